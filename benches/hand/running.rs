//! `running.msk`.

use super::*;

pub struct Running {
    own: Proprioception,
    torso: usize,
    pelvis: usize,
    pelvis_axes: usize,
    clearance: [usize; 2],
    soles: [usize; 2],
    knees: [usize; 2],
    com_velocity: usize,
    start: f64,
    farthest: f64,
    horizon: u32,
    step: u32,
}

impl Running {
    pub fn new(task: &CompiledTask, sums: Sums) -> Self {
        let slots = Slots(task);
        let soles = ["sole_l", "sole_r"].map(|name| slots.landmark(name));
        let pelvis = slots.landmark("pelvis");
        Self {
            own: Proprioception::new(&slots, sums),
            torso: slots.of(Sensor::LandmarkAxes(slots.landmark("torso"))),
            pelvis: slots.of(Sensor::LandmarkPosition(pelvis)),
            pelvis_axes: slots.of(Sensor::LandmarkAxes(pelvis)),
            clearance: soles.map(|sole| slots.of(Sensor::LandmarkClearance(sole))),
            soles: soles.map(|sole| slots.of(Sensor::LandmarkPosition(sole))),
            knees: ["knee_angle_l", "knee_angle_r"].map(|name| slots.of(Sensor::JointPosition(slots.joint(name)))),
            com_velocity: slots.of(Sensor::ComVelocity),
            start: 0.0,
            farthest: 0.0,
            horizon: task.horizon,
            step: 0,
        }
    }
}

impl Hand for Running {
    fn reset(&mut self, frame: &[f64]) {
        self.step = 0;
        self.start = frame[self.pelvis];
        self.farthest = frame[self.pelvis];
    }

    fn step(&mut self, frame: &[f64], weights: &[f64], outcome: &mut Outcome) {
        self.step += 1;
        let [left, right] = self.soles.map(|sole| vector(frame, sole));
        let between = [left[0] - right[0], left[1] - right[1], left[2] - right[2]];
        let [ahead, width, _] = along_heading(frame, self.pelvis_axes, between);
        let stride = ahead.abs();
        let lift = (frame[self.clearance[0]] - frame[self.clearance[1]]).abs();
        let speed = frame[self.com_velocity];
        let bend = frame[self.knees[0]].max(frame[self.knees[1]]);
        self.farthest = self.farthest.max(frame[self.pelvis]);
        let forward = vector(frame, self.torso);
        let pitch = libm::atan2(-forward[2], libm::hypot(forward[0], forward[1]));
        outcome.ends = [frame[self.pelvis + 2] < 0.45, pitch < -core::f64::consts::FRAC_PI_4];
        let ended = outcome.ends.contains(&true);
        let flag = |holds: bool| f64::from(u8::from(holds));
        outcome.terms[..8].copy_from_slice(&[
            speed.clamp(-0.5, 6.0),
            flag(speed > 3.0),
            (stride + 2.0 * lift).clamp(0.0, 1.0),
            (bend - 0.1).clamp(0.0, 1.0),
            ((0.15 - width) / 0.15).clamp(0.0, 1.0),
            flag(stride < 0.2 && lift < 0.1),
            flag(!ended),
            self.own.effort(frame),
        ]);
        outcome.reward = weighted_sum(&outcome.terms[..8], weights);
        outcome.truncated = self.step >= self.horizon && !ended;
        outcome.success = self.farthest - self.start > 15.0;
    }

    fn observe(&self, frame: &[f64], out: &mut [f64]) {
        let out = self.own.write(frame, out);
        out[..4].copy_from_slice(&quaternion(&frame[self.torso..self.torso + 9]));
        out[4] = frame[self.clearance[0]];
        out[5] = frame[self.clearance[1]];
    }
}
