//! The class that projects use: an effect of a compositor.

use crate::device::Device;
use crate::error::Error;
use crate::guides::{self, Pictures};
use crate::runner::Runner;
use godot::builtin::{GString, PackedByteArray, Rid, StringName, VarDictionary, Vector2i};
use godot::classes::compositor_effect::EffectCallbackType;
use godot::classes::{
    CompositorEffect, Engine, FileAccess, ICompositorEffect, RenderData, RenderSceneBuffersRd, Time,
};
use godot::global::godot_error;
use godot::obj::{Base, Gd, InstanceId, Singleton};
use godot::register::{GodotClass, godot_api};
use isophote::engine::program::Precision;
use isophote::guides::Guides;
use isophote::preset::{self, Settings};
use isophote::{ColourSpace, Graph, Request};
use std::collections::HashMap;

/// Frames that a viewport may stay undrawn before what is kept for it is given back.
const PATIENCE: i32 = 30;

/// A look on the viewports of a `Compositor`, in the Forward+ renderer.
#[derive(GodotClass)]
#[class(tool, base = CompositorEffect)]
pub(crate) struct IsophoteEffect {
    base: Base<CompositorEffect>,
    /// A style such as `cartoon`, or a look that ships, such as `look:travel_poster`.
    #[export]
    look: GString,
    /// A preset of Isophote, which takes the place of the look: `res://dusk.json`.
    #[export(file = "*.json")]
    preset: GString,
    /// Parameters by the names that presets have for them, and their values: `{"line_color": "#203040"}`.
    #[export]
    parameters: VarDictionary,
    /// Frames a second in which marks that are redrawn by time are counted, and keyframes of presets.
    #[export]
    frame_rate: f32,
    /// Number of the shot: looks that are steady over time begin anew where it changes.
    #[export]
    shot: i32,
    /// Largest motion from frame to frame that is followed, in pixels.
    #[export]
    max_motion: f32,
    /// True for viewports with a transparent background, whose alpha says how far a pixel is covered.
    #[export]
    transparent: bool,
    device: Option<Device>,
    /// The look as it was asked for last, and what it comes to; none where it is none.
    style: Option<(Asked, Option<(Graph, Settings)>)>,
    /// By viewport and view.
    viewports: HashMap<(InstanceId, u32), Viewport>,
}

/// Properties that name a look.
#[derive(Clone, PartialEq)]
struct Asked {
    look: String,
    preset: String,
    parameters: Vec<(String, String)>,
}

/// State of a view of a viewport.
struct Viewport {
    /// None where the look could not be drawn; it is tried again when something else is wanted.
    runner: Option<Runner>,
    asked: Asked,
    request: Request,
    shot: i32,
    /// Number of the frame that it was drawn in last.
    drawn: i32,
}

#[godot_api]
impl ICompositorEffect for IsophoteEffect {
    fn init(base: Base<CompositorEffect>) -> Self {
        let mut effect = base.to_init_gd();
        effect.set_effect_callback_type(EffectCallbackType::POST_TRANSPARENT);
        effect.set_access_resolved_color(true);
        effect.set_access_resolved_depth(true);
        effect.set_needs_normal_roughness(true);
        effect.set_needs_motion_vectors(true);
        Self {
            base,
            look: "look:travel_poster".into(),
            preset: GString::new(),
            parameters: VarDictionary::new(),
            frame_rate: 24.0,
            shot: 0,
            max_motion: isophote::request::MAX_MOTION,
            transparent: false,
            device: None,
            style: None,
            viewports: HashMap::new(),
        }
    }

    fn render_callback(&mut self, _kind: i32, data: Option<Gd<RenderData>>) {
        let Some(data) = data else { return };
        let Some(buffers) = data.get_render_scene_buffers() else { return };
        let Ok(buffers) = buffers.try_cast::<RenderSceneBuffersRd>() else { return };
        let Some(scene) = data.get_render_scene_data() else { return };
        let Vector2i { x, y } = buffers.get_internal_size();
        let (Ok(width), Ok(height)) = (u32::try_from(x), u32::try_from(y)) else { return };
        if width == 0 || height == 0 {
            return;
        }
        if self.device.is_none() {
            self.device = Device::of_renderer();
        }
        let Some(mut device) = self.device.take() else { return };
        for view in 0..buffers.get_view_count() {
            let pictures = Pictures {
                color: buffers.get_color_layer(view),
                depth: buffers.get_depth_layer(view),
                normal: normals(&buffers, view),
                velocity: Some(buffers.get_velocity_layer(view)).filter(Rid::is_valid),
                projection: scene.get_view_projection(view),
                size: [width, height],
                is_transparent: self.transparent,
            };
            self.draw(&mut device, (buffers.instance_id(), view), &pictures);
        }
        self.forget(&mut device);
        self.device = Some(device);
    }
}

#[godot_api]
impl IsophoteEffect {
    /// The guide of a look as the last frame of a viewport had it, for tools: `normal` (four 16-bit floats a pixel), `depth` (a
    /// 32-bit float) or `motion` (two). Waits for the device; empty where nothing was drawn.
    #[func]
    fn guide_data(&mut self, name: GString) -> PackedByteArray {
        let name = name.to_string();
        let mut runners = self.viewports.values().filter_map(|viewport| viewport.runner.as_ref());
        let image = runners.find_map(|runner| runner.last(&name));
        let read = |(image, device): (Rid, &mut Device)| device.read(image);
        image.zip(self.device.as_mut()).map(read).unwrap_or_default()
    }
}

impl IsophoteEffect {
    /// Stylizes a view. Where that fails its picture stays, and the error is printed once.
    fn draw(&mut self, device: &mut Device, key: (InstanceId, u32), pictures: &Pictures) {
        let asked = self.asked();
        let Some((graph, settings)) = self.opened(&asked) else { return };
        let seconds = Time::singleton().get_ticks_usec() as f64 * 1e-6;
        let request = Request {
            space: ColourSpace::Linear,
            guides: Guides {
                depth: true,
                normal: pictures.normal.is_some(),
                motion: pictures.velocity.is_some(),
                ..Guides::NONE
            },
            // No number is frame 0.
            frame: (seconds * f64::from(self.frame_rate)) as i64,
            reference_height: settings.lengths().reference_height(),
            max_motion: self.max_motion,
            ..Request::new(pictures.size[0], pictures.size[1])
        };
        let (shot, drawn) = (self.shot, Engine::singleton().get_frames_drawn());
        let viewport = self.viewports.entry(key).or_insert_with(|| Viewport {
            runner: None,
            // Nothing yet, so that it is tried.
            asked: Asked { look: String::new(), preset: String::new(), parameters: Vec::new() },
            request,
            shot,
            drawn,
        });
        if let Err(e) = viewport.stylize(device, (&asked, graph, &settings), request, shot, pictures) {
            godot_error!("a viewport is not stylized: {e}");
            if let Some(mut runner) = viewport.runner.take() {
                runner.free(device);
            }
        }
        (viewport.asked, viewport.request, viewport.shot, viewport.drawn) = (asked, request, shot, drawn);
    }

    fn asked(&self) -> Asked {
        let parameters = self.parameters.iter_shared();
        Asked {
            look: self.look.to_string(),
            preset: self.preset.to_string(),
            parameters: parameters.map(|(name, value)| (name.to_string(), value.to_string())).collect(),
        }
    }

    /// The look that is asked for; none where it is none, which is printed once.
    fn opened(&mut self, asked: &Asked) -> Option<(Graph, Settings)> {
        if self.style.as_ref().is_none_or(|(earlier, _)| earlier != asked) {
            let opened = open(asked).inspect_err(|e| godot_error!("a viewport is not stylized: {e}")).ok();
            self.style = Some((asked.clone(), opened));
        }
        self.style.as_ref()?.1.clone()
    }

    /// Gives back what is kept for viewports that are drawn no longer.
    fn forget(&mut self, device: &mut Device) {
        let now = Engine::singleton().get_frames_drawn();
        self.viewports.retain(|_, viewport| {
            let is_drawn = now - viewport.drawn <= PATIENCE;
            if !is_drawn && let Some(runner) = &mut viewport.runner {
                runner.free(device);
            }
            is_drawn
        });
    }
}

impl Drop for IsophoteEffect {
    fn drop(&mut self) {
        if let Some(device) = &mut self.device {
            self.viewports
                .values_mut()
                .filter_map(|viewport| viewport.runner.as_mut())
                .for_each(|r| r.free(device));
        }
    }
}

impl Viewport {
    fn stylize(
        &mut self,
        device: &mut Device,
        (asked, mut graph, settings): (&Asked, Graph, &Settings),
        request: Request,
        shot: i32,
        pictures: &Pictures,
    ) -> Result<(), Error> {
        let is_edited = *asked != self.asked;
        let is_other = is_edited || Request { frame: self.request.frame, ..request } != self.request;
        settings.at_frame(&mut graph, request.frame)?;
        graph.set_precision(Precision::Half);
        match &mut self.runner {
            Some(runner) => {
                if shot != self.shot {
                    runner.cut();
                }
                let graph = (is_edited || request.frame != self.request.frame).then_some(graph);
                runner.follow(device, graph, request)?;
            }
            None if is_other => self.runner = Some(Runner::new(device, graph, request)?),
            None => return Ok(()),
        }
        let Some(runner) = &mut self.runner else { return Ok(()) };
        guides::write(device, pictures, &runner.targets())?;
        let stylized = runner.run(device)?;
        guides::present(device, stylized, pictures)
    }
}

/// The normals of a view, where the renderer has drawn any.
fn normals(buffers: &Gd<RenderSceneBuffersRd>, view: u32) -> Option<Rid> {
    let [context, name] = ["forward_clustered", "normal_roughness"].map(StringName::from);
    let has = buffers.has_texture(&context, &name);
    has.then(|| buffers.get_texture_slice(&context, &name, view, 0, 1, 1)).filter(Rid::is_valid)
}

/// The graph of a look with its parameters.
fn open(asked: &Asked) -> Result<(Graph, Settings), Error> {
    let (mut graph, mut settings) = if asked.preset.is_empty() {
        preset::open(&asked.look)?
    } else {
        let json = FileAccess::get_file_as_string(&asked.preset).to_string();
        if json.is_empty() {
            return Err(Error::File(asked.preset.clone()));
        }
        preset::open_json(&asked.preset, &json, None)?
    };
    for (name, value) in &asked.parameters {
        settings.set(&mut graph, name, value)?;
    }
    Ok((graph, settings))
}
