// Tones as an artist's marks: hatching that bends over the form, crossed where it is dark, and strokes along and across
// the form where the structure is significant. What is lighter than marks can say is rubbed in smoothly.
// Cost: six loads, 8 hashes, an eigenvector and about 130 multiply-adds.
#import gpu/grid
#import shared/tensor
#import shared/mark_tones
#import shared/value_noise

struct Params {
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Pixels of the full-size picture per pixel.
    inverse_scale: f32,
    /// Distance of hatches, pixels of the full-size picture.
    spacing: f32,
    /// L from which on nothing is dark.
    light: f32,
    /// Density per unit of L below `light`.
    slope: f32,
    /// By how much middle tones are lighter than in proportion, 0..1.
    ease: f32,
    /// L from which on tones are smooth.
    smooth_from: f32,
    /// 1 / the units of L over which marks stand out.
    inverse_fade: f32,
    /// How much of the tones is rubbed in, 0..=1.
    rubbed: f32,
    /// How much of them follows the form where that is significant, 0..=1.
    form: f32,
    /// Anisotropy from which on structure is significant.
    significant: f32,
    /// 1 / standard deviation of the strokes' values.
    stroke_gain: f32,
    /// Width of strokes, pixels.
    stroke_width: f32,
    /// 1 / length of strokes, pixels.
    inverse_length: f32,
    /// How soft the edges of strokes are in the full-size picture, in values of 0..=1.
    softness: f32,
    /// 1 / standard deviation of given hatching; 0: hatching stays on the screen.
    given_gain: f32,
    /// How soft they are in this one, whose pixels may be wider.
    edge: f32,
    /// By how much less than the whole paper the darkest marks cover, 0..=1.
    open: f32,
    /// Distance that hatches bend per unit of L of the relief, pixels of the full-size picture.
    bend: f32,
    /// Share of the tone that is lifted out where a place is lighter than the relief, 0..=1.
    lift: f32,
    /// Nonzero: the hatching is what ink covers in four tones, and the second image of it the same around a place.
    drawn_tones: u32,
}

#params
// (L alpha, alpha), and the same of the relief.
#input tones
#input tensor, strokes, crossing, first_hatching, second_hatching
#output target_image r32float

const HALF: vec2f = vec2f(0.5);
// Length of strokes across the form, in lengths of those along it.
const CROSSING: f32 = 0.6;
// Densities up to which the first of two directions has all strokes, and all hatches.
const FULL_STROKES: f32 = 0.5;
const FULL_HATCHES: f32 = 0.7;
// Units of L above the relief from which on tone is lifted out, and the share of it per further unit.
const LIFT_FROM: f32 = 2.0;
const LIFT_SLOPE: f32 = 0.12;
// Share of the paper that a given tone covers at least beyond the one before.
const LEAST_STEP: f32 = 0.01;

// Density of the first of two directions that are to cover `d` together.
fn shared_out(d: f32, full: f32) -> f32 {
    return d - 0.5 * max(d - full, 0.0);
}

// Density that covers `d` together with `first`.
fn remaining(d: f32, first: f32) -> f32 {
    return 1.0 - (1.0 - d) / max(1.0 - first, 1e-6);
}

// How much of a pixel a band covers, `r` from whose middle it lies and whose half width is `s`, in pixels of the full-size
// picture.
fn covered(r: f32, s: f32) -> f32 {
    let size = min(params.inverse_scale, 0.5 * params.spacing);
    return clamp((s - r) / size + 0.5, 0.0, 1.0) - clamp((-s - r) / size + 0.5, 0.0, 1.0);
}

// Hatches of mean density `d` along `along`, `shift` aside, as if drawn by hand.
fn hatch(q: vec2f, along: vec2f, shift: f32, d: f32, seed: u32) -> f32 {
    let p = dot(q, along);
    var across = q.y * along.x - q.x * along.y + shift;
    across += params.spacing * 0.45 * (value_noise(vec2f(p, across) * (0.06 / params.spacing), seed) - 0.5);
    let phase = across / params.spacing;
    let line = floor(phase);
    // The pressure of the hand, stroke by stroke.
    let pressure = value_noise(vec2f(p * (0.11 / params.spacing), line * 7.0), seed + 57u) - 0.5;
    let density = clamp(d + 0.7 * d * (1.0 - d) * pressure, 0.0, 1.0);
    let r = abs(phase - line - 0.5) * params.spacing;
    let half_spacing = 0.5 * params.spacing;
    if density <= 0.5 {
        return covered(r, density * half_spacing);
    }
    return 1.0 - covered(half_spacing - r, (1.0 - density) * half_spacing);
}

// Strokes of mean density `d` where noise is higher than most, `z` in standard deviations.
fn stroke(z: f32, d: f32) -> f32 {
    let h = 0.5 + 0.5 * tanh(clamp(0.8 * z, -8.0, 8.0));
    let foot = d * (1.0 + params.softness);
    // What is nearly bare or nearly solid stays so.
    let room = max(min(foot, 1.0 + params.softness - foot), 0.0);
    let edge = min(room + params.softness, params.edge);
    return clamp((foot - 0.5 * params.softness - h) / edge + 0.5, 0.0, 1.0);
}

// The mean of strokes that are asked for a density: where they are thinner than their soft edges they cover less.
fn stroke_mean(d: f32) -> f32 {
    let wide = d * (1.0 + params.softness);
    return select(wide - 0.5 * params.softness, 0.5 * wide * wide / params.softness, wide < params.softness);
}

// By how much fewer grains a stroke averages beside the picture's border, where its line is cut: the root of the
// variance that it gains.
fn border_gain(p: vec2f, t: vec2f, inverse_length: f32) -> f32 {
    let size = vec2f(grid.full);
    let near = min(p, size - p);
    let cut = near * inverse_length / max(abs(t), vec2f(1e-3));
    let along = exp(-cut * (0.92 + 0.28 * cut));
    let d = near / params.stroke_width;
    let beside = exp(-d * (0.92 + 0.28 * d));
    return 1.0 / sqrt((1.0 + along.x) * (1.0 + along.y) * (1.0 + beside.x) * (1.0 + beside.y));
}

// Hatching that covers the share `d` of the paper, by tones that cover `tones` of a pixel and `around` of what is around it.
// Between two tones the darker one fades in; beyond the last all is solid.
fn given_tones(tones: vec4f, around: vec4f, d: f32) -> f32 {
    var covered = 0.0;
    var mean = 0.0;
    for (var i = 0u; i < 5u; i += 1u) {
        var tone = vec2f(1.0);
        if i < 4u {
            tone = vec2f(tones[i], around[i]);
        }
        let step = tone.y - mean;
        if step > LEAST_STEP {
            covered = mix(covered, tone.x, clamp((d - mean) / step, 0.0, 1.0));
            mean = tone.y;
        }
    }
    return covered;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let tone = fetch(tones, 0u, p);
    let lightness = tone_lightness(tone.xy);
    let ground = tone_lightness(tone.zw);
    let t = clamp((params.light - lightness) * params.slope, 0.0, 1.0);
    let eased = t * (1.0 - params.ease * (1.0 - t));
    let lifted = params.lift * rise((lightness - ground - LIFT_FROM) * LIFT_SLOPE);
    let d = (eased - params.open * eased * eased * eased) * (1.0 - lifted);
    let marked = (1.0 - params.rubbed) * rise((params.smooth_from - lightness) * params.inverse_fade);
    var density = d;
    if marked > 0.0 && params.drawn_tones != 0u {
        let drawn = given_tones(fetch(first_hatching, 4u, p), fetch(second_hatching, 5u, p), d);
        density = d + marked * (drawn - d);
    } else if marked > 0.0 {
        let structure = fetch(tensor, 1u, p);
        let tangent = tensor_tangent(structure);
        // By the change from pixel to pixel of the full-size picture.
        let gradient = sqrt(max(structure.x + structure.z, 0.0)) / params.inverse_scale;
        let form = params.form * rise((tensor_anisotropy(structure) - params.significant) * 4.0)
            * rise((gradient - 0.003) * 180.0);
        let gain = vec2f(
            border_gain(vec2f(p) + HALF, tangent, params.inverse_length),
            border_gain(vec2f(p) + HALF, tangent.yx, params.inverse_length / CROSSING),
        );
        let z = (vec2f(fetch(strokes, 2u, p).x, fetch(crossing, 3u, p).x) - HALF) * params.stroke_gain * gain;
        // What strokes along the form leave over of darks goes across it, and what both leave over is hatched.
        let followed = d * form;
        let long = shared_out(followed, FULL_STROKES);
        let crossed = remaining(followed, long);
        let rest = remaining(d, followed);
        let first = shared_out(rest, FULL_HATCHES);
        let second = remaining(rest, first);
        var hatches = vec2f(0.0);
        var means = vec2f(first, second);
        if params.given_gain > 0.0 {
            let a = (fetch(first_hatching, 4u, p).x - 0.5) * params.given_gain;
            let b = (fetch(second_hatching, 5u, p).x - 0.5) * params.given_gain;
            hatches = vec2f(stroke(a, first), stroke(b, second));
            means = vec2f(stroke_mean(first), stroke_mean(second));
        } else {
            let q = (vec2f(p) + HALF + params.origin) * params.inverse_scale;
            let shift = (ground - 50.0) * params.bend;
            hatches = vec2f(
                hatch(q, vec2f(0.8, -0.6), shift, first, 301u),
                hatch(q, vec2f(0.96, 0.28), -shift, second, 701u),
            );
        }
        var bare = (1.0 - stroke(z.x, long)) * (1.0 - stroke(z.y, crossed)) * (1.0 - hatches.x) * (1.0 - hatches.y);
        if params.rubbed > 0.0 {
            // What strokes leave bare of light tones is rubbed in, or paper would glow where smooth tones end.
            let left = (1.0 - stroke_mean(long)) * (1.0 - stroke_mean(crossed)) * (1.0 - means.x) * (1.0 - means.y);
            bare *= min((1.0 - d) / max(left, 1e-6), 1.0);
        }
        let drawn = 1.0 - bare;
        density = d + marked * (drawn - d);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(density));
}
