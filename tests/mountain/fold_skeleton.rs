//! Skeletons of folds against the figures of the literature and of independent sketches.

use crate::fold_common;
use crate::fold_common::RATE;
use glam::DVec2;
use orogen::mountain::Grid;
use orogen::mountain::fold::lines::{bottom_lines, top_lines, trough_node, troughs};
use orogen::mountain::fold::{Drive, FoldDrive, FoldMesh, FoldStats, Skeleton};
use orogen::units::{Extent, KM};
use proptest::prelude::*;

const LAND: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};

fn blocks() -> Grid {
    fold_common::blocks(LAND)
}

fn mesh(wavelength_km: f64, seed: u64) -> FoldMesh {
    fold_common::mesh(LAND, wavelength_km, seed)
}

fn skeleton(mesh: &FoldMesh, azimuth: f64) -> (Skeleton, FoldDrive) {
    let drive = FoldDrive::uniform(blocks(), RATE, azimuth);
    (Skeleton::select(mesh, &drive, None, &[]), drive)
}

fn length([a, b]: [DVec2; 2]) -> f64 {
    a.distance(b)
}

fn mean_edge(mesh: &FoldMesh) -> f64 {
    let edges = mesh.edges().len();
    (0..edges).map(|edge| length(mesh.ends(edge))).sum::<f64>() / edges as f64
}

/// Mean and deviation of a figure over meshes whose whole box, margins included, is 20 wavelengths wide.
fn over_seeds(figure: impl Fn(&FoldMesh, &Skeleton, &FoldDrive) -> f64) -> (f64, f64) {
    let values: Vec<f64> = (0..24)
        .map(|seed| {
            let mesh = mesh(6.25, seed);
            let (skeleton, drive) = skeleton(&mesh, 0.13 * seed as f64);
            figure(&mesh, &skeleton, &drive)
        })
        .collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
    (mean, square.sqrt())
}

#[test]
fn ends_and_joints_are_as_many_as_in_the_literature() {
    let of = |figure: fn(&FoldStats) -> f64| over_seeds(|m, s, d| figure(&FoldStats::of(m, s, d)));
    let (ends, joints) = (of(|s| s.end_fraction), of(|s| s.triple_fraction));
    // The paper counts 21.2 % and 7.5 %, an independent sketch 22.2 % and 8.7 %.
    assert!((ends.0 - 0.222).abs() < 0.014, "ends {ends:?}");
    assert!((joints.0 - 0.087).abs() < 0.010, "joints {joints:?}");
}

#[test]
fn the_realised_wavelength_is_the_one_asked_for() {
    let (ratio, deviation) = over_seeds(|m, s, d| {
        let stats = FoldStats::of(m, s, d);
        stats.realised_wavelength / stats.wavelength
    });
    assert!(
        (ratio - 1.0).abs() < 0.03 && deviation < 0.03,
        "{ratio} {deviation}"
    );
}

#[test]
fn crests_are_a_third_of_the_edges_and_lie_across_the_compression() {
    // Wide enough that borders do not count.
    let mesh = mesh(1.5, 5);
    let edges = mesh.edges().len() as f64;
    let azimuth = 0.4;
    let (skeleton, drive) = skeleton(&mesh, azimuth);
    let share = skeleton.top_len() as f64 / edges;
    assert!((share - 0.31).abs() < 0.015, "{share} of the edges");
    let both = share + troughs(&mesh, &skeleton).len() as f64 / edges;
    assert!(
        (both - 1.13).abs() < 0.06,
        "crests and troughs {both} of the edges"
    );

    let compression = DVec2::from_angle(azimuth);
    let off_strike = |edge: usize| {
        let [a, b] = mesh.ends(edge);
        (b - a).normalize().dot(compression).abs().asin().to_degrees()
    };
    let mut angles: Vec<f64> = skeleton.top().map(off_strike).collect();
    angles.sort_by(f64::total_cmp);
    let mean = angles.iter().sum::<f64>() / angles.len() as f64;
    let ninth = angles[angles.len() * 9 / 10];
    assert!(
        (mean - 15.0).abs() < 0.7 && (ninth - 28.5).abs() < 0.7,
        "{mean}° {ninth}°"
    );

    let stats = FoldStats::of(&mesh, &skeleton, &drive);
    assert_eq!(
        (stats.top_edges, stats.bottom_edges),
        (skeleton.top_len(), troughs(&mesh, &skeleton).len())
    );
    let chain = stats.mean_chain_length / mean_edge(&mesh);
    assert!((3.6..4.6).contains(&chain), "crests of {chain} edges");
}

#[test]
fn faces_keep_at_most_two_crests_and_few_were_about_to_have_three() {
    let mesh = mesh(1.5, 8);
    let (skeleton, _) = skeleton(&mesh, 1.1);
    let crests = |sides: &[u32; 3]| {
        sides
            .iter()
            .filter(|&&side| skeleton.is_top(side as usize))
            .count()
    };
    assert!(mesh.faces().iter().all(|sides| crests(sides) < 3));
    for edge in skeleton.top() {
        assert!(mesh.edges()[edge].other.is_some() && skeleton.is_live(edge));
    }
}

#[test]
fn the_mesh_is_as_dense_as_saturated_sampling_makes_it() {
    for (wavelength, seed) in [(1.0, 1), (1.5, 2), (2.5, 3)] {
        let mesh = mesh(wavelength, seed);
        let nodes = mesh.vertices().iter().filter(|&&p| LAND.contains(p)).count() as f64;
        let inside = (0..mesh.edges().len()).filter(|&edge| LAND.contains(mesh.middle(edge)));
        let lengths: Vec<f64> = inside.map(|edge| length(mesh.ends(edge))).collect();
        let edge = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let law = nodes * edge * edge / LAND.area();
        assert!((law - 1.225).abs() < 0.015, "{law}");
        assert!(
            (edge / mesh.wavelength() - 1.17).abs() < 0.015,
            "{}",
            edge / mesh.wavelength()
        );
    }
}

/// True if the insides of two segments meet.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

#[test]
fn crests_and_troughs_never_meet() {
    let mesh = mesh(7.0, 4);
    // Compression that turns across the land.
    let drive = FoldDrive::from_fn(blocks(), |p| Drive {
        rate: RATE,
        direction: DVec2::from_angle(p.x / (30.0 * KM)),
        limit: f64::INFINITY,
    });
    let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
    let troughs: Vec<[DVec2; 2]> = troughs(&mesh, &skeleton)
        .iter()
        .map(|trough| trough.nodes.map(|node| trough_node(&mesh, node)))
        .collect();
    assert!(skeleton.top_len() > 100);
    for edge in skeleton.top() {
        let crest = mesh.ends(edge);
        assert!(!troughs.iter().any(|&trough| cross(crest, trough)));
    }
    // The check sees what crosses.
    let lying = mesh.ends(0);
    let turned = [DVec2::Y, -DVec2::Y].map(|by| mesh.middle(0) + by.rotate(lying[1] - lying[0]));
    assert!(cross(lying, turned));
}

#[test]
fn lines_hold_every_crest_on_the_land_once() {
    let mesh = mesh(5.0, 6);
    let (skeleton, _) = skeleton(&mesh, 0.3);
    let total = |lines: &[Vec<DVec2>]| -> f64 {
        let steps = lines.iter().flat_map(|line| line.windows(2));
        steps.map(|step| step[0].distance(step[1])).sum()
    };
    let crests = top_lines(&mesh, &skeleton);
    // The length on the land by another way: in many short steps.
    let on_land = |[a, b]: [DVec2; 2]| {
        let inside = (0..1000).filter(|&k| LAND.contains(a.lerp(b, (f64::from(k) + 0.5) / 1000.0)));
        inside.count() as f64 / 1000.0 * a.distance(b)
    };
    let expected: f64 = skeleton.top().map(|edge| on_land(mesh.ends(edge))).sum();
    assert!((total(&crests) / expected - 1.0).abs() < 1e-3);
    let troughs = bottom_lines(&mesh, &skeleton);
    assert!(total(&troughs) > total(&crests));
    for line in crests.iter().chain(&troughs) {
        assert!(line.len() > 1 && line.iter().all(|&p| LAND.contains(p.round())));
    }
}

#[test]
fn nothing_folds_where_nothing_is_compressed() {
    let mesh = mesh(4.0, 2);
    let still = Skeleton::select(&mesh, &FoldDrive::still(blocks()), None, &[]);
    assert_eq!(still, Skeleton::none(&mesh));
    let east = FoldDrive::from_fn(blocks(), |p| Drive {
        rate: if p.x > 50.0 * KM { RATE } else { 0.0 },
        direction: DVec2::X,
        limit: 1.0,
    });
    let half = Skeleton::select(&mesh, &east, None, &[]);
    assert!(half.top_len() > 100);
    assert!(half.top().all(|edge| mesh.middle(edge).x > 49.0 * KM));
    let unknown = FoldDrive::uniform(blocks(), f64::NAN, 0.0);
    assert!(Skeleton::select(&mesh, &unknown, None, &[]).is_empty());
}

/// Part of the crests of one skeleton that are crests of another.
fn kept(before: &Skeleton, after: &Skeleton) -> f64 {
    before.top().filter(|&edge| after.is_top(edge)).count() as f64 / before.top_len() as f64
}

#[test]
fn crests_stay_put_while_a_drag_goes_on() {
    let mesh = mesh(3.0, 9);
    let (first, _) = skeleton(&mesh, 0.5);
    let louder = FoldDrive::uniform(blocks(), 2.0 * RATE, 0.5);
    let again = Skeleton::select(&mesh, &louder, Some(&first), &[]);
    assert!(kept(&first, &again) > 0.995 && kept(&again, &first) > 0.995);
    let third = Skeleton::select(&mesh, &louder, Some(&again), &[]);
    assert_eq!(again, third, "and then nothing changes any more");

    let (turned, drive) = skeleton(&mesh, 0.5 + 2.0_f64.to_radians());
    let held = Skeleton::select(&mesh, &drive, Some(&first), &[]);
    assert!(kept(&first, &held) >= 0.95, "{}", kept(&first, &held));
    assert!(kept(&first, &turned) < kept(&first, &held));

    // What is held does not stay for ever.
    let across = FoldDrive::uniform(blocks(), RATE, 0.5 + std::f64::consts::FRAC_PI_2);
    assert!(kept(&first, &Skeleton::select(&mesh, &across, Some(&first), &[])) < 0.02);
    // Ground that was not compressed before follows the exact rule, and so does another mesh.
    let none = Skeleton::none(&mesh);
    assert_eq!(Skeleton::select(&mesh, &drive, Some(&none), &[]), turned);
    let other = FoldMesh::new(LAND, 3.0 * KM, 10).expect("a mesh");
    assert_eq!(
        Skeleton::select(&other, &drive, Some(&first), &[]),
        Skeleton::select(&other, &drive, None, &[])
    );
}

#[test]
fn any_number_of_threads_chooses_the_same_crests() {
    let runs = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let mesh = mesh(1.5, 3);
            let (skeleton, _) = skeleton(&mesh, 0.7);
            (mesh, skeleton)
        })
    });
    assert!(runs[0] == runs[1] && runs[0] == runs[2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_drive_makes_sound_skeletons(
        wavelength in 3.0..20.0_f64,
        seed in any::<u64>(),
        waves in proptest::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, 0.0..6.3_f64), 1..4),
    ) {
        let mesh = mesh(wavelength, seed);
        let drive = FoldDrive::from_fn(blocks(), |p| {
            let sum: f64 = waves.iter().map(|w| (w.0 * p.x / 9e3 + w.1 * p.y / 9e3 + w.2).sin()).sum();
            Drive { rate: RATE * sum.max(0.0), direction: DVec2::from_angle(2.0 * sum), limit: 1e-7 }
        });
        let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
        for edge in skeleton.top() {
            prop_assert!(skeleton.is_live(edge) && drive.at(mesh.middle(edge)).rate > 0.0);
        }
        for sides in mesh.faces() {
            prop_assert!(!sides.iter().all(|&side| skeleton.is_top(side as usize)));
        }
        let stats = FoldStats::of(&mesh, &skeleton, &drive);
        prop_assert!(stats.end_fraction + stats.triple_fraction <= 1.0);
        prop_assert!(stats.realised_wavelength.is_finite());
        for line in top_lines(&mesh, &skeleton).iter().chain(&bottom_lines(&mesh, &skeleton)) {
            prop_assert!(line.iter().all(|p| p.is_finite()));
        }
    }
}
