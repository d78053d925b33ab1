//! Initial numbers of layers.

/// A matrix of orthonormal rows or columns, whichever are fewer, times `gain` (Saxe et al. 2014), from standard normal draws.
pub fn orthogonal(weight: &mut [f32], [rows, columns]: [usize; 2], gain: f64, normal: &mut impl FnMut() -> f64) {
    let (count, length) = if rows < columns { (rows, columns) } else { (columns, rows) };
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(count);
    while basis.len() < count {
        let mut next: Vec<f64> = (0..length).map(|_| normal()).collect();
        // Twice is enough for orthogonality to the last bits (Giraud et al. 2005).
        for _ in 0..2 {
            for known in &basis {
                let along: f64 = known.iter().zip(&next).map(|(a, b)| a * b).sum();
                next.iter_mut().zip(known).for_each(|(next, known)| *next -= along * known);
            }
        }
        let norm = next.iter().map(|value| value * value).sum::<f64>().sqrt();
        // Draws that depend on those before are drawn again: for normal draws that never happens.
        if norm > 1e-6 {
            next.iter_mut().for_each(|value| *value /= norm);
            basis.push(next);
        }
    }
    for (index, value) in weight.iter_mut().enumerate() {
        let (row, column) = (index / columns, index % columns);
        let unit = if rows < columns { basis[row][column] } else { basis[column][row] };
        *value = (gain * unit) as f32;
    }
}

/// Uniform within 1 / sqrt(inputs), from uniform draws on [0, 1): what PyTorch gives linear layers.
pub fn uniform_fan_in(values: &mut [f32], inputs: usize, uniform: &mut impl FnMut() -> f64) {
    let bound = 1.0 / (inputs as f64).sqrt();
    values.fill_with(|| (bound * (2.0 * uniform() - 1.0)) as f32);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_or_columns_are_orthogonal() {
        let mut state = 1_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        for [rows, columns] in [[3, 5], [5, 3], [4, 4], [1, 7]] {
            let mut weight = vec![0.0; rows * columns];
            orthogonal(&mut weight, [rows, columns], 2.0, &mut draw);
            let at = |row: usize, column: usize| f64::from(weight[row * columns + column]);
            let few = rows.min(columns);
            for i in 0..few {
                for j in 0..few {
                    let product: f64 = if rows < columns {
                        (0..columns).map(|k| at(i, k) * at(j, k)).sum()
                    } else {
                        (0..rows).map(|k| at(k, i) * at(k, j)).sum()
                    };
                    assert!((product - if i == j { 4.0 } else { 0.0 }).abs() < 1e-5);
                }
            }
        }
    }
}
