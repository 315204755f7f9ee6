extends Node3D
## Walks in a circle, as fast as its steps are long.

const RADIUS := 1.0
const SPEED := 1.25

var angle := 0.0


func _ready() -> void:
	var player: AnimationPlayer = $Body/AnimationPlayer
	player.get_animation("walk").loop_mode = Animation.LOOP_LINEAR
	player.play("walk")
	go(0.0)


func _physics_process(delta: float) -> void:
	go(delta)


func go(delta: float) -> void:
	angle += SPEED / RADIUS * delta
	position = Vector3(RADIUS * sin(angle), 0.0, 0.5 + RADIUS * cos(angle))
	rotation.y = angle + PI / 2
