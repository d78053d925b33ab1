//! What may be written next.
//!
//! 1. `place` tells from the text before the cursor what is being written: it need not be readable as a whole;
//! 2. what follows a dot is asked of the compiler, with the unfinished word replaced by one that can be read;
//! 3. words come from the tables of the language, the vocabulary of the body and what is declared in sight.

mod place;
mod words;

use crate::positions::{Encoding, Lines};
use crate::workspace::{Workspace, file_of};
use lsp_types::{CompletionItem, CompletionItemKind, CompletionTextEdit, Documentation, TextEdit};
use msk_compiler::check::action::spaces;
use msk_compiler::check::functions;
use msk_compiler::check::scene::elements;
use msk_compiler::compile::Inspection;
use msk_compiler::diagnostics::{FileId, Span};
use msk_compiler::hir::Members;
use msk_compiler::quantity::unit;
use msk_compiler::resolve::index::Space;
use msk_compiler::signals::{self, Owner};
use msk_compiler::syntax::parse;
use msk_compiler::vocabulary::{GroupKind, JointKind, Vocabulary};
use place::{Place, Wanted};
use std::path::Path;
use std::sync::Arc;

/// A word that no text uses.
const PROBE: &str = "unfinished_word";

/// A proposal before it is put into the text.
struct Proposal {
    label: String,
    kind: CompletionItemKind,
    detail: String,
    docs: String,
}

fn proposal(label: &str, kind: CompletionItemKind, detail: impl Into<String>, docs: impl Into<String>) -> Proposal {
    Proposal { label: label.to_owned(), kind, detail: detail.into(), docs: docs.into() }
}

/// What may be written at a byte of a file.
pub fn complete(workspace: &Workspace<'_>, path: &Path, byte: usize, encoding: Encoding) -> Vec<CompletionItem> {
    let Some(text) = workspace.text(path) else { return Vec::new() };
    let parsed = parse(FileId::default(), &text);
    let in_comment = |span: Span| (span.start as usize) < byte && byte <= span.end as usize;
    if parsed.comments.iter().any(|comment| in_comment(comment.span)) {
        return Vec::new();
    }
    let Some(place) = place::place(&text, byte) else { return Vec::new() };
    let proposals = match &place.wanted {
        Wanted::Member => members(workspace, path, &text, &place),
        Wanted::Unit => units(),
        Wanted::Words(table) => table.iter().map(|(word, docs)| proposal(word, CompletionItemKind::KEYWORD, "", *docs)).collect(),
        Wanted::Elements => kinds(),
        Wanted::Fields(kind) => fields(kind),
        Wanted::Joints => joints(&vocabulary(workspace, path, byte)),
        Wanted::Poses => poses(&vocabulary(workspace, path, byte)),
        Wanted::Lints => {
            let lints = msk_compiler::diagnostics::lints().filter(|(_, lint)| lint.allowable());
            lints.map(|(code, lint)| proposal(lint.name, CompletionItemKind::CONSTANT, code.title, "")).collect()
        }
        Wanted::Declared(space) => declared(workspace, path, byte, |known| known == *space),
        Wanted::ActionSpaces => action_spaces(),
        Wanted::Settings(space) => settings(space),
        Wanted::Frames => frames(&vocabulary(workspace, path, byte)),
        Wanted::Formula => formula(workspace, path, byte),
    };
    let lines = Lines::new(&text, encoding);
    let range = lines.range(Span::new(place.word.start, place.word.end));
    let item = |proposal: Proposal| CompletionItem {
        text_edit: Some(CompletionTextEdit::Edit(TextEdit { range, new_text: proposal.label.clone() })),
        label: proposal.label,
        kind: Some(proposal.kind),
        detail: (!proposal.detail.is_empty()).then_some(proposal.detail),
        documentation: (!proposal.docs.is_empty()).then_some(Documentation::String(proposal.docs)),
        ..CompletionItem::default()
    };
    proposals.into_iter().map(item).collect()
}

/// What may follow the dot before the word.
fn members(workspace: &Workspace<'_>, path: &Path, text: &str, place: &Place) -> Vec<Proposal> {
    let assumed = format!("{}{PROBE}{}", &text[..place.word.start], &text[place.word.end..]);
    let whole = workspace.inspect_assuming(path, assumed);
    let dot = place.word.start - 1;
    match member_at(&whole, path, dot) {
        Some(Members::Signals { owners, parts }) => {
            let rows = owners.iter().flat_map(|owner| signals::of(*owner)).filter(|row| row.supported && !row.name.contains('('));
            let mut found: Vec<Proposal> =
                parts.iter().map(|part| proposal(part, CompletionItemKind::MODULE, "a part of the object", "")).collect();
            found.extend(rows.map(|row| proposal(row.name, CompletionItemKind::FIELD, row.kind, row.description)));
            found
        }
        Some(Members::Words(words)) => {
            words.iter().map(|word| proposal(word, CompletionItemKind::FIELD, "a component", "")).collect()
        }
        Some(Members::None) => Vec::new(),
        None => by_name(&vocabulary(workspace, path, dot), before_dot(text, dot)),
    }
}

/// What may follow the formula that ends at `dot`, from the typed HIR.
fn member_at(whole: &Inspection, path: &Path, dot: usize) -> Option<Members> {
    let file = file_of(whole, path)?;
    let typed = whole.scopes.iter().flat_map(|scope| scope.typed.iter().map(|typed| typed.members(&scope.vocabulary, file, dot)));
    typed.flatten().max_by_key(|(span, _)| span.end - span.start).map(|(_, members)| members)
}

/// The name that ends at `dot`.
fn before_dot(text: &str, dot: usize) -> &str {
    let before = &text[..dot];
    let start = before.rfind(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).map_or(0, |at| at + 1);
    &before[start..]
}

/// Signals of a name where the text around it cannot be read.
fn by_name(vocabulary: &Vocabulary, name: &str) -> Vec<Proposal> {
    let owners: &[Owner] = if let Some(landmark) = vocabulary.landmarks.iter().find(|known| known.name == name) {
        if landmark.of_scene { &[Owner::Object, Owner::Landmark] } else { &[Owner::Landmark] }
    } else if vocabulary.joints.iter().any(|known| known.name == name) {
        &[Owner::Joint]
    } else if vocabulary.muscles.iter().any(|known| known.name == name) {
        &[Owner::Muscle]
    } else if name == "com" {
        &[Owner::CentreOfMass]
    } else {
        &[]
    };
    let rows = owners.iter().flat_map(|owner| signals::of(*owner)).filter(|row| row.supported && !row.name.contains('('));
    rows.map(|row| proposal(row.name, CompletionItemKind::FIELD, row.kind, row.description)).collect()
}

/// What exists on the body of the task around a byte, or of any other.
fn vocabulary(workspace: &Workspace<'_>, path: &Path, byte: usize) -> Arc<Vocabulary> {
    let whole = workspace.inspect(path);
    let file = file_of(&whole, path);
    let own = whole.scopes.iter().filter(|scope| Some(scope.file) == file && scope.span.start as usize <= byte);
    let near = own.max_by_key(|scope| scope.span.start).or(whole.scopes.first());
    near.map(|scope| scope.vocabulary.clone()).or_else(|| workspace.some_vocabulary().map(Arc::new)).unwrap_or_default()
}

fn units() -> Vec<Proposal> {
    let rows = unit::UNITS.iter().map(|unit| proposal(unit.name, CompletionItemKind::UNIT, unit.description, ""));
    rows.chain([proposal("steps", CompletionItemKind::UNIT, "control steps", "")]).collect()
}

fn kinds() -> Vec<Proposal> {
    let rows = elements::KINDS.iter().map(|kind| proposal(kind.name, CompletionItemKind::CLASS, "element", kind.description));
    rows.chain(words::SCENE.iter().map(|(word, docs)| proposal(word, CompletionItemKind::KEYWORD, "", *docs))).collect()
}

fn fields(kind: &str) -> Vec<Proposal> {
    let all = elements::KINDS.iter().chain(elements::JOINTS);
    let known: Vec<&str> =
        all.filter(|row| row.name == kind).flat_map(|row| row.required.iter().chain(row.optional)).copied().collect();
    let rows = elements::FIELDS.iter().filter(|field| known.contains(&field.name));
    let fields = rows.map(|field| proposal(field.name, CompletionItemKind::FIELD, field.form, field.description));
    let parts =
        elements::KINDS.iter().chain(elements::JOINTS).filter(|row| row.name != "ground" && kind != "hinge" && kind != "slide");
    fields.chain(parts.map(|row| proposal(row.name, CompletionItemKind::CLASS, "a part", row.description))).collect()
}

fn action_spaces() -> Vec<Proposal> {
    spaces::SPACES
        .iter()
        .map(|space| proposal(space.name, CompletionItemKind::CLASS, "action space", space.description))
        .collect()
}

/// The settings of an action space.
fn settings(space: &str) -> Vec<Proposal> {
    let known: Vec<&str> = spaces::SPACES.iter().filter(|row| row.name == space).flat_map(spaces::Space::settings).collect();
    let rows = spaces::SETTINGS.iter().filter(|setting| known.contains(&setting.name));
    rows.map(|setting| proposal(setting.name, CompletionItemKind::FIELD, setting.form, setting.description)).collect()
}

/// Whether a name can be written without quotes.
fn plain(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_lowercase() || c == '_')
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

fn joints(vocabulary: &Vocabulary) -> Vec<Proposal> {
    let joint = |joint: &msk_compiler::vocabulary::Joint| {
        let (factor, unit) = match joint.kind {
            JointKind::Hinge => (180.0 / std::f64::consts::PI, "deg"),
            JointKind::Slide => (1.0, "m"),
        };
        let range = joint
            .range
            .map_or("unlimited".to_owned(), |[low, high]| format!("{:.1} .. {:.1} {unit}", low * factor, high * factor));
        proposal(&joint.name, CompletionItemKind::VARIABLE, range, "")
    };
    vocabulary.joints.iter().filter(|known| plain(&known.name)).map(joint).collect()
}

fn poses(vocabulary: &Vocabulary) -> Vec<Proposal> {
    vocabulary.poses.iter().map(|pose| proposal(&pose.name, CompletionItemKind::VALUE, "a pose", "")).collect()
}

fn frames(vocabulary: &Vocabulary) -> Vec<Proposal> {
    let landmarks = vocabulary.landmarks.iter().filter(|landmark| plain(&landmark.name));
    let own = landmarks
        .map(|landmark| proposal(&landmark.name, CompletionItemKind::VARIABLE, "frame of a landmark", &landmark.description));
    let rest = [
        proposal("world", CompletionItemKind::KEYWORD, "world axes", ""),
        proposal("heading", CompletionItemKind::FUNCTION, "heading(landmark)", "the yaw of a landmark only"),
    ];
    own.chain(rest).collect()
}

/// Declared names of some spaces.
fn declared(workspace: &Workspace<'_>, path: &Path, byte: usize, wanted: impl Fn(Space) -> bool) -> Vec<Proposal> {
    let index = workspace.index();
    let Some(file) = index.file(path) else { return Vec::new() };
    let kind = |what: &str| match what {
        "fn" => CompletionItemKind::FUNCTION,
        "const" | "parameter" => CompletionItemKind::CONSTANT,
        "task" | "sequence" => CompletionItemKind::CLASS,
        "object" => CompletionItemKind::MODULE,
        _ => CompletionItemKind::VARIABLE,
    };
    let symbols = index.in_sight(file, byte);
    let symbols = symbols.iter().filter(|symbol| wanted(symbol.space) && plain(&symbol.name));
    symbols.map(|symbol| proposal(&symbol.name, kind(symbol.what), symbol.what, &symbol.docs)).collect()
}

/// Everything that a formula may begin with.
fn formula(workspace: &Workspace<'_>, path: &Path, byte: usize) -> Vec<Proposal> {
    let mut found = declared(workspace, path, byte, |space| space == Space::Value);
    let vocabulary = vocabulary(workspace, path, byte);
    let landmarks = vocabulary.landmarks.iter().filter(|landmark| plain(&landmark.name));
    found.extend(landmarks.map(|landmark| {
        let what = if landmark.of_scene { "an object" } else { "a landmark" };
        proposal(&landmark.name, CompletionItemKind::VARIABLE, what, &landmark.description)
    }));
    found.extend(joints(&vocabulary).into_iter().map(|joint| Proposal { detail: format!("a joint, {}", joint.detail), ..joint }));
    found.extend(vocabulary.groups.iter().filter(|group| plain(&group.name)).map(|group| {
        let what = match group.kind {
            GroupKind::Joints => "joints",
            GroupKind::Muscles => "muscles",
            GroupKind::Landmarks => "landmarks",
        };
        proposal(&group.name, CompletionItemKind::ENUM, format!("a group of {} {what}", group.members.len()), "")
    }));
    let muscles = vocabulary.muscles.iter().filter(|muscle| plain(&muscle.name));
    found.extend(muscles.map(|muscle| proposal(&muscle.name, CompletionItemKind::VARIABLE, "a muscle", &muscle.family)));
    found.extend(words::SETS.iter().map(|(word, docs)| proposal(word, CompletionItemKind::ENUM, "", *docs)));
    let own = [Owner::Time, Owner::WholeBody].into_iter().flat_map(signals::of).filter(|row| row.supported);
    found.extend(own.map(|row| proposal(row.name, CompletionItemKind::FIELD, row.kind, row.description)));
    let functions = functions::FUNCTIONS.iter().chain(functions::OPERATORS);
    found.extend(functions.map(|f| proposal(f.name, CompletionItemKind::FUNCTION, f.signature, f.description)));
    found.extend(words::FORMULA.iter().map(|(word, docs)| proposal(word, CompletionItemKind::KEYWORD, "", *docs)));
    let mut seen = std::collections::BTreeSet::new();
    found.retain(|one| seen.insert(one.label.clone()));
    found
}
