//! A delay by whole control steps.

use serde::{Deserialize, Serialize};

/// The last actions, as many as the delay is long.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Delay {
    /// One action after the other, in a ring.
    kept: Vec<f64>,
    /// Which of them is the oldest.
    oldest: usize,
    /// The action that takes effect now.
    present: Vec<f64>,
}

impl Delay {
    /// A delay of actions with so many entries by so many steps.
    pub fn new(size: usize, steps: u32) -> Self {
        // The checker bounds the latency.
        Self { kept: vec![0.0; size * steps as usize], oldest: 0, present: vec![0.0; size] }
    }

    /// Whether it has the shape of another one, and its ring is whole.
    pub fn fits(&self, other: &Self) -> bool {
        let sizes = |delay: &Self| [delay.kept.len(), delay.present.len()];
        sizes(self) == sizes(other) && self.oldest * self.present.len() <= self.kept.len().saturating_sub(self.present.len())
    }

    /// As after endless steps with this value in every entry.
    pub fn fill(&mut self, value: f64) {
        self.kept.fill(value);
        self.oldest = 0;
        self.present.fill(value);
    }

    /// Takes the action of this step, and gives that which takes effect in it.
    pub fn advance(&mut self, action: impl Iterator<Item = f64>) -> &[f64] {
        let size = self.present.len();
        if self.kept.is_empty() {
            self.present.iter_mut().zip(action).for_each(|(present, entry)| *present = entry);
            return &self.present;
        }
        let place = self.oldest * size;
        let kept = &mut self.kept[place..place + size];
        self.present.copy_from_slice(kept);
        kept.iter_mut().zip(action).for_each(|(kept, entry)| *kept = entry);
        self.oldest = (self.oldest + 1) % (self.kept.len() / size);
        &self.present
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_action_comes_out_after_as_many_steps() {
        for steps in [0_u32, 1, 3] {
            let mut delay = Delay::new(2, steps);
            delay.fill(-1.0);
            for step in 0..8 {
                let value = f64::from(step);
                let found = delay.advance([value, 10.0 * value].into_iter()).to_vec();
                let expected = if step < steps {
                    vec![-1.0, -1.0]
                } else {
                    vec![value - f64::from(steps), 10.0 * (value - f64::from(steps))]
                };
                assert_eq!(found, expected, "step {step} with a delay of {steps}");
            }
        }
    }
}
