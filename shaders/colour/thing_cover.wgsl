// Share of each pixel that some things cover, by the numbers of objects and by the names of a Cryptomatte.
// Cost: two or three loads, and about six operations for each entry of the table.
#import gpu/grid
#import shared/things

struct Params {
    /// The things that each entry is for.
    entries: array<vec4f, 64>,
    /// Number of entries, 1..=64.
    count: u32,
    /// Inputs that there are, as bits: 1 numbers of objects, 2 a Cryptomatte, 4 the shares of the entries before these.
    reads: u32,
}

#params
// Numbers of objects, a Cryptomatte, and the shares of the entries before these.
#input object_id, cryptomatte, below
#output target_image r32float

fn of_pixel(id: vec3u, object_id: vec4f, cryptomatte: vec4f, below: vec4f) -> vec4f {
    let reads = params.reads;
    var share = select(0.0, below.x, (reads & 4u) > 0u);
    let count = params.count;
    for (var i = 0u; i < count; i++) {
        share += thing_share(params.entries[i], object_id.x, cryptomatte, reads);
    }
    return vec4f(min(share, 1.0), 0.0, 0.0, 0.0);
}
