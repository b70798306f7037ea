//! Colours: linear light in, sRGB out.

use glam::Vec3;

use crate::rock::Colour;

/// Linear light of an sRGB colour given as `0xRRGGBB` (IEC 61966-2-1).
pub(crate) fn linear(hex: u32) -> Vec3 {
    let channel = |shift: u32| {
        let v = ((hex >> shift) & 0xff) as f32 / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    };
    Vec3::new(channel(16), channel(8), channel(0))
}

/// Linear light of an sRGB colour.
pub(super) fn light([red, green, blue]: Colour) -> Vec3 {
    linear(u32::from(red) << 16 | u32::from(green) << 8 | u32::from(blue))
}

/// Linear light → sRGB bytes by table.
pub(crate) struct Encoder {
    table: Vec<u8>,
}

/// Table entries: four per step of the steepest part of the curve.
const STEPS: usize = 1 << 14;

impl Encoder {
    pub(crate) fn new() -> Self {
        let table = (0..=STEPS)
            .map(|i| {
                let v = i as f32 / STEPS as f32;
                let encoded = if v <= 0.003_130_8 {
                    12.92 * v
                } else {
                    1.055 * v.powf(1.0 / 2.4) - 0.055
                };
                (encoded * 255.0).round() as u8
            })
            .collect();
        Self { table }
    }

    /// sRGB bytes of linear light, clipped to what can be shown.
    pub(crate) fn encode(&self, colour: Vec3) -> [u8; 3] {
        let steps = (colour.clamp(Vec3::ZERO, Vec3::ONE) * STEPS as f32 + 0.5).to_array();
        steps.map(|step| self.table[step as usize])
    }
}

/// Colours along a scale, mixed between the neighbouring entries. Below the first and above the last they stay.
pub(crate) struct Ramp {
    entries: Vec<(f32, Vec3)>,
}

impl Ramp {
    /// Entries `(value, 0xRRGGBB)` in ascending order.
    pub(super) fn new(entries: &[(f32, u32)]) -> Self {
        Self {
            entries: entries.iter().map(|&(at, hex)| (at, linear(hex))).collect(),
        }
    }

    pub(crate) fn at(&self, value: f32) -> Vec3 {
        let after = self.entries.partition_point(|entry| entry.0 <= value);
        match (
            after.checked_sub(1).map(|i| self.entries[i]),
            self.entries.get(after),
        ) {
            (Some((a, low)), Some(&(b, high))) => low.lerp(high, (value - a) / (b - a)),
            (Some((_, colour)), None) | (None, Some(&(_, colour))) => colour,
            (None, None) => Vec3::ZERO,
        }
    }
}

/// 0 below `low`, 1 above `high`, smooth between (Hermite).
#[inline]
pub(crate) fn smoothstep(low: f32, high: f32, value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_linear_and_back() {
        let encoder = Encoder::new();
        for byte in 0..=255_u32 {
            let hex = byte << 16 | byte << 8 | byte;
            assert_eq!(encoder.encode(linear(hex)), [byte as u8; 3]);
        }
    }
}
