//! Files that are broken, impossible or malicious: each gives one clear error, quickly, and never a panic.

use msk_physics::model::{Model, ModelError, ModelFiles};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// However bad a file is, it is refused within this time (unoptimised builds included).
const PATIENCE: Duration = Duration::from_secs(20);

fn refuse(text: &str) -> String {
    let start = Instant::now();
    let error = Model::from_mjcf(text).map(|model| model.name).unwrap_err();
    assert!(start.elapsed() < PATIENCE, "took {:?}", start.elapsed());
    error.to_string()
}

/// Asserts that the text is refused with a message that contains `expected`.
fn refused(text: &str, expected: &str) {
    let message = refuse(text);
    assert!(message.contains(expected), "expected `{expected}` in the message, found\n{message}\nfor\n{text:.300}");
}

/// A body that would be fine, with something inside it.
fn with(inside: &str) -> String {
    format!("<mujoco><worldbody><body><joint name=\"j\"/><geom name=\"g\" size=\"1\"/>{inside}</body></worldbody></mujoco>")
}

/// A model that would be fine, with something beside its bodies.
fn beside(section: &str) -> String {
    format!(
        "<mujoco><worldbody><body name=\"a\"><joint name=\"j\"/><geom name=\"g\" type=\"capsule\" size=\"1 1\"/>\
         <site name=\"s\"/><site name=\"t\" pos=\"1 0 0\"/></body></worldbody>{section}</mujoco>"
    )
}

#[test]
fn what_is_not_a_model() {
    refused("", "not well-formed XML");
    refused("\0\u{1}", "not well-formed XML");
    refused("<mujoco>", "not well-formed XML");
    refused("<mujoco><worldbody></mujoco>", "not well-formed XML");
    refused("<robot/>", "top-level element is `mujoco`, found `robot`");
    refused("<include file=\"x\"/>", "cannot include files");
    refused("<mujoco a=\"1\" a=\"2\"/>", "not well-formed XML");
    // Entities that expand to gigabytes, and such that read other files.
    let laughs: String = (1..30).map(|n| format!("<!ENTITY e{n} \"&e{};&e{};\">", n - 1, n - 1)).collect();
    refused(&format!("<!DOCTYPE m [<!ENTITY e0 \"ha\">{laughs}]><mujoco model=\"&e29;\"/>"), "not well-formed XML");
    refused("<!DOCTYPE m [<!ENTITY e SYSTEM \"/etc/passwd\">]><mujoco model=\"&e;\"/>", "not well-formed XML");
}

#[test]
fn nesting_without_end() {
    for tag in ["body", "frame", "default class=\"x\"", "b"] {
        let text = format!("<mujoco>{}", format!("<{tag}>").repeat(100_000));
        let _ = refuse(&text);
    }
    let name = |n: usize| format!("<default class=\"c{n}\">");
    let classes: String = (0..1000).map(name).collect();
    refused(&format!("<mujoco><default>{classes}{}</default></mujoco>", "</default>".repeat(1000)), "deeper than 256");
    let bodies = format!("{}{}", "<body>".repeat(1000), "</body>".repeat(1000));
    refused(&format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>"), "deeper than 256");
}

#[test]
fn counts_without_measure() {
    refused(&format!("<mujoco><worldbody>{}</worldbody></mujoco>", "<site/>".repeat(1_000_001)), "more than 1000000 elements");
    refused(&with(&"<joint/>".repeat(7)), "more than 6 degrees of freedom, found 8");
    refused(&with(&"<geom size=\"1\"/>".repeat(30_000)), "at most 20000 are supported");
    let ball = "<body><freejoint/><geom size=\"1\"/></body>";
    refused(&format!("<mujoco><worldbody>{}</worldbody></mujoco>", ball.repeat(5_000)), "pairs of shapes can collide");
    let leaf = "<body><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/><joint/></body>";
    refused(&format!("<mujoco><worldbody>{}</worldbody></mujoco>", leaf.repeat(100_000)), "too large");
    let spine = "<body><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/><joint/><joint/><joint/>".repeat(200);
    let ribs = leaf.repeat(60_000);
    let closing = "</body>".repeat(200);
    refused(&format!("<mujoco><worldbody>{spine}{ribs}{closing}</worldbody></mujoco>"), "entries");
}

#[test]
fn numbers_that_are_none() {
    for number in ["nan", "inf", "-inf", "1e999", "1e31", "0x10", "1,5", "one", "", " ", "1 2 3 4", "--1"] {
        let message = refuse(&with(&format!("<site pos=\"{number} 0 0\"/><site pos=\"{number}\"/>")));
        assert!(message.contains("`pos`"), "{number}: {message}");
    }
    refused(&with("<geom size=\"-1\"/>"), "positive sizes");
    refused(&with("<geom type=\"box\" size=\"1 1\"/>"), "3 positive sizes");
    refused(&with("<geom size=\"1\" mass=\"-1\"/>"), "`mass` must not be negative");
    refused(&with("<geom size=\"1\" condim=\"2\"/>"), "`condim` must be 1, 3, 4 or 6");
    refused(&with("<geom size=\"1\" contype=\"99999999999\"/>"), "`contype` expects a whole number");
    refused(&with("<geom size=\"1\" contype=\"1.5\"/>"), "`contype` expects a whole number");
    refused(&with("<geom size=\"1\" type=\"torus\"/>"), "`type` expects one of");
    refused("<mujoco><option timestep=\"0\"/></mujoco>", "`timestep` must be positive");
    refused("<mujoco><option iterations=\"-1\"/></mujoco>", "`iterations` expects a whole number");
    let long = "9".repeat(1_000_000);
    let message = refuse(&with(&format!("<site pos=\"{long}\"/>")));
    assert!(message.len() < 300, "a hostile value floods the message");
}

#[test]
fn orientations_that_are_none() {
    refused(&with("<site quat=\"0 0 0 0\"/>"), "degenerate");
    refused(&with("<site zaxis=\"0 0 0\"/>"), "degenerate");
    refused(&with("<site xyaxes=\"1 0 0 2 0 0\"/>"), "degenerate");
    refused(&with("<site axisangle=\"0 0 0 1\"/>"), "degenerate");
    refused(&with("<site quat=\"1 0 0 0\" euler=\"0 0 0\"/>"), "more than once");
    refused(&with("<geom type=\"capsule\" size=\"1\" fromto=\"1 1 1 1 1 1\"/>"), "same point twice");
    refused("<mujoco><compiler eulerseq=\"xyw\"/></mujoco>", "three letters");
    refused(&with("<body><joint axis=\"0 0 0\"/><geom size=\"1\"/></body>"), "`axis` is zero");
}

#[test]
fn masses_that_cannot_move() {
    let body = |inertial: &str| format!("<mujoco><worldbody><body name=\"b\">{inertial}<joint/></body></worldbody></mujoco>");
    refused(&body(""), "`b` (number 1) has no mass");
    refused(&body("<inertial pos=\"0 0 0\" mass=\"0\" diaginertia=\"0 0 0\"/>"), "has no mass");
    refused(&body("<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"0 0 0\"/>"), "has no mass or no inertia");
    refused(&body("<inertial pos=\"0 0 0\" mass=\"-1\" diaginertia=\"1 1 1\"/>"), "`mass` must not be negative");
    refused(&body("<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 -1\"/>"), "not positive");
    refused(&body("<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"5 1 1\"/>"), "impossible");
    refused(&body("<inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\"1 1 1 5 5 5\"/>"), "not positive");
    refused(&body("<inertial pos=\"0 0 0\" mass=\"1\"/>"), "has no mass or no inertia");
    let both = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\" fullinertia=\"1 1 1 0 0 0\"/>";
    refused(&body(both), "not both");
    refused(&body("<inertial mass=\"1\" diaginertia=\"1 1 1\"/>"), "needs the attribute `pos`");
    // One direction with two joints: the mass matrix is singular, in numbers or after rounding.
    let twice = |mass: &str, armature: &str| {
        let slide = |name: &str| format!("<joint name=\"{name}\" type=\"slide\" armature=\"{armature}\"/>");
        let inertial = format!("<inertial pos=\"0 0 0\" mass=\"{mass}\" diaginertia=\"1 1 1\"/>");
        format!("<mujoco><worldbody><body>{inertial}{}{}</body></worldbody></mujoco>", slide("a"), slide("b"))
    };
    refused(&twice("1", "0"), "the mass matrix has no inverse at the reference configuration");
    refused(&twice("2.9e14", "1e-5"), "rounding leaves nothing of the inertia that joint 0 (`a`) moves by itself");
    refused(&with("<body><geom type=\"mesh\" mesh=\"none\" contype=\"0\" conaffinity=\"0\"/></body>"), "does not exist");
}

#[test]
fn joints_that_cannot_be() {
    refused("<mujoco><worldbody><joint/></worldbody></mujoco>", "the world cannot have joints");
    refused(&with("<freejoint/>"), "cannot have other joints");
    refused(&with("<body><freejoint/><geom size=\"1\"/></body>"), "only a child of the world");
    refused(&with("<joint range=\"2 1\"/>"), "`range` is empty");
    refused(&with("<joint limited=\"true\"/>"), "there is no `range`");
    refused(&with("<joint damping=\"-1\"/>"), "`damping` must not be negative");
    refused(&with("<joint damping=\"1 2\"/>"), "polynomial");
    refused(&with("<joint class=\"none\"/>"), "no default class `none`");
    refused(&with("<body childclass=\"none\"/>"), "no default class `none`");
}

#[test]
fn length_ranges_that_cannot_be_computed() {
    let muscle = "<actuator><muscle name=\"m\" joint=\"j\"/></actuator>";
    let with_settings = |settings: &str| beside(&format!("<compiler><lengthrange {settings}/></compiler>{muscle}"));
    refused(&with_settings(""), "the actuator `m` cannot be computed: its length still changes by");
    refused(&with_settings("mode=\"none\""), "a muscle needs a `lengthrange`");
    refused(&with_settings("timestep=\"1e-9\""), "needs too many steps");
    refused(&with_settings("inttotal=\"1e30\""), "needs too many steps");
    refused(&with_settings("inttotal=\"-1\""), "`inttotal` must not be negative");
    refused(&with_settings("accel=\"1e30\""), "cannot be computed");
    refused(&with_settings("uselimit=\"true\""), "cannot be computed");
}

#[test]
fn copies_that_cannot_be() {
    let replicate = |attributes: &str, inside: &str| with(&format!("<replicate {attributes}>{inside}</replicate>"));
    refused(&replicate("", "<geom/>"), "needs the attribute `count`");
    refused(&replicate("count=\"-1\"", "<geom/>"), "`count` expects a whole number");
    refused(&replicate("count=\"1000000\"", "<geom size=\"1\"/>"), "with all copies the model has more than");
    let nested = (0..9).fold("<site/>".to_owned(), |inside, _| format!("<replicate count=\"10\">{inside}</replicate>"));
    refused(&with(&nested), "with all copies the model has more than");
    refused(&replicate("count=\"2\"", "<joint/>"), "`joint` cannot stand directly in `replicate`");
    refused(&with(&"<replicate count=\"0\"/>".repeat(1_001)), "more than 1000 `replicate` elements");
    let copied = "<replicate count=\"2\"><body name=\"b\"><joint name=\"k\"/><geom size=\"1\"/></body></replicate>";
    let mixed = with(copied).replace("</mujoco>", "<equality><joint joint1=\"j\" joint2=\"k\"/></equality></mujoco>");
    refused(&mixed, "cannot join something that `replicate` copies");
    let many = "<replicate count=\"500000\"><site name=\"s\"/></replicate>";
    let paths = "<spatial><site site=\"s\"/><site site=\"s\"/></spatial>".repeat(100);
    refused(&with(many).replace("</mujoco>", &format!("<tendon>{paths}</tendon></mujoco>")), "with all copies");
}

#[test]
fn bodies_placed_from_outside() {
    let body = |inside: &str| format!("<body mocap=\"true\">{inside}</body>");
    refused(&with(&body("")), "a child of the world without joints");
    let world = |body: &str| format!("<mujoco><worldbody>{body}</worldbody></mujoco>");
    refused(&world(&body("<joint/>")), "a child of the world without joints");
    let model = Model::from_mjcf(&world(&body("<geom size=\"1\"/>"))).unwrap();
    assert_eq!((model.bodies.mocap, model.bodies.weld), (vec![false, true], vec![0, 1]));
}

#[test]
fn what_is_not_quite_xml_is_read_as_mujoco_reads_it() {
    let text =
        "<mujoco><!-- a -- b -->\n<worldbody>\n<site name=\"a<b & c\"pos=\"1 2 3\"/>\n<geom sise=\"1\"/></worldbody></mujoco>";
    refused(text, "line 4: attribute `sise` of `geom` (is it `size`?)");
    let mended = text.replace("sise", "size");
    assert_eq!(Model::from_mjcf(&mended).unwrap().sites.name, ["a<b & c"]);
    refused("<mujoco><a b=\"1\"c=\"2\"></mujoco>", "line 1: not well-formed XML: expected a whitespace");
}

#[test]
fn names_that_lead_nowhere_or_twice() {
    let tendon = |path: &str| beside(&format!("<tendon><spatial name=\"p\">{path}</spatial></tendon>"));
    refused(&with("<joint name=\"j\"/>"), "two joints with the name `j`");
    refused(&tendon("<site site=\"s\"/><site site=\"x\"/>"), "`site` names the site `x`, which does not exist");
    refused(&tendon("<site site=\"s\"/>"), "start and end with a site");
    refused(&tendon(""), "is empty");
    refused(&tendon("<site site=\"s\"/><geom geom=\"g\"/><site site=\"t\"/>"), "sphere or a cylinder");
    refused(&tendon("<site site=\"s\"/><pulley divisor=\"0\"/><site site=\"t\"/>"), "must be positive");
    refused(&tendon("<site site=\"s\"/><pulley divisor=\"2\"/><site site=\"t\"/>"), "a site of its own");
    refused(&beside("<equality><joint joint1=\"j\" joint2=\"j\"/></equality>"), "coupled to itself");
    refused(&beside("<equality><joint joint1=\"x\"/></equality>"), "names the joint `x`");
    refused(&beside("<contact><pair geom1=\"g\" geom2=\"x\"/></contact>"), "names the geom `x`");
    refused(&beside("<contact><exclude body1=\"a\"/></contact>"), "needs the attribute `body2`");
    let muscle = "<tendon><spatial name=\"p\"><site site=\"s\"/><site site=\"t\"/></spatial></tendon><actuator><muscle ";
    refused(&beside(&format!("{muscle} tendon=\"x\"/></actuator>")), "names the tendon `x`");
    refused(
        &beside(&format!("{muscle} tendon=\"p\"/></actuator>")),
        "the length range of the actuator `` cannot be computed: its",
    );
    refused(&beside(&format!("{muscle} tendon=\"p\" lengthrange=\"1 2\" lmin=\"2\"/></actuator>")), "lmin < 1 < lmax");
    refused(&beside(&format!("{muscle} tendon=\"p\" lengthrange=\"1 2\" vmax=\"0\"/></actuator>")), "must be positive");
    refused("<mujoco><default><default class=\"a\"/><default class=\"a\"/></default></mujoco>", "defined twice");
}

#[test]
fn everything_unsupported_is_listed_with_its_line() {
    let text = "<mujoco>\n<option integrator=\"discrete\">\n<flag spring=\"disable\"/></option>\n<worldbody>\n\
                <body sleep=\"init\">\n<joint springyield=\"1\"/>\n<geom size=\"1\" fluidshape=\"ellipsoid\"/>\n\
                <composite/>\n</body></worldbody>\n<deformable/>\n<equality>\n<flex flex=\"b\"/></equality>\n\
                <actuator>\n<dcmotor joint=\"j\"/></actuator></mujoco>";
    let Err(ModelError::Unsupported(list)) = Model::from_mjcf(text) else { panic!("not refused as unsupported") };
    let found: Vec<_> = list.iter().map(|item| (item.place.line, item.what.as_str())).collect();
    let expected = [
        (2, "attribute `integrator` of `option` with the value `discrete`"),
        (3, "attribute `spring` of `flag` with the value `disable`"),
        (5, "attribute `sleep` of `body` with the value `init`"),
        (6, "attribute `springyield` of `joint` with the value `1`"),
        (7, "attribute `fluidshape` of `geom` with the value `ellipsoid`"),
        (8, "element `composite` in `body`"),
        (10, "element `deformable` in `mujoco`"),
        (12, "element `flex` in `equality`"),
        (14, "element `dcmotor` in `actuator`"),
    ];
    assert_eq!(found, expected);
    assert!(list.iter().all(|item| !item.advice().is_empty()));
    let message = ModelError::Unsupported(list).to_string();
    assert!(message.contains("help: only rigid bodies are simulated"), "{message}");
}

#[test]
fn gravity_can_be_switched_off() {
    let text =
        |flag: &str| format!("<mujoco><option gravity=\"0 0 -5\"><flag {flag}/></option><option gravity=\"0 0 -6\"/></mujoco>");
    assert_eq!(Model::from_mjcf(&text("gravity=\"disable\"")).unwrap().options.gravity.z, 0.0);
    assert_eq!(Model::from_mjcf(&text("")).unwrap().options.gravity.z, -6.0);
    refused(&text("gravity=\"off\""), "`gravity` expects one of disable, enable");
}

#[test]
fn what_only_shows_is_skipped() {
    let text = "<mujoco><visual><global fovy=\"1\"/></visual><statistic extent=\"1\"/><size njmax=\"1\"/><custom/>\
                <asset><texture name=\"t\"/><material name=\"m\"/></asset><sensor><clock/></sensor><keyframe><key/></keyframe>\
                <worldbody><light/><camera/><body user=\"1\"><freejoint group=\"1\"/><geom size=\"1\" rgba=\"1 1 1 1\"/></body>\
                </worldbody></mujoco>";
    assert_eq!(Model::from_mjcf(text).unwrap().nv, 6);
}

/// Files in a folder of their own; the first is the main one.
fn from_files(files: &[(&str, &[u8])]) -> Result<Model, ModelError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, contents) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, contents).unwrap();
    }
    Model::from_file(folder.path().join(files[0].0))
}

fn files_refused(files: &[(&str, &[u8])], expected: &str) {
    let message = from_files(files).map(|model| model.name).unwrap_err().to_string();
    assert!(message.contains(expected), "expected `{expected}`, found `{message}`");
}

#[test]
fn includes_that_go_in_circles_or_nowhere() {
    let include = |file: &str| format!("<mujoco><include file=\"{file}\"/></mujoco>").into_bytes();
    files_refused(&[("a.xml", &include("a.xml"))], "included more than once");
    files_refused(&[("a.xml", &include("./b.xml")), ("b.xml", &include("../x/../a.xml"))], "cannot read");
    files_refused(&[("a.xml", &include("b.xml")), ("b.xml", &include("./a.xml"))], "included more than once");
    files_refused(&[("a.xml", &include("missing.xml"))], "cannot read");
    files_refused(&[("a.xml", &include("."))], "not a regular file");
    files_refused(&[("a.xml", &include("empty.xml")), ("empty.xml", b"<x/>")], "holds no elements");
    files_refused(&[("a.xml", b"<mujoco><include/></mujoco>")], "needs the attribute `file`");
    files_refused(&[("a.xml", &include("b.xml")), ("b.xml", b"\xff\xfe")], "not UTF-8");
    files_refused(&[("a.xml", &include("b.xml")), ("b.xml", b"<x>")], "b.xml:1: not well-formed XML");
}

#[test]
fn a_chain_of_includes_is_followed_only_so_far() {
    let file = |n: usize| (format!("{n}.xml"), format!("<mujoco><include file=\"{}.xml\"/></mujoco>", n + 1).into_bytes());
    let chain: Vec<_> = (0..400).map(file).collect();
    let chain: Vec<(&str, &[u8])> = chain.iter().map(|(name, text)| (name.as_str(), text.as_slice())).collect();
    files_refused(&chain, "deeper than 256");
}

#[test]
fn an_include_is_looked_for_beside_the_main_file_first() {
    let main = b"<mujoco><worldbody><include file=\"parts/limb.xml\"/></worldbody></mujoco>";
    let limb = b"<x><include file=\"tip.xml\"/></x>";
    let tip = |name: &str| format!("<x><site name=\"{name}\"/></x>").into_bytes();
    let (inner, outer) = (tip("inner"), tip("outer"));
    let near: &[(&str, &[u8])] = &[("m.xml", main), ("parts/limb.xml", limb), ("parts/tip.xml", &inner)];
    assert_eq!(from_files(near).unwrap().sites.name, ["inner"]);
    let both = [near, &[("tip.xml", &outer)]].concat();
    assert_eq!(from_files(&both).unwrap().sites.name, ["outer"]);
}

#[test]
fn meshes_that_are_none() {
    let main = b"<mujoco><asset><mesh name=\"m\" file=\"m.stl\"/></asset><worldbody><body><freejoint/>\
                 <geom type=\"mesh\" mesh=\"m\" contype=\"0\" conaffinity=\"0\"/></body></worldbody></mujoco>";
    let stl = |count: u32, triangles: &[[f32; 9]]| {
        let mut bytes = vec![b' '; 80];
        bytes.extend(count.to_le_bytes());
        for corners in triangles {
            bytes.extend([0; 12]);
            bytes.extend(corners.iter().flat_map(|number| number.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    };
    let flat = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let broken = [f32::NAN; 9];
    files_refused(&[("m.xml", main)], "cannot read");
    files_refused(&[("m.xml", main), ("m.stl", b"solid ascii\nendsolid")], "not a binary STL");
    files_refused(&[("m.xml", main), ("m.stl", &stl(0, &[]))], "not a binary STL");
    files_refused(&[("m.xml", main), ("m.stl", &stl(u32::MAX, &[flat]))], "not a binary STL");
    files_refused(&[("m.xml", main), ("m.stl", &stl(1, &[broken]))], "not a binary STL");
    files_refused(&[("m.xml", main), ("m.stl", &stl(1, &[flat]))], "encloses no volume");
    files_refused(&[("m.xml", main), ("m.stl", &stl(2, &[[0.0; 9], [f32::MAX; 9]]))], "encloses no volume");
}

#[cfg(unix)]
#[test]
fn devices_are_not_read() {
    let message = Model::from_file(Path::new("/dev/zero")).map(|model| model.name).unwrap_err().to_string();
    assert!(message.contains("not a regular file"), "{message}");
}

/// Runs `work` on a thread of its own: a pipe that is waited for fails the test instead of hanging it.
#[cfg(unix)]
fn watched<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let (send, receive) = std::sync::mpsc::channel();
    std::thread::spawn(move || send.send(work()));
    receive.recv_timeout(Duration::from_secs(60)).expect("the reader waits")
}

#[cfg(unix)]
#[test]
fn pipes_are_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["pipe.xml", "pipe.stl", "pipe.bin"] {
        assert!(std::process::Command::new("mkfifo").arg(folder.path().join(name)).status().unwrap().success());
    }
    let include = "<mujoco><include file=\"pipe.xml\"/></mujoco>";
    let mesh = "<mujoco><asset><mesh name=\"m\" file=\"pipe.stl\"/></asset>\
                <worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody></mujoco>";
    let heights = "<mujoco><asset><hfield name=\"h\" size=\"1 1 1 1\" file=\"pipe.bin\"/></asset>\
                   <worldbody><geom type=\"hfield\" hfield=\"h\"/></worldbody></mujoco>";
    for (name, text) in [("include.xml", include), ("mesh.xml", mesh), ("heights.xml", heights), ("pipe.xml", "")] {
        let path = folder.path().join(name);
        if !text.is_empty() {
            fs::write(&path, text).unwrap();
        }
        let message = watched(move || Model::from_file(path).map(|model| model.name).unwrap_err().to_string());
        assert!(message.contains("not a regular file, but a named pipe"), "{name}: {message}");
    }
}

/// Files in memory, which count what is asked of them.
#[derive(Debug, Default)]
struct InMemory {
    files: BTreeMap<PathBuf, Vec<u8>>,
    asked: Mutex<Vec<PathBuf>>,
}

impl ModelFiles for InMemory {
    fn read(&self, path: &Path, limit: u64) -> Result<Option<Vec<u8>>, String> {
        self.asked.lock().unwrap().push(path.to_path_buf());
        match self.files.get(path) {
            Some(bytes) if bytes.len() as u64 > limit => Err("too large".into()),
            Some(bytes) if bytes == b"secret" => Err("it is secret".into()),
            bytes => Ok(bytes.cloned()),
        }
    }
}

#[test]
fn all_files_of_a_model_come_from_where_the_caller_says() {
    let file = |name: &str, content: &[u8]| (PathBuf::from(name), content.to_vec());
    let main = b"<mujoco><include file=\"limb.xml\"/>\
                 <asset><hfield name=\"h\" size=\"1 1 1 1\" file=\"heights.bin\"/></asset>\
                 <worldbody><geom type=\"hfield\" hfield=\"h\"/></worldbody></mujoco>";
    let limb = b"<x><asset><mesh name=\"m\" file=\"m.obj\"/></asset>\
                 <worldbody><body><freejoint/><geom type=\"mesh\" mesh=\"m\"/></body></worldbody></x>";
    let mut heights: Vec<u8> = [2_i32, 2].into_iter().flat_map(i32::to_le_bytes).collect();
    heights.extend([0.0_f32, 1.0, 2.0, 3.0].into_iter().flat_map(f32::to_le_bytes));
    let mesh = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let mut memory = InMemory {
        files: BTreeMap::from([
            file("a/m.xml", main),
            file("a/limb.xml", limb),
            file("a/m.obj", mesh),
            file("a/heights.bin", &heights),
        ]),
        ..Default::default()
    };
    let model = Model::from_files("a/m.xml", &memory).unwrap();
    assert_eq!((model.nv, model.meshes.len(), model.height_fields.len()), (6, 1, 1));
    let mut asked = memory.asked.lock().unwrap().clone();
    asked.sort();
    asked.dedup();
    assert_eq!(asked, memory.files.keys().cloned().collect::<Vec<_>>());
    // A refusal is the answer; nothing else is tried.
    memory.files.insert("a/limb.xml".into(), b"secret".to_vec());
    let message = Model::from_files("a/m.xml", &memory).map(|model| model.name).unwrap_err().to_string();
    assert_eq!(message, "cannot read a/limb.xml: it is secret");
}

/// A piece of a file that a mutation may put anywhere.
fn piece() -> impl Strategy<Value = String> {
    let words = [
        "\"",
        "<",
        ">",
        "/>",
        "</body>",
        "<body>",
        "<frame>",
        "<geom ",
        "class=\"limb\"",
        "type=\"mesh\"",
        "type=\"free\"",
        "nan",
        "-1",
        "1e30",
        "-1e-300",
        "0 0 0",
        "&amp;",
        "&#0;",
        "\u{fffd}",
        "<![CDATA[",
        "<!--",
        "-->",
        "size=\"0\"",
        "pos=\"1e29 0 0\"",
    ];
    prop_oneof![prop::sample::select(words.to_vec()).prop_map(str::to_owned), "[ -~]{0,6}"]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is cut from a good file or put into it, the reader answers.
    #[test]
    fn damaged_files_are_answered(
        file in 0..4_usize,
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..40_usize, piece()), 1..6),
    ) {
        const FILES: [&str; 4] = [
            include_str!("../../../tests/oracle/models/mjcf/frames.xml"),
            include_str!("../../../tests/oracle/models/mjcf/actuators.xml"),
            include_str!("../../../tests/oracle/models/mjcf/inertias.xml"),
            include_str!("../../../tests/oracle/models/muscles.xml"),
        ];
        let mut text: Vec<char> = FILES[file].chars().collect();
        for (place, length, piece) in cuts {
            let start = place.index(text.len());
            let end = (start + length).min(text.len());
            text.splice(start..end, piece.chars());
        }
        let _ = Model::from_mjcf(&text.iter().collect::<String>());
    }

    /// Any one attribute replaced by any number.
    #[test]
    fn any_number_in_any_place_is_answered(place in any::<prop::sample::Index>(), number in any::<f64>()) {
        let text = include_str!("../../../tests/oracle/models/mjcf/actuators.xml");
        let quotes: Vec<usize> = text.match_indices("=\"").map(|(index, _)| index + 2).collect();
        let start = quotes[place.index(quotes.len())];
        let end = start + text[start..].find(['\"', ' ']).unwrap();
        let _ = Model::from_mjcf(&format!("{}{number:?}{}", &text[..start], &text[end..]));
    }
}

#[test]
fn a_giant_file_is_not_read_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("giant.xml");
    // Sparse: a terabyte that takes no room.
    fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
    let message = Model::from_file(&path).map(|model| model.name).unwrap_err().to_string();
    assert!(message.contains("larger than the limit of 67108864 bytes"), "{message}");
}
