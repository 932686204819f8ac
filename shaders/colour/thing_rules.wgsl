// A map of what rules say of things, by the numbers of objects: of several rules for a thing the last one counts, channel by
// channel.
// Cost: one or two loads, and about six operations for each entry of the table.
#import gpu/grid
#import shared/breaks

struct Params {
    /// By entry, two vectors: first and last number that it is for, and what the map has there; below 0 what it says nothing of.
    entries: array<vec4f, 128>,
    /// Values where no rule says anything.
    start: vec4f,
    /// Number of entries, 1..=64.
    count: u32,
    /// 1 where the values of `below` count in the place of `start`.
    has_below: u32,
}

#params
// Numbers of objects, and the map of the entries before these.
#input object_id, below
#output target_image rgba32float

fn of_pixel(id: vec3u, object_id: vec4f, below: vec4f) -> vec4f {
    let number = known_id(object_id.x);
    var value = select(params.start, below, params.has_below > 0u);
    let count = params.count;
    for (var i = 0u; i < count; i++) {
        let range = params.entries[2u * i].xy;
        let said = params.entries[2u * i + 1u];
        let is_meant = number >= range.x && number <= range.y;
        value = select(value, said, vec4<bool>(is_meant) & (said >= vec4f(0.0)));
    }
    return value;
}
