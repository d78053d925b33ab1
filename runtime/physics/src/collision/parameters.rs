//! Which pairs can meet, and the parameters of their contacts.

use super::{Plan, broad::Broad, can_meet};
use crate::model::{GeomKind, Model, SolverParameters};
use crate::scalar::Real;
use core::ops::Range;
use std::collections::BTreeSet;

/// A pair of geoms that can meet, with the parameters of its contacts mixed.
#[derive(Debug, Clone)]
pub struct CollisionPair {
    /// The two geoms, ordered by kind as MuJoCo orders them.
    pub geoms: [usize; 2],
    /// Their kinds.
    pub kinds: [GeomKind; 2],
    /// Their bodies.
    pub bodies: [usize; 2],
    /// The bounding test: largest distance of the centres (height over a plane) at which the pair can touch, m.
    pub bound: f64,
    /// Distance below which contact forces act, m.
    pub margin: f64,
    /// Extra distance in which contacts are reported without force, m.
    pub gap: f64,
    /// Contact dimension: 1, 3, 4 or 6.
    pub dimension: usize,
    /// Two sliding, one torsional, two rolling coefficients: the sliding ones with the friction of the model.
    pub friction: [f64; 5],
    /// Where the sliding friction comes from.
    pub sliding: Sliding,
    /// SolverParameters of the contact.
    pub softness: SolverParameters,
    /// SolverParameters reference of an elliptic cone's friction rows; both zero takes that of `softness`.
    pub friction_reference: [f64; 2],
    /// Inverse weight of both bodies at the reference configuration: translation, rotation.
    pub inverse_weight: [f64; 2],
    /// Range of the dofs that move one body against the other, in the plan's columns.
    pub(in super::super) columns: Range<usize>,
    /// Whether some of these dofs move only the first body and others only the second: contacts then couple two chains.
    pub(in super::super) bridges_chains: bool,
}

/// Which geoms decide the sliding friction of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sliding {
    /// None: an explicit pair has its own.
    Pair,
    /// That of higher priority.
    Geom(usize),
    /// The rougher of two.
    Larger([usize; 2]),
}

impl CollisionPair {
    /// Distance up to which contacts are reported, m.
    pub(super) fn reach(&self) -> f64 {
        self.margin + self.gap
    }

    /// The friction of its contacts where geoms have these sliding frictions.
    #[inline(always)]
    pub(in super::super) fn friction_with<T: Real>(&self, sliding: impl Fn(usize) -> T) -> [T; 5] {
        let [first, second, torsional, rolling, last] = self.friction;
        let [first, second, torsional, rolling, last] =
            [T::splat(first), T::splat(second), T::splat(torsional), T::splat(rolling), T::splat(last)];
        let sliding = match self.sliding {
            Sliding::Pair => return [first, second, torsional, rolling, last],
            Sliding::Geom(geom) => sliding(geom),
            Sliding::Larger([a, b]) => sliding(a).at_least(sliding(b)),
        };
        let sliding = sliding.at_least(T::splat(SMALLEST_FRICTION));
        [sliding, sliding, torsional, rolling, rolling]
    }
}

/// Two geoms and, if declared explicitly, the index of their pair.
type Choice = ([usize; 2], Option<usize>);

impl Plan {
    /// Decides which pairs of geoms can meet.
    pub fn new(model: &Model) -> Self {
        let mut plan = Self::default();
        for (geoms, pair) in choices(model) {
            let [first, second] = geoms.map(|geom| model.geoms.kind[geom]);
            if can_meet(first, second) {
                plan.add(model, geoms, pair);
            }
        }
        plan.broad = Broad::new(model, &plan.candidates);
        plan
    }

    fn add(&mut self, model: &Model, geoms: [usize; 2], pair: Option<usize>) {
        let kinds = geoms.map(|geom| model.geoms.kind[geom]);
        let bodies = geoms.map(|geom| model.geoms.body[geom]);
        let columns = self.add_columns(model, bodies);
        let mixed = match pair {
            Some(pair) => declared(model, pair),
            None => mixed(model, geoms),
        };
        let radius: f64 = geoms.iter().map(|&geom| model.geoms.bounding_radius[geom]).sum();
        let weight = |k: usize| bodies.iter().map(|&body| model.bodies.inverse_weight[body][k]).sum();
        self.candidates.push(CollisionPair {
            geoms,
            kinds,
            bodies,
            bound: radius + mixed.margin + mixed.gap,
            margin: mixed.margin,
            gap: mixed.gap,
            dimension: mixed.dimension,
            friction: mixed.friction,
            sliding: mixed.sliding,
            softness: mixed.softness,
            friction_reference: mixed.friction_reference,
            inverse_weight: [weight(0), weight(1)],
            bridges_chains: self.sides[columns.clone()].windows(2).any(|sides| sides[0] != sides[1]),
            columns,
        });
    }

    /// Dofs that move exactly one of the two bodies: those that move both cancel in every contact row.
    fn add_columns(&mut self, model: &Model, bodies: [usize; 2]) -> Range<usize> {
        let [first, second] = bodies.map(|body| moving_dofs(model, body));
        let start = self.columns.len();
        for &dof in first.symmetric_difference(&second) {
            self.columns.push(dof);
            self.sides.push(if second.contains(&dof) { 1.0 } else { -1.0 });
        }
        start..self.columns.len()
    }
}

/// All dofs that move `body`, ascending.
fn moving_dofs(model: &Model, body: usize) -> BTreeSet<usize> {
    let mut carrier = body;
    while carrier != 0 && model.bodies.dofs[carrier].is_empty() {
        carrier = model.bodies.parent[carrier];
    }
    let last = if carrier == 0 { None } else { model.bodies.dofs[carrier].clone().next_back() };
    core::iter::successors(last, |&dof| model.dofs.parent[dof]).collect()
}

/// All pairs that pass MuJoCo's filters, in its order: by body pair (smaller body first), explicit pairs before others.
fn choices(model: &Model) -> Vec<Choice> {
    let bodies_of = |geoms: &[usize; 2]| {
        let [a, b] = geoms.map(|geom| model.geoms.body[geom]);
        (a.min(b), a.max(b))
    };
    let by_kind = |[a, b]: [usize; 2]| if model.geoms.kind[a] as u8 > model.geoms.kind[b] as u8 { [b, a] } else { [a, b] };
    let mut chosen: Vec<Choice> =
        model.pairs.geoms.iter().enumerate().map(|(pair, &geoms)| (by_kind(geoms), Some(pair))).collect();
    let explicit: BTreeSet<[usize; 2]> = chosen.iter().map(|(geoms, _)| *geoms).collect();
    let colliding = |body: usize| {
        let geoms = &model.geoms;
        model.bodies.geoms[body].clone().filter(|&geom| geoms.contact_type[geom] != 0 || geoms.contact_affinity[geom] != 0)
    };
    let carriers: Vec<usize> = (0..model.bodies.parent.len()).filter(|&body| colliding(body).next().is_some()).collect();
    for (index, &first) in carriers.iter().enumerate() {
        for &second in carriers[index + 1..].iter().filter(|&&second| bodies_can_meet(model, first, second)) {
            for a in colliding(first) {
                let pairs = colliding(second).filter(|&b| bits_match(model, a, b)).map(|b| by_kind([a, b]));
                chosen.extend(pairs.filter(|geoms| !explicit.contains(geoms)).map(|geoms| (geoms, None)));
            }
        }
    }
    chosen.sort_by_key(|(geoms, _)| bodies_of(geoms));
    chosen
}

/// Neither welded together, nor parent and child (the world aside), nor both immovable, nor excluded.
fn bodies_can_meet(model: &Model, first: usize, second: usize) -> bool {
    let bodies = &model.bodies;
    let [weld_first, weld_second] = [bodies.weld[first], bodies.weld[second]];
    let parent_weld = |weld: usize| bodies.weld[bodies.parent[weld]];
    let neighbours =
        weld_first != 0 && weld_second != 0 && (weld_first == parent_weld(weld_second) || weld_second == parent_weld(weld_first));
    let excluded = model.exclusions.binary_search(&(first.min(second), first.max(second))).is_ok();
    let still = |weld: usize| weld == 0 || bodies.mocap[weld];
    let immovable = still(weld_first) && still(weld_second);
    weld_first != weld_second && !immovable && !neighbours && !excluded
}

fn bits_match(model: &Model, a: usize, b: usize) -> bool {
    let geoms = &model.geoms;
    geoms.contact_type[a] & geoms.contact_affinity[b] != 0 || geoms.contact_type[b] & geoms.contact_affinity[a] != 0
}

/// Parameters of a contact.
struct Mixed {
    margin: f64,
    gap: f64,
    dimension: usize,
    friction: [f64; 5],
    sliding: Sliding,
    softness: SolverParameters,
    friction_reference: [f64; 2],
}

fn declared(model: &Model, pair: usize) -> Mixed {
    let pairs = &model.pairs;
    Mixed {
        margin: pairs.margin[pair],
        gap: pairs.gap[pair],
        dimension: usize::from(pairs.dimension[pair]),
        friction: pairs.friction[pair].map(|coefficient| coefficient.at_least(SMALLEST_FRICTION)),
        sliding: Sliding::Pair,
        softness: pairs.softness[pair],
        friction_reference: pairs.friction_reference[pair],
    }
}

/// MuJoCo's `mjMINMU`: friction below it is raised to it, so that cones never degenerate.
const SMALLEST_FRICTION: f64 = 1e-5;

/// MuJoCo's mixing: the geom of higher priority decides; equals take the larger dimension and friction and the average
/// softness weighted by `solmix` (the element-wise smaller reference if either is in the direct format).
fn mixed(model: &Model, [a, b]: [usize; 2]) -> Mixed {
    let geoms = &model.geoms;
    let leader = match geoms.priority[a].cmp(&geoms.priority[b]) {
        core::cmp::Ordering::Greater => Some(a),
        core::cmp::Ordering::Less => Some(b),
        core::cmp::Ordering::Equal => None,
    };
    let sliding_torsional_rolling = match leader {
        Some(geom) => geoms.friction[geom],
        None => core::array::from_fn(|k| geoms.friction[a][k].at_least(geoms.friction[b][k])),
    };
    let [sliding, torsional, rolling] = sliding_torsional_rolling.map(|coefficient: f64| coefficient.at_least(SMALLEST_FRICTION));
    Mixed {
        margin: geoms.margin[a] + geoms.margin[b],
        gap: geoms.gap[a] + geoms.gap[b],
        dimension: usize::from(match leader {
            Some(geom) => geoms.contact_dimension[geom],
            None => geoms.contact_dimension[a].max(geoms.contact_dimension[b]),
        }),
        friction: [sliding, sliding, torsional, rolling, rolling],
        sliding: leader.map_or(Sliding::Larger([a, b]), Sliding::Geom),
        softness: match leader {
            Some(geom) => geoms.softness[geom],
            None => {
                average_softness(geoms.softness[a], geoms.softness[b], mix_weight(geoms.softness_mix[a], geoms.softness_mix[b]))
            }
        },
        friction_reference: [0.0; 2],
    }
}

/// Weight of the first of two geoms.
fn mix_weight(first: f64, second: f64) -> f64 {
    const TINY: f64 = 1e-15;
    match (first >= TINY, second >= TINY) {
        (true, true) => first / (first + second),
        (false, false) => 0.5,
        (false, true) => 0.0,
        (true, false) => 1.0,
    }
}

fn average_softness(first: SolverParameters, second: SolverParameters, weight: f64) -> SolverParameters {
    let average = |a: f64, b: f64| weight * a + (1.0 - weight) * b;
    let standard = first.reference[0] > 0.0 && second.reference[0] > 0.0;
    let reference = core::array::from_fn(|k| {
        let (a, b) = (first.reference[k], second.reference[k]);
        if standard { average(a, b) } else { a.at_most(b) }
    });
    SolverParameters { reference, impedance: core::array::from_fn(|k| average(first.impedance[k], second.impedance[k])) }
}
