//! Terranes: connected regions of continental crust on a plate (section 3).

use rayon::prelude::*;

use super::plate::Plate;
use crate::sphere::{Lattice, RADIUS_KM};

/// The terranes of a plate.
#[derive(Clone, Debug, Default)]
pub(super) struct Terranes {
    /// Number of the terrane of each slot; `u32::MAX` on oceanic crust.
    pub(super) of: Vec<u32>,
    /// Areas, Mkm².
    areas: Vec<f64>,
}

impl Terranes {
    /// The terranes of all plates.
    pub(super) fn of_all(plates: &[Plate], lattice: &Lattice) -> Vec<Self> {
        plates.par_iter().map(|plate| Self::new(plate, lattice)).collect()
    }

    fn new(plate: &Plate, lattice: &Lattice) -> Self {
        let (of, sizes) = plate.regions(lattice, |slot| plate.crust[slot as usize].continental);
        let mut areas = vec![0.0; sizes.len()];
        for (&terrane, &i) in of.iter().zip(plate.members()) {
            if terrane != u32::MAX {
                areas[terrane as usize] += lattice.areas()[i as usize] * RADIUS_KM * RADIUS_KM / 1e6;
            }
        }
        Self { of, areas }
    }

    /// Area of the terrane that a slot belongs to, Mkm²; 0 on oceanic crust.
    pub(super) fn area_mkm2(&self, slot: u32) -> f64 {
        self.areas
            .get(self.of[slot as usize] as usize)
            .copied()
            .unwrap_or(0.0)
    }
}
