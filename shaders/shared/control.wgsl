// Factors of control maps, of which 0.5 changes nothing. Twin of kernels/shared/control.rs.

// Distance from 0.5 that is neutral: eight bits have no exact half, and this is more than half of their step.
const CONTROL_NEUTRAL: f32 = 0.0021;

// A channel of a control map as -1..1, 0 where it is neutral or not a number.
fn control_step(value: f32) -> f32 {
    // Compared by bits: shader compilers may assume that NaN does not exist.
    let is_number = (bitcast<u32>(value) & 0x7fffffffu) <= 0x7f800000u;
    let v = select(0.5, clamp(value, 0.0, 1.0), is_number) - 0.5;
    let past = max(abs(v) - CONTROL_NEUTRAL, 0.0) * (1.0 / (0.5 - CONTROL_NEUTRAL));
    return select(past, -past, v < 0.0);
}

// Factor of 1/4 to 4 of a channel, exactly 1 where it is neutral.
fn control_factor(value: f32) -> f32 {
    let step = control_step(value);
    return select(exp2(2.0 * step), 1.0, step == 0.0);
}

// A channel with so many steps more, -1..1.
fn control_sum(value: f32, more: f32) -> f32 {
    let step = clamp(control_step(value) + more, -1.0, 1.0);
    let past = 0.5 + step * (0.5 - CONTROL_NEUTRAL) + select(CONTROL_NEUTRAL, -CONTROL_NEUTRAL, step < 0.0);
    return select(past, 0.5, step == 0.0);
}
