// Heights of folds between crests and troughs, as `mountain::fold::shape` has them.
//
// Places are told by buckets of a lattice and metres from the bucket's south-west corner: so `f32` keeps its digits.

struct Lines {
    // Column and row of the first bucket, and how many there are.
    buckets: vec4<i32>,
    // Where their starts begin.
    first: u32,
    // Half the longest, metres.
    half_length: f32,
}

struct Folds {
    crests: Lines,
    troughs: Lines,
    // Columns and rows of the grid, or of a rectangle that holds all points.
    size: vec2<u32>,
    // Points, or cells.
    count: u32,
    // Width of a bucket: the wavelength, metres.
    bucket: f32,
    // Farther than this from every crest there are no folds, metres.
    reach: f32,
}

struct Place {
    bucket: i32,
    offset: f32,
}

@group(0) @binding(0) var<uniform> folds: Folds;
// Where the lines of each bucket begin.
@group(0) @binding(1) var<storage, read> starts: array<u32>;
// From where, from the corner of its bucket, and along which way.
@group(0) @binding(2) var<storage, read> lines: array<vec4<f32>>;
// East and north of each point, or of columns and then rows.
@group(0) @binding(3) var<storage, read> places: array<Place>;
@group(0) @binding(4) var<storage, read_write> heights: array<f32>;

fn squared_distance(line: vec4<f32>, p: vec2<f32>) -> f32 {
    let d = p - line.xy;
    let length = dot(line.zw, line.zw);
    let t = clamp(dot(d, line.zw) / max(length, LEAST_LENGTH), 0.0, 1.0);
    let off = d - t * line.zw;
    return dot(off, off);
}

// Distance to the nearest line, at most `reach`.
fn distance_to(which: Lines, x: Place, y: Place) -> f32 {
    var looked = min(FIRST_LOOK * folds.bucket, folds.reach);
    loop {
        var squared = looked * looked;
        let around = looked + which.half_length;
        let low = vec2(x.offset, y.offset) - around;
        let high = vec2(x.offset, y.offset) + around;
        let here = vec2(x.bucket, y.bucket);
        let last = which.buckets.xy + which.buckets.zw - 1;
        let begin = max(here + vec2<i32>(floor(low / folds.bucket)), which.buckets.xy);
        let end = min(here + vec2<i32>(floor(high / folds.bucket)), last);
        for (var row = begin.y; row <= end.y; row++) {
            for (var col = begin.x; col <= end.x; col++) {
                let bucket = vec2(col, row);
                let p = vec2(x.offset, y.offset) - vec2<f32>(bucket - here) * folds.bucket;
                let inside = bucket - which.buckets.xy;
                let at = which.first + u32(inside.y * which.buckets.z + inside.x);
                for (var k = starts[at]; k < starts[at + 1u]; k++) {
                    squared = min(squared, squared_distance(lines[k], p));
                }
            }
        }
        if squared < looked * looked || looked >= folds.reach {
            return sqrt(squared);
        }
        looked = min(2.0 * looked, folds.reach);
    }
    // No way leads here.
    return folds.reach;
}

fn height(x: Place, y: Place) -> f32 {
    let crest = distance_to(folds.crests, x, y);
    if crest >= folds.reach {
        return 0.0;
    }
    let trough = distance_to(folds.troughs, x, y);
    let part = crest / max(crest + trough, TOUCH);
    let z = part * part;
    let half = (1.0 - z)
        * (QUOTIENT_0 + z * (QUOTIENT_1 + z * (QUOTIENT_2 + z * (QUOTIENT_3 + z * (QUOTIENT_4 + z * QUOTIENT_5)))));
    let t = clamp((crest / folds.bucket - FADE_FROM) / (FADE_TO - FADE_FROM), 0.0, 1.0);
    let fade = 1.0 - t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    return half * half * fade;
}

@compute @workgroup_size(SIDE, SIDE)
fn on_grid(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= folds.size.x || id.y >= folds.size.y {
        return;
    }
    heights[id.y * folds.size.x + id.x] = height(places[id.x], places[folds.size.x + id.y]);
}

@compute @workgroup_size(SIDE, SIDE)
fn at_points(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = id.y * folds.size.x + id.x;
    if id.x >= folds.size.x || at >= folds.count {
        return;
    }
    heights[at] = height(places[2u * at], places[2u * at + 1u]);
}
