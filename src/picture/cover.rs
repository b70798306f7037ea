//! What grows and lies on the land: colours by height, slope, aspect and place.

use glam::Vec3;

use super::colour::{Ramp, linear, smoothstep};
use super::light::Spot;
use super::noise;

/// Height of the upper edge of the forest, metres: that of the Southern Alps of New Zealand, a young range between two
/// plates as those of the table are (Wardle 2008, "New Zealand forest to alpine
/// transitions in global context", Arct. Antarct. Alp. Res. 40).
const TREE_LINE: f32 = 1300.0;

/// Height above which snow lies all year, metres: there it is 1,600 m in the wet west and 2,200 m in the dry east
/// (Chinn 1995, "Glacier fluctuations in the Southern Alps of New Zealand", Arctic and Alpine Research 27).
const SNOW_LINE: f32 = 2050.0;

/// The colours of the map, in linear light. Greens are never loud, rock is warm, shadows come from the light.
pub(super) struct Palette {
    lowland: f32,
    open: Ramp,
    wood: Ramp,
    rock: Ramp,
    scree: Vec3,
    snow: Vec3,
    water_meadow: Vec3,
    shallow: Vec3,
    deep: Vec3,
    haze: Vec3,
}

/// Variation of the cover over several kilometres, at a place (east, north, metres). It is smooth enough to be
/// computed on a coarse grid.
pub(super) fn broad_noise((east, north): (f32, f32)) -> f32 {
    noise::fractal(east / 5200.0, north / 5200.0, 3, 11)
}

impl Palette {
    /// For land whose plains lie at about `lowland` metres.
    pub(super) fn new(lowland: f32) -> Self {
        Self {
            lowland,
            open: Ramp::new(&[
                (-40.0, 0xc6_cfb0),
                (15.0, 0xd2_d6b6),
                (60.0, 0xdd_dcbc),
                (180.0, 0xe5_e1c0),
                (400.0, 0xe2_deb9),
                (800.0, 0xda_d9b0),
                (1200.0, 0xcd_cfa3),
                (1700.0, 0xc8_c6a4),
                (2200.0, 0xcc_c5b2),
                (3000.0, 0xd8_d3cb),
            ]),
            wood: Ramp::new(&[
                (-200.0, 0xab_ba99),
                (400.0, 0x9b_ac88),
                (900.0, 0x88_9a79),
                (1400.0, 0x80_9175),
            ]),
            rock: Ramp::new(&[(500.0, 0xb4_a794), (1400.0, 0xa8_a29b), (2600.0, 0xa9_a6a6)]),
            scree: linear(0xc8_bfae),
            snow: linear(0xef_f1f2),
            water_meadow: linear(0xb4_c69c),
            shallow: linear(0x9f_c4cf),
            deep: linear(0x4f_86a3),
            haze: linear(0xc4_d0d8),
        }
    }

    /// Colour of the dry land at a place (east, north, metres) and height (metres). `broad` is [`broad_noise`] there,
    /// `floodplain` is 1 beside large rivers.
    pub(super) fn land(&self, at: (f32, f32), height: f32, broad: f32, floodplain: f32, spot: &Spot) -> Vec3 {
        let (east, north) = at;
        let fine = noise::fractal(east / 1100.0, north / 1100.0, 3, 23);
        let border = 0.6 * broad + 0.4 * fine;
        let slope = spot.steepness;

        // Hypsometric tints over the lowland, with borders that wander.
        let over_lowland = height - self.lowland;
        let mut colour = self
            .open
            .at(over_lowland + (20.0 + 0.1 * over_lowland.clamp(0.0, 1200.0)) * border);

        // The plains: a quilt of fields.
        let plain = 1.0 - smoothstep(0.05, 0.16, spot.form_steepness + 0.3 * slope);
        if plain > 0.0 {
            let warp = 0.35 * fine;
            let (word, edge) = noise::parcel(east / 820.0 + warp, north / 820.0 - warp, 31);
            let tone = 0.030 * noise::signed(word) + 0.05 * broad;
            let warmth = 0.025 * noise::signed(word.wrapping_mul(0x9E37_79B1));
            let hedge = 0.035 * (1.0 - smoothstep(0.0, 0.10, edge));
            let field = Vec3::new(
                1.0 + tone + warmth - hedge,
                1.0 + tone - hedge,
                1.0 + tone - warmth - hedge,
            );
            colour *= Vec3::ONE.lerp(field, plain);
        }
        let meadow = floodplain * (1.0 - smoothstep(0.06, 0.20, slope));
        colour = colour.lerp(self.water_meadow, 0.75 * meadow);

        // Woods: on slopes too steep to plough and not too steep to root, in hollows, on shaded sides; in patches on
        // the plain, along its rivers.
        let tree_line = TREE_LINE - 130.0 * spot.northness + 190.0 * border;
        let below = 1.0 - smoothstep(tree_line - 260.0, tree_line + 60.0, height);
        let rooted = smoothstep(0.07, 0.26, slope) * (1.0 - smoothstep(0.85, 1.25, slope));
        let patch = smoothstep(
            0.22,
            0.48,
            0.42 * broad + 0.40 * fine + (spot.rise / 90.0).clamp(-0.4, 0.4),
        ) * 0.62;
        let clearing = smoothstep(
            -0.85,
            -0.25,
            fine + 0.5 * broad + 0.45 * spot.northness - 0.35 * spot.convexity,
        );
        let wood = below * (rooted * clearing).max(patch * (1.0 - smoothstep(0.85, 1.25, slope)));
        colour = colour.lerp(self.wood.at(height), 0.88 * wood);

        // Scree below, rock where nothing holds.
        let alpine = smoothstep(TREE_LINE - 200.0, TREE_LINE + 500.0, height + 260.0 * border);
        let scree = alpine * smoothstep(0.42, 0.66, slope + 0.12 * fine) * 0.6;
        colour = colour.lerp(self.scree, scree);
        let bare = smoothstep(
            0.74 - 0.20 * alpine,
            1.02 - 0.20 * alpine,
            slope + 0.10 * fine + 0.10 * spot.convexity,
        );
        let grain = 1.0 + 0.07 * fine;
        colour = colour.lerp(self.rock.at(height) * grain, bare * (0.55 + 0.45 * alpine));

        // Snow: high, in the shade lower, in hollows lower, not on faces it slides from.
        let snow_line = SNOW_LINE - 330.0 * spot.northness + 170.0 * border + 160.0 * spot.convexity;
        let lies = smoothstep(snow_line - 90.0, snow_line + 190.0, height + 120.0 * fine);
        let slides = smoothstep(0.80, 1.15, slope + 0.08 * fine);
        colour.lerp(self.snow, lies * (1.0 - 0.85 * slides))
    }

    /// Colour of standing water of some depth, metres.
    pub(super) fn lake(&self, depth: f32) -> Vec3 {
        self.shallow
            .lerp(self.deep, 1.0 - (-depth.max(0.0) / 260.0).exp())
    }

    /// The colour seen through the air above low land: `height_share` 0 in the plains, 1 at the summits.
    pub(super) fn through_air(&self, colour: Vec3, height_share: f32) -> Vec3 {
        let thickness = 0.13 * (1.0 - height_share) * (1.0 - height_share);
        colour.lerp(self.haze, thickness)
    }
}
