//! Frames that are rendered and stylized on one device: what they look like, and what they cost when warm.

use std::path::Path;
use std::sync::Arc;

use isophote_example::kernels::{Counts, Kernels};
use isophote_example::plan_runner::ALL;
use isophote_finishing::stylize::Stylizer;
use isophote_finishing::stylize::preset::Lengths;
use isophote_finishing::stylize::style::{Setting, Style};
use isophote_loader::abi::{ISOPHOTE_SPACE_LINEAR, IsophoteRequest};
use isophote_loader::{Control, Input, Library};
use isophote_pictures::floats::Picture;
use isophote_pictures::pixels::{Pixels, Precision, Samples};
use isophote_render::gpu::Gpu;
use isophote_render::lighting::Lighting;
use isophote_render::readback::Readback;
use isophote_render::renderer::Renderer;
use isophote_render::targets::Targets;
use isophote_scene::Scene;
use isophote_scene::camera::{Framing, Orbit};
use isophote_scene::pose::Pose;

use crate::support::{self, folder, isophote, listing, succeeds};

const SIZE: (u32, u32) = (96, 64);

/// A cube that turns before the camera.
struct Stage {
    gpu: Gpu,
    scene: Scene,
    pose: Pose,
    lighting: Lighting,
    orbit: Orbit,
    renderer: Renderer,
    library: Library,
}

/// A style whose lengths are pixels, since pictures here have few.
fn style(library: &Library, name: &str) -> Style {
    let mut style = Style::load(library, name, &[]).expect("the style is known");
    style.lengths = Lengths::Pixels;
    style
}

impl Stage {
    fn new(folder: &Path) -> Self {
        let gpu = Gpu::open().expect("a graphics adapter");
        let scene = Scene::load(&support::cube(folder), None).expect("the cube is a scene");
        let pose = Pose::at_rest(&scene);
        let orbit = Orbit::turntable(&scene, SIZE.0 as f32 / SIZE.1 as f32, Framing::default());
        let lighting = Lighting::for_scene(&scene, &pose, &orbit.view(), None, None);
        let renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, SIZE).expect("the scene fits");
        let library = Library::from_file(support::library()).expect("the library");
        Self { gpu, scene, pose, lighting, orbit, renderer, library }
    }

    fn stylizer(&self, kernels: &Arc<Kernels>, name: &str) -> Stylizer {
        let style = style(&self.library, name);
        let targets = self.renderer.targets();
        let mut stylizer = Stylizer::new(kernels, &self.library, style, targets).expect("the style fits");
        stylizer.bind(targets).expect("the targets fit");
        stylizer
    }

    /// One frame, as a viewer draws it: one encoder, one submission.
    fn frame(&mut self, stylizer: &mut Stylizer, angle: f32) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let view = self.orbit.turned(angle).view();
        self.renderer.encode(&mut encoder, &self.scene, &self.pose, &view, &self.lighting);
        stylizer.encode(&mut encoder, ALL).expect("the style can be recorded");
        self.gpu.queue.submit([encoder.finish()]);
    }

    fn read(&self, view: &wgpu::TextureView) -> Picture {
        Readback::default().read(&self.gpu, view.texture()).expect("the texture can be read")
    }
}

fn set(stylizer: &mut Stylizer, text: &str) -> bool {
    stylizer.set(&text.parse::<Setting>().expect("a setting")).expect("the setting is good");
    stylizer.update().expect("the style can be updated")
}

#[test]
fn a_warm_frame_makes_nothing_and_is_one_submission() {
    let folder = folder();
    let mut stage = Stage::new(folder.path());
    let kernels = Kernels::new(stage.gpu.device.clone(), stage.gpu.queue.clone());
    for style in ["cartoon", "blueprint"] {
        let mut stylizer = stage.stylizer(&kernels, style);
        stage.frame(&mut stylizer, 0.0);
        let before = kernels.counts();
        for frame in 1..5 {
            stylizer.update().expect("nothing is to be updated");
            stylizer.bind(stage.renderer.targets()).expect("the targets are the same");
            stage.frame(&mut stylizer, frame as f32 * 0.1);
        }
        // The submission is the host's own, with the scene in it; the library adds none.
        assert_eq!(kernels.counts(), before, "{style}");
        stage.gpu.wait().expect("the device works");
        // Moving a slider writes uniforms and nothing else.
        let picture = stage.read(stylizer.output());
        let slider = "tau=0.6";
        assert!(!set(&mut stylizer, slider), "{slider} changes the passes of {style}");
        assert_eq!(kernels.counts(), Counts { uploads: before.uploads + 1, ..before });
        stage.frame(&mut stylizer, 0.4);
        assert_ne!(stage.read(stylizer.output()), picture, "{slider} changes nothing");
    }
}

#[test]
fn structural_changes_and_other_sizes_are_taken_over() {
    let folder = folder();
    let mut stage = Stage::new(folder.path());
    let kernels = Kernels::new(stage.gpu.device.clone(), stage.gpu.queue.clone());
    let mut stylizer = stage.stylizer(&kernels, "flow_dog");
    let passes = |stylizer: &Stylizer| stylizer.plan().passes().expect("the plan has passes").len();
    let before = passes(&stylizer);
    assert!(set(&mut stylizer, "iterations=3"), "iterations are passes");
    assert!(passes(&stylizer) > before);
    stylizer.bind(stage.renderer.targets()).expect("the targets fit");
    stage.frame(&mut stylizer, 0.0);
    stage.renderer.resize((50, 70)).expect("the size fits");
    stylizer.resize((50, 70)).expect("the size fits");
    stylizer.bind(stage.renderer.targets()).expect("the targets fit");
    stage.frame(&mut stylizer, 0.0);
    let picture = stage.read(stylizer.output());
    assert_eq!((picture.width, picture.height, picture.channels), (50, 70, 1));
    stage.gpu.check().expect("the device reports nothing");
}

#[test]
fn the_hosts_device_gives_what_the_librarys_processor_gives() {
    let folder = folder();
    let mut stage = Stage::new(folder.path());
    let kernels = Kernels::new(stage.gpu.device.clone(), stage.gpu.queue.clone());
    for name in ["cartoon", "blueprint"] {
        let mut stylizer = stage.stylizer(&kernels, name);
        stage.frame(&mut stylizer, 0.3);
        let ours = stage.read(stylizer.output());
        let Targets { color, normal, depth, object_id, .. } = stage.renderer.targets();
        let inputs = [("color", color), ("normal", normal), ("depth", depth), ("object_id", object_id)].map(
            |(name, target)| {
                let Picture { width, height, channels, data } = stage.read(&target.view);
                let pixels = Pixels::new(width, height, channels as u32, Samples::F32(data));
                (name, pixels.expect("as many samples as pixels"))
            },
        );
        let inputs = inputs.each_ref().map(|(name, pixels)| Input { name, pixels });
        let mut style = style(&stage.library, name);
        let request = style.request(&stage.library, SIZE).expect("the size is possible");
        let request = IsophoteRequest { space: ISOPHOTE_SPACE_LINEAR, ..request };
        let mut theirs = Pixels::zeroed(SIZE.0, SIZE.1, 4, Precision::F32);
        style
            .graph
            .process(None, &request, &inputs, &mut theirs, &mut Control::default())
            .expect("the style can be computed");
        let far = ours.data.iter().zip(theirs.to_f32()).filter(|(a, b)| (*a - b).abs() > 0.01).count();
        // Soft steps and stream lines may go the other way at a few pixels.
        assert!(far * 100 <= ours.data.len(), "{name}: {far} of {} samples differ", ours.data.len());
    }
}

#[test]
fn frames_are_written_plain_and_stylized() {
    let folder = folder();
    let scene = support::cube(folder.path());
    let out = folder.path().join("out");
    std::fs::create_dir(&out).expect("the folder is writable");
    let render = |style: &str, name: &str, more: &[&str]| {
        let mut command = isophote();
        command.arg("render").arg(&scene).arg(out.join(name)).args(["--size", "64x48", "--style", style]);
        succeeds(command.args(more))
    };
    let open = |name: &str| image::open(out.join(name)).expect("a picture was written");
    render("none", "plain.png", &[]);
    for style in ["cartoon", "blueprint", "flow_dog"] {
        render(style, &format!("{style}.png"), &[]);
        assert_ne!(open("plain.png").into_rgb8(), open(&format!("{style}.png")).into_rgb8(), "{style}");
    }
    assert_eq!(open("flow_dog.png").color(), image::ColorType::L8, "scalars are grey");
    render("cartoon", "line.png", &["--set", "tau=0.5"]);
    render("cartoon", "turn.####.png", &["--frames", "3", "--turntable"]);
    assert_ne!(open("turn.0001.png"), open("turn.0002.png"));
    render("cartoon", "frame.exr", &[]);
    let exr = exr::prelude::read_first_flat_layer_from_file(out.join("frame.exr")).expect("an EXR file");
    for channel in &exr.layer_data.channel_data.list {
        assert!(channel.sample_data.values_as_f32().all(f32::is_finite));
    }
    assert_eq!(listing(&out).iter().filter(|n| n.starts_with("turn.")).count(), 3);
    assert!(listing(&out).iter().all(|n| !n.starts_with('.')), "temporary files are left");
}

#[test]
fn a_kernel_reads_textures_of_both_precisions_in_one_plan() {
    // Its levels are sampled in half precision, but for the one that the host gives.
    let nodes = ["--node", "painting", "--node", "cartoon"];
    let bench = ["bench", "--backend", "gpu", "--precision", "fast", "--size", "320x200", "--runs", "1"];
    succeeds(isophote().args(bench).args(nodes));
}
