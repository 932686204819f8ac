//! The window: a frame is drawn whenever the one before it has been shown.

use std::sync::Arc;
use std::time::Instant;

use isophote_files::desktop;
use isophote_files::error::{Error, Result};
use isophote_render::gpu::Gpu;
use isophote_render::present::Present;
use isophote_scene::Scene;
use isophote_scene::camera::{Orbit, Viewpoint};
use winit::application::ApplicationHandler;
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};

use crate::painter::Painter;

/// Way to mend a desktop that gives no window.
const FIX: &str = "start the example in a desktop session with a Vulkan driver, or give --frames DIR";
/// Radians by which the camera turns while the pointer moves by a pixel.
const TURN: f32 = 0.008;
/// Factor on the distance for each step of the wheel.
const STEP: f32 = 0.9;

/// Opens a window that shows the scene in a style until it is closed.
///
/// # Errors
/// [`Error::Input`] for scenes and styles that cannot be drawn, [`Error::Failure`] without a window or a device.
pub fn show(size: (u32, u32), scene: Scene, style: &str) -> Result<()> {
    let failed = |e| desktop::no_window(e, FIX);
    let event_loop = EventLoop::new().map_err(failed)?;
    let mut app =
        App { size, scene: Some(scene), style: style.to_owned(), stage: None, drag: None, failure: None };
    event_loop.run_app(&mut app).map_err(failed)?;
    app.failure.map_or(Ok(()), Err)
}

struct App {
    size: (u32, u32),
    /// The scene until there is a stage for it.
    scene: Option<Scene>,
    style: String,
    stage: Option<Stage>,
    /// Place of the pointer, while its button is down.
    drag: Option<Option<PhysicalPosition<f64>>>,
    /// Error that has ended the window.
    failure: Option<Error>,
}

/// Window, its device, and all that is drawn on it.
struct Stage {
    window: Arc<Window>,
    gpu: Gpu,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    painter: Painter,
    present: Present,
    started: Instant,
    frame: i64,
}

impl Stage {
    fn open(
        event_loop: &ActiveEventLoop,
        (width, height): (u32, u32),
        scene: Scene,
        style: &str,
    ) -> Result<Self> {
        let attributes = Window::default_attributes()
            .with_title(format!("Isophote - {style}"))
            .with_inner_size(PhysicalSize::new(width, height));
        let window = event_loop.create_window(attributes).map_err(|e| desktop::no_window(e, FIX))?;
        let window = Arc::new(window);
        let display = Box::new(event_loop.owned_display_handle());
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle_from_env(display);
        let instance = wgpu::Instance::new(descriptor);
        let surface = instance.create_surface(Arc::clone(&window)).map_err(|e| desktop::no_window(e, FIX))?;
        let gpu = Gpu::with_instance(instance, Some(&surface))?;
        let size = pixels(&window);
        let config = surface.get_default_config(&gpu.adapter, size.0, size.1);
        let config = config.ok_or_else(|| desktop::no_window("the adapter cannot draw on it", FIX))?;
        surface.configure(&gpu.device, &config);
        let camera = Viewpoint::of(&scene, size.0 as f32 / size.1 as f32);
        let painter = Painter::new(&gpu, scene, style, size, camera)?;
        let present = Present::new(&gpu.device, config.format, painter.picture());
        let started = Instant::now();
        Ok(Self { window, gpu, surface, config, painter, present, started, frame: 0 })
    }

    /// Takes over the size of the window.
    fn resize(&mut self) -> Result<()> {
        (self.config.width, self.config.height) = pixels(&self.window);
        self.surface.configure(&self.gpu.device, &self.config);
        self.painter.resize((self.config.width, self.config.height))?;
        self.gpu.check()
    }

    /// The camera that goes around the scene, through which it is seen from now on.
    fn steer(&mut self) -> &mut Orbit {
        self.painter.camera.node = None;
        &mut self.painter.camera.orbit
    }

    /// Draws a frame and shows it: scene, style and presentation are one submission.
    fn draw(&mut self) -> Result<()> {
        use wgpu::CurrentSurfaceTexture as Current;
        let shown = match self.surface.get_current_texture() {
            Current::Success(shown) | Current::Suboptimal(shown) => shown,
            Current::Timeout | Current::Occluded => return Ok(()),
            Current::Lost | Current::Outdated | Current::Validation => return self.resize(),
        };
        self.frame += 1;
        self.painter.go_to(self.started.elapsed().as_secs_f32());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.painter.encode(&mut encoder, self.frame)?;
        let surface = shown.texture.create_view(&Default::default());
        self.present.encode(&self.gpu.device, &mut encoder, self.painter.picture(), &surface);
        self.gpu.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.gpu.queue.present(shown);
        self.gpu.check()
    }
}

impl App {
    fn handle(&mut self, event_loop: &ActiveEventLoop, result: Result<()>) {
        if let Err(error) = result {
            self.failure.get_or_insert(error);
            event_loop.exit();
        }
    }

    fn point(&mut self, position: PhysicalPosition<f64>) {
        let (Some(stage), Some(before)) = (&mut self.stage, &mut self.drag) else { return };
        if let Some(before) = before {
            let [x, y] = [position.x - before.x, position.y - before.y].map(|way| way as f32 * TURN);
            stage.steer().rotate(-x, y);
        }
        *before = Some(position);
    }

    fn scroll(&mut self, delta: MouseScrollDelta) {
        let steps = match delta {
            MouseScrollDelta::LineDelta(_, lines) => lines,
            MouseScrollDelta::PixelDelta(way) => way.y as f32 / 100.0,
        };
        if let Some(stage) = &mut self.stage {
            stage.steer().zoom(STEP.powf(steps));
        }
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(scene) = self.scene.take() else { return };
        let opened = Stage::open(event_loop, self.size, scene, &self.style);
        let result = opened.map(|stage| {
            stage.window.request_redraw();
            self.stage = Some(stage);
        });
        self.handle(event_loop, result);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::CursorMoved { position, .. } => self.point(position),
            WindowEvent::MouseWheel { delta, .. } => self.scroll(delta),
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } => {
                self.drag = (state == ElementState::Pressed).then_some(None);
            }
            WindowEvent::Resized(_) => {
                let resized = self.stage.as_mut().map_or(Ok(()), Stage::resize);
                self.handle(event_loop, resized);
            }
            WindowEvent::RedrawRequested => {
                let drawn = self.stage.as_mut().map_or(Ok(()), Stage::draw);
                self.stage.iter().for_each(|stage| stage.window.request_redraw());
                self.handle(event_loop, drawn);
            }
            _ => {}
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // The device goes before the window that its surface belongs to.
        self.stage = None;
    }
}

/// Size of a window in pixels; one that is minimised has none, and targets have at least one.
fn pixels(window: &Window) -> (u32, u32) {
    let size = window.inner_size();
    (size.width.max(1), size.height.max(1))
}
