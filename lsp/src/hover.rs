//! What stands at a place: its type, unit, range and documentation.

use crate::hints::share;
use crate::positions::{Encoding, Lines};
use crate::workspace::Workspace;
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind};
use msk_compiler::check::action::spaces;
use msk_compiler::check::scene::elements;
use msk_compiler::compile::Inspection;
use msk_compiler::diagnostics::{FileId, Span};
use msk_compiler::graph::interval::Bounds;
use msk_compiler::hir::Description;
use msk_compiler::numbers::for_people;
use msk_compiler::quantity::unit;
use std::path::Path;

/// The hover text at a byte of a file.
pub fn hover(workspace: &Workspace<'_>, path: &Path, byte: usize, encoding: Encoding) -> Option<Hover> {
    let text = workspace.text(path)?;
    let inspections = workspace.inspections_of(path);
    let typed = inspections.iter().find_map(|(file, whole)| typed(whole, *file, byte));
    let (span, markdown) = unit(&text, byte)
        .or(typed)
        .or_else(|| inspections.iter().find_map(|(file, whole)| term(whole, *file, path, byte)))
        .or_else(|| named(workspace, path, byte))
        .or_else(|| word(&text, byte))?;
    let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value: markdown });
    Some(Hover { contents, range: Some(Lines::new(&text, encoding).range(span)) })
}

fn holds(span: Span, byte: usize) -> bool {
    span.start as usize <= byte && byte <= span.end as usize
}

/// From the typed HIR: the smallest name or formula around, and what is known of it as the last word of a larger one.
fn typed(whole: &Inspection, file: FileId, byte: usize) -> Option<(Span, String)> {
    let known = whole.scopes.iter().flat_map(|scope| scope.typed.iter().map(|typed| typed.at(&scope.vocabulary, file, byte)));
    let size = |found: &(Description, _)| found.0.span.end - found.0.span.start;
    let (smallest, around) = known.flatten().min_by_key(size)?;
    if smallest.kind.is_empty() && smallest.docs.is_empty() {
        return None;
    }
    let around = around.filter(|_| smallest.range.is_none() && smallest.kind.starts_with('`'));
    let source = whole.report.sources.text(file);
    let mut markdown = String::new();
    for found in [Some(&smallest), around.as_ref()].into_iter().flatten().filter(|found| !found.kind.is_empty()) {
        let written = found.span.of(source).lines().next().unwrap_or_default();
        let head = if found.kind.starts_with('`') { found.kind.clone() } else { format!("`{written}`: {}", found.kind) };
        markdown += &format!("{head}\n\n");
        if let Some(range) = found.range {
            markdown += &format!("Stays within {}.\n\n", within(range));
        }
    }
    for found in [Some(&smallest), around.as_ref()].into_iter().flatten().filter(|found| !found.docs.is_empty()) {
        markdown += &format!("{}\n\n", found.docs);
    }
    Some((smallest.span, markdown.trim_end().to_owned())).filter(|(_, markdown)| !markdown.is_empty())
}

/// Bounds in words.
fn within(range: Bounds) -> String {
    match (range.low.is_finite(), range.high.is_finite()) {
        (true, true) if range.low == range.high => format!("the constant {}", for_people(range.low)),
        (true, true) => format!("{} .. {} (SI)", for_people(range.low), for_people(range.high)),
        (true, false) => format!("{} and above (SI)", for_people(range.low)),
        _ => format!("{} and below (SI)", for_people(range.high)),
    }
}

/// The name of a term: its weight and share.
fn term(whole: &Inspection, file: FileId, path: &Path, byte: usize) -> Option<(Span, String)> {
    use msk_compiler::syntax::tree::{Item, TaskStatement, walk};
    let tree = &whole.files.iter().find(|known| known.path == path)?.tree;
    debug_assert_eq!(tree.file, file);
    for item in &tree.items {
        let Item::Task(task) = item else { continue };
        for statement in &task.statements {
            let TaskStatement::Reward(reward) = statement else { continue };
            let Some(found) = walk::items(&reward.terms).find(|term| holds(term.name.span, byte)) else { continue };
            let compiled = whole.tasks.iter().find(|known| known.name == task.name.text)?;
            let total: f64 = compiled.terms.iter().map(|term| term.weight.abs()).sum();
            let term = compiled.terms.iter().find(|term| term.name == found.name.text)?;
            let docs = found.docs.as_ref().map_or("", |docs| docs.text.as_str());
            let share = share(term.weight.abs() / total);
            let per = if reward.per_second { "per second" } else { "per control step" };
            let training = term.schedule.map_or_else(String::new, |schedule| format!(", in a training {schedule}"));
            let markdown = format!(
                "`{}`: a term of the reward\n\nWeight {}, {share} of all, {per}{training}.\n\n{docs}",
                term.name, term.weight
            );
            return Some((found.name.span, markdown.trim_end().to_owned()));
        }
    }
    None
}

/// What a text declares, where the checker knows nothing.
fn named(workspace: &Workspace<'_>, path: &Path, byte: usize) -> Option<(Span, String)> {
    let index = workspace.index();
    let here = index.at(index.file(path)?, byte)?;
    let symbol = &index.symbols[here.symbol];
    let markdown = format!("`{}`: {}\n\n{}", symbol.name, symbol.what, symbol.docs);
    Some((here.span, markdown.trim_end().to_owned()))
}

/// The word at a byte, with what stands before it.
fn word_at(text: &str, byte: usize) -> Option<(Span, &str, &str)> {
    let inside = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '%';
    let start = text.get(..byte)?.rfind(|c| !inside(c)).map_or(0, |at| at + text[at..].chars().next().map_or(1, char::len_utf8));
    let end = text.get(byte..)?.find(|c| !inside(c)).map_or(text.len(), |at| byte + at);
    Some((Span::new(start, end), text.get(start..end)?, text.get(..start)?))
}

/// A unit stands behind a number or behind another unit.
fn unit(text: &str, byte: usize) -> Option<(Span, String)> {
    let (span, word, before) = word_at(text, byte)?;
    let found = unit::find(word)?;
    let last = before.chars().next_back()?;
    let number = last == ' ' && before.trim_end_matches(' ').ends_with(|c: char| c.is_ascii_digit());
    let markdown = || format!("`{}`: {}, {}", found.name, found.description, found.dimension.described());
    (number || matches!(last, '*' | '/' | '(')).then(|| (span, markdown()))
}

/// Elements and their fields: words of the language that stand for something.
fn word(text: &str, byte: usize) -> Option<(Span, String)> {
    let (span, word, _) = word_at(text, byte)?;
    let kind = elements::KINDS.iter().chain(elements::JOINTS).find(|kind| kind.name == word);
    let field = elements::FIELDS.iter().find(|field| field.name == word);
    let space = spaces::SPACES.iter().find(|space| space.name == word);
    let setting = spaces::SETTINGS.iter().find(|setting| setting.name == word);
    let markdown = match (kind, field) {
        (Some(kind), _) => {
            let (required, optional) = (kind.required.join(" "), kind.optional.join(" "));
            format!("`{}`: {}\n\nRequired: {required}. Optional: {optional}.", kind.name, kind.description)
        }
        (_, Some(field)) => format!("`{}`\n\n{}", field.form, field.description),
        _ => match (space, setting) {
            (Some(space), _) => format!("`act {}`: {}", space.name, space.description),
            (_, Some(setting)) => format!("`{}`\n\n{}", setting.form, setting.description),
            _ => return None,
        },
    };
    Some((span, markdown))
}
