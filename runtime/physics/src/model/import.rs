//! Importing a model: what the simulator needs of somebody else's files, in one flat file of figures.

use super::{Model, PathPoint, Sensors};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Prunes what has no part in the physics.
pub fn import(mut model: Model) -> Model {
    drop_ornaments(&mut model);
    model.keyframes.clear();
    model.sensors = Sensors::default();
    name_collision_shapes(&mut model);
    model
}

/// The model as the text of a file, with a comment that names where it comes from and what was changed.
pub fn to_file_text(model: &Model, source: &Path) -> String {
    let name = source.file_name().unwrap_or_default().to_string_lossy();
    // Two hyphens would end the comment.
    let name = name.replace("--", "- -");
    format!(
        "<!-- Flattened from {name} by `msk physics import`: includes and default classes resolved, inertias explicit;\n     \
         meshes, shapes without contact or wrapping, cameras, lights, materials, sensors and key frames left out;\n     \
         collision shapes without a name named after their body. Origin and licence: NOTICE beside this file. -->\n{}",
        model.to_mjcf()
    )
}

/// Drops shapes that neither collide nor carry a tendon. All sites stay: those no tendon uses mark the anatomy.
fn drop_ornaments(model: &mut Model) {
    let geoms = &model.geoms;
    let mut kept: Vec<bool> =
        geoms.contact_type.iter().zip(&geoms.contact_affinity).map(|(kind, affinity)| (kind | affinity) != 0).collect();
    model.pairs.geoms.iter().flatten().for_each(|geom| kept[*geom] = true);
    for point in &model.tendons.path_points {
        if let PathPoint::Wrap { geom, .. } = point {
            kept[*geom] = true;
        }
    }
    retain_geoms(model, &kept);
}

/// Keeps the geoms marked, in their order, and moves every reference along.
fn retain_geoms(model: &mut Model, kept: &[bool]) {
    // The number of kept geoms before each: a kept geom's new index, and where ranges move to.
    let mut before = vec![0; kept.len() + 1];
    for (geom, keep) in kept.iter().enumerate() {
        before[geom + 1] = before[geom] + usize::from(*keep);
    }
    fn retain<T>(values: &mut Vec<T>, kept: &[bool]) {
        let mut marks = kept.iter();
        values.retain(|_| marks.next().copied().unwrap_or(false));
    }
    let geoms = &mut model.geoms;
    retain(&mut geoms.name, kept);
    retain(&mut geoms.kind, kept);
    retain(&mut geoms.body, kept);
    retain(&mut geoms.size, kept);
    retain(&mut geoms.asset, kept);
    retain(&mut geoms.position, kept);
    retain(&mut geoms.orientation, kept);
    retain(&mut geoms.contact_type, kept);
    retain(&mut geoms.contact_affinity, kept);
    retain(&mut geoms.contact_dimension, kept);
    retain(&mut geoms.priority, kept);
    retain(&mut geoms.softness_mix, kept);
    retain(&mut geoms.softness, kept);
    retain(&mut geoms.friction, kept);
    retain(&mut geoms.margin, kept);
    retain(&mut geoms.gap, kept);
    retain(&mut geoms.bounding_radius, kept);
    retain(&mut geoms.group, kept);
    for range in &mut model.bodies.geoms {
        *range = before[range.start]..before[range.end];
    }
    model.pairs.geoms.iter_mut().flatten().for_each(|geom| *geom = before[*geom]);
    for point in &mut model.tendons.path_points {
        if let PathPoint::Wrap { geom, .. } = point {
            *geom = before[*geom];
        }
    }
}

/// Names unnamed shapes after their body, so that landmarks and reports can speak of them.
fn name_collision_shapes(model: &mut Model) {
    let mut taken: BTreeSet<String> = model.geoms.name.iter().cloned().collect();
    // The last number given to each stem: counting starts there, not anew for every shape.
    let mut numbers = BTreeMap::new();
    for geom in 0..model.geoms.name.len() {
        if !model.geoms.name[geom].is_empty() {
            continue;
        }
        let stem = format!("{}_collision", model.bodies.name[model.geoms.body[geom]]);
        let number = numbers.entry(stem.clone()).or_insert(1_usize);
        let mut name = stem.clone();
        while !taken.insert(name.clone()) {
            *number += 1;
            name = format!("{stem}_{number}");
        }
        model.geoms.name[geom] = name;
    }
}
