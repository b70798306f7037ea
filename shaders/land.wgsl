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
    // Cells of the mesh.
    mesh: vec2<f32>,
    // Rectangle of the land in the plan, clip space: corner and size.
    plan: vec4<f32>,
    // 0 in plan, 1 in oblique view.
    tilt: f32,
    exaggeration: f32,
    lowland: f32,
    summit: f32,
    // How thick the air is, 1 as usual.
    haze: f32,
    // Part of the light that is left, 0 to 1.
    lamp: f32,
    // 1 if the target encodes colours by itself.
    encoded: f32,
    // Distance from the eye to the middle of the view, metres.
    distance: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var sheet_sampler: sampler;
@group(0) @binding(2) var sheet: texture_2d<f32>;
@group(0) @binding(3) var stand: texture_2d<f32>;
@group(0) @binding(4) var<uniform> air: Air;

// Colours of the air, in linear light.
struct Air {
    // The haze of the plan, and that of the distance.
    valley: vec4<f32>,
    distance: vec4<f32>,
    // The sky at the horizon towards the sun, away from it, and overhead.
    glow: vec4<f32>,
    horizon: vec4<f32>,
    zenith: vec4<f32>,
    // What is around the plan.
    table: vec4<f32>,
}

// How far the land goes on beyond its border, metres.
const BEYOND = 700000.0;

fn encode(colour: vec3<f32>) -> vec3<f32> {
    let c = clamp(colour * view.lamp, vec3<f32>(0.0), vec3<f32>(1.0));
    let gamma = select(1.055 * pow(c, vec3<f32>(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3<f32>(0.0031308));
    return select(gamma, c, view.encoded > 0.5);
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

// Vertices stand in rows from north to south; the outermost ones are carried far beyond the border.
@vertex
fn mesh(@builtin(vertex_index) index: u32) -> MeshPoint {
    let columns = u32(view.mesh.x) + 3u;
    let cell = vec2<f32>(f32(index % columns), f32(index / columns)) - 1.0;
    let uv = clamp(cell / view.mesh, vec2<f32>(0.0), vec2<f32>(1.0));
    let outward = clamp(cell, vec2<f32>(-1.0), view.mesh + 1.0) - clamp(cell, vec2<f32>(0.0), view.mesh);
    let plan = vec2<f32>(uv.x, 1.0 - uv.y) * view.extent + vec2<f32>(outward.x, -outward.y) * BEYOND;
    let height = textureSampleLevel(stand, sheet_sampler, uv, 0.0).x * 1000.0;
    return MeshPoint(view.view_proj * vec4<f32>(plan, height * view.exaggeration, 1.0), plan, height);
}

// The sky in a direction (unit length).
fn sky_colour(way: vec3<f32>) -> vec3<f32> {
    let sun = normalize(vec3<f32>(-0.70710678, 0.70710678, 0.12));
    let towards = 0.5 + 0.5 * dot(normalize(vec3<f32>(way.xy, 0.0) + vec3<f32>(1e-5, 0.0, 0.0)), vec3<f32>(sun.xy, 0.0) * 1.0071);
    let rim = mix(air.horizon.rgb, air.glow.rgb, towards * towards * towards);
    let rise = clamp(way.z, 0.0, 1.0);
    return mix(rim, air.zenith.rgb, 1.0 - exp(-rise * 3.6));
}

@fragment
fn terrain(point: MeshPoint) -> @location(0) vec4<f32> {
    let uv = vec2<f32>(point.plan.x / view.extent.x, 1.0 - point.plan.y / view.extent.y);
    let inside = clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0));
    let outside = length((uv - inside) * view.extent);
    let seen = textureSample(sheet, sheet_sampler, inside);
    let to_eye = view.eye.xyz - vec3<f32>(point.plan, point.height * view.exaggeration);
    let distance = length(to_eye);
    let way = -to_eye / distance;
    // Still water holds a little of the sky.
    let mirrored = vec3<f32>(way.xy, max(-way.z, 0.02));
    let grazing = pow(1.0 - clamp(-way.z, 0.0, 1.0), 4.0);
    var colour = mix(seen.rgb, sky_colour(normalize(mirrored)), seen.a * (0.10 + 0.55 * grazing));
    colour = mix(colour, through_valley_air(colour, point.height), 1.0 - view.tilt);
    // Air thins out upwards, and begins to show behind what one looks at.
    let depth = max(distance - 0.72 * view.distance, 0.0);
    let thin = exp(-max(point.height - view.lowland, 0.0) / 2600.0);
    let blue = 1.0 - exp(-depth / 260000.0 * view.haze * (0.35 + 0.65 * thin));
    colour = mix(colour, mix(air.distance.rgb, sky_colour(vec3<f32>(way.xy, 0.0)), smoothstep(0.25, 1.0, blue)), blue * view.tilt);
    // The land's border is lost in mist, not cut.
    let mist = smoothstep(0.0, 90000.0, outside) * view.tilt;
    colour = mix(colour, sky_colour(normalize(vec3<f32>(way.xy, 0.0))), mist);
    let around = smoothstep(0.0, 600.0, outside) * (1.0 - view.tilt);
    colour = mix(colour, air.table.rgb, around);
    return vec4<f32>(encode(colour), 1.0);
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
    return vec4<f32>(encode(mix(air.table.rgb, sky_colour(way), view.tilt)), 1.0);
}
