//! `msk physics rollout`: a trajectory under given excitations.

use super::Start;
use crate::error::{Context, Error};
use crate::output;
use msk::evaluate::npz::NpzWriter;
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace};
use msk_runtime::inspect::Excitations;
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Advance the physics under given excitations and write the trajectory
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    start: Start,
    /// Excitations as a NumPy array of doubles, one row per step, one column per muscle
    #[arg(long, value_name = "FILE.npy")]
    ctrl: PathBuf,
    /// Number of physics steps; without it, one per row of the excitations
    #[arg(long, value_name = "N")]
    steps: Option<usize>,
    /// The file to write: qpos, qvel and act after each step, and time
    #[arg(long, value_name = "FILE.npz")]
    out: PathBuf,
}

/// The most numbers that a trajectory may hold: 8 GiB.
const MOST_NUMBERS: usize = 1 << 30;

/// The largest file of excitations that is read, bytes.
const LARGEST: u64 = 4 << 30;

/// Runs the subcommand.
///
/// # Errors
/// A model, state or array that cannot be read or does not fit, or a step that fails: the steps before it are written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (model, mut state) = args.start.load()?;
    let controls = read(&args.ctrl, model.actuators.name.len())?;
    let rows = controls.rows();
    let steps = args.steps.unwrap_or(rows);
    if steps == 0 {
        let error = Error::new(format!("there is no step to take: {} has {rows} rows", args.ctrl.display()));
        return Err(error.hint("give a row of excitations per step, and at least one with --steps"));
    }
    if steps > rows {
        return Err(Error::new(format!("{} has {rows} rows; {steps} steps need one each", args.ctrl.display())));
    }
    let width = 1 + model.nq + model.nv + model.na;
    if steps.saturating_mul(width) > MOST_NUMBERS {
        return Err(Error::new(format!("{steps} steps are too many: at most {} fit into memory", MOST_NUMBERS / width)));
    }
    let mut trajectory = Trajectory::default();
    let outcome = trajectory.record(&model, &mut state, &controls, steps);
    let mut archive = io::Cursor::new(Vec::new());
    trajectory.write(&model, &mut archive).context(|| format!("cannot write `{}`", args.out.display()))?;
    output::write(&args.out, archive.into_inner())?;
    outcome?;
    Ok(ExitCode::SUCCESS)
}

/// Excitations of all steps.
fn read(path: &Path, muscles: usize) -> Result<Excitations, Error> {
    let bytes = msk_storage::read_file(path, LARGEST)?;
    Excitations::from_npy(&bytes, muscles).map_err(|error| Error::new(format!("{} {error}", path.display())))
}

/// What is recorded after each step.
#[derive(Default)]
struct Trajectory {
    time: Vec<f64>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    activation: Vec<f64>,
}

impl Trajectory {
    fn record(&mut self, model: &Model, state: &mut State<f64>, controls: &Excitations, steps: usize) -> Result<(), Error> {
        let mut workspace = Workspace::new(model);
        for step in 0..steps {
            state.control.copy_from_slice(controls.row(step));
            physics::step(model, state, &mut workspace)?;
            self.time.push(state.time);
            self.position.extend(&state.position);
            self.velocity.extend(&state.velocity);
            self.activation.extend(&state.activation);
        }
        Ok(())
    }

    fn write(&self, model: &Model, out: impl Write + Seek) -> io::Result<()> {
        let steps = self.time.len();
        let mut archive = NpzWriter::new(out);
        archive.array("time", &self.time, &[steps])?;
        archive.array("qpos", &self.position, &[steps, model.nq])?;
        archive.array("qvel", &self.velocity, &[steps, model.nv])?;
        archive.array("act", &self.activation, &[steps, model.na])?;
        archive.finish().map(drop)
    }
}
