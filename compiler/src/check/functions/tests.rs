//! Shapes of the language: what every function and operator makes of every type in every argument, as a table and as laws.
//!
//! The laws take nothing from the signatures: they compare a call with lists with the calls of the lists' elements.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use super::signature::{Parameter, Shapes, Signature, Takes};
use super::{Checks, FUNCTIONS, Function, OPERATORS};
use crate::check::context::Checker;
use crate::check::types::{ElementType, Type};
use crate::check::value::{TypedValue, Value};
use crate::diagnostics::{FileId, Severity};
use crate::graph::{Graph, NodeId};
use crate::resolve::scope::{Globals, Names, Place};
use crate::syntax;
use crate::syntax::tree::{Expr, Item, TaskStatement};
use crate::vocabulary::Vocabulary;
use msk_program::lower::{Interpreter, Moment, Outputs, layout};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::OnceLock;

/// Values of one type.
struct Sample {
    name: &'static str,
    elements: [&'static str; 4],
    /// How the list of them is written; empty for a bracket of the elements.
    list: &'static str,
}

const fn sample(name: &'static str, elements: [&'static str; 4]) -> Sample {
    Sample { name, elements, list: "" }
}

const SAMPLES: [Sample; 15] = [
    sample("plain number", ["torso.up.z", "pelvis.up.z", "torso.left.x", "pelvis.forward.y"]),
    sample("length", ["com.height", "pelvis.height", "head.height", "torso.height"]),
    sample("time", ["t", "0.2 s", "(t + 1 s)", "dt"]),
    sample("angle", ["knee_angle_r.q", "knee_angle_l.q", "hip_flexion_r.q", "3 rad"]),
    sample("wrapping angle", ["pelvis.yaw", "torso.yaw", "pelvis.pitch", "torso.roll"]),
    sample("angles, some of which wrap", ["pelvis.yaw", "knee_angle_r.q", "torso.roll", "3 rad"]),
    Sample {
        name: "hinges and slides",
        elements: ["knee_angle_r.q", "knee_angle_translation1_r.q", "hip_flexion_r.q", "knee_angle_translation2_r.q"],
        list: "[knee_angle_r, knee_angle_translation1_r, hip_flexion_r, knee_angle_translation2_r].q",
    },
    sample("whole number", ["step", "(step + 1)", "(step * 2)", "(step + 5)"]),
    sample("control steps", ["3 steps", "4 steps", "1 steps", "7 steps"]),
    sample("condition", ["com.height > 0.1 m", "pelvis.height > 0.2 m", "step > 1", "torso.up.z > 0"]),
    sample("vector", ["com.velocity", "pelvis.velocity", "head.velocity", "torso.velocity"]),
    sample("flat vector", ["com.velocity.xy", "pelvis.velocity.xy", "head.velocity.xy", "torso.velocity.xy"]),
    sample(
        "vector in pelvis",
        ["(com.velocity in pelvis)", "(torso.velocity in pelvis)", "(head.velocity in pelvis)", "(sole_l.velocity in pelvis)"],
    ),
    sample("place", ["com.position", "pelvis.position", "head.position", "torso.position"]),
    sample("orientation", ["pelvis.orientation", "torso.orientation", "head.orientation", "sole_l.orientation"]),
];

impl Sample {
    fn one(&self, place: usize) -> String {
        self.elements[place].to_owned()
    }

    fn list(&self) -> String {
        if self.list.is_empty() { format!("[{}]", self.elements.join(", ")) } else { self.list.to_owned() }
    }
}

fn vocabulary() -> &'static Vocabulary {
    static HUMAN: OnceLock<Vocabulary> = OnceLock::new();
    HUMAN.get_or_init(|| serde_json::from_str(include_str!("../../../tests/fixtures/human_vocabulary.json")).unwrap())
}

/// Formulas checked one after the other into one graph; of wrong ones the codes.
fn checked(texts: &[String]) -> (Graph, Vec<Result<TypedValue, String>>) {
    checked_on(vocabulary(), texts)
}

/// The same on another body.
fn checked_on(vocabulary: &Vocabulary, texts: &[String]) -> (Graph, Vec<Result<TypedValue, String>>) {
    let formulas: Vec<Expr> = texts.iter().map(|text| formula(text)).collect();
    let globals = Globals::default();
    let names = Names::global(&globals);
    let mut checker = Checker::new(vocabulary, &names, Place { file: FileId::default(), in_task: false }, &[]);
    checker.timing.horizon = 50;
    (checker.settled.interval, checker.settled.horizon) = (true, true);
    let mut values = Vec::new();
    for formula in &formulas {
        let value = checker.value(formula);
        let diagnostics = std::mem::take(&mut checker.diagnostics);
        values.push(match value {
            Ok(Value::Typed(data)) => Ok(data),
            Ok(other) => panic!("{other:?}"),
            Err(_) => {
                let error = diagnostics.iter().find(|diagnostic| diagnostic.severity == Severity::Error);
                Err(error.unwrap_or_else(|| panic!("an error that nothing tells of")).code.id.to_owned())
            }
        });
    }
    (std::mem::take(&mut checker.graph), values)
}

fn formula(text: &str) -> Expr {
    let parsed = syntax::parse(FileId::default(), &format!("task t {{ let x = {text} }}"));
    assert!(!parsed.has_errors(), "{text}");
    let Some(Item::Task(task)) = parsed.tree.items.into_iter().next() else { panic!("{text}") };
    match task.statements.into_iter().next() {
        Some(TaskStatement::Let(binding)) => binding.value,
        other => panic!("{text}: {other:?}"),
    }
}

/// What nodes hold at a few steps, while sensors measure something else at each.
fn simulated(graph: &Graph, nodes: &[NodeId]) -> Vec<Vec<u64>> {
    let outputs = Outputs { channels: nodes.to_vec(), ..Outputs::default() };
    let layout = layout(std::iter::once((graph, &outputs)), &[]);
    let mut plain = Interpreter { graph, memories: BTreeMap::new(), states: Vec::new() };
    let mut found = vec![Vec::new(); nodes.len()];
    for step in 0..5_u32 {
        // From one step to the next angles cross the half turn.
        let measured = |lane: usize| 1.7 * libm::sin(lane as f64 * 1.3 + f64::from(step) * 2.9);
        let frame: Vec<f64> = (0..layout.size()).map(measured).collect();
        let mut moment = Moment { step, layout: &layout, frame: &frame, values: BTreeMap::new(), before: Vec::new() };
        for (node, found) in nodes.iter().zip(&mut found) {
            found.extend(plain.value(*node, &mut moment).into_iter().map(f64::to_bits));
        }
    }
    found
}

/// Whatever maps over lists, with holes for its arguments: functions by their signatures, and all operators.
fn templates() -> Vec<String> {
    let mut templates: Vec<String> = Vec::new();
    for function in FUNCTIONS.iter().chain(OPERATORS) {
        let Checks::Signatures(signatures) = &function.checks else { continue };
        for signature in *signatures {
            // `norm` maps over vectors, but makes one value of a list of numbers.
            let folds = |other: &Signature| {
                other.parameters.len() == signature.parameters.len() && other.parameters[0].shapes == Shapes::List
            };
            let maps = signature.parameters.iter().all(|parameter| matches!(parameter.shapes, Shapes::Each | Shapes::One));
            if maps && !signatures.iter().any(folds) {
                let holes: Vec<&str> = signature.parameters.iter().map(|parameter| constant(parameter.takes)).collect();
                templates.push(format!("{}({})", function.name, holes.join(", ")));
            }
        }
    }
    let operators = [
        "-({})",
        "not ({})",
        "({}) + ({})",
        "({}) - ({})",
        "({}) * ({})",
        "({}) / ({})",
        "({}) ^ ({})",
        "({}) and ({})",
        "({}) or ({})",
        "({}) < ({})",
        "({}) >= ({})",
        "({}) == ({})",
        "({}) < ({}) <= ({})",
        "(({}) when ({}))",
        "(if t > 0.02 s then ({}) else ({}))",
        "(({}) in torso)",
        "({}).z",
        "({}).xy",
        "({}).forward",
        "max({}, {}, {})",
    ];
    templates.extend(operators.map(str::to_owned));
    templates.sort();
    templates.dedup();
    templates
}

/// What stands for a parameter that is known while compiling; a hole for any other.
fn constant(takes: Takes) -> &'static str {
    match takes {
        Takes::Duration => "2 steps",
        Takes::TimeConstant => "0.05 s",
        _ => "{}",
    }
}

fn filled(template: &str, arguments: &[String]) -> String {
    let mut text = String::new();
    let mut pieces = template.split("{}");
    text += pieces.next().unwrap();
    for (argument, piece) in arguments.iter().zip(pieces) {
        text += argument;
        text += piece;
    }
    text
}

/// The samples to put into so many holes: one for all but the last, one for that.
fn combinations(holes: usize) -> Vec<Vec<&'static Sample>> {
    let mut combinations = Vec::new();
    for first in &SAMPLES {
        let last = if holes > 1 { &SAMPLES[..] } else { std::slice::from_ref(first) };
        combinations.extend(last.iter().map(|last| {
            let mut chosen = vec![first; holes];
            chosen[holes - 1] = last;
            chosen
        }));
    }
    combinations
}

/// Which of so many holes get a list: all, or one; of two, any.
fn listed(holes: usize) -> Vec<Vec<bool>> {
    let alone = (0..holes).map(|list| (0..holes).map(|hole| hole == list).collect());
    if holes == 1 { vec![vec![true]] } else { std::iter::once(vec![true; holes]).chain(alone).collect() }
}

/// A list maps: it is taken exactly if all its elements are, and gives for each what the element by itself gives, in type, in
/// whether it wraps, and in every bit of its value.
#[test]
fn whatever_maps_does_with_lists_what_it_does_with_their_elements() {
    let (mut taken, mut refused) = (0, 0);
    for template in templates() {
        let holes = template.matches("{}").count();
        for samples in combinations(holes) {
            let written = |lists: &[bool], place: Option<usize>| {
                let argument = |(sample, list): (&&Sample, &bool)| match place {
                    None if *list => sample.list(),
                    Some(place) if *list => sample.one(place),
                    _ => sample.one(0),
                };
                filled(&template, &samples.iter().zip(lists).map(argument).collect::<Vec<_>>())
            };
            let first_is_taken = checked(&[written(&vec![false; holes], None)]).1[0].is_ok();
            for lists in listed(holes) {
                let whole = written(&lists, None);
                match checked(std::slice::from_ref(&whole)).1.remove(0) {
                    Ok(_) => {
                        assert!(first_is_taken, "{whole} is taken, its elements are not");
                        maps(&whole, [0, 1, 2, 3].map(|place| written(&lists, Some(place))));
                        taken += 1;
                    }
                    // A list of vectors has one dimension: there is none to which numbers of several have scaled them.
                    Err(code) if code == "E0307" => refused += 1,
                    Err(_) => {
                        let elements = checked(&[1, 2, 3].map(|place| written(&lists, Some(place)))).1;
                        let all = first_is_taken && elements.iter().all(Result::is_ok);
                        assert!(!all, "{whole} is refused, its elements are not");
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(taken > 1000 && refused > 1000, "{taken} taken, {refused} refused");
}

/// What is written with lists is what is written with each of their elements.
fn maps(whole: &str, elements: [String; 4]) {
    let texts: Vec<String> = std::iter::once(whole.to_owned()).chain(elements).collect();
    let (graph, values) = checked(&texts);
    let values: Vec<TypedValue> =
        values.into_iter().zip(&texts).map(|(value, text)| value.unwrap_or_else(|code| panic!("{text}: {code}"))).collect();
    let (whole, elements) = values.split_first().unwrap();
    assert_eq!(whole.kind.length(), Some(4), "{}", texts[0]);
    let nodes: Vec<NodeId> = values.iter().map(|value| value.node).collect();
    let simulated = simulated(&graph, &nodes);
    let lanes = whole.kind.element_lanes();
    for (place, one) in elements.iter().enumerate() {
        assert_eq!(one.kind, Type::One(whole.kind.element_at(place)), "element {place} of {}", texts[0]);
        let own = simulated[0].chunks(4 * lanes).flat_map(|step| &step[place * lanes..(place + 1) * lanes]);
        assert!(own.eq(&simulated[place + 1]), "element {place} of {} is not {}", texts[0], texts[place + 1]);
    }
}

#[test]
fn lists_of_different_length_never_meet() {
    let mut met = 0;
    for template in templates().into_iter().filter(|template| template.matches("{}").count() > 1) {
        let holes = template.matches("{}").count();
        for samples in combinations(holes) {
            let longer = |sample: &Sample| format!("[{}, {}]", sample.elements.join(", "), sample.elements[0]);
            let equal: Vec<String> = samples.iter().map(|sample| sample.list()).collect();
            if samples.iter().any(|sample| !sample.list.is_empty()) || checked(&[filled(&template, &equal)]).1[0].is_err() {
                continue;
            }
            for hole in 0..holes {
                let mut unequal = equal.clone();
                unequal[hole] = longer(samples[hole]);
                let text = filled(&template, &unequal);
                assert_eq!(checked(std::slice::from_ref(&text)).1[0].clone().err().as_deref(), Some("E0305"), "{text}");
                met += 1;
            }
        }
    }
    assert!(met > 300, "{met}");
}

/// Functions that make one value of a list, against what the value means.
#[test]
fn functions_of_lists_give_one_value_of_what_their_elements_are() {
    let cases = [
        ("sum([pelvis.yaw, torso.yaw])", "pelvis.yaw + torso.yaw"),
        ("sum([com.velocity, head.velocity])", "com.velocity + head.velocity"),
        ("sum([step, 2])", "step + 2"),
        ("max([pelvis.yaw, torso.yaw])", "max(pelvis.yaw, torso.yaw)"),
        ("min([com.height, head.height])", "min(com.height, head.height)"),
        ("first([pelvis.yaw, knee_angle_r.q])", "pelvis.yaw"),
        ("last([pelvis.yaw, knee_angle_r.q])", "knee_angle_r.q"),
        ("[pelvis.yaw, knee_angle_r.q][1]", "knee_angle_r.q"),
        ("[knee_angle_r, knee_angle_translation1_r].q[1]", "knee_angle_translation1_r.q"),
        ("last([x for x in [pelvis.yaw, torso.yaw]])", "torso.yaw"),
        ("norm([com.velocity, head.velocity])", "[norm(com.velocity), norm(head.velocity)]"),
        ("all([step > 1, step > 2])", "step > 1 and step > 2"),
        ("(com.height^([2, 3]))[1]", "com.height^3"),
        ("(com.speed / 1 m/s)^([0.123, 3])", "[(com.speed / 1 m/s)^0.123, (com.speed / 1 m/s)^3]"),
        ("lerp(pelvis.yaw, torso.yaw, 0.25)", "pelvis.yaw + 0.25 * (torso.yaw - pelvis.yaw)"),
        ("rate([pelvis.yaw, torso.yaw])", "[rate(pelvis.yaw), rate(torso.yaw)]"),
        ("rate([pelvis, torso].yaw)", "[rate(pelvis.yaw), rate(torso.yaw)]"),
        ("rate(first([pelvis.yaw, torso.yaw]))", "rate(pelvis.yaw)"),
        ("rate(if t > 1 s then torso.yaw else pelvis.yaw)", "rate(pelvis.yaw)"),
        ("rate(pelvis.yaw when t < 1 s)", "rate(pelvis.yaw)"),
        ("rate(pelvis.yaw + 0 * torso.yaw)", "rate(pelvis.yaw)"),
        ("mean([pelvis.yaw, pelvis.yaw]) - pelvis.yaw", "pelvis.yaw - pelvis.yaw + 0 * pelvis.pitch"),
    ];
    for (written, meant) in cases {
        let (graph, values) = checked(&[written.to_owned(), meant.to_owned()]);
        let [written_value, meant_value] = values.as_slice() else { panic!("two values") };
        let (written_value, meant_value) = (written_value.clone().expect(written), meant_value.clone().expect(meant));
        assert_eq!(written_value.kind, meant_value.kind, "{written}");
        let simulated = simulated(&graph, &[written_value.node, meant_value.node]);
        for (found, expected) in simulated[0].iter().zip(&simulated[1]) {
            let (found, expected) = (f64::from_bits(*found), f64::from_bits(*expected));
            assert!((found - expected).abs() < 1e-12, "{written}: {found} is not {expected}");
        }
    }
}

#[test]
fn a_set_that_is_empty_on_a_body_is_an_error() {
    let bare = Vocabulary { muscles: Vec::new(), ..vocabulary().clone() };
    let formulas =
        ["first(activation)", "sum(activation^2)", "muscles[0].force", "muscles[step].force", "muscles.force", "mean(action)"];
    let (_, values) = checked_on(&bare, &formulas.map(str::to_owned));
    let codes: Vec<&str> = values.iter().map(|value| value.as_ref().map_or_else(String::as_str, |_| "a value")).collect();
    assert_eq!(codes, ["E0205"; 6]);
}

#[test]
fn what_has_no_rule_is_refused() {
    for (text, code) in [
        ("[torso.up.z, 1]^([2, 3, 4])", "E0305"),
        ("lerp([1, 2], [1, 2, 3], 0.5)", "E0305"),
        ("tolerance(com.height, 0..1 m, [1 m, 2 m, 3 m]) + [1, 2]", "E0305"),
        ("com.velocity + [0, 0]", "E0301"),
        ("[1.5, torso.up]", "E0301"),
        ("held(com.height > 1 m, [3 steps])", "E0310"),
        ("smooth(com.height, [1 s])", "E0304"),
        ("delay(com.height, [0])", "E0310"),
        ("mean([knee_angle_r, knee_angle_translation1_r].q)", "E0307"),
        ("com.height^([2, torso.up.z])", "E0308"),
        ("[com.height, pelvis.height, torso.height] * [[1, 2, 3, 4][0]]", "E0305"),
        ("[knee_angle_r, knee_angle_translation1_r].q * [com.velocity, head.velocity]", "E0307"),
        ("[x for x in [knee_angle_r, knee_angle_translation1_r].q]", "E0301"),
        ("[com.height, pelvis.height][[0]]", "E0309"),
    ] {
        assert_eq!(checked(&[text.to_owned()]).1[0].clone().err().as_deref(), Some(code), "{text}");
    }
}

/// How the table names a type.
fn named(ty: &Type) -> String {
    let element = |element: ElementType| element.described(vocabulary());
    match ty {
        Type::Mixed(elements) => elements.iter().map(|own| element(*own)).collect::<Vec<_>>().join(", "),
        other => other.described(vocabulary()),
    }
}

/// Arguments that fit beside the one that is looked at.
fn beside(takes: Takes, alike: bool, own: &str) -> String {
    match takes {
        Takes::Duration | Takes::TimeConstant => constant(takes).to_owned(),
        _ if alike => own.to_owned(),
        Takes::Quantity(_) => "0.5".to_owned(),
        Takes::Condition => "step > 1".to_owned(),
        _ => own.to_owned(),
    }
}

/// What a function gives for every sample as one of its arguments, the others being beside it.
fn row(function: &Function, signature: &Signature, place: usize) -> String {
    let mut row = String::new();
    for sample in &SAMPLES {
        let given = |own: String| {
            let argument = |(other, parameter): (usize, &Parameter)| {
                if other == place { own.clone() } else { beside(parameter.takes, parameter.alike, &sample.one(0)) }
            };
            let arguments: Vec<String> = signature.parameters.iter().enumerate().map(argument).collect();
            let (_, values) = checked(&[format!("{}({})", function.name, arguments.join(", "))]);
            values.into_iter().next().unwrap().map_or_else(|code| code, |data| named(&data.kind))
        };
        let (one, list) = (given(sample.one(0)), given(sample.list()));
        let _ = match list.strip_prefix("a list of 4, each ") {
            Some(each) if each == one => writeln!(row, "- {}: {one}; of a list each", sample.name),
            _ if one == list && one.starts_with('E') => Ok(()),
            _ => writeln!(row, "- {}: {one}; of a list {list}", sample.name),
        };
    }
    row
}

fn rows(function: &Function, table: &mut String) {
    let _ = writeln!(table, "\n## {}\n", function.signature);
    let Checks::Signatures(signatures) = &function.checks else {
        table.push_str("takes parts of the body or what a sensor must know beforehand\n");
        return;
    };
    // Parameters with the same properties are listed together.
    let mut groups: Vec<(Vec<&str>, String)> = Vec::new();
    for signature in *signatures {
        for (place, parameter) in signature.parameters.iter().enumerate() {
            let row = row(function, signature, place);
            match groups.last_mut() {
                Some((names, known)) if *known == row => names.push(parameter.name),
                _ => groups.push((vec![parameter.name], row)),
            }
        }
    }
    for (names, row) in groups {
        let _ = writeln!(table, "{}:\n{row}", names.join(", "));
    }
}

#[test]
fn types_of_all_functions() {
    let mut table = String::new();
    FUNCTIONS.iter().chain(OPERATORS).for_each(|function| rows(function, &mut table));
    insta::assert_snapshot!(table);
}
