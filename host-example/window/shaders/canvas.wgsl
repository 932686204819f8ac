// The canvas of the window: one picture or two, before and after, wherever pan and zoom put them, on neutral grey.

struct Settings {
    // Left and top, width and height of the canvas, in pixels of the window.
    area: vec4f,
    // So of the pictures on the left and on the right of the split.
    places: array<vec4f, 2>,
    // What the numbers of each picture are; in z, whether the surface wants encoded values; in w, what becomes of pixels.
    kinds: vec4u,
    // Column at which the right picture begins; factor on light; half-way distance of depths; width of a square.
    numbers: vec4f,
    // What surrounds the pictures, as it is shown; in w, the factor on their difference.
    surround: vec4f,
}

const LINEAR = 0u;
const SRGB = 1u;
const ACESCG = 2u;
const GREY = 3u;
const NORMAL = 4u;
const DEPTH = 5u;
const OBJECT_ID = 6u;
const MOTION = 7u;

// What becomes of pixels, where they are not seen as they are.
const DIFFERENCE = 1u;
const SAMPLES = 2u;

// Samples along each side of a pixel, at most, where pictures are made smaller.
const MOST_TAPS = 4.0;

@group(0) @binding(0) var<uniform> settings: Settings;
@group(0) @binding(1) var left: texture_2d<f32>;
@group(0) @binding(2) var right: texture_2d<f32>;

@vertex
fn canvas_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

fn encoded(light: vec3f) -> vec3f {
    let curve = 1.055 * pow(max(light, vec3f(0.0)), vec3f(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * light, light <= vec3f(0.0031308));
}

fn decoded(value: vec3f) -> vec3f {
    let curve = pow((max(value, vec3f(0.0)) + 0.055) / 1.055, vec3f(2.4));
    return select(curve, value / 12.92, value <= vec3f(0.04045));
}

// A colour of this hue, from 0 to 1, as it is shown.
fn hue(turn: f32) -> vec3f {
    return clamp(abs(fract(vec3f(turn) + vec3f(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, vec3f(0.0), vec3f(1.0));
}

// A texel as premultiplied light.
fn light(kind: u32, texel: vec4f) -> vec4f {
    switch kind {
        case LINEAR: { return vec4f(texel.rgb * settings.numbers.y, texel.a); }
        case SRGB: {
            // Its colour is not multiplied by alpha.
            return vec4f(decoded(texel.rgb) * texel.a * settings.numbers.y, texel.a);
        }
        case ACESCG: {
            let to_rec709 = mat3x3f(
                vec3f(1.7050510, -0.1302564, -0.0240034),
                vec3f(-0.6217921, 1.1408048, -0.1289690),
                vec3f(-0.0832589, -0.0105484, 1.1529724),
            );
            return vec4f(to_rec709 * texel.rgb * settings.numbers.y, texel.a);
        }
        case GREY: { return vec4f(decoded(vec3f(texel.r)) * settings.numbers.y, 1.0); }
        case NORMAL: {
            let exists = dot(texel.xyz, texel.xyz) > 0.0;
            return vec4f(select(vec3f(0.0), decoded(texel.xyz * 0.5 + 0.5), exists), 1.0);
        }
        case DEPTH: {
            let near = settings.numbers.z / (max(texel.r, 0.0) + settings.numbers.z);
            return vec4f(select(vec3f(0.0), decoded(vec3f(near)), texel.r > 0.0), 1.0);
        }
        case OBJECT_ID: {
            let color = decoded(hue(fract(texel.r * 0.61803399)) * 0.6 + 0.25);
            return vec4f(select(vec3f(0.0), color, texel.r != 0.0), 1.0);
        }
        default: {
            // The farther something moves, the more colour it has; its hue says whither.
            let way = length(texel.rg);
            let color = mix(vec3f(0.5), hue(atan2(texel.g, texel.r) / 6.2831853 + 0.5), way / (way + 8.0));
            return vec4f(decoded(color), 1.0);
        }
    }
}

fn texel(is_right: bool, kind: u32, at: vec2i) -> vec4f {
    if is_right {
        let last = vec2i(textureDimensions(right)) - 1;
        return light(kind, textureLoad(right, clamp(at, vec2i(0), last), 0));
    }
    let last = vec2i(textureDimensions(left)) - 1;
    return light(kind, textureLoad(left, clamp(at, vec2i(0), last), 0));
}

fn smoothed(is_right: bool, kind: u32, at: vec2f) -> vec4f {
    let corner = floor(at - 0.5);
    let share = at - 0.5 - corner;
    let cell = vec2i(corner);
    let above = mix(texel(is_right, kind, cell), texel(is_right, kind, cell + vec2i(1, 0)), share.x);
    let below = mix(texel(is_right, kind, cell + vec2i(0, 1)), texel(is_right, kind, cell + 1), share.x);
    return mix(above, below, share.y);
}

// What is shown of a picture at a place of the window; alpha is 0 beside it.
fn picture(is_right: bool, position: vec2f) -> vec4f {
    let place = settings.places[u32(is_right)];
    let kind = settings.kinds[u32(is_right)];
    let within = (position - place.xy) / place.zw;
    if any(within < vec2f(0.0)) || any(within >= vec2f(1.0)) {
        return vec4f(-1.0);
    }
    var size = vec2f(textureDimensions(left));
    if is_right {
        size = vec2f(textureDimensions(right));
    }
    let at = within * size;
    let step = size / place.zw;
    // Numbers that stand for things have no means.
    if all(step <= vec2f(0.5)) || all(abs(step - 1.0) < vec2f(1e-3)) || kind == OBJECT_ID || settings.kinds.w == SAMPLES {
        return texel(is_right, kind, vec2i(floor(at)));
    }
    let taps = clamp(ceil(max(step.x, step.y) * 0.5), 1.0, MOST_TAPS);
    var sum = vec4f(0.0);
    for (var y = 0.5; y < taps; y += 1.0) {
        for (var x = 0.5; x < taps; x += 1.0) {
            sum += smoothed(is_right, kind, at + (vec2f(x, y) / taps - 0.5) * step);
        }
    }
    return sum / (taps * taps);
}

fn shown(light: vec3f) -> vec4f {
    let value = clamp(light, vec3f(0.0), vec3f(1.0));
    return vec4f(select(value, encoded(value), settings.kinds.z != 0u), 1.0);
}

// How far apart both pictures are at a place of the window, as they are seen, where they cover it.
fn difference(before: vec4f, after: vec4f) -> vec3f {
    let one = vec3f(1.0);
    let apart = encoded(min(before.rgb, one)) - encoded(min(after.rgb, one));
    return decoded(min(abs(apart) * settings.surround.w, one));
}

@fragment
fn canvas_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let found = picture(position.x >= settings.numbers.x, position.xy);
    if found.a < 0.0 {
        return shown(decoded(settings.surround.rgb));
    }
    if settings.kinds.w == SAMPLES {
        let colour = clamp(found.rgb / max(found.a, 1e-4), vec3f(0.0), vec3f(1.0));
        return vec4f(encoded(colour), clamp(found.a, 0.0, 1.0));
    }
    if settings.kinds.w == DIFFERENCE {
        return shown(difference(picture(false, position.xy), found));
    }
    let square = vec2i(floor((position.xy - settings.area.xy) / settings.numbers.w));
    let checker = decoded(vec3f(select(0.22, 0.28, ((square.x + square.y) & 1) == 0)));
    return shown(found.rgb + checker * clamp(1.0 - found.a, 0.0, 1.0));
}
