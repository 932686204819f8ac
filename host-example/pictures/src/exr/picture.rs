//! A picture and its guides out of a file's channels, and a result back into them.

use std::path::Path;

use isophote_exr_edit::{Channel, Decoded, Edit, Error as ExrError, File, Part, Plane, Window};

use super::choose::{Chosen, Selection};
use super::fault::Fault;
use super::guides::{GuideSource, Meaning as GuideMeaning};
use super::meaning;
use super::motion::applied;
use super::names::{Model, components};
use crate::meaning::Meaning;
use crate::pixels::{Pixels, Samples};
use crate::primaries;
use isophote_files::error::Error;

/// Numbers up to here are exact as floats.
const EXACT: u32 = 1 << 24;

/// A picture of a file, ready for a graph.
#[derive(Debug)]
pub struct Picture {
    /// Grey, RGB or RGBA.
    pub pixels: Pixels,
    /// Guides by the name of the graph's input.
    pub guides: Vec<(&'static str, Pixels)>,
    /// Meaning of its numbers.
    pub meaning: Meaning,
    /// Share of results that is used, 0 to 1: a mask for each that was asked for.
    pub masks: Vec<Option<Pixels>>,
    /// The pixels that it had, where its own are not square and were made so.
    pub own: Option<OwnPixels>,
    /// Reason why there can be no result of it, for want of masks; neighbouring frames may depend on it all the same.
    pub refused: Option<Error>,
}

/// Pixels that a picture had before they were made square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnPixels {
    /// Columns and rows.
    pub size: (u32, u32),
    /// Width of one over its height.
    pub aspect: f64,
    /// Scale of the picture in square pixels, as requests have it.
    pub scale: f32,
}

impl Picture {
    /// A picture of which nothing else is known than what its numbers mean.
    pub fn alone(pixels: Pixels, meaning: Meaning) -> Self {
        Self { pixels, guides: Vec::new(), meaning, masks: Vec::new(), own: None, refused: None }
    }

    /// The window that its pixels fill.
    pub fn window(&self) -> Window {
        let (width, height) = (self.pixels.width() as usize, self.pixels.height() as usize);
        self.meaning.data.unwrap_or(Window { x: 0, y: 0, width, height })
    }
}

/// Reads a picture.
///
/// # Errors
/// [`Fault::File`] when its channels are of unequal size or take too much memory.
pub fn read(
    exr: &File,
    decoded: &[Option<Decoded>],
    chosen: &Chosen,
    selection: &Selection,
    path: &Path,
) -> Result<Picture, Fault> {
    let unequal = || ExrError::Damaged("its channels are of unequal size".into());
    let part = &exr.parts()[chosen.group.part];
    let data = decoded[chosen.group.part].as_ref().ok_or_else(unequal)?;
    let mut planes: Vec<Plane> = chosen.colors.iter().map(|c| data.plane(*c)).collect::<Result<_, _>>()?;
    if chosen.model == Model::LuminanceChroma {
        let sampling = part.channels[chosen.colors[1]].sampling;
        let weights = primaries::luminance(part.chromaticities);
        planes = to_rgb(&planes, part.window, sampling, weights);
    }
    if let Some(alpha) = chosen.alpha {
        // Grey with alpha has no form of its own.
        if let [grey] = planes.as_slice() {
            planes = vec![grey.clone(), grey.clone(), grey.clone()];
        }
        planes.push(data.plane(alpha)?);
    }
    let mut guides = Vec::with_capacity(chosen.guides.len());
    for source in &chosen.guides {
        let pixels = guide(exr, decoded, source, part.window, part.world_to_camera)?;
        // Colours are multiplied as the picture is.
        let alpha = || chosen.alpha.map(|alpha| data.plane(alpha)).transpose();
        let pixels = match pixels {
            Some(colours) if source.guide.is_colour() => with_alpha(colours, alpha()?.as_ref()),
            data => data,
        };
        guides.extend(pixels.map(|pixels| (source.guide.id(), pixels)));
    }
    let mut masks = Vec::with_capacity(chosen.masks.len());
    let mut refused = None;
    for mask in &chosen.masks {
        let Some(mask) = mask else {
            masks.push(None);
            continue;
        };
        let (width, height) = (part.window.width as u32, part.window.height as u32);
        match mask.read(exr, decoded, part.window, selection.on_unknown, path) {
            Ok(values) => masks.push(Pixels::new(width, height, 1, Samples::F32(values))),
            Err(fault @ Fault::File(_)) => return Err(fault),
            Err(fault) => {
                masks.push(None);
                refused.get_or_insert(fault.of(path));
            }
        }
    }
    let pixels = interleaved(part.window, &planes).ok_or_else(unequal)?;
    let meaning = meaning::of(exr, chosen.group.part, chosen.alpha.is_some());
    Ok(Picture { pixels, guides, meaning, masks, own: None, refused })
}

/// Samples a pixel that a result must have to go into the file.
pub fn result_channels(chosen: &Chosen, selection: &Selection, scalar: bool, has_alpha: bool) -> u32 {
    match (scalar, chosen.alpha) {
        (true, _) if selection.into.is_some() => 1,
        (true, None) if chosen.model == Model::Grey => 1,
        (_, Some(_)) => 4,
        (_, None) if has_alpha && selection.into.is_some() => 4,
        (_, None) => 3,
    }
}

/// Puts a result into the edit of the part that its picture came from.
///
/// # Errors
/// [`ExrError::Argument`] when it does not fit the part.
pub fn replace(
    edit: &mut Edit,
    part: &Part,
    chosen: &Chosen,
    selection: &Selection,
    result: &Pixels,
) -> Result<(), ExrError> {
    let numbers = result.to_f32();
    let count = result.channels() as usize;
    let plane = |offset: usize| -> Vec<f32> { numbers.iter().skip(offset).step_by(count).copied().collect() };
    if let Some(layer) = &selection.into {
        let model = &part.channels[chosen.colors[0]];
        for (offset, name) in components(result.channels()).iter().enumerate() {
            let name = into_name(part, chosen, layer, name);
            let flags = if offset < 3 { model.flags } else { [0; 4] };
            edit.insert(Channel { name, sample: model.sample, flags, sampling: (1, 1) }, plane(offset))?;
        }
        return Ok(());
    }
    let name = |channel: usize| part.channels[channel].name.as_str();
    let weights = primaries::luminance(part.chromaticities);
    match (chosen.model, chosen.colors.as_slice()) {
        (Model::Rgb, colors) => {
            for (offset, color) in colors.iter().enumerate() {
                edit.replace(name(*color), plane(offset))?;
            }
        }
        (Model::Grey, colors) => {
            let grey = if count == 1 { plane(0) } else { luminance(&numbers, count, weights) };
            for color in colors {
                edit.replace(name(*color), grey.clone())?;
            }
        }
        (Model::LuminanceChroma, colors) => {
            let sampling = part.channels[colors[1]].sampling;
            let planes = to_chroma(&numbers, count, part.window, sampling, weights);
            for (color, values) in colors.iter().zip(planes) {
                edit.replace(name(*color), values)?;
            }
        }
    }
    if let (Some(alpha), 4) = (chosen.alpha, count) {
        edit.replace(name(alpha), plane(3))?;
    }
    Ok(())
}

/// Full name of a channel of a new layer.
pub fn into_name(part: &Part, chosen: &Chosen, layer: &str, component: &str) -> String {
    match &chosen.group.view {
        Some(view) if part.view.is_none() => format!("{layer}.{view}.{component}"),
        _ => format!("{layer}.{component}"),
    }
}

/// Planes of equal size as pixels: halves when all are.
fn interleaved(window: Window, planes: &[Plane]) -> Option<Pixels> {
    let count = planes.len();
    let size = window.width * window.height * count;
    let samples = if planes.iter().all(|p| matches!(p, Plane::Half(_))) {
        let mut all = vec![half::f16::ZERO; size];
        for (offset, plane) in planes.iter().enumerate() {
            if let Plane::Half(values) = plane {
                all.iter_mut().skip(offset).step_by(count).zip(values).for_each(|(to, from)| *to = *from);
            }
        }
        Samples::F16(all)
    } else {
        let mut all = vec![0.0; size];
        for (offset, plane) in planes.iter().enumerate() {
            all.iter_mut().skip(offset).step_by(count).zip(plane.to_f32()).for_each(|(to, from)| *to = from);
        }
        Samples::F32(all)
    };
    Pixels::new(window.width as u32, window.height as u32, count as u32, samples)
}

/// A guide over the window of a picture that this camera has seen; nothing where it has no pixels or no number.
pub fn guide(
    exr: &File,
    decoded: &[Option<Decoded>],
    source: &GuideSource,
    window: Window,
    world_to_camera: Option<[f32; 16]>,
) -> Result<Option<Pixels>, ExrError> {
    let numbers = match source.meaning {
        GuideMeaning::Hashes => hashes,
        _ => numbers,
    };
    // What a motion does not tell is unknown.
    let nothing = if source.guide.is_motion() { f32::NAN } else { 0.0 };
    let layer = |(part, channels): (usize, &[usize])| {
        let Some(data) = decoded[part].as_ref() else { return Ok(None) };
        let plane = |channel: &usize| Ok::<_, ExrError>(numbers(&data.plane(*channel)?));
        let planes: Vec<Vec<f32>> = channels.iter().map(plane).collect::<Result<_, _>>()?;
        Ok::<_, ExrError>(Some(over(window, &planes, exr.parts()[part].window, nothing)))
    };
    let count = source.channels.len();
    let Some(mut all) = layer((source.part, &source.channels))? else { return Ok(None) };
    if !source.light.is_empty() {
        let mut sum = vec![0.0; all.len()];
        for (part, channels) in &source.light {
            let Some(light) = layer((*part, channels))? else { continue };
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
        }
        all.iter_mut().zip(sum).for_each(|(colour, light)| *colour *= light);
    }
    let size = (window.width as u32, window.height as u32);
    if let GuideMeaning::Vectors(rule) = source.meaning {
        return Ok(applied(rule, all, size));
    }
    if let GuideMeaning::Position = source.meaning {
        let Some(camera) = world_to_camera else { return Ok(None) };
        // Row vectors; the camera looks along -z.
        let depth = all.as_chunks::<3>().0.iter().map(|p| {
            let z = p[0] * camera[2] + p[1] * camera[6] + p[2] * camera[10] + camera[14];
            if *p == [0.0; 3] { 0.0 } else { z.abs() }
        });
        return Ok(Pixels::new(size.0, size.1, 1, Samples::F32(depth.collect())));
    }
    if source.guide.is_of_surfaces() {
        // Three zeros are no surface: renderers leave their backgrounds so.
        let valid = |v: &[f32; 3]| [v[0], v[1], v[2], f32::from(*v != [0.0; 3])];
        let vectors = all.as_chunks::<3>().0.iter().flat_map(valid).collect();
        return Ok(Pixels::new(size.0, size.1, 4, Samples::F32(vectors)));
    }
    Ok(Pixels::new(size.0, size.1, count as u32, Samples::F32(all)))
}

/// Planes of a part of this window, pixel by pixel over a picture's; `nothing` where one has no pixel or no number.
fn over(window: Window, planes: &[Vec<f32>], part: Window, nothing: f32) -> Vec<f32> {
    let count = planes.len();
    let mut all = vec![nothing; window.width * window.height * count];
    for y in 0..window.height {
        let from_y = window.y as i64 + y as i64 - part.y as i64;
        if !(0..part.height as i64).contains(&from_y) {
            continue;
        }
        for x in 0..window.width {
            let from_x = window.x as i64 + x as i64 - part.x as i64;
            if !(0..part.width as i64).contains(&from_x) {
                continue;
            }
            let from = from_y as usize * part.width + from_x as usize;
            let to = &mut all[(y * window.width + x) * count..][..count];
            for (to, plane) in to.iter_mut().zip(planes) {
                *to = plane[from];
            }
            if to.iter().any(|v| !v.is_finite()) {
                to.fill(nothing);
            }
        }
    }
    all
}

/// Colours with an alpha: their own, or that of the picture.
fn with_alpha(colours: Pixels, alpha: Option<&Plane>) -> Option<Pixels> {
    if colours.channels() == 4 {
        return Some(colours);
    }
    let numbers = colours.to_f32();
    let alphas = alpha.map(Plane::to_f32);
    let pixels = numbers.as_chunks::<3>().0.iter().enumerate();
    let pixel = |(at, [r, g, b]): (usize, &[f32; 3])| {
        let alpha = alphas.as_ref().and_then(|alphas| alphas.get(at)).copied().unwrap_or(1.0);
        [*r, *g, *b, alpha]
    };
    let joined = pixels.flat_map(pixel).collect();
    Pixels::new(colours.width(), colours.height(), 4, Samples::F32(joined))
}

/// As floats; integers that floats do not tell apart are folded into those that they do.
fn numbers(plane: &Plane) -> Vec<f32> {
    let Plane::Uint(ids) = plane else { return plane.to_f32() };
    ids.iter().map(|id| folded(*id)).collect()
}

/// The bits of floats as numbers of objects.
fn hashes(plane: &Plane) -> Vec<f32> {
    plane.to_f32().iter().map(|id| folded(id.to_bits())).collect()
}

fn folded(id: u32) -> f32 {
    (if id < EXACT { id } else { 1 + (id ^ id.rotate_right(13)) % (EXACT - 1) }) as f32
}

fn luminance(numbers: &[f32], count: usize, weights: [f32; 3]) -> Vec<f32> {
    let grey = |p: &[f32]| {
        let [r, g, b] = [p[0], p[1], p[2]];
        if r == g && g == b { r } else { r * weights[0] + g * weights[1] + b * weights[2] }
    };
    numbers.chunks_exact(count).map(grey).collect()
}

/// Red, green and blue of luminance and the ratios (R - Y) / Y and (B - Y) / Y, which have a sample at
/// every so many columns and rows; between them they are interpolated.
fn to_rgb(planes: &[Plane], window: Window, sampling: (usize, usize), weights: [f32; 3]) -> Vec<Plane> {
    let [y, ry, by] = [0, 1, 2].map(|at: usize| planes[at].to_f32());
    let width = window.width / sampling.0;
    let height = window.height / sampling.1;
    let between = |plane: &[f32], x: usize, y: usize| {
        let ((left, u), (top, v)) = ((x / sampling.0, x % sampling.0), (y / sampling.1, y % sampling.1));
        let (u, v) = (u as f32 / sampling.0 as f32, v as f32 / sampling.1 as f32);
        let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
        let row = |y: usize| {
            let (a, b) = (plane[y * width + left], plane[y * width + right]);
            if u == 0.0 { a } else { a + (b - a) * u }
        };
        if v == 0.0 { row(top) } else { row(top) + (row(bottom) - row(top)) * v }
    };
    let mut rgb = [0; 3].map(|_| Vec::with_capacity(y.len()));
    for (at, luminance) in y.iter().enumerate() {
        let (column, row) = (at % window.width, at / window.width);
        let r = (between(&ry, column, row) + 1.0) * luminance;
        let b = (between(&by, column, row) + 1.0) * luminance;
        rgb[0].push(r);
        rgb[1].push((luminance - r * weights[0] - b * weights[2]) / weights[1]);
        rgb[2].push(b);
    }
    rgb.map(Plane::Float).into()
}

/// The opposite; ratios are means over the pixels around each of their samples.
fn to_chroma(
    numbers: &[f32],
    count: usize,
    window: Window,
    sampling: (usize, usize),
    weights: [f32; 3],
) -> [Vec<f32>; 3] {
    let y = luminance(numbers, count, weights);
    let ratio = |offset: usize| {
        let full: Vec<f32> = y
            .iter()
            .enumerate()
            .map(|(at, y)| {
                let ratio = (numbers[at * count + offset] - y) / y;
                if ratio.is_finite() { ratio } else { 0.0 }
            })
            .collect();
        let mut few = Vec::with_capacity(full.len() / (sampling.0 * sampling.1));
        let tent = |distance: usize, step: usize| (step - distance) as f32;
        for row in (0..window.height).step_by(sampling.1) {
            for column in (0..window.width).step_by(sampling.0) {
                let (mut sum, mut weight) = (0.0, 0.0);
                for y in row.saturating_sub(sampling.1 - 1)..(row + sampling.1).min(window.height) {
                    for x in column.saturating_sub(sampling.0 - 1)..(column + sampling.0).min(window.width) {
                        let w = tent(x.abs_diff(column), sampling.0) * tent(y.abs_diff(row), sampling.1);
                        sum += w * full[y * window.width + x];
                        weight += w;
                    }
                }
                few.push(sum / weight);
            }
        }
        few
    };
    let (ry, by) = (ratio(0), ratio(2));
    [y, ry, by]
}
