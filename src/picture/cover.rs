//! What grows and lies on the land: colours by height, slope, aspect and place.

use glam::Vec3;

use super::colour::{Ramp, linear, smoothstep};
use super::light::Spot;
use super::noise;
use super::strata::Stone;

/// Height of the upper edge of the forest, metres: that of the Southern Alps of New Zealand, a young range between two
/// plates as those of the table are (Wardle 2008, "New Zealand forest to alpine
/// transitions in global context", Arct. Antarct. Alp. Res. 40).
pub(crate) const TREE_LINE: f32 = 1300.0;

/// Height above which snow lies all year, metres: there it is 1,600 m in the wet west and 2,200 m in the dry east
/// (Chinn 1995, "Glacier fluctuations in the Southern Alps of New Zealand", Arctic and Alpine Research 27).
pub(crate) const SNOW_LINE: f32 = 2050.0;

/// Slopes (tangents) over which plants give way to the rock of a cliff: 28° to 37°.
const CLIFF: (f32, f32) = (0.53, 0.75);

/// Most that a cliff shows of its rock; the rest is ledges and what grows on them.
const CLIFF_SHOWS: f32 = 0.88;

/// The colours of the map, in linear light. Greens are never loud, rock is warm, shadows come from the light.
pub(crate) struct Palette {
    lowland: f32,
    pub(crate) open: Ramp,
    pub(crate) wood: Ramp,
    pub(crate) rock: Ramp,
    pub(crate) scree: Vec3,
    pub(crate) snow: Vec3,
    pub(crate) water_meadow: Vec3,
    pub(crate) shallow: Vec3,
    pub(crate) deep: Vec3,
    pub(crate) shore: Vec3,
    pub(crate) haze: Vec3,
}

/// Variation of the cover over several kilometres, at a place (east, north, metres). It is smooth enough to be
/// computed on a coarse grid.
pub(super) fn broad_noise((east, north): (f32, f32)) -> f32 {
    noise::fractal(east / 5200.0, north / 5200.0, 3, 11)
}

impl Palette {
    /// For land whose plains lie at about `lowland` metres.
    pub(crate) fn new(lowland: f32) -> Self {
        Self {
            lowland,
            open: Ramp::new(&[
                (-40.0, 0xc6_cfb0),
                (15.0, 0xd2_d6b6),
                (60.0, 0xdd_dcbc),
                (180.0, 0xe5_e1c0),
                (400.0, 0xe2_deb9),
                (800.0, 0xda_d9b0),
                (1200.0, 0xcc_c9a6),
                (1600.0, 0xc6_bfa4),
                (2000.0, 0xc3_bbaf),
                (3000.0, 0xd3_cec8),
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
            deep: linear(0x48_7c9b),
            shore: linear(0x4d_7d96),
            haze: linear(0xc4_d0d8),
        }
    }

    /// Colour of the dry land at a place (east, north, metres) and height (metres). `broad` is [`broad_noise`] there,
    /// `floodplain` is 1 beside large rivers.
    /// `stone` is the rock under it, where it is known.
    pub(super) fn land(
        &self,
        at: (f32, f32),
        height: f32,
        broad: f32,
        floodplain: f32,
        spot: &Spot,
        stone: Option<Stone>,
    ) -> Vec3 {
        let (east, north) = at;
        let fine = noise::fractal(east / 1100.0, north / 1100.0, 3, 23);
        let border = 0.6 * broad + 0.4 * fine;
        let slope = spot.steepness;

        // Hypsometric tints over the lowland, with borders that wander.
        let over_lowland = height - self.lowland;
        let mut colour = self
            .open
            .at(over_lowland + (20.0 + 0.1 * over_lowland.clamp(0.0, 1200.0)) * border);

        // The plains: broad soft fields of tone that follow the gentle relief, greener in hollows, paler on swells.
        let plain = 1.0 - smoothstep(0.05, 0.16, spot.form_steepness + 0.5 * spot.hillside);
        // Beside mountains the mean height around is theirs, and says nothing of the plain.
        let open = 1.0 - smoothstep(0.004, 0.02, spot.form_steepness);
        let swell = open * (spot.rise / 14.0).clamp(-1.0, 1.0);
        if plain > 0.0 {
            let tone = 0.030 * broad + 0.035 * swell;
            let warmth = 0.022 * broad + 0.030 * swell;
            let field = Vec3::new(1.0 + tone + warmth, 1.0 + tone, 1.0 + tone - warmth);
            colour *= Vec3::ONE.lerp(field, plain);
        }
        let meadow = floodplain * (1.0 - smoothstep(0.06, 0.20, slope));
        colour = colour.lerp(self.water_meadow, 0.75 * meadow);

        // Woods: on slopes too steep to plough and not too steep to root, in hollows, on shaded sides; in patches on
        // the plain, along its rivers.
        let tree_line = TREE_LINE - 130.0 * spot.northness + 190.0 * border;
        let below = 1.0 - smoothstep(tree_line - 260.0, tree_line + 60.0, height);
        let rooted = smoothstep(0.06, 0.20, spot.hillside) * (1.0 - smoothstep(0.85, 1.25, slope));
        let grove = smoothstep(0.15, 0.75, 0.9 * broad + 0.12 * fine - 0.35 * swell);
        let clearing = smoothstep(-0.95, -0.25, 0.45 * fine + 0.6 * broad + 0.45 * spot.northness);
        let wood = below * (rooted * clearing).max(0.30 * grove * plain);
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
        // Near the snow even gentle ground is stones.
        let barren = smoothstep(SNOW_LINE - 600.0, SNOW_LINE - 50.0, height + 260.0 * border);
        let bare = bare.max(0.8 * barren);
        let grain = 1.0 + 0.07 * fine;
        let mut rock = self.rock.at(height);
        let mut shows = bare * (0.55 + 0.45 * alpine);
        if let Some(stone) = stone {
            // Cliffs show their beds; gentler ground has only a tinge of its rock, or beds would look like contours.
            let cliff = smoothstep(CLIFF.0, CLIFF.1, slope + 0.06 * fine);
            rock = rock.lerp(stone.layer, 0.7).lerp(stone.bedded, cliff);
            shows = shows.max(CLIFF_SHOWS * cliff);
        }
        colour = colour.lerp(rock * grain, shows);

        // Snow: high, in the shade lower, in hollows lower, not on faces it slides from.
        let snow_line = SNOW_LINE - 330.0 * spot.northness + 170.0 * border + 90.0 * spot.convexity;
        let lies = smoothstep(snow_line - 90.0, snow_line + 190.0, height + 120.0 * fine);
        let slides = smoothstep(0.85, 1.25, slope + 0.08 * fine);
        colour.lerp(self.snow, lies * (1.0 - 0.75 * slides))
    }

    /// Colour of standing water of some depth, metres: tints that step at the depths of a bathymetric chart, softly,
    /// over a bottom that is faintly shaded.
    pub(super) fn lake(&self, depth: f32, spot: &Spot) -> Vec3 {
        const STEPS: [f32; 6] = [10.0, 30.0, 75.0, 150.0, 300.0, 600.0];
        let depth = depth.max(0.0);
        let stepped: f32 = STEPS
            .iter()
            .map(|&step| smoothstep(0.86 * step, 1.14 * step, depth))
            .sum();
        let steady = 1.0 - (-depth / 260.0).exp();
        let share = 0.45 * stepped / STEPS.len() as f32 + 0.55 * steady;
        let bottom = Vec3::ONE.lerp(spot.light, 0.22);
        self.shallow.lerp(self.deep, share) * bottom * (0.80 + 0.20 * spot.sky)
    }

    /// Colour of a shoreline.
    pub(super) fn shore(&self) -> Vec3 {
        self.shore
    }

    /// The colour seen through the air above low land: `height_share` 0 in the plains, 1 at the summits.
    pub(super) fn through_air(&self, colour: Vec3, height_share: f32) -> Vec3 {
        let thickness = 0.13 * (1.0 - height_share) * (1.0 - height_share);
        colour.lerp(self.haze, thickness)
    }
}
