//! Rigid fits against their closed form and an independent solution (Umeyama 1991, scale 1).
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use glam::{DMat2, DVec2};
use orogen::gesture::rigid::{RigidFit, RigidMotion};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};
use proptest::prelude::*;

/// Angles are recovered to this: rounding of coordinates of some hundred millimetres over fingers millimetres apart.
const ANGLE_TOLERANCE: f64 = 1e-9;

/// Millimetres: the same rounding, over the size of a table.
const LENGTH_TOLERANCE: f64 = 1e-6;

fn point() -> impl Strategy<Value = DVec2> {
    (-1500.0..1500.0, -1500.0..1500.0).prop_map(DVec2::from)
}

/// Points that do not coincide.
fn points(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<DVec2>> {
    prop::collection::vec(point(), count).prop_filter("spread out", |points| {
        let mean = points.iter().sum::<DVec2>() / points.len() as f64;
        points.iter().map(|p| p.distance(mean)).fold(0.0, f64::max) > 5.0
    })
}

fn motion() -> impl Strategy<Value = RigidMotion> {
    (-0.999 * PI..0.999 * PI, point()).prop_map(|(angle, translation)| RigidMotion { angle, translation })
}

fn apart(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(2.0 * PI);
    d.min(2.0 * PI - d)
}

/// Umeyama (1991), eq. 40–42 with s = 1: R = U S Vᵀ of the covariance Σ (to)(from)ᵀ, with S = diag(1, ±1) so that
/// det R = 1. The singular vectors come from the eigenvectors of `MᵀM`.
fn umeyama(from: &[DVec2], to: &[DVec2]) -> DMat2 {
    let n = from.len() as f64;
    let (c, p) = (from.iter().sum::<DVec2>() / n, to.iter().sum::<DVec2>() / n);
    let mut m = DMat2::ZERO;
    for (&a, &b) in from.iter().zip(to) {
        let (x, y) = (a - c, b - p);
        m += DMat2::from_cols(y * x.x, y * x.y);
    }
    let s = m.transpose() * m;
    let phi = 0.5 * (2.0 * s.y_axis.x).atan2(s.x_axis.x - s.y_axis.y);
    let (v1, v2) = (DVec2::from_angle(phi), DVec2::from_angle(phi).perp());
    let u1 = (m * v1).normalize();
    // det(U) det(V) < 0 is mended by S on the smaller singular value: U S is a rotation of V by construction.
    let u2 = u1.perp();
    DMat2::from_cols(u1, u2) * DMat2::from_cols(v1, v2).transpose()
}

fn misfit(motion: &RigidMotion, from: &[DVec2], to: &[DVec2]) -> f64 {
    let squares = from
        .iter()
        .zip(to)
        .map(|(&a, &b)| motion.apply(a).distance_squared(b));
    squares.sum::<f64>().sqrt()
}

proptest! {
    #[test]
    fn exact_motions_are_recovered(from in points(2..6), truth in motion()) {
        let to: Vec<DVec2> = from.iter().map(|&p| truth.apply(p)).collect();
        let fit = RigidFit::fit(&from, &to);
        prop_assert!(apart(fit.motion.angle, truth.angle) < ANGLE_TOLERANCE);
        prop_assert!(fit.motion.translation.distance(truth.translation) < LENGTH_TOLERANCE);
        prop_assert!(fit.residual < LENGTH_TOLERANCE);
    }

    #[test]
    fn it_is_umeyama_without_scale(from in points(2..6), to in points(2..6)) {
        let n = from.len().min(to.len());
        let (from, to) = (&from[..n], &to[..n]);
        let fit = RigidFit::fit(from, to);
        let rotation = umeyama(from, to);
        prop_assert!((rotation.determinant() - 1.0).abs() < 1e-9);
        let theirs = RigidMotion { angle: rotation.x_axis.to_angle(), translation: DVec2::ZERO };
        let centre = |points: &[DVec2]| points.iter().sum::<DVec2>() / n as f64;
        let theirs = RigidMotion { translation: centre(to) - theirs.apply(centre(from)), ..theirs };
        // Compared by misfit: where all angles are about as good, the angle itself is not determined.
        let (ours, theirs) = (misfit(&fit.motion, from, to), misfit(&theirs, from, to));
        prop_assert!((ours - theirs).abs() <= 1e-7 * (1.0 + ours), "{} {}", ours, theirs);
    }

    #[test]
    fn nothing_near_fits_better(from in points(1..6), noise in points(1..6), turn in -0.1..0.1, by in point()) {
        let n = from.len().min(noise.len());
        let to: Vec<DVec2> = from.iter().zip(&noise).map(|(a, b)| *a + *b * 0.1).collect();
        let fit = RigidFit::fit(&from[..n], &to);
        prop_assert!((misfit(&fit.motion, &from[..n], &to) - fit.residual).abs() < LENGTH_TOLERANCE);
        let other = RigidMotion { angle: fit.motion.angle + turn, translation: fit.motion.translation + by * 0.01 };
        prop_assert!(misfit(&other, &from[..n], &to) >= fit.residual - LENGTH_TOLERANCE);
    }

    #[test]
    fn the_residual_is_the_closed_form(from in points(2..6), to in points(2..6)) {
        let n = from.len().min(to.len());
        let (from, to) = (&from[..n], &to[..n]);
        let (c, p) = (from.iter().sum::<DVec2>() / n as f64, to.iter().sum::<DVec2>() / n as f64);
        let (mut squares, mut dot, mut cross) = (0.0, 0.0, 0.0);
        for (&a, &b) in from.iter().zip(to) {
            squares += (a - c).length_squared() + (b - p).length_squared();
            dot += (a - c).dot(b - p);
            cross += (a - c).perp_dot(b - p);
        }
        let closed = squares - 2.0 * dot.hypot(cross);
        prop_assert!((RigidFit::fit(from, to).residual.powi(2) - closed).abs() < 1e-9 * squares);
    }

    #[test]
    fn a_turned_frame_gives_the_turned_motion(from in points(2..6), noise in points(2..6), frame in motion()) {
        let n = from.len().min(noise.len());
        let from = &from[..n];
        let to: Vec<DVec2> = from.iter().zip(&noise).map(|(a, b)| *a + *b * 0.05).collect();
        let turned = |points: &[DVec2]| points.iter().map(|&p| frame.apply(p)).collect::<Vec<_>>();
        let here = RigidFit::fit(from, &to);
        let there = RigidFit::fit(&turned(from), &turned(&to));
        prop_assert!(apart(here.motion.angle, there.motion.angle) < 1e-7);
        prop_assert!((here.residual - there.residual).abs() < LENGTH_TOLERANCE);
        let expected = frame.compose(&here.motion).compose(&frame.inverse());
        for &p in &turned(from) {
            prop_assert!(expected.apply(p).distance(there.motion.apply(p)) < 1e-4);
        }
    }

    #[test]
    fn mirrored_fingers_are_turned_and_never_mirrored(from in points(3..6)) {
        let to: Vec<DVec2> = from.iter().map(|p| DVec2::new(-p.x, p.y)).collect();
        let motion = RigidFit::fit(&from, &to).motion;
        let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
        let before = area(from[0], from[1], from[2]);
        let after = area(motion.apply(from[0]), motion.apply(from[1]), motion.apply(from[2]));
        prop_assert!((before - after).abs() < 1e-6 * (1.0 + before.abs()));
    }

    #[test]
    fn motions_compose_and_invert(a in motion(), b in motion(), p in point()) {
        prop_assert!(a.compose(&b).apply(p).distance(a.apply(b.apply(p))) < LENGTH_TOLERANCE);
        prop_assert!(a.inverse().apply(a.apply(p)).distance(p) < LENGTH_TOLERANCE);
        prop_assert!(a.inverse().apply(p).distance(a.apply_inverse(p)) < LENGTH_TOLERANCE);
        prop_assert!(a.compose(&b).angle > -PI && a.compose(&b).angle <= PI);
    }

    #[test]
    fn a_fraction_moves_its_pivot_straight(a in motion(), pivot in point(), p in point(), f in 0.0..1.0) {
        let part = a.fraction(f, pivot);
        prop_assert!(part.apply(pivot).distance(pivot.lerp(a.apply(pivot), f)) < LENGTH_TOLERANCE);
        prop_assert!((part.angle - f * a.angle).abs() < ANGLE_TOLERANCE);
        prop_assert!(a.fraction(0.0, pivot).apply(p).distance(p) < LENGTH_TOLERANCE);
        prop_assert!(a.fraction(1.0, pivot).apply(p).distance(a.apply(p)) < LENGTH_TOLERANCE);
    }

    #[test]
    fn table_and_ground_see_the_same_motion(a in motion(), p in point()) {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        let ground = a.to_plan(&map);
        // Metres; the map has 147 of them in a millimetre.
        prop_assert!(ground.apply(map.to_plan(p)).distance(map.to_plan(a.apply(p))) < 1e-3);
    }
}

#[test]
fn one_finger_or_coincident_fingers_translate() {
    let (a, b) = (DVec2::new(300.0, 200.0), DVec2::new(310.0, 190.0));
    for count in 1..=5 {
        let fit = RigidFit::fit(&vec![a; count], &vec![b; count]);
        assert_eq!(
            (fit.motion.angle, fit.motion.translation, fit.residual),
            (0.0, b - a, 0.0)
        );
    }
    // Coincident at first, apart later: no turn is better than another.
    let fit = RigidFit::fit(&[a, a], &[b, b + DVec2::X]);
    assert_eq!(fit.motion.angle, 0.0);
    assert_eq!(RigidFit::fit(&[], &[]).motion, RigidMotion::IDENTITY);
}

#[test]
fn half_a_turn_is_stable() {
    let from = [
        DVec2::new(-40.0, 3.0),
        DVec2::new(35.0, -10.0),
        DVec2::new(10.0, 30.0),
    ];
    for off in [-1e-9, -1e-15, 0.0, 1e-15, 1e-9] {
        let to = from.map(|p| DVec2::from_angle(PI + off).rotate(p));
        let fit = RigidFit::fit(&from, &to);
        assert!(apart(fit.motion.angle, PI + off) < 1e-12, "{off}");
        assert!(fit.motion.angle > -PI && fit.motion.angle <= PI);
        assert!(fit.residual < 1e-12);
    }
    // Exactly half a turn, by sign: one angle, not its twin −π.
    let fit = RigidFit::fit(&[DVec2::X, -DVec2::X], &[-DVec2::X, DVec2::X]);
    assert_eq!(fit.motion.angle, PI);
    assert_eq!(fit.motion.inverse().angle, PI);
}

#[test]
fn a_turn_to_the_left_on_the_table_is_one_to_the_left_on_the_map() {
    // Seen from above, y down on the table: the finger at the right goes up, which is north.
    let map = PlanMap::new(DVec2::new(1000.0, 500.0), 100_000.0);
    let turn = RigidFit::fit(
        &[DVec2::new(400.0, 250.0), DVec2::new(600.0, 250.0)],
        &[DVec2::new(500.0, 350.0), DVec2::new(500.0, 150.0)],
    );
    assert!((turn.motion.to_plan(&map).angle - PI / 2.0).abs() < 1e-12);
}
