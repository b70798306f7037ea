// What all passes that shape and colour the land share. Grids have row 0 in the north, as rasters have.

struct Ground {
    // Size of the land, metres.
    extent: vec2<f32>,
    // Cells of the height grid.
    grid: vec2<f32>,
    // Texels of the sheet.
    sheet: vec2<f32>,
    // Typical distance between the points the heights come from, metres.
    spacing: f32,
    // Height of the plains, metres.
    lowland: f32,
    // Share of the newest land that is mixed into the land as drawn, 0 to 1.
    blend: f32,
    // Heights are multiplied by this where the land is seen aslant.
    exaggeration: f32,
    // Upper edge of the forest and lower edge of lasting snow, metres.
    tree_line: f32,
    snow_line: f32,
    // Height at which haze and contrast are those of summits, metres.
    summit: f32,
    // Cells of a rim whose heights only hold the border.
    rim: f32,
    // Greatest lake depth that a byte holds, metres.
    deepest: f32,
    // Heights between which the ramps of colour are read, metres.
    ramp_low: f32,
    ramp_high: f32,
    // 1 if the land is also lit for the view aslant.
    aslant: f32,
    // Thickness of the pile of layers, metres; 0 where nothing is known of it.
    pile: f32,
    // Share of the geological map's colours, 0 to 1.
    geology: f32,
}

@group(0) @binding(0) var<uniform> ground: Ground;

// A triangle that covers the target.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}
