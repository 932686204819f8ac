//! A scene seen by a camera over a number of frames, rendered and stylized without a window.

use std::f32::consts::TAU;

use crate::apply::backend::Backend;
use crate::apply::materials;
use crate::directed::Directed;
use crate::processor::Processor;
use crate::read_back::ReadBack;
use crate::stylize::Stylizer;
use crate::stylize::style::Style;
use isophote_example::kernels::Kernels;
use isophote_example::plan_runner::ALL;
use isophote_files::error::Result;
use isophote_loader::Library;
use isophote_loader::catalogue::Kind;
use isophote_pictures::exr::{MATERIALS, MadeMatte, OBJECTS};
use isophote_pictures::floats::Picture;
use isophote_pictures::material::Material;
use isophote_pictures::meaning::ImageState;
use isophote_pictures::pixels::Pixels;
use isophote_render::background::Background;
use isophote_render::gpu::Gpu;
use isophote_render::lighting::Lighting;
use isophote_render::readback::Readback;
use isophote_render::renderer::Renderer;
use isophote_render::samples::{self, SAMPLES};
use isophote_render::targets::{Target, Targets};
use isophote_scene::Scene;
use isophote_scene::camera::{Direction, Framing, Orbit, View, Viewpoint};
use isophote_scene::pose::Pose;
use wgpu::util::DeviceExt;

/// Options of a shot, which say what is rendered of a scene.
#[derive(Clone, Debug)]
pub struct Options {
    /// Size of the pictures in pixels.
    pub size: (u32, u32),
    /// Number of the first frame, and of frames up to the last.
    pub range: (i64, u64),
    /// True where the camera turns once around the scene over all frames.
    pub turntable: bool,
    /// Framing of the scene by the default camera and by turntables.
    pub framing: Framing,
    /// Node of the camera of the file that is looked through, but for turntables; the default camera otherwise.
    pub camera: Option<usize>,
    /// Direction of the sun, seen from the camera, if it is not the usual one.
    pub light: Option<Direction>,
    /// Brightness in stops.
    pub exposure: f32,
    /// Background of the scene.
    pub background: Background,
    /// True where the scene casts its shadow on an invisible ground.
    pub ground: bool,
    /// The animation that plays.
    pub animation: Option<usize>,
    /// Time of frame 1 in seconds.
    pub start: f32,
    /// Frames per second.
    pub fps: f32,
    /// True where pictures are scene-referred, as they are before exposure and tone mapping.
    pub scene_referred: bool,
    /// True where rest positions are rendered whatever the style.
    pub rest_positions: bool,
    /// True where the control map of a scene that has one is rendered whatever the style.
    pub control: bool,
    /// True where colours of surfaces and their light are rendered, whatever the style.
    pub layers: bool,
    /// Backend that the style runs on; the renderer's device may be a driver that computes on the CPU.
    pub backend: Backend,
    /// Paper and hatching of the style.
    pub materials: Vec<Material>,
}

impl Options {
    /// State of the pictures.
    fn state(&self) -> ImageState {
        if self.scene_referred { ImageState::SceneReferred } else { ImageState::DisplayReferred }
    }
}

/// Style of a shot.
#[derive(Debug)]
pub struct Look<'l> {
    /// The library that it is of.
    pub library: &'l Library,
    /// The style.
    pub style: Style,
    /// Rules for things of the scene, which are followed on the CPU.
    pub directed: Option<Directed>,
}

impl Look<'_> {
    /// The style, and those that rules give to things.
    fn styles(&self) -> impl Iterator<Item = &Style> {
        let own = self.directed.iter().flat_map(Directed::looks).map(Processor::style);
        std::iter::once(&self.style).chain(own)
    }
}

/// A scene on a graphics device of its own.
pub struct Shot {
    options: Options,
    scene: Scene,
    pose: Pose,
    lighting: Lighting,
    camera: Viewpoint,
    /// Number of the frame drawn last, and what it was seen by.
    drawn: Option<(i64, View)>,
    gpu: Gpu,
    renderer: Renderer,
    finish: Finish,
    readback: Readback,
}

/// The way from what was rendered to the picture.
enum Finish {
    /// None: pictures are plain.
    Plain,
    /// A style on the renderer's device.
    Device(Box<Stylizer>),
    /// A style on the CPU.
    Cpu(Box<ReadBack>),
}

impl Finish {
    /// A style on what the renderer draws.
    fn of(look: Look<'_>, gpu: &Gpu, renderer: &Renderer, options: &Options) -> Result<Self> {
        let Look { library, style, directed } = look;
        let materials = materials::on_frame(&options.materials, options.size);
        if directed.is_some() || options.backend.is_cpu(gpu.is_software()) {
            let style = ReadBack::new(library, style, directed)?.with_materials(materials);
            return Ok(Self::Cpu(Box::new(style)));
        }
        let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
        let materials = materials.iter().map(|(name, pixels)| (*name, uploaded(gpu, pixels))).collect();
        let targets = (renderer.targets(), options.state());
        let stylizer = Stylizer::on_materials(&kernels, library, style, targets, materials)?;
        Ok(Self::Device(Box::new(stylizer)))
    }

    /// Frames before its own that a frame depends on.
    fn depth(&self) -> Result<usize> {
        match self {
            Self::Plain => Ok(0),
            Self::Device(stylizer) => Ok(stylizer.depth()),
            Self::Cpu(style) => style.depth(),
        }
    }

    fn wants_rest_positions(&self) -> Result<bool> {
        match self {
            Self::Plain => Ok(false),
            Self::Device(stylizer) => stylizer.wants_rest_positions(),
            Self::Cpu(style) => style.wants_rest_positions(),
        }
    }

    /// Takes the next frame for the first.
    fn forget(&mut self) {
        match self {
            Self::Plain => {}
            Self::Device(stylizer) => stylizer.forget(),
            Self::Cpu(style) => style.forget(),
        }
    }
}

impl Shot {
    /// Opens a device and makes everything ready.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for scenes and styles that cannot be drawn,
    /// [`isophote_files::error::Error::Failure`] without a device or when it fails.
    pub fn new(scene: Scene, look: Option<Look<'_>>, options: Options) -> Result<Self> {
        let gpu = Gpu::open()?;
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, options.size)?;
        renderer.set_background(&options.background, options.scene_referred)?;
        if options.ground {
            renderer.add_ground();
        }
        // Before the style, which asks for what is there.
        let (mut reads_control, mut reads_light) = (options.control, false);
        for (library, style) in look.iter().flat_map(|look| look.styles().map(|style| (look.library, style)))
        {
            reads_control |= style.can_use(Kind::Control)?;
            reads_light |= style.reads_light(library)?;
        }
        if reads_control {
            renderer.add_control(&scene)?;
        }
        // What is shown as it is has none, and styles then take it from the picture.
        if options.layers || reads_light && scene.is_lit() {
            renderer.add_layers(options.state());
        }
        let finish = look.map_or(Ok(Finish::Plain), |look| Finish::of(look, &gpu, &renderer, &options))?;
        if options.rest_positions || finish.wants_rest_positions()? {
            renderer.add_rest_positions();
        }
        gpu.check()?;
        let pose = Pose::at_rest(&scene);
        let camera = viewpoint(&options, &scene);
        let view = camera.view(&scene, &pose);
        let mut lighting =
            Lighting::for_scene(&scene, &pose, &view, options.light, options.background.environment());
        lighting.exposure *= options.exposure.exp2();
        let mut shot = Self {
            lighting,
            camera,
            readback: Readback::default(),
            drawn: None,
            options,
            scene,
            pose,
            gpu,
            renderer,
            finish,
        };
        shot.bind()?;
        Ok(shot)
    }

    /// Lets the style read what is rendered.
    fn bind(&mut self) -> Result<()> {
        let targets = self.renderer.targets();
        match &mut self.finish {
            Finish::Device(stylizer) => stylizer.bind(targets),
            Finish::Plain | Finish::Cpu(_) => Ok(()),
        }
    }

    /// Takes the pose and the view of a frame, drawn or not.
    fn go_to(&mut self, number: i64) -> View {
        let Options { animation, start, fps, range: (first, count), .. } = self.options;
        self.pose.update(&self.scene, animation, start + (number - 1) as f32 / fps);
        if self.options.turntable {
            let share = (number - first) as f32 / count as f32;
            return self.camera.orbit.turned(share * TAU).view();
        }
        self.camera.view(&self.scene, &self.pose)
    }

    /// Renders and stylizes the frame of a number. It does not depend on those drawn before: its motion is that
    /// from the frame of the number before it, and none in frame 1; where the style depends on frames before, those that
    /// were not drawn are drawn first. `progress` is told the share of a style on the CPU that is done.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device fails.
    pub fn draw(&mut self, number: i64, progress: &mut dyn FnMut(f32)) -> Result<Picture> {
        let follows = self.drawn.as_ref().is_some_and(|(drawn, _)| *drawn == number - 1);
        if number == 1 || !follows {
            let depth = self.finish.depth()? as i64;
            // Nothing comes before frame 1.
            let first = if number < 1 { number - depth } else { (number - depth).max(1) };
            self.finish.forget();
            self.begin_before(first);
            for before in first..number {
                self.encode(before)?;
            }
        }
        self.encode(number)?;
        let texture = match &mut self.finish {
            Finish::Plain => &self.renderer.targets().color_in(self.options.state()).texture,
            Finish::Device(stylizer) => stylizer.output().texture(),
            Finish::Cpu(style) => return style.picture(progress),
        };
        self.readback.read(&self.gpu, texture)
    }

    /// Lets the renderer know where everything was before a frame.
    fn begin_before(&mut self, number: i64) {
        if number == 1 {
            self.renderer.forget_motion();
        } else {
            let view = self.go_to(number - 1);
            self.renderer.pass_over(&self.scene, &self.pose, &view, &self.lighting);
        }
    }

    /// Renders and stylizes the frame that follows the last one.
    fn encode(&mut self, number: i64) -> Result<()> {
        let view = self.go_to(number);
        self.drawn = Some((number, view));
        let mut is_rebuilt = false;
        if let Finish::Device(stylizer) = &mut self.finish {
            stylizer.at_frame(number)?;
            is_rebuilt = stylizer.update()?;
        }
        if is_rebuilt {
            self.bind()?;
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.renderer.encode(&mut encoder, &self.scene, &self.pose, &view, &self.lighting);
        if let Finish::Device(stylizer) = &mut self.finish {
            stylizer.encode(&mut encoder, ALL)?;
        }
        self.gpu.queue.submit([encoder.finish()]);
        let targets = (self.renderer.targets(), self.options.state());
        match &mut self.finish {
            Finish::Cpu(style) => {
                style.take(&self.gpu, &mut self.readback, targets, number)?;
                if style.directed().is_some() { self.direct((number, view)) } else { Ok(()) }
            }
            Finish::Plain | Finish::Device(_) => Ok(()),
        }
    }

    /// Lets rules for things direct the frame that was encoded last. What is known of its pixels is that of the frame afterwards, too.
    fn direct(&mut self, (number, view): (i64, View)) -> Result<()> {
        let mut coverage = Vec::new();
        for sample in 0..SAMPLES {
            let numbers = self.sample(sample, &view)?;
            if let Finish::Cpu(style) = &self.finish
                && let Some(directed) = style.directed()
            {
                directed.count(&mut coverage, &numbers, SAMPLES);
            }
        }
        if let Finish::Cpu(style) = &mut self.finish {
            style.follow(&coverage);
        }
        self.begin_before(number);
        self.go_to(number);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.renderer.encode_motion(&mut encoder, &self.scene, &self.pose, &view, &self.lighting);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// Numbers of things that one of the samples of the frame drawn last shows.
    fn sample(&mut self, sample: u32, view: &View) -> Result<Vec<f32>> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let shown = (&self.scene, &self.pose, view, &self.lighting);
        self.renderer.encode_shifted(&mut encoder, shown, samples::shift(sample));
        self.gpu.queue.submit([encoder.finish()]);
        let numbers = self.readback.read(&self.gpu, &self.renderer.targets().object_id.texture)?;
        Ok(numbers.data)
    }

    /// View of the frame that was drawn last.
    pub fn view(&self) -> Option<&View> {
        self.drawn.as_ref().map(|(_, view)| view)
    }

    /// Data that the renderer knows of the pixels of the frame drawn last, as `choose` picks them; nothing where they
    /// were not rendered.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device fails.
    pub fn read(&mut self, choose: impl FnOnce(&Targets) -> Option<&Target>) -> Result<Option<Picture>> {
        let target = choose(self.renderer.targets());
        target.map(|target| self.readback.read(&self.gpu, &target.texture)).transpose()
    }

    /// Cryptomattes of the objects and of the materials of the frame drawn last; nothing before a frame was drawn. From then
    /// on, what is known of the pixels is that of another sample of them.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device fails.
    pub fn read_mattes(&mut self) -> Result<Vec<MadeMatte>> {
        let Some((_, view)) = self.drawn else { return Ok(Vec::new()) };
        let mut samples = Vec::with_capacity(SAMPLES as usize);
        for sample in 0..SAMPLES {
            let numbers = self.sample(sample, &view)?;
            samples.push(numbers.iter().map(|v| *v as u32).collect::<Vec<_>>());
        }
        let things = [(OBJECTS, self.scene.object_names()), (MATERIALS, self.scene.material_names())];
        let made =
            |(name, names): (_, Vec<String>)| MadeMatte::new(name, self.options.size, &samples, &names);
        Ok(things.map(made).into())
    }

    /// Pixels from where points of the frame drawn last are to where they will be in the frame that follows; nothing before
    /// a frame was drawn. From then on, what is known of the pixels has this motion.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device fails.
    pub fn read_motion_forward(&mut self) -> Result<Option<Picture>> {
        let Some((number, view)) = self.drawn else { return Ok(None) };
        let next = self.go_to(number + 1);
        self.renderer.pass_over(&self.scene, &self.pose, &next, &self.lighting);
        self.go_to(number);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.renderer.encode_motion(&mut encoder, &self.scene, &self.pose, &view, &self.lighting);
        self.gpu.queue.submit([encoder.finish()]);
        self.read(|targets| Some(&targets.motion))
    }
}

/// Camera that the pictures are taken from.
fn viewpoint(options: &Options, scene: &Scene) -> Viewpoint {
    let aspect = options.size.0 as f32 / options.size.1 as f32;
    if options.turntable {
        return Viewpoint { node: None, orbit: Orbit::turntable(scene, aspect, options.framing) };
    }
    Viewpoint { node: options.camera, orbit: Orbit::framing(scene, aspect, options.framing) }
}

/// A picture of RGBA as a texture.
fn uploaded(gpu: &Gpu, pixels: &Pixels) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: pixels.width(), height: pixels.height(), depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("material"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(&pixels.to_f32()),
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
