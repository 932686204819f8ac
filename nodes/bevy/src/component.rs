//! The component of stylized cameras, and its way to the render world.

use crate::look::{Look, Style};
use bevy::asset::{Assets, Handle};
use bevy::camera::Camera;
use bevy::core_pipeline::prepass::{DepthPrepass, MotionVectorPrepass, NormalPrepass};
use bevy::ecs::prelude::*;
use bevy::reflect::Reflect;
use bevy::reflect::std_traits::ReflectDefault;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use bevy::time::Time;
use isophote::engine::program::Precision;
use std::sync::Arc;

/// Component that has the picture of a [`Camera3d`](bevy::camera::Camera3d) redrawn by a look.
///
/// Until the look is loaded, and where it cannot be drawn, which is logged, the picture stays as it is.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default, Clone)]
#[require(DepthPrepass, NormalPrepass, MotionVectorPrepass)]
pub struct Stylize {
    /// The look.
    pub look: Handle<Look>,
    /// False to show the plain picture, at no cost but that of the prepasses.
    pub enabled: bool,
    /// Frames a second in which marks that are redrawn by time are counted, and keyframes of presets; 24 unless set otherwise.
    pub frame_rate: f32,
    /// Number of the shot. Looks that are steady over time begin anew where it changes, as they must after a cut.
    pub shot: u32,
    /// Largest motion from frame to frame that is followed, in pixels of the viewport; longer ones are unknown. 128 unless
    /// set otherwise.
    pub max_motion: f32,
    /// Precision of images on the way: by default colours in half as many bytes, and lookups by samplers. `Exact` gives the numbers
    /// of the library's CPU executor.
    #[reflect(ignore, default = "fast")]
    pub precision: Precision,
}

fn fast() -> Precision {
    Precision::Fast
}

impl Stylize {
    /// The component for a look, with all else as it is unless set otherwise.
    pub fn new(look: Handle<Look>) -> Self {
        Self { look, ..Self::default() }
    }
}

impl Default for Stylize {
    fn default() -> Self {
        Self {
            look: Handle::default(),
            enabled: true,
            frame_rate: 24.0,
            shot: 0,
            max_motion: isophote::request::MAX_MOTION,
            precision: fast(),
        }
    }
}

/// The component as the render world has it: with the look itself.
#[derive(Component, Clone, Debug)]
pub(crate) struct Wanted {
    pub(crate) style: Arc<Style>,
    /// Number of the frame, in the component's frames a second.
    pub(crate) frame: i64,
    pub(crate) shot: u32,
    pub(crate) max_motion: f32,
    pub(crate) precision: Precision,
}

type Cameras<'w, 's> = Query<'w, 's, (RenderEntity, &'static Camera, Option<&'static Stylize>)>;

/// Tells the render world which cameras are stylized, and by what.
pub(crate) fn extract(
    mut commands: Commands,
    cameras: Extract<Cameras>,
    looks: Extract<Res<Assets<Look>>>,
    time: Extract<Option<Res<Time>>>,
) {
    for (entity, camera, stylize) in &cameras {
        let Ok(mut entity) = commands.get_entity(entity) else { continue };
        let stylize = stylize.filter(|stylize| stylize.enabled && camera.is_active);
        match stylize.and_then(|stylize| Some((stylize, looks.get(&stylize.look)?))) {
            Some((stylize, look)) => {
                let seconds = time.as_ref().map_or(0.0, |time| time.elapsed_secs_f64());
                entity.insert(Wanted {
                    style: Arc::clone(&look.style),
                    // No number is frame 0.
                    frame: (seconds * f64::from(stylize.frame_rate)) as i64,
                    shot: stylize.shot,
                    max_motion: stylize.max_motion,
                    precision: stylize.precision,
                });
            }
            None => {
                entity.remove::<Wanted>();
            }
        }
    }
}
