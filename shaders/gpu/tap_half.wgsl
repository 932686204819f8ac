// gpu/tap for pictures of 16-bit floats, which windows hold as they are. Twice as many pixels take as much memory, and
// four times as many invocations share it: an ellipse of 12 pixels to a side takes 13 loads a pixel in the place of 27.

const GROUP_SIDE: u32 = 16u;

const WINDOW_LINE: i32 = 368;
const WINDOW_AREA: i32 = 1008;
const WINDOW_AREA_BESIDE_WEIGHTS: i32 = 544;
const WINDOW_SMALL: i32 = 400;

// Red and green, blue and alpha.
alias WindowTap = vec2u;

// A caller's own picture may hold more than 16 bits can.
fn window_pack(value: vec4f) -> WindowTap {
    let v = clamp(value, vec4f(-65504.0), vec4f(65504.0));
    return vec2u(pack2x16float(v.xy), pack2x16float(v.zw));
}

fn window_unpack(tap: WindowTap) -> vec4f {
    return vec4f(unpack2x16float(tap.x), unpack2x16float(tap.y));
}
