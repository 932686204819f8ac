## Tests of the extension: `godot --path project res://tests/run.tscn`. Ends with the number of failures.
extends Node3D

const SIZE := Vector2i(320, 200)
const DISTANCE := 5.0
## Movement of the box in a frame.
const STEP := Vector3(0.02, 0.01, 0)

var effect: CompositorEffect
var box := MeshInstance3D.new()
var failures := 0
var is_moving := false


func _ready() -> void:
	get_window().size = SIZE
	var mesh := BoxMesh.new()
	var material := StandardMaterial3D.new()
	material.albedo_color = Color(0.6, 0.6, 0.6)
	material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	mesh.material = material
	box.mesh = mesh
	add_child(box)
	var environment := WorldEnvironment.new()
	environment.environment = Environment.new()
	environment.environment.background_mode = Environment.BG_COLOR
	# That of the box: only the guides tell them apart.
	environment.environment.background_color = Color(0.6, 0.6, 0.6)
	add_child(environment)
	var camera := Camera3D.new()
	add_child(camera)
	camera.look_at_from_position(Vector3(0, 0, DISTANCE + 0.5), Vector3.ZERO)
	effect = ClassDB.instantiate("IsophoteEffect")
	camera.compositor = Compositor.new()
	camera.compositor.compositor_effects = [effect] as Array[CompositorEffect]
	_run.call_deferred()


func _run() -> void:
	await _looks()
	await _guides()
	await _motion()
	await _faults()
	print("%d failures" % failures)
	get_tree().quit(mini(failures, 100))


func _process(_delta: float) -> void:
	if is_moving:
		box.position += STEP


func _check(is_true: bool, what: String) -> void:
	print(("ok: " if is_true else "FAILED: ") + what)
	failures += 0 if is_true else 1


func _picture(frames := 4) -> Image:
	for frame in frames:
		await RenderingServer.frame_post_draw
	return get_viewport().get_texture().get_image()


func _dark(image: Image) -> int:
	var count := 0
	for y in image.get_height():
		for x in image.get_width():
			count += 1 if image.get_pixel(x, y).get_luminance() < 0.3 else 0
	return count


func _looks() -> void:
	effect.enabled = false
	_check(_dark(await _picture()) == 0, "the plain box is not seen")
	effect.enabled = true
	effect.look = "cartoon"
	effect.parameters = {"sigma_e": "2"}
	var lines := _dark(await _picture())
	_check(lines > 100 and lines < 4000, "lines are drawn around it: %d pixels" % lines)
	effect.parameters = {"sigma_e": "2", "line_color": "#ffffff"}
	_check(_dark(await _picture()) == 0, "lines have the colour that they are given")
	effect.parameters = {}
	get_window().size = SIZE * 2
	await _picture(6)
	var size := get_viewport().get_texture().get_size()
	var texels: int = effect.guide_data("depth").size() / 4
	_check(texels == int(size.x) * int(size.y), "guides follow the window's size: %d texels" % texels)
	get_window().size = SIZE
	await _picture(6)


func _guides() -> void:
	effect.parameters = {}
	await _picture()
	var size := get_viewport().get_texture().get_size()
	var middle := int(size.y / 2) * int(size.x) + int(size.x / 2)
	var depth: PackedByteArray = effect.guide_data("depth")
	_check(absf(depth.decode_float(middle * 4) - DISTANCE) < 0.01, "the box is %f away" % depth.decode_float(middle * 4))
	_check(depth.decode_float(0) == 0.0, "nothing is behind it")
	var normal: PackedByteArray = effect.guide_data("normal")
	var facing := Vector3(normal.decode_half(middle * 8), normal.decode_half(middle * 8 + 2), normal.decode_half(middle * 8 + 4))
	_check(facing.distance_to(Vector3.BACK) < 0.05, "the box faces the camera: %s" % facing)


func _motion() -> void:
	effect.parameters = {"steadiness": "1", "sigma_e": "2"}
	is_moving = true
	await _picture(5)
	var motion: PackedByteArray = effect.guide_data("motion")
	is_moving = false
	var size := get_viewport().get_texture().get_size()
	var middle := int(size.y / 2) * int(size.x) + int(size.x / 2)
	var moved := Vector2(motion.decode_float(middle * 8), motion.decode_float(middle * 8 + 4))
	var pixels := size.y / (2 * tan(deg_to_rad(75.0 / 2)) * DISTANCE)
	# Back to where it was, y downwards.
	var expected := Vector2(-STEP.x, STEP.y) * pixels
	_check(moved.distance_to(expected) < 0.1, "the box moved by %s pixels, %s was expected" % [moved, expected])
	effect.shot += 1
	var lines := _dark(await _picture())
	_check(lines > 50, "a cut is drawn: %d pixels of lines" % lines)


func _faults() -> void:
	effect.parameters = {"sigma_e": "2"}
	for look in ["cartoom", "look:travel_postr"]:
		effect.look = look
		_check(_dark(await _picture()) == 0, "%s leaves the picture as it is" % look)
	effect.look = "cartoon"
	effect.preset = "res://missing.json"
	_check(_dark(await _picture()) == 0, "a missing preset leaves the picture as it is")
	effect.preset = "res://tests/red.json"
	await _picture()
	effect.preset = ""
	_check(_dark(await _picture()) > 50, "the look is back")
