//! From the wishes of episodes to the forces of their muscles: all of a control step that takes time, for one episode or, in lanes, for
//! eight.
//!
//! Episodes have the same muscles; the points of their feet that bear weight differ. Every point that bears in any lane gets columns; where
//! it does not bear they are zero, without room between their bounds, and not counted. Such columns change no sum, so a lane comes to the
//! bits that it comes to alone.

use super::allocation::{Allocation, Columns, Effort, Memory, Problem, Unknown};
use super::compromise::Compromise;
use super::coordinates::{Coordinates, Slopes};
use super::dynamics::Dynamics;
use super::feedback::{Law, acceleration};
use super::grips::Grips;
use super::motion::Moved;
use super::support::Support;
use super::wishes::{Bearing, PointWish, Wishes};
use super::{CONTACT_COST, CONTACT_LIMIT, CONTACT_UNIT, MUSCLE_COST, friction_pyramid, tetrahedron};
use crate::body::Body;
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::spatial::{dot, zero};
use msk_physics::{Instructions, LaneWork, State, Workspace};
use nalgebra::Vector3;

/// What an episode wishes for, and where its share goes.
pub(super) struct Member<'a> {
    pub lane: usize,
    pub effort: Effort,
    pub wishes: &'a Wishes,
    /// The activations that each muscle can reach within the hold.
    pub reach: &'a [[f64; 2]],
    pub memory: &'a mut Memory,
    /// The activation of each muscle, to be filled.
    pub out: &'a mut [f64],
}

/// Memory for the controllers of one body.
#[derive(Debug, Clone)]
pub(super) struct Share<T: Real> {
    coordinates: Coordinates,
    slopes: Slopes<T>,
    compromise: Compromise<T>,
    dynamics: Dynamics<T>,
    /// What the free root carries.
    centre: Option<Centre<T>>,
    /// What moves each body that has points that may bear.
    carriers: Vec<(usize, Moved)>,
    points: Vec<Bearer<T>>,
    /// The weight of each coordinate's wish, squared, and that times the acceleration wished for.
    wishes: Vec<[T; 2]>,
    velocities: Vec<T>,
    accelerations: Vec<T>,
    /// How the point at hand moves.
    motion: Vec<Vector3<T>>,
    /// Muscles first, then the edges of the friction pyramid at each point that bears weight.
    columns: Columns<T>,
    unknowns: Vec<Unknown<T>>,
    wanted: Vec<T>,
    count: T,
    allocation: Allocation<T>,
}

/// The centre of mass of what hangs on a body, and the wish for it.
#[derive(Debug, Clone)]
struct Centre<T: Real> {
    body: usize,
    moved: Moved,
    error: Vector3<T>,
    /// Of the reference: velocity, then acceleration.
    reference: [Vector3<T>; 2],
    laws: [LaneLaw<T>; 3],
    factor: T,
}

/// A law in each lane.
#[derive(Debug, Clone, Copy)]
struct LaneLaw<T> {
    stiffness: T,
    damping: T,
    weight: T,
}

impl<T: Real> LaneLaw<T> {
    fn none() -> Self {
        Self { stiffness: T::splat(0.0), damping: T::splat(0.0), weight: T::splat(0.0) }
    }

    fn set(&mut self, lane: usize, law: &Law) {
        self.stiffness.set_lane(lane, law.stiffness);
        self.damping.set_lane(lane, law.damping);
        self.weight.set_lane(lane, law.weight);
    }

    /// The acceleration that it wishes for; see [`acceleration`].
    #[inline(always)]
    fn acceleration(&self, error: T, velocity: T, reference: [T; 2], hold: f64) -> T {
        acceleration([self.stiffness, self.damping], error, velocity, reference, hold)
    }
}

/// A point of a foot that bears weight or is to go somewhere in some lane, or one that is held.
#[derive(Debug, Clone)]
struct Bearer<T: Real> {
    /// Which of all points it is; they stand in this order.
    key: usize,
    /// Its place among the carriers.
    carrier: usize,
    position: Vector3<T>,
    /// Forces of one unit of which every other is a sum, such as the edges of its friction pyramid, N; zero in lanes in which it bears none.
    edges: [Vector3<T>; 4],
    error: Vector3<T>,
    /// What it is to have: velocity, then acceleration.
    reference: [Vector3<T>; 2],
    /// Its weight is squared.
    law: LaneLaw<T>,
    /// How many units a force has at most.
    limit: T,
}

impl<T: Real> Bearer<T> {
    fn new(key: usize, carrier: usize) -> Self {
        let (error, reference, law) = (zero(), [zero(), zero()], LaneLaw::none());
        Self { key, carrier, position: zero(), edges: [zero(); 4], error, reference, law, limit: T::splat(0.0) }
    }

    fn set(&mut self, lane: usize, wish: &PointWish) {
        let PointWish { point, bearing, law, error, moving, bending } = wish;
        set_lane(&mut self.position, lane, &point.position);
        let forces = match bearing {
            Bearing::None => None,
            Bearing::Ground => Some(friction_pyramid(point)),
            Bearing::Grip => Some(tetrahedron()),
        };
        if let Some(forces) = forces {
            for (edge, force) in self.edges.iter_mut().zip(forces) {
                set_lane(edge, lane, &(force * CONTACT_UNIT));
            }
            self.limit.set_lane(lane, CONTACT_LIMIT);
        }
        self.law.set(lane, law);
        set_lane(&mut self.error, lane, error);
        set_lane(&mut self.reference[0], lane, moving);
        set_lane(&mut self.reference[1], lane, bending);
    }
}

impl<T: Real> Share<T> {
    /// For a body of a model, of which `workspace` holds forward passes.
    pub fn new(model: &Model, body: &Body, workspace: &Workspace<T>) -> Self {
        let coordinates = Coordinates::new(model);
        let dynamics = Dynamics::new(model, &workspace.tendons, &coordinates);
        let columns = dynamics.columns();
        let moved_root = |_| Centre {
            body: body.root.body,
            moved: Moved::subtree(model, &coordinates, body.root.body),
            error: zero(),
            reference: [zero(), zero()],
            laws: [LaneLaw::none(); 3],
            factor: T::splat(0.0),
        };
        let centre = body.root.free.map(moved_root);
        let root = body.root.free.iter().flat_map(|(_, dof)| *dof..dof + 6);
        let moved_body = |body: usize| (body, Moved::body(model, &coordinates, body));
        let mut carriers = Support::new(body).carriers(model);
        carriers.extend(Grips::new(model).carriers());
        carriers.sort_unstable();
        carriers.dedup();
        let carriers: Vec<(usize, Moved)> = carriers.into_iter().map(moved_body).collect();
        let moved = centre.as_ref().map(|centre| &centre.moved);
        let compromise = Compromise::new(&coordinates, (moved, root), carriers.iter().map(|(_, moved)| moved));
        let (size, zeros) = (coordinates.len(), vec![T::splat(0.0); coordinates.len()]);
        Self {
            slopes: Slopes::new(&coordinates),
            wishes: vec![[T::splat(0.0); 2]; size],
            velocities: zeros.clone(),
            accelerations: zeros.clone(),
            wanted: zeros,
            motion: Vec::new(),
            points: Vec::new(),
            unknowns: Vec::new(),
            count: T::splat(0.0),
            allocation: Allocation::new(size),
            coordinates,
            compromise,
            dynamics,
            centre,
            carriers,
            columns,
        }
    }

    /// Shares out what members in different lanes wish for, all in holds of that length, s. States and forward passes are those of the
    /// lanes.
    pub fn solve(&mut self, passes: (&Model, &State<T>, &Workspace<T>), hold: f64, members: &mut [Member<'_>]) {
        self.take_in(members);
        Instructions::default().run(Fill { share: self, passes, hold });
        for effort in [Effort::EXACT, Effort::ROUGH] {
            let of_effort = |member: &Member<'_>| member.effort == effort;
            if members.iter().any(of_effort) {
                let among = T::mask(|lane| members.iter().any(|member| of_effort(member) && member.lane == lane));
                self.share_out(effort, among);
                let ended = members.iter_mut().filter(|member| of_effort(member));
                ended.for_each(|member| self.allocation.remember(member.lane, member.memory, member.out));
            }
        }
    }

    fn share_out(&mut self, effort: Effort, among: T::Mask) {
        let Self { dynamics: Dynamics { pattern, inertia, .. }, columns, unknowns, wanted, count, allocation, .. } = self;
        allocation.search(&Problem { pattern, inertia, columns, unknowns, wanted, count: *count }, effort, among);
    }

    /// Puts the wishes of members into their lanes.
    fn take_in(&mut self, members: &[Member<'_>]) {
        let zero = T::splat(0.0);
        self.lay_out_points(members);
        let muscles = members.first().map_or(0, |member| member.reach.len());
        self.unknowns.clear();
        self.unknowns.resize(muscles, Unknown { low: zero, high: zero, cost: T::splat(MUSCLE_COST) });
        self.count = zero;
        for member in members {
            let &Member { lane, wishes, reach, .. } = member;
            for (unknown, [low, high]) in self.unknowns.iter_mut().zip(reach) {
                unknown.low.set_lane(lane, *low);
                unknown.high.set_lane(lane, *high);
            }
            for (own, wish) in self.wishes.iter_mut().zip(&wishes.coordinates) {
                own[0].set_lane(lane, wish[0]);
                own[1].set_lane(lane, wish[1]);
            }
            if let Some(centre) = &mut self.centre {
                set_lane(&mut centre.error, lane, &wishes.centre.error);
                set_lane(&mut centre.reference[0], lane, &wishes.centre.moving);
                set_lane(&mut centre.reference[1], lane, &wishes.centre.bending);
                centre.laws.iter_mut().zip(&wishes.centre.laws).for_each(|(own, law)| own.set(lane, law));
                centre.factor.set_lane(lane, wishes.centre.factor);
            }
            let bearing = wishes.points.iter().filter(|wish| wish.bearing != Bearing::None).count();
            self.count.set_lane(lane, (muscles + 4 * bearing) as f64);
            self.allocation.recall(lane, member.memory);
        }
        for point in &self.points {
            let unknown = Unknown { low: zero, high: point.limit, cost: T::splat(CONTACT_COST) };
            self.unknowns.extend([unknown; 4]);
        }
    }

    /// Fills the points with wishes in any lane, keys ascending.
    fn lay_out_points(&mut self, members: &[Member<'_>]) {
        self.points.clear();
        for member in members {
            for wish in &member.wishes.points {
                let key = wish.point.key;
                let Some(carrier) = self.carriers.iter().position(|(body, _)| *body == wish.point.body) else { continue };
                let place = self.points.partition_point(|point| point.key < key);
                if self.points.get(place).is_none_or(|point| point.key != key) {
                    self.points.insert(place, Bearer::new(key, carrier));
                }
                self.points[place].set(member.lane, wish);
            }
        }
    }
}

/// Fills the problem from what has been taken in.
struct Fill<'a, T: Real> {
    share: &'a mut Share<T>,
    passes: (&'a Model, &'a State<T>, &'a Workspace<T>),
    hold: f64,
}

impl<T: Real> LaneWork for Fill<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { share, passes, hold } = self;
        let (model, state, workspace) = passes;
        let Share { coordinates, slopes, compromise, dynamics, velocities, accelerations, motion, columns, .. } = share;
        slopes.update(coordinates, model, state);
        for (velocity, &dof) in velocities.iter_mut().zip(&coordinates.dofs) {
            *velocity = state.velocity[dof];
        }
        compromise.begin(&share.wishes);
        if let Some(centre) = &mut share.centre {
            let Centre { body, moved, error, reference: [moving, bending], laws, factor } = centre;
            moved.centre((model, workspace, slopes), *body, motion);
            let velocity = velocity(moved, motion, velocities);
            let mut wish = zero();
            let mut weight = zero();
            for axis in 0..3 {
                wish[axis] = laws[axis].acceleration(error[axis], velocity[axis], [moving[axis], bending[axis]], hold);
                weight[axis] = *factor * laws[axis].weight;
            }
            compromise.set_centre((moved, motion), &wish, &weight);
        }
        columns.truncate(dynamics.muscles());
        for Bearer { carrier, position, edges, error, reference: [moving, bending], law, .. } in &share.points {
            let (body, moved) = &share.carriers[*carrier];
            moved.point((model, &workspace.kinematics, slopes), (*body, position), motion);
            let velocity = velocity(moved, motion, velocities);
            let mut wish = zero();
            for axis in 0..3 {
                wish[axis] = law.acceleration(error[axis], velocity[axis], [moving[axis], bending[axis]], hold);
            }
            compromise.add_point((moved, motion), &wish, law.weight);
            for edge in edges {
                let entries = moved.coordinates.iter().zip(&*motion).map(
                    #[inline(always)]
                    |(&row, column)| (row, dot(column, edge)),
                );
                columns.push(&dynamics.pattern, entries);
            }
        }
        compromise.settle(accelerations);
        dynamics.update(passes, (coordinates, slopes), hold, columns);
        dynamics.required_force(accelerations, &mut share.wanted);
    }
}

/// Velocity of what moves like that at those velocities of the independent coordinates, m/s.
#[inline(always)]
fn velocity<T: Real>(moved: &Moved, motion: &[Vector3<T>], velocities: &[T]) -> Vector3<T> {
    let mut sum = zero();
    for (&coordinate, column) in moved.coordinates.iter().zip(motion) {
        T::apart();
        for axis in 0..3 {
            sum[axis] += column[axis] * velocities[coordinate];
        }
    }
    sum
}

fn set_lane<T: Real>(all: &mut Vector3<T>, lane: usize, one: &Vector3<f64>) {
    all.iter_mut().zip(one.iter()).for_each(|(all, &one)| all.set_lane(lane, one));
}
