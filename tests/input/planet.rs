//! Planets from pairs of images.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::DVec3;
use image::{ImageBuffer, Luma, Rgb};
use orogen::input::planet::{
    Colours, Heights, LEAST_SAMPLES, MAX_PLATES, PlanetMaps, WIDTH_RANGE, read_planet,
};
use orogen::sphere::{Lattice, direction, latitude_longitude};
use proptest::prelude::*;

fn lattice() -> Lattice {
    Lattice::new(10_007).expect("a size within range")
}

/// Direction of a pixel's middle.
fn place(column: u32, row: u32, width: u32) -> DVec3 {
    let degrees = 360.0 / f64::from(width);
    direction(
        90.0 - (f64::from(row) + 0.5) * degrees,
        (f64::from(column) + 0.5) * degrees - 180.0,
    )
}

fn png<P: image::PixelWithColorType>(image: &ImageBuffer<P, Vec<P::Subpixel>>) -> Vec<u8>
where
    [P::Subpixel]: image::EncodableLayout,
{
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, image::ImageFormat::Png)
        .expect("memory takes all");
    bytes.into_inner()
}

fn grey16(width: u32, value: impl Fn(DVec3) -> f64) -> Vec<u8> {
    png(&ImageBuffer::from_fn(width, width / 2, |c, r| {
        Luma([(value(place(c, r, width)) * 65_535.0).round() as u16])
    }))
}

fn colours8(width: u32, colour: impl Fn(DVec3) -> [u8; 3]) -> Vec<u8> {
    png(&ImageBuffer::from_fn(width, width / 2, |c, r| {
        Rgb(colour(place(c, r, width)))
    }))
}

fn exr_heights(width: usize, value: impl Fn(DVec3) -> f32) -> Vec<u8> {
    use exr::prelude::{AnyChannel, AnyChannels, Image, WritableImage as _};
    let pixels = |i| value(place((i % width) as u32, (i / width) as u32, width as u32));
    let data: Vec<f32> = (0..width * width / 2).map(pixels).collect();
    let channel = AnyChannel::new("height_m", exr::prelude::FlatSamples::F32(data));
    let image = Image::from_channels((width, width / 2), AnyChannels::sort(vec![channel].into()));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).expect("memory takes all");
    bytes.into_inner()
}

/// Eight plates: the octants, each in a colour of its own.
fn octant(p: DVec3) -> [u8; 3] {
    [p.x, p.y, p.z].map(|v| if v > 0.0 { 200 } else { 40 })
}

fn octant_number(p: DVec3) -> u16 {
    octant(p)
        .iter()
        .fold(0, |number, &c| 2 * number + u16::from(c == 200))
}

fn hills(p: DVec3) -> f64 {
    0.5 + 0.2 * p.x + 0.1 * (3.0 * p.y).sin() + 0.15 * p.z * p.z
}

fn error_of(result: Result<impl std::fmt::Debug, impl std::fmt::Display>) -> String {
    let error = result.expect_err("refused").to_string();
    assert!(!error.contains('\n') && error.contains("expected"), "{error}");
    error
}

#[test]
fn heights_are_where_they_were_painted() {
    let lattice = lattice();
    for width in [64, 200, 512, 2048] {
        let heights = Heights::decode(&grey16(width, hills), [-8_000.0, 6_000.0]).unwrap();
        // The curvature over a pixel or a cell, whichever is greater, and the step of the file.
        let reach = (std::f64::consts::TAU / f64::from(width)).max(lattice.spacing());
        let tolerance = 14_000.0 * (reach * reach + 1.0 / 65_535.0);
        for (&p, &z) in lattice.points().iter().zip(&heights.on(&lattice)) {
            let expected = -8_000.0 + 14_000.0 * hills(p);
            assert!(
                (f64::from(z) - expected).abs() < tolerance,
                "{z} for {expected} at {p}, {width}"
            );
        }
    }
}

#[test]
fn exr_heights_are_metres() {
    let lattice = lattice();
    let bytes = exr_heights(360, |p| (-4_000.0 + 8_000.0 * hills(p)) as f32);
    let heights = Heights::decode(&bytes, [0.0, 0.0]).unwrap().on(&lattice);
    for (&p, &z) in lattice.points().iter().zip(&heights) {
        assert!((f64::from(z) - (-4_000.0 + 8_000.0 * hills(p))).abs() < 10.0);
    }
}

#[test]
fn a_fine_image_is_averaged_not_picked_from() {
    let lattice = Lattice::new(1_000).unwrap();
    // A chequerboard of single pixels is grey from afar.
    let image = ImageBuffer::from_fn(2048, 1024, |c, r| {
        Luma([if (c + r) % 2 == 0 { 0_u8 } else { 255 }])
    });
    let heights = Heights::decode(&png(&image), [0.0, 1_000.0]).unwrap();
    assert!(heights.on(&lattice).iter().all(|z| (z - 500.0).abs() < 20.0));
}

#[test]
fn each_colour_is_a_plate() {
    let lattice = lattice();
    let plate = Colours::decode(&colours8(512, octant))
        .unwrap()
        .on(&lattice)
        .unwrap();
    let pixel = std::f64::consts::TAU / 512.0;
    for (&p, &number) in lattice.points().iter().zip(&plate) {
        let from_edge = p.x.abs().min(p.y.abs()).min(p.z.abs());
        assert!(from_edge < pixel || number == octant_number(p), "{p}");
    }
}

#[test]
fn exr_colours_are_plates_as_png_colours_are() {
    let lattice = lattice();
    let plain = ImageBuffer::from_fn(256, 128, |c, r| {
        Rgb(octant(place(c, r, 256)).map(|v| f32::from(v) / 255.0))
    });
    let mut bytes = std::io::Cursor::new(Vec::new());
    plain.write_to(&mut bytes, image::ImageFormat::OpenExr).unwrap();
    let from_exr = Colours::decode(&bytes.into_inner())
        .unwrap()
        .on(&lattice)
        .unwrap();
    let from_png = Colours::decode(&colours8(256, octant))
        .unwrap()
        .on(&lattice)
        .unwrap();
    assert_eq!(from_exr, from_png);
}

#[test]
fn smoothed_edges_are_no_plates() {
    let lattice = lattice();
    // Each pixel the mean of sixteen places in it.
    let width = 360;
    let fine = |c: u32, r: u32| {
        let mut sum = [0_u32; 3];
        for k in 0..16 {
            let colour = octant(place(4 * c + k % 4, 4 * r + k / 4, 4 * width));
            for (sum, value) in sum.iter_mut().zip(colour) {
                *sum += u32::from(value);
            }
        }
        Rgb(sum.map(|v| (v / 16) as u8))
    };
    // Half a pixel off, so that edges run through pixels.
    let smooth = ImageBuffer::from_fn(width, width / 2, |c, r| {
        let mix = |a: Rgb<u8>, b: Rgb<u8>| Rgb([0, 1, 2].map(|k| u8::midpoint(a.0[k], b.0[k])));
        mix(fine(c, r), fine((c + 1) % width, r))
    });
    let colours: BTreeSet<[u8; 3]> = smooth.pixels().map(|p| p.0).collect();
    assert!(colours.len() > 8, "edges are smoothed");
    let plate = Colours::decode(&png(&smooth)).unwrap().on(&lattice).unwrap();
    assert_eq!(plate.iter().copied().collect::<BTreeSet<u16>>().len(), 8);
    let pixel = std::f64::consts::TAU / f64::from(width);
    for (&p, &number) in lattice.points().iter().zip(&plate) {
        let from_edge = p.x.abs().min(p.y.abs()).min(p.z.abs());
        assert!(
            from_edge < 2.0 * pixel + lattice.spacing() || number == octant_number(p),
            "{p}"
        );
    }
}

#[test]
fn a_stray_speck_joins_the_plate_around_it() {
    let lattice = lattice();
    // About five samples, and about fifty.
    let with_speck = |degrees: f64| {
        let speck = direction(20.0, 60.0);
        colours8(720, move |p| {
            if p.dot(speck) > degrees.to_radians().cos() {
                [255, 255, 255]
            } else {
                octant(p)
            }
        })
    };
    let plate = Colours::decode(&with_speck(1.5)).unwrap().on(&lattice).unwrap();
    assert_eq!(plate.iter().max(), Some(&7));
    let plate = Colours::decode(&with_speck(8.0)).unwrap().on(&lattice).unwrap();
    assert_eq!(plate.iter().max(), Some(&8));
    let samples = plate.iter().filter(|&&number| number == 8).count();
    assert!(samples >= LEAST_SAMPLES);
    for (&p, &number) in lattice.points().iter().zip(&plate) {
        let (latitude, longitude) = latitude_longitude(p);
        assert!(number != 8 || (latitude - 20.0).abs() < 9.0 && (longitude - 60.0).abs() < 10.0);
    }
}

#[test]
fn bad_images_are_refused_in_one_line() {
    let lattice = Lattice::new(2_000).unwrap();
    let flat = |width: u32, height: u32| png(&ImageBuffer::from_pixel(width, height, Luma([9_u8])));
    for (width, height) in [(64, 64), (64, 31), (16, 8), (1, 1)] {
        assert!(error_of(Heights::decode(&flat(width, height), [0.0, 1.0])).contains("twice as wide"));
        assert!(error_of(Colours::decode(&flat(width, height))).contains("twice as wide"));
    }
    let wide = *WIDTH_RANGE.end() as u32 + 2;
    assert!(error_of(Colours::decode(&flat(wide, wide / 2))).contains(&wide.to_string()));
    for metres in [[f64::NAN, 0.0], [0.0, f64::INFINITY], [-1e5, 0.0]] {
        assert!(error_of(Heights::decode(&flat(64, 32), metres)).contains("black"));
    }
    assert!(error_of(Heights::decode(b"", [0.0, 1.0])).contains("EXR or a PNG"));
    let whole = flat(64, 32);
    error_of(Heights::decode(&whole[..whole.len() / 2], [0.0, 1.0]));
    error_of(Colours::decode(&whole[..whole.len() / 2]));
    for wrong in [f32::NAN, f32::INFINITY, 12_500.0] {
        let bytes = exr_heights(64, |p| if p.z > 0.9 { wrong } else { 0.0 });
        assert!(error_of(Heights::decode(&bytes, [0.0, 1.0])).contains("row 0"));
    }
    let noise = ImageBuffer::from_fn(256, 128, |c, r| {
        Rgb([(c % 256) as u8, r as u8, (c * r % 251) as u8])
    });
    assert!(error_of(Colours::decode(&png(&noise)).unwrap().on(&lattice)).contains("plate"));
}

#[test]
fn too_many_colours_are_counted() {
    let lattice = Lattice::new(40_000).unwrap();
    let squares = ImageBuffer::from_fn(1_024, 512, |c, r| Rgb([(c / 32) as u8, (r / 32) as u8, 7]));
    let error = error_of(Colours::decode(&png(&squares)).unwrap().on(&lattice));
    assert!(error.contains(&format!("at most {MAX_PLATES}")), "{error}");
}

#[test]
fn files_are_named_in_errors_and_sizes_may_differ() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let lattice = Lattice::new(5_000).unwrap();
    let (heights, plates) = (
        file("heights.png", &grey16(128, hills)),
        file("plates.png", &colours8(300, octant)),
    );
    let square = file("square.png", &png(&ImageBuffer::from_pixel(64, 64, Luma([1_u8]))));
    let metres = [-8_000.0, 6_000.0];
    let PlanetMaps { elevation_m, plate } = read_planet(&heights, &plates, metres, &lattice).unwrap();
    assert_eq!((elevation_m.len(), plate.len()), (5_000, 5_000));
    assert_eq!(plate.iter().max(), Some(&7));
    assert!(error_of(read_planet(&square, &plates, metres, &lattice)).contains("square.png"));
    assert!(error_of(read_planet(&heights, &square, metres, &lattice)).contains("square.png"));
    let missing = read_planet(Path::new("nowhere.png"), &plates, metres, &lattice).unwrap_err();
    assert!(missing.to_string().contains("nowhere.png"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Plates around random places: every sample gets one, none is empty, and away from edges it is the painted one.
    #[test]
    fn any_plates_come_out_as_painted(
        centres in proptest::collection::vec((-1.0..1.0, -1.0..1.0, -1.0..1.0), 1..30),
        half_width in 60_u32..400,
    ) {
        let lattice = Lattice::new(3_000).unwrap();
        let centres: Vec<DVec3> = centres.into_iter().map(|c| DVec3::from(c).try_normalize().unwrap_or(DVec3::Z)).collect();
        let cosines = |p: DVec3| {
            let mut cosines: Vec<(f64, usize)> = centres.iter().map(|c| c.dot(p)).zip(0..).collect();
            cosines.sort_by(|a, b| b.0.total_cmp(&a.0));
            cosines
        };
        // Three primes, so that all colours differ.
        let colour = |k: usize| [(k * 7 % 256) as u8, (k * 31 % 256) as u8, (k * 101 % 256) as u8];
        let width = 2 * half_width;
        let colours = Colours::decode(&colours8(width, |p| colour(cosines(p)[0].1))).unwrap();
        let plate = colours.on(&lattice).unwrap();
        prop_assert_eq!(plate.len(), lattice.len());
        let count = plate.iter().max().unwrap() + 1;
        let mut painted = vec![BTreeSet::new(); count as usize];
        let margin = std::f64::consts::TAU / f64::from(width) + lattice.spacing();
        for (&p, &number) in lattice.points().iter().zip(&plate) {
            let near = cosines(p);
            // Distance to the border of the two nearest centres, about.
            let inside = near.len() == 1 || (near[0].0 - near[1].0) > 2.0 * margin;
            painted[number as usize].insert(if inside { near[0].1 } else { usize::MAX });
        }
        for kinds in painted {
            prop_assert!(!kinds.is_empty());
            prop_assert!(kinds.iter().filter(|&&k| k != usize::MAX).count() <= 1);
        }
    }
}
