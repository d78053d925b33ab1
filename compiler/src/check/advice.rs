//! What is probably meant by a name that means nothing here: a part of an object, a later number of a row, a phase to come.

use super::context::Checker;
use crate::vocabulary::Landmark;

impl Checker<'_> {
    /// Advice on a name that exists, but not where it is read or not by itself.
    pub(super) fn meant_elsewhere(&self, text: &str) -> Option<String> {
        if self.later_phases.iter().any(|phase| phase == text) {
            return Some(format!(
                "`{text}` is a later phase of the sequence: a phase can read itself and earlier phases, for example `NAME.success`"
            ));
        }
        if self.phases.iter().any(|phase| phase == text) {
            return Some(format!("`{text}` is a phase; its success is `{text}.success`"));
        }
        if !self.place.in_task && self.names.of_task().any(|(name, _)| name == text) {
            return Some(format!("functions and constants cannot read names of the task: pass `{text}` as an argument"));
        }
        self.part_of_a_thing(text).or_else(|| self.beyond_a_row(text))
    }

    /// `swing` of `door.swing`.
    fn part_of_a_thing(&self, text: &str) -> Option<String> {
        let landmarks = self.vocabulary.landmarks.iter().map(|landmark| &landmark.name);
        let mut names = landmarks.chain(self.vocabulary.joints.iter().map(|joint| &joint.name));
        let whole = names.find(|name| name.rsplit_once('.').is_some_and(|(_, part)| part == text))?;
        Some(format!("it belongs to an object: `{whole}`"))
    }

    /// `pole_5` where there are `pole_0` to `pole_4`.
    fn beyond_a_row(&self, text: &str) -> Option<String> {
        let (stem, number) = text.rsplit_once('_')?;
        let number: u32 = number.parse().ok()?;
        let of_row = |landmark: &Landmark| -> Option<u32> {
            let (own, number) = landmark.name.rsplit_once('_')?;
            (own == stem && landmark.of_scene).then(|| number.parse().ok())?
        };
        let numbers = || self.vocabulary.landmarks.iter().filter_map(of_row);
        let (first, last) = (numbers().min()?, numbers().max()?);
        let excluded = if number == last + 1 { "; the upper end of a range is excluded" } else { "" };
        Some(format!("there are `{stem}_{first}` to `{stem}_{last}`{excluded}"))
    }

    /// The objects of the scene, for an error that would otherwise list the body.
    pub(super) fn objects_in_words(&self) -> Option<String> {
        let objects = self.vocabulary.landmarks.iter().filter(|landmark| landmark.of_scene && !landmark.name.contains('.'));
        let names: Vec<String> = objects.take(12).map(|landmark| format!("`{}`", landmark.name)).collect();
        (!names.is_empty()).then(|| format!("the scene has {}", names.join(", ")))
    }

    /// The landmarks of the body that have a segment, left and right in one.
    pub(super) fn segments_in_words(&self) -> String {
        let solid = |landmark: &&Landmark| !landmark.of_scene && landmark.has_segment;
        let names: Vec<&str> = self.vocabulary.landmarks.iter().filter(solid).map(|landmark| landmark.name.as_str()).collect();
        let other = |stem: &str| names.iter().any(|name| name.strip_suffix("_r") == Some(stem));
        let words: Vec<String> = names
            .iter()
            .filter_map(|name| match (name.strip_suffix("_l"), name.strip_suffix("_r")) {
                (Some(stem), _) if other(stem) => Some(format!("{stem}_{{l,r}}")),
                (_, Some(stem)) if names.iter().any(|name| name.strip_suffix("_l") == Some(stem)) => None,
                _ => Some((*name).to_owned()),
            })
            .collect();
        words.join(", ")
    }
}
