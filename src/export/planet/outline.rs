//! Outlines of plates: rings of Voronoi edges between samples of different plates.

use glam::DVec3;

use crate::sphere::Lattice;

/// The closed rings around the samples for which `plate` has one value, for each value below `count`. Seen from outside
/// the sphere, the plate lies to the left of its rings; a ring's first point is not repeated.
///
/// Corners of Voronoi cells lie in the middle of the triangles' circles, where three cells meet: a ring passes each of
/// them once, and neighbouring plates share theirs to the bit.
pub(super) fn rings(lattice: &Lattice, plate: &[u16], count: usize) -> Vec<Vec<Vec<DVec3>>> {
    let triangles = lattice.triangles();
    // From a directed edge between two plates to the triangle on its left.
    let mut edges: Vec<(u64, u32)> = Vec::new();
    for (number, &[a, b, c]) in triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if plate[from as usize] != plate[to as usize] {
                edges.push((key(from, to), number as u32));
            }
        }
    }
    edges.sort_unstable();
    let find = |from: u32, to: u32| edges.binary_search_by_key(&key(from, to), |edge| edge.0).ok();
    let centre = |number: u32| {
        let [a, b, c] = triangles[number as usize].map(|i| lattice.point(i));
        (b - a).cross(c - a).normalize()
    };
    let mut rings = vec![Vec::new(); count];
    let mut passed = vec![false; edges.len()];
    for first in 0..edges.len() {
        // The edge from the plate's sample to a foreign one is crossed from right to left.
        let owner = plate[(edges[first].0 >> 32) as usize];
        let mut ring = Vec::new();
        let mut at = first;
        while !passed[at] {
            passed[at] = true;
            let number = edges[at].1;
            ring.push(centre(number));
            // The way out of the triangle: the edge that comes back to the plate, seen from the other side.
            let [a, b, c] = triangles[number as usize];
            let back = [(a, b), (b, c), (c, a)]
                .into_iter()
                .find(|&(from, to)| plate[from as usize] != owner && plate[to as usize] == owner);
            let Some(next) = back.and_then(|(from, to)| find(to, from)) else {
                break;
            };
            at = next;
        }
        if ring.len() > 2 {
            rings[owner as usize].push(ring);
        }
    }
    rings
}

fn key(from: u32, to: u32) -> u64 {
    (u64::from(from) << 32) | u64::from(to)
}
