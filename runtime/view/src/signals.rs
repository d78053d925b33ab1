//! Curves beside the picture: what the task reads of body and scene, its metrics, the return.
//!
//! Joint coordinates and their rates, places of landmarks and everything about single
//! muscles follow from the recording already. A curve is drawn a few hundred pixels high, so
//! each is stored in steps of a 1000th of its range.

use crate::track::Track;
use msk_program::frame::Sensor;
use msk_program::scene::Part;
use msk_program::task::CompiledTask;
use msk_program::vocabulary::JointKind;
use serde::Serialize;

/// Steps of a curve's range; the number after the last stands for what is not a number.
const STEPS: f64 = 1000.0;
const NOTHING: i32 = 1001;

/// A curve: its value is low + step * code.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Signal {
    pub name: String,
    pub unit: String,
    pub low: f64,
    pub step: f64,
}

/// Curves of all frames so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Signals {
    names: Vec<(String, String)>,
    rows: Vec<f64>,
}

impl Signals {
    /// Adds a curve; all are added before the first frame.
    pub fn add(&mut self, name: impl Into<String>, unit: impl Into<String>) {
        self.names.push((name.into(), unit.into()));
    }

    /// Appends the values of a frame, in the order of the curves.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        let before = self.rows.len();
        self.rows.extend(row);
        self.rows.resize(before + self.names.len(), f64::NAN);
    }

    /// The curves with their ranges, and a track of their codes.
    pub fn finish(&self) -> (Vec<Signal>, Track) {
        let width = self.names.len();
        let describe = |(index, (name, unit)): (usize, &(String, String))| {
            let finite = self.rows.iter().skip(index).step_by(width).copied().filter(|value| value.is_finite());
            let (low, high) =
                finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
            let (low, range) = if low <= high { (low, high - low) } else { (0.0, 0.0) };
            Signal { name: name.clone(), unit: unit.clone(), low, step: range / STEPS }
        };
        let signals: Vec<Signal> = self.names.iter().enumerate().map(describe).collect();
        let mut track = Track::new(width);
        for row in self.rows.chunks(width.max(1)) {
            track.push(row.iter().zip(&signals).map(|(value, signal)| match value.is_finite() {
                true if signal.step > 0.0 => ((value - signal.low) / signal.step).round() as i32,
                true => 0,
                false => NOTHING,
            }));
        }
        (signals, track)
    }
}

/// What of a task's frame becomes a curve: the place of its value in the frame, its name and unit.
pub(crate) fn of_frame(task: &CompiledTask) -> Vec<(usize, String, &'static str)> {
    let curves = task.frame.entries().iter().flat_map(|&(sensor, offset)| {
        let named = name(task, sensor);
        let axes: &[(usize, &str)] = match sensor.size() {
            _ if named.is_none() => &[],
            1 => &[(0, "")],
            3 => &[(0, ".x"), (1, ".y"), (2, ".z")],
            _ => &[],
        };
        let (name, unit) = named.unwrap_or_default();
        axes.iter().map(move |(axis, suffix)| (offset + axis, format!("{name}{suffix}"), unit))
    });
    curves.collect()
}

/// Name and unit of a sensor as a task writes them; `None` for what is recorded elsewhere.
fn name(task: &CompiledTask, sensor: Sensor) -> Option<(String, &'static str)> {
    use Sensor as S;
    let words = &task.vocabulary;
    let landmark = |index: usize| words.landmarks.get(index).map(|landmark| landmark.name.as_str());
    let part = |part: Part| match part {
        Part::Ground => Some("ground"),
        Part::Robot => Some("robot"),
        Part::Landmark(index) => landmark(index),
        Part::Group(index) => words.groups.get(index).map(|group| group.name.as_str()),
    };
    let joint = |index: usize| {
        let joint = words.joints.get(index)?;
        Some((joint.name.as_str(), joint.kind == JointKind::Hinge))
    };
    let of_landmark = |index: usize, signal: &str| Some(format!("{}.{signal}", landmark(index)?));
    let of_parts = |signal: &str, first: Part, second: Part| Some(format!("{signal}({}, {})", part(first)?, part(second)?));
    Some(match sensor {
        S::LandmarkVelocity(index) => (of_landmark(index, "velocity")?, "m/s"),
        S::LandmarkAcceleration(index) => (of_landmark(index, "acceleration")?, "m/s^2"),
        S::LandmarkAngularVelocity(index) => (of_landmark(index, "angular_velocity")?, "rad/s"),
        S::LandmarkClearance(index) => (of_landmark(index, "clearance")?, "m"),
        S::GroundForce(index) => (of_parts("contact_force", Part::Landmark(index), Part::Ground)?, "N"),
        S::GroundContact(index) => (of_parts("touching", Part::Landmark(index), Part::Ground)?, ""),
        S::Touching(first, second) => (of_parts("touching", first, second)?, ""),
        S::ContactForce(first, second) => (of_parts("contact_force", first, second)?, "N"),
        S::ContactCount(first, second) => (of_parts("contact_count", first, second)?, ""),
        S::SurfaceDistance(first, second) => (of_parts("surface_distance", first, second)?, "m"),
        S::Slip(first, second) => (of_parts("slip", first, second)?, "m/s"),
        S::JointTorque(index) => match joint(index)? {
            (name, true) => (format!("{name}.torque"), "N m"),
            (name, false) => (format!("{name}.torque"), "N"),
        },
        S::ComPosition => ("com.position".to_owned(), "m"),
        S::ComVelocity => ("com.velocity".to_owned(), "m/s"),
        S::ComAcceleration => ("com.acceleration".to_owned(), "m/s^2"),
        S::AngularMomentum => ("angular_momentum".to_owned(), "kg m^2/s"),
        S::CentreOfPressure => ("centre_of_pressure".to_owned(), "m"),
        S::SupportMargin => ("support_margin".to_owned(), "m"),
        S::RootVelocity => ("root.velocity".to_owned(), "m/s"),
        S::RootAngularVelocity => ("root.angular_velocity".to_owned(), "rad/s"),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_keep_their_range_and_their_gaps() {
        let mut signals = Signals::default();
        signals.add("height", "m");
        signals.add("still", "");
        for (height, still) in [(1.0, 3.0), (f64::NAN, 3.0), (3.0, 3.0)] {
            signals.push([height, still]);
        }
        let (found, track) = signals.finish();
        assert_eq!((found[0].low, found[0].step, found[1].low, found[1].step), (1.0, 2.0 / STEPS, 3.0, 0.0));
        assert_eq!(track.column(0).collect::<Vec<_>>(), [0, NOTHING, 1000]);
        assert_eq!(track.column(1).collect::<Vec<_>>(), [0, 0, 0]);
    }
}
