//! What a planet shows: its crust on the samples of the world.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::borders::meetings;
use super::cover::{Cover, NOBODY};
use super::crust::Crust;
use super::planet::Planet;
use super::spread;
use crate::sphere::Lattice;
use crate::surface::planet as shown;
use crate::surface::planet::{Border, BorderKind, PlateFacts};

/// Below this speed plates neither close nor part, mm/yr.
const STILL: f64 = 3.0;

impl Planet {
    /// The planet as it is `ahead_my` after its last step: plates are carried on rigidly. 0 is now; more than a step is
    /// seen as a step.
    pub fn surface(&self, ahead_my: f64) -> shown::Planet {
        // A time that is no number is no time.
        let ahead_my = ahead_my.max(0.0).min(self.params.dt_my);
        let lattice = &self.lattice;
        let mut now = self.clone();
        if ahead_my > 0.0 {
            for plate in &mut now.plates {
                plate.turn(ahead_my);
            }
        }
        let mut cover = Cover::new(&now.plates, lattice);
        now.settle(&mut cover);
        let since_my = self.time_my + ahead_my - self.spread_my;
        let noise = vec![0.0; lattice.len()];
        let gaps = spread::gaps(&cover, &now.plates, &noise, lattice, since_my, &self.params);
        let mut crust: Vec<(u16, Crust)> = (0..lattice.len() as u32)
            .into_par_iter()
            .with_min_len(2048)
            .map(|cell| match cover.owner[cell as usize] {
                NOBODY => (0, Crust::oceanic(spread::ridge_km(&self.params) as f32, 0.0)),
                owner => (owner, now.sampled(&cover, cell)),
            })
            .collect();
        for gap in gaps {
            crust[gap.cell as usize] = (gap.plate, gap.crust);
            cover.owner[gap.cell as usize] = gap.plate;
            cover.slot[gap.cell as usize] = gap.slot;
        }
        now.show(&cover, &crust, ahead_my)
    }

    /// Crust at a sample of the world: between the samples of its plate, among those of the same kind.
    fn sampled(&self, cover: &Cover, cell: u32) -> Crust {
        let lattice = &self.lattice;
        let plate = &self.plates[cover.owner[cell as usize] as usize];
        let nearest = &plate.crust[cover.slot[cell as usize] as usize];
        let local = plate.rotation.inverse() * lattice.point(cell);
        let (corners, weights) = lattice.locate(local);
        let (mut sum, mut z, mut trench, mut age, mut thickness) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (corner, weight) in corners.into_iter().zip(weights) {
            let Some(slot) = plate.slot(corner) else { continue };
            let crust = &plate.crust[slot as usize];
            if crust.continental != nearest.continental {
                continue;
            }
            let weight = weight as f32;
            sum += weight;
            z += weight * crust.z;
            trench += weight * crust.trench;
            age += weight * crust.age;
            thickness += weight * crust.thickness;
        }
        let mut crust = nearest.turned(plate.rotation);
        if sum > 0.01 {
            (crust.z, crust.trench, crust.age) = (z / sum, trench / sum, age / sum);
            crust.thickness = thickness / sum;
        }
        crust
    }

    fn show(&self, cover: &Cover, crust: &[(u16, Crust)], ahead_my: f64) -> shown::Planet {
        let lattice = &self.lattice;
        let mut areas = vec![(0.0, 0.0); self.plates.len()];
        for ((plate, crust), area) in crust.iter().zip(lattice.areas()) {
            areas[*plate as usize].0 += area;
            areas[*plate as usize].1 += if crust.continental { *area } else { 0.0 };
        }
        let plates = self
            .plates
            .iter()
            .zip(&areas)
            .map(|(plate, &(area, land))| PlateFacts {
                id: plate.id,
                rotation: plate.rotation,
                omega: plate.omega,
                area_sr: area,
                continental: if area > 0.0 { land / area } else { 0.0 },
                grip: plate.grip,
            });
        shown::Planet {
            lattice: Arc::clone(lattice),
            time_my: self.time_my + ahead_my,
            elevation_m: crust
                .iter()
                .map(|(_, crust)| 1000.0 * crust.surface_km())
                .collect(),
            plate: crust.iter().map(|(plate, _)| *plate).collect(),
            continental: crust.iter().map(|(_, crust)| crust.continental).collect(),
            thickness_km: crust.iter().map(|(_, crust)| crust.thickness).collect(),
            age_my: crust
                .iter()
                .map(|(_, crust)| if crust.continental { 0.0 } else { crust.age })
                .collect(),
            orogeny: crust.iter().map(|(_, crust)| crust.orogeny).collect(),
            orogeny_age_my: crust.iter().map(|(_, crust)| crust.orogeny_age).collect(),
            fold: crust.iter().map(|(_, crust)| crust.fold).collect(),
            ridge: crust.iter().map(|(_, crust)| crust.ridge).collect(),
            plates: plates.collect(),
            borders: self.border_lines(cover, crust),
            hot_spots: self.hot_spots.iter().map(|at| at.as_vec3()).collect(),
        }
    }

    fn border_lines(&self, cover: &Cover, crust: &[(u16, Crust)]) -> Vec<Border> {
        let lattice = &self.lattice;
        meetings(cover, &self.plates, lattice)
            .into_par_iter()
            .with_min_len(256)
            .filter_map(|meeting| {
                let [a, b] = meeting.cells;
                let ends = cell_edge(lattice, a, b)?;
                let land = [a, b].map(|cell| crust[cell as usize].1.continental);
                let kind = if meeting.closing < -STILL.max(0.3 * meeting.sliding) {
                    BorderKind::Ridge
                } else if meeting.closing <= STILL.max(0.3 * meeting.sliding) {
                    BorderKind::Transform
                } else if land[0] && land[1] {
                    BorderKind::Collision
                } else {
                    BorderKind::Subduction
                };
                let first_is_upper = self.first_is_upper(&meeting, cover);
                Some(Border {
                    ends,
                    samples: if first_is_upper { [a, b] } else { [b, a] },
                    kind,
                    closing_mm_per_yr: meeting.closing as f32,
                })
            })
            .collect()
    }
}

/// The edge between the Voronoi cells of two neighbours: the middles of the triangles on both sides.
fn cell_edge(lattice: &Lattice, a: u32, b: u32) -> Option<[Vec3; 2]> {
    let star = lattice.neighbours(a);
    let at = star.iter().position(|&n| n == b)?;
    let thirds = [
        star[(at + star.len() - 1) % star.len()],
        star[(at + 1) % star.len()],
    ];
    Some(thirds.map(|c| {
        (lattice.point(a) + lattice.point(b) + lattice.point(c))
            .normalize()
            .as_vec3()
    }))
}
