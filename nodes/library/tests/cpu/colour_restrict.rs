//! `colour_restrict` on the CPU executor.

use isophote::kernels::structure::colour_restrict::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, PlanBuilder, Rect};

#[test]
fn pixels_count_by_coverage_and_missing_children_not_at_all() {
    let mut plan = PlanBuilder::new(3, 3).unwrap();
    let color = plan.input("color", 4, Class::Colour);
    let half = pass(&mut plan, color);
    plan.output("color", half);
    let value = |x: usize, y: usize, c: usize| match (c, (x, y)) {
        (3, (1, 1)) => 0.0,
        (3, _) => 1.0,
        (_, (1, 1)) => 9.0,
        _ => x as f32 + 10.0 * y as f32,
    };
    let values = (0..36).map(|i| value(i / 4 % 3, i / 12, i % 4)).collect();
    let image = Image::from_vec(3, 3, 4, values).unwrap();
    let region = Rect::of_size(3, 3);
    let got = CpuExecutor::new()
        .run(&plan.finish().unwrap(), &[("color", &image)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0);
    assert_eq!((got.width(), got.height()), (2, 2));
    let grey = |x: i32, y: i32| [got.pixel(x, y)[0], got.pixel(x, y)[3]];
    let near = |got: [f32; 2], want: [f32; 2]| (0..2).all(|i| (got[i] - want[i]).abs() < 1e-5);
    assert!(near(grey(0, 0), [11.0 / 3.0, 0.75]), "{:?}", grey(0, 0));
    assert!(near(grey(1, 0), [7.0, 1.0]) && near(grey(0, 1), [20.5, 1.0]) && near(grey(1, 1), [22.0, 1.0]));
}
