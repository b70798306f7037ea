//! Maps read from files: their values, the rules by which a channel is picked, and what is refused.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::Cursor;
use std::path::PathBuf;

use crate::picture_common::LAND;
use orogen::export::exr;
use orogen::export::height16::Height16;
use orogen::input::maps::{MapFault, MapKind, read_map};
use orogen::surface::Raster;
use orogen::units::Extent;
use proptest::prelude::*;

/// A folder with one file in it.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    fn put(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

fn exr_of(width: usize, height: usize, channels: &[(&str, &[f32])]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    exr::write(&mut file, width, height, channels).unwrap();
    file.into_inner()
}

fn png_of(image: impl Into<image::DynamicImage>) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image.into().write_to(&mut file, image::ImageFormat::Png).unwrap();
    file.into_inner()
}

fn refusal(bytes: &[u8], kind: MapKind) -> String {
    let desk = Desk::new();
    let path = desk.put("map.bin", bytes);
    let message = read_map(&path, kind).unwrap_err().to_string();
    assert!(
        message.starts_with(path.to_str().unwrap()),
        "the file is named: {message}"
    );
    assert!(!message.contains('\n'), "one line: {message}");
    message
}

#[test]
fn exr_values_are_taken_as_they_are_from_the_channel_that_is_meant() {
    let desk = Desk::new();
    let (a, b, c) = ([1.0, 2.0], [-3.0, 4.5], [7.0, 8.0]);
    let read = |channels: &[(&str, &[f32])], kind| {
        let path = desk.put("map.exr", &exr_of(2, 1, channels));
        read_map(&path, kind).unwrap().data
    };
    assert_eq!(read(&[("a", &a), ("height_m", &b)], MapKind::Start), b);
    assert_eq!(read(&[("a", &a), ("land.height_m", &b)], MapKind::Start), b);
    assert_eq!(
        read(&[("height_m", &a), ("uplift_m_per_yr", &b)], MapKind::Uplift),
        b
    );
    assert_eq!(read(&[("A", &a), ("Y", &b)], MapKind::Uplift), b);
    assert_eq!(read(&[("whatever", &b)], MapKind::Uplift), b);
    assert_eq!(
        read(&[("R", &c), ("G", &c), ("B", &c)], MapKind::Start),
        c,
        "grey is exact"
    );
    let coloured = read(
        &[("R", &[1.0, 0.0]), ("G", &[0.0, 1.0]), ("B", &[0.0, 0.0])],
        MapKind::Rain,
    );
    assert_eq!(coloured, [0.2126, 0.7152]);
}

/// Grey values pass through single precision twice.
fn close(values: &[f32], expected: &[f32]) {
    assert_eq!(values.len(), expected.len());
    for (value, expected) in values.iter().zip(expected) {
        assert!(
            (value - expected).abs() <= 2e-7 * expected.abs(),
            "{value} {expected}"
        );
    }
}

#[test]
fn png_black_is_zero_and_white_the_full_scale() {
    let desk = Desk::new();
    let grey16 =
        image::ImageBuffer::<image::Luma<u16>, _>::from_raw(3, 1, vec![0_u16, 13107, 65535]).unwrap();
    let path = desk.put("u.png", &png_of(grey16));
    let uplift = read_map(&path, MapKind::Uplift).unwrap();
    close(&uplift.data, &[0.0, 2e-4, 1e-3]);
    assert_eq!((uplift.width, uplift.height), (3, 1));
    close(
        &read_map(&path, MapKind::Start).unwrap().data,
        &[0.0, 1310.7, 6553.5],
    );
    assert_eq!(read_map(&path, MapKind::Rain).unwrap().data[2], 2.0);

    let grey8 = image::GrayImage::from_raw(2, 1, vec![0, 255]).unwrap();
    assert_eq!(
        read_map(&desk.put("g.png", &png_of(grey8)), MapKind::Protect)
            .unwrap()
            .data,
        [0.0, 1.0]
    );
    let colour = image::RgbaImage::from_raw(2, 1, vec![255, 255, 255, 3, 0, 255, 0, 255]).unwrap();
    let protect = read_map(&desk.put("c.png", &png_of(colour)), MapKind::Protect).unwrap();
    assert_eq!(protect.data, [1.0, 0.7152], "luminance, transparency ignored");
}

#[test]
fn a_start_surface_comes_back_by_its_description() {
    let heights = Raster::from_fn(32, 18, LAND, |p| (0.05 * p.x - 0.03 * p.y - 200.0) as f32);
    let height16 = Height16::new(&heights).unwrap();
    let (mut png, mut json) = (Vec::new(), Vec::new());
    height16.write_png(&mut png).unwrap();
    height16.write_json(&mut json).unwrap();
    let desk = Desk::new();
    let path = desk.put("height16.png", &png);
    let described = desk.put("height16.json", &json);
    let read = read_map(&path, MapKind::Start).unwrap();
    assert!((read.extent.width - LAND.width).abs() < 1e-6 && (read.extent.height - LAND.height).abs() < 1e-6);
    for (a, b) in read.data.iter().zip(&heights.data) {
        assert!((a - b).abs() < 0.05, "{a} {b}");
    }
    assert!(
        read_map(&path, MapKind::Rain).unwrap().extent.width == 32.0,
        "other kinds have no metres"
    );

    let other = String::from_utf8(json)
        .unwrap()
        .replace("\"width\": 32", "\"width\": 31");
    std::fs::write(&described, other).unwrap();
    let error = read_map(&path, MapKind::Start).unwrap_err();
    assert!(
        error.to_string().contains("31 × 18 pixels; expected 32 × 18"),
        "{error}"
    );
    std::fs::write(&described, "{}").unwrap();
    assert!(matches!(
        read_map(&path, MapKind::Start).unwrap_err().fault,
        MapFault::Sidecar { .. }
    ));
}

#[test]
fn maps_lie_over_any_land() {
    let land = Extent {
        width: 10.0,
        height: 5.0,
    };
    let desk = Desk::new();
    let path = desk.put("m.exr", &exr_of(2, 1, &[("height_m", &[0.0, 100.0])]));
    let map = read_map(&path, MapKind::Start).unwrap().stretched(land);
    assert_eq!(map.sample(glam::DVec2::new(5.0, 1.0)), 50.0);
    assert_eq!(map.sample(glam::DVec2::new(9.0, 4.0)), 100.0);
}

#[test]
fn what_is_no_map_is_refused_with_what_was_expected() {
    assert!(
        refusal(b"P5 12 12 255", MapKind::Uplift).contains("expected an EXR or a PNG file, it is neither")
    );
    assert!(refusal(b"", MapKind::Uplift).contains("expected an EXR or a PNG"));
    let exr = exr_of(4, 4, &[("height_m", &[0.5; 16])]);
    assert!(refusal(&exr[..exr.len() / 2], MapKind::Start).contains("expected a complete EXR file"));
    assert!(refusal(&exr[..6], MapKind::Start).contains("expected a complete EXR file"));
    let png = png_of(image::GrayImage::new(9, 9));
    assert!(refusal(&png[..png.len() - 30], MapKind::Start).contains("expected a complete PNG file"));

    let two = refusal(&exr_of(1, 1, &[("a", &[0.5]), ("b", &[0.5])]), MapKind::Uplift);
    assert!(
        two.contains("channels `a`, `b`; expected `uplift_m_per_yr`"),
        "{two}"
    );

    let hole = [0.0, 1.0, f32::NAN, 0.0, 0.0, 0.0];
    let hole = refusal(&exr_of(2, 3, &[("height_m", &hole)]), MapKind::Start);
    assert!(
        hole.contains("NaN at column 0, row 1; expected start height values"),
        "{hole}"
    );
    let endless = refusal(&exr_of(1, 1, &[("height_m", &[f32::INFINITY])]), MapKind::Start);
    assert!(endless.contains("inf at column 0, row 0"), "{endless}");
    let dry = refusal(&exr_of(1, 1, &[("rain", &[-0.5])]), MapKind::Rain);
    assert!(
        dry.contains("-0.5 at column 0, row 0; expected rain values from 0e0"),
        "{dry}"
    );
    let beyond = refusal(&exr_of(1, 1, &[("protect", &[1.5])]), MapKind::Protect);
    assert!(
        beyond.contains("expected protection values from 0e0 to 1e0"),
        "{beyond}"
    );
}

#[test]
fn a_file_that_is_not_there_and_a_folder_are_refused() {
    let desk = Desk::new();
    for path in [desk.folder.path().join("none.exr"), desk.folder.path().to_owned()] {
        let error = read_map(&path, MapKind::Uplift).unwrap_err();
        assert!(matches!(error.fault, MapFault::Unreadable(_)));
        assert!(error.to_string().contains(path.to_str().unwrap()));
    }
}

#[test]
fn sizes_are_checked_before_pixels_are_read() {
    // A PNG header that promises 100,000 × 100,000 pixels.
    let mut png = png_of(image::GrayImage::new(1, 1));
    png[16..20].copy_from_slice(&100_000_u32.to_be_bytes());
    png[20..24].copy_from_slice(&100_000_u32.to_be_bytes());
    let crc = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&crc.to_be_bytes());
    let message = refusal(&png, MapKind::Uplift);
    assert!(
        message.contains("100000 × 100000 pixels of 1 channels; expected 1 to"),
        "{message}"
    );

    // An EXR header whose windows promise the same.
    let mut exr = exr_of(3, 3, &[("height_m", &[0.0; 9])]);
    for name in [
        b"dataWindow\0box2i\0".as_slice(),
        b"displayWindow\0box2i\0".as_slice(),
    ] {
        let at = exr.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
        for far_corner in [at + 8, at + 12] {
            exr[far_corner..far_corner + 4].copy_from_slice(&99_999_i32.to_le_bytes());
        }
    }
    let message = refusal(&exr, MapKind::Start);
    assert!(
        message.contains("100000 × 100000 pixels of 1 channels"),
        "{message}"
    );
}

/// CRC of a PNG chunk (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                (crc >> 1) ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    !crc
}

/// Reading ends in a raster or in a message, and never in anything else.
fn read_any(bytes: &[u8]) {
    let desk = Desk::new();
    let path = desk.put("map", bytes);
    for kind in [MapKind::Start, MapKind::Protect] {
        match read_map(&path, kind) {
            Ok(map) => assert_eq!(map.data.len(), map.width * map.height),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn random_bytes_never_panic(signature in 0..3_usize, bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let signatures: [&[u8]; 3] = [b"", &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0], b"\x89PNG\r\n\x1a\n"];
        read_any(&[signatures[signature], &bytes].concat());
    }

    #[test]
    fn damaged_maps_never_panic(
        is_png: bool,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        keep in any::<prop::sample::Index>(),
    ) {
        let mut bytes = if is_png {
            png_of(image::GrayImage::from_fn(20, 10, |x, y| image::Luma([(x * y) as u8])))
        } else {
            let values: Vec<f32> = (0..200).map(|i| i as f32 * 0.004).collect();
            exr_of(20, 10, &[("height_m", &values), ("protect", &values)])
        };
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        // Now and then the end is torn off.
        let length = if keep.index(4) == 0 { keep.index(bytes.len()) } else { bytes.len() };
        read_any(&bytes[..length]);
    }
}
