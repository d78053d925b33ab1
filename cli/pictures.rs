//! `--png`, `--strip`: moments of an episode as pictures.

use crate::error::Error;
use crate::named::by_name;
use crate::output;
use msk::compiler::numbers::{exact, fixed};
use msk::evaluate::Trial;
use msk::runtime::episode::{Ending, Environment};
use msk::view::render::{Colouring, LARGEST, Options, Picture, Renderer, Scene, Strip, Theme, View, film_strip};
use std::path::{Path, PathBuf};

/// Pictures of an episode
#[derive(clap::Args)]
#[command(next_help_heading = "Pictures")]
pub struct PictureArgs {
    /// Write a picture of the episode to this PNG file: the body with its muscles by activation, contact forces, the reference motion
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Time of the picture, such as 1.2 or "1.2 s" [default: the end]
    #[arg(long, value_name = "TIME", value_parser = seconds, requires = "png")]
    at: Option<f64>,
    /// Write moments at equal distances beside each other, with their times, to this PNG file
    #[arg(long, value_name = "FILE")]
    strip: Option<PathBuf>,
    /// Moments of a strip
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=64), requires = "strip")]
    frames: u16,
    /// Where the camera of pictures stands: three-quarter, front, right, back, left, above
    #[arg(long, value_name = "NAME", default_value = "three-quarter", value_parser = view)]
    view: View,
    /// Size of pictures in pixels; frames of a strip are as high, and narrow
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "960x720", value_parser = size)]
    size: [u32; 2],
    /// Colours of pictures: light, dark
    #[arg(long, value_name = "NAME", default_value = "light", value_parser = theme)]
    theme: Theme,
    /// What colours muscles in pictures: activation, excitation, force, fibre (length), capacity (strength that is left)
    #[arg(long, value_name = "NAME", default_value = "activation", value_parser = colouring)]
    colour: Colouring,
}

fn view(name: &str) -> Result<View, String> {
    by_name(name, &View::NAMED)
}

fn theme(name: &str) -> Result<Theme, String> {
    by_name(name, &Theme::NAMED)
}

fn colouring(name: &str) -> Result<Colouring, String> {
    by_name(name, &Colouring::NAMED)
}

/// Later than any episode lasts, s.
const LATEST: f64 = 1e9;

/// `1.2`, `1.2s`, `1.2 s`.
fn seconds(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('s').unwrap_or(text).trim_end();
    let value = number.parse().ok().filter(|value: &f64| (0.0..=LATEST).contains(value));
    value.ok_or_else(|| format!("`{text}` is no time: write a number of seconds, such as 1.2 or \"1.2 s\""))
}

/// `960x720`.
fn size(text: &str) -> Result<[u32; 2], String> {
    let parts = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    let fits = |size: &[u32; 2]| size.iter().all(|pixels| (1..=LARGEST).contains(pixels));
    parts.filter(fits).ok_or_else(|| format!("`{text}` is no size: write two numbers from 1 to {LARGEST}, such as 960x720"))
}

/// The pictures of an episode that are wanted.
pub struct Pictures<'a> {
    args: &'a PictureArgs,
    renderer: Option<Renderer>,
    moment: Option<Scene>,
    strip: Strip,
}

impl<'a> Pictures<'a> {
    /// For the next episode of an environment.
    ///
    /// # Errors
    /// A condition of the muscles that the body cannot have.
    pub fn of(args: &'a PictureArgs, episode: &Environment, trial: &Trial) -> Result<Self, Error> {
        let wanted = args.png.is_some() || args.strip.is_some();
        let strengths = trial.body.condition.strengths(&trial.body.body)?;
        let renderer = wanted.then(|| Renderer::new(episode, &strengths, args.colour));
        Ok(Self { args, renderer, moment: None, strip: Strip::default() })
    }

    /// Keeps what is wanted of the present step. A fault leaves nothing to look at.
    pub fn look(&mut self, episode: &Environment) {
        let Some(renderer) = self.renderer.as_mut().filter(|_| !matches!(episode.ending(), Some(Ending::Fault(_)))) else {
            return;
        };
        let time = f64::from(episode.steps()) * episode.control_period();
        // Half a step before: the nearest one.
        let before = |at: f64| time <= at + 0.5 * episode.control_period();
        if self.args.strip.is_some() {
            let scene = renderer.scene(episode);
            if self.args.png.is_some() && self.args.at.is_none_or(before) {
                self.moment = Some(scene.clone());
            }
            self.strip.look(scene);
        } else if self.args.at.is_none_or(before) {
            self.moment = Some(renderer.scene(episode));
        }
    }

    /// Writes the pictures.
    ///
    /// # Errors
    /// An episode without the moment that is asked for, or a file that cannot be written.
    pub fn write(&self, episode: &Environment) -> Result<(), Error> {
        let [width, height] = self.args.size;
        let options = Options { width, height, view: self.args.view, theme: self.args.theme, labels: true };
        let nothing = || Error::new("there is nothing to show: the episode ended with a fault at its reset");
        if let Some(path) = &self.args.png {
            let scene = self.moment.as_ref().ok_or_else(nothing)?;
            if let Some(at) = self.args.at.filter(|at| *at > scene.time + 0.5 * episode.control_period() + 1e-9) {
                let message =
                    format!("there is no picture at {} s: the episode ended after {} s", exact(at), fixed(scene.time, 2));
                return Err(Error::new(message).hint("choose an earlier time with --at, or leave it out for the end"));
            }
            save(path, &scene.render(&options)?)?;
        }
        if let Some(path) = &self.args.strip {
            let scenes = self.strip.scenes(self.args.frames.into());
            if scenes.is_empty() {
                return Err(nothing());
            }
            save(path, &film_strip(&scenes, &options)?)?;
        }
        Ok(())
    }
}

fn save(path: &Path, picture: &Picture) -> Result<(), Error> {
    output::write(path, picture.png()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_sizes_are_read() {
        assert_eq!([seconds("1.2"), seconds("1.2 s"), seconds("0s")].map(Result::ok), [Some(1.2), Some(1.2), Some(0.0)]);
        assert_eq!([seconds("-1"), seconds("nan"), seconds("inf s"), seconds("soon")].map(|time| time.is_err()), [true; 4]);
        assert_eq!(size("64x48").ok(), Some([64, 48]));
        assert_eq!(["64", "0x9", "9x99999", "axb", "1x2x3"].map(|text| size(text).is_err()), [true; 5]);
    }
}
