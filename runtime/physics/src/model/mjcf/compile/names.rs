//! Names of elements and the indices they stand for.

use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use std::collections::HashMap;

/// The kinds of things that are referred to by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Body,
    Joint,
    Geom,
    Site,
    Tendon,
    Actuator,
    Equality,
    Keyframe,
    Sensor,
}

impl Kind {
    fn word(self) -> &'static str {
        match self {
            Self::Body => "body",
            Self::Joint => "joint",
            Self::Geom => "geom",
            Self::Site => "site",
            Self::Tendon => "tendon",
            Self::Actuator => "actuator",
            Self::Equality => "equality",
            Self::Keyframe => "key",
            Self::Sensor => "sensor",
        }
    }
}

/// Names given so far. Only looked up, never iterated, so that the hash order cannot show.
#[derive(Debug, Default)]
pub(super) struct Names {
    indices: HashMap<(Kind, String), usize>,
}

impl Names {
    /// Registers body 0 and gives its name.
    pub fn world(&mut self) -> String {
        self.indices.insert((Kind::Body, "world".to_owned()), 0);
        "world".to_owned()
    }

    /// Registers the name of the element with this index; an empty name is no name.
    pub fn register(&mut self, kind: Kind, element: &Element, index: usize) -> Result<String, ModelError> {
        let name = element.name();
        if !name.is_empty() && self.indices.insert((kind, name.clone()), index).is_some() {
            return Err(element.invalid(format!("there are two {}s with the name `{name}`", kind.word())));
        }
        Ok(name)
    }

    /// The index that a required attribute of the element refers to.
    pub fn required(&self, kind: Kind, element: &Element, attribute: &str) -> Result<usize, ModelError> {
        element.required(attribute)?;
        self.optional(kind, element, attribute)?.ok_or_else(|| element.invalid(format!("`{attribute}` is empty")))
    }

    /// The index that an attribute of the element refers to, if it is given.
    pub fn optional(&self, kind: Kind, element: &Element, attribute: &str) -> Result<Option<usize>, ModelError> {
        let Some(name) = element.text(attribute) else { return Ok(None) };
        let index = self.indices.get(&(kind, name.to_owned())).copied();
        let unknown = || element.invalid(format!("`{attribute}` names the {} `{name}`, which does not exist", kind.word()));
        index.map(Some).ok_or_else(unknown)
    }
}
