//! What surrounds a body, resolved: plain data in SI units, from which the runtime builds a model.
//!
//! Every element of a scene becomes an [`Object`]: a rigid body of its own, carried by the world, by another object or by the
//! body that carries a landmark. Tasks name objects like landmarks (`door.up`, `cube.velocity`), and joints of objects like
//! joints (`door.swing.q`): [`Vocabulary::with_scene`] appends both, in the order of the scene, behind those of the body, and
//! the runtime appends them to the bound body in the same order.
//!
//! [`Vocabulary::with_scene`]: crate::vocabulary::Vocabulary::with_scene

use serde::{Deserialize, Serialize};

/// Everything around the body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneDescription {
    /// The level ground z = 0; `None` leaves the body above nothing.
    pub ground: Option<Surface>,
    /// Elements in the order of the text, parents before what they carry.
    pub objects: Vec<Object>,
    /// What is held to what.
    pub connections: Vec<Connection>,
    /// Named sets of objects: (name, indices into `objects`). A group counts as one thing in contacts.
    pub groups: Vec<(String, Vec<usize>)>,
}

impl SceneDescription {
    /// Mass of each object with all that it carries without a joint: of what moves as one, kg.
    #[must_use]
    pub fn masses(&self) -> Vec<f64> {
        let mut masses: Vec<f64> = self.objects.iter().map(|object| object.mass).collect();
        // Parents stand before what they carry.
        for (index, object) in self.objects.iter().enumerate().rev() {
            if let (Parent::Object(parent), Motion::Fixed) = (&object.parent, &object.motion) {
                masses[*parent] += masses[index];
            }
        }
        masses
    }
}

/// How a surface meets others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Sliding, torsional (m) and rolling (m) friction.
    pub friction: [f64; 3],
    /// Whether its friction decides that of a contact alone: that of two surfaces is otherwise the larger one.
    pub decides: bool,
    /// Whether it can be touched at all.
    pub solid: bool,
    /// Whether it counts as ground: for clearance, `ground_height` and `touching(_, ground)`.
    pub walkable: bool,
}

impl Default for Surface {
    fn default() -> Self {
        Self { friction: [1.0, 0.005, 0.0001], decides: false, solid: true, walkable: false }
    }
}

/// What carries an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Parent {
    /// Nothing: it stands in the world.
    World,
    /// Another object, by its place in the list.
    Object(usize),
    /// A landmark of the body: a rigid child of the body part that carries it, not counted into the body's mass. Places and
    /// orientations are in the landmark's anatomical frame (forward, left, up).
    Landmark(String),
}

/// An element of a scene: a rigid body, which moves if it has joints or is free, and stays where its parent is otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// Name in tasks, unique in the scene: `door`, `door.leaf` for a part inside `door`.
    pub name: String,
    /// Documentation.
    pub description: String,
    /// What carries it.
    pub parent: Parent,
    /// Position in the parent's frame, m. For a shape the centre, for terrain its near edge on its middle line.
    pub position: [f64; 3],
    /// Orientation in the parent's frame, w x y z.
    pub orientation: [f64; 4],
    /// How it moves against its parent.
    pub motion: Motion,
    /// Its shape; `None` for a pure frame (a `body` or a `marker`).
    pub shape: Option<Shape>,
    /// Mass, kg. Zero for things that cannot move.
    pub mass: f64,
    /// How it meets others.
    pub surface: Surface,
}

/// How an object moves against its parent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// Not at all, at a place in the world that is drawn for every episode.
    Placed,
    /// As a formula of time has it, from its place in the world: the drive of the task.
    Driven,
    /// Six ways; its place in the scene is where it starts. Only for objects carried by the world.
    Free,
    /// By joints, one after the other.
    Joints(Vec<ObjectJoint>),
}

/// A hinge or slide of an object, or a ball joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectJoint {
    /// Name in tasks: `door.swing`.
    pub name: String,
    /// Turns or slides.
    pub kind: ObjectJointKind,
    /// Unit axis in the object's frame; without meaning for a ball.
    pub axis: [f64; 3],
    /// Anchor in the object's frame, m.
    pub anchor: [f64; 3],
    /// Range, rad or m.
    pub range: Option<[f64; 2]>,
    /// Damping, N m s/rad or N s/m.
    pub damping: f64,
    /// Stiffness, N m/rad or N/m.
    pub stiffness: f64,
    /// Friction loss, N m or N.
    pub friction_loss: f64,
}

/// Kind of an object's joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObjectJointKind {
    /// Coordinate in rad.
    Hinge,
    /// Coordinate in m.
    Slide,
    /// A rotation.
    Ball,
}

/// Shapes. Lengths in m; the long axis of capsules and cylinders is z of the object's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// Full extents.
    Box([f64; 3]),
    /// Radius.
    Sphere(f64),
    /// Radius and length of the cylindrical part.
    Capsule(f64, f64),
    /// Radius and length.
    Cylinder(f64, f64),
    /// Half axes.
    Ellipsoid([f64; 3]),
    /// An infinite plane with its normal along z.
    Plane,
    /// What one can walk on and over.
    Terrain(Terrain),
}

impl Shape {
    /// A number that may differ from episode to episode: what leaves the kind and the count of shapes as they are. A slope's angle is
    /// not among them: its object turns.
    pub fn number(&mut self, index: usize) -> Option<&mut f64> {
        match self {
            Self::Box(numbers) | Self::Ellipsoid(numbers) => numbers.get_mut(index),
            Self::Sphere(radius) => [radius].into_iter().nth(index),
            Self::Capsule(radius, length) | Self::Cylinder(radius, length) => [radius, length].into_iter().nth(index),
            Self::Plane => None,
            Self::Terrain(Terrain::Stairs { rise, run, width, .. }) => [rise, run, width].into_iter().nth(index),
            Self::Terrain(Terrain::Slope { length, width, .. }) => [length, width].into_iter().nth(index),
            Self::Terrain(Terrain::Heights { heights, .. }) => heights.get_mut(index),
        }
    }

    /// The field of a scene that gives this number: `size.x`, `radius`, `height`.
    pub fn number_name(&self, index: usize) -> &'static str {
        let names: &[&str] = match self {
            Self::Box(_) | Self::Ellipsoid(_) => &["size.x", "size.y", "size.z"],
            Self::Sphere(_) => &["radius"],
            Self::Capsule(..) | Self::Cylinder(..) => &["radius", "length"],
            Self::Plane => &[],
            Self::Terrain(Terrain::Stairs { .. }) => &["rise", "run", "width"],
            Self::Terrain(Terrain::Slope { .. }) => &["length", "width"],
            Self::Terrain(Terrain::Heights { .. }) => return "height",
        };
        names.get(index).copied().unwrap_or("?")
    }
}

/// Terrain made of boxes or of a height field. It extends from the object's place along its x axis, centred in y.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Terrain {
    /// A flight of steps that goes up.
    Stairs {
        /// Number of steps.
        count: u32,
        /// Height of one step, m.
        rise: f64,
        /// Depth of one step, m.
        run: f64,
        /// Width, m.
        width: f64,
    },
    /// Heights over a rectangle, from the object's place: sampled by formula or drawn.
    Heights {
        /// Length along x and width along y, m.
        size: [f64; 2],
        /// Samples along x and y, at least 2 each.
        samples: [usize; 2],
        /// Heights, m, x fastest.
        heights: Vec<f64>,
    },
    /// An inclined rectangle that rises along x.
    Slope {
        /// Horizontal length, m.
        length: f64,
        /// Width, m.
        width: f64,
        /// Inclination, rad; negative goes down.
        angle: f64,
    },
}

/// What is held to what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Connection {
    /// A weld holds place and orientation, a connection (a ball joint) only the place.
    pub weld: bool,
    /// First end: the name of a landmark or an object.
    pub from: String,
    /// Second end.
    pub to: String,
    /// Whether the initial offset is kept; otherwise the ends meet.
    pub here: bool,
}

/// A side of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// The level ground and everything walkable.
    Ground,
    /// The segment of a landmark, or an object with all that it carries: index into the vocabulary's landmarks.
    Landmark(usize),
    /// All members of a group of landmarks: index into the vocabulary's groups.
    Group(usize),
    /// All shapes of the body itself.
    Robot,
}
