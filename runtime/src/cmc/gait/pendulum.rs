//! A walking body, seen from above: an inverted pendulum that falls from step to step.
//!
//! With its centre of mass c at a constant height h over the centre of pressure z it is pushed away from that, c̈ = ω² (c - z), ω² = g / h
//! (Kajita et al., The 3D linear inverted pendulum mode, IROS 2001). Its capture point ξ = c + ċ/ω (Pratt et al., Humanoids 2006) obeys
//! ξ̇ = ω (ξ - z): it runs away from where the ground presses, and where it ends is known when a step begins.
//!
//! A step of duration T begins as a foot lands. For a time D both feet bear, and z goes evenly from the foot behind, p₀, to the one that has landed,
//! p; then p bears alone. With E = exp(ωT) and K = E (1 - (1 - exp(-ωD)) / ωD),
//!
//! > ξ(T) - p = E (ξ(0) - p) - K (p₀ - p).
//!
//! In a gait that repeats a way s at every step the capture point passes each landing at s (1 - K) / (E - 1) from it; in one that goes to
//! and fro, at -s (1 + K) / (E + 1). A foot that lands where the next step will end as the gait has it makes good whatever has
//! happened, within two steps (compare Khadiv et al., Walking control based on step timing adaptation, IEEE Trans. Robotics 36, 2020).
//!
//! The leg that swings turns the body's whole about its centre of mass. With its angular momentum L the ground pushes besides, sideways from where it presses
//! (Popovic, Goswami & Herr, Ground reference points in legged locomotion, Int. J. Robotics Research 24, 2005): with m the mass and l = (L_y, -L_x)
//!
//! > ξ̇ = ω (ξ - z) - ω l̇ / m g.
//!
//! If l goes evenly to zero until the step ends, a time r from now, ξ is then ahead of what the pressure alone would make of it by
//! ω l / m g · (exp(ωr) - 1) / ωr. Without that a foot would be sent too far ahead in the first half of its way, and called back in the second.

use msk_physics::scalar::Real;
use nalgebra::Vector2;

/// How long a step takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Timing {
    /// For how long both feet bear at its start, D, s.
    pub both: f64,
    /// For how long one of them bears after that, s.
    pub single: f64,
}

impl Timing {
    /// Of the whole step, T, s.
    pub fn step(&self) -> f64 {
        self.both + self.single
    }

    /// Where the ground usually presses at a time of a step, s.
    pub fn pressure(&self, time: f64, [from, to]: [Vector2<f64>; 2]) -> Vector2<f64> {
        let share = (time / self.both).clip(0.0, 1.0);
        from * (1.0 - share) + to * share
    }
}

/// The pendulum of a body, and what grows in a step of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pendulum {
    /// 1/s.
    pub omega: f64,
    timing: Timing,
    /// E and K.
    grown: f64,
    ramp: f64,
}

/// What a gait asks of its steps: all in the axes of the heading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    /// From the foot that bears to where the other usually lands, m.
    pub usual: Vector2<f64>,
    /// From there to the capture point at the end of the step that begins then, m.
    pub next: Vector2<f64>,
}

impl Pendulum {
    /// Of a centre of mass at this height over the ground (m), under this gravity (m/s²), in steps that take so long.
    pub fn new(height: f64, gravity: f64, timing: Timing) -> Self {
        let omega = (gravity / height.at_least(0.1)).sqrt();
        let grown = libm::exp(omega * timing.step());
        let ramp = grown * (1.0 - (1.0 - libm::exp(-omega * timing.both)) / (omega * timing.both));
        Self { omega, timing, grown, ramp }
    }

    /// Where a capture point is after `duration` (s) in which the pressure goes evenly from the first place to the second.
    fn run(&self, capture: Vector2<f64>, [from, to]: [Vector2<f64>; 2], duration: f64) -> Vector2<f64> {
        if duration <= 0.0 {
            return capture;
        }
        let lead = (to - from) / (duration * self.omega);
        (capture - from - lead) * libm::exp(self.omega * duration) + to + lead
    }

    /// Where a capture point is at the end of a step `time` (s) after it began, if the pressure goes from one place to another as usual.
    pub fn end(&self, capture: Vector2<f64>, time: f64, [from, to]: [Vector2<f64>; 2]) -> Vector2<f64> {
        let Timing { both, single } = self.timing;
        let landed = self.run(capture, [self.timing.pressure(time, [from, to]), to], both - time);
        self.run(landed, [to, to], (both + single - time).at_most(single))
    }

    /// By how much it ends further ahead for an angular momentum that is spent until then: ω l / m g now, m.
    pub fn swung(&self, time: f64, momentum: Vector2<f64>) -> Vector2<f64> {
        let rest = (self.timing.step() - time).at_least(1e-3);
        momentum * (self.authority(time) / (self.omega * rest))
    }

    /// By how much it ends further back if the pressure is further ahead by 1 from `time` on.
    pub fn authority(&self, time: f64) -> f64 {
        libm::exp(self.omega * (self.timing.step() - time).at_least(0.0)) - 1.0
    }

    /// The course of a gait of that velocity (m/s, in the axes of its heading) whose feet are `across` apart: the vector to where the foot that is on
    /// its way usually lands, if the body stays.
    pub fn course(&self, velocity: Vector2<f64>, across: Vector2<f64>) -> Course {
        let way = velocity * self.timing.step();
        let passed = way * ((1.0 - self.ramp) / (self.grown - 1.0)) + across * ((1.0 + self.ramp) / (self.grown + 1.0));
        Course { usual: way + across, next: way - across + passed }
    }

    /// Where a foot lands, from the one that bears, if the capture point ends there: the step after it goes on with the course.
    pub fn landing(&self, end: Vector2<f64>, course: &Course) -> Vector2<f64> {
        (end * self.grown - course.next) / (self.grown - self.ramp)
    }

    /// Where the capture point has to end for the usual landing.
    pub fn usual_end(&self, course: &Course) -> Vector2<f64> {
        (course.usual * (self.grown - self.ramp) + course.next) / self.grown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TIMING: Timing = Timing { both: 0.063, single: 0.39 };
    const STEP: f64 = 0.453;

    fn vector([x, y]: [f64; 2]) -> Vector2<f64> {
        Vector2::new(x, y)
    }

    proptest! {
        #[test]
        fn the_end_is_that_of_the_equation_of_motion(
            capture in prop::array::uniform2(-0.3..0.3_f64), from in prop::array::uniform2(-0.3..0.3_f64), begun in 0.0..STEP,
        ) {
            let (pendulum, places) = (Pendulum::new(0.9, 9.81, TIMING), [vector(from), Vector2::zeros()]);
            let (steps, mut found) = (20_000, vector(capture));
            let period = (STEP - begun) / f64::from(steps);
            for step in 0..steps {
                let time = begun + (f64::from(step) + 0.5) * period;
                // The midpoint rule.
                let half = found + (found - TIMING.pressure(time, places)) * (0.5 * pendulum.omega * period);
                found += (half - TIMING.pressure(time, places)) * (pendulum.omega * period);
            }
            prop_assert!((found - pendulum.end(vector(capture), begun, places)).norm() < 1e-5);
        }

        #[test]
        fn momentum_that_is_spent_evenly_brings_the_capture_point_where_it_is_foreseen(
            momentum in prop::array::uniform2(-0.1..0.1_f64), begun in 0.0..0.9 * STEP,
        ) {
            let pendulum = Pendulum::new(0.9, 9.81, TIMING);
            let (steps, rest) = (20_000, STEP - begun);
            let period = rest / f64::from(steps);
            let mut found = Vector2::zeros();
            for _ in 0..steps {
                // The midpoint rule, over the middle of the foot.
                let slope = |capture: Vector2<f64>| capture * pendulum.omega + vector(momentum) / rest;
                found += slope(found + slope(found) * (0.5 * period)) * period;
            }
            prop_assert!((found - pendulum.swung(begun, vector(momentum))).norm() < 1e-5);
        }

        #[test]
        fn two_steps_bring_any_capture_point_back_to_the_gait(
            capture in prop::array::uniform2(-0.2..0.2_f64), velocity in prop::array::uniform2(-0.5..0.8_f64),
        ) {
            let pendulum = Pendulum::new(0.9, 9.81, TIMING);
            let across = |step: usize| Vector2::new(0.0, if step.is_multiple_of(2) { 0.18 } else { -0.18 });
            let (mut before, mut stance, mut capture) = (vector([0.0, 0.18]), Vector2::zeros(), vector(capture));
            let mut ways = Vec::new();
            for step in 0..6 {
                let course = pendulum.course(vector(velocity), across(step));
                capture = pendulum.end(capture, 0.0, [before, stance]);
                let landing = stance + pendulum.landing(capture - stance, &course);
                ways.push(landing - stance - course.usual);
                (before, stance) = (stance, landing);
            }
            // The first landing takes what has happened into account, the second follows from it.
            prop_assert!(ways[2..].iter().all(|way| way.norm() < 1e-6), "{ways:?}");
        }
    }

    #[test]
    fn the_usual_end_leads_to_the_usual_landing() {
        let pendulum = Pendulum::new(0.9, 9.81, TIMING);
        let course = pendulum.course(Vector2::new(0.5, -0.1), Vector2::new(0.0, 0.2));
        let landing = pendulum.landing(pendulum.usual_end(&course), &course);
        assert!((landing - course.usual).norm() < 1e-12);
        // Of two ends that differ by one sole, the pressure at the start of the step makes up for most.
        assert!((4.0..6.0).contains(&(pendulum.authority(0.0) + 1.0)));
    }
}
