//! Orogen beside [fastlem](https://crates.io/crates/fastlem) 0.1.4, on the same nodes.
//!
//! ```text
//! cargo run --release --manifest-path benches/peers/Cargo.toml [NODES...]
//! ```
//!
//! (10,000, 100,000 and 1,000,000 nodes where none are named; some minutes in all, most of them fastlem's.)
//!
//! **What is the same.** A square of 100 × 100 km; the nodes, their order in memory (Orogen's, along a Hilbert curve),
//! their outlets (the border) and their heights at the start; uplift 5e-4 m/yr, K 5.5e-7, m 0.5, n 1; one thread; and
//! what a step has to do: find receivers through lakes, add up drainage areas, solve the stream power law along rivers.
//!
//! **What is not.** fastlem's iteration knows no time: it sets every node to the height that a steady land would have on
//! the present drainage (Steer 2021), and repeats that until drainage no longer changes. Orogen's step is 100,000 years of
//! a land that grows (Braun & Willett 2013), and keeps what a knickpoint has not reached yet. One iteration and one step
//! do equal work; after equally many of them the lands differ, as the mean heights show. Orogen is timed with landslides,
//! too; fastlem's slopes are not bounded here. Triangulation is timed of given nodes, without sampling them; fastlem's
//! includes the areas of Voronoi cells and its graph, Orogen's includes both as well.
//!
//! *Cold* is the first step from noise; *developed* is the step after sixty others. Times are CPU time, the least of the
//! runs.

use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;

use cpu_time::ProcessTime;
use fastlem::core::parameters::TopographicalParameters;
use fastlem::core::traits::Model;
use fastlem::core::units::{Area, Elevation, Length};
use fastlem::lem::generator::TerrainGenerator;
use fastlem::models::surface::builder::TerrainModel2DBulider;
use fastlem::models::surface::model::TerrainModel2D;
use fastlem::models::surface::sites::Site2D;
use orogen::terrain::{Border, Erosion, ErosionParams, Forcing, StartLand, Tin};
use orogen::units::{Extent, KM};
use terrain_graph::edge_attributed_undirected::EdgeAttributedUndirectedGraph;

/// The square.
const LAND: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};
/// Uplift, m/yr.
const UPLIFT: f64 = 5e-4;
/// Erosion constant at m = 0.5, 1/yr.
const K: f64 = 5.5e-7;
/// Length of Orogen's step, yr.
const DT_YR: f64 = 1e5;
/// Steps until drainage has developed.
const DEVELOPED: usize = 60;
/// Sizes where none are named.
const SIZES: [usize; 3] = [10_000, 100_000, 1_000_000];

/// Anything that keeps an engine from its land.
type Failure = Box<dyn Error + Send + Sync>;

/// What an engine took, CPU ms, and the mean of the heights it came to, m.
struct Times {
    engine: &'static str,
    build: f64,
    cold: f64,
    developed: f64,
    mean_m: f64,
}

fn main() -> Result<(), Failure> {
    let named = std::env::args().skip(1).map(|size| {
        let parsed = size.parse::<usize>();
        parsed.map_err(|_| format!("`{size}`: expected a number of nodes"))
    });
    let mut sizes = named.collect::<Result<Vec<_>, _>>()?;
    if sizes.is_empty() {
        sizes.extend(SIZES);
    }
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!("    nodes  engine                    build ms    cold ms  developed ms   mean height m");
    for nodes in sizes {
        let runs = if nodes > 200_000 { 2 } else { 7 };
        let compared: Result<_, Failure> = one.install(|| {
            let tin = Tin::poisson(LAND, nodes, 1)?;
            let start = StartLand::new(1).heights(&tin);
            Ok([
                orogen(&tin, &start, false, runs)?,
                orogen(&tin, &start, true, runs)?,
                fastlem(&tin, &start, runs)?,
            ])
        });
        for times in compared? {
            let Times {
                engine,
                build,
                cold,
                developed,
                mean_m,
            } = times;
            println!("{nodes:>9}  {engine:<24} {build:>9.2}  {cold:>9.2}  {developed:>12.2}  {mean_m:>14.0}");
        }
    }
    println!(
        "One step of Orogen is {DT_YR:.0} years of a land that grows; one iteration of fastlem knows no time and aims at the \
         steady land."
    );
    Ok(())
}

fn orogen(tin: &Tin, start: &[f64], landslides: bool, runs: usize) -> Result<Times, Failure> {
    let params = ErosionParams {
        k: K,
        landslides,
        ..ErosionParams::default()
    };
    let uplift = vec![UPLIFT; tin.len()];
    let forcing = Forcing::uplift(&uplift);
    let border = Border::Flags(tin.border());
    // Both engines are handed nodes that are well spaced; if they do not make a land, nothing is to be compared.
    Tin::from_nodes(LAND, tin.positions(), border)?;
    let (build, ()) = least(runs, || (), |()| Tin::from_nodes(LAND, tin.positions(), border));
    let (cold, (mut erosion, mut z)) = least(
        runs,
        || (Erosion::new(tin), start.to_vec()),
        |(erosion, z)| erosion.step(tin, z, &forcing, &params, DT_YR),
    );
    for _ in 1..DEVELOPED {
        erosion.step(tin, &mut z, &forcing, &params, DT_YR);
    }
    let (developed, ()) = least(
        runs,
        || (),
        |()| erosion.step(tin, &mut z, &forcing, &params, DT_YR),
    );
    Ok(Times {
        engine: if landslides {
            "Orogen, with landslides"
        } else {
            "Orogen"
        },
        build,
        cold,
        developed,
        mean_m: mean(&z),
    })
}

fn fastlem(tin: &Tin, start: &[f64], runs: usize) -> Result<Times, Failure> {
    let sites: Vec<Site2D> = tin.positions().iter().map(|p| Site2D::new(p.x, p.y)).collect();
    let builder = TerrainModel2DBulider::default()
        .set_sites(sites)
        .set_bounding_box(
            Some(Site2D::new(0.0, 0.0)),
            Some(Site2D::new(LAND.width, LAND.height)),
        );
    let land = Land(Arc::new(builder.build()?));
    let same = |(site, p): (&Site2D, &_)| [site.x, site.y] == <[f64; 2]>::from(*p);
    if land.num() != tin.len() || !land.sites().iter().zip(tin.positions()).all(same) {
        return Err("fastlem has other nodes, or in another order".into());
    }
    let (build, ()) = least(runs, || (), |()| drop(black_box(builder.build())));
    let prepare = |heights: &[f64]| {
        let nodes = heights.iter().zip(tin.border()).map(|(&height, &outlet)| {
            TopographicalParameters::default()
                .set_base_elevation(height)
                .set_erodibility(K)
                .set_uplift_rate(UPLIFT)
                .set_is_outlet(outlet)
        });
        TerrainGenerator::default()
            .set_model(land.clone())
            .set_parameters(nodes.collect())
    };
    let iterate = |heights: &[f64], times: usize| {
        let times = u32::try_from(times).unwrap_or(u32::MAX);
        prepare(heights).set_max_iteration(times).generate()
    };
    let one = |generator: &mut Option<TerrainGenerator<_, _, _>>| {
        let generator = generator.take().map(|generator| generator.set_max_iteration(1));
        drop(black_box(generator.map(TerrainGenerator::generate)));
    };
    let (cold, _) = least(runs, || Some(prepare(start)), one);
    let heights = iterate(start, DEVELOPED)?;
    let (developed, _) = least(runs, || Some(prepare(&heights)), one);
    Ok(Times {
        engine: "fastlem",
        build,
        cold,
        developed,
        mean_m: mean(&heights),
    })
}

/// fastlem's land, whose heights are the result: making its interpolator is no part of an iteration. It is shared, so that
/// letting go of it is none either.
#[derive(Clone)]
struct Land(Arc<TerrainModel2D>);

impl Model<Site2D, Vec<f64>> for Land {
    fn num(&self) -> usize {
        self.0.num()
    }

    fn sites(&self) -> &[Site2D] {
        self.0.sites()
    }

    fn areas(&self) -> &[Area] {
        self.0.areas()
    }

    fn default_outlets(&self) -> &[usize] {
        self.0.default_outlets()
    }

    fn graph(&self) -> &EdgeAttributedUndirectedGraph<Length> {
        self.0.graph()
    }

    fn create_terrain_from_result(&self, heights: &[Elevation]) -> Vec<f64> {
        heights.to_vec()
    }
}

/// The least CPU time of the runs, ms, and what the last of them worked on. What each needs of its own is made outside its
/// time.
fn least<S, T>(runs: usize, mut fresh: impl FnMut() -> S, mut work: impl FnMut(&mut S) -> T) -> (f64, S) {
    let mut least = f64::INFINITY;
    let mut run = || {
        let mut own = fresh();
        let began = ProcessTime::now();
        let result = black_box(work(&mut own));
        least = least.min(began.elapsed().as_secs_f64() * 1e3);
        drop(result);
        own
    };
    for _ in 1..runs {
        drop(run());
    }
    let own = run();
    (least, own)
}

fn mean(heights: &[f64]) -> f64 {
    heights.iter().sum::<f64>() / heights.len() as f64
}
