//! Action spaces: `act cmc { joints legs, range 0.5 rad }`.

pub mod spaces;
mod synergies;
mod targets;

use super::context::{Checked, Checker};
use super::dimension::Dimension;
use super::value::{EntityRef, Value};
use crate::action::{ActionSpace, ActionTarget, BaseController, BaseNetwork};
use crate::diagnostics::{FileId, codes, nearest};
use crate::spoken;
use crate::syntax::tree::{Act, Expr, ExprKind, Field, FieldValue};
use crate::vocabulary::JointKind;
use spaces::{SPACES, Space, form};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Networks by the file that names them and the path as it stands there, as far as they could be read.
pub(crate) type Networks = BTreeMap<(FileId, String), Checked<Arc<BaseNetwork>>>;

/// The largest values of settings, in SI units: beyond what any body does, and small enough to compute with.
const MOST_ANGLE: f64 = std::f64::consts::PI;
const MOST_LENGTH: f64 = 10.0;
const MOST_TORQUE: f64 = 1e5;
const MOST_TIME: f64 = 1e3;
/// Most control steps of latency: as many actions are kept.
const MOST_STEPS: u32 = 1000;

/// The settings of one action space, each known to it and written once.
struct Settings<'a> {
    act: &'a Act,
}

impl<'a> Settings<'a> {
    fn get(&self, name: &str) -> Option<&'a Field> {
        self.act.fields.iter().find(|field| field.name.text == name)
    }
}

impl<'a> Checker<'a> {
    /// The action space of the task, which formulas that read `action` need.
    pub(super) fn action_space(&mut self, act: &'a Act) -> Checked<()> {
        let settings = self.settings_of(act)?;
        let target = match act.target.text.as_str() {
            "muscles" => self.controlled_muscles(&settings)?,
            "synergies" => ActionTarget::Synergies(self.synergies(settings.get("of"), settings.get("sides"))?),
            "torque" => {
                let joints = self.controlled_joints(&settings)?;
                let ranges = self.torques(&settings, joints.len())?;
                ActionTarget::Torque { joints, ranges }
            }
            _ => self.tracking_offsets(&settings)?,
        };
        self.action = ActionSpace {
            target,
            activations: self.activations(&settings)?,
            scale: self.scale_of(&settings)?,
            filter: self.amount(&settings, "filter", Dimension::TIME, MOST_TIME)?,
            latency: self.latency(&settings)?,
            residual: self.base_controller(&settings)?,
        };
        Ok(())
    }

    /// Looks at the words of a space and of its settings.
    fn settings_of(&mut self, act: &'a Act) -> Checked<Settings<'a>> {
        let Some(space) = SPACES.iter().find(|space| space.name == act.target.text) else {
            let names: Vec<&str> = SPACES.iter().map(|space| space.name).collect();
            let message = format!("there is no action space `{}`", act.target.text);
            let mut diagnostic = self
                .diagnostic(codes::tasks::UNKNOWN_SETTING, act.target.span, message)
                .help(format!("action spaces are {}", names.join(", ")));
            for near in nearest(&act.target.text, names.iter().copied()) {
                diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), act.target.span, near);
            }
            return Err(self.report(diagnostic));
        };
        for (index, field) in act.fields.iter().enumerate() {
            let name = field.name.text.as_str();
            if !space.settings().any(|known| known == name) {
                return Err(self.unknown_setting(space, field));
            }
            if act.fields[..index].iter().any(|earlier| earlier.name.text == name) {
                return Err(self.error(codes::tasks::REPEATED, field.span, format!("`{name}` is given twice")));
            }
        }
        let missing = space.required.iter().find(|name| !act.fields.iter().any(|field| field.name.text == **name));
        if let Some(missing) = missing {
            let message = format!("`act {}` needs `{missing}`", space.name);
            let diagnostic = self.diagnostic(codes::tasks::MISSING, act.target.span, message).help(format!(
                "write `act {} {{ {} }}`",
                space.name,
                form(missing)
            ));
            return Err(self.report(diagnostic));
        }
        Ok(Settings { act })
    }

    fn unknown_setting(&mut self, space: &Space, field: &Field) -> super::context::Reported {
        let name = field.name.text.as_str();
        let known: Vec<&str> = space.settings().collect();
        let message = format!("`act {}` has no setting `{name}`", space.name);
        let mut diagnostic =
            self.diagnostic(codes::tasks::UNKNOWN_SETTING, field.name.span, message).help(format!("it has {}", known.join(", ")));
        for near in nearest(name, known.iter().copied()) {
            diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), field.name.span, near);
        }
        self.report(diagnostic)
    }

    /// The value behind the word of a setting.
    fn setting_value(&mut self, field: &'a Field) -> Checked<&'a Expr> {
        if let FieldValue::Value(value) = &field.value {
            return Ok(value);
        }
        let name = field.name.text.as_str();
        let diagnostic = self
            .diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, format!("invalid value of `{name}`"))
            .expected(format!("`{}`", form(name)));
        Err(self.report(diagnostic))
    }

    /// A number above 0 and up to `most`; 0 where the setting is missing.
    fn amount(&mut self, settings: &Settings<'a>, name: &str, dimension: Dimension, most: f64) -> Checked<f64> {
        let Some(field) = settings.get(name) else { return Ok(0.0) };
        let expr = self.setting_value(field)?;
        self.bounded(expr, name, dimension, most)
    }

    /// The torque of an entry of 1 on each of so many joints: one number for all, or a list.
    fn torques(&mut self, settings: &Settings<'a>, joints: usize) -> Checked<Vec<f64>> {
        let Some(field) = settings.get("range") else { return Ok(vec![0.0; joints]) };
        let expr = self.setting_value(field)?;
        let ExprKind::List(elements) = &expr.kind else {
            return Ok(vec![self.bounded(expr, "range", Dimension::TORQUE, MOST_TORQUE)?; joints]);
        };
        if elements.len() != joints {
            let diagnostic = self
                .diagnostic(codes::types::LENGTHS_DIFFER, expr.span, "`range` and `joints` differ in length")
                .expected(format!("one torque for all joints, or {joints}, one for each"))
                .found(elements.len().to_string());
            return Err(self.report(diagnostic));
        }
        elements.iter().map(|element| self.bounded(element, "range", Dimension::TORQUE, MOST_TORQUE)).collect()
    }

    /// The number that an expression is known to be, above 0 and up to `most`.
    fn bounded(&mut self, expr: &'a Expr, name: &str, dimension: Dimension, most: f64) -> Checked<f64> {
        let value = self.fixed_number(expr, dimension, &format!("`{name}`"))?;
        if value > 0.0 && value <= most {
            return Ok(value);
        }
        let unit = spoken::written(dimension, [expr]);
        let diagnostic = self
            .diagnostic(codes::tasks::OUT_OF_RANGE, expr.span, format!("`{name}` is out of range"))
            .expected(format!("above 0 and at most {}", unit.tell(most)))
            .found(unit.tell(value));
        Err(self.report(diagnostic))
    }

    fn scale_of(&mut self, settings: &Settings<'a>) -> Checked<f64> {
        // Entries of an action are in -1..1 and cannot be larger.
        let scale = self.amount(settings, "scale", Dimension::NONE, 1.0)?;
        Ok(if scale == 0.0 { 1.0 } else { scale })
    }

    fn latency(&mut self, settings: &Settings<'a>) -> Checked<u32> {
        let Some(field) = settings.get("latency") else { return Ok(0) };
        let expr = self.setting_value(field)?;
        let steps = self.steps(expr)?;
        let horizon = self.timing.horizon;
        if steps > f64::from(MOST_STEPS) {
            let message = format!("`latency` takes at most {MOST_STEPS} control steps");
            return Err(self.error(codes::tasks::OUT_OF_RANGE, expr.span, message));
        }
        if steps >= f64::from(horizon) {
            let diagnostic = self
                .diagnostic(codes::tasks::OUT_OF_RANGE, expr.span, "no action takes effect within the episode")
                .expected(format!("less than {horizon} steps, the task's horizon"));
            return Err(self.report(diagnostic));
        }
        // It is at most a thousand.
        Ok(steps as u32)
    }

    fn activations(&mut self, settings: &Settings<'a>) -> Checked<bool> {
        let Some(field) = settings.get("activations") else { return Ok(false) };
        let asked = self.flag_value(field)?;
        match settings.get("residual") {
            Some(_) if asked => {
                let message = "activations cannot be added to the action of a controller";
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, message)
                    .help("controllers give excitations: leave out `activations` or `residual`");
                Err(self.report(diagnostic))
            }
            _ => Ok(asked),
        }
    }

    fn base_controller(&mut self, settings: &Settings<'a>) -> Checked<Option<BaseController>> {
        let Some(field) = settings.get("residual") else { return Ok(None) };
        let expr = self.setting_value(field)?;
        let word = if let ExprKind::Name(name) = &expr.kind { name.text.as_str() } else { "" };
        if let Some(controller) = BaseController::NAMED.into_iter().find(|controller| controller.name() == word) {
            return Ok(Some(controller));
        }
        if let ExprKind::Text(path) = &expr.kind {
            let known = self.networks.and_then(|networks| networks.get(&(self.place.file, path.clone())));
            return match known {
                Some(network) => network.clone().map(|network| Some(BaseController::Network(network))),
                None => Err(self.error(codes::names::FILE, expr.span, "this network has not been read")),
            };
        }
        let diagnostic = self
            .diagnostic(codes::tasks::UNKNOWN_SETTING, expr.span, "an action cannot be added to this")
            .expected("`residual cmc`, `residual demonstration` or a network, `residual \"agent.onnx\"`")
            .help("these act on the body by themselves; programs are policies of the command line");
        Err(self.report(diagnostic))
    }

    fn controlled_muscles(&mut self, settings: &Settings<'a>) -> Checked<ActionTarget> {
        let Some(field) = settings.get("of") else { return Ok(ActionTarget::AllMuscles) };
        let expr = self.setting_value(field)?;
        let muscles = self.muscles_of(expr)?;
        self.must_be_once(&muscles, expr)?;
        Ok(ActionTarget::Muscles(muscles))
    }

    /// The muscles that an expression names.
    fn muscles_of(&mut self, expr: &'a Expr) -> Checked<Vec<usize>> {
        let found = self.entities_of(expr)?;
        let muscle = |entity: &EntityRef| if let EntityRef::Muscle(index) = entity { Some(*index) } else { None };
        match found.iter().map(muscle).collect::<Option<Vec<usize>>>().filter(|muscles| !muscles.is_empty()) {
            Some(muscles) => Ok(muscles),
            None => {
                let message = "an action space lists muscles here";
                let diagnostic = self
                    .diagnostic(codes::types::WRONG_TYPE, expr.span, message)
                    .help(format!("write `{}`; `msk vocabulary` lists muscles and their groups", form("of")));
                Err(self.report(diagnostic))
            }
        }
    }

    pub(super) fn entities_of(&mut self, expr: &'a Expr) -> Checked<Vec<EntityRef>> {
        Ok(match self.value(expr)? {
            Value::Entity(entity) => vec![entity],
            Value::Entities { members, .. } => members,
            Value::Typed(_) => Vec::new(),
        })
    }

    fn must_be_once(&mut self, muscles: &[usize], expr: &Expr) -> Checked<()> {
        let twice = muscles.iter().enumerate().find(|(place, muscle)| muscles[..*place].contains(muscle));
        match twice.and_then(|(_, &muscle)| self.vocabulary.muscles.get(muscle)) {
            None => Ok(()),
            Some(muscle) => {
                let message = format!("the muscle `{}` is controlled twice", muscle.name);
                Err(self.error(codes::tasks::REPEATED, expr.span, message))
            }
        }
    }

    /// The independent hinges that `joints` names.
    fn controlled_joints(&mut self, settings: &Settings<'a>) -> Checked<Vec<usize>> {
        let Some(field) = settings.get("joints") else { return Ok(Vec::new()) };
        let expr = self.setting_value(field)?;
        let found = self.entities_of(expr)?;
        let mut joints: Vec<usize> = Vec::new();
        for entity in &found {
            let EntityRef::Joint(index) = *entity else { break };
            let joint = &self.vocabulary.joints[index];
            let (code, reason, help) = if joint.of_scene {
                (codes::tasks::COUPLED, format!("`{}` belongs to the scene", joint.name), "an action moves the body")
            } else if !joint.independent {
                (
                    codes::tasks::COUPLED,
                    format!("the joint `{}` is coupled", joint.name),
                    "a coupled joint follows another: name that one",
                )
            } else if joint.kind != JointKind::Hinge {
                (codes::tasks::COUPLED, format!("the joint `{}` slides", joint.name), "action spaces move hinges")
            } else if joints.contains(&index) {
                (codes::tasks::REPEATED, format!("the joint `{}` is controlled twice", joint.name), "name each joint once")
            } else {
                joints.push(index);
                continue;
            };
            let diagnostic = self.diagnostic(code, expr.span, reason).help(help);
            return Err(self.report(diagnostic));
        }
        if joints.is_empty() || joints.len() < found.len() {
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, expr.span, "an action space lists joints here")
                .help(format!("write `{}`; `msk vocabulary` lists joints and their groups", form("joints")));
            return Err(self.report(diagnostic));
        }
        Ok(joints)
    }
}
