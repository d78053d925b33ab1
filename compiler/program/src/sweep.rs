//! What perturbation sweeps grow, and along which scales.

use serde::{Deserialize, Serialize};

/// Episodes of each task at each scale, unless a protocol or a caller has another number.
pub const EPISODES: u32 = 30;

/// Largest scale of noise and pushes.
const LARGEST: f64 = 1000.0;

/// What grows in a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Noise on every entry of the action.
    Action,
    /// Noise on every entry of the normalised observation.
    Observation,
    /// Factors of the active forces of muscles.
    Gain,
    /// Pushes against the root, in body weights.
    Push,
    /// Factor of the friction of the ground.
    Friction,
    /// Factors of the masses of segments.
    Mass,
    /// Control steps by which actions are late.
    Latency,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Action, Self::Observation, Self::Gain, Self::Push, Self::Friction, Self::Mass, Self::Latency];
    /// Those of the paper, whose areas are averaged.
    pub const PAPER: [Self; 3] = [Self::Action, Self::Observation, Self::Gain];

    /// Its name in suites, on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Action => "action",
            Self::Observation => "observation",
            Self::Gain => "gain",
            Self::Push => "push",
            Self::Friction => "friction",
            Self::Mass => "mass",
            Self::Latency => "latency",
        }
    }

    /// The axis of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|axis| axis.name() == name)
    }

    /// What its scales are, as a heading: a noun after the name.
    pub fn scale(self) -> &'static str {
        match self {
            Self::Action => "standard deviation of the noise on every entry",
            Self::Observation => "standard deviation of the noise on every normalised entry",
            Self::Gain => "largest relative change of a muscle's force, drawn per episode",
            Self::Push => "force against the root in body weights",
            Self::Friction => "largest relative change of the ground's friction, drawn per episode",
            Self::Mass => "largest relative change of a segment's mass, drawn per episode",
            Self::Latency => "control steps by which actions are late",
        }
    }

    /// The usual scales, from 0 on.
    pub fn grid(self) -> [f64; 5] {
        match self {
            Self::Action | Self::Gain | Self::Mass => [0.0, 0.05, 0.10, 0.15, 0.20],
            Self::Observation => [0.0, 0.02, 0.05, 0.08, 0.10],
            Self::Push => [0.0, 0.05, 0.10, 0.20, 0.40],
            Self::Friction => [0.0, 0.2, 0.4, 0.6, 0.8],
            Self::Latency => [0.0, 1.0, 2.0, 4.0, 8.0],
        }
    }

    /// What a scale may be, if `scale` is none.
    pub fn refuses(self, scale: f64) -> Option<&'static str> {
        let (fits, expected) = match self {
            Self::Action | Self::Observation | Self::Push => ((0.0..=LARGEST).contains(&scale), "a number from 0 to 1000"),
            // A factor of 0 would take force, friction or mass away.
            Self::Gain | Self::Friction | Self::Mass => ((0.0..1.0).contains(&scale), "a number from 0 to below 1"),
            Self::Latency => {
                ((0.0..=LARGEST).contains(&scale) && scale.fract() == 0.0, "a whole number of control steps, at most 1000")
            }
        };
        (!fits).then_some(expected)
    }
}

/// Along what and how a protocol sweeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepProtocol {
    /// Episodes of each task at each scale.
    pub episodes: u32,
    /// Axes with their scales, which grow from 0.
    pub axes: Vec<(Axis, Vec<f64>)>,
}

impl Default for SweepProtocol {
    /// That of the paper.
    fn default() -> Self {
        Self { episodes: EPISODES, axes: Axis::PAPER.map(|axis| (axis, axis.grid().to_vec())).to_vec() }
    }
}

impl SweepProtocol {
    /// The scales of an axis: the usual ones where the protocol has none.
    pub fn scales(&self, axis: Axis) -> Vec<f64> {
        let known = self.axes.iter().find(|(known, _)| *known == axis);
        known.map_or_else(|| axis.grid().to_vec(), |(_, scales)| scales.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_scales_begin_at_zero_and_grow_within_bounds() {
        for axis in Axis::ALL {
            let grid = axis.grid();
            assert!(grid[0] == 0.0 && grid.windows(2).all(|pair| pair[0] < pair[1]), "{axis:?}");
            assert!(grid.iter().all(|scale| axis.refuses(*scale).is_none()), "{axis:?}");
            assert!([-0.1, f64::NAN, 1001.0].iter().all(|scale| axis.refuses(*scale).is_some()), "{axis:?}");
            assert_eq!(Axis::named(axis.name()), Some(axis));
        }
        assert!(Axis::Latency.refuses(1.5).is_some() && Axis::Gain.refuses(1.0).is_some() && Axis::Push.refuses(1.0).is_none());
    }

    #[test]
    fn axes_without_scales_have_the_usual_ones() {
        let sweep = SweepProtocol { episodes: 2, axes: vec![(Axis::Push, vec![0.0, 0.5])] };
        assert_eq!(sweep.scales(Axis::Push), [0.0, 0.5]);
        assert_eq!(sweep.scales(Axis::Action), Axis::Action.grid());
    }
}
