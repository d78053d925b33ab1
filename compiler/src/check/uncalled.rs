//! Functions, constants and blocks of channels that nothing reads. What they are is only checked where they are read; what they
//! name can be looked at without, and so can cycles of calls.

use super::functions;
use super::signals::{self, Owner};
use crate::diagnostics::{Diagnostic, FileId, Span, codes, nearest};
use crate::resolve::scope::{Definition, Names, Place};
use crate::syntax::MAXIMUM_ERRORS;
use crate::syntax::tree::walk::{Visitor, walk_expression};
use crate::syntax::tree::{Entry, Expr, ExprKind, File, Function, Item, NamePart, Observation};
use crate::vocabulary::Vocabulary;
use crate::work::visit;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Words that every body and the language know beside signals and functions.
const WORDS: [&str; 10] = ["com", "ground", "robot", "joints", "hinges", "slides", "independent", "muscles", "world", "heading"];

/// Looks at the declarations of a file that are not in `called`: names that mean nothing, and cycles. Parts of bodies are only
/// judged where there is a body.
pub(crate) fn check(
    file: &File,
    names: &Names<'_>,
    cycles: &Cycles<'_>,
    called: &BTreeSet<(FileId, String)>,
    bodies: &[&Vocabulary],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let place = Place { file: file.file, in_task: false };
    let most = diagnostics.len() + MAXIMUM_ERRORS;
    for item in &file.items {
        let (name, formulas): (_, Vec<&Expr>) = match item {
            Item::Function(function) => (&function.name, vec![&function.body]),
            Item::Const(binding) => (&binding.name, vec![&binding.value]),
            Item::Observation(observation) => (&observation.name, channels(observation)),
            _ => continue,
        };
        if called.contains(&(file.file, name.text.clone())) {
            continue;
        }
        // Names that mean nothing are compared with all names in sight, cycles are followed: errors that are only counted are not
        // worth that.
        let is_shown = diagnostics.len() <= most;
        let parameters = if let Item::Function(function) = item { &function.parameters[..] } else { &[] };
        let locals = parameters.iter().map(|parameter| parameter.name.text.as_str()).collect();
        let mut reader = Reader { names, place, bodies, locals, is_shown, diagnostics };
        formulas.into_iter().for_each(|formula| reader.expression(formula));
        if let (Item::Function(function), true) = (item, is_shown) {
            diagnostics.extend(cycles.diagnostic(function, place));
        }
    }
}

fn channels(observation: &Observation) -> Vec<&Expr> {
    let items = observation.channels.iter();
    items.filter_map(|entry| if let Entry::Item(channel) = entry { Some(&channel.value) } else { None }).collect()
}

struct Reader<'a, 'd> {
    names: &'a Names<'a>,
    place: Place,
    bodies: &'a [&'a Vocabulary],
    locals: Vec<&'a str>,
    /// Whether errors are shown, not only counted.
    is_shown: bool,
    diagnostics: &'d mut Vec<Diagnostic>,
}

impl<'a> Reader<'a, '_> {
    fn known(&self, name: &str) -> bool {
        let of_body = |body: &&Vocabulary| {
            body.landmarks.iter().any(|part| part.name == name)
                || body.joints.iter().any(|part| part.name == name)
                || body.muscles.iter().any(|part| part.name == name)
                || body.groups.iter().any(|part| part.name == name)
        };
        self.locals.contains(&name)
            || self.names.find(self.place, name).is_some()
            || [Owner::Time, Owner::WholeBody].into_iter().any(|owner| signals::find(owner, name).is_some())
            || WORDS.contains(&name)
            || self.bodies.is_empty()
            || self.bodies.iter().any(of_body)
    }

    fn unknown(&mut self, name: &str, span: Span, message: String) {
        let candidates = self.names.in_sight(self.place).chain(self.locals.iter().copied());
        let functions = functions::FUNCTIONS.iter().chain(functions::OPERATORS).map(|function| function.name);
        let mut diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, self.place.file, span, message);
        let near = if self.is_shown { nearest(name, candidates.chain(functions)) } else { Vec::new() };
        for near in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), span, near);
        }
        self.diagnostics.push(diagnostic);
    }
}

impl<'a> Visitor<'a> for Reader<'a, '_> {
    fn expression(&mut self, expression: &'a Expr) {
        match &expression.kind {
            ExprKind::Name(name) => {
                if matches!(name.parts.as_slice(), [NamePart::Literal(_)]) && !self.known(&name.text) {
                    self.unknown(&name.text, name.span, format!("undefined name `{}`", name.text));
                }
            }
            ExprKind::Call { function, arguments } => {
                if let ExprKind::Name(name) = &function.kind {
                    let known = functions::find(&name.text).is_some() || self.names.find(self.place, &name.text).is_some();
                    // A heading is a frame, and a distribution a draw: neither stands in a function, but each is a word.
                    if !known && !matches!(name.text.as_str(), "heading" | "uniform" | "normal" | "choice") {
                        self.unknown(&name.text, name.span, format!("undefined function `{}`", name.text));
                    }
                } else {
                    self.expression(function);
                }
                arguments.iter().for_each(|argument| self.expression(&argument.value));
            }
            ExprKind::Comprehension { element, variable, source } => {
                self.expression(source);
                self.locals.push(&variable.text);
                self.expression(element);
                self.locals.pop();
            }
            _ => walk_expression(self, expression),
        }
    }
}

/// Functions that call themselves, over whatever others.
pub(crate) struct Cycles<'a> {
    names: &'a Names<'a>,
    /// For each function on a cycle the number of its strongly connected component.
    components: BTreeMap<Key<'a>, usize>,
}

/// A function: its file and its name.
type Key<'a> = (FileId, &'a str);

impl<'a> Cycles<'a> {
    /// Finds the functions of all files that call themselves. Each call is followed once.
    pub(crate) fn of(files: impl IntoIterator<Item = &'a File>, names: &'a Names<'a>) -> Self {
        let mut cycles = Self { names, components: BTreeMap::new() };
        let mut components = BTreeMap::new();
        let mut search = Search::default();
        for file in files {
            for item in &file.items {
                let Item::Function(function) = item else { continue };
                let key = (file.file, function.name.text.as_str());
                // Of two functions of one name only the first can be called.
                let first = names.find(Place { file: file.file, in_task: false }, key.1);
                let is_first = first.is_some_and(|(declared, _)| declared.definition.span() == function.name.span);
                if is_first && !search.found.contains_key(&key) {
                    search.run(key, function, |function, file| cycles.calls(function, file), &mut components);
                }
            }
        }
        cycles.components = components;
        cycles
    }

    /// The functions that a function calls, in the order of the text.
    fn calls(&self, function: &'a Function, file: FileId) -> Vec<Call<'a>> {
        let mut calls = Calls(Vec::new());
        calls.expression(&function.body);
        visit(1 + calls.0.len());
        let place = Place { file, in_task: false };
        let found = calls.0.into_iter().filter_map(|(name, span)| {
            let (declared, _) = self.names.find(place, &name)?;
            let Definition::Function(function) = declared.definition else { return None };
            Some(Call { key: (declared.file, &function.name.text), function, span })
        });
        found.collect()
    }

    /// Reports a function that stands on a cycle, with a shortest way back to it.
    fn diagnostic(&self, function: &'a Function, place: Place) -> Option<Diagnostic> {
        let start = (place.file, function.name.text.as_str());
        let component = self.components.get(&start)?;
        // Breadth first within the component: the first call that comes back closes a shortest cycle.
        let mut callers: BTreeMap<Key<'a>, Key<'a>> = BTreeMap::new();
        let mut pending = VecDeque::from([(start, function)]);
        let mut last = None;
        while let (None, Some((caller, function))) = (last, pending.pop_front()) {
            for call in self.calls(function, caller.0) {
                if call.key == start {
                    last = Some(caller);
                } else if self.components.get(&call.key) == Some(component) && !callers.contains_key(&call.key) {
                    callers.insert(call.key, caller);
                    pending.push_back((call.key, call.function));
                }
            }
        }
        let mut cycle = vec![start];
        let mut key = last?;
        while key != start {
            cycle.push(key);
            key = *callers.get(&key)?;
        }
        cycle.push(start);
        cycle.reverse();
        let first = self.calls(function, place.file).into_iter().find(|call| call.key == cycle[1])?;
        let circle: Vec<&str> = cycle.iter().map(|(_, name)| *name).collect();
        let message = format!("`{}` depends on itself", function.name.text);
        let diagnostic = Diagnostic::new(codes::names::CYCLE, place.file, first.span, message)
            .here("this closes the cycle")
            .label(place.file, function.name.span, "declared here")
            .help(format!("the circle: {}", circle.join(" -> ")))
            .help("functions cannot be recursive");
        Some(diagnostic)
    }
}

/// A call of a function.
struct Call<'a> {
    key: Key<'a>,
    function: &'a Function,
    span: Span,
}

/// Tarjan's search for strongly connected components, without recursion: a chain of calls may be as long as a text.
#[derive(Default)]
struct Search<'a> {
    /// For each function its order of discovery, and the lowest order of an open function that it reaches.
    found: BTreeMap<Key<'a>, (usize, usize)>,
    /// Functions whose component is not complete, in the order of discovery.
    open: Vec<Key<'a>>,
    is_open: BTreeSet<Key<'a>>,
}

/// A function whose calls are being followed.
struct Frame<'a> {
    key: Key<'a>,
    calls: std::vec::IntoIter<Call<'a>>,
    calls_itself: bool,
}

impl<'a> Search<'a> {
    fn enter(&mut self, key: Key<'a>, calls: Vec<Call<'a>>) -> Frame<'a> {
        let order = self.found.len();
        self.found.insert(key, (order, order));
        self.open.push(key);
        self.is_open.insert(key);
        Frame { key, calls: calls.into_iter(), calls_itself: false }
    }

    fn lower(&mut self, key: Key<'a>, order: usize) {
        if let Some((_, lowest)) = self.found.get_mut(&key) {
            *lowest = order.min(*lowest);
        }
    }

    /// Follows all calls from a function, and numbers the components of those that stand on a cycle.
    fn run(
        &mut self,
        key: Key<'a>,
        function: &'a Function,
        calls_of: impl Fn(&'a Function, FileId) -> Vec<Call<'a>>,
        components: &mut BTreeMap<Key<'a>, usize>,
    ) {
        let mut path = vec![self.enter(key, calls_of(function, key.0))];
        while let Some(frame) = path.last_mut() {
            let key = frame.key;
            if let Some(call) = frame.calls.next() {
                frame.calls_itself |= call.key == key;
                match self.found.get(&call.key).map(|(order, _)| *order) {
                    None => path.push(self.enter(call.key, calls_of(call.function, call.key.0))),
                    Some(order) if self.is_open.contains(&call.key) => self.lower(key, order),
                    Some(_) => {}
                }
                continue;
            }
            let calls_itself = frame.calls_itself;
            path.pop();
            let Some((order, lowest)) = self.found.get(&key).copied() else { continue };
            if let Some(caller) = path.last() {
                self.lower(caller.key, lowest);
            }
            if order == lowest {
                let start = self.open.iter().rposition(|open| *open == key).unwrap_or_default();
                let members = self.open.split_off(start);
                let is_cycle = members.len() > 1 || calls_itself;
                for member in members {
                    self.is_open.remove(&member);
                    if is_cycle {
                        components.insert(member, order);
                    }
                }
            }
        }
    }
}

/// The calls of a formula.
struct Calls(Vec<(String, Span)>);

impl<'a> Visitor<'a> for Calls {
    fn expression(&mut self, expression: &'a Expr) {
        if let ExprKind::Call { function, .. } = &expression.kind
            && let ExprKind::Name(name) = &function.kind
        {
            self.0.push((name.text.clone(), expression.span));
        }
        walk_expression(self, expression);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resolve::scope::{FileInSight, Globals};
    use crate::syntax;
    use crate::work::assert_linear;

    /// Whether each function of a text stands on a cycle.
    fn cyclic(text: &str) -> Vec<String> {
        let tree = syntax::parse(FileId::default(), text).tree;
        let globals = Globals::collect([FileInSight { tree: &tree, uses: Vec::new() }]);
        let names = Names::global(&globals);
        let cycles = Cycles::of([&tree], &names);
        cycles.components.keys().map(|(_, name)| (*name).to_owned()).collect()
    }

    #[test]
    fn functions_on_cycles_are_found_and_those_that_lead_to_one_are_not() {
        assert_eq!(cyclic("fn a(x) = b(x)\nfn b(x) = c(x)\nfn c(x) = b(x) + d(x)\nfn d(x) = x\n"), ["b", "c"]);
        assert_eq!(cyclic("fn a(x) = a(x)\n"), ["a"]);
        assert_eq!(cyclic("fn a(x) = b(x) + c(x)\nfn b(x) = d(x)\nfn c(x) = d(x)\nfn d(x) = x\n"), Vec::<String>::new());
        assert_eq!(cyclic("fn a(x) = b(x) + c(x)\nfn b(x) = a(x)\nfn c(x) = a(x)\n"), ["a", "b", "c"]);
    }

    #[test]
    fn each_call_is_followed_once() {
        let chain = |length: usize| (1..length).map(|n| format!("fn f{n}(x) = f{}(x)\n", n - 1)).collect::<String>();
        assert_linear(1000, |length| cyclic(&(chain(length) + "fn f0(x) = x\n")));
        assert_eq!(cyclic(&(chain(1000) + "fn f0(x) = f999(x)\n")).len(), 1000);
    }
}
