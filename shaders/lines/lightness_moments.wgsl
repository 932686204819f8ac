// Lightness and its square for the local deviation, as sums that any linear filter may average: (L alpha, L^2 alpha, alpha).
// Cost: one load and two operations.
#import gpu/grid
#import shared/coverage

#input lightness
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    let l = v.x / select(1.0, v.y, v.y > LEAST_COVERAGE);
    return vec4f(v.x, v.x * l, v.y, 1.0);
}
