//! Lines where geometry breaks: silhouettes and creases that a renderer knows of are drawn, whatever lies behind them, and
//! on plain forms nothing else is.

use isophote::Request;
use isophote::request::Guides;
use isophote_engine::Image;
use isophote_tests::scenery::forms;
use isophote_tests::{png, run};

/// A style, its parameters without tones, and whether a luma is of a line.
type Style = (&'static str, &'static [(&'static str, &'static str)], fn(f32) -> bool);

const STYLES: [Style; 3] = [
    ("cartoon", &[("line_color", "#ff00ff")], |_| false),
    ("ink", &[("tone", "0"), ("grain", "0")], |luma| luma < 0.5),
    ("blueprint", &[("grid", "0"), ("paper_texture", "0"), ("fill", "0")], |luma| luma > 0.5),
];

/// Pixels on both sides of a break of what `differs`, which lies half a pixel from them.
fn beside(width: i32, height: i32, differs: impl Fn([i32; 2], [i32; 2]) -> bool) -> Vec<[i32; 2]> {
    let mut found = Vec::new();
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            for other in [[x + 1, y], [x, y + 1]] {
                if differs([x, y], other) {
                    found.extend([[x, y], other]);
                }
            }
        }
    }
    found
}

fn is_near(marks: &[bool], width: i32, height: i32, [x, y]: [i32; 2], distance: f32) -> bool {
    let reach = distance.ceil() as i32;
    (-reach..=reach).any(|dy| {
        (-reach..=reach).any(|dx| {
            let (u, v) = (x + dx, y + dy);
            let inside = (0..width).contains(&u) && (0..height).contains(&v);
            inside && (dx as f32).hypot(dy as f32) <= distance && marks[(v * width + u) as usize]
        })
    })
}

fn drawn((id, params, is_line): Style) -> Vec<bool> {
    let color = &forms()[0].1;
    let guides = Guides { normal: true, depth: true, object_id: true, ..Guides::default() };
    let request = Request { guides, ..Request::new(color.width(), color.height()) };
    let result = run::whole(run::planned(&run::single(id, params), request).plan(), forms());
    png::write(&png::results().join(format!("outlines-{id}.png")), &result);
    let pixels = result.data().chunks_exact(4);
    pixels
        .map(|p| {
            // Lines of a colour that nothing else has.
            let is_magenta = p[0] > 0.5 && p[2] > 0.5 && p[1] < 0.35;
            is_magenta || is_line(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2])
        })
        .collect()
}

fn at(image: &Image, [x, y]: [i32; 2]) -> &[f32] {
    image.pixel(x, y)
}

#[test]
fn silhouettes_and_creases_are_drawn() {
    let [(_, color), (_, normal), _, (_, id)] = forms() else { panic!("four pictures") };
    let (width, height) = (color.width() as i32, color.height() as i32);
    let outlines = beside(width, height, |a, b| at(id, a) != at(id, b));
    let creases = beside(width, height, |a, b| {
        let dot: f32 = (0..3).map(|c| at(normal, a)[c] * at(normal, b)[c]).sum();
        let is_there = at(normal, a)[3] > 0.5 && at(normal, b)[3] > 0.5;
        is_there && at(id, a) == at(id, b) && dot < 30f32.to_radians().cos() * 0.98
    });
    assert!(outlines.len() > 200 && creases.len() > 40, "{} {}", outlines.len(), creases.len());
    for style in STYLES {
        let lines = drawn(style);
        let recall = |wanted: &[[i32; 2]]| {
            let found = wanted.iter().filter(|p| is_near(&lines, width, height, **p, 1.5)).count();
            found as f32 / wanted.len() as f32
        };
        let (outline, crease) = (recall(&outlines), recall(&creases));
        assert!(outline >= 0.97 && crease >= 0.9, "{}: outlines {outline:.3}, creases {crease:.3}", style.0);
    }
}

#[test]
fn no_line_is_without_cause() {
    let [(_, color), (_, normal), _, (_, id)] = forms() else { panic!("four pictures") };
    let (width, height) = (color.width() as i32, color.height() as i32);
    let differs = |a: [i32; 2], b: [i32; 2]| {
        let shade: f32 = (0..3).map(|c| (at(color, a)[c] - at(color, b)[c]).abs()).sum();
        let dot: f32 = (0..3).map(|c| at(normal, a)[c] * at(normal, b)[c]).sum();
        at(id, a) != at(id, b) || at(normal, a)[3] > 0.5 && dot < 0.85 || shade > 0.15
    };
    let mut causes = vec![false; (width * height) as usize];
    for [x, y] in beside(width, height, differs) {
        causes[(y * width + x) as usize] = true;
    }
    for style in STYLES {
        let lines = drawn(style);
        let all: Vec<[i32; 2]> = (0..height)
            .flat_map(|y| (0..width).map(move |x| [x, y]))
            .filter(|[x, y]| lines[(y * width + x) as usize])
            .collect();
        // Lines of ink are up to six pixels wide about their border.
        let caused = all.iter().filter(|p| is_near(&causes, width, height, **p, 3.0)).count();
        let precision = caused as f32 / all.len() as f32;
        assert!(precision >= 0.95, "{}: {precision:.3} of {} line pixels", style.0, all.len());
    }
}
