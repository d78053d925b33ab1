//! What a picture shows: solids, muscles and labels, in the world at a moment.

use super::muscles::{self, Belly, Tube};
use super::palette::{self, Colouring, Colours};
use super::solids::{self, Solid};
use super::{Options, Picture, PictureError, Rgb, Vector, geometry, label, shade, single};
use crate::anatomy::Anatomy;
use crate::shapes::Shape;
use msk_physics::kinematics::{self, Kinematics};
use msk_physics::{State, rotation};
use msk_program::numbers::fixed;
use msk_runtime::body::sensors::Snapshot;
use msk_runtime::condition::Compartments;
use msk_runtime::episode::{Environment, EpisodeKey};
use msk_runtime::reference::Reference;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Length of the arrow of a force as large as the body's weight, m.
const ARROW: f32 = 0.6;
/// Forces that are smaller are not shown, as a share of the weight.
const SMALLEST_FORCE: f64 = 0.02;
const SMALLEST_BONE: f32 = 0.008;
/// Shapes smaller than this have coarse triangles, m.
const SMALL: f64 = 0.045;

/// Takes scenes of an environment.
pub struct Renderer {
    anatomy: Anatomy,
    meshes: Arc<[Solid]>,
    strengths: Vec<f64>,
    colouring: Colouring,
    /// The episode whose shapes and reference these are.
    episode: Option<EpisodeKey>,
    reference: Reference,
    /// Where the reference motion has the bodies.
    ghost: Option<(State<f64>, Kinematics<f64>)>,
}

/// What an environment shows at a moment.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Time of the episode, s.
    pub time: f64,
    pub(super) centre: Vector,
    pub(super) ground: bool,
    pub(super) meshes: Arc<[Solid]>,
    pub(super) solids: Vec<Placed>,
    pub(super) shells: [Vec<Placed>; 2],
    pub(super) tubes: Vec<Tube>,
    pub(super) labels: Vec<Label>,
    pub(super) colouring: Colouring,
    pub(super) muscles: bool,
}

/// Which unit shape, and what covers it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    Ball,
    SmallBall,
    Box,
    Cylinder,
    Bone,
    Arrow,
    Mesh(usize),
}

/// What a surface is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Paint {
    Scenery,
    Bone,
    Arrow,
    Marker,
    Muscle,
    Skin,
    Ghost,
    MarkerBall,
}

/// A unit shape in the world.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub form: Form,
    pub place: Vector,
    pub turn: Matrix3<f32>,
    pub size: Vector,
    /// Half the length of a capsule between its caps, m.
    pub half: f32,
    pub paint: Paint,
}

/// A name or number at a place.
#[derive(Debug, Clone)]
pub(super) struct Label {
    pub at: Vector,
    pub text: String,
    pub paint: Paint,
}

impl Paint {
    pub fn colour(self, colours: &Colours) -> Rgb {
        match self {
            Self::Scenery => colours.scenery,
            Self::Bone => colours.bone,
            Self::Arrow => colours.arrow,
            Self::Marker | Self::MarkerBall => colours.marker,
            Self::Muscle => colours.tendon,
            Self::Skin => colours.skin,
            Self::Ghost => colours.ghost,
        }
    }
}

impl Form {
    pub fn solid(self, meshes: &[Solid]) -> Option<&Solid> {
        Some(match self {
            Self::Ball => &solids::BALL,
            Self::SmallBall => &solids::SMALL_BALL,
            Self::Box => &solids::BOX,
            Self::Cylinder => &solids::CYLINDER,
            Self::Bone => &solids::BONE,
            Self::Arrow => &solids::ARROW,
            Self::Mesh(mesh) => meshes.get(mesh)?,
        })
    }
}

impl Renderer {
    /// For the episodes of an environment whose muscles have these strengths, one per muscle; none for healthy ones.
    pub fn new(environment: &Environment, strengths: &[f64], colouring: Colouring) -> Self {
        Self::of(&environment.context().snapshot(), strengths, colouring)
    }

    /// For snapshots of one model.
    pub fn of(snapshot: &Snapshot<'_>, strengths: &[f64], colouring: Colouring) -> Self {
        let anatomy = Anatomy::of(snapshot, strengths);
        let meshes = anatomy.meshes.iter().map(|mesh| solids::facets(&mesh.corners, &mesh.triangles)).collect();
        let reference = Reference::new(snapshot.model);
        Self { anatomy, meshes, strengths: strengths.to_vec(), colouring, episode: None, reference, ghost: None }
    }

    /// What the environment shows at present.
    pub fn scene(&mut self, environment: &Environment) -> Scene {
        let context = environment.context();
        let snapshot = context.snapshot();
        let time = f64::from(environment.steps()) * environment.control_period();
        // Shapes may be drawn for each episode, and the path of the reference begins where the root stood.
        if environment.steps() == 0 || self.episode != Some(environment.key()) {
            *self = Self { episode: Some(environment.key()), ..Self::of(&snapshot, &self.strengths, self.colouring) };
        }
        let mut scene = self.scene_of(time, &snapshot, environment.compartments());
        if let Some(coordinates) = self.reference.coordinates(&context) {
            let (state, placed) =
                self.ghost.get_or_insert_with(|| (snapshot.state.clone(), snapshot.workspace.kinematics.clone()));
            state.position.copy_from_slice(coordinates);
            kinematics::update(snapshot.model, state, placed);
            let own = self.anatomy.shapes.iter().filter(|shape| shape.own);
            scene.shells[1].extend(own.filter_map(|shape| place(shape, placed, Paint::Ghost)));
        }
        for (name, at) in environment.markers() {
            let at = single(&Vector3::from(at));
            let ball = |form, size: f32, paint| Placed {
                form,
                place: at,
                turn: Matrix3::identity(),
                size: Vector::repeat(size),
                half: 0.0,
                paint,
            };
            scene.shells[1].push(ball(Form::Ball, 0.05, Paint::MarkerBall));
            scene.solids.push(ball(Form::SmallBall, 0.009, Paint::Marker));
            scene.labels.push(Label { at: at + Vector::z() * 0.07, text: name, paint: Paint::Marker });
        }
        scene
    }

    /// What a snapshot shows, `time` s after the beginning.
    pub fn scene_of(&self, time: f64, snapshot: &Snapshot<'_>, fatigue: Option<&Compartments>) -> Scene {
        let placed = &snapshot.workspace.kinematics;
        let [mut solids, mut skin] = [Vec::new(), Vec::new()];
        for shape in &self.anatomy.shapes {
            let (list, paint) = if shape.own { (&mut skin, Paint::Skin) } else { (&mut solids, Paint::Scenery) };
            list.extend(place(shape, placed, paint));
        }
        let mut labels = Vec::new();
        self.bones(placed, &mut solids);
        self.forces(snapshot, &mut solids, &mut labels);
        let tubes = (0..self.anatomy.muscles.len()).flat_map(|muscle| self.tubes(snapshot, muscle, fatigue)).collect();
        Scene {
            time,
            centre: single(&placed.body_position[self.anatomy.root]),
            ground: self.anatomy.ground,
            meshes: self.meshes.clone(),
            solids,
            shells: [skin, Vec::new()],
            tubes,
            labels,
            colouring: self.colouring,
            muscles: !self.anatomy.muscles.is_empty(),
        }
    }

    fn bones(&self, placed: &Kinematics<f64>, solids: &mut Vec<Placed>) {
        for (index, part) in self.anatomy.bodies.iter().enumerate().filter(|(_, part)| part.bone) {
            let [from, to] = [part.parent, index].map(|body| single(&placed.body_position[body]));
            let length = (to - from).norm();
            if length >= SMALLEST_BONE {
                let thickness = (0.055 * length).clamp(0.0028, 0.017);
                solids.push(along(Form::Bone, from, (to - from) / length, thickness, length, Paint::Bone));
            }
        }
    }

    /// Contact forces: the resultant of each pair of bodies at its centre of pressure.
    fn forces(&self, snapshot: &Snapshot<'_>, solids: &mut Vec<Placed>, labels: &mut Vec<Label>) {
        let mut pairs: BTreeMap<[usize; 2], (Vector3<f64>, Vector3<f64>, f64)> = BTreeMap::new();
        for contact in snapshot.external_contacts() {
            let entry = pairs.entry([contact.shape, contact.other].map(|geom| snapshot.model.geoms.body[geom])).or_default();
            let size = contact.force.norm();
            entry.0 += contact.force;
            entry.1 += contact.position * size;
            entry.2 += size;
        }
        for (force, moment, weight) in pairs.into_values() {
            let size = force.norm();
            if !(size > SMALLEST_FORCE * self.anatomy.weight && size > 0.0) {
                continue;
            }
            let (from, direction) = (single(&(moment / weight)), single(&(force / size)));
            let length = (size / self.anatomy.weight) as f32 * ARROW;
            solids.push(along(Form::Arrow, from, direction, 0.018, length, Paint::Arrow));
            labels.push(Label { at: from + direction * length, text: format!("{} N", fixed(size, 0)), paint: Paint::Arrow });
        }
    }

    fn tubes(&self, snapshot: &Snapshot<'_>, index: usize, fatigue: Option<&Compartments>) -> Vec<Tube> {
        let muscle = &self.anatomy.muscles[index];
        let actuation = &snapshot.workspace.actuation;
        // Tension is positive here, and negative in the physics.
        let force = if muscle.force > 0.0 { -actuation.force[index] / muscle.force } else { 0.0 };
        let fatigued = fatigue.map_or(0.0, |compartments| compartments.of(index)[2]);
        let capacity = muscle.strength * (1.0 - fatigued);
        let of = |values: &[f64]| values.get(index).copied().unwrap_or(0.0);
        let share = match self.colouring {
            Colouring::Activation => of(&snapshot.state.activation),
            Colouring::Excitation => of(&snapshot.state.control),
            Colouring::Force => force,
            Colouring::Fibre if muscle.optimal > 0.0 => actuation.fibre_length(index) / muscle.optimal - 0.5,
            Colouring::Fibre => 0.5,
            Colouring::Capacity => capacity,
        };
        let lost = if self.colouring == Colouring::Capacity { 0.0 } else { 1.0 - capacity };
        let branches = muscles::branches(snapshot, index);
        let belly = Belly::of(muscle, actuation.length[index], branches.len(), force);
        let colour = palette::muscle(share, lost);
        branches.into_iter().map(|line| Tube { line, belly, colour }).collect()
    }
}

impl Scene {
    /// Draws the scene.
    ///
    /// # Errors
    /// A size that a picture cannot have.
    pub fn render(&self, options: &Options) -> Result<Picture, PictureError> {
        let mut picture = Picture::new(options.width, options.height)?;
        let camera = super::camera::Camera::new(options.view, self.centre, [options.width as f32, options.height as f32]);
        let colours = options.theme.colours();
        shade::draw(self, &camera, colours, &geometry::Layers::of(self, colours), &mut picture);
        if options.labels {
            label::annotate(self, &camera, colours, &mut picture);
        }
        Ok(picture)
    }
}

/// A shape where the bodies are; `None` for what has no form.
fn place(shape: &Shape, placed: &Kinematics<f64>, paint: Paint) -> Option<Placed> {
    let [x, y, z] = shape.size;
    // Fingers and toes are many and need few triangles.
    let ball = if x.max(y).max(z) < SMALL { Form::SmallBall } else { Form::Ball };
    let (form, size, half) = match (shape.kind, shape.mesh) {
        ("sphere", _) => (ball, [x, x, x], 0.0),
        ("capsule", _) => (ball, [x, x, x], y),
        ("ellipsoid", _) => (ball, [x, y, z], 0.0),
        ("cylinder", _) => (Form::Cylinder, [x, x, y], 0.0),
        ("box", _) => (Form::Box, [x, y, z], 0.0),
        (_, mesh) => (Form::Mesh(mesh?), [1.0; 3], 0.0),
    };
    let turn = placed.body_rotation[shape.body];
    Some(Placed {
        form,
        place: single(&(placed.body_position[shape.body] + turn * Vector3::from(shape.position))),
        turn: (turn * rotation::matrix(&shape.orientation)).map(|part| part as f32),
        size: single(&Vector3::from(size)),
        half: half as f32,
        paint,
    })
}

/// A shape from z = 0 to 1, along a direction.
fn along(form: Form, from: Vector, direction: Vector, thickness: f32, length: f32, paint: Paint) -> Placed {
    let other = if direction.x.abs() < 0.8 { Vector::x() } else { Vector::y() };
    let x = direction.cross(&other).normalize();
    let turn = Matrix3::from_columns(&[x, direction.cross(&x), direction]);
    Placed { form, place: from, turn, size: Vector::new(thickness, thickness, length), half: 0.0, paint }
}
