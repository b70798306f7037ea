// The planet in a window: its heights with what the samples are too far apart for, then light and colours, then the
// whole laid into the window. Directions are unit vectors: in the view's frame x is right, y up, z towards the eye; in
// the world's z is the north pole. Heights are kilometres above the sea.

struct Globe {
    // From the view's frame to the world's: columns.
    turn: mat3x3<f32>,
    // Middle of the disc on the sheet, texels from its top-left corner.
    centre: vec2<f32>,
    // Size of the sheet, texels.
    size: vec2<f32>,
    // Radius of the disc, texels.
    radius: f32,
    // How many generations of detail can be seen.
    octaves: u32,
    // Part of the light that is left.
    lamp: f32,
    // The target takes linear light.
    encodes: f32,
    // Size of the target, pixels.
    window: vec2<f32>,
}

// From the world's frame to those of the plates: quaternions, by the number in the plates' atlas.
struct Frames {
    turns: array<vec4<f32>, 256>,
}

@group(0) @binding(0) var<uniform> globe: Globe;
@group(0) @binding(1) var<uniform> frames: Frames;
@group(0) @binding(2) var smooth_sampler: sampler;
@group(0) @binding(3) var nearest_sampler: sampler;
// Height, roughness, share of mountains.
@group(0) @binding(4) var crust: texture_cube<f32>;
// Out of 255: the number of the plate, that of the nearest other one, and how much the detail here is the other's.
@group(0) @binding(5) var plates: texture_cube<f32>;
// Height; middling, broad and fine variation of the cover.
@group(0) @binding(6) var forms: texture_2d<f32>;
@group(0) @binding(7) var sheet: texture_2d<f32>;

// How far beyond the limb the air is seen, radii.
const AIR: f32 = 1.05;

const EARTH_KM: f32 = 6370.0;
// Heights are multiplied by this in the light, on land and under water.
const RELIEF_LAND: f32 = 21.0;
const RELIEF_SEA: f32 = 9.0;

// A lamp above the visitor's left shoulder, and the cool room.
const LAMP: vec3<f32> = vec3<f32>(-0.52, 0.56, 0.645);
const WARM: vec3<f32> = vec3<f32>(1.06, 1.0, 0.90);
const COOL: vec3<f32> = vec3<f32>(0.62, 0.74, 0.98);

// Cells per radian of the broad variation of the cover.
const COVER: f32 = 3.1;
// How far a place is displaced before the samples are looked at, radians: a coast does not show them.
const WARP: f32 = 0.012;

@vertex
fn disc(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    var at = globe.centre;
    let corner = index % 3u;
    if corner > 0u {
        let angle = 6.2831853 * f32((index / 3u + corner - 1u) % CORNERS) / f32(CORNERS);
        at += globe.radius * AIR * 1.01 / cos(3.1415927 / f32(CORNERS)) * vec2<f32>(cos(angle), sin(angle));
    }
    let clip = at / globe.size * 2.0 - 1.0;
    return vec4<f32>(clip.x, -clip.y, 0.0, 1.0);
}

@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    return vec4<f32>(corner * 4.0 - 1.0, 0.0, 1.0);
}

// Where a texel is, radii from the middle of the disc.
fn from_centre(position: vec4<f32>) -> vec2<f32> {
    let away = (position.xy - globe.centre) / globe.radius;
    return vec2<f32>(away.x, -away.y);
}

// The place of the sphere that is seen there; outside, the nearest of the limb.
fn seen(away: vec2<f32>) -> vec3<f32> {
    let square = dot(away, away);
    if square >= 1.0 {
        return vec3<f32>(away * inverseSqrt(square), 0.0);
    }
    return vec3<f32>(away, sqrt(1.0 - square));
}

fn turned(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}

fn hash(cell: vec3<u32>) -> u32 {
    var v = cell.x ^ cell.y ^ cell.z;
    v = (v ^ (v >> 15u)) * 0x2C1B3C6Du;
    v = (v ^ (v >> 12u)) * 0x297A2D39u;
    return v ^ (v >> 15u);
}

fn parts(word: u32) -> vec3<f32> {
    let three = vec3<u32>(word, word >> 10u, word >> 20u) & vec3<u32>(1023u);
    return vec3<f32>(three) / 511.5 - 1.0;
}

struct Cell {
    low: vec3<u32>,
    high: vec3<u32>,
    f: vec3<f32>,
    u: vec3<f32>,
}

fn cell_of(p: vec3<f32>, seed: u32) -> Cell {
    let base = floor(p);
    let mixer = vec3<u32>(0x9E3779B1u, 0x85EBCA77u, 0xC2B2AE3Du);
    let low = vec3<u32>(vec3<i32>(base)) * mixer + vec3<u32>(seed * 0x27D4EB2Fu, 0u, 0u);
    let f = p - base;
    return Cell(low, low + mixer, f, f * f * f * (f * (f * 6.0 - 15.0) + 10.0));
}

// Gradient noise in about [-1, 1] (Perlin 2002).
fn gradient(p: vec3<f32>, seed: u32) -> f32 {
    let c = cell_of(p, seed);
    let g = c.f - 1.0;
    let a = mix(dot(parts(hash(c.low)), c.f),
                dot(parts(hash(vec3<u32>(c.high.x, c.low.yz))), vec3<f32>(g.x, c.f.yz)), c.u.x);
    let b = mix(dot(parts(hash(vec3<u32>(c.low.x, c.high.y, c.low.z))), vec3<f32>(c.f.x, g.y, c.f.z)),
                dot(parts(hash(vec3<u32>(c.high.xy, c.low.z))), vec3<f32>(g.xy, c.f.z)), c.u.x);
    let d = mix(dot(parts(hash(vec3<u32>(c.low.xy, c.high.z))), vec3<f32>(c.f.xy, g.z)),
                dot(parts(hash(vec3<u32>(c.high.x, c.low.y, c.high.z))), vec3<f32>(g.x, c.f.y, g.z)), c.u.x);
    let e = mix(dot(parts(hash(vec3<u32>(c.low.x, c.high.yz))), vec3<f32>(c.f.x, g.yz)),
                dot(parts(hash(c.high)), g), c.u.x);
    return 1.25 * mix(mix(a, b, c.u.y), mix(d, e, c.u.y), c.u.z);
}

// Three independent smooth values in [-1, 1].
fn drift(p: vec3<f32>, seed: u32) -> vec3<f32> {
    let c = cell_of(p, seed);
    let a = mix(parts(hash(c.low)), parts(hash(vec3<u32>(c.high.x, c.low.yz))), c.u.x);
    let b = mix(parts(hash(vec3<u32>(c.low.x, c.high.y, c.low.z))), parts(hash(vec3<u32>(c.high.xy, c.low.z))), c.u.x);
    let d = mix(parts(hash(vec3<u32>(c.low.xy, c.high.z))), parts(hash(vec3<u32>(c.high.x, c.low.y, c.high.z))), c.u.x);
    let e = mix(parts(hash(vec3<u32>(c.low.x, c.high.yz))), parts(hash(c.high)), c.u.x);
    return mix(mix(a, b, c.u.y), mix(d, e, c.u.y), c.u.z);
}

// From one generation to the next: twice as fine, and turned, so that no lattice is seen.
fn finer(p: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(1.6 * p.y + 1.2 * p.z, -1.6 * p.x + 0.72 * p.y - 0.96 * p.z, -1.2 * p.x - 0.96 * p.y + 1.28 * p.z) + 17.3;
}

// What the detail of one plate adds.
struct Detail {
    // Where the samples are to be looked at, radians from here, the world's frame.
    away: vec3<f32>,
    // Variation of the cover, of middling and great extent.
    middling: f32,
    broad: f32,
    // Hills and crests, about -1 to 1.
    soft: f32,
    sharp: f32,
}

fn detail(own: vec3<f32>) -> Detail {
    let wide = drift(own * 21.0, 5u);
    var all = Detail(wide + 0.6 * drift(own * 47.0, 7u) + 0.35 * drift(own * 103.0, 9u), 1.3 * gradient(own * 12.0, 4u),
                     gradient(own * COVER, 3u), 0.0, 0.0);
    var p = own * DETAIL;
    var cells = DETAIL / globe.radius;
    var amplitude = 1.0;
    for (var octave = 0u; octave < globe.octaves; octave++) {
        let seen = 1.0 - smoothstep(0.4 * FINEST, FINEST, cells);
        let value = gradient(p, 11u + octave);
        all.soft += amplitude * seen * value;
        // Crests: sharp above, wide between.
        all.sharp += amplitude * seen * (0.58 - 1.9 * abs(value));
        amplitude *= 0.6;
        cells *= 2.0;
        p = finer(p);
    }
    return all;
}

// Heights. Detail belongs to the plates and travels with them; at borders one plate's passes into the other's.
@fragment
fn form(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let world = globe.turn * seen(from_centre(position));
    let pair = vec2<u32>(textureSampleLevel(plates, nearest_sampler, world, 0.0).rg * 255.0 + 0.5);
    let other = textureSampleLevel(plates, smooth_sampler, world, 0.0).b;
    var all = Detail();
    var share = 1.0 - other;
    var plate = pair.x;
    for (var turn = 0; turn < 2 && share > 0.0; turn++) {
        let frame = frames.turns[plate];
        let one = detail(turned(frame, world));
        all.away += share * turned(vec4<f32>(-frame.xyz, frame.w), one.away);
        all.middling += share * one.middling;
        all.broad += share * one.broad;
        all.soft += share * one.soft;
        all.sharp += share * one.sharp;
        share = select(0.0, other, turn == 0);
        plate = pair.y;
    }
    let ground = textureSampleLevel(crust, smooth_sampler, world + WARP * all.away, 0.0);
    let height = ground.x + ground.y * (all.soft + ground.z * 2.0 * all.sharp);
    return vec4<f32>(height, all.middling, all.broad, all.soft);
}

fn texel(at: vec2<i32>) -> vec4<f32> {
    return textureLoad(forms, clamp(at, vec2<i32>(0), vec2<i32>(globe.size) - 1), 0);
}

// Height as the light sees it.
fn lit_height(km: f32) -> f32 {
    return select(km * RELIEF_LAND, km * RELIEF_SEA, km < 0.0);
}

fn code(hex: u32) -> vec3<f32> {
    return vec3<f32>(vec3<u32>(hex >> 16u, hex >> 8u, hex) & vec3<u32>(255u)) / 255.0;
}

fn rgb(hex: u32) -> vec3<f32> {
    return decoded(code(hex));
}

fn sea_colour(km: f32) -> vec3<f32> {
    let depth = -km;
    let shelf = mix(rgb(0x8abbc6u), rgb(0x5b97b5u), smoothstep(0.0, 0.5, depth));
    let slope = mix(shelf, rgb(0x3b769fu), smoothstep(0.3, 2.2, depth));
    let plain = mix(slope, rgb(0x1f4c7du), smoothstep(2.0, 4.4, depth));
    return mix(plain, rgb(0x0f2648u), smoothstep(4.2, 7.0, depth));
}

struct Cover {
    colour: vec3<f32>,
    ice: f32,
}

// What grows at a height, in a climate of belts: wet at the equator, dry in the horse latitudes, wet again, cold.
fn land_cover(km: f32, sine: f32, steep: f32, middling: f32, broad: f32, fine: f32) -> Cover {
    let square = sine * sine;
    let warmth = 29.0 - 46.0 * square - 5.0 * max(km, 0.0) + 4.0 * broad + 2.2 * middling + 1.2 * fine;
    let tropics = exp(-square * 16.0);
    let westerlies = exp(-(abs(sine) - 0.78) * (abs(sine) - 0.78) * 22.0);
    let wet = 0.08 + 0.95 * tropics + 0.80 * westerlies + 0.34 * broad + 0.20 * middling + 0.14 * fine;
    let lush = smoothstep(0.22, 0.72, wet);
    let hot = mix(rgb(0xd8c297u), rgb(0x5c8350u), lush);
    let savanna = mix(hot, rgb(0xaaa66bu), 0.75 * (1.0 - abs(2.0 * lush - 1.0)));
    let mild = mix(rgb(0xbfb489u), rgb(0x7b9862u), lush);
    let cold = mix(rgb(0x8d9a7bu), rgb(0x5d7a60u), lush);
    var ground = mix(mild, savanna, smoothstep(13.0, 22.0, warmth));
    ground = mix(cold, ground, smoothstep(2.0, 12.0, warmth));
    ground = mix(rgb(0xa39f8eu), ground, smoothstep(-5.0, 3.0, warmth));
    let upland = mix(rgb(0xb09a78u), rgb(0x8f8172u), smoothstep(2.4, 4.2, km));
    ground = mix(ground, upland, 0.85 * smoothstep(0.9, 2.6, km + 0.5 * fine));
    ground = mix(ground, rgb(0x7d746bu), 0.6 * smoothstep(0.35, 0.9, steep));
    let ice = smoothstep(-6.0, -10.5, warmth + 5.0 * steep);
    return Cover(mix(ground, rgb(0xf1f4f6u), ice), ice);
}

// Light and colours.
@fragment
fn shade(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let away = from_centre(position);
    let distance = length(away);
    let p = seen(away);
    let at = vec2<i32>(position.xy);
    let here = texel(at);
    let east = texel(at + vec2<i32>(1, 0)).x;
    let west = texel(at - vec2<i32>(1, 0)).x;
    let north = texel(at - vec2<i32>(0, 1)).x;
    let south = texel(at + vec2<i32>(0, 1)).x;
    let km = here.x;
    // What the picture's plane shows of the slope lies in the tangent plane.
    let rise = 0.5 * globe.radius / EARTH_KM
        * vec3<f32>(lit_height(east) - lit_height(west), lit_height(north) - lit_height(south), 0.0);
    let slope = rise - p * dot(rise, p);
    let normal = normalize(p - slope);
    let hollow = (east + west + north + south - 4.0 * km) * globe.radius / EARTH_KM;
    let steep = length(slope);
    let day = dot(p, LAMP);
    let relief = dot(normal, LAMP) - day;
    let open = 0.10 + 0.90 * smoothstep(-0.42, 0.80, day);
    let sine = (globe.turn * p).z;
    let middling = here.y;
    let broad = here.z;
    let fine = here.w;

    var colour = vec3<f32>(0.0);
    let cold = 29.0 - 50.0 * sine * sine + 3.0 * broad + 2.5 * middling + 1.5 * fine;
    if km < 0.0 {
        colour = sea_colour(km);
        let pack = smoothstep(-13.5, -16.0, cold);
        colour = mix(colour, mix(rgb(0xc9dbe4u), rgb(0xeaf1f4u), smoothstep(-15.0, -18.0, cold)), pack);
        colour *= 1.0 + (1.0 - 0.7 * pack) * clamp(0.95 * relief, -0.30, 0.30);
        // The lamp on the water.
        let mirrored = reflect(vec3<f32>(0.0, 0.0, -1.0), normalize(mix(p, normal, 0.06)));
        colour += (1.0 - pack) * vec3<f32>(0.028, 0.036, 0.042) * pow(max(dot(mirrored, LAMP), 0.0), 9.0);
    } else {
        let cover = land_cover(km, sine, steep, middling, broad, fine);
        let bright = clamp(relief * 1.5, -0.62, 0.55) - clamp(hollow * 2.2, -0.10, 0.16);
        colour = cover.colour * mix(COOL, vec3<f32>(1.0), smoothstep(-0.5, 0.05, bright)) * (1.0 + bright);
    }
    colour *= mix(COOL * 0.55, WARM, smoothstep(-0.3, 0.5, day)) * open * 1.08;
    // Air: thin, blue towards the limb, warm where the day ends.
    let thick = pow(1.0 - p.z, 3.2);
    let sky = mix(rgb(0x1c3d6eu), rgb(0x9fc6eeu), smoothstep(-0.25, 0.75, day));
    colour = mix(colour, sky, 0.62 * thick * (0.15 + 0.85 * smoothstep(-0.35, 0.5, day)));
    // Beside the limb.
    let over = max(distance - 1.0, 0.0);
    let glow = exp(-over / 0.011) * smoothstep(-0.45, 0.7, day) * (1.0 - smoothstep(0.6, 1.0, over / (AIR - 1.0)));
    let beside = code(ROOM) + code(0x5f8fd0u) * 0.75 * glow * globe.lamp;
    let inside = clamp((1.0 - distance) * globe.radius + 0.5, 0.0, 1.0);
    return vec4<f32>(mix(beside, encoded(colour * globe.lamp), inside), 1.0);
}

// Into the window.
@fragment
fn lay(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let colour = textureSampleLevel(sheet, smooth_sampler, position.xy / globe.window, 0.0).rgb;
    return vec4<f32>(mix(colour, decoded(colour), globe.encodes), 1.0);
}
