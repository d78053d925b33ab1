//! Shapes placed in the world.

use crate::{
    kinematics::Kinematics,
    model::{GeomKind, HeightField, Mesh, Model},
    overrides::ShapeOverride,
    scalar::Real,
    spatial::{lane_of, matrix_of},
};
use nalgebra::{Matrix3, Vector3};

/// What gives a shape its form beyond its size.
#[derive(Debug, Clone, Copy)]
pub enum Asset<'a> {
    /// Nothing: a primitive.
    None,
    /// A mesh.
    Mesh(&'a Mesh),
    /// A height field.
    HeightField(&'a HeightField),
}

/// A shape in the world, of one episode or of all lanes.
#[derive(Debug, Clone, Copy)]
pub struct Placed<'a, T: Real = f64> {
    /// Kind.
    pub kind: GeomKind,
    /// Centre, m.
    pub position: Vector3<T>,
    /// Rotation from the shape's axes to the world's.
    pub rotation: Matrix3<T>,
    /// Size as defined by its kind, m.
    pub size: Vector3<T>,
    /// Form of meshes and height fields.
    pub asset: Asset<'a>,
}

impl<'a> Placed<'a> {
    /// Geom `geom` of `model` at a place, or the shape that an episode has of its own.
    fn new(
        model: &'a Model,
        own: Option<&'a ShapeOverride>,
        geom: usize,
        position: Vector3<f64>,
        rotation: Matrix3<f64>,
    ) -> Self {
        let (kind, asset) = (model.geoms.kind[geom], model.geoms.asset[geom]);
        if let Some(own) = own {
            let asset = own.heights.as_ref().map_or(Asset::None, Asset::HeightField);
            return Self { kind, position, rotation, size: own.size, asset };
        }
        let asset = match (kind, asset) {
            (GeomKind::Mesh, Some(asset)) => Asset::Mesh(&model.meshes[asset]),
            (GeomKind::HeightField, Some(asset)) => Asset::HeightField(&model.height_fields[asset]),
            _ => Asset::None,
        };
        Self { kind, position, rotation, size: model.geoms.size[geom], asset }
    }

    /// Geom `geom` where the kinematics of the episode in `lane` put it.
    pub fn of<T: Real>(model: &'a Model, kinematics: &'a Kinematics<T>, lane: usize, geom: usize) -> Self {
        let position = lane_of(&kinematics.geom_position[geom], lane);
        let rotation = matrix_of(&kinematics.geom_rotation[geom], lane);
        Self::new(model, kinematics.overrides.shape(lane, geom), geom, position, rotation)
    }

    /// A point or direction-from-the-centre of the world in the shape's axes.
    pub(super) fn local(&self, point: Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&(point - self.position))
    }
}

impl<'a, T: Real> Placed<'a, T> {
    /// Geom `geom`, a primitive, where the kinematics of all lanes put it.
    #[inline(always)]
    pub(super) fn of_all(model: &Model, kinematics: &Kinematics<T>, geom: usize) -> Self {
        let size = kinematics.overrides.size(model, geom);
        let (position, rotation) = (kinematics.geom_position[geom], kinematics.geom_rotation[geom]);
        Self { kind: model.geoms.kind[geom], position, rotation, size, asset: Asset::None }
    }

    /// As it is in one lane.
    pub(super) fn in_lane(&self, lane: usize) -> Placed<'a> {
        let Self { kind, position, rotation, size, asset } = self;
        let (position, size) = (lane_of(position, lane), lane_of(size, lane));
        Placed { kind: *kind, position, rotation: matrix_of(rotation, lane), size, asset: *asset }
    }

    /// The z axis: a plane's normal, a capsule's axis.
    #[inline(always)]
    pub(super) fn axis(&self) -> Vector3<T> {
        Vector3::new(self.rotation.m13, self.rotation.m23, self.rotation.m33)
    }
}
