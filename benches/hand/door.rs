//! `door.msk`.

use super::*;

pub struct Door {
    own: Proprioception,
    pelvis: usize,
    pelvis_axes: usize,
    head: usize,
    palm: usize,
    handle: usize,
    ankles: [usize; 2],
    angle: usize,
    opened: bool,
    /// Whether it has passed and arrived.
    reached: [bool; 2],
    success: bool,
    horizon: u32,
    step: u32,
}

impl Door {
    pub fn new(task: &CompiledTask, sums: Sums) -> Self {
        let slots = Slots(task);
        let place = |name: &str| slots.of(Sensor::LandmarkPosition(slots.landmark(name)));
        Self {
            own: Proprioception::new(&slots, sums),
            pelvis: place("pelvis"),
            pelvis_axes: slots.of(Sensor::LandmarkAxes(slots.landmark("pelvis"))),
            head: place("head"),
            palm: place("palm_r"),
            handle: place("door.handle"),
            ankles: ["ankle_l", "ankle_r"].map(place),
            angle: slots.of(Sensor::JointPosition(slots.joint("door.swing"))),
            opened: false,
            reached: [false; 2],
            success: false,
            horizon: task.horizon,
            step: 0,
        }
    }

    /// What the flags come to at a snapshot.
    fn remember(&mut self, frame: &[f64]) -> [bool; 2] {
        let through = frame[self.pelvis];
        self.opened |= frame[self.angle] > 1.0;
        self.success |= self.opened && through > 1.5;
        let before = self.reached;
        for (reached, line) in self.reached.iter_mut().zip([1.0, 2.0]) {
            *reached |= self.opened && through > line;
        }
        [0, 1].map(|line| self.reached[line] && !before[line])
    }

    fn gap(&self, frame: &[f64]) -> [f64; 3] {
        let (handle, palm) = (vector(frame, self.handle), vector(frame, self.palm));
        [handle[0] - palm[0], handle[1] - palm[1], handle[2] - palm[2]]
    }
}

impl Hand for Door {
    fn reset(&mut self, frame: &[f64]) {
        (self.step, self.opened, self.reached, self.success) = (0, false, [false; 2], false);
        self.remember(frame);
    }

    fn step(&mut self, frame: &[f64], weights: &[f64], outcome: &mut Outcome) {
        self.step += 1;
        let first = self.remember(frame);
        let angle = frame[self.angle];
        let reach = norm(self.gap(frame));
        let gate = ((0.3 - reach) / 0.15).clamp(0.0, 1.0);
        let [left, right] = self.ankles.map(|ankle| frame[ankle]);
        let leading = frame[self.pelvis] - left.max(right);
        let stride = (left - right).abs();
        outcome.ends = [frame[self.pelvis + 2] < 0.65, frame[self.head + 2] < 1.1];
        let ended = outcome.ends.contains(&true);
        let flag = |holds: bool| f64::from(u8::from(holds));
        outcome.terms = [
            libm::exp(-1.5 * reach),
            (angle / 1.2).clamp(0.0, 1.0) * gate,
            flag(first[0]),
            flag(first[1]),
            ((leading - 0.35) / 0.2).clamp(0.0, 1.0),
            (2.0 * (stride - 0.6)).clamp(0.0, 1.0),
            flag(!ended),
            flag(ended),
            self.own.effort(frame),
        ];
        outcome.reward = weighted_sum(&outcome.terms, weights);
        outcome.truncated = self.step >= self.horizon && !ended;
        outcome.success = self.success;
    }

    fn observe(&self, frame: &[f64], out: &mut [f64]) {
        let out = self.own.write(frame, out);
        out[..3].copy_from_slice(&along_heading(frame, self.pelvis_axes, self.gap(frame)));
        out[3] = frame[self.angle];
        out[4] = 2.5 - frame[self.pelvis];
    }
}
