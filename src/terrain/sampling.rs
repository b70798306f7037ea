//! Poisson-disc sampling of a rectangle: irregular, isotropic, without clumps or holes.
//!
//! Random sequential insertion ("dart throwing", Cook 1986) on a background grid. Darts fall in *slices*: a slice
//! visits the still empty cells and throws into each with a small probability, so that the darts arrive in an order
//! that is nearly random in space, which is what makes the result isotropic; cells that stay empty are split into
//! quarters, and quarters covered by one disc are dropped, until the set is saturated (Ebeida et al. 2012, *A simple
//! algorithm for maximal Poisson-disk sampling in high dimensions*). The radius is chosen so that the requested
//! number of nodes falls one or two per cent short of saturation; throwing stops at that number exactly.

use glam::DVec2;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use crate::units::Extent;

/// Mean spacing of nodes along the border, in disc radii. With [`BORDER_JITTER`] the gaps lie between 1.0 and 1.5
/// radii: no two border nodes are closer than a radius, and no inner node fits between two of them and the border.
const BORDER_SPACING: f64 = 1.25;

/// Largest shift of a border node along its side, in border spacings.
const BORDER_JITTER: f64 = 0.1;

/// Nodes per squared radius that are aimed at. Random insertion saturates at 0.696 (a jamming coverage of 0.547).
const FILL: f64 = 0.685;

/// Width in radii by which the border nodes keep inner nodes away from the border, as seen by their number.
const BORDER_STRIP: f64 = 0.95;

/// Factor by which the radius shrinks when a set saturates before it has enough nodes.
const SHRINK: f64 = 0.98;

/// Share of the still empty cells that a slice throws into, slice by slice, before cells are split.
const SLICES: [f64; 16] = [
    0.04, 0.04, 0.05, 0.06, 0.07, 0.08, 0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.8,
];

/// Slices on each level of split cells.
const SPLIT_SLICES: [f64; 3] = [0.3, 0.6, 1.0];

/// Times a cell is split before what is left of it counts as covered.
const LEVELS: u32 = 6;

/// Positions of a Poisson-disc sample, the border nodes first, and the number of border nodes.
pub(super) struct Samples {
    /// All positions, metres.
    pub(super) positions: Vec<DVec2>,
    /// The first `border` positions lie on the border of the rectangle.
    pub(super) border: usize,
}

/// Exactly `nodes` (at least 16) Poisson-disc samples of `extent`, with nodes along its border, corners included.
pub(super) fn poisson_disc(extent: Extent, nodes: usize, seed: u64) -> Samples {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut radius = disc_radius(extent, nodes);
    let border = border_nodes(extent, radius, nodes, &mut rng);
    loop {
        let mut throw = DartBoard::new(extent, radius, border.clone());
        throw.fill(nodes, &mut rng);
        if throw.positions.len() >= nodes {
            return Samples {
                positions: throw.positions,
                border: border.len(),
            };
        }
        radius *= SHRINK;
    }
}

/// The disc radius at which about `nodes` samples nearly saturate `extent`.
fn disc_radius(extent: Extent, nodes: usize) -> f64 {
    let expected = |r: f64| {
        let inner = (extent.width - BORDER_STRIP * r).max(0.0) * (extent.height - BORDER_STRIP * r).max(0.0);
        2.0 * (extent.width + extent.height) / (BORDER_SPACING * r) + FILL * inner / (r * r)
    };
    let (mut low, mut high) = (0.0, extent.width.max(extent.height));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if expected(middle) > nodes as f64 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high.min(extent.width).min(extent.height)
}

/// Nodes along the border: the four corners, and jittered regular nodes between them, `nodes` at most.
fn border_nodes(extent: Extent, radius: f64, nodes: usize, rng: &mut Pcg64Mcg) -> Vec<DVec2> {
    let segments = |length: f64| ((length / (BORDER_SPACING * radius)).round() as usize).max(1);
    let (mut columns, mut rows) = (segments(extent.width), segments(extent.height));
    let excess = (2 * (columns + rows)).saturating_sub(nodes).div_ceil(2);
    let long = columns.max(rows);
    let shortened = long.saturating_sub(excess).max(1);
    if columns >= rows {
        columns = shortened;
    } else {
        rows = shortened;
    }
    let mut border = Vec::with_capacity(2 * (columns + rows));
    let corners = [
        DVec2::ZERO,
        DVec2::new(extent.width, 0.0),
        extent.size(),
        DVec2::new(0.0, extent.height),
    ];
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        let count = if side % 2 == 0 { columns } else { rows };
        border.push(from);
        for k in 1..count {
            let shift = BORDER_JITTER * (2.0 * unit(rng.next_u64()) - 1.0);
            let t = (k as f64 + shift) / count as f64;
            // One coordinate is the same at both ends and stays exactly on the side.
            border.push(from + (to - from) * t);
        }
    }
    border
}

/// A number in [0, 1) from the upper bits of a random word.
fn unit(word: u64) -> f64 {
    (word >> 11) as f64 / (1_u64 << 53) as f64
}

/// A square that may still take a sample: the part (`sub_x`, `sub_y`) of a grid cell on the current level.
#[derive(Clone, Copy)]
struct Open {
    cell: u32,
    sub_x: u16,
    sub_y: u16,
}

/// The background grid. A cell's diagonal is one radius, so it holds one sample at most; two empty cells pad each
/// side, so that the neighbourhood of a cell needs no bounds.
struct DartBoard {
    extent: Extent,
    radius: f64,
    cell: f64,
    stride: usize,
    /// The sample in each cell; NaN where there is none (a distance to NaN is below no radius).
    samples: Vec<DVec2>,
    positions: Vec<DVec2>,
    rows: usize,
}

impl DartBoard {
    const PAD: usize = 2;

    fn new(extent: Extent, radius: f64, border: Vec<DVec2>) -> Self {
        let cell = radius / std::f64::consts::SQRT_2;
        let columns = (extent.width / cell) as usize + 1;
        let rows = (extent.height / cell) as usize + 1;
        let stride = columns + 2 * Self::PAD;
        let mut board = Self {
            extent,
            radius,
            cell,
            stride,
            samples: vec![DVec2::NAN; stride * (rows + 2 * Self::PAD)],
            positions: border,
            rows,
        };
        for index in 0..board.positions.len() {
            let p = board.positions[index];
            let at = board.cell_at(p);
            board.samples[at] = p;
        }
        board
    }

    fn cell_at(&self, p: DVec2) -> usize {
        ((p.y / self.cell) as usize + Self::PAD) * self.stride + (p.x / self.cell) as usize + Self::PAD
    }

    /// South-west corner of an open square.
    fn corner(&self, open: Open, side: f64) -> DVec2 {
        let (row, column) = (open.cell as usize / self.stride, open.cell as usize % self.stride);
        DVec2::new(
            (column - Self::PAD) as f64 * self.cell + open.sub_x as f64 * side,
            (row - Self::PAD) as f64 * self.cell + open.sub_y as f64 * side,
        )
    }

    /// True if a sample near `cell` meets `test`. Two cells apart is the farthest a disc reaches.
    fn any_near(&self, cell: usize, test: impl Fn(DVec2) -> bool) -> bool {
        let first = cell - 2 * self.stride - 2;
        (0..5).any(|row| {
            let start = first + row * self.stride;
            self.samples[start..start + 5].iter().any(|&q| test(q))
        })
    }

    /// Throws until there are `target` positions in all, or no room is left.
    fn fill(&mut self, target: usize, rng: &mut Pcg64Mcg) {
        let mut open: Vec<Open> = (0..self.rows)
            .flat_map(|row| {
                let first = (row + Self::PAD) * self.stride + Self::PAD;
                first..first + self.stride - 2 * Self::PAD
            })
            .filter(|&cell| self.samples[cell].is_nan())
            .map(|cell| Open {
                cell: cell as u32,
                sub_x: 0,
                sub_y: 0,
            })
            .collect();
        for level in 0..LEVELS {
            let side = self.cell / f64::from(1 << level);
            let slices: &[f64] = if level == 0 { &SLICES } else { &SPLIT_SLICES };
            for &share in slices {
                self.throw_slice(&mut open, side, share, target, rng);
                if self.positions.len() >= target {
                    return;
                }
            }
            open = self.split(&open, 0.5 * side);
            shuffle(&mut open, rng);
        }
    }

    /// One dart into a random `share` of the open squares; keeps those still open.
    fn throw_slice(
        &mut self,
        open: &mut Vec<Open>,
        side: f64,
        share: f64,
        target: usize,
        rng: &mut Pcg64Mcg,
    ) {
        // One random word serves a dart: 12 bits decide whether it flies, 26 bits place it on each axis.
        let flies = (share * 4096.0) as u64;
        let step = side / f64::from(1 << 26);
        let radius_squared = self.radius * self.radius;
        let mut kept = 0;
        for k in 0..open.len() {
            let square = open[k];
            let cell = square.cell as usize;
            let word = rng.next_u64();
            let mut still_open = true;
            if word & 4095 < flies && self.positions.len() < target {
                if self.samples[cell].is_nan() {
                    let p = self.corner(square, side)
                        + DVec2::new((word >> 38) as f64, (word >> 12 & 0x3FF_FFFF) as f64) * step;
                    if self.extent.contains(p)
                        && !self.any_near(cell, |q| q.distance_squared(p) < radius_squared)
                    {
                        self.samples[cell] = p;
                        self.positions.push(p);
                        still_open = false;
                    }
                } else {
                    still_open = false;
                }
            }
            open[kept] = square;
            kept += usize::from(still_open);
        }
        open.truncate(kept);
    }

    /// The quarters, of side `half`, of the open squares that no single disc covers.
    fn split(&self, open: &[Open], half: f64) -> Vec<Open> {
        let radius_squared = self.radius * self.radius;
        let mut quarters = Vec::with_capacity(open.len());
        for square in open
            .iter()
            .filter(|square| self.samples[square.cell as usize].is_nan())
        {
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let quarter = Open {
                    cell: square.cell,
                    sub_x: 2 * square.sub_x + dx,
                    sub_y: 2 * square.sub_y + dy,
                };
                let low = self.corner(quarter, half);
                let middle = low + 0.5 * half;
                let covered = self.any_near(quarter.cell as usize, |q| {
                    let farthest = (q - middle).abs() + 0.5 * half;
                    farthest.length_squared() < radius_squared
                });
                if !covered && self.extent.contains(low) {
                    quarters.push(quarter);
                }
            }
        }
        quarters
    }
}

/// Fisher–Yates, so that the last few samples do not gather where a sweep begins.
fn shuffle<T>(items: &mut [T], rng: &mut Pcg64Mcg) {
    for k in (1..items.len()).rev() {
        items.swap(k, (rng.next_u64() % (k as u64 + 1)) as usize);
    }
}

/// A permutation of `positions` along a Hilbert curve over `extent`: nodes near in the plane are near in memory.
pub(super) fn hilbert_order(extent: Extent, positions: &[DVec2]) -> Vec<u32> {
    let scale = 65_535.0 / extent.width.max(extent.height);
    let mut keys: Vec<u64> = positions
        .iter()
        .enumerate()
        .map(|(index, p)| hilbert_key((p.x * scale) as u32, (p.y * scale) as u32) << 32 | index as u64)
        .collect();
    keys.sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

/// Distance along the Hilbert curve of order 16 at cell (`x`, `y`).
fn hilbert_key(mut x: u32, mut y: u32) -> u64 {
    let mut key = 0_u64;
    for bit in (0..16).rev() {
        let (rx, ry) = (x >> bit & 1, y >> bit & 1);
        key = key << 2 | u64::from((3 * rx) ^ ry);
        if ry == 0 {
            if rx == 1 {
                x = !x;
                y = !y;
            }
            std::mem::swap(&mut x, &mut y);
        }
    }
    key
}
