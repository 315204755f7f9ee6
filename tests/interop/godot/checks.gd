extends "res://promises.gd"
## What a WeftCloth3D promises.


func promises() -> Array[Callable]:
	return [falls_and_is_drawn_where_it_is, meets_every_kind_of_shape, follows_its_anchors, goes_with_the_pause_and_slow_motion,
			changes_with_the_tree, says_what_is_broken, is_saved_and_loaded, leaves_nothing_behind]


# Also far from where its node is, so that its box for culling goes along.
func falls_and_is_drawn_where_it_is() -> void:
	var air := WeftWorld.new()
	air.air_enabled = false
	var falling := cloth(sheet(), Vector3(0, 3, 0))
	falling.world = air
	var paint := StandardMaterial3D.new()
	paint.albedo_color = Color(1, 0, 0)
	falling.material_override = paint
	var camera := Camera3D.new()
	camera.rotation_degrees.x = -90
	var light := DirectionalLight3D.new()
	light.rotation_degrees.x = -90
	add_child(camera)
	add_child(light)
	add_child(falling)
	await ticks(91)
	var at := middle(falling)
	var seconds := 91 / 60.0   # v' = -g - c v, with cotton's damping of 0.1 / s; a tick is 0.25 m here
	var height := 3 - 9.8 / 0.1 * (seconds - (1 - exp(-0.1 * seconds)) / 0.1)
	expect(absf(at.y - height) < 0.1, "cloth falls to %f, not to %f" % [at.y, height])
	camera.position = at + Vector3(0, 2, 0)
	camera.make_current()
	await get_tree().process_frame
	await RenderingServer.frame_post_draw
	var picture := get_viewport().get_texture().get_image()
	var seen := picture.get_pixel(picture.get_width() / 2, picture.get_height() / 2)
	expect(seen.r > 0.3 and seen.g < 0.2, "the cloth is not seen where it is: %s" % seen)
	await gone([falling, camera, light])


func meets_every_kind_of_shape() -> void:
	var faces := BoxMesh.new()
	faces.size = Vector3(0.5, 0.5, 0.5)
	var sphere := SphereShape3D.new()
	sphere.radius = 0.25
	var capsule := CapsuleShape3D.new()
	capsule.radius = 0.25
	capsule.height = 0.9
	var box := BoxShape3D.new()
	box.size = Vector3(0.5, 0.5, 0.5)
	var nodes := []
	var cloths := []
	var kinds := [sphere, capsule, box, WorldBoundaryShape3D.new(), faces.create_trimesh_shape()]
	for k in kinds.size():
		var at := Vector3(4.0 * k, -0.25 if kinds[k] is SphereShape3D or kinds[k] is BoxShape3D else 0.0, 0)
		var solid := body(kinds[k], at)
		if kinds[k] is CapsuleShape3D:
			solid.rotation_degrees.z = 90
			solid.position.y = -0.25
		if kinds[k] is ConcavePolygonShape3D:
			solid.position.y = -0.25
		solid.collision_layer = 1 << k
		var over := cloth(sheet(15), Vector3(4.0 * k, 0.1, 0))
		over.collision_mask = 1 << k
		nodes.append_array([solid, over])
		cloths.append(over)
	for node in nodes:
		add_child(node)
	await ticks(60)
	for k in kinds.size():
		var top := -INF
		for p in cloths[k].get_vertices():
			top = maxf(top, p.y)
		expect(cloths[k].get_fault() == "", cloths[k].get_fault())
		expect(top > -0.02 and top < 0.06, "on the %s cloth lies at %f, not at 0" % [kinds[k].get_class(), top])
	# A shape that moves takes the cloth on it along.
	var before := middle(cloths[2]).y
	for k in 30:
		nodes[4].position.y += 0.02
		await ticks(1)
	expect(middle(cloths[2]).y > before + 0.3, "a box that rises takes no cloth along: from %f to %f" % [before, middle(cloths[2]).y])
	await gone(nodes)


func follows_its_anchors() -> void:
	var held := cloth(sheet())
	var by := anchor([0, 10])
	held.add_child(by)
	var bones := Skeleton3D.new()
	bones.add_bone("hand")
	var second := cloth(sheet(), Vector3(3, 0, 0))
	var hand := anchor([0])
	hand.follow = NodePath("../../Bones")
	hand.bone = "hand"
	second.add_child(hand)
	bones.name = "Bones"
	add_child(bones)
	add_child(held)
	add_child(second)
	await ticks(5)
	by.position = Vector3(0, 1, 0)
	bones.set_bone_pose_position(0, Vector3(0, 0, 0.5))
	await ticks(60)
	var corner := held.get_vertices()[0]
	expect(corner.distance_to(Vector3(0.5, 1, 0.5)) < 1e-3, "the anchor's vertex is at %s" % corner)
	corner = second.get_vertices()[0]
	expect(corner.distance_to(Vector3(3.5, 0, 1)) < 1e-3, "the bone's vertex is at %s" % corner)
	await gone([held, second, bones])


func goes_with_the_pause_and_slow_motion() -> void:
	var still := WeftWorld.new()
	still.air_enabled = false
	var falling := cloth(sheet())
	falling.world = still
	add_child(falling)
	await ticks(2)
	get_tree().paused = true
	var before := middle(falling)
	process_mode = Node.PROCESS_MODE_ALWAYS
	falling.process_mode = Node.PROCESS_MODE_PAUSABLE
	await ticks(20)
	expect(middle(falling) == before, "it falls from %s to %s while the tree is paused" % [before, middle(falling)])
	get_tree().paused = false
	await gone([falling])
	var fell := []
	for scale in [1.0, 0.5]:
		Engine.time_scale = scale
		falling = cloth(sheet())
		falling.world = still
		add_child(falling)
		await ticks(41)
		fell.append(middle(falling).y)
		await gone([falling])
	Engine.time_scale = 1
	expect(absf(fell[0] / fell[1] - 4) < 0.3, "at half the speed it falls %f of %f, not a quarter" % [fell[1], fell[0]])


# Others go on where they are when a cloth or a shape comes or goes.
func changes_with_the_tree() -> void:
	var first := cloth(sheet())
	first.add_child(anchor([0]))
	add_child(first)
	await ticks(60)
	var before := middle(first)
	var second := cloth(sheet(), Vector3(5, 0, 0))
	second.add_child(anchor([0]))
	add_child(second)
	await ticks(2)
	expect(middle(first).distance_to(before) < 0.1, "a cloth that comes moves another from %s to %s" % [before, middle(first)])
	expect(second.get_vertices().size() == 121, "the cloth that came is not simulated")
	var sphere := SphereShape3D.new()
	sphere.radius = 0.2
	var solid := body(sphere, Vector3(9, 0, 0))
	add_child(solid)
	await ticks(2)
	expect(middle(first).distance_to(before) < 0.1, "a shape that comes moves cloth from %s to %s" % [before, middle(first)])
	second.queue_free()
	solid.queue_free()
	await ticks(2)
	expect(middle(first).distance_to(before) < 0.15 and first.get_fault() == "", "a cloth that goes moves another")
	first.restart()
	await ticks(2)
	expect(middle(first).y > -0.05, "it does not begin anew: %s" % middle(first))
	await gone([first])


func says_what_is_broken() -> void:
	var points := ArrayMesh.new()
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array([Vector3.ZERO, Vector3.ONE, Vector3.UP])
	points.add_surface_from_arrays(Mesh.PRIMITIVE_POINTS, arrays)
	var flat := ArrayMesh.new()
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array([Vector3.ZERO, Vector3.ZERO, Vector3.ZERO])
	flat.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var not_finite := ArrayMesh.new()
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array([Vector3(NAN, 0, 0), Vector3.RIGHT, Vector3.UP])
	not_finite.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var good := cloth(sheet())
	var nodes := [good, cloth(null), cloth(points), cloth(flat), cloth(not_finite), cloth(ArrayMesh.new()), cloth(sheet()), cloth(sheet()), cloth(null), cloth(sheet())]
	nodes[6].add_child(anchor([100000]))
	nodes[7].scale = Vector3(1, 2, 1)
	nodes[8].gltf = "res://project.godot"
	nodes[9].fabric_preset = 4
	nodes[9].maps_mass = "COLOR_0.r"
	var told := {}
	for node in nodes:
		node.failed.connect(func(sentence: String) -> void: told[node] = sentence)
		add_child(node)
	await ticks(3)
	for k in range(1, nodes.size()):
		expect(told.has(nodes[k]) and told[nodes[k]] == nodes[k].get_fault(), "broken cloth %d does not say so" % k)
		expect(not nodes[k].get_warnings().is_empty(), "broken cloth %d has no warning in the tree" % k)
	expect(good.get_fault() == "" and good.get_vertices().size() == 121, "a good cloth beside broken ones does not go on: %s" % good.get_fault())
	expect(good.get_warnings().is_empty(), "a good cloth has warnings: %s" % good.get_warnings())
	var cylinder := body(CylinderShape3D.new(), Vector3(7, 0, 0))
	var empty := body(null, Vector3(8, 0, 0))
	add_child(cylinder)
	add_child(empty)
	await ticks(3)
	expect(good.get_fault() == "", "a shape that cloth does not meet stops it: %s" % good.get_fault())
	var wrong := WeftWorld.new()
	wrong.solver_method = 4
	wrong.solver_relaxation = 1.99
	good.world = wrong
	expect(not good.get_warnings().is_empty(), "a solver that cannot be has no warning")
	good.world = null
	nodes.append_array([cylinder, empty])
	await gone(nodes)


func is_saved_and_loaded() -> void:
	var world := WeftWorld.new()
	world.solver_substeps = 7
	world.air_wind = Vector3(1, 2, 3)
	var saved := cloth(sheet())
	saved.world = world
	saved.fabric_preset = 4
	saved.fabric_thickness = 0.004
	var by := anchor([1, 2])
	by.follow = NodePath("../..")
	saved.add_child(by)
	by.owner = saved
	var scene := PackedScene.new()
	expect(scene.pack(saved) == OK and ResourceSaver.save(scene, "user://saved.tscn") == OK, "the scene cannot be saved")
	var loaded: WeftCloth3D = load("user://saved.tscn").instantiate()
	var found: WeftAnchor3D = loaded.get_child(0)
	expect(loaded.world.solver_substeps == 7 and loaded.world.air_wind == Vector3(1, 2, 3), "the world is not loaded as it was saved")
	expect(loaded.fabric_preset == 4 and loaded.fabric_thickness == 0.004, "the fabric is not loaded as it was saved")
	expect(found.vertices == PackedInt32Array([1, 2]) and found.follow == NodePath("../.."), "the anchor is not loaded as it was saved")
	saved.free()
	loaded.free()


func leaves_nothing_behind() -> void:
	var scene: PackedScene = load("res://small.tscn")
	var count := WeftWorld.new()
	var resident := 0.0
	for k in 15:
		var node := scene.instantiate()
		add_child(node)
		await ticks(4)
		expect(count.get_simulation_count() == 1, "with one scene there are %d simulations" % count.get_simulation_count())
		expect(node.get_node("Cloth").get_fault() == "", node.get_node("Cloth").get_fault())
		node.queue_free()
		await ticks(12)
		expect(count.get_simulation_count() == 0, "without a scene there are %d simulations" % count.get_simulation_count())
		var pages := FileAccess.open("/proc/self/statm", FileAccess.READ).get_line().get_slice(" ", 1).to_int()
		if k == 4:   # driver and shaders have theirs by now
			resident = pages * 4096.0
		elif k == 14:
			expect(pages * 4096.0 - resident < 8e6, "ten loads of a scene take %d kB" % ((pages * 4096.0 - resident) / 1024))
			print("ten loads: %d kB" % ((pages * 4096.0 - resident) / 1024))
