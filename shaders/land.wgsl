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
    // Where the mesh is densest, as parts of the land from its north-west corner.
    focus: vec2<f32>,
    // How much denser it is there: 0 not at all, 4 by half.
    gathering: f32,
    lowland: f32,
    // Rectangle of the land in the plan, clip space: corner and size.
    plan: vec4<f32>,
    // 0 in plan, 1 in oblique view.
    tilt: f32,
    // Heights are drawn so many times as high.
    exaggeration: f32,
    // How thick the air is, 1 as usual.
    haze: f32,
    // Part of the light that is left, 0 to 1.
    lamp: f32,
    // 1 if the target encodes colours by itself.
    encodes: f32,
    // Share of the evening's colours, 0 to 1.
    dusk: f32,
    // 1 if the layers under the land are known.
    layered: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var sheet_sampler: sampler;
@group(0) @binding(2) var sheet: texture_2d<f32>;
@group(0) @binding(3) var stand: texture_2d<f32>;
@group(0) @binding(4) var<uniform> air: Air;
@group(0) @binding(5) var evening_sheet: texture_2d<f32>;
// Place in the pile of layers of the rock at the surface, less a half.
@group(0) @binding(6) var rock: texture_2d<f32>;
@group(0) @binding(7) var pile: texture_2d_array<f32>;

// Colours of the air, in linear light.
struct Air {
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

// As the target takes it.
fn shown(srgb: vec3<f32>) -> vec3<f32> {
    let c = srgb * view.lamp;
    return select(c, decoded(c), view.encodes > 0.5);
}

// Linear light as the target takes it, with half a step of its colours more or less (Jimenez 2014, interleaved gradient
// noise): where tones pass into each other slowly, no bands are seen.
fn dithered(colour: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let noise = fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715)))) - 0.5;
    return shown(encoded(colour) + noise / 255.0);
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

@fragment
fn plan(point: PlanPoint) -> @location(0) vec4<f32> {
    return vec4<f32>(shown(textureSampleLevel(sheet, sheet_sampler, point.uv, 0.0).rgb), 1.0);
}

// Perspective.

struct MeshPoint {
    @builtin(position) position: vec4<f32>,
    @location(0) plan: vec2<f32>,
    // What the air adds, and the part of the land's light that it lets through.
    @location(1) air: vec4<f32>,
    // The sky that still water holds, and how much of it.
    @location(2) mirrored: vec4<f32>,
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

// The air before a place: the light it adds, and the part of what comes from there that it lets through. It changes
// slowly, so that it is known well enough at the corners of the mesh.
fn air_before(place: vec3<f32>) -> vec4<f32> {
    let to_eye = view.eye.xyz - place;
    let distance = length(to_eye);
    let way = -to_eye / distance;
    // Blue between the eye and far slopes; mist over low land. Both thin out upwards, by e over a height, so that their
    // depth on the way to a place is that overhead times the slant: summits are clear.
    let drawn = view.exaggeration;
    let height = max(place.z - view.lowland * drawn, 0.0);
    let slant = view.haze * distance / max(view.eye.z - view.lowland * drawn - height, 1.0);
    let blue = exp(-slant * 0.042 * exp(-height / (3000.0 * drawn)));
    let low = exp(-slant * 0.034 * exp(-height / (300.0 * drawn)));
    let near = towards_sun(way);
    let near2 = near * near;
    var added = mix(air.distance.rgb, air.glow.rgb, 0.55 * near2 * near2) * (1.0 - blue);
    added = mix(mix(air.mist.rgb, air.glow.rgb, 0.5 * near2 * near), added, low);
    // The land's border is lost in the mist of the horizon, not cut.
    let outside = length(place.xy - clamp(place.xy, vec2<f32>(0.0), view.extent));
    let left = 1.0 - smoothstep(0.0, 0.85 * BEYOND, outside);
    return vec4<f32>(mix(sky_colour(way), added, left), blue * low * left);
}

// What still water shows along a way: its ripples lean the mirror towards the horizon.
fn mirrored_sky(way: vec3<f32>) -> vec4<f32> {
    let grazing = 1.0 - clamp(-way.z, 0.0, 1.0);
    let mirrored = normalize(vec3<f32>(way.xy, 0.3 * max(-way.z, 0.02)));
    return vec4<f32>(sky_colour(mirrored), 0.25 + 0.70 * grazing * grazing * grazing);
}

// Where a line of the mesh stands, so that the lines are dense about the focus (Vinokur 1983): all are parts, 0 to 1.
fn gathered(line: f32, focus: f32) -> f32 {
    let strength = max(view.gathering, 1e-3);
    let up = exp(strength);
    let start = log((1.0 + (up - 1.0) * focus) / (1.0 + (1.0 / up - 1.0) * focus)) / (2.0 * strength);
    return clamp(focus * (1.0 + sinh(strength * (line - start)) / sinh(strength * start)), 0.0, 1.0);
}

// Vertices stand in rows from north to south; RINGS of them are beyond the border, ever farther apart.
@vertex
fn mesh(@builtin(vertex_index) index: u32) -> MeshPoint {
    let columns = u32(view.mesh.x) + 1u + 2u * u32(RINGS);
    let cell = vec2<f32>(f32(index % columns), f32(index / columns)) - RINGS;
    let inner = clamp(cell, vec2<f32>(0.0), view.mesh);
    let part_of_land = vec2<f32>(gathered(inner.x / view.mesh.x, view.focus.x), gathered(inner.y / view.mesh.y, view.focus.y));
    let rings = cell - inner;
    let part = abs(rings) / (RINGS - 1.0);
    let away = select(BEYOND * (exp(3.0 * part) - 1.0) / (exp(3.0) - 1.0), vec2<f32>(FARTHEST), abs(rings) > vec2<f32>(RINGS - 0.5));
    let grid = part_of_land * view.extent + sign(rings) * away;
    let height = textureSampleLevel(stand, sheet_sampler, grid / view.extent, 0.0).x * 1000.0;
    let fade = 1.0 - smoothstep(0.0, 0.8 * BEYOND, length(away * sign(abs(rings))));
    let plan = vec2<f32>(grid.x, view.extent.y - grid.y);
    let place = vec3<f32>(plan, mix(view.lowland, height, fade) * view.exaggeration);
    let way = normalize(place - view.eye.xyz);
    return MeshPoint(view.view_proj * vec4<f32>(place, 1.0), plan, air_before(place), mirrored_sky(way));
}

// How far a place is outside the land, metres.
fn outside(uv: vec2<f32>) -> f32 {
    return length((uv - clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0))) * view.extent);
}

// The rock between texels; beyond the border as in a mirror. By loads, which cost software less.
fn rock_between(uv: vec2<f32>) -> f32 {
    let last = vec2<i32>(textureDimensions(rock)) - 1;
    let mirrored = 1.0 - abs(1.0 - abs(uv));
    let at = clamp(mirrored * vec2<f32>(last + 1) - 0.5, vec2<f32>(0.0), vec2<f32>(last));
    let low = vec2<i32>(at);
    let high = min(low + 1, last);
    let part = at - vec2<f32>(low);
    return mix(mix(textureLoad(rock, low, 0).x, textureLoad(rock, vec2<i32>(high.x, low.y), 0).x, part.x),
               mix(textureLoad(rock, vec2<i32>(low.x, high.y), 0).x, textureLoad(rock, high, 0).x, part.x), part.y);
}

// How the bed that crops out differs from its layer. Where a neighbouring pixel is not rock, and its place unknown, there
// is hardly any rock here either.
fn bed(uv: vec2<f32>) -> vec3<f32> {
    let place = rock_between(uv);
    let level = pile_level(length(vec2<f32>(dpdx(place), dpdy(place))));
    return 2.0 * pile_look(pile, BEDS, place + 0.5, level).rgb;
}

// The land at evening: what lies there, seen through air.
fn evening(point: MeshPoint, uv: vec2<f32>) -> vec3<f32> {
    // What stands in the mirror is dim.
    let roots = textureSampleBias(evening_sheet, sheet_sampler, uv, min(outside(uv) / 9000.0, 4.0));
    var lying = roots.rgb * roots.rgb;
    var water = roots.a;
    if view.layered > 0.5 {
        // Above a half water, below it bare rock.
        water = max(2.0 * roots.a - 1.0, 0.0);
        let bare = 1.0 - 2.0 * roots.a;
        if bare > 0.02 {
            lying *= mix(vec3<f32>(1.0), bed(uv), bare);
        }
    }
    let colour = mix(lying, point.mirrored.rgb, water * point.mirrored.a);
    return colour * point.air.a + point.air.rgb;
}

fn uv_of(plan: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(plan.x / view.extent.x, 1.0 - plan.y / view.extent.y);
}

@fragment
fn terrain(point: MeshPoint) -> @location(0) vec4<f32> {
    return vec4<f32>(dithered(evening(point, uv_of(point.plan)), point.position.xy), 1.0);
}

// On the way from the plan: the noon of the map becomes evening, and what is around the map comes out of the dark.
@fragment
fn dusk(point: MeshPoint) -> @location(0) vec4<f32> {
    let uv = uv_of(point.plan);
    let map = decoded(textureSampleLevel(sheet, sheet_sampler, uv, 0.0).rgb);
    let around = smoothstep(0.0, 600.0, outside(uv)) * (1.0 - smoothstep(0.1, 0.8, view.tilt));
    let colour = mix(mix(map, evening(point, uv), view.dusk), air.table.rgb, around);
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
