//! What an editor shows of the typed HIR: at a place, and behind a dot.

use super::types::{ElementType, Frame};
use super::value::{EntityRef, Value};
use super::{DefinitionId, Expr, Hir, NameUse, Resolution};
use crate::diagnostics::{FileId, Span};
use crate::graph::interval::{self, Bounds};
use crate::signals::Owner;
use crate::vocabulary::{JointKind, Vocabulary};
use std::sync::Arc;

/// What is known of one stretch of a text.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Description {
    /// Which bytes.
    pub span: Span,
    /// What stands there, in words: `a speed (m/s)`, ``the landmark `pelvis` ``.
    pub kind: String,
    /// Between which values it stays, in SI units, if anything is known.
    pub range: Option<Bounds>,
    /// Documentation, from the text, the body file or the tables of the language.
    pub docs: String,
}

/// What may follow behind a dot.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Members {
    /// Nothing.
    #[default]
    None,
    /// Signals of these owners, and parts of an object.
    Signals {
        /// Whose signals.
        owners: Vec<Owner>,
        /// Names of parts.
        parts: Vec<String>,
    },
    /// Components or axes.
    Words(&'static [&'static str]),
}

/// The typed HIR of a task or of its scene, kept for the language server.
pub struct TypedFormulas {
    pub(crate) hir: Arc<Hir>,
    /// Between which values each node of the graph stays.
    pub(crate) bounds: Vec<Vec<Bounds>>,
    /// Constants of objects, `seat.top`.
    pub(crate) constants: Vec<String>,
    /// What a function of the language is, by its name: signature and description.
    pub(crate) function: fn(&str) -> Option<(&'static str, &'static str)>,
}

impl TypedFormulas {
    /// The HIR itself.
    pub fn hir(&self) -> &Hir {
        &self.hir
    }

    /// What is known of the smallest name or formula at a byte, then, where that is the last word of a longer formula, what is
    /// known of the whole: `height` in `pelvis.height` is a signal, whose value is that of the whole.
    pub fn at(&self, vocabulary: &Vocabulary, file: FileId, byte: usize) -> Option<(Description, Option<Description>)> {
        let holds = |span: Span| span.start as usize <= byte && byte <= span.end as usize;
        let exprs = || self.hir.exprs.iter().filter(|expr| expr.file == file && expr.value.is_some()).map(|expr| expr.span);
        let names = self.hir.uses.iter().flat_map(|name| {
            let declared = if let Resolution::Definition(id) = name.resolution { Some((id.file, id.span)) } else { None };
            [Some((name.file, name.span)), declared]
        });
        let names = names.flatten().filter(|(own, _)| *own == file).map(|(_, span)| span);
        let smallest = exprs().chain(names).filter(|span| holds(*span)).min_by_key(|span| span.end - span.start)?;
        let around = exprs().filter(|span| span.end == smallest.end && span.start < smallest.start);
        let around = around.max_by_key(|span| span.start).map(|span| self.described(vocabulary, file, span));
        Some((self.described(vocabulary, file, smallest), around))
    }

    /// What may follow behind the formula that ends at a byte.
    pub fn members(&self, vocabulary: &Vocabulary, file: FileId, end: usize) -> Option<(Span, Members)> {
        let ending = self.hir.exprs.iter().filter(|expr| expr.file == file && expr.span.end as usize == end);
        let members = ending.filter_map(|expr| Some((expr.span, self.members_of(vocabulary, expr.value.as_ref()?))));
        members.filter(|(_, members)| *members != Members::None).max_by_key(|(span, _)| span.end - span.start)
    }

    /// What stands at a place. A formula of a library is checked at each call; the first one speaks for all.
    fn described(&self, vocabulary: &Vocabulary, file: FileId, span: Span) -> Description {
        let here = |expr: &&Expr| expr.file == file && expr.span == span && expr.value.is_some();
        let name = self.hir.uses.iter().find(|name| name.file == file && name.span == span);
        let declared = DefinitionId { file, span };
        let first_use = || self.hir.uses.iter().filter(|name| stands_for(name, declared)).find_map(|name| name.expr);
        let value = self.hir.exprs.iter().find(here).and_then(|expr| expr.value.as_ref());
        let value = value.or_else(|| first_use().and_then(|first| self.hir.expr(first).value.as_ref()));
        let mut found = Description { span, ..Description::default() };
        match name.map(|name| name.resolution) {
            Some(Resolution::Definition(id)) => found.docs = self.hir.docs(id).to_owned(),
            Some(Resolution::Signal(signal)) => {
                found.kind = format!("`{}`: {}", signal.name, signal.kind);
                found.docs = signal.description.to_owned();
            }
            Some(Resolution::Function(function)) => {
                if let Some((signature, description)) = (self.function)(function) {
                    (found.kind, found.docs) = (format!("`{signature}`"), description.to_owned());
                }
                // Its value is that of the call.
                return found;
            }
            Some(Resolution::Entity) => {}
            None => found.docs = self.hir.docs(declared).to_owned(),
        }
        match value {
            Some(Value::Typed(data)) => {
                if found.kind.is_empty() {
                    found.kind = data.kind.described(vocabulary);
                }
                let numbers = data.kind.all(|element| element.is_number() || matches!(element, ElementType::Vector { .. }));
                let known = numbers && self.bounds.get(data.node.index()).is_some();
                let range = known.then(|| interval::of_scalar(&self.bounds, data.node));
                found.range = range.filter(|range| *range != Bounds::ANY);
            }
            Some(Value::Entity(thing)) => {
                found.kind = entity_name(vocabulary, *thing);
                if found.docs.is_empty() {
                    found.docs = entity_docs(vocabulary, *thing);
                }
            }
            Some(Value::Entities { members, group }) => {
                let what = if *group { "a group" } else { "a list" };
                let names: Vec<String> = members.iter().take(4).map(|thing| entity_name(vocabulary, *thing)).collect();
                let more = if members.len() > names.len() { ", ..." } else { "" };
                found.kind = format!("{what} of {}: {}{more}", members.len(), names.join(", "));
            }
            None => {}
        }
        found
    }

    fn members_of(&self, vocabulary: &Vocabulary, value: &Value) -> Members {
        match value {
            Value::Typed(data) => data.kind.element().map_or(Members::None, components),
            Value::Entity(thing) => self.members_of_entity(vocabulary, *thing),
            Value::Entities { members, .. } => {
                members.first().map_or(Members::None, |first| self.members_of_entity(vocabulary, *first))
            }
        }
    }

    fn members_of_entity(&self, vocabulary: &Vocabulary, thing: EntityRef) -> Members {
        let (owners, parts) = match thing {
            EntityRef::Landmark(index) if vocabulary.landmarks.get(index).is_some_and(|landmark| landmark.of_scene) => {
                let constants = self.constants.iter().map(String::as_str);
                (vec![Owner::Object, Owner::Landmark], parts_of(vocabulary, constants, thing))
            }
            EntityRef::Landmark(_) => (vec![Owner::Landmark], Vec::new()),
            EntityRef::Joint(_) => (vec![Owner::Joint], Vec::new()),
            EntityRef::Muscle(_) => (vec![Owner::Muscle], Vec::new()),
            EntityRef::CentreOfMass => (vec![Owner::CentreOfMass], Vec::new()),
            EntityRef::Ground | EntityRef::Robot => return Members::None,
        };
        Members::Signals { owners, parts }
    }
}

fn stands_for(name: &NameUse, declared: DefinitionId) -> bool {
    matches!(name.resolution, Resolution::Definition(id) if id == declared)
}

/// How texts call a part of the body or of the scene.
pub(crate) fn entity_name(vocabulary: &Vocabulary, thing: EntityRef) -> String {
    match thing {
        EntityRef::Landmark(index) if vocabulary.landmarks[index].of_scene => {
            format!("the object `{}`", vocabulary.landmarks[index].name)
        }
        EntityRef::Landmark(index) => format!("the landmark `{}`", vocabulary.landmarks[index].name),
        EntityRef::Joint(index) => format!("the joint `{}`", vocabulary.joints[index].name),
        EntityRef::Muscle(index) => format!("the muscle `{}`", vocabulary.muscles[index].name),
        EntityRef::CentreOfMass => "the centre of mass `com`".to_owned(),
        EntityRef::Ground => "the `ground`".to_owned(),
        EntityRef::Robot => "the body as a whole, `robot`".to_owned(),
    }
}

/// What an object has beside the signals of every landmark: sizes (its `constants`, `seat.top`), parts, joints.
pub(crate) fn parts_of<'a>(
    vocabulary: &'a Vocabulary,
    constants: impl Iterator<Item = &'a str>,
    thing: EntityRef,
) -> Vec<String> {
    let EntityRef::Landmark(index) = thing else { return Vec::new() };
    let Some(object) = vocabulary.landmarks.get(index).filter(|landmark| landmark.of_scene) else { return Vec::new() };
    let prefix = format!("{}.", object.name);
    let landmarks = vocabulary.landmarks.iter().map(|landmark| landmark.name.as_str());
    let joints = vocabulary.joints.iter().map(|joint| joint.name.as_str());
    let names = landmarks.chain(joints).chain(constants);
    let mut parts: Vec<String> = Vec::new();
    for part in names.filter_map(|name| name.strip_prefix(&prefix)).filter(|part| !part.contains('.')) {
        if part != "position" && !parts.iter().any(|known| known == part) {
            parts.push(part.to_owned());
        }
    }
    parts
}

fn entity_docs(body: &Vocabulary, thing: EntityRef) -> String {
    match thing {
        EntityRef::Landmark(index) => {
            let landmark = &body.landmarks[index];
            let height = landmark.neutral_position[2];
            let place =
                if landmark.of_scene { String::new() } else { format!("\n\nHeight in the standing pose: {height:.3} m.") };
            format!("{}{place}", landmark.description)
        }
        EntityRef::Joint(index) => {
            let joint = &body.joints[index];
            let (factor, unit) = match joint.kind {
                JointKind::Hinge => (180.0 / std::f64::consts::PI, "deg"),
                JointKind::Slide => (1.0, "m"),
            };
            let range = joint
                .range
                .map_or("unlimited".to_owned(), |[low, high]| format!("{:.4} .. {:.4} {unit}", low * factor, high * factor));
            let role = if joint.independent { "" } else { "; coupled to another joint" };
            format!("Range {range}, in the standing pose {:.4} {unit}{role}.", joint.neutral * factor)
        }
        EntityRef::Muscle(index) => {
            let muscle = &body.muscles[index];
            format!("Peak isometric force {:.1} N, family {}.", muscle.peak_force, muscle.family)
        }
        EntityRef::CentreOfMass => format!("Mass of the body alone: {:.2} kg.", body.mass),
        EntityRef::Ground => "The level ground and everything walkable, as one side of a contact.".to_owned(),
        EntityRef::Robot => "All shapes of the body, as one side of a contact.".to_owned(),
    }
}

/// What may follow behind a computed value.
fn components(element: ElementType) -> Members {
    Members::Words(match element {
        ElementType::Vector { size: 2, frame: Frame::World, .. } => &["x", "y"],
        ElementType::Vector { frame: Frame::World, .. } | ElementType::Place(Frame::World) => &["x", "y", "z", "xy"],
        ElementType::Vector { .. } | ElementType::Place(_) => &["forward", "left", "up"],
        ElementType::Rotation => &["forward", "left", "up"],
        _ => return Members::None,
    })
}
