//! Every writer, read back by other means.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::Cursor;

use crate::picture_common::{Grid, LAND, grid, mountain, on_threads, read_exr, read_glb, read_ply, river};
use glam::{DVec2, Vec3};
use orogen::export::height16::{Height16, Sidecar};
use orogen::export::ply::NodeValues;
use orogen::export::{ExportError, Mesh, OutDir, exr, geojson, glb, ply};
use orogen::surface::{FoldLine, Raster};

fn exr_bytes(width: usize, height: usize, channels: &[(&str, &[f32])]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    exr::write(&mut file, width, height, channels).unwrap();
    file.into_inner()
}

fn mesh(grid: &Grid) -> Mesh<'_> {
    Mesh {
        positions: &grid.positions,
        heights: &grid.heights,
        triangles: &grid.triangles,
    }
}

fn glb_bytes(grid: &Grid, map: Option<&[u8]>) -> Vec<u8> {
    let mut bytes = Vec::new();
    glb::write(&mut bytes, mesh(grid), LAND, map).unwrap();
    bytes
}

#[test]
fn exr_keeps_every_bit_of_its_channels() {
    let heights: Vec<f32> = (0..21).map(|i| (i as f32).exp2() * -1.37).collect();
    let drainage: Vec<f32> = (0..21).map(|i| 1e-30 * i as f32).collect();
    let bytes = exr_bytes(7, 3, &[("height_m", &heights), ("drainage_km2", &drainage)]);
    let (size, channels) = read_exr(&bytes);
    assert_eq!(size, (7, 3));
    assert_eq!(channels.len(), 2);
    assert_eq!(channels["height_m"], heights);
    assert_eq!(channels["drainage_km2"], drainage);
}

#[test]
fn exr_refuses_what_would_not_be_an_image() {
    let four = [0.0; 4];
    let refused = |width, height, channels: &[(&str, &[f32])]| {
        let error = exr::write(Cursor::new(Vec::new()), width, height, channels).unwrap_err();
        error.to_string()
    };
    assert!(refused(2, 3, &[("height_m", &four)]).contains("`height_m`: 4 values for 2 × 3"));
    assert!(refused(2, 2, &[("a", &four), ("a", &four)]).contains("differ"));
    assert!(refused(2, 2, &[("höhe", &four)]).contains("ASCII"));
    assert!(refused(0, 0, &[("a", &[])]).contains("no pixels"));
}

#[test]
fn sixteen_bit_heights_are_within_half_a_step() {
    let heights = Raster::from_fn(33, 17, LAND, |p| mountain(DVec2::new(20e3, 20e3))(p) - 120.0);
    let height16 = Height16::new(&heights).unwrap();

    let (mut png, mut r16, mut json) = (Vec::new(), Vec::new(), Vec::new());
    height16.write_png(&mut png).unwrap();
    height16.write_r16(&mut r16).unwrap();
    height16.write_json(&mut json).unwrap();

    let sidecar: Sidecar = serde_json::from_slice(&json).unwrap();
    assert_eq!((sidecar.width, sidecar.height), (33, 17));
    assert_eq!(sidecar.km_per_pixel, [64.0 / 33.0, 36.0 / 17.0]);
    assert_eq!(
        (sidecar.row_origin.as_str(), sidecar.pixel.as_str()),
        ("north-west", "area")
    );

    let image::DynamicImage::ImageLuma16(image) = image::load_from_memory(&png).unwrap() else {
        panic!("expected 16-bit grey");
    };
    assert_eq!(image.dimensions(), (33, 17));
    let from_r16: Vec<u16> = r16.chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
    assert_eq!(image.as_raw(), &from_r16, "both files hold the same steps");
    assert_eq!(
        (from_r16.iter().min(), from_r16.iter().max()),
        (Some(&0), Some(&65535))
    );

    let step = (sidecar.metres_at_65535 - sidecar.metres_at_0) / 65535.0;
    for (height, steps) in heights.data.iter().zip(&from_r16) {
        let back = sidecar.metres_at_0 + f64::from(*steps) * step;
        assert!((back - f64::from(*height)).abs() <= 0.5 * step + 1e-4);
    }
}

#[test]
fn flat_land_has_a_range_and_a_hole_in_the_land_is_refused() {
    let mut flat = Raster::from_fn(4, 4, LAND, |_| 17.0);
    let height16 = Height16::new(&flat).unwrap();
    assert!(height16.steps.iter().all(|&step| step == 0));
    assert_eq!(
        (height16.sidecar.metres_at_0, height16.sidecar.metres_at_65535),
        (17.0, 18.0)
    );
    flat.data[5] = f32::NAN;
    assert!(
        Height16::new(&flat)
            .unwrap_err()
            .to_string()
            .contains("not a finite number")
    );
}

#[test]
fn ply_holds_what_the_simulation_knows() {
    let grid = grid(5, 4, mountain(DVec2::new(20e3, 20e3)));
    let count = grid.positions.len();
    let drainage: Vec<f64> = (0..count).map(|i| 1e6 + i as f64).collect();
    let uplift: Vec<f64> = (0..count).map(|i| 1e-4 * i as f64).collect();
    let erodibility: Vec<f64> = (0..count).map(|i| 1e-6 + 1e-8 * i as f64).collect();
    let receivers: Vec<u32> = (0..count as u32).map(|i| i.saturating_sub(1)).collect();
    let layers: Vec<u32> = (0..count as u32).map(|i| i % 3).collect();
    let values = NodeValues {
        drainage: &drainage,
        uplift: &uplift,
        receivers: &receivers,
        layers: &layers,
        erodibility: &erodibility,
    };
    let mut bytes = Vec::new();
    ply::write(&mut bytes, mesh(&grid), values).unwrap();
    let read = read_ply(&bytes);
    assert!(read.comments[0].contains("z up"));
    let single = |values: &[f64]| values.iter().map(|&v| f64::from(v as f32)).collect::<Vec<_>>();
    let xs: Vec<f64> = grid.positions.iter().map(|p| p.x).collect();
    let ys: Vec<f64> = grid.positions.iter().map(|p| p.y).collect();
    assert_eq!(read.vertex["x"], single(&xs));
    assert_eq!(read.vertex["y"], single(&ys));
    assert_eq!(read.vertex["z"], single(&grid.heights));
    assert_eq!(read.vertex["area_m2"], single(&drainage));
    assert_eq!(read.vertex["uplift"], single(&uplift));
    assert_eq!(read.vertex["k"], single(&erodibility));
    assert_eq!(
        read.vertex["receiver"][..3],
        [-1.0, 0.0, 1.0],
        "the outlet has none"
    );
    assert_eq!(read.vertex["layer"][..4], [0.0, 1.0, 2.0, 0.0]);
    for (face, corners) in read.faces.iter().zip(&grid.triangles) {
        assert_eq!(face.map(|c| c as u32), *corners);
    }

    let short = NodeValues {
        uplift: &uplift[1..],
        ..values
    };
    let error = ply::write(Vec::new(), mesh(&grid), short).unwrap_err();
    assert!(error.to_string().contains("20 vertices but 19 values of uplift"));
}

#[test]
fn glb_is_a_mesh_other_programs_can_read() {
    let grid = grid(9, 7, mountain(DVec2::new(20e3, 20e3)));
    let map = b"not a real picture".as_slice();
    let bytes = glb_bytes(&grid, Some(map));
    let read = read_glb(&bytes);
    assert_eq!(read.document["asset"]["version"], "2.0");
    assert_eq!(read.document["buffers"][0]["byteLength"], read.binary.len());

    let positions = read.floats::<3>(0);
    for (p, (plan, height)) in positions.iter().zip(grid.positions.iter().zip(&grid.heights)) {
        assert_eq!(*p, [plan.x as f32, *height as f32, -plan.y as f32]);
    }
    let bound = |key: &str, axis: usize| read.document["accessors"][0][key][axis].as_f64().unwrap() as f32;
    for axis in 0..3 {
        let values = || positions.iter().map(|p| p[axis]);
        assert_eq!(bound("min", axis), values().fold(f32::MAX, f32::min));
        assert_eq!(bound("max", axis), values().fold(f32::MIN, f32::max));
    }

    // Faces look up, and so do the normals, which are of unit length.
    let indices = read.indices();
    for corners in indices.chunks(3) {
        let [a, b, c] = std::array::from_fn(|i| Vec3::from(positions[corners[i] as usize]));
        assert!((b - a).cross(c - a).y > 0.0);
    }
    for normal in read.floats::<3>(1) {
        assert!((Vec3::from(normal).length() - 1.0).abs() < 1e-5 && normal[1] > 0.0);
    }
    assert_eq!(read.texture(), Some(map));
    assert_eq!(
        read.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"],
        0
    );
    assert_eq!(read_glb(&glb_bytes(&grid, None)).texture(), None);
}

#[test]
fn a_tilted_plane_has_its_normal_everywhere() {
    let grid = grid(6, 5, |p| (0.3 * p.x - 0.4 * p.y) as f32);
    let expected = Vec3::new(-0.3, 1.0, -0.4).normalize();
    for normal in read_glb(&glb_bytes(&grid, None)).floats::<3>(1) {
        assert!((Vec3::from(normal) - expected).length() < 1e-4, "{normal:?}");
    }
}

#[test]
fn rivers_are_lines_in_kilometres() {
    let rivers = [
        river(
            &[
                DVec2::new(1e3, 35e3),
                DVec2::new(4e3, 31e3),
                DVec2::new(4e3, 26e3),
            ],
            25e6,
        ),
        river(&[DVec2::new(60e3, 0.0), DVec2::new(61e3, 0.0)], 9e6),
    ];
    let mut bytes = Vec::new();
    geojson::write_rivers(&mut bytes, LAND, &rivers).unwrap();
    let read: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(read["type"], "FeatureCollection");
    assert_eq!(read["bbox"], serde_json::json!([0.0, 0.0, 64.0, 36.0]));
    assert!(read["frame"].as_str().unwrap().contains("kilometres"));
    let first = &read["features"][0];
    assert_eq!(first["geometry"]["type"], "LineString");
    assert_eq!(
        first["geometry"]["coordinates"],
        serde_json::json!([[1.0, 35.0], [4.0, 31.0], [4.0, 26.0]])
    );
    assert_eq!(first["properties"]["length_km"], 10.0);
    assert_eq!(
        first["properties"]["drainage_km2"],
        serde_json::json!([25.0, 25.0, 25.0])
    );
    assert_eq!(read["features"].as_array().unwrap().len(), 2);
}

#[test]
fn crests_and_troughs_of_folds_are_lines_with_their_layer() {
    let course = [DVec2::new(1e3, 2e3), DVec2::new(1.5e3, 9123.4)];
    let fold = |crest| FoldLine {
        points: course.to_vec(),
        crest,
        layer: 2,
        wavelength_m: 4321.06,
    };
    let folds = [fold(true), fold(false)];
    let mut bytes = Vec::new();
    geojson::write_folds(&mut bytes, LAND, &folds).unwrap();
    let read: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(read["type"], "FeatureCollection");
    let first = &read["features"][0];
    assert_eq!(
        first["properties"],
        serde_json::json!({"kind": "top", "layer": 2, "wavelength_m": 4321.1})
    );
    assert_eq!(
        first["geometry"],
        serde_json::json!({"type": "LineString", "coordinates": [[1.0, 2.0], [1.5, 9.1234]]})
    );
    assert_eq!(read["features"][1]["properties"]["kind"], "bottom");
}

#[test]
fn equal_input_gives_equal_bytes_on_any_number_of_threads() {
    let grid = grid(40, 30, mountain(DVec2::new(20e3, 20e3)));
    let heights = Raster::from_fn(301, 170, LAND, mountain(DVec2::new(20e3, 20e3)));
    let all = |threads: usize| {
        on_threads(threads, || {
            let mut png = Vec::new();
            Height16::new(&heights).unwrap().write_png(&mut png).unwrap();
            let exr = exr_bytes(
                301,
                170,
                &[("height_m", &heights.data), ("slope", &heights.slope().data)],
            );
            (png, exr, glb_bytes(&grid, None))
        })
    };
    let once = all(1);
    assert!(once == all(1) && once == all(2) && once == all(7));
}

#[test]
fn files_appear_whole_or_not_at_all() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    let out = OutDir::create(folder.path().join("deep/er")).unwrap();
    let path = out.write("a.txt", |file| file.write_all(b"first")).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"first");

    let error = out
        .write("a.txt", |file| {
            file.write_all(&vec![7; 100_000])?;
            Err(std::io::Error::other("the encoder gave up"))
        })
        .unwrap_err();
    assert!(
        error.to_string().contains("a.txt: the encoder gave up"),
        "{error}"
    );
    assert_eq!(std::fs::read(&path).unwrap(), b"first", "the older file stays");
    let left: Vec<_> = std::fs::read_dir(out.path())
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(left, ["a.txt"], "nothing half-written is left");

    out.write("a.txt", |file| file.write_all(b"second")).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"second");
}

#[cfg(unix)]
#[test]
fn written_files_are_readable_as_any_other() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let ordinary = folder.path().join("ordinary");
    std::fs::write(&ordinary, b"").unwrap();
    let written = OutDir::create(folder.path())
        .unwrap()
        .write("a", |_| Ok(()))
        .unwrap();
    let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&written), mode(&ordinary));
}

#[test]
fn a_folder_that_cannot_be_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, b"").unwrap();
    let below = file.join("results");
    let error = OutDir::create(&below).unwrap_err();
    assert!(matches!(&error, ExportError::Folder { folder, .. } if *folder == below));
    assert!(error.to_string().contains(below.to_str().unwrap()), "{error}");
}
