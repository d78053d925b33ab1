//! The human body file agrees with its model: landmarks are where and how they are named, poses are possible.

use msk::compiler::compile;
use msk::compiler::diagnostics::Style;
use msk::compiler::task::RootPlacement;
use msk::physics::{self, State, Workspace};
use msk::runtime::library::{BodyLibrary, BoundBody, FileLoader};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;
use std::path::Path;

fn human() -> BoundBody {
    let library = BodyLibrary::default();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/bodies/human.msk");
    let compilation = compile(Path::new(file), &FileLoader, &library);
    let compilation = compilation.unwrap_or_else(|report| panic!("{}", report.render(Style::Plain)));
    library.bind(&compilation.bodies[0]).unwrap()
}

/// The human in a pose on the ground.
struct Posed {
    human: BoundBody,
    state: State<f64>,
    workspace: Workspace<f64>,
}

fn posed(pose: &str) -> Posed {
    let human = human();
    let (mut state, mut workspace) = (State::new(&human.model), Workspace::new(&human.model));
    let coordinates = human.body.pose(pose).unwrap();
    human.body.place(&human.model, &RootPlacement::default(), coordinates, &mut state, &mut workspace);
    physics::forward(&human.model, &state, &mut workspace).unwrap();
    Posed { human, state, workspace }
}

impl Posed {
    fn landmark(&self, name: &str) -> (Vector3<f64>, Matrix3<f64>) {
        let landmark = self.human.body.landmarks.iter().find(|landmark| landmark.name == name).expect(name);
        let kinematics = &self.workspace.kinematics;
        let axes = kinematics.body_rotation[landmark.body] * landmark.axes;
        (kinematics.point(landmark.body, &landmark.point), axes)
    }

    fn height(&self, name: &str) -> f64 {
        self.landmark(name).0.z
    }

    fn com(&self) -> Vector3<f64> {
        self.workspace.kinematics.subtree_com[self.human.body.root.body]
    }
}

#[test]
fn standing_straight_the_landmarks_face_forward_and_up() {
    let standing = posed("neutral");
    // The arms hang off the trunk; everything else is aligned with the world.
    let arms = ["shoulder", "elbow", "wrist", "palm"];
    for landmark in &standing.human.body.landmarks {
        let tolerance = if arms.iter().any(|arm| landmark.name.starts_with(arm)) { 0.35 } else { 2e-3 };
        let error = (standing.landmark(&landmark.name).1 - Matrix3::identity()).norm();
        assert!(error < tolerance, "{} is off by {error}", landmark.name);
    }
}

#[test]
fn standing_straight_the_landmarks_are_at_their_heights() {
    let standing = posed("neutral");
    let root = standing.state.position[2];
    assert!((root - 0.9468).abs() < 1e-4, "the root is at {root} m");
    for (name, low, high) in [
        ("heel_l", 0.0, 0.003),
        ("sole_r", 0.0, 0.003),
        ("toes_l", 0.0, 0.003),
        ("ankle_r", 0.063, 0.065),
        ("knee_l", 0.45, 0.48),
        ("hip_r", 0.85, 0.89),
        ("pelvis", 0.94, 0.95),
        ("torso", 1.25, 1.35),
        ("chest", 1.25, 1.36),
        ("shoulder_l", 1.40, 1.45),
        ("elbow_r", 1.10, 1.16),
        ("wrist_l", 0.85, 0.92),
        ("palm_r", 0.80, 0.86),
        ("neck", 1.45, 1.52),
        ("chin", 1.48, 1.52),
        ("head", 1.53, 1.56),
        ("head_top", 1.71, 1.74),
    ] {
        let height = standing.height(name);
        assert!((low..high).contains(&height), "{name} is {height} m above the ground");
    }
}

#[test]
fn points_lie_on_the_side_of_the_body_that_their_names_say() {
    let standing = posed("neutral");
    let forward = |name: &str| standing.landmark(name).0.x;
    assert!(forward("toes_l") > forward("sole_l") && forward("sole_l") > forward("heel_l"));
    assert!(forward("chest") > forward("torso") + 0.05, "the chest is the front of the torso");
    assert!(forward("chin") > forward("head") + 0.05);
    let palm = standing.landmark("palm_l").0 - standing.landmark("wrist_l").0;
    assert!(palm.z < -0.03, "the palm is below the wrist");
}

#[test]
fn left_and_right_are_mirror_images() {
    let standing = posed("neutral");
    for landmark in &standing.human.body.landmarks {
        let Some(name) = landmark.name.strip_suffix("_l") else { continue };
        let (left, right) = (standing.landmark(&landmark.name).0, standing.landmark(&format!("{name}_r")).0);
        assert!(left.y > 0.05, "{name}_l is on the left");
        let error = (left - Vector3::new(right.x, -right.y, right.z)).norm();
        // The model's own sides differ by a third of a millimetre.
        assert!(error < 2e-3, "{name}: {error} m");
    }
}

#[test]
fn the_centre_of_mass_of_standing_poses_is_above_the_feet() {
    for (pose, heel, toes) in
        [("neutral", "heel_r", "toes_r"), ("squatting", "heel_l", "toes_l"), ("standing_on_right", "heel_r", "toes_r")]
    {
        let posed = posed(pose);
        let (heel, toes, com) = (posed.landmark(heel).0.x, posed.landmark(toes).0.x, posed.com().x);
        assert!(heel < com && com < toes, "{pose}: centre of mass at {com} m, foot from {heel} m to {toes} m");
    }
}

#[test]
fn in_no_pose_is_the_body_inside_itself_or_the_ground() {
    for pose in human().body.poses.iter().map(|pose| pose.name.clone()) {
        let posed = posed(&pose);
        let names = &posed.human.model.geoms.name;
        for contact in &posed.workspace.lanes[0].constraints.contacts {
            let [first, second] = contact.geoms.map(|geom| &names[geom]);
            assert!(contact.distance > -1e-3, "{pose}: {first} is {} m inside {second}", -contact.distance);
        }
    }
}

#[test]
fn poses_satisfy_the_couplings() {
    for pose in human().body.poses.iter().map(|pose| pose.name.clone()) {
        let posed = posed(&pose);
        let rows = &posed.workspace.lanes[0].constraints.rows;
        let couplings = posed.human.model.couplings.joint.len();
        for row in 0..couplings {
            assert!(rows.position[row].abs() < 1e-12, "{pose}: coupling {row} is off by {}", rows.position[row]);
        }
    }
}

#[test]
fn every_muscle_is_in_one_of_twenty_families() {
    let human = human();
    let mut sizes: BTreeMap<&str, usize> = BTreeMap::new();
    for muscle in &human.body.muscles {
        *sizes.entry(&muscle.family).or_default() += 1;
    }
    let mut sizes: Vec<(&str, usize)> = sizes.into_iter().collect();
    sizes.sort_by_key(|&(name, size)| (core::cmp::Reverse(size), name));
    assert_eq!(
        sizes,
        [
            ("Other trunk", 92),
            ("Longissimus", 52),
            ("Abdominals", 26),
            ("Hand intrinsics", 26),
            ("Iliocostalis", 24),
            ("Wrist/finger extensors", 24),
            ("Wrist/finger flexors", 24),
            ("Hip flexors/adductors", 22),
            ("Paraspinals deep", 22),
            ("Glutes", 20),
            ("Other leg", 16),
            ("Rotator cuff", 12),
            ("Elbow extensors", 8),
            ("Elbow flexors", 8),
            ("Hamstrings", 8),
            ("Quadriceps", 8),
            ("Calves", 6),
            ("Deltoids", 6),
            ("Pectorals", 6),
            ("Pronators/supinators", 6),
        ]
    );
    let family = |name: &str| &human.body.muscles.iter().find(|muscle| muscle.name == name).unwrap().family;
    for thumb in ["EPL", "APL", "EPL_left", "APL_left"] {
        assert_eq!(family(thumb), "Wrist/finger extensors");
    }
}

/// The checker's tests resolve names in a copy of this vocabulary; `MSK_UPDATE=1 cargo test --test suite human` renews it.
#[test]
fn the_compilers_fixture_is_this_bodys_vocabulary() {
    let human = human();
    let vocabulary = serde_json::to_string(&human.body.vocabulary(&human.model)).unwrap() + "\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("compiler/tests/fixtures/human_vocabulary.json");
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::write(&path, &vocabulary).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    assert!(kept.trim_end() == vocabulary.trim_end(), "the fixture is out of date: renew it with MSK_UPDATE=1");
}
