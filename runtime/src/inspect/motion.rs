//! A motion measured on a body: ranges, couplings, feet against the ground, the seam of a cycle, the two sides.
//!
//! Nothing is judged by how it looks. A foot is known by the ends of its capsules: such an end stands while it is nearer to the
//! ground than [`TOUCH`] and hardly rises or falls; how far it wanders meanwhile is how far the foot slides.

use crate::body::Body;
use msk_physics::model::{GeomKind, Model};
use msk_physics::scalar::Real;
use msk_physics::{State, Workspace, kinematics};
use msk_program::motion::{Motion, RootPart, Target};
use nalgebra::Vector3;
use serde::Serialize;

/// What stands is nearer to the ground than this, m.
const TOUCH: f64 = 4e-3;
/// What stands neither rises nor falls faster, m/s.
const STILL: f64 = 0.15;
/// Times of a turn at which feet are looked at.
const TIMES: usize = 200;

/// What a motion may at most do wrong. Lengths in m, angles in rad.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MotionLimits {
    /// How deep a foot may be in the ground.
    pub penetration: f64,
    /// How far a standing foot may slide.
    pub sliding: f64,
    /// How much a coupled joint may differ from its coupling, rad or m.
    pub coupling: f64,
    /// How far a joint may leave its range, rad or m.
    pub range: f64,
    /// How many times the sharpest bend within a cycle that at its seam may be.
    pub seam: f64,
}

impl Default for MotionLimits {
    fn default() -> Self {
        Self { penetration: 5e-3, sliding: 20e-3, coupling: 1e-3, range: 2e-3, seam: 2.0 }
    }
}

/// What was measured. Lengths in m, times in s, angles in rad.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionReport {
    /// Name of the motion.
    pub name: String,
    /// Whether it repeats.
    pub cycle: bool,
    /// Its length.
    pub duration: f64,
    /// Rows of its table.
    pub rows: usize,
    /// Its columns, in order.
    pub columns: Vec<MotionColumn>,
    /// Both feet, if the body has a group `feet` and the motion the root's path.
    pub feet: Vec<MotionFoot>,
    /// How far the root goes in one turn, and its mean speed: of a cycle only.
    pub stride: Option<[f64; 2]>,
    /// The largest second derivative of a joint at the seam of a cycle over the largest within it.
    pub seam: Option<f64>,
    /// The largest difference of a joint from its partner on the other side, half a turn later or at the same time, whichever
    /// is smaller for the whole motion; and whether it is the later one.
    pub sides: Option<(f64, bool)>,
}

/// A column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionColumn {
    /// Its heading.
    pub name: String,
    /// The unit of its text.
    pub unit: String,
    /// SI value of one such unit.
    pub factor: f64,
    /// Lowest and highest value, SI units.
    pub values: [f64; 2],
    /// Largest rate, SI units.
    pub rate: f64,
    /// The joint's range, SI units.
    pub range: Option<[f64; 2]>,
    /// Of a coupled joint: how much it differs from its coupling.
    pub residual: Option<f64>,
}

/// A foot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionFoot {
    /// Its landmark.
    pub name: String,
    /// Share of the time for which any part of it stands.
    pub stance: f64,
    /// How deep it is in the ground at worst.
    pub penetration: f64,
    /// How far the end of a capsule wanders while it stands, at worst.
    pub sliding: f64,
    /// How high its lowest point rises at most while nothing of it stands.
    pub clearance: f64,
}

impl MotionReport {
    /// What exceeds the limits, in words.
    pub fn faults(&self, limits: &MotionLimits) -> Vec<String> {
        let mut faults = Vec::new();
        for column in &self.columns {
            let shown = |value: f64| format!("{:.2} {}", value / column.factor, column.unit);
            if let Some([low, high]) = column.range
                && (column.values[0] < low - limits.range || column.values[1] > high + limits.range)
            {
                let ([least, most], low, high) = (column.values, shown(low), shown(high));
                faults.push(format!("{} leaves its range {low} .. {high}: {} .. {}", column.name, shown(least), shown(most)));
            }
            if let Some(residual) = column.residual.filter(|residual| *residual > limits.coupling) {
                faults.push(format!("{} differs from its coupling by {}", column.name, shown(residual)));
            }
        }
        for foot in &self.feet {
            let millimetres = |value: f64| format!("{:.1} mm", 1e3 * value);
            if foot.penetration > limits.penetration {
                faults.push(format!("{} penetrates the ground by {}", foot.name, millimetres(foot.penetration)));
            }
            if foot.sliding > limits.sliding {
                faults.push(format!("{} slides by {} during stance", foot.name, millimetres(foot.sliding)));
            }
        }
        if let Some(seam) = self.seam.filter(|seam| *seam > limits.seam) {
            faults.push(format!("the cycle bends {seam:.2} times as sharply at its seam as anywhere else"));
        }
        faults
    }
}

/// Measures a motion on a body, which must have its joints.
pub fn inspect_motion(model: &Model, body: &Body, motion: &Motion) -> MotionReport {
    let x = motion.root(RootPart::X).map(|column| motion.advance(column));
    MotionReport {
        name: motion.name.clone(),
        cycle: motion.cycle,
        duration: motion.duration,
        rows: motion.times.len(),
        columns: columns(model, body, motion),
        feet: feet(model, body, motion),
        stride: x.filter(|_| motion.cycle).map(|stride| [stride, stride / motion.duration]),
        seam: motion.cycle.then(|| seam(motion)),
        sides: sides(motion),
    }
}

fn columns(model: &Model, body: &Body, motion: &Motion) -> Vec<MotionColumn> {
    let residuals = residuals(model, body, motion);
    let column = |(index, column): (usize, &msk_program::motion::Column)| {
        let joint = match &column.target {
            Target::Joint(name) => body.joints.iter().find(|joint| joint.name == *name),
            Target::Root(_) | Target::Site(..) => None,
        };
        let [slow, fast] = motion.rate_range(index);
        MotionColumn {
            name: column.target.name().into_owned(),
            unit: column.unit.clone(),
            factor: msk_program::quantity::unit::find(&column.unit).map_or(1.0, |unit| unit.factor),
            values: motion.range(index),
            rate: fast.at_least(-slow),
            range: joint.and_then(|joint| joint.range),
            residual: joint.filter(|joint| !joint.independent).map(|_| residuals[index]),
        }
    };
    motion.columns.iter().enumerate().map(column).collect()
}

/// For every column the largest difference of a coupled joint from its coupling, over the rows.
fn residuals(model: &Model, body: &Body, motion: &Motion) -> Vec<f64> {
    let mut worst = vec![0.0_f64; motion.columns.len()];
    let mut position = State::<f64>::new(model).position;
    for &time in &motion.times {
        let columns = body.joints.iter().filter_map(|joint| Some((joint, motion.joint(&joint.name)?)));
        let columns: Vec<_> = columns.collect();
        for (joint, column) in &columns {
            position[joint.position] = motion.value(*column, time);
        }
        body.solve_couplings(model, &mut position);
        for (joint, column) in columns {
            worst[column] = worst[column].at_least((position[joint.position] - motion.value(column, time)).abs());
        }
    }
    worst
}

/// An end of a foot's capsule, or the middle of its sphere.
struct End {
    geom: usize,
    /// In the shape's frame, m.
    point: Vector3<f64>,
    radius: f64,
}

/// The ends of a segment's capsules.
fn ends(model: &Model, segment: &[usize]) -> Vec<End> {
    let mut ends = Vec::new();
    for &geom in segment {
        let (radius, arm) = (model.geoms.size[geom].x, model.geoms.size[geom].y);
        match model.geoms.kind[geom] {
            GeomKind::Sphere => ends.push(End { geom, point: Vector3::zeros(), radius }),
            GeomKind::Capsule => {
                ends.extend([arm, -arm].map(|z| End { geom, point: Vector3::new(0.0, 0.0, z), radius }));
            }
            _ => {}
        }
    }
    ends
}

fn feet(model: &Model, body: &Body, motion: &Motion) -> Vec<MotionFoot> {
    let group = body.groups.iter().find(|group| group.name == "feet");
    let placed = [RootPart::X, RootPart::Y, RootPart::Height].iter().all(|part| motion.root(*part).is_some());
    let Some(group) = group.filter(|_| placed) else { return Vec::new() };
    // A climb has a step for each half turn; elsewhere the ground is level.
    let rise = motion.root(RootPart::Height).map_or(0.0, |column| motion.advance(column)) / 2.0;
    let feet: Vec<Vec<End>> = group.members.iter().map(|&landmark| ends(model, &body.landmarks[landmark].segment)).collect();
    // Two turns, so that a stance over the seam is seen whole.
    let turns = if motion.cycle { 2 } else { 1 };
    let step = motion.duration / TIMES as f64;
    let (mut state, mut workspace) = (State::new(model), Workspace::new(model));
    let mut tracks: Vec<Vec<Vec<Vector3<f64>>>> = feet.iter().map(|ends| vec![Vec::new(); ends.len()]).collect();
    for time in (0..=turns * TIMES).map(|index| index as f64 * step) {
        body.follow(model, motion, time, &mut state, &mut workspace);
        for (ends, track) in feet.iter().zip(&mut tracks) {
            for (end, places) in ends.iter().zip(track) {
                places.push(bottom(&workspace.kinematics, end));
            }
        }
    }
    let named = group.members.iter().map(|&landmark| body.landmarks[landmark].name.clone());
    named.zip(&tracks).map(|(name, track)| foot(name, track, rise, step, motion.cycle)).collect()
}

/// The lowest point of an end.
fn bottom(kinematics: &kinematics::Kinematics<f64>, end: &End) -> Vector3<f64> {
    kinematics.geom_position[end.geom] + kinematics.geom_rotation[end.geom] * end.point - Vector3::z() * end.radius
}

/// A foot from the tracks of its ends.
fn foot(name: String, tracks: &[Vec<Vector3<f64>>], rise: f64, step: f64, cycle: bool) -> MotionFoot {
    let times = tracks.first().map_or(0, Vec::len);
    let level = |z: f64| if rise > 0.0 { (z / rise).round() * rise } else { 0.0 };
    let stands = |track: &[Vector3<f64>], at: usize| {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(times - 1));
        let speed = (track[after].z - track[before].z) / (step * (after - before) as f64);
        let above = track[at].z - level(track[at].z);
        // Between two steps of a climb nothing stands.
        above < TOUCH && (rise == 0.0 || above > -rise / 8.0) && speed.abs() < STILL
    };
    let mut standing = vec![false; times];
    let (mut sliding, mut penetration, mut clearance) = (0.0_f64, 0.0_f64, 0.0_f64);
    for track in tracks {
        let mut from = None;
        for at in 0..times {
            let here = stands(track, at);
            standing[at] |= here;
            if here || rise == 0.0 {
                penetration = penetration.at_least(level(track[at].z) - track[at].z);
            }
            match (here, from) {
                (true, None) => from = Some(at),
                (false, Some(start)) => {
                    // What had begun before the first turn is seen in the second.
                    if !(cycle && start == 0) {
                        sliding = sliding.at_least(excursion(&track[start..at]));
                    }
                    from = None;
                }
                _ => {}
            }
        }
        if let Some(start) = from
            && !cycle
        {
            sliding = sliding.at_least(excursion(&track[start..]));
        }
    }
    for at in (0..times).filter(|at| !standing[*at]) {
        let lowest = tracks.iter().map(|track| track[at].z - level(track[at].z)).fold(f64::INFINITY, Real::at_most);
        clearance = clearance.at_least(lowest);
    }
    let stance = standing.iter().filter(|standing| **standing).count() as f64 / times.max(1) as f64;
    MotionFoot { name, stance, penetration, sliding, clearance }
}

/// The largest horizontal distance between two places of a track.
fn excursion(track: &[Vector3<f64>]) -> f64 {
    let pairs = track.iter().enumerate().flat_map(|(index, a)| track[index..].iter().map(move |b| (b - a).xy().norm()));
    pairs.fold(0.0, Real::at_least)
}

/// The sharpest bend of a joint at the seam over the sharpest elsewhere, from differences of rates.
fn seam(motion: &Motion) -> f64 {
    let width = motion.duration / (4.0 * TIMES as f64);
    let bend = |column: usize, time: f64| (motion.rate(column, time + width) - motion.rate(column, time - width)).abs();
    let joints: Vec<usize> =
        (0..motion.columns.len()).filter(|c| matches!(motion.columns[*c].target, Target::Joint(_))).collect();
    let ratio = |column: &usize| {
        let inner =
            (2..TIMES - 1).map(|index| bend(*column, index as f64 * motion.duration / TIMES as f64)).fold(0.0, Real::at_least);
        if inner > 1e-9 { bend(*column, 0.0) / inner } else { 0.0 }
    };
    joints.iter().map(ratio).fold(0.0, Real::at_least)
}

/// How far joints differ from their partners on the other side.
fn sides(motion: &Motion) -> Option<(f64, bool)> {
    let partner = |name: &str| name.strip_suffix("_l").map(|stem| format!("{stem}_r"));
    let pairs: Vec<(usize, usize)> =
        motion.joints().filter_map(|name| Some((motion.joint(name)?, motion.joint(&partner(name)?)?))).collect();
    let worst = |delay: f64| {
        let differences = pairs.iter().flat_map(|&(left, right)| {
            motion.times.iter().map(move |time| (motion.value(left, time + delay) - motion.value(right, *time)).abs())
        });
        differences.fold(0.0, Real::at_least)
    };
    let (together, later) = (worst(0.0), if motion.cycle { worst(0.5 * motion.duration) } else { f64::INFINITY });
    (!pairs.is_empty()).then_some(if later < together { (later, true) } else { (together, false) })
}
