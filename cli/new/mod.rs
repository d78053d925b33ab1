//! `msk new task NAME`, `msk new body NAME --model FILE`: a file to begin with.

mod scaffold;

use crate::error::{Context, Error};
use crate::project;
use crate::terminal;
use msk::compiler::compile;
use msk::compiler::diagnostics::{FileId, Report};
use msk::compiler::files::{LoadError, Loader};
use msk::compiler::format::format;
use msk::compiler::syntax::{self, tree::Item};
use msk::compiler::task::CompiledTask;
use msk::runtime::bodies;
use msk::runtime::library::{BodyLibrary, FileLoader};
use scaffold::scaffold;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Create a task file or a body file
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Task(TaskArgs),
    Body(BodyArgs),
}

/// A task with a comment in every section, which compiles and runs
#[derive(clap::Args)]
struct TaskArgs {
    /// Name of the task: small letters, digits and underscores
    name: String,
    /// Family it belongs to
    #[arg(long, default_value = "stabilization", conflicts_with = "from")]
    family: String,
    /// Extend this task instead of starting from scratch: a task of tasks.msk, or FILE@TASK
    #[arg(long, value_name = "TASK")]
    from: Option<String>,
    /// The file to write, which must not exist; otherwise NAME.msk
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// A body file for a model in MJCF: its root, a landmark on every part with shapes, a neutral pose
#[derive(clap::Args)]
struct BodyArgs {
    /// Name of the body: small letters, digits and underscores
    name: String,
    /// The model
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// The file to write, which must not exist; otherwise bodies/NAME.msk, where tasks look for it
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the file.
///
/// # Errors
/// A name that no task or body can have, a task or model to start from that cannot be read, or a file that exists already.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    match args.command {
        Command::Task(args) => new_task(&args),
        Command::Body(args) => new_body(&args),
    }
}

fn new_body(args: &BodyArgs) -> Result<ExitCode, Error> {
    must_be_a_name("body", &args.name)?;
    let path = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("bodies/{}.msk", args.name)));
    let cannot = || format!("the model `{}` cannot be read", args.model.display());
    let model = bodies::model(&args.model).context(cannot)?;
    let text = scaffold(&args.name, &model, &relative(&args.model, &path)).context(cannot)?;
    // Laid out as `msk fmt` does; what cannot be is reported by the compiler below.
    let text = format(FileId::default(), &text).unwrap_or(text);
    write(&path, &text, &[("check", "check against its model"), ("vocabulary --body", "names for tasks")])
}

fn new_task(args: &TaskArgs) -> Result<ExitCode, Error> {
    must_be_a_name("task", &args.name)?;
    must_be_a_name("family", &args.family)?;
    let path = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.msk", args.name)));
    let text = match &args.from {
        Some(from) => extension(&args.name, from, &path)?,
        None => include_str!("task.msk").replace("NAME", &args.name).replace("FAMILY", &args.family),
    };
    write(&path, &text, &[("check", "check"), ("explain", "explain"), ("run", "one episode")])
}

/// Writes a text that compiles to a new file, and prints the next commands.
fn write(path: &Path, text: &str, next: &[(&str, &str)]) -> Result<ExitCode, Error> {
    // A word of the language is no name either: the compiler knows which.
    if let Err(report) = compile(path, &Pending { path, text }, &BodyLibrary::default()) {
        return Err(Error::rendered_then(&report, "nothing was written, since it would not compile"));
    }
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).context(|| format!("cannot create the folder `{}`", folder.display()))?;
    }
    let cannot = || format!("`{}` cannot be written; existing files are never replaced", path.display());
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).context(cannot)?;
    file.write_all(text.as_bytes()).context(cannot)?;
    let mut out = terminal::out();
    writeln!(out, "Created {}. Next:", path.display())?;
    for (command, purpose) in next {
        writeln!(out, "  msk {command:<8} {:<24} {purpose}", path.display())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn must_be_a_name(what: &str, name: &str) -> Result<(), Error> {
    let fits =
        |(index, letter): (usize, char)| letter == '_' || letter.is_ascii_lowercase() || (index > 0 && letter.is_ascii_digit());
    if !name.is_empty() && name.chars().enumerate().all(fits) {
        return Ok(());
    }
    let message = format!("`{name}` is not a name for a {what}");
    Err(Error::usage(message)
        .hint("names consist of lower-case letters, digits and underscores and begin with a letter: `carry_box`"))
}

/// A task that changes another one.
fn extension(name: &str, from: &str, path: &Path) -> Result<String, Error> {
    let tasks = project::compiled(from, &[])?;
    let [task] = tasks.as_slice() else {
        let names: Vec<&str> = tasks.iter().map(|task| task.name.as_str()).collect();
        let message = format!("`{from}` contains {} tasks: {}", names.len(), names.join(", "));
        return Err(Error::usage(message).hint(format!("select one of them: {from}@{}", names[0])));
    };
    let home = home(from, task)?;
    let used = relative(&home, path);
    let template = include_str!("extension.msk").replace("NAME", name).replace("FILE", &used).replace("TASK", &task.name);
    let first = task.terms.first().map_or_else(String::new, |term| format!("{} {}", term.weight, term.name));
    Ok(template.replace("FIRST", &first).replace("FAMILY", &task.family))
}

/// The file in which a task stands.
fn home(named: &str, task: &CompiledTask) -> Result<PathBuf, Error> {
    let (file, _) = project::named(named)?;
    let compilation = compile(file, &FileLoader, &BodyLibrary::default()).map_err(|report: Report| Error::rendered(&report))?;
    let sources = &compilation.sources;
    let holds = |item: &Item| matches!(item, Item::Task(known) if known.name.text == task.name);
    let found = sources.files().find(|&source| syntax::parse(source, sources.text(source)).tree.items.iter().any(holds));
    let found = found.map(|source| PathBuf::from(sources.path(source)));
    found.ok_or_else(|| Error::usage(format!("`{}` is a sequence; only a task can be extended", task.name)))
}

/// How a file is used from another one, with slashes on every system.
fn relative(target: &Path, from: &Path) -> String {
    let depth = from.parent().map_or(0, |folder| folder.components().count());
    let target = target.to_string_lossy().replace('\\', "/");
    if Path::new(&target).is_absolute() { target } else { format!("{}{target}", "../".repeat(depth)) }
}

/// A text that is not on the disk yet, among files that are.
struct Pending<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Loader for Pending<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if path == self.path { Ok(self.text.to_owned()) } else { FileLoader.load(path) }
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        FileLoader.load_bytes(path, limit)
    }
}
