//! The good files that the broken ones are made of: one for each kind of content.

/// Name and text.
pub const SEEDS: [(&str, &str); 17] = [
    ("frames", include_str!("../../../../tests/oracle/models/mjcf/frames.xml")),
    ("actuators", include_str!("../../../../tests/oracle/models/mjcf/actuators.xml")),
    ("inertias", include_str!("../../../../tests/oracle/models/mjcf/inertias.xml")),
    ("copies", include_str!("../../../../tests/oracle/models/mjcf/copies.xml")),
    ("masses", include_str!("../../../../tests/oracle/models/mjcf/masses.xml")),
    ("joints", include_str!("../../../../tests/oracle/models/joints.xml")),
    ("muscles", include_str!("../../../../tests/oracle/models/muscles.xml")),
    ("pulley", include_str!("../../../../tests/oracle/models/pulley.xml")),
    ("tendon springs", include_str!("../../../../tests/oracle/models/tendon_springs.xml")),
    ("wrap cylinder", include_str!("../../../../tests/oracle/models/wrap_cylinder.xml")),
    ("wrap inside", include_str!("../../../../tests/oracle/models/wrap_inside.xml")),
    ("wrap sphere", include_str!("../../../../tests/oracle/models/wrap_sphere.xml")),
    ("heap", include_str!("../../../../tests/oracle/contact_models/heap.xml")),
    ("limits", include_str!("../../../../tests/oracle/contact_models/limits.xml")),
    ("parallel", include_str!("../../../../tests/oracle/contact_models/parallel.xml")),
    ("shapes", include_str!("../../../../tests/oracle/contact_models/shapes.xml")),
    ("included", INCLUDING),
];

/// A model of two files.
const INCLUDING: &str = "<mujoco model=\"two files\">
  <include file=\"limb.xml\"/>
  <worldbody><body name=\"trunk\"><freejoint/><geom size=\"0.2\"/></body></worldbody>
</mujoco>";

/// What it includes.
const INCLUDED: &str = "<mujoco>
  <default><default class=\"limb\"><geom size=\"0.1\" density=\"500\"/></default></default>
  <worldbody><body name=\"limb\" childclass=\"limb\" pos=\"1 0 0\"><joint axis=\"0 1 0\"/><geom/></body></worldbody>
</mujoco>";

/// The other files that a seed needs beside it.
pub fn others(text: &str) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    if text.contains("limb.xml") {
        files.push(("limb.xml".to_owned(), INCLUDED.as_bytes().to_vec()));
    }
    if text.contains("notched.stl") {
        files.push((
            "meshes/notched.stl".to_owned(),
            include_bytes!("../../../../tests/oracle/models/mjcf/meshes/notched.stl").to_vec(),
        ));
    }
    files
}
