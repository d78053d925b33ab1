//! Types of computed values: dimensions, frames, lists.

use super::dimension::Dimension;
use crate::vocabulary::Vocabulary;

/// The frame in which a vector's components are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Frame {
    /// x forward at the start, y left, z up.
    World,
    /// The anatomical axes forward, left, up of a landmark.
    Landmark(usize),
    /// The yaw of a landmark only: forward and left are level, up is the world's.
    Heading(usize),
}

impl Frame {
    /// As written after `in`.
    pub fn name(self, vocabulary: &Vocabulary) -> String {
        let landmark = |index: usize| vocabulary.landmarks.get(index).map_or("?", |landmark| landmark.name.as_str());
        match self {
            Self::World => "world".to_owned(),
            Self::Landmark(index) => landmark(index).to_owned(),
            Self::Heading(index) => format!("heading({})", landmark(index)),
        }
    }
}

/// The type of a computed value.
#[derive(Debug, Clone, PartialEq)]
pub enum Type {
    /// A number with a dimension.
    Number(Dimension),
    /// A condition.
    Bool,
    /// A count or an index.
    Int,
    /// A time as a whole number of control steps.
    Steps,
    /// A point.
    Place(Frame),
    /// A free vector of two or three components.
    Vector {
        /// Two or three.
        size: usize,
        /// Of every component.
        dimension: Dimension,
        /// In which the components are counted.
        frame: Frame,
    },
    /// An orientation, held as its nine axis components.
    Rotation,
    /// So many elements of one type.
    List(Box<Type>, usize),
    /// A list of numbers whose dimensions differ, such as hinges and slides together.
    Mixed(Vec<Dimension>),
}

impl Type {
    /// A plain number.
    pub const PLAIN: Self = Self::Number(Dimension::NONE);

    /// A vector of three components in world axes.
    pub fn world_vector(dimension: Dimension) -> Self {
        Self::Vector { size: 3, dimension, frame: Frame::World }
    }

    /// A list of numbers, or a mixed one where their dimensions differ.
    pub fn numbers(dimensions: Vec<Dimension>) -> Self {
        match dimensions.as_slice() {
            [first, rest @ ..] if rest.iter().all(|other| other == first) => {
                Self::List(Box::new(Self::Number(*first)), dimensions.len())
            }
            _ => Self::Mixed(dimensions),
        }
    }

    /// The type of one element: of a list its elements', else its own.
    pub fn element(&self) -> &Type {
        match self {
            Self::List(element, _) => element,
            other => other,
        }
    }

    /// Number of elements of a list.
    pub fn length(&self) -> Option<usize> {
        match self {
            Self::List(_, length) => Some(*length),
            Self::Mixed(dimensions) => Some(dimensions.len()),
            _ => None,
        }
    }

    /// The same shape with other elements.
    pub fn with_element(&self, element: Type) -> Type {
        match self.length() {
            Some(length) => Self::List(Box::new(element), length),
            None => element,
        }
    }

    /// Lanes of one element.
    pub fn element_lanes(&self) -> usize {
        match self.element() {
            Self::Vector { size, .. } => *size,
            Self::Place(_) => 3,
            Self::Rotation => 9,
            _ => 1,
        }
    }

    /// The dimension of an element's numbers; none of a condition, a rotation or a mixed list.
    pub fn dimension(&self) -> Option<Dimension> {
        match self.element() {
            Self::Number(dimension) | Self::Vector { dimension, .. } => Some(*dimension),
            Self::Int => Some(Dimension::NONE),
            Self::Place(_) => Some(Dimension::LENGTH),
            _ => None,
        }
    }

    /// What a reader calls it: `a speed (m/s)`, `a list of 2 places`, `a vector in m/s (pelvis axes)`.
    pub fn described(&self, vocabulary: &Vocabulary) -> String {
        let axes = |frame: Frame| match frame {
            Frame::World => "world axes".to_owned(),
            other => format!("axes of {}", other.name(vocabulary)),
        };
        match self {
            Self::Number(dimension) => dimension.described(),
            Self::Bool => "a condition (yes or no)".to_owned(),
            Self::Int => "a whole number".to_owned(),
            Self::Steps => "a number of control steps".to_owned(),
            Self::Place(frame) => format!("a place ({})", axes(*frame)),
            Self::Vector { size, dimension, frame } => {
                let unit = if dimension.is_none() { "without unit".to_owned() } else { format!("in {dimension}") };
                format!("a vector of {size} components {unit} ({})", axes(*frame))
            }
            Self::Rotation => "an orientation".to_owned(),
            Self::List(element, length) => format!("a list of {length}, each {}", element.described(vocabulary)),
            Self::Mixed(dimensions) => {
                let mut units: Vec<String> = Vec::new();
                for unit in dimensions.iter().map(Dimension::to_string) {
                    if !units.contains(&unit) {
                        units.push(unit);
                    }
                }
                format!("a list of {} numbers of different dimensions ({})", dimensions.len(), units.join(" and "))
            }
        }
    }
}
