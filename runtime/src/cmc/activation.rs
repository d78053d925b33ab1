//! Activation lags behind excitation; this inverts the lag over one control step.
//!
//! MuJoCo integrates da/dt = (u - a) / τ(u, a) by Euler steps while the excitation u is held. The activation at the end of
//! the hold, A(u), rises with u, so that what a muscle can reach is [A(u_low), A(u_high)], and the excitation that brings it
//! to a wanted activation is the root of A(u) = wanted. Eight muscles are searched for at once, in lanes.
//!
//! That excitation is a steep function of the state, because muscles relax slowly: what is to fall a little gets none at all. It is
//! hard to learn from. The smooth one of [`Lead::Smooth`] comes near it without a search.

use crate::action::excitation;
use core::ops::Range;
use msk_physics::actuation::activation_rate;
use msk_physics::lanes::{Lanes, WIDTH};
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{Instructions, LaneWork};
use msk_program::body::ExcitationMap;

/// How an excitation is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hold {
    /// Physics steps.
    pub steps: u32,
    /// Length of one, s.
    pub timestep: f64,
}

/// How excitations lead the activations that they are to bring about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Lead {
    /// Muscles are there at the end of the hold: the root of A(u) = wanted.
    #[default]
    Exact,
    /// u = a + k (wanted - a). Of rising and falling, k is 1 for the faster one, and for the other as much more as that is slower: the ratio
    /// of their time constants. So an activation falls about as fast as it rises, and u is a continuous function of the state.
    Smooth,
}

/// The root is bracketed until the activation is known this well.
const TOLERANCE: f64 = 1e-7;
/// Three are usual, nine with time constants that are forty times apart.
const ITERATIONS: usize = 40;

impl Hold {
    /// Length, s.
    pub fn duration(self) -> f64 {
        f64::from(self.steps) * self.timestep
    }

    /// The activation at the end, from `activation` under `excitation`. `constants` are the muscle's activation and
    /// deactivation times (s) and smoothing width.
    #[inline(always)]
    fn activation<T: Real>(self, activation: T, excitation: T, constants: &[f64; 3]) -> T {
        let [end] = self.activations(activation, [excitation], constants);
        end
    }

    /// The activations at the end under several excitations, side by side: each waits for its divisions, not for the others'.
    #[inline(always)]
    fn activations<T: Real, const N: usize>(self, activation: T, excitations: [T; N], constants: &[f64; 3]) -> [T; N] {
        let mut present = [activation; N];
        // No closure: it would be compiled for the least of all processors.
        if !self.keeps_direction(constants) {
            for _ in 0..self.steps {
                for (present, excitation) in present.iter_mut().zip(excitations) {
                    *present += T::splat(self.timestep) * activation_rate(excitation, *present, constants);
                }
            }
            return present;
        }
        let [zero, one, half, grows] = [0.0, 1.0, 0.5, 1.5].map(T::splat);
        let [rise, step, fall_step] = [constants[0], self.timestep, self.timestep / constants[1]].map(T::splat);
        for (present, excitation) in present.iter_mut().zip(excitations) {
            let (excitation, rises) = (excitation.clip(zero, one), present.less(excitation));
            let any_rises = T::any(rises);
            for _ in 0..self.steps {
                let pace = half + grows * present.clip(zero, one);
                let change = excitation - *present;
                let mut gain = fall_step * change * pace;
                if any_rises {
                    gain = T::select(rises, step * change / (rise * pace), gain);
                }
                *present += gain;
            }
        }
        present
    }

    /// Whether an activation goes up or down throughout a hold: then it takes half of the divisions, or none. One that is slow comes near the
    /// excitation but not beyond it.
    #[inline(always)]
    fn keeps_direction(self, &[rise, fall, width]: &[f64; 3]) -> bool {
        width == 0.0 && 2.0 * self.timestep <= rise && 2.0 * self.timestep <= fall
    }

    /// How much the activation at the end rises per excitation, near an excitation that equals `activation`: for falling, then for rising.
    /// Exact without a smooth transition between the two.
    #[inline(always)]
    fn slopes<T: Real>(self, activation: T, [rise, fall, _]: &[f64; 3]) -> [T; 2] {
        let (one, step) = (T::splat(1.0), T::splat(self.timestep));
        let pace = T::splat(0.5) + T::splat(1.5) * activation.clip(T::splat(0.0), one);
        let mut left = [one; 2];
        let stays = [one - step * pace / T::splat(*fall), one - step / (T::splat(*rise) * pace)];
        for _ in 0..self.steps {
            left = [left[0] * stays[0], left[1] * stays[1]];
        }
        left.map(
            #[inline(always)]
            |left| one - left,
        )
    }

    /// The excitation within `range` that ends at `wanted`, or comes nearest to it. `reach` are the activations at the end under the
    /// bounds of the range.
    ///
    /// An excitation that equals the activation keeps it; from there on both ways the inverse of A is interpolated from that point, the
    /// slope there and what the bound reaches, then from the point so found as well (Newton's divided differences with a double node). Two or
    /// three points are enough; where they are not, false position goes on within the bracket (Dowell & Jarratt, BIT 11, 1971).
    #[inline(always)]
    fn excitation<T: Real>(self, activation: T, wanted: T, range: [f64; 2], reach: [T; 2], constants: &[f64; 3]) -> T {
        let (zero, half, tolerance) = (T::splat(0.0), T::splat(0.5), T::splat(TOLERANCE));
        let [mut low, mut high] = range.map(T::splat);
        // Holding the present activation changes nothing, and parts rising from falling, where the time constant jumps.
        let (still, falls) = (activation.clip(low, high), wanted.less(activation));
        let stays = T::select(activation.less(low), reach[0], T::select(high.less(activation), reach[1], activation));
        let slope = self.slopes(activation, constants);
        let slope = T::select(falls, slope[0], slope[1]);
        let bound = [T::select(falls, low, high) - still, T::select(falls, reach[0], reach[1]) - stays];
        (low, high) = (T::select(falls, low, still), T::select(falls, still, high));
        let mut below = T::select(falls, reach[0], stays) - wanted;
        let mut above = T::select(falls, stays, reach[1]) - wanted;
        let (out_low, out_high) = (T::not(below.less(zero)), T::not(zero.less(above)));
        let mut found = T::select(out_low, low, high);
        let mut done = T::or(out_low, out_high);

        let inverse = T::splat(1.0) / slope;
        let bend = (bound[0] - bound[1] * inverse) / bound[1].squared();
        let goal = wanted - stays;
        let mut next = still + goal * (inverse + bend * goal);
        let mut was_under = done;
        for taken in 0..ITERATIONS {
            if T::all(done) {
                return found;
            }
            let inside = T::and(low.less(next), next.less(high));
            let point = T::select(inside, next, (low * above - high * below) / (above - below));
            let missed = self.activation(activation, point, constants) - wanted;
            found = T::select(done, found, point);
            done = T::or(done, T::not(tolerance.less(missed.abs())));
            let under = missed.less(zero);
            // The end that stays for the second time counts half, so that it is left.
            let again = T::or(T::and(under, was_under), T::not(T::or(under, was_under)));
            let share = if taken > 0 { T::select(again, half, T::splat(1.0)) } else { T::splat(1.0) };
            (low, high) = (T::select(under, point, low), T::select(under, high, point));
            (below, above) = (T::select(under, missed, share * below), T::select(under, share * above, missed));
            was_under = under;
            next = (low * above - high * below) / (above - below);
            if taken == 0 {
                let (x, y) = (point - still, missed + goal);
                let third = (x - y * (inverse + bend * y)) / (y.squared() * (y - bound[1]));
                next = still + goal * (inverse + goal * (bend + third * (goal - bound[1])));
            }
        }
        T::select(done, found, half * (low + high))
    }
}

/// k of [`Lead::Smooth`] for rising and for falling; with a time constant of zero, one muscle is as fast as the other.
fn smooth_lead([rise, fall, _]: [f64; 3]) -> [f64; 2] {
    let above_one = |ratio: f64| if ratio.is_finite() { ratio.at_least(1.0) } else { 1.0 };
    [above_one(rise / fall), above_one(fall / rise)]
}

/// The muscles of a body, in groups that share their constants, as many as lanes at most.
#[derive(Debug, Clone)]
pub(super) struct Muscles {
    groups: Vec<Group>,
}

#[derive(Debug, Clone)]
struct Group {
    /// Places among the muscles.
    places: Range<usize>,
    /// Where the activation of each stands.
    activations: Vec<usize>,
    constants: [f64; 3],
}

impl Muscles {
    /// Those of `model`.
    pub fn new(model: &Model) -> Self {
        let mut groups: Vec<Group> = Vec::new();
        for (place, (_, muscle)) in model.actuators.muscles().enumerate() {
            let fits = |group: &&mut Group| group.constants == muscle.time_constants && group.activations.len() < WIDTH;
            match groups.last_mut().filter(fits) {
                Some(group) => {
                    group.activations.push(muscle.activation);
                    group.places.end = place + 1;
                }
                None => groups.push(Group {
                    places: place..place + 1,
                    activations: vec![muscle.activation],
                    constants: muscle.time_constants,
                }),
            }
        }
        Self { groups }
    }

    /// Writes for each muscle the activations at the end of the hold under the lowest and the highest of `excitations`.
    pub fn reach(&self, hold: Hold, activations: &[f64], excitations: [f64; 2], out: &mut [[f64; 2]]) {
        Instructions::default().run(Reach { muscles: self, hold, activations, excitations, out });
    }

    /// Replaces for each muscle the wanted activation by the excitation within `range` that leads there from `activations`. `reach` is
    /// what [`reach`](Self::reach) gives for the bounds of the range.
    pub fn excitations(
        &self,
        lead: Lead,
        hold: Hold,
        activations: &[f64],
        (range, reach): ([f64; 2], &[[f64; 2]]),
        wanted: &mut [f64],
    ) {
        match lead {
            Lead::Exact => Instructions::default().run(Excite { muscles: self, hold, activations, range, reach, wanted }),
            Lead::Smooth => self.lead_smoothly(activations, range, wanted),
        }
    }

    /// Replaces the excitation of each muscle by the activation at the end of the hold.
    pub fn predict(&self, hold: Hold, activations: &[f64], excitations: &mut [f64]) {
        for group in &self.groups {
            for (excitation, &slot) in excitations[group.places.clone()].iter_mut().zip(&group.activations) {
                *excitation = hold.activation(activations[slot], *excitation, &group.constants);
            }
        }
    }

    fn lead_smoothly(&self, activations: &[f64], [low, high]: [f64; 2], wanted: &mut [f64]) {
        for group in &self.groups {
            let [rising, falling] = smooth_lead(group.constants);
            for (wanted, &slot) in wanted[group.places.clone()].iter_mut().zip(&group.activations) {
                let change = *wanted - activations[slot];
                let lead = if change < 0.0 { falling } else { rising };
                *wanted = (activations[slot] + lead * change).clip(low, high);
            }
        }
    }
}

impl Group {
    #[inline(always)]
    fn present(&self, activations: &[f64]) -> Lanes {
        gather(self.activations.iter().map(|&slot| activations[slot]))
    }
}

/// The values in lanes; lanes beyond are zero.
#[inline(always)]
fn gather(values: impl Iterator<Item = f64>) -> Lanes {
    let mut lanes = Lanes::splat(0.0);
    for (lane, value) in values.enumerate() {
        lanes.set_lane(lane, value);
    }
    lanes
}

struct Reach<'a> {
    muscles: &'a Muscles,
    hold: Hold,
    activations: &'a [f64],
    excitations: [f64; 2],
    out: &'a mut [[f64; 2]],
}

impl LaneWork for Reach<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let hold = self.hold;
        for group in &self.muscles.groups {
            let present = group.present(self.activations);
            let [low, high] = self.excitations;
            let [low, high] = hold.activations(present, [Lanes::splat(low), Lanes::splat(high)], &group.constants);
            for (lane, out) in self.out[group.places.clone()].iter_mut().enumerate() {
                *out = [low.lane(lane), high.lane(lane)];
            }
        }
    }
}

struct Excite<'a> {
    muscles: &'a Muscles,
    hold: Hold,
    activations: &'a [f64],
    range: [f64; 2],
    reach: &'a [[f64; 2]],
    wanted: &'a mut [f64],
}

impl LaneWork for Excite<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let hold = self.hold;
        for group in &self.muscles.groups {
            let wanted = &mut self.wanted[group.places.clone()];
            let (present, goal) = (group.present(self.activations), gather(wanted.iter().copied()));
            let reach = &self.reach[group.places.clone()];
            let reach = [gather(reach.iter().map(|reach| reach[0])), gather(reach.iter().map(|reach| reach[1]))];
            let found = hold.excitation(present, goal, self.range, reach, &group.constants);
            for (lane, wanted) in wanted.iter_mut().enumerate() {
                *wanted = found.lane(lane);
            }
        }
    }
}

/// The excitations that actions in [-1, 1] reach.
pub(super) fn excitation_range(map: ExcitationMap) -> [f64; 2] {
    [excitation(map, -1.0), excitation(map, 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HOLD: Hold = Hold { steps: 10, timestep: 1e-3 };

    fn muscle() -> impl Strategy<Value = [f64; 3]> {
        (prop::sample::select(vec![0.010, 0.015]), prop::sample::select(vec![0.040, 0.050]), prop::sample::select(vec![0.0, 0.1]))
            .prop_map(|(rise, fall, width)| [rise, fall, width])
    }

    proptest! {
        #[test]
        fn a_wanted_activation_within_reach_is_met(
            start in 0.0..1.0, share in 0.0..1.0, constants in muscle(),
        ) {
            let [low, high] = [0.0, 1.0].map(|u| HOLD.activation(start, u, &constants));
            let wanted = low + share * (high - low);
            let excitation = HOLD.excitation(start, wanted, [0.0, 1.0], [low, high], &constants);
            prop_assert!((HOLD.activation(start, excitation, &constants) - wanted).abs() < 1e-6);
        }

        #[test]
        fn an_activation_that_keeps_its_direction_follows_the_rate_of_the_physics(
            start in 0.0..1.0, excitation in 0.0..1.0, constants in muscle(),
        ) {
            prop_assert_eq!(HOLD.keeps_direction(&constants), constants[2] == 0.0);
            let mut expected: f64 = start;
            for _ in 0..HOLD.steps {
                expected += HOLD.timestep * activation_rate(excitation, expected, &constants);
            }
            prop_assert!((HOLD.activation(start, excitation, &constants) - expected).abs() < 1e-14);
        }

        #[test]
        fn muscles_in_lanes_have_the_bits_of_muscles_alone(
            starts in prop::collection::vec(0.0..1.0, 19), wishes in prop::collection::vec(-0.2..1.2, 19), constants in muscle(),
        ) {
            let groups = (0..3).map(|group| {
                let places = 8 * group..19.min(8 * (group + 1));
                Group { activations: places.clone().collect(), places, constants }
            });
            let muscles = Muscles { groups: groups.collect() };
            let (mut reach, mut found) = (vec![[0.0; 2]; 19], wishes.clone());
            muscles.reach(HOLD, &starts, [0.1, 0.9], &mut reach);
            muscles.excitations(Lead::Exact, HOLD, &starts, ([0.1, 0.9], &reach), &mut found);
            for muscle in 0..19 {
                let alone = [0.1, 0.9].map(|bound| HOLD.activation(starts[muscle], bound, &constants));
                prop_assert_eq!(reach[muscle], alone);
                prop_assert_eq!(found[muscle], HOLD.excitation(starts[muscle], wishes[muscle], [0.1, 0.9], alone, &constants));
            }
        }

        #[test]
        fn a_wanted_activation_out_of_reach_gives_the_nearest_bound(start in 0.0..1.0, constants in muscle()) {
            let [low, high] = [0.1, 0.9].map(|u| HOLD.activation(start, u, &constants));
            let found = |wanted: f64| HOLD.excitation(start, wanted, [0.1, 0.9], [low, high], &constants);
            prop_assert_eq!([found(low - 0.01), found(high + 0.01)], [0.1, 0.9]);
        }

        #[test]
        fn smooth_excitations_stand_still_with_the_activation_and_fall_as_fast_as_they_rise(
            start in 0.3..0.7f64, change in 0.0..0.02f64, constants in muscle(),
        ) {
            let muscles = Muscles { groups: vec![Group { activations: vec![0], places: 0..1, constants }] };
            let led = |wanted: f64| -> f64 {
                let mut found = [wanted];
                muscles.excitations(Lead::Smooth, HOLD, &[start], ([0.0, 1.0], &[]), &mut found);
                found[0]
            };
            prop_assert_eq!(led(start), start);
            prop_assert!((led(start + change) - start - change).abs() < 1e-12);
            let slower = constants[1] / constants[0];
            prop_assert!((led(start - change) - start + slower * change).abs() < 1e-12);
        }
    }
}
