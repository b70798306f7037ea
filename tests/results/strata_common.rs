//! Land with layers in closed form, for tests of slices, maps and files.
#![allow(clippy::unwrap_used, reason = "a land that cannot be made fails the test")]

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use orogen::rock::{Column, Stratigraphy, preset};
use orogen::surface::{FaultTrace, Raster, StrataMap, Surface};
use orogen::units::Extent;

/// A plan wider than high.
pub(crate) const LAND: Extent = Extent {
    width: 64e3,
    height: 36e3,
};

/// How far the pile has risen as a whole: a range from south to north in the middle.
pub(crate) fn base(p: DVec2) -> f64 {
    4200.0 * range(p)
}

/// How far the folds have raised the layer over the first folding interface: waves across the range.
pub(crate) fn fold(p: DVec2) -> f64 {
    900.0 * range(p) * (1.0 + (TAU * p.x / 8e3).cos())
}

/// 1 on the axis of the range, 0 in the plains.
fn range(p: DVec2) -> f64 {
    (-((p.x - 32e3) / 11e3).powi(2)).exp()
}

/// The ground: less high than the pile has risen, cut by valleys that run out of the range; a basin in the west.
pub(crate) fn ground(p: DVec2) -> f64 {
    let crest = 2600.0 * range(p) + 0.35 * fold(p);
    let valleys = 0.5 + 0.5 * (TAU * p.y / 9e3).cos() * (1.0 - range(p));
    let ground = crest * (0.45 + 0.55 * valleys) - 20.0 * (1.0 - range(p));
    let basin = 500.0 * (-(p.distance(LAKE) / 2e3).powi(2)).exp();
    ground.min(base(p) + fold(p) + sediment(p)) - basin
}

/// Loose sediment: in the western plain.
pub(crate) fn sediment(p: DVec2) -> f64 {
    120.0 * (1.0 - p.x / 14e3).max(0.0)
}

/// Where a lake lies, west of the range, and its level.
const LAKE: DVec2 = DVec2::new(17e3, 18e3);
pub(crate) const LAKE_LEVEL: f64 = 200.0;

/// Depth of the lake.
pub(crate) fn lake_depth(p: DVec2) -> f64 {
    if p.distance(LAKE) < 3e3 {
        (LAKE_LEVEL - ground(p)).max(0.0)
    } else {
        0.0
    }
}

/// Root under the range.
pub(crate) fn root(p: DVec2) -> f64 {
    6000.0 * (-((p.x - 32e3) / 20e3).powi(2)).exp()
}

/// The pile of layers at a place.
pub(crate) fn column(pile: &Stratigraphy, p: DVec2) -> Column<'_> {
    let column = Column::new(pile, base(p));
    pile.folding()
        .next()
        .map_or(column, |interface| column.folded(interface, fold(p)))
}

/// Land over the named preset on `width × height` cells, with a fault on the east side of the range.
pub(crate) fn folded_range(preset: &str, width: usize, height: usize) -> Surface {
    let pile: Arc<Stratigraphy> = preset::by_name(preset).unwrap();
    let raster = |value: &dyn Fn(DVec2) -> f64| Raster::from_fn(width, height, LAND, |p| value(p) as f32);
    let folds = pile
        .folding()
        .take(1)
        .map(|interface| (interface, raster(&fold)))
        .collect();
    let strata = StrataMap {
        base: raster(&base),
        folds,
        sediment: raster(&sediment),
        root: raster(&root),
        depth: raster(&|p| column(&pile, p).depth_at(ground(p) - sediment(p))),
        stratigraphy: pile,
    };
    Surface {
        height: raster(&ground),
        lake_depth: raster(&lake_depth),
        drainage: raster(&|_| 0.0),
        spacing: LAND.width / width as f64,
        rivers: Vec::new(),
        plates: Vec::new(),
        faults: vec![fault()],
        folds: Vec::new(),
        strata: Some(Arc::new(strata)),
        elapsed_yr: 5e6,
    }
}

/// A straight fault at 47 km from south to north; the range is in the west, to its left.
pub(crate) fn fault() -> FaultTrace {
    FaultTrace {
        points: (1..36).map(|i| DVec2::new(47e3, 1e3 * f64::from(i))).collect(),
        range_on_left: true,
    }
}
