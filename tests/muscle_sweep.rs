//! Muscles over joint sweeps: lengths and moment arms are MuJoCo's (`tests/oracle/moment_arms.py` made the golden ones) and
//! those of finite differences; `msk physics muscle` prints and draws them.

use crate::support;

use msk_physics::model::Model;
use msk_physics::{State, Workspace, moment_arm, moment_arms, smooth};
use msk_runtime::inspect::sweep_muscle;
use serde_json::Value;
use std::process::{Command, Output};
use std::sync::OnceLock;
use support::{SplitMix, draw, golden, repository};

fn human() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| Model::from_file(repository("bodies/models/human416.xml")).expect("the body loads"))
}

fn msk(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_msk")).args(["physics", "muscle"]).args(arguments).output().unwrap()
}

#[test]
fn lengths_and_moment_arms_over_sweeps_are_those_of_mujoco() {
    let golden = golden("moment_arms");
    let steps = golden["steps"].as_u64().unwrap() as usize;
    let mut compared = 0;
    for sweep in golden["sweeps"].as_array().unwrap() {
        let (muscle, joint) = (sweep["muscle"].as_str().unwrap(), sweep["joint"].as_str().unwrap());
        let found = sweep_muscle(human(), &State::new(human()), muscle, joint, steps).unwrap();
        for (found, expected) in found.samples.iter().zip(sweep["samples"].as_array().unwrap()) {
            let number = |name: &str| expected[name].as_f64().unwrap();
            assert!((found.coordinate - number("coordinate")).abs() < 1e-12);
            assert!((found.length - number("length")).abs() < 1e-9, "{muscle}: {} m", found.length);
            assert!((found.moment_arm - number("moment_arm")).abs() < 1e-9, "{muscle} on {joint}: {} m", found.moment_arm);
            assert!((found.own_moment_arm - number("own")).abs() < 1e-9);
            compared += 1;
        }
    }
    assert_eq!(compared, 130);
}

#[test]
fn moment_arms_are_the_slopes_of_lengths() {
    for (muscle, joint) in [("soleus_r", "ankle_angle_r"), ("recfem_l", "knee_angle_l"), ("DELT2", "shoulder_elv_r")] {
        // Steps so small that central differences are good to a micrometre.
        let found = sweep_muscle(human(), &State::new(human()), muscle, joint, 4000).unwrap();
        let mut kinks = 0;
        for samples in found.samples.windows(3) {
            let slope = (samples[2].length - samples[0].length) / (samples[2].coordinate - samples[0].coordinate);
            if (slope + samples[1].moment_arm).abs() > 2e-6 {
                // Where a wrap begins or ends the slope has a corner.
                let touched = |at: usize| samples[at].wraps.iter().map(|wrap| wrap.touches).collect::<Vec<_>>();
                assert_ne!(touched(0), touched(2), "{muscle} at {} rad: {slope}", samples[1].coordinate);
                kinks += 1;
            }
        }
        assert!(kinks <= 8, "{muscle}: {kinks}");
    }
}

#[test]
fn one_moment_arm_is_an_entry_of_the_row() {
    let (mut random, mut workspace) = (SplitMix(8), Workspace::new(human()));
    let state = draw(human(), &mut random);
    smooth(human(), &state, &mut workspace);
    let mut row = vec![0.0; human().nv];
    for tendon in (0..human().tendons.name.len()).step_by(7) {
        moment_arms(human(), &workspace.kinematics, &workspace.tendons, tendon, &mut row);
        for (dof, entry) in row.iter().enumerate() {
            let single = moment_arm(human(), &workspace.kinematics, &workspace.tendons, tendon, dof);
            assert!((single + entry).abs() < 1e-13, "{} on dof {dof}: {single} is not {}", human().tendons.name[tendon], -entry);
        }
    }
}

#[test]
fn the_command_prints_path_wraps_and_curve() {
    let output = msk(&["recfem_r", "--joint", "knee_angle_r", "--steps", "4"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.starts_with("recfem_r on knee_angle_r, tendon recfem_r_tendon\n"), "{text}");
    assert!(text.contains("coupled joints: ") && text.contains("knee_angle_beta_translation1_r"), "{text}");
    assert!(text.contains("peak force 2212 N") && text.contains("  start ") && text.contains("  on pelvis"), "{text}");
    assert!(text.contains("\n   120.00 ") || text.contains("\n   119.9"), "{text}");

    assert!(!text.contains("operating range"), "{text}");
    let output = msk(&["Ps_L1_VB_r", "--joint", "hip_flexion_r", "--steps", "4"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("leaves no tendon: with `tendons elastic` 18.7 mm of the path would be elastic"), "{text}");

    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("soleus.svg");
    let output = msk(&["soleus_r", "--joint", "ankle_angle_r", "--json", "--plot", picture.to_str().unwrap()]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((report["unit"].as_str(), report["samples"].as_array().unwrap().len()), (Some("rad"), 41));
    let arm = report["samples"][20]["moment_arm"].as_f64().unwrap();
    // The calf pulls the foot down: dorsiflexion is positive.
    assert!((-0.06..-0.03).contains(&arm), "{arm} m");
    let picture = std::fs::read_to_string(picture).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("ankle_angle_r [deg]") && picture.contains("moment arm [mm]"));
}

#[test]
fn what_cannot_be_swept_is_refused_in_words() {
    let refused = |arguments: &[&str], expected: &str| {
        let output = msk(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && message.starts_with("error: ") && message.contains(expected), "{message}");
    };
    refused(&["solus_r", "--joint", "ankle_angle_r"], "no muscle `solus_r`; did you mean `soleus_r`?");
    refused(&["soleus_r", "--joint", "ankel_angle_r"], "no hinge or slide `ankel_angle_r`; did you mean `ankle_angle_r`?");
    refused(
        &["recfem_r", "--joint", "knee_angle_translation1_r"],
        "joint `knee_angle_translation1_r` is coupled to another joint; sweep the independent one, `knee_angle_r`",
    );
    refused(&["soleus_r", "--joint", "root"], "no hinge or slide `root`");
}
