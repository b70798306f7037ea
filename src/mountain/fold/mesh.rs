//! The random triangulation whose edges can become folds.

use std::ops::RangeInclusive;

use glam::DVec2;
use rayon::prelude::*;

use super::FoldError;
use super::drive::FoldDrive;
use crate::terrain::Tin;
use crate::units::{Extent, KM};

/// Wavelengths that folds can have, metres: 0.5–20 km and a little more. Shorter ones make meshes of a million edges,
/// longer ones two folds per land.
pub const WAVELENGTHS: RangeInclusive<f64> = 0.4 * KM..=25.0 * KM;

/// Disc radius of the sampling, in wavelengths. Saturated sampling has a mean edge of 1.333 radii, and crests of folds
/// stand 0.85 mean edges apart: this radius makes their mean wavelength the one asked for.
const RADIUS: f64 = 0.878;

/// How far the mesh reaches beyond the land, in wavelengths: where it ends, so do folds.
const MARGIN: f64 = 2.0;

/// A side of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshEdge {
    /// The vertices at its ends, the smaller first.
    pub ends: [u32; 2],
    /// The face beside it.
    pub face: u32,
    /// The face on its other side; none on the border of the mesh.
    pub other: Option<u32>,
}

/// A place and a direction at which the drive is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Probe {
    middle: DVec2,
    /// Cosine and sine of twice the azimuth.
    doubled: [f64; 2],
}

/// What makes two meshes the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeshKey {
    pub(super) extent: Extent,
    pub(super) wavelength: f64,
    pub(super) seed: u64,
}

/// A Delaunay triangulation of saturated Poisson-disc samples, with edges about as long as folds are wide; it reaches two
/// wavelengths beyond the land. Edges and faces are numbered along a Hilbert curve.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldMesh {
    key: MeshKey,
    vertices: Vec<DVec2>,
    edges: Vec<MeshEdge>,
    faces: Vec<[u32; 3]>,
    /// Each edge, and its four dual edges.
    probes: Vec<[Probe; 5]>,
    /// Edges at vertex i are `around[first_around[i]..first_around[i + 1]]`.
    first_around: Vec<u32>,
    around: Vec<u32>,
}

impl FoldMesh {
    /// The mesh for folds of `wavelength` metres over `extent`, a pure function of its arguments.
    ///
    /// # Errors
    /// [`FoldError`] for a wavelength outside [`WAVELENGTHS`] and an extent that is no rectangle or too large.
    pub fn new(extent: Extent, wavelength: f64, seed: u64) -> Result<Self, FoldError> {
        if !WAVELENGTHS.contains(&wavelength) {
            return Err(FoldError::Wavelength {
                wavelength,
                least: *WAVELENGTHS.start(),
                most: *WAVELENGTHS.end(),
            });
        }
        let margin = MARGIN * wavelength;
        let grown = Extent {
            width: extent.width + 2.0 * margin,
            height: extent.height + 2.0 * margin,
        };
        let tin = Tin::saturated(grown, RADIUS * wavelength, seed)?;
        let vertices: Vec<DVec2> = tin.positions().iter().map(|&p| p - margin).collect();
        let (edges, faces) = sides(tin.triangles());
        let mut mesh = Self {
            key: MeshKey {
                extent,
                wavelength,
                seed,
            },
            probes: Vec::new(),
            first_around: Vec::new(),
            around: Vec::new(),
            vertices,
            edges,
            faces,
        };
        mesh.probes = (0..mesh.edges.len()).map(|edge| mesh.probes_of(edge)).collect();
        mesh.link_vertices();
        Ok(mesh)
    }

    /// The land.
    pub fn extent(&self) -> Extent {
        self.key.extent
    }

    /// The wavelength asked for, metres.
    pub fn wavelength(&self) -> f64 {
        self.key.wavelength
    }

    /// The seed of the sampling.
    pub fn seed(&self) -> u64 {
        self.key.seed
    }

    /// Positions of the vertices, plan metres.
    pub fn vertices(&self) -> &[DVec2] {
        &self.vertices
    }

    /// The edges.
    pub fn edges(&self) -> &[MeshEdge] {
        &self.edges
    }

    /// The three edges of each face.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Both ends of an edge, plan metres.
    pub fn ends(&self, edge: usize) -> [DVec2; 2] {
        self.edges[edge].ends.map(|vertex| self.vertices[vertex as usize])
    }

    /// Middle of an edge, plan metres.
    pub fn middle(&self, edge: usize) -> DVec2 {
        self.probes[edge][0].middle
    }

    /// Centre of a face: the mean of its corners, plan metres.
    pub fn centre(&self, face: usize) -> DVec2 {
        // The mean of the middles of the edges is that of the corners.
        self.faces[face]
            .iter()
            .map(|&edge| self.middle(edge as usize))
            .sum::<DVec2>()
            / 3.0
    }

    /// The edges at a vertex.
    pub(super) fn edges_at(&self, vertex: usize) -> &[u32] {
        &self.around[self.first_around[vertex] as usize..self.first_around[vertex + 1] as usize]
    }

    pub(super) fn key(&self) -> MeshKey {
        self.key
    }

    /// The drive at the middle of an edge, as `u_f·(cos 2φ, sin 2φ)`.
    pub(super) fn drive_on(&self, edge: usize, drive: &FoldDrive) -> [f64; 2] {
        drive.doubled(self.probes[edge][0].middle)
    }

    /// Compression energy of an edge, 0 across the compression to 1 along it, and those of its four dual edges. A dual
    /// edge where nothing is compressed takes the compression of the edge.
    pub(super) fn energies<'a>(
        &'a self,
        edge: usize,
        here: [f64; 2],
        drive: &'a FoldDrive,
    ) -> (f64, impl Iterator<Item = f64> + 'a) {
        let [own, duals @ ..] = &self.probes[edge];
        let duals = duals.iter().map(move |dual| {
            let there = drive.doubled(dual.middle);
            dual.energy(if there == [0.0; 2] { here } else { there })
        });
        (own.energy(here), duals)
    }

    /// The edge and its duals, which join the middles of the other edges of its two faces. Without a second face an edge
    /// is its own dual: never below itself, it becomes no fold.
    fn probes_of(&self, edge: usize) -> [Probe; 5] {
        let own = Probe::between(self.ends(edge));
        let MeshEdge { face, other, .. } = self.edges[edge];
        let Some(other) = other else {
            return [own; 5];
        };
        let middles = |face: u32| {
            let sides = self.faces[face as usize];
            let at = sides.iter().position(|&side| side as usize == edge).unwrap_or(0);
            [1, 2].map(|k| {
                let [a, b] = self.ends(sides[(at + k) % 3] as usize);
                (a + b) / 2.0
            })
        };
        let ([a, b], [c, d]) = (middles(face), middles(other));
        [
            own,
            Probe::between([a, c]),
            Probe::between([a, d]),
            Probe::between([b, c]),
            Probe::between([b, d]),
        ]
    }

    fn link_vertices(&mut self) {
        let mut first = vec![0_u32; self.vertices.len() + 1];
        for vertex in self.edges.iter().flat_map(|edge| edge.ends) {
            first[vertex as usize + 1] += 1;
        }
        for vertex in 0..self.vertices.len() {
            first[vertex + 1] += first[vertex];
        }
        let mut next = first.clone();
        self.around = vec![0; 2 * self.edges.len()];
        for (index, edge) in self.edges.iter().enumerate() {
            for vertex in edge.ends {
                let place = &mut next[vertex as usize];
                self.around[*place as usize] = index as u32;
                *place += 1;
            }
        }
        self.first_around = first;
    }
}

impl Probe {
    fn between([a, b]: [DVec2; 2]) -> Self {
        let along = (b - a).normalize_or(DVec2::X);
        Self {
            middle: (a + b) / 2.0,
            doubled: [along.x * along.x - along.y * along.y, 2.0 * along.x * along.y],
        }
    }

    /// `|cos|` of the angle between the direction and the compression, by the half-angle formula.
    fn energy(&self, [x, y]: [f64; 2]) -> f64 {
        let cos2 = (self.doubled[0] * x + self.doubled[1] * y) / (x * x + y * y).sqrt();
        (0.5 * (1.0 + cos2)).max(0.0).sqrt()
    }
}

/// Edges of triangles, each once, and the three edges of each triangle.
fn sides(triangles: &[[u32; 3]]) -> (Vec<MeshEdge>, Vec<[u32; 3]>) {
    let mut halves: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (face, &[a, b, c]) in triangles.iter().enumerate() {
        halves.extend([[a, b], [b, c], [c, a]].map(|[from, to]| ([from.min(to), from.max(to)], face as u32)));
    }
    halves.par_sort_unstable();
    let mut edges: Vec<MeshEdge> = Vec::with_capacity(halves.len() / 2 + 1);
    let mut faces = vec![[0; 3]; triangles.len()];
    let mut filled = vec![0_u8; triangles.len()];
    for (ends, face) in halves {
        match edges.last_mut() {
            Some(edge) if edge.ends == ends => edge.other = Some(face),
            _ => edges.push(MeshEdge {
                ends,
                face,
                other: None,
            }),
        }
        let place = &mut filled[face as usize];
        faces[face as usize][usize::from(*place)] = edges.len() as u32 - 1;
        *place += 1;
    }
    (edges, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAND: Extent = Extent {
        width: 70.0 * KM,
        height: 50.0 * KM,
    };

    #[test]
    fn edges_and_faces_know_each_other() {
        let mesh = FoldMesh::new(LAND, 4.0 * KM, 3).expect("a mesh");
        assert_eq!(
            mesh.vertices.len() + mesh.faces.len(),
            mesh.edges.len() + 1,
            "Euler's formula"
        );
        for (face, sides) in mesh.faces.iter().enumerate() {
            for &side in sides {
                let edge = mesh.edges[side as usize];
                assert!(edge.face == face as u32 || edge.other == Some(face as u32));
            }
        }
        for vertex in 0..mesh.vertices.len() {
            for &edge in mesh.edges_at(vertex) {
                assert!(mesh.edges[edge as usize].ends.contains(&(vertex as u32)));
            }
        }
        assert_eq!(mesh.around.len(), 2 * mesh.edges.len());
    }

    #[test]
    fn reaches_beyond_the_land_with_short_edges() {
        let wavelength = 4.0 * KM;
        let mesh = FoldMesh::new(LAND, wavelength, 3).expect("a mesh");
        let least = mesh
            .vertices
            .iter()
            .copied()
            .reduce(DVec2::min)
            .expect("vertices");
        let most = mesh
            .vertices
            .iter()
            .copied()
            .reduce(DVec2::max)
            .expect("vertices");
        assert!((least + MARGIN * wavelength).length() < 1e-6);
        assert!((most - MARGIN * wavelength - LAND.size()).length() < 1e-6);
        for edge in 0..mesh.edges.len() {
            let [a, b] = mesh.ends(edge);
            assert!(
                a.distance(b) < 2.05 * RADIUS * wavelength,
                "an edge of {}",
                a.distance(b)
            );
        }
    }

    #[test]
    fn energy_is_the_cosine_to_the_compression() {
        let edge = Probe::between([DVec2::new(3.0, 1.0), DVec2::new(-1.0, 4.0)]);
        for k in 0..24 {
            let azimuth = f64::from(k) * 15.0_f64.to_radians();
            let exact = DVec2::new(-0.8, 0.6).dot(DVec2::from_angle(azimuth)).abs();
            let energy = edge.energy([2e-4 * (2.0 * azimuth).cos(), 2e-4 * (2.0 * azimuth).sin()]);
            assert!((energy - exact).abs() < 1e-7);
        }
    }

    #[test]
    fn refuses_what_cannot_fold() {
        for wavelength in [0.0, -1.0, 100.0, 60.0 * KM, f64::NAN, f64::INFINITY] {
            let error = FoldMesh::new(LAND, wavelength, 1).expect_err("no such folds");
            assert!(matches!(error, FoldError::Wavelength { .. }));
        }
        let nowhere = Extent {
            width: f64::NAN,
            ..LAND
        };
        assert!(matches!(
            FoldMesh::new(nowhere, 5.0 * KM, 1),
            Err(FoldError::Mesh(_))
        ));
        let endless = Extent {
            width: 1e9,
            height: 1e9,
        };
        assert!(matches!(
            FoldMesh::new(endless, 5.0 * KM, 1),
            Err(FoldError::Mesh(TinError::TooManyNodes { .. }))
        ));
    }

    use crate::terrain::TinError;
}
