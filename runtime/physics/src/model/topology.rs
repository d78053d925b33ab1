//! What follows from the tree's shape alone: roots, welds, subtree masses, the sparsity of the mass matrix.
//!
//! Readers of files and builders of scenes fill what is given and call [`complete`]; constants that need the physics come
//! after it, from [`constants`](crate::constants).

use super::Model;

/// The mass matrix may have this many entries.
const MOST_ENTRIES: usize = 20_000_000;

/// A model may have this many geoms, and this many pairs of them that may meet.
const MOST_GEOMS: usize = 20_000;
const MOST_PAIRS: usize = 2_000_000;

/// Constants are derived by one solve with the mass matrix per body, dof and actuator: so many of them at most, and so many
/// entries visited in all.
const MOST_SOLVES: usize = 100_000;
const MOST_WORK: usize = 1_000_000_000;

/// Masses and moments below this count as zero (MuJoCo's `mjMINVAL`).
const LEAST: f64 = 1e-15;

/// Fills the derived arrays. Constants that need the physics are left at zero, with the right lengths.
///
/// # Errors
/// In words: a moving body without mass, or a model so large that compiling it would take minutes.
pub fn complete(model: &mut Model) -> Result<(), String> {
    model.nq = model.reference_position.len();
    model.nv = model.dofs.body.len();
    bodies(model);
    check_masses(model)?;
    dofs(model)?;
    check_size(model)?;
    model.bodies.inverse_weight = vec![[0.0; 2]; model.bodies.name.len()];
    model.dofs.inverse_weight = vec![0.0; model.nv];
    let tendons = model.tendons.name.len();
    model.tendons.reference_length = vec![0.0; tendons];
    model.tendons.resting_length = vec![0.0; tendons];
    model.tendons.inverse_weight = vec![0.0; tendons];
    model.actuators.acceleration_scale = vec![0.0; model.actuators.name.len()];
    Ok(())
}

fn bodies(model: &mut Model) {
    let bodies = &mut model.bodies;
    let count = bodies.name.len();
    (bodies.root, bodies.weld, bodies.dofs) = Default::default();
    bodies.subtree_mass = bodies.mass.clone();
    for body in (1..count).rev() {
        bodies.subtree_mass[bodies.parent[body]] += bodies.subtree_mass[body];
    }
    bodies.mocap.resize(count, false);
    bodies.gravity_compensation.resize(count, 0.0);
    let joints = &mut model.joints;
    joints.actuator_force_range.resize(joints.kind.len(), None);
    joints.actuator_compensates.resize(joints.kind.len(), false);
    // Parents come before children, so one pass down the tree carries roots and welds along.
    for body in 0..count {
        let parent = bodies.parent[body];
        bodies.root.push(if parent == 0 { body } else { bodies.root[parent] });
        let own = body == 0 || bodies.mocap[body] || !bodies.joints[body].is_empty();
        bodies.weld.push(if own { body } else { bodies.weld[parent] });
        // Bodies are read in order, and so are their dofs: a body's start where the previous one's end.
        let end = bodies.joints[body].end;
        let dof_end = model.joints.dof_address.get(end).copied().unwrap_or(model.nv);
        let start = bodies.dofs.last().map_or(0, |range: &core::ops::Range<usize>| range.end);
        bodies.dofs.push(start..dof_end);
    }
}

/// Parents of dofs, and the rows of the mass matrix: a dof couples to those on its path to the root.
fn dofs(model: &mut Model) -> Result<(), String> {
    let dofs = &mut model.dofs;
    (dofs.parent, dofs.row, dofs.column) = Default::default();
    for dof in 0..model.nv {
        let body = model.dofs.body[dof];
        let first = dof == model.bodies.dofs[body].start;
        let parent = if first { last_dof_above(model, body) } else { Some(dof - 1) };
        let start = model.dofs.column.len();
        if let Some(parent) = parent {
            let row = model.dofs.row[parent].clone();
            model.dofs.column.extend_from_within(row);
        }
        model.dofs.column.push(dof);
        if model.dofs.column.len() > MOST_ENTRIES {
            return Err(format!("the mass matrix has more than {MOST_ENTRIES} entries"));
        }
        model.dofs.parent.push(parent);
        model.dofs.row.push(start..model.dofs.column.len());
    }
    Ok(())
}

fn last_dof_above(model: &Model, mut body: usize) -> Option<usize> {
    while body != 0 {
        body = model.bodies.parent[body];
        if !model.bodies.dofs[body].is_empty() {
            return Some(model.bodies.dofs[body].end - 1);
        }
    }
    None
}

/// Refuses models so large that compiling them would take minutes.
fn check_size(model: &Model) -> Result<(), String> {
    let geoms = model.geoms.name.len();
    if geoms > MOST_GEOMS {
        return Err(format!("the model has {geoms} geoms; at most {MOST_GEOMS} are supported"));
    }
    let pairs = colliding_pairs(model);
    if pairs > MOST_PAIRS {
        return Err(format!("{pairs} pairs of shapes can collide; at most {MOST_PAIRS} are supported"));
    }
    let solves = model.bodies.name.len() + model.nv + model.tendons.name.len() + model.actuators.name.len();
    let entries = model.dofs.column.len() + model.nv;
    // Bodies and dofs visit only their path to the root, tendons and actuators everything.
    let depths = model.dofs.row.iter().map(|row| row.len() * row.len()).sum::<usize>();
    let whole = model.tendons.name.len() + model.actuators.name.len();
    let work = whole.saturating_mul(entries).saturating_add(depths.saturating_mul(8));
    if work > MOST_WORK || solves > MOST_SOLVES {
        let freedom = model.nv;
        return Err(format!(
            "the model is too large: {freedom} degrees of freedom, {solves} bodies, degrees, tendons and muscles"
        ));
    }
    Ok(())
}

/// How many pairs of geoms on bodies not welded together have matching contact bits.
fn colliding_pairs(model: &Model) -> usize {
    let geoms = &model.geoms;
    let weld = |geom: usize| model.bodies.weld[geoms.body[geom]];
    let meet = |a: usize, b: usize| {
        let bits = geoms.contact_type[a] & geoms.contact_affinity[b] | geoms.contact_type[b] & geoms.contact_affinity[a];
        bits != 0 && weld(a) != weld(b)
    };
    let colliding: Vec<usize> =
        (0..geoms.name.len()).filter(|geom| geoms.contact_type[*geom] | geoms.contact_affinity[*geom] != 0).collect();
    let after = |(index, a): (usize, &usize)| colliding[index + 1..].iter().filter(|b| meet(*a, **b)).count();
    colliding.iter().enumerate().map(after).sum()
}

/// Refuses bodies that move without mass or inertia: the mass matrix would be singular.
fn check_masses(model: &Model) -> Result<(), String> {
    let bodies = &model.bodies;
    let heavy = |body: usize| bodies.mass[body] > LEAST && bodies.inertia[body].iter().all(|moment| *moment > LEAST);
    let mut carried = vec![false; bodies.name.len()];
    for body in 1..bodies.name.len() {
        carried[bodies.weld[body]] |= heavy(body);
    }
    let light = (1..bodies.name.len()).find(|body| bodies.weld[*body] == *body && !bodies.mocap[*body] && !carried[*body]);
    match light {
        Some(body) => {
            let name = &bodies.name[body];
            Err(format!("the moving body `{name}` (number {body}) has no mass or no inertia"))
        }
        None => Ok(()),
    }
}
