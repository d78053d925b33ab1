//! The compromise between wishes for accelerations: weighted least squares over the independent coordinates.
//!
//! Each coordinate has a wish of its own, or none; points of the feet wish with a Jacobian that few coordinates have a part in, the
//! centre of mass (Jacobian J, wish a, weights S²) with one that all have. With A the normal matrix of the others, and r their right-hand
//! side, (A + J'S²J) ẇ = r + J'S²a is the same as
//!
//! > A ẇ + J'S μ = r,   S J ẇ - μ = S a,
//!
//! which keeps the sparsity of A. It is symmetric quasi-definite, so any order of elimination has its factors (R. J. Vanderbei, Symmetric
//! quasidefinite matrices, SIAM J. Optim. 5, 1995). The joints come first, then μ, then the root, so that every pivot is the
//! sum of terms of one sign. A joint that moves no foot then meets the others in the three entries of μ alone. All is written over
//! [`Real`], for one episode or for eight in lanes.

use super::coordinates::Coordinates;
use super::motion::Moved;
use msk_physics::path_matrix::PathPattern;
use msk_physics::scalar::Real;
use msk_physics::spatial::dot;
use nalgebra::Vector3;

/// Keeps what no wish asks for at rest.
const REST: f64 = 1e-6;

/// The system of one control step.
#[derive(Debug, Clone)]
pub(super) struct Compromise<T> {
    pattern: PathPattern,
    /// Where each coordinate stands among the unknowns, and where the three of μ begin.
    place: Vec<usize>,
    multiplier: usize,
    matrix: Vec<T>,
    /// The right-hand side, then the answer.
    x: Vec<T>,
}

impl<T: Real> Compromise<T> {
    /// Memory for wishes of these points of the feet, and of the centre of mass of what hangs on a free root.
    pub fn new<'a>(
        coordinates: &Coordinates,
        (centre, root): (Option<&Moved>, impl Iterator<Item = usize>),
        feet: impl Iterator<Item = &'a Moved>,
    ) -> Self {
        let size = coordinates.len();
        let multiplier = root.filter_map(|dof| coordinates.of(dof)).max().map_or(0, |last| last + 1);
        let place: Vec<usize> = (0..size).map(|index| if index < multiplier { index } else { index + 3 }).collect();
        let path = |moved: &Moved| -> Vec<usize> { moved.coordinates.iter().map(|&coordinate| place[coordinate]).collect() };
        let mut paths: Vec<Vec<usize>> = feet.map(path).collect();
        for coordinate in centre.iter().flat_map(|centre| &centre.coordinates) {
            let mut path: Vec<usize> = (multiplier..multiplier + 3).chain([place[*coordinate]]).collect();
            path.sort_unstable();
            paths.push(path);
        }
        let mut pattern = PathPattern::default();
        pattern.rebuild(&vec![None; size + 3], paths.iter().map(Vec::as_slice));
        let zeros = |size: usize| vec![T::splat(0.0); size];
        Self { matrix: zeros(pattern.column.len()), x: zeros(size + 3), pattern, place, multiplier }
    }

    /// Begins with the wishes of the coordinates: of each its weight, squared, and that times the acceleration wished for.
    #[inline(always)]
    pub fn begin(&mut self, wishes: &[[T; 2]]) {
        self.matrix.fill(T::splat(0.0));
        self.x.fill(T::splat(0.0));
        for (&place, &[weight, weighted]) in self.place.iter().zip(wishes) {
            self.matrix[self.pattern.row[place].end - 1] = T::splat(REST) + weight;
            self.x[place] = weighted;
        }
        for axis in self.multiplier..self.multiplier + 3 {
            self.matrix[self.pattern.row[axis].end - 1] = T::splat(-1.0);
        }
    }

    /// Adds the wish for an acceleration (m/s²) of a point that moves with these coordinates like that; `weight` is squared already.
    #[inline(always)]
    pub fn add_point(&mut self, (moved, motion): (&Moved, &[Vector3<T>]), wish: &Vector3<T>, weight: T) {
        for (count, (&coordinate, column)) in moved.coordinates.iter().zip(motion).enumerate() {
            let row = self.place[coordinate];
            let weighted = column.map(
                #[inline(always)]
                |part| part * weight,
            );
            self.x[row] += dot(&weighted, wish);
            let target = &mut self.matrix[self.pattern.row[row].clone()];
            for (&earlier, other) in moved.coordinates[..=count].iter().zip(motion) {
                T::apart();
                target[self.pattern.depth(self.place[earlier])] += dot(&weighted, other);
            }
        }
    }

    /// Sets the wish for an acceleration (m/s²) of the centre of mass, which moves with these coordinates like that; `weight` is not
    /// squared.
    #[inline(always)]
    pub fn set_centre(&mut self, (moved, motion): (&Moved, &[Vector3<T>]), wish: &Vector3<T>, weight: &Vector3<T>) {
        for axis in 0..3 {
            let multiplier = self.multiplier + axis;
            self.x[multiplier] = weight[axis] * wish[axis];
            for (&coordinate, column) in moved.coordinates.iter().zip(motion) {
                T::apart();
                let place = self.place[coordinate];
                let (row, column_place) = (place.max(multiplier), place.min(multiplier));
                self.matrix[self.pattern.row[row].start + self.pattern.depth(column_place)] = weight[axis] * column[axis];
            }
        }
    }

    /// Writes the acceleration of each coordinate.
    #[inline(always)]
    pub fn settle(&mut self, accelerations: &mut [T]) {
        self.pattern.layout().factor(&mut self.matrix);
        self.pattern.layout().solve(&self.matrix, &mut self.x);
        for (acceleration, &place) in accelerations.iter_mut().zip(&self.place) {
            *acceleration = self.x[place];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_physics::model::Model;
    use nalgebra::{DMatrix, DVector, Matrix3xX};
    use proptest::prelude::*;

    /// A trunk with two legs and an arm.
    const TREE: &str = r#"<mujoco><worldbody>
        <body><freejoint/><geom size="0.1"/>
          <body><joint name="a"/><geom size="0.1"/><body><joint name="b"/><geom size="0.1"/></body></body>
          <body><joint name="c"/><geom size="0.1"/><body><joint name="d"/><geom size="0.1"/></body></body>
          <body><joint name="e"/><geom size="0.1"/></body>
        </body></worldbody></mujoco>"#;
    const SIZE: usize = 11;

    fn numbers(count: usize) -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-1.0..1.0_f64, count)
    }

    fn vectors(values: &[f64]) -> Vec<Vector3<f64>> {
        values.chunks_exact(3).map(Vector3::from_column_slice).collect()
    }

    proptest! {
        #[test]
        fn it_is_the_least_squares_answer(
            own in numbers(2 * SIZE), centre in numbers(3 * SIZE), feet in prop::array::uniform2(numbers(24)),
            wishes in prop::array::uniform3(numbers(3)), counts in prop::array::uniform3(any::<bool>()),
        ) {
            let model = Model::from_mjcf(TREE).unwrap();
            let coordinates = Coordinates::new(&model);
            let moved = [3, 5].map(|body| Moved::body(&model, &coordinates, body));
            let whole = Moved::subtree(&model, &coordinates, 1);
            let mut compromise = Compromise::<f64>::new(&coordinates, (Some(&whole), 0..6), moved.iter());
            let own: Vec<[f64; 2]> = own.chunks_exact(2).map(|pair| [0.1 + pair[0].abs(), pair[1]]).collect();
            compromise.begin(&own);
            let mut normal = DMatrix::from_diagonal(&DVector::from_iterator(SIZE, own.iter().map(|wish| wish[0] + REST)));
            let mut right = DVector::from_iterator(SIZE, own.iter().map(|wish| wish[1]));
            let mut expect = |moved: &Moved, motion: &[Vector3<f64>], wish: &Vector3<f64>, weight: Vector3<f64>| {
                let mut jacobian = Matrix3xX::zeros(SIZE);
                moved.coordinates.iter().zip(motion).for_each(|(&row, column)| jacobian.set_column(row, column));
                let weighted = nalgebra::Matrix3::from_diagonal(&weight) * &jacobian;
                normal += jacobian.transpose() * &weighted;
                right += weighted.transpose() * wish;
            };
            for ((moved, foot), (wish, counts)) in moved.iter().zip(&feet).zip(wishes.iter().zip(counts)) {
                let (motion, wish, weight) = (vectors(foot), Vector3::from_column_slice(wish), if counts { 2.0 } else { 0.0 });
                compromise.add_point((moved, &motion), &wish, weight);
                expect(moved, &motion, &wish, Vector3::repeat(weight));
            }
            let (motion, wish) = (vectors(&centre), Vector3::from_column_slice(&wishes[2]));
            let weight = if counts[2] { Vector3::new(3.0, 2.0, 1.5) } else { Vector3::zeros() };
            compromise.set_centre((&whole, &motion), &wish, &weight);
            expect(&whole, &motion, &wish, weight.component_mul(&weight));
            let mut found = [0.0; SIZE];
            compromise.settle(&mut found);
            let expected = normal.cholesky().unwrap().solve(&right);
            for (found, expected) in found.iter().zip(&expected) {
                prop_assert!((found - expected).abs() < 1e-10 * (1.0 + expected.abs()), "{found} is not {expected}");
            }
        }
    }

    #[test]
    fn what_no_wish_asks_for_rests() {
        let model = Model::from_mjcf(TREE).unwrap();
        let coordinates = Coordinates::new(&model);
        let mut compromise = Compromise::<f64>::new(&coordinates, (None, 0..6), core::iter::empty());
        compromise.begin(&[[0.0; 2]; SIZE]);
        let mut found = [1.0; SIZE];
        compromise.settle(&mut found);
        assert_eq!(found, [0.0; SIZE]);
    }
}
