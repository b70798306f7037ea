//! Heights of folds against brute force, and edits of folds.

use crate::fold_common;
use std::f64::consts::PI;

use crate::fold_common::RATE;
use glam::DVec2;
use orogen::mountain::fold::lines::{top_lines, trough_node, troughs};
use orogen::mountain::fold::shape::SHAPE_TOLERANCE;
use orogen::mountain::fold::{
    CpuFolds, Drive, FoldDrive, FoldEdit, FoldEditKind, FoldMesh, FoldRates, FoldShape, FoldStats,
    PointRates, Skeleton,
};
use orogen::mountain::{Field, Grid};
use orogen::units::{Extent, KM};
use proptest::prelude::*;

const LAND: Extent = Extent {
    width: 100.0 * KM,
    height: 60.0 * KM,
};

fn blocks() -> Grid {
    fold_common::blocks(LAND)
}

fn mesh(wavelength_km: f64, seed: u64) -> FoldMesh {
    fold_common::mesh(LAND, wavelength_km, seed)
}

/// Compression that turns slowly across the land.
fn turning() -> FoldDrive {
    FoldDrive::from_fn(blocks(), |p| Drive {
        rate: RATE,
        direction: DVec2::from_angle(p.x / (60.0 * KM)),
        limit: f64::INFINITY,
    })
}

/// The same in the middle third of the land only.
fn belt() -> FoldDrive {
    FoldDrive::from_fn(blocks(), |p| Drive {
        rate: if (p.x / LAND.width - 0.5).abs() < 1.0 / 6.0 {
            RATE
        } else {
            0.0
        },
        direction: DVec2::from_angle(p.x / (60.0 * KM)),
        limit: f64::INFINITY,
    })
}

/// Distances and heights the long way: every segment for every place.
struct Brute {
    wavelength: f64,
    crests: Vec<[DVec2; 2]>,
    troughs: Vec<[DVec2; 2]>,
}

impl Brute {
    fn new(mesh: &FoldMesh, skeleton: &Skeleton) -> Self {
        let lines = troughs(mesh, skeleton);
        Self {
            wavelength: mesh.wavelength(),
            crests: skeleton.top().map(|edge| mesh.ends(edge)).collect(),
            troughs: lines
                .iter()
                .map(|line| line.nodes.map(|node| trough_node(mesh, node)))
                .collect(),
        }
    }

    fn distances(&self, p: DVec2) -> (f64, f64) {
        let nearest = |segments: &[[DVec2; 2]]| {
            let distance = |&[a, b]: &[DVec2; 2]| {
                let t = (p - a).dot(b - a) / (b - a).length_squared();
                p.distance(a.lerp(b, t.clamp(0.0, 1.0)))
            };
            segments.iter().map(distance).fold(f64::INFINITY, f64::min)
        };
        (nearest(&self.crests), nearest(&self.troughs))
    }

    fn shape(&self, p: DVec2) -> f64 {
        let (crest, trough) = self.distances(p);
        if !crest.is_finite() {
            return 0.0;
        }
        let wavelength = 2.0 * (crest + trough);
        let t = (crest / self.wavelength - 1.5).clamp(0.0, 1.0);
        let fade = 1.0 - t.powi(3) * (t * (t * 6.0 - 15.0) + 10.0);
        0.5 * (1.0 + (2.0 * PI * crest / wavelength).cos()) * fade
    }
}

/// Places all over the land and beyond it, on no lattice.
fn places(count: u32) -> Vec<DVec2> {
    let golden = DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053);
    let margin = DVec2::splat(3.0 * KM);
    let place = |k| (f64::from(k) * golden).fract() * (LAND.size() + 2.0 * margin) - margin;
    (0..count).map(place).collect()
}

#[test]
fn fast_heights_are_those_of_brute_force() {
    for (wavelength, cells) in [(9.0, 150_000), (2.1, 40_000), (2.1, 900), (0.8, 300)] {
        for drive in [turning(), belt()] {
            let mesh = mesh(wavelength, 11);
            let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
            let (shape, brute) = (FoldShape::new(&mesh, &skeleton), Brute::new(&mesh, &skeleton));
            // Columns and rows that no tile divides.
            let mut grid = Grid::over(LAND, cells);
            (grid.cols, grid.rows) = (grid.cols - 3, grid.rows - 1);
            let mut heights = vec![9.0; 7];
            shape.on_grid(grid, &mut heights);
            assert_eq!(heights.len(), grid.len());
            for at in (0..grid.len()).step_by(1 + grid.len() / 1_500) {
                let p = grid.centre(at % grid.cols, at / grid.cols);
                let error = f64::from(heights[at]) - brute.shape(p);
                assert!(
                    error.abs() < SHAPE_TOLERANCE,
                    "{error} at {p} with {wavelength} km"
                );
            }
            let points = places(500);
            let mut heights = Vec::new();
            shape.at_points(&points, &mut heights);
            for (&p, &height) in points.iter().zip(&heights) {
                assert!((height - brute.shape(p)).abs() < 1e-6);
                let exact = brute.distances(p);
                match shape.distances(p) {
                    Some((crest, trough)) => {
                        assert!((crest - exact.0).abs() < 1e-6 && (trough - exact.1).abs() < 1e-6);
                    }
                    None => assert!(exact.0 >= 2.5 * mesh.wavelength()),
                }
            }
        }
    }
}

#[test]
fn crests_are_highest_and_troughs_lowest() {
    let mesh = mesh(5.0, 7);
    let skeleton = Skeleton::select(&mesh, &turning(), None, &[]);
    let shape = FoldShape::new(&mesh, &skeleton);
    for edge in skeleton.top() {
        let [a, b] = mesh.ends(edge);
        for t in [0.0, 0.3, 0.5, 1.0] {
            assert!((shape.at(a.lerp(b, t)) - 1.0).abs() < 1e-9);
        }
    }
    for line in troughs(&mesh, &skeleton) {
        let [a, b] = line.nodes.map(|node| trough_node(&mesh, node));
        for t in [0.0, 0.4, 1.0] {
            assert!(shape.at(a.lerp(b, t)).abs() < 1e-9);
        }
    }
}

#[test]
fn heights_stay_in_bounds_and_average_a_half() {
    let mesh = mesh(3.0, 12);
    let skeleton = Skeleton::select(&mesh, &turning(), None, &[]);
    let shape = FoldShape::new(&mesh, &skeleton);
    let mut heights = Vec::new();
    shape.on_grid(Grid::over(LAND, 256 * 1024), &mut heights);
    assert!(heights.iter().all(|h| (0.0..=1.0).contains(h)));
    let mean = heights.iter().map(|&h| f64::from(h)).sum::<f64>() / heights.len() as f64;
    assert!((mean - 0.48).abs() < 0.02, "{mean}");
    let mut least = f64::INFINITY;
    let mut farthest: f64 = 0.0;
    for p in places(20_000).into_iter().filter(|&p| LAND.contains(p)) {
        let (crest, trough) = shape.distances(p).expect("folds everywhere");
        least = least.min(2.0 * (crest + trough) / mesh.wavelength());
        farthest = farthest.max(crest / mesh.wavelength());
    }
    // Wavelengths never vanish, and folded ground is nowhere as far from a crest as where the shape begins to fade.
    assert!(least > 0.3, "{least}");
    assert!(farthest < 1.5, "{farthest}");
}

#[test]
fn heights_are_continuous() {
    // Distances change by no more than the step, so heights by no more than π/2 · step / (d_t + d_b), twice over for
    // two distances, and a little where folds fade.
    let mesh = mesh(6.0, 3);
    for drive in [turning(), belt()] {
        let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
        let shape = FoldShape::new(&mesh, &skeleton);
        let step = 1.0;
        let mut steepest: f64 = 0.0;
        for y in [7.3, 22.1, 41.9, 55.0] {
            let line: Vec<DVec2> = (0..100_000)
                .map(|k| DVec2::new(f64::from(k) * step, y * KM))
                .collect();
            let mut heights = Vec::new();
            shape.at_points(&line, &mut heights);
            steepest = heights
                .windows(2)
                .map(|h| (h[1] - h[0]).abs())
                .fold(steepest, f64::max);
        }
        let bound = PI * step / (0.15 * mesh.wavelength());
        assert!(steepest < bound, "{steepest} of {bound}");
        assert!(steepest > bound / 100.0);
    }
}

#[test]
fn without_folds_all_is_flat() {
    let mesh = mesh(5.0, 1);
    let shape = FoldShape::new(&mesh, &Skeleton::none(&mesh));
    let mut heights = Vec::new();
    shape.on_grid(Grid::over(LAND, 10_000), &mut heights);
    assert!(heights.iter().all(|&h| h == 0.0));
    assert_eq!(shape.at(DVec2::new(3.0, 4.0)), 0.0);
    assert_eq!(shape.wavelength_at(DVec2::new(3.0, 4.0)), None);
    assert_eq!(shape.at(DVec2::splat(f64::NAN)), 0.0);
    // The skeleton of a finer mesh names edges that this one does not have.
    let finer = self::mesh(2.0, 1);
    let foreign = Skeleton::select(&finer, &turning(), None, &[]);
    assert!(!foreign.is_of(&mesh) && foreign.is_of(&finer));
    assert_eq!(FoldShape::new(&mesh, &foreign).at(DVec2::new(3.0, 4.0)), 0.0);
    assert_eq!(FoldStats::of(&mesh, &foreign, &turning()).top_edges, 0);
    assert!(top_lines(&mesh, &foreign).is_empty());
}

/// A finger drawn from the south-west to the north-east, across folds that run north–south.
fn stroke() -> Vec<DVec2> {
    (0..=40)
        .map(|k| DVec2::new(25.0 + 1.2 * f64::from(k), 20.0 + 0.3 * f64::from(k)) * KM)
        .collect()
}

fn edit(kind: FoldEditKind) -> FoldEdit {
    FoldEdit::new(kind, &stroke()).expect("an edit")
}

/// East–west compression: folds run north–south.
fn east_west() -> FoldDrive {
    FoldDrive::uniform(blocks(), RATE, 0.0)
}

#[test]
fn a_drawn_stroke_becomes_a_crest_and_leaves_no_trace_when_removed() {
    let mesh = mesh(6.0, 21);
    let drive = east_west();
    let plain = Skeleton::select(&mesh, &drive, None, &[]);
    let edits = [edit(FoldEditKind::Turn)];
    let turned = Skeleton::select(&mesh, &drive, Some(&plain), &edits);
    assert_ne!(turned, plain);
    assert_eq!(Skeleton::select(&mesh, &drive, Some(&plain), &edits), turned);
    assert_eq!(Skeleton::select(&mesh, &drive, Some(&turned), &edits), turned);
    assert_eq!(Skeleton::select(&mesh, &drive, Some(&turned), &[]), plain);
    assert_eq!(
        Skeleton::select(&mesh, &drive, Some(&turned), &[edit(FoldEditKind::Raise(2.0))]),
        plain
    );

    // Where the finger was, a crest is near.
    let mean = |skeleton: &Skeleton| {
        let shape = FoldShape::new(&mesh, skeleton);
        let to_crest = |p: &DVec2| shape.distances(*p).map_or(f64::INFINITY, |d| d.0);
        stroke().iter().map(to_crest).sum::<f64>() / 41.0 / mesh.wavelength()
    };
    assert!(mean(&turned) < mean(&plain) && mean(&turned) < 0.25);
    // Few crests near it still run more across it than along: only steps of the drawn one.
    let across = |skeleton: &Skeleton| {
        let along = stroke()[40] - stroke()[0];
        let near = |edge: &usize| {
            let middle = mesh.middle(*edge);
            stroke()
                .iter()
                .any(|p| p.distance(middle) < 0.5 * mesh.wavelength())
        };
        let steep = |edge: &usize| {
            let [a, b] = mesh.ends(*edge);
            (b - a).perp_dot(along).abs() > (b - a).dot(along).abs()
        };
        skeleton.top().filter(near).filter(steep).count()
    };
    let (before, after) = (across(&plain), across(&turned));
    assert!(before >= 5 && 3 * after <= before, "{before} {after}");
    // The crest is one line from near one end of the stroke to near the other.
    let new: Vec<usize> = turned.top().filter(|&edge| !plain.is_top(edge)).collect();
    let along = stroke()[40] - stroke()[0];
    let reach = |edge: &usize| {
        mesh.ends(*edge)
            .map(|p| (p - stroke()[0]).dot(along) / along.length_squared())
    };
    let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
    for t in new.iter().flat_map(reach) {
        (from, to) = (from.min(t), to.max(t));
    }
    assert!(from < 0.15 && to > 0.85, "{from} {to}");
    // No crest crosses it, faces stay open, and far away nothing has changed.
    for edge in 0..mesh.edges().len() {
        let away = stroke()
            .iter()
            .map(|p| p.distance(mesh.middle(edge)))
            .fold(f64::INFINITY, f64::min);
        if away > 2.0 * mesh.wavelength() {
            assert_eq!(turned.is_top(edge), plain.is_top(edge));
        }
    }
    for sides in mesh.faces() {
        assert!(!sides.iter().all(|&side| turned.is_top(side as usize)));
    }
}

#[test]
fn a_stroke_shorter_than_an_edge_still_turns_one() {
    let mesh = mesh(6.0, 21);
    let here = mesh
        .vertices()
        .iter()
        .copied()
        .find(|&p| LAND.contains(p))
        .expect("a vertex");
    let dab = FoldEdit::new(FoldEditKind::Turn, &[here, here + DVec2::new(300.0, 20.0)]).expect("an edit");
    let skeleton = Skeleton::select(&mesh, &east_west(), None, &[dab]);
    let touched = (0..mesh.edges().len()).filter(|&edge| mesh.ends(edge).contains(&here));
    let lying = touched.filter(|&edge| {
        let [a, b] = mesh.ends(edge);
        skeleton.is_top(edge) && (b - a).normalize().x.abs() > 0.8
    });
    assert_eq!(lying.count(), 1);
}

#[test]
fn nothing_is_drawn_where_nothing_folds() {
    let mesh = mesh(6.0, 21);
    let still = FoldDrive::still(blocks());
    assert!(Skeleton::select(&mesh, &still, None, &[edit(FoldEditKind::Turn)]).is_empty());
}

#[test]
fn rates_follow_drive_share_limit_and_hand() {
    let mesh = mesh(6.0, 21);
    let drive = FoldDrive {
        limit: Field::constant(blocks(), 1e-8),
        ..east_west()
    };
    let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
    let shape = FoldShape::new(&mesh, &skeleton);
    let raised = [edit(FoldEditKind::Raise(2.0))];
    let rates = |share, raise: bool| FoldRates {
        drive: &drive,
        share,
        edits: if raise { &raised } else { &[] },
    };
    let points = places(4_000);
    let mut heights = Vec::new();
    shape.at_points(&points, &mut heights);
    let at = |share: f64, raise: bool| {
        let mut out = PointRates::default();
        out.fill(&mut CpuFolds, &shape, &rates(share, raise), &points);
        out.raised
    };
    let (low, high, edited) = (at(0.05, false), at(1.0, false), at(0.05, true));
    let mut raised_somewhere: f32 = 1.0;
    for (k, &height) in heights.iter().enumerate() {
        // 0.05 of the rate is far below the limit of 6e-5 m/yr, all of it far above.
        let height = height as f32;
        let wanted = height * 0.05 * RATE as f32;
        assert!(low[k] <= wanted * 1.000_001 && low[k] >= 0.998 * wanted);
        assert!(high[k] <= height * 6.000_1e-5 && high[k] >= height * 5.9e-5);
        assert!(edited[k] >= low[k] && edited[k] <= 2.0 * low[k] * 1.000_001);
        let away = stroke()
            .iter()
            .map(|p| p.distance(points[k]))
            .fold(f64::INFINITY, f64::min);
        if away > 0.6 * mesh.wavelength() {
            assert_eq!(edited[k], low[k]);
        }
        raised_somewhere = raised_somewhere.max(edited[k] / low[k].max(1e-12));
    }
    assert!(raised_somewhere > 1.9);
}

/// What is asked for only where something folds is what each point by itself would get.
#[test]
fn rates_are_heights_times_the_rates_of_crests() {
    let mesh = mesh(4.0, 8);
    let drive = belt();
    let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
    let shape = FoldShape::new(&mesh, &skeleton);
    let rates = FoldRates {
        drive: &drive,
        share: 0.4,
        edits: &[],
    };
    let mut out = PointRates::default();
    // Memory of an earlier time must not shine through.
    out.fill(&mut CpuFolds, &shape, &rates, &places(9_000));
    let points = places(6_000);
    out.fill(&mut CpuFolds, &shape, &rates, &points);
    assert_eq!((out.crests.len(), out.raised.len()), (points.len(), points.len()));
    let mut still = 0;
    for (k, &p) in points.iter().enumerate() {
        let crest = drive.at(p).amplitude_rate(mesh.wavelength(), 0.4);
        assert_eq!(out.crests[k], crest);
        assert_eq!(out.raised[k], (shape.at(p) * crest) as f32);
        still += usize::from(crest == 0.0);
    }
    assert!(
        still > 1_000 && still < 5_000,
        "{still} of {} points are still",
        points.len()
    );
}

#[test]
fn any_number_of_threads_gives_the_same_heights() {
    let edits = [edit(FoldEditKind::Turn), edit(FoldEditKind::Raise(2.5))];
    let runs = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let mesh = mesh(2.0, 5);
            let drive = belt();
            let skeleton = Skeleton::select(&mesh, &drive, None, &edits);
            let shape = FoldShape::new(&mesh, &skeleton);
            let rates = FoldRates {
                drive: &drive,
                share: 0.5,
                edits: &edits,
            };
            let mut heights = Vec::new();
            shape.on_grid(Grid::over(LAND, 100_000), &mut heights);
            let mut points = PointRates::default();
            points.fill(&mut CpuFolds, &shape, &rates, &places(5_000));
            (skeleton, heights, points.crests, points.raised)
        })
    });
    assert!(runs[0] == runs[1] && runs[0] == runs[2]);
    assert!(runs[0].3.iter().any(|&rate| rate > 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn whatever_is_drawn_skeletons_stay_sound(
        wavelength in 3.0..20.0_f64,
        seed in 0..40_u64,
        strokes in proptest::collection::vec(
            (proptest::collection::vec((-30.0..130.0_f64, -30.0..90.0_f64), 1..9), -1.0..5.0_f64, any::<bool>()),
            0..7,
        ),
    ) {
        let mesh = mesh(wavelength, seed);
        let drive = turning();
        let edits: Vec<FoldEdit> = strokes
            .iter()
            .filter_map(|(path, factor, turn)| {
                let path: Vec<DVec2> = path.iter().map(|&(x, y)| DVec2::new(x, y) * KM).collect();
                let kind = if *turn { FoldEditKind::Turn } else { FoldEditKind::Raise(*factor) };
                FoldEdit::new(kind, &path).ok()
            })
            .collect();
        let skeleton = Skeleton::select(&mesh, &drive, None, &edits);
        for edge in skeleton.top() {
            prop_assert!(mesh.edges()[edge].other.is_some() && skeleton.is_live(edge));
        }
        for sides in mesh.faces() {
            prop_assert!(!sides.iter().all(|&side| skeleton.is_top(side as usize)));
        }
        let shape = FoldShape::new(&mesh, &skeleton);
        let rates = FoldRates { drive: &drive, share: 1.0, edits: &edits };
        let mut out = PointRates::default();
        out.fill(&mut CpuFolds, &shape, &rates, &places(300));
        prop_assert!(out.raised.iter().all(|rate| (0.0..=3.000_1 * RATE as f32).contains(rate)));
        prop_assert_eq!(
            Skeleton::select(&mesh, &drive, Some(&skeleton), &[]),
            Skeleton::select(&mesh, &drive, Some(&Skeleton::select(&mesh, &drive, None, &[])), &[])
        );
    }
}
