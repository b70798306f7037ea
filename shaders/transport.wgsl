// Transport, Eq. 1–2, as `mountain::transport` has it: displacements at the corners of cells, then thickening.

struct Problem {
    // Cells.
    cols: u32,
    rows: u32,
    bodies: u32,
    exponent: f32,
    // For distances in units.
    rest_weight: f32,
    per_cell: f32,
}

struct Body {
    // T⁻¹π − π = spin·(π − pivot) + lift, row by row, metres.
    spin: vec4<f32>,
    lift: vec2<f32>,
    radius: f32,
    // Its edges.
    first: u32,
    edges: u32,
    // 1 where edges enclose something.
    solid: u32,
}

// An edge of a body's core; a lone corner is one without length.
struct Edge {
    // Outwards.
    normal: vec2<f32>,
    // Where the body's pivot is: beyond the edge, and along it from where it begins, metres.
    beyond: f32,
    along: f32,
    length: f32,
}

@group(0) @binding(0) var<uniform> problem: Problem;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> edges: array<Edge>;
// For each body: where columns and then rows of corners lie from its pivot, metres.
@group(0) @binding(3) var<storage, read> places: array<f32>;
// East and then north components of displacements, metres, then thickening.
@group(0) @binding(4) var<storage, read_write> field: array<f32>;

// From the nearest point of the core to `p`, which is relative to the body's pivot.
fn beyond(body: Body, p: vec2<f32>) -> vec2<f32> {
    var nearest = vec2(0.0);
    var least = FARTHEST;
    var inside = body.solid != 0u;
    for (var k = body.first; k < body.first + body.edges; k++) {
        let edge = edges[k];
        let tangent = vec2(-edge.normal.y, edge.normal.x);
        let out = dot(edge.normal, p) + edge.beyond;
        let along = dot(tangent, p) + edge.along;
        let past = along - clamp(along, 0.0, edge.length);
        inside = inside && out <= 0.0;
        if out > 0.0 && past == 0.0 {
            // Far away, squares do not tell an edge from its corners any more.
            return out * edge.normal;
        }
        let squared = out * out + past * past;
        if squared < least {
            least = squared;
            nearest = out * edge.normal + past * tangent;
        }
    }
    return select(nearest, vec2(0.0), inside);
}

@compute @workgroup_size(SIDE, SIDE)
fn corners(@builtin(global_invocation_id) id: vec3<u32>) {
    let across = problem.cols + 1u;
    let down = problem.rows + 1u;
    if id.x >= across || id.y >= down {
        return;
    }
    var weights = problem.rest_weight;
    var shift = vec2(0.0);
    for (var k = 0u; k < problem.bodies; k++) {
        let body = bodies[k];
        let table = k * (across + down);
        let p = vec2(places[table + id.x], places[table + across + id.y]);
        let outside = beyond(body, p);
        let from_core = length(outside);
        let distance = from_core - body.radius;
        // Inside, the weight exceeds all others' a million times.
        let weight = exp2_of(-problem.exponent * log2_of(max(distance, RIM) * PER_UNIT));
        let projection = p - outside * (max(distance, 0.0) / max(from_core, RIM));
        weights += weight;
        shift += weight
            * (vec2(dot(body.spin.xy, projection), dot(body.spin.zw, projection)) + body.lift);
    }
    // Without bodies and without rest nothing moves.
    shift *= 1.0 / max(weights, LEAST_WEIGHT);
    let at = id.y * across + id.x;
    field[at] = shift.x;
    field[across * down + at] = shift.y;
}

@compute @workgroup_size(SIDE, SIDE)
fn cells(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= problem.cols || id.y >= problem.rows {
        return;
    }
    let across = problem.cols + 1u;
    let corners = across * (problem.rows + 1u);
    let above = id.y * across + id.x;
    let below = above + across;
    // Diagonals of the quad in cells, rising and falling: what the shifts add.
    let rising = vec2(
        field[above + 1u] - field[below],
        field[corners + above + 1u] - field[corners + below],
    ) * problem.per_cell;
    let falling = vec2(
        field[above] - field[below + 1u],
        field[corners + above] - field[corners + below + 1u],
    ) * problem.per_cell;
    let change = (rising.x + falling.y + rising.x * falling.y)
        + (rising.y - falling.x - rising.y * falling.x);
    field[2u * corners + id.y * problem.cols + id.x] = 1.0 + 0.5 * change;
}
