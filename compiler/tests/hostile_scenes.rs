//! Whatever stands in a scene or an initial state, the compiler answers, and what it lets pass can be reset.

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::Middle;
use msk_compiler::task::TaskState;
use proptest::prelude::*;
use support::compiling::{compile_text, complete};

const KINDS: &[&str] = &[
    "ground",
    "plane",
    "box",
    "sphere",
    "capsule",
    "cylinder",
    "ellipsoid",
    "body",
    "point",
    "stairs",
    "slope",
    "heights",
    "hinge",
    "slide",
    "ball",
    "bxo",
];
#[rustfmt::skip]
const FIELDS: &[&str] = &[
    "size [0.4 m, 0.4 m, 0.4 m]", "size [4 m, 1 m]", "size 0.4 m", "radius 3 cm", "radius 0 m", "radius -1 m", "length 1 m",
    "from [0, 0, 0] to [0, 0, 1 m]", "from [0, 0, 0] to [0, 0, 0]", "along [0, 1, 0]", "along [0, 0, 0]", "at [1 m, 0, 0]",
    "at a.position", "at [r, 0, r]", "radius r", "at a.position + [0, 0, 1 m]", "at pelvis.position", "at [i * 1 m, 0, 0]", "at", "orientation 30 deg",
    "orientation [0, 0, 1 rad]", "turned 3", "free", "free false", "mass 2 kg", "mass 0 kg", "mass 1e300 kg", "density 1000 kg/m^3",
    "friction 1", "friction [1, 1 mm, 1 mm]", "friction -1", "solid false", "walkable", "walkable 3", "count 3", "count 1e9",
    "rise 15 cm", "run 50 cm", "width 1 m", "angle 5 deg", "angle 89 deg", "samples [3, 2]", "samples [1e6, 1e6]", "samples [2.5, 2]",
    "height 0.1 m * sin(x * 90 deg/m)", "height x * y", "height y", "height com.height", "height t / 1 s * 1 m", "axis [0, 0, 1]",
    "axis [0, 0, 0]", "range 0 deg .. 90 deg", "range 1 deg .. 0 deg", "range 10 deg .. 90 deg", "range 3 m", "damping 1 N*m*s/rad",
    "stiffness 2 N/m", "height on ground", "align a to b", "1 / 0", "box c { size [1 m, 1 m, 1 m], mass 1 kg }", "hinge q { axis [0, 0, 1] }",
    "point p { at [0, 0, 1 m] }",
];
#[rustfmt::skip]
const REST: &[&str] = &[
    "weld palm_l to a here", "weld a to b", "weld a to a", "connect a.p to palm_r release when t > 1 s", "weld com to a",
    "group all_ = [a, b]", "group g = a_{*}", "group h = [a, a]", "group a = [b]", "group k = pelvis", "marker m at a.position",
    "marker m at [0, 0, 1 m]", "marker n at t", "remove a", "remove b", "remove z_{*}", "allow repeats_scene \"x\"", "allow nothing \"x\"",
    "repeat i in 0..3 { sphere s_{i} { radius 1 cm, at [1 m * i, 0, 0] } }", "repeat i in 0..0 { ground }", "repeat i in 0..3 { ground }",
    "repeat i in 0..2 { repeat j in 0..2 { box s_{i}_{j} { size [1 m, 1 m, 1 m] } } }", "repeat i in 0..1000000 { sphere a_{i} { radius 1 m } }",
    "sphere a_{i} { radius 1 m }", "sphere a { radius i * 1 m }",
];
#[rustfmt::skip]
const BEGINNING: &[&str] = &[
    "pose neutral", "pose sitting { knee_angle_l = 10 deg }", "root { height on ground }", "root { height 1 m, at [1 m, 0 m] }",
    "root { align palm_l to a }", "root { align palm_l to a.p, align palm_r to b }", "root { heading a }", "root { height r, at [r, r] }", "a { velocity [1 m/s, 0, 0] }",
    "a { q 10 deg }", "a { at [0, 0, 1 m], spin [0, 0, 1 rad/s], orientation 3 deg }", "a.c { q 10 deg }", "b { q 10 m }", "pelvis { at [0, 0, 0] }",
    "noise joints normal(0, 1 rad)", "noise a normal(0, 1 rad)", "noise a.q uniform(-1 rad .. 1 rad)", "noise slides normal(0, 1 m)",
    "settle 10 ms with activation 0.2 at rest", "settle -1 s", "settle 1e300 s",
];
#[rustfmt::skip]
const FORMULAS: &[&str] = &[
    "a.top", "a.size", "a.position", "a.c.up", "a.q.q", "a.q", "b.velocity", "touching(a, robot)", "touching(robot, ground)", "touching(a, a)",
    "contact_force(a, [a, b])", "contact_count(g, ground)", "surface_distance(pelvis, a)", "slip(sole_{l,r}, a)", "ground_height(a)",
    "ground_height(pelvis, [1 m, 0, 0])", "ground_normal([0 m, 0 m])", "scan(heading(a), [[1 m, 1 m]])", "ray(a, [1, 0, 0], 3 m)",
    "radar(head, g, 7, 180 deg, 2 m)", "s_{*}.radius", "a_{*}.top", "g.speed", "a.position in b", "neutral(a.position)", "a.clearance",
];

fn scene() -> impl Strategy<Value = String> {
    let names = prop::sample::select(&["a", "b", "a_{0}", "pelvis", "t", ""][..]);
    let on = prop::sample::select(&["", "", "", " on pelvis", " on a", " on nothing"][..]);
    let fields = prop::collection::vec(prop::sample::select(FIELDS), 0..6).prop_map(|fields| fields.join(", "));
    let element = (prop::sample::select(KINDS), names, on, fields)
        .prop_map(|(kind, name, on, fields)| format!("{kind} {name}{on} {{ {fields} }}"));
    let statement =
        prop_oneof![4 => element, 2 => prop::sample::select(REST).prop_map(str::to_owned), 1 => Just("ground".to_owned())];
    prop::collection::vec(statement, 0..7).prop_map(|statements| statements.join("\n"))
}

fn some(lines: &'static [&'static str]) -> impl Strategy<Value = String> {
    prop::collection::vec(prop::sample::select(lines), 0..4).prop_map(|lines| lines.join("\n"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn scenes_of_any_words_neither_panic_nor_hang(scene in scene(), init in some(BEGINNING), observe in some(FORMULAS)) {
        let text = format!("random r = uniform(0 m .. 1 m)\nscene {{\n{scene}\n}}\ninit {{\npose neutral\n{init}\n}}\nobserve {{\npelvis.height\n{observe}\n}}");
        let begun = std::time::Instant::now();
        let compiled = compile_text(&complete(&text), &[]);
        // A second on a quiet machine; the tests may share theirs.
        prop_assert!(begun.elapsed().as_secs() < 10, "{text}");
        match compiled {
            Err(report) => prop_assert!(report.has_errors(), "{text}"),
            Ok(compilation) => {
                let task = &compilation.tasks[0];
                let (frame, mut state) = (vec![0.0; task.frame.size()], TaskState::default());
                prop_assert!(task.reset(&frame, &mut Middle, &mut state).is_ok(), "{text}");
                let begins = task.initial_state(&state);
                prop_assert!(begins.coordinates.iter().all(|value| value.is_finite()), "{text}");
                for object in &task.scene.objects {
                    let numbers = object.position.iter().chain(&object.orientation).chain(&object.surface.friction);
                    prop_assert!(numbers.chain([&object.mass]).all(|value| value.is_finite()), "{text}");
                }
            }
        }
    }
}
