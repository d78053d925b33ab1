//! Mass properties of bodies: explicit, or inferred from the geoms; then bounded and balanced as the file asks.

use super::Compiler;
use super::settings::InertiaFromGeoms;
use super::tree::Frame;
use crate::model::inertia::{MassProperties, combine, moments, principal, volume};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// Density of a geom that gives neither mass nor density: water's.
const WATER: f64 = 1000.0;

/// What a body's inertia can be inferred from.
#[derive(Debug, Default)]
pub(super) struct Parts {
    solids: Vec<Part>,
}

#[derive(Debug)]
enum Part {
    SupportShape(MassProperties),
    Mesh { geom: Element, frame: Frame },
}

impl Compiler<'_> {
    /// Notes the mass properties of the geom that was just added.
    pub(super) fn add_solid(&mut self, geom: &Element, parts: &mut Parts) -> Result<(), ModelError> {
        let geoms = &self.model.geoms;
        let index = geoms.name.len() - 1;
        let (kind, size) = (geoms.kind[index], geoms.size[index]);
        if geom.text("mesh").is_some() {
            return Err(geom.invalid("fitting a primitive to a mesh is not supported"));
        }
        if !self.counts(i64::from(geoms.group[index])) {
            return Ok(());
        }
        let mass = match geom.text("mass") {
            Some(_) => geom.size_or("mass", 0.0)?,
            None => geom.size_or("density", WATER)? * volume(kind, size),
        };
        if mass > 0.0 && volume(kind, size) > 0.0 {
            let (centre, axes) = (geoms.position[index], geoms.orientation[index]);
            parts.solids.push(Part::SupportShape(MassProperties { mass, centre, axes, moments: moments(kind, size, mass) }));
        }
        Ok(())
    }

    /// Reads a mesh geom. One that cannot collide and that nothing names or sees only carries mass, and its file is read only if the
    /// mass is needed.
    pub(super) fn read_mesh_geom(
        &mut self,
        geom: &Element,
        body: usize,
        frame: &Frame,
        parts: &mut Parts,
    ) -> Result<(), ModelError> {
        let bits = |attribute| geom.integer_or(attribute, 1, 0, i64::from(u32::MAX));
        let named = geom.text("name").is_some_and(|name| self.named_geoms.contains(name));
        if named || self.sensors_see_shapes || bits("contype")? != 0 || bits("conaffinity")? != 0 {
            self.read_geom(geom, body, frame)?;
        }
        if self.counts(geom.integer_or("group", 0, i64::from(i32::MIN), i64::from(i32::MAX))?) {
            let frame = frame.then(&self.frame(geom)?);
            parts.solids.push(Part::Mesh { geom: geom.clone(), frame });
        }
        Ok(())
    }

    /// Whether geoms of a group take part in inferring inertia.
    fn counts(&self, group: i64) -> bool {
        let [first, last] = self.settings.inertia_groups;
        (first..=last).contains(&group)
    }

    /// Sets the body's mass properties.
    pub(super) fn read_inertia(&mut self, body: &Element, index: usize, parts: Parts) -> Result<(), ModelError> {
        let inertial = body.children.iter().find(|child| child.tag == "inertial");
        let from_geoms = self.settings.inertia_from_geoms;
        let found = match inertial {
            Some(element) if from_geoms != InertiaFromGeoms::Always => Some(self.explicit(element)?),
            None if from_geoms == InertiaFromGeoms::Never => {
                return Err(body.invalid("the body has no `inertial`, and `inertiafromgeom` is off"));
            }
            _ => self.inferred(parts)?,
        };
        // Where nothing gives a body mass, MuJoCo takes the numbers of the body's own pose for its inertial frame; a lower
        // bound on the mass then acts there.
        let bodies = &self.model.bodies;
        let (centre, axes) = (bodies.position[index], bodies.orientation[index]);
        let empty = MassProperties { mass: 0.0, centre, axes, moments: Vector3::zeros() };
        let mut properties = found.unwrap_or(empty);
        self.bound(body, &mut properties)?;
        let bodies = &mut self.model.bodies;
        bodies.mass[index] = properties.mass;
        bodies.inertia[index] = properties.moments;
        bodies.inertial_position[index] = properties.centre;
        bodies.inertial_orientation[index] = properties.axes;
        Ok(())
    }

    /// The `inertial` element.
    fn explicit(&self, element: &Element) -> Result<MassProperties, ModelError> {
        element.required("pos")?;
        element.required("mass")?;
        let frame = self.frame(element)?;
        let mass = element.size_or("mass", 0.0)?;
        let full = element.numbers::<6>("fullinertia")?;
        let diagonal = element.numbers::<3>("diaginertia")?;
        let (moments, axes) = match (diagonal, full) {
            (Some(diagonal), None) => (Vector3::from(diagonal), frame.orientation),
            (None, Some([xx, yy, zz, xy, xz, yz])) => {
                if ["quat", "axisangle", "xyaxes", "zaxis", "euler"].iter().any(|form| element.text(form).is_some()) {
                    return Err(element.invalid("`fullinertia` and an orientation exclude each other"));
                }
                principal(&Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
            }
            // A body that cannot move needs no inertia; one that can is refused later.
            (None, None) => (Vector3::zeros(), frame.orientation),
            (Some(_), Some(_)) => return Err(element.invalid("`inertial` takes either `diaginertia` or `fullinertia`, not both")),
        };
        let positive = full.is_none() || self.settings.least_inertia > 0.0 || moments.iter().all(|moment| *moment > 0.0);
        if moments.iter().any(|moment| *moment < 0.0) && diagonal.is_some() || !positive {
            return Err(element.invalid("the inertia is not positive"));
        }
        Ok(MassProperties { mass, centre: frame.position, axes, moments })
    }

    /// The sum of the body's solids and meshes.
    fn inferred(&mut self, parts: Parts) -> Result<Option<MassProperties>, ModelError> {
        let mut all = Vec::new();
        for part in parts.solids {
            match part {
                Part::SupportShape(properties) => all.push(properties),
                Part::Mesh { geom, frame } => all.extend(self.mesh_properties(&geom, &frame)?),
            }
        }
        Ok(combine(&all))
    }

    /// Mass properties of a mesh geom in its body's frame; `None` if it has no mass.
    fn mesh_properties(&mut self, geom: &Element, frame: &Frame) -> Result<Option<MassProperties>, ModelError> {
        let mesh = self.mesh(geom)?.solid;
        let mass = match geom.text("mass") {
            Some(_) => geom.size_or("mass", 0.0)?,
            None => geom.size_or("density", WATER)? * mesh.volume,
        };
        if mass <= 0.0 {
            return Ok(None);
        }
        let placed = frame.then(&Frame { position: mesh.centre, orientation: mesh.axes });
        let moments = mesh.moments * (mass / mesh.volume);
        Ok(Some(MassProperties { mass, centre: placed.position, axes: placed.orientation, moments }))
    }

    /// Scales all masses and inertias to the total that the file asks for (`settotalmass`).
    pub(super) fn scale_masses(&mut self) {
        let bodies = &mut self.model.bodies;
        let found: f64 = bodies.mass.iter().sum();
        if let Some(wanted) = self.settings.total_mass.filter(|_| found > 0.0) {
            let factor = wanted / found;
            bodies.mass.iter_mut().for_each(|mass| *mass *= factor);
            bodies.inertia.iter_mut().for_each(|moments| *moments *= factor);
        }
    }

    /// Applies the file's lower bounds, and the triangle inequality that moments of inertia obey.
    fn bound(&self, body: &Element, properties: &mut MassProperties) -> Result<(), ModelError> {
        let settings = &self.settings;
        properties.mass = properties.mass.at_least(settings.least_mass);
        properties.moments = properties.moments.map(|moment| moment.at_least(settings.least_inertia));
        let [a, b, c] = [properties.moments.x, properties.moments.y, properties.moments.z];
        if a + b < c || a + c < b || b + c < a {
            if !settings.balance_inertia {
                return Err(body.invalid(format!(
                    "the moments of inertia {a}, {b}, {c} are impossible: each must not exceed the sum of the others \
                     (`balanceinertia` would average them)"
                )));
            }
            properties.moments = Vector3::repeat((a + b + c) / 3.0);
        }
        Ok(())
    }
}
