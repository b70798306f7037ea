//! Draws slice and maps of a folded range that rivers have cut, to judge their looks without the sculpting half.
//!
//! `cargo run --example strata_preview -- FOLDER [PRESET] [NODES] [WIDTH] [X0,Y0,X1,Y1]`

use std::error::Error;
use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use orogen::export::svg;
use orogen::picture::{MapStyle, geological_map, paint_figure, relief_map};
use orogen::rock::{Column, MAX_LAYERS, Stratigraphy, preset};
use orogen::slice::{FigureOptions, Label, Slice, parse_ends};
use orogen::surface::{FaultTrace, Raster, StrataMap, Surface};
use orogen::survey::{Ground, Survey};
use orogen::terrain::{Erosion, ErosionParams, Forcing, StartLand, Tin};
use orogen::units::{Extent, KM};

const LAND: Extent = Extent {
    width: 178.0 * KM,
    height: 100.0 * KM,
};

/// Years a step, and steps.
const DT_YR: f64 = 50e3;
const STEPS: usize = 90;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = std::path::PathBuf::from(arguments.next().ok_or("expected a folder")?);
    std::fs::create_dir_all(&folder)?;
    let name = arguments.next().unwrap_or_else(|| "jura".to_owned());
    let nodes = arguments.next().map_or(Ok(60_000), |n| n.parse())?;
    let width: u32 = arguments.next().map_or(Ok(1920), |n| n.parse())?;
    let ends = parse_ends(&arguments.next().unwrap_or_else(|| "30,50,150,50".to_owned()))?;
    let pile = preset::by_name(&name).ok_or("no such preset")?;

    let surface = range(&pile, nodes, width as usize)?;
    let style = MapStyle {
        title: pile.title().to_owned(),
        cuts: vec![ends],
        ..MapStyle::default()
    };
    let height = (f64::from(width) * LAND.height / LAND.width).round() as u32;
    relief_map(&surface, &style, width, height).save(folder.join("picture.png"))?;

    let wide = (1.17 * f64::from(width)) as u32;
    geological_map(&surface, &style, wide, height)
        .ok_or("no layers")?
        .save(folder.join("geology.png"))?;

    let slice = Slice::cut(&surface, ends, 1200)?;
    let options = FigureOptions {
        title: pile.title().to_owned(),
        labels: vec![Label {
            distance: slice.length() * 0.45,
            text: "Crest & valley".to_owned(),
        }],
        ..FigureOptions::default()
    };
    let figure = slice.figure(DVec2::new(f64::from(width), f64::from(height)), &options);
    paint_figure(&figure).save(folder.join("slice.png"))?;
    svg::write(std::fs::File::create(folder.join("slice.svg"))?, &figure)?;
    Ok(())
}

/// Speed of the whole pile, m/yr: a belt across the push that dies out at its ends.
fn rise(p: DVec2) -> f64 {
    let at = p - LAND.size() / 2.0;
    let across = at.x + 5.0 * KM * (at.y / (17.0 * KM)).sin();
    let along = (at.y / (46.0 * KM)).abs().min(1.0);
    let half = (22.0 * KM * (1.0 - along.powi(3)).sqrt()).max(1.0);
    0.9e-3 * (1.0 - (across / half).powi(2)).max(0.0).powf(0.8)
}

/// Part of that speed by which the folding layers rise more: waves along the belt.
fn fold(p: DVec2, wavelength: f64) -> f64 {
    let across = p.x + 5.0 * KM * (p.y / (17.0 * KM)).sin() + 1.2 * KM * (p.y / (9.0 * KM)).cos();
    (0.5 + 0.5 * (TAU * across / wavelength).cos()).powf(1.5)
}

fn range(pile: &Arc<Stratigraphy>, nodes: usize, width: usize) -> Result<Surface, Box<dyn Error>> {
    let tin = Tin::poisson(LAND, nodes, 7)?;
    let folding: Vec<(usize, f64, f64)> = pile
        .folding()
        .map(|interface| {
            let layer = &pile.layers()[interface - 1];
            (interface, layer.fold, layer.wavelength_m.unwrap_or(4.0 * KM))
        })
        .collect();
    let rates: Vec<(f64, [f64; MAX_LAYERS + 1])> = tin
        .positions()
        .iter()
        .map(|&p| {
            let mut folds = [0.0; MAX_LAYERS + 1];
            for &(interface, share, wavelength) in &folding {
                folds[interface] = share * rise(p) * fold(p, wavelength);
            }
            (rise(p), folds)
        })
        .collect();
    let column = |node: usize, years: f64| {
        let (base, folds) = &rates[node];
        let column = Column::new(pile, base * years);
        (1..folds.len()).fold(column, |column, i| column.folded(i, folds[i] * years))
    };
    let mut z = StartLand::new(7).heights(&tin);
    let start = z.clone();
    let mut erosion = Erosion::new(&tin);
    let params = ErosionParams {
        k: 1.1e-6,
        ..ErosionParams::default()
    };
    let depth = |node: usize, z: f64, years: f64| column(node, years).depth_at(z - start[node]);
    for step in 0..STEPS {
        let years = step as f64 * DT_YR;
        let depths: Vec<f64> = (0..tin.len()).map(|i| depth(i, z[i], years)).collect();
        let uplift: Vec<f64> = (0..tin.len())
            .map(|i| rates[i].0 + column(i, years).fold_rate(depths[i], &rates[i].1))
            .collect();
        let rock = |i: usize| pile.bed_rock(pile.place(depths[i]));
        let erodibility: Vec<f64> = (0..tin.len()).map(|i| rock(i).erodibility).collect();
        let talus: Vec<f64> = (0..tin.len()).map(|i| rock(i).talus).collect();
        let forcing = Forcing {
            erodibility: Some(&erodibility),
            talus: Some(&talus),
            ..Forcing::uplift(&uplift)
        };
        erosion.step(&tin, &mut z, &forcing, &params, DT_YR);
    }
    let years = STEPS as f64 * DT_YR;

    let mut survey = Survey::new(&tin, width);
    let ground = Ground {
        tin: &tin,
        z: &z,
        flow: erosion.flow(),
    };
    let mut surface = survey.surface(ground, years);
    let sample = |values: Vec<f64>| Raster {
        data: survey.raster().linear(&values),
        ..surface.height.clone()
    };
    let node = |value: &dyn Fn(usize) -> f64| sample((0..tin.len()).map(value).collect());
    let plain = |p: DVec2| ((p.x - 0.62 * LAND.width) / (30.0 * KM)).clamp(0.0, 1.0);
    let strata = StrataMap {
        stratigraphy: Arc::clone(pile),
        base: node(&|i| rates[i].0 * years + start[i]),
        folds: folding
            .iter()
            .map(|&(interface, ..)| (interface, node(&|i| rates[i].1[interface] * years)))
            .collect(),
        sediment: node(&|i| {
            let p = tin.positions()[i];
            250.0 * plain(p) * (1.0 - plain(p)) * 4.0 * (1.0 - z[i] / 300.0).clamp(0.0, 1.0)
        }),
        root: node(&|i| {
            let across = (tin.positions()[i].x - LAND.width / 2.0) / (28.0 * KM);
            7.0 * KM * (-across * across).exp()
        }),
        depth: node(&|i| depth(i, z[i], years)),
    };
    surface.strata = Some(Arc::new(strata));
    surface.faults = vec![FaultTrace {
        points: (6..=44)
            .map(|i| {
                let y = f64::from(i) * 2.0 * KM;
                DVec2::new(
                    LAND.width / 2.0 + 20.0 * KM - 5.0 * KM * (y / (17.0 * KM)).sin(),
                    y,
                )
            })
            .collect(),
        range_on_left: true,
    }];
    Ok(surface)
}
