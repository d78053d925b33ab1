//! Loops unrolled, removals carried out: the statements of a scene as a flat list.

use crate::check::context::{Checked, Checker, Reported};
use crate::check::lookup::fits;
use crate::check::types::Type;
use crate::check::value::{Data, Value};
use crate::diagnostics::{Span, codes, nearest};
use crate::syntax::tree::{Connection, Element, ElementName, Group, Marker, Name, NamePart, Remove, Repeat, SceneStatement};

/// Elements that one scene may hold once its loops are unrolled.
const MOST: usize = 2_000;

/// Loop variables and their present values.
pub(crate) type Locals = Vec<(String, f64)>;

/// The statements of a scene, each with the loop variables around it.
#[derive(Debug, Default)]
pub(crate) struct Expanded<'a> {
    /// Elements with their full names; only the ground has none.
    pub elements: Vec<(&'a Element, Option<String>, Locals)>,
    pub connections: Vec<(&'a Connection, Locals)>,
    pub groups: Vec<&'a Group>,
    pub markers: Vec<(&'a Marker, Locals)>,
}

impl<'a> Checker<'a> {
    /// Unrolls the statements of a scene.
    pub(super) fn expand_scene(&mut self, statements: &'a [SceneStatement], locals: &Locals, found: &mut Expanded<'a>) {
        for statement in statements {
            match statement {
                SceneStatement::Element(element) => {
                    let name = self.with_locals(locals, |checker| checker.element_name(element));
                    if let Ok(name) = name
                        && self.may_hold(found.elements.len(), element.span).is_ok()
                    {
                        found.elements.push((element, name, locals.clone()));
                    }
                }
                SceneStatement::Connection(connection) => found.connections.push((connection, locals.clone())),
                SceneStatement::Group(group) => found.groups.push(group),
                SceneStatement::Marker(marker) => found.markers.push((marker, locals.clone())),
                SceneStatement::Repeat(repeat) => self.expand_repeat(repeat, locals, found),
                SceneStatement::Remove(remove) => self.expand_removal(remove, locals, found),
                SceneStatement::Allow(_) => {}
            }
        }
    }

    fn expand_repeat(&mut self, repeat: &'a Repeat, locals: &Locals, found: &mut Expanded<'a>) {
        let Ok(values) = self.with_locals(locals, |checker| checker.loop_values(&repeat.range)) else { return };
        for value in values {
            let Value::Data(Data { node, .. }) = value else { continue };
            let Some(number) = self.graph.constant_value(node) else { continue };
            let mut inner = locals.clone();
            inner.push((repeat.variable.text.clone(), number));
            let told = self.diagnostics.len();
            self.expand_scene(&repeat.statements, &inner, found);
            // What is wrong in one round is wrong in all of them.
            if self.diagnostics.len() > told {
                break;
            }
        }
    }

    fn may_hold(&mut self, count: usize, span: Span) -> Checked<()> {
        if count < MOST {
            return Ok(());
        }
        if count == MOST && !self.diagnostics.iter().any(|told| told.code == codes::tasks::TOO_LARGE) {
            self.error(codes::tasks::TOO_LARGE, span, format!("a scene holds at most {MOST} elements"));
        }
        Err(Reported)
    }

    fn expand_removal(&mut self, remove: &'a Remove, locals: &Locals, found: &mut Expanded<'a>) {
        let pattern = match self.with_locals(locals, |checker| checker.names_of(&remove.name)) {
            Ok(patterns) => patterns,
            Err(Reported) => return,
        };
        for pattern in pattern {
            let before = found.elements.len();
            found.elements.retain(|(_, name, _)| !name.as_deref().is_some_and(|name| fits(&pattern, name)));
            if found.elements.len() == before {
                let names: Vec<&str> = found.elements.iter().filter_map(|(_, name, _)| name.as_deref()).collect();
                let near = nearest(&pattern, names);
                let message = format!("there is no `{pattern}` above that could be removed");
                let mut diagnostic = self.diagnostic(codes::names::UNKNOWN_NAME, remove.name.span, message);
                for name in near {
                    diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), remove.name.span, name);
                }
                self.report(diagnostic);
            }
        }
    }

    /// The names of a pattern; a star stays one.
    pub(super) fn names_of(&mut self, name: &Name) -> Checked<Vec<String>> {
        if !name.parts.iter().any(|part| matches!(part, NamePart::Any)) {
            return self.expand(name);
        }
        let pattern = |part: &NamePart| match part {
            NamePart::Literal(literal) => literal.clone(),
            _ => "*".to_owned(),
        };
        Ok(vec![name.parts.iter().map(pattern).collect()])
    }

    /// The one name of an element; none of the ground.
    pub(super) fn element_name(&mut self, element: &'a Element) -> Checked<Option<String>> {
        let name = match &element.name {
            Some(ElementName::Name(name)) => name,
            Some(ElementName::Quoted(text)) => {
                let message = "the name of an element is a word of the language, without quotes";
                return Err(self.error(codes::tasks::UNKNOWN_SETTING, text.span, message));
            }
            None if element.kind.text == "ground" => return Ok(None),
            None => {
                let message = format!("this `{}` has no name", element.kind.text);
                let diagnostic = self
                    .diagnostic(codes::tasks::MISSING, element.kind.span, message)
                    .help(format!("every element has one, by which formulas read it: `{} seat {{ ... }}`", element.kind.text));
                return Err(self.report(diagnostic));
            }
        };
        let several = name.parts.iter().any(|part| !matches!(part, NamePart::Literal(_) | NamePart::Variable(_)));
        if several {
            let message = format!("`{}` would give several things one place", name.text);
            let diagnostic = self
                .diagnostic(codes::tasks::UNKNOWN_SETTING, name.span, message)
                .help("repeat the element: `repeat i in 0..10 { cylinder pole_{i} { ... } }`");
            return Err(self.report(diagnostic));
        }
        Ok(self.expand(name)?.pop())
    }

    /// Runs `check` with loop variables in sight.
    pub(crate) fn with_locals<T>(&mut self, locals: &Locals, check: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.locals.len();
        for (name, number) in locals {
            let node = self.graph.constant(*number);
            self.locals.push((name.clone(), Value::Data(Data::new(node, Type::Int))));
        }
        let result = check(self);
        self.locals.truncate(before);
        result
    }
}
