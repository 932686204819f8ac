// Paper that a host gives: its colours on white, and the depth of its grain, by how much darker it is than the paper around
// it, in standard deviations of that: 0 on peaks, 0.5 on the average, 1 in pits.
// Cost: three loads, two divisions, a root and about 30 multiply-adds.
#import gpu/grid
#import shared/coverage

// (L alpha, alpha) of the paper, and its moments (L alpha, L^2 alpha, alpha), smoothed.
#input paper, lightness, around
#output target_image rgba32float

// Depth per standard deviation of the lightness.
const DEPTH: f32 = 0.24;
// Variance of lightness, in units of L, that is the noise of a smooth sheet.
const SMOOTH: f32 = 0.25;

fn of_pixel(id: vec3u, paper: vec4f, lightness: vec4f, around: vec4f) -> vec4f {
    let covered = max(around.z, LEAST_COVERAGE);
    let mean = around.x / covered;
    let variance = max(around.y / covered - mean * mean, 0.0) + SMOOTH;
    let l = clamp(lightness.x / max(lightness.y, LEAST_COVERAGE), 0.0, 120.0);
    let deviations = (mean - l) / sqrt(variance) * clamp(lightness.y, 0.0, 1.0);
    let depth = clamp(0.5 + DEPTH * deviations, 0.0, 1.0);
    let white = vec3f(1.0);
    let color = white + (clamp(paper.rgb, vec3f(0.0), white) - white) * clamp(paper.a, 0.0, 1.0);
    return vec4f(color, depth);
}
