//! Poisson-disc sampling of a rectangle: irregular, isotropic, without clumps or holes.
//!
//! Random sequential insertion ("dart throwing", Cook 1986) on a background grid. Darts fall in *slices*: a slice
//! throws into a small random share of the cells, so that the darts arrive in an order that is nearly random in space,
//! which is what makes the result isotropic; cells that stay empty are split into quarters, and quarters covered by
//! one disc are dropped, until the set is saturated (Ebeida et al. 2012, *A simple algorithm for maximal Poisson-disk
//! sampling in high dimensions*). The radius is chosen so that the requested number of nodes falls three or four per
//! cent short of saturation; throwing stops at that number exactly.

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
const FILL: f64 = 0.672;

/// Width in radii by which the border nodes keep inner nodes away from the border, as seen by their number.
const BORDER_STRIP: f64 = 0.95;

/// Factor by which the radius shrinks when a set saturates before it has enough nodes.
const SHRINK: f64 = 0.98;

/// Share of the cells that a slice throws into, slice by slice, before cells are split. The first slices
/// are thin: within one the darts fall row by row.
const SLICES: [f64; 9] = [0.04, 0.04, 0.05, 0.06, 0.07, 0.08, 0.1, 0.12, 0.15];

/// Slices on each level of split cells.
const SPLIT_SLICES: [f64; 3] = [0.3, 0.6, 0.8];

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

/// Poisson-disc samples of `extent` that leave no room for another: no two are nearer than `radius` metres, and no place
/// is farther than that from all. Border nodes as in [`poisson_disc`].
pub(super) fn saturated(extent: Extent, radius: f64, seed: u64) -> Samples {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let border = border_nodes(extent, radius, usize::MAX, &mut rng);
    let count = border.len();
    let mut throw = DartBoard::new(extent, radius, border);
    throw.fill(usize::MAX, &mut rng);
    Samples {
        positions: throw.positions,
        border: count,
    }
}

/// How many samples [`saturated`] has room for at most: discs of half the radius, packed as tightly as they go, on the
/// rectangle grown by half a radius.
pub(super) fn saturated_at_most(extent: Extent, radius: f64) -> f64 {
    (extent.width + radius) * (extent.height + radius) / (radius * radius * 3.0_f64.sqrt() / 2.0)
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

/// The background grid, in units of its cells. A cell's diagonal is one radius, so a cell holds one sample at most.
///
/// Single precision is enough: only the rule "no nearer than a radius" depends on it, by 1e-4 at worst.
struct DartBoard {
    extent: Extent,
    /// Side of a cell, metres.
    cell: f64,
    stride: usize,
    rows: usize,
    /// The sample in each cell, [`EMPTY`] where there is none.
    xs: Vec<f32>,
    ys: Vec<f32>,
    /// Metres.
    positions: Vec<DVec2>,
}

/// Empty cells around the land, so that the neighbourhood of a cell needs no bounds.
const PAD: usize = 2;

/// Most columns that one test of a neighbourhood row looks at.
const LANES: usize = 8;

/// Coordinate of "no sample": farther than a radius from everything.
const EMPTY: f32 = -1.0e9;

/// Squared radius in cells.
const RADIUS_SQUARED: f32 = 2.0;

impl DartBoard {
    fn new(extent: Extent, radius: f64, border: Vec<DVec2>) -> Self {
        let cell = radius / std::f64::consts::SQRT_2;
        let columns = (extent.width / cell) as usize + 1;
        let rows = (extent.height / cell) as usize + 1;
        let stride = columns + 2 * PAD;
        let cells = stride * (rows + 2 * PAD) + LANES;
        let mut board = Self {
            extent,
            cell,
            stride,
            rows,
            xs: vec![EMPTY; cells],
            ys: vec![EMPTY; cells],
            positions: border,
        };
        for index in 0..board.positions.len() {
            let p = board.positions[index] / cell;
            let at = (p.y as usize + PAD) * stride + p.x as usize + PAD;
            board.xs[at] = p.x as f32;
            board.ys[at] = p.y as f32;
        }
        board
    }

    fn is_empty(&self, cell: u32) -> bool {
        self.xs[cell as usize] == EMPTY
    }

    /// South-west corner of the cell of an open square, in cells.
    fn corner(&self, open: Open) -> (f32, f32) {
        let (row, column) = (open.cell as usize / self.stride, open.cell as usize % self.stride);
        ((column - PAD) as f32, (row - PAD) as f32)
    }

    /// True if a disc covers the point (x, y), which lies in the upper or the lower half of its cell.
    fn is_hit(&self, cell: u32, upper: bool, x: f32, y: f32) -> bool {
        self.any_near(cell, upper, |sample_x, sample_y| {
            let (dx, dy) = (sample_x - x, sample_y - y);
            dx * dx + dy * dy
        })
    }

    /// True if one disc covers the whole square of the given half side around (x, y), in one half of its cell.
    fn is_covered(&self, cell: u32, upper: bool, x: f32, y: f32, half: f32) -> bool {
        self.any_near(cell, upper, |sample_x, sample_y| {
            let (dx, dy) = ((sample_x - x).abs() + half, (sample_y - y).abs() + half);
            dx * dx + dy * dy
        })
    }

    /// True if a sample near one half of a cell has a squared distance below that of a radius.
    fn any_near(&self, cell: u32, upper: bool, squared_distance: impl Fn(f32, f32) -> f32) -> bool {
        // Two cells to each side; eight lanes fill whole registers and cost less than five would. The second row beyond
        // the other half is farther than a radius. No row ends the search: to the processor, which of them has the
        // disc is a coin toss, and dearer than all the rows.
        let first_row = usize::from(upper);
        let mut near = [f32::INFINITY; LANES];
        for row in first_row..first_row + 4 {
            let first = cell as usize + row * self.stride - 2 * (self.stride + 1);
            let (xs, ys) = (&self.xs[first..first + LANES], &self.ys[first..first + LANES]);
            for lane in 0..LANES {
                let squared = squared_distance(xs[lane], ys[lane]);
                near[lane] = if squared < near[lane] { squared } else { near[lane] };
            }
        }
        near.iter().any(|&squared| squared < RADIUS_SQUARED)
    }

    /// Throws until there are `target` positions in all, or no room is left.
    fn fill(&mut self, target: usize, rng: &mut Pcg64Mcg) {
        let mut open = Vec::with_capacity(self.stride * self.rows);
        for row in 0..self.rows {
            let first = ((row + PAD) * self.stride + PAD) as u32;
            let row = (first..first + (self.stride - 2 * PAD) as u32).filter(|&cell| self.is_empty(cell));
            open.extend(row.map(|cell| Open {
                cell,
                sub_x: 0,
                sub_y: 0,
            }));
        }
        let mut side = 1.0;
        for level in 0..LEVELS {
            let slices: &[f64] = if level == 0 { &SLICES } else { &SPLIT_SLICES };
            for &share in slices {
                // The last samples, which end the throwing, must not gather where a sweep over the rows begins.
                let stride = if level < 2 { 1 } else { even_stride(open.len()) };
                self.throw_slice(&open, side, share, stride, target, rng);
                if self.positions.len() >= target {
                    return;
                }
            }
            side *= 0.5;
            open = self.split(&open, side);
        }
    }

    /// One dart into each of a random `share` of the squares, unless their cell holds a sample by now.
    /// They are visited in steps of `stride`, round and round.
    fn throw_slice(
        &mut self,
        open: &[Open],
        side: f32,
        share: f64,
        stride: usize,
        target: usize,
        rng: &mut Pcg64Mcg,
    ) {
        let gaps = gaps(share);
        let step = side / (1 << 24) as f32;
        let mut next = usize::from(gaps[rng.next_u64() as usize % GAPS]) - 1;
        while next < open.len() && self.positions.len() < target {
            let square = open[next * stride % open.len()];
            // One random word serves a dart: 24 bits place it on each axis, others say where the next one falls.
            let word = rng.next_u64();
            next += usize::from(gaps[word as usize % GAPS]);
            if !self.is_empty(square.cell) {
                continue;
            }
            let (west, south) = self.corner(square);
            let east = f32::from(square.sub_x) * side + (word >> 40) as f32 * step;
            let north = f32::from(square.sub_y) * side + (word >> 16 & 0xFF_FFFF) as f32 * step;
            let (x, y) = (west + east, south + north);
            if self.is_hit(square.cell, north >= 0.5, x, y) {
                continue;
            }
            let p = DVec2::new(f64::from(x), f64::from(y)) * self.cell;
            // Strictly inside: the border has its own nodes.
            if p.min_element() > 0.0 && p.x < self.extent.width && p.y < self.extent.height {
                self.xs[square.cell as usize] = x;
                self.ys[square.cell as usize] = y;
                self.positions.push(p);
            }
        }
    }

    /// The quarters, of the given side, of the open squares that no single disc covers.
    fn split(&self, open: &[Open], side: f32) -> Vec<Open> {
        let mut quarters = Vec::with_capacity(open.len());
        for square in open.iter().filter(|square| self.is_empty(square.cell)) {
            let (west, south) = self.corner(*square);
            let half = 0.5 * side;
            // Whole cells are rarely covered by one disc, smaller squares are more often than not.
            let covered = if side >= 0.5 {
                self.covered_quarters(square.cell, west + side, south + side, half)
            } else {
                let upper = f32::from(square.sub_y) * 2.0 * side >= 0.5;
                let (x, y) = (
                    west + f32::from(2 * square.sub_x + 1) * side,
                    south + f32::from(2 * square.sub_y + 1) * side,
                );
                if self.is_covered(square.cell, upper, x, y, side) {
                    continue;
                }
                QUARTERS.map(|(sub_x, sub_y)| {
                    let (x, y) = (
                        x + (f32::from(sub_x) - 0.5) * side,
                        y + (f32::from(sub_y) - 0.5) * side,
                    );
                    self.is_covered(square.cell, upper, x, y, half)
                })
            };
            for ((sub_x, sub_y), covered) in QUARTERS.into_iter().zip(covered) {
                if !covered {
                    quarters.push(Open {
                        cell: square.cell,
                        sub_x: 2 * square.sub_x + sub_x,
                        sub_y: 2 * square.sub_y + sub_y,
                    });
                }
            }
        }
        quarters
    }

    /// Which [`QUARTERS`] of the cell around (x, y) are covered by a single disc; `half` is half a quarter's side.
    ///
    /// Without branches: to the processor, which discs cover what is a coin toss. A disc that covers a quarter of a
    /// cell lies one cell away at most.
    fn covered_quarters(&self, cell: u32, x: f32, y: f32, half: f32) -> [bool; 4] {
        const N: usize = 4;
        // Squared distance to the far corner of each quarter, the smallest in each lane.
        let mut far = [[f32::INFINITY; N]; 4];
        let squared = |sample: f32, middle: f32| ((sample - middle).abs() + half).powi(2);
        for row in 0..3 {
            let first = cell as usize + row * self.stride - (self.stride + 1);
            let (xs, ys) = (&self.xs[first..first + N], &self.ys[first..first + N]);
            for lane in 0..N {
                let (west, east) = (squared(xs[lane], x - half), squared(xs[lane], x + half));
                let (south, north) = (squared(ys[lane], y - half), squared(ys[lane], y + half));
                let corners = [west + south, east + south, west + north, east + north];
                for (far, corner) in far.iter_mut().zip(corners) {
                    far[lane] = if corner < far[lane] { corner } else { far[lane] };
                }
            }
        }
        far.map(|lanes| lanes.iter().any(|&far| far < RADIUS_SQUARED))
    }
}

/// The quarters of a square, as steps east and north.
const QUARTERS: [(u16, u16); 4] = [(0, 0), (1, 0), (0, 1), (1, 1)];

/// Entries of a table of gaps.
const GAPS: usize = 1024;

/// Quantiles of the distance from one success to the next in trials that succeed with probability `share`.
fn gaps(share: f64) -> [u16; GAPS] {
    let mut table = [1; GAPS];
    let (mut gap, mut longer) = (1, 1.0 - share);
    for (k, entry) in table.iter_mut().enumerate() {
        while longer > 1.0 - (k as f64 + 0.5) / GAPS as f64 {
            gap += 1;
            longer *= 1.0 - share;
        }
        *entry = gap;
    }
    table
}

/// A step that visits all of `count` places once, evenly from the first few on: by the golden section, with no divisor
/// in common.
fn even_stride(count: usize) -> usize {
    let common = |mut a: usize, mut b: usize| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let mut stride = (count as f64 * 0.618_034) as usize;
    while common(stride, count) != 1 {
        stride += 1;
    }
    stride
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
