//! The spherical Delaunay triangulation, made once.

use glam::{DQuat, DVec3};
use spade::{DelaunayTriangulation, Point2, Triangulation as _};

/// Marks "nobody" among sample indices.
const NONE: u32 = u32::MAX;

/// Triangles, neighbours in compressed rows, and areas of the cells.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    triangles: Vec<[u32; 3]>,
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    areas: Vec<f64>,
}

impl Mesh {
    /// The triangulation of `points`: seen stereographically from the first of them, which so lies at infinity, the others
    /// are triangulated in the plane, and each edge of their hull makes a triangle with the first. Circles stay circles, so
    /// it is the Delaunay triangulation of the sphere, without a patch at a pole. `None` when it does not close.
    pub(super) fn new(points: &[DVec3]) -> Option<Self> {
        let to_pole = DQuat::from_rotation_arc(points[0], DVec3::Z);
        let plane: Vec<Point2<f64>> = points[1..]
            .iter()
            .map(|&p| {
                let p = to_pole * p;
                Point2::new(p.x / (1.0 - p.z), p.y / (1.0 - p.z))
            })
            .collect();
        let flat = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(plane).ok()?;
        let mut triangles = Vec::with_capacity(2 * points.len() - 4);
        for face in flat.inner_faces() {
            triangles.push(face.vertices().map(|v| v.index() as u32 + 1));
        }
        for edge in flat.convex_hull() {
            let [a, b] = edge.vertices().map(|v| v.index() as u32 + 1);
            triangles.push([0, a, b]);
        }
        if triangles.len() != 2 * points.len() - 4 {
            return None;
        }
        for corner in &mut triangles {
            let [a, b, c] = corner.map(|i| points[i as usize]);
            if a.dot(b.cross(c)) < 0.0 {
                corner.swap(1, 2);
            }
        }
        let (starts, neighbours) = stars(points.len(), &triangles)?;
        let mut mesh = Self {
            triangles,
            starts,
            neighbours,
            areas: Vec::new(),
        };
        mesh.areas = (0..points.len() as u32)
            .map(|i| mesh.cell_area(i, points))
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

    /// Area of the Voronoi cell of `i`: a fan of spherical triangles to the circumcentres around it.
    fn cell_area(&self, i: u32, points: &[DVec3]) -> f64 {
        let p = points[i as usize];
        let star = self.neighbours(i);
        let centre = |k: usize| {
            let (a, b) = (
                points[star[k] as usize],
                points[star[(k + 1) % star.len()] as usize],
            );
            (a - p).cross(b - p).normalize()
        };
        (0..star.len())
            .map(|k| triangle_area(p, centre(k), centre((k + 1) % star.len())))
            .sum()
    }
}

/// Solid angle of a spherical triangle (Van Oosterom and Strackee 1983), steradians, positive when counter-clockwise.
fn triangle_area(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let volume = a.dot(b.cross(c));
    2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// Neighbours of each sample in order around it, in compressed rows.
fn stars(samples: usize, triangles: &[[u32; 3]]) -> Option<(Vec<u32>, Vec<u32>)> {
    let mut degrees = vec![0_u32; samples];
    for corner in triangles {
        for &i in corner {
            degrees[i as usize] += 1;
        }
    }
    let mut starts = Vec::with_capacity(samples + 1);
    let mut total = 0;
    starts.push(0);
    for degree in degrees {
        total += degree;
        starts.push(total);
    }
    // Each triangle says of each of its corners who follows whom around it.
    let mut links = vec![[NONE; 2]; total as usize];
    let mut filled = starts.clone();
    for &[a, b, c] in triangles {
        for (at, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
            links[filled[at as usize] as usize] = [from, to];
            filled[at as usize] += 1;
        }
    }
    let mut neighbours = vec![NONE; total as usize];
    for i in 0..samples {
        let range = starts[i] as usize..starts[i + 1] as usize;
        let (links, row) = (&links[range.clone()], &mut neighbours[range]);
        let mut at = links.first()?[0];
        for place in row.iter_mut() {
            *place = at;
            at = links.iter().find(|link| link[0] == at)?[1];
        }
        if at != row[0] {
            return None;
        }
    }
    Some((starts, neighbours))
}
