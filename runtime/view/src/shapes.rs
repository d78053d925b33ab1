//! What of a model is seen: its solid shapes and the surfaces of its assets.

use crate::anatomy::{round, vector};
use crate::track::quantise;
use msk_physics::model::{GeomKind, HeightField, Model};
use msk_physics::overrides::{Overrides, ShapeOverride};
use msk_runtime::body::Body;
use nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Shape {
    pub kind: &'static str,
    pub body: usize,
    pub size: [f64; 3],
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<usize>,
    pub own: bool,
}

/// Triangles.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Surface {
    /// Corners in tenths of a millimetre.
    pub corners: Vec<i32>,
    pub triangles: Vec<usize>,
}

/// The shapes that are shown, and the surfaces to which they refer.
pub(crate) fn of(model: &Model, body: &Body, overrides: &Overrides) -> (Vec<Shape>, Vec<Surface>) {
    let mut meshes = Surfaces::default();
    let shown = (0..model.geoms.kind.len()).filter(|&geom| is_shown(model, body, geom));
    let shapes = shown.filter_map(|geom| shape(model, body, geom, overrides.shape(0, geom), &mut meshes)).collect();
    (shapes, meshes.found)
}

/// Solid shapes and those of objects; what only bends muscles is not shown.
fn is_shown(model: &Model, body: &Body, geom: usize) -> bool {
    let geoms = &model.geoms;
    let solid = geoms.contact_type[geom] != 0 || geoms.contact_affinity[geom] != 0;
    body.shapes.contains(&geom) || solid || body.objects.iter().any(|object| object.body == geoms.body[geom])
}

fn shape(model: &Model, body: &Body, geom: usize, own: Option<&ShapeOverride>, meshes: &mut Surfaces) -> Option<Shape> {
    let geoms = &model.geoms;
    let field = || own.and_then(|own| own.heights.as_ref()).or_else(|| model.height_fields.get(geoms.asset[geom]?));
    let (kind, mesh) = match geoms.kind[geom] {
        // The ground is drawn as such.
        GeomKind::Plane => return None,
        GeomKind::Sphere => ("sphere", None),
        GeomKind::Capsule => ("capsule", None),
        GeomKind::Ellipsoid => ("ellipsoid", None),
        GeomKind::Cylinder => ("cylinder", None),
        GeomKind::Box => ("box", None),
        GeomKind::HeightField => ("mesh", Some(meshes.height_field(field()?, geoms.asset[geom]?))),
        GeomKind::Mesh => ("mesh", Some(meshes.mesh(model, geoms.asset[geom]?))),
    };
    Some(Shape {
        kind,
        body: geoms.body[geom],
        size: vector(&own.map_or(geoms.size[geom], |own| own.size)),
        position: vector(&own.map_or(geoms.position[geom], |own| own.position)),
        orientation: geoms.orientation[geom].map(round),
        mesh,
        own: body.owns(geoms.body[geom]),
    })
}

/// Surfaces of assets, each once.
#[derive(Default)]
struct Surfaces {
    found: Vec<Surface>,
    known: BTreeMap<(bool, usize), usize>,
}

impl Surfaces {
    fn mesh(&mut self, model: &Model, asset: usize) -> usize {
        let mesh = &model.meshes[asset];
        self.keep((true, asset), || (mesh.vertices.clone(), mesh.triangles.concat()))
    }

    fn height_field(&mut self, field: &HeightField, asset: usize) -> usize {
        self.keep((false, asset), || {
            let corners = (0..field.rows).flat_map(|row| (0..field.columns).map(move |column| field.point(row, column)));
            let cells = (1..field.rows).flat_map(|row| (1..field.columns).map(move |column| (row, column)));
            let triangles = cells.flat_map(|(row, column)| {
                let [a, c] = [(row - 1) * field.columns + column - 1, row * field.columns + column];
                [a, a + 1, c, a, c, c - 1]
            });
            (corners.collect(), triangles.collect())
        })
    }

    fn keep(&mut self, key: (bool, usize), make: impl FnOnce() -> (Vec<Vector3<f64>>, Vec<usize>)) -> usize {
        let Self { found, known } = self;
        *known.entry(key).or_insert_with(|| {
            let (corners, triangles) = make();
            let corners = corners.iter().flat_map(vector).map(|part| quantise(part, 1e-4));
            found.push(Surface { corners: corners.collect(), triangles });
            found.len() - 1
        })
    }
}
