//! Passes that are fused run in one dispatch, and give what they give by themselves.
#![cfg(feature = "gpu")]

mod support;

use bytemuck::{Pod, Zeroable};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::gpu::{Device, Executor, Options};
use isophote_engine::kernel::{Import, Parts};
use isophote_engine::program::{Format, Precision, Program};
use isophote_engine::{Band, Class, Image, ImageId, Kernel, Plan, PlanBuilder, Rect, Support, Tolerance};
use std::sync::Arc;

static GRID: Import = Import {
    name: "gpu/grid",
    text: include_str!("../../../shaders/gpu/grid.wgsl"),
    filtered: None,
    packed: None,
};

const EXACT: Tolerance = Tolerance { absolute: 1e-5, relative: 1e-5, outliers: 0.0, reason: "few sums" };

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Amount {
    amount: f32,
}

macro_rules! kernel {
    ($kernel:ident, $inputs:expr, $channels:expr, $is_per_pixel:expr, $main:expr, $own:expr, $cpu:expr) => {
        kernel!($kernel, $inputs, $channels, $is_per_pixel, &[], $main, $own, $cpu);
    };
    ($kernel:ident, $inputs:expr, $channels:expr, $is_per_pixel:expr, $around:expr, $main:expr, $own:expr, $cpu:expr) => {
        static $kernel: Kernel = Kernel {
            name: stringify!($kernel),
            shader: concat!(include_str!("../../../shaders/gpu/grid.wgsl"), $own, $main),
            inputs: $inputs,
            outputs: &[$channels],
            params_size: size_of::<Amount>(),
            parts: Parts {
                imports: &[&GRID],
                own: $own,
                is_per_pixel: $is_per_pixel,
                around: $around,
                can_lead: true,
                ..Parts::NONE
            },
            pair: None,
            cpu: $cpu,
            cost: |_| 1.0,
            tolerance: EXACT,
            fast: EXACT.rounded_to_half(),
        };
    };
}

// Difference to the right neighbour, times an amount.
kernel!(
    SLOPE,
    1,
    4,
    false,
    "",
    "
struct Params { amount: f32 }
@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;
// A name that another kernel has, too.
fn scaled(v: vec4f) -> vec4f { return v * params.amount; }
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let v = fetch(source, 0u, pixel(id) + vec2i(1, 0)) - fetch(source, 0u, pixel(id));
    textureStore(target_image, vec2i(id.xy), scaled(v));
}
",
    |pass, band| {
        let amount = pass.params::<Amount>().amount;
        let view = pass.inputs[0];
        each(band, 4, |x, y, out| {
            let (a, b) = (view.pixel4(x + 1, y), view.pixel4(x, y));
            (0..4).for_each(|c| out[c] = (a[c] - b[c]) * amount);
        });
    }
);

// The sum of the first two channels plus an amount, alone.
kernel!(
    SUM,
    1,
    1,
    true,
    "
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    textureStore(target_image, vec2i(id.xy), of_pixel(id, fetch(source, 0u, pixel(id))));
}
",
    "
struct Params { amount: f32 }
@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<r32float, write>;
fn scaled(v: vec4f) -> f32 { return v.x + v.y + params.amount; }
fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    return vec4f(scaled(source), 7.0, 7.0, 7.0);
}
",
    |pass, band| {
        let amount = pass.params::<Amount>().amount;
        let view = pass.inputs[0];
        each(band, 1, |x, y, out| {
            let v = view.pixel4(x, y);
            out[0] = v[0] + v[1] + amount;
        });
    }
);

// A picture times a number of another one, plus its position.
kernel!(
    BLEND,
    2,
    4,
    true,
    "
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    textureStore(target_image, vec2i(id.xy), of_pixel(id, fetch(picture, 0u, p), fetch(factor, 1u, p)));
}
",
    "
struct Params { amount: f32 }
@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var factor: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;
fn of_pixel(id: vec3u, picture: vec4f, factor: vec4f) -> vec4f {
    return picture * factor.x * factor.a + vec4f(params.amount * centre(id), factor.y, 0.0);
}
",
    |pass, band| {
        let amount = pass.params::<Amount>().amount;
        let [picture, factor] = pass.inputs else { return };
        each(band, 4, |x, y, out| {
            let (v, f) = (picture.pixel4(x, y), factor.pixel1(x, y));
            (0..4).for_each(|c| out[c] = v[c] * f);
            out[0] += amount * (x as f32 + 0.5);
            out[1] += amount * (y as f32 + 0.5);
        });
    }
);

// A picture's right neighbour times a number of another one.
kernel!(
    BESIDE,
    2,
    4,
    true,
    &[0],
    "
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    textureStore(target_image, vec2i(id.xy), of_pixel(id, fetch(factor, 1u, pixel(id))));
}
",
    "
struct Params { amount: f32 }
@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var factor: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;
const INPUT_PICTURE: u32 = 0u;
fn of_pixel(id: vec3u, factor: vec4f) -> vec4f {
    return params.amount * factor.x * fetch(picture, INPUT_PICTURE, pixel(id) + vec2i(1, 0));
}
",
    |pass, band| {
        let amount = pass.params::<Amount>().amount;
        let [picture, factor] = pass.inputs else { return };
        each(band, 4, |x, y, out| {
            let (v, f) = (picture.pixel4(x + 1, y), factor.pixel1(x, y));
            (0..4).for_each(|c| out[c] = amount * f * v[c]);
        });
    }
);

fn each(band: &mut Band<'_>, channels: usize, mut of: impl FnMut(i32, i32, &mut [f32])) {
    let window = band.window;
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y).chunks_exact_mut(channels);
        (window.x0..window.x1).zip(row).for_each(|(x, out)| of(x, y, out));
    }
}

fn slope(b: &mut PlanBuilder, image: ImageId, amount: f32) -> ImageId {
    b.pass(&SLOPE, &[image], &Amount { amount }, Class::Colour, Support::Pixels(1))
}

fn sum(b: &mut PlanBuilder, image: ImageId, amount: f32) -> ImageId {
    b.pass(&SUM, &[image], &Amount { amount }, Class::Field, Support::Pixels(0))
}

fn blend(b: &mut PlanBuilder, images: [ImageId; 2], amount: f32) -> ImageId {
    b.pass(&BLEND, &images, &Amount { amount }, Class::Colour, Support::Pixels(0))
}

fn beside(b: &mut PlanBuilder, images: [ImageId; 2], amount: f32) -> ImageId {
    b.pass(&BESIDE, &images, &Amount { amount }, Class::Colour, Support::Pixels(1))
}

/// Slopes, their sum, and the source times that.
fn describe(b: &mut PlanBuilder, amount: f32) -> isophote_engine::Result<()> {
    let source = b.input("source", 4, Class::Colour);
    let slopes = slope(b, source, amount);
    let sums = sum(b, slopes, 0.25 * amount);
    let blended = blend(b, [source, sums], 0.01);
    b.output("result", blended);
    Ok(())
}

fn plan(amount: f32) -> Plan {
    let mut b = PlanBuilder::new(53, 37).unwrap();
    describe(&mut b, amount).unwrap();
    b.finish().unwrap()
}

fn names(plan: &Plan) -> Vec<String> {
    let program = Program::lower(plan, Rect::of_size(53, 37)).unwrap();
    program.dispatches.iter().map(|dispatch| dispatch.shader.name.to_string()).collect()
}

fn device() -> Option<Arc<Device>> {
    match Device::open(&Options::default()) {
        Ok(device) => Some(device),
        Err(e) => {
            assert!(std::env::var_os("ISOPHOTE_REQUIRE_GPU").is_none(), "a graphics device is needed: {e}");
            eprintln!("*** SKIPPED: {e} ***");
            None
        }
    }
}

fn on_cpu(plan: &Plan, source: &Image, region: Rect) -> Image {
    let inputs = [("source", source)];
    CpuExecutor::new().run(plan, &inputs, region, &CallingThread, Control::default()).unwrap().remove(0)
}

fn picture() -> Image {
    let value = |i: usize| ((i * 7919) % 1013) as f32 / 1013.0;
    Image::from_vec(53, 37, 4, (0..53 * 37 * 4).map(value).collect()).unwrap()
}

/// Greatest difference, as a share of 1 and of the value.
fn worst(a: &Image, b: &Image) -> f32 {
    let differences = a.data().iter().zip(b.data()).map(|(a, b)| (a - b).abs() / (1.0 + a.abs()));
    differences.fold(0.0, f32::max)
}

#[test]
fn single_pixels_follow_in_one_dispatch() {
    assert_eq!(names(&plan(2.0)), ["SLOPE+SUM+BLEND@1"]);
    let program = Program::lower(&plan(2.0), Rect::of_size(53, 37)).unwrap();
    // The source, which two kernels read, and the result.
    assert_eq!(program.textures.len(), 2);
    assert_eq!(program.dispatches[0].params.len(), 48);
    assert_eq!(program.bytes_moved(), 2 * 53 * 37 * 16);
    let Some(device) = device() else { return };
    let (plan, source, region) = (plan(2.0), picture(), Rect::of_size(53, 37));
    let expected = on_cpu(&plan, &source, region);
    let mut executor = Executor::new(device);
    let run = |executor: &mut Executor, region| {
        executor.run_images(&plan, &[("source", &source)], region, Control::default()).unwrap().remove(0)
    };
    assert!(worst(&expected, &run(&mut executor, region)) < 1e-5);
    let tile = Rect { x0: 13, y0: 5, x1: 44, y1: 30 };
    assert!(worst(&on_cpu(&plan, &source, tile), &run(&mut executor, tile)) < 1e-5);
}

#[test]
fn what_several_read_or_what_leaves_is_written() {
    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let slopes = slope(&mut b, source, 1.0);
    let sums = sum(&mut b, slopes, 0.5);
    // The slopes are read again, and the sums leave.
    let blended = blend(&mut b, [slopes, sums], 0.0);
    b.output("result", blended);
    b.output("sums", sums);
    assert_eq!(names(&b.finish().unwrap()), ["SLOPE", "SUM", "BLEND"]);
}

/// Runs a plan as a whole and in part on both executors.
fn compare(plan: &Plan) {
    let Some(device) = device() else { return };
    let source = picture();
    let mut executor = Executor::new(device);
    for region in [Rect::of_size(53, 37), Rect { x0: 13, y0: 5, x1: 44, y1: 30 }] {
        let results = executor.run_images(plan, &[("source", &source)], region, Control::default()).unwrap();
        assert!(worst(&on_cpu(plan, &source, region), &results[0]) < 1e-5);
    }
}

#[test]
fn what_follows_from_a_stored_pixel_is_stored_besides() {
    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let first = slope(&mut b, source, 1.0);
    // Reads farther than what is stored besides.
    let second = slope(&mut b, first, 0.5);
    let factor = sum(&mut b, first, 0.5);
    let third = slope(&mut b, second, 0.5);
    let blended = blend(&mut b, [third, factor], 0.0);
    b.output("result", blended);
    let plan = b.finish().unwrap();
    assert_eq!(names(&plan), ["SLOPE*+SUM", "SLOPE", "SLOPE+BLEND"]);
    compare(&plan);
}

#[test]
fn several_chains_of_single_pixels_join() {
    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let first = slope(&mut b, source, 1.0);
    let factor = sum(&mut b, source, 0.5);
    let blended = blend(&mut b, [first, factor], 0.01);
    b.output("result", blended);
    let plan = b.finish().unwrap();
    assert_eq!(names(&plan), ["SLOPE+SUM@(t)+BLEND@(0,1)"]);
    compare(&plan);
}

#[test]
fn what_a_kernel_reads_itself_stays_a_texture() {
    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let first = slope(&mut b, source, 1.0);
    let factor = sum(&mut b, first, 0.5);
    let shifted = beside(&mut b, [source, factor], 0.5);
    b.output("result", shifted);
    let plan = b.finish().unwrap();
    assert_eq!(names(&plan), ["SLOPE+SUM+BESIDE@1"]);
    compare(&plan);

    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let first = slope(&mut b, source, 1.0);
    let factor = sum(&mut b, source, 0.5);
    // The neighbours of the slopes are not those of a single pixel.
    let shifted = beside(&mut b, [first, factor], 0.5);
    b.output("result", shifted);
    let plan = b.finish().unwrap();
    assert_eq!(names(&plan), ["SLOPE", "SUM+BESIDE@1"]);
    compare(&plan);
}

#[test]
fn a_chain_runs_where_its_last_pass_stands() {
    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let first = slope(&mut b, source, 1.0);
    let second = slope(&mut b, source, 0.5);
    let factor = sum(&mut b, second, 1.0);
    let blended = blend(&mut b, [first, factor], 0.0);
    b.output("result", blended);
    let plan = b.finish().unwrap();
    // Either order is right: the one that ends last takes the other's result.
    assert_eq!(names(&plan), ["SLOPE+SUM", "SLOPE+BLEND"]);
    let Some(device) = device() else { return };
    let (source, region) = (picture(), Rect::of_size(53, 37));
    let mut executor = Executor::new(device);
    let result =
        executor.run_images(&plan, &[("source", &source)], region, Control::default()).unwrap().remove(0);
    assert!(worst(&on_cpu(&plan, &source, region), &result) < 1e-5);
}

#[test]
fn edits_rewrite_the_bytes_of_every_kernel() {
    let (mut edited, region) = (plan(2.0), Rect::of_size(53, 37));
    let mut program = Program::lower(&edited, region).unwrap();
    assert!(edited.edit(|b| describe(b, 3.0)).unwrap());
    assert!(program.repack(&edited));
    let anew = Program::lower(&edited, region).unwrap();
    assert_eq!(program.dispatches[0].params, anew.dispatches[0].params);
    assert_ne!(anew.dispatches[0].params, Program::lower(&plan(2.0), region).unwrap().dispatches[0].params);
}

#[test]
fn half_precision_halves_the_bytes_and_rounds() {
    let plan = plan(2.0);
    let region = Rect::of_size(53, 37);
    let program = Program::lower_as(&plan, region, Precision::Half).unwrap();
    // What enters is the caller's.
    let formats: Vec<Format> = program.textures.iter().map(|texture| texture.format).collect();
    assert_eq!(formats, [Format::Rgba32, Format::Rgba16]);
    assert_eq!(program.dispatches[0].shader.name, "SLOPE+SUM+BLEND@1/half");
    assert_eq!(program.bytes_moved(), 53 * 37 * (16 + 8));
    let Some(device) = device() else { return };
    let mut executor = Executor::new(device);
    executor.set_precision(Precision::Half);
    let source = picture();
    let result =
        executor.run_images(&plan, &[("source", &source)], region, Control::default()).unwrap().remove(0);
    let difference = worst(&on_cpu(&plan, &source, region), &result);
    assert!((1e-6..3e-3).contains(&difference), "{difference}");
}

#[test]
fn shaders_of_single_kernels_store_half_floats() {
    let Some(device) = device() else { return };
    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let blurred = support::box_blur(&mut b, source, 2, 0.5);
    let again = support::box_blur(&mut b, blurred, 1, 1.0);
    b.output("result", again);
    let (plan, region, source) = (b.finish().unwrap(), Rect::of_size(53, 37), picture());
    let mut executor = Executor::new(device);
    executor.set_precision(Precision::Fast);
    let result =
        executor.run_images(&plan, &[("source", &source)], region, Control::default()).unwrap().remove(0);
    assert!(worst(&on_cpu(&plan, &source, region), &result) < 1e-3);
}
