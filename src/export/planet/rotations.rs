//! `plates.rot`: how the plates turned, as a rotation file of `GPlates` (PLATES4 format).

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DQuat;

use crate::sphere::latitude_longitude;

/// Where a plate was at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Model time, My.
    pub time_my: f64,
    /// The plate's name.
    pub plate: u32,
    /// From the plate's own frame to the world's.
    pub rotation: DQuat,
}

/// A plate's number in `GPlates`, where 0 is the world's frame.
pub(super) fn gplates_id(plate: u32) -> u32 {
    plate.saturating_add(1)
}

/// Writes lines of `plate time latitude longitude angle fixed-plate ! comment`, degrees and My, sorted by plate and age.
///
/// * Times count backwards: 0 is the last moment of `history`.
/// * A rotation takes the plate from where it lies at the end, as in `plates.geojson`, to where it was; a plate that is
///   gone, from where it was last.
/// * A plate begins at its first entry: at the start of the planet, or when a rift made it.
/// * Plate 0 is the world's frame, to which all rotations refer; a plate's number is its name + 1.
///
/// # Errors
/// Where `out` fails.
pub fn write_rotations(mut out: impl Write, history: &[Rotation]) -> io::Result<()> {
    let end_my = history
        .iter()
        .map(|entry| entry.time_my)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut plates: BTreeMap<u32, Vec<Rotation>> = BTreeMap::new();
    for entry in history {
        plates.entry(entry.plate).or_default().push(*entry);
    }
    for (plate, mut entries) in plates {
        entries.sort_by(|a, b| b.time_my.total_cmp(&a.time_my));
        entries.dedup_by_key(|entry| entry.time_my.to_bits());
        let home = entries[0].rotation.inverse();
        for entry in entries {
            let turn = (entry.rotation * home).normalize();
            let turn = if turn.w < 0.0 { -turn } else { turn };
            let (axis, angle) = turn.to_axis_angle();
            let (latitude, longitude) = if angle == 0.0 {
                (90.0, 0.0)
            } else {
                latitude_longitude(axis)
            };
            writeln!(
                out,
                "{} {:.4} {latitude:.8} {longitude:.8} {:.8} 0 ! plate {plate}",
                gplates_id(plate),
                end_my - entry.time_my,
                angle.to_degrees(),
            )?;
        }
    }
    Ok(())
}
