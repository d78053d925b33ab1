//! Types of computed values: what one element is, and whether it is one or a list.
//!
//! Dimension, frame, shape and wrapping all belong to the type: whatever hands a value on hands them on with it.

use crate::quantity::dimension::Dimension;
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

/// The type of one element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementType {
    /// A number with a dimension.
    Number(Dimension),
    /// An angle known up to whole turns: differences of it take the short way round.
    WrappingAngle,
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
}

impl ElementType {
    /// A dimensionless number.
    pub const PLAIN: Self = Self::Number(Dimension::NONE);
    /// An angle that does not wrap.
    pub const ANGLE: Self = Self::Number(Dimension::ANGLE);

    /// A vector of three components in world axes.
    pub fn world_vector(dimension: Dimension) -> Self {
        Self::Vector { size: 3, dimension, frame: Frame::World }
    }

    /// Lanes of the graph that it takes.
    pub fn lanes(self) -> usize {
        match self {
            Self::Vector { size, .. } => size,
            Self::Place(_) => 3,
            Self::Rotation => 9,
            Self::Number(_) | Self::WrappingAngle | Self::Bool | Self::Int | Self::Steps => 1,
        }
    }

    /// The dimension of its numbers; none of a condition, a count of steps or a rotation.
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Number(dimension) | Self::Vector { dimension, .. } => Some(dimension),
            Self::WrappingAngle => Some(Dimension::ANGLE),
            Self::Int => Some(Dimension::NONE),
            Self::Place(_) => Some(Dimension::LENGTH),
            Self::Bool | Self::Steps | Self::Rotation => None,
        }
    }

    /// Whether it is one number with a dimension.
    pub fn is_number(self) -> bool {
        matches!(self, Self::Number(_) | Self::WrappingAngle | Self::Int)
    }

    /// The same components in another dimension; a number where it was a number.
    pub fn in_dimension(self, dimension: Dimension) -> Self {
        match self {
            Self::Vector { size, frame, .. } => Self::Vector { size, dimension, frame },
            _ => Self::Number(dimension),
        }
    }

    /// What is either of the two: a whole number beside a plain one is plain, an angle beside one that wraps wraps.
    pub fn meet(self, other: Self) -> Option<Self> {
        match (self, other) {
            _ if self == other => Some(self),
            (Self::Int, Self::PLAIN) | (Self::PLAIN, Self::Int) => Some(Self::PLAIN),
            (Self::WrappingAngle, Self::ANGLE) | (Self::ANGLE, Self::WrappingAngle) => Some(Self::WrappingAngle),
            _ => None,
        }
    }

    /// What a reader calls it: `a speed (m/s)`, `a vector of 3 components in m/s (axes of pelvis)`.
    pub fn described(self, vocabulary: &Vocabulary) -> String {
        let axes = |frame: Frame| match frame {
            Frame::World => "world frame".to_owned(),
            other => format!("frame of {}", other.name(vocabulary)),
        };
        match self {
            Self::Number(dimension) => dimension.described(),
            Self::WrappingAngle => "an angle that wraps (rad)".to_owned(),
            Self::Bool => "a condition (true or false)".to_owned(),
            Self::Int => "a whole number".to_owned(),
            Self::Steps => "a number of control steps".to_owned(),
            Self::Place(frame) => format!("a place ({})", axes(frame)),
            Self::Vector { size, dimension, frame } => {
                let unit = if dimension.is_none() { "without unit".to_owned() } else { format!("in {dimension}") };
                format!("a vector of {size} components {unit} ({})", axes(frame))
            }
            Self::Rotation => "an orientation".to_owned(),
        }
    }
}

/// Whether a value is one element or a list of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// One element.
    One,
    /// So many elements.
    List(usize),
}

impl Shape {
    /// Number of elements.
    pub fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::List(length) => length,
        }
    }

    /// Number of elements of a list.
    pub fn length(self) -> Option<usize> {
        match self {
            Self::One => None,
            Self::List(length) => Some(length),
        }
    }
}

/// The type of a computed value.
#[derive(Debug, Clone, PartialEq)]
pub enum Type {
    /// One element.
    One(ElementType),
    /// So many elements of one type.
    List(ElementType, usize),
    /// A list of numbers that differ: in dimension, such as hinges and slides together, or in whether they wrap.
    Mixed(Vec<ElementType>),
}

impl From<ElementType> for Type {
    fn from(element: ElementType) -> Self {
        Self::One(element)
    }
}

impl Type {
    /// One element, or a list of that shape.
    pub fn new(element: ElementType, shape: Shape) -> Self {
        match shape {
            Shape::One => Self::One(element),
            Shape::List(length) => Self::List(element, length),
        }
    }

    /// One element, or a list of so many if `list` is given.
    pub fn one_or_list(element: ElementType, list: bool, length: usize) -> Self {
        if list { Self::List(element, length) } else { Self::One(element) }
    }

    /// A list of these elements: mixed where they differ, which only numbers may.
    pub fn list_of(elements: Vec<ElementType>) -> Option<Self> {
        match elements.as_slice() {
            [first, rest @ ..] if rest.iter().all(|other| other == first) => Some(Self::List(*first, elements.len())),
            _ if elements.iter().all(|element| element.is_number()) => Some(Self::Mixed(elements)),
            _ => None,
        }
    }

    /// A list of numbers, or a mixed one where their dimensions differ.
    pub fn numbers(dimensions: Vec<Dimension>) -> Self {
        match dimensions.as_slice() {
            [first, rest @ ..] if rest.iter().all(|other| other == first) => {
                Self::List(ElementType::Number(*first), dimensions.len())
            }
            _ => Self::Mixed(dimensions.into_iter().map(ElementType::Number).collect()),
        }
    }

    /// What every element is; nothing of a mixed list.
    pub fn element(&self) -> Option<ElementType> {
        match self {
            Self::One(element) | Self::List(element, _) => Some(*element),
            Self::Mixed(_) => None,
        }
    }

    /// What each element may stand for; nothing where their dimensions differ.
    pub fn met(&self) -> Option<ElementType> {
        match self {
            Self::One(element) | Self::List(element, _) => Some(*element),
            Self::Mixed(elements) => {
                let (first, rest) = elements.split_first()?;
                rest.iter().try_fold(*first, |met, element| met.meet(*element))
            }
        }
    }

    /// The element at `place`, which lies within.
    pub fn element_at(&self, place: usize) -> ElementType {
        match self {
            Self::One(element) | Self::List(element, _) => *element,
            Self::Mixed(elements) => elements[place],
        }
    }

    /// Whether it is one element, or a list.
    pub fn shape(&self) -> Shape {
        match self {
            Self::One(_) => Shape::One,
            Self::List(_, length) => Shape::List(*length),
            Self::Mixed(elements) => Shape::List(elements.len()),
        }
    }

    /// Number of elements of a list.
    pub fn length(&self) -> Option<usize> {
        self.shape().length()
    }

    /// Whether every element is one for which `holds`.
    pub fn all(&self, holds: impl Fn(ElementType) -> bool) -> bool {
        match self {
            Self::One(element) | Self::List(element, _) => holds(*element),
            Self::Mixed(elements) => elements.iter().all(|element| holds(*element)),
        }
    }

    /// The same shape with what `change` makes of every element; nothing if it makes nothing of one.
    pub fn map(&self, change: impl Fn(ElementType) -> Option<ElementType>) -> Option<Type> {
        Some(match self {
            Self::One(element) => Self::One(change(*element)?),
            Self::List(element, length) => Self::List(change(*element)?, *length),
            Self::Mixed(elements) => Self::list_of(elements.iter().map(|element| change(*element)).collect::<Option<_>>()?)?,
        })
    }

    /// The same shape with other elements.
    pub fn with_element(&self, element: ElementType) -> Type {
        Self::new(element, self.shape())
    }

    /// Two types element by element, where one value meets every element of a list; nothing if `combine` makes nothing of a
    /// pair, or if the lists differ in length.
    pub fn zip(&self, other: &Type, combine: impl Fn(ElementType, ElementType) -> Option<ElementType>) -> Option<Type> {
        let length = match (self.length(), other.length()) {
            (Some(a), Some(b)) if a != b => return None,
            (a, b) => a.or(b),
        };
        match (self.element(), other.element(), length) {
            (Some(a), Some(b), None) => combine(a, b).map(Self::One),
            (Some(a), Some(b), Some(length)) => combine(a, b).map(|element| Self::List(element, length)),
            (_, _, length) => {
                let pairs = (0..length.unwrap_or(1)).map(|place| combine(self.element_at(place), other.element_at(place)));
                pairs.collect::<Option<_>>().and_then(Self::list_of)
            }
        }
    }

    /// Lanes of one element.
    pub fn element_lanes(&self) -> usize {
        self.element().map_or(1, ElementType::lanes)
    }

    /// Lanes of the graph: the width of every node that holds a value of this type.
    pub fn lanes(&self) -> usize {
        self.shape().count() * self.element_lanes()
    }

    /// The dimension of an element's numbers; none of a condition, a rotation or where dimensions differ.
    pub fn dimension(&self) -> Option<Dimension> {
        self.met().and_then(ElementType::dimension)
    }

    /// Whether it is one number with a dimension.
    pub fn is_one_number(&self) -> bool {
        matches!(self, Self::One(element) if element.is_number())
    }

    /// The units of its numbers, each once; a plain number has an empty one.
    pub fn units(&self) -> Vec<String> {
        let elements = match self {
            Self::One(element) | Self::List(element, _) => std::slice::from_ref(element),
            Self::Mixed(elements) => elements,
        };
        let mut units: Vec<String> = Vec::new();
        for unit in elements.iter().filter_map(|element| element.dimension()).map(|dimension| dimension.to_string()) {
            if !units.contains(&unit) {
                units.push(unit);
            }
        }
        units
    }

    /// What a reader calls one of its elements, or the whole of a mixed list.
    pub fn element_described(&self, vocabulary: &Vocabulary) -> String {
        self.met().map_or_else(|| self.described(vocabulary), |element| element.described(vocabulary))
    }

    /// What a reader calls it: `a speed (m/s)`, `a list of 2, each a place (world axes)`.
    pub fn described(&self, vocabulary: &Vocabulary) -> String {
        match (self.met(), self) {
            (_, Self::One(element)) => element.described(vocabulary),
            (_, Self::List(element, length)) => format!("a list of {length}, each {}", element.described(vocabulary)),
            (Some(element), Self::Mixed(elements)) => {
                format!("a list of {}, each {}", elements.len(), element.described(vocabulary))
            }
            (None, Self::Mixed(elements)) => {
                format!("a list of {} numbers of different dimensions ({})", elements.len(), self.units().join(" and "))
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn an_angle_beside_one_that_wraps_wraps_and_others_do_not_meet() {
        assert_eq!(ElementType::ANGLE.meet(ElementType::WrappingAngle), Some(ElementType::WrappingAngle));
        assert_eq!(ElementType::Int.meet(ElementType::PLAIN), Some(ElementType::PLAIN));
        assert_eq!(ElementType::PLAIN.meet(ElementType::ANGLE), None);
        assert_eq!(ElementType::Place(Frame::World).meet(ElementType::Place(Frame::Landmark(0))), None);
    }

    #[test]
    fn lists_keep_of_every_element_what_it_is() {
        let mixed = Type::list_of(vec![ElementType::WrappingAngle, ElementType::ANGLE]).unwrap();
        assert_eq!(mixed.element(), None);
        assert_eq!(mixed.met(), Some(ElementType::WrappingAngle));
        assert_eq!(mixed.element_at(1), ElementType::ANGLE);
        let halves = mixed.map(|element| element.dimension().map(ElementType::Number));
        assert_eq!(halves, Some(Type::List(ElementType::ANGLE, 2)));
        let one = Type::One(ElementType::WrappingAngle);
        assert_eq!(mixed.zip(&one, ElementType::meet), Some(Type::List(ElementType::WrappingAngle, 2)));
        assert_eq!(mixed.zip(&Type::List(ElementType::ANGLE, 3), ElementType::meet), None);
        assert_eq!(Type::list_of(vec![ElementType::ANGLE, ElementType::Rotation]), None);
    }

    #[test]
    fn lanes_are_those_of_all_elements() {
        assert_eq!(Type::One(ElementType::Rotation).lanes(), 9);
        assert_eq!(Type::List(ElementType::Place(Frame::World), 4).lanes(), 12);
        assert_eq!(Type::Mixed(vec![ElementType::PLAIN, ElementType::ANGLE]).lanes(), 2);
    }
}
