// A map of what rules say of things, by the numbers of objects and by the names of a Cryptomatte: of several rules for a thing the
// last one counts, channel by channel, as much as its things cover of a pixel.
// Cost: two or three loads, and about ten operations for each entry of the table.
#import gpu/grid
#import shared/things
#import shared/coverage

struct Params {
    /// By entry, two vectors: the things that it is for, 1 in w where its rule ends with it, and what the map has there; below 0 what it
    /// says nothing of.
    entries: array<vec4f, 128>,
    /// Values where no rule says anything.
    start: vec4f,
    /// Number of entries, 1..=64.
    count: u32,
    /// Inputs that there are, as bits: 1 numbers of objects, 2 a Cryptomatte, 4 the map of the entries before these, whose values
    /// count in the place of `start`.
    reads: u32,
    /// 1 for a map of colours, which are mixed by their coverage.
    is_paint: u32,
}

#params
// Numbers of objects, a Cryptomatte, and the map of the entries before these.
#input object_id, cryptomatte, below
#output target_image rgba32float

// Values with what a rule says over them, which counts by `share`.
fn laid_over(value: vec4f, said: vec4f, share: f32) -> vec4f {
    var mixed = value + (said - value) * share;
    if params.is_paint > 0u {
        let before = premultiply(value);
        mixed = unpremultiply(before + (premultiply(said) - before) * share);
    }
    let own = select(mixed, said, share >= 1.0);
    return select(value, own, vec4<bool>(share > 0.0) & (said >= vec4f(0.0)));
}

fn of_pixel(id: vec3u, object_id: vec4f, cryptomatte: vec4f, below: vec4f) -> vec4f {
    let reads = params.reads;
    var value = select(params.start, below, (reads & 4u) > 0u);
    var share = 0.0;
    let count = params.count;
    for (var i = 0u; i < count; i++) {
        let things = params.entries[2u * i];
        share += thing_share(things, object_id.x, cryptomatte, reads);
        if things.w > 0.0 {
            value = laid_over(value, params.entries[2u * i + 1u], min(share, 1.0));
            share = 0.0;
        }
    }
    return value;
}
