//! `tensor_logarithm` on the CPU executor.

use isophote::kernels::structure::tensor_logarithm::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, ImageId, PlanBuilder, Rect};

fn run(image: &Image, add: impl Fn(&mut PlanBuilder, ImageId) -> ImageId) -> Image {
    let mut plan = PlanBuilder::new(image.width(), image.height()).unwrap();
    let tensor = plan.input("tensor", 4, Class::Field);
    let result = add(&mut plan, tensor);
    plan.output("tensor", result);
    let region = Rect::of_size(image.width(), image.height());
    CpuExecutor::new()
        .run(&plan.finish().unwrap(), &[("tensor", image)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

#[test]
fn the_way_there_and_back_keeps_tensors() {
    // Of any size; with an eigenvalue that is no vanishing share of the other.
    let tensors =
        [[1.0, 0.0, 0.01, 1.0], [3e-6, 2e-6, 2e-6, 0.5], [40.0, -9.0, 4.0, 0.0], [2.0, 0.0, 2.0, 1.0]];
    let image = Image::from_vec(4, 1, 4, tensors.concat()).unwrap();
    let there = run(&image, pass);
    assert!((there.pixel(0, 0)[0]).abs() < 1e-6 && (there.pixel(0, 0)[2] - 0.01f32.ln()).abs() < 1e-5);
    let back = run(&there, pass_inverse);
    for (got, want) in back.data().chunks_exact(4).zip(tensors) {
        let size = want[0].max(want[2]);
        assert!(
            (0..3).all(|i| (got[i] - want[i]).abs() < 1e-4 * size) && got[3] == want[3],
            "{got:?} {want:?}"
        );
    }
}

#[test]
fn no_tensor_has_no_direction_and_edges_keep_theirs() {
    let image = Image::from_vec(2, 1, 4, vec![0.0, 0.0, 0.0, 1.0, 0.36, 0.48, 0.64, 1.0]).unwrap();
    let there = run(&image, pass);
    let [e, f, g, _] = there.pixel(0, 0).try_into().unwrap();
    assert!(f == 0.0 && e == g && (e - LEAST.ln()).abs() < 1e-4, "{e} {f} {g}");
    let back = run(&there, pass_inverse);
    let [e, f, g, _]: [f32; 4] = back.pixel(1, 0).try_into().unwrap();
    assert!((2.0 * f).atan2(e - g) - 0.96f32.atan2(-0.28) < 1e-4, "{e} {f} {g}");
    assert!(e * g - f * f < 2e-3, "{e} {f} {g}");
}
