//! Shapes that an episode has of its own, instead of those of the model: other sizes, other heights, and the inertia that follows.

use super::{batch::OneLane, model::GeomKind, model::HeightField, model::Model, scalar::Real, spatial::constant};
use nalgebra::Vector3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::sync::Arc;

/// The shapes in which an episode differs from its model.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ShapeOverrides {
    /// At most one for each geom.
    pub shapes: Vec<ShapeOverride>,
    /// Principal moments of inertia of bodies, kg m², for the mass of the model; `mass_scale` of the state scales them.
    pub moments: Vec<(usize, Vector3<f64>)>,
}

/// The shape of a geom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeOverride {
    /// Which geom. Its body can move, or is placed from outside: those that stand still are sorted once.
    pub geom: usize,
    /// Size as defined by its kind, m; without meaning for height fields.
    pub size: Vector3<f64>,
    /// Position in the frame of its body, m.
    pub position: Vector3<f64>,
    /// Its heights, if it is a height field.
    pub heights: Option<HeightField>,
}

impl ShapeOverride {
    /// Radius of a sphere about the centre that holds the shape, m; 0 for a plane.
    pub fn bounding_radius(&self, kind: GeomKind) -> f64 {
        self.heights.as_ref().map_or_else(|| kind.bounding_radius(self.size), HeightField::bounding_radius)
    }

    /// Whether it is a shape of that kind, of finite size.
    fn is_of(&self, kind: GeomKind) -> bool {
        let heights = self.heights.as_ref().is_none_or(HeightField::is_valid);
        let finite = self.size.iter().chain(&self.position).all(|value| value.is_finite());
        heights && finite && kind != GeomKind::Mesh && self.heights.is_some() == (kind == GeomKind::HeightField)
    }
}

impl ShapeOverrides {
    fn shape(&self, geom: usize) -> Option<&ShapeOverride> {
        self.shapes.iter().find(|shape| shape.geom == geom)
    }

    /// By how much the bounding spheres of two geoms are larger than in the model, m.
    pub(crate) fn growth(&self, model: &Model, geoms: [usize; 2]) -> f64 {
        let own = geoms.into_iter().filter_map(|geom| self.shape(geom));
        own.map(|own| own.bounding_radius(model.geoms.kind[own.geom]) - model.geoms.bounding_radius[own.geom]).sum()
    }

    fn fits(&self, model: &Model) -> bool {
        let shape = |shape: &ShapeOverride| {
            let kind = model.geoms.kind.get(shape.geom);
            kind.is_some_and(|kind| shape.is_of(*kind) && model.bodies.weld[model.geoms.body[shape.geom]] != 0)
        };
        let moment = |(body, moments): &(usize, Vector3<f64>)| {
            *body < model.bodies.mass.len() && moments.iter().all(|moment| moment.is_finite() && *moment > 0.0)
        };
        self.shapes.iter().all(shape) && self.moments.iter().all(moment)
    }
}

/// The overrides of each lane; without any in most models. They are shared by all copies of a state, and never change.
#[derive(Debug, Clone, Default)]
pub struct Overrides(Vec<Option<Arc<ShapeOverrides>>>);

impl Overrides {
    /// None in so many lanes.
    pub(crate) fn none(lanes: usize) -> Self {
        Self(vec![None; lanes])
    }

    /// Those of a state of one episode.
    pub fn of(overrides: ShapeOverrides) -> Self {
        Self(vec![Some(Arc::new(overrides))])
    }

    /// Whether every lane has the shapes of the model.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }

    /// Those of a lane.
    pub fn lane(&self, lane: usize) -> Option<&ShapeOverrides> {
        self.0.get(lane)?.as_deref()
    }

    /// The shape that a geom has in a lane, if it is not that of the model.
    #[inline]
    pub fn shape(&self, lane: usize, geom: usize) -> Option<&ShapeOverride> {
        self.lane(lane)?.shape(geom)
    }

    /// The same of another state.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.0.clone_from(&other.0);
    }

    /// Whether they are of so many episodes of `model`.
    pub(crate) fn fits(&self, model: &Model, lanes: usize) -> bool {
        self.0.len() == lanes && self.0.iter().flatten().all(|own| own.fits(model))
    }

    /// Radius of a sphere about the centre of a geom that holds it in a lane, m.
    #[inline]
    pub fn bounding_radius(&self, model: &Model, lane: usize, geom: usize) -> f64 {
        let own = self.shape(lane, geom);
        own.map_or(model.geoms.bounding_radius[geom], |own| own.bounding_radius(model.geoms.kind[geom]))
    }

    /// Size of a geom as defined by its kind, m; without meaning for height fields.
    #[inline(always)]
    pub(crate) fn size<T: Real>(&self, model: &Model, geom: usize) -> Vector3<T> {
        let mut size: Vector3<T> = constant(&model.geoms.size[geom]);
        for (lane, own) in self.0.iter().enumerate() {
            let Some(own) = own.as_deref().and_then(|own| own.shape(geom)) else { continue };
            size.iter_mut().zip(own.size.iter()).for_each(|(size, own)| size.set_lane(lane, *own));
        }
        size
    }

    /// Principal moments of inertia of a body, kg m², but for `mass_scale`.
    #[inline(always)]
    pub(crate) fn moments<T: Real>(&self, model: &Model, body: usize) -> Vector3<T> {
        let mut moments: Vector3<T> = constant(&model.bodies.inertia[body]);
        for (lane, own) in self.0.iter().enumerate() {
            let Some(own) = own else { continue };
            if let Some((_, own)) = own.moments.iter().find(|(known, _)| *known == body) {
                moments.iter_mut().zip(own.iter()).for_each(|(moment, own)| moment.set_lane(lane, *own));
            }
        }
        moments
    }
}

impl PartialEq for Overrides {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&Option<Arc<ShapeOverrides>>, &Option<Arc<ShapeOverrides>>)| match (a, b) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
            (None, None) => true,
            _ => false,
        };
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(same)
    }
}

impl OneLane<Self> for Overrides {
    fn read_lane(&mut self, all: &Self, lane: usize) {
        self.0[0].clone_from(&all.0[lane]);
    }
    fn write_lane(&self, all: &mut Self, lane: usize) {
        all.0[lane].clone_from(&self.0[0]);
    }
}

impl Serialize for Overrides {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.iter().map(Option::as_deref).collect::<Vec<_>>().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Overrides {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let lanes = Vec::<Option<ShapeOverrides>>::deserialize(deserializer)?;
        Ok(Self(lanes.into_iter().map(|own| own.map(Arc::new)).collect()))
    }
}
