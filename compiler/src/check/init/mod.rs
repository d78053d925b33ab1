//! How an episode begins: a pose with adjustments, the root, objects, noise, and physics before the first snapshot.

mod align;
mod drawn;
mod layers;
mod noise;
mod objects;
mod pose;
mod root;
mod scaling;

use super::context::{Checked, Checker, Failures};
use super::dimension::Dimension;
use super::types::{ElementType, Type};
use crate::diagnostics::{FileId, Span, codes};
use crate::graph::NodeId;
use crate::numbers::for_people;
use crate::scene::Motion;
use crate::syntax::tree::{Block, InitStatement, Settle};
use crate::task::{self, Init, ObjectStart, Setting};
use layers::Row;

/// An initial state, and the numbers in it that are drawn.
#[derive(Debug, Default)]
pub(crate) struct InitialState {
    pub init: Init,
    /// In the order of the places in [`Init::drawn`].
    pub drawn: Vec<NodeId>,
    /// The motion from which the pose is taken.
    pub motion: Option<String>,
}

/// The `init` of one task, with its file.
pub(crate) type Layer<'a> = (&'a Block<InitStatement>, FileId);

impl<'a> Checker<'a> {
    /// Checks the `init` of a task and of those that it extends, the oldest first; `None` where there is none.
    pub(crate) fn init(&mut self, layers: &[Layer<'a>]) -> Checked<Option<InitialState>> {
        let Some((block, file)) = layers.last() else { return Ok(None) };
        for (block, file) in layers {
            self.in_file(*file, |checker| checker.placed_once(&block.entries));
        }
        let rows = self.layered(layers);
        self.in_file(*file, |checker| checker.rows_of_init(&rows?, block.keyword)).map(Some)
    }

    /// The initial state of the root or an object is set once in each task: a second block would silently override the first.
    fn placed_once(&mut self, entries: &'a [InitStatement]) {
        let mut placed: Vec<&str> = Vec::new();
        for entry in entries {
            let InitStatement::Object(element) = entry else { continue };
            let name = element.object.text.as_str();
            if placed.contains(&name) {
                let message = format!("`{name}` is declared twice");
                let diagnostic = self.diagnostic(codes::tasks::REPEATED, element.object.span, message);
                self.report(diagnostic.help(format!("write one block: `{name} {{ height on ground, heading 90 deg }}`")));
            }
            placed.push(name);
        }
    }

    fn rows_of_init(&mut self, rows: &[Row<'a>], span: Span) -> Checked<InitialState> {
        let mut initial = InitialState { init: self.starting_objects(), ..InitialState::default() };
        let mut posed: Option<Span> = None;
        let mut failures = Failures::default();
        failures.catch(self.drawn_fields(&mut initial));
        // What is placed may differ from the pose: the pose comes first, wherever it stands.
        let is_pose = |row: &&Row<'a>| matches!(row.statement, InitStatement::Pose(_));
        let poses = rows.iter().filter(is_pose);
        for row in poses.chain(rows.iter().filter(|row| !is_pose(row))) {
            let statement = row.statement;
            let result = self.in_file(row.file, |checker| match statement {
                InitStatement::Pose(pose) => match posed.replace(pose.span) {
                    None => checker.pose(pose, &mut initial),
                    Some(_) => Err(checker.error(codes::tasks::REPEATED, pose.span, "a second pose would replace the first")),
                },
                InitStatement::Object(element) if element.object.text == "root" => checker.root(element, &mut initial),
                InitStatement::Object(element) => checker.placement(element, &mut initial),
                InitStatement::Noise(noise) => checker.noise(noise, &mut initial.init),
                InitStatement::Scaling(scaling) => checker.scaling(scaling, &mut initial),
                InitStatement::Settle(settle) => checker.settle(settle, &mut initial.init),
                // Carried out already.
                InitStatement::Allow(_) | InitStatement::Remove(_) => Ok(()),
            });
            failures.catch(result);
        }
        if posed.is_none() {
            let diagnostic = self
                .diagnostic(codes::tasks::MISSING, span, "`init` does not declare a `pose`")
                .help("write `pose neutral`, or another pose of the body, or the name of a `reference`");
            return Err(self.report(diagnostic));
        }
        let root = &initial.init.root;
        let placed = initial.init.drawn.iter().any(|(setting, _)| *setting == Setting::RootHeight);
        if root.height.is_none() && root.meets.is_empty() && !placed && !failures.any() && !self.has_ground() {
            let diagnostic =
                self.diagnostic(codes::scene::NO_GROUND, span, "this scene has no ground for the initial state").help(
                    "declare `ground` in the scene, or place the root: `root { height 1 m }`, `root { align palm_l to bar.grip }`",
                );
            return Err(self.report(diagnostic));
        }
        if !failures.any() {
            self.must_begin_within_ranges(&initial.init, span)?;
        }
        failures.or(initial)
    }

    /// Joints at zero and every object that is free, or placed for every episode, where the scene has it.
    fn starting_objects(&self) -> Init {
        let scene = self.scene.map(|scene| &scene.description);
        let objects = scene.into_iter().flat_map(|scene| scene.objects.iter().enumerate());
        let placed = objects.filter(|(_, object)| matches!(object.motion, Motion::Free | Motion::Placed | Motion::Driven)).map(
            |(index, object)| ObjectStart {
                object: index,
                position: object.position,
                orientation: object.orientation,
                velocity: [0.0; 3],
                spin: [0.0; 3],
            },
        );
        Init { coordinates: vec![0.0; self.vocabulary.joints.len()], objects: placed.collect(), ..Init::default() }
    }

    /// `settle 50 ms with activation 0.2 at rest`: a whole number of physics steps.
    fn settle(&mut self, settle: &'a Settle, init: &mut Init) -> Checked<()> {
        if init.settle.is_some() {
            return Err(self.error(codes::tasks::REPEATED, settle.span, "`settle` is declared twice"));
        }
        let steps = self.physics_steps(&settle.duration)?;
        let activation = match &settle.activation {
            Some(expr) => {
                let activation = self.fixed_number(expr, Dimension::NONE, "the activation")?;
                if !(0.0..=1.0).contains(&activation) {
                    return Err(self.error(codes::tasks::OUT_OF_RANGE, expr.span, "activations lie in 0 .. 1"));
                }
                activation
            }
            None => 0.0,
        };
        init.settle = Some(task::Settle { steps, activation, at_rest: settle.at_rest });
        Ok(())
    }

    fn physics_steps(&mut self, expr: &'a crate::syntax::tree::Expr) -> Checked<u32> {
        let data = self.data(expr)?;
        let step = self.vocabulary.physics_step;
        let steps = match (self.graph.constant_value(data.node), &data.kind) {
            (Some(steps), Type::One(ElementType::Steps)) => steps,
            (Some(seconds), Type::One(ElementType::Number(Dimension::TIME))) => seconds / step,
            _ => {
                let diagnostic = self
                    .diagnostic(codes::types::DURATION, expr.span, "`settle` takes a constant duration")
                    .expected("`50 ms`, or `50 steps` of the physics");
                return Err(self.report(diagnostic));
            }
        };
        if (steps - steps.round()).abs() < 1e-6 && (1.0..=1e6).contains(&steps.round()) {
            return Ok(steps.round() as u32);
        }
        let message = format!("this is not a whole number of physics steps of {} s, from 1 to a million", for_people(step));
        Err(self.error(codes::types::DURATION, expr.span, message))
    }
}
