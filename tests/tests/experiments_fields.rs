//! Experiments on fields: filling low-contrast regions (Figure 2.26).

use isophote::kernels::structure::jacobi_step;
use isophote_engine::{Class, Image, PlanBuilder};
use isophote_tests::pictures::from_fn;
use isophote_tests::run;
use isophote_tests::table::Table;

const SIDE: usize = 192;
/// Radius of the part to be filled.
const HOLE: f64 = 72.0;

/// Tensors of a circular field with a hole, and of a bent line that crosses it: the rest must be filled
/// over long distances.
fn known_tensors() -> Image {
    from_fn(SIDE as u32, SIDE as u32, |x, y| {
        let (dx, dy) = (f64::from(x) - 99.3, f64::from(y) - 94.6);
        let r = dx.hypot(dy);
        let line = dy - 0.004 * dx * dx + 10.0;
        if r < HOLE && !(line.abs() < 1.5 && dx < 25.0) {
            // What does not count must not shine through.
            return [900.0, -70.0, 800.0, 0.0];
        }
        let (nx, ny) = if r < HOLE { (-0.008 * dx, 1.0) } else { (dx / r, dy / r) };
        [nx * nx, nx * ny, ny * ny, 1.0].map(|v| v as f32)
    })
}

type Field = Vec<[f64; 3]>;

/// One step of 2.171 with borders clamped to the edge; `weight` 1 is Jacobi's.
fn average(field: &Field, x: usize, y: usize) -> [f64; 3] {
    let at = |x: usize, y: usize| field[y * SIDE + x];
    let last = SIDE - 1;
    let four = [
        at((x + 1).min(last), y),
        at(x.saturating_sub(1), y),
        at(x, (y + 1).min(last)),
        at(x, y.saturating_sub(1)),
    ];
    [0, 1, 2].map(|c| 0.25 * four.iter().map(|t| t[c]).sum::<f64>())
}

/// Root mean square by which `field` is off over the pixels to be filled, as a share of the range of
/// the values, which is 1.
fn error(field: &Field, solution: &Field, fixed: &[bool]) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for ((f, s), _) in field.iter().zip(solution).zip(fixed).filter(|(_, fixed)| !**fixed) {
        squares += (0..3).map(|c| (f[c] - s[c]).powi(2)).sum::<f64>();
        count += 3.0;
    }
    (squares / count).sqrt()
}

fn as_field(image: &Image) -> Field {
    image.data().chunks_exact(4).map(|t| [0, 1, 2].map(|c| f64::from(t[c]))).collect()
}

/// The converged solution, by successive over-relaxation.
fn over_relaxed(start: Field, fixed: &[bool]) -> Field {
    let mut solution = start;
    let mut change = 1.0f64;
    while change > 1e-10 {
        change = 0.0;
        for y in 0..SIDE {
            for x in 0..SIDE {
                let i = y * SIDE + x;
                if fixed[i] {
                    continue;
                }
                let mean = average(&solution, x, y);
                for c in 0..3 {
                    let step = 1.95 * (mean[c] - solution[i][c]);
                    solution[i][c] += step;
                    change = change.max(step.abs());
                }
            }
        }
    }
    solution
}

/// So many iterations of Jacobi's method.
fn iterated(start: Field, fixed: &[bool], count: usize) -> Field {
    let mut field = start;
    for _ in 0..count {
        let mut next = field.clone();
        for y in 0..SIDE {
            for x in 0..SIDE {
                if !fixed[y * SIDE + x] {
                    next[y * SIDE + x] = average(&field, x, y);
                }
            }
        }
        field = next;
    }
    field
}

#[test]
fn relaxation_on_a_pyramid_solves_laplaces_equation() {
    let tensors = known_tensors();
    let fixed: Vec<bool> = tensors.data().chunks_exact(4).map(|t| t[3] == 1.0).collect();
    let known = as_field(&tensors);
    let start: Field = known.iter().zip(&fixed).map(|(t, f)| if *f { *t } else { [0.0; 3] }).collect();

    let solution = over_relaxed(start.clone(), &fixed);
    let jacobi = iterated(start, &fixed, 1000);
    let share = fixed.iter().filter(|f| **f).count() as f64 / fixed.len() as f64;
    let title = format!(
        "Distance from the converged solution of Laplace's equation where {:.0} % of the tensors are kept, in \
         percent of their range",
        100.0 * share
    );
    let mut table = Table::new(5, "Fig. 2.26", &title, &["method", "off by"]);
    let slow = error(&jacobi, &solution, &fixed);
    table.row(&["1,000 Jacobi iterations".to_owned(), format!("{:.1} %", 100.0 * slow)]);
    let mut pyramid = Vec::new();
    for steps in [1, 2, 3] {
        let mut plan = PlanBuilder::new(SIDE as u32, SIDE as u32).unwrap();
        let input = plan.input("tensor", 4, Class::Field);
        let filled = jacobi_step::relax(&mut plan, input, steps);
        plan.output("output", filled);
        let filled = as_field(&run::whole(&plan.finish().unwrap(), &[("tensor", tensors.clone())]));
        for (i, kept) in fixed.iter().enumerate().filter(|(_, f)| **f) {
            assert!(*kept && (0..3).all(|c| (filled[i][c] - known[i][c]).abs() < 1e-6), "kept tensors stay");
        }
        let off = error(&filled, &solution, &fixed);
        table.row(&[format!("pyramid, {steps} steps a level"), format!("{:.1} %", 100.0 * off)]);
        pyramid.push(off);
    }
    table.print();
    assert!(slow > 0.02, "1,000 Jacobi iterations are not enough");
    assert!(pyramid[2] < slow, "the pyramid is better");
    assert!(pyramid[2] < 0.02, "and within two percent");
    // One step a level, the default, is a little coarser than that.
    assert!(pyramid[0] < 0.03 && pyramid[0] > pyramid[1], "{pyramid:?}");
}
