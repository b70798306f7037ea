// The looks of the pile of layers by the place in it: 0 its first surface, 1 below its last layer.

// Means over two pixels: beds thinner than those are not told apart, and nothing shimmers. `per_pixel`: how much of the
// pile lies between a pixel and the next.
fn pile_level(per_pixel: f32) -> f32 {
    return log2(max(2.0 * per_pixel * PILE_STEPS, 1.0));
}

// Means of one length, mixed along the pile.
fn pile_mean(pile: texture_2d_array<f32>, row: i32, place: f32, level: i32) -> vec4<f32> {
    let last = (i32(PILE_STEPS) >> u32(level)) - 1;
    let step = clamp(place * f32(last + 1) - 0.5, 0.0, f32(last));
    let low = i32(step);
    return mix(textureLoad(pile, vec2<i32>(low, 0), row, level),
               textureLoad(pile, vec2<i32>(min(low + 1, last), 0), row, level), step - f32(low));
}

// A row of the table at a place. By loads: a sampler that mixes levels costs software a quarter more of a frame.
fn pile_look(pile: texture_2d_array<f32>, row: i32, place: f32, level: f32) -> vec4<f32> {
    let within = clamp(level, 0.0, log2(PILE_STEPS) - 1.0);
    let low = i32(within);
    return mix(pile_mean(pile, row, place, low), pile_mean(pile, row, place, low + 1), within - f32(low));
}
