// d^(−e) as `mountain::power` has it: powers that every card computes to the same few roundings.

fn log2_of(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    let exponent = bitcast<i32>(bits - SQRT_HALF_BITS) >> 23u;
    let mantissa = bitcast<f32>(bits - bitcast<u32>(exponent << 23u));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let z = s * s;
    let series = 1.0 + z * (1.0 / 3.0 + z * (1.0 / 5.0 + z * (1.0 / 7.0 + z * (1.0 / 9.0))));
    return f32(exponent) + (2.0 * LOG2_E * s) * series;
}

fn exp2_of(y: f32) -> f32 {
    let whole = round(y);
    let f = (y - whole) * LN_2;
    let series = 1.0
        + f * (1.0
            + f * (1.0 / 2.0
                + f * (1.0 / 6.0
                    + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0 + f * (1.0 / 5040.0)))))));
    return series * bitcast<f32>(u32(i32(whole) + 127) << 23u);
}
