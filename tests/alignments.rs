//! `align`: joints that reach, objects that follow.

use super::episodes::episode;
use super::task_tests::{holds, played};
use msk::runtime::episode::EpisodeKey;

#[test]
fn joints_bring_a_palm_to_an_object_and_the_root_stays() {
    holds(
        "test \"reaching\" {
            moment standing { pose neutral }
            moment reaching {
                pose neutral { cube.at = [0.3 m, -0.2 m, 1 m], align palm_r to cube with arms }
            }
            expect norm(palm_r.position - cube.position) < 1 mm at reaching
            expect norm(palm_r.position - cube.position) > 20 cm at standing
            expect pelvis.height at standing <= pelvis.height at reaching <= pelvis.height at standing
            expect palm_l.position.x at standing <= palm_l.position.x at reaching <= palm_l.position.x at standing
        }",
    );
}

#[test]
fn two_palms_share_the_joints_of_the_trunk() {
    holds(
        "test \"both hands\" {
            pose neutral {
                align palm_r to [0.5 m, -0.15 m, 0.9 m] with [arms, lumbar]
                align palm_l to [0.5 m, 0.15 m, 0.9 m] with [arms, lumbar]
            }
            expect norm(palm_r.position - [0.5 m, -0.15 m, 0.9 m]) < 1 mm
            expect norm(palm_l.position - [0.5 m, 0.15 m, 0.9 m]) < 1 mm
        }",
    );
}

#[test]
fn a_hand_is_laid_on_the_knee() {
    holds(
        "test \"resting\" {
            pose squatting { align palm_r to knee_r with [arms, lumbar] }
            expect norm(palm_r.position - knee_r.position) < 1 mm
        }",
    );
}

#[test]
fn joints_stay_within_their_ranges_and_say_how_near_they_come() {
    let reports =
        played("test \"too far\" { pose neutral { align palm_r to [3 m, 0 m, 1 m] with arms }; expect pelvis.height > 0 m }");
    let message = format!("{:?}", reports[0]);
    assert!(!reports[0].passed());
    assert!(message.contains("`palm_r` is still") && message.contains("[3.000 m, 0.000 m, 1.000 m]"), "{message}");
}

#[test]
fn what_is_aligned_at_two_keyframes_stays_aligned_between_them() {
    holds(
        "test \"carrying\" {
            pose neutral
            at 0.5 s pose neutral { align cube to palm_r }
            at 1.5 s { root.at = [1 m, 0 m], shoulder_elevation_r = 60 deg } as carried
            at 1.51 s { cube.at = [1.3 m, 0 m, 0.05 m] }
            until 2.5 s
            expect norm(palm_r.position - cube.position) < 1 mm at carried
            expect cube.position.z < 6 cm
        }
        test \"holding on\" {
            pose neutral { align palm_r to [0.3 m, -0.2 m, 1.1 m] with arms }
            at 1 s { root.pitch = 5 deg } as leaning
            until 1 s
            expect norm(palm_r.position - [0.3 m, -0.2 m, 1.1 m]) < 1 mm at leaning
        }",
    );
}

#[test]
fn on_the_way_between_keyframes_a_hand_stays_where_it_holds_on() {
    holds(
        "metrics { away = max(norm(palm_r.position - [0.3 m, -0.2 m, 1.1 m]), 0 m) }
        test \"holding on\" {
            pose neutral { align palm_r to [0.3 m, -0.2 m, 1.1 m] with arms }
            at 1 s { root.pitch = 8 deg, root.height = 90 cm }
            until 0.5 s
            expect norm(palm_r.position - [0.3 m, -0.2 m, 1.1 m]) < 1 mm
        }",
    );
}

#[test]
fn an_object_begins_in_the_hand() {
    let mut environment = episode(&[
        ("init {", "scene { ground; box cube { size [10 cm, 10 cm, 10 cm], mass 1 kg, free, at [3 m, 0, 1 m], point grip { at [0, 0, 5 cm] } } }
            init { cube { align cube.grip to palm_r, velocity [0, 0, 0] }"),
        ("observe {", "observe { held = cube.grip.position - palm_r.position; below = cube.position - palm_r.position;"),
    ]);
    for episode in 0..5 {
        environment.reset(EpisodeKey { seed: 1, episode });
        let observation = environment.observation();
        assert!(observation[..3].iter().all(|away| away.abs() < 1e-9), "{:?}", &observation[..6]);
        assert!((observation[5] + 0.05).abs() < 1e-9, "{:?}", &observation[..6]);
    }
}
