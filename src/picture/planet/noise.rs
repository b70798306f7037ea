//! Noise in three dimensions from hashes of lattice points, the same as in `shaders/globe.wgsl`.

use glam::Vec3;

fn hash(x: u32, y: u32, z: u32) -> u32 {
    let mut v = x ^ y ^ z;
    v = (v ^ (v >> 15)).wrapping_mul(0x2C1B_3C6D);
    v = (v ^ (v >> 12)).wrapping_mul(0x297A_2D39);
    v ^ (v >> 15)
}

/// Three numbers in [−1, 1] from a word.
fn parts(word: u32) -> Vec3 {
    let part = |shift: u32| (word >> shift & 1023) as f32 / 511.5 - 1.0;
    Vec3::new(part(0), part(10), part(20))
}

/// The lattice's cell that holds a point.
struct Cell {
    low: [u32; 3],
    high: [u32; 3],
    f: Vec3,
    u: Vec3,
}

impl Cell {
    fn of(p: Vec3, seed: u32) -> Self {
        const MIXER: [u32; 3] = [0x9E37_79B1, 0x85EB_CA77, 0xC2B2_AE3D];
        let base = p.floor();
        let whole = base.to_array().map(|x| x as i32 as u32);
        let mut low = [0; 3];
        let mut high = [0; 3];
        for k in 0..3 {
            low[k] = whole[k].wrapping_mul(MIXER[k]);
            if k == 0 {
                low[k] = low[k].wrapping_add(seed.wrapping_mul(0x27D4_EB2F));
            }
            high[k] = low[k].wrapping_add(MIXER[k]);
        }
        let f = p - base;
        Self {
            low,
            high,
            f,
            u: f * f * f * (f * (f * 6.0 - 15.0) + 10.0),
        }
    }

    /// What a corner's hash says: bits 0, 1, 2 of `corner` choose the high side along x, y, z.
    fn corner(&self, corner: usize) -> Vec3 {
        let side = |k: usize| {
            if corner >> k & 1 == 1 {
                self.high[k]
            } else {
                self.low[k]
            }
        };
        parts(hash(side(0), side(1), side(2)))
    }
}

/// Gradient noise in about [−1, 1] (Perlin 2002).
pub(super) fn gradient(p: Vec3, seed: u32) -> f32 {
    let c = Cell::of(p, seed);
    let at = |corner: usize| {
        let offset = Vec3::new(
            (corner & 1) as f32,
            (corner >> 1 & 1) as f32,
            (corner >> 2 & 1) as f32,
        );
        c.corner(corner).dot(c.f - offset)
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let low = mix(mix(at(0), at(1), c.u.x), mix(at(2), at(3), c.u.x), c.u.y);
    let high = mix(mix(at(4), at(5), c.u.x), mix(at(6), at(7), c.u.x), c.u.y);
    1.25 * mix(low, high, c.u.z)
}

/// Three independent smooth values in [−1, 1].
pub(super) fn drift(p: Vec3, seed: u32) -> Vec3 {
    let c = Cell::of(p, seed);
    let low = c
        .corner(0)
        .lerp(c.corner(1), c.u.x)
        .lerp(c.corner(2).lerp(c.corner(3), c.u.x), c.u.y);
    let high = c
        .corner(4)
        .lerp(c.corner(5), c.u.x)
        .lerp(c.corner(6).lerp(c.corner(7), c.u.x), c.u.y);
    low.lerp(high, c.u.z)
}

/// From one octave to the next: twice as fine, and turned, so that no lattice is seen.
pub(super) fn finer(p: Vec3) -> Vec3 {
    Vec3::new(
        1.6 * p.y + 1.2 * p.z,
        -1.6 * p.x + 0.72 * p.y - 0.96 * p.z,
        -1.2 * p.x - 0.96 * p.y + 1.28 * p.z,
    ) + 17.3
}
