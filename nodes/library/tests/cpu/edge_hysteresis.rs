//! `edge_hysteresis` on the CPU executor.

use isophote::kernels::lines::edge_hysteresis::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, PlanBuilder, Rect};

fn edges_of(candidates: &Image, reach: u32) -> Image {
    let (width, height) = (candidates.width(), candidates.height());
    let mut plan = PlanBuilder::new(width, height).unwrap();
    let input = plan.input("candidates", 1, Class::Field);
    let out = pass(&mut plan, input, reach, 1.0);
    plan.output("edges", out);
    let region = Rect::of_size(width, height);
    CpuExecutor::new()
        .run(
            &plan.finish().unwrap(),
            &[("candidates", candidates)],
            region,
            &CallingThread,
            Control::default(),
        )
        .unwrap()
        .remove(0)
}

#[test]
fn chains_are_followed_as_far_as_they_may_be() {
    // A weak line that winds down the picture from one strong pixel, and one that touches nothing.
    let mut image = Image::new(150, 40, 1).unwrap();
    let mut chain = vec![(3, 0)];
    for y in 0..38i32 {
        let turn = if y / 4 % 2 == 0 { 1 } else { 0 };
        for x in 0..if y % 4 == 3 { 130 } else { 1 } {
            chain.push((if turn == 1 { 4 + x } else { 133 - x }, y + 1));
        }
    }
    for (x, y) in &chain {
        image.row_mut(*y)[*x as usize] = 1.0;
    }
    image.row_mut(0)[3] = 2.0;
    for x in 140..150 {
        image.row_mut(20)[x] = 1.0;
    }
    for reach in [0, 1, 11, 12, 13, 100, 300, 2000] {
        let out = edges_of(&image, reach);
        let drawn = out.data().iter().filter(|v| **v == 0.0).count();
        // Chessboard distance along the chain, by growing one pixel at a time.
        let mut reached = std::collections::HashSet::from([(3, 0)]);
        for _ in 0..reach {
            let near: Vec<_> = chain
                .iter()
                .filter(|(x, y)| {
                    reached.iter().any(|(a, b): &(i32, i32)| (a - x).abs() <= 1 && (b - y).abs() <= 1)
                })
                .copied()
                .collect();
            let before = reached.len();
            reached.extend(near);
            if reached.len() == before {
                break;
            }
        }
        assert_eq!(drawn, reached.len(), "reach {reach}");
        assert!(out.row(20)[140..].iter().all(|v| *v == 1.0));
    }
}
