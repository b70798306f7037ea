// The land as drawn grows towards the land as it is.

@group(0) @binding(1) var drawn_height: texture_2d<f32>;
@group(0) @binding(2) var drawn_water: texture_2d<f32>;
@group(0) @binding(3) var new_height: texture_2d<f32>;
@group(0) @binding(4) var new_water: texture_2d<f32>;
@group(0) @binding(5) var drawn_layers: texture_2d<f32>;
@group(0) @binding(6) var new_layers: texture_2d<f32>;

struct Grown {
    // Metres.
    @location(0) height: f32,
    // Part under water, drainage, root of the lake depth: each as part of what a byte holds.
    @location(1) water: vec4<f32>,
    // Place in the pile of the rock at the surface, less a half; thickness of the sediment on it, metres.
    @location(2) layers: vec4<f32>,
}

@fragment
fn grow(@builtin(position) position: vec4<f32>) -> Grown {
    let at = vec2<i32>(position.xy);
    // The outermost nodes are held by the border; the land just inside goes on to the edge in their place.
    let rim = vec2<i32>(i32(ground.rim));
    let inside = clamp(at, rim, vec2<i32>(ground.grid) - 1 - rim);
    var grown: Grown;
    grown.height = mix(textureLoad(drawn_height, at, 0).x, textureLoad(new_height, inside, 0).x, ground.blend);
    grown.water = mix(textureLoad(drawn_water, at, 0), textureLoad(new_water, at, 0), ground.blend);
    grown.layers = mix(textureLoad(drawn_layers, at, 0), textureLoad(new_layers, inside, 0), ground.blend);
    return grown;
}
