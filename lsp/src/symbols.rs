//! What a file holds, as an outline.

use crate::positions::Lines;
use lsp_types::{DocumentSymbol, SymbolKind};
use msk_compiler::diagnostics::Span;
use msk_compiler::syntax::tree::{BodyStatement, Element, ElementName, File, Item, SceneStatement, TaskStatement, walk};

/// The outline of a file.
pub fn outline(tree: &File, lines: &Lines<'_>) -> Vec<DocumentSymbol> {
    tree.items.iter().filter_map(|item| of_item(item, lines)).collect()
}

fn of_item(item: &Item, lines: &Lines<'_>) -> Option<DocumentSymbol> {
    let statements = |statements: &[TaskStatement]| statements.iter().flat_map(|one| of_statement(one, lines)).collect();
    Some(match item {
        Item::Use(_) => return None,
        Item::Const(binding) => symbol(&binding.name.text, SymbolKind::CONSTANT, binding.span, binding.name.span, vec![], lines),
        Item::Function(f) => symbol(&f.name.text, SymbolKind::FUNCTION, f.span, f.name.span, vec![], lines),
        Item::Observation(block) => symbol(&block.name.text, SymbolKind::ARRAY, block.span, block.name.span, vec![], lines),
        Item::Task(task) => {
            symbol(&task.name.text, SymbolKind::CLASS, task.span, task.name.span, statements(&task.statements), lines)
        }
        Item::Sequence(sequence) => {
            let inside = statements(&sequence.statements);
            symbol(&sequence.name.text, SymbolKind::CLASS, sequence.span, sequence.name.span, inside, lines)
        }
        Item::Suite(suite) => {
            let families = suite.families.iter();
            let families = families.map(|f| symbol(&f.name.text, SymbolKind::NAMESPACE, f.span, f.name.span, vec![], lines));
            let protocols = suite.protocols.iter().map(|protocol| {
                // The only protocol of a suite needs no name.
                let settings = &protocol.settings;
                let (name, at) = match &protocol.name {
                    Some(name) => (name.text.as_str(), name.span),
                    None => ("protocol", settings.kind.span),
                };
                symbol(name, SymbolKind::PROPERTY, settings.span, at, vec![], lines)
            });
            let inside = families.chain(protocols).collect();
            symbol(&suite.name.text, SymbolKind::MODULE, suite.span, suite.name.span, inside, lines)
        }
        Item::Body(body) => {
            let inside = body.statements.iter().filter_map(|statement| of_body(statement, lines)).collect();
            symbol(&body.name.text, SymbolKind::STRUCT, body.span, body.name.span, inside, lines)
        }
    })
}

fn of_body(statement: &BodyStatement, lines: &Lines<'_>) -> Option<DocumentSymbol> {
    match statement {
        BodyStatement::Element(element) => of_element(element, lines),
        BodyStatement::Group(group) => {
            Some(symbol(&group.name.text, SymbolKind::ARRAY, group.span, group.name.span, vec![], lines))
        }
        BodyStatement::Pose(pose) => Some(symbol(&pose.name.text, SymbolKind::OBJECT, pose.span, pose.name.span, vec![], lines)),
        BodyStatement::Model(_) | BodyStatement::Setting { .. } => None,
    }
}

fn of_statement(statement: &TaskStatement, lines: &Lines<'_>) -> Vec<DocumentSymbol> {
    use TaskStatement as S;
    let one = |name: &str, kind, span, selection| vec![symbol(name, kind, span, selection, vec![], lines)];
    match statement {
        S::Let(binding) => one(&binding.name.text, SymbolKind::VARIABLE, binding.span, binding.name.span),
        S::State(state) => one(&state.name.text, SymbolKind::FIELD, state.span, state.name.span),
        S::Clock(clock) => one(&clock.name.text, SymbolKind::FIELD, clock.span, clock.name.span),
        S::Random(random) => one(&random.name.text, SymbolKind::FIELD, random.span, random.name.span),
        S::Reference(reference) => one(&reference.name.text, SymbolKind::FIELD, reference.span, reference.name.span),
        S::Params(block) => walk::items(&block.entries)
            .flat_map(|parameter| one(&parameter.name.text, SymbolKind::CONSTANT, parameter.span, parameter.name.span))
            .collect(),
        S::Scene(block) => {
            let inside = block.entries.iter().flat_map(|entry| of_scene(entry, lines)).collect();
            vec![symbol("scene", SymbolKind::NAMESPACE, block.span, block.keyword, inside, lines)]
        }
        S::Reward(reward) => {
            let terms = walk::items(&reward.terms);
            let inside = terms.map(|t| symbol(&t.name.text, SymbolKind::PROPERTY, t.span, t.name.span, vec![], lines)).collect();
            let name = if reward.per_second { "reward per second" } else { "reward" };
            vec![symbol(name, SymbolKind::NAMESPACE, reward.span, reward.span, inside, lines)]
        }
        S::Terminate(ends) | S::Finish(ends) => {
            let name = if matches!(statement, S::Terminate(_)) { "terminate" } else { "finish" };
            let reasons = walk::items(&ends.reasons);
            let inside = reasons.map(|r| symbol(&r.name.text, SymbolKind::EVENT, r.span, r.name.span, vec![], lines)).collect();
            vec![symbol(name, SymbolKind::NAMESPACE, ends.span, ends.span, inside, lines)]
        }
        S::Phase(phase) => one(&phase.task.text, SymbolKind::EVENT, phase.span, phase.task.span),
        S::Test(test) => one(&test.title.value, SymbolKind::METHOD, test.span, test.title.span),
        _ => Vec::new(),
    }
}

fn of_scene(statement: &SceneStatement, lines: &Lines<'_>) -> Vec<DocumentSymbol> {
    match statement {
        SceneStatement::Element(element) => of_element(element, lines).into_iter().collect(),
        SceneStatement::Group(group) => {
            vec![symbol(&group.name.text, SymbolKind::ARRAY, group.span, group.name.span, vec![], lines)]
        }
        SceneStatement::Repeat(repeat) => repeat.statements.iter().flat_map(|statement| of_scene(statement, lines)).collect(),
        _ => Vec::new(),
    }
}

fn of_element(element: &Element, lines: &Lines<'_>) -> Option<DocumentSymbol> {
    let (name, selection) = match element.name.as_ref()? {
        ElementName::Name(name) => (&name.text, name.span),
        ElementName::Quoted(text) => (&text.value, text.span),
    };
    let inside = element.parts.iter().filter_map(|part| of_element(part, lines)).collect();
    Some(symbol(name, SymbolKind::OBJECT, element.span, selection, inside, lines))
}

#[allow(deprecated, reason = "the field `deprecated` must be given a value")]
fn symbol(
    name: &str,
    kind: SymbolKind,
    span: Span,
    selection: Span,
    children: Vec<DocumentSymbol>,
    lines: &Lines<'_>,
) -> DocumentSymbol {
    // Editors refuse a selection outside its range, and an empty name.
    let name = if name.is_empty() { "(no name)".to_owned() } else { name.to_owned() };
    DocumentSymbol {
        name,
        detail: None,
        kind,
        tags: None,
        deprecated: None,
        range: lines.range(span.to(selection)),
        selection_range: lines.range(selection),
        children: (!children.is_empty()).then_some(children),
    }
}
