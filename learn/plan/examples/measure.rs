//! Plays one episode under a planner and prints what came of it, for measurements:
//!
//! ```text
//! cargo run --release -p msk-plan --example measure -- FILE TASK [SETTINGS | POLICY] [SEED] [STEPS]
//! ```
//!
//! SETTINGS is what follows `plan` on the command line of `msk`: a preset, or a file. POLICY is a built-in one, such as `cmc` or `"gait 0.9"`.

use msk_compiler::compile;
use msk_runtime::episode::{Environment, EpisodeKey};
use msk_runtime::library::{BodyLibrary, FileLoader};
use msk_runtime::policy::PolicySource;
use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, name, more @ ..] = arguments.as_slice() else { return Err("expected FILE TASK [SETTINGS] [SEED] [STEPS]".into()) };
    let [settings, seed, steps] = [0, 1, 2].map(|place| more.get(place).map(String::as_str));
    let bodies = BodyLibrary::default();
    let compilation = compile(Path::new(file), &FileLoader, &bodies).map_err(|report| report.to_string())?;
    let task = compilation.tasks.iter().find(|task| task.name == *name).ok_or("no such task")?.clone();
    let stage = bodies.stage(&task.body, &task.scene)?;
    let mut environment = Environment::new(stage.model, stage.body, task.clone())?;
    let settings = settings.unwrap_or("fast");
    let source = match PolicySource::built_in(settings) {
        Ok(built_in) => built_in,
        Err(_) => msk_plan::source(&format!("plan {settings}")).ok_or("no planner")??,
    };
    let never = AtomicBool::new(false);
    let mut policy = source.open(&never)?;
    let most = steps.map_or(Ok(task.horizon), str::parse)?;
    environment.reset(EpisodeKey { seed: seed.map_or(Ok(0), str::parse)?, episode: 0 });
    policy.reset(&environment.context())?;
    let mut action = environment.engine().action(policy.acts_on());
    let start = Instant::now();
    while environment.ending().is_none() && environment.steps() < most {
        policy.act(&environment.context(), &mut action.entries)?;
        environment.step(&action)?;
    }
    let time = f64::from(environment.steps()) * environment.control_period();
    let ending = environment.ending().map_or("goes on".to_owned(), |ending| match ending.conditions(&task) {
        none if none.is_empty() => format!("{ending:?}"),
        conditions => conditions,
    });
    let total = environment.episode().total();
    println!(
        "{name} {}: {time:.2} s, {ending}, success {}, return {total:.0}, {:.2} per step, {:.1} s of clock time per second",
        source.name(),
        environment.success(),
        total / f64::from(environment.steps()),
        start.elapsed().as_secs_f64() / time,
    );
    Ok(())
}
