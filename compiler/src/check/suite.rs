//! Suites: families of tasks and protocols.

use super::constant;
use crate::diagnostics::nearest;
use crate::diagnostics::{Diagnostic, FileId, codes};
use crate::syntax::tree::{self, FieldValue};

/// Families of tasks and the protocols by which policies are compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Suite {
    /// Its name.
    pub name: String,
    /// Families with the names of their tasks.
    pub families: Vec<(String, Vec<String>)>,
    /// The ways to evaluate it; the first is the default.
    pub protocols: Vec<Protocol>,
}

/// A protocol of a suite: how many episodes, from which seed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Protocol {
    /// Its name; empty if it has none.
    pub name: String,
    /// Episodes per task.
    pub episodes: u32,
    /// Seed of the first episode.
    pub seed: u64,
}

impl Default for Protocol {
    fn default() -> Self {
        Self { name: String::new(), episodes: 50, seed: 0 }
    }
}

/// Checks a suite against the names of all tasks in sight, which are sorted.
pub(crate) fn check(suite: &tree::Suite, file: FileId, tasks: &[&str], diagnostics: &mut Vec<Diagnostic>) -> Suite {
    let mut checked = Suite { name: suite.name.text.clone(), families: Vec::new(), protocols: Vec::new() };
    let mut empty = |what: &str, name: &tree::Ident| {
        let diagnostic =
            Diagnostic::new(codes::tasks::MISSING, file, name.span, format!("the {what} `{}` lists no task", name.text));
        diagnostics.push(diagnostic.help("write `family stabilization { stand, walk }`"));
    };
    if suite.families.is_empty() {
        empty("suite", &suite.name);
    }
    suite.families.iter().filter(|family| family.tasks.is_empty()).for_each(|family| empty("family", &family.name));
    for family in &suite.families {
        let mut members = Vec::new();
        for task in &family.tasks {
            if tasks.binary_search(&task.text.as_str()).is_err() {
                let near = nearest(&task.text, tasks.iter().copied());
                let message = format!("undefined task `{}`", task.text);
                let mut diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, file, task.span, message);
                if near.is_empty() {
                    diagnostic = diagnostic.help("import it with `use \"...\"`");
                }
                for name in near {
                    diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), task.span, name);
                }
                diagnostics.push(diagnostic);
            }
            members.push(task.text.clone());
        }
        checked.families.push((family.name.text.clone(), members));
    }
    for protocol in &suite.protocols {
        let repeated = |name: &tree::Ident| checked.protocols.iter().any(|before| before.name == name.text);
        if let Some(name) = protocol.name.as_ref().filter(|name| repeated(name)) {
            let message = format!("the protocol `{}` is declared twice", name.text);
            diagnostics.push(Diagnostic::new(codes::tasks::REPEATED, file, name.span, message));
        }
        checked.protocols.push(self::protocol(protocol, file, diagnostics));
    }
    checked
}

/// Checks the settings of a protocol.
fn protocol(protocol: &tree::Protocol, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Protocol {
    let name = protocol.name.as_ref().map(|name| name.text.clone()).unwrap_or_default();
    let mut checked = Protocol { name, ..Protocol::default() };
    let unknown = |name: &str, span| {
        Diagnostic::new(codes::tasks::UNKNOWN_SETTING, file, span, format!("a protocol has no `{name}`"))
            .help("it takes `episodes 50` and `seed 0`")
    };
    let mut seen: Vec<&str> = Vec::new();
    for field in &protocol.settings.fields {
        let name = field.name.text.as_str();
        if seen.contains(&name) {
            let message = format!("`{name}` is given twice");
            diagnostics.push(Diagnostic::new(codes::tasks::REPEATED, file, field.span, message));
        }
        seen.push(name);
        match (name, &field.value) {
            ("episodes" | "seed", FieldValue::Value(value)) => match constant::whole(value) {
                Ok(number) if name == "seed" => checked.seed = number,
                Ok(number @ 1..=1_000_000) => checked.episodes = number as u32,
                Ok(_) => {
                    let message = "between one and a million episodes";
                    diagnostics.push(Diagnostic::new(codes::tasks::OUT_OF_RANGE, file, value.span, message));
                }
                Err(wrong) => {
                    diagnostics.push(Diagnostic::new(wrong.code, file, wrong.span, wrong.message));
                }
            },
            _ => diagnostics.push(unknown(name, field.span)),
        }
    }
    diagnostics.extend(protocol.settings.parts.iter().map(|part| unknown(&part.kind.text, part.span)));
    checked
}
