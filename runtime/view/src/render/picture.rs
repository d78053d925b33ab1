//! Pixels, and their PNG file.

use super::{LARGEST, Rgb};
use png::{BitDepth, ColorType, Compression, Encoder};
use std::io;
use thiserror::Error;

/// Rows of pixels from above, each with red, green and blue bytes from the left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

/// Why there is no picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum PictureError {
    /// A size that pictures do not have.
    #[error("expected a picture of 1 to {LARGEST} pixels in width and height, found {0} x {1}")]
    Size(u32, u32),
    /// A strip of no frames.
    #[error("expected at least one frame in a film strip")]
    Empty,
}

impl Picture {
    /// A black one.
    pub(super) fn new(width: u32, height: u32) -> Result<Self, PictureError> {
        match (1..=LARGEST).contains(&width) && (1..=LARGEST).contains(&height) {
            true => Ok(Self { width, height, bytes: vec![0; 3 * width as usize * height as usize] }),
            false => Err(PictureError::Size(width, height)),
        }
    }

    /// Pixels of a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Three bytes for each pixel, row by row: `3 * width * height`.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The same, without a copy.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// The picture as the bytes of a PNG file.
    ///
    /// # Errors
    /// None that is known: memory takes all that is written.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.bytes)?;
        writer.finish()?;
        Ok(file)
    }

    /// So many rows after each other, the last time perhaps fewer.
    pub(super) fn rows_mut(&mut self, count: usize) -> impl Iterator<Item = &mut [u8]> {
        self.bytes.chunks_mut(3 * self.width as usize * count)
    }

    /// Gives all pixels one colour.
    pub(super) fn fill(&mut self, colour: Rgb) {
        let colour = colour.map(|part| (255.0 * part) as u8);
        self.bytes.chunks_exact_mut(3).for_each(|pixel| pixel.copy_from_slice(&colour));
    }

    /// Puts another picture over this one, its left upper corner at a pixel; what does not fit is left out.
    pub(super) fn paste(&mut self, other: &Self, [left, top]: [u32; 2]) {
        let [width, other_width] = [self.width, other.width].map(|width| 3 * width as usize);
        let start = (3 * left as usize).min(width);
        let size = other_width.min(width - start);
        let rows = self.bytes.chunks_exact_mut(width).skip(top as usize);
        for (row, from) in rows.zip(other.bytes.chunks_exact(other_width)) {
            row[start..start + size].copy_from_slice(&from[..size]);
        }
    }

    /// Mixes a colour into a pixel, if there is one at that place.
    pub(super) fn blend(&mut self, x: i64, y: i64, colour: Rgb, share: f32) {
        let inside = |value: i64, size: u32| u32::try_from(value).ok().filter(|value| *value < size);
        let Some((x, y)) = inside(x, self.width).zip(inside(y, self.height)) else { return };
        let first = 3 * (y as usize * self.width as usize + x as usize);
        for (byte, part) in self.bytes[first..first + 3].iter_mut().zip(colour) {
            let before = f32::from(*byte);
            *byte = (before + (255.0 * part - before) * share + 0.5) as u8;
        }
    }
}
