//! The files of a computed land, the same for `replay` and `erode`.

use std::collections::BTreeMap;
use std::io::{self, Cursor, Write};
use std::time::Instant;

use cpu_time::ProcessTime;
use glam::DVec2;
use image::{ImageFormat, RgbaImage};
use serde::Serialize;

use super::PictureChoice;
use super::failure::Failure;
#[cfg(feature = "app")]
use super::render;
use super::slice;
use crate::export::height16::Height16;
use crate::export::{Mesh, OutDir, exr, geojson, glb, ply};
use crate::gesture::contact::Side;
use crate::picture::{MapStyle, geological_map, relief_map};
use crate::sim::Sim;
use crate::slice::clipped;
use crate::surface::rivers::{self, River};
use crate::surface::{Cut, FaultTrace, FoldLine, PlateMark, Surface};
use crate::survey::{Ground, Survey, Underground, Water};
use crate::terrain::{Flow, Tin};
use crate::units::{Extent, KM};

/// Drainage area from which a stream counts as a river in `rivers.geojson`, m².
const RIVER_AREA: f64 = 10.0 * KM * KM;

/// How long the parts of a run took.
#[derive(Debug)]
pub(super) struct Timings {
    wall: Instant,
    cpu: ProcessTime,
    laps: BTreeMap<String, Lap>,
}

/// One part of a run.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Lap {
    wall_ms: f64,
    cpu_ms: f64,
}

impl Timings {
    pub(super) fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu: ProcessTime::now(),
            laps: BTreeMap::new(),
        }
    }

    /// Ends a part, and begins the next.
    pub(super) fn lap(&mut self, name: &str) {
        let lap = Lap {
            wall_ms: self.wall.elapsed().as_secs_f64() * 1e3,
            cpu_ms: self.cpu.elapsed().as_secs_f64() * 1e3,
        };
        self.laps.insert(name.to_owned(), lap);
        self.wall = Instant::now();
        self.cpu = ProcessTime::now();
    }

    pub(super) fn finish(self) -> BTreeMap<String, Lap> {
        self.laps
    }
}

/// The pictures that a run draws, and what it needs for them: known before the work, so that nobody waits in vain.
pub(super) struct Pictures {
    choice: PictureChoice,
    slices: Vec<[DVec2; 2]>,
    #[cfg(feature = "app")]
    gpu: Option<std::sync::Arc<crate::gpu::Gpu>>,
}

impl Pictures {
    /// Also draws slices between these ends, plan metres.
    pub(super) fn with_slices(mut self, slices: &[[DVec2; 2]]) -> Self {
        self.slices = slices.to_vec();
        self
    }

    /// The same pictures without slices, for another land.
    pub(super) fn without_slices(&self) -> Self {
        Self {
            choice: self.choice,
            slices: Vec::new(),
            #[cfg(feature = "app")]
            gpu: self.gpu.clone(),
        }
    }

    /// Fails where the rendered picture alone is wanted and nothing can draw it; warns where the map is drawn as well.
    #[cfg_attr(
        not(feature = "app"),
        expect(
            clippy::unnecessary_wraps,
            reason = "the map needs nothing that could be missing"
        )
    )]
    pub(super) fn new(choice: PictureChoice) -> Result<Self, Failure> {
        Ok(Self {
            choice,
            slices: Vec::new(),
            #[cfg(feature = "app")]
            gpu: render::adapter(choice)?.map(std::sync::Arc::new),
        })
    }

    /// All slices of a run: those asked for, then those people looked at, where they meet the `land`.
    fn cuts(&self, looked_at: &[Cut], land: Extent) -> Result<Vec<Cut>, Failure> {
        let asked = slice::on_land(&self.slices, land)?.into_iter().map(|ends| Cut {
            ends,
            frozen: false,
            notes: Vec::new(),
        });
        let seen = looked_at.iter().filter_map(|cut| {
            let ends = clipped(cut.ends, land).ok()?;
            Some(Cut { ends, ..cut.clone() })
        });
        Ok(asked.chain(seen).collect())
    }
}

/// What stands and lies on the land.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    pub(super) plates: Vec<PlateMark>,
    pub(super) faults: Vec<FaultTrace>,
    pub(super) folds: Vec<FoldLine>,
    /// Cross-sections that people looked at.
    pub(super) cuts: Vec<Cut>,
}

/// A land on its nodes, ready to be written.
pub(super) struct LandFiles<'a> {
    pub(super) title: &'a str,
    pub(super) tin: &'a Tin,
    pub(super) z: &'a [f64],
    /// m/yr.
    pub(super) uplift: &'a [f64],
    /// Water over `z`.
    pub(super) flow: &'a Flow,
    /// Stream-power k at each node.
    pub(super) k: &'a [f64],
    pub(super) marks: Marks,
    /// The layers under it.
    pub(super) under: Option<Underground<'a>>,
    pub(super) elapsed_yr: f64,
}

impl LandFiles<'_> {
    /// Writes picture, height maps, meshes and rivers into `out`, each file whole or not at all.
    pub(super) fn write(
        self,
        out: &OutDir,
        size: u32,
        pictures: &Pictures,
        timings: &mut Timings,
    ) -> Result<(), Failure> {
        let title = self.title.to_owned();
        let cuts = pictures.cuts(&self.marks.cuts, self.tin.extent())?;
        let (tin, z, uplift, flow, k) = (self.tin, self.z, self.uplift, self.flow, self.k);
        let water = Water::new(self.ground());
        let rivers = rivers::trace(water.graph(self.ground()), RIVER_AREA);
        let mut survey = Survey::new(tin, size as usize);
        let uplift_map = survey.raster().linear(uplift);
        let surface = self.surface(&mut survey);
        timings.lap("rasters");

        let texture = if pictures.choice.has_map() {
            let style = MapStyle {
                title: title.clone(),
                cuts: cuts.iter().map(|cut| cut.ends).collect(),
                ..MapStyle::default()
            };
            let png = map_png(&surface, &style)?;
            out.write("picture.png", |w| w.write_all(&png))
                .map_err(Failure::other)?;
            write_geology(out, &surface, &style)?;
            // The mesh wears the land alone, to the edge.
            let bare = MapStyle {
                marks: false,
                lettering: false,
                ..MapStyle::default()
            };
            Some(map_png(&surface, &bare)?)
        } else {
            None
        };
        #[cfg(feature = "app")]
        if let Some(gpu) = &pictures.gpu {
            render::write(gpu, &surface, out)?;
        }
        timings.lap("picture");
        slice::write(out, &surface, &cuts, &title, size)?;
        timings.lap("slices");

        write_height_maps(out, &surface, &uplift_map)?;
        timings.lap("height_maps");
        let mesh = Mesh {
            positions: tin.positions(),
            heights: z,
            triangles: tin.triangles(),
        };
        let values = ply::NodeValues {
            drainage: flow.drainage(),
            uplift,
            receivers: water.receivers(),
            layers: &node_layers(&surface, tin, z),
            erodibility: k,
        };
        out.write("terrain.ply", |w| ply::write(w, mesh, values))
            .map_err(Failure::other)?;
        out.write("terrain.glb", |w| {
            glb::write(w, mesh, tin.extent(), texture.as_deref())
        })
        .map_err(Failure::other)?;
        write_rivers(out, tin, &rivers)?;
        if surface.strata.is_some() {
            out.write("folds.geojson", |w| {
                geojson::write_folds(w, tin.extent(), &surface.folds)
            })
            .map_err(Failure::other)?;
        }
        timings.lap("meshes");
        Ok(())
    }

    fn ground(&self) -> Ground<'_> {
        Ground {
            tin: self.tin,
            z: self.z,
            flow: self.flow,
        }
    }

    fn surface(self, survey: &mut Survey) -> Surface {
        let mut bare = survey.surface(self.ground(), self.elapsed_yr);
        if let Some(under) = &self.under {
            survey.draw_layers(under, &mut bare);
        }
        Surface {
            plates: self.marks.plates,
            faults: self.marks.faults,
            folds: self.marks.folds,
            ..bare
        }
    }
}

fn map_png(surface: &Surface, style: &MapStyle) -> Result<Vec<u8>, Failure> {
    let map = relief_map(
        surface,
        style,
        surface.height.width as u32,
        surface.height.height as u32,
    );
    png(&map)
}

pub(super) fn png(image: &RgbaImage) -> Result<Vec<u8>, Failure> {
    let mut png = Cursor::new(Vec::new());
    image
        .write_to(&mut png, ImageFormat::Png)
        .map_err(Failure::other)?;
    Ok(png.into_inner())
}

/// The geological map, where the layers are known; its land is as large as that of the picture.
fn write_geology(out: &OutDir, surface: &Surface, style: &MapStyle) -> Result<(), Failure> {
    /// Width of map and key against that of the map.
    const WITH_KEY: f64 = 1.17;
    let (width, height) = (surface.height.width, surface.height.height as u32);
    let wide = (width as f64 * WITH_KEY).round() as u32;
    let Some(map) = geological_map(surface, style, wide, height) else {
        return Ok(());
    };
    let png = png(&map)?;
    out.write("geology.png", |w| w.write_all(&png))
        .map(drop)
        .map_err(Failure::other)
}

/// The layer at the surface of each node, 0 where the layers are not known.
fn node_layers(surface: &Surface, tin: &Tin, z: &[f64]) -> Vec<u32> {
    let Some(strata) = surface.strata.as_deref() else {
        return vec![0; tin.len()];
    };
    let nodes = tin.positions().iter().zip(z);
    nodes
        .map(|(&p, &z)| strata.stratigraphy.place(strata.exposed_depth(p, z)).layer as u32)
        .collect()
}

/// The layers on the cells of the heights: layer at the surface, its depth before folding, sediment on it.
fn strata_channels(surface: &Surface) -> Option<[(&'static str, Vec<f32>); 3]> {
    let strata = surface.strata.as_deref()?;
    let height = &surface.height;
    let cells = (0..height.data.len()).map(|cell| height.centre(cell % height.width, cell / height.width));
    let depth: Vec<f64> = cells
        .clone()
        .map(|p| strata.exposed_depth(p, surface.ground(p)))
        .collect();
    let layer = |&depth: &f64| strata.stratigraphy.place(depth).layer as f32;
    Some([
        ("layer", depth.iter().map(layer).collect()),
        ("strat_depth_m", depth.iter().map(|&d| d as f32).collect()),
        ("sediment_m", cells.map(|p| strata.sediment.sample(p)).collect()),
    ])
}

fn write_height_maps(out: &OutDir, surface: &Surface, uplift: &[f32]) -> Result<(), Failure> {
    let height = &surface.height;
    let slope = height.slope();
    let drainage_km2: Vec<f32> = surface.drainage.data.iter().map(|a| a / 1e6).collect();
    let strata = strata_channels(surface);
    let mut channels: Vec<(&str, &[f32])> = vec![
        ("height_m", &height.data),
        ("uplift_m_per_yr", uplift),
        ("drainage_km2", &drainage_km2),
        ("slope", &slope.data),
    ];
    for (name, values) in strata.iter().flatten() {
        channels.push((name, values));
    }
    out.write("height.exr", |w| {
        exr::write(w, height.width, height.height, &channels)
    })
    .map_err(Failure::other)?;
    let height16 = Height16::new(height).map_err(Failure::other)?;
    out.write("height16.png", |w| height16.write_png(w))
        .map_err(Failure::other)?;
    out.write("height16.r16", |w| height16.write_r16(w))
        .map_err(Failure::other)?;
    out.write("height16.json", |w| height16.write_json(w))
        .map_err(Failure::other)?;
    Ok(())
}

fn write_rivers(out: &OutDir, tin: &Tin, rivers: &[River]) -> Result<(), Failure> {
    out.write("rivers.geojson", |w| {
        geojson::write_rivers(w, tin.extent(), rivers)
    })
    .map(drop)
    .map_err(Failure::other)
}

/// Writes `value` as indented JSON with a line end.
pub(super) fn write_json(out: &OutDir, name: &str, value: &impl Serialize) -> Result<(), Failure> {
    out.write(name, |w| {
        serde_json::to_writer_pretty(&mut *w, value).map_err(io::Error::other)?;
        w.write_all(b"\n")
    })
    .map(drop)
    .map_err(Failure::other)
}

/// The land of a session, with its plates and faults. `flow` is the water over it, `k` the erosion constant.
pub(super) fn land_of<'a>(sim: &'a Sim, flow: &'a Flow, k: &'a [f64], title: &'a str) -> LandFiles<'a> {
    let world = sim.world();
    LandFiles {
        title,
        tin: &world.tin,
        z: &world.z,
        uplift: sim.node_uplift(),
        flow,
        k,
        marks: Marks {
            plates: sim.plate_marks(),
            faults: sim.fault_traces(),
            folds: sim.fold_lines(usize::MAX),
            cuts: [Side::South, Side::North]
                .into_iter()
                .filter_map(|side| sim.cut(side).cloned())
                .collect(),
        },
        under: Some(sim.underground()),
        elapsed_yr: world.time_yr,
    }
}

/// Draws the map of a running session into `out` as `name`.
pub(super) fn draw_frame(out: &OutDir, name: &str, sim: &Sim, title: &str, size: u32) -> Result<(), Failure> {
    let mut survey = Survey::new(&sim.world().tin, size as usize);
    let flow = sim.flow();
    let land = land_of(sim, &flow, &[], title);
    let style = MapStyle {
        title: title.to_owned(),
        ..MapStyle::default()
    };
    let png = map_png(&land.surface(&mut survey), &style)?;
    out.write(name, |w| w.write_all(&png))
        .map(drop)
        .map_err(Failure::other)
}
