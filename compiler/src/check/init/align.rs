//! Places that are brought to others: `align palm_l to bar.grip_l`, by the root, by joints, or by the object that owns the place.

use crate::check::context::{Checked, Checker, Reported};
use crate::check::dimension::Dimension;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::{Span, codes};
use crate::frame::Origin;
use crate::init::{Alignment, Moves};
use crate::scene::{Motion, Parent};
use crate::syntax::tree::{Align, Expr};
use crate::task::Init;

impl<'a> Checker<'a> {
    /// In a test, `align` moves what owns the place, or the joints behind `with`.
    pub(in crate::check) fn align(&mut self, align: &'a Align, init: &mut Init) -> Checked<()> {
        let landmark = self.aligned(&align.place)?;
        match &align.joints {
            Some(joints) => self.align_joints(align, joints, init),
            None if self.vocabulary.landmarks[landmark].of_scene => self.align_object(align, init).map(|_| ()),
            None => self.align_root(align, init),
        }
    }

    /// The root is moved until a landmark of the body is in its place.
    pub(in crate::check) fn align_root(&mut self, align: &'a Align, init: &mut Init) -> Checked<()> {
        if let Some(joints) = &align.joints {
            let message = "the root is moved as a whole, without joints";
            let diagnostic = self
                .diagnostic(codes::tasks::UNKNOWN_SETTING, joints.span, message)
                .help("in a test, joints bring a landmark to its place: `pose neutral { align palm_r to bar.grip_r with arms }`");
            return Err(self.report(diagnostic));
        }
        let landmark = self.landmark_of_body(align)?;
        let target = self.target(&align.target)?;
        if let Origin::Landmark(index, _) = target
            && !self.vocabulary.landmarks[index].of_scene
        {
            let message = "`align` moves the body to a place of the scene, not to a part of the body";
            return Err(self.error(codes::types::WRONG_TYPE, align.target.span, message));
        }
        init.root.meets.push((landmark, target));
        Ok(())
    }

    /// A free object is moved until a place of its own is in its place. Gives the object.
    pub(in crate::check) fn align_object(&mut self, align: &'a Align, init: &mut Init) -> Checked<usize> {
        let landmark = self.aligned(&align.place)?;
        let Some(object) = self.free_owner(landmark) else {
            let name = &self.vocabulary.landmarks[landmark].name;
            let message = format!("`{name}` belongs to nothing that is free");
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, align.place.span, message)
                .help("`align` moves a free object, or the root of the body: `root { align palm_l to bar.grip_l }`");
            return Err(self.report(diagnostic));
        };
        let target = self.target(&align.target)?;
        if let Origin::Landmark(index, _) = target
            && self.free_owner(index) == Some(object)
        {
            return Err(self.error(codes::types::WRONG_TYPE, align.target.span, "a thing cannot be aligned to a part of itself"));
        }
        init.alignments.retain(|known| known.moves != Moves::Object(object));
        init.alignments.push(Alignment { landmark, target, moves: Moves::Object(object) });
        Ok(object)
    }

    /// Joints bring a landmark of the body to its place.
    fn align_joints(&mut self, align: &'a Align, joints: &'a Expr, init: &mut Init) -> Checked<()> {
        let landmark = self.landmark_of_body(align)?;
        let target = self.target(&align.target)?;
        if let Origin::Landmark(index, _) = target {
            let object = self.free_owner(index);
            if init.alignments.iter().any(|known| object.is_some_and(|object| known.moves == Moves::Object(object))) {
                let message = "this object is aligned itself, after the joints have moved";
                let diagnostic = self
                    .diagnostic(codes::tasks::REPEATED, align.target.span, message)
                    .help("align one to the other, and not both to each other");
                return Err(self.report(diagnostic));
            }
        }
        let joints = self.reaching_joints(joints)?;
        let same = |known: &Alignment| known.landmark == landmark && matches!(known.moves, Moves::Joints(_));
        init.alignments.retain(|known| !same(known));
        // Joints first: objects are aligned to where they have brought the body.
        let place = init.alignments.iter().take_while(|known| matches!(known.moves, Moves::Joints(_))).count();
        init.alignments.insert(place, Alignment { landmark, target, moves: Moves::Joints(joints) });
        Ok(())
    }

    /// The independent joints of the body among those that are named; coupled ones follow them.
    fn reaching_joints(&mut self, expr: &'a Expr) -> Checked<Vec<usize>> {
        let found = self.entities_of(expr)?;
        let mut joints: Vec<usize> = Vec::new();
        for entity in &found {
            let EntityRef::Joint(index) = *entity else { return Err(self.no_joints(expr.span)) };
            let joint = &self.vocabulary.joints[index];
            if joint.of_scene {
                let message = format!("`{}` belongs to the scene", joint.name);
                let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message);
                return Err(self.report(diagnostic.help("joints of the body bring a landmark to its place")));
            }
            if joint.independent && !joints.contains(&index) {
                joints.push(index);
            }
        }
        match joints.is_empty() {
            true => Err(self.no_joints(expr.span)),
            false => Ok(joints),
        }
    }

    fn no_joints(&mut self, span: Span) -> Reported {
        let diagnostic = self
            .diagnostic(codes::types::WRONG_TYPE, span, "`with` lists independent joints of the body")
            .help("write `align palm_r to bar.grip_r with [arms, lumbar]`; `msk vocabulary` lists joints and their groups");
        self.report(diagnostic)
    }

    fn landmark_of_body(&mut self, align: &'a Align) -> Checked<usize> {
        let landmark = self.aligned(&align.place)?;
        match self.vocabulary.landmarks[landmark].of_scene {
            true => Err(self.no_landmark(align.place.span)),
            false => Ok(landmark),
        }
    }

    /// The landmark of the body or the place of an object that is aligned.
    fn aligned(&mut self, place: &'a Expr) -> Checked<usize> {
        match self.value(place)? {
            Value::Entity(EntityRef::Landmark(index)) => Ok(index),
            _ => Err(self.no_landmark(place.span)),
        }
    }

    fn no_landmark(&mut self, span: Span) -> Reported {
        let message = "`align` places a landmark of the body";
        let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, span, message).help("write `align palm_l to bar.grip_l`");
        self.report(diagnostic)
    }

    /// Where an aligned place shall be.
    fn target(&mut self, target: &'a Expr) -> Checked<Origin> {
        match self.value(target)? {
            Value::Entity(EntityRef::Landmark(index)) if self.stands_still(index) => {
                Ok(Origin::World(self.vocabulary.landmarks[index].neutral_position))
            }
            Value::Entity(EntityRef::Landmark(index)) => Ok(Origin::Landmark(index, [0.0; 3])),
            Value::Entity(_) | Value::Entities { .. } => {
                let message = "`align` goes to one place: a landmark, an object, or `[x, y, z]`";
                Err(self.error(codes::types::WRONG_TYPE, target.span, message))
            }
            Value::Typed(_) => self.fixed_bracket(target, Dimension::LENGTH, "`align`").map(Origin::World),
        }
    }

    /// The free object that a landmark is part of.
    fn free_owner(&self, landmark: usize) -> Option<usize> {
        let objects = &self.scene?.description.objects;
        let mut index = self.vocabulary.landmarks.get(landmark).filter(|known| known.of_scene).and(self.object_of(landmark))?;
        // A joint between the two would leave the place where it is relative to what it hangs on, so it moves along as well.
        loop {
            let object = objects.get(index)?;
            match object.motion {
                Motion::Free => return Some(index),
                _ => match object.parent {
                    // Parts stand behind what they are parts of.
                    Parent::Object(parent) if parent < index => index = parent,
                    _ => return None,
                },
            }
        }
    }
}
