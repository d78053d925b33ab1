//! The numbers that are trained.

use std::ops::Range;

/// A named tensor among [`Parameters`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tensor {
    /// Unique, such as `actor.0.weight`.
    pub name: String,
    /// Row by row.
    pub shape: Vec<usize>,
    /// Where its numbers stand.
    pub range: Range<usize>,
}

/// All numbers of a learner in one array: an optimiser, a gradient and a checkpoint have the same order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parameters {
    values: Vec<f32>,
    tensors: Vec<Tensor>,
}

impl Parameters {
    /// Adds a tensor of zeros behind the others; returns where its numbers stand.
    pub fn add(&mut self, name: impl Into<String>, shape: &[usize]) -> Range<usize> {
        let begin = self.values.len();
        let range = begin..begin + shape.iter().product::<usize>();
        self.values.resize(range.end, 0.0);
        self.tensors.push(Tensor { name: name.into(), shape: shape.to_vec(), range: range.clone() });
        range
    }

    /// How many numbers there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The numbers.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The numbers, to be changed.
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// The tensors, in the order of their numbers.
    pub fn tensors(&self) -> &[Tensor] {
        &self.tensors
    }

    /// The tensor to which a number belongs; `None` behind the last.
    pub fn tensor_of(&self, place: usize) -> Option<&Tensor> {
        self.tensors.get(self.tensors.partition_point(|tensor| tensor.range.end <= place))
    }

    /// The tensor of the first number that is infinite or no number, here or in a gradient of these parameters.
    pub fn first_invalid(&self, numbers: &[f32]) -> Option<&Tensor> {
        let place = numbers.iter().position(|number| !number.is_finite())?;
        self.tensor_of(place)
    }

    /// Moves `to` towards `from`, another range of the same length, by a share of the way: Polyak averaging.
    ///
    /// # Panics
    /// If the ranges overlap or have different lengths.
    pub fn follow(&mut self, to: Range<usize>, from: Range<usize>, share: f32) {
        assert!(to.len() == from.len() && (to.end <= from.start || from.end <= to.start), "separate ranges of one length");
        let split = to.start.max(from.start);
        let (low, high) = self.values.split_at_mut(split);
        let (targets, sources) =
            if to.start < from.start { (&mut low[to], &high[..from.len()]) } else { (&mut high[..to.len()], &low[from]) };
        for (target, source) in targets.iter_mut().zip(sources) {
            *target += share * (source - *target);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_belong_to_tensors() {
        let mut parameters = Parameters::default();
        assert_eq!(parameters.add("a", &[2, 3]), 0..6);
        assert_eq!(parameters.add("b", &[1]), 6..7);
        let name = |place: usize| parameters.tensor_of(place).map(|tensor| tensor.name.as_str());
        assert_eq!([name(0), name(5), name(6), name(7)], [Some("a"), Some("a"), Some("b"), None]);
        let mut gradient = [0.0; 7];
        assert_eq!(parameters.first_invalid(&gradient), None);
        gradient[6] = f32::NAN;
        assert_eq!(parameters.first_invalid(&gradient).map(|tensor| tensor.name.as_str()), Some("b"));
    }

    #[test]
    fn targets_follow_in_both_directions() {
        let mut parameters = Parameters::default();
        let (a, b) = (parameters.add("a", &[2]), parameters.add("b", &[2]));
        parameters.values_mut().copy_from_slice(&[1.0, 2.0, 3.0, 6.0]);
        parameters.follow(a.clone(), b.clone(), 0.5);
        assert_eq!(parameters.values(), [2.0, 4.0, 3.0, 6.0]);
        parameters.follow(b, a, 1.0);
        assert_eq!(parameters.values(), [2.0, 4.0, 2.0, 4.0]);
    }
}
