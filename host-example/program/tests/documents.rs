//! Documents of the window: what they hold is what `apply` hands to the library, and nothing that is opened ends the window.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use image::{DynamicImage, Rgb32FImage, Rgba32FImage};
use isophote_example::kernels::Kernels;
use isophote_example::plan_runner::{ALL, PlanRunner};
use isophote_finishing::apply::backend::Backend;
use isophote_finishing::apply::filter::{Filter, MaskedStyle};
use isophote_finishing::apply::frame_cache::{CachedFrame, Window};
use isophote_finishing::apply::memory::Budget;
use isophote_finishing::apply::square;
use isophote_finishing::stylize::style::Style;
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::history::Past;
use isophote_loader::{Control, Input, Library};
use isophote_pictures::exr::{Guide, Picture, Selection};
use isophote_pictures::pixels::{Pixels, Precision, Samples};
use isophote_pictures::read;
use isophote_pictures::space::Space;
use isophote_pictures::write::Format;
use isophote_render::gpu::Gpu;
use isophote_render::readback::Readback;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::stylizing::{Stylist, Task};
use isophote_window::state::document::frame::Frame;
use isophote_window::state::document::kind::Kind;
use isophote_window::state::look::EditedLook;

use crate::support::{self, assets, folder, has_ffmpeg, isophote, picture, succeeds};

/// This only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(60);

fn library() -> Library {
    Library::from_file(support::library()).expect("the library")
}

fn floats(width: u32, height: u32, channels: u32, data: Vec<f32>) -> Pixels {
    Pixels::new(width, height, channels, Samples::F32(data)).expect("as many numbers as pixels")
}

/// Result of the style on a frame, handed over as the window does, with these guides.
fn stylized(frame: &Frame, name: &str, (channels, precision): (u32, Precision)) -> Pixels {
    let library = library();
    let mut style = Style::load(&library, name, &[]).expect("a style");
    let usable = style.usable_guides(&library).expect("the library answers");
    let size = (frame.width, frame.height);
    let request = frame.request(style.request(&library, size).expect("a request"));
    let color = floats(size.0, size.1, 4, frame.color.as_flattened().to_vec());
    let wanted = frame.guides.iter().filter(|image| usable.contains(&image.guide));
    let guides: Vec<(&str, Pixels)> = wanted
        .map(|image| (image.guide.id(), floats(size.0, size.1, image.channels, image.data.clone())))
        .collect();
    let mut inputs = vec![Input { name: "color", pixels: &color }];
    inputs.extend(guides.iter().map(|(name, pixels)| Input { name, pixels }));
    let mut target = Pixels::zeroed(size.0, size.1, channels, precision);
    style.graph.process(None, &request, &inputs, &mut target, &mut Control::default()).expect("a result");
    target
}

/// Result of `apply` on a file, before it is put back into the primaries of the file.
fn applied(path: &Path, name: &str, space: Option<Space>, backend: Backend) -> Pixels {
    let library = library();
    let style = Style::load(&library, name, &[]).expect("a style");
    let wanted = style.usable_guides(&library).expect("the library answers");
    let mut source = read::read(path, &Selection { wanted, ..Selection::default() }).expect("a picture");
    square::make(&library, "picture", &mut source).expect("square pixels");
    let budget = Budget::new(u64::MAX, 1);
    let format = if source.exr.is_some() { Format::Exr } else { Format::Tiff };
    let own = Arc::new(CachedFrame::new(None, source, true, budget.share()));
    let exr = own.take_exr();
    let window = Window { frames: vec![Arc::clone(&own)], own };
    let mut filter =
        Filter::new(library, vec![MaskedStyle::whole(style)], backend, space, 0).expect("a filter");
    let filtered = filter.run("picture", &window, exr.as_ref(), format, &mut |_| {}).expect("a result");
    filtered.results.into_iter().next().expect("a picture")
}

/// A texture with numbers.
fn uploaded(gpu: &Gpu, (width, height): (u32, u32), channels: u32, data: &[f32]) -> wgpu::TextureView {
    let format = match channels {
        1 => wgpu::TextureFormat::R32Float,
        2 => wgpu::TextureFormat::Rg32Float,
        _ => wgpu::TextureFormat::Rgba32Float,
    };
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(width * channels * 4),
        rows_per_image: None,
    };
    let texture = gpu.device.create_texture(&descriptor);
    let bytes: Vec<u8> = data.iter().flat_map(|v| v.to_ne_bytes()).collect();
    gpu.queue.write_texture(texture.as_image_copy(), &bytes, layout, descriptor.size);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Result of the style on a frame, on a device of the host's own, as the window does it.
fn on_the_device(frame: &Frame, name: &str) -> Vec<f32> {
    let (library, gpu) = (library(), Gpu::open().expect("a graphics adapter"));
    let style = Style::load(&library, name, &[]).expect("a style");
    let usable = style.usable_guides(&library).expect("the library answers");
    let size = (frame.width, frame.height);
    let wanted: Vec<_> = frame.guides.iter().filter(|image| usable.contains(&image.guide)).collect();
    let names = wanted.iter().map(|image| image.guide.id());
    let guides = library.guide_bits(names).expect("the library knows them");
    let usual = style.request(&library, size).expect("a request");
    let request = frame.request(IsophoteRequest { guides, ..usual });
    let plan = style.named().plan(&library, &request, 0).expect("a plan");
    let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
    let mut runner = PlanRunner::new(&kernels, &plan, Past::default()).expect("the device works");
    let mut views = vec![("color", uploaded(&gpu, size, 4, frame.color.as_flattened()))];
    views.extend(wanted.iter().map(|g| (g.guide.id(), uploaded(&gpu, size, g.channels, &g.data))));
    let inputs: Vec<(&str, &wgpu::TextureView)> = views.iter().map(|(name, view)| (*name, view)).collect();
    runner.bind(&inputs).expect("the inputs fit");
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    runner.encode(&mut encoder, ALL).expect("the plan is complete");
    gpu.queue.submit([encoder.finish()]);
    let output = runner.output().expect("an output").texture();
    Readback::default().read(&gpu, output).expect("the device works").data
}

#[test]
fn a_device_of_the_windows_own_gives_what_apply_gives_on_one() {
    let folder = folder();
    let path = folder.path().join("light.tif");
    DynamicImage::from(bright(61, 47)).save(&path).expect("the folder is writable");
    rendered(folder.path(), "cube.####.exr");
    for path in [path, folder.path().join("cube.0002.exr")] {
        let frame =
            Document::open(&path, &Options::default()).expect("a picture").wait(1).expect("a picture");
        let expected = applied(&path, "cartoon", None, Backend::Gpu);
        let own = floats(frame.width, frame.height, 4, on_the_device(&frame, "cartoon"));
        assert_eq!(expected.channels(), 4);
        assert!(own.converted(expected.precision()) == expected, "{} is another picture", path.display());
    }
}

#[test]
fn the_cpu_gives_the_window_what_it_gives_apply() {
    let folder = folder();
    let path = folder.path().join("light.tif");
    DynamicImage::from(bright(61, 47)).save(&path).expect("the folder is writable");
    rendered(folder.path(), "cube.####.exr");
    let mut stylist = Stylist::new(library());
    let look = EditedLook::open(&library(), "cartoon".as_ref()).expect("a style");
    for (shot, path) in (1..).zip([path, folder.path().join("cube.0002.exr")]) {
        let frame =
            Document::open(&path, &Options::default()).expect("a picture").wait(1).expect("a picture");
        let size = (frame.width, frame.height);
        let expected = applied(&path, "cartoon", None, Backend::Cpu);
        let task = Task { look: look.clone(), frame, things: None, share: 1.0, size, shot };
        let own = stylist.stylize(&task, &mut Control::default()).expect("a result").expect("a picture");
        let own = own.converted(expected.precision());
        assert!(own == expected, "{} is another picture", path.display());
        // For the screen it is made smaller before, and the look's lengths with it.
        let task = Task { size: (size.0 / 2, size.1 / 2), ..task };
        let small = stylist.stylize(&task, &mut Control::default()).expect("a result").expect("a picture");
        assert_eq!((small.width(), small.height()), task.size);
        let mean = |pixels: &Pixels| {
            let numbers = pixels.to_f32();
            numbers.iter().sum::<f32>() / numbers.len() as f32
        };
        let [small, whole] = [mean(&small), mean(&own)];
        assert!((small - whole).abs() < 0.1 * whole.abs(), "{small} and {whole}");
        let cancelled = Control { cancelled: Some(&|| true), ..Control::default() };
        assert!(stylist.stylize(&task, &mut { cancelled }).expect("no failure").is_none());
    }
}

/// Opens a picture, and makes sure that the window's result is that of `apply`.
fn is_the_same(path: &Path, space: Option<Space>) -> Arc<Frame> {
    let options = Options { space, ..Options::default() };
    let document = Document::open(path, &options).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(document.kind(), Kind::Picture);
    let frame = document.wait(1).expect("a picture");
    // It reads colour, normals, depth and object numbers.
    let expected = applied(path, "cartoon", space, Backend::Cpu);
    let made = stylized(&frame, "cartoon", (expected.channels(), expected.precision()));
    let mut source = read::read(path, &Selection::default()).expect("a picture");
    square::make(&library(), "picture", &mut source).expect("square pixels");
    let Picture { own, meaning, .. } = &source.pictures[0];
    let made = match own {
        Some(own) => square::unmake(&library(), "picture", (own, meaning), &made).expect("the file's pixels"),
        None => made,
    };
    assert!(made == expected, "{} is another picture", path.display());
    frame
}

/// Red, green, blue and alpha of any kind, with light beyond white and what is no number.
fn bright(width: u32, height: u32) -> Rgba32FImage {
    let source = picture(width, height);
    Rgba32FImage::from_fn(width, height, |x, y| {
        let alpha = if x < width / 2 { 1.0 } else { y as f32 / height as f32 };
        let [r, g, b] = source.get_pixel(x, y).0.map(|v| f32::from(v) / 60.0 * alpha);
        image::Rgba([if x == 3 && y == 4 { f32::NAN } else { r }, g, b, alpha])
    })
}

#[test]
fn pictures_are_what_apply_hands_over() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let rgb = DynamicImage::from(picture(61, 47));
    let clear = DynamicImage::from(bright(61, 47));
    let save = |name: &str, picture: DynamicImage| picture.save(at(name)).expect("the folder is writable");
    save("rgb.png", rgb.clone());
    save("deep.png", rgb.to_rgb16().into());
    save("grey.png", rgb.to_luma8().into());
    save("clear.png", clear.to_rgba8().into());
    save("rgb.jpg", rgb.clone());
    save("clear.tif", clear.to_rgba16().into());
    save("light.tif", clear.clone());
    save("rgb.webp", rgb.clone());
    save(
        "light.hdr",
        DynamicImage::from(Rgb32FImage::from_fn(61, 47, |x, y| {
            image::Rgb(picture(61, 47).get_pixel(x, y).0.map(|v| f32::from(v) / 30.0))
        })),
    );
    for name in [
        "rgb.png",
        "deep.png",
        "grey.png",
        "clear.png",
        "rgb.jpg",
        "clear.tif",
        "light.tif",
        "rgb.webp",
        "light.hdr",
    ] {
        let frame = is_the_same(&at(name), None);
        assert_eq!((frame.width, frame.height, frame.number), (61, 47, None), "{name}");
    }
    let light = is_the_same(&at("light.tif"), Some(Space::Acescg));
    assert_eq!((light.request.space, light.replaced), (Space::Acescg, 1));
    is_the_same(&at("rgb.png"), Some(Space::Linear));
}

#[test]
fn cases_of_pixels_that_are_not_square_are_shown_as_square_ones() {
    let folder = folder();
    library();
    let case = support::root().join("tests/data/cases/pixel_aspect");
    let name = b"pixelAspectRatio\0float\0\x04\0\0\0";
    let bytes = fs::read(case.join("imp2.exr")).expect("the case");
    let at = bytes.windows(name.len()).position(|b| b == name).expect("an aspect") + name.len();
    for aspect in [2.0_f32, 0.5] {
        let path = folder.path().join(format!("{aspect}.exr"));
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&aspect.to_le_bytes());
        fs::write(&path, bytes).expect("the folder is writable");
        let source = read::read(&path, &Selection::default()).expect("a picture");
        let own = &source.pictures[0].pixels;
        let frame = is_the_same(&path, None);
        let shape = frame.width as f32 / frame.height as f32;
        assert_eq!(shape, own.width() as f32 / own.height() as f32 * aspect);
        // Looks at any size know how high full-size pixels are.
        let usual = library().request((1, 1)).expect("a request");
        assert_eq!(frame.request_of_all(1.0, usual).scale, frame.height as f32 / own.height() as f32);
    }
    if has_ffmpeg() {
        let document = Document::open(&case.join("sar.mp4"), &Options::default()).expect("a video");
        let frame = document.wait(1).expect("a frame");
        // 720 by 480 pixels that are 8 wide and 9 high.
        let shape = f64::from(frame.width) / f64::from(frame.height);
        assert!((shape - 4.0 / 3.0).abs() < 0.01, "{}x{}", frame.width, frame.height);
    }
}

/// A frame of the cube with everything that `render` knows.
fn rendered(folder: &Path, name: &str) -> PathBuf {
    let scene = support::cube(folder);
    let out = folder.join(name);
    succeeds(isophote().arg("render").arg(scene).arg(&out).args([
        "--size",
        "72x48",
        "--turntable",
        "--frames",
        "3",
    ]));
    out
}

#[test]
fn guides_are_found_by_their_names() {
    let folder = folder();
    let pattern = rendered(folder.path(), "cube.####.exr");
    let path = folder.path().join("cube.0002.exr");
    let frame = is_the_same(&path, None);
    let channels = |guide| frame.guide(guide).map(|image| image.channels);
    assert_eq!(channels(Guide::Normal), Some(4));
    assert_eq!(channels(Guide::Depth), Some(1));
    assert_eq!(channels(Guide::ObjectId), Some(1));
    assert_eq!(channels(Guide::Motion), Some(2));
    assert_eq!(channels(Guide::RestPosition), Some(4));
    assert!(frame.guides.iter().all(|image| image.data.len() == 72 * 48 * image.channels as usize));
    let document = Document::open(&path, &Options::default()).expect("a picture");
    let offers = &document.info().offers;
    assert_eq!(offers.layer, "");
    let names: Vec<(&str, bool)> = offers.layers.iter().map(|l| (l.name.as_str(), l.is_data)).collect();
    assert!(names.contains(&("", false)) && names.contains(&("N", true)), "{names:?}");
    let normal = offers.guides.iter().find(|(guide, _)| *guide == Guide::Normal).expect("normals");
    assert_eq!(normal.1, ["N.X", "N.Y", "N.Z"]);
    assert_eq!(document.info().sequence().as_deref(), Some(pattern.as_path()));
    // A layer of data is shown where that is insisted on.
    let layer = |force| {
        let selection = Selection { layer: Some("N".into()), force, ..Selection::default() };
        Document::open(&path, &Options { selection, ..Options::default() })
    };
    assert_eq!(layer(true).expect("normals").info().offers.layer, "N");
    assert!(layer(false).unwrap_err().to_string().contains("--force-layer"));
}

#[test]
fn real_files_are_what_apply_hands_over() {
    let Some(assets) = assets() else {
        eprintln!("\n*** SKIPPED: there are no assets beside the repository ***\n");
        return;
    };
    for name in [
        "exr/DisplayWindow/t05.exr",
        "exr/TestImages/BrightRingsNanInf.exr",
        "exr/TestImages/GammaChart.exr",
        "exr/LuminanceChroma/Flowers.exr",
    ] {
        is_the_same(&assets.join(name), None);
    }
    let beachball = assets.join("exr/Beachball/multipart.0001.exr");
    let document = Document::open(&beachball, &Options::default()).expect("a picture");
    let offers = &document.info().offers;
    let main =
        offers.layers.iter().find(|layer| layer.name == offers.layer).expect("the layer that was read");
    assert_eq!(main.views, ["right", "left"], "{offers:?}");
    let options = |view: &str| Options {
        selection: Selection { view: Some(view.into()), ..Selection::default() },
        ..Options::default()
    };
    let seen =
        |view: &str| Document::open(&beachball, &options(view)).expect("a view").wait(1).expect("a picture");
    assert!(seen("left").color != seen("right").color, "views are chosen");
    assert!(Document::open(&beachball, &options("middle")).is_err());
    for entry in fs::read_dir(assets.join("exr/Damaged")).expect("damaged files").flatten() {
        let path = entry.path();
        if let Err(error) = Document::open(&path, &Options::default()) {
            assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
        }
    }
}

#[test]
fn what_cannot_be_opened_says_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(64, 48).save(at("whole.png")).expect("the folder is writable");
    let bytes = fs::read(at("whole.png")).expect("a picture");
    fs::write(at("cut.png"), &bytes[..bytes.len() / 2]).expect("the folder is writable");
    fs::write(at("empty.exr"), "").expect("the folder is writable");
    fs::write(at("text.exr"), "text").expect("the folder is writable");
    fs::write(at("text.mp4"), "text").expect("the folder is writable");
    fs::create_dir(at("folder")).expect("the folder is writable");
    let refused = |name: &str, words: &[&str]| {
        let text = Document::open(&at(name), &Options::default()).expect_err(name).to_string();
        for word in words {
            assert!(text.contains(word), "{name} does not say '{word}': {text}");
        }
    };
    refused("missing.png", &["missing.png", "cannot be opened"]);
    refused("missing.####.png", &["matches no file"]);
    refused("folder", &["folder without numbered pictures"]);
    refused("cut.png", &["cut.png", "damaged"]);
    refused("empty.exr", &["empty.exr", "is empty"]);
    refused("text.exr", &["text.exr", "neither PNG"]);
    if has_ffmpeg() {
        refused("text.mp4", &["text.mp4", "ffmpeg"]);
    }
    let scene = support::cube(folder.path());
    let scene = Document::open(&scene, &Options::default()).expect("a scene");
    assert!(scene.kind() == Kind::Scene && scene.frames().is_none());
    assert!(scene.wait(1).unwrap_err().to_string().contains("is a scene"));
    let mut loading = Document::begin(at("whole.png"), Options::default());
    wait_until_some(|| loading.poll()).expect("a picture");
}

#[test]
fn large_pictures_are_loaded_beside_the_window() {
    let folder = folder();
    let path = folder.path().join("8k.jpg");
    let tile = picture(256, 256);
    let large = image::RgbImage::from_fn(7680, 4320, |x, y| *tile.get_pixel(x % 256, y % 256));
    large.save(&path).expect("the folder is writable");
    let started = Instant::now();
    let mut loading = Document::begin(path, Options::default());
    assert!(loading.poll().is_none(), "nobody waits for it");
    let document = wait_until_some(|| loading.poll()).expect("a picture");
    eprintln!("8K in {:.2} s", started.elapsed().as_secs_f64());
    let frame = document.wait(1).expect("a picture");
    assert_eq!((frame.width, frame.height, frame.bytes()), (7680, 4320, 7680 * 4320 * 16));
    // A header that asks for all memory.
    let huge = folder.path().join("huge.hdr");
    fs::write(&huge, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 90000 +X 90000\n")
        .expect("the folder is writable");
    let text = Document::open(&huge, &Options::default()).unwrap_err().to_string();
    assert!(text.contains("huge.hdr"), "{text}");
}

fn wait_until_some<T>(mut poll: impl FnMut() -> Option<T>) -> T {
    let started = Instant::now();
    loop {
        if let Some(value) = poll() {
            return value;
        }
        assert!(started.elapsed() < PATIENCE, "it does not come to that");
        std::thread::sleep(Duration::from_millis(2));
    }
}
