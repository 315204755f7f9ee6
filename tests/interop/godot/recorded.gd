extends "res://promises.gd"
## A world of everything that a recording can have, for weft run to play: started with -- DIR it is left there.


func _ready() -> void:
	var world := WeftWorld.new()
	world.recording = OS.get_cmdline_user_args()[0]
	world.air_wind = Vector3(1, 0, 0.5)
	world.air_turbulence = 0.5
	var gust := WeftGust.new()
	gust.velocity = Vector3(0, 0, 3)
	world.air_gusts = [gust]
	var fan := WeftAirField3D.new()
	fan.world = world
	fan.shape = 2
	fan.velocity = Vector3(0, 2, 0)
	add_child(fan)

	var carried := cloth(sheet(), Vector3(0, 1, 0))
	carried.motion_enabled = true
	carried.motion_max_distance = 0.2
	carried.motion_max_distance_map = "COLOR_0.r"
	carried.motion_backstop_radius = 1.0
	carried.motion_backstop_distance = 0.1
	carried.inertia_enabled = true
	carried.inertia_linear = 0.3
	carried.inertia_centrifugal = 0.0
	carried.mesh = painted()
	var hung := cloth(painted(), Vector3(3, 1, 0))
	hung.maps_mass = "COLOR_0.r"
	hung.add_child(anchor([0, 10]))
	var torn := cloth(sheet(15), Vector3(6, 1, 0))
	torn.tear_enabled = true
	torn.tear_strain = 0.3
	torn.add_child(anchor(range(16, 289, 17)))
	var puller := anchor(range(0, 289, 17))
	torn.add_child(puller)
	var full := cloth(SphereMesh.new(), Vector3(9, 1, 0))
	full.mesh.radial_segments = 24
	full.mesh.rings = 12
	full.pressure_enabled = true
	var nodes := [carried, hung, torn, full]
	for node in nodes:
		node.world = world
		add_child(node)
	var tears := [0]
	torn.torn.connect(func() -> void: tears[0] += 1)
	for k in 60:
		await get_tree().physics_frame
		carried.position += Vector3(0.02, 0, 0.03 * sin(0.3 * k))
		carried.rotate_y(0.04)
		hung.rotate_x(0.01)
		puller.position.x += 0.025
	for node in nodes:
		expect(node.get_fault() == "", node.get_fault())
	expect(tears[0] > 0, "the sheet does not tear")
	await gone(nodes)
	get_tree().quit(1 if broken > 0 else 0)


# A sheet whose vertex colours grow along it.
func painted() -> ArrayMesh:
	var arrays := sheet().get_mesh_arrays()
	var colours := PackedColorArray()
	for p in arrays[Mesh.ARRAY_VERTEX]:
		colours.append(Color(p.x + 0.6, 0, 0))
	arrays[Mesh.ARRAY_COLOR] = colours
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	return mesh
