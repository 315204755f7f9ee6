extends AnimatableBody3D
## Swings through the curtain and back.

var time := 0.0


func _physics_process(delta: float) -> void:
	time += delta
	position.z = -0.6 - 0.8 * cos(TAU * time / 4.0)
	rotate_x(2.0 * delta)
