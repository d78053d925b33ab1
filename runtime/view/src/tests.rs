use super::*;
use crate::anatomy::{Anatomy, Waypoint};
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace, kinematics};
use msk_program::body::{Axis, BodyDescription};
use msk_program::task::RootPlacement;
use msk_runtime::bodies;
use msk_runtime::body::Body;
use msk_runtime::body::sensors::Snapshot;
use std::path::Path;

/// The full body, and the same with its knees bent.
fn human() -> (Model, Body) {
    let model = bodies::model(&Path::new(bodies::ROOT).join("bodies/models/human416.xml")).unwrap();
    let bend = |joint: &str, angle: f64| ["l", "r"].map(|side| (format!("{joint}_{side}"), angle));
    let crouch = [bend("hip_flexion", 0.8), bend("knee_angle", 1.2), bend("ankle_angle", 0.4)].concat();
    let description = BodyDescription {
        name: "human".into(),
        root: "Full Body".into(),
        root_forward: Axis::MinusY,
        root_up: Axis::PlusZ,
        poses: vec![("neutral".into(), Vec::new()), ("crouch".into(), crouch)],
        ..BodyDescription::default()
    };
    let body = Body::bind(&description, &model).unwrap();
    (model, body)
}

/// A way from standing to a crouch in so many frames.
pub(crate) fn crouching(frames: u32, mut look: impl FnMut(u32, &Snapshot<'_>)) {
    let (model, body) = human();
    let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
    let crouch = body.pose("crouch").unwrap();
    for frame in 0..frames {
        let share = f64::from(frame) / f64::from(frames - 1);
        let pose: Vec<f64> = body.neutral().iter().zip(crouch).map(|(from, to)| from + share * (to - from)).collect();
        body.place(&model, &RootPlacement::default(), &pose, &mut state, &mut workspace);
        state.activation.fill(0.5 * share);
        physics::forward(&model, &state, &mut workspace).unwrap();
        look(frame, &Snapshot { body: &body, model: &model, state: &state, workspace: &workspace });
    }
}

fn recording(frames: u32) -> Recording {
    let mut recorder = None;
    crouching(frames, |frame, snapshot| {
        recorder.get_or_insert_with(|| Recorder::of(snapshot, &[], 0.02)).look_at(frame, snapshot);
    });
    recorder.unwrap().recording(Caption { task: "crouch <down>".into(), ..Caption::default() }).unwrap()
}

#[test]
fn the_same_recording_gives_the_same_page_and_it_is_small() {
    let pages = [(); 2].map(|()| page("crouch <down>", &[recording(50)]).unwrap());
    assert_eq!(pages[0], pages[1]);
    assert!(pages[0].contains("<title>crouch &lt;down&gt;</title>"));
    // The model alone takes 45 kB.
    assert!(pages[0].len() < 180_000, "{} bytes", pages[0].len());
}

#[test]
fn nothing_of_a_page_comes_from_elsewhere() {
    let page = page("crouch", &[recording(2)]).unwrap();
    let program = &page[..page.rfind("<script type=\"application/octet-stream\"").unwrap()];
    for reaching in ["http:", "https:", "import(", "import ", "fetch(", "XMLHttpRequest", "WebSocket", "<link"] {
        assert!(!program.contains(reaching), "`{reaching}`");
    }
    assert!(program.contains("default-src 'none'"));
}

#[test]
fn a_page_has_each_model_once() {
    let one = page("one", &[recording(20)]).unwrap().len();
    let two = page("two", &[recording(20), recording(20)]).unwrap().len();
    assert!(two - one < 12_000, "{one} and {two} bytes");
}

/// What the page places from stored coordinates is where it was.
#[test]
fn quantised_coordinates_move_no_body_by_more_than_a_tenth_of_a_millimetre() {
    let mut worst: f64 = 0.0;
    crouching(9, |_, snapshot| {
        let mut state = snapshot.state.clone();
        state.position.iter_mut().for_each(|value| *value = f64::from(track::quantise(*value, 4e-5)) * 4e-5);
        let mut found = snapshot.workspace.kinematics.clone();
        kinematics::update(snapshot.model, &state, &mut found);
        for (there, here) in snapshot.workspace.kinematics.body_position.iter().zip(&found.body_position) {
            worst = worst.max((there - here).norm());
        }
    });
    assert!(worst < 1e-4, "{worst} m");
}

/// The length of each path from what is stored is that of the physics: sites, touched places and the way around surfaces are right.
#[test]
fn paths_are_as_long_as_those_of_the_physics() {
    crouching(3, |_, snapshot| {
        let anatomy = Anatomy::of(snapshot, &[]);
        let mut rows = vec![0; wraps::WIDTH * anatomy.wraps.len()];
        wraps::update(snapshot, &anatomy.wraps, &mut rows);
        for (index, muscle) in anatomy.muscles.iter().enumerate() {
            let found = length(snapshot, &anatomy, &rows, &muscle.path);
            let expected = snapshot.workspace.actuation.length[index];
            assert!((found - expected).abs() < 5e-4, "{}: {found} m, not {expected} m", muscle.name);
        }
    });
}

/// What `pathOf` of the page does.
fn length(snapshot: &Snapshot<'_>, anatomy: &Anatomy, rows: &[i32], path: &[Waypoint]) -> f64 {
    use nalgebra::Vector3;
    let kinematics = &snapshot.workspace.kinematics;
    let (mut length, mut last, mut bend) = (0.0, None::<Vector3<f64>>, None);
    let mut go = |last: &mut Option<Vector3<f64>>, to: Vector3<f64>| {
        length += last.map_or(0.0, |from| (to - from).norm());
        *last = Some(to);
    };
    let mut around = 0.0;
    for point in path {
        match *point {
            Waypoint::Branch => last = None,
            Waypoint::Wrap(wrap) => bend = Some(wrap),
            Waypoint::Site(body, x, y, z) => {
                if let Some(index) = bend.take() {
                    let row = &rows[wraps::WIDTH * index..wraps::WIDTH * (index + 1)];
                    let place = |first: usize| Vector3::from_fn(|axis, _| f64::from(row[first + axis]) * wraps::QUANTUM);
                    let wrap = &anatomy.wraps[index];
                    let world =
                        |place: Vector3<f64>| kinematics.geom_position[wrap.geom] + kinematics.geom_rotation[wrap.geom] * place;
                    if row[0] != 0 {
                        let (from, to) = (place(1), place(4));
                        go(&mut last, world(from));
                        let full = std::f64::consts::TAU;
                        let (angle, climb) = match wrap.sphere {
                            true => (from.angle(&to), 0.0),
                            false => ((to.y.atan2(to.x) - from.y.atan2(from.x)).rem_euclid(full), to.z - from.z),
                        };
                        let angle = if row[0] == 1 { angle } else { full - angle };
                        around += (angle * wrap.radius).hypot(climb);
                        last = Some(world(to));
                    }
                }
                go(&mut last, kinematics.body_position[body] + kinematics.body_rotation[body] * Vector3::new(x, y, z));
            }
        }
    }
    length + around
}

#[test]
fn an_episode_that_could_not_begin_is_no_page() {
    let (model, body) = human();
    let (state, workspace) = (State::new(&model), Workspace::new(&model));
    let recorder = Recorder::of(&Snapshot { body: &body, model: &model, state: &state, workspace: &workspace }, &[], 0.01);
    assert_eq!(recorder.recording(Caption::default()).unwrap_err(), RecordingError::Empty);
}
