//! A body file to begin with, written from a model: every name in it exists, and it binds as it stands.

use msk::compiler::numbers::exact;
use msk::compiler::syntax::is_name;
use msk::physics::model::{JointKind, Model};
use msk::physics::{State, Workspace, kinematics};
use msk::runtime::body::{NEUTRAL, subtree};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The model has no body on which a body file could stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the model has no named body that is a child of the world")]
pub struct NoRoot;

/// A body file called `name` for a model that stands at `path`, relative to the file: its root, a landmark on every body that has
/// a shape that touches things, names for joints that tasks could not spell, and a neutral pose within all ranges.
///
/// Which axes of a body point forward and up is read off the model's initial configuration, taken to stand upright along +x.
///
/// # Errors
/// A model without a named body.
pub fn scaffold(name: &str, model: &Model, path: &str) -> Result<String, NoRoot> {
    let root = root(model).ok_or(NoRoot)?;
    let members = subtree(model, root);
    let (state, mut workspace) = (State::<f64>::new(model), Workspace::<f64>::new(model));
    kinematics::update(model, &state, &mut workspace.kinematics);
    let axes = |body: usize| axes_of(&workspace.kinematics.body_rotation[body]);

    let mut taken: BTreeSet<String> = BTreeSet::new();
    let joints: Vec<usize> = (0..model.joints.name.len())
        .filter(|&joint| matches!(model.joints.kind[joint], JointKind::Hinge | JointKind::Slide))
        .filter(|&joint| members.contains(&model.joints.body[joint]))
        .collect();
    let mut aliases = String::new();
    let mut called = Vec::with_capacity(joints.len());
    for &joint in &joints {
        let original = &model.joints.name[joint];
        let own = free_name(original, "joint", &mut taken);
        if own != *original && !original.is_empty() {
            let _ = writeln!(aliases, "    joint {own} = \"{original}\"");
        }
        called.push(own);
    }

    let mut text = format!(
        "//! NAME: describe this body and the origin of its model.\n//!\n//! Points are in metres, in the frame of the model's body. The axes `forward` and `up` were derived from the model's initial\n//! configuration: check each. `msk check` of this file reports everything that does not match the model.\n\nbody {name} {{\n    model \"{path}\"\n"
    );
    let _ = writeln!(text, "    root  \"{}\" {{ {} }}", model.bodies.name[root], axes(root));
    text += "\n    // Landmarks: the points that tasks can read, such as `pelvis.height`. The tasks of the library read `pelvis`, `torso`, `head`,\n    // `sole_{l,r}`\n";
    text += "    // and `palm_{l,r}`: rename the corresponding landmarks. A segment lists the shapes of the model that have contacts.\n\n";
    for body in members.clone().filter(|&body| !model.bodies.name[body].is_empty()) {
        let shapes: Vec<String> = (0..model.geoms.body.len())
            .filter(|&geom| model.geoms.body[geom] == body && !model.geoms.name[geom].is_empty())
            .filter(|&geom| model.geoms.contact_type[geom] != 0 || model.geoms.contact_affinity[geom] != 0)
            .map(|geom| format!("\"{}\"", model.geoms.name[geom]))
            .collect();
        if shapes.is_empty() && body != root {
            continue;
        }
        let original = &model.bodies.name[body];
        let own = free_name(original, "part", &mut taken);
        let segment = if shapes.is_empty() { String::new() } else { format!(", segment [{}]", shapes.join(", ")) };
        let _ = writeln!(text, "    /// The body `{original}` of the model, at the origin of its frame.");
        let _ = writeln!(text, "    landmark {own} {{ on \"{original}\", at [0, 0, 0], {}{segment} }}", axes(body));
    }
    if !aliases.is_empty() {
        let _ = write!(text, "\n    // Joints whose names in the model are not valid names of tasks.\n\n{aliases}");
    }
    text += "\n    // Poses: joints that are not listed are zero.\n\n";
    let neutral = neutral(model, &joints, &called);
    let _ = writeln!(text, "    pose {NEUTRAL} {{ {neutral}}}\n}}");
    Ok(text.replace("NAME", name))
}

/// The body that moves freely and carries most, else the first that hangs on the world.
fn root(model: &Model) -> Option<usize> {
    let named = |&body: &usize| !model.bodies.name[body].is_empty();
    let on_world = || (1..model.bodies.name.len()).filter(|&body| model.bodies.parent[body] == 0).filter(named);
    let free = |body: usize| model.bodies.joints[body].clone().any(|joint| model.joints.kind[joint] == JointKind::Free);
    let largest = on_world().filter(|&body| free(body)).max_by_key(|&body| (subtree(model, body).len(), usize::MAX - body));
    largest.or_else(|| on_world().next())
}

/// `forward x, up z`: the axes of a frame nearest to +x and to +z of the world.
fn axes_of(rotation: &Matrix3<f64>) -> String {
    let nearest = |direction: Vector3<f64>, without: Option<usize>| {
        let along = rotation.transpose() * direction;
        let best = (0..3)
            .filter(|axis| Some(*axis) != without)
            .max_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs()).then(b.cmp(&a)));
        let axis = best.unwrap_or(0);
        (axis, format!("{}{}", if along[axis] < 0.0 { "-" } else { "" }, ["x", "y", "z"][axis]))
    };
    let (up, up_word) = nearest(Vector3::z(), None);
    let (_, forward_word) = nearest(Vector3::x(), Some(up));
    format!("forward {forward_word}, up {up_word}")
}

/// A name for tasks that is like the model's and not taken yet.
fn free_name(original: &str, kind: &str, taken: &mut BTreeSet<String>) -> String {
    let spelled: String =
        original.to_ascii_lowercase().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let spelled = spelled.trim_matches('_');
    let whole = if is_name(spelled) { spelled.to_owned() } else { format!("{kind}_{spelled}").trim_end_matches('_').to_owned() };
    let candidates = std::iter::once(whole.clone()).chain((2..).map(|number| format!("{whole}_{kind}{number}")));
    let free = candidates.into_iter().find(|name| !taken.contains(name)).unwrap_or(whole);
    taken.insert(free.clone());
    free
}

/// Independent joints whose range leaves out zero, each at the nearest end of its range.
fn neutral(model: &Model, joints: &[usize], called: &[String]) -> String {
    let followers: BTreeSet<usize> = model.couplings.joint.iter().copied().collect();
    let mut set = Vec::new();
    for (&joint, name) in joints.iter().zip(called) {
        let Some([low, high]) = model.joints.range[joint] else { continue };
        if followers.contains(&joint) || (low <= 0.0 && 0.0 <= high) {
            continue;
        }
        let unit = if model.joints.kind[joint] == JointKind::Hinge { "rad" } else { "m" };
        set.push(format!("{name} = {} {unit}", exact(if low > 0.0 { low } else { high })));
    }
    if set.is_empty() { String::new() } else { format!("{} ", set.join(", ")) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use msk::compiler::compile;
    use msk::compiler::files::{LoadError, Loader};
    use msk::runtime::library::BodyLibrary;
    use std::path::Path;

    const MODEL: &str = r#"<mujoco><compiler angle="radian"/><worldbody><geom type="plane" size="0 0 1"/>
        <body name="Rack" pos="2 0 0"><geom name="rack" size="0.1"/></body>
        <body name="Full Body" pos="0 0 1" euler="0 0 1.5707963267948966"><freejoint/><geom name="trunk" size="0.1"/>
          <body name="deg" pos="0 0 -0.3"><joint name="Knee.R" axis="1 0 0" limited="true" range="0.2 2"/>
            <geom name="shank" size="0.1"/></body>
          <body name="inner"><joint name="inner" axis="0 1 0"/><geom size="0.05" contype="0" conaffinity="0"/></body>
        </body></worldbody></mujoco>"#;

    struct One<'a>(&'a str);

    impl Loader for One<'_> {
        fn load(&self, path: &Path) -> Result<String, LoadError> {
            if path.ends_with("legs.msk") { Ok(self.0.to_owned()) } else { Err(LoadError::Missing(path.to_path_buf())) }
        }
    }

    #[test]
    fn a_scaffold_names_what_the_model_has() {
        let text = scaffold("legs", &Model::from_mjcf(MODEL).unwrap(), "legs.xml").unwrap();
        assert!(text.contains("root  \"Full Body\" { forward -y, up z }"), "{text}");
        assert!(text.contains("landmark part_deg { on \"deg\", at [0, 0, 0], forward -y, up z, segment [\"shank\"] }"), "{text}");
        assert!(text.contains("joint knee_r = \"Knee.R\"") && text.contains("pose neutral { knee_r = 0.2 rad }"), "{text}");
        assert!(!text.contains("Rack") && !text.contains("inner"), "{text}");
    }

    #[test]
    fn a_scaffold_binds_to_its_model_as_it_stands() {
        let folder = tempfile::tempdir().unwrap();
        let model = folder.path().join("legs.xml");
        std::fs::write(&model, MODEL).unwrap();
        let text = scaffold("legs", &Model::from_mjcf(MODEL).unwrap(), "legs.xml").unwrap();
        let compiled = compile(&folder.path().join("legs.msk"), &One(&text), &BodyLibrary::default());
        assert!(compiled.is_ok(), "{}\n{text}", compiled.err().map_or(String::new(), |report| report.to_string()));
    }

    #[test]
    fn a_model_without_bodies_has_no_root() {
        let model = Model::from_mjcf("<mujoco><worldbody><geom size=\"1\"/></worldbody></mujoco>").unwrap();
        assert_eq!(scaffold("nothing", &model, "nothing.xml"), Err(NoRoot));
    }
}
