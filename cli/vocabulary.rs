//! `msk vocabulary`: everything that a task may name.

use crate::error::{Context, Error};
use crate::terminal;
use msk::compiler::check::scene::elements;
use msk::compiler::compile;
use msk::compiler::numbers::fixed;
use msk::compiler::signals;
use msk::compiler::vocabulary::{GroupKind, Vocabulary};
use msk::runtime::bodies;
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// List what tasks may name: signals, elements of scenes, and the landmarks, joints, muscles, groups and poses of a body
#[derive(clap::Args)]
pub struct Args {
    /// Name of a body, or its file
    #[arg(long, default_value = "human")]
    body: String,
    /// For agents and editors
    #[arg(long)]
    json: bool,
}

/// Prints the vocabulary.
///
/// # Errors
/// An unknown body, or one that does not fit its model.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let vocabulary = vocabulary(&args.body)?;
    let mut out = terminal::out();
    if args.json {
        let scene = serde_json::json!({ "elements": elements::KINDS, "joints": elements::JOINTS, "fields": elements::FIELDS });
        let all = serde_json::json!({ "signals": signals::SIGNALS, "scene": scene, "body": vocabulary });
        serde_json::to_writer_pretty(&mut out, &all)?;
        writeln!(out)?;
    } else {
        write!(out, "{}\n{}\n{}", signals::table(), elements::table(), parts(&vocabulary))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Of the body file `name`, of `bodies/NAME.msk` here, or of the built-in body.
fn vocabulary(name: &str) -> Result<Vocabulary, Error> {
    let here = PathBuf::from(if name.ends_with(".msk") { name.into() } else { format!("bodies/{name}.msk") });
    let path = match bodies::builtin(name) {
        Some(file) if !here.exists() => file.path,
        _ => here,
    };
    let library = BodyLibrary::default();
    let compilation = compile(&path, &FileLoader, &library).map_err(|report| Error::rendered(&report))?;
    let description = compilation.bodies.first().ok_or_else(|| Error::new(format!("`{}` contains no body", path.display())))?;
    let bound = library.bind(description).context(|| format!("cannot use `{}`", path.display()))?;
    Ok(bound.body.vocabulary(&bound.model))
}

/// The names on a body, kind by kind.
fn parts(vocabulary: &Vocabulary) -> String {
    let mut text = format!("Body `{}`, {} kg\n", vocabulary.body, fixed(vocabulary.mass, 2));
    text += "\nLandmarks\n";
    for landmark in &vocabulary.landmarks {
        text += &format!("    {:<26} {} m  {}\n", landmark.name, fixed(landmark.neutral_position[2], 3), landmark.description);
    }
    let joints = vocabulary.joints.iter().map(|joint| joint.name.as_str());
    text += &paragraph("Joints", joints);
    for (kind, title) in [
        (GroupKind::Landmarks, "Groups of landmarks"),
        (GroupKind::Joints, "Groups of joints"),
        (GroupKind::Muscles, "Groups and families of muscles"),
    ] {
        let groups = vocabulary.groups.iter().filter(|group| group.kind == kind);
        let counted: Vec<String> = groups.map(|group| format!("{} ({})", group.name, group.members.len())).collect();
        text += &paragraph(title, counted.iter().map(String::as_str));
    }
    text += &paragraph("Poses", vocabulary.poses.iter().map(|pose| pose.name.as_str()));
    let muscles = vocabulary.muscles.iter().map(|muscle| muscle.name.as_str());
    text += &paragraph("Muscles", muscles);
    text
}

/// Words in lines of at most 100 columns.
fn paragraph<'a>(title: &str, words: impl Iterator<Item = &'a str>) -> String {
    let mut text = format!("\n{title}");
    let mut column = 100;
    for word in words {
        if column + word.len() + 2 > 100 {
            text += "\n    ";
            column = 4;
        }
        text += word;
        text += "  ";
        column += word.len() + 2;
    }
    text.lines().map(|line| format!("{}\n", line.trim_end())).collect()
}
