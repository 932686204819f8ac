//! Plans and programs: sharing, windows, support, edits, memory reuse, and exact tiles.

use crate::support::{self, BOX, BoxParams, box_blur, describe, noise, plan, rescale, shift};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor, Rows};
use isophote_engine::program::{Program, Role};
use isophote_engine::{Class, Error, Image, ImageId, Plan, PlanBuilder, Rect, Result, Support};
use std::collections::HashMap;
use std::ops::Range;

fn run(plan: &Plan, inputs: &[(&str, &Image)], region: Rect) -> Vec<Image> {
    CpuExecutor::new().run(plan, inputs, region, &CallingThread, Control::default()).unwrap()
}

fn rect(x0: i32, y0: i32, x1: i32, y1: i32) -> Rect {
    Rect { x0, y0, x1, y1 }
}

#[test]
fn equal_passes_are_recorded_once() {
    let mut b = PlanBuilder::new(8, 8).unwrap();
    let source = b.input("source", 4, Class::Colour);
    assert_eq!(source, b.input("source", 4, Class::Colour));
    let once = box_blur(&mut b, source, 1, 1.0);
    let twice = box_blur(&mut b, once, 1, 1.0);
    assert_eq!(box_blur(&mut b, source, 1, 1.0), once);
    assert_eq!(box_blur(&mut b, once, 1, 1.0), twice);
    assert_ne!(box_blur(&mut b, source, 1, 1.5), once);
    let params = BoxParams { radius: 1, gain: 1.0 };
    assert_ne!(b.pass(&BOX, &[source], &params, Class::Field, Support::Pixels(1)), once);
    assert_ne!(b.pass(&BOX, &[source], &params, Class::Colour, Support::Pixels(2)), once);
    assert_ne!(b.pass_at(&BOX, &[source], &params, &[Class::Colour], Support::Pixels(1), 1), once);
    b.output("twice", twice);
    let plan = b.finish().unwrap();
    assert_eq!((plan.passes().len(), plan.inputs().len()), (6, 1));
}

#[test]
fn a_plan_without_output_is_refused() {
    assert!(matches!(PlanBuilder::new(8, 8).unwrap().finish(), Err(Error::Input(_))));
    assert!(matches!(PlanBuilder::new(0, 8), Err(Error::Geometry(_))));
}

#[test]
fn windows_grow_backwards_and_stop_at_the_edge() {
    let mut b = PlanBuilder::new(100, 50).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let unused = b.input("unused", 4, Class::Colour);
    let soft = box_blur(&mut b, source, 3, 1.0);
    let softer = box_blur(&mut b, soft, 2, 1.0);
    let dead = box_blur(&mut b, unused, 2, 1.0);
    b.output("soft", soft);
    b.output("softer", softer);
    let plan = b.finish().unwrap();
    let windows = plan.windows(rect(10, 0, 20, 49));
    assert_eq!(windows[softer.index()], rect(10, 0, 20, 49));
    assert_eq!(windows[soft.index()], rect(8, 0, 22, 50));
    assert_eq!(windows[source.index()], rect(5, 0, 25, 50));
    assert!(windows[dead.index()].is_empty() && windows[unused.index()].is_empty());
    assert_eq!(plan.support(), Support::Pixels(5));
    // What is not needed is neither asked for nor computed.
    let image = noise(100, 50, 4);
    assert_eq!(run(&plan, &[("source", &image)], Rect::of_size(100, 50)).len(), 2);
    let program = Program::lower(&plan, Rect::of_size(100, 50)).unwrap();
    assert_eq!(program.dispatches.len(), 2);
    assert!(program.input("unused").is_none() && program.input("source").is_some());
}

#[test]
fn level_sizes_round_up() {
    let b = PlanBuilder::new(101, 1).unwrap();
    assert_eq!(b.level_size(1), [51, 1]);
    assert_eq!(b.level_size(3), [13, 1]);
    assert_eq!(b.level_size(100), [1, 1]);
    assert_eq!(b.level_size(-1), [202, 2]);
}

#[test]
fn a_tile_equals_the_same_tile_of_the_whole() {
    for (width, height) in [(1, 1), (7, 5), (97, 61)] {
        let plan = plan(width, height, 1.5);
        let source = noise(width, height, 4);
        let whole = run(&plan, &[("source", &source)], Rect::of_size(width, height));
        let (w, h) = (width as i32, height as i32);
        for region in [
            rect(0, 0, 1, 1),
            rect(w / 3, h / 2, w, h),
            rect(w - 1, 0, w, h),
            rect(w / 5, 1.min(h - 1), w / 2 + 1, h),
        ] {
            // Only the promised window is given, so that reading farther would be noticed.
            let needed = plan.windows(region)[plan.inputs()[0].image.index()];
            let part = source.crop(needed).unwrap();
            let tile = run(&plan, &[("source", &part)], region);
            for (tile, whole) in tile.iter().zip(&whole) {
                assert_eq!(*tile, whole.crop(region).unwrap(), "{width}x{height} {region:?}");
            }
        }
    }
}

#[test]
fn strips_compute_what_whole_passes_do() {
    let mut b = PlanBuilder::new(37, 120).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let soft = box_blur(&mut b, source, 2, 1.0);
    let half = rescale(&mut b, soft, 1);
    let back = rescale(&mut b, half, 0);
    let softer = box_blur(&mut b, back, 1, 1.0);
    let sharp = box_blur(&mut b, soft, 0, 2.0);
    b.output("softer", softer);
    b.output("sharp", sharp);
    let plan = b.finish().unwrap();
    let source = noise(37, 120, 4);
    for region in [rect(0, 0, 37, 120), rect(3, 11, 30, 117)] {
        let run = |strip: u32| {
            let mut executor = CpuExecutor::new();
            executor.set_strip(Some(strip));
            executor.record_times(true);
            let shares = std::cell::RefCell::new(Vec::new());
            let control =
                Control { cancelled: None, progress: Some(&|share| shares.borrow_mut().push(share)) };
            // The second run finds the memory of the first.
            let mut results = Vec::new();
            for _ in 0..2 {
                shares.borrow_mut().clear();
                results =
                    executor.run(&plan, &[("source", &source)], region, &CallingThread, control).unwrap();
            }
            assert_eq!(executor.times().len(), 5);
            assert_eq!(executor.times()[4].pixels, region.area());
            (results, shares.into_inner())
        };
        let (whole, once) = run(u32::MAX);
        assert_eq!(once.len(), 5);
        for strip in [1, 8, 13, 40] {
            let (strips, shares) = run(strip);
            assert_eq!(strips, whole, "{region:?} in strips of {strip}");
            // Forty rows of so small a picture would take more memory than whole passes do.
            assert_eq!(shares.len() > 5, strip < 40, "{region:?} in strips of {strip}");
            assert!(shares.is_sorted() && shares.last() == Some(&1.0), "{shares:?}");
        }
    }
}

/// A picture by rows, and results that are put together of theirs.
struct ByRows<'a> {
    source: &'a Image,
    next: i32,
    results: Vec<Image>,
}

impl Rows for ByRows<'_> {
    fn read(&mut self, name: &str, rows: Range<i32>, image: &mut Image) -> Result<()> {
        assert_eq!((name, rows.start), ("source", self.next));
        self.next = rows.end;
        let window = image.window();
        for y in rows {
            let part = self.source.crop(Rect { y0: y, y1: y + 1, ..window })?;
            image.row_mut(y).copy_from_slice(part.data());
        }
        Ok(())
    }

    fn write(&mut self, output: usize, part: Rect, image: &Image) -> Result<()> {
        let part = image.crop(part)?;
        let result = &mut self.results[output];
        (part.window().y0..part.window().y1).for_each(|y| result.row_mut(y).copy_from_slice(part.row(y)));
        Ok(())
    }
}

#[test]
fn rows_of_a_picture_give_what_the_whole_gives() {
    let mut b = PlanBuilder::new(37, 320).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let soft = box_blur(&mut b, source, 2, 1.0);
    let half = rescale(&mut b, soft, 1);
    let back = rescale(&mut b, half, 0);
    let softer = box_blur(&mut b, back, 1, 1.0);
    b.output("softer", softer);
    b.output("half", half);
    b.output("source", source);
    let plan = b.finish().unwrap();
    let source = noise(37, 320, 4);
    for region in [rect(0, 0, 37, 320), rect(3, 11, 30, 317)] {
        let whole = run(&plan, &[("source", &source)], region);
        let windows = plan.windows(region);
        let least = CpuExecutor::new().bytes_by_rows(&plan, (region, 0), &CallingThread);
        for most in [0, 4 * least / 3, u64::MAX] {
            let mut executor = CpuExecutor::new();
            let bytes = executor.bytes_by_rows(&plan, (region, most), &CallingThread);
            assert!(bytes <= most.max(least) && (most < u64::MAX || bytes > 2 * least), "{bytes} of {most}");
            let next = windows[plan.inputs()[0].image.index()].y0;
            // Memory that was not written would not be zero.
            let results = whole.iter().map(|image| Image::with_window(image.window(), image.channels()));
            let mut rows = ByRows { source: &source, next, results: results.collect::<Result<_>>().unwrap() };
            executor.run_rows(&plan, &mut rows, (region, most), &CallingThread, Control::default()).unwrap();
            assert!(rows.results == whole, "{region:?} in {most} bytes");
            assert!(executor.kept() <= bytes, "{} of {bytes}", executor.kept());
        }
    }
}

#[test]
fn an_output_of_another_level_returns_its_own_pixels() {
    let mut b = PlanBuilder::new(37, 21).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let half = rescale(&mut b, source, 1);
    let quarter = rescale(&mut b, half, 2);
    let double = rescale(&mut b, source, -1);
    b.output("quarter", quarter);
    b.output("double", double);
    let plan = b.finish().unwrap();
    let source = noise(37, 21, 4);
    let whole = run(&plan, &[("source", &source)], Rect::of_size(37, 21));
    assert_eq!(whole[0].window(), Rect::of_size(10, 6));
    assert_eq!(whole[1].window(), Rect::of_size(74, 42));
    let tile = run(&plan, &[("source", &source)], rect(9, 3, 30, 13));
    assert_eq!(tile[0], whole[0].crop(rect(2, 0, 8, 4)).unwrap());
    assert_eq!(tile[1], whole[1].crop(rect(18, 6, 60, 26)).unwrap());
}

#[test]
fn an_edit_writes_in_place() {
    let mut plan = plan(40, 30, 1.0);
    let place = plan.passes()[0].params.as_ptr();
    assert!(plan.edit(|b| describe(b, 2.0)).unwrap());
    assert_eq!(plan.passes()[0].params.as_ptr(), place);
    let source = noise(40, 30, 4);
    let whole = Rect::of_size(40, 30);
    let fresh = support::plan(40, 30, 2.0);
    assert_eq!(run(&plan, &[("source", &source)], whole), run(&fresh, &[("source", &source)], whole));
    assert!(plan.edit(|b| describe(b, 1.0)).unwrap(), "an edited plan can be edited again");
}

/// The plan that the edits below depart from: two equal blurs, one of which is blurred again.
fn shared(b: &mut PlanBuilder, gains: [f32; 2]) -> ImageId {
    let source = b.input("source", 4, Class::Colour);
    let first = box_blur(b, source, 1, gains[0]);
    let second = box_blur(b, source, 1, gains[1]);
    assert_eq!(b.desc(second).channels, 4);
    box_blur(b, first, 2, 1.0)
}

/// One blur of an input.
fn blurred(b: &mut PlanBuilder, from: &str) {
    let source = b.input(from, 4, Class::Colour);
    let result = box_blur(b, source, 1, 1.0);
    b.output("result", result);
}

type Describe = fn(&mut PlanBuilder);

/// Descriptions of other plans than [`shared`] with equal gains, and what is other in them.
fn departures() -> [(&'static str, Describe); 9] {
    [
        ("shared passes now differ", |b| {
            let result = shared(b, [3.0, 4.0]);
            b.output("result", result);
        }),
        ("one pass more", |b| {
            let result = shared(b, [1.0, 1.0]);
            let result = box_blur(b, result, 1, 1.0);
            b.output("result", result);
        }),
        ("one pass less", |b| blurred(b, "source")),
        ("another kernel", |b| {
            let source = b.input("source", 4, Class::Colour);
            let moved = shift(b, source, [1.0, 1.0]);
            let split = b.pass_at(
                &support::SPLIT,
                &[moved],
                &(),
                &[Class::Field, Class::Field],
                Support::Pixels(0),
                0,
            );
            let position = b.sibling(split, 7);
            let _ = b.desc(position);
            b.output("result", position);
        }),
        ("other connections", |b| {
            let source = b.input("source", 4, Class::Colour);
            box_blur(b, source, 1, 1.0);
            box_blur(b, source, 1, 1.0);
            let result = box_blur(b, source, 2, 1.0);
            b.output("result", result);
        }),
        ("another class", |b| {
            let source = b.input("source", 4, Class::Colour);
            let params = BoxParams { radius: 1, gain: 1.0 };
            let first = b.pass(&BOX, &[source], &params, Class::Field, Support::Pixels(1));
            b.pass(&BOX, &[source], &params, Class::Field, Support::Pixels(1));
            let result = box_blur(b, first, 2, 1.0);
            b.output("result", result);
        }),
        ("another input", |b| blurred(b, "other")),
        ("another output", |b| {
            let result = shared(b, [1.0, 1.0]);
            b.output("another", result);
        }),
        ("no output", |b| {
            shared(b, [1.0, 1.0]);
        }),
    ]
}

#[test]
fn an_edit_notices_another_course() {
    let fresh = |gains| {
        let mut b = PlanBuilder::new(40, 30).unwrap();
        let result = shared(&mut b, gains);
        b.output("result", result);
        b.finish().unwrap()
    };
    let edited = |gains, describe: Describe| {
        fresh(gains).edit(|b| {
            describe(b);
            Ok::<(), ()>(())
        })
    };
    let same: Describe = |b| {
        let result = shared(b, [3.0, 3.0]);
        b.output("result", result);
    };
    assert_eq!(edited([1.0, 1.0], same), Ok(true));
    assert_eq!(edited([1.0, 2.0], same), Ok(true), "what differed may become equal");
    for (what, describe) in departures() {
        assert_eq!(edited([1.0, 1.0], describe), Ok(false), "{what}");
    }
    assert_eq!(fresh([1.0, 1.0]).edit(|_| Err("no")), Err("no"));
}

#[test]
fn memory_is_reused_but_never_while_it_lives() {
    let mut state = 12345u32;
    let mut random = |n: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % n
    };
    for round in 0..60 {
        let mut b = PlanBuilder::new(60, 44).unwrap();
        let mut images = vec![b.input("source", 4, Class::Colour)];
        for _ in 0..24 {
            let source = images[random(images.len())];
            let gain = random(1000) as f32;
            images.push(match random(4) {
                0 => rescale(&mut b, source, random(3) as i8),
                1 => shift(&mut b, source, [gain % 3.0, 1.0]),
                _ => box_blur(&mut b, source, random(3) as i32, gain),
            });
        }
        let last = *images.last().unwrap();
        b.output("last", last);
        b.output("other", images[12]);
        let plan = b.finish().unwrap();
        let region = if round % 2 == 0 { Rect::of_size(60, 44) } else { rect(7, 5, 31, 28) };
        let Ok(program) = Program::lower(&plan, region) else { continue };
        nothing_is_overwritten(&plan, &program, region);
    }
}

/// Follows what textures hold from dispatch to dispatch.
fn nothing_is_overwritten(plan: &Plan, program: &Program, region: Rect) {
    let mut holds: HashMap<u32, ImageId> = HashMap::new();
    for port in plan.inputs() {
        holds.extend(program.input(&port.name).map(|at| (at as u32, port.image)));
    }
    let windows = plan.windows(region);
    let live = plan.passes().iter().filter(|p| !windows[p.outputs[0].index()].is_empty());
    assert_eq!(live.clone().count(), program.dispatches.len());
    for (pass, dispatch) in live.zip(&program.dispatches) {
        for (image, texture) in pass.inputs.iter().zip(&dispatch.inputs) {
            assert_eq!(holds.get(texture), Some(image), "overwritten before its last use");
        }
        for (image, texture) in pass.outputs.iter().zip(&dispatch.outputs) {
            assert!(!dispatch.inputs.contains(texture));
            let (texture_of, window) = (&program.textures[*texture as usize], windows[image.index()]);
            let stored = texture_of.window;
            match texture_of.role {
                Role::Transient => {
                    assert!(stored.width() >= window.width() && stored.height() >= window.height())
                }
                _ => assert_eq!(stored, window),
            }
            holds.insert(*texture, *image);
        }
    }
    for port in plan.outputs() {
        assert_eq!(holds[&(program.output(&port.name).unwrap() as u32)], port.image);
    }
}

#[test]
fn a_chain_needs_two_scratch_textures_however_long_it_is() {
    let mut b = PlanBuilder::new(60, 44).unwrap();
    let mut image = b.input("source", 4, Class::Colour);
    (0..9).for_each(|i| image = box_blur(&mut b, image, 1, i as f32));
    b.output("result", image);
    let plan = b.finish().unwrap();
    let scratch = |region| -> Vec<Rect> {
        let program = Program::lower(&plan, region).unwrap();
        program.textures.iter().filter(|t| t.role == Role::Transient).map(|t| t.window).collect()
    };
    assert_eq!(scratch(Rect::of_size(60, 44)), [Rect::of_size(60, 44); 2]);
    // Of a tile they are as large as the first images, of which later passes read ever smaller parts.
    assert_eq!(scratch(rect(30, 20, 34, 22)), [Rect::of_size(20, 18), Rect::of_size(18, 16)]);
}

#[test]
fn a_program_says_when_it_must_be_lowered_again() {
    let chain = |b: &mut PlanBuilder, radius, count: i32| {
        let mut image = b.input("source", 4, Class::Colour);
        (0..count).for_each(|i| image = box_blur(b, image, radius, i as f32));
        b.output("result", image);
        Ok::<(), ()>(())
    };
    let made = |radius, count| {
        let mut b = PlanBuilder::new(60, 44).unwrap();
        chain(&mut b, radius, count).unwrap();
        b.finish().unwrap()
    };
    let mut plan = made(2, 3);
    let mut whole = Program::lower(&plan, Rect::of_size(60, 44)).unwrap();
    let mut tile = Program::lower(&plan, rect(20, 20, 30, 30)).unwrap();
    assert!(plan.edit(|b| chain(b, 3, 3)).unwrap());
    let before = tile.dispatches[0].params.clone();
    assert!(whole.repack(&plan));
    assert_eq!(whole.dispatches[0].params, plan.passes()[0].params);
    assert!(!tile.repack(&plan), "a wider filter needs more than the tile's windows");
    assert_eq!(tile.dispatches[0].params, before);
    assert!(!whole.repack(&made(3, 2)));
}

#[test]
fn programs_refuse_what_they_cannot_be() {
    let mut b = PlanBuilder::new(20, 10).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let soft = box_blur(&mut b, source, 1, 1.0);
    b.output("soft", soft);
    let plan = b.finish().unwrap();
    for region in [Rect::default(), rect(0, 0, 21, 10), rect(-1, 0, 5, 5)] {
        assert!(matches!(Program::lower(&plan, region), Err(Error::Geometry(_))));
    }
    let mut b = PlanBuilder::new(20, 10).unwrap();
    let source = b.input("source", 4, Class::Colour);
    b.output("same", source);
    assert!(matches!(Program::lower(&b.finish().unwrap(), Rect::of_size(20, 10)), Err(Error::Input(_))));
}
