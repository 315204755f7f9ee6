extends "res://promises.gd"
## Motion vectors, in Forward+: cloth that is carried along has those of a mesh that goes the same way.


func promises() -> Array[Callable]:
	return [has_motion_vectors, has_motion_vectors_between_ticks, casts_its_shadow, is_culled_where_it_is]


func looking(at: Vector3) -> Camera3D:
	var camera := Camera3D.new()
	camera.position = at
	add_child(camera)
	camera.make_current()
	return camera


func picture() -> Image:
	await get_tree().process_frame
	await RenderingServer.frame_post_draw
	return get_viewport().get_texture().get_image()


func pixel(of_it: Image, camera: Camera3D, at: Vector3) -> Color:
	var place := camera.unproject_position(at)
	return of_it.get_pixel(clampi(int(place.x), 0, of_it.get_width() - 1), clampi(int(place.y), 0, of_it.get_height() - 1))


func differ(a: Color, b: Color) -> float:
	return maxf(absf(a.r - b.r), maxf(absf(a.g - b.g), absf(a.b - b.b)))


# A cloth that does what its node does, a mesh beside it, and a cloth that stays. Godot draws motion vectors as arrows from points 32 pixels
# apart: these are 128 pixels apart, so that what is drawn of them is the same.
func has_motion_vectors() -> void:
	var upright := sheet(9, 1.2)
	upright.orientation = PlaneMesh.FACE_Z
	var apart := Vector3(128.0 / 60.0, 0, 0)
	var carried := cloth(upright, -apart - Vector3(1.2, 0.6, 0))
	var stays := cloth(upright, -apart - Vector3(0, -1.3, 0))
	for each in [carried, stays]:
		each.motion_enabled = true
		each.motion_max_distance = 0.0
	var mesh := MeshInstance3D.new()
	mesh.mesh = upright
	mesh.position = carried.position + apart
	var camera := looking(Vector3(0, 0, 4))
	camera.set_orthogonal(4.0, 0.1, 10.0)   # 60 pixels a metre
	for node in [carried, stays, mesh]:
		add_child(node)
	get_viewport().use_taa = true
	get_viewport().debug_draw = Viewport.DEBUG_DRAW_MOTION_VECTORS
	await ticks(5)
	for k in 8:
		await get_tree().physics_frame
		carried.position += Vector3(0.15, 0.075, 0)
		mesh.position += Vector3(0.15, 0.075, 0)
	await RenderingServer.frame_post_draw
	var seen := get_viewport().get_texture().get_image()
	seen.save_png("user://motion.png")
	var moves := arrows(seen, camera, carried.position)
	var wanted := arrows(seen, camera, mesh.position)
	var still := arrows(seen, camera, stays.position)
	var off := 0
	for k in wanted.size():
		off += int(wanted[k] != moves[k])
	expect(wanted.count(1) > 20, "the mesh that moves has arrows on %d pixels only" % wanted.count(1))
	expect(off * 10 < wanted.count(1), "of %d pixels of arrows of a mesh %d are others of cloth that goes with it" % [wanted.count(1), off])
	expect(still.count(1) < 3, "cloth that stays has arrows on %d pixels" % still.count(1))
	get_viewport().debug_draw = Viewport.DEBUG_DRAW_DISABLED
	get_viewport().use_taa = false
	await gone([carried, stays, mesh, camera])


func has_motion_vectors_between_ticks() -> void:
	get_tree().physics_interpolation = true
	await has_motion_vectors()
	get_tree().physics_interpolation = false


# Where pixels about a place are coloured.
func arrows(of_it: Image, camera: Camera3D, at: Vector3) -> PackedByteArray:
	var found := PackedByteArray()
	var centre := Vector2i(camera.unproject_position(at).round())
	for y in range(-30, 30):
		for x in range(-30, 30):
			var place := centre + Vector2i(x, y)
			var colour := of_it.get_pixelv(place.clamp(Vector2i.ZERO, of_it.get_size() - Vector2i.ONE))
			found.append(int(colour.r - colour.b > 0.2))
	return found


# Where the cloth is, not where it was: by every kind of light, each of which finds what casts shadows in its own way.
func casts_its_shadow() -> void:
	var above := cloth(sheet())
	above.motion_enabled = true
	above.motion_max_distance = 0.0
	var floor := MeshInstance3D.new()
	floor.mesh = PlaneMesh.new()
	floor.mesh.size = Vector2(20, 20)
	var camera := looking(Vector3(0, 1.5, 5))
	add_child(above)
	add_child(floor)
	for light: Light3D in [DirectionalLight3D.new(), SpotLight3D.new(), OmniLight3D.new()]:
		light.rotation_degrees.x = -90
		light.position.y = 6
		light.shadow_enabled = true
		if light is not DirectionalLight3D:
			light.light_energy = 20
			light.set_param(Light3D.PARAM_RANGE, 20.0)
		above.position = Vector3(-3, 1, 0)
		above.restart()
		add_child(light)
		await ticks(3)
		for k in 60:
			above.position.x += 0.05
			await ticks(1)
		await ticks(5)
		var seen := await picture()
		seen.save_png("user://shadow_%s.png" % light.get_class())
		var under := pixel(seen, camera, Vector3(0, 0, 0.2))
		var beside := pixel(seen, camera, Vector3(1.2, 0, 0.2))
		var start := pixel(seen, camera, Vector3(-1.2, 0, 0.2))
		expect(beside.r - under.r > 0.2, "by a %s the floor under cloth is %s, beside it %s" % [light.get_class(), under, beside])
		expect(absf(beside.r - start.r) < 0.1, "by a %s there is a shadow where cloth was: %s, beside it %s" % [light.get_class(), start, beside])
		light.queue_free()
	await gone([above, floor, camera])


# It flies fast across the edge of the picture: it must be drawn in every frame in which some of it is in view.
func is_culled_where_it_is() -> void:
	var paint := StandardMaterial3D.new()
	paint.albedo_color = Color(1, 0, 0)
	paint.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	var light := DirectionalLight3D.new()
	var flying := cloth(sheet(), Vector3(-12, 0, 0))
	flying.mesh.orientation = PlaneMesh.FACE_Z
	flying.material_override = paint
	flying.motion_enabled = true
	flying.motion_max_distance = 0.0
	var camera := looking(Vector3(0, 0, 4))
	add_child(light)
	add_child(flying)
	await ticks(5)
	var missed := 0
	for k in 48:
		await get_tree().physics_frame
		flying.position.x += 0.5   # 30 m/s
		await RenderingServer.frame_post_draw
		var at := flying.get_vertices()
		var centre := Vector3.ZERO
		for p in at:
			centre += p / at.size()
		if absf(centre.x) < 2.0 and pixel(get_viewport().get_texture().get_image(), camera, centre).r < 0.3:
			missed += 1
	expect(missed == 0, "cloth that flies past at 30 m/s is not drawn in %d frames" % missed)
	await gone([flying, light, camera])
