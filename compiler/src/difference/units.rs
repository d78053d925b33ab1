//! Units of the numbers of joints. A snapshot writes them bare, in SI units, because a joint's kind is known to who reads the body.

use super::Change;
use crate::vocabulary::{Joint, JointKind};

/// Writes the unit behind each number of a pose, a velocity and the noise of joints.
pub(super) fn write(changes: &mut [Change], joints: &[Joint]) {
    for change in changes {
        let rate = if change.section == "velocities" || change.name == "velocities" { "/s" } else { "" };
        match change.section.as_str() {
            "pose" | "velocities" => {
                for field in &mut change.fields {
                    let Some(unit) = unit(&field.field, joints) else { continue };
                    for value in [&mut field.before, &mut field.after].into_iter().flatten() {
                        *value = format!("{value} {unit}{rate}");
                    }
                }
            }
            "noise" => {
                for field in &mut change.fields {
                    let listed = field.before.as_ref().or(field.after.as_ref());
                    let Some(unit) = listed.and_then(|names| common_unit(names, joints)) else { continue };
                    // `uniform -0.1..0.1` has two numbers.
                    field.field = format!("{} {unit}{rate}", field.field.replace("..", &format!(" {unit}{rate}..")));
                }
            }
            _ => {}
        }
    }
}

/// Of the coordinate of a joint.
fn unit(name: &str, joints: &[Joint]) -> Option<&'static str> {
    joints.iter().find(|joint| joint.name == name).map(|joint| match joint.kind {
        JointKind::Hinge => "rad",
        JointKind::Slide => "m",
    })
}

/// Of all joints of a list as a snapshot writes it (`hip_r, knee_r to toe_r (5)`), where they have the same.
fn common_unit(names: &str, joints: &[Joint]) -> Option<&'static str> {
    let mut units = names.split(", ").flat_map(|run| run.split(" to ")).map(|name| unit(name.split(' ').next()?, joints));
    let first = units.next()??;
    units.all(|unit| unit == Some(first)).then_some(first)
}
