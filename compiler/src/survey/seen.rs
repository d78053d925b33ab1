//! Between which bounds sensors are in a pose.

use crate::check::OperatingRange;
use crate::extremes::{maximum, minimum};
use crate::frame::{Query, Sensor};
use crate::graph::interval::{Bounds, Ranges};
use std::collections::{BTreeMap, BTreeSet};

/// A pose: what it settles is known but for a little, anything else may be anything that it can be.
pub(super) struct Seen<'a> {
    pub ranges: &'a OperatingRange<'a>,
    pub offsets: &'a BTreeMap<Sensor, usize>,
    pub frame: &'a [f64],
    /// Contacts that the poses speak about.
    pub trusted: &'a BTreeSet<Sensor>,
}

/// Places and distances are taken to be known to this, m: a smaller miss is not reported.
const LENGTH: f64 = 5e-3;
/// Angles and directions are taken to be known to this, rad.
const ANGLE: f64 = 1e-2;

/// Whether a pose settles what a sensor measures.
pub(super) fn of_pose(sensor: Sensor) -> bool {
    slack(sensor).is_some() || is_contact(sensor)
}

/// Whether a sensor tells of touching: a pose settles it, but only poses that are sought out touch anything.
pub(super) fn is_contact(sensor: Sensor) -> bool {
    matches!(sensor, Sensor::Touching(..) | Sensor::GroundContact(_))
}

/// How exactly a pose settles what a sensor measures; `None` if it does not.
fn slack(sensor: Sensor) -> Option<f64> {
    use Sensor as S;
    match sensor {
        S::LandmarkPosition(_) | S::LandmarkClearance(_) | S::ComPosition | S::RootPosition | S::SurfaceDistance(..) => {
            Some(LENGTH)
        }
        S::LandmarkAxes(_) | S::RootAxes | S::JointPosition(_) => Some(ANGLE),
        S::Query(..) => Some(LENGTH),
        _ => None,
    }
}

impl Ranges for Seen<'_> {
    fn sensor(&self, sensor: Sensor, lane: usize) -> Bounds {
        let anything = || self.ranges.sensor(sensor, lane);
        let value = || self.offsets.get(&sensor).and_then(|offset| self.frame.get(offset + lane)).copied();
        if self.trusted.contains(&sensor) {
            return value().map_or_else(anything, Bounds::point);
        }
        // A radar sees what is anywhere around: the poses are not sought out for that.
        if let Sensor::Query(query, _) = sensor
            && matches!(self.ranges.queries.get(query), Some(Query::Radar { .. }))
        {
            return anything();
        }
        match (slack(sensor), value()) {
            (Some(slack), Some(value)) if value.is_finite() => {
                let near = Bounds::new(value - slack, value + slack);
                match sensor {
                    Sensor::LandmarkAxes(_) | Sensor::RootAxes => Bounds::new(maximum(near.low, -1.0), minimum(near.high, 1.0)),
                    _ => near,
                }
            }
            _ => anything(),
        }
    }

    fn step(&self) -> Bounds {
        self.ranges.step()
    }
}

impl super::Survey<'_> {
    /// The sensors of contacts that the task reads, with their places in the record.
    pub fn contacts(&self) -> impl Iterator<Item = (Sensor, usize)> + '_ {
        self.offsets.iter().filter(|(sensor, _)| is_contact(**sensor)).map(|(sensor, offset)| (*sensor, *offset))
    }
}
