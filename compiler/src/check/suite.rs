//! Suites: families of tasks and the protocol.

use super::constant;
use crate::compile::{Protocol, Suite};
use crate::diagnostics::nearest;
use crate::diagnostics::{Diagnostic, FileId, codes};
use crate::syntax::tree::{self, FieldValue};

/// Checks a suite against the names of all tasks in sight.
pub(crate) fn check(suite: &tree::Suite, file: FileId, tasks: &[&str], diagnostics: &mut Vec<Diagnostic>) -> Suite {
    let mut checked = Suite { name: suite.name.text.clone(), families: Vec::new(), protocol: Protocol::default() };
    let mut empty = |what: &str, name: &tree::Ident| {
        let diagnostic =
            Diagnostic::new(codes::tasks::MISSING, file, name.span, format!("the {what} `{}` names no task", name.text));
        diagnostics.push(diagnostic.help("write `family stabilization { stand, walk }`"));
    };
    if suite.families.is_empty() {
        empty("suite", &suite.name);
    }
    suite.families.iter().filter(|family| family.tasks.is_empty()).for_each(|family| empty("family", &family.name));
    for family in &suite.families {
        let mut members = Vec::new();
        for task in &family.tasks {
            if !tasks.contains(&task.text.as_str()) {
                let near = nearest(&task.text, tasks.iter().copied());
                let message = format!("there is no task `{}` in sight", task.text);
                let mut diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, file, task.span, message);
                if near.is_empty() {
                    diagnostic = diagnostic.help("bring it in with `use \"...\"`");
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
    for field in suite.protocol.iter().flat_map(|protocol| &protocol.fields) {
        match (field.name.text.as_str(), &field.value) {
            ("episodes" | "seed", FieldValue::Value(value)) => match constant::whole(value) {
                Ok(number) if field.name.text == "seed" => checked.protocol.seed = number,
                Ok(number @ 1..=1_000_000) => checked.protocol.episodes = number as u32,
                Ok(_) => {
                    let message = "between one and a million episodes";
                    diagnostics.push(Diagnostic::new(codes::tasks::OUT_OF_RANGE, file, value.span, message));
                }
                Err(wrong) => {
                    diagnostics.push(Diagnostic::new(wrong.code, file, wrong.span, wrong.message));
                }
            },
            (name, _) => {
                let message = format!("a protocol has no `{name}` yet");
                let diagnostic = Diagnostic::new(codes::tasks::UNKNOWN_SETTING, file, field.span, message);
                diagnostics.push(diagnostic.help("it takes `episodes 50` and `seed 0`"));
            }
        }
    }
    checked
}
