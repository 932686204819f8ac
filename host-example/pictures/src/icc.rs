//! ICC profiles: the meaning of numbers that they give, pictures through their tables, and profiles for writers.
//!
//! Source: ICC.1:2022, sections 8 to 10 and annex F.

use std::sync::Arc;

use moxcms::{
    CicpProfile, ColorDateTime, ColorProfile, DataColorSpace, Layout, LocalizableString, MatrixCoefficients,
    PointeeSizeExpressible, ProfileText, RenderingIntent, ToneReprCurve, TransformExecutor, TransformOptions,
    Vector3d, WHITE_POINT_D50, WHITE_POINT_D65, XyY, Xyzd, adaption_matrix_d,
};
use rayon::prelude::*;

use crate::cicp;
use crate::meaning::{Meaning, profile_is_of};
use crate::pixels::{Pixels, Samples};
use crate::primaries::{self, Chromaticities};
use crate::transfer::{Curve, Transfer, srgb_encode};

/// The part of a file that says which colours are meant.
pub const NAME: &str = "ICC profile";
/// Samples of a profile's curve.
const SAMPLES: usize = 4096;
/// Curves that differ by less than this, encoded for displays, are the same: a step of 8 bits.
const SAME: f32 = 1.0 / 256.0;

/// Numbers that a profile explains.
enum Kind {
    /// Primaries and transfer say all.
    Shaper(Chromaticities, Transfer),
    /// Grey by a transfer.
    Grey(Transfer),
    /// Tables lead to the colours.
    Tables(Box<ColorProfile>),
}

/// Kind of the profile; nothing where it is damaged or says nothing that is understood.
fn parse(bytes: &[u8]) -> Option<Kind> {
    let profile = ColorProfile::new_from_slice(bytes).ok()?;
    match profile.color_space {
        DataColorSpace::Gray => {
            let curve = curve(profile.gray_trc.as_ref()?)?;
            Some(Kind::Grey(transfer([curve.clone(), curve.clone(), curve], [profile.gray_trc.as_ref(); 3])?))
        }
        DataColorSpace::Rgb => Some(match shaper(&profile) {
            Some((primaries, transfer)) => Kind::Shaper(primaries, transfer),
            None if has_tables(&profile) => Kind::Tables(Box::new(profile)),
            None => return None,
        }),
        DataColorSpace::Cmyk if has_tables(&profile) => Some(Kind::Tables(Box::new(profile))),
        _ => None,
    }
}

fn has_tables(profile: &ColorProfile) -> bool {
    profile.lut_a_to_b_perceptual.is_some() || profile.lut_a_to_b_colorimetric.is_some()
}

/// Primaries and transfer of a profile that has no more to say.
fn shaper(profile: &ColorProfile) -> Option<(Chromaticities, Transfer)> {
    if let Some(CicpProfile { color_primaries, transfer_characteristics, .. }) = profile.cicp
        && let Some(primaries) = cicp::primaries(color_primaries as u8)
        && let Some(transfer) = cicp::transfer(transfer_characteristics as u8)
    {
        return Some((primaries, transfer));
    }
    let tone = [&profile.red_trc, &profile.green_trc, &profile.blue_trc].map(Option::as_ref);
    let curves = [curve(tone[0]?)?, curve(tone[1]?)?, curve(tone[2]?)?];
    Some((chromaticities(profile)?, transfer(curves, tone)?))
}

/// Chromaticities under the white that the device has; profiles write them under D50.
fn chromaticities(profile: &ColorProfile) -> Option<Chromaticities> {
    let xyz = |point: Xyzd| [point.x, point.y, point.z];
    let d50 = xyz(WHITE_POINT_D50.to_xyzd());
    let white = match (profile.chromatic_adaptation, profile.media_white_point.map(xyz)) {
        (Some(adaptation), _) => adaptation.inverse().mul_vector(Vector3d { v: d50 }).v,
        // Old profiles write the white of the device instead.
        (None, Some(white)) if (white[0] - d50[0]).abs() > 0.005 => white,
        // Which white is chosen makes no colour another.
        _ => xyz(WHITE_POINT_D65.to_xyzd()),
    };
    let colorants = [profile.red_colorant, profile.green_colorant, profile.blue_colorant].map(xyz);
    primaries::of_colorants(colorants, white)
}

/// A curve of a profile, sampled.
fn curve(tone: &ToneReprCurve) -> Option<Vec<f32>> {
    let evaluator = tone.make_linear_evaluator().ok()?;
    let sample = |i| evaluator.evaluate_value(i as f32 / (SAMPLES - 1) as f32).clamp(0.0, 1.0);
    let samples: Vec<f32> = (0..SAMPLES).map(sample).collect();
    samples.iter().all(|v| v.is_finite()).then_some(samples)
}

/// The transfer that three curves are, by its name where it has one.
fn transfer(curves: [Vec<f32>; 3], tone: [Option<&ToneReprCurve>; 3]) -> Option<Transfer> {
    let mut named = vec![Transfer::Srgb, Transfer::Linear, Transfer::Rec709];
    match tone[0] {
        Some(ToneReprCurve::Parametric(parameters)) if parameters.len() == 1 => {
            named.insert(0, Transfer::Gamma(parameters[0]));
        }
        Some(ToneReprCurve::Lut(lut)) if lut.len() == 1 => {
            named.insert(0, Transfer::Gamma(f32::from(lut[0]) / 256.0));
        }
        _ => {}
    }
    let is = |transfer: &Transfer| {
        curves.iter().all(|curve| {
            curve.iter().enumerate().all(|(i, light)| {
                let [own, ..] = transfer.decode([i as f32 / (SAMPLES - 1) as f32; 3]);
                (srgb_encode(own.clamp(0.0, 1.0)) - srgb_encode(*light)).abs() < SAME
            })
        })
    };
    match named.into_iter().find(is) {
        Some(Transfer::Gamma(1.0)) => Some(Transfer::Linear),
        Some(transfer) => Some(transfer),
        None => {
            let [r, g, b] = curves.map(Curve::new);
            Some(Transfer::Curves(Arc::new([r?, g?, b?])))
        }
    }
}

/// The meaning of numbers with a profile. Those that only tables explain become sRGB. `is_grey` says that a picture of colours
/// has none.
pub fn meant(mut meaning: Meaning, profile: Vec<u8>, pixels: &mut Pixels, is_grey: bool) -> Meaning {
    let fits = profile_is_of(&profile, 3) || is_grey && profile_is_of(&profile, 1);
    if !fits {
        meaning.warnings.push(format!("its {NAME} is of other channels and left aside"));
        return meaning;
    }
    match parse(&profile) {
        Some(Kind::Shaper(primaries, transfer)) => {
            meaning.primaries = primaries;
            meaning.transfer = transfer;
        }
        Some(Kind::Grey(transfer)) => meaning.transfer = transfer,
        Some(Kind::Tables(tables)) => match through(&tables, pixels) {
            Some(converted) => {
                *pixels = converted;
                return Meaning { said_by: Some(NAME), ..meaning };
            }
            None => meaning.warnings.push(format!("its {NAME} is not understood and left aside")),
        },
        None => meaning.warnings.push(format!("its {NAME} is not understood; results carry it on")),
    }
    Meaning { said_by: Some(NAME), profile: Some(profile.into()), ..meaning }
}

/// Pictures of inks (0 for none) through the tables of their profile, as sRGB; nothing where the profile is of something else.
pub fn of_inks(profile: &[u8], inks: &Pixels) -> Option<Pixels> {
    match parse(profile)? {
        Kind::Tables(tables) if tables.color_space == DataColorSpace::Cmyk => through(&tables, inks),
        _ => None,
    }
}

/// Integers through tables, as sRGB.
fn through(tables: &ColorProfile, pixels: &Pixels) -> Option<Pixels> {
    let (width, height, channels) = (pixels.width(), pixels.height(), pixels.channels());
    let (from, to, results) = match (tables.color_space, channels) {
        (DataColorSpace::Cmyk, 4) => (Layout::Rgba, Layout::Rgb, 3),
        (DataColorSpace::Rgb, 3) => (Layout::Rgb, Layout::Rgb, 3),
        (DataColorSpace::Rgb, 4) => (Layout::Rgba, Layout::Rgba, 4),
        _ => return None,
    };
    let srgb = ColorProfile::new_srgb();
    let rendering_intent = match tables.lut_a_to_b_perceptual {
        Some(_) => RenderingIntent::Perceptual,
        None => RenderingIntent::RelativeColorimetric,
    };
    let options = TransformOptions { rendering_intent, ..TransformOptions::default() };
    let rows = (width as usize * channels as usize, width as usize * results as usize);
    let samples = match pixels.samples() {
        Samples::U8(from8) => {
            let transform = tables.create_transform_8bit(from, &srgb, to, options).ok()?;
            Samples::U8(by_rows(&*transform, from8, rows)?)
        }
        Samples::U16(from16) => {
            let transform = tables.create_transform_16bit(from, &srgb, to, options).ok()?;
            Samples::U16(by_rows(&*transform, from16, rows)?)
        }
        Samples::F16(_) | Samples::F32(_) => return None,
    };
    Pixels::new(width, height, results, samples)
}

fn by_rows<T: PointeeSizeExpressible + Copy + Default + Send + Sync>(
    transform: &(dyn TransformExecutor<T> + Send + Sync),
    from: &[T],
    (row, result): (usize, usize),
) -> Option<Vec<T>> {
    let mut to = vec![T::default(); from.len() / row * result];
    let rows = to.par_chunks_exact_mut(result).zip(from.par_chunks_exact(row));
    let is_done = rows.map(|(to, from)| transform.transform(from, to).is_ok()).reduce(|| true, |a, b| a && b);
    is_done.then_some(to)
}

/// A profile of a meaning, for files that say by nothing else what their numbers mean; nothing for curves that no profile gave.
pub fn made(meaning: &Meaning) -> Option<Vec<u8>> {
    let curve = match &meaning.transfer {
        Transfer::Linear => ToneReprCurve::Parametric(vec![1.0]),
        Transfer::Gamma(gamma) => ToneReprCurve::Parametric(vec![*gamma]),
        Transfer::Srgb => {
            ToneReprCurve::Parametric(vec![2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045])
        }
        Transfer::Rec709 => {
            let scale = 1.0 / 1.099_296_8;
            ToneReprCurve::Parametric(vec![1.0 / 0.45, scale, 0.099_296_8 * scale, 1.0 / 4.5, 0.081_242_86])
        }
        Transfer::Pq | Transfer::Hlg => sampled(&meaning.transfer),
        Transfer::Curves(_) => return None,
    };
    let [rx, ry, gx, gy, bx, by, wx, wy] = meaning.primaries.map(f64::from);
    let mut profile = ColorProfile::new_srgb();
    let point = |x: f64, y: f64| Xyzd::new(x / y, 1.0, (1.0 - x - y) / y);
    let colorants = [point(rx, ry), point(gx, gy), point(bx, by)];
    profile.update_rgb_colorimetry_triplet(XyY::new(wx, wy, 1.0), colorants[0], colorants[1], colorants[2]);
    profile.chromatic_adaptation =
        Some(adaption_matrix_d(XyY::new(wx, wy, 1.0).to_xyz(), WHITE_POINT_D50.to_xyz()));
    profile.media_white_point = Some(WHITE_POINT_D50.to_xyzd());
    profile.cicp = code_points(meaning);
    profile.red_trc = Some(curve.clone());
    profile.green_trc = Some(curve.clone());
    profile.blue_trc = Some(curve);
    // The same file at any time.
    profile.creation_date_time =
        ColorDateTime { year: 2000, month: 1, day_of_the_month: 1, hours: 0, minutes: 0, seconds: 0 };
    let text = |text: String| {
        ProfileText::Localizable(vec![LocalizableString::new("en".to_owned(), "US".to_owned(), text)])
    };
    profile.description = Some(text(meaning.words()));
    profile.copyright = Some(text("Public Domain".to_owned()));
    profile.encode().ok()
}

/// A curve from black to the brightest light.
fn sampled(transfer: &Transfer) -> ToneReprCurve {
    let light = |i| transfer.decode([i as f32 / (SAMPLES - 1) as f32; 3])[0];
    let brightest = light(SAMPLES - 1);
    ToneReprCurve::Lut((0..SAMPLES).map(|i| (light(i) / brightest * 65535.0 + 0.5) as u16).collect())
}

/// The code points of PQ and HLG, whose curve alone does not say how bright white is.
fn code_points(meaning: &Meaning) -> Option<CicpProfile> {
    if !matches!(meaning.transfer, Transfer::Pq | Transfer::Hlg) {
        return None;
    }
    Some(CicpProfile {
        color_primaries: cicp::code_of_primaries(meaning.primaries)?.try_into().ok()?,
        transfer_characteristics: cicp::code_of_transfer(&meaning.transfer)?.try_into().ok()?,
        matrix_coefficients: MatrixCoefficients::Identity,
        full_range: true,
    })
}
