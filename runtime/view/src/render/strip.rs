//! Film strips: moments of an episode beside each other.

use super::label::{height, outlined};
use super::{Options, Picture, PictureError, Scene};
use msk_program::numbers::fixed;

/// Scenes that are kept at most until an episode has ended.
const KEPT: usize = 512;
/// Width of a frame over its height.
const ASPECT: f64 = 0.64;
/// Frames beside each other; more begin another row.
const COLUMNS: usize = 8;
/// Pixels between frames.
const GAP: u32 = 3;

/// Scenes of an episode whose length is not known before its end: at equal distances, which double whenever there are too many.
pub struct Strip {
    stride: usize,
    looked: usize,
    scenes: Vec<Scene>,
    last: Option<Scene>,
}

impl Default for Strip {
    fn default() -> Self {
        Self { stride: 1, looked: 0, scenes: Vec::new(), last: None }
    }
}

impl Strip {
    /// Keeps a scene, or leaves it out; the last one is always kept.
    pub fn look(&mut self, scene: Scene) {
        if self.looked.is_multiple_of(self.stride) {
            self.scenes.push(scene.clone());
        }
        if self.scenes.len() > KEPT {
            let mut index = 0;
            self.scenes.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.stride *= 2;
        }
        self.last = Some(scene);
        self.looked += 1;
    }

    /// The scenes closest to `frames` equal distances from the first to the last.
    pub fn scenes(&self, frames: usize) -> Vec<&Scene> {
        let Some(last) = &self.last else { return Vec::new() };
        let nearest = |time: f64| {
            let apart = |scene: &&Scene| (scene.time - time).abs();
            self.scenes.iter().chain([last]).min_by(|a, b| apart(a).total_cmp(&apart(b)))
        };
        let first = self.scenes.first().map_or(0.0, |scene| scene.time);
        let share = |frame: usize| if frames > 1 { frame as f64 / (frames - 1) as f64 } else { 0.0 };
        (0..frames).filter_map(|frame| nearest(first + share(frame) * (last.time - first))).collect()
    }
}

/// Scenes beside each other, each with its time. Frames are as high as the options say, and narrow.
///
/// # Errors
/// No scene, or a size that a picture cannot have.
pub fn film_strip(scenes: &[&Scene], options: &Options) -> Result<Picture, PictureError> {
    let frame = Options { width: ((f64::from(options.height) * ASPECT).round() as u32).max(1), labels: false, ..*options };
    if scenes.is_empty() {
        return Err(PictureError::Empty);
    }
    let [columns, rows] = [scenes.len().min(COLUMNS), scenes.len().div_ceil(COLUMNS)].map(|count| count as u32);
    let extent = |count: u32, size: u32| count.saturating_mul(size.saturating_add(GAP)) - GAP;
    let mut film = Picture::new(extent(columns, frame.width), extent(rows, frame.height))?;
    film.fill([1.0; 3]);
    let colours = options.theme.colours();
    for (place, scene) in (0..).zip(scenes) {
        let mut picture = scene.render(&frame)?;
        let size = height(&picture) as i64;
        let at = [size / 2, i64::from(frame.height) - 3 * size / 2];
        outlined(&mut picture, &format!("{} s", fixed(scene.time, 2)), at, colours.ink, colours.sky);
        film.paste(&picture, [place % columns * (frame.width + GAP), place / columns * (frame.height + GAP)]);
    }
    Ok(film)
}
