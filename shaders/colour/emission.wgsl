// The light of a picture beyond what its coverage can carry, as an opaque picture in the host's own space.
// Cost: one load and about ten operations.
#import gpu/grid
#import shared/host_colour

#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    return vec4f(beyond_coverage(finite(source)), 1.0);
}
