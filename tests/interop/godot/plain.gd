extends Node3D
## A scene without Weft. In Forward+ with motion vectors, as motion.gd has them: Godot's own messages come with them.


func _ready() -> void:
	if RenderingServer.get_current_rendering_method() == "forward_plus":
		get_viewport().use_taa = true
		get_viewport().debug_draw = Viewport.DEBUG_DRAW_MOTION_VECTORS
