//! The product of matrices, for which learning takes most of its time.

use pulp::{Arch, Simd, WithSimd, bytemuck};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::cell::RefCell;
use std::fmt::Debug;
use std::num::NonZeroUsize;
use std::ops::Range;

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
    /// Numbers of a register.
    lanes: usize,
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
        let arch = Arch::new();
        Ok(Self { arch, lanes: arch.dispatch(Lanes), pool })
    }

    /// With one thread and the registers that every processor has: for tests.
    pub fn narrow() -> Self {
        Self { arch: Arch::Scalar, lanes: Arch::Scalar.dispatch(Lanes), pool: None }
    }

    /// The rows of a product from `first` on, as many as `out` has.
    fn rows(&self, a: Matrix<'_>, b: Matrix<'_>, first: usize, out: &mut [f32]) {
        PACKED.with_borrow_mut(|[left, right]| {
            let (width, columns) = (REGISTERS * self.lanes, b.columns);
            for from in (0..a.columns).step_by(DEPTH) {
                let depth = DEPTH.min(a.columns - from);
                for block in (0..columns).step_by(COLUMNS) {
                    let end = columns.min(block + COLUMNS);
                    let strips = || (block..end).step_by(width).map(|column| column..end.min(column + width));
                    let panels = aligned(right, depth * width * strips().len());
                    for (panel, strip) in panels.chunks_exact_mut(depth * width).zip(strips()) {
                        pack_right(b, from, strip, width, panel);
                    }
                    for (index, out) in out.chunks_mut(ROWS * columns).enumerate() {
                        let left = aligned(left, depth * ROWS);
                        pack_left(a, first + index * ROWS, out.len() / columns, from, left);
                        for (panel, strip) in panels.chunks_exact(depth * width).zip(strips()) {
                            self.tile(left, panel, out, columns, strip);
                        }
                    }
                }
            }
        });
    }

    /// Adds the product of packed factors to some columns of at most [`ROWS`] rows of `out`.
    fn tile(&self, left: &[f32], right: &[f32], out: &mut [f32], columns: usize, within: Range<usize>) {
        if within.len() == REGISTERS * self.lanes && out.len() == ROWS * columns {
            return self.arch.dispatch(Tile { left, right, out: &mut out[within.start..], stride: columns });
        }
        let mut whole = [[0.0; REGISTERS * LINE]; ROWS];
        for (whole, row) in whole.iter_mut().zip(out.chunks(columns)) {
            whole[..within.len()].copy_from_slice(&row[within.clone()]);
        }
        self.arch.dispatch(Tile { left, right, out: whole.as_flattened_mut(), stride: REGISTERS * LINE });
        for (whole, row) in whole.iter().zip(out.chunks_mut(columns)) {
            row[within.clone()].copy_from_slice(&whole[..within.len()]);
        }
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
                let part = |(index, out): (usize, &mut [f32])| self.rows(a, b, index * share, out);
                pool.install(|| out.par_chunks_mut(share * b.columns).enumerate().for_each(part));
            }
            _ => self.rows(a, b, 0, out),
        }
    }
}

/// Rows of a tile, which stays in registers while products are added to it.
const ROWS: usize = 6;
/// Registers of a row of a tile.
const REGISTERS: usize = 2;
/// Products that are added before the tile goes back to memory.
const DEPTH: usize = 256;
/// Columns of the second factor that are packed together, for all rows of the first.
const COLUMNS: usize = 512;
/// Numbers of a cache line, and of the widest register.
const LINE: usize = 16;

thread_local! {
    /// Parts of both factors, packed in the order in which tiles read them; the buffers stay with their thread.
    static PACKED: RefCell<[Vec<f32>; 2]> = const { RefCell::new([Vec::new(), Vec::new()]) };
}

/// How many numbers a register has.
struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F32_LANES
    }
}

/// Adds the product of packed factors to a tile, whose rows begin `stride` apart in `out`.
struct Tile<'a> {
    left: &'a [f32],
    right: &'a [f32],
    out: &'a mut [f32],
    stride: usize,
}

impl WithSimd for Tile<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { left, right, out, stride } = self;
        let (left, _) = left.as_chunks::<ROWS>();
        let right: &[[S::f32s; REGISTERS]] = bytemuck::cast_slice(right);
        let mut sums = [[simd.splat_f32s(0.0); REGISTERS]; ROWS];
        for (row, sums) in sums.iter_mut().enumerate() {
            sums.copy_from_slice(bytemuck::cast_slice(&out[row * stride..][..REGISTERS * S::F32_LANES]));
        }
        for (left, right) in left.iter().zip(right) {
            for (sums, left) in sums.iter_mut().zip(left) {
                let left = simd.splat_f32s(*left);
                for (sum, right) in sums.iter_mut().zip(right) {
                    *sum = simd.mul_add_f32s(left, *right, *sum);
                }
            }
        }
        for (row, sums) in sums.iter().enumerate() {
            out[row * stride..][..REGISTERS * S::F32_LANES].copy_from_slice(bytemuck::cast_slice(sums));
        }
    }
}

/// A slice of `count` numbers of a buffer that is aligned to cache lines, so that no load of a register touches two of them.
fn aligned(buffer: &mut Vec<f32>, count: usize) -> &mut [f32] {
    if buffer.len() < count + LINE {
        buffer.resize(count + LINE, 0.0);
    }
    let begin = buffer.as_ptr().align_offset(LINE * size_of::<f32>()).min(LINE);
    &mut buffer[begin..begin + count]
}

/// Packs `rows` rows from row `top` on, columns from `from` on: column after column. What lacks to a tile is not used.
fn pack_left(a: Matrix<'_>, top: usize, rows: usize, from: usize, left: &mut [f32]) {
    let [row_stride, column_stride] = a.strides;
    let values = &a.values[top * row_stride + from * column_stride..];
    let (left, _) = left.as_chunks_mut::<ROWS>();
    if row_stride == 1 {
        for (column, left) in left.iter_mut().enumerate() {
            let values = &values[column * column_stride..][..rows];
            match <&[f32; ROWS]>::try_from(values) {
                Ok(whole) => *left = *whole,
                Err(_) => left[..rows].copy_from_slice(values),
            }
        }
        return;
    }
    // Rows that lack are copies of the first.
    let depth = left.len();
    let mut parts = [&values[..depth]; ROWS];
    for (row, part) in parts.iter_mut().enumerate().take(rows) {
        *part = &values[row * row_stride..][..depth];
    }
    for (column, left) in left.iter_mut().enumerate() {
        for (left, part) in left.iter_mut().zip(&parts) {
            *left = part[column];
        }
    }
}

/// Packs some columns of the rows from `from` on, as many as `right` takes; what lacks to `width` columns is 0.
fn pack_right(b: Matrix<'_>, from: usize, columns: Range<usize>, width: usize, right: &mut [f32]) {
    let [row_stride, column_stride] = b.strides;
    let values = &b.values[from * row_stride + columns.start * column_stride..];
    let wide = columns.len();
    if column_stride == 1 {
        for (row, right) in right.chunks_exact_mut(width).enumerate() {
            right[..wide].copy_from_slice(&values[row * row_stride..][..wide]);
            right[wide..].fill(0.0);
        }
        return;
    }
    if wide < width {
        right.fill(0.0);
    }
    // A transposition, in blocks that stay in the cache.
    for (block, right) in right.chunks_mut(LINE * width).enumerate() {
        for place in 0..wide {
            let values = &values[block * LINE + place * column_stride..];
            for (right, value) in right.chunks_exact_mut(width).zip(values) {
                right[place] = *value;
            }
        }
    }
}
