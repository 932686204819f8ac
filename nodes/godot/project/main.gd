## A few things in a look. Space takes the next one of some looks.
##
## godot --path project -- [--look NAME] [--picture FILE.png] [--frames N]: with a picture the last frame is written, and the program ends.
extends Node3D

const LOOKS := ["look:travel_poster", "cartoon", "look:fineliner", "watercolor", "ink"]

var effect: CompositorEffect
var picture := ""
var frames := 12
var turning := Node3D.new()


func _ready() -> void:
	effect = ClassDB.instantiate("IsophoteEffect")
	if effect == null:
		push_error("the extension is not loaded: build it into res://addons/isophote")
		get_tree().quit(1)
		return
	var arguments := OS.get_cmdline_user_args()
	for at in range(0, arguments.size() - 1, 2):
		match arguments[at]:
			"--look": effect.look = arguments[at + 1]
			"--picture": picture = arguments[at + 1]
			"--frames": frames = int(arguments[at + 1])
	add_child(turning)
	_add_things()
	var camera := Camera3D.new()
	add_child(camera)
	camera.look_at_from_position(Vector3(0, 1.7, 4.4), Vector3(0, 0.5, 0))
	camera.compositor = Compositor.new()
	camera.compositor.compositor_effects = [effect] as Array[CompositorEffect]


func _add_things() -> void:
	var environment := WorldEnvironment.new()
	environment.environment = Environment.new()
	environment.environment.background_mode = Environment.BG_COLOR
	environment.environment.background_color = Color(0.55, 0.68, 0.8)
	environment.environment.ambient_light_source = Environment.AMBIENT_SOURCE_COLOR
	environment.environment.ambient_light_color = Color(0.6, 0.65, 0.75)
	environment.environment.ambient_light_energy = 0.6
	add_child(environment)
	var sun := DirectionalLight3D.new()
	add_child(sun)
	sun.look_at_from_position(Vector3(3, 5, 4), Vector3.ZERO)
	sun.shadow_enabled = true
	var ground := PlaneMesh.new()
	ground.size = Vector2(30, 30)
	_add(self, ground, Color(0.45, 0.55, 0.36), Vector3.ZERO)
	_add(turning, TorusMesh.new(), Color(0.85, 0.3, 0.18), Vector3(-1.2, 0.5, 0)).rotation.x = 1.2
	var box := BoxMesh.new()
	box.size = Vector3(0.9, 1.3, 0.9)
	_add(turning, box, Color(0.2, 0.45, 0.8), Vector3(1.1, 0.65, -0.5))
	_add(turning, SphereMesh.new(), Color(0.9, 0.75, 0.3), Vector3(0.3, 0.5, 1.0))


func _add(parent: Node3D, mesh: PrimitiveMesh, color: Color, place: Vector3) -> MeshInstance3D:
	var material := StandardMaterial3D.new()
	material.albedo_color = color
	mesh.material = material
	var thing := MeshInstance3D.new()
	thing.mesh = mesh
	thing.position = place
	parent.add_child(thing)
	return thing


func _process(delta: float) -> void:
	turning.rotate_y(0.01 if picture != "" else delta * 0.5)
	if Input.is_action_just_pressed("ui_accept"):
		effect.look = LOOKS[(LOOKS.find(effect.look) + 1) % LOOKS.size()]
	if picture != "" and Engine.get_frames_drawn() >= frames:
		var image := get_viewport().get_texture().get_image()
		var status := image.save_png(picture)
		get_tree().quit(0 if status == OK else 1)
		picture = ""
