//! Where the reference motion of a task has the body.

use crate::body::Body;
use crate::policy::PolicyContext;
use msk_physics::kinematics::{self, Kinematics};
use msk_physics::model::Model;
use msk_physics::{State, Workspace};
use msk_program::init::Parts;
use msk_program::motion::{Motion, RootPart};
use msk_program::task::Init;

/// The body that the reference places: its path begins where the root stood, as computed muscle control follows it.
pub struct Reference {
    state: State<f64>,
    workspace: Box<Workspace<f64>>,
    begun: Option<Course>,
}

/// What holds as long as a phase of a sequence lasts.
struct Course {
    phase: u32,
    parts: Parts,
    base: Init,
    /// From the table's root to where the root stood, m; nothing where the table has no such column.
    shift: [Option<f64>; 3],
}

const PLACES: [RootPart; 3] = [RootPart::X, RootPart::Y, RootPart::Height];

impl Reference {
    /// Of a model, before any step.
    pub fn new(model: &Model) -> Self {
        Self { state: State::new(model), workspace: Box::new(Workspace::new(model)), begun: None }
    }

    /// The coordinates of the reference at present; `None` if the present phase follows none.
    pub fn coordinates(&mut self, context: &PolicyContext<'_>) -> Option<&[f64]> {
        self.place(context)?;
        Some(&self.state.position)
    }

    /// Where the reference has the segments at present; `None` as there.
    pub fn kinematics(&mut self, context: &PolicyContext<'_>) -> Option<&Kinematics<f64>> {
        self.place(context)?;
        kinematics::update(context.model, &self.state, &mut self.workspace.kinematics);
        Some(&self.workspace.kinematics)
    }

    fn place(&mut self, context: &PolicyContext<'_>) -> Option<()> {
        let (followed, time) = context.task.followed(context.progress)?;
        let (motion, model, body) = (&*followed.motion, context.model, context.body);
        let stands = body.root.free.map_or([0.0; 3], |(place, _)| [0, 1, 2].map(|axis| context.state.position[place + axis]));
        let phase = context.progress.phase;
        if self.begun.as_ref().is_none_or(|course| course.phase != phase) {
            let base = context.task.initial_state(context.progress);
            self.begun = Some(Course::new(phase, motion, time, Init::clone(&base), body, stands));
        }
        let course = self.begun.as_ref()?;
        course.place(motion, time, stands, model, body, (&mut self.state, &mut self.workspace));
        Some(())
    }
}

impl Course {
    fn new(phase: u32, motion: &Motion, time: f64, mut base: Init, body: &Body, stands: [f64; 3]) -> Self {
        let joints = body.joints.iter().enumerate().filter(|(_, joint)| joint.independent);
        let parts = Parts {
            joints: joints.filter_map(|(index, joint)| Some((index, motion.joint(&joint.name)?))).collect(),
            root: RootPart::ALL.into_iter().filter(|part| motion.root(*part).is_some()).collect(),
            velocity: false,
        };
        base.root.meets.clear();
        let begins = PLACES.map(|part| motion.root(part).map(|column| motion.value(column, time)));
        Self { phase, parts, base, shift: std::array::from_fn(|axis| begins[axis].map(|begins| stands[axis] - begins)) }
    }

    fn place(
        &self,
        motion: &Motion,
        time: f64,
        stands: [f64; 3],
        model: &Model,
        body: &Body,
        (state, workspace): (&mut State<f64>, &mut Workspace<f64>),
    ) {
        let mut init = self.base.clone();
        self.parts.write(motion, time, &mut init);
        let value = |part: RootPart| motion.root(part).map_or(0.0, |column| motion.value(column, time));
        let at: [f64; 3] = std::array::from_fn(|axis| self.shift[axis].map_or(stands[axis], |shift| value(PLACES[axis]) + shift));
        init.root.position = [at[0], at[1]];
        init.root.height = Some(at[2]);
        body.place(model, &init.root, &init.coordinates, state, workspace);
    }
}
