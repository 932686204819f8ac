//! Regions: what passes read, and bands.

use crate::support::{BOX, BoxParams, box_blur, plan, rescale};
use isophote_engine::{Class, PlanBuilder, Rect, Support};

fn rect(x0: i32, y0: i32, x1: i32, y1: i32) -> Rect {
    Rect { x0, y0, x1, y1 }
}

#[test]
fn passes_along_an_axis_reach_along_it_alone() {
    let mut b = PlanBuilder::new(100, 50).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let params = BoxParams { radius: 0, gain: 1.0 };
    let row = b.pass(&BOX, &[source], &params, Class::Colour, Support::Row(3));
    let column = b.pass(&BOX, &[row], &params, Class::Colour, Support::Column(2));
    b.output("column", column);
    let plan = b.finish().unwrap();
    let windows = plan.windows(rect(10, 20, 20, 30));
    assert_eq!(windows[row.index()], rect(10, 18, 20, 32));
    assert_eq!(windows[source.index()], rect(7, 18, 23, 32));
    assert_eq!(plan.support(), Support::Pixels(3));
    assert_eq!(Support::Row(3).farther(Support::Row(4)), Support::Row(4));
    assert_eq!(Support::Row(3).farther(Support::Column(2)), Support::Pixels(3));
    assert_eq!(Support::Column(2).farther(Support::Global), Support::Global);
}

#[test]
fn no_band_is_lower_than_what_is_read_around_it_is_worth() {
    let mut b = PlanBuilder::new(64, 1000).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let soft = box_blur(&mut b, source, 60, 1.0);
    b.output("soft", soft);
    let plan = b.finish().unwrap();
    let all = Rect::of_size(64, 1000);
    // Of at least 240 rows there are four bands of 250, but not one of 240 and a rest of 40.
    assert_eq!(plan.band_rows(all, [1, u64::MAX], 16), 250);
    assert_eq!(plan.band_rows(Rect { y1: 400, ..all }, [1, u64::MAX], 16), 400);
    assert_eq!(plan.band_rows(all, [1, 1], 16), 16);
}

#[test]
fn support_bounds_every_region() {
    let plan = plan(4096, 4096, 1.0);
    let Support::Pixels(halo) = plan.support() else { panic!("nothing reads everything") };
    let input = plan.inputs()[0].image.index();
    let mut widest = 0;
    for start in 2000..2008 {
        for length in 1..9 {
            let region = rect(start, start + 1, start + length, start + 3);
            let window = plan.windows(region)[input];
            assert!(region.grown(halo as i32).contains(&window), "{region:?} {window:?} {halo}");
            widest = widest.max(region.x0 - window.x0).max(window.x1 - region.x1);
        }
    }
    assert!(halo as i32 - widest <= 1, "{halo} is more than {widest}");
    let mut b = PlanBuilder::new(64, 64).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let mut level = source;
    (1..=6).for_each(|l| level = rescale(&mut b, level, l));
    let back = rescale(&mut b, level, 0);
    let params = BoxParams { radius: 0, gain: 1.0 };
    let mean = b.pass(&BOX, &[back], &params, Class::Colour, Support::Global);
    b.output("mean", mean);
    assert_eq!(b.finish().unwrap().support(), Support::Global);
}

#[test]
fn what_is_handed_of_another_level_is_read_as_far_as_from_its_level() {
    let mut b = PlanBuilder::new(4096, 4096).unwrap();
    let source = b.input("source", 4, Class::Colour);
    let coarse = rescale(&mut b, source, 2);
    let params = BoxParams { radius: 3, gain: 1.0 };
    let mean = b.pass(&BOX, &[coarse], &params, Class::Colour, Support::Pixels(3));
    let back = rescale(&mut b, mean, 0);
    b.output("mean", back);
    let whole = b.finish().unwrap();
    let (Support::Pixels(all), Support::Pixels(handed)) =
        (whole.support(), whole.with_handed(&[coarse]).support())
    else {
        panic!("nothing reads everything")
    };
    assert!((12..=all).contains(&handed), "{handed} of {all}");
}
