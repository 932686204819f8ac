//! Passes that are fused run in one dispatch, and give what they give by themselves.
#![cfg(feature = "gpu")]

mod kernels;

use crate::support;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::gpu::{Device, Executor, Options};
use isophote_engine::program::{Format, Precision, Program};
use isophote_engine::{Class, Image, ImageId, Plan, PlanBuilder, Rect, Support};
use kernels::{Amount, BESIDE, BLEND, SLOPE, SUM};
use std::sync::Arc;

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
    let (mut b, source) = begun();
    let slopes = slope(&mut b, source, 1.0);
    let sums = sum(&mut b, slopes, 0.5);
    // The slopes are read again, and the sums leave.
    let blended = blend(&mut b, [slopes, sums], 0.0);
    b.output("result", blended);
    b.output("sums", sums);
    assert_eq!(names(&b.finish().unwrap()), ["SLOPE", "SUM", "BLEND"]);
}

/// A plan and the picture that it begins with.
fn begun() -> (PlanBuilder, ImageId) {
    let mut b = PlanBuilder::new(53, 37).unwrap();
    let source = b.input("source", 4, Class::Colour);
    (b, source)
}

/// Runs a plan that ends with `result` as a whole and in part on both executors, in dispatches of these names.
fn compare(mut b: PlanBuilder, result: ImageId, expected: &[&str]) {
    b.output("result", result);
    let plan = b.finish().unwrap();
    assert_eq!(names(&plan), expected);
    let Some(device) = device() else { return };
    let source = picture();
    let mut executor = Executor::new(device);
    for region in [Rect::of_size(53, 37), Rect { x0: 13, y0: 5, x1: 44, y1: 30 }] {
        let results = executor.run_images(&plan, &[("source", &source)], region, Control::default()).unwrap();
        assert!(worst(&on_cpu(&plan, &source, region), &results[0]) < 1e-5);
    }
}

#[test]
fn what_follows_from_a_stored_pixel_is_stored_besides() {
    let (mut b, source) = begun();
    let first = slope(&mut b, source, 1.0);
    // Reads farther than what is stored besides.
    let second = slope(&mut b, first, 0.5);
    let factor = sum(&mut b, first, 0.5);
    let third = slope(&mut b, second, 0.5);
    let blended = blend(&mut b, [third, factor], 0.0);
    compare(b, blended, &["SLOPE*+SUM", "SLOPE", "SLOPE+BLEND"]);
}

#[test]
fn several_chains_of_single_pixels_join() {
    let (mut b, source) = begun();
    let first = slope(&mut b, source, 1.0);
    let factor = sum(&mut b, source, 0.5);
    let blended = blend(&mut b, [first, factor], 0.01);
    compare(b, blended, &["SLOPE+SUM@(t)+BLEND@(0,1)"]);
}

#[test]
fn what_a_kernel_reads_itself_stays_a_texture() {
    let (mut b, source) = begun();
    let first = slope(&mut b, source, 1.0);
    let factor = sum(&mut b, first, 0.5);
    let shifted = beside(&mut b, [source, factor], 0.5);
    compare(b, shifted, &["SLOPE+SUM+BESIDE@1"]);

    let (mut b, source) = begun();
    let first = slope(&mut b, source, 1.0);
    let factor = sum(&mut b, source, 0.5);
    // The neighbours of the slopes are not those of a single pixel.
    let shifted = beside(&mut b, [first, factor], 0.5);
    compare(b, shifted, &["SLOPE", "SUM+BESIDE@1"]);
}

#[test]
fn a_chain_runs_where_its_last_pass_stands() {
    let (mut b, source) = begun();
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
    let (mut b, source) = begun();
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
