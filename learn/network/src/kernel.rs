//! The product of matrices, for which learning takes most of its time.

use pulp::{Arch, Simd, WithSimd, bytemuck};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::fmt::Debug;
use std::num::NonZeroUsize;

/// A view of numbers as a matrix: element (i, j) is number i * `strides[0]` + j * `strides[1]`, one of which is 1.
#[derive(Debug, Clone, Copy)]
pub struct Matrix<'a> {
    values: &'a [f32],
    rows: usize,
    columns: usize,
    strides: [usize; 2],
}

impl<'a> Matrix<'a> {
    /// Numbers that stand row by row.
    ///
    /// # Panics
    /// If their number is not rows times columns.
    pub fn new(values: &'a [f32], rows: usize, columns: usize) -> Self {
        assert_eq!(values.len(), rows * columns, "a matrix of {rows} x {columns}");
        Self { values, rows, columns, strides: [columns, 1] }
    }

    /// The same numbers with rows for columns.
    #[must_use]
    pub fn transposed(self) -> Self {
        let [row, column] = self.strides;
        Self { rows: self.columns, columns: self.rows, strides: [column, row], ..self }
    }
}

/// What multiplies matrices.
pub trait Kernel: Debug + Send + Sync {
    /// `out += a * b`, where `out` stands row by row. To each element the products are added in the order of their index, each with one
    /// rounding of product and sum.
    ///
    /// # Panics
    /// If the shapes do not fit.
    fn add_product(&self, a: Matrix<'_>, b: Matrix<'_>, out: &mut [f32]);
}

/// The processor, with one or more threads and the widest registers that it has.
#[derive(Debug)]
pub struct Processor {
    arch: Arch,
    /// None for the thread of the caller.
    pool: Option<ThreadPool>,
}

impl Processor {
    /// With so many threads.
    ///
    /// # Errors
    /// The operating system gives no threads.
    pub fn new(threads: NonZeroUsize) -> Result<Self, ThreadPoolBuildError> {
        let pool = (threads.get() > 1).then(|| ThreadPoolBuilder::new().num_threads(threads.get()).build()).transpose()?;
        Ok(Self { arch: Arch::new(), pool })
    }

    /// With one thread and the registers that every processor has: for tests.
    pub fn narrow() -> Self {
        Self { arch: Arch::Scalar, pool: None }
    }
}

/// Products below which threads are not worth their start.
const FEW: usize = 1 << 18;

impl Kernel for Processor {
    fn add_product(&self, a: Matrix<'_>, b: Matrix<'_>, out: &mut [f32]) {
        assert_eq!(a.columns, b.rows, "columns of the first factor and rows of the second");
        assert_eq!(out.len(), a.rows * b.columns, "elements of the product");
        if out.is_empty() {
            return;
        }
        match &self.pool {
            Some(pool) if a.rows * a.columns * b.columns > FEW => {
                let share = a.rows.div_ceil(pool.current_num_threads()).next_multiple_of(ROWS);
                let part = |(index, out): (usize, &mut [f32])| {
                    self.arch.dispatch(Product { a, b, first: index * share, out });
                };
                pool.install(|| out.par_chunks_mut(share * b.columns).enumerate().for_each(part));
            }
            _ => self.arch.dispatch(Product { a, b, first: 0, out }),
        }
    }
}

/// Rows of a tile, which stays in registers while products are added to it.
const ROWS: usize = 6;
/// Registers of a row of a tile.
const REGISTERS: usize = 2;
/// Numbers of the widest register.
const WIDEST: usize = 16;
/// Products that are added before the tile goes back to memory.
const DEPTH: usize = 256;
/// Tiles for which factors are copied together: 16 of them are 96 rows.
const TILES: usize = 16;

/// The rows of a product from `first` on, as many as `out` has.
struct Product<'a> {
    a: Matrix<'a>,
    b: Matrix<'a>,
    first: usize,
    out: &'a mut [f32],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { a, b, first, out } = self;
        let (width, columns) = (REGISTERS * S::F32_LANES, b.columns);
        // Copies in the order in which tiles read them.
        let mut left = [[[0.0_f32; ROWS]; DEPTH]; TILES];
        let mut right = [[0.0_f32; REGISTERS * WIDEST]; DEPTH];
        for (block, out) in out.chunks_mut(TILES * ROWS * columns).enumerate() {
            let top = first + block * TILES * ROWS;
            for from in (0..a.columns).step_by(DEPTH) {
                let depth = DEPTH.min(a.columns - from);
                copy_left(a, [top, out.len() / columns], [from, depth], &mut left);
                for column in (0..columns).step_by(width) {
                    let wide = width.min(columns - column);
                    let right: &mut [f32] = &mut right.as_flattened_mut()[..depth * width];
                    copy_right(b, from, column, wide, width, right);
                    let right: &[[S::f32s; REGISTERS]] = bytemuck::cast_slice(right);
                    for (left, out) in left.iter().zip(out.chunks_mut(ROWS * columns)) {
                        tile(simd, &left[..depth], right, out, columns, column, wide);
                    }
                }
            }
        }
    }
}

/// Copies `rows` rows from row `top` on, `depth` columns from `from` on: tile after tile, column after column. What lacks to the last tile
/// stays as it is: it is not used.
#[inline(always)]
fn copy_left(a: Matrix<'_>, [top, rows]: [usize; 2], [from, depth]: [usize; 2], left: &mut [[[f32; ROWS]; DEPTH]]) {
    let [row_stride, column_stride] = a.strides;
    let begin = top * row_stride + from * column_stride;
    if row_stride == 1 {
        for column in 0..depth {
            let values = &a.values[begin + column * column_stride..][..rows];
            for (left, values) in left.iter_mut().zip(values.chunks(ROWS)) {
                match <&[f32; ROWS]>::try_from(values) {
                    Ok(whole) => left[column] = *whole,
                    Err(_) => left[column][..values.len()].copy_from_slice(values),
                }
            }
        }
        return;
    }
    for row in 0..rows {
        let left = &mut left[row / ROWS][..depth];
        for (left, value) in left.iter_mut().zip(&a.values[begin + row * row_stride..]) {
            left[row % ROWS] = *value;
        }
    }
}

/// Copies rows from `from` on, as many as `right` takes, of `wide` columns from `column` on; what lacks to `width` is 0.
#[inline(always)]
fn copy_right(b: Matrix<'_>, from: usize, column: usize, wide: usize, width: usize, right: &mut [f32]) {
    /// Numbers of a line of the cache.
    const LINE: usize = 16;
    let [row_stride, column_stride] = b.strides;
    if column_stride == 1 {
        for (row, right) in right.chunks_exact_mut(width).enumerate() {
            let begin = (from + row) * row_stride + column;
            right[..wide].copy_from_slice(&b.values[begin..begin + wide]);
            right[wide..].fill(0.0);
        }
        return;
    }
    if wide < width {
        right.fill(0.0);
    }
    // A transposition, in blocks that stay in the cache.
    for (block, right) in right.chunks_mut(LINE * width).enumerate() {
        let begin = from + block * LINE + column * column_stride;
        for place in 0..wide {
            let values = &b.values[begin + place * column_stride..];
            for (right, value) in right.chunks_exact_mut(width).zip(values) {
                right[place] = *value;
            }
        }
    }
}

/// Adds the product of copied factors to a tile of `out`, whose rows begin at `column` and are `wide`.
#[inline(always)]
fn tile<S: Simd>(
    simd: S,
    left: &[[f32; ROWS]],
    right: &[[S::f32s; REGISTERS]],
    out: &mut [f32],
    columns: usize,
    column: usize,
    wide: usize,
) {
    let mut sums = [[simd.splat_f32s(0.0); REGISTERS]; ROWS];
    let lanes = S::F32_LANES;
    let part = |register: usize| (register * lanes).min(wide)..((register + 1) * lanes).min(wide);
    for (sums, row) in sums.iter_mut().zip(out.chunks(columns)) {
        for (register, sum) in sums.iter_mut().enumerate() {
            *sum = simd.partial_load_f32s(&row[column..column + wide][part(register)]);
        }
    }
    for (left, right) in left.iter().zip(right) {
        for (sums, left) in sums.iter_mut().zip(left) {
            let left = simd.splat_f32s(*left);
            for (sum, right) in sums.iter_mut().zip(right) {
                *sum = simd.mul_add_f32s(left, *right, *sum);
            }
        }
    }
    for (sums, row) in sums.iter().zip(out.chunks_mut(columns)) {
        for (register, sum) in sums.iter().enumerate() {
            simd.partial_store_f32s(&mut row[column..column + wide][part(register)], *sum);
        }
    }
}
