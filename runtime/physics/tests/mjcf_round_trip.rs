//! Writing a model and reading it back gives an equal model, bit for bit.

use msk_physics::model::{GeomKind, Model, rotation};
use proptest::prelude::*;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Numbers of every size that figures of a body may have, and some that are awkward to print.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -10.0..10.0,
        (-1.0..1.0).prop_map(|x: f64| x * 1e-9),
        (-1.0..1.0).prop_map(|x: f64| x * 1e5),
        Just(0.1 + 0.2),
        Just(0.0),
        Just(-0.0),
        Just(1.0),
    ]
}

fn positive() -> impl Strategy<Value = f64> {
    prop_oneof![0.001..10.0, Just(1e-5), Just(1.0 / 3.0), Just(4096.0)]
}

fn vector() -> impl Strategy<Value = String> {
    [number(), number(), number()].prop_map(|[x, y, z]| format!("{x} {y} {z}"))
}

fn orientation() -> impl Strategy<Value = String> {
    prop_oneof![
        Just(String::new()),
        [number(), number(), number()].prop_map(|[x, y, z]| format!("quat=\"1 {x} {y} {z}\"")),
        [number(), number(), number()].prop_map(|[x, y, z]| format!("euler=\"{x} {y} {z}\"")),
        [number(), number()].prop_map(|[x, y]| format!("zaxis=\"{x} {y} 1\"")),
    ]
}

fn joint() -> impl Strategy<Value = String> {
    let kind = prop_oneof![Just("hinge"), Just("slide")];
    (kind, vector(), [number(), number()], positive(), [positive(), positive(), positive()], number()).prop_map(
        |(kind, pos, [x, y], width, [armature, damping, stiffness], reference)| {
            let low = reference - 1.0;
            format!(
                "<joint type=\"{kind}\" pos=\"{pos}\" axis=\"{x} {y} 1\" range=\"{low} {}\" ref=\"{reference}\" \
                 springref=\"{x}\" armature=\"{armature}\" damping=\"{damping}\" stiffness=\"{stiffness}\" \
                 solimplimit=\"0.{}\"/>",
                low + width,
                if damping < 1.0 { 5 } else { 9 },
            )
        },
    )
}

fn geom() -> impl Strategy<Value = String> {
    let kind = prop_oneof![Just("sphere"), Just("capsule"), Just("ellipsoid"), Just("cylinder"), Just("box")];
    let place = (vector(), orientation()).prop_map(|(pos, orientation)| format!("pos=\"{pos}\" {orientation}"));
    let span = [number(), number(), number()].prop_map(|[x, y, z]| format!("type=\"capsule\" fromto=\"1 2 3 {x} {y} {z}\""));
    let plain = (kind, place).prop_map(|(kind, place)| format!("type=\"{kind}\" {place}"));
    (prop_oneof![3 => plain, 1 => span], [positive(), positive(), positive()], 0..3, positive()).prop_map(
        |(shape, [a, b, c], group, friction)| {
            format!(
                "<geom {shape} size=\"{a} {b} {c}\" contype=\"0\" conaffinity=\"0\" group=\"{group}\" \
                 friction=\"{friction}\" margin=\"{friction}\"/>"
            )
        },
    )
}

/// A body's own elements, and how far up the chain of bodies before it its parent is.
#[derive(Debug)]
struct Body {
    up: usize,
    frame: String,
    contents: String,
}

fn body() -> impl Strategy<Value = Body> {
    let joints = prop::collection::vec(joint(), 0..3);
    let geoms = prop::collection::vec(geom(), 0..3);
    (0..4_usize, vector(), orientation(), joints, geoms).prop_map(|(up, pos, orientation, joints, geoms)| {
        let inertial = "<inertial pos=\"0.1 0 0.3\" mass=\"1.1\" fullinertia=\"0.3 0.2 0.25 0.01 -0.02 0.03\"/>";
        let inertial = if geoms.is_empty() { inertial } else { "" };
        let contents = [joints.concat(), geoms.concat(), inertial.to_owned()].concat();
        Body { up, frame: format!("pos=\"{pos}\" {orientation}"), contents }
    })
}

/// A model's text; names carry characters that XML must escape.
fn text(bodies: &[Body], lengths: &[f64]) -> String {
    let mut text = String::from("<mujoco model=\"a &lt; b\"><worldbody>");
    let mut depth = 0;
    for (index, body) in bodies.iter().enumerate() {
        for _ in 0..body.up.min(depth) {
            text.push_str("</body>");
        }
        depth = depth.saturating_sub(body.up) + 1;
        let name = format!("b &amp; &quot;{index}&quot;&#10;");
        let site = format!("<site name=\"s{index}\" pos=\"0 {index}.7 0\"/>");
        write!(text, "<body name=\"{name}\" {}>{site}{}", body.frame, body.contents).unwrap();
    }
    text.push_str(&"</body>".repeat(depth));
    text.push_str("<site name=\"end\" pos=\"1 2 3\"/></worldbody><tendon>");
    for (index, length) in lengths.iter().enumerate() {
        let site = index % bodies.len();
        write!(
            text,
            "<spatial name=\"t{index}\" springlength=\"{length}\" stiffness=\"{length}\"><site site=\"s{site}\"/>\
             <site site=\"end\"/></spatial>"
        )
        .unwrap();
    }
    text.push_str("</tendon><actuator>");
    for (index, length) in lengths.iter().enumerate() {
        let high = length + 1.0;
        write!(text, "<muscle name=\"m{index}\" tendon=\"t{index}\" lengthrange=\"{length} {high}\" force=\"{length}\"/>")
            .unwrap();
    }
    text.push_str("</actuator></mujoco>");
    text
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reading_what_was_written_gives_the_same_model(
        bodies in prop::collection::vec(body(), 1..8),
        lengths in prop::collection::vec(positive(), 0..6),
    ) {
        let model = match Model::from_mjcf(&text(&bodies, &lengths)) {
            Ok(model) => model,
            // A frame or span may come out degenerate, an inertia impossible by a rounding error: those are not models.
            Err(_) => return Err(TestCaseError::reject("not a model")),
        };
        let written = model.to_mjcf();
        let again = Model::from_mjcf(&written).map_err(|error| TestCaseError::fail(format!("{error}\n{written}")))?;
        prop_assert!(again == model, "{written}\n{again:#?}\n{model:#?}");
    }
}

#[test]
fn the_full_body_survives_unchanged() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bodies/models/human416.xml");
    let model = Model::from_file(path).unwrap();
    assert!(Model::from_mjcf(&model.to_mjcf()).unwrap() == model);
}

/// All model files below a folder.
fn models_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            models_below(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "xml") {
            found.push(path);
        }
    }
}

/// Whether two models with meshes are the same bodies: a mesh that is read is put into a frame of its own, which depends on the
/// method of its inertia and on rounding, so that only its corners in the body's frame can be compared.
fn same_solids(a: &Model, b: &Model) -> bool {
    let corners = |model: &Model| {
        let geoms = &model.geoms;
        let mut corners = Vec::new();
        for geom in 0..geoms.kind.len() {
            let Some(asset) = geoms.asset[geom].filter(|_| geoms.kind[geom] == GeomKind::Mesh) else { continue };
            for &vertex in &model.meshes[asset].vertices {
                corners.push(geoms.position[geom] + rotation::rotate(geoms.orientation[geom], vertex));
            }
        }
        corners
    };
    let (first, second) = (corners(a), corners(b));
    a.bodies == b.bodies
        && a.geoms.name == b.geoms.name
        && !first.is_empty()
        && first.len() == second.len()
        && first.iter().zip(&second).all(|(one, other)| (one - other).norm() < 1e-7)
}

#[test]
fn every_model_of_the_tests_survives_unchanged() {
    let mut found = Vec::new();
    models_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/oracle"), &mut found);
    assert!(found.len() >= 20, "{found:?}");
    let mut changed = Vec::new();
    for path in &found {
        // Some are there to be refused.
        let Ok(model) = Model::from_file(path) else { continue };
        let same = |again: &Model| if model.meshes.is_empty() { *again == model } else { same_solids(again, &model) };
        if !Model::from_mjcf(&model.to_mjcf()).is_ok_and(|again| same(&again)) {
            changed.push(path);
        }
    }
    assert!(changed.is_empty(), "{changed:?}");
}
