//! Facts a relief map must show, whatever its taste.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::Cursor;

use crate::picture_common::{LAND, grid, mountain, on_threads, read_exr, read_glb, read_ply, river, surface};
use glam::DVec2;
use image::RgbaImage;
use orogen::export::height16::Height16;
use orogen::export::ply::NodeValues;
use orogen::export::{Mesh, exr, geojson, glb, ply};
use orogen::picture::{MapFrame, MapStyle, relief_map};
use orogen::surface::{FaultTrace, PlateMark, PlateState, Raster, Surface};

/// The land alone, filling the picture.
fn bare() -> MapStyle {
    MapStyle {
        marks: false,
        lettering: false,
        ..MapStyle::default()
    }
}

fn map(surface: &Surface) -> RgbaImage {
    relief_map(surface, &bare(), 640, 360)
}

/// Pixel of the bare map at a plan position.
fn pixel(image: &RgbaImage, plan: DVec2) -> [f32; 3] {
    let frame = MapFrame::new(LAND, &bare(), image.width(), image.height());
    let at = frame.to_pixel(plan);
    let [red, green, blue, alpha] = image.get_pixel(at.x as u32, at.y as u32).0;
    assert_eq!(alpha, 255);
    [red, green, blue].map(f32::from)
}

/// Mean brightness of the bare map around a plan position.
fn brightness(image: &RgbaImage, plan: DVec2) -> f32 {
    let mut sum = 0.0;
    for dx in -3..=3 {
        for dy in -3..=3 {
            let [r, g, b] = pixel(image, plan + 200.0 * DVec2::new(f64::from(dx), f64::from(dy)));
            sum += 0.2126 * r + 0.7152 * g + 0.0722 * b;
        }
    }
    sum / 49.0
}

fn differing(a: &RgbaImage, b: &RgbaImage) -> Vec<DVec2> {
    a.enumerate_pixels()
        .zip(b.pixels())
        .filter(|((_, _, p), q)| p != q)
        .map(|((x, y, _), _)| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
        .collect()
}

fn mean(points: &[DVec2]) -> DVec2 {
    assert!(!points.is_empty());
    points.iter().sum::<DVec2>() / points.len() as f64
}

#[test]
fn a_mountain_in_the_north_west_is_there_in_every_file() {
    // A quarter of the land from the west, a quarter from the north.
    let summit = DVec2::new(16e3, 27e3);
    let surface = surface(160, 90, summit);
    let (width, height) = (surface.height.width, surface.height.height);
    let row_major = |index: usize| DVec2::new((index % width) as f64, (index / width) as f64);
    let north_west = DVec2::new(0.25 * width as f64 - 0.5, 0.25 * height as f64 - 0.5);
    let top = |values: &[f32]| {
        let index = (0..values.len())
            .max_by(|&a, &b| values[a].total_cmp(&values[b]))
            .unwrap();
        row_major(index)
    };

    // The picture differs from one of flat land around the same place.
    let mut flat = surface.clone();
    flat.height.data.fill(0.0);
    let (image, plain) = (map(&surface), map(&flat));
    let far: Vec<DVec2> = differing(&image, &plain)
        .into_iter()
        .filter(|p| {
            let (x, y) = (p.x as u32, p.y as u32);
            image.get_pixel(x, y).0[0].abs_diff(plain.get_pixel(x, y).0[0]) > 24
        })
        .collect();
    assert!(
        mean(&far).distance(DVec2::new(160.0, 90.0)) < 25.0,
        "{}",
        mean(&far)
    );

    let mut file = Cursor::new(Vec::new());
    exr::write(&mut file, width, height, &[("height_m", &surface.height.data)]).unwrap();
    assert!(top(&read_exr(file.get_ref()).1["height_m"]).distance(north_west) < 1.0);

    let height16 = Height16::new(&surface.height).unwrap();
    let (mut png, mut r16) = (Vec::new(), Vec::new());
    height16.write_png(&mut png).unwrap();
    height16.write_r16(&mut r16).unwrap();
    let from_png: Vec<f32> = image::load_from_memory(&png)
        .unwrap()
        .into_luma16()
        .iter()
        .map(|&s| f32::from(s))
        .collect();
    let from_r16: Vec<f32> = r16
        .chunks(2)
        .map(|b| f32::from(u16::from_le_bytes([b[0], b[1]])))
        .collect();
    assert!(top(&from_png).distance(north_west) < 1.0);
    assert!(top(&from_r16).distance(north_west) < 1.0);

    let grid = grid(65, 37, mountain(summit));
    let mesh = Mesh {
        positions: &grid.positions,
        heights: &grid.heights,
        triangles: &grid.triangles,
    };
    let zeros = vec![0.0; grid.positions.len()];
    let outlets: Vec<u32> = (0..grid.positions.len() as u32).collect();
    let values = NodeValues {
        drainage: &zeros,
        uplift: &zeros,
        receivers: &outlets,
        layers: &outlets,
        erodibility: &zeros,
    };
    let mut bytes = Vec::new();
    ply::write(&mut bytes, mesh, values).unwrap();
    let read = read_ply(&bytes);
    let z = &read.vertex["z"];
    let i = (0..z.len()).max_by(|&a, &b| z[a].total_cmp(&z[b])).unwrap();
    assert!(
        DVec2::new(read.vertex["x"][i], read.vertex["y"][i]).distance(summit) < 1.0,
        "x east, y north"
    );

    let mut bytes = Vec::new();
    glb::write(&mut bytes, mesh, LAND, None).unwrap();
    let read = read_glb(&bytes);
    let positions = read.floats::<3>(0);
    let i = (0..positions.len())
        .max_by(|&a, &b| positions[a][1].total_cmp(&positions[b][1]))
        .unwrap();
    assert_eq!(
        [positions[i][0], positions[i][2]],
        [16e3, -27e3],
        "x east, z south"
    );
    let uv = read.floats::<2>(2)[i];
    assert!(
        (uv[0] - 0.25).abs() < 1e-6 && (uv[1] - 0.25).abs() < 1e-6,
        "where the map shows it"
    );

    let mut bytes = Vec::new();
    geojson::write_rivers(&mut bytes, LAND, &[river(&[summit, DVec2::new(16e3, 36e3)], 1e7)]).unwrap();
    let read: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(
        read["features"][0]["geometry"]["coordinates"][0],
        serde_json::json!([16.0, 27.0])
    );
}

#[test]
fn light_comes_from_the_north_west() {
    let summit = LAND.size() / 2.0;
    let image = map(&surface(320, 180, summit));
    let flank = |x: f64, y: f64| brightness(&image, summit + 4.5e3 * DVec2::new(x, y).normalize());
    let (lit, dark) = (flank(-1.0, 1.0), flank(1.0, -1.0));
    assert!(lit > dark + 40.0, "north-west {lit}, south-east {dark}");
    for across in [flank(1.0, 1.0), flank(-1.0, -1.0)] {
        assert!(dark < across && across < lit, "{dark} < {across} < {lit}");
    }
}

#[test]
fn shadows_are_cool_and_lights_are_warm() {
    let summit = LAND.size() / 2.0;
    let image = map(&surface(320, 180, summit));
    // Half-way down, where the same woods stand on both sides; higher up one side may be snow and the other rock.
    let tint = |x: f64, y: f64| {
        let [r, _, b] = pixel(&image, summit + 7.5e3 * DVec2::new(x, y).normalize());
        b / r
    };
    let (dark, lit) = (tint(1.0, -1.0), tint(-1.0, 1.0));
    assert!(
        dark > lit + 0.05,
        "blue over red: {dark} in the shade, {lit} in the sun"
    );
}

#[test]
fn cast_shadows_end_softly() {
    // A wall across the light; its shadow lies on flat ground to the south-east.
    let mut surface = surface(640, 360, DVec2::ZERO);
    let wall = |p: DVec2| {
        let across = ((p.x - 32e3) - (p.y - 18e3)) / 2.0_f64.sqrt();
        if (across + 3e3).abs() < 300.0 { 2500.0 } else { 0.0 }
    };
    surface.height = Raster::from_fn(640, 360, LAND, wall);
    let image = map(&surface);
    let profile: Vec<f32> = (0..80)
        .map(|i| {
            brightness(
                &image,
                LAND.size() / 2.0 + f64::from(i) * 130.0 * DVec2::new(1.0, -1.0),
            )
        })
        .collect();
    let (dark, light) = (profile[0], profile[79]);
    assert!(light > dark + 25.0, "there is a shadow: {dark} to {light}");
    let steepest = profile.windows(2).map(|p| p[1] - p[0]).fold(0.0, f32::max);
    assert!(
        steepest < 0.25 * (light - dark),
        "no hard edge: {steepest} of {}",
        light - dark
    );
}

#[test]
fn lakes_are_blue_and_deeper_ones_darker() {
    let mut surface = surface(320, 180, DVec2::new(-1e6, 0.0));
    let (shallow, deep) = (DVec2::new(16e3, 18e3), DVec2::new(48e3, 18e3));
    surface.lake_depth = Raster::from_fn(320, 180, LAND, |p| {
        if p.distance(shallow) < 5e3 {
            4.0
        } else if p.distance(deep) < 5e3 {
            200.0
        } else {
            0.0
        }
    });
    let image = map(&surface);
    for lake in [shallow, deep] {
        let [r, g, b] = pixel(&image, lake);
        assert!(b > g && g > r && b > r + 30.0, "{r} {g} {b}");
    }
    assert!(brightness(&image, deep) < brightness(&image, shallow) - 10.0);
    let [r, _, b] = pixel(&image, DVec2::new(32e3, 18e3));
    assert!(b < r, "dry land is not blue");
}

#[test]
fn rivers_run_where_they_are_and_grow() {
    let dry = surface(320, 180, DVec2::new(-1e6, 0.0));
    let mut wet = dry.clone();
    wet.rivers = vec![
        river(&[DVec2::new(8e3, 30e3), DVec2::new(56e3, 30e3)], 3e9),
        river(&[DVec2::new(8e3, 6e3), DVec2::new(56e3, 6e3)], 30e6),
    ];
    let image = map(&wet);
    // On flat land a river may wander within half the distance between data points: one pixel here.
    let bluest = (-1..=1)
        .map(|dy| pixel(&image, DVec2::new(40e3, 30e3 + 100.0 * f64::from(dy))))
        .map(|[r, _, b]| b - r)
        .fold(0.0, f32::max);
    assert!(bluest > 30.0, "water is blue: {bluest}");
    let changed = |south: f64, north: f64| {
        differing(&map(&dry), &image)
            .iter()
            .filter(|p| {
                let y = LAND.height * (1.0 - p.y / 360.0);
                (south..north).contains(&y)
            })
            .count()
    };
    assert!(
        changed(24e3, 36e3) > 3 * changed(0.0, 12e3).max(1),
        "the larger one is wider"
    );
    assert!(changed(0.0, 12e3) > 200, "the smaller one is there");
    assert_eq!(changed(14e3, 22e3), 0, "nothing changes away from them");
}

#[test]
fn marks_lie_where_they_belong_and_teeth_point_to_the_range() {
    let land = surface(320, 180, DVec2::new(-1e6, 0.0));
    let style = MapStyle {
        marks: true,
        ..bare()
    };
    let without = relief_map(&land, &style, 640, 360);
    let centre_of = |marked: &Surface| mean(&differing(&without, &relief_map(marked, &style, 640, 360)));

    // A fault due east: left is north, up.
    let fault = |range_on_left| {
        let mut marked = land.clone();
        marked.faults = vec![FaultTrace {
            points: vec![DVec2::new(16e3, 18e3), DVec2::new(48e3, 18e3)],
            range_on_left,
        }];
        centre_of(&marked).y
    };
    assert!(
        fault(true) < 179.8 && fault(false) > 180.2,
        "{} {}",
        fault(true),
        fault(false)
    );

    let plate = |spent, state, cap| {
        let mut marked = land.clone();
        let square = [(40e3, 20e3), (56e3, 20e3), (56e3, 32e3), (40e3, 32e3)];
        marked.plates = vec![PlateMark {
            hull: square.map(|(x, y)| DVec2::new(x, y)).to_vec(),
            arrows: vec![(DVec2::new(50e3, 26e3), DVec2::new(44e3, 26e3))],
            spent,
            state,
            cap,
        }];
        relief_map(&marked, &style, 640, 360)
    };
    let fresh = plate(0.0, PlateState::Pushing, None);
    let middle = mean(&differing(&without, &fresh));
    assert!(middle.distance(DVec2::new(480.0, 100.0)) < 12.0, "{middle}");
    let shaft = DVec2::new(47e3, 26e3);
    let contrast = |image: &RgbaImage| pixel(image, shaft)[2];
    assert!(
        contrast(&plate(0.9, PlateState::Pushing, None)) > contrast(&fresh) + 10.0,
        "ink fades as it is spent"
    );
    assert_ne!(fresh, plate(0.0, PlateState::Pushing, Some(0.5)));
    assert_ne!(fresh, plate(0.0, PlateState::Resting, None));
}

#[test]
fn exaggeration_is_printed_wherever_it_is_not_one() {
    let flat = surface(64, 36, DVec2::new(-1e6, 0.0));
    let print = |vertical_exaggeration| {
        let style = MapStyle {
            vertical_exaggeration,
            ..MapStyle::default()
        };
        relief_map(&flat, &style, 640, 360)
    };
    let (plain, exaggerated) = (print(1.0), print(1.5));
    let changed = differing(&plain, &exaggerated);
    let frame = MapFrame::new(LAND, &MapStyle::default(), 640, 360);
    assert!(
        !changed.is_empty(),
        "flat land looks the same, so the words must differ"
    );
    assert!(
        changed.iter().all(|p| p.y > f64::from(frame.top + frame.height)),
        "in the caption only"
    );
}

#[test]
fn equal_surfaces_give_equal_pixels_on_any_number_of_threads() {
    let mut land = surface(200, 113, DVec2::new(30e3, 20e3));
    land.spacing = 900.0;
    land.rivers = vec![river(&[DVec2::new(8e3, 30e3), DVec2::new(56e3, 3e3)], 3e9)];
    let draw = |threads| on_threads(threads, || relief_map(&land, &MapStyle::default(), 501, 299));
    let once = draw(1);
    assert!(once == draw(1) && once == draw(2) && once == draw(7));
}

#[test]
fn odd_surfaces_still_give_a_picture() {
    let mut land = surface(7, 3, DVec2::new(30e3, 20e3));
    land.height.data[4] = f32::NAN;
    land.height.data[5] = f32::INFINITY;
    land.rivers = vec![river(&[DVec2::NAN, DVec2::ZERO], f64::NAN), river(&[], 1.0)];
    land.plates = vec![PlateMark {
        hull: vec![DVec2::NAN; 3],
        arrows: vec![(DVec2::NAN, DVec2::ZERO)],
        spent: f64::NAN,
        state: PlateState::Pushing,
        cap: Some(f64::NAN),
    }];
    for (width, height) in [(1, 1), (2, 300), (300, 2), (97, 61)] {
        let image = relief_map(&land, &MapStyle::default(), width, height);
        assert_eq!(image.dimensions(), (width, height));
        assert!(image.pixels().all(|p| p.0[3] == 255));
    }
    assert_eq!(relief_map(&land, &bare(), 0, 0).dimensions(), (1, 1));
}
