//! Experiment 17: optical flow on rendered frames against the renderer's motion, beside OpenCV's dense inverse search.

use isophote::choice::Numbered;
use isophote::optical_flow::{Quality, estimate};
use isophote_engine::{Class, Image, Plan, PlanBuilder};
use isophote_tests::device::device;
use isophote_tests::run;
use isophote_tests::steadiness::{Shot, carried, rendered_shots};
use isophote_tests::table::Table;

/// Longest motion that is looked for along x and along y, pixels; that of a request.
const REACH: f32 = 64.0;

/// A shot, and what OpenCV 5.0.0 (`DISOpticalFlow`, 8-bit grey) makes of these frames: mean end-point error in pixels of
/// its presets fast and medium.
struct Known {
    shot: Shot,
    opencv: [f64; 2],
}

fn plan(size: [u32; 2], quality: Quality) -> Plan {
    let mut plan = PlanBuilder::new(size[0], size[1]).unwrap();
    let pictures = ["here", "there"].map(|name| plan.input(name, 4, Class::Colour));
    let motion = estimate(&mut plan, pictures, quality, REACH);
    plan.output("motion", motion);
    plan.finish().unwrap()
}

/// Sum and number of the end-point errors where the frame before shows the same.
fn errors(shot: &Shot, frame: usize, found: &Image) -> (f64, u64) {
    let (now, then) = (&shot.frames[frame], &shot.frames[frame - 1]);
    let width = found.width() as usize;
    let (mut sum, mut count) = (0.0, 0);
    for (index, place) in carried(shot, frame, &then.color).iter().enumerate() {
        if place.counts {
            let (x, y) = ((index % width) as i32, (index / width) as i32);
            let (ours, truth) = (found.pixel(x, y), now.motion.pixel(x, y));
            sum += f64::from((ours[0] - truth[0]).hypot(ours[1] - truth[1]));
            count += 1;
        }
    }
    (sum, count)
}

/// Mean end-point error over all frames of a shot but the first, pixels.
fn mean_error(shot: &Shot, quality: Quality) -> f64 {
    let size = &shot.frames[0].color;
    let plan = plan([size.width(), size.height()], quality);
    let (mut sum, mut count) = (0.0, 0);
    for frame in 1..shot.frames.len() {
        let pictures = [frame, frame - 1].map(|at| shot.frames[at].color.clone());
        let [here, there] = pictures;
        let (s, n) = errors(shot, frame, &run::whole(&plan, &[("here", here), ("there", there)]));
        (sum, count) = (sum + s, count + n);
    }
    sum / count as f64
}

#[test]
fn rendered_motion_is_estimated_no_worse_than_by_opencv() {
    let Some(_) = device("rendered frames") else { return };
    let mut all =
        vec![Known { shot: rendered_shots::demo(rendered_shots::SIZE).unwrap(), opencv: [0.360, 0.420] }];
    match rendered_shots::fox(rendered_shots::SIZE) {
        Some(shot) => all.push(Known { shot: shot.unwrap(), opencv: [2.032, 1.699] }),
        None => eprintln!("\n*** SKIPPED: no fox beside the checkout ***\n"),
    }
    let columns = ["shot", "OpenCV, fast", "OpenCV, medium", "fast", "medium", "fine"];
    let title = "Mean end-point error of optical flow on rendered frames, pixels";
    let mut table = Table::new(17, "Kroeger et al. 2016", title, &columns);
    for Known { shot, opencv } in &all {
        let ours: Vec<f64> = Quality::ALL.iter().map(|quality| mean_error(shot, *quality)).collect();
        let mut row = vec![shot.name.clone()];
        row.extend(opencv.iter().chain(&ours).map(|error| format!("{error:.2}")));
        table.row(&row);
        assert!(ours[1] <= opencv[1], "{}: {:.3} against {:.3}", shot.name, ours[1], opencv[1]);
    }
    table.print();
}
