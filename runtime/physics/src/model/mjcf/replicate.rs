//! The `replicate` element: copies of a part of the tree, each placed and turned against the one before.
//!
//! 1. Inner replicates come first, so that names carry the suffix of the innermost first;
//! 2. every copy becomes a `frame` with the names inside suffixed by its number;
//! 3. what refers to a copied name (contacts, equalities, tendons, actuators, sensors) is copied along, and stands after
//!    what is not copied, all of the first copy before all of the second.

use super::compile::Settings;
use super::document::Element;
use super::error::ModelError;
use super::references::{Named, definition, reference};
use crate::model::rotation;
use nalgebra::Vector3;

/// A file may hold this many `replicate` elements: each costs a pass over everything that refers to names.
const MOST_REPLICATES: usize = 1_000;

/// All copies together may hold this many elements: far more than a model can have that is not refused later.
const MOST_COPIED: usize = 200_000;

/// Sections that refer to the tree, those that others refer to first.
const REFERRING: [&str; 5] = ["tendon", "actuator", "contact", "equality", "sensor"];

/// Replaces all `replicate` elements by what they stand for.
pub(super) fn expand(root: &mut Element, settings: &Settings) -> Result<(), ModelError> {
    let mut worlds: Vec<Element> = Vec::new();
    let mut copied = Vec::new();
    let budget = &mut { MOST_COPIED };
    for section in root.children.iter_mut().filter(|child| child.tag == "worldbody") {
        let mut world = core::mem::replace(section, Element::empty("worldbody", section.place.clone()));
        expand_children(&mut world, settings, budget, &mut copied)?;
        worlds.push(world);
    }
    let mut worlds = worlds.into_iter();
    for section in root.children.iter_mut().filter(|child| child.tag == "worldbody") {
        if let Some(world) = worlds.next() {
            *section = world;
        }
    }
    for mut copies in copied {
        for section in REFERRING {
            copies.copy_referring(root, section, budget)?;
        }
    }
    Ok(())
}

/// The names that one `replicate` copies, and the suffixes that they get.
struct Copies {
    names: Named,
    suffixes: Vec<String>,
}

fn expand_children(
    parent: &mut Element,
    settings: &Settings,
    budget: &mut usize,
    copied: &mut Vec<Copies>,
) -> Result<(), ModelError> {
    let mut children = Vec::with_capacity(parent.children.len());
    for mut child in core::mem::take(&mut parent.children) {
        expand_children(&mut child, settings, budget, copied)?;
        if child.tag == "replicate" {
            children.extend(replicas(&child, settings, budget, copied)?);
        } else {
            children.push(child);
        }
    }
    parent.children = children;
    Ok(())
}

/// The frames that a `replicate` stands for.
fn replicas(
    element: &Element,
    settings: &Settings,
    budget: &mut usize,
    copied: &mut Vec<Copies>,
) -> Result<Vec<Element>, ModelError> {
    element.required("count")?;
    let count = element.integer_or("count", 0, 0, 1_000_000)? as usize;
    if let Some(own) = element.children.iter().find(|child| matches!(child.tag.as_str(), "joint" | "freejoint" | "inertial")) {
        return Err(own.invalid(format!("`{}` cannot stand directly in `replicate`; put it into a body", own.tag)));
    }
    spend(element, element.size(), count, budget)?;
    if copied.len() == MOST_REPLICATES {
        return Err(element.invalid(format!("the model has more than {MOST_REPLICATES} `replicate` elements")));
    }
    let offset = element.vector_or("offset", Vector3::zeros())?;
    let angles = element.numbers::<3>("euler")?.unwrap_or_default().map(|angle| settings.radians(angle));
    let separator = element.text("sep").unwrap_or_default();
    let digits = count.to_string().len();
    let suffixes: Vec<String> = (0..count).map(|index| format!("{separator}{index:0digits$}")).collect();
    let mut names = Named::default();
    element.children.iter().for_each(|child| names.collect(child));

    let mut position = Vector3::zeros();
    let mut frames = Vec::with_capacity(count);
    for (index, suffix) in suffixes.iter().enumerate() {
        // Turned by so many times the angles, rather than so many times by the angles: that is what MuJoCo does.
        let turned = angles.map(|angle| angle * index as f64);
        let orientation = rotation::from_euler(turned, &settings.euler_sequence).unwrap_or(rotation::IDENTITY);
        let mut frame = Element::empty("frame", element.place.clone());
        frame.attributes =
            vec![("pos".to_owned(), spaced(position.iter().copied())), ("quat".to_owned(), spaced(orientation.into_iter()))];
        frame.children = element.children.clone();
        frame.children.iter_mut().for_each(|child| suffix_names(child, suffix));
        frames.push(frame);
        position += rotation::rotate(orientation, offset);
    }
    copied.push(Copies { names, suffixes });
    Ok(frames)
}

/// Takes room for `count` copies of something of this size.
fn spend(element: &Element, size: usize, count: usize, budget: &mut usize) -> Result<(), ModelError> {
    let needed = size.saturating_mul(count);
    match budget.checked_sub(needed) {
        Some(left) => {
            *budget = left;
            Ok(())
        }
        None => Err(element.invalid(format!("with all copies the model has more than {MOST_COPIED} copied elements"))),
    }
}

/// Appends the suffix to the element's name and to those of all elements in it.
fn suffix_names(element: &mut Element, suffix: &str) {
    for (attribute, value) in &mut element.attributes {
        if attribute == "name" && !value.is_empty() {
            value.push_str(suffix);
        }
    }
    element.children.iter_mut().for_each(|child| suffix_names(child, suffix));
}

impl Copies {
    /// Copies the entries of a kind of section about the copied names, and remembers the names that are copied by that.
    fn copy_referring(&mut self, root: &mut Element, tag: &str, budget: &mut usize) -> Result<(), ModelError> {
        let mut referring = Vec::new();
        for section in root.children.iter_mut().filter(|child| child.tag == tag) {
            let (copied, kept) = core::mem::take(&mut section.children).into_iter().partition(|child| self.refers(child));
            section.children = kept;
            referring.extend::<Vec<Element>>(copied);
        }
        let Some(section) = root.children.iter_mut().rev().find(|child| child.tag == tag) else { return Ok(()) };
        for element in &referring {
            spend(element, element.size(), self.suffixes.len(), budget)?;
            if tag == "equality" && self.refers_elsewhere(element) {
                return Err(element.invalid(
                    "an equality cannot join something that `replicate` copies with something that it does not: put both \
                     into the `replicate`, or write the copies out",
                ));
            }
            if let Some(named) = definition(element) {
                self.names.insert(named);
            }
        }
        for suffix in &self.suffixes {
            section.children.extend(referring.iter().map(|element| self.copy(element, suffix)));
        }
        Ok(())
    }

    /// Whether an element, or one in it, refers to a copied name.
    fn refers(&self, element: &Element) -> bool {
        let own = element.attributes.iter().any(|(attribute, value)| self.copied(element, attribute, value));
        own || element.children.iter().any(|child| self.refers(child))
    }

    /// Whether an element refers to a name that is not copied.
    fn refers_elsewhere(&self, element: &Element) -> bool {
        let other = |(attribute, value): &(String, String)| {
            reference(element, attribute).is_some() && !value.is_empty() && !self.copied(element, attribute, value)
        };
        element.attributes.iter().any(other)
    }

    fn copied(&self, element: &Element, attribute: &str, value: &str) -> bool {
        reference(element, attribute).is_some_and(|kind| self.names.contains(kind, value))
    }

    /// The element for one copy.
    fn copy(&self, element: &Element, suffix: &str) -> Element {
        let mut copy = element.clone();
        self.suffix_references(&mut copy, suffix);
        for (attribute, value) in &mut copy.attributes {
            if attribute == "name" && !value.is_empty() {
                value.push_str(suffix);
            }
        }
        copy
    }

    fn suffix_references(&self, element: &mut Element, suffix: &str) {
        let marks: Vec<bool> =
            element.attributes.iter().map(|(attribute, value)| self.copied(element, attribute, value)).collect();
        for ((_, value), mark) in element.attributes.iter_mut().zip(marks) {
            if mark {
                value.push_str(suffix);
            }
        }
        element.children.iter_mut().for_each(|child| self.suffix_references(child, suffix));
    }
}

fn spaced(numbers: impl Iterator<Item = f64>) -> String {
    numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(" ")
}
