// Tones that marks and their grain begin at. Twin of kernels/shared/mark_tones.rs.

// A ramp from 0 to 1.
fn rise(t: f32) -> f32 {
    let c = clamp(t, 0.0, 1.0);
    return c * c * (3.0 - 2.0 * c);
}

// Lightness of (L alpha, alpha); that of paper where nothing is covered.
fn tone_lightness(v: vec2f) -> f32 {
    return select(100.0, v.x / v.y, v.y > 1e-4);
}
