//! What the sun sees: depths from above, so that ground and scenery know what stands between.

use super::Vector;
use super::geometry::Layers;
use super::raster::{Band, cover};

/// Cells of a side.
const CELLS: usize = 1024;
/// Half the width of what is looked at, m.
const HALF: f32 = 1.9;
/// What is nearer than this to a surface does not shade it, m.
const BIAS: f32 = 0.012;
/// Cells to each side over which the edge of a shadow is spread, and their distance.
const SPREAD: [i32; 2] = [3, 2];
/// Cells of the side of a block, more than a shadow is spread.
const BLOCK: usize = 8;
const BLOCKS: usize = CELLS / BLOCK;

/// Direction to the sun, not a unit vector.
const SUN: Vector = Vector::new(0.35, -0.45, 1.0);

/// Direction to the sun.
pub(super) fn sun() -> Vector {
    SUN.normalize()
}

/// Heights along the direction to the sun, of what is nearest to it.
pub(super) struct Shadow {
    centre: Vector,
    axes: [Vector; 3],
    heights: Vec<f32>,
    /// Blocks in or beside which anything is.
    near: Vec<bool>,
}

impl Shadow {
    /// Of what is solid and of the skin around it.
    pub fn of(layers: &Layers, centre: Vector) -> Self {
        let z = sun();
        let x = Vector::y().cross(&z).normalize();
        let mut this = Self {
            centre: Vector::new(centre.x, centre.y, 0.8),
            axes: [x, z.cross(&x), z],
            heights: vec![f32::NEG_INFINITY; CELLS * CELLS],
            near: vec![false; BLOCKS * BLOCKS],
        };
        let casting = [(&layers.solid, layers.casting), (&layers.shells[0], layers.shells[0].triangles.len())];
        for (surface, count) in casting {
            let places: Vec<[f32; 3]> = surface.corners.iter().map(|corner| this.place(&corner.place)).collect();
            surface.triangles[..count]
                .iter()
                .for_each(|triangle| this.cast(triangle.corners.map(|corner| places[corner as usize])));
        }
        this.find_near();
        this
    }

    fn find_near(&mut self) {
        for (y, row) in self.heights.chunks_exact(CELLS).enumerate() {
            for (x, _) in row.iter().enumerate().filter(|(_, height)| **height > f32::NEG_INFINITY) {
                let around = |cell: usize| (cell / BLOCK).saturating_sub(1)..=(cell / BLOCK + 1).min(BLOCKS - 1);
                around(y).for_each(|y| self.near[y * BLOCKS..][around(x)].fill(true));
            }
        }
    }

    /// Column, row and height of a place.
    fn place(&self, at: &Vector) -> [f32; 3] {
        let from = at - self.centre;
        let cell = |axis: usize| (from.dot(&self.axes[axis]) / HALF * 0.5 + 0.5) * CELLS as f32;
        [cell(0), cell(1), from.dot(&self.axes[2])]
    }

    fn cast(&mut self, corners: [[f32; 3]; 3]) {
        let band = Band { width: CELLS, rows: [0, CELLS] };
        cover(&band, corners.map(|[x, y, _]| [x, y]), |x, y, weights| {
            let height = weights[0] * corners[0][2] + weights[1] * corners[1][2] + weights[2] * corners[2][2];
            let cell = &mut self.heights[y * CELLS + x];
            *cell = cell.max(height);
        });
    }

    /// Share of the sun's light that reaches a place, 0 to 1.
    pub fn light(&self, at: &Vector) -> f32 {
        let [column, row, height] = self.place(at);
        let [count, step] = SPREAD;
        let inside = |cell: i32| usize::try_from(cell).ok().filter(|cell| *cell < CELLS);
        let (column, row) = (column.floor() as i32, row.floor() as i32);
        let block = inside(row).zip(inside(column)).map(|(row, column)| row / BLOCK * BLOCKS + column / BLOCK);
        if !block.is_some_and(|block| self.near[block]) {
            return 1.0;
        }
        let mut shaded = 0;
        for y in (-count..=count).map(|index| row + index * step) {
            for x in (-count..=count).map(|index| column + index * step) {
                let cell = inside(y).zip(inside(x)).map(|(y, x)| self.heights[y * CELLS + x]);
                shaded += i32::from(cell.is_some_and(|found| found > height + BIAS));
            }
        }
        let all = (2 * count + 1) * (2 * count + 1);
        1.0 - shaded as f32 / all as f32
    }
}
