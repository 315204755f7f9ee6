extends "res://promises.gd"
## What a WeftCloth3D promises of skins, hands, the air, gases and tears.


func promises() -> Array[Callable]:
	return [goes_with_its_skin, wears_an_imported_mesh, goes_with_its_node_without_a_skin, feels_as_much_as_it_is_told,
			goes_on_where_its_node_has_gone, is_pinned_and_released, is_grabbed_and_let_go, blows_in_gusts_and_fields, holds_a_gas,
			tears_and_is_cut, shows_a_file_at_rest, loads_in_the_background]


# No air, so that what falls does, and room for hands.
func still(pins := 0, grabs := 0) -> WeftWorld:
	var world := WeftWorld.new()
	world.air_enabled = false
	world.pins = pins
	world.grabs = grabs
	return world


# A strip along x whose left half is the first bone's and whose right half is the second's.
func skinned_strip() -> ArrayMesh:
	var tool := SurfaceTool.new()
	tool.begin(Mesh.PRIMITIVE_TRIANGLES)
	for i in 9:
		for j in 3:
			tool.set_normal(Vector3.UP)
			tool.set_uv(Vector2(i / 8.0, j / 2.0))
			tool.set_bones(PackedInt32Array([0, 1, 0, 0]))
			var second := 0.0 if i < 4 else (1.0 if i > 4 else 0.5)
			tool.set_weights(PackedFloat32Array([1.0 - second, second, 0.0, 0.0]))
			tool.add_vertex(Vector3(i / 8.0 - 0.5, 0, j / 8.0))
	for i in 8:
		for j in 2:
			var v := 3 * i + j
			for corner in [v, v + 3, v + 1, v + 1, v + 3, v + 4]:
				tool.add_index(corner)
	return tool.commit()


func two_bones() -> Skeleton3D:
	var bones := Skeleton3D.new()
	bones.name = "Bones"
	bones.position = Vector3(0, 2, 0)
	bones.add_bone("left")
	bones.add_bone("right")
	bones.set_bone_rest(0, Transform3D(Basis(), Vector3(-0.25, 0, 0)))
	bones.set_bone_rest(1, Transform3D(Basis(), Vector3(0.25, 0, 0)))
	bones.reset_bone_poses()
	return bones


func goes_with_its_skin() -> void:
	var bones := two_bones()
	bones.rotation_degrees.y = 90
	var near := cloth(skinned_strip())
	near.world = still()
	near.skeleton = NodePath("..")
	near.motion_enabled = true
	near.motion_max_distance = 0.02
	var held := cloth(skinned_strip())
	held.world = near.world
	held.skeleton = NodePath("..")
	var by := anchor([0, 24])
	by.with_skin = true
	held.add_child(by)
	bones.add_child(near)
	bones.add_child(held)
	bones.set_bone_pose_position(0, Vector3(-0.25, 0.1, 0))   # a pose to begin with
	add_child(bones)
	await ticks(2)
	var start := near.get_vertices()[0]
	expect(start.distance_to(bones.to_global(Vector3(-0.5, 0.1, 0))) < 0.05, "it does not begin in its pose, but at %s" % start)
	bones.position.x += 0.5
	bones.set_bone_pose_position(1, Vector3(0.25, 0.3, 0))
	bones.set_bone_pose_rotation(1, Quaternion(Vector3.RIGHT, PI / 2))
	await ticks(30)
	var wanted := bones.to_global(bones.get_bone_global_pose(1) * Vector3(0.25, 0, 0.25))   # vertex 26, 0.25 from the bone at rest
	var there := near.get_vertices()[26]
	expect(there.distance_to(wanted) < 0.025, "a vertex is at %s, and its bone takes it to %s" % [there, wanted])
	wanted = bones.to_global(bones.get_bone_global_pose(1) * Vector3(0.25, 0, 0))
	there = held.get_vertices()[24]
	expect(there.distance_to(wanted) < 1e-4, "an anchor is at %s, and the skin takes it to %s" % [there, wanted])
	expect(near.get_fault() == "" and near.get_warnings().is_empty(), "a skinned cloth has faults: %s" % near.get_warnings())
	near.motion_scale = 20.0
	await ticks(40)
	expect(lowest(near) < bones.position.y - 0.15, "with longer max distances it does not hang lower than %f" % lowest(near))
	near.skeleton = NodePath("../nowhere")
	expect(not near.get_warnings().is_empty(), "joints without a skeleton have no warning")
	await gone([bones])


# What Godot imports and what Weft reads of the same file are carried alike.
func wears_an_imported_mesh() -> void:
	var imported: Node3D = load("res://cape.glb").instantiate()
	var from: MeshInstance3D = imported.find_children("*", "MeshInstance3D")[0]
	var bones: Skeleton3D = imported.find_children("*", "Skeleton3D")[0]
	var worn := cloth(from.mesh)
	worn.skin = from.skin
	var read := cloth(null)
	read.gltf = "res://cape.glb"
	for each in [worn, read]:
		each.skeleton = NodePath("..")
		each.world = still()
		each.motion_enabled = true
		each.motion_max_distance = 0.0
		bones.add_child(each)
	add_child(imported)
	imported.position = Vector3(2, 0, 1)
	await ticks(5)
	var before := middle(worn)
	bones.set_bone_pose_rotation(bones.find_bone("chest"), Quaternion(Vector3.RIGHT, 0.6))
	await ticks(5)
	expect(worn.get_fault() == "" and read.get_fault() == "", worn.get_fault() + read.get_fault())
	expect(worn.get_warnings().is_empty(), "an imported mesh has warnings: %s" % worn.get_warnings())
	expect(middle(worn).distance_to(before) > 0.05, "a bone that turns leaves cloth at %s" % middle(worn))
	expect(middle(worn).distance_to(middle(read)) < 0.005, "imported it is at %s, read at %s" % [middle(worn), middle(read)])
	expect(absf(lowest(worn) - lowest(read)) < 0.002, "imported it reaches down to %f, read to %f" % [lowest(worn), lowest(read)])
	# A file's joint with a colon is a bone with none.
	var bytes := FileAccess.get_file_as_bytes("res://cape.glb")
	var at := bytes.hex_encode().find("chest".to_ascii_buffer().hex_encode()) / 2
	bytes[at + 1] = ":".unicode_at(0)
	FileAccess.open("user://colon.glb", FileAccess.WRITE).store_buffer(bytes)
	bones.set_bone_name(bones.find_bone("chest"), "c_est")
	read.gltf = "user://colon.glb"
	expect(read.get_warnings().is_empty(), "a joint with a colon has warnings: %s" % read.get_warnings())
	await gone([imported])


func goes_with_its_node_without_a_skin() -> void:
	var near := cloth(sheet())
	near.world = still()
	near.motion_enabled = true
	near.motion_max_distance = 0.01
	near.motion_backstop_radius = 10.0
	add_child(near)
	await ticks(5)
	for k in 20:
		near.position.x += 0.05
		near.rotate_y(0.05)
		await ticks(1)
	await ticks(2)
	expect(middle(near).distance_to(near.position) < 0.03, "its node is at %s, and it is at %s" % [near.position, middle(near)])
	await gone([near])


# Two sheets hang from nodes that start off at 3 m/s; one feels nothing of it.
func feels_as_much_as_it_is_told() -> void:
	var nodes := []
	for felt in [1.0, 0.0]:
		var hung := cloth(sheet(), Vector3(0, 2, 4 * felt))
		hung.world = still()
		hung.inertia_enabled = true
		hung.inertia_linear = felt
		hung.mesh.orientation = PlaneMesh.FACE_X
		hung.add_child(anchor([0, 10]))
		nodes.append(hung)
		add_child(hung)
	await ticks(5)
	var swung := [0.0, 0.0]
	for k in 20:
		for n in 2:
			nodes[n].position.x += 0.05
		await ticks(1)
		for n in 2:
			swung[n] = maxf(swung[n], absf(nodes[n].position.x - middle(nodes[n]).x))
	for node in nodes:
		expect(node.get_fault() == "", node.get_fault())
	expect(swung[0] > 0.2, "a sheet that feels its node start off swings by %f only" % swung[0])
	expect(swung[1] < 0.06, "a sheet that feels nothing swings by %f" % swung[1])
	await gone(nodes)


# When something comes and all is made anew, a cloth whose node has moved goes on from where it is.
func goes_on_where_its_node_has_gone() -> void:
	var held := cloth(sheet(), Vector3(0, 2, 0))
	var corner := anchor([])
	corner.box = Vector3(0.1, 0.1, 0.1)
	corner.position = Vector3(0.5, 0, 0.5)   # vertex 0
	held.add_child(corner)
	add_child(held)
	await ticks(30)
	for k in 20:
		held.position.x += 0.05
		await ticks(1)
	var before := held.get_vertices()[0]
	expect(before.distance_to(corner.global_position) < 1e-3, "its anchor is at %s" % before)
	var other := cloth(sheet(), Vector3(0, 9, 0))
	add_child(other)
	await ticks(4)
	expect(held.get_fault() == "", held.get_fault())
	var after := held.get_vertices()[0]
	expect(after.distance_to(corner.global_position) < 1e-3, "when another comes an anchor jumps from %s to %s" % [before, after])
	await gone([held, other])


func is_pinned_and_released() -> void:
	var falling := cloth(sheet())
	falling.world = still(8)
	add_child(falling)
	await ticks(2)
	falling.pin([0, 10])
	await ticks(30)
	var corner := falling.get_vertices()[0]
	expect(corner.distance_to(Vector3(0.5, 0, 0.5)) < 0.05, "a pinned vertex is at %s" % corner)
	expect(lowest(falling) < -0.5, "what is pinned does not hang: %f" % lowest(falling))
	for k in 20:
		falling.move_pins([0, 10], [Vector3(0.5, 0.05 * k, 0.5), Vector3(-0.5, 0.05 * k, 0.5)])
		await ticks(1)
	await ticks(1)
	expect(falling.get_vertices()[10].distance_to(Vector3(-0.5, 0.95, 0.5)) < 1e-3, "a pin was moved to %s" % falling.get_vertices()[10])
	var other := cloth(sheet(), Vector3(5, 0, 0))   # all is made anew
	other.world = falling.world
	add_child(other)
	await ticks(10)
	corner = falling.get_vertices()[10]
	expect(corner.distance_to(Vector3(-0.5, 0.95, 0.5)) < 1e-3, "a cloth that comes undoes pins: %s" % corner)
	falling.release([0, 10])
	await ticks(30)
	expect(falling.get_vertices()[10].y < 0.5, "what was released does not fall: %s" % falling.get_vertices()[10])
	falling.pin([100000, -1])   # warnings
	falling.move_pins([3], [Vector3.ZERO])
	await ticks(2)
	expect(falling.get_fault() == "", "a wrong pin stops the cloth: %s" % falling.get_fault())
	await gone([falling, other])


func is_grabbed_and_let_go() -> void:
	var held := cloth(sheet(), Vector3(0, 2, 0))
	held.world = still(0, 2)
	held.add_child(anchor([0, 10]))
	held.grip_stiffness = 500.0
	held.fabric_preset = 4
	held.fabric_damping = 3.0
	expect(held.grab(Vector3(0, 3, 0), Vector3.DOWN).is_empty(), "cloth that is not there is grabbed")
	add_child(held)
	await ticks(60)
	expect(held.grab(Vector3(9, 9, 9), Vector3.UP).is_empty(), "a ray into the sky takes hold")
	var at := held.get_vertices()[115]   # in the middle of the lower hem
	var found := held.grab(at + Vector3(0, 0, 2), Vector3.FORWARD)
	expect(not found.is_empty() and found.get("cloth") == held, "a ray to %s finds %s" % [at, found])
	if found.is_empty():
		await gone([held])
		return
	expect(found.point.distance_to(at) < 0.1 and absf(found.distance - 2) < 0.1, "a ray to %s meets %s" % [at, found])
	var target: Vector3 = found.point + Vector3(0, 0.4, 0.2)
	for k in 40:
		held.move_grab(found.grab, found.point.lerp(target, minf(1.0, k / 20.0)))
		await ticks(1)
	expect(held.get_vertices()[115].distance_to(target) < 0.15, "what is pulled to %s is at %s" % [target, held.get_vertices()[115]])
	var other := cloth(sheet(), Vector3(5, 0, 0))   # all is made anew
	other.world = held.world
	add_child(other)
	await ticks(30)
	expect(held.get_vertices()[115].distance_to(target) < 0.15, "a cloth that comes lets go: %s, not %s" % [held.get_vertices()[115], target])
	held.let_go(found.grab)
	await ticks(40)
	expect(held.get_vertices()[115].distance_to(target) > 0.2, "what was let go stays at %s" % held.get_vertices()[115])
	held.move_grab(found.grab, target)   # a warning
	await ticks(2)
	expect(held.get_fault() == "", "a wrong grab stops the cloth: %s" % held.get_fault())
	await gone([held, other])


func blows_in_gusts_and_fields() -> void:
	var gusty := WeftWorld.new()
	var gust := WeftGust.new()
	gust.velocity = Vector3(0, 0, 6)
	gust.period = 4.0
	gusty.air_gusts = [gust]
	var upright := sheet()
	upright.orientation = PlaneMesh.FACE_Z
	var nodes := []
	for world in [gusty, WeftWorld.new(), WeftWorld.new(), WeftWorld.new()]:
		var flag := cloth(upright, Vector3(4.0 * nodes.size(), 0, 0))
		flag.world = world
		flag.add_child(anchor([0, 10]))
		nodes.append(flag)
		add_child(flag)
	var fan := WeftAirField3D.new()   # before the third, and later before the fourth
	fan.world = nodes[2].world
	fan.shape = 2   # a jet
	fan.velocity = Vector3(0, 0, 8)
	fan.radius = 0.5
	fan.position = nodes[2].position + Vector3(0, -0.2, -1)
	add_child(fan)
	await ticks(45)
	var blown := []
	for flag in nodes:
		expect(flag.get_fault() == "", flag.get_fault())
		blown.append(middle(flag).z)
	expect(blown[0] > blown[1] + 0.1, "a gust blows cloth to %f, no gust to %f" % [blown[0], blown[1]])
	expect(blown[2] > blown[1] + 0.1, "a jet blows cloth to %f, none to %f" % [blown[2], blown[1]])
	fan.rotation_degrees.y = 180   # it blows away from the cloth now
	fan.hide()
	await ticks(90)
	expect(middle(nodes[2]).z < 0.1, "while the jet is hidden it blows cloth to %f" % middle(nodes[2]).z)
	fan.world = nodes[3].world
	fan.show()
	fan.rotation_degrees.y = 0
	fan.position = nodes[3].position + Vector3(0, -0.2, -1)
	await ticks(45)
	expect(middle(nodes[3]).z > 0.1, "the jet of another world blows cloth to %f" % middle(nodes[3]).z)
	fan.queue_free()
	await ticks(3)
	expect(nodes[3].get_fault() == "", "without its jet a cloth stands still: %s" % nodes[3].get_fault())
	for k in 17:   # one more than there may be
		fan = WeftAirField3D.new()
		fan.velocity = Vector3(0, 1, 0)
		fan.world = nodes[3].world
		nodes.append(fan)
		add_child(fan)
	await ticks(3)
	expect(nodes[3].get_fault() == "", "17 fields stop a cloth: %s" % nodes[3].get_fault())
	await gone(nodes)


func radius(of_it: WeftCloth3D) -> float:
	var centre := middle(of_it)
	var sum := 0.0
	for p in of_it.get_vertices():
		sum += p.distance_to(centre)
	return sum / of_it.get_vertices().size()


func holds_a_gas() -> void:
	var ball := SphereMesh.new()
	ball.radial_segments = 24
	ball.rings = 12
	var full := cloth(ball)
	full.world = still()
	full.world.gravity_scale = 0.0
	full.fabric_preset = 4
	full.fabric_stretch = 500.0
	full.pressure_enabled = true
	full.pressure_rest_pressure = 500.0
	full.pressure_ambient = 1000.0
	add_child(full)
	await ticks(30)
	expect(full.get_fault() == "", full.get_fault())
	var before := radius(full)
	full.pressure_amount = 3.0
	await ticks(60)
	expect(radius(full) > 1.05 * before, "three times the gas blows a ball up from %f to %f" % [before, radius(full)])
	full.pressure_amount = 0.1
	await ticks(90)
	expect(radius(full) < 0.95 * before, "without gas a ball goes from %f to %f" % [before, radius(full)])
	var open := cloth(sheet())
	open.pressure_enabled = true
	expect(not open.get_warnings().is_empty(), "an open mesh with a gas has no warning")
	open.free()
	await gone([full])


func tears_and_is_cut() -> void:
	var held := cloth(sheet(15), Vector3(0, 2, 0))
	held.world = still()
	held.tear_enabled = true
	held.tear_strain = 0.3
	var left := anchor(range(16, 289, 17))
	var right := anchor(range(0, 289, 17))
	held.add_child(left)
	held.add_child(right)
	var torn := [0]
	held.torn.connect(func() -> void: torn[0] += 1)
	add_child(held)
	await ticks(2)
	expect(torn[0] == 0, "cloth tears at rest")
	for k in 30:
		right.position.x += 0.04
		await ticks(1)
	await ticks(10)
	expect(torn[0] > 0, "cloth that is pulled to twice its length does not tear")
	await gone([held])

	held = cloth(sheet(15), Vector3(0, 2, 0))
	held.world = still()
	held.tear_enabled = true
	held.tear_strain = 10.0
	held.add_child(anchor(range(0, 289, 17)))
	add_child(held)
	var paint := StandardMaterial3D.new()
	paint.albedo_color = Color(1, 0, 0)
	held.material_override = paint
	await ticks(10)
	var eye := middle(held) + Vector3(0, 3, 0)
	var pieces := held.cut(eye, middle(held) - eye + Vector3(0, 0, -2), middle(held) - eye + Vector3(0, 0, 2))
	expect(pieces > 5, "a cut across a sheet makes two of %d vertices" % pieces)
	var other := cloth(sheet(), Vector3(5, 0, 0))   # all is made anew
	other.world = held.world
	add_child(other)
	await ticks(70)
	expect(held.get_fault() == "", held.get_fault())
	expect(held.get_vertices()[8 * 17 + 16].y < 0, "what was cut off does not fall: %s" % held.get_vertices()[8 * 17 + 16])
	expect(held.get_vertices()[8 * 17].y > 1.9, "what is held falls: %s" % held.get_vertices()[8 * 17])
	expect(still_cut(), "cloth that does not tear was cut")
	await gone([held, other])


func still_cut() -> bool:
	var whole := cloth(sheet())
	var count := whole.cut(Vector3.UP, Vector3.DOWN, Vector3.RIGHT)
	whole.free()
	return count == 0


func shows_a_file_at_rest() -> void:
	var cape := cloth(null)
	cape.gltf = "res://cape.glb"
	expect(cape.mesh != null and cape.mesh.get_aabb().size.y > 0.5, "the mesh of a file is not the node's")
	var scene := PackedScene.new()
	scene.pack(cape)
	ResourceSaver.save(scene, "user://file.tscn")
	var text := FileAccess.get_file_as_string("user://file.tscn")
	expect(not text.contains("ArrayMesh") and text.contains("cape.glb"), "a file's mesh is saved with the scene")
	var loaded: WeftCloth3D = load("user://file.tscn").instantiate()
	expect(loaded.mesh != null, "a scene that is loaded does not show its file's mesh")
	loaded.free()
	cape.gltf = ""
	expect(cape.mesh == null, "without a file there is still its mesh")
	cape.gltf = "res://project.godot"
	expect(cape.mesh == null and not cape.get_warnings().is_empty(), "a file that is no mesh has no warning")
	cape.free()


# On a device with a single queue Godot's loader threads and Weft submit to the same one. Validation says if two do so at a time.
func loads_in_the_background() -> void:
	const COUNT := 32
	for k in COUNT:
		var picture := Image.create(1024, 1024, false, Image.FORMAT_RGBA8)
		picture.fill(Color(k / float(COUNT), 0, 0))
		ResourceSaver.save(ImageTexture.create_from_image(picture), "user://picture_%d.res" % k)
	var held := cloth(sheet(31))
	held.add_child(anchor([0]))
	add_child(held)
	await ticks(5)
	for k in COUNT:
		ResourceLoader.load_threaded_request("user://picture_%d.res" % k, "", true, ResourceLoader.CACHE_MODE_IGNORE)
	for k in COUNT:
		var file := "user://picture_%d.res" % k
		while ResourceLoader.load_threaded_get_status(file) == ResourceLoader.THREAD_LOAD_IN_PROGRESS:
			await ticks(1)
		expect(ResourceLoader.load_threaded_get(file) is Texture2D, "%s is not loaded" % file)
		DirAccess.remove_absolute(file)
	expect(held.get_fault() == "", held.get_fault())
	await gone([held])
