//! Which elements define names, and which attributes refer to them.

use super::document::Element;
use std::collections::BTreeSet;

/// A kind of named thing. Kinds have separate names: a body and a joint may share one.
pub(super) type Kind = &'static str;

/// Names by kind.
#[derive(Debug, Default)]
pub(super) struct Named {
    names: BTreeSet<(Kind, String)>,
}

impl Named {
    /// Adds the names that a part of the tree defines.
    pub fn collect(&mut self, element: &Element) {
        if let Some(named) = definition(element) {
            self.insert(named);
        }
        element.children.iter().for_each(|child| self.collect(child));
    }

    pub fn insert(&mut self, (kind, name): (Kind, &str)) {
        self.names.insert((kind, name.to_owned()));
    }

    pub fn contains(&self, kind: Kind, name: &str) -> bool {
        self.names.contains(&(kind, name.to_owned()))
    }
}

/// The kind and name that an element of the tree, of a `tendon` or an `actuator` section defines.
pub(super) fn definition(element: &Element) -> Option<(Kind, &str)> {
    let name = element.text("name").filter(|name| !name.is_empty())?;
    let kind = match element.tag.as_str() {
        "body" => "body",
        "joint" | "freejoint" => "joint",
        "geom" => "geom",
        "site" => "site",
        "frame" => "frame",
        "spatial" | "fixed" => "tendon",
        "general" | "motor" | "position" | "velocity" | "intvelocity" | "damper" | "cylinder" | "muscle" | "adhesion" => {
            "actuator"
        }
        _ => return None,
    };
    Some((kind, name))
}

/// The kind of thing that an attribute names, if it names one.
pub(super) fn reference(element: &Element, attribute: &str) -> Option<Kind> {
    Some(match attribute {
        "body" | "body1" | "body2" => "body",
        "joint" | "joint1" | "joint2" | "jointinparent" => "joint",
        "geom" | "geom1" | "geom2" => "geom",
        "site" | "site1" | "site2" | "sidesite" | "refsite" | "cranksite" | "slidersite" => "site",
        "tendon" | "tendon1" | "tendon2" => "tendon",
        "actuator" => "actuator",
        "objname" => object(element.text("objtype")?)?,
        "refname" => object(element.text("reftype")?)?,
        _ => return None,
    })
}

/// The kind of a sensor's `objtype` or `reftype`.
fn object(word: &str) -> Option<Kind> {
    Some(match word.trim() {
        "body" | "xbody" => "body",
        "geom" => "geom",
        "site" => "site",
        _ => return None,
    })
}
