//! What is shared with the shaders: uniforms, instances and constants. `tests/gpu/render_shaders.rs` compares the layouts.

use std::fmt::Write as _;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::upload::SHORE_BLUR;
use crate::picture::colour::linear;
use crate::picture::cover::Palette;
use crate::picture::light::SUN_ELEVATION;
use crate::picture::water::RIVER;

/// As `Ground` in `shaders/ground.wgsl`, which says what the fields mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Ground {
    pub extent: [f32; 2],
    pub grid: [f32; 2],
    pub sheet: [f32; 2],
    pub spacing: f32,
    pub lowland: f32,
    pub blend: f32,
    pub exaggeration: f32,
    pub tree_line: f32,
    pub snow_line: f32,
    pub summit: f32,
    pub rim: f32,
    pub deepest: f32,
    pub ramp_low: f32,
    pub ramp_high: f32,
    pub aslant: f32,
    pub pile: f32,
    pub geology: f32,
}

/// As `View` in `shaders/land.wgsl`, which says what the fields mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct View {
    pub view_proj: [[f32; 4]; 4],
    pub eye: [f32; 4],
    pub right: [f32; 4],
    pub up: [f32; 4],
    pub forward: [f32; 4],
    pub extent: [f32; 2],
    pub mesh: [f32; 2],
    pub focus: [f32; 2],
    pub gathering: f32,
    pub lowland: f32,
    pub plan: [f32; 4],
    pub tilt: f32,
    pub exaggeration: f32,
    pub haze: f32,
    pub lamp: f32,
    pub encodes: f32,
    pub dusk: f32,
    pub layered: f32,
}

/// As `Air` in `shaders/land.wgsl`: colours in linear light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Air {
    pub mist: [f32; 4],
    pub distance: [f32; 4],
    pub glow: [f32; 4],
    pub horizon: [f32; 4],
    pub middle: [f32; 4],
    pub zenith: [f32; 4],
    pub table: [f32; 4],
}

/// As `Reach` in `shaders/rivers.wgsl`: a straight piece of a river.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Reach {
    pub from_to: [f32; 4],
    pub half_widths: [f32; 2],
    pub large: [f32; 2],
}

impl Reach {
    /// The vertex attributes, in the order of the shader's locations.
    pub(super) const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
        wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x2, 2 => Float32x2];
}

/// As `Globe` in `shaders/globe.wgsl`, which says what the fields mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Globe {
    pub turn: [[f32; 4]; 3],
    pub centre: [f32; 2],
    pub size: [f32; 2],
    pub radius: f32,
    pub octaves: u32,
    pub lamp: f32,
    pub encodes: f32,
    pub window: [f32; 2],
}

/// As `Frames` in `shaders/globe.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Frames {
    pub turns: [[f32; 4]; 256],
}

/// The shaders, by name, as they are written; [`source`] makes modules of them.
pub const SHADERS: [(&str, &str); 8] = [
    ("grow", include_str!("../../shaders/grow.wgsl")),
    ("relief", include_str!("../../shaders/relief.wgsl")),
    ("noise", include_str!("../../shaders/noise.wgsl")),
    ("rivers", include_str!("../../shaders/rivers.wgsl")),
    ("sheet", include_str!("../../shaders/sheet.wgsl")),
    ("land", include_str!("../../shaders/land.wgsl")),
    ("shrink", include_str!("../../shaders/shrink.wgsl")),
    ("globe", include_str!("../../shaders/globe.wgsl")),
];

/// What several shaders share.
const GROUND: &str = include_str!("../../shaders/ground.wgsl");
const ENCODE: &str = include_str!("../../shaders/encode.wgsl");
const PILE: &str = include_str!("../../shaders/pile.wgsl");

/// Looks in each direction when light is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightQuality {
    /// Steps towards the sun.
    pub sun_steps: u32,
    /// Directions in which the sky is looked at.
    pub sky_directions: u32,
    /// Steps in each.
    pub sky_steps: u32,
}

/// Cells of the height grid along one texel of the big forms.
pub(super) const FORM_CELLS: u32 = 8;
/// Cells along one texel of the light.
pub(super) const LIGHT_CELLS: u32 = 2;
/// Texels of the sheet along one texel of the meadows.
pub(super) const MEADOW_TEXELS: u32 = 4;
/// Generations of gullies below the mesh.
const GULLIES: u32 = 3;
/// Radius over which big forms are taken, metres.
const FORM_REACH: f32 = 4000.0;
/// Width of the meadows beside a large river, metres.
const MEADOW: f32 = 1400.0;
/// Farthest that shadows and skies look, cells of the grid.
const FARTHEST_LOOK: f64 = 110.0;

/// Rows of vertices beyond each side of the land.
pub(super) const RINGS: u32 = 12;
/// Where the evening's sun stands, radians clockwise from north, and its height over the horizon, radians.
pub(super) const EVENING_AZIMUTH: f64 = 290.0 / 180.0 * std::f64::consts::PI;
const EVENING_ELEVATION: f64 = 0.27;

/// Loose gravel and sand that rivers have laid down.
const ALLUVIUM: u32 = 0xdc_d8c6;

/// The dark of the room around the land, `0xRRGGBB`.
pub(super) const ROOM: u32 = 0x14_1618;

/// Corners of the polygon in which a planet is drawn: what lies beside the disc is drawn for nothing.
pub(super) const DISC_CORNERS: u32 = 24;
/// Cells per radian of the coarsest detail of a planet.
pub(super) const PLANET_DETAIL: f64 = 9.0;
/// Cells of the finest detail of a planet along a pixel.
pub(super) const FINEST_DETAIL: f64 = 0.5;

/// Rows of the ramp texture: colours by height.
pub(super) const RAMP_ROWS: [&str; 3] = ["OPEN", "WOOD", "ROCK"];
/// Heights that ramps know.
pub(super) const RAMP_STEPS: u32 = 1024;

/// Rows of the pile's table: how beds differ from their layer and how hard they are, the layers' stone, and their colour
/// on geological maps.
pub(super) const PILE_ROWS: [&str; 3] = ["BEDS", "STONE", "CHART"];
/// Steps of the pile from its first surface to below its last layer.
pub(super) const PILE_STEPS: u32 = 2048;

/// Factor from one step to the next, so that `steps` steps from `first` cells reach [`FARTHEST_LOOK`].
fn stride(steps: u32, first: f64) -> f64 {
    (FARTHEST_LOOK / first).powf(1.0 / f64::from(steps.max(2) - 1))
}

/// The whole text of a shader: the constants that Rust and shaders share, what shaders share, and its own.
pub fn source(name: &str, light: LightQuality, penumbra: (f32, f32)) -> String {
    let mut text = String::new();
    let mut constant = |name: &str, value: &dyn std::fmt::Display| {
        // Writing into a string cannot fail.
        let _ = writeln!(text, "const {name} = {value};");
    };
    let float = |value: f64| format!("{value:?}");
    constant("FORM_CELLS", &float(f64::from(FORM_CELLS)));
    constant("LIGHT_CELLS", &float(f64::from(LIGHT_CELLS)));
    constant("FORM_REACH", &float(f64::from(FORM_REACH)));
    constant("MEADOW", &float(f64::from(MEADOW)));
    constant("GULLIES", &GULLIES);
    constant("SUN_STEPS", &light.sun_steps);
    constant(
        "SUN_STRIDE",
        &float(stride(light.sun_steps, 0.9 * f64::from(LIGHT_CELLS))),
    );
    constant("SKY_DIRECTIONS", &light.sky_directions);
    constant("SKY_STEPS", &light.sky_steps);
    constant(
        "SKY_STRIDE",
        &float(stride(light.sky_steps, 1.2 * f64::from(LIGHT_CELLS))),
    );
    constant("PENUMBRA_LOW", &float(f64::from(penumbra.0)));
    constant("PENUMBRA_HIGH", &float(f64::from(penumbra.1)));
    let evening = [
        ("EVENING_EAST", EVENING_AZIMUTH.sin()),
        ("EVENING_NORTH", EVENING_AZIMUTH.cos()),
        ("EVENING_SINE", EVENING_ELEVATION.sin()),
        ("EVENING_COSINE", EVENING_ELEVATION.cos()),
        ("EVENING_TANGENT", EVENING_ELEVATION.tan()),
        ("SUN_SINE", f64::from(SUN_ELEVATION).sin()),
        ("SUN_COSINE", f64::from(SUN_ELEVATION).cos()),
        ("RINGS", f64::from(RINGS)),
        ("SHORE_BLUR", SHORE_BLUR),
    ];
    for (name, value) in evening {
        constant(name, &float(value));
    }
    constant("RAMP_STEPS", &float(f64::from(RAMP_STEPS)));
    constant("PILE_STEPS", &float(f64::from(PILE_STEPS)));
    constant("ROOM", &format_args!("{ROOM}u"));
    constant("CORNERS", &format_args!("{DISC_CORNERS}u"));
    constant("DETAIL", &float(PLANET_DETAIL));
    constant("FINEST", &float(FINEST_DETAIL));
    for names in [RAMP_ROWS, PILE_ROWS] {
        for (row, name) in names.iter().enumerate() {
            constant(name, &row);
        }
    }
    let palette = Palette::new(0.0);
    let colours = [
        ("SCREE", palette.scree),
        ("SNOW", palette.snow),
        ("WATER_MEADOW", palette.water_meadow),
        ("SHALLOW", palette.shallow),
        ("DEEP", palette.deep),
        ("SHORE", palette.shore),
        ("RIVER", linear(RIVER)),
        ("VALLEY", palette.haze),
        ("ALLUVIUM", linear(ALLUVIUM)),
    ];
    for (name, Vec3 { x, y, z }) in colours {
        constant(name, &format_args!("vec3<f32>({x:?}, {y:?}, {z:?})"));
    }
    let own = SHADERS
        .iter()
        .find(|(other, _)| *other == name)
        .map_or("", |(_, own)| own);
    let shared = match name {
        "shrink" => "",
        "land" | "globe" => ENCODE,
        _ => GROUND,
    };
    let more = match name {
        "sheet" => [SHADERS[2].1, ENCODE, PILE].concat(),
        "land" => PILE.to_owned(),
        _ => String::new(),
    };
    format!("{text}{shared}{more}{own}")
}
