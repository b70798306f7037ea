//! The geological map and strata on cliffs: facts of pictures of a land in closed form.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::picture_common::on_threads;
use crate::strata_common::{LAND, folded_range};
use glam::DVec2;
use image::RgbaImage;
use orogen::picture::{MapFrame, MapStyle, geological_map, relief_map};
use orogen::rock::preset;
use orogen::slice::Slice;
use orogen::surface::{Raster, Surface};
use orogen::units::Extent;

const SIZE: (usize, usize) = (512, 288);

fn bare() -> MapStyle {
    MapStyle {
        marks: false,
        lettering: false,
        ..MapStyle::default()
    }
}

/// The land without faults and lakes: nothing but rock and light.
fn land(preset: &str) -> Surface {
    let mut surface = folded_range(preset, SIZE.0, SIZE.1);
    surface.faults.clear();
    surface.lake_depth.data.fill(0.0);
    surface
}

/// Linear light of a pixel.
fn light(image: &RgbaImage, x: u32, y: u32) -> [f64; 3] {
    let [red, green, blue, _] = image.get_pixel(x, y).0;
    [red, green, blue].map(|byte| (f64::from(byte) / 255.0).powf(2.2))
}

/// Cosine between two colours: 1 where they differ by their lightness alone.
fn likeness(a: [f64; 3], b: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

/// Each layer's colour on the map: that of a plain in which only it crops out.
fn colours(preset: &str) -> Vec<[f64; 3]> {
    let pile = preset::by_name(preset).unwrap();
    let mut depths = pile.depths().to_vec();
    depths.push(depths[depths.len() - 1] + 200.0);
    depths
        .windows(2)
        .map(|layer| {
            let mut plain = land(preset);
            let mut map = (**plain.strata.as_ref().unwrap()).clone();
            plain.height.data.fill(0.0);
            map.base.data.fill(f64::midpoint(layer[0], layer[1]) as f32);
            map.sediment.data.fill(0.0);
            map.folds.clear();
            plain.strata = Some(map.into());
            let map = geological_map(&plain, &bare(), 64, 36).unwrap();
            light(&map, 32, 18)
        })
        .collect()
}

#[test]
fn the_map_shows_the_layer_that_the_slice_has_at_its_surface() {
    let name = "zagros";
    let surface = land(name);
    let colours = colours(name);
    let map = geological_map(&surface, &bare(), SIZE.0 as u32, SIZE.1 as u32).unwrap();
    let (mut compared, mut seen) = (0, vec![false; colours.len()]);
    for row in [40, 111, 144, 200, 251] {
        let ends = [0, SIZE.0 - 1].map(|column| surface.height.centre(column, row));
        let slice = Slice::cut(&surface, ends, SIZE.0).unwrap();
        let strata = slice.strata.as_ref().unwrap();
        // On borders, which may run along the line too, the map draws a line.
        let above = Slice::cut(&surface, ends.map(|p| p + DVec2::new(0.0, 250.0)), SIZE.0).unwrap();
        let below = Slice::cut(&surface, ends.map(|p| p - DVec2::new(0.0, 250.0)), SIZE.0).unwrap();
        let layer = |slice: &Slice, i: usize| slice.strata.as_ref().unwrap().outcrop[i].layer;
        for i in 2..SIZE.0 - 2 {
            let expected = layer(&slice, i);
            let around = (i - 2..=i + 2).flat_map(|i| [&slice, &above, &below].map(|s| layer(s, i)));
            if strata.sediment[i] > 0.0 || around.into_iter().any(|layer| layer != expected) {
                continue;
            }
            let drawn = light(&map, i as u32, row as u32);
            let like = |k: &usize| likeness(drawn, colours[*k]);
            let nearest = (0..colours.len())
                .max_by(|a, b| like(a).total_cmp(&like(b)))
                .unwrap();
            assert_eq!(nearest, expected, "column {i} of row {row}: {drawn:?}");
            compared += 1;
            seen[expected] = true;
        }
    }
    assert!(compared > 800, "{compared}");
    assert!(seen.iter().filter(|seen| **seen).count() >= 4, "{seen:?}");
}

#[test]
fn loose_sediment_covers_the_rock() {
    let surface = land("zagros");
    let map = geological_map(&surface, &bare(), SIZE.0 as u32, SIZE.1 as u32).unwrap();
    let mut without = surface.clone();
    let mut strata = (**surface.strata.as_ref().unwrap()).clone();
    strata.sediment.data.fill(0.0);
    without.strata = Some(strata.into());
    let rock = geological_map(&without, &bare(), SIZE.0 as u32, SIZE.1 as u32).unwrap();
    assert!(
        map.get_pixel(20, 144) != rock.get_pixel(20, 144),
        "100 m in the west"
    );
    assert_eq!(
        map.get_pixel(256, 144),
        rock.get_pixel(256, 144),
        "none in the middle"
    );
}

#[test]
fn where_no_layers_are_known_there_is_no_map() {
    let mut surface = land("jura");
    surface.strata = None;
    assert!(geological_map(&surface, &bare(), 64, 36).is_none());
}

#[test]
fn cliffs_show_their_rock_and_gentle_land_does_not() {
    let gentle = land("digne");
    // A sixth as wide, it is six times as steep.
    let extent = Extent {
        width: LAND.width / 6.0,
        height: LAND.height / 6.0,
    };
    let mut map = (**gentle.strata.as_ref().unwrap()).clone();
    map.base = map.base.stretched(extent);
    map.sediment = map.sediment.stretched(extent);
    map.folds = map
        .folds
        .into_iter()
        .map(|(i, raise)| (i, raise.stretched(extent)))
        .collect();
    let with = Surface {
        height: gentle.height.stretched(extent),
        lake_depth: gentle.lake_depth.stretched(extent),
        drainage: gentle.drainage.stretched(extent),
        spacing: gentle.spacing / 6.0,
        strata: Some(map.into()),
        ..gentle
    };
    let mut without = with.clone();
    without.strata = None;
    let (width, height) = (SIZE.0 as u32, SIZE.1 as u32);
    let (with_rock, plain) = (
        relief_map(&with, &bare(), width, height),
        relief_map(&without, &bare(), width, height),
    );
    let slope = with.height.slope();
    let (mut steep, mut changed) = (0, 0);
    for (i, &slope) in slope.data.iter().enumerate() {
        let (x, y) = ((i % SIZE.0) as u32, (i / SIZE.0) as u32);
        let differs = with_rock.get_pixel(x, y) != plain.get_pixel(x, y);
        let inside = (8..width - 8).contains(&x) && (8..height - 8).contains(&y);
        if slope > 0.9 && inside {
            steep += 1;
            changed += u32::from(differs);
        }
        if slope < 0.25 && with.height.data[i] < 1200.0 {
            assert!(!differs, "gentle land at {x}, {y}");
        }
    }
    assert!(steep > 100 && changed * 10 > steep * 9, "{changed} of {steep}");
}

#[test]
fn beds_are_drawn_where_they_are_wide_enough() {
    // A plane of 45° through flat layers; its pixels are 60 m or 1 m of height.
    let cliff = |cell: f64| {
        let mut surface = land("digne");
        let extent = Extent {
            width: SIZE.0 as f64 * cell,
            height: SIZE.1 as f64 * cell,
        };
        let scaled = |raster: &Raster, value: &dyn Fn(DVec2) -> f64| {
            Raster::from_fn(raster.width, raster.height, extent, |p| value(p) as f32)
        };
        let mut map = (**surface.strata.as_ref().unwrap()).clone();
        // Through the second layer, whose beds are 100 m thick.
        surface.height = scaled(&surface.height, &|p| p.x - 0.5 * extent.width - 1000.0);
        surface.lake_depth = scaled(&surface.height, &|_| 0.0);
        surface.drainage = surface.lake_depth.clone();
        surface.spacing = cell;
        map.base = surface.lake_depth.clone();
        map.sediment = map.base.clone();
        map.folds.clear();
        surface.strata = Some(map.into());
        relief_map(&surface, &bare(), SIZE.0 as u32, SIZE.1 as u32)
    };
    // Lightness along the middle row, within the layer.
    let contrast = |image: &RgbaImage, columns: std::ops::Range<u32>| {
        let line: Vec<f64> = columns.map(|x| light(image, x, 144)[1]).collect();
        let (low, high) = line
            .iter()
            .fold((f64::MAX, 0.0_f64), |(l, h), &v| (l.min(v), h.max(v)));
        high / low
    };
    let near = contrast(&cliff(10.0), 240..272);
    let far = contrast(&cliff(60.0), 252..260);
    assert!(near > 1.25, "beds of ten pixels: {near}");
    assert!(far < 1.15, "beds of two pixels merge: {far}");
}

#[test]
fn cuts_are_drawn_on_the_map_from_end_to_end() {
    let surface = land("jura");
    let ends = [DVec2::new(10e3, 30e3), DVec2::new(50e3, 8e3)];
    let draw = |cuts: Vec<[DVec2; 2]>| {
        let style = MapStyle { cuts, ..bare() };
        relief_map(&surface, &style, 640, 360)
    };
    let (without, with) = (draw(Vec::new()), draw(vec![ends]));
    let frame = MapFrame::new(LAND, &bare(), 640, 360);
    let [a, b] = ends.map(|end| frame.to_pixel(end));
    let mut changed = 0;
    for (x, y, pixel) in with.enumerate_pixels() {
        if pixel != without.get_pixel(x, y) {
            changed += 1;
            let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let along = (b - a).normalize();
            let off = (p - a).perp_dot(along).abs();
            let near_end = p.distance(a).min(p.distance(b)) < 12.0;
            assert!(off < 4.0 || near_end, "{p} is {off} pixels off the line");
        }
    }
    assert!(changed > 600, "{changed}");
}

#[test]
fn the_same_surface_gives_the_same_map_for_any_number_of_threads() {
    let surface = folded_range("jura", 200, 113);
    let draw = |threads| {
        on_threads(threads, || {
            geological_map(&surface, &MapStyle::default(), 503, 277).unwrap()
        })
    };
    let one = draw(1);
    assert!(one == draw(2) && one == draw(7));
    for (width, height) in [(1, 1), (3, 900), (900, 2)] {
        let map = geological_map(&surface, &MapStyle::default(), width, height).unwrap();
        assert_eq!(map.dimensions(), (width, height));
    }
}
