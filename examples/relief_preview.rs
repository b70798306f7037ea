//! Draws the relief map of a range that rose between two hands, to judge the map's looks without the sculpting half.
//!
//! `cargo run --release --example relief_preview -- OUT.png [NODES] [WIDTHxHEIGHT] [EXAGGERATION] [MYR]`

use std::error::Error;

use glam::DVec2;
use orogen::picture::{MapStyle, relief_map};
use orogen::surface::rivers::{FlowGraph, drawn};
use orogen::surface::{FaultTrace, PlateMark, PlateState, Raster, Surface};
use orogen::terrain::{Erosion, ErosionParams, Forcing, StartLand, Tin, TinRaster};
use orogen::units::{Extent, KM, MYR};

const LAND: Extent = Extent {
    width: 178.0 * KM,
    height: 100.0 * KM,
};

/// Years a step.
const DT_YR: f64 = 50e3;

/// Rivers on the map begin at this drainage area, m².
const RIVER_AREA: f64 = 15.0 * KM * KM;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let out = arguments.next().unwrap_or_else(|| "relief.png".to_owned());
    let nodes = arguments.next().map_or(Ok(60_000), |n| n.parse())?;
    let size = arguments.next().unwrap_or_else(|| "1920x1080".to_owned());
    let (width, height) = size.split_once('x').ok_or("expected WIDTHxHEIGHT")?;
    let (width, height): (u32, u32) = (width.parse()?, height.parse()?);
    let vertical_exaggeration = arguments.next().map_or(Ok(1.0), |x| x.parse())?;
    let elapsed_yr = arguments.next().map_or(Ok(5.0), |x| x.parse::<f64>())? * MYR;

    let surface = range(nodes, elapsed_yr, width as usize, height as usize)?;
    let style = MapStyle {
        title: "Two hands push".to_owned(),
        vertical_exaggeration,
        ..MapStyle::default()
    };
    relief_map(&surface, &style, width, height).save(out)?;
    Ok(())
}

/// Uplift between the hands, m/yr: a belt across the push, bent and folded, that dies out at its ends.
fn uplift(p: DVec2) -> f64 {
    let from_centre = p - LAND.size() / 2.0;
    let across = from_centre.x + 5.0 * KM * (from_centre.y / (17.0 * KM)).sin();
    let along = (from_centre.y / (46.0 * KM)).abs().min(1.0);
    let half_width = 19.0 * KM * (1.0 - along.powi(3)).sqrt();
    let belt = (1.0 - (across / half_width.max(1.0)).powi(2)).max(0.0);
    let folds = 1.0 + 0.25 * (std::f64::consts::TAU * across / (8.0 * KM)).cos();
    1.1e-3 * belt.powf(0.7) * folds
}

fn range(nodes: usize, elapsed_yr: f64, width: usize, height: usize) -> Result<Surface, Box<dyn Error>> {
    let tin = Tin::poisson(LAND, nodes, 7)?;
    let rates: Vec<f64> = tin.positions().iter().map(|&p| uplift(p)).collect();
    let params = ErosionParams {
        k: 1.1e-6,
        ..ErosionParams::default()
    };
    let mut z = StartLand::new(7).heights(&tin);
    let mut erosion = Erosion::new(&tin);
    for _ in 0..(elapsed_yr / DT_YR).ceil() as usize {
        erosion.step(&tin, &mut z, &Forcing::uplift(&rates), &params, DT_YR);
    }

    let depth: Vec<f64> = erosion
        .water_level(&z)
        .iter()
        .zip(&z)
        .map(|(w, z)| w - z)
        .collect();
    let receivers: Vec<u32> = erosion.receivers().iter().map(|receiver| receiver.0).collect();
    let graph = FlowGraph {
        positions: tin.positions(),
        receivers: &receivers,
        drainage: erosion.drainage(),
        lake: &depth.iter().map(|&d| d > 0.5).collect::<Vec<_>>(),
    };
    let pixels = TinRaster::new(&tin, width, height);
    let raster = |data| Raster {
        width,
        height,
        extent: LAND,
        data,
    };
    Ok(Surface {
        height: raster(pixels.smooth(&tin, &z)),
        lake_depth: raster(pixels.linear(&depth)),
        drainage: raster(pixels.linear(erosion.drainage())),
        spacing: tin.spacing(),
        rivers: drawn(graph, RIVER_AREA),
        plates: vec![
            plate(52.0 * KM, 0.0, PlateState::Resting),
            plate(128.0 * KM, -16.0 * KM, PlateState::Pushing),
        ],
        faults: vec![fault()],
        folds: Vec::new(),
        strata: None,
        elapsed_yr,
    })
}

/// A hand of four fingers that moves `push` metres east.
fn plate(x: f64, push: f64, state: PlateState) -> PlateMark {
    let fingers =
        [(0.0, 24.0), (5.0, 41.0), (4.0, 59.0), (-2.0, 76.0)].map(|(dx, y)| DVec2::new(x + dx * KM, y * KM));
    let centre = DVec2::new(x, 50.0 * KM);
    let rim = |i: i32| {
        centre + DVec2::from_angle(f64::from(i) * 0.1 * std::f64::consts::PI) * DVec2::new(13.0, 36.0) * KM
    };
    PlateMark {
        hull: (0..20).map(rim).collect(),
        arrows: fingers.map(|f| (f, f + DVec2::new(push, 0.0))).to_vec(),
        spent: 0.3,
        state,
        cap: None,
    }
}

/// The fault on the pushed side of the belt, from south to north.
fn fault() -> FaultTrace {
    let at = |i: i32| {
        let y = f64::from(i) * 2.0 * KM;
        DVec2::new(
            LAND.width / 2.0 + 20.0 * KM - 5.0 * KM * (y / (17.0 * KM)).sin(),
            y,
        )
    };
    FaultTrace {
        points: (6..=44).map(at).collect(),
        range_on_left: true,
    }
}
