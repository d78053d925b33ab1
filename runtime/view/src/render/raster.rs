//! Which samples of a picture a triangle covers, and what of a surface is nearest at each.

use super::Vector;
use super::camera::{Camera, NEAR};
use super::geometry::{Corner, Surface, Triangle};
use super::scene::Paint;

/// Samples of a pixel, in each direction.
pub(super) const SAMPLES: usize = 2;

/// What is nearest at a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// One over the depth, 1/m; 0 where there is nothing.
    pub nearness: f32,
    /// Not a unit vector.
    pub normal: Vector,
    pub colour: [u8; 3],
    pub paint: Paint,
}

impl Sample {
    pub const NOTHING: Self = Self { nearness: 0.0, normal: Vector::new(0.0, 0.0, 0.0), colour: [0; 3], paint: Paint::Skin };
}

/// Rows of samples.
pub(super) struct Band {
    pub width: usize,
    /// First row, and the one after the last.
    pub rows: [usize; 2],
}

/// Weights of three corners.
type Weights = [f32; 3];

/// Calls `put(x, y, weights)` for the samples of a band whose middles lie in a triangle of places in samples.
pub(super) fn cover(band: &Band, corners: [[f32; 2]; 3], mut put: impl FnMut(usize, usize, Weights)) {
    let [a, b, c] = corners;
    let area = turn(a, b, c);
    if !area.is_finite() || area == 0.0 {
        return;
    }
    let range = |axis: usize, low: usize, high: usize| {
        let all = [a[axis], b[axis], c[axis]];
        let least = all.iter().fold(f32::INFINITY, |least, value| least.min(*value));
        let most = all.iter().fold(f32::NEG_INFINITY, |most, value| most.max(*value));
        // Casts stop at the ends of their range.
        let first = ((least - 0.5).ceil().max(0.0) as usize).max(low);
        let after = ((most - 0.5).floor() + 1.0).max(0.0) as usize;
        first..after.min(high)
    };
    let (columns, rows) = (range(0, 0, band.width), range(1, band.rows[0], band.rows[1]));
    let scale = 1.0 / area;
    // How the weights of the first two corners change from column to column.
    let [first_slope, second_slope] = [(b[1] - c[1]) * scale, (c[1] - a[1]) * scale];
    for y in rows {
        let begin = [columns.start as f32 + 0.5, y as f32 + 0.5];
        let [first_begin, second_begin] = [turn(begin, b, c) * scale, turn(a, begin, c) * scale];
        for x in columns.clone() {
            let passed = (x - columns.start) as f32;
            let (first, second) = (first_begin + first_slope * passed, second_begin + second_slope * passed);
            let third = 1.0 - first - second;
            if first >= 0.0 && second >= 0.0 && third >= 0.0 {
                put(x, y, [first, second, third]);
            }
        }
    }
}

/// Twice the area of a triangle; positive where its corners turn clockwise on a picture whose rows lead down.
fn turn(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// A surface as a camera sees it: places in samples with nearness, and the triangles of each band.
pub(super) struct Seen {
    corners: Vec<(Corner, [f32; 3])>,
    triangles: Vec<Triangle>,
    bands: Vec<Vec<u32>>,
}

impl Seen {
    /// Sorts what is before the camera into bands of so many rows of samples.
    pub fn new(surface: &Surface, camera: &Camera, height: usize, rows: usize) -> Self {
        let seen = |corner: &Corner| {
            let [x, y, depth] = camera.project(&corner.place);
            (*corner, [x * SAMPLES as f32, y * SAMPLES as f32, depth])
        };
        let mut this = Self {
            corners: surface.corners.iter().map(seen).collect(),
            triangles: Vec::with_capacity(surface.triangles.len()),
            bands: vec![Vec::new(); height.div_ceil(rows)],
        };
        for triangle in &surface.triangles {
            let depths = triangle.corners.map(|corner| this.depth(corner));
            match depths.map(|depth| depth >= NEAR) {
                [true, true, true] => this.add(*triangle, rows),
                [false, false, false] => {}
                _ => this.clip(triangle, seen).into_iter().for_each(|triangle| this.add(triangle, rows)),
            }
        }
        this.corners.iter_mut().for_each(|(_, place)| place[2] = 1.0 / place[2]);
        this
    }

    fn depth(&self, corner: u32) -> f32 {
        self.corners[corner as usize].1[2]
    }

    fn add(&mut self, triangle: Triangle, rows: usize) {
        let places = triangle.corners.map(|corner| self.corners[corner as usize].1);
        let [a, b, c] = places.map(|[x, y, _]| [x, y]);
        if triangle.closed && turn(a, b, c) > 0.0 {
            return;
        }
        let [low, high] = [
            places.iter().fold(f32::INFINITY, |low, place| low.min(place[1])),
            places.iter().fold(f32::NEG_INFINITY, |high, place| high.max(place[1])),
        ];
        if high < 0.0 || low.is_nan() || high.is_nan() {
            return;
        }
        let number = self.triangles.len() as u32;
        let first = (low.max(0.0) as usize) / rows;
        let last = ((high as usize) / rows).min(self.bands.len().saturating_sub(1));
        if first > last {
            return;
        }
        self.bands[first..=last].iter_mut().for_each(|band| band.push(number));
        self.triangles.push(triangle);
    }

    /// The parts of a triangle that are before the camera.
    fn clip(&mut self, triangle: &Triangle, seen: impl Fn(&Corner) -> (Corner, [f32; 3])) -> Vec<Triangle> {
        let mut outline = Vec::new();
        for side in 0..3 {
            let (from, to) = (triangle.corners[side], triangle.corners[(side + 1) % 3]);
            let (near, far) = (self.depth(from), self.depth(to));
            if near >= NEAR {
                outline.push(from);
            }
            if (near >= NEAR) != (far >= NEAR) {
                // A hair behind, so that rounding leaves it before the camera.
                let share = (NEAR * 1.001 - near) / (far - near);
                let [a, b] = [from, to].map(|corner| self.corners[corner as usize].0);
                let corner = Corner {
                    place: a.place + (b.place - a.place) * share,
                    normal: a.normal + (b.normal - a.normal) * share,
                    colour: super::mix(a.colour, b.colour, share),
                };
                outline.push(self.corners.len() as u32);
                self.corners.push(seen(&corner));
            }
        }
        let fan = (2..outline.len()).map(|last| [outline[0], outline[last - 1], outline[last]]);
        fan.map(|corners| Triangle { corners, ..*triangle }).collect()
    }

    /// Draws the triangles of a band over `samples`, which are its rows one after the other.
    pub fn draw(&self, band: &Band, number: usize, samples: &mut [Sample]) {
        for triangle in &self.bands[number] {
            let triangle = &self.triangles[*triangle as usize];
            let corners = triangle.corners.map(|corner| &self.corners[corner as usize]);
            let places = corners.map(|(_, [x, y, _])| [*x, *y]);
            cover(band, places, |x, y, weights| {
                let sum = |of: &dyn Fn(usize) -> f32| weights[0] * of(0) + weights[1] * of(1) + weights[2] * of(2);
                let nearness = sum(&|corner| corners[corner].1[2]);
                let sample = &mut samples[(y - band.rows[0]) * band.width + x];
                if nearness > sample.nearness {
                    let [a, b, c] = corners.map(|(corner, _)| corner);
                    *sample = Sample {
                        nearness,
                        normal: a.normal * weights[0] + b.normal * weights[1] + c.normal * weights[2],
                        colour: [0, 1, 2].map(|part| (255.0 * sum(&|corner| corners[corner].0.colour[part])) as u8),
                        paint: triangle.paint,
                    };
                }
            });
        }
    }
}
