//! Gait figures from the forces under two feet.
//!
//! A foot stands while the ground carries more than 20 N of it, the usual threshold of force plates; what lasts less than 50 ms is
//! chatter and no change. A strike is the beginning of a stance.
//!
//! * cadence: steps per minute between the first and the last strike of either foot;
//! * step length: at a strike after one of the other foot, how far the foot is before the other along the way that the centre of mass
//!   goes from the first to the last strike, m;
//! * stance share: stance over cycle, of the cycles between two strikes of one foot;
//! * asymmetry: |l - r| / ((l + r) / 2) of the two feet's mean step lengths and stance shares; 0 is symmetric (Robinson, Herzog and Nigg,
//!   J. Manip. Physiol. Ther. 10, 1987).

use crate::trace::{Quantity, Row};

/// What a foot carries that stands, N.
const STANDS: f64 = 20.0;
/// What lasts less is chatter, s.
const CHATTER: f64 = 0.05;

/// The beginning of a stance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strike {
    /// Which foot.
    pub foot: usize,
    /// When, as the number of the row.
    pub row: u32,
    /// Row in which the foot left the ground again, if it did.
    pub off: Option<u32>,
    /// Places of all feet at the strike, horizontally, m; of bodies with more than two feet the first two.
    feet: [[f64; 2]; 2],
    /// Place of the centre of mass, m.
    com: [f64; 2],
}

/// One foot over time.
#[derive(Debug, Clone, Copy, Default)]
struct Foot {
    stands: bool,
    /// Since which row it has been otherwise.
    otherwise: Option<(u32, [[f64; 2]; 2], [f64; 2])>,
}

/// Follows the feet.
#[derive(Debug, Clone, Default)]
pub struct Gait {
    feet: [Foot; 2],
    strikes: Vec<Strike>,
    rows: u32,
    period: f64,
}

/// What there is of gait in an episode.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct GaitFigures {
    /// Steps per minute.
    pub cadence: Option<f64>,
    /// Mean step length, m.
    pub step_length: Option<f64>,
    /// Mean stance share, 0..1.
    pub stance_share: Option<f64>,
    /// Asymmetry of step lengths.
    pub step_length_asymmetry: Option<f64>,
    /// Asymmetry of stance shares.
    pub stance_asymmetry: Option<f64>,
}

impl Gait {
    /// Adds the next row.
    pub fn look(&mut self, row: &Row<'_>) {
        let (reactions, places) = (row.of(Quantity::GroundReactions), row.of(Quantity::Feet));
        let (&[x, y, _], &[ax, ay, _, bx, by, _]) = (row.of(Quantity::CenterOfMass), places) else { return };
        self.period = row.layout().period;
        let present = self.rows;
        self.rows += 1;
        let where_now = ([[ax, ay], [bx, by]], [x, y]);
        for (index, reaction) in reactions.chunks_exact(7).enumerate().take(2) {
            let stands = reaction[2] > STANDS;
            let foot = &mut self.feet[index];
            if present == 0 {
                foot.stands = stands;
            }
            if stands == foot.stands {
                foot.otherwise = None;
                continue;
            }
            let (since, feet, com) = *foot.otherwise.get_or_insert((present, where_now.0, where_now.1));
            // Half a step less, so that rounding does not decide.
            if f64::from(present + 1 - since) * self.period < CHATTER - 0.5 * self.period {
                continue;
            }
            (foot.stands, foot.otherwise) = (stands, None);
            match stands {
                true => self.strikes.push(Strike { foot: index, row: since, off: None, feet, com }),
                false => {
                    if let Some(strike) = self.strikes.iter_mut().rev().find(|strike| strike.foot == index) {
                        strike.off = Some(since);
                    }
                }
            }
        }
    }

    /// The strikes so far, in the order of time.
    pub fn strikes(&self) -> Vec<Strike> {
        let mut strikes = self.strikes.clone();
        strikes.sort_by_key(|strike| (strike.row, strike.foot));
        strikes
    }

    /// The figures of all rows.
    pub fn figures(&self) -> GaitFigures {
        let strikes = self.strikes();
        let ([first, .., last], true) = (strikes.as_slice(), self.period > 0.0) else { return GaitFigures::default() };
        let time = f64::from(last.row - first.row) * self.period;
        let lengths = step_lengths(&strikes);
        let stances = [0, 1].map(|foot| mean(&stance_shares(&strikes, foot)));
        let all: Vec<f64> = [0, 1].iter().flat_map(|&foot| stance_shares(&strikes, foot)).collect();
        let of = |foot: usize| mean(&lengths.iter().filter(|(of, _)| *of == foot).map(|(_, length)| *length).collect::<Vec<_>>());
        GaitFigures {
            cadence: (time > 0.0).then(|| 60.0 * (strikes.len() - 1) as f64 / time),
            step_length: mean(&lengths.iter().map(|(_, length)| *length).collect::<Vec<_>>()),
            stance_share: mean(&all),
            step_length_asymmetry: asymmetry([of(0), of(1)]),
            stance_asymmetry: asymmetry(stances),
        }
    }
}

/// Foot and length of every step.
fn step_lengths(strikes: &[Strike]) -> Vec<(usize, f64)> {
    let ([first, .., last], count) = (strikes, strikes.len()) else { return Vec::new() };
    let way = [last.com[0] - first.com[0], last.com[1] - first.com[1]];
    let far = libm::hypot(way[0], way[1]);
    if far <= 0.0 || count < 2 {
        return Vec::new();
    }
    let pairs = strikes.windows(2).filter(|pair| pair[0].foot != pair[1].foot);
    let length = |pair: &[Strike]| {
        let Strike { foot, feet, .. } = pair[1];
        let ahead = [0, 1].map(|axis| feet[foot][axis] - feet[1 - foot][axis]);
        (foot, (ahead[0] * way[0] + ahead[1] * way[1]) / far)
    };
    pairs.map(length).collect()
}

/// Stance over cycle, of the whole cycles of a foot.
fn stance_shares(strikes: &[Strike], foot: usize) -> Vec<f64> {
    let own: Vec<&Strike> = strikes.iter().filter(|strike| strike.foot == foot).collect();
    let share = |pair: &[&Strike]| {
        let off = pair[0].off?;
        Some(f64::from(off - pair[0].row) / f64::from(pair[1].row - pair[0].row))
    };
    own.windows(2).filter_map(share).collect()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn asymmetry([left, right]: [Option<f64>; 2]) -> Option<f64> {
    let (left, right) = (left?, right?);
    let middle = 0.5 * (left + right);
    (middle != 0.0).then(|| ((left - right) / middle).abs())
}
