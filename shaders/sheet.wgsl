// The lit, coloured land seen from above: all that does not depend on where the eye is.

@group(0) @binding(1) var smooth_sampler: sampler;
@group(0) @binding(2) var slopes: texture_2d<f32>;
@group(0) @binding(3) var stand: texture_2d<f32>;
@group(0) @binding(4) var form: texture_2d<f32>;
@group(0) @binding(5) var lit: texture_2d<f32>;
@group(0) @binding(6) var water: texture_2d<f32>;
@group(0) @binding(7) var rivers: texture_2d<f32>;
@group(0) @binding(8) var cover_noise: texture_2d<f32>;
// Colours by height, linear, one row each: open ground (by height over the plains), wood, rock.
@group(0) @binding(9) var ramps: texture_2d<f32>;
@group(0) @binding(10) var meadows: texture_2d<f32>;
// Place in the pile of layers of the rock at the surface, less a half; thickness of the sediment on it, metres.
@group(0) @binding(11) var layers: texture_2d<f32>;
@group(0) @binding(12) var pile: texture_2d_array<f32>;

// Colours of light. Flat open ground receives exactly white.
const SUN = vec3<f32>(1.0, 0.93, 0.77);
const SKY = vec3<f32>(0.43, 0.63, 1.0);
// Share of the light on flat ground that comes from the sun.
const SUN_SHARE = 0.66;

// Half a wavelength of crags, metres.
const CRAGS = 170.0;
// Colours of the evening.
const EVENING_SUN = vec3<f32>(2.55, 1.58, 0.78);
const EVENING_SKY = vec3<f32>(0.20, 0.275, 0.45);
const EVENING_GROUND = vec3<f32>(0.10, 0.075, 0.05);

// Cubic B-spline from four bilinear looks: a linear one would show the cells.
fn spline(image: texture_2d<f32>, uv: vec2<f32>) -> vec4<f32> {
    let size = vec2<f32>(textureDimensions(image));
    let place = uv * size - 0.5;
    let base = floor(place);
    let f = place - base;
    let w0 = (1.0 - f) * (1.0 - f) * (1.0 - f) / 6.0;
    let w1 = (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0;
    let w3 = f * f * f / 6.0;
    let w2 = 1.0 - w0 - w1 - w3;
    let a = w0 + w1;
    let b = w2 + w3;
    let p = (base - 0.5 + w1 / a) / size;
    let q = (base + 1.5 + w3 / b) / size;
    return (textureSampleLevel(image, smooth_sampler, p, 0.0) * a.x
          + textureSampleLevel(image, smooth_sampler, vec2<f32>(q.x, p.y), 0.0) * b.x) * a.y
         + (textureSampleLevel(image, smooth_sampler, vec2<f32>(p.x, q.y), 0.0) * a.x
          + textureSampleLevel(image, smooth_sampler, q, 0.0) * b.x) * b.y;
}

fn towards(slope: vec2<f32>, up: f32, way: vec2<f32>) -> f32 {
    return max(up * (SUN_SINE - SUN_COSINE * dot(slope, way)), 0.0);
}

// Cosine of the sun's incidence on a slope: seven tenths by the sun itself, the rest by suns in the west and north
// weighted by how much the slope faces across them (Mark 1992), so that ridges towards the sun keep their form.
fn sun_on(slope: vec2<f32>) -> f32 {
    let up = inverseSqrt(1.0 + dot(slope, slope));
    let sun = towards(slope, up, vec2<f32>(-0.70710678, 0.70710678));
    let steep2 = dot(slope, slope);
    if steep2 < 1e-8 {
        return sun;
    }
    let west = slope.y * slope.y / steep2;
    let north = slope.x * slope.x / steep2;
    let oblique = west * towards(slope, up, vec2<f32>(-1.0, 0.0)) + north * towards(slope, up, vec2<f32>(0.0, 1.0));
    return 0.72 * sun + 0.28 * oblique;
}

// Slopes of the lowlands are lit steeper than they are, as draughtsmen do.
fn lowland_gain(steepness: f32) -> f32 {
    let s = max(steepness, 1e-5);
    return 1.0 + 0.09 * (1.0 - exp(-s / 0.009)) / s;
}

fn ramp(row: i32, height: f32) -> vec3<f32> {
    let part = clamp((height - ground.ramp_low) / (ground.ramp_high - ground.ramp_low), 0.0, 1.0);
    return textureLoad(ramps, vec2<i32>(i32(part * (RAMP_STEPS - 1.0) + 0.5), row), 0).rgb;
}

// Slope, profile and height (metres) of gullies down the slope, each generation running into the one before.
fn carve(plan: vec2<f32>, down: vec2<f32>, steep: f32, texel: f32) -> vec4<f32> {
    var way = -down / max(steep, 1e-6);
    var wavelength = 2.0 * ground.spacing;
    let carving = 0.55 + 0.45 * gradient(plan / (5.0 * wavelength), 0x51u);
    var strength = 0.55 * carving * min(steep, 1.0) * smoothstep(0.08, 0.40, steep);
    var carved = vec4<f32>(0.0);
    var share = 0.6;
    let generations = select(0, GULLIES, steep > 0.06);
    for (var generation = 0; generation < generations; generation++) {
        if wavelength < 2.5 * texel {
            break;
        }
        let profile = gullies(plan / wavelength, way, 0x9d1u + u32(generation));
        let sideways = vec2<f32>(-way.y, way.x);
        carved += vec4<f32>(strength * profile.y * sideways, share * profile.x, 0.25 * wavelength * strength * profile.x);
        way = normalize(way - 0.7 * profile.y * sideways);
        wavelength *= 0.5;
        strength *= 0.6;
        share *= 0.6;
    }
    return carved;
}

// The rock that crops out at a texel.
struct Rock {
    // Place in the pile.
    place: f32,
    // How much of the pile lies between this texel and the next.
    per_texel: f32,
    // How the bed differs from its layer, and how hard it is, -1 to 1.
    bed: vec3<f32>,
    hardness: f32,
    // What its layer is made of.
    stone: vec3<f32>,
}

// `smooth_place`: the place in the pile under the land without its gullies, less a half, and `change` how much it changes
// from this texel to the next; `raised`: what the gullies add to the height, metres, and `rough` from texel to texel.
fn rock_at(smooth_place: f32, change: f32, raised: f32, rough: f32) -> Rock {
    // The layers do not follow the gullies, which cut into them: in a gully the rock is older.
    let place = smooth_place + 0.5 - raised / ground.pile;
    let per_texel = change + rough / ground.pile;
    let look = pile_look(pile, BEDS, place, pile_level(per_texel));
    // Layers pass into each other over some more, and weather towards grey.
    let roots = pile_look(pile, STONE, place, pile_level(2.0 * per_texel)).rgb;
    let stone = roots * roots;
    let grey = dot(stone, vec3<f32>(0.30, 0.59, 0.11));
    return Rock(place, per_texel, 2.0 * look.rgb, 2.0 * look.a - 1.0, 0.9 * mix(stone, vec3<f32>(grey), 0.20));
}

// The geological map: layers in their colours, sediment in that of the youngest, boundaries in ink.
fn chart(rock: Rock, sediment: f32) -> vec3<f32> {
    let level = pile_level(0.5 * rock.per_texel);
    let here = pile_look(pile, CHART, rock.place, level).rgb;
    let above = pile_look(pile, CHART, rock.place - rock.per_texel, level).rgb;
    let ink = smoothstep(0.02, 0.25, length(here - above));
    let paper = mix(here * here, vec3<f32>(1.0), 0.30) * (1.0 - 0.5 * ink);
    return mix(paper, ALLUVIUM, 0.9 * smoothstep(3.0, 12.0, sediment));
}

// The land at a texel, as light finds it.
struct Lain {
    plan: vec2<f32>,
    // What lies there, in even light.
    colour: vec3<f32>,
    // How much of it is snow.
    snow: f32,
    // Slope with its gullies, and that of the big forms.
    slope: vec2<f32>,
    form_slope: vec2<f32>,
    // Over a few mesh edges.
    steep: f32,
    height: f32,
    // Sunlight that gets past the mountains, part of the sky that is seen, the evening's sunlight.
    passed: vec3<f32>,
    lake: f32,
    shore: f32,
    depth: f32,
    river: f32,
    // How much of it is bare rock, how its bed differs from its layer, and its place in the pile, less a half.
    bare: f32,
    bed: vec3<f32>,
    place: f32,
}

fn lain(position: vec2<f32>) -> Lain {
    let uv = position / ground.sheet;
    let plan = vec2<f32>(uv.x, 1.0 - uv.y) * ground.extent;
    let texel = ground.extent.x / ground.sheet.x;
    let slope4 = spline(slopes, uv);
    let stand4 = textureSampleLevel(stand, smooth_sampler, uv, 0.0);
    let height = stand4.x * 1000.0;
    let middle = slope4.zw;
    let steep = length(middle);

    // The big forms.
    let big4 = textureSampleLevel(form, smooth_sampler, uv, 0.0);
    let big = big4.x * 1000.0;
    let form_slope = big4.yz;

    // In the plains only the smoothed land counts: its finest noise is no form.
    let rugged = smoothstep(0.015, 0.10, stand4.z);
    let sharp = slope4.xy + 0.8 * smoothstep(0.06, 0.25, stand4.z) * (slope4.xy - middle);
    var slope = mix(middle, sharp, rugged);
    let carved = carve(plan, middle, steep, texel);
    slope += carved.xy;
    let furrow = carved.z;

    let passed = textureSampleLevel(lit, smooth_sampler, uv, 0.0).xyz;

    // What grows and lies there.
    let places = (textureSampleLevel(cover_noise, smooth_sampler, uv, 0.0).xy - 0.5) / 0.35;
    let broad = places.x;
    let fine = places.y;
    let border = 0.6 * broad + 0.4 * fine;
    let steepness = 0.5 * (length(slope) + steep);
    let form_steepness = length(form_slope);
    let northness = select(0.0, -slope.y / max(length(slope), 0.15), steep > 1e-6);
    let convexity = clamp(stand4.y / 0.06, -1.0, 1.0) + furrow;
    let rise = height - big;
    let over_lowland = height - ground.lowland;
    var colour = ramp(OPEN, over_lowland + (20.0 + 0.1 * clamp(over_lowland, 0.0, 1200.0)) * border);

    let plain = 1.0 - smoothstep(0.05, 0.16, form_steepness + 0.5 * steep);
    let open = 1.0 - smoothstep(0.004, 0.02, form_steepness);
    let swell = open * clamp(rise / 14.0, -1.0, 1.0);
    let tone = 0.030 * broad + 0.035 * swell;
    let warmth = 0.022 * broad + 0.030 * swell;
    colour *= mix(vec3<f32>(1.0), vec3<f32>(1.0 + tone + warmth, 1.0 + tone, 1.0 + tone - warmth), plain);
    var wet = textureSampleLevel(water, smooth_sampler, uv, 0.0).xyz;
    if wet.x > 0.02 {
        wet = spline(water, uv).xyz;
    }
    let river = textureLoad(rivers, vec2<i32>(position), 0).x;
    let beside = textureSampleLevel(meadows, smooth_sampler, uv, 0.0).x;
    let drained = smoothstep(0.0, 0.7, wet.y);
    let meadow = max(beside, 0.35 * drained) * (1.0 - smoothstep(0.06, 0.20, steepness));
    colour = mix(colour, WATER_MEADOW, 0.75 * meadow);

    let tree_line = ground.tree_line - 130.0 * northness + 190.0 * border;
    let below = 1.0 - smoothstep(tree_line - 260.0, tree_line + 60.0, height);
    let rooted = smoothstep(0.06, 0.20, steep) * (1.0 - smoothstep(0.85, 1.25, steepness));
    let grove = smoothstep(0.15, 0.75, 0.9 * broad + 0.12 * fine - 0.35 * swell);
    let clearing = smoothstep(-0.95, -0.25, 0.45 * fine + 0.6 * broad + 0.45 * northness);
    let wood = below * max(rooted * clearing, 0.30 * grove * plain);
    colour = mix(colour, ramp(WOOD, height), 0.88 * wood);

    let alpine = smoothstep(ground.tree_line - 200.0, ground.tree_line + 500.0, height + 260.0 * border);
    let scree = alpine * smoothstep(0.42, 0.66, steepness + 0.12 * fine) * 0.6;
    colour = mix(colour, SCREE, scree);
    var stands = steepness + 0.10 * fine + 0.10 * convexity;
    var stone = ramp(ROCK, height);
    var shown = 0.55 + 0.45 * alpine;
    var rock = Rock(0.5, 0.0, vec3<f32>(1.0), 0.0, stone);
    var sediment = 0.0;
    if ground.pile > 0.0 {
        let under = textureSampleLevel(layers, smooth_sampler, uv, 0.0).xy;
        let change = length(vec2<f32>(dpdx(under.x), dpdy(under.x)));
        sediment = under.y;
        // Thick sediment lies flat: gravel before mountains, meadows farther out.
        let flat = smoothstep(3.0, 10.0, sediment) * (1.0 - smoothstep(0.05, 0.14, steepness));
        let gravel = smoothstep(0.01, 0.08, form_steepness) * (0.6 + 0.25 * fine);
        colour = mix(colour, mix(WATER_MEADOW, ALLUVIUM, 0.45 + 0.4 * gravel), 0.5 * flat * (1.0 - wood));
        if steepness > 0.22 || ground.geology > 0.0 {
            // Where beds are seen, a linear look would show the cells.
            var place = under.x;
            if steepness > 0.4 {
                place = spline(layers, uv).x;
            }
            rock = rock_at(place, change, carved.w, texel * length(carved.xy));
            // Hard beds stand out of meadows and woods, weak ones are grown over.
            stands += 0.14 * rock.hardness;
            shown = 0.78 + 0.22 * alpine;
            stone = mix(stone, rock.stone, 0.72);
            // What is not bare is stony too: belts of one stone are seen from far away.
            let stony = smoothstep(0.22, 0.60, steepness) * (0.28 + 0.20 * alpine) * (1.0 - 0.65 * wood);
            colour = mix(colour, rock.stone, stony);
        }
    }
    let bare = smoothstep(0.74 - 0.20 * alpine, 1.02 - 0.20 * alpine, stands);
    let barren = smoothstep(ground.snow_line - 600.0, ground.snow_line - 50.0, height + 260.0 * border);
    colour = mix(colour, stone * (1.0 + 0.07 * fine), max(bare, 0.8 * barren) * shown);

    let snow_line = ground.snow_line - 330.0 * northness + 170.0 * border + 70.0 * convexity;
    let lies = smoothstep(snow_line - 120.0, snow_line + 220.0, height + 120.0 * fine);
    let slides = smoothstep(0.85, 1.25, steepness + 0.08 * fine);
    let snow = lies * (1.0 - 0.75 * slides);
    colour = mix(colour, SNOW, snow);
    if ground.geology > 0.0 {
        colour = mix(colour, chart(rock, sediment), ground.geology);
    }

    let depth = wet.z * wet.z * ground.deepest;
    // The shore is where half of the ground around is under water; it is as sharp as the texels allow.
    let edge = clamp(0.5 * texel / (2.6 * SHORE_BLUR * ground.spacing), 0.02, 0.3);
    let lake = smoothstep(0.5 - edge, 0.5 + edge, wet.x);
    let shore = lake * (1.0 - smoothstep(0.5 + edge, 0.5 + 3.0 * edge, wet.x));
    // Thin lines look thinner where they are mixed in linear light.
    let inked = river * (1.5 - 0.5 * river);
    // Debris fills the gullies and hides the beds here and there.
    let clean = (0.35 + 0.65 * smoothstep(-0.9, 0.5, convexity + 0.35 * fine)) * (0.78 + 0.22 * clamp(fine + broad, -1.0, 1.0));
    let known = select(0.0, 1.0 - ground.geology, ground.pile > 0.0);
    let seen = known * bare * shown * clean * (1.0 - snow) * (1.0 - max(lake, inked));
    return Lain(plan, colour, snow, slope, form_slope, steep, height, passed, lake, shore, depth, inked,
                seen * (1.0 - 0.7 * smoothstep(3.0, 12.0, sediment)), rock.bed,
                rock.place + 0.8 * carved.w / max(ground.pile, 1.0) - 0.5);
}

// Light from the north-west as a draughtsman sets it, relative to flat open ground.
fn noon(land: Lain) -> vec3<f32> {
    let gentle = lowland_gain(length(land.form_slope) + 0.5 * land.steep);
    let direct = 0.74 * sun_on(land.slope * gentle) + 0.26 * sun_on(land.form_slope * gentle * 1.3);
    let up = inverseSqrt(1.0 + dot(land.slope, land.slope));
    let sun = direct / SUN_SINE * (0.40 + 0.60 * land.passed.x);
    let dome = land.passed.y * land.passed.y * (0.5 + 0.5 * up);
    let white = SUN * SUN_SHARE + SKY * (1.0 - SUN_SHARE);
    var light = (SUN * (SUN_SHARE * sun) + SKY * ((1.0 - SUN_SHARE) * dome)) / white;
    light = 1.0 + (light - 1.0) * (0.95 + 0.25 * smoothstep(0.0, ground.summit, land.height));
    light = max(light, vec3<f32>(0.0));
    let over = max(light - 1.0, vec3<f32>(0.0));
    let under = max(1.0 - light, vec3<f32>(0.0));
    return 1.0 + over / (1.0 + 1.6 * over) - under / (1.0 + 0.22 * under);
}

// The colour of water of some depth over a bottom in some light.
fn standing_water(depth: f32, bottom: vec3<f32>, sky: f32) -> vec3<f32> {
    let share = 0.45 * smoothstep(5.0, 400.0, depth) + 0.55 * (1.0 - exp(-depth / 260.0));
    return mix(SHALLOW, DEEP, share) * mix(vec3<f32>(1.0), bottom, 0.22) * (0.80 + 0.20 * sky);
}

// The printed map's colour.
fn mapped(land: Lain) -> vec3<f32> {
    let light = noon(land);
    var colour = land.colour * light;
    if ground.pile > 0.0 {
        colour *= mix(vec3<f32>(1.0), land.bed, land.bare);
    }
    colour = mix(colour, RIVER * mix(vec3<f32>(1.0), light, 0.2), min(land.river, 1.0) * (1.0 - land.lake));
    let lake = standing_water(land.depth, light, land.passed.y);
    colour = mix(colour, mix(lake, SHORE, 0.6 * land.shore), land.lake);
    // The air over low land: contrast grows with height.
    let depth = 1.0 - smoothstep(0.0, ground.summit, land.height);
    return mix(colour, VALLEY, 0.13 * depth * depth);
}

// The same land in the evening: a low warm sun on one side, the blue of the sky on the other.
fn at_evening(land: Lain) -> vec3<f32> {
    // Crags, finer than what the gullies know.
    let crags = vec2<f32>(gradient(land.plan / CRAGS, 31u), gradient(land.plan / CRAGS, 37u));
    let rough = 0.42 * smoothstep(0.15, 0.8, land.steep) * (1.0 - 0.5 * land.snow);
    let slope = (mix(land.slope, land.form_slope, 0.15) + rough * crags) * ground.exaggeration;
    let up = inverseSqrt(1.0 + dot(slope, slope));
    let direct = max(up * (EVENING_SINE - EVENING_COSINE * dot(slope, vec2<f32>(EVENING_EAST, EVENING_NORTH))), 0.0);
    let dome = land.passed.y * land.passed.y * (0.45 + 0.55 * up);
    // What the sunlit land throws back into the shade.
    let back = max(dot(slope, vec2<f32>(EVENING_EAST, EVENING_NORTH)) * up, 0.0);
    let light = EVENING_SUN * (direct * land.passed.z) + EVENING_SKY * dome + EVENING_GROUND * back;
    // Low light makes colours deep, all but the snow's; bare stone, already strong, less so.
    let grey = vec3<f32>(dot(land.colour, vec3<f32>(0.30, 0.59, 0.11)));
    let deep = mix(pow(mix(land.colour, grey, 0.16 + 0.30 * land.bare), vec3<f32>(1.28)), land.colour, land.snow);
    let lake = mix(SHALLOW, DEEP, 0.5 + 0.5 * (1.0 - exp(-land.depth / 120.0)));
    let wet = max(land.lake, 0.9 * land.river);
    let water = mix(SHORE, lake, land.lake) * mix(EVENING_SKY, vec3<f32>(0.34), 0.4);
    let colour = mix(deep * light, water, wet);
    // The brightest lights come out softly.
    let over = max(colour - 0.6, vec3<f32>(0.0));
    return min(colour, vec3<f32>(0.6)) + over / (1.0 + 1.7 * over);
}

@fragment
fn sheet(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(encoded(mapped(lain(position.xy))), 1.0);
}

struct Sheets {
    // sRGB.
    @location(0) map: vec4<f32>,
    // Roots of linear light, and water; where layers are known half of it, over a half less half of what is bare rock.
    @location(1) evening: vec4<f32>,
    // Place in the pile of layers, less a half.
    @location(2) rock: vec4<f32>,
}

@fragment
fn sheets(@builtin(position) position: vec4<f32>) -> Sheets {
    let land = lain(position.xy);
    let water = max(land.lake, land.river);
    let lies = select(water, 0.5 + 0.5 * (water - land.bare), ground.pile > 0.0);
    return Sheets(vec4<f32>(encoded(mapped(land)), 1.0), vec4<f32>(sqrt(at_evening(land)), lies),
                  vec4<f32>(land.place, 0.0, 0.0, 1.0));
}
