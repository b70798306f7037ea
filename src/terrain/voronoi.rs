//! Areas of Voronoi cells clipped to the rectangle of land.

use glam::DVec2;

use super::tin::{NodeId, Tin};
use crate::units::Extent;

/// Area of each node's Voronoi cell within the extent, m².
///
/// An inner triangle gives each of its corners the quadrilateral corner – edge middle – circumcentre – edge middle.
/// The three signed areas sum to the triangle whatever the circumcentre, so nothing is lost to rounding. Cells that
/// the hull leaves open (`hull` flags their nodes), or whose corners lie outside the rectangle, are cut from the rectangle instead.
pub(super) fn cell_areas(tin: &Tin, hull: &[bool]) -> Vec<f64> {
    let extent = tin.extent();
    let mut areas = vec![0.0; tin.len()];
    let mut cut = hull.to_vec();
    for triangle in tin.triangles() {
        let nodes = triangle.map(|k| k as usize);
        let [a, b, c] = nodes.map(|k| tin.positions()[k]);
        let centre = circumcentre(a, b, c);
        if !extent.contains(centre) {
            for k in nodes {
                cut[k] = true;
            }
            continue;
        }
        for (k, corner, after, before) in [(0, a, b, c), (1, b, c, a), (2, c, a, b)] {
            let (after, before) = (0.5 * (after - corner), 0.5 * (before - corner));
            let centre = centre - corner;
            areas[nodes[k]] += 0.5 * (after.perp_dot(centre) + centre.perp_dot(before));
        }
    }
    let mut cell = Vec::new();
    for node in tin.nodes() {
        let i = node.index();
        // Rounding in a needle of a triangle can leave less than nothing.
        if cut[i] || areas[i] <= 0.0 {
            areas[i] = cut_cell_area(tin, node, extent, &mut cell);
        }
    }
    areas
}

/// Cuts the rectangle by the bisector with each Delaunay neighbour; what remains is the cell.
fn cut_cell_area(tin: &Tin, node: NodeId, extent: Extent, cell: &mut Vec<DVec2>) -> f64 {
    let p = tin.position(node);
    let size = extent.size();
    cell.clear();
    cell.extend(
        [
            DVec2::ZERO,
            DVec2::new(size.x, 0.0),
            size,
            DVec2::new(0.0, size.y),
        ]
        .map(|q| q - p),
    );
    let mut kept = Vec::with_capacity(16);
    for neighbour in tin.neighbours(node) {
        let d = tin.position(neighbour) - p;
        let limit = 0.5 * d.length_squared();
        kept.clear();
        for k in 0..cell.len() {
            let (from, to) = (cell[k], cell[(k + 1) % cell.len()]);
            let (beyond_from, beyond_to) = (from.dot(d) - limit, to.dot(d) - limit);
            if beyond_from <= 0.0 {
                kept.push(from);
            }
            if (beyond_from < 0.0) != (beyond_to < 0.0) && beyond_from != 0.0 && beyond_to != 0.0 {
                kept.push(from + (to - from) * (beyond_from / (beyond_from - beyond_to)));
            }
        }
        std::mem::swap(cell, &mut kept);
    }
    let doubled: f64 = (0..cell.len())
        .map(|k| cell[k].perp_dot(cell[(k + 1) % cell.len()]))
        .sum();
    (0.5 * doubled).max(0.0)
}

/// Centre of the circle through three points; far outside (or not finite) when they are nearly on a line.
fn circumcentre(a: DVec2, b: DVec2, c: DVec2) -> DVec2 {
    let (b, c) = (b - a, c - a);
    let (bb, cc) = (b.length_squared(), c.length_squared());
    let doubled = 2.0 * b.perp_dot(c);
    a + DVec2::new(c.y * bb - b.y * cc, b.x * cc - c.x * bb) / doubled
}
