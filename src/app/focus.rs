//! Where the flight looks: the most rugged part of the land, followed slowly.

use glam::DVec2;

use crate::render::Oblique;
use crate::surface::Surface;
use crate::units::KM;

/// Cells that are looked at along each side to find it.
const LOOKS: usize = 64;
/// Time in which the eye follows, s: slower than anybody notices.
const FOLLOWS_S: f64 = 6.0;
/// Time of one turn around, s.
const TURN_S: f64 = 240.0;
/// Where the eye is when it has just left the plan: it looks north, as the plan does.
const AZIMUTH: f64 = -0.35;

/// The middle of the high land.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Focus {
    at: Option<DVec2>,
    height: f64,
}

impl Focus {
    /// Follows the land; at once while nobody sees it (`aloft` 0).
    pub(super) fn follow(&mut self, surface: &Surface, aloft: f64, dt_s: f64) {
        let (at, height) = high_land(surface);
        let part = if aloft > 0.0 && self.at.is_some() {
            1.0 - (-dt_s / FOLLOWS_S).exp()
        } else {
            1.0
        };
        let from = self.at.unwrap_or(at);
        self.at = Some(from.lerp(at, part));
        self.height += (height - self.height) * part;
    }

    /// The eye after `seconds` of flight over heights that are exaggerated.
    pub(super) fn eye(&self, seconds: f64, exaggeration: f64) -> Oblique {
        Oblique {
            focus: self.at.unwrap_or_default(),
            focus_height: 0.5 * self.height * exaggeration,
            azimuth: AZIMUTH + std::f64::consts::TAU * seconds / TURN_S,
            depression: 0.36,
            distance: 105.0 * KM,
            field_of_view: 0.6,
        }
    }
}

/// The middle of the land weighted by how far it stands out, and the greatest height seen.
fn high_land(surface: &Surface) -> (DVec2, f64) {
    let raster = &surface.height;
    let (across, down) = ((raster.width / LOOKS).max(1), (raster.height / LOOKS).max(1));
    let (mut sum, mut total, mut highest) = (DVec2::ZERO, 0.0, 0.0_f64);
    for row in (0..raster.height).step_by(down) {
        for column in (0..raster.width).step_by(across) {
            let height = f64::from(raster.data[row * raster.width + column]);
            if height.is_finite() {
                let weight = (height.max(0.0) / KM + 0.05).powi(3);
                sum += raster.centre(column, row) * weight;
                total += weight;
                highest = highest.max(height);
            }
        }
    }
    if total > 0.0 {
        (sum / total, highest)
    } else {
        (raster.extent.size() / 2.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Raster;
    use crate::units::Extent;

    #[test]
    fn it_looks_at_the_mountain() {
        let extent = Extent {
            width: 178.0 * KM,
            height: 100.0 * KM,
        };
        let summit = DVec2::new(120.0 * KM, 30.0 * KM);
        let height = Raster::from_fn(200, 112, extent, |p| {
            (3000.0 * (-(p.distance(summit) / 8e3).powi(2)).exp()) as f32
        });
        let flat = Raster::from_fn(200, 112, extent, |_| 0.0);
        let surface = Surface {
            height,
            lake_depth: flat.clone(),
            drainage: flat,
            spacing: 800.0,
            rivers: Vec::new(),
            plates: Vec::new(),
            faults: Vec::new(),
            elapsed_yr: 0.0,
        };
        let mut focus = Focus::default();
        focus.follow(&surface, 0.0, 0.1);
        assert!(focus.eye(0.0, 1.0).focus.distance(summit) < 12.0 * KM);
    }
}
