//! Default classes: attributes that elements inherit.
//!
//! A class starts as a copy of its parent *as the parent is at that point*, so the order of sections matters: what a later
//! section adds to `main` does not reach classes that an earlier one defined.

use super::document::Element;
use super::error::ModelError;
use super::shortcut::{self, SHORTCUTS};
use std::collections::BTreeMap;

/// The class that everything inherits from.
const MAIN: &str = "main";

/// Attributes of which the later one replaces only as many numbers as it has.
const OVERLAID: [&str; 12] = [
    "size",
    "friction",
    "solref",
    "solimp",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "gainprm",
    "biasprm",
    "dynprm",
    "gear",
];

/// Attributes that set the same thing in different ways: giving one takes back the others.
const ALTERNATIVES: [&[&str]; 1] = [&["quat", "axisangle", "xyaxes", "zaxis", "euler"]];

/// One class: for each kind of element the attributes it starts with.
#[derive(Debug, Clone, Default)]
struct Class {
    attributes: BTreeMap<&'static str, Vec<(String, String)>>,
}

/// All classes of a model.
#[derive(Debug)]
pub(super) struct Defaults {
    classes: BTreeMap<String, Class>,
}

/// The default that applies to an element: all tendons share one, and all actuators.
fn kind_of(tag: &str) -> Option<&'static str> {
    Some(match tag {
        "joint" => "joint",
        "geom" => "geom",
        "site" => "site",
        "mesh" => "mesh",
        "material" => "material",
        "pair" => "pair",
        "equality" => "equality",
        "tendon" | "spatial" | "fixed" => "tendon",
        "general" => "actuator",
        _ => return shortcut::find(tag).map(|_| "actuator"),
    })
}

impl Defaults {
    /// Collects the classes of all `default` sections in order.
    pub fn collect(root: &Element) -> Result<Self, ModelError> {
        let mut defaults = Self { classes: BTreeMap::from([(MAIN.to_owned(), Class::default())]) };
        for section in root.children.iter().filter(|child| child.tag == "default") {
            if section.text("class").is_some_and(|name| name != MAIN) {
                return Err(section.invalid("the top-level default class is called `main`"));
            }
            defaults.extend(section, MAIN)?;
        }
        Ok(defaults)
    }

    /// Adds the elements of a `default` to the class `name`, then its nested classes.
    fn extend(&mut self, section: &Element, name: &str) -> Result<(), ModelError> {
        let mut class = self.classes.get(name).cloned().unwrap_or_default();
        let before = class.clone();
        for child in section.children.iter().filter(|child| child.tag != "default") {
            let Some(kind) = kind_of(&child.tag) else { continue };
            let attributes = class.inherit(Some(kind), child)?;
            if kind == "actuator" {
                class.remember_law(child, &attributes, &before);
            }
            class.attributes.insert(kind, attributes);
        }
        self.classes.insert(name.to_owned(), class.clone());
        for nested in section.children.iter().filter(|child| child.tag == "default") {
            let nested_name = nested.required("class")?;
            if self.classes.insert(nested_name.to_owned(), class.clone()).is_some() {
                return Err(nested.invalid(format!("the default class `{nested_name}` is defined twice")));
            }
            self.extend(nested, nested_name)?;
        }
        Ok(())
    }

    /// Whether a class exists.
    pub fn contains(&self, class: &str) -> bool {
        self.classes.contains_key(class)
    }

    /// The element with the attributes of its class filled in: its own `class`, else the surrounding `childclass`.
    pub fn resolve(&self, element: &Element, surrounding: Option<&str>) -> Result<Element, ModelError> {
        self.resolve_kind(kind_of(&element.tag), element, surrounding)
    }

    /// The same for an equality, whose tags mean something else elsewhere.
    pub fn resolve_equality(&self, element: &Element) -> Result<Element, ModelError> {
        self.resolve_kind(Some("equality"), element, None)
    }

    fn resolve_kind(
        &self,
        kind: Option<&'static str>,
        element: &Element,
        surrounding: Option<&str>,
    ) -> Result<Element, ModelError> {
        let name = element.text("class").or(surrounding).unwrap_or(MAIN);
        let class = self.classes.get(name);
        let class = class.ok_or_else(|| element.invalid(format!("there is no default class `{name}`")))?;
        let attributes = class.inherit(kind, element)?;
        Ok(Element { tag: element.tag.clone(), attributes, children: element.children.clone(), place: element.place.clone() })
    }
}

impl Class {
    fn of(&self, kind: &str) -> &[(String, String)] {
        self.attributes.get(kind).map_or(&[], Vec::as_slice)
    }

    /// The element's own attributes over the inherited ones; shortcuts become what they stand for.
    fn inherit(&self, kind: Option<&'static str>, element: &Element) -> Result<Vec<(String, String)>, ModelError> {
        let inherited = kind.map_or(&[][..], |kind| self.of(kind));
        match shortcut::find(&element.tag).filter(|_| kind == Some("actuator")) {
            Some(shortcut) => {
                let raw = shortcut::expand(shortcut, element, self.of(shortcut.tag))?;
                Ok(merged(&raw, inherited))
            }
            None => Ok(merged(&element.attributes, inherited)),
        }
    }

    /// Keeps an actuator default's force law for the shortcuts that may inherit it; the others fall back to what the class
    /// started with.
    fn remember_law(&mut self, element: &Element, attributes: &[(String, String)], before: &Self) {
        let gain = attributes.iter().find(|(name, _)| name == "gaintype").map_or("fixed", |(_, value)| value.trim());
        for shortcut in &SHORTCUTS {
            let applies = element.tag == shortcut.tag || element.tag == "general" && gain == shortcut.gain;
            let law = if applies { shortcut::raw(attributes) } else { before.of(shortcut.tag).to_vec() };
            self.attributes.insert(shortcut.tag, law);
        }
    }
}

/// `own` attributes, then those inherited ones that `own` does not replace.
fn merged(own: &[(String, String)], inherited: &[(String, String)]) -> Vec<(String, String)> {
    let gives = |name: &str| own.iter().any(|(own_name, _)| own_name == name);
    let replaced = |name: &str| {
        gives(name) || ALTERNATIVES.iter().any(|group| group.contains(&name) && group.iter().any(|other| gives(other)))
    };
    let inherited_value = |name: &str| inherited.iter().find(|(key, _)| key == name).map(|(_, value)| value);
    let mut result: Vec<(String, String)> = own
        .iter()
        .map(|(name, value)| match inherited_value(name) {
            Some(below) if OVERLAID.contains(&name.as_str()) => (name.clone(), overlaid(value, below)),
            _ => (name.clone(), value.clone()),
        })
        .collect();
    result.extend(inherited.iter().filter(|(name, _)| !replaced(name)).cloned());
    result
}

/// The numbers of `above`, then those of `below` that it leaves standing.
fn overlaid(above: &str, below: &str) -> String {
    let standing = below.split_whitespace().skip(above.split_whitespace().count());
    above.split_whitespace().chain(standing).collect::<Vec<_>>().join(" ")
}
