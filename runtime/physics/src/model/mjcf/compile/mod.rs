//! From resolved elements to the arrays of a [`Model`].
//!
//! 1. [`settings`]: the `compiler` and `option` elements;
//! 2. [`meshes`] are read where they collide or a body's inertia depends on them;
//! 3. [`tree`]: bodies in depth-first order with their frames, joints, shapes and sites; [`shapes`] reads one geom or site;
//! 4. [`inertias`]: explicit or inferred mass properties, bounded and balanced;
//! 5. [`contacts`], [`tendons`], [`equalities`], [`actuators`], [`sensors`]: what refers to the tree by name;
//! 6. the model's `topology`: roots and welds, degrees of freedom, the rows of the mass matrix, subtree masses;
//! 7. [`keyframes`]: states of the whole model;
//! 8. the physics' own constants at the reference configuration (inverse weights, reference lengths).

mod actuators;
mod align;
mod contacts;
mod equalities;
mod inertias;
mod keyframes;
mod length_range;
mod meshes;
mod names;
mod sensors;
mod settings;
mod shapes;
mod tendons;
mod tree;

use super::defaults::Defaults;
use super::document::{Document, Element};
use super::error::{ModelError, Unsupported};
use super::{replicate, schema};
use crate::{
    constants,
    model::{GeomKind, Model, topology},
};
use nalgebra::Vector3;
use names::Names;
pub(super) use settings::Settings;
pub(super) use shapes::GEOM_KINDS;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Everything that the parts of the compiler share.
struct Compiler<'a> {
    document: &'a Document<'a>,
    settings: Settings,
    defaults: Defaults,
    names: Names,
    /// Meshes read so far.
    meshes: BTreeMap<String, Rc<meshes::Asset>>,
    /// Features found missing while reading; reported together.
    unsupported: Vec<Unsupported>,
    /// Joints whose spring and damper follow from a time constant (s) and a damping ratio.
    springs: Vec<(usize, [f64; 2])>,
    /// Geoms that contact pairs and sensors name.
    named_geoms: BTreeSet<&'a str>,
    /// Materials that nobody sees.
    transparent_materials: BTreeSet<String>,
    /// Whether sensors see shapes that do not collide and that nothing names.
    sensors_see_shapes: bool,
    /// Volumes of all sites.
    zones: Vec<(GeomKind, Vector3<f64>)>,
    model: Model,
}

/// Compiles a document.
pub(super) fn compile(mut document: Document<'_>) -> Result<Model, ModelError> {
    schema::check(&document.root)?;
    let settings = settings::compiler_settings(&document.root)?;
    replicate::expand(&mut document.root, &settings)?;
    let document = &document;
    let root = &document.root;
    let mut compiler = Compiler {
        document,
        settings,
        defaults: Defaults::collect(root)?,
        names: Names::default(),
        meshes: BTreeMap::new(),
        unsupported: Vec::new(),
        springs: Vec::new(),
        named_geoms: named_geoms(root),
        transparent_materials: BTreeSet::new(),
        sensors_see_shapes: section(root, "sensor").any(sees_shapes),
        zones: Vec::new(),
        model: Model { name: root.text("model").unwrap_or("MuJoCo Model").to_owned(), ..Model::default() },
    };
    compiler.model.options = settings::options(root)?;
    compiler.read_materials()?;
    compiler.read_tree()?;
    compiler.read_contacts()?;
    compiler.read_tendons()?;
    compiler.read_equalities()?;
    compiler.read_actuators()?;
    compiler.read_sensors()?;
    if !compiler.unsupported.is_empty() {
        return Err(ModelError::Unsupported(compiler.unsupported));
    }
    compiler.scale_masses();
    topology::complete(&mut compiler.model).map_err(|message| root.invalid(message))?;
    compiler.read_keyframes()?;
    constants::resolve_spring_damper(&mut compiler.model, &compiler.springs);
    constants::derive(&mut compiler.model).map_err(|message| root.invalid(message))?;
    let actuators: Vec<&Element> = section(root, "actuator").collect();
    compiler.settings.length_ranges.complete(&mut compiler.model, &actuators)?;
    Ok(compiler.model)
}

impl Compiler<'_> {
    /// Reads what matters of materials.
    fn read_materials(&mut self) -> Result<(), ModelError> {
        for element in section(&self.document.root, "asset").filter(|element| element.tag == "material") {
            let material = self.defaults.resolve(element, None)?;
            let opaque = shapes::opaque(&material)?;
            self.transparent_materials.extend(material.text("name").filter(|_| !opaque).map(str::to_owned));
        }
        Ok(())
    }
}

/// Whether a sensor reads surfaces by more than their names.
fn sees_shapes(element: &Element) -> bool {
    element.tag == "rangefinder" || ["distance", "normal", "fromto"].contains(&element.tag.as_str())
}

/// The children of all sections with a name, in order.
fn section<'a>(root: &'a Element, name: &'static str) -> impl Iterator<Item = &'a Element> {
    root.children.iter().filter(move |child| child.tag == name).flat_map(|section| &section.children)
}

/// Geoms that matter by their names.
fn named_geoms(root: &Element) -> BTreeSet<&str> {
    let elements = section(root, "contact").chain(section(root, "sensor"));
    elements.flat_map(|element| ["geom1", "geom2", "objname", "refname"].map(|name| element.text(name))).flatten().collect()
}
