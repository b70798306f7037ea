//! The lattice on the sphere: its triangulation against another one, its look-up against a search, its areas.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::{DQuat, DVec3};
use orogen::sphere::{Lattice, LatticeError, SAMPLES_RANGE, arc};
use proptest::prelude::*;
use spade::{DelaunayTriangulation, Point2, Triangulation as _};

/// What a product of two lengths of one spacing may be off by, in units of its square: some thirty roundings.
const ROUNDING: f64 = 1e-14;

/// Numbers that look random, the same in every run: the fractional parts of multiples of the plastic number's powers.
fn directions(count: usize) -> impl Iterator<Item = DVec3> {
    (1..=count).map(|i| {
        let z = 1.0 - 2.0 * (i as f64 * 0.754_877_666_246_692_8).fract();
        let (sin, cos) = (2.0 * PI * (i as f64 * 0.569_840_290_998_053_3).fract()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    })
}

/// Poles, and points a rounding error, a hair and a few spacings off them.
fn polar(spacing: f64) -> impl Iterator<Item = DVec3> {
    let offs = [0.0, 1e-300, 1e-16, 1e-9, 0.01, 0.3, 0.7, 1.5, 4.0];
    offs.into_iter().flat_map(move |off| {
        (0..16).flat_map(move |turn| {
            let (sin, cos) = (PI / 8.0 * f64::from(turn)).sin_cos();
            let off = if off < 1e-6 { off } else { off * spacing };
            [-1.0, 1.0].map(|z| DVec3::new(off * cos, off * sin, z).normalize())
        })
    })
}

fn rotations() -> [DQuat; 4] {
    [
        DQuat::IDENTITY,
        DQuat::from_rotation_y(0.7),
        DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 2.1),
        DQuat::from_axis_angle(DVec3::new(-0.36, 0.48, 0.8), 5.9),
    ]
}

/// What makes triangles the Delaunay triangulation of points on the sphere.
fn check_delaunay(points: &[DVec3], triangles: &[[u32; 3]]) -> Result<(), String> {
    let n = points.len();
    if triangles.len() != 2 * n - 4 {
        return Err(format!("{} triangles of {n} samples", triangles.len()));
    }
    let at = |i: u32| points[i as usize];
    // By directed edge, the corner on its left.
    let mut left = BTreeMap::new();
    for &[a, b, c] in triangles {
        if at(a).dot(at(b).cross(at(c))) <= 0.0 {
            return Err(format!("triangle {a} {b} {c} is clockwise"));
        }
        for (edge, corner) in [((a, b), c), ((b, c), a), ((c, a), b)] {
            if left.insert(edge, corner).is_some() {
                return Err(format!("edge {edge:?} twice"));
            }
        }
    }
    if left.len() != 2 * (3 * n - 6) {
        return Err(format!("{} directed edges of {n} samples", left.len()));
    }
    let rounding = ROUNDING * 4.0 * PI / n as f64;
    for (&(a, b), &c) in &left {
        let Some(&d) = left.get(&(b, a)) else {
            return Err(format!("edge {a} {b} has one side"));
        };
        // The plane through a triangle cuts its circumcircle out of the sphere; the far side of it is inside.
        let above = (at(b) - at(a)).cross(at(c) - at(a)).dot(at(d) - at(a));
        if above > rounding {
            return Err(format!("{d} lies in the circle of {a} {b} {c} by {above:e}"));
        }
    }
    Ok(())
}

/// Neighbours of each sample, in ascending order.
fn sorted_stars(lattice: &Lattice) -> Vec<Vec<u32>> {
    let sorted = |i| {
        let mut star = lattice.neighbours(i).to_vec();
        star.sort_unstable();
        star
    };
    (0..lattice.len() as u32).map(sorted).collect()
}

/// The same by a planar triangulation with exact predicates: seen stereographically from the first sample, which so lies
/// at infinity, the others are triangulated, and the first is joined to their hull.
fn planar_stars(points: &[DVec3]) -> Vec<Vec<u32>> {
    let to_pole = DQuat::from_rotation_arc(points[0], DVec3::Z);
    let seen = points[1..].iter().map(|&p| {
        let p = to_pole * p;
        Point2::new(p.x / (1.0 - p.z), p.y / (1.0 - p.z))
    });
    let flat = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(seen.collect()).expect("finite places");
    let mut stars = vec![Vec::new(); points.len()];
    for edge in flat.undirected_edges() {
        let [a, b] = edge.vertices().map(|v| v.index() + 1);
        stars[a].push(b as u32);
        stars[b].push(a as u32);
    }
    for edge in flat.convex_hull() {
        let on_hull = edge.from().index() + 1;
        stars[0].push(on_hull as u32);
        stars[on_hull].push(0);
    }
    for star in &mut stars {
        star.sort_unstable();
    }
    stars
}

/// Samples by height, to be searched.
struct Search(Vec<DVec3>, f64);

impl Search {
    fn new(lattice: &Lattice) -> Self {
        let mut points = lattice.points().to_vec();
        points.sort_by(|a, b| a.z.total_cmp(&b.z));
        Self(points, lattice.spacing())
    }

    /// Cosine of the distance from `p` to the sample nearest to it: no place is farther from all than one spacing.
    fn nearest(&self, p: DVec3) -> f64 {
        let from = self.0.partition_point(|q| q.z < p.z - self.1);
        let to = self.0.partition_point(|q| q.z <= p.z + self.1);
        let best = self.0[from..to].iter().map(|q| q.dot(p)).fold(-1.0, f64::max);
        assert!(best > self.1.cos(), "a hole at {p}");
        best
    }
}

fn check_areas(lattice: &Lattice) {
    let areas = lattice.areas();
    let sum: f64 = areas.iter().sum();
    assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-11, "{sum}");
    let least = areas.iter().copied().fold(f64::INFINITY, f64::min);
    let most = areas.iter().copied().fold(0.0, f64::max);
    assert!(least > 0.0 && most / least <= 1.13, "{least:e} to {most:e}");
}

#[test]
fn it_is_the_delaunay_triangulation() {
    for samples in [1_000, 10_007, 60_000] {
        let lattice = Lattice::new(samples).unwrap();
        check_delaunay(lattice.points(), lattice.triangles()).unwrap();
    }
}

#[test]
fn an_edge_turned_the_other_way_is_found() {
    let lattice = Lattice::new(1_000).unwrap();
    let mut triangles = lattice.triangles().to_vec();
    let [a, b, c] = triangles[0];
    let other = triangles.iter().position(|t| {
        let [x, y, z] = *t;
        [[x, y], [y, z], [z, x]].contains(&[b, a])
    });
    let other = other.unwrap();
    let d = triangles[other]
        .into_iter()
        .find(|i| ![a, b].contains(i))
        .unwrap();
    triangles[0] = [a, d, c];
    triangles[other] = [d, b, c];
    let error = check_delaunay(lattice.points(), &triangles).unwrap_err();
    assert!(error.contains("circle"), "{error}");
    triangles[0] = [a, c, d];
    assert!(check_delaunay(lattice.points(), &triangles).is_err());
    triangles.pop();
    assert!(check_delaunay(lattice.points(), &triangles).is_err());
}

#[test]
fn stars_run_counter_clockwise_around_triangles() {
    let lattice = Lattice::new(10_007).unwrap();
    let mut corners = 0;
    for i in 0..lattice.len() as u32 {
        let star = lattice.neighbours(i);
        corners += star.len();
        let p = lattice.point(i);
        let mut turned = 0.0;
        for (k, &a) in star.iter().enumerate() {
            let (a, b) = (lattice.point(a), lattice.point(star[(k + 1) % star.len()]));
            let (a, b) = (a - p * a.dot(p), b - p * b.dot(p));
            let angle = p.dot(a.cross(b)).atan2(a.dot(b));
            assert!(angle > 0.0, "sample {i}");
            turned += angle;
        }
        assert!((turned - 2.0 * PI).abs() < 1e-9, "sample {i} turns {turned}");
    }
    assert_eq!(corners, 3 * lattice.triangles().len());
}

#[test]
fn another_construction_gives_the_same_edges() {
    for samples in [1_000, 1_001, 4_999, 10_007, 60_000] {
        let lattice = Lattice::new(samples).unwrap();
        let reference = planar_stars(lattice.points());
        for (i, (star, expected)) in sorted_stars(&lattice).iter().zip(&reference).enumerate() {
            assert_eq!(star, expected, "sample {i} of {samples}");
        }
    }
}

#[test]
fn every_sample_is_nearest_to_itself() {
    let lattice = Lattice::new(30_011).unwrap();
    for i in 0..lattice.len() as u32 {
        assert_eq!(lattice.nearest(lattice.point(i)), i);
    }
}

#[test]
fn the_nearest_sample_is_the_one_a_search_finds() {
    for samples in [1_000, 10_007, 60_000] {
        let lattice = Lattice::new(samples).unwrap();
        let search = Search::new(&lattice);
        let queries = directions(100_000).chain(polar(lattice.spacing()));
        for p in queries {
            let nearest = lattice.nearest(p);
            let found = lattice.point(nearest).dot(p);
            let somewhere = lattice.neighbours(lattice.neighbours(nearest)[0])[2];
            for near in [somewhere, 0] {
                let walked = lattice.point(lattice.nearest_from(p, near)).dot(p);
                assert_eq!(walked, found, "{p} from {near}");
            }
            // Two samples as near as each other to rounding are both right.
            assert!(found >= search.nearest(p) - 1e-15, "{p} of {samples}");
        }
    }
}

#[test]
fn places_come_back_from_their_triangle_in_any_rotation() {
    for samples in [1_000, 20_011] {
        let lattice = Lattice::new(samples).unwrap();
        for rotation in rotations() {
            let rotated = lattice.points().iter().map(|&p| rotation * p);
            for p in rotated.chain(directions(5_000)).chain(polar(lattice.spacing())) {
                let (corners, weights) = lattice.locate(p);
                assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)));
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                assert!(
                    lattice.neighbours(corners[0]).contains(&corners[1])
                        && lattice.neighbours(corners[0]).contains(&corners[2])
                );
                let place: DVec3 = (0..3).map(|k| weights[k] * lattice.point(corners[k])).sum();
                assert!(arc(place.normalize(), p) < 1e-9, "{p} of {samples}");
            }
        }
    }
}

#[test]
fn areas_are_even_and_cover_the_sphere() {
    for samples in [1_000, 10_007, 100_000] {
        check_areas(&Lattice::new(samples).unwrap());
    }
}

#[test]
fn any_number_of_threads_makes_the_same_lattice() {
    let make = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| Lattice::new(50_021).unwrap())
    };
    let one = make(1);
    for threads in [2, 7] {
        let other = make(threads);
        assert_eq!(one.points(), other.points());
        assert_eq!(one.triangles(), other.triangles());
        assert_eq!(one.areas(), other.areas());
        for i in 0..one.len() as u32 {
            assert_eq!(one.neighbours(i), other.neighbours(i));
        }
    }
}

#[test]
fn sizes_outside_the_range_are_refused() {
    for found in [0, 1, SAMPLES_RANGE.0 - 1, SAMPLES_RANGE.1 + 1, usize::MAX] {
        assert_eq!(Lattice::new(found).unwrap_err(), LatticeError::Size { found });
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_size_makes_a_lattice(samples in 1_000_usize..30_000, x in -1.0..1.0, y in -1.0..1.0, z in -1.0..1.0) {
        let lattice = Lattice::new(samples).unwrap();
        prop_assert_eq!(check_delaunay(lattice.points(), lattice.triangles()), Ok(()));
        check_areas(&lattice);
        let p = DVec3::new(x, y, z).try_normalize().unwrap_or(DVec3::X);
        let found = lattice.point(lattice.nearest(p)).dot(p);
        prop_assert!(found >= Search::new(&lattice).nearest(p) - 1e-15);
    }
}
