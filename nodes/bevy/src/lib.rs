//! Stylization of Bevy's cameras by Isophote's looks.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use isophote_bevy::{Look, Stylize, StylizePlugin};
//!
//! fn setup(mut commands: Commands, mut looks: ResMut<Assets<Look>>) -> Result {
//!     let look = looks.add(Look::named("look:travel_poster")?);
//!     commands.spawn((Camera3d::default(), Stylize::new(look)));
//!     Ok(())
//! }
//!
//! fn main() {
//!     App::new().add_plugins((DefaultPlugins, StylizePlugin)).add_systems(Startup, setup).run();
//! }
//! ```
//!
//! A camera with [`Stylize`] has its picture redrawn after tone mapping, in Bevy's render schedule, with Bevy's device and command
//! encoder: nothing leaves the graphics card. The prepasses of depth, normals and motion vectors, which the component asks for, are the
//! guides of the look. What Bevy's prepass leaves out, such as materials that blend, has no guides: its lines are found in its colours.
//!
//! Looks are assets: those that ship, styles by their names, and [presets](isophote::preset) in files that end in `.look.json`. A changed
//! file changes the picture while the program runs, where Bevy watches its assets.

mod component;
mod draw;
mod error;
mod guides;
mod images;
mod look;
mod present;
mod runner;
mod shaders;

pub use component::Stylize;
pub use error::Error;
pub use isophote;
pub use isophote::engine::program::Precision;
pub use look::{Look, LookLoader};

use bevy::app::{App, Plugin};
use bevy::asset::AssetApp;
use bevy::core_pipeline::schedule::{Core3d, Core3dSystems};
use bevy::core_pipeline::tonemapping::tonemapping;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};

/// Plugin that stylizes cameras with [`Stylize`]. Without a render world it does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct StylizePlugin;

impl Plugin for StylizePlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Look>().init_asset_loader::<LookLoader>().register_type::<Stylize>();
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
        render_app
            .init_resource::<draw::Drawings>()
            .add_systems(ExtractSchedule, component::extract)
            .add_systems(Render, draw::forget.in_set(RenderSystems::Cleanup))
            .add_systems(Core3d, draw::stylize.after(tonemapping).in_set(Core3dSystems::PostProcess));
    }
}
