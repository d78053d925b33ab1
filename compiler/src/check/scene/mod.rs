//! Scenes: from the statements of `scene { }` to a [`SceneDescription`].
//!
//! A scene is checked before the formulas of its task, on the vocabulary of the body alone; then the objects join the
//! vocabulary, and formulas name them like landmarks.
//!
//! 1. `elements`: which elements and fields there are, one table;
//! 2. `expand`: loops unrolled, removals carried out;
//! 3. `fields`, `shapes`, `heights`, `joints`, `object`: one element with its parts; `drawn`: fields that chance decides;
//! 4. `geometry`, `parts`: sizes and places that formulas read, so that a task never repeats them;
//! 5. `groups`: named sets;
//! 6. `repeats`: lints;
//! 7. `connections`: welds, releases and markers, whose formulas see the whole vocabulary.

pub(crate) mod connections;
pub(crate) mod drawn;
pub(crate) mod driven;
pub mod elements;
pub(crate) mod expand;
mod fields;
pub(crate) mod geometry;
mod groups;
pub(in crate::check) mod heights;
mod joints;
pub(crate) mod object;
mod parts;
mod repeats;
pub(crate) mod rotation;
mod shapes;
pub(in crate::check) mod varied;

use super::context::{Checked, Checker, Reported};
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::numbers::for_people;
use crate::resolve::inherit::WholeTask;
use crate::resolve::scope::{Names, Place};
use crate::scene::{Motion, Object, Parent, SceneDescription, Shape, Surface};
use crate::syntax::tree::{Element, ElementName, Expr, TaskStatement};
use crate::vocabulary::{Landmark, Vocabulary};
use drawn::{DrawnField, SceneField};
use driven::DrivenObject;
use expand::{Expanded, Locals, Merging, Unrolled};
use geometry::Known;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Half the height of what may lie in the ground like a plate, m.
const HIGHEST_PLATE: f64 = 0.05;

/// The scene of a task, as far as it is known before the formulas of the task are checked.
#[derive(Debug, Default)]
pub(crate) struct CheckedScene<'a> {
    pub description: SceneDescription,
    /// Of each object, whether nothing can move it.
    pub fixed: Vec<bool>,
    /// Constants of objects by `NAME.SIGNAL`.
    pub known: BTreeMap<String, Known>,
    /// Fields that are drawn for every episode.
    pub drawn: Vec<DrawnField<'a>>,
    /// Objects that move as formulas of time have it.
    pub driven: Vec<DrivenObject<'a>>,
    /// Names of the task that the scene reads.
    pub used: BTreeSet<String>,
    /// The unrolled statements.
    pub statements: Expanded<'a>,
}

/// A scene in the making.
pub(super) struct Stage<'a> {
    pub scene: SceneDescription,
    pub fixed: Vec<bool>,
    /// Where each object was written.
    pub spans: Vec<(FileId, Span)>,
    pub drawn: Vec<DrawnField<'a>>,
    pub driven: Vec<DrivenObject<'a>>,
    /// Objects as landmarks in the making: their places and axes in the world, if they stand still.
    pub landmarks: Vec<Landmark>,
}

impl<'a> Stage<'a> {
    /// Adds an object.
    pub(super) fn push(&mut self, body: &Vocabulary, object: Object, fixed: bool, span: (FileId, Span)) {
        // Landmarks of the body and of the objects before it are enough to place one more.
        let carriers = Vocabulary { landmarks: self.carriers(body, &object), ..Vocabulary::default() };
        let parent = match &object.parent {
            Parent::Object(_) => Parent::Landmark(CARRIER.to_owned()),
            other => other.clone(),
        };
        let alone = SceneDescription { objects: vec![Object { parent, ..object.clone() }], ..SceneDescription::default() };
        self.landmarks.extend(carriers.with_scene(&alone).landmarks.pop());
        self.scene.objects.push(object);
        self.fixed.push(fixed);
        self.spans.push(span);
    }

    /// Whether an object stays where the scene has it, or is moved from there by nothing but its formula.
    pub(super) fn stands(&self, index: usize) -> bool {
        let object = &self.scene.objects[index];
        match (&object.motion, &object.parent) {
            (Motion::Placed | Motion::Driven, _) | (Motion::Fixed, Parent::World) => true,
            (Motion::Fixed, Parent::Object(parent)) => self.stands(*parent),
            _ => false,
        }
    }

    /// Whether a formula of time moves an object, or what carries it rigidly.
    pub(super) fn is_driven(&self, index: usize) -> bool {
        let object = &self.scene.objects[index];
        match (&object.motion, &object.parent) {
            (Motion::Driven, _) => true,
            (Motion::Fixed, Parent::Object(parent)) => self.is_driven(*parent),
            _ => false,
        }
    }

    /// Notes that a field is drawn.
    pub(super) fn draw(&mut self, object: Option<usize>, field: SceneField, expr: &'a Expr, (locals, file): (&Locals, FileId)) {
        self.drawn.push(DrawnField { object, field, expr, locals: locals.clone(), file });
    }

    fn carriers(&self, body: &Vocabulary, object: &Object) -> Vec<Landmark> {
        match &object.parent {
            Parent::World => Vec::new(),
            Parent::Object(index) => {
                let carrier = self.landmarks.get(*index).cloned();
                carrier.map(|landmark| Landmark { name: CARRIER.to_owned(), ..landmark }).into_iter().collect()
            }
            Parent::Landmark(name) => body.landmarks.iter().filter(|landmark| landmark.name == *name).cloned().collect(),
        }
    }
}

/// The words with which an element begins: its kind and its name.
pub(super) fn head(element: &Element) -> Span {
    match &element.name {
        Some(ElementName::Name(name)) => element.kind.span.to(name.span),
        Some(ElementName::Quoted(text)) => element.kind.span.to(text.span),
        None => element.kind.span,
    }
}

/// No name of a task: it holds a blank.
const CARRIER: &str = "its parent";

/// Checks the scene of a task, on the vocabulary of its body.
pub(crate) fn of_task<'a>(
    task: &'a WholeTask,
    names: &'a Names<'a>,
    vocabulary: &'a Vocabulary,
) -> (CheckedScene<'a>, Vec<Diagnostic>) {
    let mut checker = Checker::new(vocabulary, names, Place::of_task(task.file), &task.statements);
    let blocks = task.statements.iter().filter_map(|placed| match &placed.statement {
        TaskStatement::Scene(block) => Some((block, placed)),
        _ => None,
    });
    let mut blocks = blocks.peekable();
    if blocks.peek().is_none() {
        let description = SceneDescription { ground: Some(GROUND), ..Default::default() };
        return (CheckedScene { description, ..Default::default() }, Vec::new());
    }
    let mut merging = Merging::default();
    let mut last_layer = None;
    for (block, placed) in blocks {
        // An inherited scene is read where it was written.
        checker.in_file(placed.file, |checker| {
            if last_layer.replace(placed.layer) == Some(placed.layer) {
                checker.error(codes::tasks::REPEATED, block.keyword, "`scene` is declared twice");
            }
            merging.layer = placed.layer;
            checker.expand_scene(&block.entries, &Locals::new(), &mut merging);
        });
    }
    let statements = merging.merged();
    let (stage, known) = checker.stage(&statements);
    let Stage { scene: description, fixed, drawn, driven, .. } = stage;
    let used = std::mem::take(&mut checker.used);
    let graph = std::mem::take(&mut checker.graph);
    let hir = Arc::new(std::mem::take(&mut checker.hir));
    checker.keep_for_editors(hir, &graph);
    (CheckedScene { description, fixed, known, drawn, driven, used, statements }, checker.diagnostics)
}

/// The level ground of a task without a scene.
const GROUND: Surface = Surface { friction: [1.0, 0.005, 0.0001], decides: false, solid: true, walkable: true };

impl<'a> Checker<'a> {
    /// The elements and groups of a scene.
    fn stage(&mut self, statements: &Expanded<'a>) -> (Stage<'a>, BTreeMap<String, Known>) {
        let (fixed, spans, drawn, driven, landmarks) = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut stage = Stage { scene: SceneDescription::default(), fixed, spans, drawn, driven, landmarks };
        let mut broken: Vec<(FileId, Span)> = Vec::new();
        for Unrolled { statement: element, name, locals, file, .. } in &statements.elements {
            // Errors are reported, for one round of a loop; the other elements are checked all the same.
            if broken.contains(&(*file, element.span)) {
                continue;
            }
            let before = self.diagnostics.len();
            let check = |checker: &mut Self| match name {
                None => checker.ground(&mut stage, element, locals),
                Some(name) => checker.object(&mut stage, element, name, None, locals),
            };
            let result = self.in_file(*file, |checker| checker.with_locals(locals, check));
            if result.is_err() || Reported::among(&self.diagnostics[before..]).is_some() {
                broken.push((*file, element.span));
            }
        }
        // A part that could not be read may be the one that weighs.
        if broken.is_empty() {
            self.must_have_masses(&stage);
            self.warn_half_buried(&stage);
        }
        for group in &statements.groups {
            let _ = self.in_file(group.file, |checker| checker.scene_group(&mut stage, group.statement));
        }
        (stage, std::mem::take(&mut self.known))
    }

    fn ground(&mut self, stage: &mut Stage<'a>, element: &'a Element, locals: &Locals) -> Checked<()> {
        let Some(kind) = elements::find("ground") else {
            return Err(self.error(codes::tasks::UNKNOWN_SETTING, element.kind.span, "a scene has no `ground` here"));
        };
        let fields = self.fields(element, kind)?;
        if let Some(part) = element.parts.first() {
            let message = "the ground has no parts; declare elements beside it";
            return Err(self.error(codes::tasks::UNKNOWN_SETTING, part.span, message));
        }
        let (friction, drawn) = self.friction(&fields)?;
        let surface = Surface { friction, decides: drawn.is_some(), ..GROUND };
        if let Some(expr) = drawn {
            stage.draw(None, SceneField::Friction, expr, (locals, self.place.file));
        }
        if stage.scene.ground.replace(surface).is_some() {
            return Err(self.error(codes::tasks::REPEATED, element.span, "`ground` is declared twice"));
        }
        Ok(())
    }

    /// Warns of shapes that stand still with their middle at the height of the ground: the lower face was probably meant.
    fn warn_half_buried(&mut self, stage: &Stage<'a>) {
        // Of what a loop repeats only the first is reported.
        let mut reported: BTreeSet<(FileId, Span)> = BTreeSet::new();
        for (index, object) in stage.scene.objects.iter().enumerate() {
            let half = match object.shape {
                Some(Shape::Box([_, _, height])) => height / 2.0,
                Some(Shape::Cylinder(_, length)) => length / 2.0,
                Some(Shape::Capsule(radius, length)) => length / 2.0 + radius,
                Some(Shape::Ellipsoid([_, _, half])) => half,
                _ => continue,
            };
            let stands = stage.fixed[index] && object.parent == Parent::World && object.orientation == [1.0, 0.0, 0.0, 0.0];
            let flat = stage.scene.ground.is_none() || half < HIGHEST_PLATE || object.position[2] != 0.0;
            let (file, span) = stage.spans[index];
            if !stands || flat || !reported.insert((file, span)) {
                continue;
            }
            let [x, y, _] =
                object.position.map(|lane| if lane == 0.0 { "0".to_owned() } else { format!("{} m", for_people(lane)) });
            let message = format!("the lower half of `{}` is in the ground: `at` is the place of its centre", object.name);
            let diagnostic = Diagnostic::new(codes::slips::HALF_BURIED, file, span, message)
                .help(format!("to put it on the ground write `at [{x}, {y}, {} m]`", for_people(half)));
            self.diagnostics.push(diagnostic);
        }
    }

    /// What moves has a mass: its own, or that of what it carries without a joint.
    fn must_have_masses(&mut self, stage: &Stage<'a>) {
        let objects = &stage.scene.objects;
        let total = stage.scene.masses();
        for (index, object) in objects.iter().enumerate() {
            let (file, span) = stage.spans[index];
            if !matches!(object.motion, Motion::Fixed | Motion::Placed | Motion::Driven) && total[index] <= 0.0 {
                let message = format!("`{}` moves, but none of its parts has a mass", object.name);
                let diagnostic = Diagnostic::new(codes::scene::MASS, file, span, message)
                    .help("give one of its shapes `mass 2 kg` or `density 500 kg/m^3`");
                self.report(diagnostic);
            }
            if stage.stands(index) && object.mass > 0.0 {
                let message = format!("`{}` is fixed: its mass has no effect", object.name);
                let diagnostic = Diagnostic::new(codes::lints::IDLE_MASS, file, span, message)
                    .help("remove it, or make the object movable: `free`, or a joint");
                self.diagnostics.push(diagnostic);
            }
        }
    }
}
