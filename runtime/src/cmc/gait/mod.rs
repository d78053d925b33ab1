//! A gait: steps that catch a body which falls where it is to go.
//!
//! 1. Where the body goes until the end of the present step is known at any time of it (`pendulum`), and so is where the next foot has to land;
//! 2. within the soles the centre of pressure is moved so that the foot may land where it usually would;
//! 3. what the body does for that in one hold is a [`Step`]: wishes of the centre of mass, the root and both feet (`step`).
//!
//! A body that is to stay stands on both feet, and steps if it is pushed too far.

mod pace;
mod path;
mod pendulum;
mod step;
mod terrain;

pub(super) use step::Step;

use super::feedback::Carried;
use super::motion::is_below;
use super::support::{Point, Support};
use super::{ControlError, Present, turning};
use crate::body::sensors::Snapshot;
use core::ops::Range;
use msk_physics::model::{Model, rotation};
use msk_physics::scalar::Real;
use msk_physics::{Workspace, kinematics};
use msk_program::task::RootPlacement;
use nalgebra::{Vector2, Vector3};
use pace::Manner;
use path::Path;
use pendulum::{Pendulum, Timing};
use step::{Foot, Placed, Roll, Swing};

/// How a body shall walk.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Walk {
    /// Forward and left of where it faces, m/s.
    pub velocity: Vector2<f64>,
    /// How fast it turns to the left, rad/s.
    pub turn: f64,
}

/// Between the middles of the soles of a body that is to stay, which a narrower stance lets fall, m; the least of any; and how far a foot reaches back and
/// to its side, m.
const STANDING_WIDTH: f64 = 0.2;
const LEAST_WIDTH: f64 = 0.11;
const REACH: [f64; 2] = [-0.6, 0.5];
/// How far out or in a foot points at most, rad.
const TOES: f64 = 0.1;
/// How far the centre of pressure may be ahead of the middle of a sole, or behind it, m.
const SOLE: f64 = 0.065;
/// A body is past the foot that bears when it is this far ahead of the middle of its sole, m.
const PAST: f64 = 0.1;
/// The greatest pace with which a gait starts, m/s: one of a body that comes faster makes shorter steps than it needs, and slows down.
const START_PACE: f64 = 0.4;
/// How fast a body comes to turn, rad/s².
const TURNING: f64 = 1.3;
/// How fast a body stands up into its gait, m/s.
const RISING: f64 = 0.3;
/// What is slower stays, m/s and rad/s; what is further from the middle of its feet has to step, and after a step less far may stay, m.
const STILL: f64 = 0.05;
const PUSHED: f64 = 0.12;
const CAUGHT: f64 = 0.03;
/// Weight has shifted to a foot if the capture point is as near, m; at the latest after this time, s.
const SHIFTED: f64 = 0.062;
const SHIFTING: f64 = 0.5;
/// From this share of its time on a foot that is this near to the ground has landed, m. One that is late lands while weight goes to it: to wait for it
/// makes the body fall.
const EARLY: f64 = 0.9;
const LANDED: f64 = 0.003;

/// What the feet do.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Both bear.
    Standing,
    /// Both bear, and the weight goes to one of them.
    Shifting { stance: usize, time: f64 },
    /// One bears: since the other has landed, s; where the ground pressed then; where the other was when it left.
    Stepping { stance: usize, time: f64, from: Vector2<f64>, lifted: Option<Placed> },
}

/// A gait over an episode.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Gait {
    /// The left one first.
    feet: [Foot; 2],
    /// Where the body is to face, rad.
    heading: f64,
    /// Where it did when it began.
    begun: f64,
    /// Of the centre of mass over the ground, m: how high it is to be now, and in the long run.
    height: f64,
    usual_height: f64,
    /// Of the ground that the centre of mass goes over, m; when it began, and how fast it rises, m/s.
    level: f64,
    level_begun: f64,
    rise: f64,
    phase: Phase,
    /// Where the ground was to press in the last hold, m.
    pressure: Vector2<f64>,
    /// How it walks now: a body does not change its pace at once.
    walk: Walk,
    /// How it walks in the present step.
    manner: Manner,
    path: Path,
    /// The control step of the last hold.
    step: Option<u32>,
}

/// The body as a gait sees it.
struct Now {
    pendulum: Pendulum,
    com: Vector3<f64>,
    capture: Vector2<f64>,
    /// Of the angular momentum about the centre of mass, ω l / m g (`pendulum`), m.
    momentum: Vector2<f64>,
    placed: [Placed; 2],
    /// s.
    hold: f64,
}

impl Now {
    fn middle(&self, foot: usize) -> Vector2<f64> {
        self.placed[foot].middle.xy()
    }

    fn centre(&self) -> Vector2<f64> {
        (self.middle(0) + self.middle(1)) * 0.5
    }
}

impl Gait {
    /// Of a body as it is, whose feet have these points.
    ///
    /// # Errors
    /// A body that is not free, or has not two feet.
    pub fn new(present: &Present<'_>, support: &Support) -> Result<Self, ControlError> {
        let &Present { body, state, workspace, .. } = present;
        let (place, _) = body.root.free.ok_or(ControlError::NoGait)?;
        let [heading, ..] = body.turns(core::array::from_fn(|part| state.position[place + 3 + part]));
        let feet = feet(present, support, heading).ok_or(ControlError::NoGait)?;
        let placed = feet.each_ref().map(|foot| foot.placed(present, &support.points));
        let ground = placed.map(|placed| placed.ground());
        let com = workspace.kinematics.subtree_com[body.root.body];
        let level = ground[0].at_least(ground[1]);
        let pace = turning::level(velocity(present).xy(), -heading);
        let mut gait = Self {
            feet,
            heading,
            begun: heading,
            height: com.z - level,
            usual_height: standing_height(present),
            level,
            level_begun: level,
            rise: 0.0,
            phase: Phase::Standing,
            pressure: (placed[0].middle.xy() + placed[1].middle.xy()) * 0.5,
            walk: Walk { velocity: Vector2::new(pace.x.clip(-START_PACE, START_PACE), 0.0), turn: 0.0 },
            manner: Manner::of(0.0),
            path: Path(com.xy()),
            step: None,
        };
        gait.begin(&placed, pace.x);
        Ok(gait)
    }

    /// Goes on with the step that a body takes which has just been set in motion at that speed, m/s.
    fn begin(&mut self, placed: &[Placed; 2], speed: f64) {
        let ahead = |foot: usize| turning::level((placed[foot].middle - placed[1 - foot].middle).xy(), -self.heading).x;
        let timing = self.manner.timing;
        let lower = if placed[0].height < placed[1].height { 0 } else { 1 };
        if placed[1 - lower].height > placed[lower].height + 0.02 {
            let share = 0.5 + 0.5 * ahead(1 - lower) / (speed.abs() * timing.step()).at_least(0.1);
            self.pressure = placed[lower].middle.xy();
            let time = timing.both + timing.single * share.clip(0.0, 1.0);
            self.phase = Phase::Stepping { stance: lower, time, from: self.pressure, lifted: None };
        } else if speed.abs() > 0.3 {
            let front = if ahead(0) * speed > 0.0 { 0 } else { 1 };
            self.pressure = placed[1 - front].middle.xy();
            self.phase = Phase::Stepping { stance: front, time: 0.0, from: self.pressure, lifted: None };
        }
    }

    /// What the hold that begins with a control step is for; `None` if the body is to stand. Control steps have that period, s; an action may be kept
    /// for several.
    pub fn advance(&mut self, present: &Present<'_>, points: &[Point], walk: &Walk, (step, period): (u32, f64)) -> Option<Step> {
        let since = self.step.map_or(1, |before| step.saturating_sub(before).max(1));
        self.step = Some(step);
        let now = self.look(present, points, f64::from(since) * period);
        self.change_pace(walk, now.hold);
        self.change_phase(&now);
        let (pressure, swing) = match self.phase {
            Phase::Standing => {
                self.pressure = now.centre();
                self.climb(0.5 * (now.placed[0].ground() + now.placed[1].ground()), SHIFTING, now.hold);
                return None;
            }
            Phase::Shifting { stance, ref mut time } => {
                *time += now.hold;
                self.rise = 0.0;
                (self.shift(&now, stance), None)
            }
            Phase::Stepping { stance, time, from, lifted } => self.stride(&now, present, (stance, time, from, lifted)),
        };
        self.pressure = pressure;
        let placement = RootPlacement { heading: self.heading, pitch: self.manner.lean, ..RootPlacement::default() };
        let facing = present.body.facing(&placement);
        Some(Step {
            orientation: rotation::from_matrix(&facing),
            spin: facing.transpose() * Vector3::z() * self.walk.turn,
            height: self.level + self.height,
            rise: self.rise,
            acceleration: (now.com.xy() - pressure) * (now.pendulum.omega * now.pendulum.omega),
            swing,
            roll: self.roll(&now),
            manner: self.manner,
        })
    }

    /// How far the body has turned since it began, and by how much the ground is higher.
    pub fn carried(&self) -> Carried {
        Carried { turned: self.heading - self.begun, risen: self.level - self.level_begun }
    }

    /// Brings the level of the ground to another within a time, s.
    fn climb(&mut self, level: f64, time: f64, hold: f64) {
        self.rise = (level - self.level) / time.at_least(hold);
        self.level += self.rise * hold;
    }

    fn look(&self, present: &Present<'_>, points: &[Point], hold: f64) -> Now {
        let &Present { body, model, state, workspace } = present;
        let com = workspace.kinematics.subtree_com[body.root.body];
        let gravity = (-model.options.gravity.z).at_least(1.0);
        let pendulum = Pendulum::new(self.height, gravity, self.manner.timing);
        let capture = com.xy() + velocity(present).xy() / pendulum.omega;
        let weight = workspace.kinematics.subtree_mass[body.root.body] * gravity;
        let spin = Snapshot { body, model, state, workspace }.angular_momentum();
        let momentum = Vector2::new(spin.y, -spin.x) * (pendulum.omega / weight.at_least(1.0));
        Now { pendulum, com, capture, momentum, placed: self.feet.each_ref().map(|foot| foot.placed(present, points)), hold }
    }

    fn change_pace(&mut self, walk: &Walk, hold: f64) {
        let change = walk.velocity - self.walk.velocity;
        let most = Manner::of(walk.velocity.x).quickening * hold;
        self.walk.velocity += if change.norm() > most { change * (most / change.norm()) } else { change };
        self.height += (self.usual_height - self.manner.lower - self.height).clip(-RISING * hold, RISING * hold);
        self.walk.turn += (walk.turn - self.walk.turn).clip(-TURNING * hold, TURNING * hold);
        self.heading += self.walk.turn * hold;
    }

    fn moves(&self) -> bool {
        self.walk.velocity.norm() > STILL || self.walk.turn.abs() > STILL
    }

    fn change_phase(&mut self, now: &Now) {
        let before = self.phase;
        let moves = self.moves();
        let pushed = now.capture - now.centre();
        self.phase = match self.phase {
            Phase::Standing if moves || pushed.norm() > PUSHED => {
                // The foot on the side where the body goes is the first to leave.
                let aside = if moves { self.walk.velocity.y } else { turning::level(pushed, -self.heading).y };
                Phase::Shifting { stance: if aside > 0.0 { 1 } else { 0 }, time: 0.0 }
            }
            Phase::Shifting { stance, time } if time >= SHIFTING || self.inward(now, stance) < SHIFTED => {
                Phase::Stepping { stance, time: self.manner.timing.both, from: self.pressure, lifted: None }
            }
            Phase::Stepping { stance, time, .. } if self.has_landed(now, stance, time) => match moves || pushed.norm() > CAUGHT {
                true => Phase::Stepping { stance: 1 - stance, time: 0.0, from: self.pressure, lifted: None },
                false => Phase::Standing,
            },
            phase => phase,
        };
        // A step that has begun goes on as it began.
        let goes_on = matches!((before, self.phase), (Phase::Stepping { stance, .. }, Phase::Stepping { stance: now, .. }) if stance == now);
        if !goes_on {
            self.manner = Manner::of(self.walk.velocity.x);
        }
    }

    /// The foot whose heel may rise.
    fn roll(&self, now: &Now) -> Option<Roll> {
        let Phase::Stepping { stance, time, .. } = self.phase else { return None };
        let forward = turning::level(Vector2::new(1.0, 0.0), self.heading);
        let past = (now.com.xy() - now.middle(stance)).dot(&forward) > PAST;
        let begins = time < self.manner.timing.both;
        let foot = if begins { 1 - stance } else { stance };
        (begins || past).then(|| Roll { keys: self.feet[foot].keys.clone(), middle: now.middle(foot), forward })
    }

    /// How far the capture point is from the middle of a sole towards the other, m.
    fn inward(&self, now: &Now, stance: usize) -> f64 {
        turning::level(now.middle(stance) - now.capture, -self.heading).y * self.feet[stance].side
    }

    fn has_landed(&self, now: &Now, stance: usize, time: f64) -> bool {
        let Timing { both, single } = self.manner.timing;
        time >= both + single || (time > both + EARLY * single && now.placed[1 - stance].height < LANDED)
    }

    /// Where the ground is to press for the capture point to go over a foot.
    fn shift(&self, now: &Now, stance: usize) -> Vector2<f64> {
        let goal = now.middle(stance) - turning::level(Vector2::new(0.0, self.feet[stance].side * 0.04), self.heading);
        // It goes there with a rate of 4 1/s.
        let wanted = now.capture - (goal - now.capture) * (4.0 / now.pendulum.omega);
        self.within_both(now, wanted)
    }

    /// Where the ground is to press in a hold of a step, and the way of the other foot.
    fn stride(
        &mut self,
        now: &Now,
        present: &Present<'_>,
        (stance, time, from, lifted): (usize, f64, Vector2<f64>, Option<Placed>),
    ) -> (Vector2<f64>, Option<Swing>) {
        let (pendulum, manner, swung) = (&now.pendulum, &self.manner, &self.feet[1 - stance]);
        let Timing { both, single } = manner.timing;
        let places = [from, now.middle(stance)];
        let width = if self.moves() { manner.width } else { STANDING_WIDTH };
        let velocity = self.path.follow(now.com.xy(), self.walk.velocity, self.heading, manner.returning) * manner.stride;
        let course = pendulum.course(velocity, Vector2::new(0.0, swung.side * width));
        let end = turning::level(pendulum.end(now.capture, time, places) - now.middle(stance), -self.heading);
        let momentum = turning::level(now.momentum, -self.heading).x * manner.foreseen;
        let end = end + pendulum.swung(time, Vector2::new(momentum, 0.0));
        let authority = pendulum.authority(time);
        let wanted = (end - pendulum.usual_end(&course)) / authority.at_least(1e-3);
        let within = Vector2::new(wanted.x.clip(-SOLE, SOLE), wanted.y.clip(-manner.aside, manner.aside));
        let usual = manner.timing.pressure(time + 0.5 * now.hold, places);
        let pressed = match time + now.hold < both {
            true => self.within_both(now, usual + turning::level(wanted, self.heading)),
            false => usual + turning::level(within, self.heading),
        };
        let lifted = lifted.or_else(|| (time + now.hold > both - manner.early).then(|| now.placed[1 - stance]));
        let way = lifted.map(|from| {
            let landing = pendulum.landing(end - within * authority, &course);
            let aside = (swung.side * landing.y).clip(LEAST_WIDTH, REACH[1]) * swung.side;
            let landing =
                turning::level(Vector2::new((landing.x - manner.short).clip(REACH[0], manner.reach), aside), self.heading);
            let bearing = &now.placed[stance];
            let place = (now.middle(stance) + landing).push(bearing.ground());
            terrain::way(present, from, (place, self.heading + swung.toes), manner.lift)
        });
        let swing = way.as_ref().map(|way| {
            way.swing((swung, manner), present, now.placed[1 - stance].middle, [time - both + manner.early, now.hold])
        });
        let lands = way.map_or(now.placed[1 - stance].ground(), |way| way.to.z);
        self.climb(0.5 * (now.placed[stance].ground() + lands), both + single - time, now.hold);
        self.phase = Phase::Stepping { stance, time: time + now.hold, from, lifted };
        (pressed, swing)
    }

    /// The place between two soles, or on one of them, that is nearest to another, roughly.
    fn within_both(&self, now: &Now, wanted: Vector2<f64>) -> Vector2<f64> {
        let across = now.middle(0) - now.middle(1);
        let length = across.norm().at_least(1e-6);
        let (along, from) = (across / length, wanted - now.centre());
        let between = from.dot(&along).clip(-0.5 * length, 0.5 * length);
        let forward = turning::level(Vector2::new(1.0, 0.0), self.heading);
        let ahead = (from - along * between).dot(&forward).clip(-SOLE, SOLE);
        now.centre() + along * between + forward * ahead
    }
}

/// The left and the right foot of a body that faces there, if it has two.
fn feet(present: &Present<'_>, support: &Support, heading: f64) -> Option<[Foot; 2]> {
    let &Present { body, model, workspace, .. } = present;
    let foot = |(landmark, keys): (usize, Range<usize>)| {
        let landmark = &body.landmarks[landmark];
        let mut foot = Foot { body: landmark.body, axes: landmark.axes, keys, side: 1.0, toes: 0.0 };
        // As far out as it is now; a foot on its way may point anywhere.
        foot.toes = turning::between(heading, foot.placed(present, &support.points).heading).clip(-TOES, TOES);
        foot
    };
    let feet: Vec<Foot> = Support::landmarks(body).zip(support.keys()).map(foot).collect();
    let [first, second] = <[Foot; 2]>::try_from(feet).ok()?;
    // Feet may cross; the hips, where the legs part, do not.
    let hips = [hip(model, first.body, second.body), hip(model, second.body, first.body)];
    let kinematics = &workspace.kinematics;
    let left = kinematics.body_rotation[body.root.body] * body.root.axes.column(1);
    let aside = hips.map(|hip| kinematics.body_position[hip].dot(&left));
    let [left, right] = if aside[0] > aside[1] { [first, second] } else { [second, first] };
    Some([left, Foot { side: -1.0, ..right }])
}

/// The body nearest to the root that carries a foot, and not the other.
fn hip(model: &Model, foot: usize, other: usize) -> usize {
    let mut hip = foot;
    while hip > 0 && !is_below(model, other, model.bodies.parent[hip]) {
        hip = model.bodies.parent[hip];
    }
    hip
}

/// How high the centre of mass of a body in its neutral pose is over its soles, m.
fn standing_height(present: &Present<'_>) -> f64 {
    let &Present { body, model, state, .. } = present;
    let (mut state, mut workspace) = (state.clone(), Workspace::new(model));
    body.place(model, &RootPlacement::default(), body.neutral(), &mut state, &mut workspace);
    kinematics::update(model, &state, &mut workspace.kinematics);
    let mut support = Support::new(body);
    support.update(model, &workspace.kinematics);
    let lowest = support.points.iter().map(|point| point.position.z).fold(f64::INFINITY, f64::at_most);
    workspace.kinematics.subtree_com[body.root.body].z - lowest
}

/// Of the common centre of mass of all that the root carries, m/s.
fn velocity(present: &Present<'_>) -> Vector3<f64> {
    let &Present { body, model, state, workspace } = present;
    let carried = Snapshot { body, model, state, workspace }.momentum(body.members.clone());
    carried / workspace.kinematics.subtree_mass[body.root.body].at_least(f64::MIN_POSITIVE)
}
