//! Which one-token changes are made of a task, and which are not.

use msk_compiler::mutation::{Class, Mutant, Part, mutants, tasks};

/// `class: from -> to` of every change, in order.
fn changes(text: &str) -> Vec<String> {
    let all = mutants(text, "small").into_iter();
    all.map(|mutant| format!("{}: {} -> {}", mutant.class.name(), mutant.span.of(text), mutant.replacement)).collect()
}

/// A task with one end.
fn end(condition: &str) -> String {
    format!("task small {{\n    terminate {{ over when {condition} }}\n}}\n")
}

#[test]
fn signs_comparisons_axes_and_units_are_taken_for_others() {
    assert_eq!(
        changes(&end("com.velocity.x - 1 m/s < -0.5 m/s")),
        [
            "derivative: velocity -> position",
            "axis: x -> y",
            "sign: - -> +",
            "number: 1 -> 0",
            "number: 1 -> 2",
            "unit: m -> cm",
            "unit: s -> ms",
            "comparison: < -> >",
            "sign: - -> ",
            "number: 0.5 -> 0.25",
            "number: 0.5 -> 0.55",
            "number: 0.5 -> 1",
            "unit: m -> cm",
            "unit: s -> ms",
        ]
    );
}

#[test]
fn sides_words_of_logic_and_functions_are_taken_for_others() {
    assert_eq!(
        changes(&end("not touching(sole_l, ground) and min(pelvis.up.z, a_{l,r}.q) >= b")),
        [
            "logic: not -> ",
            "side: sole_l -> sole_r",
            "logic: and -> or",
            "function: min -> max",
            "axis: up -> forward",
            "axis: z -> x",
            "side: a_{l,r} -> a_{l,l}",
            "derivative: q -> qd",
            "comparison: >= -> <=",
        ]
    );
}

#[test]
fn of_a_scheduled_weight_the_last_one_is_mutated() {
    let text = "task small {\n    reward { 8 -> 4 over 30 % (2..9) tall = b }\n}\n";
    assert_eq!(changes(text), ["weight: 4 -> -4", "weight: 4 -> 2", "weight: 4 -> 5", "weight: 4 -> 8"]);
}

#[test]
fn whole_numbers_stay_whole_and_nought_stays() {
    assert_eq!(changes(&end("a > 0")), ["comparison: > -> <"]);
    assert_eq!(changes(&end("a > 30")), ["comparison: > -> <", "number: 30 -> 15", "number: 30 -> 33", "number: 30 -> 60"]);
    // A tenth more than one is two, as is its double: listed once.
    assert_eq!(changes(&end("a > 1")), ["comparison: > -> <", "number: 1 -> 0", "number: 1 -> 2"]);
}

#[test]
fn weights_change_in_sign_and_size_and_their_ranges_do_not() {
    let text = "task small {\n    reward {\n        10 (5..20) tall = high\n        -0.5 effort = much\n    }\n}\n";
    assert_eq!(
        changes(text),
        [
            "weight: 10 -> -10",
            "weight: 10 -> 5",
            "weight: 10 -> 11",
            "weight: 10 -> 20",
            "weight: - -> ",
            "weight: 0.5 -> 0.25",
            "weight: 0.5 -> 0.55",
            "weight: 0.5 -> 1",
        ]
    );
}

#[test]
fn names_and_tests_stay_as_they_are() {
    let text = "task small {
    body human
    family locomotion
    symmetric
    scene { ground; group seats = seat; remove stone_3; marker goal at [1 m, 0, 0] }
    init { pose neutral }
    observe { pelvis }
    test \"low\" { moment a { pose neutral { root.height = 0.3 m } }
        expect pelvis.height < 0.5 m at a
    }
}
";
    assert_eq!(changes(text), [""; 0]);
}

#[test]
fn values_and_success_are_changed_only_in_the_task_that_is_named() {
    let text = "task small {\n    let a = 3 < b\n    success a or b\n}\ntask other {\n    let c = 4\n    success not c\n}\n";
    assert_eq!(tasks(text), ["small", "other"]);
    let known = ["number: 3 -> 1", "number: 3 -> 4", "number: 3 -> 6", "comparison: < -> >", "logic: or -> and"];
    assert_eq!(changes(text), known);
    assert_eq!(mutants(text, "other").len(), 4);
    assert_eq!(mutants(text, "none"), []);
    assert_eq!(mutants("", "small"), []);
}

#[test]
fn a_change_replaces_one_place_and_nothing_else() {
    let text = end("a < 2 m");
    let changed: Vec<String> = mutants(&text, "small").iter().map(|mutant| mutant.apply(&text)).collect();
    assert_eq!(changed, [end("a > 2 m"), end("a < 1 m"), end("a < 3 m"), end("a < 4 m"), end("a < 2 cm")]);
}

#[test]
fn changes_come_in_the_order_of_the_text_whenever_asked() {
    let text = include_str!("../../tasks/stabilization/stand.msk");
    let all = mutants(text, "stand");
    assert!(all.len() > 50, "{}", all.len());
    assert!(all.is_sorted_by_key(|mutant: &Mutant| mutant.span.start));
    assert_eq!(mutants(text, "stand"), all);
    for class in Class::ALL {
        assert!(all.iter().any(|mutant| mutant.class == class), "{class:?}");
    }
}

#[test]
fn scene_initial_state_and_observation_are_parts_of_their_own() {
    let text = "task small {
    scene {
        box seat_l { size [2 m, 0, 0], solid false }
        weld palm_l to seat_l
        repeat i in 0..4 { sphere stone { radius 0.5 * i } }
    }
    init {
        pose neutral { knee_r = -8 deg }
        root { height 3 m, align palm_r to bar }
        noise joints normal(0, 6 rad)
        settle 50 ms with activation 0.2
    }
    observe { seen = pelvis.pitch }
    success a > 7
}
";
    let of = |part: Part| -> Vec<String> {
        let all = mutants(text, "small").into_iter().filter(|mutant| mutant.part == part);
        all.map(|mutant| format!("{} -> {}", mutant.span.of(text), mutant.replacement)).collect()
    };
    let scene = [
        "2 -> 1",
        "2 -> 3",
        "2 -> 4",
        "m -> cm",
        "false -> true",
        "palm_l -> palm_r",
        "seat_l -> seat_r",
        "4 -> 2",
        "4 -> 5",
        "4 -> 8",
    ];
    assert_eq!(of(Part::Scene)[..10], scene);
    assert_eq!(of(Part::Scene)[10..], ["0.5 -> 0.25", "0.5 -> 0.55", "0.5 -> 1", "* -> /"]);
    let initial_state = of(Part::InitialState);
    for change in ["knee_r -> knee_l", "- -> ", "8 -> 16", "3 -> 6", "palm_r -> palm_l", "6 -> 12", "50 -> 100", "0.2 -> 0.4"] {
        assert!(initial_state.iter().any(|known| known == change), "no {change} in {initial_state:?}");
    }
    assert_eq!(of(Part::Observation), ["pitch -> roll"]);
    assert_eq!(of(Part::Meaning), ["> -> <", "7 -> 3", "7 -> 8", "7 -> 14"]);
}

#[test]
fn draws_settings_and_disturbances_are_mutated_each_in_its_part() {
    let text = "task small {
    control 50 Hz
    horizon 200 steps
    params { load: mass = 5 kg (1 kg .. 9 kg) }
    random side = uniform(3 m .. 4 m) where side > 2 m redraw when far
    reference gait = motion \"walk.csv\" start 0.4
    disturb pelvis { force [60 N, 0, 0], at 3 s }
}
";
    let of = |part: Part| -> Vec<String> {
        let all = mutants(text, "small").into_iter().filter(|mutant| mutant.part == part);
        all.map(|mutant| format!("{} -> {}", mutant.span.of(text), mutant.replacement)).collect()
    };
    for change in ["50 -> 100", "200 -> 100", "steps -> s", "5 -> 10"] {
        assert!(of(Part::Meaning).iter().any(|known| known == change), "no {change} in {:?}", of(Part::Meaning));
    }
    for change in ["3 -> 6", "4 -> 8", "> -> <", "0.4 -> 0.8"] {
        assert!(of(Part::InitialState).iter().any(|known| known == change), "no {change} in {:?}", of(Part::InitialState));
    }
    for change in ["60 -> 120", "s -> ms"] {
        assert!(of(Part::Scene).iter().any(|known| known == change), "no {change} in {:?}", of(Part::Scene));
    }
    // What a tuner may choose is no meaning.
    assert!(!of(Part::Meaning).iter().any(|known| known == "9 -> 18"));
}

#[test]
fn settings_of_actions_and_channels_are_mutated() {
    let text = "task small {\n    act muscles { latency 2 steps }\n    observe { pelvis.height clip 0 m .. 3 m }\n}\n";
    let found = |part: Part| {
        let all = mutants(text, "small").into_iter().filter(move |mutant| mutant.part == part);
        all.map(|mutant| format!("{} -> {}", mutant.span.of(text), mutant.replacement)).collect::<Vec<_>>()
    };
    assert!(found(Part::Action).contains(&"2 -> 1".to_owned()), "{:?}", found(Part::Action));
    assert!(found(Part::Observation).contains(&"3 -> 4".to_owned()), "{:?}", found(Part::Observation));
}
