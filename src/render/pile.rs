//! The pile of layers as the graphics card takes it: how its beds look, by depth.

use glam::Vec3;

use super::layout::{PILE_ROWS, PILE_STEPS};
use crate::gpu::Gpu;
use crate::picture::colour::linear;
use crate::rock::{Bedding, Colour, Stratigraphy};

/// Part of the table below the last layer: the basement.
const BELOW: f64 = 0.1;
/// Looks within one step of the table.
const LOOKS: usize = 4;
/// Lighter by so much is a hard bed at full contrast, and darker a weak one.
const HARD: f64 = 0.17;
const WEAK: f64 = 0.29;
/// Debris of weak beds against clean faces of hard ones: red, green, blue.
const DEBRIS: Vec3 = Vec3::new(1.0, 0.985, 0.985);
/// The shade below the edge of a hard bed reaches so far into the weak one below, as a part of it.
const OVERHANG: f64 = 0.20;
/// A joint between beds is so thick, as a part of the bed, but no thicker than so many metres.
const JOINT: (f64, f64) = (0.07, 14.0);
/// Typical thickness of the banks that beds consist of, metres.
const BANK: f64 = 48.0;
/// How much banks differ.
const BANK_TONE: f64 = 0.06;

/// A pile's looks by depth, with means over ever longer pieces of it.
pub(super) struct Pile {
    pub(super) view: wgpu::TextureView,
    /// Depth over which the table reaches, metres.
    pub(super) range_m: f32,
}

impl Pile {
    /// The looks of a pile.
    pub(super) fn new(gpu: &Gpu, stratigraphy: &Stratigraphy) -> Self {
        let range_m = range(stratigraphy);
        Self::filled(gpu, &rows(stratigraphy, range_m), range_m as f32)
    }

    /// Where nothing is known of the layers.
    pub(super) fn none(gpu: &Gpu) -> Self {
        Self::filled(gpu, &[vec![[0.0; 4]], vec![[0.0; 4]], vec![[0.0; 4]]], 0.0)
    }

    fn filled(gpu: &Gpu, rows: &[Vec<[f32; 4]>; PILE_ROWS.len()], range_m: f32) -> Self {
        let steps = rows[0].len() as u32;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("pile"),
            size: wgpu::Extent3d {
                width: steps,
                height: 1,
                depth_or_array_layers: rows.len() as u32,
            },
            mip_level_count: steps.ilog2() + 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (row, texels) in rows.iter().enumerate() {
            let mut texels = texels.clone();
            for level in 0..texture.mip_level_count() {
                fill(gpu, &texture, (level, row as u32), &texels);
                texels = halved(&texels);
            }
        }
        Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..wgpu::TextureViewDescriptor::default()
            }),
            range_m,
        }
    }
}

fn fill(gpu: &Gpu, texture: &wgpu::Texture, (level, row): (u32, u32), texels: &[[f32; 4]]) {
    let bytes: Vec<u8> = texels
        .as_flattened()
        .iter()
        .map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
        .collect();
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: level,
            origin: wgpu::Origin3d { x: 0, y: 0, z: row },
            aspect: wgpu::TextureAspect::All,
        },
        &bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes.len() as u32),
            rows_per_image: None,
        },
        wgpu::Extent3d {
            width: texels.len() as u32,
            height: 1,
            depth_or_array_layers: 1,
        },
    );
}

fn halved(texels: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let mean = |pair: &[[f32; 4]]| std::array::from_fn(|i| f32::midpoint(pair[0][i], pair[1][i]));
    texels.chunks_exact(2).map(mean).collect()
}

/// Depth over which a pile's table reaches, metres.
fn range(stratigraphy: &Stratigraphy) -> f64 {
    stratigraphy.depths().last().copied().unwrap_or(0.0).max(1.0) * (1.0 + BELOW)
}

/// The rows of the table in the order of [`PILE_ROWS`].
fn rows(stratigraphy: &Stratigraphy, range_m: f64) -> [Vec<[f32; 4]>; PILE_ROWS.len()] {
    let steps = PILE_STEPS as usize;
    let bedding = |step: usize, look: usize| {
        let part = (step as f64 + (look as f64 + 0.5) / LOOKS as f64) / steps as f64;
        stratigraphy.bedding(part * range_m)
    };
    let mut tones: Vec<(usize, Vec3, f32)> = (0..steps)
        .map(|step| {
            let looks = (0..LOOKS).map(|look| {
                let bed = bedding(step, look);
                (tone(&bed), bed.hardness as f32)
            });
            let sum = looks.fold((Vec3::ZERO, 0.0), |sum, look| (sum.0 + look.0, sum.1 + look.1));
            let part = 1.0 / LOOKS as f32;
            (bedding(step, LOOKS / 2).layer, sum.0 * part, sum.1 * part)
        })
        .collect();
    // Seen from afar a layer has the colour of its stone.
    for layer in tones.chunk_by_mut(|a, b| a.0 == b.0) {
        let mean = layer.iter().map(|step| step.1).sum::<Vec3>() / layer.len() as f32;
        for step in layer {
            step.1 /= mean;
        }
    }
    let beds = tones.iter().map(|&(_, tone, hardness)| {
        let Vec3 { x, y, z } = tone * 0.5;
        [x, y, z, 0.5 + 0.5 * hardness]
    });
    let roots = |colour: &dyn Fn(usize) -> Colour| -> Vec<[f32; 4]> {
        let root = |&(layer, ..): &(usize, Vec3, f32)| {
            let [r, g, b] = colour(layer).map(u32::from);
            let Vec3 { x, y, z } = linear(r << 16 | g << 8 | b);
            [x.sqrt(), y.sqrt(), z.sqrt(), 1.0]
        };
        tones.iter().map(root).collect()
    };
    [
        beds.collect(),
        roots(&|layer| stratigraphy.rock(layer).stone),
        roots(&|layer| stratigraphy.rock(layer).colour),
    ]
}

/// How much lighter than its layer a bed is at a place in it: red, green, blue.
fn tone(bed: &Bedding) -> Vec3 {
    if bed.thickness_m <= 0.0 {
        return Vec3::ONE;
    }
    let joint = JOINT.0.min(JOINT.1 / bed.thickness_m);
    // Nothing lies on the topmost bed.
    let at_joint = if (bed.part < joint && bed.bed > 0) || bed.part > 1.0 - joint {
        0.84
    } else {
        1.0
    };
    let (base, debris) = if bed.hardness < 0.0 {
        let shade = 0.36 * -bed.hardness * (1.0 - bed.part / OVERHANG).max(0.0);
        ((1.0 + WEAK * bed.hardness) * (1.0 - shade), -bed.hardness)
    } else {
        (1.0 + HARD * bed.hardness, 0.0)
    };
    let colour = Vec3::ONE.lerp(DEBRIS, debris as f32);
    colour * (base * at_joint * bank(bed)) as f32
}

/// Tone of the bank at a place in a bed: banks are of uneven thickness, with a joint between each two.
fn bank(bed: &Bedding) -> f64 {
    let banks = (bed.thickness_m / BANK).round().clamp(1.0, 9.0);
    let uneven = |i: f64| 0.3 * (noise(bed.bed, i as usize) - 0.5);
    let at = bed.part * banks;
    // Which bank, when the joints are moved up or down.
    let mut which = at.floor();
    if which > 0.0 && at < which + uneven(which) {
        which -= 1.0;
    } else if which + 1.0 < banks && at >= which + 1.0 + uneven(which + 1.0) {
        which += 1.0;
    }
    let tone = 1.0 + BANK_TONE * (2.0 * noise(bed.bed + 64, which as usize) - 1.0);
    let from_top = at - which - if which > 0.0 { uneven(which) } else { 0.0 };
    if which > 0.0 && from_top < 0.16 {
        tone * 0.90
    } else {
        tone
    }
}

/// A number from 0 to 1 that is always the same for the same bed and bank (fractional parts of multiples of the plastic
/// number's powers are spread evenly, Roberts 2018).
fn noise(bed: usize, bank: usize) -> f64 {
    (0.5 + bed as f64 * 0.754_877_666_246_693 + bank as f64 * 0.569_840_290_998_053_3).fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rock::preset;

    #[test]
    fn from_afar_every_layer_has_the_colour_of_its_stone() {
        for name in preset::names() {
            let pile = preset::by_name(name).unwrap();
            let range_m = range(&pile);
            let [beds, ..] = rows(&pile, range_m);
            for (layer, depths) in pile.depths().windows(2).enumerate() {
                let step = |depth: f64| (depth / range_m * f64::from(PILE_STEPS)).round() as usize;
                let steps = &beds[step(depths[0])..step(depths[1])];
                let mean = steps.iter().map(|step| step[1]).sum::<f32>() / steps.len() as f32;
                assert!((mean - 0.5).abs() < 0.01, "{name}, layer {layer}: {mean}");
            }
        }
    }

    #[test]
    fn hard_beds_are_lighter_than_weak_ones_and_tones_fit_into_bytes() {
        for name in preset::names() {
            let pile = preset::by_name(name).unwrap();
            let [beds, ..] = rows(&pile, range(&pile));
            let mean = |hard: bool| {
                let of: Vec<f32> = beds
                    .iter()
                    .filter(|bed| if hard { bed[3] > 0.6 } else { bed[3] < 0.4 })
                    .map(|bed| bed[1])
                    .collect();
                of.iter().sum::<f32>() / of.len() as f32
            };
            assert!(mean(true) > 1.1 * mean(false), "{name}");
            assert!(
                beds.as_flattened().iter().all(|part| (0.0..=1.0).contains(part)),
                "{name}"
            );
        }
    }

    #[test]
    fn the_basement_has_no_beds() {
        let pile = preset::default();
        let [beds, ..] = rows(&pile, range(&pile));
        assert_eq!(beds.last(), Some(&[0.5; 4]));
    }
}
