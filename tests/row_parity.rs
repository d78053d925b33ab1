//! Every kind of constraint gives MuJoCo 4.0.0's rows and, once solved, its accelerations: one small model per feature.
//! `tests/oracle/rows.py` made the golden numbers.

use crate::support;

use msk_physics::model::Model;
use serde_json::Value;
use support::{golden, repository, rows};

fn compare(name: &str) {
    let path = repository("tests/oracle/row_models").join(format!("{name}.xml"));
    let model = Model::from_file(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    rows::compare(name, &model, &golden(&format!("rows_{name}")), 1e-8, 1.0, |_| Vec::new());
}

macro_rules! features {
    ($($name:ident),* $(,)?) => {
        $(#[test]
        fn $name() {
            compare(stringify!($name));
        })*

        #[test]
        fn every_model_is_compared() {
            let mut names: Vec<String> = std::fs::read_dir(repository("tests/oracle/row_models"))
                .unwrap()
                .map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
                .collect();
            names.sort();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

features!(
    condim1,
    condim3,
    condim4,
    condim6,
    connect,
    elliptic_condim3,
    elliptic_condim4,
    elliptic_condim6,
    everything,
    fixed_tendon,
    frictionloss_joint,
    frictionloss_tendon,
    gap_margin,
    impratio,
    impratio_pyramid,
    no_slip_elliptic_condim3,
    no_slip_elliptic_condim4,
    no_slip_elliptic_condim6,
    no_slip_pyramid,
    pair_overrides,
    priority_mix,
    refsafe_off,
    solimp_cases,
    solref_direct,
    switched_off,
    tendon_armature,
    tendon_equality,
    tendon_limit,
    weld,
    weld_sites,
);

/// The golden file's version is the oracle's.
#[test]
fn the_golden_numbers_are_those_of_the_oracle() {
    assert_eq!(golden("rows_weld")["mujoco"], Value::from("4.0.0"));
}
