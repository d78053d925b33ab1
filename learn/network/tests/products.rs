//! Products of matrices: their bits are those of a plain loop.

use super::numbers;
use msk_network::{Kernel, Matrix, Processor};
use proptest::prelude::*;
use std::num::NonZeroUsize;

/// The definition: products added in the order of their index, each with one rounding.
fn plain(a: &[f32], b: &[f32], [rows, depth, columns]: [usize; 3], out: &mut [f32]) {
    for row in 0..rows {
        for column in 0..columns {
            for index in 0..depth {
                let out = &mut out[row * columns + column];
                *out = libm::fmaf(a[row * depth + index], b[index * columns + column], *out);
            }
        }
    }
}

fn transposed(values: &[f32], [rows, columns]: [usize; 2]) -> Vec<f32> {
    (0..values.len()).map(|index| values[(index % rows) * columns + index / rows]).collect()
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn compare([rows, depth, columns]: [usize; 3], salt: usize) {
    let (a, b) = (numbers(rows * depth, salt, 3.0), numbers(depth * columns, salt + 1, 1.0));
    let begin = numbers(rows * columns, salt + 2, 1.0);
    let mut expected = begin.clone();
    plain(&a, &b, [rows, depth, columns], &mut expected);
    let (turned_a, turned_b) = (transposed(&a, [rows, depth]), transposed(&b, [depth, columns]));
    let (plain_a, plain_b) = (Matrix::new(&a, rows, depth), Matrix::new(&b, depth, columns));
    let (turned_a, turned_b) =
        (Matrix::new(&turned_a, depth, rows).transposed(), Matrix::new(&turned_b, columns, depth).transposed());
    let threads = |count: usize| Processor::new(NonZeroUsize::new(count).unwrap()).unwrap();
    for kernel in [threads(1), threads(2), threads(5), Processor::narrow()] {
        for (a, b) in [(plain_a, plain_b), (plain_a, turned_b), (turned_a, plain_b), (turned_a, turned_b)] {
            let mut out = begin.clone();
            kernel.add_product(a, b, &mut out);
            assert_eq!(bits(&out), bits(&expected), "{rows} x {depth} x {columns} by {kernel:?}");
        }
    }
}

#[test]
fn large_products_have_the_bits_of_a_plain_loop_on_any_number_of_threads() {
    for shape in [[200, 300, 70], [97, 513, 33], [1, 1000, 300], [700, 1, 400], [14, 260, 1050]] {
        compare(shape, 3);
    }
}

#[test]
fn empty_products_change_nothing() {
    let mut out = [1.0; 4];
    let kernel = Processor::narrow();
    kernel.add_product(Matrix::new(&[], 2, 0), Matrix::new(&[], 0, 2), &mut out);
    assert_eq!(out, [1.0; 4]);
    kernel.add_product(Matrix::new(&[], 0, 3), Matrix::new(&[0.0; 6], 3, 2), &mut []);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn products_of_any_shape_have_the_bits_of_a_plain_loop(rows in 1..40_usize, depth in 0..40_usize, columns in 1..70_usize, salt in 0..1000_usize) {
        compare([rows, depth, columns], salt);
    }
}
