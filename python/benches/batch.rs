//! Steps of the Rust vector environment, for `vector.py`, which takes the same steps through Python.
//!
//! Arguments: name of a task, number of environments, threads, steps. Prints the sum of all rewards.

use msk_compiler::compile;
use msk_runtime::episode::{AutoresetMode, Engine, VectorEnvironment};
use msk_runtime::library::{BodyLibrary, FileLoader};
use std::error::Error;
use std::num::NonZeroUsize;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let [task, count, threads, steps] = arguments.as_slice() else {
        // `cargo bench` calls it without arguments.
        return Ok(());
    };
    let suite = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tasks.msk");
    let bodies = BodyLibrary::default();
    let compilation = compile(&suite, &FileLoader, &bodies).map_err(|report| report.to_string())?;
    let task = compilation.tasks.iter().find(|known| known.name == *task).ok_or("no such task")?;
    let stage = bodies.stage(&task.body, &task.scene)?;
    let engine = Engine::new(stage.model, stage.body, task.clone())?;
    let (count, threads): (NonZeroUsize, NonZeroUsize) = (count.parse()?, threads.parse()?);
    let mut environment = VectorEnvironment::new(engine, count, threads)?.with_autoreset(AutoresetMode::SameStep).with_stride(1);
    let keys: Vec<_> = (0..count.get() as u64).map(|seed| Some(msk_runtime::episode::EpisodeKey { seed, episode: 0 })).collect();
    environment.reset_to(&keys);
    let actions = vec![-0.5; count.get() * environment.engine().action_size()];
    let mut rewards = 0.0;
    for _ in 0..steps.parse::<usize>()? {
        environment.step(&actions)?.rewards.iter().for_each(|reward| rewards += reward);
    }
    println!("{rewards:?}");
    Ok(())
}
