// Linear light and sRGB.

// sRGB from linear light by roots, which cost less than powers; off by less than 0.003 (after Taylor 2013).
fn encoded(linear: vec3<f32>) -> vec3<f32> {
    let c = clamp(linear, vec3<f32>(0.0), vec3<f32>(1.0));
    let root = sqrt(c);
    let fourth = sqrt(root);
    return clamp(0.662002687 * root + 0.684122060 * fourth - 0.323583601 * sqrt(fourth) - 0.0225411470 * c,
                 vec3<f32>(0.0), vec3<f32>(1.0));
}

// Back again, as closely (after Taylor 2013).
fn decoded(c: vec3<f32>) -> vec3<f32> {
    return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878);
}
