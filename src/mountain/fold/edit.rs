//! Crests drawn and raised by hand (section 5.2, local refinement).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::FoldError;
use super::edge_set::EdgeSet;
use super::mesh::FoldMesh;
use crate::mountain::smoother;

/// Most points of a path; longer ones are thinned.
pub const MAX_POINTS: usize = 256;

/// Most edits that count; of more, the newest.
pub const MAX_EDITS: usize = 64;

/// Largest factor by which folds can be raised, also where edits overlap.
pub const MAX_RAISE: f64 = 3.0;

/// Points of a path nearer to each other than this are one, in wavelengths: a mesh sees no finer.
const GRAIN: f64 = 0.2;

/// How far from its path a crest may be led, in wavelengths: no place is farther than 0.88 from a vertex.
const CORRIDOR: f64 = 1.5;

/// Half width of what an edit changes, in wavelengths: from a crest to its troughs.
const REACH: f64 = 0.5;

/// What an edit does to the folds along its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FoldEditKind {
    /// A crest runs along the path; crests that cross it there leave.
    Turn,
    /// Folds are this many times as high along the path, 0–[`MAX_RAISE`], and as before half a wavelength beside it.
    Raise(f64),
}

/// A local refinement of folds: a finger drawn along the land.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldEdit {
    kind: FoldEditKind,
    path: Vec<DVec2>,
}

impl FoldEdit {
    /// An edit along `path` (plan metres). Paths of more than [`MAX_POINTS`] points are thinned evenly; factors beyond
    /// their range are cut to it.
    ///
    /// # Errors
    /// [`FoldError`] for numbers that are not finite, and for less than two points to turn folds along or one to raise
    /// them at.
    pub fn new(kind: FoldEditKind, path: &[DVec2]) -> Result<Self, FoldError> {
        let (expected, kind) = match kind {
            FoldEditKind::Turn => (2, kind),
            FoldEditKind::Raise(factor) if factor.is_finite() => {
                (1, FoldEditKind::Raise(factor.clamp(0.0, MAX_RAISE)))
            }
            FoldEditKind::Raise(_) => return Err(FoldError::NotFinite),
        };
        if path.len() < expected {
            return Err(FoldError::ShortPath {
                found: path.len(),
                expected,
            });
        }
        if !path.iter().all(|p| p.is_finite()) {
            return Err(FoldError::NotFinite);
        }
        let kept = path.len().min(MAX_POINTS);
        let path = (0..kept)
            .map(|k| path[k * (path.len() - 1) / (kept - 1).max(1)])
            .collect();
        Ok(Self { kind, path })
    }

    /// What it does.
    pub fn kind(&self) -> FoldEditKind {
        self.kind
    }

    /// Where, plan metres.
    pub fn path(&self) -> &[DVec2] {
        &self.path
    }
}

/// The edits that count.
fn newest(edits: &[FoldEdit]) -> &[FoldEdit] {
    &edits[edits.len().saturating_sub(MAX_EDITS)..]
}

/// `grown` with the crests that `edits` draw, in order. Edges that are not `live` do not become crests.
pub(super) fn turned(mesh: &FoldMesh, grown: &EdgeSet, live: &EdgeSet, edits: &[FoldEdit]) -> EdgeSet {
    let mut top = grown.clone();
    for edit in newest(edits) {
        if edit.kind == FoldEditKind::Turn {
            let path = Path::of(&edit.path, mesh.wavelength());
            let mut crest = route(mesh, &path);
            crest.retain(|&edge| live.contains(edge) && mesh.edges()[edge].other.is_some());
            let cleared = top.with(crossing(mesh, &top, &path).into_iter().map(|edge| (edge, false)));
            let drawn = cleared.with(crest.iter().map(|&edge| (edge, true)));
            let closing = crest
                .iter()
                .flat_map(|&edge| [Some(mesh.edges()[edge].face), mesh.edges()[edge].other])
                .flatten()
                .map(|face| mesh.faces()[face as usize].map(|side| side as usize))
                .filter(|sides| sides.iter().all(|&side| drawn.contains(side)))
                .flat_map(|sides| sides.into_iter().filter(|side| !crest.contains(side)))
                .map(|edge| (edge, false));
            top = drawn.with(closing);
        }
    }
    top
}

/// Crests that lie within reach of a path and more across it than along.
fn crossing(mesh: &FoldMesh, top: &EdgeSet, path: &Path) -> Vec<usize> {
    let reach = REACH * mesh.wavelength();
    top.iter()
        .filter(|&edge| {
            let middle = mesh.middle(edge);
            if !path.may_reach(middle, reach) {
                return false;
            }
            let (distance, along) = path.nearest(middle);
            let [a, b] = mesh.ends(edge);
            let across = (b - a).perp_dot(along).abs();
            distance <= reach && across > (b - a).dot(along).abs()
        })
        .collect()
}

/// Edges of the mesh that lead along a path: the way from the vertex nearest to its beginning to the one nearest to its
/// end that is short and near to the path.
fn route(mesh: &FoldMesh, path: &Path) -> Vec<usize> {
    let (first, last) = path.ends();
    let vertex_near = |p: DVec2| {
        let places = mesh.vertices().iter().enumerate();
        let nearest = places.min_by(|a, b| a.1.distance_squared(p).total_cmp(&b.1.distance_squared(p)));
        nearest.map_or(0, |(vertex, _)| vertex)
    };
    let (from, to) = (vertex_near(first), vertex_near(last));
    if from == to {
        // A stroke shorter than an edge still points somewhere.
        let along = |edge: &u32| {
            let [a, b] = mesh.ends(*edge as usize);
            (b - a).normalize_or_zero().dot(last - first).abs()
        };
        let edges = mesh.edges_at(from).iter();
        let best = edges.max_by(|a, b| along(a).total_cmp(&along(b)));
        return best.map(|&edge| edge as usize).into_iter().collect();
    }
    let corridor = CORRIDOR * mesh.wavelength();
    let mut reached: Vec<Option<(f64, u32)>> = vec![None; mesh.vertices().len()];
    let mut done = vec![false; mesh.vertices().len()];
    reached[from] = Some((0.0, u32::MAX));
    // Costs are not negative, so their bits sort as they do; of equals the smaller vertex goes first.
    let mut next = BinaryHeap::from([Reverse((0_u64, from as u32))]);
    while let Some(Reverse((cost, vertex))) = next.pop() {
        let vertex = vertex as usize;
        if std::mem::replace(&mut done[vertex], true) {
            continue;
        }
        if vertex == to {
            break;
        }
        for &edge in mesh.edges_at(vertex) {
            let middle = mesh.middle(edge as usize);
            let [a, b] = mesh.edges()[edge as usize].ends.map(|end| end as usize);
            let beyond = if a == vertex { b } else { a };
            if done[beyond] || !path.may_reach(middle, corridor) {
                continue;
            }
            let (distance, _) = path.nearest(middle);
            if distance > corridor {
                continue;
            }
            let length = mesh.vertices()[a].distance(mesh.vertices()[b]);
            let detour = 1.0 + (distance / (REACH * mesh.wavelength())).powi(2);
            let there = f64::from_bits(cost) + length * detour;
            if reached[beyond].is_none_or(|(best, _)| there < best) {
                reached[beyond] = Some((there, edge));
                next.push(Reverse((there.to_bits(), beyond as u32)));
            }
        }
    }
    let mut crest = Vec::new();
    let mut vertex = to;
    while vertex != from {
        let Some((_, edge)) = reached[vertex] else {
            return Vec::new();
        };
        crest.push(edge as usize);
        let [a, b] = mesh.edges()[edge as usize].ends.map(|end| end as usize);
        vertex = if a == vertex { b } else { a };
    }
    crest
}

/// A drawn path without needless points.
#[derive(Clone, Debug)]
struct Path {
    points: Vec<DVec2>,
    least: DVec2,
    most: DVec2,
}

impl Path {
    fn of(points: &[DVec2], wavelength: f64) -> Self {
        let mut kept: Vec<DVec2> = Vec::with_capacity(points.len());
        for (k, &p) in points.iter().enumerate() {
            let near = |last: &DVec2| last.distance(p) < GRAIN * wavelength;
            if kept.last().is_some_and(near) {
                // The end stays where the finger left.
                if k + 1 < points.len() || kept.len() == 1 {
                    continue;
                }
                kept.pop();
            }
            kept.push(p);
        }
        if let ([only], Some(&last)) = (&kept[..], points.last())
            && *only != last
        {
            kept.push(last);
        }
        Self {
            least: kept.iter().copied().fold(DVec2::INFINITY, DVec2::min),
            most: kept.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max),
            points: kept,
        }
    }

    fn ends(&self) -> (DVec2, DVec2) {
        let first = self.points.first().copied().unwrap_or_default();
        (first, self.points.last().copied().unwrap_or(first))
    }

    /// False if `p` is certainly farther than `reach`.
    fn may_reach(&self, p: DVec2, reach: f64) -> bool {
        (p - p.clamp(self.least, self.most)).length_squared() <= reach * reach
    }

    /// Distance to `p` and the path's direction where it is nearest.
    fn nearest(&self, p: DVec2) -> (f64, DVec2) {
        let (first, _) = self.ends();
        let mut best = (first.distance_squared(p), DVec2::ZERO);
        for ends in self.points.windows(2) {
            let along = ends[1] - ends[0];
            let t = ((p - ends[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let squared = (ends[0] + along * t).distance_squared(p);
            if squared < best.0 || best.1 == DVec2::ZERO {
                best = (squared, along);
            }
        }
        (best.0.sqrt(), best.1.normalize_or_zero())
    }
}

/// Where folds are higher or lower than they grow.
#[derive(Clone, Debug)]
pub(super) struct Raises {
    paths: Vec<(Path, f64)>,
    reach: f64,
}

impl Raises {
    pub(super) fn of(edits: &[FoldEdit], wavelength: f64) -> Self {
        let raised = newest(edits).iter().filter_map(|edit| match edit.kind {
            FoldEditKind::Turn => None,
            FoldEditKind::Raise(factor) => Some((Path::of(&edit.path, wavelength), factor)),
        });
        Self {
            paths: raised.collect(),
            reach: REACH * wavelength,
        }
    }

    /// The factor at `p`, 0–[`MAX_RAISE`].
    pub(super) fn at(&self, p: DVec2) -> f64 {
        let near = self
            .paths
            .iter()
            .filter(|(path, _)| path.may_reach(p, self.reach));
        let factor: f64 = near
            .map(|(path, factor)| {
                let (distance, _) = path.nearest(p);
                1.0 + (factor - 1.0) * (1.0 - smoother(distance / self.reach))
            })
            .product();
        factor.min(MAX_RAISE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_and_tidies_paths() {
        let here = DVec2::new(1_000.0, 2_000.0);
        assert_eq!(
            FoldEdit::new(FoldEditKind::Turn, &[here]),
            Err(FoldError::ShortPath {
                found: 1,
                expected: 2
            })
        );
        assert!(FoldEdit::new(FoldEditKind::Raise(2.0), &[]).is_err());
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(
                FoldEdit::new(FoldEditKind::Turn, &[here, DVec2::new(bad, 0.0)]),
                Err(FoldError::NotFinite)
            );
            assert_eq!(
                FoldEdit::new(FoldEditKind::Raise(bad), &[here]),
                Err(FoldError::NotFinite)
            );
        }
        let long: Vec<DVec2> = (0..5_000).map(|k| DVec2::splat(f64::from(k))).collect();
        let thinned = FoldEdit::new(FoldEditKind::Raise(9.0), &long).expect("an edit");
        assert_eq!(thinned.kind(), FoldEditKind::Raise(MAX_RAISE));
        assert_eq!(thinned.path().len(), MAX_POINTS);
        assert_eq!(
            (thinned.path()[0], thinned.path()[MAX_POINTS - 1]),
            (long[0], long[4_999])
        );
    }

    #[test]
    fn a_path_keeps_its_ends_and_drops_its_grains() {
        let points: Vec<DVec2> = (0..=100).map(|k| DVec2::new(f64::from(k) * 10.0, 0.0)).collect();
        let path = Path::of(&points, 1_000.0);
        assert_eq!(path.ends(), (points[0], points[100]));
        assert!(path.points.len() <= 6);
        let (distance, along) = path.nearest(DVec2::new(430.0, -70.0));
        assert!((distance - 70.0).abs() < 1e-9 && along == DVec2::X);
        let short = Path::of(&points[..3], 1_000.0);
        assert_eq!(short.points, [points[0], points[2]]);
        assert_eq!(Path::of(&[points[1]], 1_000.0).points, [points[1]]);
    }

    #[test]
    fn raising_is_smooth_compact_and_bounded() {
        let path = [DVec2::ZERO, DVec2::new(10_000.0, 0.0)];
        let edit = |factor| FoldEdit::new(FoldEditKind::Raise(factor), &path).expect("an edit");
        let raises = Raises::of(&[edit(2.0)], 6_000.0);
        assert!((raises.at(DVec2::new(4_000.0, 0.0)) - 2.0).abs() < 1e-12);
        assert_eq!(raises.at(DVec2::new(4_000.0, 3_000.0)), 1.0);
        assert!((raises.at(DVec2::new(4_000.0, 2_999.0)) - 1.0).abs() < 1e-6);
        let twice = Raises::of(&[edit(3.0), edit(3.0)], 6_000.0);
        assert_eq!(twice.at(DVec2::ZERO), MAX_RAISE);
        let flat = Raises::of(&[edit(0.0)], 6_000.0);
        assert_eq!(flat.at(DVec2::ZERO), 0.0);
    }
}
