//! What is drawn on top of the land, looked at as shapes: marks of different meaning differ in line and in colour, for
//! every kind of colour vision; figures do not jitter; marks come and go.

#![cfg(feature = "app")]

use crate::ui_common::{SCREEN, map, shapes};
use egui::epaint::{ColorMode, PathShape};
use egui::{Color32, Shape};
use glam::DVec2;
use orogen::gesture::contact::Side;
use orogen::instrument::{EditView, Editing};
use orogen::kiosk::{Hint, Lesson};
use orogen::live::Clock;
use orogen::surface::{FaultTrace, PlateMark, PlateState};
use orogen::ui::ink::Chart;
use orogen::ui::readouts::{self, Readings};
use orogen::ui::{Sight, ghost, palette, warning};
use orogen::units::KM;

fn plate(state: PlateState, spent: f64, cap: Option<f64>) -> PlateMark {
    let corner = |x: f64, y: f64| DVec2::new(x, y) * KM;
    let push = if state == PlateState::Resting { 0.0 } else { 20.0 };
    PlateMark {
        hull: vec![
            corner(40.0, 30.0),
            corner(60.0, 30.0),
            corner(60.0, 70.0),
            corner(40.0, 70.0),
        ],
        arrows: vec![(corner(50.0, 50.0), corner(50.0 + push, 50.0))],
        spent,
        state,
        cap,
    }
}

fn drawn(plates: &[PlateMark], faults: &[FaultTrace]) -> Vec<Shape> {
    let mut chart = Chart::default();
    chart.follow(plates, faults, 0.0);
    shapes(|painter, sight| chart.draw(painter, sight, 1.0, None, 9.0))
}

fn paths(shapes: &[Shape]) -> Vec<&PathShape> {
    shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::Path(path) => Some(path),
            _ => None,
        })
        .collect()
}

/// Strokes in an ink: how many, and the opacity of the strongest (0 to 255).
fn strokes(shapes: &[Shape], ink: Color32) -> (usize, u8) {
    let opacities: Vec<u8> = paths(shapes)
        .into_iter()
        .filter_map(|path| match path.stroke.color {
            ColorMode::Solid(colour) if path.stroke.width > 0.0 && same_hue(colour, ink) => Some(colour.a()),
            _ => None,
        })
        .collect();
    (opacities.len(), opacities.iter().copied().max().unwrap_or(0))
}

/// `colour` is `ink` with some opacity.
fn same_hue(colour: Color32, ink: Color32) -> bool {
    let part = f32::from(colour.a()) / 255.0;
    let near = |a: u8, b: u8| (f32::from(a) - f32::from(b) * part).abs() < 2.0;
    colour.a() > 8 && near(colour.r(), ink.r()) && near(colour.g(), ink.g()) && near(colour.b(), ink.b())
}

#[test]
fn states_of_plates_differ_in_line_not_only_in_colour() {
    let pushing = drawn(&[plate(PlateState::Pushing, 0.0, None)], &[]);
    let resting = drawn(&[plate(PlateState::Resting, 0.0, None)], &[]);
    let standing = drawn(&[plate(PlateState::Standing, 1.0, None)], &[]);
    let (solid, strong) = strokes(&pushing, palette::VERMILION);
    let (dashes, _) = strokes(&resting, palette::BLUE_BLACK);
    let (thin, faded) = strokes(&standing, palette::BLUE_BLACK);
    assert_eq!(solid, 1, "one unbroken outline");
    assert!(dashes > 20, "a dashed outline, {dashes} pieces");
    assert_eq!(thin, 1);
    assert!(u32::from(faded) * 2 < u32::from(strong), "{faded} of {strong}");
    assert_eq!(strokes(&pushing, palette::BLUE_BLACK).0, 0);
}

#[test]
fn an_arrow_pales_as_it_is_spent_and_a_capped_one_shows_where_it_wanted_to_go() {
    let (_, fresh) = strokes(
        &drawn(&[plate(PlateState::Pushing, 0.0, None)], &[]),
        palette::VERMILION,
    );
    let (_, spent) = strokes(
        &drawn(&[plate(PlateState::Pushing, 0.9, None)], &[]),
        palette::VERMILION,
    );
    assert!(spent < fresh);

    let capped = drawn(&[plate(PlateState::Pushing, 0.0, Some(0.5))], &[]);
    let tip = Sight::flat(map(), SCREEN)
        .of_plan(DVec2::new(70.0, 50.0) * KM)
        .expect("on the table");
    let wanted = tip.x + 20.0 * KM as f32 / map().metres_per_mm() as f32 * 1920.0 / 1209.6;
    let farthest = paths(&capped)
        .iter()
        .flat_map(|path| &path.points)
        .map(|p| p.x)
        .fold(0.0, f32::max);
    assert!(
        (farthest - wanted).abs() < 6.0,
        "dots end at {farthest}, not at {wanted}"
    );
}

#[test]
fn the_teeth_of_a_fault_point_to_the_range() {
    let north = vec![DVec2::new(20.0, 50.0) * KM, DVec2::new(120.0, 50.0) * KM];
    for (range_on_left, up) in [(true, true), (false, false)] {
        let fault = FaultTrace {
            points: north.clone(),
            range_on_left,
        };
        let shapes = drawn(&[], &[fault]);
        let line = Sight::flat(map(), SCREEN)
            .of_plan(north[0])
            .expect("on the table")
            .y;
        let teeth: Vec<_> = paths(&shapes)
            .into_iter()
            .filter(|path| path.points.len() == 3)
            .collect();
        assert!(teeth.len() > 10);
        for tooth in teeth {
            assert_eq!(tooth.points[2].y < line, up);
        }
    }
}

#[test]
fn marks_come_and_go_and_then_there_is_nothing_left_to_draw() {
    let mut chart = Chart::default();
    let mark = [plate(PlateState::Resting, 0.0, None)];
    chart.follow(&mark, &[], 1.0);
    let opacity = |chart: &Chart, now_s: f64| {
        strokes(
            &shapes(|painter, sight| chart.draw(painter, sight, 1.0, None, now_s)),
            palette::BLUE_BLACK,
        )
        .1
    };
    let (first, soon, then) = (opacity(&chart, 1.02), opacity(&chart, 1.08), opacity(&chart, 2.0));
    assert!(first < soon && soon < then, "{first} {soon} {then}");
    assert!(chart.moves(1.05) && !chart.moves(2.0));
    chart.follow(&[], &[], 3.0);
    assert!(chart.moves(3.1));
    assert!(opacity(&chart, 3.3) < then);
    chart.follow(&[], &[], 5.0);
    assert!(!chart.moves(5.0));
    assert!(shapes(|painter, sight| chart.draw(painter, sight, 1.0, None, 5.0)).is_empty());
}

#[test]
fn handles_are_there_only_for_a_side_that_edits_and_places_that_are_none_draw_nothing_wild() {
    let mut chart = Chart::default();
    let mut wild = plate(PlateState::Pushing, f64::NAN, Some(f64::NAN));
    wild.hull[1] = DVec2::NAN;
    wild.arrows.push((DVec2::NAN, DVec2::splat(f64::INFINITY)));
    chart.follow(&[plate(PlateState::Pushing, 0.0, None), wild], &[], 0.0);
    let circles = |edits: Option<&[EditView]>| {
        let shapes = shapes(|painter, sight| chart.draw(painter, sight, 1.0, edits, 9.0));
        for path in paths(&shapes) {
            assert!(path.points.iter().all(|p| p.x.is_finite() && p.y.is_finite()));
        }
        shapes
            .iter()
            .filter(|shape| matches!(shape, Shape::Circle(_)))
            .count()
    };
    let without = circles(None);
    assert!(circles(Some(&[])) > without);
    let doing = [
        Editing::Nothing,
        Editing::Plate,
        Editing::Fault,
        Editing::Removed,
        Editing::Tip { tip: DVec2::NAN },
        Editing::NewArrow {
            from: DVec2::ZERO,
            to: DVec2::NAN,
        },
    ];
    let edits = doing.map(|doing| EditView {
        side: Side::North,
        at: DVec2::new(300.0, 300.0),
        doing,
        hold: 0.5,
    });
    assert!(circles(Some(&edits)) > without);
}

#[test]
fn digits_are_equally_wide_and_the_strip_keeps_its_length() {
    let strip = |elapsed_yr: f64| {
        let clock = Clock {
            elapsed_yr,
            ..Clock::default()
        };
        let readings = Readings {
            clock: &clock,
            exaggeration: 1.0,
        };
        let shapes = shapes(|painter, sight| readouts::draw(painter, sight, &readings, Side::South, 1.0));
        let widths = paths(&shapes)
            .into_iter()
            .map(|path| path.visual_bounding_rect().width());
        widths.fold(0.0, f32::max)
    };
    let length = strip(0.0);
    for elapsed_yr in [1.11e6, 4.44e6, 8.88e6, 88.88e6, 100.0e6] {
        assert_eq!(strip(elapsed_yr), length);
    }
    let turned = shapes(|painter, sight| {
        let clock = Clock::default();
        let readings = Readings {
            clock: &clock,
            exaggeration: 1.6,
        };
        readouts::draw(painter, sight, &readings, Side::North, 0.0);
    });
    let upside_down = |shape: &Shape| matches!(shape, Shape::Text(text) if (text.angle - std::f32::consts::PI).abs() < 1e-6);
    assert!(
        turned.iter().any(upside_down),
        "the exaggeration is told to the north side, too"
    );
}

#[test]
fn the_warning_counts_whole_seconds_for_both_sides() {
    for (left_ms, told) in [(20_000, "20"), (12_001, "13"), (1, "1")] {
        let shapes = shapes(|painter, sight| warning::draw(painter, sight, SCREEN, left_ms, 20_000));
        let angles: Vec<f32> = shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Text(text) if text.galley.text() == told => Some(text.angle),
                _ => None,
            })
            .collect();
        assert_eq!(angles.len(), 2, "{told} is told twice");
        assert!((angles[0] - angles[1]).abs() > 3.0, "once for each side");
    }
}

#[test]
fn ghosts_that_may_not_travel_stand_where_the_gesture_ends() {
    let places = |progress: f64| {
        let hint = Hint {
            lesson: Lesson::TwoHands,
            side: Side::South,
            progress,
        };
        let shapes = shapes(|painter, sight| ghost::draw_still(painter, sight, &hint));
        let rings = shapes.into_iter().filter_map(|shape| match shape {
            Shape::Circle(circle) => Some((circle.center.x.to_bits(), circle.center.y.to_bits())),
            _ => None,
        });
        rings.collect::<Vec<_>>()
    };
    assert!(places(0.0).is_empty() && places(1.0).is_empty());
    assert!(places(0.3).len() >= 10, "a ring round each finger");
    assert_eq!(places(0.3), places(0.7));
}

/// Colour vision without one kind of cone: Machado, Oliveira & Fernandes 2009, severity 1, on linear RGB.
const DEFICIENCIES: [(&str, [[f64; 3]; 3]); 4] = [
    ("usual", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
    ),
    (
        "deuteranopia",
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
    ),
    (
        "tritanopia",
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ),
];

/// A colour as somebody sees it, in CIE L*a*b* (D65).
fn seen(colour: Color32, matrix: &[[f64; 3]; 3]) -> [f64; 3] {
    let linear = |v: u8| {
        let v = f64::from(v) / 255.0;
        if v <= 0.040_45 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    };
    let rgb = [colour.r(), colour.g(), colour.b()].map(linear);
    let [r, g, b] = matrix.map(|row| (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]).clamp(0.0, 1.0));
    let f = |t: f64| {
        if t > 0.008_856 {
            t.cbrt()
        } else {
            7.787 * t + 16.0 / 116.0
        }
    };
    let x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
    let y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
    let z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn difference(a: Color32, b: Color32, matrix: &[[f64; 3]; 3]) -> f64 {
    let (a, b) = (seen(a, matrix), seen(b, matrix));
    a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Two colours that differ by this much (ΔE*ab) are told apart at a glance; about 2.3 can just be seen.
const AT_A_GLANCE: f64 = 14.0;

#[test]
fn inks_and_hands_stay_apart_for_every_colour_vision() {
    // Plain, meadow, forest, rock and snow of the map.
    let land = [0xd6_d8be, 0xb4_c29a, 0x7d_9272, 0x9a_8c7c, 0xf4_f6f8]
        .map(|c: u32| Color32::from_rgb((c >> 16) as u8, (c >> 8) as u8, c as u8));
    for (who, matrix) in &DEFICIENCIES {
        let apart = |a: Color32, b: Color32| {
            let d = difference(a, b, matrix);
            assert!(d > AT_A_GLANCE, "{a:?} and {b:?} differ by {d:.1} with {who}");
        };
        apart(palette::VERMILION, palette::BLUE_BLACK);
        for ground in land {
            apart(palette::VERMILION, ground);
            apart(palette::BLUE_BLACK, ground);
        }
        for (i, &hand) in palette::HANDS.iter().enumerate() {
            for &other in &palette::HANDS[..i] {
                apart(hand, other);
            }
        }
    }
}

#[test]
fn the_simulation_of_colour_vision_sees_what_it_should() {
    let (red, green) = (Color32::from_rgb(190, 90, 60), Color32::from_rgb(120, 120, 50));
    let [usual, _, deutan, _] = &DEFICIENCIES;
    assert!(difference(red, green, &usual.1) > 2.0 * difference(red, green, &deutan.1));
    let white = seen(Color32::WHITE, &usual.1);
    assert!((white[0] - 100.0).abs() < 0.1 && white[1].abs() < 0.5 && white[2].abs() < 0.5);
}
