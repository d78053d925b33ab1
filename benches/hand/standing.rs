//! `standing.msk`.

use super::*;

pub struct Standing {
    own: Proprioception,
    torso: usize,
    clearance: [usize; 2],
    soles: [usize; 2],
    com: usize,
    com_velocity: usize,
    positions: List,
    velocities: List,
    neutral: Vec<f64>,
    horizon: u32,
    step: u32,
}

impl Standing {
    pub fn new(task: &CompiledTask, sums: Sums) -> Self {
        let slots = Slots(task);
        let soles = ["sole_l", "sole_r"].map(|name| slots.landmark(name));
        let free = || {
            let hinges = |kind| kind == msk::compiler::vocabulary::JointKind::Hinge;
            let joints = task.vocabulary.joints.iter().enumerate();
            joints.filter(move |(_, joint)| !joint.of_scene && joint.independent && hinges(joint.kind))
        };
        Self {
            own: Proprioception::new(&slots, sums),
            torso: slots.of(Sensor::LandmarkAxes(slots.landmark("torso"))),
            clearance: soles.map(|sole| slots.of(Sensor::LandmarkClearance(sole))),
            soles: soles.map(|sole| slots.of(Sensor::LandmarkVelocity(sole))),
            com: slots.of(Sensor::ComPosition),
            com_velocity: slots.of(Sensor::ComVelocity),
            positions: slots.list(free().map(|(index, _)| Sensor::JointPosition(index))),
            velocities: slots.list(free().map(|(index, _)| Sensor::JointVelocity(index))),
            neutral: free().map(|(_, joint)| joint.neutral).collect(),
            horizon: task.horizon,
            step: 0,
        }
    }
}

impl Hand for Standing {
    fn reset(&mut self, _: &[f64]) {
        self.step = 0;
    }

    fn step(&mut self, frame: &[f64], weights: &[f64], outcome: &mut Outcome) {
        self.step += 1;
        let (mut bent, mut index, mut moving) = (0.0, 0, 0.0);
        self.positions.each(frame, |value| {
            let off = value - self.neutral[index];
            bent += off * off;
            index += 1;
        });
        self.velocities.each(frame, |value| moving += value * value);
        let speed = norm(vector(frame, self.com_velocity));
        let sliding: f64 = self.soles.iter().map(|&sole| norm(vector(frame, sole))).sum();
        let up = vector(frame, self.torso + 6);
        let tilt = libm::atan2((up[0] * up[0] + up[1] * up[1]).sqrt(), up[2]);
        outcome.ends = [frame[self.com + 2] < 0.8, tilt > 0.8];
        let ended = outcome.ends.contains(&true);
        outcome.terms[..6].copy_from_slice(&[
            libm::exp(-bent.sqrt()),
            libm::exp(-10.0 * speed) * libm::exp(-0.1 * moving.sqrt()),
            libm::exp(-10.0 * sliding),
            libm::exp(-5.0 * (1.0 - up[2]).max(0.0)),
            f64::from(u8::from(!ended)),
            self.own.effort(frame),
        ]);
        outcome.reward = weighted_sum(&outcome.terms[..6], weights);
        outcome.truncated = self.step >= self.horizon && !ended;
        outcome.success = outcome.truncated;
    }

    fn observe(&self, frame: &[f64], out: &mut [f64]) {
        let out = self.own.write(frame, out);
        out[..4].copy_from_slice(&quaternion(&frame[self.torso..self.torso + 9]));
        out[4] = frame[self.clearance[0]];
        out[5] = frame[self.clearance[1]];
    }
}
