//! What the checker understood of each place of a text, kept for editors: only where somebody asked for it.

use super::context::Checker;
use super::functions::Function;
use super::ranges::Working;
use super::signals::{Owner, Signal};
use super::types::{ElementType, Frame};
use super::value::{Thing, Value};
use crate::diagnostics::{FileId, Span};
use crate::graph::Graph;
use crate::graph::interval::{self, Bounds};
use crate::syntax::tree::Docs;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// What was understood of one stretch of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Which file.
    pub file: FileId,
    /// Which bytes of it.
    pub span: Span,
    /// What stands there, in words: `a speed (m/s)`, ``the landmark `pelvis` ``.
    pub kind: String,
    /// Between which values it stays, in SI units, if anything is known.
    pub range: Option<Bounds>,
    /// Documentation, from the text, the body file or the tables of the language.
    pub docs: String,
    /// What may follow behind a dot.
    pub members: Members,
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

/// Notes of one checker in the making, by place.
#[derive(Debug, Default)]
pub(crate) struct Taken(BTreeMap<(FileId, Span), Draft>);

#[derive(Debug, Default)]
struct Draft {
    value: Option<Value>,
    words: String,
    docs: String,
}

/// Where the notes of all checkers of a task meet.
pub(crate) type Notebook = RefCell<Vec<Note>>;

impl Checker<'_> {
    /// Notes what an expression at `span` of the present file stands for.
    pub(crate) fn note_value(&mut self, span: Span, value: &Value) {
        let file = self.place.file;
        if let Some(draft) = self.draft(file, span) {
            // A formula of a library is checked at each call; the first one speaks for all.
            draft.value.get_or_insert_with(|| value.clone());
        }
    }

    /// Notes documentation for `span` of `file`.
    pub(crate) fn note_docs(&mut self, file: FileId, span: Span, docs: Option<&Docs>) {
        if let (Some(docs), Some(draft)) = (docs, self.draft(file, span)) {
            draft.docs.clone_from(&docs.text);
        }
    }

    /// Notes the declaration of a name beside what it stands for.
    pub(crate) fn note_declared(&mut self, file: FileId, span: Span, value: &Value, docs: Option<&Docs>) {
        if let Some(draft) = self.draft(file, span) {
            draft.value.get_or_insert_with(|| value.clone());
        }
        self.note_docs(file, span, docs);
    }

    /// Notes a signal of the language.
    pub(crate) fn note_signal(&mut self, span: Span, signal: &Signal) {
        let file = self.place.file;
        if let Some(draft) = self.draft(file, span) {
            draft.words = format!("`{}`: {}", signal.name, signal.kind);
            draft.docs = signal.description.to_owned();
        }
    }

    /// Notes a function of the language.
    pub(crate) fn note_function(&mut self, span: Span, function: &Function) {
        let file = self.place.file;
        if let Some(draft) = self.draft(file, span) {
            draft.words = format!("`{}`", function.signature);
            draft.docs = function.description.to_owned();
        }
    }

    fn draft(&mut self, file: FileId, span: Span) -> Option<&mut Draft> {
        self.notes.as_mut().map(|taken| taken.0.entry((file, span)).or_default())
    }

    /// Hands the notes over, with the bounds of what the graph computes.
    pub(crate) fn hand_over_notes(&mut self, graph: &Graph) {
        let (Some(taken), Some(book)) = (self.notes.take(), &self.names.notes) else { return };
        let ranges = Working { vocabulary: self.vocabulary, queries: &self.queries, timing: self.timing };
        let bounds = interval::analyse(graph, &ranges);
        let notes = taken.0.into_iter().map(|((file, span), draft)| self.finished(file, span, draft, &bounds));
        book.borrow_mut().extend(notes);
    }

    fn finished(&self, file: FileId, span: Span, draft: Draft, bounds: &[Vec<Bounds>]) -> Note {
        let (mut kind, mut range, mut members, mut docs) = (draft.words, None, Members::None, draft.docs);
        match &draft.value {
            Some(Value::Data(data)) => {
                if kind.is_empty() {
                    kind = data.kind.described(self.vocabulary);
                }
                let numbers = data.kind.all(|element| element.is_number() || matches!(element, ElementType::Vector { .. }));
                let known = bounds.get(data.node.index()).is_some();
                range = (numbers && known).then(|| interval::of_scalar(bounds, data.node)).filter(|range| *range != Bounds::ANY);
                members = data.kind.element().map_or(Members::None, components);
            }
            Some(Value::Thing(thing)) => {
                kind = self.thing_name(*thing);
                members = self.members(*thing);
                if docs.is_empty() {
                    docs = self.thing_docs(*thing);
                }
            }
            Some(Value::Things { members: all, group }) => {
                let what = if *group { "a group" } else { "a list" };
                let names: Vec<String> = all.iter().take(4).map(|thing| self.thing_name(*thing)).collect();
                let more = if all.len() > names.len() { ", ..." } else { "" };
                kind = format!("{what} of {}: {}{more}", all.len(), names.join(", "));
                members = all.first().map_or(Members::None, |first| self.members(*first));
            }
            None => {}
        }
        Note { file, span, kind, range, docs, members }
    }

    fn members(&self, thing: Thing) -> Members {
        let (owners, parts) = match thing {
            Thing::Landmark(index) if self.vocabulary.landmarks[index].of_scene => {
                (vec![Owner::Object, Owner::Landmark], self.parts_of(thing))
            }
            Thing::Landmark(_) => (vec![Owner::Landmark], Vec::new()),
            Thing::Joint(_) => (vec![Owner::Joint], Vec::new()),
            Thing::Muscle(_) => (vec![Owner::Muscle], Vec::new()),
            Thing::CentreOfMass => (vec![Owner::CentreOfMass], Vec::new()),
            Thing::Ground | Thing::Robot => return Members::None,
        };
        Members::Signals { owners, parts }
    }

    fn thing_docs(&self, thing: Thing) -> String {
        let body = self.vocabulary;
        match thing {
            Thing::Landmark(index) => {
                let landmark = &body.landmarks[index];
                let height = landmark.neutral_position[2];
                let place = if landmark.of_scene { String::new() } else { format!("\n\nHeight when standing: {height:.3} m.") };
                format!("{}{place}", landmark.description)
            }
            Thing::Joint(index) => {
                let joint = &body.joints[index];
                let (factor, unit) = match joint.kind {
                    crate::vocabulary::JointKind::Hinge => (180.0 / std::f64::consts::PI, "deg"),
                    crate::vocabulary::JointKind::Slide => (1.0, "m"),
                };
                let range = joint
                    .range
                    .map_or("unlimited".to_owned(), |[low, high]| format!("{:.4} .. {:.4} {unit}", low * factor, high * factor));
                let role = if joint.independent { "" } else { "; it follows another joint" };
                format!("Range {range}, when standing {:.4} {unit}{role}.", joint.neutral * factor)
            }
            Thing::Muscle(index) => {
                let muscle = &body.muscles[index];
                format!("Peak isometric force {:.1} N, family {}.", muscle.peak_force, muscle.family)
            }
            Thing::CentreOfMass => format!("Of the body alone, {:.2} kg.", body.mass),
            Thing::Ground => "The level ground and everything walkable, as one side of a contact.".to_owned(),
            Thing::Robot => "All shapes of the body, as one side of a contact.".to_owned(),
        }
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
