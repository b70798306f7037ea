// The shape of the land as light and cover see it.

@group(0) @binding(1) var height: texture_2d<f32>;
@group(0) @binding(2) var water: texture_2d<f32>;

fn at(cell: vec2<i32>) -> f32 {
    return textureLoad(height, clamp(cell, vec2<i32>(0), vec2<i32>(ground.grid) - 1), 0).x;
}

fn level(cell: vec2<i32>) -> f32 {
    let inside = clamp(cell, vec2<i32>(0), vec2<i32>(ground.grid) - 1);
    let depth = textureLoad(water, inside, 0).z;
    return textureLoad(height, inside, 0).x + depth * depth * ground.deepest;
}

struct Shape {
    // Slope (rise per metre to the east and to the north) at the cell, and over a few mesh edges.
    @location(0) slopes: vec4<f32>,
    // Height in km, height over the mean of some mesh edges in spacings, steepness around.
    @location(1) stand: vec4<f32>,
}

@fragment
fn relief(@builtin(position) position: vec4<f32>) -> Shape {
    let cell = vec2<i32>(position.xy);
    let size = ground.extent / ground.grid;
    let fine = vec2<f32>(at(cell + vec2<i32>(1, 0)) - at(cell - vec2<i32>(1, 0)),
                         at(cell - vec2<i32>(0, 1)) - at(cell + vec2<i32>(0, 1))) / (2.0 * size);
    // Sobel over one mesh edge to each side.
    let r = max(i32(round(0.9 * ground.spacing / size.x)), 1);
    let nw = at(cell + vec2<i32>(-r, -r));
    let n = at(cell + vec2<i32>(0, -r));
    let ne = at(cell + vec2<i32>(r, -r));
    let w = at(cell + vec2<i32>(-r, 0));
    let e = at(cell + vec2<i32>(r, 0));
    let sw = at(cell + vec2<i32>(-r, r));
    let s = at(cell + vec2<i32>(0, r));
    let se = at(cell + vec2<i32>(r, r));
    let middle = vec2<f32>((ne + 2.0 * e + se) - (nw + 2.0 * w + sw),
                           (nw + 2.0 * n + ne) - (sw + 2.0 * s + se)) / (8.0 * f32(r) * size);
    let here = at(cell);
    let mean = (nw + ne + sw + se + 2.0 * (n + e + s + w)) / 12.0;
    // On a crest, the steepness of its flanks.
    let flanks = max(max(abs(e - here), abs(w - here)) / (f32(r) * size.x), max(abs(n - here), abs(s - here)) / (f32(r) * size.y));
    var shape: Shape;
    shape.slopes = vec4<f32>(fine, middle);
    shape.stand = vec4<f32>(here / 1000.0, (here - mean) / ground.spacing, max(flanks, length(middle)), 0.0);
    return shape;
}

// Heights (km) over some kilometres: the big forms, lakes by their level. One texel for FORM_CELLS² cells.
@fragment
fn forms(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let size = ground.extent / ground.grid;
    let middle = vec2<i32>(position.xy * FORM_CELLS);
    let reach = FORM_REACH / size;
    let taps = 4;
    var sum = 0.0;
    var total = 0.0;
    for (var y = -taps; y <= taps; y++) {
        for (var x = -taps; x <= taps; x++) {
            let offset = vec2<f32>(f32(x), f32(y)) / f32(taps);
            let weight = max(1.0 - dot(offset, offset) * 0.9, 0.0);
            sum += weight * level(middle + vec2<i32>(offset * reach));
            total += weight;
        }
    }
    return vec4<f32>(sum / total / 1000.0, 0.0, 0.0, 0.0);
}

@group(0) @binding(3) var form: texture_2d<f32>;

// The same with the slopes of the big forms, rise per metre to the east and to the north.
@fragment
fn form_slopes(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let cell = vec2<i32>(position.xy);
    let last = vec2<i32>(textureDimensions(form)) - 1;
    let size = ground.extent / ground.grid * FORM_CELLS;
    let east = textureLoad(form, min(cell + vec2<i32>(1, 0), last), 0).x;
    let west = textureLoad(form, max(cell - vec2<i32>(1, 0), vec2<i32>(0)), 0).x;
    let north = textureLoad(form, max(cell - vec2<i32>(0, 1), vec2<i32>(0)), 0).x;
    let south = textureLoad(form, min(cell + vec2<i32>(0, 1), last), 0).x;
    let slope = vec2<f32>(east - west, north - south) * 1000.0 / (2.0 * size);
    return vec4<f32>(textureLoad(form, cell, 0).x, slope, 0.0);
}

// Tangent of the horizon in a direction (cells), as far as shadows reach.
fn horizon(start: vec2<f32>, here: f32, way: vec2<f32>) -> f32 {
    let cell = 0.5 * (ground.extent.x / ground.grid.x + ground.extent.y / ground.grid.y);
    var rim = -1.0;
    var distance = 0.9 * LIGHT_CELLS;
    for (var step = 0; step < SUN_STEPS; step++) {
        rim = max(rim, (level(vec2<i32>(start + way * distance)) - here) / (distance * cell));
        distance = distance * SUN_STRIDE + 0.35;
    }
    return rim;
}

// Sunlight that gets past the mountains, the part of the sky that is seen, and the evening's sunlight.
@fragment
fn light(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let start = position.xy * LIGHT_CELLS;
    let here = level(vec2<i32>(start));
    let sun = 1.0 - smoothstep(PENUMBRA_LOW, PENUMBRA_HIGH, horizon(start, here, vec2<f32>(-0.70710678, -0.70710678)));
    let cell = 0.5 * (ground.extent.x / ground.grid.x + ground.extent.y / ground.grid.y);
    var sky = 0.0;
    for (var direction = 0; direction < SKY_DIRECTIONS; direction++) {
        let angle = (f32(direction) + 0.5) * 6.2831853 / f32(SKY_DIRECTIONS);
        let way = vec2<f32>(cos(angle), sin(angle));
        var rim = 0.0;
        var far = 1.2 * LIGHT_CELLS;
        for (var step = 0; step < SKY_STEPS; step++) {
            let rise = level(vec2<i32>(start + way * far)) - here;
            rim = max(rim, rise / (far * cell));
            far = far * SKY_STRIDE + 0.4;
        }
        // Of a direction's sky, what is above the horizon (Lambert's weight): the square of the cosine.
        sky += 1.0 / (1.0 + rim * rim);
    }
    var evening = 1.0;
    if ground.aslant > 0.5 {
        // Rows count southwards.
        let rim = horizon(start, here, vec2<f32>(EVENING_EAST, -EVENING_NORTH)) * ground.exaggeration;
        evening = 1.0 - smoothstep(0.72 * EVENING_TANGENT, 1.25 * EVENING_TANGENT, rim);
    }
    return vec4<f32>(sun, sky / f32(SKY_DIRECTIONS), evening, 1.0);
}
