//! Slices of a land in closed form.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::strata_common::{
    LAKE_LEVEL, LAND, base, column, fold, folded_range, ground, lake_depth, root, sediment,
};
use glam::DVec2;
use orogen::export::svg;
use orogen::picture::paint_figure;
use orogen::rock::preset;
use orogen::slice::{Band, Figure, FigureOptions, Label, MAX_SAMPLES, Role, Slice, SliceError};
use orogen::surface::{FaultTrace, Surface};
use proptest::prelude::*;

/// Columns and rows of the test land: cells of 250 m.
const CELLS: (usize, usize) = (256, 144);

/// Rasters hold 32-bit floats, metres.
const ROUNDING: f64 = 2e-3;

fn land() -> Surface {
    folded_range("jura", CELLS.0, CELLS.1)
}

/// The slice through the centres of a row of cells, one place at each.
fn along_row(surface: &Surface, row: usize) -> Slice {
    let ends = [0, CELLS.0 - 1].map(|column| surface.height.centre(column, row));
    Slice::cut(surface, ends, CELLS.0).unwrap()
}

#[test]
fn everything_along_the_line_is_what_lies_there() {
    let surface = land();
    let pile = preset::by_name("jura").unwrap();
    let slice = along_row(&surface, 70);
    let strata = slice.strata.as_ref().unwrap();
    assert_eq!(strata.interfaces.len(), pile.depths().len());
    for i in 0..CELLS.0 {
        let p = surface.height.centre(i, 70);
        assert!((slice.distance[i] - (p.x - 125.0)).abs() < 1e-6);
        assert!((slice.ground[i] - ground(p)).abs() < ROUNDING);
        assert!((strata.sediment[i] - sediment(p)).abs() < ROUNDING);
        assert!((strata.root[i] - root(p)).abs() < ROUNDING);
        let column = column(&pile, p);
        for (k, heights) in strata.interfaces.iter().enumerate() {
            assert!(
                (heights[i] - column.height(k)).abs() < ROUNDING,
                "interface {k} at {p}"
            );
        }
        match slice.lake[i] {
            Some(level) => assert!(
                lake_depth(p) > 0.5 && (level - LAKE_LEVEL).abs() < 0.01,
                "{level}"
            ),
            None => assert!(lake_depth(p) <= 0.5 + ROUNDING),
        }
    }
    assert!(slice.lake.iter().any(Option::is_some), "the lake is cut");
    let top = base(DVec2::new(32e3, 18e3)) + fold(DVec2::new(32e3, 18e3));
    assert!(top > 5500.0, "there is something to see");
}

#[test]
fn lakes_are_level() {
    let slice = along_row(&land(), 72);
    let levels: Vec<f64> = slice.lake.iter().copied().flatten().collect();
    assert!(levels.windows(2).all(|pair| pair[0] == pair[1]), "{levels:?}");
}

#[test]
fn faults_are_crossed_where_they_are_and_dip_under_the_range() {
    let surface = land();
    let straight = Slice::cut(&surface, [DVec2::new(0.0, 18e3), DVec2::new(64e3, 18e3)], 100).unwrap();
    let [fault] = straight.faults.as_slice() else {
        panic!("one crossing expected, found {:?}", straight.faults);
    };
    assert!((fault.distance - 47e3).abs() < 1e-6);
    assert!(!fault.range_ahead, "the range is in the west");
    assert!((fault.height - ground(DVec2::new(47e3, 18e3))).abs() < 1.0);
    assert!((fault.apparent_dip - FaultTrace::DIP_DEG.to_radians().tan()).abs() < 1e-9);

    // Against the trace, at 45°: the range is ahead, and the dip looks less.
    let slanted = Slice::cut(&surface, [DVec2::new(60e3, 31e3), DVec2::new(34e3, 5e3)], 100).unwrap();
    let fault = slanted.faults[0];
    assert!(fault.range_ahead);
    assert!((fault.distance - 13e3 * 2.0_f64.sqrt()).abs() < 1e-6);
    let cosine = std::f64::consts::FRAC_1_SQRT_2;
    assert!((fault.apparent_dip - cosine * straight.faults[0].apparent_dip).abs() < 1e-9);

    let beside = Slice::cut(&surface, [DVec2::new(0.0, 0.2e3), DVec2::new(64e3, 0.2e3)], 9).unwrap();
    assert!(beside.faults.is_empty(), "the trace ends before this line");
}

#[test]
fn ends_beyond_the_land_are_moved_to_its_border() {
    let slice = Slice::cut(&land(), [DVec2::new(-20e3, 18e3), DVec2::new(99e3, 18e3)], 50).unwrap();
    assert_eq!(slice.ends, [DVec2::new(0.0, 18e3), DVec2::new(LAND.width, 18e3)]);
    assert_eq!(slice.distance.last(), Some(&LAND.width));
}

#[test]
fn lines_without_length_or_land_are_refused() {
    let surface = land();
    let cut = |a: [f64; 2], b: [f64; 2]| Slice::cut(&surface, [a.into(), b.into()], 10);
    assert_eq!(cut([5e3, 5e3], [5e3, 5e3]), Err(SliceError::TooShort));
    assert_eq!(cut([f64::NAN, 5e3], [5e3, 5e3]), Err(SliceError::NotFinite));
    assert!(matches!(
        cut([-5e3, 5e3], [-5e3, 9e3]),
        Err(SliceError::Outside { .. })
    ));
}

#[test]
fn land_without_layers_and_land_without_numbers_are_cut_too() {
    let mut bare = land();
    bare.strata = None;
    let slice = Slice::cut(&bare, [DVec2::ZERO, LAND.size()], usize::MAX).unwrap();
    assert!(slice.strata.is_none());
    assert_eq!(slice.ground.len(), MAX_SAMPLES);

    let mut spoilt = land();
    spoilt.height.data.fill(f32::NAN);
    spoilt.lake_depth.data.fill(f32::NAN);
    let mut map = (**spoilt.strata.as_ref().unwrap()).clone();
    map.base.data.fill(f32::NAN);
    map.sediment.data.fill(f32::INFINITY);
    map.root.data.fill(f32::NAN);
    spoilt.strata = Some(map.into());
    let slice = Slice::cut(&spoilt, [DVec2::ZERO, LAND.size()], 0).unwrap();
    let strata = slice.strata.unwrap();
    let numbers = strata.interfaces.iter().flatten().chain(&slice.ground);
    assert!(
        numbers
            .chain(&strata.sediment)
            .chain(&strata.root)
            .all(|v| v.is_finite())
    );
    assert_eq!(slice.ground, [0.0, 0.0]);
}

/// A figure of the section alone, at twice the height.
fn section(slice: &Slice) -> Figure {
    let options = FigureOptions {
        exaggeration: Some(2.0),
        crust: false,
        names: false,
        ..FigureOptions::default()
    };
    slice.figure(DVec2::new(1600.0, 900.0), &options)
}

/// Bands of a figure whose role passes.
fn bands(figure: &Figure, wanted: impl Fn(Role) -> bool) -> Vec<&Band> {
    figure.bands.iter().filter(|band| wanted(band.role)).collect()
}

fn in_the_ground(role: Role) -> bool {
    matches!(role, Role::Rock(_) | Role::Sediment)
}

/// Where metres lie in a figure, from what is drawn in it: the ground's highest place, and the sides.
struct Scale {
    left: f64,
    across: f64,
    up: f64,
    summit: (f64, f64),
}

impl Scale {
    fn of(figure: &Figure, slice: &Slice) -> Self {
        let solid = bands(figure, in_the_ground);
        let points = || solid.iter().flat_map(|band| &band.top);
        let left = points().map(|p| p.x).fold(f64::MAX, f64::min);
        let right = points().map(|p| p.x).fold(f64::MIN, f64::max);
        let across = (right - left) / slice.length();
        let summit = slice.ground.iter().copied().fold(f64::MIN, f64::max);
        Self {
            left,
            across,
            up: 2.0 * across,
            summit: (summit, points().map(|p| p.y).fold(f64::MAX, f64::min)),
        }
    }

    fn x(&self, distance: f64) -> f64 {
        self.left + distance * self.across
    }

    fn y(&self, height: f64) -> f64 {
        self.summit.1 + (self.summit.0 - height) * self.up
    }
}

#[test]
fn layers_and_sediment_fill_the_ground_without_gap_or_overlap() {
    for preset in preset::names() {
        let surface = folded_range(preset, CELLS.0, CELLS.1);
        let slice = Slice::cut(&surface, [DVec2::new(1e3, 9e3), DVec2::new(60e3, 31e3)], 777).unwrap();
        let figure = section(&slice);
        let scale = Scale::of(&figure, &slice);
        let solid = bands(&figure, in_the_ground);
        let floor = solid
            .iter()
            .flat_map(|band| &band.bottom)
            .map(|p| p.y)
            .fold(f64::MIN, f64::max);
        let expected: f64 = slice
            .distance
            .windows(2)
            .zip(slice.ground.windows(2))
            .map(|(x, z)| (x[1] - x[0]) * scale.across * (floor - scale.y(f64::midpoint(z[0], z[1]))))
            .sum();
        let drawn: f64 = solid.iter().map(|band| band.area()).sum();
        assert!(
            (drawn / expected - 1.0).abs() < 1e-6,
            "{preset}: {drawn} of {expected}"
        );
        assert!(solid.iter().all(|band| band.area() >= 0.0));
    }
}

#[test]
fn eroded_rock_hangs_over_the_ground() {
    let slice = along_row(&land(), 30);
    let figure = section(&slice);
    let scale = Scale::of(&figure, &slice);
    let eroded = bands(&figure, |role| matches!(role, Role::Eroded(_)));
    assert!(
        eroded.iter().map(|band| band.area()).sum::<f64>() > 1000.0,
        "much is gone"
    );
    for band in eroded {
        for (top, bottom) in band.top.iter().zip(&band.bottom) {
            let ground = scale.y(slice.ground_at((bottom.x - scale.left) / scale.across));
            assert!(
                top.y <= bottom.y && bottom.y <= ground + 1e-6,
                "{:?} {bottom} {ground}",
                band.role
            );
        }
    }
}

#[test]
fn the_layer_drawn_at_the_surface_is_the_one_that_crops_out() {
    let slice = along_row(&land(), 44);
    let figure = section(&slice);
    let scale = Scale::of(&figure, &slice);
    let strata = slice.strata.as_ref().unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for i in (0..slice.distance.len()).filter(|&i| strata.sediment[i] < 1e-3) {
        let (x, y) = (scale.x(slice.distance[i]), scale.y(slice.ground[i]));
        let at_surface = |band: &&Band| {
            let point = band.top.iter().position(|p| (p.x - x).abs() < 1e-6);
            point.is_some_and(|k| (band.top[k].y - y).abs() < 1e-6 && band.bottom[k].y > y + 1e-6)
        };
        let layer = strata.outcrop[i].layer;
        let drawn: Vec<Role> = figure
            .bands
            .iter()
            .filter(at_surface)
            .map(|band| band.role)
            .filter(|role| in_the_ground(*role))
            .collect();
        assert_eq!(drawn, [Role::Rock(layer)], "at {} m", slice.distance[i]);
        seen.insert(layer);
    }
    assert!(seen.len() >= 4, "valleys cut through the layers: {seen:?}");
}

#[test]
fn the_fault_is_drawn_from_its_outcrop_at_its_dip() {
    let slice = along_row(&land(), 44);
    let figure = section(&slice);
    let scale = Scale::of(&figure, &slice);
    let cut = slice.faults[0];
    let outcrop = DVec2::new(scale.x(cut.distance), scale.y(cut.height));
    let fault = figure
        .lines
        .iter()
        .find(|line| line.points.len() == 2 && line.points[0].distance(outcrop) < 1e-6)
        .unwrap();
    let way = fault.points[1] - fault.points[0];
    assert!(way.x < 0.0 && way.y > 0.0, "down to the west, under the range");
    assert!((way.y / -way.x - 2.0 * cut.apparent_dip).abs() < 1e-9);
}

#[test]
fn exaggeration_is_printed_and_labels_are_drawn() {
    let slice = along_row(&land(), 44);
    let options = FigureOptions {
        title: "Lesson 3".to_owned(),
        labels: vec![
            Label {
                distance: 30e3,
                text: "Creux du Van".to_owned(),
            },
            Label {
                distance: 31e3,
                text: "Val-de-Travers".to_owned(),
            },
            Label {
                distance: 999e3,
                text: "nowhere".to_owned(),
            },
        ],
        ..FigureOptions::default()
    };
    let words = |exaggeration: f64| -> Vec<String> {
        let options = FigureOptions {
            exaggeration: Some(exaggeration),
            ..options.clone()
        };
        let figure = slice.figure(DVec2::new(1200.0, 700.0), &options);
        figure.texts.into_iter().map(|text| text.text).collect()
    };
    let has = |words: &[String], part: &str| words.iter().any(|text| text.contains(part));
    let double = words(2.0);
    for part in [
        "Lesson 3",
        "heights × 2",
        "sea level",
        "Creux du Van",
        "Val-de-Travers",
        "Malm",
        "Moho",
    ] {
        assert!(has(&double, part), "{part}: {double:?}");
    }
    assert!(!has(&double, "nowhere"));
    let plain = words(1.0);
    assert!(has(&plain, "true scale") && !has(&plain, "heights ×"));
}

proptest! {
    /// No size and no choice makes the layout fail, and all it draws are places.
    #[test]
    fn any_figure_is_drawn(
        size in (0.0..5000.0f64, 0.0..5000.0f64),
        exaggeration in proptest::option::of(-1.0..100.0f64),
        depth in -1e5..1e5f64,
        (crust, names, layers) in any::<(bool, bool, bool)>(),
        ends in proptest::array::uniform4(-10e3..70e3f64),
        label in ".{0,12}",
    ) {
        let mut surface = folded_range("zagros", 32, 18);
        if !layers {
            surface.strata = None;
        }
        let [x0, y0, x1, y1] = ends;
        if let Ok(slice) = Slice::cut(&surface, [DVec2::new(x0, y0), DVec2::new(x1, y1)], 60) {
            let options = FigureOptions {
                exaggeration,
                depth,
                crust,
                names,
                labels: vec![Label { distance: slice.length() / 2.0, text: label }],
                ..FigureOptions::default()
            };
            let figure = slice.figure(DVec2::new(size.0, size.1), &options);
            prop_assert!(figure.bands.iter().flat_map(Band::outline).all(DVec2::is_finite));
            prop_assert!(figure.lines.iter().flat_map(|line| &line.points).all(|p| p.is_finite()));
            prop_assert!(figure.texts.iter().all(|text| text.at.is_finite()));
            prop_assert!(figure.size.max_element() <= 5000.0 && figure.size.min_element() >= 1.0);
        }
    }
}

/// Tags of a document, checked to be nested, and its text; fails on anything XML would refuse here.
fn well_formed(document: &str) -> String {
    let mut open: Vec<&str> = Vec::new();
    let mut text = String::new();
    let body = document
        .strip_prefix("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n")
        .unwrap();
    for part in body.split('<').skip(1) {
        let (tag, after) = part.split_once('>').expect("a tag ends");
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().unwrap());
        }
        for entity in after.split('&').skip(1) {
            let name = entity.split_once(';').expect("an entity ends").0;
            assert!(["amp", "lt", "gt", "quot"].contains(&name), "{name}");
        }
        assert!(!after.contains('>'));
        text.push_str(after);
    }
    assert!(open.is_empty(), "{open:?}");
    text
}

fn svg_of(figure: &Figure) -> String {
    let mut bytes = Vec::new();
    svg::write(&mut bytes, figure).unwrap();
    String::from_utf8(bytes).unwrap()
}

#[test]
fn the_svg_is_well_formed_whatever_it_is_called() {
    let slice = along_row(&land(), 70);
    let options = FigureOptions {
        title: "A <b> & \"c\" ]]> \u{1}é".to_owned(),
        ..FigureOptions::default()
    };
    let document = svg_of(&slice.figure(DVec2::new(1600.0, 900.0), &options));
    let text = well_formed(&document);
    assert!(
        text.contains("A &lt;b&gt; &amp; &quot;c&quot; ]]&gt; é"),
        "{text}"
    );
    assert!(document.contains("viewBox=\"0 0 1600 "));
    for class in ["rock layer-1", "eroded layer-0", "sediment", "water", "deep"] {
        assert!(document.contains(&format!("class=\"{class}\"")), "{class}");
    }
}

#[test]
#[should_panic(expected = "left: Some(\"g\")")]
fn the_check_of_nesting_can_fail() {
    well_formed("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg><g></svg></g>");
}

#[test]
fn the_same_slice_gives_the_same_bytes_and_pixels() {
    let draw = || {
        let figure = along_row(&land(), 44).figure(DVec2::new(800.0, 450.0), &FigureOptions::default());
        (svg_of(&figure), paint_figure(&figure))
    };
    let first = draw();
    assert!(first == draw());
    let (width, height) = first.1.dimensions();
    assert!(width == 800 && (100..=450).contains(&height), "{height}");
}
