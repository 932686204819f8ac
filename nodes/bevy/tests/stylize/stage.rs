//! An application without a window, whose cameras draw into images.

use bevy::app::PluginsState;
use bevy::asset::AssetPlugin;
use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::settings::{InstanceFlags, WgpuSettings};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use isophote_bevy::{Look, Stylize, StylizePlugin};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

/// Size of pictures.
pub const SIZE: [u32; 2] = [320, 240];

/// Frames that a picture may take to come back.
const PATIENCE: usize = 400;

/// Frames after which all that a scene needs is there and drawn.
const WARM: usize = 6;

/// A scene without a window.
pub struct Stage {
    pub app: App,
    captured: Receiver<Image>,
    capture: Sender<Image>,
}

/// A picture in 8-bit sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub size: [u32; 2],
    /// Red, green, blue and alpha.
    pub texels: Vec<[u8; 4]>,
}

impl Picture {
    /// Share of texels that differ by more than `most` in a channel.
    pub fn differs(&self, other: &Self, most: u8) -> f32 {
        assert_eq!(self.size, other.size);
        let is_other = |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > most);
        let pairs = self.texels.iter().zip(&other.texels);
        pairs.filter(is_other).count() as f32 / self.texels.len() as f32
    }

    /// The part of a picture: left, top, width and height.
    pub fn part(&self, [left, top, width, height]: [u32; 4]) -> Self {
        let row = |y: u32| (left..left + width).map(move |x| self.texels[(y * self.size[0] + x) as usize]);
        Self { size: [width, height], texels: (top..top + height).flat_map(row).collect() }
    }
}

impl Stage {
    /// A stage whose assets are the files of a folder.
    pub fn new(assets: &Path) -> Self {
        let mut app = App::new();
        let windows =
            WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
        let files = AssetPlugin { file_path: assets.display().to_string(), ..default() };
        let settings = WgpuSettings { instance_flags: InstanceFlags::empty(), ..default() };
        let rendering = RenderPlugin {
            render_creation: settings.into(),
            synchronous_pipeline_compilation: true,
            ..default()
        };
        let plugins = DefaultPlugins.set(windows).set(files).set(rendering).disable::<WinitPlugin>();
        app.add_plugins((plugins, StylizePlugin));
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(16)));
        while app.plugins_state() == PluginsState::Adding {
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        app.finish();
        app.cleanup();
        let (capture, captured) = channel();
        let mut stage = Self { app, captured, capture };
        stage.light();
        stage
    }

    fn light(&mut self) {
        let turned = Transform::from_xyz(3.0, 5.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y);
        let light = DirectionalLight { illuminance: 9000.0, shadow_maps_enabled: false, ..default() };
        self.app.world_mut().spawn((light, turned));
    }

    /// Adds a thing of a colour.
    pub fn put(&mut self, mesh: Mesh, material: StandardMaterial, place: Transform) -> Entity {
        let world = self.app.world_mut();
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), place)).id()
    }

    /// A target for cameras.
    pub fn target(&mut self, [width, height]: [u32; 2]) -> Handle<Image> {
        let image = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
        self.app.world_mut().resource_mut::<Assets<Image>>().add(image)
    }

    /// Adds a camera that looks at the middle of the scene.
    pub fn camera(&mut self, target: &Handle<Image>) -> Entity {
        let place = Transform::from_xyz(0.0, 1.2, 5.0).looking_at(Vec3::ZERO, Vec3::Y);
        let target = RenderTarget::Image(target.clone().into());
        let backdrop =
            Camera { clear_color: ClearColorConfig::Custom(Color::srgb(0.7, 0.75, 0.8)), ..default() };
        let camera = (Camera3d::default(), backdrop, target, Msaa::Off, Tonemapping::None, place);
        self.app.world_mut().spawn(camera).id()
    }

    /// Has a camera stylized.
    pub fn stylize(&mut self, camera: Entity, look: Look) {
        let world = self.app.world_mut();
        let look = world.resource_mut::<Assets<Look>>().add(look);
        world.entity_mut(camera).insert(Stylize::new(look));
    }

    /// Draws so many frames.
    pub fn run(&mut self, frames: usize) {
        (0..frames).for_each(|_| self.app.update());
    }

    /// Draws until all is there, and then the picture of a target.
    pub fn picture(&mut self, target: &Handle<Image>) -> Picture {
        self.run(WARM);
        let capture = self.capture.clone();
        let send = move |captured: On<ScreenshotCaptured>| {
            let _ = capture.send(captured.image.clone());
        };
        self.app.world_mut().spawn(Screenshot::image(target.clone())).observe(send);
        for _ in 0..PATIENCE {
            self.app.update();
            if let Ok(image) = self.captured.try_recv() {
                let size = [image.width(), image.height()];
                let data = image.data.expect("a captured picture has texels");
                let texels = data.chunks_exact(4).map(|texel| [texel[0], texel[1], texel[2], texel[3]]);
                return Picture { size, texels: texels.collect() };
            }
        }
        panic!("no picture was captured in {PATIENCE} frames");
    }
}
