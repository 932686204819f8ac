//! `gradient_tensor` on the CPU executor.

use isophote::kernels::structure::gradient_tensor::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, PlanBuilder, Rect};

const PLAIN: Measure = Measure { scale: 1.0, luma: false, normalize: false, threshold: None };
const OPERATORS: [Derivative; 6] = [
    Derivative::Central,
    Derivative::Sobel,
    Derivative::Scharr3,
    Derivative::Scharr5,
    Derivative::Gaussian(0.867),
    Derivative::Gaussian(3.0),
];

fn picture(width: u32, height: u32, color: impl Fn(f32, f32) -> [f32; 4]) -> Image {
    let values = (0..width * height).flat_map(|i| color((i % width) as f32, (i / width) as f32));
    Image::from_vec(width, height, 4, values.collect()).unwrap()
}

fn tensors(image: &Image, operator: Derivative, measure: Measure) -> Image {
    let mut plan = PlanBuilder::new(image.width(), image.height()).unwrap();
    let color = plan.input("color", 4, Class::Colour);
    let result = pass(&mut plan, color, operator, measure);
    plan.output("tensor", result);
    let region = Rect::of_size(image.width(), image.height());
    CpuExecutor::new()
        .run(&plan.finish().unwrap(), &[("color", image)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

fn near(got: &[f32], want: [f32; 4], bound: f32) {
    let close = got.iter().zip(want).all(|(g, w)| (g - w).abs() <= bound);
    assert!(close, "{got:?} for {want:?}");
}

#[test]
fn the_gradient_of_a_ramp_is_exact_for_every_operator() {
    let ramp = picture(43, 39, |x, y| [0.01 * x, 0.02 * y, 0.03 * x - 0.01 * y, 1.0]);
    for operator in OPERATORS {
        let got = tensors(&ramp, operator, PLAIN);
        for (x, y) in [(21, 19), (12, 20), (30, 12)] {
            near(got.pixel(x, y), [0.0010, -0.0003, 0.0005, 1.0], 2e-7);
        }
    }
}

#[test]
fn the_window_of_an_operator_is_known() {
    // Central differences are means over two pixels in a row; Sobel's are, of the two rows beside, half.
    assert!((Derivative::Central.variance() - 1.0 / 6.0).abs() < 1e-6);
    assert!((Derivative::Sobel.variance() - (0.5 + 1.0 / 3.0) / 2.0).abs() < 1e-6);
    assert_eq!(Derivative::Gaussian(2.0).variance(), 0.0);
}

#[test]
fn luma_scale_and_normalization_do_what_they_say() {
    let ramp = picture(20, 20, |x, y| [0.03 * x, 0.04 * y, 0.0, 1.0]);
    let luma = tensors(&ramp, Derivative::Scharr3, Measure { luma: true, ..PLAIN });
    let (gx, gy) = (0.2126 * 0.03, 0.7152 * 0.04);
    near(luma.pixel(9, 9), [gx * gx, gx * gy, gy * gy, 1.0], 1e-7);
    let half = tensors(&ramp, Derivative::Scharr3, Measure { scale: 0.5, ..PLAIN });
    near(half.pixel(9, 9), [0.000_225, 0.0, 0.0004, 1.0], 1e-7);
    let normalized = tensors(&ramp, Derivative::Scharr3, Measure { normalize: true, ..PLAIN });
    near(normalized.pixel(9, 9), [0.03, 0.0, 0.04, 1.0], 1e-6);
}

#[test]
fn validity_follows_the_gradient() {
    let kink = picture(24, 8, |x, _| [0.05 * x.min(12.0), 0.0, 0.0, 1.0]);
    let got = tensors(&kink, Derivative::Central, Measure { threshold: Some(0.03), ..PLAIN });
    assert_eq!((got.pixel(5, 4)[3], got.pixel(20, 4)[3]), (1.0, 0.0));
}

#[test]
fn hidden_colours_leave_no_trace() {
    let disc = |hidden: f32| {
        picture(31, 29, move |x, y| {
            let inside = (x - 15.0).hypot(y - 14.0) < 9.0;
            if inside { [0.02 * x, 0.5, 0.1, 1.0] } else { [hidden, 3.0 * hidden, 0.0, 0.0] }
        })
    };
    for operator in OPERATORS {
        let (a, b) = (tensors(&disc(0.0), operator, PLAIN), tensors(&disc(7.0), operator, PLAIN));
        assert_eq!(a, b);
        // Only the ramp in red is seen, at the disc's border no more than inside.
        for pixel in a.data().chunks_exact(4) {
            assert!(pixel[0] <= 0.0004 * 1.001 && pixel[2] <= 0.0004 * 1.001, "{pixel:?}");
        }
    }
}
