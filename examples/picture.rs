//! A picture of a body in the middle of a task: plays the posture policy for a while and draws where it got to.
//! Try it: cargo run --release --example picture -- examples/crouch.msk 2.0 crouch.svg

use msk::compiler::compile;
use msk::compiler::diagnostics::Style;
use msk::draw::{Options, svg};
use msk::runtime::body::sensors::Snapshot;
use msk::runtime::episode::{Environment, EpisodeKey};
use msk::runtime::library::{BodyLibrary, FileLoader};
use msk::runtime::policy;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, seconds, out] = arguments.as_slice() else { return Err("usage: picture TASK.msk SECONDS OUT.svg".into()) };
    let seconds: f64 = seconds.parse()?;

    // From text to a task, and from the body's name to a body.
    let library = BodyLibrary::default();
    let compilation = compile(Path::new(file), &FileLoader, &library).map_err(|report| report.render(Style::Plain))?;
    let task = compilation.tasks.first().ok_or("the file holds no task")?;
    let bound = library.stage(&task.body, &task.scene)?;

    // One episode under computed muscle control, until the time has come or the episode has ended.
    let mut episode = Environment::new(bound.model.clone(), bound.body.clone(), task.clone())?;
    let mut policy = policy::create("posture")?;
    episode.reset(EpisodeKey { seed: 1, episode: 0 });
    policy.reset(&episode.context())?;
    let mut action = episode.engine().action(policy.acts_on());
    while episode.ending().is_none() && f64::from(episode.steps()) * episode.control_period() < seconds {
        policy.act(&episode.context(), &mut action.entries)?;
        episode.step(&action)?;
    }

    let context = episode.context();
    let (body, model, state, workspace) = (context.body, context.model, context.state, context.workspace);
    let time = f64::from(episode.steps()) * episode.control_period();
    let caption = format!("{}, {time:.2} s", task.name);
    let picture = svg(&Snapshot { body, model, state, workspace }, &Options { caption, ..Options::default() });
    std::fs::write(out, picture)?;
    Ok(())
}
