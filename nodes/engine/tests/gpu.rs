//! The GPU executor: same results as the CPU's, tiles, warm runs, devices of hosts, errors.
#![cfg(feature = "gpu")]

mod textures;

use crate::support::{self, BOX, BoxParams, box_blur, describe, noise, plan, shift, worst};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::gpu::{Device, Executor, Options, wgpu};
use isophote_engine::program::Program;
use isophote_engine::{Class, Error, Image, Kernel, Plan, PlanBuilder, Rect, Support};
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use textures::{download, texture, upload, view};

/// A device, or `None` where there is none and none was required.
fn device() -> Option<Arc<Device>> {
    match Device::open(&Options { timestamps: true, ..Options::default() }) {
        Ok(device) => Some(device),
        Err(Error::NoDevice(e)) if std::env::var_os("ISOPHOTE_REQUIRE_GPU").is_none_or(|v| v != "1") => {
            // Straight to the stream: the test harness swallows what is printed.
            let _ = writeln!(std::io::stderr(), "SKIPPED a GPU test: {e}");
            None
        }
        Err(e) => panic!("a GPU is required: {e}"),
    }
}

fn on_cpu(plan: &Plan, source: &Image, region: Rect) -> Vec<Image> {
    CpuExecutor::new().run(plan, &[("source", source)], region, &CallingThread, Control::default()).unwrap()
}

fn on_gpu(executor: &mut Executor, plan: &Plan, source: &Image, region: Rect) -> Vec<Image> {
    executor.run_images(plan, &[("source", source)], region, Control::default()).unwrap()
}

#[test]
fn both_executors_agree() {
    let Some(device) = device() else { return };
    let mut executor = Executor::new(device);
    for (width, height) in [(1, 1), (7, 5), (67, 43)] {
        let plan = plan(width, height, 1.5);
        let source = noise(width, height, 4);
        let whole = Rect::of_size(width, height);
        let part = Rect { x0: whole.x1 / 3, y0: whole.y1 / 4, ..whole };
        for region in [whole, part] {
            let (cpu, gpu) = (on_cpu(&plan, &source, region), on_gpu(&mut executor, &plan, &source, region));
            assert_eq!(gpu.len(), 3);
            for (c, g) in cpu.iter().zip(&gpu) {
                assert!(worst(c, g) < 2e-5, "{width}x{height} {region:?}: {}", worst(c, g));
            }
        }
    }
}

#[test]
fn three_channels_travel_as_four() {
    let Some(device) = device() else { return };
    let mut b = PlanBuilder::new(19, 11).unwrap();
    let source = b.input("source", 3, Class::Colour);
    let brightness = b.pass_at(&support::SPLIT, &[source], &(), &[Class::Field; 2], Support::Pixels(0), 0);
    let position = b.sibling(brightness, 1);
    let joined = b.pass(
        &support::JOIN,
        &[brightness, position],
        &support::JoinParams { scale: 1.0 },
        Class::Colour,
        Support::Pixels(1),
    );
    b.output("joined", joined);
    let plan = b.finish().unwrap();
    let source = noise(19, 11, 3);
    let region = Rect { x0: 3, y0: 2, x1: 18, y1: 11 };
    let (cpu, gpu) =
        (on_cpu(&plan, &source, region), on_gpu(&mut Executor::new(device), &plan, &source, region));
    assert_eq!(gpu[0].channels(), 3);
    assert!(worst(&cpu[0], &gpu[0]) < 1e-5);
}

#[test]
fn tiles_equal_the_whole() {
    let Some(device) = device() else { return };
    let plan = plan(203, 151, 1.0);
    let source = noise(203, 151, 4);
    let region = Rect { x0: 5, y0: 3, x1: 203, y1: 150 };
    let mut executor = Executor::new(Arc::clone(&device));
    let whole = on_gpu(&mut executor, &plan, &source, region);
    let submissions = device.counts().submissions;
    // By the side of a texture, and by memory.
    for (side, budget) in [(90, u64::MAX), (u32::MAX, 2 << 20)] {
        executor.set_limits(side, budget);
        let before = device.counts();
        let tiled = on_gpu(&mut executor, &plan, &source, region);
        let after = device.counts();
        assert!(after.submissions - before.submissions >= 4, "nothing was cut");
        // All tiles run in the textures of one program; two of them are on their way at once, each with a buffer for either way.
        assert_eq!(after.textures, before.textures);
        assert!(after.buffers <= before.buffers + 2);
        assert_eq!(tiled, whole);
        on_gpu(&mut executor, &plan, &source, region);
        assert_eq!((device.counts().textures, device.counts().buffers), (after.textures, after.buffers));
    }
    assert_eq!(submissions, 1);
    executor.set_limits(24, u64::MAX);
    let refused = executor.run_images(&plan, &[("source", &source)], region, Control::default());
    assert!(matches!(refused, Err(Error::Geometry(_))), "{refused:?}");
}

#[test]
fn much_work_is_cut() {
    let Some(device) = device() else { return };
    let plan = plan(203, 151, 1.0);
    let source = noise(203, 151, 4);
    let region = Rect::of_size(203, 151);
    let operations: Vec<f64> = Program::lower(&plan, region).unwrap().operations(&plan).collect();
    let most = operations.iter().copied().fold(0.0, f64::max);
    let mut executor = Executor::new(Arc::clone(&device));
    let mut submissions = |work: f64| {
        executor.set_work(work);
        let before = device.counts().submissions;
        let result = on_gpu(&mut executor, &plan, &source, region);
        (result, device.counts().submissions - before)
    };
    let (whole, one) = submissions(f64::INFINITY);
    assert_eq!(one, 1);
    // Every dispatch is allowed, but not all of them in one submission.
    let (parts, several) = submissions(1.5 * most);
    assert!(several > 1 && several <= operations.len() as u64, "{several}");
    assert_eq!(parts, whole);
    // The dearest dispatch is too much for one.
    let (tiles, many) = submissions(0.3 * most);
    assert!(many > several, "{many}");
    assert_eq!(tiles, whole);
    // No tile is so little work: it is done all the same.
    let (tiles, _) = submissions(1.0);
    assert_eq!(tiles, whole);
}

#[test]
fn what_reads_everything_is_not_cut() {
    let Some(device) = device() else { return };
    let mut b = PlanBuilder::new(80, 60).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let mean = b.pass(&BOX, &[source], &BoxParams { radius: 1, gain: 1.0 }, Class::Colour, Support::Global);
    b.output("mean", mean);
    let plan = b.finish().unwrap();
    let mut executor = Executor::new(device);
    executor.set_limits(64, u64::MAX);
    let source = noise(80, 60, 4);
    let region = Rect::of_size(80, 60);
    match executor.run_images(&plan, &[("source", &source)], region, Control::default()) {
        Err(Error::Geometry(e)) => assert!(e.contains("80 are needed") && e.contains("whole picture"), "{e}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_warm_run_creates_nothing_and_submits_once() {
    let Some(device) = device() else { return };
    let mut executor = Executor::new(Arc::clone(&device));
    let source = noise(64, 48, 4);
    let region = Rect::of_size(64, 48);
    on_gpu(&mut executor, &plan(64, 48, 1.0), &source, region);
    let before = device.counts();
    assert_eq!(before.submissions, 1);
    let again = on_gpu(&mut executor, &plan(64, 48, 1.0), &source, region);
    let edited = on_gpu(&mut executor, &plan(64, 48, 2.0), &source, region);
    assert_ne!(again, edited);
    let mut expected = before;
    expected.submissions += 2;
    expected.uniform_writes += 1;
    assert_eq!(device.counts(), expected);
}

#[test]
fn dropped_programs_lend_their_textures_to_the_next() {
    let Some(device) = device() else { return };
    let executor = Executor::new(Arc::clone(&device));
    let program = Program::lower(&plan(64, 48, 1.0), Rect::of_size(64, 48)).unwrap();
    drop(executor.prepare(&program).unwrap());
    let before = device.counts();
    let _prepared = executor.prepare(&program).unwrap();
    let after = device.counts();
    assert!(before.textures > 0 && before.pipelines == 4);
    assert_eq!((after.textures, after.pipelines), (before.textures, before.pipelines));
}

#[test]
fn a_host_records_several_programs_into_one_submission() {
    let Some(owner) = device() else { return };
    // What a host has: a device of its own, of which we get handles.
    let (raw, queue) = (owner.raw().clone(), owner.queue().clone());
    let device = Device::wrap(raw.clone(), queue.clone());
    let executor = Executor::new(Arc::clone(&device));
    let float = wgpu::TextureFormat::Rgba32Float;
    let (source, middle, result) =
        (texture(&raw, 64, 40, float), texture(&raw, 64, 40, float), texture(&raw, 64, 40, float));
    let (source_view, middle_view, result_view) = (view(&source), view(&middle), view(&result));
    let image = noise(64, 40, 4);
    upload(&queue, &source, &image);
    let one = |gain, by| {
        let mut b = PlanBuilder::new(64, 40).unwrap();
        let source = b.input("source", 4, Class::Colour);
        let soft = box_blur(&mut b, source, 2, gain);
        let moved = shift(&mut b, soft, by);
        b.output("result", moved);
        b.finish().unwrap()
    };
    let (first_plan, second_plan) = (one(1.0, [3.0, 0.5]), one(2.0, [-1.0, 2.0]));
    let whole = Rect::of_size(64, 40);
    let mut first = executor.prepare(&Program::lower(&first_plan, whole).unwrap()).unwrap();
    let mut second = executor.prepare(&Program::lower(&second_plan, whole).unwrap()).unwrap();
    let mut frame = || {
        first.bind(&[("source", &source_view)], &[("result", &middle_view)]).unwrap();
        second.bind(&[("source", &middle_view)], &[("result", &result_view)]).unwrap();
        let mut encoder = raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        first.encode(&mut encoder).unwrap();
        second.encode(&mut encoder).unwrap();
        queue.submit([encoder.finish()]);
    };
    frame();
    let before = device.counts();
    assert_eq!((before.submissions, before.bind_groups, before.pipelines), (0, 4, 2));
    frame();
    assert_eq!(device.counts(), before);
    let between = on_cpu(&first_plan, &image, whole);
    let expected = on_cpu(&second_plan, &between[0], whole);
    assert!(worst(&download(&raw, &queue, &result, 4), &expected[0]) < 2e-5);
    owner.check().unwrap();
}

#[test]
fn changed_views_renew_only_what_holds_them() {
    let Some(device) = device() else { return };
    let executor = Executor::new(Arc::clone(&device));
    let plan = plan(64, 48, 1.0);
    let mut prepared = executor.prepare(&Program::lower(&plan, Rect::of_size(64, 48)).unwrap()).unwrap();
    let mut encoder = device.raw().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let unbound = prepared.encode(&mut encoder).unwrap_err().to_string();
    assert!(unbound.contains("source"), "{unbound}");
    for output in ["joined", "position", "soft"] {
        prepared.own_output(output).unwrap();
    }
    let eight = texture(device.raw(), 64, 48, wgpu::TextureFormat::Rgba8UnormSrgb);
    assert!(matches!(prepared.own_output("sharp"), Err(Error::Input(_))));
    let half = texture(device.raw(), 80, 48, wgpu::TextureFormat::Rgba16Float);
    prepared.bind(&[("source", &view(&eight))], &[]).unwrap();
    let before = device.counts().bind_groups;
    prepared.bind(&[("source", &view(&half))], &[]).unwrap();
    assert_eq!(device.counts().bind_groups, before + 1);
    prepared.encode(&mut encoder).unwrap();
    let small = texture(device.raw(), 64, 47, wgpu::TextureFormat::Rgba32Float);
    let e = prepared.bind(&[("source", &view(&small))], &[]).unwrap_err();
    assert!(matches!(&e, Error::Input(m) if m.contains("64x47") && m.contains("64x48")), "{e}");
    let integer = texture(device.raw(), 64, 48, wgpu::TextureFormat::Rgba32Uint);
    let e = prepared.bind(&[("source", &view(&integer))], &[]).unwrap_err();
    assert!(matches!(&e, Error::Device(m) if !m.contains('\n')), "{e}");
    device.check().unwrap();
}

#[test]
fn an_edit_is_one_write() {
    let Some(device) = device() else { return };
    let executor = Executor::new(Arc::clone(&device));
    let mut plan = plan(64, 48, 1.0);
    let whole = Rect::of_size(64, 48);
    let mut program = Program::lower(&plan, whole).unwrap();
    let mut prepared = executor.prepare(&program).unwrap();
    let source = noise(64, 48, 4);
    let input = prepared.own_input("source").unwrap();
    upload(device.queue(), input.texture(), &source);
    let outputs = ["joined", "position", "soft"].map(|name| prepared.own_output(name).unwrap());
    let before = device.counts();
    assert!(plan.edit(|b| describe(b, 3.0)).unwrap());
    assert!(program.repack(&plan));
    prepared.repack(&program).unwrap();
    prepared.repack(&program).unwrap();
    let mut expected = before;
    expected.uniform_writes += 1;
    assert_eq!(device.counts(), expected);
    let mut encoder = device.raw().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    prepared.encode(&mut encoder).unwrap();
    device.queue().submit([encoder.finish()]);
    let soft = download(device.raw(), device.queue(), outputs[2].texture(), 4);
    assert!(worst(&soft, &on_cpu(&plan, &source, whole)[2]) < 2e-5);
    let other = Program::lower(&support::plan(65, 48, 1.0), Rect::of_size(65, 48)).unwrap();
    assert!(matches!(prepared.repack(&other), Err(Error::Input(_))));
}

#[test]
fn passes_are_timed() {
    let Some(device) = device() else { return };
    let executor = Executor::new(Arc::clone(&device));
    let program = Program::lower(&plan(64, 48, 1.0), Rect::of_size(64, 48)).unwrap();
    let mut prepared = executor.prepare(&program).unwrap();
    prepared.own_input("source").unwrap();
    for output in ["joined", "position", "soft"] {
        prepared.own_output(output).unwrap();
    }
    if !device.has_timestamps() {
        assert!(matches!(prepared.record_times(true), Err(Error::NoDevice(_))));
        return;
    }
    assert!(prepared.times().unwrap().is_empty());
    prepared.record_times(true).unwrap();
    let before = device.counts();
    for _ in 0..2 {
        let mut encoder = device.raw().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        prepared.encode(&mut encoder).unwrap();
        device.queue().submit([encoder.finish()]);
        let times = prepared.times().unwrap();
        let names: Vec<_> = times.iter().map(|t| t.kernel.as_str()).collect();
        assert_eq!(names, ["box", "shift", "shift", "box", "shift", "box", "split", "join"]);
        assert_eq!((times[0].pixels, times[2].pixels), (64 * 48, 32 * 24));
        assert!(times.iter().any(|t| !t.time.is_zero()));
    }
    assert_eq!(device.counts(), before);
    device.check().unwrap();
}

/// `BOX` with another shader.
fn custom(shader: String) -> Plan {
    let kernel: &'static Kernel =
        Box::leak(Box::new(Kernel { shader: shader.leak(), name: "custom", ..BOX }));
    let mut b = PlanBuilder::new(8, 8).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let result =
        b.pass(kernel, &[source], &BoxParams { radius: 1, gain: 1.0 }, Class::Colour, Support::Pixels(1));
    b.output("result", result);
    b.finish().unwrap()
}

#[test]
fn a_bad_shader_is_an_error_of_one_line() {
    let Some(device) = device() else { return };
    let mut executor = Executor::new(Arc::clone(&device));
    let source = noise(8, 8, 4);
    let shaders = [
        BOX.shader.replace("var sum", "var sum !"),
        BOX.shader.replace("vec4f(0.0)", "vec3f(0.0)"),
        BOX.shader.replace("rgba32float", "rg32float"),
        BOX.shader.replace("gain: f32", "gain: vec4f, more: vec4f"),
        BOX.shader.replace("fn main", "fn other"),
        String::new(),
    ];
    for shader in shaders {
        let plan = custom(shader);
        let result =
            executor.run_images(&plan, &[("source", &source)], Rect::of_size(8, 8), Control::default());
        match result {
            Err(Error::Device(e)) => assert!(e.contains("'custom'") && !e.contains('\n'), "{e}"),
            other => panic!("{other:?}"),
        }
        device.check().unwrap();
    }
    let fine = custom(BOX.shader.to_owned());
    on_gpu(&mut executor, &fine, &source, Rect::of_size(8, 8));
}

#[test]
fn wrong_images_are_refused_as_on_the_cpu() {
    let Some(device) = device() else { return };
    let mut executor = Executor::new(device);
    let plan = plan(16, 16, 1.0);
    let (thin, small) = (noise(16, 16, 1), noise(15, 16, 4));
    let whole = Rect::of_size(16, 16);
    for inputs in [vec![], vec![("source", &thin)], vec![("source", &small)]] {
        let gpu = executor.run_images(&plan, &inputs, whole, Control::default()).unwrap_err();
        let cpu =
            CpuExecutor::new().run(&plan, &inputs, whole, &CallingThread, Control::default()).unwrap_err();
        assert!(matches!(gpu, Error::Input(_)));
        assert_eq!(gpu.to_string(), cpu.to_string());
    }
    let outside = executor.run_images(&plan, &[], Rect::of_size(17, 16), Control::default());
    assert!(matches!(outside, Err(Error::Geometry(_))));
}

#[test]
fn tiles_report_progress_and_stop() {
    let Some(device) = device() else { return };
    let mut executor = Executor::new(device);
    executor.set_limits(80, u64::MAX);
    let plan = plan(120, 90, 1.0);
    let source = noise(120, 90, 4);
    let whole = Rect::of_size(120, 90);
    let shares = std::sync::Mutex::new(Vec::new());
    let note = |share| shares.lock().unwrap().push(share);
    let control = Control { progress: Some(&note), ..Control::default() };
    executor.run_images(&plan, &[("source", &source)], whole, control).unwrap();
    let shares = shares.into_inner().unwrap();
    assert!(shares.len() >= 4 && shares.is_sorted() && shares.last() == Some(&1.0), "{shares:?}");
    let calls = AtomicUsize::new(0);
    let stop = || calls.fetch_add(1, Ordering::Relaxed) >= 2;
    let control = Control { cancelled: Some(&stop), ..Control::default() };
    let stopped = executor.run_images(&plan, &[("source", &source)], whole, control);
    assert!(matches!(stopped, Err(Error::Cancelled)));
    assert_eq!(calls.load(Ordering::Relaxed), 3);
}

#[test]
fn a_lost_device_is_an_error() {
    let Some(device) = device() else { return };
    let mut executor = Executor::new(Arc::clone(&device));
    let source = noise(64, 48, 4);
    let whole = Rect::of_size(64, 48);
    let plan = plan(64, 48, 1.0);
    on_gpu(&mut executor, &plan, &source, whole);
    device.raw().destroy();
    for _ in 0..2 {
        match executor.run_images(&plan, &[("source", &source)], whole, Control::default()) {
            Err(Error::Device(e)) => assert!(e.contains("lost") || e.contains("destroyed"), "{e}"),
            other => panic!("{other:?}"),
        }
    }
    // A host's device reports to the host, not to us; there, too, nothing may panic.
    let wrapped = Device::wrap(device.raw().clone(), device.queue().clone());
    let lost = Executor::new(wrapped).run_images(&plan, &[("source", &source)], whole, Control::default());
    assert!(matches!(lost, Err(Error::Device(_))), "{lost:?}");
}

#[test]
fn textures_beyond_the_device_are_an_error() {
    let Some(device) = device() else { return };
    let side = device.max_side() + 1;
    let mut b = PlanBuilder::new(side, 1).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let soft = box_blur(&mut b, source, 1, 1.0);
    let result = box_blur(&mut b, soft, 1, 1.0);
    b.output("result", result);
    let program = Program::lower(&b.finish().unwrap(), Rect::of_size(side, 1)).unwrap();
    let refused = Executor::new(Arc::clone(&device)).prepare(&program);
    assert!(matches!(&refused, Err(Error::Device(e)) if e.contains(&side.to_string())), "{refused:?}");
    device.check().unwrap();
}

#[test]
fn several_threads_share_a_device() {
    let Some(device) = device() else { return };
    let source = noise(64, 48, 4);
    let whole = Rect::of_size(64, 48);
    let expected = on_gpu(&mut Executor::new(Arc::clone(&device)), &plan(64, 48, 1.0), &source, whole);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let mut executor = Executor::new(Arc::clone(&device));
                for _ in 0..20 {
                    let plan = plan(64, 48, 1.0);
                    assert_eq!(on_gpu(&mut executor, &plan, &source, whole), expected);
                }
            });
        }
    });
    device.check().unwrap();
}

#[test]
fn adapters_are_counted_from_the_best() {
    let Some(usual) = device() else { return };
    let open = |adapter: &str| Device::open(&Options { adapter: Some(adapter.into()), ..Options::default() });
    // Where a variable asks for another than the best, it is another.
    if std::env::var_os("ISOPHOTE_ADAPTER").is_none() {
        assert_eq!(open("#1").unwrap().name(), usual.name());
    }
    for none in ["#0", "#99"] {
        assert!(matches!(open(none), Err(Error::NoDevice(e)) if e.contains(none)));
    }
}

#[test]
fn an_unknown_adapter_is_named() {
    let options = Options { adapter: Some("no such adapter".into()), ..Options::default() };
    let Err(Error::NoDevice(e)) = Device::open(&options) else { panic!("there is no such adapter") };
    assert!(e.contains("no such adapter") || e.contains("mesa-vulkan-drivers"), "{e}");
}
