//! A turning scene in a look: `viewer [LOOK] [SCENE.gltf] [--picture FILE.png [--frames N] [--size WIDTHxHEIGHT]]`.
//!
//! Space takes the next look that ships, N the plain picture. With `--picture` there is no window: the last of some frames is written.

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::AssetPlugin;
use bevy::camera::RenderTarget;
use bevy::camera::primitives::Aabb;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use isophote_bevy::{Look, Stylize, StylizePlugin};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of the command line.
#[derive(Resource, Clone, Debug)]
struct Options {
    look: String,
    scene: Option<PathBuf>,
    picture: Option<PathBuf>,
    frames: u32,
    size: [u32; 2],
}

/// Mark of things that turn.
#[derive(Component)]
struct Turning;

/// The image that is written.
#[derive(Resource)]
struct Target(Handle<Image>);

/// Usage of the program.
const USAGE: &str = "say: viewer [LOOK] [SCENE.gltf] [--picture FILE.png [--frames N] [--size WIDTHxHEIGHT]]";

impl Options {
    fn read(arguments: impl Iterator<Item = String>) -> Option<Self> {
        let mut options = Self {
            look: "look:travel_poster".into(),
            scene: None,
            picture: None,
            frames: 48,
            size: [960, 540],
        };
        let mut arguments = arguments.peekable();
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--picture" => options.picture = Some(arguments.next()?.into()),
                "--frames" => options.frames = arguments.next()?.parse().ok()?,
                "--size" => {
                    let size = arguments.next()?;
                    let (width, height) = size.split_once('x')?;
                    options.size = [width.parse().ok()?, height.parse().ok()?];
                }
                scene if scene.ends_with(".gltf") || scene.ends_with(".glb") => {
                    options.scene = Some(std::path::absolute(scene).ok()?);
                }
                look if !look.starts_with('-') => options.look = look.to_owned(),
                _ => return None,
            }
        }
        Some(options)
    }
}

fn main() -> AppExit {
    let Some(options) = Options::read(std::env::args().skip(1)) else {
        eprintln!("{USAGE}");
        return AppExit::from_code(2);
    };
    let mut app = App::new();
    let folder = options.scene.as_deref().and_then(Path::parent).unwrap_or(Path::new(".")).to_owned();
    let files = AssetPlugin { file_path: folder.display().to_string(), ..default() };
    if options.picture.is_some() {
        let windows =
            WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
        let rendering = RenderPlugin { synchronous_pipeline_compilation: true, ..default() };
        app.add_plugins(DefaultPlugins.set(files).set(windows).set(rendering).disable::<WinitPlugin>())
            .add_plugins(ScheduleRunnerPlugin::run_loop(Duration::ZERO))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 24.0)))
            .add_systems(Update, capture);
    } else {
        app.add_plugins(DefaultPlugins.set(files)).add_systems(Update, choose);
    }
    app.add_plugins(StylizePlugin)
        .insert_resource(options)
        .add_systems(Startup, (setup_camera, setup_scene))
        .add_systems(Update, (turn, frame));
    app.run()
}

fn setup_camera(
    mut commands: Commands,
    options: Res<Options>,
    mut looks: ResMut<Assets<Look>>,
    mut images: ResMut<Assets<Image>>,
) -> Result {
    let look = looks.add(Look::named(&options.look)?);
    let place = Transform::from_xyz(0.0, 1.6, 4.2).looking_at(Vec3::new(0.0, 0.5, 0.0), Vec3::Y);
    let backdrop =
        Camera { clear_color: ClearColorConfig::Custom(Color::srgb(0.75, 0.8, 0.86)), ..default() };
    let mut camera = commands.spawn((
        Camera3d::default(),
        backdrop,
        Tonemapping::AcesFitted,
        Msaa::Sample4,
        place,
        Stylize::new(look),
    ));
    if options.picture.is_some() {
        let [width, height] = options.size;
        let image = images.add(Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None));
        camera.insert(RenderTarget::Image(image.clone().into()));
        commands.insert_resource(Target(image));
    }
    Ok(())
}

fn setup_scene(
    mut commands: Commands,
    options: Res<Options>,
    files: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let sun = Transform::from_xyz(3.0, 5.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((DirectionalLight { illuminance: 6000.0, shadow_maps_enabled: true, ..default() }, sun));
    let scene = options.scene.as_ref().and_then(|scene| scene.file_name()).and_then(|name| name.to_str());
    if let Some(scene) = scene {
        let scene = files.load(GltfAssetLabel::Scene(0).from_asset(scene.to_owned()));
        commands.spawn((WorldAssetRoot(scene), Turning));
        return;
    }
    let mut thing = |mesh: Mesh, color: Color, place: Transform| {
        let material = StandardMaterial { base_color: color, perceptual_roughness: 0.7, ..default() };
        (Mesh3d(meshes.add(mesh)), MeshMaterial3d(materials.add(material)), place)
    };
    let ground = Plane3d::default().mesh().size(30.0, 30.0).build();
    commands.spawn(thing(ground, Color::srgb(0.52, 0.6, 0.44), Transform::default()));
    let root = commands.spawn((Transform::default(), Visibility::default(), Turning)).id();
    let things = [
        thing(
            Torus::new(0.28, 0.62).mesh().build(),
            Color::srgb(0.85, 0.35, 0.22),
            Transform::from_xyz(-1.1, 0.62, 0.0).with_rotation(Quat::from_rotation_x(1.2)),
        ),
        thing(
            Cuboid::new(0.9, 1.3, 0.9).into(),
            Color::srgb(0.25, 0.5, 0.8),
            Transform::from_xyz(0.9, 0.65, -0.5),
        ),
        thing(
            Sphere::new(0.5).mesh().uv(48, 32),
            Color::srgb(0.92, 0.8, 0.35),
            Transform::from_xyz(0.15, 0.5, 0.8),
        ),
    ];
    for thing in things {
        commands.spawn((thing, ChildOf(root)));
    }
}

fn turn(mut things: Query<&mut Transform, With<Turning>>, time: Res<Time>) {
    for mut place in &mut things {
        place.rotate_y(time.delta_secs() * 0.5);
    }
}

/// Moves the camera to where a scene from a file fills the picture, once its things are there.
fn frame(
    mut cameras: Query<(&mut Transform, &mut Projection), With<Stylize>>,
    things: Query<(&Aabb, &GlobalTransform), With<Mesh3d>>,
    options: Res<Options>,
    mut is_framed: Local<bool>,
) {
    if *is_framed || options.scene.is_none() || things.is_empty() {
        return;
    }
    let corners = things.iter().flat_map(|(bounds, place)| {
        let [center, half] = [Vec3::from(bounds.center), Vec3::from(bounds.half_extents)];
        [-half, half].map(|half| place.transform_point(center + half))
    });
    let (least, most) = corners.fold((Vec3::MAX, Vec3::MIN), |(a, b), corner| (a.min(corner), b.max(corner)));
    let (middle, radius) = ((least + most) * 0.5, (most - least).length() * 0.5);
    for (mut place, mut projection) in &mut cameras {
        let from = middle + Vec3::new(0.35, 0.3, 1.0).normalize() * radius * 2.6;
        *place = Transform::from_translation(from).looking_at(middle, Vec3::Y);
        if let Projection::Perspective(lens) = &mut *projection {
            (lens.near, lens.far) = (radius * 0.01, radius * 20.0);
        }
    }
    *is_framed = true;
}

/// Takes another look by keys.
fn choose(
    keys: Res<ButtonInput<KeyCode>>,
    mut cameras: Query<&mut Stylize>,
    mut looks: ResMut<Assets<Look>>,
    mut next: Local<usize>,
) -> Result {
    for mut stylize in &mut cameras {
        if keys.just_pressed(KeyCode::KeyN) {
            stylize.enabled = !stylize.enabled;
        }
        if keys.just_pressed(KeyCode::Space) {
            let names: Vec<String> = Look::shipped().collect();
            let name = &names[*next % names.len()];
            *next += 1;
            info!("{name}");
            stylize.look = looks.add(Look::named(name)?);
        }
    }
    Ok(())
}

/// Writes the picture after the frames that were asked for, and ends.
fn capture(
    mut commands: Commands,
    options: Res<Options>,
    target: Res<Target>,
    mut frame: Local<u32>,
    mut exit: MessageWriter<AppExit>,
    files: Res<AssetServer>,
    scenes: Query<&WorldAssetRoot>,
) {
    if scenes.iter().any(|scene| !files.is_loaded_with_dependencies(&scene.0)) {
        return;
    }
    *frame += 1;
    let Some(picture) = options.picture.clone().filter(|_| *frame == options.frames) else {
        if *frame > options.frames + 60 {
            error!("no picture was captured");
            exit.write(AppExit::error());
        }
        return;
    };
    commands.spawn(Screenshot::image(target.0.clone())).observe(save_to_disk(picture)).observe(
        |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
            exit.write(AppExit::Success);
        },
    );
}
