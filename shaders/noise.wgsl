// Noise from position hashes: the same place gives the same value on any card.

// A well mixed word from a lattice point (after Jarzynski & Olano 2020, "Hash functions for GPU rendering", pcg).
fn hash(cell: vec2<i32>, seed: u32) -> u32 {
    var v = u32(cell.x) * 0x9E3779B1u + u32(cell.y) * 0x85EBCA77u + seed * 0xC2B2AE3Du;
    v = v * 747796405u + 2891336453u;
    v = ((v >> ((v >> 28u) + 4u)) ^ v) * 277803737u;
    return (v >> 22u) ^ v;
}

fn unit(word: u32) -> f32 {
    return f32(word >> 8u) / 16777216.0;
}

fn slope_at(cell: vec2<i32>, offset: vec2<f32>, seed: u32) -> f32 {
    let word = hash(cell, seed);
    let east = f32(word & 0xffffu) / 32768.0 - 1.0;
    let north = f32(word >> 16u) / 32768.0 - 1.0;
    return east * offset.x + north * offset.y;
}

// Gradient noise in about [-1, 1], of wavelength about two (Perlin 2002).
fn gradient(p: vec2<f32>, seed: u32) -> f32 {
    let base = floor(p);
    let cell = vec2<i32>(base);
    let f = p - base;
    let u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let south = mix(slope_at(cell, f, seed), slope_at(cell + vec2<i32>(1, 0), f - vec2<f32>(1.0, 0.0), seed), u.x);
    let north = mix(slope_at(cell + vec2<i32>(0, 1), f - vec2<f32>(0.0, 1.0), seed),
                    slope_at(cell + vec2<i32>(1, 1), f - vec2<f32>(1.0, 1.0), seed), u.x);
    return 1.6 * mix(south, north, u.y);
}

fn fractal(place: vec2<f32>, octaves: i32, seed: u32) -> f32 {
    var p = place;
    var sum = 0.0;
    var amplitude = 1.0;
    var total = 0.0;
    for (var octave = 0; octave < octaves; octave++) {
        sum += amplitude * gradient(p, seed + u32(octave));
        total += amplitude;
        amplitude *= 0.5;
        p = vec2<f32>(1.6 * p.x + 1.2 * p.y + 17.3, -1.2 * p.x + 1.6 * p.y - 9.1);
    }
    return 1.4 * sum / total;
}

// Roof-shaped wave of period one in [-1, 1], and its derivative in units of its flanks'.
fn wave(t: f32) -> vec2<f32> {
    let f = fract(t) - 0.5;
    let g = fract(t + 0.25) - 0.5;
    return vec2<f32>(1.0 - 4.0 * abs(f), -clamp((4.0 * abs(g) - 1.0) * 4.0, -1.0, 1.0));
}

// Waves whose crests run along `way`, of wavelength one: profile, and its derivative across the crests (sparse
// convolution as in Lagae et al. 2009). With crests down the slope they look like gullies and spurs.
fn gullies(p: vec2<f32>, way: vec2<f32>, seed: u32) -> vec2<f32> {
    let base = vec2<i32>(floor(p));
    var sum = vec2<f32>(0.0);
    var total = 1e-4;
    for (var dy = -1; dy <= 1; dy++) {
        for (var dx = -1; dx <= 1; dx++) {
            let cell = base + vec2<i32>(dx, dy);
            let word = hash(cell, seed);
            let centre = vec2<f32>(cell) + 0.2 + 0.6 * vec2<f32>(unit(word), unit(word * 0x9E3779B1u));
            let d = p - centre;
            let near = 1.0 - dot(d, d) / 1.44;
            if near > 0.0 {
                let weight = near * near;
                sum += weight * wave(dot(d, vec2<f32>(-way.y, way.x)) + unit(word * 0x85EBCA77u) * 0.35);
                total += weight;
            }
        }
    }
    return sum / total;
}

// Variation of the cover that depends on the place alone: over several kilometres, and over several hundred metres.
@fragment
fn variation(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let plan = vec2<f32>(position.x, ground.sheet.y - position.y) / ground.sheet * ground.extent;
    let broad = fractal(plan / 5200.0, 3, 11u);
    let fine = fractal(plan / 1100.0, 3, 23u);
    return vec4<f32>(vec2<f32>(broad, fine) * 0.35 + 0.5, 0.0, 1.0);
}
