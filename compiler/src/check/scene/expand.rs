//! Loops unrolled, removals carried out, layers of extended tasks laid over each other: the statements of a scene as flat lists.
//!
//! What a task declares over a scene that it extends replaces what has the same name there, in its place; the rest is added.

use crate::check::context::{Checked, Checker, Local, Reported};
use crate::check::lookup::fits;
use crate::check::scene::object::dotted;
use crate::check::types::{ElementType, Type};
use crate::check::value::{TypedValue, Value};
use crate::diagnostics::{FileId, Span, codes};
use crate::resolve::inherit::overrides_nothing;
use crate::resolve::layers::Layers;
use crate::syntax::tree::{Connection, Element, ElementName, Group, Marker, Name, NamePart, Remove, Repeat, SceneStatement};

/// Elements that one scene may hold once its loops are unrolled.
const MOST: usize = 2_000;

/// Loop variables and their present values.
pub(crate) type Locals = Vec<(String, f64)>;

/// A statement of a scene, with the loop variables around it.
#[derive(Debug)]
pub(crate) struct Unrolled<'a, T> {
    pub statement: &'a T,
    /// Its full name, of a connection what it holds; only the ground has none.
    pub name: Option<String>,
    pub locals: Locals,
    /// Where it was written.
    pub file: FileId,
}

/// The statements of a scene, one by one.
#[derive(Debug, Default)]
pub(crate) struct Expanded<'a> {
    pub elements: Vec<Unrolled<'a, Element>>,
    pub connections: Vec<Unrolled<'a, Connection>>,
    pub groups: Vec<Unrolled<'a, Group>>,
    pub markers: Vec<Unrolled<'a, Marker>>,
}

/// Statements of one kind, under their names.
type Rows<'a, T> = Layers<Option<String>, Unrolled<'a, T>>;

/// Statements of the scenes of tasks that extend each other, laid over each other.
#[derive(Debug, Default)]
pub(super) struct Merging<'a> {
    /// Of the statements that come next.
    pub layer: usize,
    elements: Rows<'a, Element>,
    connections: Rows<'a, Connection>,
    groups: Rows<'a, Group>,
    markers: Rows<'a, Marker>,
}

impl<'a> Merging<'a> {
    /// What is left of all layers.
    pub(super) fn merged(self) -> Expanded<'a> {
        Expanded {
            elements: self.elements.into_items().collect(),
            connections: self.connections.into_items().collect(),
            groups: self.groups.into_items().collect(),
            markers: self.markers.into_items().collect(),
        }
    }
}

impl<'a> Checker<'a> {
    /// Unrolls the statements of a scene.
    pub(super) fn expand_scene(&mut self, statements: &'a [SceneStatement], locals: &Locals, found: &mut Merging<'a>) {
        let (file, layer) = (self.place.file, found.layer);
        for statement in statements {
            let locals = locals.clone();
            match statement {
                SceneStatement::Element(element) => {
                    let name = self.with_locals(&locals, |checker| checker.element_name(element));
                    if let Ok(name) = name
                        && self.may_hold(found.elements.count(), element.span).is_ok()
                    {
                        found.elements.lay(name.clone(), layer, Unrolled { statement: element, name, locals, file });
                    }
                }
                SceneStatement::Connection(connection) => {
                    let name = dotted(&connection.from);
                    found.connections.lay(name.clone(), layer, Unrolled { statement: connection, name, locals, file });
                }
                SceneStatement::Group(group) => {
                    let name = Some(group.name.text.clone());
                    found.groups.lay(name.clone(), layer, Unrolled { statement: group, name, locals, file });
                }
                SceneStatement::Marker(marker) => {
                    if let Ok(names) = self.with_locals(&locals, |checker| checker.expand(&marker.name)) {
                        let name = Some(names.concat());
                        found.markers.lay(name.clone(), layer, Unrolled { statement: marker, name, locals, file });
                    }
                }
                SceneStatement::Repeat(repeat) => self.expand_repeat(repeat, &locals, found),
                SceneStatement::Remove(remove) => self.expand_removal(remove, &locals, found),
                SceneStatement::Allow(_) => {}
            }
        }
    }

    fn expand_repeat(&mut self, repeat: &'a Repeat, locals: &Locals, found: &mut Merging<'a>) {
        let Ok(values) = self.with_locals(locals, |checker| checker.loop_values(&repeat.range)) else { return };
        for value in values {
            let number = match &value {
                Value::Typed(TypedValue { node, kind: Type::One(ElementType::Int), .. }) => self.graph.constant_value(*node),
                _ => None,
            };
            let Some(number) = number else {
                let diagnostic = self
                    .diagnostic(codes::types::NOT_CONSTANT, repeat.range.span, "`repeat` in a scene iterates over whole numbers")
                    .help("write the range of a number: `repeat i in 0..4 { ... }`");
                self.report(diagnostic);
                return;
            };
            let mut inner = locals.clone();
            inner.push((repeat.variable.text.clone(), number));
            let before = self.diagnostics.len();
            self.expand_scene(&repeat.statements, &inner, found);
            // What is wrong in one round is wrong in all of them.
            if Reported::among(&self.diagnostics[before..]).is_some() {
                break;
            }
        }
    }

    fn may_hold(&mut self, count: usize, span: Span) -> Checked<()> {
        if count < MOST {
            return Ok(());
        }
        let reported = Reported::among(self.diagnostics.iter().filter(|diagnostic| diagnostic.code == codes::tasks::TOO_LARGE));
        Err(reported.unwrap_or_else(|| self.error(codes::tasks::TOO_LARGE, span, format!("a scene has at most {MOST} elements"))))
    }

    fn expand_removal(&mut self, remove: &'a Remove, locals: &Locals, found: &mut Merging<'a>) {
        let Ok(patterns) = self.with_locals(locals, |checker| checker.names_of(&remove.name)) else { return };
        for pattern in patterns {
            let fitting = |name: &Option<String>, _: usize| name.as_deref().is_some_and(|name| fits(&pattern, name));
            let gone = [
                found.elements.take_out_where(fitting),
                found.connections.take_out_where(fitting),
                found.groups.take_out_where(fitting),
                found.markers.take_out_where(fitting),
            ];
            if !gone.contains(&true) {
                let (things, held) = (found.elements.keys(), found.connections.keys());
                let all = things.chain(held).chain(found.groups.keys()).chain(found.markers.keys());
                let names = all.filter_map(|(name, _)| name.as_deref());
                let message = format!("no element `{pattern}` is declared above");
                self.report(overrides_nothing(message, &pattern, self.place.file, remove.name.span, names));
            }
        }
    }

    /// The names of a pattern; a star stays one.
    pub(in crate::check) fn names_of(&mut self, name: &Name) -> Checked<Vec<String>> {
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
                let message = "the name of an element is an unquoted word";
                return Err(self.error(codes::tasks::UNKNOWN_SETTING, text.span, message));
            }
            None if element.kind.text == "ground" => return Ok(None),
            None => {
                let message = format!("this `{}` has no name", element.kind.text);
                let diagnostic = self.diagnostic(codes::tasks::MISSING, element.kind.span, message).help(format!(
                    "every element needs a name, by which formulas read it: `{} seat {{ ... }}`",
                    element.kind.text
                ));
                return Err(self.report(diagnostic));
            }
        };
        let several = name.parts.iter().any(|part| !matches!(part, NamePart::Literal(_) | NamePart::Variable(_)));
        if several {
            let message = format!("`{}` would put several objects at one place", name.text);
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
            let value = Value::Typed(TypedValue::new(node, ElementType::Int));
            self.locals.push(Local { name: name.clone(), value, definition: None });
        }
        let result = check(self);
        self.locals.truncate(before);
        result
    }
}
