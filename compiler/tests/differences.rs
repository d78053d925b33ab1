//! What a difference in meaning is, and what is none.

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::difference::{ChangeKind, Difference};
use msk_compiler::snapshot::Snapshot;
use msk_compiler::task::CompiledTask;
use std::sync::Arc;
use support::compiling::{compile_text, complete};

fn snapshot(statements: &str) -> Snapshot {
    let compilation = compile_text(&complete(statements), &[]).unwrap_or_else(|report| panic!("{report}"));
    compilation.tasks[0].snapshot()
}

fn task(statements: &str) -> Arc<CompiledTask> {
    compile_text(&complete(statements), &[]).unwrap_or_else(|report| panic!("{report}")).tasks[0].clone()
}

fn hash(statements: &str) -> String {
    compile_text(&complete(statements), &[]).unwrap_or_else(|report| panic!("{report}")).tasks[0].hash.clone()
}

fn between(before: &str, after: &str) -> Difference {
    Difference::between(&snapshot(before), &snapshot(after), true)
}

const BEFORE: &str = "
    let low = 0.8 m
    state steps_high: int = 0 becomes steps_high + 1 when pelvis.height > 1 m
    reward {
        10 (5..20) tall  = pelvis.height / 1 m
         5         still = exp(-10 s/m * com.speed)
         2         high  = clip(steps_high / 10, 0, 1)
        -1         sunk  = pelvis.height < low
    }
    terminate {
        fallen when com.height < 0.8 m
    }
    observe {
        pelvis.height
        steps_high
    }";

#[test]
fn a_snapshot_read_back_is_the_same() {
    let snapshot = snapshot(BEFORE);
    assert_eq!(snapshot.to_string().parse::<Snapshot>().unwrap(), snapshot);
    let broken = snapshot.to_string().replace("weight: 10", "weight 10");
    let error = broken.parse::<Snapshot>().unwrap_err().to_string();
    assert!(error.contains("expected `name: value`, found `    weight 10`"), "{error}");
    assert!("something else".parse::<Snapshot>().unwrap_err().to_string().starts_with("line 1"));
}

#[test]
fn comments_layout_and_local_names_make_no_difference() {
    let rewritten = "
    observe { pelvis.height   // how tall
        count_high
    }
    terminate { fallen when com.height < 80 cm }
    state count_high: int = 0
        becomes count_high + 1 when pelvis.height > 100 cm
    const_free: nothing
    reward {
        10 (5..20) tall = pelvis.height / 1 m
        5 still = exp(-10 s/m * com.speed)   // quiet
        2 high = clip(count_high / 10, 0, 1)
        -1 sunk = pelvis.height < deep
    }
    let deep = 80 cm"
        .replace("    const_free: nothing\n", "");
    // The label of a channel is part of what it is: the observation is compared by it.
    let before = BEFORE.replace("pelvis.height\n        steps_high\n", "pelvis.height\n        count_high = steps_high\n");
    let difference = between(&before, &rewritten);
    assert!(difference.is_empty(), "{difference}");
    assert_eq!(hash(&before), hash(&rewritten));
}

#[test]
fn every_kind_of_change_is_reported_in_words() {
    let after = BEFORE
        .replace("10 (5..20) tall  = pelvis.height / 1 m", "12 (5..30) tall  = pelvis.height / 1 m")
        .replace("-10 s/m", "-12 s/m")
        .replace("let low = 0.8 m", "let low = 0.7 m")
        .replace("         2         high  = clip(steps_high / 10, 0, 1)\n", "         3         new   = once(ended)\n")
        .replace("com.height < 0.8 m\n", "com.height < 0.75 m\n        flew when com.height > 2 m\n")
        .replace("pelvis.height\n        steps_high", "steps_high\n        pelvis.height")
        + "\nscene { ground\n box seat { size [1 m, 1 m, 1 m], at [-2 m, 0, 0.5 m] } }\nsuccess survived and pelvis.height > 1 m";
    let before =
        format!("{BEFORE}\nscene {{ ground\n box seat {{ size [1 m, 1 m, 1 m], at [-3 m, 0, 0.5 m] }} }}\nsuccess survived");
    insta::assert_snapshot!(between(&before, &after), @r"
    example
      ~ object seat
          position [-3, 0, 0.5] m -> [-2, 0, 0.5] m (-33.33 %)
      ~ term tall
          weight 10 -> 12 (+20 %)
          range 5..20 -> 5..30 (+50 %)
      ~ term still
          from exp(−10 s/m · com.speed)
            to exp(−12 s/m · com.speed) (+20 %)
      + term new: weight 3, once(ended)
      ~ term sunk
          same source, different value (pelvis.height < low): a name in it has changed
          in SI units 0.8 -> 0.7 (-12.5 %)
      ~ ends by fallen
          from com.height < 0.8 m
            to com.height < 0.75 m (-6.25 %)
      + ends by flew: com.height > 2 m
      ~ success
          from survived
            to survived and pelvis.height > 1 m
      - term high: weight 2, clip(steps_high / 10, 0, 1)
      ~ order of channels
          pelvis.height, steps_high -> steps_high, pelvis.height
    ");
}

#[test]
fn the_schedule_of_a_weight_is_part_of_what_a_task_means() {
    let [early, late] = ["20 -> 10 over 30 %", "20 -> 10 over 20 % .. 50 %"]
        .map(|weight| BEFORE.replace("10 (5..20) tall", &format!("{weight} (5..20) tall")));
    assert_ne!(hash(BEFORE), hash(&early));
    assert_ne!(hash(&early), hash(&late));
    insta::assert_snapshot!(between(&early, &late));
    insta::assert_snapshot!(between(BEFORE, &early));
}

#[test]
fn whether_a_parameter_changes_from_episode_to_episode_is_part_of_what_a_task_means() {
    let with = |clause: &str| BEFORE.replace("let low = 0.8 m", &format!("params {{ low = 0.8 m (0.5..0.9 m) {clause} }}"));
    let [fixed, open] = [with(""), with("per episode")];
    assert_ne!(hash(&fixed), hash(&open));
    insta::assert_snapshot!(between(&fixed, &open));
    assert_ne!(hash(&open), hash(&open.replace("0.9 m", "1 m")));
}

#[test]
fn whether_a_learner_bootstraps_is_part_of_what_a_task_means() {
    let with = |word: &str| format!("{BEFORE}\nfinish {{ arrived {word} when com.position.x > 2 m }}");
    let [ends, goes_on] = [with(""), with("bootstrap")];
    assert_ne!(hash(&ends), hash(&goes_on));
    insta::assert_snapshot!(between(&ends, &goes_on));
}

#[test]
fn a_name_that_means_something_else_is_reported_as_it_is_typed() {
    let ends = "fallen when com.height < 0.8 m";
    let before = format!(
        "{}\nlet bent = knee_angle_r.q > limit\nlet limit = 40 deg",
        BEFORE.replace(ends, &format!("{ends}\n folded when bent"))
    );
    let after = before.replace("40 deg", "45 deg").replace("let low = 0.8 m", "let low = 70 cm");
    let (before, after) = (task(&before), task(&after));
    let difference = Difference::between(&before.snapshot(), &after.snapshot(), true).with_names(&before, &after);
    insta::assert_snapshot!(difference, @r"
    example
      ~ term sunk
          same source, different value (pelvis.height < low): a name in it has changed
          low = 0.8 m -> 70 cm
      ~ ends by folded
          same source, different value (bent): a name in it has changed
          limit = 40 deg -> 45 deg (+12.5 %)
      ~ success
          same source, different value (survived and torso.up.z > 0.5): a name in it has changed
          in SI units 0.6981 -> 0.7854 (+12.5 %)
    ");
}

#[test]
fn what_a_snapshot_holds_in_bare_numbers_is_shown_with_units_and_angles_in_degrees() {
    let init = |knee: &str, noise: &str| {
        format!(
            "{BEFORE}
            init {{
                pose neutral {{ knee_angle_r = {knee} }}
                noise [knee_angle_r, hip_flexion_r] normal(0, {noise})
                root {{ height on ground, heading {knee} }}
            }}"
        )
    };
    let (before, after) = (task(&init("40 deg", "0.5 deg")), task(&init("50 deg", "1 deg")));
    let difference = Difference::between(&before.snapshot(), &after.snapshot(), true).with_units(&after);
    insta::assert_snapshot!(difference, @r"
    example
      ~ root
          orientation heading 40 deg, pitch 0 deg, roll 0 deg -> heading 50 deg, pitch 0 deg, roll 0 deg (+25 %)
      ~ pose
          knee_angle_r 40 deg -> 50 deg (+25 %)
      ~ noise on coordinates
          normal 0.5 deg -> normal 1 deg (+100 %): hip_flexion_r, knee_angle_r
    ");
    // Programs read SI units, now with their names.
    let mut fields = difference.changes.iter().flat_map(|change| &change.fields);
    assert!(fields.any(|field| field.after.as_deref() == Some("0.8726646259971648 rad")));
}

#[test]
fn a_change_of_one_term_changes_its_section_only() {
    let (before, after) = (snapshot(BEFORE), snapshot(&BEFORE.replace("-10 s/m", "-12 s/m")));
    let differing: Vec<String> = before
        .sections
        .iter()
        .zip(&after.sections)
        .filter(|(before, after)| before != after)
        .map(|(before, _)| before.title())
        .collect();
    assert_eq!(differing, ["term still"]);
}

#[test]
fn an_object_more_changes_no_formula() {
    let scene = |more: &str| {
        format!(
            "scene {{ ground\n {more} box seat {{ size [1 m, 1 m, 1 m], at [-3 m, 0, 0.5 m] }} }}\nreward {{\n1 a = seat.height / 1 m\n}}"
        )
    };
    let difference = between(&scene(""), &scene("box other { size [1 m, 1 m, 1 m], at [3 m, 0, 0.5 m] }\n"));
    let changes: Vec<(ChangeKind, &str, &str)> =
        difference.changes.iter().map(|change| (change.kind, change.section.as_str(), change.name.as_str())).collect();
    assert_eq!(changes, [(ChangeKind::Added, "object", "other")], "{difference}");
}

#[test]
fn the_order_of_questions_to_the_ground_does_not_show_in_the_hash() {
    let (first, second) = ("1 a = ground_height(pelvis) / 1 m", "2 b = ground_height(torso) / 1 m");
    let with_let = |order: [&str; 2]| {
        let lets = order.map(|place| format!("let under_{place} = ground_height({place}) / 1 m\n")).concat();
        format!("{lets}reward {{\n1 a = under_pelvis\n2 b = under_torso\n}}")
    };
    assert_eq!(hash(&with_let(["pelvis", "torso"])), hash(&with_let(["torso", "pelvis"])));
    let finish_first = format!("finish {{\nthere when ground_height(torso) > 1 m\n}}\nreward {{\n{first}\n{second}\n}}");
    let plain = format!("reward {{\n{first}\n{second}\n}}\nfinish {{\nthere when ground_height(torso) > 1 m\n}}");
    assert_eq!(hash(&finish_first), hash(&plain));
    assert_ne!(hash(&plain), hash(&plain.replace("torso", "head")));
}

#[test]
fn what_two_terms_swap_is_a_change_of_order() {
    let difference = between("reward {\n1 a = 1\n2 b = com.height / 1 m\n}", "reward {\n2 b = com.height / 1 m\n1 a = 1\n}");
    assert_eq!(difference.changes.len(), 1);
    assert_eq!(difference.changes[0].kind, ChangeKind::Reordered);
    assert!(difference.to_string().contains("~ order of terms\n      a, b -> b, a"), "{difference}");
}

#[test]
fn the_hash_stays_until_its_encoding_changes() {
    // Written down for version 3 of the encoding. If this fails and the task below means the same, raise the version
    // (`snapshot/encoding.rs`), describe the change in `docs/content-hash.md` and in the changelog, and write the new hash down.
    let everything = "
        random far = uniform(1 m .. 2 m)
        clock beat at 1 Hz
        state best = 0 becomes best + 1 when rising(com.height > 1 m)
        scene {
            ground
            stairs flight { count 3, rise 15 cm, run 30 cm, width 1 m, at [2 m, 0, 0] }
            box door { size [4 cm, 80 cm, 2 m], mass 20 kg, at [1 m, 0, 1 m], hinge swing { axis [0, 0, 1], range 0 deg .. 90 deg } }
        }
        init { pose neutral
            noise joints normal(0, 0.01 rad) }
        reward {
            10 (5..20) a = exp(-norm(pelvis.velocity) / 1 m/s) + sin(beat) + far / 1 m
             2         b = clip(smooth(com.height / 1 m, 0.1 s)^1.5, 0, 1) when door.swing.q < 10 deg
            -1         c = max(hypot(1, best), delay(muscles.activation[0], 3 steps)) - min([1, 2, com.speed / 1 m/s])
        }
        terminate { low when held(pelvis.height < 0.5 m, 0.1 s) }
        observe { pelvis.height }
        success survived";
    assert_eq!(hash(everything), "1f4f75fa2c424be26798a1981d7e8df229dc5b3aef959d15d29f3326bb16ef39");
}
