//! Names and numbers in pictures.

use super::camera::{Camera, NEAR};
use super::palette::{Colours, heat};
use super::scene::Scene;
use super::{Picture, Rgb};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster};

/// Rows of a picture for each row of text: text is as high as a 36th of a picture, where there is a font of that height.
const ROWS_PER_TEXT: u32 = 36;
/// In smaller pictures text would hide what is shown: width, height.
const SMALLEST: [u32; 2] = [440, 240];
/// The scale of colours: pixels of a small text's height in width and height.
const BAR: [i64; 2] = [7, 1];

/// Where a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    /// It begins there.
    Left,
    /// It ends there.
    Right,
}

/// Writes what forces, markers and the scale of colours are.
pub(super) fn annotate(scene: &Scene, camera: &Camera, colours: &Colours, picture: &mut Picture) {
    if picture.width() < SMALLEST[0] || picture.height() < SMALLEST[1] {
        return;
    }
    for label in &scene.labels {
        let [x, y, depth] = camera.project(&label.at);
        if depth >= NEAR && x.is_finite() && y.is_finite() {
            let size = height(picture) as i64;
            let colour = label.paint.colour(colours);
            outlined(picture, &label.text, [x as i64 + size / 4, y as i64 - size / 2], colour, colours.sky);
        }
    }
    if scene.muscles {
        legend(scene, colours, picture);
    }
}

/// Scale of the muscles' colours, in the right lower corner.
fn legend(scene: &Scene, colours: &Colours, picture: &mut Picture) {
    let [low, high, name] = scene.colouring.scale();
    let size = height(picture) as i64;
    let (right, bottom) = (i64::from(picture.width()) - size / 2, i64::from(picture.height()) - size / 2);
    let top = bottom - size;
    let name_width = write(picture, name, [right, top], colours.ink, Anchor::Right);
    let high_width = write(picture, high, [right - name_width - size, top], colours.ink, Anchor::Right);
    let end = right - name_width - size - high_width - size / 3;
    let [width, rows] = BAR.map(|part| part * size);
    for x in 0..width {
        let colour = heat(x as f64 / (width - 1).max(1) as f64);
        (rows / 4..rows * 3 / 4).for_each(|y| picture.blend(end - width + x, top + y, colour, 1.0));
    }
    write(picture, low, [end - width - size / 3, top], colours.ink, Anchor::Right);
}

/// Text in one colour with an edge in another, so that it can be read before anything.
pub(super) fn outlined(picture: &mut Picture, text: &str, [x, y]: [i64; 2], colour: Rgb, edge: Rgb) {
    for [right, down] in [[-1, 0], [1, 0], [0, -1], [0, 1]] {
        write(picture, text, [x + right, y + down], edge, Anchor::Left);
    }
    write(picture, text, [x, y], colour, Anchor::Left);
}

/// Height of text in a picture, px.
pub(super) fn height(picture: &Picture) -> usize {
    font(picture).val()
}

fn font(picture: &Picture) -> RasterHeight {
    match picture.height() / ROWS_PER_TEXT {
        0..18 => RasterHeight::Size16,
        18..22 => RasterHeight::Size20,
        22..28 => RasterHeight::Size24,
        _ => RasterHeight::Size32,
    }
}

/// Writes a text whose upper left or right corner is at a pixel; gives its width, px. What the font lacks is written as `?`.
pub(super) fn write(picture: &mut Picture, text: &str, [x, y]: [i64; 2], colour: Rgb, anchor: Anchor) -> i64 {
    let font = font(picture);
    let glyph =
        |letter: char| get_raster(letter, FontWeight::Regular, font).or_else(|| get_raster('?', FontWeight::Regular, font));
    let glyphs: Vec<_> = text.chars().filter_map(glyph).collect();
    let width: i64 = glyphs.iter().map(|glyph| glyph.width() as i64).sum();
    let mut left = if anchor == Anchor::Left { x } else { x - width };
    for glyph in glyphs {
        for (row, shares) in (y..).zip(glyph.rows()) {
            for (column, share) in (left..).zip(shares.iter()) {
                picture.blend(column, row, colour, f32::from(*share) / 255.0);
            }
        }
        left += glyph.width() as i64;
    }
    width
}
