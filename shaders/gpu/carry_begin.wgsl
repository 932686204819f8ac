// Begin of the kernels that take a neighbouring frame into an average (`carry_colour`, `carry_value` and `carry_tensor` of
// `time`): the average's own pixel, which stays where the other frame has no share.

    if outside(id) {
        return;
    }
    let own = fetch(average, 0u, pixel(id));
    let share = fetch(shares, 2u, pixel(id)).x;
    if share <= 0.0 {
        textureStore(target_image, vec2i(id.xy), own);
        return;
    }
