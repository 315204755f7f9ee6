extends Node3D
## Plays the scene. Started with -- --frames N --out DIR it ends after N frames, and leaves pictures, frame times and recordings there.

@export var calm: WeftWorld
@export var windy: WeftWorld

var out := ""
var frames := 0
var drawn := 0
var times := PackedStringArray(["frame,milliseconds,picture"])
var before := 0


func _ready() -> void:
	var words := OS.get_cmdline_user_args()
	for k in words.size() - 1:
		if words[k] == "--out":
			out = words[k + 1]
		elif words[k] == "--frames":
			frames = int(words[k + 1])
	for cloth in find_children("*", "WeftCloth3D"):
		cloth.failed.connect(func(sentence: String) -> void: push_error("%s: %s" % [cloth.name, sentence]))
	if out.is_empty():
		return
	calm.recording = out.path_join("recording/calm")
	windy.recording = out.path_join("recording/windy")
	DirAccess.make_dir_recursive_absolute(out.path_join("pictures"))


func _process(_delta: float) -> void:
	if frames == 0:
		return
	var now := Time.get_ticks_usec()
	var with_picture := drawn % 10 == 0
	if drawn > 0:
		times.append("%d,%.3f,%d" % [drawn, (now - before) / 1000.0, int((drawn - 1) % 10 == 0)])
	before = now
	drawn += 1
	if with_picture or drawn == frames:
		await RenderingServer.frame_post_draw
		get_viewport().get_texture().get_image().save_png(out.path_join("pictures/frame_%04d.png" % drawn))
	if drawn == frames:
		FileAccess.open(out.path_join("frames.csv"), FileAccess.WRITE).store_string("\n".join(times) + "\n")
		get_tree().quit()
