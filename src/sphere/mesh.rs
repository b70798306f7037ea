//! The spherical Delaunay triangulation of the lattice, star by star.

use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::lattice::Inverse;

/// Samples whose stars one task makes.
const CHUNK: usize = 4096;

/// Within so many samples of a pole the neighbours' steps are not Fibonacci numbers yet; there all samples of about the
/// same height are candidates.
const POLAR: usize = 160;

/// How many samples before and after one near a pole are its candidates: more than a turn of the spiral and back.
const POLAR_REACH: usize = 60;

/// Fibonacci numbers `F(k − 2)` to `F(k + 3)` are the candidates' steps, where `F(k)` and `F(k + 1)` span the cells:
/// the neighbours' own are `F(k − 1)` to `F(k + 2)`, one more on either side is a margin.
const FIBONACCI: [usize; 24] = [
    0, 1, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377, 610, 987, 1597, 2584, 4181, 6765, 10946, 17711,
    28657,
];

/// Triangles, neighbours in compressed rows, and areas of the cells.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    triangles: Vec<[u32; 3]>,
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    areas: Vec<f64>,
}

impl Mesh {
    /// The triangulation of the samples of a Fibonacci lattice. The neighbours of a sample are Fibonacci numbers away
    /// from it, so each star is made on its own from a dozen candidates: seen stereographically from the sample, which
    /// so lies at infinity, its Delaunay neighbours are the convex hull of all others. `None` when the stars do not
    /// agree with each other.
    ///
    /// `spiral` are the points in the order of the spiral; `turns` says for each sample where it is there, `numbers` the
    /// reverse.
    pub(super) fn new(spiral: &[DVec3], inverse: &Inverse, turns: &[u32], numbers: &[u32]) -> Option<Self> {
        let (starts, neighbours) = renumbered(&stars(spiral, inverse)?, turns, numbers);
        let mut mesh = Self {
            triangles: Vec::new(),
            starts,
            neighbours,
            areas: Vec::new(),
        };
        mesh.triangles = mesh.close()?;
        let point = |i: u32| spiral[turns[i as usize] as usize];
        mesh.areas = (0..spiral.len() as u32)
            .into_par_iter()
            .map(|i| mesh.cell_area(i, point))
            .collect();
        Some(mesh)
    }

    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub(super) fn neighbours(&self, i: u32) -> &[u32] {
        let i = i as usize;
        &self.neighbours[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    pub(super) fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// The triangles of all stars, each once, at its first corner. `None` unless every triangle is in the stars of all
    /// its corners and there are as many as close a sphere.
    fn close(&self) -> Option<Vec<[u32; 3]>> {
        let samples = self.starts.len() - 1;
        let parts: Vec<Option<Vec<[u32; 3]>>> = chunks(samples)
            .map(|range| {
                let mut triangles = Vec::with_capacity(2 * range.len());
                for i in range.start as u32..range.end as u32 {
                    for (a, b) in turns(self.neighbours(i)) {
                        let shared = turns(self.neighbours(a)).any(|turn| turn == (b, i));
                        if !shared {
                            return None;
                        }
                        if i < a && i < b {
                            triangles.push([i, a, b]);
                        }
                    }
                }
                Some(triangles)
            })
            .collect();
        let mut triangles = Vec::with_capacity(2 * samples - 4);
        for part in parts {
            triangles.extend_from_slice(&part?);
        }
        (triangles.len() == 2 * samples - 4).then_some(triangles)
    }

    /// Area of the Voronoi cell of `i`: a fan of spherical triangles to the circumcentres around it.
    fn cell_area(&self, i: u32, point: impl Fn(u32) -> DVec3) -> f64 {
        let p = point(i);
        let centre = |(a, b): (u32, u32)| (point(a) - p).cross(point(b) - p).normalize();
        let star = self.neighbours(i);
        let mut last = centre((star[star.len() - 1], star[0]));
        // Half the solid angle of a triangle is the argument of a complex number (Van Oosterom and Strackee 1983);
        // arguments of a product add up.
        let mut product = DVec2::X;
        for turn in turns(star) {
            let next = centre(turn);
            let along = 1.0 + p.dot(last) + last.dot(next) + next.dot(p);
            product = product.rotate(DVec2::new(along, p.dot(last.cross(next))));
            last = next;
        }
        2.0 * product.y.atan2(product.x)
    }
}

/// Compressed rows: where each begins, and what is in them.
type Rows = (Vec<u32>, Vec<u32>);

/// Rows in the order of the spiral → rows in the order of the samples.
fn renumbered((starts, neighbours): &Rows, turns: &[u32], numbers: &[u32]) -> Rows {
    let mut own_starts = Vec::with_capacity(starts.len());
    let mut own = Vec::with_capacity(neighbours.len());
    own_starts.push(0);
    for &turn in turns {
        let turn = turn as usize;
        let star = &neighbours[starts[turn] as usize..starts[turn + 1] as usize];
        own.extend(star.iter().map(|&n| numbers[n as usize]));
        own_starts.push(own.len() as u32);
    }
    (own_starts, own)
}

/// Each neighbour in a star with the one that follows it.
fn turns(star: &[u32]) -> impl Iterator<Item = (u32, u32)> {
    let followers = star.iter().cycle().skip(1);
    star.iter().copied().zip(followers.copied())
}

/// Ranges of [`CHUNK`] samples, in parallel.
fn chunks(samples: usize) -> impl IndexedParallelIterator<Item = Range<usize>> {
    (0..samples.div_ceil(CHUNK))
        .into_par_iter()
        .map(move |chunk| chunk * CHUNK..((chunk + 1) * CHUNK).min(samples))
}

/// Neighbours of each sample in order around it, in compressed rows.
fn stars(points: &[DVec3], inverse: &Inverse) -> Option<Rows> {
    let parts: Vec<Option<(Vec<u8>, Vec<u32>)>> = chunks(points.len())
        .map(|range| {
            let mut degrees = Vec::with_capacity(range.len());
            let mut neighbours = Vec::with_capacity(6 * range.len());
            let mut seen = Vec::new();
            for i in range {
                let before = neighbours.len();
                candidates(i, points, inverse, &mut seen);
                wrap(&seen, &mut neighbours)?;
                degrees.push((neighbours.len() - before) as u8);
            }
            Some((degrees, neighbours))
        })
        .collect();
    let mut starts = Vec::with_capacity(points.len() + 1);
    let mut neighbours = Vec::with_capacity(6 * points.len() - 12);
    let mut total = 0;
    starts.push(0);
    for part in parts {
        let (degrees, part) = part?;
        for degree in degrees {
            total += u32::from(degree);
            starts.push(total);
        }
        neighbours.extend_from_slice(&part);
    }
    Some((starts, neighbours))
}

/// Samples that may be neighbours of `i`, seen stereographically from it.
fn candidates(i: usize, points: &[DVec3], inverse: &Inverse, seen: &mut Vec<(u32, DVec2)>) {
    let n = points.len();
    let p = points[i];
    let (east, north) = p.any_orthonormal_pair();
    let see = |j: usize| {
        let d = points[j] - p;
        (
            j as u32,
            DVec2::new(d.dot(east), d.dot(north)) / d.length_squared(),
        )
    };
    seen.clear();
    if i < POLAR || i + POLAR >= n {
        let reach = i.saturating_sub(POLAR_REACH)..(i + POLAR_REACH + 1).min(n);
        seen.extend(reach.filter(|&j| j != i).map(see));
    } else {
        // From F(k − 2) on.
        let first = inverse.zone(p.z);
        for &step in &FIBONACCI[first..first + 6] {
            if let Some(j) = i.checked_sub(step) {
                seen.push(see(j));
            }
            if i + step < n {
                seen.push(see(i + step));
            }
        }
    }
}

/// Appends the convex hull of what is seen, counter-clockwise. It starts at the nearest sample, which is seen farthest
/// out. `None` when it does not close.
fn wrap(seen: &[(u32, DVec2)], hull: &mut Vec<u32>) -> Option<()> {
    let farthest = |&a: &usize, &b: &usize| {
        let (a, b) = (seen[a].1.length_squared(), seen[b].1.length_squared());
        a.total_cmp(&b)
    };
    let first = (0..seen.len()).max_by(farthest)?;
    let mut at = first;
    for _ in 0..seen.len() {
        hull.push(seen[at].0);
        let from = seen[at].1;
        let mut next = usize::from(at == 0);
        let mut along = seen.get(next)?.1 - from;
        for (j, &(_, to)) in seen.iter().enumerate() {
            if along.perp_dot(to - from) < 0.0 {
                (next, along) = (j, to - from);
            }
        }
        at = next;
        if at == first {
            return Some(());
        }
    }
    None
}
