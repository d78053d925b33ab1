//! Motions that episodes follow: where they begin, that all readers see one phase, and where landmarks are.

use msk_compiler::compile;
use msk_compiler::files::{LoadError, Loader};
use msk_runtime::episode::{Environment, EpisodeKey};
use msk_runtime::library::{BodyLibrary, BoundBody};
use std::path::Path;

/// One leg swings, the pelvis walks on and nods.
const GAIT: &str = "# name: gait\n# source: made up\n# cycle: yes\n# duration: 1.6 s\n# advances: root.x\n\
    phase, hip_flexion_r [deg], knee_angle_r [deg], root.x [m], root.y [m], root.height [m], root.heading [deg], root.pitch [deg]\n\
    0,    30,  5,  0,   0.00,  1.00, 0,  0\n\
    0.25, 10,  60, 0.5, 0.01,  1.02, 4,  5\n\
    0.5,  -10, 10, 0.8, 0.00,  1.00, 0,  0\n\
    0.75, 10,  14, 1.2, -0.01, 1.02, -4, 5\n\
    1,    30,  5,  1.6, 0.00,  1.00, 0,  0\n";

const TASK: &str = r#"
task follow {
    family  test
    body    human
    control 100 Hz
    horizon 100 steps
    reference gait = motion "motions/gait.csv" start START
    init {
        pose gait { elbow_flexion_r = 20 deg }
        root { at [3 m, -2 m] }
    }
    observe {
        gait.phase
        q      = gait.q
        joints = gait.joints.q
        qd     = gait.qd - gait.joints.qd
        root   = gait.root - pelvis.position
        speed  = gait.velocity - pelvis.velocity
        turned = [gait.heading - pelvis.yaw, gait.pitch - pelvis.pitch]
        ankle  = gait.site(ankle_r) - ankle_r.position
        elbow_flexion_r.q
        knee = knee_angle_r.qd
    }
    reward { 1 stay = exp(-mean((gait.q - gait.joints.q)^2) / 1 rad^2) }
    success survived
}
"#;

/// The task and the motion, and nothing else.
struct Texts(String);

impl Loader for Texts {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        match path.to_str() {
            Some("task.msk") => Ok(self.0.clone()),
            Some("motions/gait.csv") => Ok(GAIT.to_owned()),
            _ => Err(LoadError::Missing(path.into())),
        }
    }
}

fn episode(start: &str) -> Environment {
    let library = BodyLibrary::default();
    let texts = Texts(TASK.replace("START", start));
    let compilation = compile(Path::new("task.msk"), &texts, &library).unwrap_or_else(|report| panic!("{report}"));
    let task = compilation.tasks[0].clone();
    let BoundBody { model, body, .. } = library.stage(&task.body, &task.scene).unwrap();
    Environment::new(model, body, task).unwrap()
}

/// A channel of the observation.
fn channel<'a>(episode: &'a Environment, name: &str) -> &'a [f64] {
    let channel = episode.task().channels.iter().find(|channel| channel.name == name).unwrap();
    &episode.observation()[channel.offset..channel.offset + channel.size]
}

fn is_small(values: &[f64], limit: f64) -> bool {
    values.iter().all(|value| value.abs() < limit)
}

/// Everything that is read of the motion agrees with where the body is and how fast.
fn begins_as_the_motion(episode: &Environment) {
    let (wanted, found) = (channel(episode, "q"), channel(episode, "joints"));
    assert!(wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-12), "{wanted:?} {found:?}");
    // The model's pelvis is turned against its root by 0.8 mrad.
    for (name, limit) in [("qd", 1e-9), ("root", 1e-9), ("speed", 1e-9), ("turned", 1e-3)] {
        assert!(is_small(channel(episode, name), limit), "{name}: {:?}", channel(episode, name));
    }
    assert!(is_small(channel(episode, "ankle"), 1e-4), "ankle: {:?}", channel(episode, "ankle"));
    assert!((channel(episode, "elbow_flexion_r.q")[0] - 20_f64.to_radians()).abs() < 1e-12);
}

#[test]
fn an_episode_begins_where_the_motion_is_and_as_fast() {
    for start in ["0", "0.25", "0.5", "0.413"] {
        let episode = episode(start);
        assert!(episode.ending().is_none(), "{:?}", episode.ending());
        assert_eq!(channel(&episode, "gait.phase"), [start.parse::<f64>().unwrap()]);
        begins_as_the_motion(&episode);
    }
    // The initial state is not at rest: the knee bends fast at its steepest.
    assert!(channel(&episode("0.1"), "knee")[0] > 1.0);
}

#[test]
fn a_drawn_start_is_the_episodes_own_and_all_readers_see_it() {
    let mut episode = episode("uniform");
    let mut phases = Vec::new();
    for number in 0..6 {
        episode.reset(EpisodeKey { seed: 5, episode: number });
        begins_as_the_motion(&episode);
        phases.push(channel(&episode, "gait.phase")[0]);
    }
    assert!(phases.iter().all(|phase| (0.0..1.0).contains(phase)));
    assert!(phases.windows(2).all(|pair| (pair[0] - pair[1]).abs() > 1e-6), "{phases:?}");
    episode.reset(EpisodeKey { seed: 5, episode: 2 });
    assert_eq!(channel(&episode, "gait.phase")[0], phases[2]);
    // Every control step takes a hundredth of a second of the cycle's 1.6 s.
    let rest = vec![-1.0; episode.context().body.muscles.len()];
    for step in 1..=5 {
        episode.step(&rest).unwrap();
        let expected = (phases[2] + 0.01 * f64::from(step) / 1.6).fract();
        assert!((channel(&episode, "gait.phase")[0] - expected).abs() < 1e-12);
    }
}

#[test]
fn the_content_of_the_table_enters_the_hash() {
    let hash = |gait: &str| {
        struct Other(String, String);
        impl Loader for Other {
            fn load(&self, path: &Path) -> Result<String, LoadError> {
                match path.to_str() {
                    Some("task.msk") => Ok(self.0.clone()),
                    Some("motions/gait.csv") => Ok(self.1.clone()),
                    _ => Err(LoadError::Missing(path.into())),
                }
            }
        }
        let texts = Other(TASK.replace("START", "0"), gait.to_owned());
        compile(Path::new("task.msk"), &texts, &BodyLibrary::default()).unwrap_or_else(|report| panic!("{report}")).tasks[0]
            .hash
            .clone()
    };
    let same = GAIT.replace("# name: gait", "# name: another name\n# a remark");
    assert_eq!(hash(GAIT), hash(&same));
    assert_ne!(hash(GAIT), hash(&GAIT.replace("0.5,  -10", "0.5,  -10.001")));
    assert_ne!(hash(GAIT), hash(&GAIT.replace("1.6 s", "1.61 s")));
}
