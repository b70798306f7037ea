// The lit, coloured land seen from above: all that does not depend on where the eye is.

@group(0) @binding(1) var smooth_sampler: sampler;
@group(0) @binding(2) var slopes: texture_2d<f32>;
@group(0) @binding(3) var stand: texture_2d<f32>;
@group(0) @binding(4) var form: texture_2d<f32>;
@group(0) @binding(5) var lit: texture_2d<f32>;
@group(0) @binding(6) var water: texture_2d<f32>;
@group(0) @binding(7) var rivers: texture_2d<f32>;
@group(0) @binding(8) var cover_noise: texture_2d<f32>;
// Colours by height, one row each: open ground (by height over the plains), wood, rock.
@group(0) @binding(9) var ramps: texture_2d<f32>;

// Colours of light. Flat open ground receives exactly white.
const SUN = vec3<f32>(1.0, 0.93, 0.77);
const SKY = vec3<f32>(0.43, 0.63, 1.0);
// Share of the light on flat ground that comes from the sun.
const SUN_SHARE = 0.66;

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
    return max(up * (sin(ground.sun_elevation) - cos(ground.sun_elevation) * dot(slope, way)), 0.0);
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

fn ramp(row: f32, height: f32) -> vec3<f32> {
    let u = (height - ground.ramp_low) / (ground.ramp_high - ground.ramp_low);
    return textureSampleLevel(ramps, smooth_sampler, vec2<f32>(u, (row + 0.5) / RAMPS), 0.0).rgb;
}

fn colour_of(row: f32) -> vec3<f32> {
    return ramp(row, ground.ramp_low);
}

// Slope and profile of gullies down the slope, each generation running into the one before.
fn carve(plan: vec2<f32>, down: vec2<f32>, steep: f32, texel: f32) -> vec3<f32> {
    var way = -down / steep;
    var wavelength = 2.0 * ground.spacing;
    let carving = 0.55 + 0.45 * gradient(plan / (5.0 * wavelength), 0x51u);
    var strength = 0.55 * carving * min(steep, 1.0) * smoothstep(0.08, 0.40, steep);
    var carved = vec3<f32>(0.0);
    var share = 0.6;
    for (var generation = 0; generation < GULLIES; generation++) {
        if wavelength < 2.5 * texel {
            break;
        }
        let profile = gullies(plan / wavelength, way, 0x9d1u + u32(generation));
        let sideways = vec2<f32>(-way.y, way.x);
        carved += vec3<f32>(strength * profile.y * sideways, share * profile.x);
        way = normalize(way - 0.7 * profile.y * sideways);
        wavelength *= 0.5;
        strength *= 0.6;
        share *= 0.6;
    }
    return carved;
}

@fragment
fn sheet(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let uv = position.xy / ground.sheet;
    let plan = vec2<f32>(uv.x, 1.0 - uv.y) * ground.extent;
    let texel = ground.extent.x / ground.sheet.x;
    let slope4 = spline(slopes, uv);
    let stand4 = spline(stand, uv);
    let height = stand4.x * 1000.0;
    let middle = slope4.zw;
    let steep = length(middle);

    // The big forms.
    let form_step = FORM_CELLS / ground.grid;
    let big = textureSampleLevel(form, smooth_sampler, uv, 0.0).x * 1000.0;
    let big_e = textureSampleLevel(form, smooth_sampler, uv + vec2<f32>(form_step.x, 0.0), 0.0).x * 1000.0;
    let big_w = textureSampleLevel(form, smooth_sampler, uv - vec2<f32>(form_step.x, 0.0), 0.0).x * 1000.0;
    let big_n = textureSampleLevel(form, smooth_sampler, uv - vec2<f32>(0.0, form_step.y), 0.0).x * 1000.0;
    let big_s = textureSampleLevel(form, smooth_sampler, uv + vec2<f32>(0.0, form_step.y), 0.0).x * 1000.0;
    let form_slope = vec2<f32>(big_e - big_w, big_n - big_s) / (2.0 * form_step * ground.extent);

    // In the plains only the smoothed land counts: its finest noise is no form.
    let rugged = smoothstep(0.015, 0.10, stand4.z);
    let sharp = slope4.xy + 0.8 * smoothstep(0.06, 0.25, stand4.z) * (slope4.xy - middle);
    var slope = mix(middle, sharp, rugged);
    var furrow = 0.0;
    if steep > 0.06 {
        let carved = carve(plan, middle, steep, texel);
        slope += carved.xy;
        furrow = carved.z;
    }

    // Light.
    let height_share = smoothstep(0.0, ground.summit, height);
    let relief = ground.exaggeration;
    let gentle = lowland_gain((length(form_slope) + 0.5 * steep) * relief) * relief;
    let direct = 0.74 * sun_on(slope * gentle) + 0.26 * sun_on(form_slope * gentle * 1.3);
    let passed = textureSampleLevel(lit, smooth_sampler, uv, 0.0);
    let up = inverseSqrt(1.0 + dot(slope, slope) * relief * relief);
    let sun = direct / sin(ground.sun_elevation) * (0.40 + 0.60 * passed.x);
    let dome = passed.y * passed.y * (0.5 + 0.5 * up);
    let white = SUN * SUN_SHARE + SKY * (1.0 - SUN_SHARE);
    var light = (SUN * (SUN_SHARE * sun) + SKY * ((1.0 - SUN_SHARE) * dome)) / white;
    light = 1.0 + (light - 1.0) * (0.95 + 0.25 * height_share);
    light = max(light, vec3<f32>(0.0));
    let over = max(light - 1.0, vec3<f32>(0.0));
    let under = max(1.0 - light, vec3<f32>(0.0));
    light = 1.0 + over / (1.0 + 1.6 * over) - under / (1.0 + 0.22 * under);

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
    var colour = ramp(0.0, over_lowland + (20.0 + 0.1 * clamp(over_lowland, 0.0, 1200.0)) * border);

    let plain = 1.0 - smoothstep(0.05, 0.16, form_steepness + 0.5 * steep);
    let open = 1.0 - smoothstep(0.004, 0.02, form_steepness);
    let swell = open * clamp(rise / 14.0, -1.0, 1.0);
    let tone = 0.030 * broad + 0.035 * swell;
    let warmth = 0.022 * broad + 0.030 * swell;
    colour *= mix(vec3<f32>(1.0), vec3<f32>(1.0 + tone + warmth, 1.0 + tone, 1.0 + tone - warmth), plain);
    let wet = textureSampleLevel(water, smooth_sampler, uv, 0.0).xy;
    let river = textureSampleLevel(rivers, smooth_sampler, uv, 0.0).xy;
    let drained = smoothstep(0.0, 0.7, wet.y);
    let meadow = max(river.y, 0.35 * drained) * (1.0 - smoothstep(0.06, 0.20, steepness));
    colour = mix(colour, colour_of(WATER_MEADOW), 0.75 * meadow);

    let tree_line = ground.tree_line - 130.0 * northness + 190.0 * border;
    let below = 1.0 - smoothstep(tree_line - 260.0, tree_line + 60.0, height);
    let rooted = smoothstep(0.06, 0.20, steep) * (1.0 - smoothstep(0.85, 1.25, steepness));
    let grove = smoothstep(0.15, 0.75, 0.9 * broad + 0.12 * fine - 0.35 * swell);
    let clearing = smoothstep(-0.95, -0.25, 0.45 * fine + 0.6 * broad + 0.45 * northness);
    let wood = below * max(rooted * clearing, 0.30 * grove * plain);
    colour = mix(colour, ramp(1.0, height), 0.88 * wood);

    let alpine = smoothstep(ground.tree_line - 200.0, ground.tree_line + 500.0, height + 260.0 * border);
    let scree = alpine * smoothstep(0.42, 0.66, steepness + 0.12 * fine) * 0.6;
    colour = mix(colour, colour_of(SCREE), scree);
    let bare = smoothstep(0.74 - 0.20 * alpine, 1.02 - 0.20 * alpine, steepness + 0.10 * fine + 0.10 * convexity);
    let barren = smoothstep(ground.snow_line - 600.0, ground.snow_line - 50.0, height + 260.0 * border);
    colour = mix(colour, ramp(2.0, height) * (1.0 + 0.07 * fine), max(bare, 0.8 * barren) * (0.55 + 0.45 * alpine));

    let snow_line = ground.snow_line - 330.0 * northness + 170.0 * border + 90.0 * convexity;
    let lies = smoothstep(snow_line - 90.0, snow_line + 190.0, height + 120.0 * fine);
    let slides = smoothstep(0.85, 1.25, steepness + 0.08 * fine);
    let snow = lies * (1.0 - 0.75 * slides);
    colour = mix(colour, colour_of(SNOW), snow) * light;

    // Water.
    let depth = wet.x * wet.x * ground.deepest;
    let lake = smoothstep(0.15, 0.85, depth);
    let share = 0.45 * smoothstep(5.0, 400.0, depth) + 0.55 * (1.0 - exp(-depth / 260.0));
    let lake_colour = mix(colour_of(SHALLOW), colour_of(DEEP), share) * mix(vec3<f32>(1.0), light, 0.22) * (0.80 + 0.20 * passed.y);
    let shore = lake * (1.0 - smoothstep(0.85, 6.0, depth));
    colour = mix(colour, colour_of(SHORE) * mix(vec3<f32>(1.0), light, 0.5), 0.92 * river.x * (1.0 - lake));
    colour = mix(colour, mix(lake_colour, colour_of(SHORE), 0.55 * shore), lake);
    return vec4<f32>(colour, max(lake, river.x));
}
