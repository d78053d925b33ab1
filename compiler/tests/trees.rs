//! The syntax tree of the real files, as it is handed to the checker.

use msk_compiler::diagnostics::FileId;
use msk_compiler::syntax::tree::{Bounds, Comment, CommentKind, File, Item, NamePart, Task, TaskStatement};
use msk_compiler::syntax::{Parsed, parse};

const STAND: &str = include_str!("../../tasks/stabilization/stand.msk");
const POSTURE: &str = include_str!("../../tasks/lib/posture.msk");
const SUITE: &str = include_str!("../../tasks.msk");
const HUMAN: &str = include_str!("../../bodies/human.msk");
const EVERYTHING: &str = include_str!("language/everything.msk");

fn read(text: &str) -> Parsed {
    let parsed = parse(FileId::default(), text);
    assert_eq!(parsed.diagnostics, [], "the file must be right");
    parsed
}

fn task(file: &File) -> &Task {
    file.items.iter().find_map(|item| if let Item::Task(task) = item { Some(task) } else { None }).unwrap()
}

#[test]
fn the_files_of_the_project_are_read_without_a_word() {
    for text in [STAND, POSTURE, SUITE, HUMAN, EVERYTHING] {
        read(text);
    }
}

#[test]
fn the_tree_of_a_small_task() {
    let text = "/// Stands.\ntask t {\n    reward { 15 (5..30) still = exp(-10 s/m * sole_{l,r}.speed) }\n}\n";
    insta::assert_debug_snapshot!(read(text).tree);
}

/// A node on one line, its spans left out.
fn line(node: &impl std::fmt::Debug) -> String {
    let text = format!("{node:?}");
    let (mut kept, mut rest) = (String::new(), text.as_str());
    while let Some(dots) = rest.find("..") {
        let (before, after) = (&rest[..dots], &rest[dots + 2..]);
        let stem = before.trim_end_matches(|digit: char| digit.is_ascii_digit());
        let end = after.find(|digit: char| !digit.is_ascii_digit()).unwrap_or(after.len());
        let is_span = stem.len() < before.len() && end > 0;
        kept += if is_span { stem } else { &rest[..dots + 2 + end] };
        rest = &after[end..];
    }
    kept += rest;
    ["digits: , ", "operator_span: , ", "keyword: , ", ", span: ", ", )"]
        .iter()
        .fold(kept, |text, noise| text.replace(noise, if noise.ends_with(')') { ")" } else { "" }))
}

#[test]
fn the_tree_of_every_statement() {
    let mut shown = String::new();
    for item in &read(EVERYTHING).tree.items {
        match item {
            Item::Task(task) => {
                shown += &format!("task {} extends {:?}\n", task.name.text, task.extends.as_ref().map(|name| &name.text));
                task.statements.iter().for_each(|statement| shown += &format!("    {}\n", line(statement)));
            }
            item => shown += &format!("{}\n", line(item)),
        }
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn weights_keep_the_span_of_their_digits() {
    let parsed = read(STAND);
    let rewards = task(&parsed.tree).statements.iter().filter_map(|statement| match statement {
        TaskStatement::Reward(reward) => Some(reward),
        _ => None,
    });
    let terms = rewards.flat_map(|reward| &reward.terms).filter_map(|entry| match entry {
        msk_compiler::syntax::tree::Entry::Item(term) => Some(term),
        _ => None,
    });
    let shown: Vec<String> = terms
        .map(|term| {
            let weight = term.weight.as_ref().unwrap();
            let range =
                if let Bounds::Range { low, high, .. } = weight.bounds { format!(" {low}..{high}") } else { String::new() };
            format!("{} {}{range}", weight.span.of(STAND), term.name.text)
        })
        .collect();
    assert_eq!(shown, ["10 pose", "15 stillness 5..30", "10 feet_planted", "10 balance", "5 alive", "-0.01 effort"]);
}

#[test]
fn documentation_and_comments_are_kept_beside_the_tree() {
    let parsed = read(STAND);
    assert!(parsed.tree.docs.as_ref().unwrap().text.starts_with("Quiet standing: hold"));
    assert!(task(&parsed.tree).docs.as_ref().unwrap().text.starts_with("Stand quietly"));
    let of = |comment: &Comment| comment.span.of(STAND).starts_with("//");
    assert!(parsed.comments.iter().all(of));
    assert_eq!(parsed.comments.len(), STAND.matches("//").count());
    assert!(parsed.comments.iter().any(|comment| comment.kind == CommentKind::Plain && !comment.own_line));
}

#[test]
fn names_keep_their_patterns() {
    let parsed = read("observation o { pole_{0..3}_top_{l,r}.height; rack_{*}.grip_{i} }");
    let text = format!("{:?}", parsed.tree);
    for part in [
        NamePart::Range(0, 3),
        NamePart::Literal("_top_".to_owned()),
        NamePart::Words(vec!["l".to_owned(), "r".to_owned()]),
        NamePart::Any,
        NamePart::Variable("i".to_owned()),
    ] {
        assert!(text.contains(&format!("{part:?}")), "{part:?} in {text}");
    }
}

#[test]
fn one_mistake_leaves_the_rest_of_the_tree() {
    let text = STAND.replacen("exp(-norm(", "exp(-norm (", 1).replacen("tilted when", "tilted if", 1);
    let parsed = parse(FileId::default(), &text);
    assert_eq!(parsed.diagnostics.len(), 2, "{:?}", parsed.diagnostics);
    assert_eq!(task(&parsed.tree).statements.len(), task(&read(STAND).tree).statements.len());
}

#[test]
fn line_ends_and_tabs_do_not_change_the_tree() {
    let shape = |text: &str| line(&parse(FileId::default(), text).tree);
    assert_eq!(shape(STAND), shape(&STAND.replace('\n', "\r\n")));
    assert_eq!(shape(STAND), shape(&STAND.replace("    ", "\t")));
    assert_eq!(shape(STAND), shape(STAND.trim_end()));
    assert_eq!(shape(STAND), shape(&format!("\u{feff}{STAND}")));
}
