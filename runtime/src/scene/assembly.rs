//! Puts a model and what was added to it into one model, in depth-first order.
//!
//! Every array of the result is gathered: an order lists, for each place, which element of the model or of the additions
//! stands there. References are moved along, and what follows from the whole is derived anew.

use super::builder::{Built, SceneBuilder};
use super::check::BuildError;
use super::elements::{NewBody, NewGeom, NewJoint};
use super::kept;
use msk_physics::constants;
use msk_physics::model::inertia::MassProperties;
use msk_physics::model::{
    Actuators, Attachment, AttachmentOrigin, Bias, Bodies, ContactPairs, Dofs, Equality, Gain, GeomKind, Geoms, HeightField,
    JointKind, Joints, Model, PathPoint, Sites, SolverParameters, Transmission, rotation, topology,
};
use nalgebra::Vector3;

/// Number of coordinates and of degrees of freedom of a joint.
pub(super) fn widths(kind: JointKind) -> [usize; 2] {
    match kind {
        JointKind::Free => [7, 6],
        JointKind::Ball => [4, 3],
        JointKind::Slide | JointKind::Hinge => [1, 1],
    }
}

/// The elements at `order`, those of the model counted first.
fn pick<T: Clone>(base: &[T], added: &[T], order: &[usize]) -> Vec<T> {
    order.iter().map(|&index| base.get(index).unwrap_or_else(|| &added[index - base.len()]).clone()).collect()
}

/// A structure of arrays gathered field by field.
macro_rules! gather {
    ($kind:ident, $base:expr, $added:expr, $order:expr; $($field:ident)*; $($other:ident = $value:expr),*) => {
        $kind { $($field: pick(&$base.$field, &$added.$field, $order),)* $($other: $value,)* }
    };
}

/// What stands where in the result, as indices of the builder.
struct Order {
    bodies: Vec<usize>,
    joints: Vec<usize>,
    geoms: Vec<usize>,
    sites: Vec<usize>,
}

impl Order {
    fn of(builder: &SceneBuilder<'_>) -> Self {
        let base = builder.base;
        let count = base.bodies.name.len();
        let bodies = depth_first(builder);
        // What a body of the model has stands together; what was added to a body follows in the order of adding.
        let contents = |of_base: &dyn Fn(usize) -> core::ops::Range<usize>, first: usize, owners: &[usize]| {
            let mut order = Vec::new();
            for &body in &bodies {
                if body < count {
                    order.extend(of_base(body));
                }
                order.extend(owners.iter().enumerate().filter(|(_, owner)| **owner == body).map(|(index, _)| first + index));
            }
            order
        };
        let owners = |carriers: &mut dyn Iterator<Item = usize>| carriers.collect::<Vec<usize>>();
        let sites_of = |body: usize| {
            let first = base.sites.body.partition_point(|owner| *owner < body);
            first..first + base.sites.body[first..].partition_point(|owner| *owner == body)
        };
        let joints = owners(&mut builder.joints.iter().map(|(body, _)| *body));
        let geoms = owners(&mut builder.geoms.iter().map(|(body, _)| *body));
        let sites = owners(&mut builder.sites.iter().map(|(body, _)| *body));
        Self {
            joints: contents(&|body| base.bodies.joints[body].clone(), base.joints.name.len(), &joints),
            geoms: contents(&|body| base.bodies.geoms[body].clone(), base.geoms.name.len(), &geoms),
            sites: contents(&sites_of, base.sites.name.len(), &sites),
            bodies,
        }
    }
}

/// Bodies of model and additions in depth-first order: children of the model before those added to the same parent.
fn depth_first(builder: &SceneBuilder<'_>) -> Vec<usize> {
    let base = &builder.base.bodies;
    let mut children = vec![Vec::new(); base.parent.len() + builder.bodies.len()];
    for (body, &parent) in base.parent.iter().enumerate().skip(1) {
        children[parent].push(body);
    }
    for (index, body) in builder.bodies.iter().enumerate() {
        children[body.parent].push(base.parent.len() + index);
    }
    let mut order = Vec::with_capacity(children.len());
    let mut waiting = vec![0];
    while let Some(body) = waiting.pop() {
        order.push(body);
        waiting.extend(children[body].iter().rev());
    }
    order
}

/// For each element of the builder its place in the result.
fn places(order: &[usize]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    for (place, &index) in order.iter().enumerate() {
        places[index] = place;
    }
    places
}

/// Builds the model.
pub(super) fn assemble(builder: &SceneBuilder<'_>) -> Result<Built, BuildError> {
    let base = builder.base;
    let order = Order::of(builder);
    let [bodies, joints, geoms, sites] = [&order.bodies, &order.joints, &order.geoms, &order.sites].map(|order| places(order));
    // Every part is named, so that a new one cannot be forgotten.
    let mut model = Model {
        name: base.name.clone(),
        options: base.options.clone(),
        bodies: Bodies::default(),
        joints: Joints::default(),
        dofs: Dofs::default(),
        geoms: Geoms::default(),
        meshes: base.meshes.clone(),
        height_fields: base.height_fields.clone(),
        sites: Sites::default(),
        tendons: base.tendons.clone(),
        actuators: base.actuators.clone(),
        elastic_tendons: base.elastic_tendons.clone(),
        equalities: base.equalities.clone(),
        couplings: base.couplings.clone(),
        pairs: pairs(builder, &geoms),
        exclusions: exclusions(base, &bodies),
        nq: 0,
        nv: 0,
        na: base.na,
        keyframes: Vec::new(),
        sensors: base.sensors.clone(),
        mean_inertia: 0.0,
        reference_position: Vec::new(),
    };
    move_references(&mut model, [&bodies, &joints, &geoms, &sites]);
    if carries_load(builder) {
        keep_strength(base, &mut model.actuators);
    }
    gather_bodies(builder, &order, &bodies, &mut model);
    gather_joints(builder, &order, &bodies, &mut model);
    model.keyframes = kept::keyframes(builder, &order.joints, &model);
    gather_shapes(builder, &order, &bodies, &mut model);
    add_attachments(builder, &sites, &mut model);
    for &geom in &builder.intangible {
        (model.geoms.contact_type[geoms[geom]], model.geoms.contact_affinity[geoms[geom]]) = (0, 0);
    }
    for &(geom, friction, priority) in &builder.frictions {
        (model.geoms.friction[geoms[geom]], model.geoms.priority[geoms[geom]]) = (friction, priority);
    }
    topology::complete(&mut model).map_err(BuildError::Model)?;
    constants::derive(&mut model).map_err(BuildError::Model)?;
    Ok(Built { model, bodies, joints, geoms, sites })
}

/// Moves what refers to bodies, joints, shapes and sites along with them.
fn move_references(model: &mut Model, [bodies, joints, geoms, sites]: [&Vec<usize>; 4]) {
    for point in &mut model.tendons.path_points {
        match point {
            PathPoint::Site(site) => *site = sites[*site],
            PathPoint::Wrap { geom, side } => (*geom, *side) = (geoms[*geom], side.map(|site| sites[site])),
            PathPoint::Joint { joint, .. } => *joint = joints[*joint],
            PathPoint::Pulley(_) => {}
        }
    }
    for kind in &mut model.equalities.kind {
        match kind {
            Equality::Connect(attachment) | Equality::Weld { attachment, .. } => {
                attachment.bodies = attachment.bodies.map(|body| bodies[body]);
                if let AttachmentOrigin::Sites(own) = &mut attachment.origin {
                    *own = own.map(|site| sites[site]);
                }
            }
            // Joints are those of the couplings, tendons keep their places.
            Equality::Joint(_) | Equality::Tendon(_) => {}
        }
    }
    for transmission in &mut model.actuators.transmission {
        match transmission {
            Transmission::Joint(joint) | Transmission::JointInParent(joint) => *joint = joints[*joint],
            Transmission::Tendon(_) => {}
            Transmission::Body(body) => *body = bodies[*body],
            Transmission::Site { site, reference } => {
                (*site, *reference) = (sites[*site], reference.map(|site| sites[site]));
            }
        }
    }
    let places = [bodies, joints, geoms, sites];
    model.sensors.measure.iter_mut().for_each(|measure| kept::move_measure(measure, places));
    let couplings = &mut model.couplings;
    couplings.joint.iter_mut().chain(couplings.leader.iter_mut().flatten()).for_each(|joint| *joint = joints[*joint]);
}

/// Appends what is held together to the model's own equalities.
fn add_attachments(builder: &SceneBuilder<'_>, places: &[usize], model: &mut Model) {
    for attachment in &builder.attachments {
        let own = attachment.sites.map(|site| places[site]);
        let frames = Attachment {
            bodies: own.map(|site| model.sites.body[site]),
            position: own.map(|site| model.sites.position[site]),
            orientation: own.map(|site| model.sites.orientation[site]),
            origin: AttachmentOrigin::Sites(own),
        };
        let equalities = &mut model.equalities;
        equalities.name.push(attachment.name.clone());
        equalities.active.push(true);
        equalities.softness.push(attachment.softness);
        equalities.kind.push(match attachment.weld {
            true => Equality::Weld { attachment: frames, torque_scale: 1.0 },
            false => Equality::Connect(frames),
        });
    }
}

/// Whether anything heavy is added to a body of the model other than the world.
fn carries_load(builder: &SceneBuilder<'_>) -> bool {
    let count = builder.base.bodies.name.len();
    let heavy = builder.geoms.iter().filter(|(_, geom)| geom.mass > 0.0);
    heavy.into_iter().any(|&(mut body, _)| {
        while body >= count {
            body = builder.bodies[body - count].parent;
        }
        body != 0
    })
}

/// Makes peak forces explicit that follow from how easily a muscle moves its body: a load changes the strength of no muscle.
fn keep_strength(base: &Model, actuators: &mut Actuators) {
    for (index, scale) in base.actuators.acceleration_scale.iter().enumerate() {
        let own = |figures: &mut [f64; 9]| {
            if figures[2] < 0.0 {
                figures[2] = figures[3] / scale;
            }
        };
        if let Gain::Muscle(figures) = &mut actuators.gain[index] {
            own(figures);
        }
        if let Bias::Muscle(figures) = &mut actuators.bias[index] {
            own(figures);
        }
    }
}

/// Explicit contact pairs but those with intangible shapes.
fn pairs(builder: &SceneBuilder<'_>, places: &[usize]) -> ContactPairs {
    let pairs = &builder.base.pairs;
    let tangible = |pair: &usize| pairs.geoms[*pair].iter().all(|geom| !builder.intangible.contains(geom));
    let kept: Vec<usize> = (0..pairs.geoms.len()).filter(tangible).collect();
    let mut kept = gather!(ContactPairs, pairs, ContactPairs::default(), &kept;
        geoms dimension softness friction_reference friction margin gap;);
    kept.geoms.iter_mut().flatten().for_each(|geom| *geom = places[*geom]);
    kept
}

fn exclusions(base: &Model, places: &[usize]) -> Vec<(usize, usize)> {
    let moved = base.exclusions.iter().map(|&(first, second)| {
        let [first, second] = [places[first], places[second]];
        (first.min(second), first.max(second))
    });
    let mut moved: Vec<(usize, usize)> = moved.collect();
    moved.sort_unstable();
    moved
}

fn gather_bodies(builder: &SceneBuilder<'_>, order: &Order, places: &[usize], model: &mut Model) {
    let count = builder.base.bodies.name.len();
    let mut added = Bodies::default();
    for (index, body) in builder.bodies.iter().enumerate() {
        push_body(body, &builder.mass_properties(count + index), &mut added);
    }
    model.bodies = gather!(Bodies, builder.base.bodies, added, &order.bodies;
        name parent position orientation inertial_position inertial_orientation mass inertia mocap
        gravity_compensation;
        root = Vec::new(), weld = Vec::new(), subtree_mass = Vec::new(), joints = Vec::new(), dofs = Vec::new(),
        geoms = Vec::new(), inverse_weight = Vec::new());
    model.bodies.parent.iter_mut().for_each(|parent| *parent = places[*parent]);
}

fn push_body(body: &NewBody, mass: &MassProperties, into: &mut Bodies) {
    into.name.push(body.name.clone());
    into.parent.push(body.parent);
    into.position.push(body.position);
    into.orientation.push(body.orientation);
    into.inertial_position.push(mass.centre);
    into.inertial_orientation.push(mass.axes);
    into.mass.push(mass.mass);
    into.inertia.push(mass.moments);
    into.mocap.push(body.placed);
    into.gravity_compensation.push(0.0);
}

fn gather_joints(builder: &SceneBuilder<'_>, order: &Order, places: &[usize], model: &mut Model) {
    let base = builder.base;
    let (mut joints, mut dofs) = (Joints::default(), Dofs::default());
    for (body, joint) in &builder.joints {
        push_joint(*body, joint, &mut joints, &mut dofs);
    }
    model.joints = gather!(Joints, base.joints, joints, &order.joints;
        name kind body anchor axis range margin limit_softness friction_softness stiffness spring_reference actuator_force_range
        actuator_compensates;
        position_address = Vec::new(), dof_address = Vec::new());
    model.joints.body.iter_mut().for_each(|body| *body = places[*body]);
    // Degrees of freedom follow their joints: those of an added joint are counted on from the model's.
    let (mut dof_order, mut added_dofs) = (Vec::new(), Vec::new());
    let mut next = base.nv;
    for (_, joint) in &builder.joints {
        added_dofs.push(next);
        next += widths(joint.kind)[1];
    }
    for (place, &index) in order.joints.iter().enumerate() {
        let [coordinates, freedom] = widths(model.joints.kind[place]);
        let (addresses, starts) = (&mut model.joints.position_address, &mut model.joints.dof_address);
        addresses.push(model.reference_position.len());
        starts.push(dof_order.len());
        let (first, reference) = match index.checked_sub(base.joints.name.len()) {
            None => {
                let address = base.joints.position_address[index];
                (base.joints.dof_address[index], base.reference_position[address..address + coordinates].to_vec())
            }
            Some(added) => {
                let body = model.joints.body[place];
                (added_dofs[added], reference(&model.bodies, body, model.joints.kind[place]))
            }
        };
        model.reference_position.extend(reference);
        dof_order.extend(first..first + freedom);
    }
    model.dofs = gather!(Dofs, base.dofs, dofs, &dof_order; armature damping friction_loss;
        body = Vec::new(), joint = Vec::new(), parent = Vec::new(), inverse_weight = Vec::new(), row = Vec::new(),
        column = Vec::new());
    for (place, kind) in model.joints.kind.iter().enumerate() {
        for _ in 0..widths(*kind)[1] {
            model.dofs.joint.push(place);
            model.dofs.body.push(model.joints.body[place]);
        }
    }
    model.bodies.joints = ranges(model.bodies.name.len(), &model.joints.body);
}

/// Coordinates of an added joint at the reference configuration.
fn reference(bodies: &Bodies, body: usize, kind: JointKind) -> Vec<f64> {
    match kind {
        JointKind::Free => bodies.position[body].iter().copied().chain(bodies.orientation[body]).collect(),
        JointKind::Ball => rotation::IDENTITY.to_vec(),
        JointKind::Slide | JointKind::Hinge => vec![0.0],
    }
}

fn push_joint(body: usize, joint: &NewJoint, into: &mut Joints, dofs: &mut Dofs) {
    let directed = matches!(joint.kind, JointKind::Hinge | JointKind::Slide);
    let axis = rotation::unit_vector(joint.axis).filter(|_| directed).unwrap_or_else(Vector3::z);
    let free = joint.kind == JointKind::Free;
    into.name.push(joint.name.clone());
    into.kind.push(joint.kind);
    into.body.push(body);
    into.anchor.push(if free { Vector3::zeros() } else { joint.anchor });
    into.axis.push(axis);
    into.range.push(joint.range.filter(|_| !free));
    into.margin.push(0.0);
    into.limit_softness.push(SolverParameters::default());
    into.friction_softness.push(SolverParameters::default());
    into.stiffness.push(joint.stiffness);
    into.spring_reference.push(0.0);
    into.actuator_force_range.push(None);
    into.actuator_compensates.push(false);
    for _ in 0..widths(joint.kind)[1] {
        dofs.armature.push(0.0);
        dofs.damping.push(joint.damping);
        dofs.friction_loss.push(joint.friction_loss);
    }
}

fn gather_shapes(builder: &SceneBuilder<'_>, order: &Order, places: &[usize], model: &mut Model) {
    let base = builder.base;
    let mut geoms = Geoms::default();
    for (body, geom) in &builder.geoms {
        push_geom(*body, geom, &mut model.height_fields, &mut geoms);
    }
    model.geoms = gather!(Geoms, base.geoms, geoms, &order.geoms;
        name kind body size asset position orientation contact_type contact_affinity contact_dimension priority softness_mix
        softness friction margin gap bounding_radius group visible;);
    model.geoms.body.iter_mut().for_each(|body| *body = places[*body]);
    model.bodies.geoms = ranges(model.bodies.name.len(), &model.geoms.body);
    let mut sites = Sites::default();
    for (body, site) in &builder.sites {
        sites.name.push(site.name.clone());
        sites.body.push(*body);
        sites.position.push(site.position);
        sites.orientation.push(site.orientation);
    }
    model.sites = gather!(Sites, base.sites, sites, &order.sites; name body position orientation;);
    model.sites.body.iter_mut().for_each(|body| *body = places[*body]);
}

fn push_geom(body: usize, geom: &NewGeom, fields: &mut Vec<HeightField>, into: &mut Geoms) {
    let field = geom.heights.as_ref().filter(|_| geom.kind == GeomKind::HeightField);
    into.name.push(geom.name.clone());
    into.kind.push(geom.kind);
    into.body.push(body);
    into.size.push(field.map_or(geom.size, HeightField::size));
    into.asset.push(field.map(|_| fields.len()));
    into.bounding_radius.push(field.map_or_else(|| geom.kind.bounding_radius(geom.size), HeightField::bounding_radius));
    fields.extend(field.cloned());
    into.position.push(geom.position);
    into.orientation.push(geom.orientation);
    into.contact_type.push(geom.contact_type);
    into.contact_affinity.push(geom.contact_affinity);
    into.contact_dimension.push(geom.contact_dimension);
    into.priority.push(geom.priority);
    into.softness_mix.push(1.0);
    into.softness.push(geom.softness);
    into.friction.push(geom.friction);
    into.margin.push(0.0);
    into.gap.push(0.0);
    into.group.push(0);
    into.visible.push(true);
}

/// For each of `count` bodies the range of what it owns: `owners` is ascending. Bodies without any begin where the one before
/// ends.
fn ranges(count: usize, owners: &[usize]) -> Vec<core::ops::Range<usize>> {
    let mut end = 0;
    (0..count)
        .map(|body| {
            let start = end;
            end += owners[start..].partition_point(|owner| *owner == body);
            start..end
        })
        .collect()
}
