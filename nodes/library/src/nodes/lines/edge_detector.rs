//! Classical edge detection (§ 4.1, 4.2.1): lines one pixel wide, as computer vision draws them.

use crate::kernels::colour::rgb_to_lab;
use crate::kernels::lines::edge_candidates::{self, Method, Options};
use crate::kernels::lines::{edge_gradient, edge_hysteresis};
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::stages::difference_of_gaussians as dog;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "edge_detector",
    label: "Edge detector",
    group: "lines",
    doc: "Edges of the lightness by classical detectors: Canny's (maxima of the gradient, joined by \
          hysteresis), the thresholded Sobel operator, or zero crossings of the Laplacian of Gaussian. 1 is \
          paper, 0 is line. Lines are one pixel of the full-size picture wide. Thresholds are heights: a \
          step between two pixels counts by the L that it rises, whatever `sigma` makes of it.",
    section: "4.1, 4.2.1",
    inputs: &[ports::COLOR],
    output: dog::EDGES,
    own_params: &[
        Param::choice("method", "Method", Method::Maximum.selected()).doc(
            "Canny: thin, joined lines at maxima of the gradient. Sobel: the magnitude of the gradient, from \
             `low` (paper) to `high` (line). Zero crossings: where the Laplacian of Gaussian changes its \
             sign (4.3), joined like Canny's.",
        ),
        Param::float("sigma", "Sigma", 1.4, [0.0, 20.0])
            .slider(0.0, 5.0)
            .pixels()
            .doc("Standard deviation of the smoothing before differentiation; 0 for none."),
        Param::float("low", "Low", 10.0, [0.0, 200.0])
            .slider(0.0, 100.0)
            .doc("Height, in L per pixel of an unsmoothed step, from which on an edge may continue a stronger one."),
        Param::float("high", "High", 30.0, [0.0, 200.0])
            .slider(0.0, 100.0)
            .doc("Height, in L per pixel of an unsmoothed step, from which on an edge is drawn by itself."),
        Param::float("reach", "Reach", 120.0, [0.0, 600.0])
            .slider(0.0, 240.0)
            .pixels()
            .structural()
            .doc(
                "Hysteresis: how far, along a chain of edges above `low`, the nearest one above `high` may be. \
                 Twelve pixels take a pass; tiles read as far around them.",
            ),
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let method = scope.option("method");
    let sigma = scope.float("sigma");
    let options = Options { method, low: scope.float("low"), high: scope.float("high") };
    let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    let gradient = edge_gradient::pass(scope.plan, lab, sigma, method == Method::Magnitude);
    let candidates = edge_candidates::pass(scope.plan, gradient, &options);
    if method == Method::Magnitude {
        return candidates;
    }
    // A line of one pixel covers that share of a pixel of a smaller rendering.
    let darkness = scope.scale().min(1.0);
    let reach = scope.float("reach").ceil().max(0.0) as u32;
    edge_hysteresis::pass(scope.plan, candidates, reach, darkness)
}

#[cfg(test)]
mod tests {
    use crate::{Graph, Planned, Request};
    use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
    use isophote_engine::{Image, Rect};

    /// The edges of a grey picture.
    fn edges(params: &[(&str, &str)], size: [u32; 2], grey: impl Fn(f32, f32) -> f32) -> Image {
        let [width, height] = size;
        let pixels = (0..width * height).flat_map(|i| {
            let v = grey((i % width) as f32, (i / width) as f32);
            [v, v, v, 1.0]
        });
        let picture = Image::from_vec(width, height, 4, pixels.collect()).unwrap();
        let mut graph = Graph::single("edge_detector").unwrap();
        let node = graph.node(0).unwrap();
        for (param, value) in params {
            graph.set_text(node, param, value).unwrap();
        }
        let planned = Planned::new(&graph, Request::new(width, height)).unwrap();
        let region = Rect::of_size(width, height);
        CpuExecutor::new()
            .run(planned.plan(), &[("color", &picture)], region, &CallingThread, Control::default())
            .unwrap()
            .remove(0)
    }

    fn drawn(row: &[f32]) -> usize {
        row.iter().filter(|v| **v < 0.5).count()
    }

    #[test]
    fn a_step_is_one_line_one_pixel_wide_at_every_scale() {
        for method in ["canny", "log_zero_crossing"] {
            for sigma in ["0", "1.4", "4"] {
                let params = [("method", method), ("sigma", sigma)];
                // Straight, and slanted.
                for slope in [0.0, 0.35] {
                    let step = |x: f32, y: f32| if x + slope * y < 30.0 { 0.2 } else { 0.7 };
                    let out = edges(&params, [64, 48], step);
                    for y in 20..28 {
                        let count = drawn(out.row(y));
                        let wanted = 1..=if slope == 0.0 { 1 } else { 2 };
                        assert!(wanted.contains(&count), "{method}, sigma {sigma}, slope {slope}: {count}");
                    }
                }
            }
        }
    }

    #[test]
    fn thresholds_are_the_heights_of_steps() {
        // Lightness 41 and 63: a step of 22.
        let step = |x: f32, _: f32| if x < 20.0 { 0.38 } else { 0.6 };
        for method in ["canny", "log_zero_crossing"] {
            for sigma in ["0", "1.4", "3"] {
                let found = |high: &str| {
                    let params = [("method", method), ("sigma", sigma), ("high", high)];
                    edges(&params, [40, 8], step).data().iter().any(|v| *v < 0.5)
                };
                assert!(found("18") && !found("26"), "{method}, sigma {sigma}");
            }
        }
    }

    #[test]
    fn a_weak_end_is_drawn_as_far_as_the_reach() {
        // A step whose height falls from 60 to 0.
        let fading = |x: f32, y: f32| if y < 10.0 { 0.2 } else { 0.2 + 0.5 * (1.0 - x / 200.0) };
        let length = |params: &[(&str, &str)]| drawn(edges(params, [200, 20], fading).row(9));
        let (strong, all) = (length(&[("reach", "0")]), length(&[]));
        let some = length(&[("reach", "20")]);
        assert!(strong > 40 && all > strong + 30, "{strong}, {some}, {all}");
        assert_eq!(some, strong + 20);
        assert_eq!(all, length(&[("reach", "600")]));
        assert_eq!(all, length(&[("high", "10")]));
    }
}
