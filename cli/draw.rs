//! `msk draw`: a picture of a body, or of the initial state of a task.

use crate::error::{Context, Error};
use crate::numbers::within;
use crate::output;
use crate::physics::read_state;
use crate::project::Project;
use crate::terminal;
use msk::compiler::body::BodyDescription;
use msk::compiler::compile;
use msk::compiler::numbers::for_people;
use msk::compiler::snapshot::names;
use msk::compiler::task::{CompiledTask, RootPlacement, Setting, TaskState};
use msk::draw::{Options, Sheet, View, svg};
use msk::physics::model::Model;
use msk::physics::{self, State, Workspace};
use msk::runtime::body::sensors::Snapshot;
use msk::runtime::episode::{Ending, EpisodeKey};
use msk::runtime::library::{BodyLibrary, FileLoader};
use msk::runtime::{bodies, body::Body};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Draw a body, or the initial state of a task, as SVG: scene, shapes, bones, muscles by activation, contact forces
#[derive(clap::Args)]
pub struct Args {
    /// Name of a body (bodies/NAME.msk here or in a folder above, else built in), or a body file
    #[arg(long, default_value = "human")]
    body: String,
    /// Draw this pose of the body, standing on the ground
    #[arg(long, default_value = "neutral")]
    pose: String,
    /// Draw this state instead: JSON with qpos, qvel, act, ctrl
    #[arg(long, value_name = "FILE", conflicts_with = "pose")]
    state: Option<PathBuf>,
    /// Draw the initial state of this task, with its scene: the name of a task in tasks.msk, or a file with one task
    #[arg(long, value_name = "TASK", conflicts_with_all = ["pose", "state", "body", "model", "activation"])]
    task: Option<String>,
    /// Seed of the initial state of a task
    #[arg(long, default_value_t = 0, requires = "task")]
    seed: u64,
    /// Draw this many initial states of a task beside each other, with the numbers that are drawn for each
    #[arg(long, value_name = "COUNT", default_value_t = 1, requires = "task", value_parser = clap::value_parser!(u64).range(1..=24))]
    draws: u64,
    /// Omit muscles and bones
    #[arg(long)]
    plain: bool,
    /// Use this model instead of the body file's, for example a scene with the body in it
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Activation of all muscles, 0 to 1, if no state is given
    #[arg(long, value_name = "LEVEL", default_value_t = 0.0, value_parser = within(0.0, 1.0), conflicts_with = "state")]
    activation: f64,
    /// Viewpoint
    #[arg(long, value_enum, default_value_t = Views::Both)]
    view: Views,
    /// Line above the picture instead of the names of body and pose
    #[arg(long)]
    caption: Option<String>,
    /// The file to write; without it, standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Views {
    /// From the body's right
    Side,
    /// From in front
    Front,
    /// From behind
    Back,
    /// Both, side by side
    Both,
}

/// Draws.
///
/// # Errors
/// A body, pose, state or model that cannot be found, read or used, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    if let Some(task) = &args.task {
        let picture = initial_states(task, &args)?;
        return write(&args, &picture);
    }
    let library = BodyLibrary::default();
    let mut description = describe(&args.body, &library)?;
    if let Some(model) = &args.model {
        description.model = model.display().to_string();
    }
    let bound = library.bind(&description)?;
    let (body, model) = (&*bound.body, &*bound.model);
    let state = match &args.state {
        Some(path) => read_state(path)?.state(model)?,
        None => posed(body, model, &args.pose, args.activation)?,
    };
    let mut workspace = Workspace::new(model);
    physics::forward(model, &state, &mut workspace)?;
    let snapshot = Snapshot { body, model, state: &state, workspace: &workspace };
    let named = || match &args.state {
        Some(path) => format!("{}, {}", body.name, path.file_stem().unwrap_or_default().display()),
        None => format!("{}, {}", body.name, args.pose.replace('_', " ")),
    };
    let caption = args.caption.clone().unwrap_or_else(named);
    let options = Options { views: args.view.list(), caption, anatomy: !args.plain, ..Options::default() };
    write(&args, &svg(&snapshot, &options))
}

fn write(args: &Args, picture: &str) -> Result<ExitCode, Error> {
    match &args.out {
        Some(path) => output::write(path, picture)?,
        None => terminal::bytes().write_all(picture.as_bytes())?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The initial states of the first episodes of a task.
fn initial_states(task: &str, args: &Args) -> Result<String, Error> {
    let (_, trial) = Project::find(task, &[])?;
    let mut episode = trial.episode()?;
    let caption = args.caption.clone().unwrap_or_else(|| format!("{} begins", trial.task.name.replace('_', " ")));
    let options = Options { views: args.view.list(), caption, anatomy: !args.plain, ..Options::default() };
    let mut sheet = Sheet::new(options);
    for number in 0..args.draws {
        episode.reset(EpisodeKey { seed: args.seed, episode: number });
        if let Some(Ending::Fault(fault)) = episode.ending() {
            return Err(Error::new(format!("the task `{task}` cannot be reset: {fault}")));
        }
        let context = episode.context();
        let drawn = if args.draws > 1 { drawn(context.task, context.progress) } else { Vec::new() };
        sheet.add(&context.snapshot(), episode.markers(), &drawn);
    }
    Ok(sheet.svg())
}

/// The numbers of body and scene that an episode has drawn, as lines of text.
fn drawn(task: &CompiledTask, progress: &TaskState) -> Vec<String> {
    let line = |&(setting, place): &(Setting, usize)| {
        let (unit, value) = (setting.unit(&task.vocabulary)?, task.drawn(place, progress));
        let value = if unit == "deg" { value.to_degrees() } else { value };
        Some(format!("{} {} {unit}", names::setting(task, setting), for_people(value)).trim_end().to_owned())
    };
    task.init.drawn.iter().filter_map(line).collect()
}

impl Views {
    fn list(self) -> Vec<View> {
        match self {
            Self::Side => vec![View::Side],
            Self::Front => vec![View::Front],
            Self::Back => vec![View::Back],
            Self::Both => vec![View::Side, View::Front],
        }
    }
}

/// The body in a pose on the ground, all muscles equally active.
fn posed(body: &Body, model: &Model, pose: &str, activation: f64) -> Result<State<f64>, Error> {
    let Some(coordinates) = body.pose(pose) else {
        let known: Vec<&str> = body.poses.iter().map(|pose| pose.name.as_str()).collect();
        let message = format!("the body `{}` has no pose `{pose}`", body.name);
        return Err(Error::new(message).hint(format!("it has: {}", known.join(", "))));
    };
    let mut state = State::new(model);
    body.place(model, &RootPlacement::default(), coordinates, &mut state, &mut Workspace::new(model));
    state.activation.fill(activation);
    Ok(state)
}

/// The body of that name, or the one in a body file.
///
/// # Errors
/// No such body, errors in its file, or a file that holds several.
pub fn describe(name: &str, library: &BodyLibrary) -> Result<BodyDescription, Error> {
    let path = find(name)?;
    let compilation = compile(&path, &FileLoader, library).map_err(|report| Error::rendered(&report))?;
    match compilation.bodies.as_slice() {
        [body] => Ok((**body).clone()),
        bodies => Err(Error::new(format!("{} contains {} bodies, not one", path.display(), bodies.len()))),
    }
}

/// The file of a body: `name` itself, `bodies/NAME.msk` here or above, or the built-in one.
fn find(name: &str) -> Result<PathBuf, Error> {
    if name.ends_with(".msk") {
        return Ok(PathBuf::from(name));
    }
    let file = Path::new("bodies").join(format!("{name}.msk"));
    let here = std::env::current_dir().context(|| "cannot determine the current folder".into())?;
    let own = here.ancestors().map(|folder| folder.join(&file)).find(|path| path.exists());
    own.or_else(|| bodies::builtin(name).map(|body| body.path)).ok_or_else(|| {
        let known: Vec<&str> = bodies::names().collect();
        Error::new(format!("there is no body `{name}`")).hint(format!("built in: {}", known.join(", ")))
    })
}
