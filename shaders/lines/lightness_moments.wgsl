// Lightness and its square for the local deviation, as sums that any linear filter may average: (L alpha, L^2 alpha, alpha).
// One highlight must not count as the contrast of all that is around it, so that lightness is bounded.
// Cost: one load and four operations.
#import gpu/grid
#import shared/coverage

#input lightness
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    let l = clamp(v.x / select(1.0, v.y, v.y > LEAST_COVERAGE), 0.0, 120.0);
    return vec4f(l * v.y, l * l * v.y, v.y, 1.0);
}
