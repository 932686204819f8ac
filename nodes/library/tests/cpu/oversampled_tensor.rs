//! `oversampled_tensor` on the CPU executor.

use isophote::kernels::structure::gradient_tensor::Measure;
use isophote::kernels::structure::oversampled_tensor::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, PlanBuilder, Rect};

#[test]
fn a_ramp_has_its_slope_everywhere_and_hidden_colours_leave_no_trace() {
    for (sigma, inset) in [(0.3, 4), (0.867, 8), (2.0, 14), (6.0, 40)] {
        let picture = |hidden: f32| {
            let values = (0..61 * 53u32).flat_map(|i| {
                let (x, y) = ((i % 61) as f32, (i / 61) as f32);
                if x > 52.0 { [hidden, -hidden, 1.0, 0.0] } else { [0.03 * x, 0.04 * y, 0.5, 1.0] }
            });
            Image::from_vec(61, 53, 4, values.collect()).unwrap()
        };
        let run = |image: &Image| {
            let mut plan = PlanBuilder::new(61, 53).unwrap();
            let color = plan.input("color", 4, Class::Colour);
            let measure = Measure { scale: 1.0, luma: false, normalize: false, threshold: None };
            let result = pass(&mut plan, color, sigma, measure);
            plan.output("tensor", result);
            CpuExecutor::new()
                .run(
                    &plan.finish().unwrap(),
                    &[("color", image)],
                    Rect::of_size(61, 53),
                    &CallingThread,
                    Control::default(),
                )
                .unwrap()
                .remove(0)
        };
        let got = run(&picture(0.0));
        assert_eq!((got.width(), got.height()), (122, 106));
        assert_eq!(got, run(&picture(100.0)));
        for (x, y) in [(inset, inset), (inset + 1, inset), (50, 53), (61, 50)] {
            let t = got.pixel(x, y);
            let near = |v: f32, want: f32| (v - want).abs() < 2e-6;
            assert!(
                near(t[0], 9e-4) && near(t[1], 0.0) && near(t[2], 16e-4) && t[3] == 1.0,
                "{sigma}: {t:?}"
            );
        }
    }
}
