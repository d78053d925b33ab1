//! Whatever stands in a file, the compiler answers: no panic, no endless work.

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::Middle;
use msk_compiler::task::{CompiledTask, StepReport, TaskState};
use proptest::prelude::*;
use support::compiling::{compile_text, complete};

/// Words and signs of the language, and some that are none.
#[rustfmt::skip]
const TOKENS: &[&str] = &[
    "pelvis", "torso", "sole_{l,r}", "feet", "com", "joints", "independent", "slides", "muscles", "soleus_r", "knee_angle_l",
    "ground", "\"glmax*\"", "muscle", "landmark", "joint", ".position", ".velocity", ".q", ".neutral", ".up", ".z", ".xy",
    ".forward", ".orientation", ".activation", ".clearance", ".mass", ".lower", "t", "dt", "step", "horizon", "terminated",
    "ended", "survived", "ended by", "fallen", "pi", "spine", "action", "in", "heading(", "world", "exp(", "norm(", "sum(",
    "mean(", "std(", "prod(", "min(", "max(", "clip(", "tolerance(", "smoothstep(", "between(", "dot(", "cross(", "normalize(",
    "distance(", "angle_between(", "neutral(", "touching(", "contact_force(", "prev(", "rate(", "held(", "delay(", "smooth(",
    "sample_hold(", "once(", "since(", "hysteresis(", "integral(", "argmax(", "first(", "sin(", "atan2(", "sqrt(", "mod(", "(", ")",
    "[", "]", ",", "+", "-", "*", "/", "^", "^2", "^0.5", "<", ">=", "==", "!=", "and", "or", "not", "when", "if", "then",
    "else", "for i in 0..3", "for i in", "i", "[0]", "0", "1", "2", "1e300", "0.5 m", "2 s", "3 deg", "25 steps", "0.015 s",
    "10 s/m", "1 kg*m^2/s", "30 %", "true", "false", "0..1 m", "..", "=", "x", "a", "b", "bend", "f(", "where", "\n",
];

/// A formula of random words.
fn formula() -> impl Strategy<Value = String> {
    prop::collection::vec(prop::sample::select(TOKENS), 1..14).prop_map(|words| words.join(" "))
}

/// A formula that is right in most of its parts: brackets close, operators have two sides.
fn plausible() -> impl Strategy<Value = String> {
    #[rustfmt::skip]
    let leaves = prop::sample::select(&[
        "com.height", "com.velocity", "com.position", "sole_{l,r}.height", "independent.q", "joints.qd", "muscles.activation",
        "torso.up", "pelvis.orientation", "pelvis", "feet", "slides.q", "t", "step", "0", "2", "0.5 m", "[0, 0, 1 m]", "terminated",
        "x", "action", "pelvis.yaw", "[pelvis, head]", "knee_angle_l", "com.height > 1 m", "sole_{l,r}.speed < 1 m/s", "s", "c",
    ][..]);
    leaves.prop_map(str::to_owned).prop_recursive(5, 24, 3, |inner| {
        #[rustfmt::skip]
        let functions = prop::sample::select(&[
            "exp", "norm", "sum", "mean", "std", "prod", "min", "max", "abs", "sqrt", "unit", "first", "argmin", "prev", "rate",
            "initial", "highest", "count", "once", "ever", "since", "integral", "neutral", "f", "any", "sin", "floor", "sign",
        ][..]);
        let pairs =
            prop::sample::select(&["dot", "cross", "distance", "atan2", "max", "sampled", "held", "delay", "smooth", "mod"][..]);
        let operators = prop::sample::select(&["+", "-", "*", "/", "<", "==", "and", "when"][..]);
        prop_oneof![
            (functions, inner.clone()).prop_map(|(name, x)| format!("{name}({x})")),
            (pairs, inner.clone(), inner.clone()).prop_map(|(name, x, y)| format!("{name}({x}, {y})")),
            (operators, inner.clone(), inner.clone()).prop_map(|(operator, x, y)| format!("(({x}) {operator} ({y}))")),
            inner.clone().prop_map(|x| format!("(({x}) in pelvis)")),
            inner.clone().prop_map(|x| format!("({x})^2")),
            (inner.clone(), inner.clone()).prop_map(|(x, y)| format!("[{x}, {y}]")),
            (inner.clone(), inner.clone(), inner).prop_map(|(x, y, z)| format!("(if {x} then {y} else {z})")),
        ]
    })
}

fn answers(formula: &str) {
    let everywhere = format!(
        "observe {{\nseen = {formula}\ns\n}}\nreward {{\n1 paid = {formula}\n}}\nterminate {{\nfallen when {formula}\n}}"
    );
    // Anything may be observed, so that many more formulas come to run.
    let observed = format!("observe {{\nseen = {formula}\n}}");
    for statements in [everywhere, observed] {
        let declarations = "let x = com.height / 1 m\nstate s: int = 0 becomes s + 1 when com.height > 1 m\nclock c at 1 Hz";
        let text = format!("fn f(a) = a + a\n{}", complete(&format!("{declarations}\n{statements}")));
        // Either answer is right; what must not happen is that there is none.
        match compile_text(&text, &[]) {
            Ok(compilation) => run(&compilation.tasks[0]),
            Err(report) => assert!(report.has_errors()),
        }
    }
}

/// A few steps over a frame of halves; a term that is no number is an answer, too.
fn run(task: &CompiledTask) {
    let frame = vec![0.5; task.frame.size()];
    let (mut state, mut report) = (TaskState::default(), StepReport::default());
    let mut observation = vec![f64::NAN; task.observation_size()];
    task.reset(&frame, &mut Middle, &mut state).unwrap();
    for step in 1..=3 {
        let result = task.step(&frame, &task.weights(), &mut Middle, &mut state, &mut report);
        assert_eq!((state.step, report.terms.len()), (step, 1));
        assert_eq!(result.is_err(), !report.terms[0].is_finite());
        task.observe(&frame, &state, &mut observation);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn words_in_any_order_are_answered(formula in formula()) {
        answers(&formula);
    }

    #[test]
    fn formulas_of_any_types_are_answered(formula in plausible()) {
        answers(&formula);
    }
}
