//! `extends`: a task with all that it takes from those it extends.
//!
//! 1. The chain of tasks is followed to its end; a circle or a task that is not in sight is an error.
//! 2. Sections that are lists are taken apart row by row, each under its name; what is declared once is one row. Scenes and
//!    initial states stay whole, in layers: their rows are laid over each other once loops are unrolled (`scene::expand`,
//!    `init::layers`).
//! 3. From the oldest task to the youngest, rows replace rows of the same name where those stand, `remove` takes them out, and
//!    the rest is added behind. What is overridden must exist.
//!
//! A row keeps the file that it was written in: its names are looked up there, and errors point there.

use super::layers::Layers;
use super::texts::{Texts, label_of};
use crate::diagnostics::{Checked, Diagnostic, Failures, FileId, Span, codes, nearest};
use crate::numbers::distinguished;
use crate::syntax::tree::{
    Allow, Block, Bounds, Channel, Ends, Entry, Ident, Remove, Reward, Task, TaskParameter, TaskStatement, Term, Weight,
};
use crate::work::visit;
use std::cell::Cell;

/// A statement with the file in which it stands.
#[derive(Debug, Clone)]
pub(crate) struct Placed {
    pub statement: TaskStatement,
    pub file: FileId,
    /// How often its task was extended from: 0 in the oldest of a line of tasks.
    pub layer: usize,
    /// What is allowed above overrides of its row that keep the rest of the row.
    pub allowed: Vec<AllowedAbove>,
}

/// An `allow` above an override of a weight or a value alone.
#[derive(Debug, Clone)]
pub(crate) struct AllowedAbove {
    pub allow: Allow,
    pub file: FileId,
    /// The line of the override.
    pub line: Span,
}

/// A task with what it inherits.
#[derive(Debug, Clone)]
pub(crate) struct WholeTask {
    /// The task itself; its statements are only its own.
    pub task: Task,
    pub file: FileId,
    /// Its own statements and the inherited ones.
    pub statements: Vec<Placed>,
}

/// A task with its file.
#[derive(Clone, Copy)]
pub(crate) struct InFile<'a> {
    pub task: &'a Task,
    pub file: FileId,
}

/// Looks a task up from a file; else the names of those that are in sight.
pub(crate) type Find<'f, 'a> = &'f dyn Fn(FileId, &str) -> Result<InFile<'a>, Vec<String>>;

/// What a row is named under: rows replace each other within their section only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Section {
    /// Declared once: the word itself.
    Single(&'static str),
    /// Declared once in each task, in layers: the word itself.
    Layered(&'static str),
    Parameter,
    Channel,
    Term,
    Critic,
    Metric,
    Reason,
    /// `let`, `state`, `clock`, `random`, `reference`: one namespace.
    Value,
    /// Never replaced.
    Loose,
}

impl Section {
    fn word(self) -> &'static str {
        match self {
            Self::Single(word) | Self::Layered(word) => word,
            Self::Parameter => "parameter",
            Self::Channel => "channel",
            Self::Term => "term",
            Self::Critic => "critic channel",
            Self::Metric => "metric",
            Self::Reason => "reason",
            Self::Value => "value",
            Self::Loose => "statement",
        }
    }
}

#[derive(Debug, Clone)]
struct Row {
    section: Section,
    name: String,
    placed: Placed,
}

/// A change that an extending task makes.
enum Change {
    Row(Box<Row>),
    Remove(Section, Remove, FileId),
}

/// Most tasks that one task may extend, over each other.
pub const MAXIMUM_EXTENDED: usize = 64;

/// Most statements that all tasks of a compilation together may inherit: each is a copy.
pub const MAXIMUM_INHERITED: usize = 200_000;

/// Statements that may still be inherited.
pub(crate) struct Budget(Cell<usize>);

impl Default for Budget {
    fn default() -> Self {
        Self(Cell::new(MAXIMUM_INHERITED))
    }
}

impl Budget {
    /// Takes statements.
    ///
    /// # Errors
    /// So many are not left, which is reported at `name`.
    pub(crate) fn spend(&self, statements: usize, name: &Ident, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Checked<()> {
        visit(statements);
        if let Some(left) = self.0.get().checked_sub(statements) {
            self.0.set(left);
            return Ok(());
        }
        let message = format!("here the inherited statements of all tasks exceed {MAXIMUM_INHERITED}");
        let diagnostic = Diagnostic::new(codes::tasks::TOO_LARGE, file, name.span, message)
            .help("every task that extends another, and every phase of a sequence, copies the statements that it inherits");
        Err(diagnostic.report(diagnostics))
    }
}

/// The task with what it inherits. `find` looks a task up from a file.
///
/// # Errors
/// A circle, a task that is not in sight, or a row that overrides nothing.
pub(crate) fn whole<'a>(
    task: InFile<'a>,
    find: Find<'_, 'a>,
    budget: &Budget,
    texts: &dyn Texts,
    diagnostics: &mut Vec<Diagnostic>,
) -> Checked<WholeTask> {
    let mut chain = vec![task];
    while let Some(parent) = chain.last().and_then(|last| last.task.extends.as_ref().map(|name| (name, last.file))) {
        let (name, file) = parent;
        let found = match find(file, &name.text) {
            Ok(found) => found,
            Err(known) => return Err(unknown_task(name, file, &known).report(diagnostics)),
        };
        if chain.iter().any(|known| std::ptr::eq(known.task, found.task)) {
            let mut names: Vec<&str> = chain.iter().map(|known| known.task.name.text.as_str()).collect();
            names.push(&name.text);
            let diagnostic = Diagnostic::new(codes::names::CYCLE, file, name.span, "a task cannot extend itself")
                .here("this closes the cycle")
                .help(format!("the circle: {}", names.join(" -> ")));
            return Err(diagnostic.report(diagnostics));
        }
        if chain.len() > MAXIMUM_EXTENDED {
            let message = format!("`{}` has more than {MAXIMUM_EXTENDED} levels of `extends`", task.task.name.text);
            let start = task.task.extends.as_ref().map_or(task.task.name.span, |name| name.span);
            return Err(Diagnostic::new(codes::tasks::TOO_LARGE, task.file, start, message).report(diagnostics));
        }
        chain.push(found);
    }
    let inherited = chain.iter().skip(1).map(|one| one.task.statements.len()).sum();
    budget.spend(inherited, &task.task.name, task.file, diagnostics)?;
    let plain = |of: InFile<'_>, layer: usize| {
        let statements = of.task.statements.iter().cloned();
        statements.map(|statement| Placed { statement, file: of.file, layer, allowed: Vec::new() }).collect::<Vec<_>>()
    };
    if chain.len() == 1 {
        return Ok(WholeTask { task: task.task.clone(), file: task.file, statements: plain(task, 0) });
    }
    let mut rows = Rows::default();
    let mut failures = Failures::default();
    for (place, one) in chain.iter().rev().enumerate() {
        // Tests belong to the task that they test.
        let inherited = place + 1 < chain.len();
        for placed in plain(*one, place) {
            if inherited && matches!(placed.statement, TaskStatement::Test(_)) {
                continue;
            }
            for change in changes(placed, texts) {
                failures.catch(match change {
                    Change::Row(row) => apply(*row, place > 0, &mut rows, diagnostics),
                    Change::Remove(section, remove, file) => take_out(section, &remove, file, &mut rows, diagnostics),
                });
            }
        }
    }
    let statements = rows.into_items().map(|row| row.placed).collect();
    failures.or(WholeTask { task: task.task.clone(), file: task.file, statements })
}

/// A phase of a sequence: the task with what the sequence declares for all its phases. What is there once for the whole episode
/// (scene, initial state, body, control, action space) is the sequence's, or else the first phase's.
pub(crate) fn in_sequence(phase: WholeTask, first: &WholeTask, sequence: &[Placed], texts: &dyn Texts) -> WholeTask {
    const SHARED: [&str; 7] = ["family", "body", "control", "act", "symmetric", "scene", "init"];
    let section_of = |placed: &Placed| match changes(placed.clone(), texts).into_iter().next() {
        Some(Change::Row(row)) => row.section,
        _ => Section::Loose,
    };
    let shared = |placed: &Placed| match section_of(placed) {
        Section::Single(word) | Section::Layered(word) => SHARED.contains(&word),
        _ => matches!(placed.statement, TaskStatement::Disturb(_)),
    };
    let declared: Vec<Section> = sequence.iter().map(section_of).collect();
    let of_first = first.statements.iter().filter(|placed| shared(placed) && !declared.contains(&section_of(placed)));
    let of_sequence =
        sequence.iter().filter(|placed| !matches!(placed.statement, TaskStatement::Phase(_) | TaskStatement::Success(_)));
    let own = phase.statements.iter().filter(|placed| !shared(placed) && !matches!(placed.statement, TaskStatement::Test(_)));
    let statements = of_first.chain(of_sequence).chain(own).cloned().collect();
    WholeTask { statements, ..phase }
}

pub(crate) fn unknown_task(name: &Ident, file: FileId, known: &[String]) -> Diagnostic {
    let message = format!("undefined task `{}`", name.text);
    let mut diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, file, name.span, message)
        .help("a base task is declared in this file or imported: `use \"...\"`");
    for near in nearest(&name.text, known.iter().map(String::as_str)) {
        diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), name.span, near);
    }
    diagnostic
}

/// The rows and removals of a statement, in order.
fn changes(placed: Placed, texts: &dyn Texts) -> Vec<Change> {
    let (file, layer) = (placed.file, placed.layer);
    let row = |section, name: &str, statement| {
        Change::Row(Box::new(Row {
            section,
            name: name.to_owned(),
            placed: Placed { statement, file, layer, allowed: Vec::new() },
        }))
    };
    let single = |word: &'static str, statement| vec![row(Section::Single(word), "", statement)];
    use TaskStatement as S;
    match placed.statement {
        S::Params(Block { keyword, entries, span }) => {
            let statement = |entries| S::Params(Block { keyword, entries, span });
            rows(entries, Section::Parameter, (file, layer), |parameter: &TaskParameter| parameter.name.text.clone(), statement)
        }
        S::Observe(Block { keyword, entries, span }) => {
            let statement = |entries| S::Observe(Block { keyword, entries, span });
            rows(entries, Section::Channel, (file, layer), |channel: &Channel| label_of(channel, file, texts), statement)
        }
        S::Critic(Block { keyword, entries, span }) => {
            let statement = |entries| S::Critic(Block { keyword, entries, span });
            rows(entries, Section::Critic, (file, layer), |channel: &Channel| label_of(channel, file, texts), statement)
        }
        S::Metrics(Block { keyword, entries, span }) => {
            let statement = |entries| S::Metrics(Block { keyword, entries, span });
            rows(entries, Section::Metric, (file, layer), |channel: &Channel| label_of(channel, file, texts), statement)
        }
        S::Reward(Reward { per_second, terms, span }) => {
            let statement = |terms| S::Reward(Reward { per_second, terms, span });
            rows(terms, Section::Term, (file, layer), |term: &Term| term.name.text.clone(), statement)
        }
        S::Terminate(Ends { after, reasons, span }) => {
            let statement = |reasons| S::Terminate(Ends { after: after.clone(), reasons, span });
            rows(reasons, Section::Reason, (file, layer), |reason| reason.name.text.clone(), statement)
        }
        S::Finish(Ends { after, reasons, span }) => {
            let statement = |reasons| S::Finish(Ends { after: after.clone(), reasons, span });
            rows(reasons, Section::Reason, (file, layer), |reason| reason.name.text.clone(), statement)
        }
        statement @ S::Family(_) => single("family", statement),
        statement @ S::Body(_) => single("body", statement),
        statement @ S::Control(_) => single("control", statement),
        statement @ S::Horizon(_) => single("horizon", statement),
        statement @ S::Act(_) => single("act", statement),
        statement @ S::Symmetric(_) => single("symmetric", statement),
        statement @ S::Scene(_) => vec![row(Section::Layered("scene"), "", statement)],
        statement @ S::Init(_) => vec![row(Section::Layered("init"), "", statement)],
        statement @ S::Success(_) => single("success", statement),
        statement => {
            let name = match &statement {
                S::Let(binding) => &binding.name.text,
                S::State(state) => &state.name.text,
                S::Clock(clock) => &clock.name.text,
                S::Random(random) => &random.name.text,
                S::Reference(reference) => &reference.name.text,
                _ => return vec![row(Section::Loose, "", statement)],
            };
            let name = name.clone();
            vec![row(Section::Value, &name, statement)]
        }
    }
}

/// The rows of a list; what is allowed stays with the row below it.
fn rows<T>(
    entries: Vec<Entry<T>>,
    section: Section,
    (file, layer): (FileId, usize),
    name: impl Fn(&T) -> String,
    statement: impl Fn(Vec<Entry<T>>) -> TaskStatement,
) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut allowed = Vec::new();
    for entry in entries {
        match entry {
            Entry::Allow(_) => allowed.push(entry),
            Entry::Remove(remove) => changes.push(Change::Remove(section, remove, file)),
            Entry::Item(ref item) => {
                let name = name(item);
                let mut whole = std::mem::take(&mut allowed);
                whole.push(entry);
                changes.push(Change::Row(Box::new(Row {
                    section,
                    name,
                    placed: Placed { statement: statement(whole), file, layer, allowed: Vec::new() },
                })));
            }
        }
    }
    changes
}

/// Rows under their section and name.
type Rows = Layers<(Section, String), Row>;

fn names(rows: &Rows, section: Section) -> impl Iterator<Item = &str> + Clone {
    rows.keys().filter(move |((known, _), _)| *known == section).map(|((_, name), _)| name.as_str())
}

/// Puts a row in the place of the one it overrides, or behind all.
fn apply(row: Row, extending: bool, rows: &mut Rows, diagnostics: &mut Vec<Diagnostic>) -> Checked<()> {
    let replaces = extending && !matches!(row.section, Section::Loose | Section::Layered(_));
    let key = (row.section, row.name.clone());
    match rows.first(&key).filter(|_| replaces) {
        Some(known) => override_row(known, row, diagnostics),
        None => {
            if extending
                && let Some(term) = term_of(&row.placed.statement)
                && term.formula.is_none()
            {
                let (name, span) = (&term.name.text, term.name.span);
                let names = names(rows, Section::Term);
                let diagnostic = overrides_nothing(lacks("term", name), name, row.placed.file, span, names);
                return Err(diagnostic.report(diagnostics));
            }
            rows.add(key, row.placed.layer, row);
            Ok(())
        }
    }
}

fn override_row(known: &mut Row, row: Row, diagnostics: &mut Vec<Diagnostic>) -> Checked<()> {
    let file = row.placed.file;
    if let (Some(old), Some(new)) = (term_of(&known.placed.statement), term_of(&row.placed.statement)) {
        match (&new.weight, &new.formula) {
            (Some(weight), None) => {
                let weight = narrowed(weight, old, file, diagnostics)?;
                set_weight(&mut known.placed.statement, weight);
                known.placed.allowed.extend(allowed(&row.placed));
                return Ok(());
            }
            (None, Some(_)) => {
                let weight = old.weight.clone();
                *known = row;
                if let Some(weight) = weight {
                    set_weight(&mut known.placed.statement, weight);
                }
                return Ok(());
            }
            _ => {}
        }
    }
    if let (Some(old), Some(new)) = (parameter_of(&known.placed.statement), parameter_of(&row.placed.statement))
        && new.annotation.is_none()
        && new.range.is_none()
    {
        // Another value alone: type and range stay, and are looked up where they were written.
        let mut parameter = old.clone();
        parameter.set.push((new.value.clone(), file));
        set_parameter(&mut known.placed.statement, parameter);
        known.placed.allowed.extend(allowed(&row.placed));
        return Ok(());
    }
    *known = row;
    Ok(())
}

/// What stands as allowed above the only line of a row.
fn allowed(row: &Placed) -> Vec<AllowedAbove> {
    fn of<T>(entries: &[Entry<T>], file: FileId, line: Option<Span>) -> Vec<AllowedAbove> {
        let line = line.unwrap_or_default();
        let above = |entry: &Entry<T>| match entry {
            Entry::Allow(allow) => Some(AllowedAbove { allow: allow.clone(), file, line }),
            _ => None,
        };
        entries.iter().filter_map(above).collect()
    }
    match &row.statement {
        TaskStatement::Reward(reward) => of(&reward.terms, row.file, term_of(&row.statement).map(|term| term.span)),
        TaskStatement::Params(block) => {
            of(&block.entries, row.file, parameter_of(&row.statement).map(|parameter| parameter.span))
        }
        _ => Vec::new(),
    }
}

/// The new weight of a term whose range stays unless another is written with it.
fn narrowed(weight: &Weight, old: &Term, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Checked<Weight> {
    let mut new = weight.clone();
    if let (Bounds::Free, Some(old)) = (&weight.bounds, &old.weight) {
        let first = weight.schedule.as_ref().map(|schedule| (schedule.from, schedule.from_span));
        let outside = |low: f64, high: f64| {
            let mut numbers = first.into_iter().chain([(weight.value, weight.span)]);
            numbers.find(|(number, _)| !(low..=high).contains(number))
        };
        if let Bounds::Range { low, high, .. } = old.bounds
            && let Some((number, at)) = outside(low, high)
        {
            let shown = distinguished(&[low, high, number]);
            let diagnostic = Diagnostic::new(codes::tasks::WEIGHT, file, at, "this weight is outside of the range of the term")
                .expected(format!("{} .. {}", shown[0], shown[1]))
                .found(&*shown[2])
                .help("a new range can be given after the weight: `40 (5..50) name`");
            return Err(diagnostic.report(diagnostics));
        }
        new.bounds = old.bounds.clone();
    }
    Ok(new)
}

fn term_of(statement: &TaskStatement) -> Option<&Term> {
    let TaskStatement::Reward(reward) = statement else { return None };
    reward.terms.iter().find_map(|entry| if let Entry::Item(term) = entry { Some(term) } else { None })
}

fn set_weight(statement: &mut TaskStatement, weight: Weight) {
    if let TaskStatement::Reward(reward) = statement
        && let Some(Entry::Item(term)) = reward.terms.last_mut()
    {
        term.weight = Some(weight);
    }
}

fn parameter_of(statement: &TaskStatement) -> Option<&TaskParameter> {
    let TaskStatement::Params(block) = statement else { return None };
    block.entries.iter().find_map(|entry| if let Entry::Item(parameter) = entry { Some(parameter) } else { None })
}

fn set_parameter(statement: &mut TaskStatement, parameter: TaskParameter) {
    if let TaskStatement::Params(block) = statement
        && let Some(Entry::Item(known)) = block.entries.last_mut()
    {
        *known = parameter;
    }
}

fn take_out(section: Section, remove: &Remove, file: FileId, rows: &mut Rows, diagnostics: &mut Vec<Diagnostic>) -> Checked<()> {
    if rows.take_out(&(section, remove.name.text.clone())) {
        return Ok(());
    }
    let names = names(rows, section);
    let name = &remove.name.text;
    Err(overrides_nothing(lacks(section.word(), name), name, file, remove.name.span, names).report(diagnostics))
}

fn lacks(word: &str, name: &str) -> String {
    format!("the base task has no {word} `{name}`")
}

/// Reports that a name is overridden or removed which is not there; `names` are those that are.
pub(crate) fn overrides_nothing<'a>(
    message: String,
    name: &str,
    file: FileId,
    span: Span,
    names: impl Iterator<Item = &'a str> + Clone,
) -> Diagnostic {
    let mut diagnostic = Diagnostic::new(codes::composition::OVERRIDES_NOTHING, file, span, message);
    let near = nearest(name, names.clone());
    let known: Vec<&str> = names.collect();
    if near.is_empty() && !known.is_empty() {
        diagnostic = diagnostic.help(format!("it has {}", known.join(", ")));
    }
    for name in near {
        diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), span, name);
    }
    diagnostic
}
