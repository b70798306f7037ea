// Rivers as ribbons: the water, and the meadows beside it.

struct Ribbon {
    @builtin(position) position: vec4<f32>,
    // Metres along and across, from the middle of the start.
    @location(0) place: vec2<f32>,
    @location(1) @interpolate(flat) reach: f32,
    // Half widths of the water at both ends, metres.
    @location(2) @interpolate(flat) half_widths: vec2<f32>,
    // Share of a large river at both ends.
    @location(3) @interpolate(flat) large: vec2<f32>,
}

struct Reach {
    // Plan metres.
    @location(0) from_to: vec4<f32>,
    // Half widths, metres.
    @location(1) half_widths: vec2<f32>,
    // How large the river is, 0 to 1, for the meadows.
    @location(2) large: vec2<f32>,
}

// A piece with so much around it, metres.
fn around(index: u32, reach: Reach, margin: f32) -> Ribbon {
    let along = reach.from_to.zw - reach.from_to.xy;
    let reach_m = max(length(along), 1e-3);
    let way = along / reach_m;
    let across = vec2<f32>(-way.y, way.x);
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    let place = vec2<f32>(mix(-margin, reach_m + margin, corner.x), mix(-margin, margin, corner.y));
    let plan = reach.from_to.xy + way * place.x + across * place.y;
    let ndc = plan / ground.extent * 2.0 - 1.0;
    return Ribbon(vec4<f32>(ndc, 0.0, 1.0), place, reach_m, reach.half_widths, reach.large);
}

@vertex
fn ribbon(@builtin(vertex_index) index: u32, reach: Reach) -> Ribbon {
    let texel = ground.extent.x / ground.sheet.x;
    return around(index, reach, max(reach.half_widths.x, reach.half_widths.y) + 1.5 * texel);
}

@vertex
fn meadow_ribbon(@builtin(vertex_index) index: u32, reach: Reach) -> Ribbon {
    // Brooks have none.
    return around(index, reach, select(0.0, MEADOW, max(reach.large.x, reach.large.y) > 0.0));
}

// How far along a piece, and how far from it, metres.
fn nearest(ribbon: Ribbon) -> vec2<f32> {
    let along = clamp(ribbon.place.x / ribbon.reach, 0.0, 1.0);
    return vec2<f32>(along, length(vec2<f32>(ribbon.place.x - along * ribbon.reach, ribbon.place.y)));
}

// Ribbons are joined by the greater of both.
@fragment
fn river(ribbon: Ribbon) -> @location(0) vec4<f32> {
    let near = nearest(ribbon);
    let half_width = mix(ribbon.half_widths.x, ribbon.half_widths.y, near.x);
    let texel = ground.extent.x / ground.sheet.x;
    // Thinner than a texel a river is paler instead.
    let seen = max(half_width, 0.5 * texel);
    let water = clamp((seen - near.y) / texel + 0.5, 0.0, 1.0) * min(half_width / (0.5 * texel), 1.0);
    return vec4<f32>(water, 0.0, 0.0, 1.0);
}

@fragment
fn meadow(ribbon: Ribbon) -> @location(0) vec4<f32> {
    let near = nearest(ribbon);
    let part = 1.0 - smoothstep(0.0, MEADOW, near.y);
    return vec4<f32>(part * part * mix(ribbon.large.x, ribbon.large.y, near.x), 0.0, 0.0, 1.0);
}

@group(0) @binding(1) var fresh: texture_2d<f32>;

// The rivers as they are, to be mixed into the rivers as drawn.
@fragment
fn soak(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(fresh, vec2<i32>(position.xy), 0);
}
