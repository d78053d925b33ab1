//! Tasks as modules in Python: how they read, and what is refused. `python/tests/test_export.py` compares what they compute.

use super::episodes::episode;
use msk::export::{NotExportable, python};
use msk::runtime::episode::Environment;

fn exported(environment: &Environment) -> Result<String, NotExportable> {
    let engine = environment.engine();
    python(engine.task(), engine.body(), engine.model()).map(|exported| exported.module)
}

/// The methods of the usual task with other parts.
fn methods(parts: &[(&str, &str)]) -> String {
    let module = exported(&episode(parts)).unwrap();
    module.split_once("    # Values").map(|(_, methods)| methods.to_owned()).unwrap()
}

#[test]
fn names_units_and_formulas_are_kept() {
    let module = methods(&[
        ("init {", "let lean = 1 - torso.up.z\n let lift = pelvis.height - initial(pelvis.height)\n init {"),
        ("2 upright = torso.up.z", "2 upright = exp(-5 * lean)\n 1 low = lift < -10 cm and not terminated"),
        ("success survived", "metrics { best = running_max(lift) }\n success survived and lean < 0.2"),
    ]);
    insta::assert_snapshot!(module);
}

#[test]
fn states_and_randoms_have_methods() {
    let module = methods(&[
        (
            "init {",
            "random goal = uniform(0.2 m .. 0.5 m, -0.5 m .. 0.1 m, 1 m .. 1.4 m) where norm(goal - [0, 0, 1.2 m]) > 0.3 m redraw when met\n \
             let met = distance(goal, palm_r) < 5 cm\n state touches: int = 0 becomes touches + 1 when rising(met)\n init {",
        ),
        ("independent.q", "touches; goal - palm_r.position"),
        ("2 upright = torso.up.z", "2 upright = exp(-1 * touches)"),
    ]);
    insta::assert_snapshot!(module);
}

#[test]
fn what_mujoco_does_not_measure_is_refused_with_every_reason() {
    let parts = [("2 upright = torso.up.z", "2 upright = support_margin / 1 m + norm(centre_of_pressure - com.position) / 1 m")];
    let refused = exported(&episode(&parts)).unwrap_err();
    assert_eq!(refused.reasons.len(), 2, "{refused}");
    assert!(refused.to_string().contains("`support_margin`: MuJoCo's data do not have it"), "{refused}");
}

#[test]
fn actions_of_muscles_are_known_where_the_policy_gives_them() {
    let parts = [("3 change = 1 s/m * rate(pelvis.height)", "3 change = soleus_r.action")];
    assert!(exported(&episode(&parts)).is_ok());
    let parts = [parts[0], ("control 100 Hz", "control 100 Hz\n act synergies { of [calves] }")];
    let refused = exported(&episode(&parts)).unwrap_err();
    assert!(refused.to_string().contains("the action that reaches a muscle"), "{refused}");
}
