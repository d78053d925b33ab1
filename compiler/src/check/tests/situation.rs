//! What a test shows: a pose, the root, objects.

use super::Scene;
use crate::check::context::{Checked, Checker, Failures};
use crate::check::dimension::Dimension;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::{Span, codes};
use crate::scene::Motion;
use crate::syntax::tree::{Assignment, Change, Expr, ExprKind, Name, Situation};
use crate::task::{Init, Setting};

/// What is set of the root.
const ROOT: &str = "`root.height`, `root.lift`, `root.at`, `root.heading`, `root.pitch`, `root.roll`";

impl<'a> Checker<'a> {
    /// Changes a scene as a statement specifies; what it does not name stays. Returns, joint by joint, whether it is set.
    pub(super) fn situation(&mut self, situation: &'a Situation, scene: &mut Scene) -> Checked<Vec<bool>> {
        let mut failures = Failures::default();
        if let Some(pose) = &situation.pose {
            failures.catch(self.named_pose(pose, &mut scene.init));
        }
        let mut set = vec![false; scene.init.coordinates.len()];
        let mut met = false;
        for change in &situation.changes {
            let changed = match change {
                Change::Assign(assignment) => self.assign(assignment, scene, &mut set),
                Change::Align(align) => {
                    // The first that places the root replaces those of earlier keyframes, the others stand beside it.
                    let before = std::mem::take(&mut scene.init.root.meets);
                    let aligned = self.align(align, &mut scene.init);
                    if scene.init.root.meets.is_empty() || std::mem::replace(&mut met, true) {
                        scene.init.root.meets.splice(..0, before);
                    }
                    aligned
                }
            };
            failures.catch(changed);
        }
        failures.or(set)
    }

    fn assign(&mut self, assignment: &'a Assignment, scene: &mut Scene, set: &mut [bool]) -> Checked<()> {
        match &assignment.target.kind {
            ExprKind::Name(name) if name.text == "activation" => {
                let activation = self.fixed_number(&assignment.value, Dimension::NONE, "the activation")?;
                if !(0.0..=1.0).contains(&activation) {
                    return Err(self.error(codes::tasks::OUT_OF_RANGE, assignment.value.span, "activations lie in 0 .. 1"));
                }
                scene.activation = activation;
                Ok(())
            }
            ExprKind::Field { base, name } if matches!(&base.kind, ExprKind::Name(word) if word.text == "root") => {
                self.assign_root(name, &assignment.value, assignment.target.span, &mut scene.init)?;
                if name.text == "heading" {
                    scene.course = scene.init.root.heading;
                }
                Ok(())
            }
            ExprKind::Field { base, name } if ["at", "orientation"].contains(&name.text.as_str()) => {
                self.assign_object(base, name, &assignment.value, &mut scene.init)
            }
            _ => {
                for joint in self.adjusted(assignment, set)? {
                    let value = self.coordinate(joint, &assignment.value, assignment.target.span)?;
                    scene.init.decide(Setting::Coordinate(joint), value);
                }
                Ok(())
            }
        }
    }

    fn assign_root(&mut self, name: &'a Name, value: &'a Expr, span: Span, init: &mut Init) -> Checked<()> {
        let angle = |setting| (Dimension::ANGLE, setting);
        match name.text.as_str() {
            "height" => {
                init.root.meets.clear();
                init.drawn.retain(|(setting, _)| *setting != Setting::RootHeight);
                init.unfollow(Setting::RootHeight);
                init.root.height = match &value.kind {
                    ExprKind::Name(word) if word.text == "ground" => None,
                    _ => Some(self.fixed_number(value, Dimension::LENGTH, "`root.height`")?),
                };
                Ok(())
            }
            "lift" => {
                init.root.lift = self.fixed_number(value, Dimension::LENGTH, "`root.lift`")?;
                Ok(())
            }
            "at" => {
                init.root.meets.clear();
                let place: [f64; 2] = self.fixed_bracket(value, Dimension::LENGTH, "`root.at`")?;
                (0..2).for_each(|axis| init.decide(Setting::RootPosition(axis), place[axis]));
                Ok(())
            }
            "heading" | "pitch" | "roll" => {
                let (dimension, setting) = angle(match name.text.as_str() {
                    "heading" => Setting::RootHeading,
                    "pitch" => Setting::RootPitch,
                    _ => Setting::RootRoll,
                });
                let number = self.fixed_number(value, dimension, &format!("`root.{}`", name.text))?;
                init.decide(setting, number);
                Ok(())
            }
            other => {
                let message = format!("a test cannot set `root.{other}`");
                let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, span, message);
                Err(self.report(diagnostic.help(format!("a test can set {ROOT}, and `align palm_l to bar.grip_l`"))))
            }
        }
    }

    /// `cube.at = [1 m, 0, 1 m]`, `cube.orientation = 30 deg`
    fn assign_object(&mut self, base: &'a Expr, name: &'a Name, value: &'a Expr, init: &mut Init) -> Checked<()> {
        let place = match self.value(base)? {
            Value::Entity(EntityRef::Landmark(index)) => {
                let known = &self.vocabulary.landmarks[index].name;
                let scene = self.scene.map(|scene| &scene.description);
                init.objects.iter().position(|start| {
                    let object = scene.and_then(|scene| scene.objects.get(start.object));
                    object.is_some_and(|object| object.name == *known && object.motion == Motion::Free)
                })
            }
            _ => None,
        };
        let Some(place) = place else {
            let diagnostic = self
                .diagnostic(codes::tasks::UNKNOWN_SETTING, base.span, "only a free object can be placed")
                .help("set joints of objects by name: `door.swing = 30 deg`");
            return Err(self.report(diagnostic));
        };
        if name.text == "at" {
            let position: [f64; 3] = self.fixed_bracket(value, Dimension::LENGTH, "`at`")?;
            (0..3).for_each(|axis| init.decide(Setting::ObjectPosition(place, axis), position[axis]));
        } else {
            init.objects[place].orientation = self.turned(value)?;
        }
        Ok(())
    }
}

/// A field of `root { ... }` that a test decides no longer follows the motion on which the task begins.
pub(super) fn unfollow_field(scene: &mut Scene, field: &str) {
    let setting = match field {
        "height" => Setting::RootHeight,
        "heading" => {
            scene.course = scene.init.root.heading;
            Setting::RootHeading
        }
        "pitch" => Setting::RootPitch,
        "roll" => Setting::RootRoll,
        _ => return,
    };
    scene.init.unfollow(setting);
}
