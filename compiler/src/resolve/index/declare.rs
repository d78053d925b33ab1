//! What files, tasks, scenes and bodies declare.

use super::{Index, Names, Space};
use crate::diagnostics::Span;
use crate::syntax::tree::{
    BodyStatement, Docs, Element, ElementName, Entry, Ident, Item, Name, NamePart, SceneStatement, TaskStatement, walk,
};

/// Collects all declarations.
pub(super) fn declare(index: &mut Index) {
    for file in 0..index.files.len() {
        let found = top(&index.files[file].tree.items);
        let mut names = Names::new();
        for found in found {
            add(index, &mut names, file, &found);
        }
        index.top.push(names);
    }
    for file in 0..index.files.len() {
        for item in 0..index.files[file].tree.items.len() {
            of_task(index, file, item, 0);
        }
    }
}

/// A declaration on its way into a table.
struct Found {
    space: Space,
    /// `door.leaf` for parts of objects.
    key: String,
    span: Span,
    what: &'static str,
    docs: Option<Docs>,
    pattern: bool,
}

fn found(space: Space, name: &Ident, what: &'static str, docs: Option<&Docs>) -> Found {
    Found { space, key: name.text.clone(), span: name.span, what, docs: docs.cloned(), pattern: false }
}

fn add(index: &mut Index, names: &mut Names, file: usize, found: &Found) {
    let key = (found.space, found.key.clone());
    // What is declared again overrides what was inherited, or clashes with it: either way it is the same name.
    let symbol = match names.get(&key) {
        Some(known) => *known,
        None => {
            let name = found.key.rsplit('.').next().unwrap_or_default();
            index.symbol(name, found.space, found.what, found.docs.as_ref())
        }
    };
    names.insert(key, symbol);
    index.occurs(file, found.span, symbol, true, found.pattern);
}

fn top(items: &[Item]) -> Vec<Found> {
    let mut all = Vec::new();
    for item in items {
        match item {
            Item::Const(binding) => all.push(found(Space::Value, &binding.name, "const", binding.docs.as_ref())),
            Item::Function(function) => all.push(found(Space::Value, &function.name, "fn", function.docs.as_ref())),
            Item::Observation(block) => all.push(found(Space::Value, &block.name, "observation", block.docs.as_ref())),
            Item::Task(task) => all.push(found(Space::Task, &task.name, "task", task.docs.as_ref())),
            Item::Sequence(sequence) => all.push(found(Space::Task, &sequence.name, "sequence", sequence.docs.as_ref())),
            Item::Body(body) => {
                all.push(found(Space::Body, &body.name, "body", body.docs.as_ref()));
                body.statements.iter().for_each(|statement| of_body(statement, &mut all));
            }
            Item::Use(_) | Item::Suite(_) => {}
        }
    }
    all
}

fn of_body(statement: &BodyStatement, all: &mut Vec<Found>) {
    match statement {
        BodyStatement::Element(element) => {
            if let Some(ElementName::Name(name)) = &element.name {
                named(Space::Part, "", name, "landmark", element.docs.as_ref(), all);
            }
        }
        BodyStatement::Group(group) => named(Space::Part, "", &group.name, "group", group.docs.as_ref(), all),
        BodyStatement::Pose(pose) => all.push(found(Space::Pose, &pose.name, "pose", pose.docs.as_ref())),
        BodyStatement::Model(_) | BodyStatement::Setting { .. } => {}
    }
}

/// The names of a pattern, each a declaration of its own.
fn named(space: Space, before: &str, name: &Name, what: &'static str, docs: Option<&Docs>, all: &mut Vec<Found>) {
    let pattern = !matches!(name.parts.as_slice(), [NamePart::Literal(_)]);
    for text in expanded(name) {
        let (key, docs) = (format!("{before}{text}"), docs.cloned());
        all.push(Found { space, key, span: name.span, what, docs, pattern });
    }
}

/// Most names that a pattern stands for here; what is more cannot be followed.
const MOST: usize = 200;

/// The names of a pattern; `{i}` and `{*}` stay as they are written, so that only the same pattern finds them.
pub(super) fn expanded(name: &Name) -> Vec<String> {
    let mut texts = vec![String::new()];
    for part in &name.parts {
        let choices: Vec<String> = match part {
            NamePart::Literal(text) => vec![text.clone()],
            NamePart::Words(words) => words.clone(),
            NamePart::Range(low, high) => (*low..*high).take(MOST).map(|number| number.to_string()).collect(),
            NamePart::Variable(_) | NamePart::Any => vec!["{}".to_owned()],
        };
        texts = texts.iter().flat_map(|text| choices.iter().map(move |choice| format!("{text}{choice}"))).collect();
        texts.truncate(MOST);
    }
    texts
}

/// Tasks that extend each other are followed this deep, as by the compiler.
const DEEPEST: usize = 64;

/// Most names that all tasks together may inherit; what is more cannot be followed.
const MOST_INHERITED: usize = 200_000;

/// What is in sight of a task or sequence: what it inherits, then what it declares.
fn of_task(index: &mut Index, file: usize, item: usize, depth: usize) -> Names {
    if let Some(known) = index.tasks.get(&(file, item)) {
        return known.clone();
    }
    let (statements, parents) = match &index.files[file].tree.items[item] {
        Item::Task(task) => (task.statements.clone(), task.extends.iter().map(|parent| parent.text.clone()).collect()),
        Item::Sequence(sequence) => {
            let phases = sequence.statements.iter();
            let phases =
                phases.filter_map(|s| if let TaskStatement::Phase(phase) = s { Some(phase.task.text.clone()) } else { None });
            (sequence.statements.clone(), phases.collect::<Vec<_>>())
        }
        _ => return Names::new(),
    };
    let mut names = Names::new();
    // A task that extends itself, over whatever detour, finds itself without names; the compiler tells it.
    index.tasks.insert((file, item), Names::new());
    for parent in parents.into_iter().filter(|_| depth < DEEPEST) {
        let Some((file, item)) = task_called(index, file, &parent) else { continue };
        let inherited = of_task(index, file, item, depth + 1);
        if index.inherited + inherited.len() > MOST_INHERITED {
            continue;
        }
        index.inherited += inherited.len();
        for (key, symbol) in inherited {
            names.entry(key).or_insert(symbol);
        }
    }
    let mut all = Vec::new();
    statements.iter().for_each(|statement| of_statement(statement, &mut all));
    for found in &all {
        add(index, &mut names, file, found);
    }
    index.tasks.insert((file, item), names.clone());
    names
}

/// The task of that name in sight of a file.
fn task_called(index: &Index, file: usize, name: &str) -> Option<(usize, usize)> {
    let sources = std::iter::once(file).chain(index.files[file].uses.iter().copied());
    sources.into_iter().find_map(|source| {
        let mut items = index.files[source].tree.items.iter();
        let item = items.position(|item| match item {
            Item::Task(task) => task.name.text == name,
            Item::Sequence(sequence) => sequence.name.text == name,
            _ => false,
        })?;
        Some((source, item))
    })
}

fn of_statement(statement: &TaskStatement, all: &mut Vec<Found>) {
    use TaskStatement as S;
    let value = |name: &Ident, what, docs: Option<&Docs>| found(Space::Value, name, what, docs);
    match statement {
        S::Let(binding) => all.push(value(&binding.name, "let", binding.docs.as_ref())),
        S::State(state) => all.push(value(&state.name, "state", state.docs.as_ref())),
        S::Clock(clock) => all.push(value(&clock.name, "clock", clock.docs.as_ref())),
        S::Random(random) => all.push(value(&random.name, "random", random.docs.as_ref())),
        S::Reference(reference) => all.push(value(&reference.name, "reference", reference.docs.as_ref())),
        S::Params(block) => {
            all.extend(walk::items(&block.entries).map(|p| value(&p.name, "parameter", p.docs.as_ref())));
        }
        S::Reward(reward) => {
            all.extend(walk::items(&reward.terms).map(|term| found(Space::Term, &term.name, "term", term.docs.as_ref())));
        }
        S::Terminate(ends) | S::Finish(ends) => {
            all.extend(
                walk::items(&ends.reasons).map(|reason| found(Space::Reason, &reason.name, "reason", reason.docs.as_ref())),
            );
        }
        S::Observe(block) | S::Critic(block) | S::Metrics(block) => {
            for channel in walk::items(&block.entries) {
                all.extend(channel.label.iter().map(|label| found(Space::Label, label, "label", channel.docs.as_ref())));
            }
        }
        S::Scene(block) => block.entries.iter().for_each(|entry| of_scene(entry, all)),
        _ => {}
    }
}

fn of_scene(statement: &SceneStatement, all: &mut Vec<Found>) {
    match statement {
        SceneStatement::Element(element) => of_element(element, "", all),
        SceneStatement::Group(group) => all.push(found(Space::Value, &group.name, "group", group.docs.as_ref())),
        SceneStatement::Marker(marker) => named(Space::Label, "", &marker.name, "marker", None, all),
        SceneStatement::Repeat(repeat) => repeat.statements.iter().for_each(|entry| of_scene(entry, all)),
        SceneStatement::Connection(_) | SceneStatement::Remove(_) | SceneStatement::Allow(_) => {}
    }
}

fn of_element(element: &Element, before: &str, all: &mut Vec<Found>) {
    let Some(ElementName::Name(name)) = &element.name else { return };
    named(Space::Value, before, name, "object", element.docs.as_ref(), all);
    let before = format!("{before}{}.", expanded(name).first().map_or("", String::as_str));
    element.parts.iter().for_each(|part| of_element(part, &before, all));
}

/// Whether an entry leaves something out.
pub(super) fn removed<T>(entries: &[Entry<T>]) -> impl Iterator<Item = &Name> {
    entries.iter().filter_map(|entry| if let Entry::Remove(remove) = entry { Some(&remove.name) } else { None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::{LoadError, Loader};
    use std::path::{Path, PathBuf};

    struct Text(String);

    impl Loader for Text {
        fn load(&self, _: &Path) -> Result<String, LoadError> {
            Ok(self.0.clone())
        }
    }

    fn index(text: String) -> Index {
        Index::of(&[PathBuf::from("/a.msk")], &Text(text))
    }

    #[test]
    fn sequences_that_lead_to_each_other_come_to_an_end() {
        let phases: String = (0..40).map(|number| format!("    phase s{number}\n")).collect();
        let text = (0..40).map(|number| format!("sequence s{number} {{\n    let a{number} = 1\n{phases}}}\n")).collect();
        assert_eq!(index(text).tasks.len(), 40);
    }

    #[test]
    fn what_tasks_inherit_is_bounded() {
        let first = "task t0 { let a0 = 1 }\n".to_owned();
        let line = |count: usize| (1..count).map(|n| format!("task t{n} extends t{} {{ let a{n} = 1 }}\n", n - 1));
        let short = index(first.clone() + &line(30).collect::<String>());
        assert_eq!(short.tasks[&(0, 29)].len(), 30);
        let long = index(first + &line(2000).collect::<String>());
        assert!(long.inherited <= MOST_INHERITED);
    }
}
