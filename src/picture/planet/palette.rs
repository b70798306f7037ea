//! Colours of seas and lands in linear light; `shaders/globe.wgsl` has the same numbers.

use glam::Vec3;

use crate::picture::colour::linear;

/// From 0 to 1 between two edges, either way round.
pub(super) fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The colours, decoded once.
pub(super) struct Palette {
    sea: [Vec3; 5],
    land: [Vec3; 12],
    pack: [Vec3; 2],
}

/// What covers a place: its colour and how much of it is ice.
pub(super) struct Ground {
    pub(super) colour: Vec3,
    pub(super) ice: f32,
}

impl Palette {
    pub(super) fn new() -> Self {
        Self {
            sea: [0x008a_bbc6, 0x005b_97b5, 0x003b_769f, 0x001f_4c7d, 0x000f_2648].map(linear),
            land: [
                0x00d8_c297,
                0x005c_8350,
                0x00aa_a66b,
                0x00bf_b489,
                0x007b_9862,
                0x008d_9a7b,
                0x005d_7a60,
                0x00a3_9f8e,
                0x00b0_9a78,
                0x008f_8172,
                0x007d_746b,
                0x00f1_f4f6,
            ]
            .map(linear),
            pack: [0x00c9_dbe4, 0x00ea_f1f4].map(linear),
        }
    }

    /// Water over a depth, km below the sea.
    pub(super) fn sea(&self, depth: f32) -> Vec3 {
        let [shore, shelf, slope, plain, deep] = self.sea;
        let shelf = shore.lerp(shelf, smoothstep(0.0, 0.5, depth));
        let slope = shelf.lerp(slope, smoothstep(0.3, 2.2, depth));
        let plain = slope.lerp(plain, smoothstep(2.0, 4.4, depth));
        plain.lerp(deep, smoothstep(4.2, 7.0, depth))
    }

    /// Ice on the sea, by how cold it is, °C: colour and how much of the water it covers.
    pub(super) fn pack(&self, cold: f32) -> (Vec3, f32) {
        let colour = self.pack[0].lerp(self.pack[1], smoothstep(-15.0, -18.0, cold));
        (colour, smoothstep(-13.5, -16.0, cold))
    }

    /// What grows at a height (km) and at the sine of a latitude, in a climate of belts: wet at the equator, dry in the
    /// horse latitudes, wet again, cold. The last three, −1 to 1, vary it at broad, middling and fine extent.
    pub(super) fn land(&self, km: f32, sine: f32, steep: f32, [broad, middling, fine]: [f32; 3]) -> Ground {
        let [
            sand,
            jungle,
            savanna,
            steppe,
            wood,
            heath,
            taiga,
            tundra,
            upland,
            high,
            rock,
            snow,
        ] = self.land;
        let square = sine * sine;
        let warmth = 29.0 - 46.0 * square - 5.0 * km.max(0.0) + 4.0 * broad + 2.2 * middling + 1.2 * fine;
        let tropics = (-square * 16.0).exp();
        let off = sine.abs() - 0.78;
        let westerlies = (-off * off * 22.0).exp();
        let wet = 0.15 + 0.95 * tropics + 0.80 * westerlies + 0.34 * broad + 0.20 * middling + 0.14 * fine;
        let lush = smoothstep(0.22, 0.72, wet);
        let hot = sand
            .lerp(jungle, lush)
            .lerp(savanna, 0.75 * (1.0 - (1.0 - 2.0 * lush).abs()));
        let mild = steppe.lerp(wood, lush);
        let cold = heath.lerp(taiga, lush);
        let ground = mild.lerp(hot, smoothstep(13.0, 22.0, warmth));
        let ground = cold.lerp(ground, smoothstep(2.0, 12.0, warmth));
        let ground = tundra.lerp(ground, smoothstep(-5.0, 3.0, warmth));
        let upland = upland.lerp(high, smoothstep(2.4, 4.2, km));
        let ground = ground.lerp(upland, 0.85 * smoothstep(0.9, 2.6, km + 0.5 * fine));
        let ground = ground.lerp(rock, 0.6 * smoothstep(0.35, 0.9, steep));
        let ice = smoothstep(-6.0, -10.5, warmth + 5.0 * steep);
        Ground {
            colour: ground.lerp(snow, ice),
            ice,
        }
    }
}
