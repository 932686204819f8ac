//! A scene as it is looked at: its camera, its light, its time. Nothing here lives on the graphics device.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;

use isophote_finishing::staging::ReadingArgs;
use isophote_pictures::material::{Material, MaterialKind};
use isophote_render::background::Background;
use isophote_render::lighting::Lighting as Light;
use isophote_scene::Scene;
use isophote_scene::animation::Animation;
use isophote_scene::camera::{self, Direction, Framing, Orbit, View, Viewpoint};
use isophote_scene::pose::Pose;

/// Camera, light and ground that a scene is shown with.
#[derive(Clone, Debug, Default)]
pub struct Staging {
    /// Framing of the scene by the default camera.
    pub framing: Framing,
    /// Node of the camera of the file that is looked through at first; the default camera otherwise.
    pub camera: Option<usize>,
    /// The light, as far as it can be changed.
    pub lighting: Lighting,
    /// True where the scene casts its shadow on an invisible ground.
    pub ground: bool,
    /// Options that the file was read with.
    pub reading: ReadingArgs,
}

/// Place of a camera, as the options of `render` say it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framed {
    /// By how many degrees it is turned to the right of where cameras are by default.
    pub azimuth: f32,
    /// Its height above the horizon in degrees.
    pub elevation: f32,
    /// Its distance over that from which the scene fills the picture.
    pub distance: f32,
    /// Point that it looks at, if that is not the middle of the scene.
    pub target: Option<Vec3>,
    /// Its vertical field of view in degrees, if it is not the usual one.
    pub fov: Option<f32>,
}

/// The light, as far as an artist changes it.
#[derive(Clone, Debug, Default)]
pub struct Lighting {
    /// Direction of the sun, seen from the camera as it stood at first, if it is not the usual one.
    pub sun: Option<Direction>,
    /// Brightness in stops.
    pub exposure: f32,
    /// Background of the scene, which lights it where it is a picture of the surroundings.
    pub background: Background,
    /// The file of that picture.
    pub surroundings: Option<PathBuf>,
}

impl PartialEq for Lighting {
    fn eq(&self, other: &Self) -> bool {
        is_same(&self.background, &other.background)
            && self.sun == other.sun
            && self.exposure == other.exposure
    }
}

/// True where two backgrounds are one.
pub fn is_same(a: &Background, b: &Background) -> bool {
    match (a, b) {
        (Background::Environment(a), Background::Environment(b)) => Arc::ptr_eq(a, b),
        (Background::Color(a), Background::Color(b)) => a == b,
        (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

/// A material that a scene's pictures lie on.
#[derive(Clone, Debug)]
pub struct OnScene {
    /// Its file, or the name of one that ships.
    pub name: PathBuf,
    /// The material.
    pub material: Arc<Material>,
}

/// A scene that is shown.
pub struct Scenery {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Pose of everything now.
    pub pose: Pose,
    /// Changes of an artist to the light.
    pub lighting: Lighting,
    /// True where the scene casts its shadow on an invisible ground.
    pub ground: bool,
    /// Options that the file was read with.
    pub reading: ReadingArgs,
    /// Paper and hatching that its pictures lie on, one of each kind.
    pub materials: Arc<[OnScene]>,
    /// True while time passes.
    pub playing: bool,
    /// Number of the animation that plays.
    pub animation: usize,
    light: Light,
    /// The camera that light was placed by.
    first_view: View,
    framing: Framing,
    viewpoint: Viewpoint,
    /// Node of the one that a key looks through.
    file_camera: Option<usize>,
    /// Camera and light that nobody would miss.
    kept: (Orbit, Lighting),
    time: f32,
    ticked: Instant,
}

impl Scenery {
    /// `scene` at rest, in a picture of this aspect.
    pub fn new(scene: Scene, staging: Staging, aspect: f32) -> Self {
        let Staging { framing, camera, lighting, ground, reading } = staging;
        let pose = Pose::at_rest(&scene);
        let viewpoint = Viewpoint { node: camera, orbit: Orbit::framing(&scene, aspect, framing) };
        let first_view = viewpoint.view(&scene, &pose);
        let mut scenery = Self {
            playing: !scene.animations.is_empty(),
            animation: 0,
            light: Light::default(),
            file_camera: camera.or_else(|| camera::file_camera(&scene)),
            kept: (viewpoint.orbit, lighting.clone()),
            first_view,
            framing,
            viewpoint,
            pose,
            lighting,
            ground,
            reading,
            materials: Arc::default(),
            time: 0.0,
            ticked: Instant::now(),
            scene: Arc::new(scene),
        };
        scenery.relight();
        scenery
    }

    /// Lays its pictures on a material of a kind, or on none.
    pub fn lie_on(&mut self, kind: MaterialKind, material: Option<OnScene>) {
        let others = self.materials.iter().filter(|own| own.material.kind() != kind).cloned();
        self.materials = others.chain(material).collect();
    }

    /// Takes over what has been changed of the light.
    pub fn relight(&mut self) {
        let Lighting { sun, exposure, background, .. } = &self.lighting;
        let rest = Pose::at_rest(&self.scene);
        let environment = background.environment();
        self.light = Light::for_scene(&self.scene, &rest, &self.first_view, *sun, environment);
        self.light.exposure *= exposure.exp2();
    }

    /// Sun and sky.
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// Direction of the sun, seen from the camera as it stood at first.
    pub fn sun(&self) -> Direction {
        self.sun_by(&self.first_view)
    }

    /// Direction of the sun, seen from a camera.
    fn sun_by(&self, view: &View) -> Direction {
        let to_sun: Vec3 = self.light.sun_direction;
        let azimuth = to_sun.x.atan2(to_sun.z) - view.azimuth();
        let turns = (azimuth / std::f32::consts::TAU).round();
        Direction {
            azimuth: azimuth - turns * std::f32::consts::TAU,
            elevation: to_sun.y.clamp(-1.0, 1.0).asin(),
        }
    }

    /// Starts or stops the animation.
    pub fn toggle_playing(&mut self) {
        self.playing = !self.playing && !self.scene.animations.is_empty();
        self.ticked = Instant::now();
    }

    /// Seconds since the beginning, and how long the animation is.
    pub fn time(&self) -> (f32, f32) {
        let length = self.scene.animations.get(self.animation).map_or(0.0, Animation::duration);
        (if length > 0.0 { self.time % length } else { 0.0 }, length)
    }

    /// Goes to a time and stays there.
    pub fn seek(&mut self, time: f32) {
        (self.time, self.playing) = (time.max(0.0), false);
        self.stand();
    }

    /// Lets everything stand where it is at the time.
    fn stand(&mut self) {
        let animation = (!self.scene.animations.is_empty()).then_some(self.animation);
        self.pose.update(&self.scene, animation, self.time);
    }

    /// Frames the whole scene.
    pub fn frame_all(&mut self, aspect: f32) {
        let orbit = Orbit::framing(&self.scene, aspect, self.framing);
        self.viewpoint = Viewpoint { node: None, orbit };
        self.kept.0 = orbit;
    }

    /// True where the light, or the camera that the mouse turns, is not as the scene was opened or framed, nor as it was kept.
    pub fn is_changed(&self) -> bool {
        let is_turned = self.viewpoint.node.is_none() && self.viewpoint.orbit != self.kept.0;
        is_turned || self.lighting != self.kept.1
    }

    /// Camera and light are kept elsewhere as they are now.
    pub fn keep(&mut self) {
        self.kept = (self.viewpoint.orbit, self.lighting.clone());
    }

    /// Nodes of the cameras of the file, with their names.
    pub fn cameras(&self) -> Vec<(usize, String)> {
        let names = camera::list_file_cameras(&self.scene);
        let node =
            |name: &String| camera::find_file_camera(&self.scene, name.split(' ').next().unwrap_or(name));
        names.iter().filter_map(|name| Some((node(name)?, name.clone()))).collect()
    }

    /// Node of the camera of the file that is looked through.
    pub fn camera(&self) -> Option<usize> {
        self.viewpoint.node
    }

    /// Looks through a camera of the file, or through one that the mouse turns.
    pub fn look_through(&mut self, node: Option<usize>) {
        if node.is_none() {
            self.orbit();
        }
        self.viewpoint.node = node;
    }

    /// Looks through the file's camera, where it has one.
    pub fn use_file_camera(&mut self) {
        self.viewpoint.node = self.file_camera;
    }

    /// The camera that the mouse turns. It takes over from where the file's camera stands.
    pub fn orbit(&mut self) -> &mut Orbit {
        let Viewpoint { node, orbit } = &mut self.viewpoint;
        if let Some(view) = node.take().and_then(|node| View::from_node(&self.scene, &self.pose, node)) {
            let offset = view.eye() - orbit.target;
            let distance = offset.length();
            if distance.is_finite() && distance > 0.0 {
                orbit.distance = distance;
                orbit.azimuth = offset.x.atan2(offset.z);
                orbit.elevation = (offset.y / distance).clamp(-1.0, 1.0).asin();
            }
        }
        orbit
    }

    /// Place of the camera that the mouse turns, in a picture of this aspect.
    pub fn framed(&self, aspect: f32) -> Framed {
        let usual = Framing::default();
        let orbit = &self.viewpoint.orbit;
        let framing = Framing {
            direction: Direction { azimuth: orbit.azimuth, elevation: orbit.elevation },
            distance: 1.0,
            target: None,
            ..self.framing
        };
        let fitting = Orbit::framing(&self.scene, aspect, framing);
        let azimuth = orbit.azimuth - usual.direction.azimuth;
        let aside = (fitting.target - orbit.target).length();
        Framed {
            azimuth: azimuth.to_degrees(),
            elevation: orbit.elevation.to_degrees(),
            distance: (orbit.distance / fitting.distance).clamp(0.1, 100.0),
            target: (aside > 1e-4 * orbit.distance).then_some(orbit.target),
            fov: (self.framing.vertical_fov != usual.vertical_fov)
                .then(|| self.framing.vertical_fov.to_degrees()),
        }
    }

    /// Direction of the sun, seen from the camera as it stands now, where a picture taken from there would have it
    /// elsewhere by itself.
    pub fn sun_from_here(&self) -> Option<Direction> {
        let rest = Pose::at_rest(&self.scene);
        let view = self.viewpoint.view(&self.scene, &rest);
        let environment = self.lighting.background.environment();
        let usual = Light::for_scene(&self.scene, &rest, &view, None, environment).sun_direction;
        if usual.abs_diff_eq(self.light.sun_direction, 1e-3) {
            return None;
        }
        Some(self.sun_by(&view))
    }

    /// Distance of the middle of the picture.
    pub fn distance(&self) -> f32 {
        (self.view().eye() - self.scene.bounds.center()).length()
    }

    /// Lets time pass.
    pub fn advance(&mut self) {
        if self.playing {
            self.time += self.ticked.elapsed().as_secs_f32();
            self.stand();
        }
        self.ticked = Instant::now();
    }

    /// View from where the camera is.
    pub fn view(&self) -> View {
        self.viewpoint.view(&self.scene, &self.pose)
    }
}
