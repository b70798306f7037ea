//! Dart throwing on a background grid.
//!
//! Random sequential insertion (Cook 1986): darts fall in *slices*. A slice throws into a small random share of the
//! cells, so that the darts arrive in an order that is nearly random in space, which is what makes the result isotropic;
//! cells that stay empty are split into quarters, and quarters covered by one disc are dropped, until the set is
//! saturated (Ebeida et al. 2012, *A simple algorithm for maximal Poisson-disk sampling in high dimensions*).

use glam::DVec2;
use multiversion::multiversion;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

use crate::units::Extent;

/// Share of the cells that a slice throws into, slice by slice, before cells are split. The first slices
/// are thin: within one the darts fall row by row.
const SLICES: [f64; 9] = [0.04, 0.04, 0.05, 0.06, 0.07, 0.08, 0.1, 0.12, 0.15];

/// Slices on each level of split cells.
const SPLIT_SLICES: [f64; 3] = [0.3, 0.6, 0.8];

/// Times a cell is split before what is left of it counts as covered.
const LEVELS: u32 = 6;

/// A square that may still take a sample: the part (`sub_x`, `sub_y`) of a grid cell on the current level.
#[derive(Clone, Copy)]
struct Open {
    cell: u32,
    sub_x: u16,
    sub_y: u16,
}

/// A dart on its way to an empty cell.
#[derive(Clone, Copy)]
struct Dart {
    cell: u32,
    /// Whether it falls into the upper half of the cell.
    upper: bool,
    /// In cells.
    x: f32,
    y: f32,
}

impl Dart {
    #[inline]
    fn squared_distance(&self, x: f32, y: f32) -> f32 {
        let (dx, dy) = (x - self.x, y - self.y);
        dx * dx + dy * dy
    }
}

/// The background grid, in units of its cells. A cell's diagonal is one radius, so a cell holds one sample at most.
///
/// Single precision is enough: only the rule "no nearer than a radius" depends on it, by 1e-4 at worst.
pub(super) struct DartBoard {
    extent: Extent,
    /// Side of a cell, metres.
    cell: f64,
    stride: usize,
    rows: usize,
    /// The sample in each cell, [`EMPTY`] where there is none.
    xs: Vec<f32>,
    ys: Vec<f32>,
    /// Metres.
    pub(super) positions: Vec<DVec2>,
}

/// Empty cells around the land, so that the neighbourhood of a cell needs no bounds.
const PAD: usize = 2;

/// Columns that one test of a neighbourhood row looks at.
const LANES: usize = 8;

/// Rows within a radius of one half of a cell.
const NEAR_ROWS: usize = 4;

/// Darts thrown at once: enough to wait for memory together, few enough that they seldom meet.
const VOLLEY: usize = 32;

/// Coordinate of "no sample": farther than a radius from everything.
const EMPTY: f32 = -1.0e9;

/// Squared radius in cells.
const RADIUS_SQUARED: f32 = 2.0;

impl DartBoard {
    /// An empty board but for the nodes of its border.
    pub(super) fn new(extent: Extent, radius: f64, border: Vec<DVec2>) -> Self {
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
        // Dividing is dear, and half as dear in 32 bits.
        let (stride, pad) = (self.stride as u32, PAD as u32);
        let (row, column) = (open.cell / stride, open.cell % stride);
        ((column - pad) as f32, (row - pad) as f32)
    }

    /// The first of [`NEAR_ROWS`] × [`LANES`] cells that hold all discs which reach into one half of a cell: two cells
    /// to each side, more to fill whole registers. The second row beyond the other half is farther than a radius.
    fn near(&self, cell: u32, upper: bool) -> usize {
        cell as usize + usize::from(upper) * self.stride - 2 * (self.stride + 1)
    }

    /// The samples of `N` cells of a row.
    #[expect(
        clippy::inline_always,
        reason = "compiled for the instruction set of its caller"
    )]
    #[inline(always)]
    fn row<const N: usize>(&self, first: usize) -> (&[f32; N], &[f32; N]) {
        let [xs, ys] = [&self.xs, &self.ys].map(|samples| samples[first..].first_chunk());
        (xs.expect("a padded board"), ys.expect("a padded board"))
    }

    /// True if a disc covers the point of a dart.
    #[expect(
        clippy::inline_always,
        reason = "compiled for the instruction set of its caller"
    )]
    #[inline(always)]
    fn is_hit(&self, dart: &Dart) -> bool {
        // No row ends the search: to the processor, which of them has the disc is a coin toss, and dearer than all the
        // rows.
        let mut nearest = [f32::INFINITY; LANES];
        let first = self.near(dart.cell, dart.upper);
        for row in 0..NEAR_ROWS {
            let (xs, ys) = self.row::<LANES>(first + row * self.stride);
            keep_nearer(
                &mut nearest,
                &far_squared(xs, dart.x, 0.0),
                &far_squared(ys, dart.y, 0.0),
            );
        }
        any_within(&nearest)
    }

    /// Throws until there are `target` positions in all, or no room is left.
    pub(super) fn fill(&mut self, target: usize, rng: &mut Pcg64Mcg) {
        let mut open = self.empty_cells();
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
            open = split(self, &open, side);
        }
    }

    /// All cells without a sample, row by row.
    fn empty_cells(&self) -> Vec<Open> {
        let columns = self.stride - 2 * PAD;
        let square = |cell| Open {
            cell,
            sub_x: 0,
            sub_y: 0,
        };
        let mut open = vec![square(0); columns * self.rows];
        let mut count = 0;
        for row in 0..self.rows {
            let first = (row + PAD) * self.stride + PAD;
            for (cell, &x) in (first..).zip(&self.xs[first..first + columns]) {
                // Each is written, and the next one over it where it is taken: nearly none is, and asking costs more.
                open[count] = square(cell as u32);
                count += usize::from(x == EMPTY);
            }
        }
        open.truncate(count);
        open
    }

    /// One dart into each of a random `share` of the squares, unless their cell holds a sample by now.
    /// They are visited in steps of `stride`, round and round.
    ///
    /// Where darts fall depends on nothing but random words, so they are thrown in volleys: memory is waited for once
    /// for a whole volley, and only its own darts are looked at one after the other.
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
        let mut volley = Vec::with_capacity(VOLLEY);
        let mut landed: Vec<Dart> = Vec::with_capacity(VOLLEY);
        while next < open.len() {
            volley.clear();
            while next < open.len() && volley.len() < VOLLEY {
                let at = if stride == 1 {
                    next
                } else {
                    next * stride % open.len()
                };
                let square = open[at];
                // One random word serves a dart: 24 bits place it on each axis, others say where the next one falls.
                let word = rng.next_u64();
                next += usize::from(gaps[word as usize % GAPS]);
                let (west, south) = self.corner(square);
                let east = f32::from(square.sub_x) * side + (word >> 40) as f32 * step;
                let north = f32::from(square.sub_y) * side + (word >> 16 & 0xFF_FFFF) as f32 * step;
                volley.push(Dart {
                    cell: square.cell,
                    upper: north >= 0.5,
                    x: west + east,
                    y: south + north,
                });
            }
            volley.retain(|dart| self.is_empty(dart.cell));
            let mut hit = [false; VOLLEY];
            hits(self, &volley, &mut hit);
            landed.clear();
            for (dart, _) in volley.iter().zip(hit).filter(|&(_, hit)| !hit) {
                let blocks = |other: &Dart| {
                    other.cell == dart.cell || dart.squared_distance(other.x, other.y) < RADIUS_SQUARED
                };
                let p = DVec2::new(f64::from(dart.x), f64::from(dart.y)) * self.cell;
                // Strictly inside: the border has its own nodes.
                let inside = p.min_element() > 0.0 && p.x < self.extent.width && p.y < self.extent.height;
                if !inside || landed.iter().any(blocks) {
                    continue;
                }
                if self.positions.len() >= target {
                    return;
                }
                self.xs[dart.cell as usize] = dart.x;
                self.ys[dart.cell as usize] = dart.y;
                self.positions.push(p);
                landed.push(*dart);
            }
        }
    }

    /// Which [`QUARTERS`] of a square around (x, y) are covered by a single disc, whose sample lies in one of the `N`
    /// columns and of so many `rows` from the cell `first` on; `half` is half the square's side. All four where one
    /// disc covers the square.
    ///
    /// Without branches: to the processor, which discs cover what is a coin toss.
    #[expect(
        clippy::inline_always,
        reason = "compiled for the instruction set of its caller"
    )]
    #[inline(always)]
    fn covered_quarters<const N: usize>(
        &self,
        first: usize,
        rows: usize,
        (x, y): (f32, f32),
        half: f32,
    ) -> [bool; 4] {
        // Squared distances to the far corner of each quarter, and of the square.
        let mut far = [[f32::INFINITY; N]; 5];
        let quarter = 0.5 * half;
        for row in 0..rows {
            let (xs, ys) = self.row::<N>(first + row * self.stride);
            let west = far_squared(xs, x - quarter, quarter);
            let east = far_squared(xs, x + quarter, quarter);
            let south = far_squared(ys, y - quarter, quarter);
            let north = far_squared(ys, y + quarter, quarter);
            let [south_west, south_east, north_west, north_east, whole] = &mut far;
            keep_nearer(south_west, &west, &south);
            keep_nearer(south_east, &east, &south);
            keep_nearer(north_west, &west, &north);
            keep_nearer(north_east, &east, &north);
            keep_nearer(whole, &far_squared(xs, x, half), &far_squared(ys, y, half));
        }
        let mut covered = [false; 5];
        for (covered, far) in covered.iter_mut().zip(&far) {
            *covered = any_within(far);
        }
        let [quarters @ .., whole] = covered;
        quarters.map(|quarter| quarter | whole)
    }
}

/// Squares of the distances, along one axis, from samples to the far end of what reaches `half` to either side of
/// `middle`.
#[expect(
    clippy::inline_always,
    reason = "compiled for the instruction set of its caller"
)]
#[inline(always)]
fn far_squared<const N: usize>(samples: &[f32; N], middle: f32, half: f32) -> [f32; N] {
    let mut squares = [0.0; N];
    for (square, sample) in squares.iter_mut().zip(samples) {
        *square = ((sample - middle).abs() + half).powi(2);
    }
    squares
}

/// Keeps the smaller of what is there and a squared distance, lane by lane.
#[expect(
    clippy::inline_always,
    reason = "compiled for the instruction set of its caller"
)]
#[inline(always)]
fn keep_nearer<const N: usize>(nearest: &mut [f32; N], xx: &[f32; N], yy: &[f32; N]) {
    for (nearest, (xx, yy)) in nearest.iter_mut().zip(xx.iter().zip(yy)) {
        let squared = xx + yy;
        *nearest = if squared < *nearest { squared } else { *nearest };
    }
}

/// Whether any distance is below a radius.
#[expect(
    clippy::inline_always,
    reason = "compiled for the instruction set of its caller"
)]
#[inline(always)]
fn any_within<const N: usize>(nearest: &[f32; N]) -> bool {
    let mut within = false;
    for &squared in nearest {
        within |= squared < RADIUS_SQUARED;
    }
    within
}

/// Which darts of a volley a disc covers.
#[multiversion(targets("x86_64+avx2"))]
fn hits(board: &DartBoard, volley: &[Dart], hit: &mut [bool; VOLLEY]) {
    for (dart, hit) in volley.iter().zip(hit) {
        *hit = board.is_hit(dart);
    }
}

/// The quarters, of the given side, of the open squares that no single disc covers.
#[multiversion(targets("x86_64+avx2"))]
fn split(board: &DartBoard, open: &[Open], side: f32) -> Vec<Open> {
    let mut quarters = Vec::with_capacity(open.len());
    for &square in open.iter().filter(|square| board.is_empty(square.cell)) {
        let (west, south) = board.corner(square);
        let covered = if side >= 0.5 {
            // A disc that covers a quarter of a cell lies one cell away at most.
            let first = square.cell as usize - (board.stride + 1);
            board.covered_quarters::<4>(first, 3, (west + side, south + side), side)
        } else {
            let upper = f32::from(square.sub_y) * 2.0 * side >= 0.5;
            let (x, y) = (
                west + f32::from(2 * square.sub_x + 1) * side,
                south + f32::from(2 * square.sub_y + 1) * side,
            );
            board.covered_quarters::<LANES>(board.near(square.cell, upper), NEAR_ROWS, (x, y), side)
        };
        let (mut left, mut count) = ([square; 4], 0);
        for ((sub_x, sub_y), covered) in QUARTERS.into_iter().zip(covered) {
            left[count] = Open {
                cell: square.cell,
                sub_x: 2 * square.sub_x + sub_x,
                sub_y: 2 * square.sub_y + sub_y,
            };
            count += usize::from(!covered);
        }
        // Copying all four and taking some back costs less than asking how many.
        let kept = quarters.len() + count;
        quarters.extend_from_slice(&left);
        quarters.truncate(kept);
    }
    quarters
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
