//! Rates at which folds grow: `rate(p) = amplitude(p) · raise(p) · shape(p)`.

use glam::DVec2;

use super::drive::FoldDrive;
use super::edit::{FoldEdit, Raises};
use super::shape::{FoldShape, FoldStage, fill_points};

/// How fast the folds of one layer grow: what drives them, the layer's share `c_i` of the rate, and edits that raise.
#[derive(Clone, Copy, Debug)]
pub struct FoldRates<'a> {
    /// What drives folds.
    pub drive: &'a FoldDrive,
    /// The layer's share of the drive's rate, 0–1.
    pub share: f64,
    /// Edits; those that raise folds count here.
    pub edits: &'a [FoldEdit],
}

/// The rates of one layer's folds at points, and memory that is kept from one time to the next.
#[derive(Clone, Debug, Default)]
pub struct PointRates {
    /// How fast a crest would rise at each point, edits apart, m/yr.
    pub crests: Vec<f64>,
    /// How fast the ground rises there, m/yr.
    pub raised: Vec<f32>,
    /// Which points fold, where they are, and how high the folds stand there.
    folding: Vec<u32>,
    places: Vec<DVec2>,
    heights: Vec<f64>,
}

impl PointRates {
    /// Computes the rates of the folds of `shape` at `points` (plan metres).
    pub fn fill(
        &mut self,
        stage: &mut dyn FoldStage,
        shape: &FoldShape,
        rates: &FoldRates<'_>,
        points: &[DVec2],
    ) {
        let wavelength = shape.wavelength();
        fill_points(points, &mut self.crests, |p| {
            rates.drive.amplitude_rate_at(p, wavelength, rates.share)
        });
        // Most of the land folds nowhere: heights are asked for where they count.
        self.folding.clear();
        self.places.clear();
        for (at, &crest) in self.crests.iter().enumerate() {
            if crest > 0.0 {
                self.folding.push(at as u32);
                self.places.push(points[at]);
            }
        }
        stage.at_points(shape, &self.places, &mut self.heights);
        let raises = Raises::of(rates.edits, wavelength);
        self.raised.clear();
        self.raised.resize(points.len(), 0.0);
        for ((&at, &height), &p) in self.folding.iter().zip(&self.heights).zip(&self.places) {
            if height > 0.0 {
                let at = at as usize;
                self.raised[at] = (height * (self.crests[at] * raises.at(p))) as f32;
            }
        }
    }
}
