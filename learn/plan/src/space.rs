//! What a plan decides: the entries of its action space.

use crate::settings::{Along, SpaceChoice, Targets};
use msk_physics::scalar::Real;
use msk_program::action::{self, ActionSpace, ActionTarget, BaseController, Synergy, TrackingOffsets};
use msk_program::frame::{Sensor, Subject};
use msk_program::scene::Part;
use msk_program::testing::Take;
use msk_program::vocabulary::{Group, GroupKind};
use msk_runtime::action::{ActsOn, Controls};
use msk_runtime::body::Body;
use msk_runtime::policy::PolicyContext;
use std::collections::BTreeMap;
use std::iter;
use std::ops::Range;
use std::sync::Arc;

/// How the entries of a plan become actions of an episode.
#[derive(Debug, Clone)]
pub(crate) enum Space {
    /// They are actions of the task's own space.
    Task(Arc<ActionSpace>),
    /// They are entries of another space.
    Other(Box<Moved>),
}

/// Entries that become actions of muscles.
#[derive(Debug, Clone)]
pub(crate) struct Moved {
    controls: Controls,
    /// By what each entry of a plan is multiplied for the controls.
    shares: Vec<f64>,
    /// The products.
    entries: Vec<f64>,
}

impl Space {
    /// Of the episode of a context, from the present on.
    ///
    /// # Errors
    /// The reason why the body or the task does not have it.
    pub fn new(context: &PolicyContext<'_>, choice: SpaceChoice, targets: &Targets) -> Result<Self, String> {
        let own = &context.task.action;
        let (space, shares) = match choice {
            SpaceChoice::Auto if own.is_default() => moved(context, targets)?,
            SpaceChoice::Auto | SpaceChoice::Task => return Ok(Self::Task(Arc::new(own.clone()))),
            SpaceChoice::Targets => moved(context, targets)?,
            SpaceChoice::Muscles => (beside_control(ActionTarget::AllMuscles), Vec::new()),
            SpaceChoice::Synergies => (beside_control(families(context)?), Vec::new()),
        };
        let mut controls = Controls::new(context, space);
        controls.reset(context).map_err(|error| error.to_string())?;
        let size = controls.space().size(context.body.muscles.len());
        // Joints come first; what follows them has its whole range.
        let shares: Vec<f64> = shares.into_iter().chain(iter::repeat(1.0)).take(size).collect();
        Ok(Self::Other(Box::new(Moved { controls, entries: vec![0.0; size], shares })))
    }

    /// The space of the task's demonstration, where settings leave open whether it is followed, and it may lead to success: the task follows
    /// no motion, and the demonstration decides nothing of what is drawn. One that does reaches for a place where nothing is in most episodes.
    ///
    /// # Errors
    /// As with [`new`](Self::new).
    pub fn demonstrated(context: &PolicyContext<'_>, choice: SpaceChoice, targets: &Targets) -> Result<Option<Self>, String> {
        let follows_none = context.task.followed(context.progress).is_none();
        let fits = leaves_open(context, choice, targets) && follows_none;
        if !fits || demonstrated(context).is_none_or(|take| !take.given.is_empty()) {
            return Ok(None);
        }
        Self::new(context, choice, &Targets { along: Along::Demonstration, ..targets.clone() }).map(Some)
    }

    /// The same space, which goes on with the demonstration from that time of it, s.
    #[must_use]
    pub fn gone_on_from(mut self, start: f64) -> Self {
        if let Self::Other(moved) = &mut self {
            moved.controls.go_on_from(start);
        }
        self
    }

    /// How long the task's demonstration takes, s; 0 without one.
    pub fn demonstration_length(context: &PolicyContext<'_>) -> f64 {
        let last = demonstrated(context).and_then(|take| take.script.last());
        last.map_or(0.0, |keyframe| f64::from(keyframe.step) / context.task.control_frequency)
    }

    /// The space of a gait, where settings leave open what is followed, and the body can walk.
    pub fn walking(context: &PolicyContext<'_>, choice: SpaceChoice, targets: &Targets) -> Option<Self> {
        // A body that cannot walk says so when the gait is reset.
        let walking = || Self::new(context, choice, &Targets { along: Along::Gait, ..targets.clone() }).ok();
        leaves_open(context, choice, targets).then(walking).flatten()
    }

    /// Which entries of a plan say how fast a gait goes: forward, left, turn. Empty where there is none.
    pub fn pace(&self) -> Range<usize> {
        match &self.action_space().target {
            // They come before that of the demonstration and the two of priorities.
            ActionTarget::MuscleControl(offsets) if offsets.walks() => {
                let priorities = if offsets.priorities > 0.0 { 2 } else { 0 };
                let end = offsets.size() - priorities - usize::from(offsets.changes_over_to().is_some());
                end - 3..end
            }
            _ => 0..0,
        }
    }

    /// That of the entries.
    fn action_space(&self) -> &ActionSpace {
        match self {
            Self::Task(space) => space,
            Self::Other(moved) => moved.controls.space(),
        }
    }

    /// Those of them that lead off the way straight ahead: left, turn.
    pub fn astray(&self) -> Range<usize> {
        let pace = self.pace();
        (pace.start + 1).min(pace.end)..pace.end
    }

    /// Whether entries of a plan say how a gait goes.
    pub fn walks(&self) -> bool {
        !self.pace().is_empty()
    }

    /// For how many control steps muscles keep in imagination what was asked of them, where settings say so many. Of a pose it is two at least: what is
    /// imagined a little worse than it will be leaves a margin. A gait sees its feet late then.
    pub fn hold(&self, steps: u32) -> u32 {
        if self.walks() { steps } else { steps.max(2) }
    }

    /// Whether entries of a plan move hands.
    pub fn reaches(&self) -> bool {
        matches!(&self.action_space().target, ActionTarget::MuscleControl(offsets) if !offsets.hands.is_empty())
    }

    /// Which entries the actions have that it gives to the episode.
    pub fn acts_on(&self) -> ActsOn {
        match self {
            Self::Task(_) => ActsOn::Task,
            Self::Other(_) => ActsOn::Muscles,
        }
    }

    /// Makes it quick, for imagined episodes.
    pub fn make_rough(&mut self) {
        if let Self::Other(moved) = self {
            moved.controls.make_rough();
        }
    }

    /// Entries of a plan.
    pub fn size(&self, context: &PolicyContext<'_>) -> usize {
        match self {
            Self::Task(_) => context.action_size(),
            Self::Other(moved) => moved.shares.len(),
        }
    }

    /// The entry that asks for nothing.
    pub fn rest(&self) -> f64 {
        self.action_space().rest()
    }

    /// Takes the entries of a plan: those of the task's own space are the action; for others it gives the controls that have to act, and
    /// their entries.
    pub fn take(&mut self, entries: &[f64], action: &mut [f64]) -> Option<(&mut Controls, &[f64])> {
        match self {
            Self::Task(_) => {
                action.copy_from_slice(entries);
                None
            }
            Self::Other(moved) => {
                let Moved { controls, shares, entries: shared, .. } = moved.as_mut();
                shared.iter_mut().zip(shares).zip(entries).for_each(|((shared, share), entry)| *shared = *share * entry);
                Some((controls, shared))
            }
        }
    }
}

/// Whether plans move targets, of whatever serves them best.
fn leaves_open(context: &PolicyContext<'_>, choice: SpaceChoice, targets: &Targets) -> bool {
    let moves_targets = match choice {
        SpaceChoice::Auto => context.task.action.is_default(),
        SpaceChoice::Targets => true,
        SpaceChoice::Task | SpaceChoice::Muscles | SpaceChoice::Synergies => false,
    };
    moves_targets && targets.along == Along::Auto
}

/// The targets of computed muscle control, and by which share of the range each joint is moved.
fn moved(context: &PolicyContext<'_>, targets: &Targets) -> Result<(ActionSpace, Vec<f64>), String> {
    let range = targets.joint_range.at_least(targets.arm_range);
    let walks = targets.along == Along::Gait;
    let joints = if range > 0.0 { joints(context.body, &targets.joints, walks)? } else { Vec::new() };
    let arms: Vec<usize> = ARMS.iter().filter_map(|name| group(context.body, name)).flatten().collect();
    let own_range = |joint: &usize| if arms.contains(joint) { targets.arm_range } else { targets.joint_range };
    let shares = joints.iter().map(|joint| own_range(joint) / range).collect();
    let moved = |range: f64| if context.body.root.free.is_some() && !walks { range } else { 0.0 };
    let offsets = TrackingOffsets {
        joints,
        range,
        center_of_mass: moved(targets.center_of_mass),
        root: moved(targets.root),
        priorities: moved(libm::log(targets.priority_factor)),
        hands: if targets.reach > 0.0 { measured_hands(context) } else { Vec::new() },
        reach: targets.reach,
        along: followed(context, targets),
    };
    if offsets.size() == 0 {
        return Err("no target is left to be moved: name joints of the body in `targets.joints`".to_owned());
    }
    Ok((ActionSpace { target: ActionTarget::MuscleControl(offsets), ..ActionSpace::default() }, shares))
}

/// What has the targets that are moved: the reference or the pose where there is no demonstration.
fn followed(context: &PolicyContext<'_>, targets: &Targets) -> action::Along {
    match targets.along {
        Along::Gait => action::Along::Gait { speed: 0.0, pace: targets.pace, then: None },
        Along::Demonstration if demonstrated(context).is_some() => action::Along::Demonstration,
        _ => action::Along::Reference,
    }
}

/// The hands of which the task measures where they are, or what they touch: others have nothing to reach for.
fn measured_hands(context: &PolicyContext<'_>) -> Vec<usize> {
    let measures = |sensor: Sensor, hand: usize| match sensor.subject() {
        Subject::Landmark(landmark) => landmark == hand,
        Subject::Parts(one, other) => [one, other].contains(&Part::Landmark(hand)),
        _ => false,
    };
    let measured = |hand: &&usize| context.task.frame.entries().iter().any(|(sensor, _)| measures(*sensor, **hand));
    context.body.hands().iter().filter(measured).copied().collect()
}

/// The episode of the test that demonstrates the task.
fn demonstrated<'a>(context: &PolicyContext<'a>) -> Option<&'a Take> {
    context.task.tests.as_ref()?.demonstrated()
}

/// The independent hinges that names of joints and of groups stand for, in the body's order; without names those of the usual groups; of a body
/// without any of these that does not walk, all that it has.
fn joints(body: &Body, names: &[String], walks: bool) -> Result<Vec<usize>, String> {
    let is_hinge = |index: &usize| {
        let joint = &body.joints[*index];
        joint.independent && !joint.of_scene && joint.kind == msk_physics::model::JointKind::Hinge
    };
    let hinges = || (0..body.joints.len()).filter(is_hinge);
    if names.is_empty() {
        // What moves the legs or the arms of a gait disturbs it: they are moved only where they are named.
        let usual = if walks { &USUAL_OF_GAITS[..] } else { &USUAL[..] };
        let usual: Vec<usize> = usual.iter().filter_map(|name| group(body, name)).flatten().collect();
        let found: Vec<usize> = hinges().filter(|index| usual.contains(index)).collect();
        return Ok(if found.is_empty() && !walks { hinges().collect() } else { found });
    }
    let mut chosen = Vec::new();
    for name in names {
        match (group(body, name), body.joints.iter().position(|joint| joint.name == *name)) {
            (Some(members), _) => chosen.extend(members),
            (None, Some(joint)) => chosen.push(joint),
            (None, None) => {
                let known: Vec<&str> =
                    body.groups.iter().filter(|group| of_joints(group)).map(|group| group.name.as_str()).collect();
                let (name, body, known) = (name, &body.name, known.join(", "));
                return Err(format!("the body `{body}` has no joint or group of joints `{name}`; its groups are {known}"));
            }
        }
    }
    Ok(hinges().filter(|index| chosen.contains(index)).collect())
}

/// Groups of joints that move without the body's weight on them.
const ARMS: [&str; 2] = ["shoulders", "elbows"];

/// What decides how a body with legs and arms stands and moves; fingers and wrists follow.
const USUAL: [&str; 4] = ["legs", "lumbar", "shoulders", "elbows"];

/// What a body bends while it walks.
const USUAL_OF_GAITS: [&str; 1] = ["lumbar"];

fn of_joints(group: &Group) -> bool {
    group.kind == GroupKind::Joints
}

fn group<'a>(body: &'a Body, name: &str) -> Option<impl Iterator<Item = usize> + use<'a>> {
    let group = body.groups.iter().find(|group| of_joints(group) && group.name == name)?;
    Some(group.members.iter().copied())
}

/// An action space whose actions are added to those of computed muscle control, so that plans begin with a body that stands.
fn beside_control(target: ActionTarget) -> ActionSpace {
    ActionSpace { target, residual: Some(BaseController::MuscleControl), ..ActionSpace::default() }
}

/// The recruitment families of the body's muscles as synergies, those of each side apart, in the order of their first muscles; muscles
/// of no family are in none.
fn families(context: &PolicyContext<'_>) -> Result<ActionTarget, String> {
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut synergies: Vec<Synergy> = Vec::new();
    for (index, muscle) in context.body.muscles.iter().enumerate().filter(|(_, muscle)| !muscle.family.is_empty()) {
        let side = ["_l", "_r"].into_iter().find(|side| muscle.name.ends_with(side)).unwrap_or_default();
        let name = format!("{}{side}", muscle.family);
        let place = *places.entry(name.clone()).or_insert(synergies.len());
        if place == synergies.len() {
            synergies.push(Synergy { name, muscles: Vec::new() });
        }
        synergies[place].muscles.push(index);
    }
    match synergies.is_empty() {
        true => Err("the body has no recruitment families: plan in `muscles`, or in the task's own `act` block".to_owned()),
        false => Ok(ActionTarget::Synergies(synergies)),
    }
}
