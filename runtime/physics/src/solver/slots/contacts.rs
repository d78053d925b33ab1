//! Rows of contacts, computed at once in all lanes in which a pair of shapes touches. Operation by operation what
//! [`Constraints::build`](crate::constraint::Constraints::build) computes in one lane; elliptic cones are not solved in lanes.

use super::{
    Row, Slot, Slots, Source,
    merge::{END, Key, candidate_of},
};
use crate::{
    collision::CollisionPair,
    constraint::{
        CrossCoupling,
        contacts::drift,
        impedance::Spring,
        jacobian::MOST_BASE_ROWS,
        rows::{ONE_WAY, regularization},
        shortest_time_constant,
    },
    scalar::Real,
    spatial::{cross, minus, plus, rotate, scale, zero},
};
use nalgebra::{Matrix3, Vector3};

/// A contact in the lanes that have it, zero in the others.
struct Touch<T: Real> {
    has: T::Mask,
    position: Vector3<T>,
    frame: Matrix3<T>,
    distance: T,
    /// Where a body is moved from outside, and its velocity along and about the axes of the frame.
    moves: T::Mask,
    drift: [T; MOST_BASE_ROWS],
}

impl<T: Real> Slots<T> {
    /// Appends the contacts of all lanes, which are the last constraints.
    #[inline(always)]
    pub(super) fn add_contacts(&mut self, source: &Source<'_, T>) {
        loop {
            let key = self.merge.least();
            if key == END {
                return;
            }
            let number = candidate_of(key);
            let candidate = &source.pairs.candidates[number];
            let touch = self.take_touch(source, candidate, key);
            if candidate.bridges_chains && self.cross_couplings.last() != Some(&CrossCoupling::Contact(number)) {
                self.cross_couplings.push(CrossCoupling::Contact(number));
            }
            let (columns, values, row, frictions) =
                (self.columns.len(), self.values.len(), self.rows.len(), self.frictions.len());
            let (dimension, pyramid) = (candidate.dimension, candidate.dimension > 1);
            self.columns.extend_from_slice(&source.pairs.columns[candidate.columns.clone()]);
            let speed = match dimension {
                1 => self.add_base_rows::<1>(source, candidate, &touch),
                3 => self.add_base_rows::<3>(source, candidate, &touch),
                4 => self.add_base_rows::<4>(source, candidate, &touch),
                _ => self.add_base_rows::<MOST_BASE_ROWS>(source, candidate, &touch),
            };
            self.add_laws(source, candidate, &touch, &speed);
            let (rows, columns) = (row..self.rows.len(), columns..self.columns.len());
            self.slots.push(Slot { rows, columns, values, dimension, pyramid, frictions });
            self.keys.push(key);
            self.occupied = T::or(self.occupied, touch.has);
        }
    }

    /// Takes the contact of a key from the lanes that have it.
    fn take_touch(&mut self, source: &Source<'_, T>, candidate: &CollisionPair, key: Key) -> Touch<T> {
        let (none, nothing) = (T::mask(|_| false), T::splat(0.0));
        let mut touch = Touch {
            has: none,
            position: zero(),
            frame: Matrix3::from_element(nothing),
            distance: nothing,
            moves: none,
            drift: [nothing; MOST_BASE_ROWS],
        };
        for (lane, own) in source.lanes.iter().enumerate().take(T::LANES) {
            let Some(index) = self.merge.take(lane, key) else { continue };
            let contact = &own.constraints.contacts[index];
            let only = T::mask(|other| other == lane);
            touch.has = T::or(touch.has, only);
            touch.distance.set_lane(lane, contact.distance);
            touch.position.iter_mut().zip(&contact.position).for_each(|(to, from)| to.set_lane(lane, *from));
            touch.frame.iter_mut().zip(&contact.frame).for_each(|(to, from)| to.set_lane(lane, *from));
            if let Some(drift) = drift(source.model, source.state, source.kinematics, lane, (candidate, contact)) {
                touch.moves = T::or(touch.moves, only);
                touch.drift.iter_mut().zip(drift).for_each(|(to, from)| to.set_lane(lane, from));
            }
        }
        touch
    }

    /// Appends the base rows of a contact, and returns their velocities.
    #[inline(always)]
    fn add_base_rows<const ROWS: usize>(
        &mut self,
        source: &Source<'_, T>,
        candidate: &CollisionPair,
        touch: &Touch<T>,
    ) -> [T; MOST_BASE_ROWS] {
        let Source { model, pairs, state, kinematics, .. } = source;
        let columns = &pairs.columns[candidate.columns.clone()];
        let sides = &pairs.sides[candidate.columns.clone()];
        let (width, start) = (columns.len(), self.values.len());
        self.values.resize(start + ROWS * width, T::splat(0.0));
        let values = &mut self.values[start..];
        let mut speed = [T::splat(-0.0); MOST_BASE_ROWS];
        for (column, (&dof, &side)) in columns.iter().zip(sides).enumerate() {
            T::apart();
            let side = T::splat(side);
            let reference = kinematics.reference(model, model.dofs.body[dof]);
            let [angular, linear] = &kinematics.dof_axis[dof];
            let arm = minus(&touch.position, reference);
            let along = scale(&rotate(&touch.frame, &plus(linear, &cross(angular, &arm))), side);
            let mut base = [along.x, along.y, along.z, along.x, along.x, along.x];
            if ROWS > 3 {
                let about = scale(&rotate(&touch.frame, angular), side);
                (base[3], base[4], base[5]) = (about.x, about.y, about.z);
            }
            let velocity = state.velocity[dof];
            for row in 0..ROWS {
                values[row * width + column] = base[row];
                speed[row] += base[row] * velocity;
            }
        }
        speed
    }

    /// Appends the rows of a contact: two edges of its pyramid for each direction of friction, or the normal alone.
    #[inline(always)]
    fn add_laws(&mut self, source: &Source<'_, T>, candidate: &CollisionPair, touch: &Touch<T>, speed: &[T; MOST_BASE_ROWS]) {
        let spring = Spring::new(&candidate.softness, shortest_time_constant(source.model));
        let depth = touch.distance - T::splat(candidate.margin);
        let impedance = spring.impedance(depth);
        let pull = T::splat(spring.stiffness) * impedance * depth;
        let translation = T::splat(candidate.inverse_weight[0]);
        let damping = -T::splat(spring.damping);
        let directions = candidate.dimension - 1;
        if directions == 0 {
            let velocity = T::select(touch.moves, speed[0] + touch.drift[0], speed[0]);
            let row = Row::new(touch.has, regularization(impedance, translation), damping * velocity - pull, ONE_WAY);
            return self.rows.push(row);
        }
        let friction = candidate.friction_with(|geom| source.state.friction[geom]);
        self.frictions.extend_from_slice(&friction[..directions]);
        // All edges share one regularisation, that of the first scaled to keep the normal's stiffness (MuJoCo's pyramid).
        let sliding = friction[0] * friction[0] / T::splat(source.model.options.impedance_ratio);
        let first = regularization(impedance, translation + friction[0] * friction[0] * translation);
        let common = (T::splat(2.0) * sliding * first).at_least(T::splat(1e-15));
        for direction in 0..directions {
            let tangent = friction[direction] * speed[direction + 1];
            let drift = friction[direction] * touch.drift[direction + 1];
            let (up, down) = (speed[0] + tangent, speed[0] - tangent);
            let up = T::select(touch.moves, up + (touch.drift[0] + drift), up);
            let down = T::select(touch.moves, down + (touch.drift[0] - drift), down);
            self.rows.push(Row::new(touch.has, common, damping * up - pull, ONE_WAY));
            self.rows.push(Row::new(touch.has, common, damping * down - pull, ONE_WAY));
        }
    }
}
