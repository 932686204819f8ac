// The colour of the pixel at the place of the greatest noise along the stream line of a tensor field (§ 5.1):
// glass patterns of a picture.
// Cost: per step one bilinear sample of the noise and two tensor samples with their tangents.
#import shared/stream

struct Params {
    /// Arc length of each side of the line, pixels.
    length: f32,
    /// 1: shorter where the orientation is uncertain (6.3.1); 0: the same everywhere.
    adapt: u32,
}

#params
#input source, tensors, noise
#output target_image rgba32float

const INPUT_TENSORS = 1u;
const INPUT_NOISE = 2u;

// Where the noise is greatest on both sides of the line through `origin`, up to `limit` pixels away; it is `first`
// there.
fn greatest(origin: vec2f, tangent: vec2f, limit: f32, first: f32, inside: bool) -> vec2f {
    var place = origin;
    var most = first;
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        var line = stream_begin(origin, side * tangent, inside);
        for (var u = 1.0; u <= limit; u += 1.0) {
            stream_step(&line, tensors, INPUT_TENSORS, 1.0, STREAM_MIDPOINT);
            if stream_ends(line, 0u) {
                break;
            }
            let value = sample_among(noise, stream_surroundings(line, INPUT_NOISE, line.position)).x;
            if value > most {
                most = value;
                place = line.position;
            }
        }
    }
    return place;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let origin = centre(id);
    let tensor = fetch(tensors, INPUT_TENSORS, pixel(id));
    var limit = params.length;
    if params.adapt != 0u {
        let certain = 1.0 + tensor_anisotropy(tensor);
        limit *= 0.25 * certain * certain;
    }
    limit += 1e-3;
    let tangent = tensor_tangent(tensor);
    let first = fetch(noise, INPUT_NOISE, pixel(id)).x;
    var place: vec2f;
    if stream_inside(INPUT_TENSORS, origin, limit) && stream_inside(INPUT_NOISE, origin, limit) {
        place = greatest(origin, tangent, limit, first, true);
    } else {
        place = greatest(origin, tangent, limit, first, false);
    }
    let own = fetch(source, 0u, pixel(id));
    let found = fetch(source, 0u, vec2i(floor(place)));
    let color = select(own.rgb, found.rgb, found.a >= 0.5);
    textureStore(target_image, vec2i(id.xy), vec4f(color, own.a));
}
