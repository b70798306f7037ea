//! A box of a land, to be refined by itself: what its edges inherit.

use glam::DVec2;

use crate::terrain::{Flow, MAX_NODES, Tin};
use crate::units::{Extent, KM};

/// Width of the rim in which a box passes into the land around it, in spacings of the nodes there: what lies between them
/// has nothing to match.
const RIM_SPACINGS: f64 = 2.0;
/// Most of a box that its rim may take on each side.
const MOST_RIM: f64 = 0.1;

/// A square box of a land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Its south-west corner in the plan, metres.
    pub south_west: DVec2,
    /// Its side, metres.
    pub side: f64,
    /// Distance between the nodes it is eroded on, metres.
    pub spacing: f64,
}

/// Why a box cannot be refined.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RegionError {
    /// The side is outside [`Region::SIDE_KM`], or no number.
    #[error("a side of {0} km: expected 4 to 16")]
    Side(f64),
    /// The spacing is outside [`Region::SPACING_M`], or no number.
    #[error("{0} m between nodes: expected 2 to 10")]
    Spacing(f64),
    /// Nodes that a TIN may not have.
    #[error(
        "{side_km} km at {spacing} m are {nodes} nodes: at most {MAX_NODES} are possible; expected {least:.1} m or more"
    )]
    TooFine {
        /// Side, km.
        side_km: f64,
        /// Spacing, metres.
        spacing: f64,
        /// Nodes these would be.
        nodes: usize,
        /// Least spacing of that side, metres.
        least: f64,
    },
    /// The box does not lie on the land.
    #[error("the box ends at {east:.1}, {north:.1} km: expected within 0, 0 and {width:.1}, {height:.1} km")]
    Outside {
        /// Its eastern end, km.
        east: f64,
        /// Its northern end, km.
        north: f64,
        /// Width of the land, km.
        width: f64,
        /// Height of the land, km.
        height: f64,
    },
}

impl Region {
    /// Sides that are refined, km.
    pub const SIDE_KM: std::ops::RangeInclusive<f64> = 4.0..=16.0;
    /// Distances between nodes, metres.
    pub const SPACING_M: std::ops::RangeInclusive<f64> = 2.0..=10.0;

    /// Checks the box against the land it is cut from.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check(&self, land: Extent) -> Result<(), RegionError> {
        let side_km = self.side / KM;
        if !Self::SIDE_KM.contains(&side_km) {
            return Err(RegionError::Side(side_km));
        }
        if !Self::SPACING_M.contains(&self.spacing) {
            return Err(RegionError::Spacing(self.spacing));
        }
        let nodes = self.nodes();
        if nodes > MAX_NODES {
            return Err(RegionError::TooFine {
                side_km,
                spacing: self.spacing,
                nodes,
                // Upwards, so that what is said is possible.
                least: (self.side / (MAX_NODES as f64).sqrt() * 10.0).ceil() / 10.0,
            });
        }
        let north_east = self.south_west + self.side;
        let within = land.contains(self.south_west) && land.contains(north_east);
        if !within {
            return Err(RegionError::Outside {
                east: north_east.x / KM,
                north: north_east.y / KM,
                width: land.width / KM,
                height: land.height / KM,
            });
        }
        Ok(())
    }

    /// The box as a land of its own.
    pub fn extent(&self) -> Extent {
        Extent {
            width: self.side,
            height: self.side,
        }
    }

    /// Nodes it is eroded on.
    pub fn nodes(&self) -> usize {
        (self.extent().area() / (self.spacing * self.spacing)).round() as usize
    }

    /// How much of the refined land counts at `p` (its own plan, metres): nothing at the edge, where it is the land
    /// around it with nodes `around` metres apart, and all of it inside the rim, with a slope that is continuous at both.
    pub(super) fn share(&self, p: DVec2, around: f64) -> f64 {
        let rim = (RIM_SPACINGS * around).min(MOST_RIM * self.side);
        let inwards = p.min(DVec2::splat(self.side) - p).min_element();
        let t = (inwards / rim).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// The rivers of a land where they cross the edge of a box.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Crossings {
    /// Where water comes in, in the plan of the box, and the area it drains, m².
    pub(super) inflows: Vec<(DVec2, f64)>,
    /// Where water goes out.
    pub(super) outflows: Vec<DVec2>,
}

impl Crossings {
    /// Those of `flow` over `tin` and the edge of `region`.
    pub(super) fn of(tin: &Tin, flow: &Flow, region: &Region) -> Self {
        let mut crossings = Self::default();
        let inside = |p: DVec2| region.extent().contains(p);
        for node in tin.nodes() {
            let from = tin.position(node) - region.south_west;
            let Some(receiver) = flow.receiver(node) else {
                // Water that leaves the land at the edge of the box leaves the box.
                if inside(from) {
                    crossings.outflows.push(from);
                }
                continue;
            };
            let to = tin.position(receiver) - region.south_west;
            match (inside(from), inside(to)) {
                (false, true) => {
                    let area = flow.drainage()[node.index()];
                    crossings.inflows.push((cross(from, to, inside), area));
                }
                (true, false) => crossings.outflows.push(cross(to, from, inside)),
                _ => {}
            }
        }
        crossings
    }

    /// Which nodes of the box's `tin` let water out: those nearest to where it goes out. If it goes out nowhere, the
    /// lowest node of the edge does.
    pub(super) fn outlets(&self, tin: &Tin, z: &[f64]) -> Vec<bool> {
        let edge = edge_nodes(tin);
        let mut flags = vec![false; tin.len()];
        for &p in &self.outflows {
            if let Some(i) = nearest(tin, &edge, p, |_| true) {
                flags[i] = true;
            }
        }
        if self.outflows.is_empty() {
            let lowest = edge.iter().copied().min_by(|&a, &b| z[a].total_cmp(&z[b]));
            if let Some(i) = lowest {
                flags[i] = true;
            }
        }
        flags
    }

    /// The rain on each node, as a factor: what flows in is rain on the node of the edge where it does.
    pub(super) fn rain(&self, tin: &Tin, outlets: &[bool]) -> Vec<f64> {
        let edge = edge_nodes(tin);
        let mut rain = vec![1.0; tin.len()];
        for &(p, area) in &self.inflows {
            // What comes in at an outlet would be gone at once.
            if let Some(i) = nearest(tin, &edge, p, |i| !outlets[i]) {
                rain[i] += area / tin.areas()[i];
            }
        }
        rain
    }
}

/// Nodes on the edge of the box.
fn edge_nodes(tin: &Tin) -> Vec<usize> {
    let extent = tin.extent();
    let on_edge = |p: DVec2| p.x == 0.0 || p.y == 0.0 || p.x == extent.width || p.y == extent.height;
    (0..tin.len()).filter(|&i| on_edge(tin.positions()[i])).collect()
}

fn nearest(tin: &Tin, nodes: &[usize], p: DVec2, wanted: impl Fn(usize) -> bool) -> Option<usize> {
    let distance = |&i: &usize| tin.positions()[i].distance_squared(p);
    let nodes = nodes.iter().copied().filter(|&i| wanted(i));
    nodes.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Where the way from `outside` to a place inside crosses the edge.
fn cross(outside: DVec2, within: DVec2, inside: impl Fn(DVec2) -> bool) -> DVec2 {
    let (mut out, mut inn) = (outside, within);
    for _ in 0..40 {
        let middle = out.midpoint(inn);
        if inside(middle) {
            inn = middle;
        } else {
            out = middle;
        }
    }
    inn
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAND: Extent = Extent {
        width: 178e3,
        height: 100e3,
    };

    fn region(x: f64, y: f64, side: f64, spacing: f64) -> Region {
        Region {
            south_west: DVec2::new(x, y) * KM,
            side: side * KM,
            spacing,
        }
    }

    #[test]
    fn boxes_that_cannot_be_are_refused_with_what_is_expected() {
        assert_eq!(region(10.0, 20.0, 8.0, 5.0).check(LAND), Ok(()));
        assert_eq!(region(170.0, 92.0, 8.0, 5.0).check(LAND), Ok(()));
        let said = |region: Region| region.check(LAND).unwrap_err().to_string();
        assert_eq!(
            said(region(0.0, 0.0, 3.0, 5.0)),
            "a side of 3 km: expected 4 to 16"
        );
        assert_eq!(
            said(region(0.0, 0.0, f64::NAN, 5.0)),
            "a side of NaN km: expected 4 to 16"
        );
        assert_eq!(
            said(region(0.0, 0.0, 8.0, 1.0)),
            "1 m between nodes: expected 2 to 10"
        );
        assert!(said(region(0.0, 0.0, 16.0, 2.0)).ends_with("expected 8.0 m or more"));
        assert!(region(0.0, 0.0, 16.0, 8.0).check(LAND).is_ok());
        assert!(said(region(175.0, 20.0, 8.0, 5.0)).starts_with("the box ends at 183.0, 28.0 km"));
        assert!(region(f64::NAN, 0.0, 8.0, 5.0).check(LAND).is_err());
    }

    #[test]
    fn the_edge_is_the_land_around_it() {
        let region = region(0.0, 0.0, 8.0, 5.0);
        assert_eq!(region.share(DVec2::new(0.0, 3e3), 130.0), 0.0);
        assert_eq!(region.share(DVec2::new(8e3, 3e3), 130.0), 0.0);
        assert_eq!(region.share(DVec2::splat(4e3), 1e4), 1.0);
        let middle = region.share(DVec2::new(130.0, 4e3), 130.0);
        assert!((middle - 0.5).abs() < 1e-9);
    }
}
