//! What poses have shown of a subject, and the search for a pose that shows more.

use super::poses::{Pose, Room};
use msk_compiler::survey::{About, Survey};
use msk_physics::scalar::Real;
use msk_program::frame::Sensor;
use msk_program::graph::interval::Bounds;
use msk_runtime::episode::{EpisodeKey, Stream};
use std::collections::BTreeSet;

/// How many changes of a pose a search tries in a round, and in how many rounds: it goes on while a round gains something.
const TRIES: usize = 100;
const ROUNDS: usize = 12;
/// What a round must gain, as a part of what is missing.
const GAIN: f64 = 0.1;

/// A pose that counts, and the record of it.
pub(super) struct Shown {
    pub pose: Pose,
    pub frame: Vec<f64>,
    pub stands: bool,
}

/// What poses have shown of a subject.
#[derive(Clone)]
pub(super) struct Tally {
    /// The least that was missing until it holds, of a term until it is not 0, and where.
    pub to_hold: (f64, Option<usize>),
    pub to_fail: (f64, Option<usize>),
    /// The least and the most of a term, and where: in any pose, and in those that stand.
    pub all: Range,
    pub standing: Range,
    /// Middles of both sides of a comparison.
    pub sides: [[f64; 2]; 2],
    /// What is missing in poses that stand, until it holds and until it fails, and where.
    pub on_feet: [Vec<(f64, usize)>; 2],
}

#[derive(Clone)]
pub(super) struct Range {
    pub low: (f64, Option<usize>),
    pub high: (f64, Option<usize>),
}

impl Default for Range {
    fn default() -> Self {
        Self { low: (f64::INFINITY, None), high: (f64::NEG_INFINITY, None) }
    }
}

impl Range {
    fn add(&mut self, bounds: Bounds, place: usize) {
        if bounds.low < self.low.0 {
            self.low = (bounds.low, Some(place));
        }
        if bounds.high > self.high.0 {
            self.high = (bounds.high, Some(place));
        }
    }

    /// The largest magnitude.
    pub fn size(&self) -> f64 {
        self.high.0.at_least(-self.low.0)
    }
}

impl Default for Tally {
    fn default() -> Self {
        let none = (f64::INFINITY, None);
        let sides = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        Self {
            to_hold: none,
            to_fail: none,
            all: Range::default(),
            standing: Range::default(),
            sides,
            on_feet: Default::default(),
        }
    }
}

impl Tally {
    pub fn see(&mut self, survey: &Survey<'_>, subject: usize, place: usize, stands: bool) {
        let is_term = matches!(survey.subjects()[subject].about, About::Term(_));
        if is_term {
            let bounds = survey.bounds(subject);
            self.all.add(bounds, place);
            if stands {
                self.standing.add(bounds, place);
            }
            let lack = survey.lack(subject, true);
            if lack < self.to_hold.0 {
                self.to_hold = (lack, Some(place));
            }
            return;
        }
        let [to_hold, to_fail] = &mut self.on_feet;
        for (wanted, known, on_feet) in [(true, &mut self.to_hold, to_hold), (false, &mut self.to_fail, to_fail)] {
            let lack = survey.lack(subject, wanted);
            if lack < known.0 {
                *known = (lack, Some(place));
            }
            if stands {
                on_feet.push((lack, place));
            }
        }
        for (side, bounds) in self.sides.iter_mut().zip(survey.sides(subject).into_iter().flatten()) {
            let middle = 0.5 * (bounds.low + bounds.high);
            *side = [side[0].at_most(middle), side[1].at_least(middle)];
        }
    }
}

/// What is wanted of a subject.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Goal {
    Hold(bool),
    /// A term beyond a size.
    Reward(f64),
    /// A term below a value.
    Less(f64),
}

/// A search for a pose.
pub(super) struct Search<'r, 'm, 's, 'g> {
    pub room: &'r mut Room<'m>,
    pub survey: &'s mut Survey<'g>,
    pub trusted: &'s BTreeSet<Sensor>,
    pub looked: usize,
}

impl Search<'_, '_, '_, '_> {
    /// How far the present pose is from a goal; 0 or less if it is there.
    fn distance(&self, subject: usize, goal: Goal) -> f64 {
        let bounds = || self.survey.bounds(subject);
        match goal {
            Goal::Hold(wanted) => self.survey.lack(subject, wanted),
            // Where the term is zero, the robustness margin leads on.
            Goal::Reward(size) => match bounds().high.at_least(-bounds().low) {
                0.0 => 1.0 + size + self.survey.lack(subject, true),
                value => size - value,
            },
            Goal::Less(value) => bounds().low - value,
        }
    }

    /// Looks for a pose that reaches a goal; whether there is one.
    pub fn run(&mut self, subject: usize, goal: Goal, start: &Shown, standing: bool, tally: &mut Tally) -> bool {
        let mut chance = Stream::new(EpisodeKey { seed: 0, episode: subject as u64 }, "probe/search");
        let mut best = start.pose.clone();
        // The last change that helped: what helped once may help again.
        let mut helped: Option<Pose> = None;
        self.survey.look_at(subject, &start.frame, self.trusted);
        let mut least = self.distance(subject, goal);
        for _ in 0..ROUNDS {
            let before = least;
            for _ in 0..TRIES {
                if least <= 0.0 {
                    return true;
                }
                let again = helped.take().filter(|_| chance.uniform() < 0.8);
                let pose = match again {
                    Some(former) => self.room.beyond(&former, &best),
                    None => self.room.near(&best, standing, &mut chance),
                };
                if !self.room.show(&pose) || (standing && !self.room.stands(&pose)) {
                    continue;
                }
                self.looked += 1;
                self.survey.look_at(subject, &self.room.frame, self.trusted);
                tally.see(self.survey, subject, 0, standing);
                let distance = self.distance(subject, goal);
                if distance < least {
                    helped = Some(std::mem::replace(&mut best, pose));
                } else if distance == least {
                    best = pose;
                }
                least = least.at_most(distance);
            }
            if least > (1.0 - GAIN) * before {
                break;
            }
        }
        least <= 0.0
    }
}
