//! Regular grids of square cells over the land.

use glam::DVec2;

use crate::units::Extent;

/// A grid of square cells that covers an extent. Row 0 is the northernmost. Columns and rows are rounded up to whole
/// blocks of [`Grid::BLOCK`] cells; what sticks out of the extent does so evenly on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Columns.
    pub cols: usize,
    /// Rows.
    pub rows: usize,
    /// Size of a cell, metres.
    pub cell: f64,
    /// The grid's north-west corner, plan metres.
    pub north_west: DVec2,
}

impl Grid {
    /// Cells per side of a block: [`Grid::blocks`] is coarser by this factor.
    pub const BLOCK: usize = 4;

    /// A grid of about `cells` square cells over `extent`.
    pub fn over(extent: Extent, cells: usize) -> Self {
        let cell = (extent.area() / cells.max(1) as f64).sqrt();
        let whole =
            |size: f64| ((size / cell / Self::BLOCK as f64 - 1e-9).ceil().max(1.0) as usize) * Self::BLOCK;
        let (cols, rows) = (whole(extent.width), whole(extent.height));
        Self {
            cols,
            rows,
            cell,
            north_west: DVec2::new(
                (extent.width - cols as f64 * cell) / 2.0,
                f64::midpoint(extent.height, rows as f64 * cell),
            ),
        }
    }

    /// The coarser grid of whole blocks on the same land.
    #[must_use]
    pub fn blocks(&self) -> Self {
        Self {
            cols: self.cols / Self::BLOCK,
            rows: self.rows / Self::BLOCK,
            cell: self.cell * Self::BLOCK as f64,
            north_west: self.north_west,
        }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cols * self.rows
    }

    /// True for a grid without cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Centre of a cell, plan metres.
    pub fn centre(&self, col: usize, row: usize) -> DVec2 {
        self.corner(col, row) + DVec2::new(0.5, -0.5) * self.cell
    }

    /// North-west corner of a cell (also defined one past the last column and row), plan metres.
    pub fn corner(&self, col: usize, row: usize) -> DVec2 {
        self.north_west + DVec2::new(col as f64, -(row as f64)) * self.cell
    }

    /// Where `p` lies between cell centres: column and row of the cell to the north-west, and the fractions towards
    /// the next ones, clamped to the grid.
    pub(super) fn bilinear(&self, p: DVec2) -> (usize, usize, f64, f64) {
        let at = (p - self.north_west) / self.cell - DVec2::new(0.5, -0.5);
        let split = |v: f64, n: usize| {
            let last = n.saturating_sub(2) as f64;
            let v = if v.is_finite() {
                v.clamp(0.0, (n - 1) as f64)
            } else {
                0.0
            };
            let low = v.floor().min(last);
            (low as usize, v - low)
        };
        let (col, fx) = split(at.x, self.cols);
        let (row, fy) = split(-at.y, self.rows);
        (col, row, fx, fy)
    }
}

/// Values at the cell centres of a grid, row by row from the north.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The grid.
    pub grid: Grid,
    /// `cols × rows` values.
    pub data: Vec<f32>,
}

impl Field {
    /// The same value everywhere.
    pub fn constant(grid: Grid, value: f32) -> Self {
        Self {
            grid,
            data: vec![value; grid.len()],
        }
    }

    /// Bilinear value at `p` (plan metres); beyond the outermost centres the border value goes on.
    pub fn at(&self, p: DVec2) -> f64 {
        let (col, row, fx, fy) = self.grid.bilinear(p);
        let (east, south) = (
            (col + 1).min(self.grid.cols - 1),
            (row + 1).min(self.grid.rows - 1),
        );
        let value = |c: usize, r: usize| f64::from(self.data[r * self.grid.cols + c]);
        let north = value(col, row) * (1.0 - fx) + value(east, row) * fx;
        let below = value(col, south) * (1.0 - fx) + value(east, south) * fx;
        north * (1.0 - fy) + below * fy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_the_extent_evenly_with_square_cells() {
        let extent = Extent {
            width: 178_000.0,
            height: 100_000.0,
        };
        let grid = Grid::over(extent, 1024 * 1024);
        assert!((grid.len() as f64 / (1024.0 * 1024.0) - 1.0).abs() < 0.01);
        let (first, last) = (grid.corner(0, 0), grid.corner(grid.cols, grid.rows));
        assert!(first.x <= 0.0 && first.y >= extent.height);
        assert!(
            (first + last - extent.size()).length() < 1e-6,
            "the overhang is even"
        );
        assert_eq!(grid.blocks().len() * Grid::BLOCK * Grid::BLOCK, grid.len());
    }

    #[test]
    fn bilinear_reproduces_a_plane_and_clamps_beyond() {
        let grid = Grid::over(
            Extent {
                width: 40.0,
                height: 20.0,
            },
            800,
        );
        let mut field = Field::constant(grid, 0.0);
        for row in 0..grid.rows {
            for col in 0..grid.cols {
                let p = grid.centre(col, row);
                field.data[row * grid.cols + col] = (2.0 * p.x + 3.0 * p.y) as f32;
            }
        }
        let p = DVec2::new(11.3, 7.9);
        assert!((field.at(p) - (2.0 * p.x + 3.0 * p.y)).abs() < 1e-4);
        assert!(field.at(DVec2::new(-1e9, f64::NAN)).is_finite());
    }
}
