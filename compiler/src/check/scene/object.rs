//! One element: from its fields and parts to objects of the scene.

use super::drawn::{FieldNumber, SceneField};
use super::elements::{self, KINDS};
use super::fields::Fields;
use super::joints::DrawnParameter;
use super::shapes::Draw;
use super::varied::is_shape;
use super::{Stage, head, rotation, shapes};
use crate::check::context::{Checked, Checker, Reported};
use crate::check::dimension::Dimension;
use crate::check::scene::expand::Locals;
use crate::check::signals::{self, Owner};
use crate::diagnostics::{Span, codes, nearest};
use crate::scene::{Motion, Object, Parent, Shape, Surface};
use crate::syntax::tree::{Element, Expr, ExprKind};

impl<'a> Checker<'a> {
    /// Reports a kind that there is not.
    pub(super) fn unknown_element(&mut self, element: &'a Element) -> Reported {
        let word = element.kind.text.as_str();
        let names = || KINDS.iter().map(|kind| kind.name);
        let message = format!("unknown element `{word}`");
        let mut diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, element.kind.span, message);
        let near = nearest(word, names());
        if near.is_empty() {
            diagnostic = diagnostic.help(format!("there is {}", names().collect::<Vec<_>>().join(", ")));
        }
        for name in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), element.kind.span, name);
        }
        self.report(diagnostic)
    }

    /// An element with its parts. `carrier` is the object around it, by its place in the scene.
    pub(super) fn object(
        &mut self,
        stage: &mut Stage<'a>,
        element: &'a Element,
        name: &str,
        carrier: Option<usize>,
        locals: &Locals,
    ) -> Checked<()> {
        let Some(kind) = KINDS.iter().find(|kind| kind.name == element.kind.text) else {
            if elements::is_joint(&element.kind.text) {
                let message = format!("a `{}` is declared inside the element that it moves", element.kind.text);
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, element.kind.span, message)
                    .help("write `body door { hinge swing { ... }, box leaf { ... } }`");
                return Err(self.report(diagnostic));
            }
            return Err(self.unknown_element(element));
        };
        if kind.name == "ground" {
            let message = "the ground is level at height 0; it is not part of another element and has no name";
            return Err(self.error(codes::tasks::UNKNOWN_SETTING, element.span, message));
        }
        self.must_be_new(stage, element, name)?;
        let fields = self.fields(element, kind)?;
        let placed = self.placed(&fields)?;
        let parent = self.parent(stage, element, carrier)?;
        let (mut motion, joints) = self.motion(stage, element, &fields, name, &parent)?;
        let (sizes, places): (Vec<Draw<'a>>, Vec<Draw<'a>>) = placed.drawn.iter().partition(|(field, _)| is_shape(*field));
        if !places.is_empty() {
            motion = self.placed_by_chance(motion, &parent, &places)?;
        }
        if let Some((_, expr)) = sizes.first() {
            motion = self.varied(stage, motion, &parent, expr)?;
        }
        self.must_have_own_mass(&fields, &sizes)?;
        motion = self.driven(stage, element, (&fields, locals), (motion, &parent))?;
        let (surface, friction) = self.surface(&fields, placed.shape.as_ref())?;
        let mass = self.mass(&fields, placed.shape.as_ref())?;
        let fixed = motion == Motion::Fixed
            && match parent {
                Parent::World => true,
                Parent::Object(index) => stage.fixed[index],
                Parent::Landmark(_) => false,
            };
        let stands = match (&motion, &parent) {
            (Motion::Placed | Motion::Driven, _) => true,
            (Motion::Fixed, Parent::Object(index)) => stage.stands(*index),
            _ => fixed,
        };
        self.must_stand_if_walked_on(&fields, placed.shape.as_ref(), &surface, stands)?;
        let index = stage.scene.objects.len();
        let mass_drawn = mass.drawn.map(|expr| (SceneField::Mass, expr));
        let drawn =
            placed.drawn.iter().copied().chain(mass_drawn).chain(friction.map(|expr| (SceneField::Friction, expr))).chain(joints);
        drawn.for_each(|(field, expr)| stage.draw(Some(index), field, expr, (locals, self.place.file)));
        let terrain = matches!(placed.shape, Some(Shape::Plane | Shape::Terrain(_)));
        if terrain && !stands {
            let message = format!("{} cannot be part of a moving element", kind.name);
            return Err(self.error(codes::scene::MOTION, element.kind.span, message));
        }
        stage.push(
            self.vocabulary,
            Object {
                name: name.to_owned(),
                description: element.docs.as_ref().map(|docs| docs.text.clone()).unwrap_or_default(),
                parent,
                position: placed.position,
                orientation: placed.orientation,
                motion,
                shape: placed.shape,
                mass: mass.value,
                surface,
            },
            fixed,
            (self.place.file, head(element)),
        );
        self.keep_geometry(stage, index);
        for part in element.parts.iter().filter(|part| !elements::is_joint(&part.kind.text)) {
            self.part(stage, part, name, index, locals);
        }
        Ok(())
    }

    fn part(&mut self, stage: &mut Stage<'a>, part: &'a Element, owner: &str, carrier: usize, locals: &Locals) {
        let Ok(Some(own)) = self.element_name(part) else { return };
        let taken = [Owner::Landmark, Owner::Object].into_iter().any(|owner| signals::find(owner, &own).is_some());
        if taken {
            let message = format!("`{own}` is a signal of every object, so it cannot be the name of a part");
            self.error(codes::names::DECLARED_TWICE, head(part), message);
            return;
        }
        // What is wrong in a part is reported; the others are checked all the same.
        let _ = self.object(stage, part, &format!("{owner}.{own}"), Some(carrier), locals);
    }

    fn must_be_new(&mut self, stage: &Stage<'a>, element: &'a Element, name: &str) -> Checked<()> {
        let span = head(element);
        if let Some(first) = stage.scene.objects.iter().position(|object| object.name == name) {
            let message = format!("the object `{name}` is declared twice");
            let diagnostic = self.diagnostic(codes::names::DECLARED_TWICE, span, message).here("again here");
            let (file, span) = stage.spans[first];
            let diagnostic = diagnostic.label(file, span, "first here");
            return Err(self.report(diagnostic));
        }
        if !name.contains('.') && (self.means_something(name) || ["root", "world", "robot"].contains(&name)) {
            let message = format!("`{name}` is already defined: it is a part of the body, a signal or a function");
            let diagnostic = self
                .diagnostic(codes::names::DECLARED_TWICE, span, message)
                .help("choose another name; `msk vocabulary` lists the names in use");
            return Err(self.report(diagnostic));
        }
        Ok(())
    }

    /// What carries the element: what is around it, what it stands `on`, or the world.
    fn parent(&mut self, stage: &Stage<'a>, element: &'a Element, carrier: Option<usize>) -> Checked<Parent> {
        match (carrier, &element.on) {
            (None, None) => Ok(Parent::World),
            (Some(index), None) => Ok(Parent::Object(index)),
            (Some(_), Some(on)) => {
                let message = "a part is attached to its enclosing element; it cannot also have `on`";
                Err(self.error(codes::tasks::REPEATED, on.span, message))
            }
            (None, Some(on)) => self.carrier(stage, on),
        }
    }

    fn carrier(&mut self, stage: &Stage<'a>, on: &'a Expr) -> Checked<Parent> {
        let Some(name) = dotted(on) else {
            return Err(self.error(
                codes::types::WRONG_TYPE,
                on.span,
                "`on` names a landmark of the body or an object of the scene",
            ));
        };
        if let Some(index) = stage.scene.objects.iter().position(|object| object.name == name) {
            return Ok(Parent::Object(index));
        }
        if self.vocabulary.landmarks.iter().any(|landmark| landmark.name == name) {
            return Ok(Parent::Landmark(name));
        }
        let landmarks = self.vocabulary.landmarks.iter().map(|landmark| landmark.name.clone());
        let objects = stage.scene.objects.iter().map(|object| object.name.clone());
        let known = landmarks.chain(objects).collect();
        Err(self.unknown_name(&name, on.span, known))
    }

    fn motion(
        &mut self,
        stage: &Stage<'a>,
        element: &'a Element,
        fields: &Fields<'a>,
        name: &str,
        parent: &Parent,
    ) -> Checked<(Motion, Vec<Draw<'a>>)> {
        let mut drawn = Vec::new();
        let mut joints: Vec<crate::scene::ObjectJoint> = Vec::new();
        for part in element.parts.iter().filter(|part| elements::is_joint(&part.kind.text)) {
            let (joint, parameters) = self.object_joint(part, name)?;
            let place = joints.len();
            let field =
                |DrawnParameter { property, dimension, formula }| (SceneField::Joint { place, property, dimension }, formula);
            drawn.extend(parameters.into_iter().map(field));
            let known = stage.scene.objects.iter().any(|object| object.name == joint.name);
            if known || joints.iter().any(|other| other.name == joint.name) {
                let message = format!("`{}` is declared twice", joint.name);
                return Err(self.error(codes::names::DECLARED_TWICE, part.span, message));
            }
            joints.push(joint);
        }
        let free = self.flag(fields, "free", false)?;
        match (free, joints.is_empty()) {
            (false, true) => Ok((Motion::Fixed, drawn)),
            (false, false) => Ok((Motion::Joints(joints), drawn)),
            (true, false) => {
                Err(self.error(codes::scene::MOTION, element.kind.span, format!("`{name}` is free and has joints: choose one")))
            }
            (true, true) if *parent != Parent::World => {
                let message = format!("`{name}` is free, so it cannot be part of another element");
                let diagnostic = self
                    .diagnostic(codes::scene::MOTION, element.kind.span, message)
                    .help("declare it at the top level, or give it a joint instead");
                Err(self.report(diagnostic))
            }
            (true, true) => Ok((Motion::Free, drawn)),
        }
    }

    /// Only what stands in the world, or is free, can stand elsewhere in every episode.
    fn placed_by_chance(&mut self, motion: Motion, parent: &Parent, drawn: &[(SceneField, &'a Expr)]) -> Checked<Motion> {
        match (motion, parent) {
            (Motion::Fixed, Parent::World) => Ok(Motion::Placed),
            (Motion::Free, _) => Ok(Motion::Free),
            _ => {
                let span = drawn.first().map_or_else(Span::default, |(_, expr)| expr.span);
                let message = "only what is free, or fixed to the world, can have another place in every episode";
                let diagnostic = self
                    .diagnostic(codes::types::NOT_CONSTANT, span, message)
                    .help("put it into a frame that is placed: `body frame { at [x, 0, 0], body door { hinge swing { ... } } }`");
                Err(self.report(diagnostic))
            }
        }
    }

    /// How it meets others, and its friction if that is drawn.
    fn surface(&mut self, fields: &Fields<'a>, shape: Option<&Shape>) -> Checked<(Surface, Option<&'a Expr>)> {
        let (friction, drawn) = self.friction(fields)?;
        let mut surface = Surface { friction, decides: drawn.is_some(), ..Surface::default() };
        surface.solid = self.flag(fields, "solid", true)?;
        surface.walkable = self.flag(fields, "walkable", matches!(shape, Some(Shape::Terrain(_))) && surface.solid)?;
        if surface.walkable && !surface.solid {
            let message = "an object without contacts cannot be walkable";
            return Err(self.error(codes::scene::MOTION, fields.span, message));
        }
        Ok((surface, drawn))
    }

    /// `friction 1.5`, or the sliding, torsional and rolling one; the sliding one alone may be drawn.
    pub(super) fn friction(&mut self, fields: &Fields<'a>) -> Checked<([f64; 3], Option<&'a Expr>)> {
        let mut friction = Surface::default().friction;
        let Some(field) = fields.get("friction") else { return Ok((friction, None)) };
        let expr = self.field_value(field)?;
        let mut drawn = None;
        if let ExprKind::List(parts) = &expr.kind
            && let [sliding, torsional, rolling] = parts.as_slice()
        {
            friction[0] = self.fixed_number(sliding, Dimension::NONE, "sliding `friction`")?;
            friction[1] = self.fixed_number(torsional, Dimension::LENGTH, "torsional `friction`")?;
            friction[2] = self.fixed_number(rolling, Dimension::LENGTH, "rolling `friction`")?;
        } else {
            let sliding = self.field_number(expr, Dimension::NONE, "`friction`")?;
            let negative = |value: f64| (value < 0.0).then_some("is negative");
            self.must_be_within(&sliding, negative, "`friction`", expr.span)?;
            (friction[0], drawn) = (sliding.value, sliding.drawn);
        }
        if friction.iter().any(|value| *value < 0.0) {
            return Err(self.error(codes::scene::SIZE, expr.span, "`friction` is negative"));
        }
        Ok((friction, drawn))
    }

    fn mass(&mut self, fields: &Fields<'a>, shape: Option<&Shape>) -> Checked<FieldNumber<'a>> {
        match (fields.get("mass"), fields.get("density")) {
            (Some(_), Some(density)) => {
                Err(self.error(codes::tasks::REPEATED, density.span, "`mass` and `density` exclude each other"))
            }
            (Some(field), None) => {
                let expr = self.field_value(field)?;
                let mass = self.field_number(expr, Dimension::MASS, "`mass`")?;
                match mass.drawn {
                    None => self.must_be_positive(mass.value, "mass", expr.span)?,
                    Some(_) => {
                        let wrong = |value: f64| (value <= 0.0).then_some("is not positive");
                        self.must_be_within(&mass, wrong, "`mass`", expr.span)?;
                    }
                }
                Ok(mass)
            }
            (None, Some(_)) => {
                let density = self.positive(fields, "density", Dimension::of(-3, 1, 0, 0))?;
                Ok(FieldNumber::known(density * shape.and_then(shapes::volume).unwrap_or(0.0), Dimension::MASS))
            }
            (None, None) => Ok(FieldNumber::known(0.0, Dimension::MASS)),
        }
    }

    fn must_stand_if_walked_on(
        &mut self,
        fields: &Fields<'a>,
        shape: Option<&Shape>,
        surface: &Surface,
        fixed: bool,
    ) -> Checked<()> {
        if !surface.walkable || fixed && shape.is_some() {
            return Ok(());
        }
        let message = "only fixed objects can be ground";
        let diagnostic = self
            .diagnostic(codes::scene::MOTION, fields.span, message)
            .help("contacts with a moving object: `touching(sole_l, board)`");
        Err(self.report(diagnostic))
    }

    /// `orientation 30 deg` or `orientation [roll, pitch, yaw]`
    pub(crate) fn turned(&mut self, expr: &'a Expr) -> Checked<[f64; 4]> {
        if let ExprKind::List(_) = expr.kind {
            return Ok(rotation::turned(self.fixed_bracket(expr, Dimension::ANGLE, "`orientation`")?));
        }
        let yaw = self.fixed_number(expr, Dimension::ANGLE, "`orientation`")?;
        Ok(rotation::turned([0.0, 0.0, yaw]))
    }
}

/// `door`, `door.leaf`: a name with dots, without patterns.
pub(crate) fn dotted(expr: &Expr) -> Option<String> {
    match &expr.kind {
        ExprKind::Name(name) => Some(name.text.clone()),
        ExprKind::Field { base, name } => Some(format!("{}.{}", dotted(base)?, name.text)),
        _ => None,
    }
}
