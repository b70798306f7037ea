// The land in the window: the sheet laid on the heights, seen through air, under a sky.

struct View {
    // Plan metres and drawn height to clip space.
    view_proj: mat4x4<f32>,
    // From clip space back to directions, for the sky.
    eye: vec4<f32>,
    right: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    // Size of the land, metres.
    extent: vec2<f32>,
    // Cells of the mesh over the land.
    mesh: vec2<f32>,
    // Rectangle of the land in the plan, clip space: corner and size.
    plan: vec4<f32>,
    // 0 in plan, 1 in oblique view.
    tilt: f32,
    // Heights are drawn so many times as high.
    exaggeration: f32,
    lowland: f32,
    summit: f32,
    // How thick the air is, 1 as usual.
    haze: f32,
    // Part of the light that is left, 0 to 1.
    lamp: f32,
    // 1 if the target encodes colours by itself.
    encoded: f32,
    // Share of the evening's colours, 0 to 1.
    dusk: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var sheet_sampler: sampler;
@group(0) @binding(2) var sheet: texture_2d<f32>;
@group(0) @binding(3) var stand: texture_2d<f32>;
@group(0) @binding(4) var<uniform> air: Air;
@group(0) @binding(5) var evening_sheet: texture_2d<f32>;

// Colours of the air, in linear light.
struct Air {
    // The haze of the plan.
    valley: vec4<f32>,
    // Mist over low land, and the blue of distance.
    mist: vec4<f32>,
    distance: vec4<f32>,
    // The sky at the horizon towards the sun, away from it, above it, and overhead.
    glow: vec4<f32>,
    horizon: vec4<f32>,
    middle: vec4<f32>,
    zenith: vec4<f32>,
    // What is around the plan.
    table: vec4<f32>,
}

// Beyond its border the land is seen as in a mirror, ever flatter and dimmer, so far, metres; then only mist.
const BEYOND = 60000.0;
// Where the mist ends, behind the horizon, metres.
const FARTHEST = 260000.0;

fn encode(colour: vec3<f32>) -> vec3<f32> {
    let c = clamp(colour * view.lamp, vec3<f32>(0.0), vec3<f32>(1.0));
    let gamma = select(1.055 * pow(c, vec3<f32>(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3<f32>(0.0031308));
    return select(gamma, c, view.encoded > 0.5);
}

// As `encode`, with half a step of the target's colours more or less (Jimenez 2014, interleaved gradient noise): where
// tones pass into each other slowly, no bands are seen.
fn dithered(colour: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let noise = fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715)))) - 0.5;
    let c = encode(colour);
    // One step of an encoded target is smaller in its shadows.
    let step = select(vec3<f32>(1.0), 2.2 * pow(c, vec3<f32>(0.545)), view.encoded > 0.5);
    return c + step * noise / 255.0;
}

// Plan.

struct PlanPoint {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn plan_quad(@builtin(vertex_index) index: u32) -> PlanPoint {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    return PlanPoint(vec4<f32>(view.plan.xy + corner * view.plan.zw, 0.0, 1.0), vec2<f32>(corner.x, 1.0 - corner.y));
}

// The air over low land: contrast grows with height.
fn through_valley_air(colour: vec3<f32>, height: f32) -> vec3<f32> {
    let share = smoothstep(0.0, view.summit, height);
    return mix(colour, air.valley.rgb, 0.13 * view.haze * (1.0 - share) * (1.0 - share));
}

@fragment
fn plan(point: PlanPoint) -> @location(0) vec4<f32> {
    let seen = textureSample(sheet, sheet_sampler, point.uv);
    let height = textureSampleLevel(stand, sheet_sampler, point.uv, 0.0).x * 1000.0;
    return vec4<f32>(encode(through_valley_air(seen.rgb, height)), 1.0);
}

// Perspective.

struct MeshPoint {
    @builtin(position) position: vec4<f32>,
    @location(0) plan: vec2<f32>,
    @location(1) height: f32,
}

// Vertices stand in rows from north to south; RINGS of them are beyond the border, ever farther apart.
@vertex
fn mesh(@builtin(vertex_index) index: u32) -> MeshPoint {
    let columns = u32(view.mesh.x) + 1u + 2u * u32(RINGS);
    let cell = vec2<f32>(f32(index % columns), f32(index / columns)) - RINGS;
    let inner = clamp(cell, vec2<f32>(0.0), view.mesh);
    let rings = cell - inner;
    let part = abs(rings) / (RINGS - 1.0);
    let away = select(BEYOND * (exp(3.0 * part) - 1.0) / (exp(3.0) - 1.0), vec2<f32>(FARTHEST), abs(rings) > vec2<f32>(RINGS - 0.5));
    let grid = inner / view.mesh * view.extent + sign(rings) * away;
    let height = textureSampleLevel(stand, sheet_sampler, grid / view.extent, 0.0).x * 1000.0;
    let fade = 1.0 - smoothstep(0.0, 0.8 * BEYOND, length(away * sign(abs(rings))));
    let plan = vec2<f32>(grid.x, view.extent.y - grid.y);
    let drawn = mix(view.lowland, height, fade);
    return MeshPoint(view.view_proj * vec4<f32>(plan, drawn * view.exaggeration, 1.0), plan, drawn);
}

// How much a direction is the sun's, 0 to 1.
fn towards_sun(way: vec3<f32>) -> f32 {
    return 0.5 + 0.5 * dot(normalize(way.xy + vec2<f32>(1e-5, 0.0)), vec2<f32>(EVENING_EAST, EVENING_NORTH));
}

// The sky in a direction (unit length).
fn sky_colour(way: vec3<f32>) -> vec3<f32> {
    let towards = towards_sun(way);
    let near = towards * towards;
    let rise = clamp(way.z, 0.0, 1.0);
    // Below the horizon lies the blue mist of far plains.
    let under = smoothstep(0.0, 0.16, -way.z);
    let rim = mix(mix(air.horizon.rgb, air.glow.rgb, near), air.distance.rgb, 0.62 * under * (1.0 - 0.6 * near));
    let above = mix(air.middle.rgb, mix(air.middle.rgb, air.glow.rgb, 0.45), near * near);
    return mix(mix(air.zenith.rgb, above, exp(-3.2 * rise)), rim, exp(-16.0 * rise));
}

// How deep the air is on the way to a place, if it is `depth` deep overhead and thins out by e every `scale` metres.
fn air_depth(depth: f32, scale: f32, height: f32, eye: f32, distance: f32) -> f32 {
    let down = max(eye - height, 1.0);
    return depth * distance / down * (exp(-height / scale) - exp(-eye / scale));
}

@fragment
fn terrain(point: MeshPoint) -> @location(0) vec4<f32> {
    let uv = vec2<f32>(point.plan.x / view.extent.x, 1.0 - point.plan.y / view.extent.y);
    let outside = length((uv - clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0))) * view.extent);
    // What stands in the mirror is dim.
    let evening = textureSampleBias(evening_sheet, sheet_sampler, uv, min(outside / 9000.0, 4.0));
    let noon = textureSampleLevel(sheet, sheet_sampler, uv, 0.0);
    let map = through_valley_air(noon.rgb, point.height);
    let to_eye = view.eye.xyz - vec3<f32>(point.plan, point.height * view.exaggeration);
    let distance = length(to_eye);
    let way = -to_eye / distance;

    // Still water holds the sky.
    // Its ripples lean the mirror towards the horizon.
    let mirrored = normalize(vec3<f32>(way.xy, 0.3 * max(-way.z, 0.02)));
    let grazing = pow(1.0 - clamp(-way.z, 0.0, 1.0), 3.0);
    var colour = mix(evening.rgb, sky_colour(mirrored), evening.a * (0.25 + 0.70 * grazing));

    // Blue between the eye and far slopes; mist over low land. Both thin out upwards: summits are clear.
    let height = max(point.height - view.lowland, 0.0) * view.exaggeration;
    let eye = max(view.eye.z - view.lowland * view.exaggeration, 1.0);
    let blue = 1.0 - exp(-view.haze * air_depth(0.042, 3000.0 * view.exaggeration, height, eye, distance));
    let towards = towards_sun(way);
    let scattered = mix(air.distance.rgb, air.glow.rgb, 0.55 * towards * towards * towards * towards);
    colour = mix(colour, scattered, blue);
    let low = 1.0 - exp(-view.haze * air_depth(0.034, 300.0 * view.exaggeration, height, eye, distance));
    colour = mix(colour, mix(air.mist.rgb, air.glow.rgb, 0.5 * towards * towards * towards), low);
    // The land's border is lost in the mist of the horizon, not cut.
    colour = mix(colour, sky_colour(way), smoothstep(0.0, 0.85 * BEYOND, outside));

    colour = mix(map, colour, view.dusk);
    let around = smoothstep(0.0, 600.0, outside) * (1.0 - smoothstep(0.1, 0.8, view.tilt));
    colour = mix(colour, air.table.rgb, around);
    return vec4<f32>(dithered(colour, point.position.xy), 1.0);
}

struct SkyPoint {
    @builtin(position) position: vec4<f32>,
    @location(0) ndc: vec2<f32>,
}

@vertex
fn sky_cover(@builtin(vertex_index) index: u32) -> SkyPoint {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    return SkyPoint(vec4<f32>(corner, 1.0, 1.0), corner);
}

@fragment
fn sky(point: SkyPoint) -> @location(0) vec4<f32> {
    let way = normalize(view.forward.xyz + view.right.xyz * point.ndc.x + view.up.xyz * point.ndc.y);
    return vec4<f32>(dithered(mix(air.table.rgb, sky_colour(way), view.tilt), point.position.xy), 1.0);
}
