//! Shapes touch where they do in MuJoCo 4.0.0: `tests/oracle/collision.py` made the golden numbers.

use crate::support;

use msk_physics::model::{GeomKind, Model};
use msk_physics::{
    State, Workspace,
    collision::{Placed, Scratch, distance, ray},
    constrained, kinematics, step,
};
use nalgebra::Vector3;
use serde_json::Value;
use support::{
    SplitMix, golden, numbers, repository,
    touching::{Theirs, Verdict, judge},
};

/// The orientation that `orientation` of the oracle script draws, number for number.
fn orientation(random: &mut SplitMix, sort: usize) -> [f64; 4] {
    let free: [f64; 4] = core::array::from_fn(|_| random.between(-1.0, 1.0));
    let turn: [f64; 4] = core::array::from_fn(|_| random.between(-2.0, 2.0).trunc());
    match sort {
        1 if turn != [0.0; 4] => turn,
        2 if turn != [0.0; 4] => core::array::from_fn(|k| turn[k] + 0.02 * free[k]),
        _ => free,
    }
}

/// The poses that `draw` of the oracle script draws.
fn draw(random: &mut SplitMix, number: usize, state: &mut State<f64>) {
    let sort = number % 4;
    for body in state.position.chunks_exact_mut(7) {
        let reach = if sort == 3 { 0.08 } else { 0.26 };
        body[..3].fill_with(|| random.between(-reach, reach));
        body[3..].copy_from_slice(&orientation(random, sort));
    }
}

/// How far our contacts are from MuJoCo's, and how often other answers were right for a reason.
#[derive(Default, Debug, Clone)]
struct Errors {
    cases: usize,
    contacts: usize,
    along: usize,
    corners: usize,
    closer: usize,
    other: usize,
    worst: [f64; 3],
}

impl Errors {
    fn add(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Same(errors) => self.worst = core::array::from_fn(|k| self.worst[k].max(errors[k])),
            Verdict::Along => self.along += 1,
            Verdict::Corners => self.corners += 1,
            Verdict::Closer => self.closer += 1,
            Verdict::Other => self.other += 1,
        }
    }
}

/// Runs all cases of a pair.
fn errors(pair: &Value) -> Errors {
    let model = Model::from_mjcf(pair["text"].as_str().unwrap()).unwrap_or_else(|error| panic!("{error}"));
    let mut random = SplitMix(pair["seed"].as_u64().unwrap());
    let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
    let mut errors = Errors::default();
    for (number, case) in pair["cases"].as_array().unwrap().iter().enumerate() {
        draw(&mut random, number, &mut state);
        if pair["first"] == "hills" {
            state.position[2] = 0.16 + 0.5 * state.position[2].abs();
        }
        kinematics::update(&model, &state, &mut workspace.kinematics);
        constrained::contacts(&model, &mut workspace);
        let theirs: Vec<Theirs> =
            case.as_array().unwrap().iter().map(|numbers| Theirs::new(&support::numbers(numbers))).collect();
        let ours = &workspace.lanes[0].constraints.contacts;
        let [first, second] = [0, 1].map(|geom| Placed::of(&model, &workspace.kinematics, 0, geom));
        let verdict = judge([&first, &second], ours, &theirs, 1e-5);
        errors.add(verdict);
        errors.cases += 1;
        errors.contacts += theirs.len();
        if verdict == Verdict::Other && std::env::args().any(|argument| argument == "--nocapture") {
            println!("  {} {} case {number}:", pair["first"], pair["second"]);
            theirs
                .iter()
                .for_each(|t| println!("    MuJoCo {:.6} {:.6?} {:.6?}", t.distance, t.position.as_slice(), t.normal.as_slice()));
            ours.iter().for_each(|c| {
                println!(
                    "    ours   [{:.6}, {:.6?}, {:.6?}]",
                    c.distance,
                    c.position.as_slice(),
                    c.frame.row(0).iter().collect::<Vec<_>>()
                )
            });
        }
    }
    errors
}

/// How far a pair may be from MuJoCo in distance, position and normal, and how many cases may be other for no reason but the
/// order of MuJoCo's search.
struct Allowed {
    other: usize,
    worst: [f64; 3],
}

fn check(name: &str, allowed: impl Fn(&str, &str) -> Allowed) {
    let mut bad = Vec::new();
    for pair in golden(&format!("collision_{name}"))["pairs"].as_array().unwrap() {
        let (first, second) = (pair["first"].as_str().unwrap(), pair["second"].as_str().unwrap());
        let e = errors(pair);
        println!(
            "{:20} {:3} cases {:4} contacts; along {:2}, corners {:2}, closer {:2}, other {:2}; errors {:.1e} {:.1e} {:.1e}",
            format!("{first}-{second}"),
            e.cases,
            e.contacts,
            e.along,
            e.corners,
            e.closer,
            e.other,
            e.worst[0],
            e.worst[1],
            e.worst[2],
        );
        let allowed = allowed(first, second);
        assert!(e.contacts > 10, "{first}-{second}: too few contacts to mean anything");
        if e.other > allowed.other || e.worst.iter().zip(allowed.worst).any(|(error, allowed)| *error > allowed) {
            bad.push(format!("{first}-{second}: {e:?}"));
        }
    }
    assert!(bad.is_empty(), "{bad:#?}");
}

/// Whether one of the two is a mesh: its corners are rounded to single precision in frames that differ in the last bits.
fn is_mesh(first: &str, second: &str) -> bool {
    [first, second].iter().any(|name| ["rock", "cube"].contains(name))
}

#[test]
fn closed_forms_are_exact() {
    check("closed", |first, second| match (first, second) {
        // MuJoCo iterates here.
        ("sphere", "ellipsoid") => Allowed { other: 0, worst: [1e-8, 1e-5, 1e-4] },
        // Where the capsule is as near to two parallel edges, rounding decides from which a second contact is looked for.
        ("capsule", "slab") => Allowed { other: 1, worst: [1e-8; 3] },
        _ if is_mesh(first, second) => Allowed { other: 0, worst: [5e-8, 5e-8, 1e-8] },
        _ => Allowed { other: 0, worst: [1e-8; 3] },
    });
}

#[test]
fn other_convex_shapes_touch_within_the_colliders_precision() {
    check("convex", |first, second| match (first, second) {
        // One case each: the ends of the capsule's line lie half a millimetre elsewhere; of several edges at a corner MuJoCo
        // takes the first in an order of its own.
        ("capsule", "cylinder") | ("rock", "rock" | "cube") => Allowed { other: 1, worst: [5e-8, 1e-5, 1e-5] },
        _ => Allowed { other: 0, worst: [5e-8, 1e-5, 1e-5] },
    });
}

#[test]
fn rays_end_where_mujocos_do() {
    for shape in golden("collision_queries")["rays"].as_array().unwrap() {
        let model = Model::from_mjcf(shape["text"].as_str().unwrap()).unwrap();
        let (state, mut workspace) = (State::<f64>::new(&model), Workspace::new(&model));
        kinematics::update(&model, &state, &mut workspace.kinematics);
        let mut random = SplitMix(shape["seed"].as_u64().unwrap());
        let centre = Vector3::new(0.1, -0.2, 0.15);
        for (number, hit) in shape["hits"].as_array().unwrap().iter().enumerate() {
            let reach = if number % 3 == 0 { 0.05 } else { 0.6 };
            let mut near = |reach: f64| centre + Vector3::from_fn(|_, _| random.between(-reach, reach));
            let origin = near(reach);
            let direction = near(0.3) - origin;
            let found = ray::cast(&model, &workspace.kinematics, 0, [origin, direction], 1e3, |_| true);
            let local = workspace.kinematics.geom_rotation[0].tr_mul(&(origin - centre));
            if shape["shape"] == "hills" && local.x.abs() < 1.0 && local.y.abs() < 0.8 && (-0.1..0.15).contains(&local.z) {
                // From inside a height field MuJoCo sees the top of its base, which is no surface.
                continue;
            }
            let (hit, what) = (numbers(hit), format!("{}, ray {number}: {found:?}", shape["shape"]));
            assert_eq!(found.is_some(), hit[0] >= 0.0, "{what}, MuJoCo's {hit:?}");
            if let Some(found) = found {
                assert!((found.distance - hit[0]).abs() < 1e-7, "{what}, MuJoCo's {}", hit[0]);
                let normal = Vector3::from_column_slice(&hit[1..4]);
                assert!((found.normal - normal).amax() < 1e-6, "{what}, MuJoCo's normal {normal:?}");
            }
        }
    }
}

#[test]
fn shapes_apart_are_as_far_apart_as_in_mujoco() {
    let mut scratch = Scratch::default();
    for pair in golden("collision_queries")["gaps"].as_array().unwrap() {
        let model = Model::from_mjcf(pair["text"].as_str().unwrap()).unwrap();
        let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
        let mut random = SplitMix(pair["seed"].as_u64().unwrap());
        for (number, expected) in numbers(&pair["distances"]).into_iter().enumerate() {
            draw(&mut random, 0, &mut state);
            let last = state.position.len() - 7;
            for (coordinate, shift) in state.position[last..].iter_mut().zip([0.3, 0.2, 0.7]) {
                *coordinate += shift;
            }
            kinematics::update(&model, &state, &mut workspace.kinematics);
            let [first, second] = [0, 1].map(|geom| Placed::of(&model, &workspace.kinematics, 0, geom));
            let gap = distance::between(&first, &second, 5.0, &mut scratch).expect("within range");
            let what = format!("{} and {}, case {number}: {}", pair["first"], pair["second"], gap.distance);
            // MuJoCo looks only at the cells below a shape, of which another may be nearer.
            let nearer = pair["first"] == "hills" && gap.distance < expected;
            assert!(nearer || (gap.distance - expected).abs() < 1e-6, "{what}, MuJoCo's {expected}");
            if gap.distance > 0.0 {
                assert!(((gap.points[1] - gap.points[0]).norm() - gap.distance).abs() < 1e-7, "{what}");
            }
        }
    }
}

#[test]
fn meshes_weigh_and_reach_what_mujocos_do() {
    let golden = &golden("collision_queries")["solids"];
    let model = Model::from_file(repository("tests/oracle/models/mjcf/solids.xml")).unwrap_or_else(|error| panic!("{error}"));
    let (state, mut workspace) = (State::<f64>::new(&model), Workspace::new(&model));
    kinematics::update(&model, &state, &mut workspace.kinematics);
    let bodies = &model.bodies;
    let tensor = |body: usize| {
        let frame = workspace.kinematics.inertial_rotation[body];
        frame * nalgebra::Matrix3::from_diagonal(&bodies.inertia[body]) * frame.transpose()
    };
    let ours: [(&str, Vec<f64>); 5] = [
        ("mass", bodies.mass.clone()),
        ("centre", bodies.inertial_position.iter().flatten().copied().collect()),
        ("tensor", (0..bodies.mass.len()).flat_map(|body| tensor(body).iter().copied().collect::<Vec<_>>()).collect()),
        ("samples", model.height_fields[0].samples.clone()),
        ("hulls", model.meshes.iter().map(|mesh| mesh.hull.vertices.len() as f64).collect()),
    ];
    for (name, values) in ours {
        let expected = numbers(&golden[name]);
        assert_eq!(values.len(), expected.len(), "{name}");
        for (index, (value, expected)) in values.iter().zip(expected).enumerate() {
            assert!(
                (value - expected).abs() <= 1e-7 * expected.abs().max(1.0),
                "{name}[{index}] is {value}, MuJoCo's {expected}"
            );
        }
    }
    // MuJoCo's sphere goes around the bounding box, ours around the shape.
    for (radius, expected) in model.geoms.bounding_radius.iter().zip(numbers(&golden["radius"])) {
        assert!(*radius <= expected * (1.0 + 1e-6) || model.geoms.kind[0] == GeomKind::HeightField, "{radius} {expected}");
    }
    // Written as text and read again, a mesh has the same corners and faces, in a frame of its own.
    let again = Model::from_mjcf(&model.to_mjcf()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again.height_fields, model.height_fields);
    for (mesh, other) in model.meshes.iter().zip(&again.meshes) {
        assert_eq!((mesh.vertices.len(), mesh.hull.faces.len()), (other.vertices.len(), other.hull.faces.len()));
    }
}

/// Lets a body rest on the ground for two seconds; how far any coordinate moves.
fn drift(ground: &str, body: &str) -> f64 {
    let corners = "-.1 -.1 -.1 .1 -.1 -.1 .1 .1 -.1 -.1 .1 -.1 -.1 -.1 .1 .1 -.1 .1 .1 .1 .1 -.1 .1 .1";
    let text = format!(
        r#"<mujoco><asset><mesh name="cube" vertex="{corners}"/>
        <hfield name="level" nrow="21" ncol="21" size="1 1 .1 .1" elevation="{}"/></asset>
        <worldbody>{ground}{body}</worldbody></mujoco>"#,
        "0 ".repeat(441)
    );
    let model = Model::from_mjcf(&text).unwrap_or_else(|error| panic!("{error}"));
    let (mut state, mut workspace) = (State::<f64>::new(&model), Workspace::new(&model));
    let start = state.position.clone();
    for _ in 0..1000 {
        step(&model, &mut state, &mut workspace).unwrap();
    }
    state.position.iter().zip(start).map(|(now, then)| (now - then).abs()).fold(0.0, f64::max)
}

#[test]
fn bodies_rest_for_two_seconds_within_a_millimetre() {
    let plane = r#"<geom type="plane" size="0 0 1"/>"#;
    let slab = r#"<geom type="box" size=".5 .5 .1" pos="0 0 -.1"/>"#;
    let level = r#"<geom type="hfield" hfield="level"/>"#;
    let free =
        |height: f64, turn: &str, geom: &str| format!(r#"<body pos="0 0 {height}" {turn}><freejoint/><geom {geom}/></body>"#);
    let lying = r#"euler="90 0 0""#;
    let bodies = [
        free(0.1, "", r#"type="box" size=".2 .15 .1""#),
        free(0.2, "", r#"type="cylinder" size=".1 .2""#),
        free(0.1, lying, r#"type="cylinder" size=".1 .2" condim="6""#),
        free(0.1, "", r#"type="mesh" mesh="cube""#),
        free(0.05, lying, r#"type="capsule" size=".05 .2" condim="6""#),
    ];
    // On a height field round things roll: one contact for each prism, anywhere along the line of touch (in MuJoCo by centimetres).
    for (ground, bodies, allowed) in [(plane, &bodies[..], 1e-3), (slab, &bodies[..], 1e-3), (level, &bodies[..2], 3e-3)] {
        for body in bodies {
            let drift = drift(ground, body);
            assert!(drift < allowed, "{body} on {ground}: {drift} m");
        }
    }
    let stack: String = (0..3).map(|k| free(0.1 + 0.2 * f64::from(k), "", r#"type="box" size=".2 .15 .1""#)).collect();
    let drift = drift(plane, &stack);
    assert!(drift < 3e-3, "a stack of three: {drift} m");
}
