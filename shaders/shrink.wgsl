// One level of a texture from the one below: the mean of four.

@group(0) @binding(0) var larger: texture_2d<f32>;
@group(0) @binding(1) var between: sampler;

@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn shrink(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let size = max(textureDimensions(larger) / 2u, vec2<u32>(1u));
    return textureSampleLevel(larger, between, position.xy / vec2<f32>(size), 0.0);
}
