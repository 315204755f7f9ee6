extends Node3D
## What checks have in common. Ends with exit code 1, and a line for each promise that is not kept.

var broken := 0


## One function a promise.
func promises() -> Array[Callable]:
	return []


func _ready() -> void:
	print("promised: ", promises().size())
	for check in promises():
		await check.call()
		print("checked: ", check.get_method())
	get_tree().quit(1 if broken > 0 else 0)


func expect(kept: bool, sentence: String) -> void:
	if not kept:
		broken += 1
		print("BROKEN: ", sentence)


func ticks(count: int) -> void:
	for k in count:
		await get_tree().physics_frame
	await get_tree().process_frame


func sheet(cells := 9, side := 1.0) -> PlaneMesh:
	var mesh := PlaneMesh.new()
	mesh.size = Vector2(side, side)
	mesh.subdivide_width = cells
	mesh.subdivide_depth = cells
	return mesh


func cloth(mesh: Mesh, at := Vector3.ZERO) -> WeftCloth3D:
	var made := WeftCloth3D.new()
	made.mesh = mesh
	made.position = at
	return made


func body(shape: Shape3D, at: Vector3) -> StaticBody3D:
	var made := StaticBody3D.new()
	var holder := CollisionShape3D.new()
	holder.shape = shape
	made.add_child(holder)
	made.position = at
	return made


func anchor(vertices: PackedInt32Array) -> WeftAnchor3D:
	var made := WeftAnchor3D.new()
	made.vertices = vertices
	return made


func gone(nodes: Array) -> void:
	for node in nodes:
		node.queue_free()
	await ticks(2)


func lowest(of_it: WeftCloth3D) -> float:
	var y := INF
	for p in of_it.get_vertices():
		y = minf(y, p.y)
	return y


func middle(of_it: WeftCloth3D) -> Vector3:
	var sum := Vector3.ZERO
	var all := of_it.get_vertices()
	for p in all:
		sum += p
	return sum / maxf(1.0, all.size())
