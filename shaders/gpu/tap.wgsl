// The side of a workgroup, and what its windows hold of a pixel: as much as the picture does. Where the picture has 16-bit
// floats, gpu/tap_half stands in the place of this text.

const GROUP_SIDE: u32 = 8u;

// Pixels that the taps of a part of a window take. Fewer leave room for more workgroups at once, which is what hides the
// time that loads take; more taps share what is loaded. Two windows of any size stay below the 16 KiB of the smallest
// devices.
//
// Windows of one row or column are gone through 8 taps at a time; their sums are the same however they are cut.
const WINDOW_LINE: i32 = 120;
// Windows of many rows and columns lose more by being cut than by waiting.
const WINDOW_AREA: i32 = 504;
// The same for shaders with sampled weights, which workgroup memory may hold besides.
const WINDOW_AREA_BESIDE_WEIGHTS: i32 = 504;
// Windows of 5 x 5 pixels, which are not cut.
const WINDOW_SMALL: i32 = 144;

alias WindowTap = vec4f;

fn window_pack(value: vec4f) -> WindowTap {
    return value;
}

fn window_unpack(tap: WindowTap) -> vec4f {
    return tap;
}
