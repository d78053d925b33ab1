//! One geom or site: its frame, size and contact parameters.

use super::settings::softness;
use super::tree::Frame;
use super::{Compiler, names::Kind};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{GeomKind, rotation};
use nalgebra::Vector3;

/// The words for the kinds that the model holds.
pub(in crate::model::mjcf) const GEOM_KINDS: [(&str, GeomKind); 8] = [
    ("plane", GeomKind::Plane),
    ("hfield", GeomKind::HeightField),
    ("sphere", GeomKind::Sphere),
    ("capsule", GeomKind::Capsule),
    ("ellipsoid", GeomKind::Ellipsoid),
    ("cylinder", GeomKind::Cylinder),
    ("box", GeomKind::Box),
    ("mesh", GeomKind::Mesh),
];

impl Compiler<'_> {
    /// Reads a geom with its class attributes already filled in. `frame` is the enclosing frame in the body.
    pub(super) fn read_geom(&mut self, element: &Element, body: usize, frame: &Frame) -> Result<(), ModelError> {
        let words = GEOM_KINDS.map(|(word, _)| word);
        let kind = element.keyword("type", &words)?.map_or(GeomKind::Sphere, |index| GEOM_KINDS[index].1);
        let (size, local, asset) = match kind {
            GeomKind::Mesh => {
                let (index, own) = self.shown_mesh(element)?;
                let reach =
                    self.model.meshes[index].vertices.iter().fold(Vector3::zeros(), |most, vertex| most.sup(&vertex.abs()));
                (reach, self.frame(element)?.then(&own), Some(index))
            }
            GeomKind::HeightField => {
                let index = self.height_field(element)?;
                (self.model.height_fields[index].size(), self.frame(element)?, Some(index))
            }
            _ => {
                let (size, local) = self.size_and_frame(element, kind)?;
                (size, local, None)
            }
        };
        let radius = match (kind, asset) {
            (GeomKind::Mesh, Some(index)) => self.model.meshes[index].hull.radius(),
            (GeomKind::HeightField, Some(index)) => self.model.height_fields[index].bounding_radius(),
            _ => kind.bounding_radius(size),
        };
        let placed = frame.then(&local);
        let visible = match element.text("material") {
            Some(material) => !self.transparent_materials.contains(material),
            None => opaque(element)?,
        };
        let geoms = &mut self.model.geoms;
        let name = self.names.register(Kind::Geom, element, geoms.name.len())?;
        let bits = |attribute| element.integer_or(attribute, 1, 0, i64::from(u32::MAX));
        geoms.contact_type.push(bits("contype")? as u32);
        geoms.contact_affinity.push(bits("conaffinity")? as u32);
        geoms.contact_dimension.push(contact_dimension(element)?);
        geoms.priority.push(element.integer_or("priority", 0, i64::from(i32::MIN), i64::from(i32::MAX))? as i32);
        geoms.group.push(element.integer_or("group", 0, i64::from(i32::MIN), i64::from(i32::MAX))? as i32);
        geoms.visible.push(visible);
        geoms.softness_mix.push(element.number_or("solmix", 1.0)?);
        geoms.softness.push(softness(element, "solref", "solimp")?);
        geoms.friction.push(element.numbers_over("friction", [1.0, 0.005, 0.0001])?);
        geoms.margin.push(element.number_or("margin", 0.0)?);
        geoms.gap.push(element.number_or("gap", 0.0)?);
        geoms.bounding_radius.push(radius);
        geoms.name.push(name);
        geoms.kind.push(kind);
        geoms.body.push(body);
        geoms.size.push(size);
        geoms.asset.push(asset);
        geoms.position.push(placed.position);
        geoms.orientation.push(placed.orientation);
        Ok(())
    }

    /// The size of a geom and its frame in what encloses it, from `pos` and an orientation or from `fromto`.
    fn size_and_frame(&self, element: &Element, kind: GeomKind) -> Result<(Vector3<f64>, Frame), ModelError> {
        let mut size = Vector3::from(element.numbers_over("size", [0.0; 3])?);
        let mut frame = self.frame(element)?;
        if let Some((span, half)) = span(element)? {
            frame = span;
            match kind {
                GeomKind::Capsule | GeomKind::Cylinder => size.y = half,
                GeomKind::Ellipsoid | GeomKind::Box => (size.y, size.z) = (size.x, half),
                GeomKind::Plane | GeomKind::HeightField | GeomKind::Sphere | GeomKind::Mesh => {
                    return Err(element.invalid("`fromto` needs a capsule, cylinder, ellipsoid or box"));
                }
            }
        }
        let needed = kind.size_count();
        if size.iter().take(needed).any(|extent| *extent <= 0.0) {
            return Err(element.invalid(format!("a geom of this kind needs {needed} positive sizes, found {}", spaced(&size))));
        }
        Ok((size, frame))
    }

    /// Reads a site with its class attributes already filled in.
    pub(super) fn read_site(&mut self, element: &Element, body: usize, frame: &Frame) -> Result<(), ModelError> {
        let local = match span(element)? {
            Some((frame, _)) => frame,
            None => self.frame(element)?,
        };
        let placed = frame.then(&local);
        self.zones.push(zone(element)?);
        let sites = &mut self.model.sites;
        let name = self.names.register(Kind::Site, element, sites.name.len())?;
        sites.name.push(name);
        sites.body.push(body);
        sites.position.push(placed.position);
        sites.orientation.push(placed.orientation);
        Ok(())
    }

    /// The frame of an element in what encloses it.
    pub(super) fn frame(&self, element: &Element) -> Result<Frame, ModelError> {
        Ok(Frame { position: element.vector_or("pos", Vector3::zeros())?, orientation: self.settings.orientation(element)? })
    }
}

/// Size of a site's volume where the file gives none, m.
const SITE_SIZE: [f64; 3] = [0.005; 3];

/// The shape and size of a site's volume.
fn zone(element: &Element) -> Result<(GeomKind, Vector3<f64>), ModelError> {
    let words = ["sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh"];
    let shape = match element.keyword("type", &words)?.unwrap_or(0) {
        0 => GeomKind::Sphere,
        1 => GeomKind::Capsule,
        2 => GeomKind::Ellipsoid,
        3 => GeomKind::Cylinder,
        4 => GeomKind::Box,
        _ => GeomKind::Mesh,
    };
    let mut size = element.numbers_over("size", SITE_SIZE)?;
    if let Some((_, half)) = span(element)? {
        let length = if matches!(shape, GeomKind::Capsule | GeomKind::Cylinder) { 1 } else { 2 };
        size[length] = half;
    }
    Ok((shape, Vector3::from(size)))
}

/// The frame in the middle of `fromto`, its z axis pointing at the first point, and half the distance.
fn span(element: &Element) -> Result<Option<(Frame, f64)>, ModelError> {
    let Some([x, y, z, u, v, w]) = element.numbers::<6>("fromto")? else { return Ok(None) };
    let (from, to) = (Vector3::new(x, y, z), Vector3::new(u, v, w));
    let orientation = rotation::from_z_axis(from - to);
    let orientation = orientation.ok_or_else(|| element.invalid("`fromto` gives the same point twice"))?;
    Ok(Some((Frame { position: 0.5 * (from + to), orientation }, 0.5 * (from - to).norm())))
}

/// The contact dimension: 1, 3, 4 or 6.
pub(super) fn contact_dimension(element: &Element) -> Result<u8, ModelError> {
    let dimension = element.integer_or("condim", 3, 1, 6)?;
    match u8::try_from(dimension) {
        Ok(dimension @ (1 | 3 | 4 | 6)) => Ok(dimension),
        _ => Err(element.invalid(format!("`condim` must be 1, 3, 4 or 6, found {dimension}"))),
    }
}

fn spaced(size: &Vector3<f64>) -> String {
    format!("{} {} {}", size.x, size.y, size.z)
}

/// Whether the colour of a geom or material is not wholly transparent.
pub(super) fn opaque(element: &Element) -> Result<bool, ModelError> {
    Ok(element.numbers_over("rgba", [1.0; 4])?[3] != 0.0)
}
