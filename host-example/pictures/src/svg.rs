//! Pictures as SVG files: areas of one colour as closed curves, which drawing programs open, cut and scale.
//!
//! A picture whose visible pixels have one colour, such as lines alone, is a shape: its alpha is looked at four times as
//! finely as its pixels, so that curves go where its edges are, and not where pixels end. All others become areas of about one
//! colour, stacked so that no gap shows between them. Clustering and fitting of curves are visioncortex's.

use std::fmt::Write as _;
use std::io::Write;

use visioncortex::color_clusters::{HIERARCHICAL_MAX, KeyingAction, Runner, RunnerConfig};
use visioncortex::{BinaryImage, Color, ColorImage, CompoundPath, PathSimplifyMode, PointF64};

use crate::pixels::{Pixels, Samples};

/// Alpha from which on a pixel is visible.
const VISIBLE: u8 = 128;
/// Difference of channels up to which visible pixels have one colour.
const ONE_COLOUR: u8 = 6;
/// Corners are angles above this, and curves are cut into pieces that turn by no more, radians.
const CORNER: f64 = std::f64::consts::FRAC_PI_3;
const SPLICE: f64 = std::f64::consts::FRAC_PI_4;
/// Pieces into which curves are cut are longer than this, pixels, and the rounds in which they are.
const PIECE: f64 = 4.0;
const ROUNDS: usize = 10;
/// Area of the smallest spots of another colour that are kept, pixels.
const SPOT: usize = 6;
/// Sum of the differences of channels from which on areas that lie in each other are two.
const LAYER: i32 = 8;
/// Pixels of a picture above which its edges are looked at half as finely, and as coarsely as pixels.
const LARGE: [usize; 2] = [4 << 20, 16 << 20];

/// Writes straight sRGB of 8 bits, of one, three or four channels, whose pixels are `aspect` times as wide as high.
///
/// # Errors
/// The error of the disk as text.
pub fn write(out: &mut impl Write, pixels: &Pixels, aspect: f32) -> Result<(), String> {
    let (width, height) = (pixels.width() as usize, pixels.height() as usize);
    let rgba = rgba(pixels);
    let paths = match one_colour(&rgba) {
        Some(color) => shape(&rgba, (width, height), color),
        None => areas(rgba, (width, height)),
    };
    let shown = width as f64 * f64::from(aspect);
    let write = |out: &mut dyn Write| {
        writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{shown}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\">"
        )?;
        out.write_all(paths.as_bytes())?;
        writeln!(out, "</svg>")
    };
    write(out).map_err(|e| e.to_string())
}

/// True for a file that [`write`] wrote to its end.
pub fn is_whole(bytes: &[u8]) -> bool {
    bytes.ends_with(b"</svg>\n")
}

/// The samples as red, green, blue and alpha.
fn rgba(pixels: &Pixels) -> Vec<u8> {
    let Samples::U8(samples) = pixels.samples() else { return Vec::new() };
    match pixels.channels() {
        1 => samples.iter().flat_map(|v| [*v, *v, *v, u8::MAX]).collect(),
        3 => samples.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, u8::MAX]).collect(),
        _ => samples.clone(),
    }
}

/// The colour of all pixels that are visible, where they have one and others are not.
fn one_colour(rgba: &[u8]) -> Option<Color> {
    let visible = || rgba.as_chunks::<4>().0.iter().filter(|pixel| pixel[3] >= VISIBLE);
    if visible().count() * 4 == rgba.len() {
        return None;
    }
    let first = visible().max_by_key(|pixel| pixel[3])?;
    let is_same = |pixel: &[u8; 4]| (0..3).all(|c| pixel[c].abs_diff(first[c]) <= ONE_COLOUR);
    visible().all(is_same).then(|| Color::new(first[0], first[1], first[2]))
}

/// The shape that alpha has, in one colour.
fn shape(rgba: &[u8], (width, height): (usize, usize), color: Color) -> String {
    let fineness =
        LARGE.iter().fold(4, |fineness, large| if width * height > *large { fineness / 2 } else { fineness });
    let alpha = |x: usize, y: usize| f32::from(rgba[4 * (y.min(height - 1) * width + x.min(width - 1)) + 3]);
    let mut fine = BinaryImage::new_w_h(width * fineness, height * fineness);
    for y in 0..height * fineness {
        // Positions between the centres of pixels.
        let at = |v: usize| ((v as f32 + 0.5) / fineness as f32 - 0.5).max(0.0);
        let (v, ty) = (at(y) as usize, at(y).fract());
        for x in 0..width * fineness {
            let (u, tx) = (at(x) as usize, at(x).fract());
            let row = |v: usize| alpha(u, v) + tx * (alpha(u + 1, v) - alpha(u, v));
            let between = row(v) + ty * (row(v + 1) - row(v));
            if between >= f32::from(VISIBLE) {
                fine.set_pixel(x, y, true);
            }
        }
    }
    let mut paths =
        format!("<g transform=\"scale({})\" fill=\"{}\">\n", 1.0 / fineness as f64, color.to_hex_string());
    for cluster in fine.to_clusters(false).iter().filter(|cluster| cluster.size() >= fineness * fineness) {
        let piece = PIECE * fineness as f64 / 2.0;
        let path = cluster.to_compound_path(PathSimplifyMode::Spline, CORNER, piece, ROUNDS, SPLICE);
        push(&mut paths, &path, None);
    }
    paths.push_str("</g>\n");
    paths
}

/// Areas of about one colour, those that lie under others first.
fn areas(mut pixels: Vec<u8>, (width, height): (usize, usize)) -> String {
    let key_color = key(&mut pixels);
    let config = RunnerConfig {
        diagonal: false,
        hierarchical: HIERARCHICAL_MAX,
        good_min_area: SPOT,
        good_max_area: width * height,
        is_same_color_a: 0,
        is_same_color_b: 1,
        deepen_diff: LAYER,
        hollow_neighbours: 1,
        key_color,
        keying_action: KeyingAction::Discard,
        ..RunnerConfig::default()
    };
    let clusters = Runner::new(config, ColorImage { pixels, width, height }).run();
    let view = clusters.view();
    let mut paths = String::new();
    for index in view.clusters_output.iter().rev() {
        let cluster = view.get_cluster(*index);
        let path =
            cluster.to_compound_path(&view, false, PathSimplifyMode::Spline, CORNER, PIECE, ROUNDS, SPLICE);
        push(&mut paths, &path, Some(cluster.residue_color()));
    }
    paths
}

/// Gives pixels that are not visible a colour that no other has, and says which; the others are opaque.
fn key(rgba: &mut [u8]) -> Color {
    let (pixels, _) = rgba.as_chunks_mut::<4>();
    if pixels.iter().all(|pixel| pixel[3] >= VISIBLE) {
        pixels.iter_mut().for_each(|pixel| pixel[3] = u8::MAX);
        return Color::default();
    }
    let mut used = vec![false; 1 << 24];
    let index = |[r, g, b]: [u8; 3]| usize::from(r) << 16 | usize::from(g) << 8 | usize::from(b);
    for [r, g, b, _] in pixels.iter().filter(|pixel| pixel[3] >= VISIBLE) {
        used[index([*r, *g, *b])] = true;
    }
    // Where every colour is used, one of them is left out.
    let free = used.iter().rposition(|used| !used).unwrap_or_default();
    let [r, g, b] = [free >> 16, free >> 8 & 255, free & 255].map(|v| v as u8);
    for pixel in pixels {
        *pixel =
            if pixel[3] >= VISIBLE { [pixel[0], pixel[1], pixel[2], u8::MAX] } else { [r, g, b, u8::MAX] };
    }
    Color::new(r, g, b)
}

/// Adds a path, with a colour of its own where it has one.
fn push(paths: &mut String, path: &CompoundPath, color: Option<Color>) {
    let (curves, offset) = path.to_svg_string(true, PointF64::default(), Some(2));
    if curves.is_empty() {
        return;
    }
    let fill = color.map(|color| format!(" fill=\"{}\"", color.to_hex_string())).unwrap_or_default();
    // A string takes all that is written.
    let _ =
        writeln!(paths, "<path d=\"{curves}\"{fill} transform=\"translate({},{})\"/>", offset.x, offset.y);
}
