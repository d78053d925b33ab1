//! Names and selectors: what a word stands for.

use super::context::{Checked, Checker, Local, Reported, Step};
use super::observe::unit_of;
use super::signals::{self, Owner};
use super::value::{EntityRef, Value};
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::diagnostics::{name_elsewhere, nearest, synonyms};
use crate::hir::{DefinitionId, Resolution};
use crate::resolve::scope::{Declared, Definition, Place};
use crate::syntax::tree::{Ident, Name, NamePart, Text};
use crate::vocabulary::{GroupKind, JointKind};
use msk_program::debug::NamedValue;

/// Sets of joints and muscles that every body has.
const SETS: &[&str] = &["joints", "hinges", "slides", "independent", "muscles"];

/// Former words of the language, functions and fields of the scene, with the present ones.
const RENAMED: &[(&str, &str)] = &[
    ("highest", "running_max"),
    ("lowest", "running_min"),
    ("sampled", "sample_hold"),
    ("turn", "angle_difference"),
    ("turned", "orientation"),
    ("unit", "normalize"),
];

/// The present word for one that was renamed.
pub(crate) fn renamed(word: &str) -> Option<&'static str> {
    RENAMED.iter().find(|(former, _)| *former == word).map(|(_, present)| *present)
}

impl<'a> Checker<'a> {
    /// What a name stands for; a brace pattern stands for a list.
    pub(crate) fn name(&mut self, name: &'a Name) -> Checked<Value> {
        let texts = self.expand(name)?;
        if let [NamePart::Literal(_)] = name.parts.as_slice() {
            return self.plain_name(&name.text, name.span);
        }
        let several = name.parts.iter().any(|part| !matches!(part, NamePart::Literal(_) | NamePart::Variable(_)));
        let mut values = Vec::new();
        for text in &texts {
            values.push((self.plain_name(text, name.span), name.span));
        }
        match (several, values.pop()) {
            (false, Some((only, _))) => only,
            (_, last) => {
                values.extend(last);
                self.bracket(values, name.span)
            }
        }
    }

    /// The plain names of a brace pattern, in order.
    pub(crate) fn expand(&mut self, name: &Name) -> Checked<Vec<String>> {
        if let [NamePart::Literal(text)] = name.parts.as_slice() {
            self.spend(1, name.span)?;
            return Ok(vec![text.clone()]);
        }
        let mut texts = vec![String::new()];
        for part in &name.parts {
            let choices: Vec<String> = match part {
                NamePart::Literal(text) => vec![text.clone()],
                NamePart::Words(words) => words.clone(),
                NamePart::Range(low, high) => {
                    self.spend((high.saturating_sub(*low)) as usize, name.span)?;
                    (*low..*high).map(|number| number.to_string()).collect()
                }
                NamePart::Variable(variable) => vec![self.loop_number(variable, name.span)?],
                NamePart::Any => return self.expand_any(name),
            };
            self.spend(texts.len() * choices.len(), name.span)?;
            texts = texts.iter().flat_map(|text| choices.iter().map(move |choice| format!("{text}{choice}"))).collect();
        }
        Ok(texts)
    }

    fn loop_number(&mut self, variable: &str, span: Span) -> Checked<String> {
        let local = self.locals.iter().rev().find(|local| local.name == variable).map(|local| local.value.clone());
        if let Some(Value::Typed(data)) = &local
            && let Some(number) = self.graph.constant_value(data.node)
        {
            return Ok(format!("{number}"));
        }
        let message = format!("`{variable}` is not a loop variable here; a list of names has two or more words: `{{l,r}}`");
        Err(self.error(codes::names::UNKNOWN_NAME, span, message))
    }

    /// `pole_{*}`: every landmark, joint or muscle that fits.
    fn expand_any(&mut self, name: &Name) -> Checked<Vec<String>> {
        let pattern = name.parts.iter().fold(String::new(), |text, part| match part {
            NamePart::Literal(literal) => text + literal,
            _ => text + "*",
        });
        let known = self.body_names();
        // Parts of objects have names with dots; a star does not reach into things.
        let landmarks = &self.vocabulary.landmarks;
        let of_scene = |name: &str| landmarks.iter().any(|landmark| landmark.of_scene && landmark.name == name);
        let whole = |name: &String| fits(&pattern, name) && !(name.contains('.') && of_scene(name));
        let fitting: Vec<String> = known.into_iter().filter(whole).collect();
        if fitting.is_empty() {
            let message = format!("no part of the body or the scene is called `{}`", name.text);
            return Err(self.error(codes::names::NOTHING_FITS, name.span, message));
        }
        Ok(fitting)
    }

    /// A loop variable or a random on trial, declared in the present file.
    pub(crate) fn local(&self, name: &Ident, value: Value) -> Local {
        let definition = Some(DefinitionId { file: self.place.file, span: name.span });
        Local { name: name.text.clone(), value, definition }
    }

    pub(crate) fn plain_name(&mut self, text: &str, span: Span) -> Checked<Value> {
        if let Some(local) = self.locals.iter().rev().find(|local| local.name == text) {
            let value = local.value.clone();
            if let Some(definition) = local.definition {
                self.resolved(span, Resolution::Definition(definition));
            }
            return Ok(value);
        }
        if let Some(data) = self.test_name(text) {
            return Ok(Value::Typed(data));
        }
        if let Some((declared, place)) = self.names.find(self.place, text) {
            self.resolved_to(span, declared);
            return self.declared(text, declared, place, span);
        }
        if let Some(thing) = self.body_element(text) {
            self.used.insert(text.to_owned());
            self.resolved(span, Resolution::Entity);
            return Ok(thing);
        }
        if let Some(place) = self.marker(text, span) {
            return place.map(Value::Typed);
        }
        for owner in [Owner::Time, Owner::WholeBody] {
            if let Some(signal) = signals::find(owner, text) {
                self.resolved(span, Resolution::Signal(signal));
                return self.single_signal(signal, span).map(Value::Typed);
            }
        }
        let candidates = self.names_in_sight();
        Err(self.unknown_name(text, span, candidates))
    }

    /// Reports a name that means nothing, with those near to it.
    pub(crate) fn unknown_name(&mut self, text: &str, span: Span, candidates: Vec<String>) -> Reported {
        let mut near = nearest(text, candidates.iter().map(String::as_str));
        let mut diagnostic = self.diagnostic(codes::names::UNKNOWN_NAME, span, format!("undefined name `{text}`"));
        if let Some(advice) = self.meant_elsewhere(text) {
            return self.report(diagnostic.help(advice));
        }
        let meant = synonyms(text, |name| candidates.iter().any(|known| known == name));
        if !meant.is_empty() {
            diagnostic = diagnostic.help(format!("here it is called `{}`", meant.join("`, `")));
            near.clear();
        } else if super::functions::find(text).is_some() {
            diagnostic = diagnostic.help(format!("`{text}` is a function: `{text}(...)`"));
        } else if let Some(advice) = name_elsewhere(text) {
            diagnostic = diagnostic.help(advice);
        } else if near.is_empty() && (1..=12).contains(&candidates.len()) {
            diagnostic = diagnostic.help(format!("there is {}", candidates.join(", ")));
        } else if near.is_empty() {
            diagnostic = diagnostic.help("`msk vocabulary` lists all names of the body and the language");
            diagnostic.help.extend(self.objects_in_words());
        }
        for name in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), span, name);
        }
        self.report(diagnostic)
    }

    fn names_in_sight(&self) -> Vec<String> {
        // Names that do not fit the language's spelling need a selector; offered bare they would not even parse.
        let plain = |name: &String| name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        let mut names: Vec<String> = self.body_names().into_iter().filter(plain).collect();
        names.extend(self.names.in_sight(self.place).map(str::to_owned));
        names.extend(self.locals.iter().map(|local| local.name.clone()));
        names
            .extend(self.scene.iter().flat_map(|known| known.statements.markers.iter().filter_map(|marker| marker.name.clone())));
        let words = signals::SIGNALS.iter().filter(|s| matches!(s.owner, Owner::Time | Owner::WholeBody)).map(|s| s.name);
        names.extend(words.chain(SETS.iter().copied()).chain(["com", "ground", "robot"]).map(str::to_owned));
        names
    }

    /// Whether a name is taken by the body or by the language.
    pub(crate) fn means_something(&self, name: &str) -> bool {
        self.taken().any(|taken| taken == name)
    }

    /// All names for which [`means_something`](Self::means_something) holds, some of them twice.
    pub(crate) fn taken(&self) -> impl Iterator<Item = &'a str> {
        let body = self.vocabulary;
        let signals = [Owner::Time, Owner::WholeBody].into_iter().flat_map(signals::of);
        let functions = super::functions::FUNCTIONS.iter().chain(super::functions::OPERATORS);
        let landmarks = body.landmarks.iter().map(|landmark| landmark.name.as_str());
        let joints = body.joints.iter().map(|joint| joint.name.as_str());
        let muscles = body.muscles.iter().map(|muscle| muscle.name.as_str());
        let groups = body.groups.iter().map(|group| group.name.as_str());
        let parts = landmarks.chain(joints).chain(muscles).chain(groups);
        let words = signals.filter_map(|signal| signal.name.split('(').next()).chain(functions.map(|function| function.name));
        parts.chain(words).chain(SETS.iter().copied()).chain(["com", "ground", "robot"])
    }

    fn body_names(&self) -> Vec<String> {
        let body = self.vocabulary;
        let landmarks = body.landmarks.iter().map(|landmark| &landmark.name);
        let joints = body.joints.iter().map(|joint| &joint.name);
        let muscles = body.muscles.iter().map(|muscle| &muscle.name);
        landmarks.chain(joints).chain(muscles).chain(body.groups.iter().map(|group| &group.name)).cloned().collect()
    }

    /// What a name means on the body or in the scene.
    pub(crate) fn body_element(&self, text: &str) -> Option<Value> {
        let body = self.vocabulary;
        if let Some(index) = body.landmarks.iter().position(|landmark| landmark.name == text) {
            return Some(Value::Entity(EntityRef::Landmark(index)));
        }
        if let Some(index) = body.joints.iter().position(|joint| joint.name == text) {
            return Some(Value::Entity(EntityRef::Joint(index)));
        }
        if let Some(index) = body.muscles.iter().position(|muscle| muscle.name == text) {
            return Some(Value::Entity(EntityRef::Muscle(index)));
        }
        if let Some(group) = body.groups.iter().find(|group| group.name == text) {
            let members = group.members.iter().map(|&index| match group.kind {
                GroupKind::Joints => EntityRef::Joint(index),
                GroupKind::Muscles => EntityRef::Muscle(index),
                GroupKind::Landmarks => EntityRef::Landmark(index),
            });
            return Some(Value::Entities { members: members.collect(), group: true });
        }
        // Joints of objects belong to no set of the body's.
        let joints = |chosen: &dyn Fn(JointKind, bool) -> bool| {
            let own = body.joints.iter().enumerate().filter(|(_, joint)| !joint.of_scene);
            let members = own.filter(|(_, joint)| chosen(joint.kind, joint.independent));
            Some(Value::Entities { members: members.map(|(index, _)| EntityRef::Joint(index)).collect(), group: true })
        };
        match text {
            "com" => Some(Value::Entity(EntityRef::CentreOfMass)),
            "ground" => Some(Value::Entity(EntityRef::Ground)),
            "robot" => Some(Value::Entity(EntityRef::Robot)),
            "joints" => joints(&|_, _| true),
            "hinges" => joints(&|kind, _| kind == JointKind::Hinge),
            "slides" => joints(&|kind, _| kind == JointKind::Slide),
            "independent" => joints(&|kind, independent| kind == JointKind::Hinge && independent),
            "muscles" => Some(Value::Entities { members: (0..body.muscles.len()).map(EntityRef::Muscle).collect(), group: true }),
            _ => None,
        }
    }

    /// The value of a declared name, checked where it is declared and only once.
    fn declared(&mut self, text: &str, declared: Declared<'a>, place: Place, span: Span) -> Checked<Value> {
        if place.in_task {
            self.used.insert(text.to_owned());
        }
        let binding = match declared.definition {
            Definition::Const(binding) | Definition::Let(binding) => {
                if !place.in_task {
                    self.names.called.borrow_mut().insert((declared.file, text.to_owned()));
                }
                binding
            }
            Definition::State(_) => return self.state(text, span),
            Definition::Clock(clock) => return self.clock(clock, place).map(Value::Typed),
            Definition::Parameter(parameter) => return self.parameter_value(parameter, place.file),
            Definition::Random(random) => return self.random(random, declared, span),
            Definition::Reference(_) => {
                let message = format!("`{text}` is a motion; use one of its signals: `{text}.q(knee_angle_r)`");
                return Err(self.error(codes::types::WRONG_TYPE, span, message));
            }
            Definition::Function(_) => {
                let message = format!("`{text}` is a function; call it: `{text}(...)`");
                return Err(self.error(codes::names::UNKNOWN_NAME, span, message));
            }
            Definition::Observation(_) => {
                let message = format!("`{text}` is a block of channels; it is allowed only in `observe`");
                return Err(self.error(codes::names::UNKNOWN_NAME, span, message));
            }
        };
        let key = (place, self.mode.after, text.to_owned());
        if let Some(known) = self.memo.get(&key) {
            self.hir.stands_for(self.formulas.get(&key).copied());
            return known.clone();
        }
        let formula = self.hir.next();
        self.enter(Step { name: text.to_owned(), file: self.place.file, span, call: false }, declared)?;
        let value = self.elsewhere(place, |checker| {
            let value = checker.value(&binding.value)?;
            checker.check_annotation(binding.annotation.as_ref(), &value)?;
            Ok(value)
        });
        self.path.pop();
        if value.is_ok() {
            self.hir.stands_for(Some(formula));
            self.formulas.insert(key.clone(), formula);
        }
        if let (Definition::Let(_), Ok(Value::Typed(data))) = (declared.definition, &value) {
            self.lets.push(NamedValue { name: text.to_owned(), node: data.node, unit: unit_of(&data.kind) });
        }
        self.memo.insert(key, value.clone());
        value
    }

    /// Steps into a name or function, unless that closes a circle.
    pub(crate) fn enter(&mut self, step: Step, declared: Declared<'a>) -> Checked<()> {
        let start = self.path.iter().position(|known| known.name == step.name && known.call == step.call);
        if let Some(start) = start {
            let mut circle: Vec<&str> = self.path[start..].iter().map(|step| step.name.as_str()).collect();
            circle.push(&step.name);
            let drawn = circle.join(" -> ");
            let help = if step.call {
                "functions cannot be recursive"
            } else {
                "to use the value of the previous step, write `prev(...)` of a signal or declare a `state`"
            };
            let message = format!("`{}` depends on itself", step.name);
            let diagnostic = Diagnostic::new(codes::names::CYCLE, step.file, step.span, message)
                .here("this closes the cycle")
                .label(declared.file, declared.definition.span(), "declared here")
                .help(format!("cyclic dependency: {drawn}"))
                .help(help);
            return Err(self.report(diagnostic));
        }
        self.path.push(step);
        Ok(())
    }

    /// `muscle "QL_post_I.1-L3_r"`, `muscles "glmax*"`.
    pub(crate) fn selector(&mut self, kind: &Ident, pattern: &Text) -> Checked<Value> {
        let body = self.vocabulary;
        let (names, thing): (Vec<&str>, fn(usize) -> EntityRef) = match kind.text.as_str() {
            "muscle" | "muscles" => (body.muscles.iter().map(|muscle| muscle.name.as_str()).collect(), EntityRef::Muscle),
            "joint" | "joints" => (body.joints.iter().map(|joint| joint.name.as_str()).collect(), EntityRef::Joint),
            "landmark" | "landmarks" => {
                (body.landmarks.iter().map(|landmark| landmark.name.as_str()).collect(), EntityRef::Landmark)
            }
            other => {
                let message = format!("`{other} \"...\"` is not supported yet; muscles, joints and landmarks can be selected");
                return Err(self.error(codes::names::NOT_YET, kind.span, message));
            }
        };
        let fitting: Vec<EntityRef> =
            names.iter().enumerate().filter(|(_, name)| fits(&pattern.value, name)).map(|(index, _)| thing(index)).collect();
        match fitting.as_slice() {
            [] => {
                let near = nearest(&pattern.value, names);
                let message = format!("no {} fits \"{}\"", kind.text.trim_end_matches('s'), pattern.value);
                let mut diagnostic = self.diagnostic(codes::names::NOTHING_FITS, pattern.span, message);
                if near.is_empty() {
                    diagnostic = diagnostic.help("`msk vocabulary` lists the names of the body; `*` matches any characters");
                }
                for name in near {
                    diagnostic = diagnostic.suggest(format!("did you mean \"{name}\"?"), pattern.span, format!("\"{name}\""));
                }
                Err(self.report(diagnostic))
            }
            [only] if !kind.text.ends_with('s') => Ok(Value::Entity(*only)),
            several => Ok(Value::Entities { members: several.to_vec(), group: kind.text.ends_with('s') }),
        }
    }
}

/// Whether `name` fits a pattern in which `*` stands for anything.
pub(crate) fn fits(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let Some(first) = parts.next() else { return false };
    let Some(mut rest) = name.strip_prefix(first) else { return false };
    let parts: Vec<&str> = parts.collect();
    let Some((last, middle)) = parts.split_last() else { return rest.is_empty() };
    for part in middle {
        match rest.find(part) {
            Some(place) => rest = &rest[place + part.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::fits;

    #[test]
    fn a_star_stands_for_anything() {
        assert!(fits("glmax*", "glmax1_r") && fits("*_r", "glmax1_r") && fits("gl*_r", "glmax1_r") && fits("*", ""));
        assert!(fits("soleus_r", "soleus_r") && !fits("soleus", "soleus_r") && !fits("a*b*a", "ab"));
    }
}
