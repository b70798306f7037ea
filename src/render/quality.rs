//! How much the picture may cost.

use super::layout::LightQuality;

/// What a graphics card or a software adapter is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderQuality {
    /// Cells of the mesh from west to east, seen aslant.
    pub mesh_columns: u32,
    /// How much denser the mesh is where one looks: 0 not at all; at 4 its cells are half as wide there, and twice as
    /// wide on the land's border.
    pub mesh_gathering: f32,
    /// Looks towards sun and sky.
    pub light: LightQuality,
    /// Parts in which light and colours are computed anew while the land grows, one part each frame: the more, the
    /// cheaper the frame and the later the light.
    pub strips: u32,
    /// Samples per pixel where the land is seen aslant (1 or 4).
    pub samples: u32,
    /// Texels of the coloured land per pixel of the window, seen aslant from near by.
    pub sheet_per_pixel: f32,
}

impl RenderQuality {
    /// For graphics cards.
    pub const HIGH: Self = Self {
        mesh_columns: 1024,
        mesh_gathering: 1.5,
        light: LightQuality {
            sun_steps: 40,
            sky_directions: 12,
            sky_steps: 10,
        },
        strips: 1,
        samples: 4,
        sheet_per_pixel: 1.5,
    };
    /// For processor cores that also run the simulation.
    pub const SOFTWARE: Self = Self {
        mesh_columns: 160,
        mesh_gathering: 4.5,
        light: LightQuality {
            sun_steps: 14,
            sky_directions: 6,
            sky_steps: 5,
        },
        strips: 6,
        samples: 1,
        sheet_per_pixel: 1.0,
    };
    /// For pictures that are kept.
    pub const PICTURE: Self = Self {
        mesh_columns: 1600,
        strips: 1,
        samples: 4,
        sheet_per_pixel: 2.0,
        ..Self::HIGH
    };
}
