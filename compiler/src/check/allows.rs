//! `allow LINT "REASON"`: collected from the statements of a task, each with what it covers.
//!
//! Above a line of a list (a term, a channel, a reason, a parameter) it covers that line; as a statement of the task, its scene or
//! its `init`, the whole task.

use crate::diagnostics::{Allowance, Diagnostic, FileId, Scope, Span, codes, find_lint, lints};
use crate::resolve::inherit::Placed;
use crate::syntax::tree::walk::items;
use crate::syntax::tree::{Allow, Entry, InitStatement, SceneStatement, TaskStatement};

/// Every `allow` of a task and of what it inherits; one that names no lint is an error, or the next slip would go unseen.
pub(crate) fn of_task(statements: &[Placed], diagnostics: &mut Vec<Diagnostic>) -> Vec<Allowance> {
    let mut collector = Collector { found: Vec::new(), diagnostics };
    for placed in statements {
        collector.statement(&placed.statement, placed.file);
        collector.overriding(placed);
    }
    collector.found
}

/// An `allow` of a library, for the whole of the task that uses it.
pub(super) fn of_library(allow: &Allow, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Option<Allowance> {
    allowance(allow, file, Scope::Task, diagnostics)
}

struct Collector<'d> {
    found: Vec<Allowance>,
    diagnostics: &'d mut Vec<Diagnostic>,
}

impl Collector<'_> {
    fn statement(&mut self, statement: &TaskStatement, file: FileId) {
        use TaskStatement as S;
        match statement {
            S::Allow(allow) => self.whole(allow, file),
            S::Scene(block) => self.scene(&block.entries, file),
            S::Init(block) => {
                for entry in &block.entries {
                    if let InitStatement::Allow(allow) = entry {
                        self.whole(allow, file);
                    }
                }
            }
            S::Params(block) => self.lines(&block.entries, file, |parameter| parameter.span),
            S::Observe(block) | S::Critic(block) | S::Metrics(block) => self.lines(&block.entries, file, |channel| channel.span),
            S::Reward(reward) => self.lines(&reward.terms, file, |term| term.span),
            S::Terminate(ends) | S::Finish(ends) => self.lines(&ends.reasons, file, |reason| reason.span),
            _ => {}
        }
    }

    /// What is allowed above an override holds for the row that it overrides.
    fn overriding(&mut self, placed: &Placed) {
        let line = match &placed.statement {
            TaskStatement::Reward(reward) => items(&reward.terms).last().map(|term| term.span),
            TaskStatement::Params(block) => items(&block.entries).last().map(|parameter| parameter.span),
            _ => None,
        };
        for above in &placed.allowed {
            // The weight stands in the line of the override, the formula where it was written first.
            let formula = line.map(|line| (placed.file, line));
            for line in formula.into_iter().chain([(above.file, above.line)]) {
                let scope = Scope::Line(Some(line));
                self.found.extend(allowance(&above.allow, above.file, scope, self.diagnostics));
            }
        }
    }

    fn scene(&mut self, statements: &[SceneStatement], file: FileId) {
        for statement in statements {
            match statement {
                SceneStatement::Allow(allow) => self.whole(allow, file),
                SceneStatement::Repeat(repeat) => self.scene(&repeat.statements, file),
                _ => {}
            }
        }
    }

    fn whole(&mut self, allow: &Allow, file: FileId) {
        self.found.extend(allowance(allow, file, Scope::Task, self.diagnostics));
    }

    /// Each `allow` covers the next line that is none.
    fn lines<T>(&mut self, entries: &[Entry<T>], file: FileId, span: impl Fn(&T) -> Span) {
        for (index, entry) in entries.iter().enumerate() {
            let Entry::Allow(allow) = entry else { continue };
            let below = entries[index..].iter().find(|entry| !matches!(entry, Entry::Allow(_)));
            let line = if let Some(Entry::Item(item)) = below { Some((file, span(item))) } else { None };
            self.found.extend(allowance(allow, file, Scope::Line(line), self.diagnostics));
        }
    }
}

fn allowance(allow: &Allow, file: FileId, scope: Scope, diagnostics: &mut Vec<Diagnostic>) -> Option<Allowance> {
    let (name, span) = (allow.lint.text.as_str(), allow.lint.span);
    let names = || lints().filter(|(_, lint)| lint.allowable()).map(|(_, lint)| lint.name);
    let found = find_lint(name);
    if let Ok((code, lint)) = found
        && lint.name == name
        && lint.allowable()
    {
        return Some(Allowance { code: code.id, place: (file, allow.span), scope, fulfilled: false });
    }
    let diagnostic = |message| Diagnostic::new(codes::tasks::UNKNOWN_SETTING, file, span, message);
    diagnostics.push(match found {
        Ok((_, lint)) if !lint.allowable() => diagnostic(format!("`{}` is a lint of the whole file, not of a task", lint.name))
            .help(format!("fix the cause, or allow the lint on the command line: `msk check --allow {}`", lint.name)),
        Ok((code, lint)) => diagnostic(format!("`allow` takes the name of a lint, not its code `{}`", code.id)).suggest(
            format!("write `{}`", lint.name),
            span,
            lint.name,
        ),
        Err(near) if near.is_empty() => {
            diagnostic(format!("there is no lint `{name}`")).help(format!("there is {}", names().collect::<Vec<_>>().join(", ")))
        }
        Err(near) => near.into_iter().fold(diagnostic(format!("there is no lint `{name}`")), |diagnostic, near| {
            diagnostic.suggest(format!("did you mean `{near}`?"), span, near)
        }),
    });
    None
}
