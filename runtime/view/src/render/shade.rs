//! Light: from the sky and the ground, from the sun, and a little from the eye, as on the page; the ground with its grid and the shadow.

use super::camera::Camera;
use super::geometry::Layers;
use super::palette::Colours;
use super::raster::{Band, SAMPLES, Sample, Seen};
use super::scene::{Paint, Scene};
use super::shadow::{Shadow, sun};
use super::{Picture, Rgb, Vector, mix, smoothstep};

/// Rows of pixels that are drawn at once: their samples stay in the cache.
const ROWS: usize = 8;
/// Light that is left in a shadow.
const SHADE: f32 = 0.6;

/// Draws layers into a picture.
pub(super) fn draw(scene: &Scene, camera: &Camera, colours: &Colours, layers: &Layers, picture: &mut Picture) {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let [wide, high, rows] = [width, height, ROWS].map(|pixels| pixels * SAMPLES);
    let shadow = Shadow::of(layers, scene.centre);
    let painter = Painter { camera, colours, shadow, centre: scene.centre, ground: scene.ground, sun: sun() };
    let solid = Seen::new(&layers.solid, camera, high, rows);
    let shells = layers.shells.each_ref().map(|shell| Seen::new(shell, camera, high, rows));
    let mut samples = [(); 3].map(|()| vec![Sample::NOTHING; wide * rows]);
    for (number, pixels) in picture.rows_mut(ROWS).enumerate() {
        let count = pixels.len() / (3 * width);
        let first = number * ROWS;
        let band = Band { width: wide, rows: [first * SAMPLES, (first + count) * SAMPLES] };
        let [opaque, skin, ghost] = &mut samples;
        opaque.fill(Sample::NOTHING);
        solid.draw(&band, number, opaque);
        for (seen, shell) in shells.iter().zip([&mut *skin, &mut *ghost]) {
            // Only what is before everything solid shines.
            shell.iter_mut().zip(opaque.iter()).for_each(|(shell, solid)| {
                *shell = Sample { nearness: solid.nearness, ..Sample::NOTHING };
            });
            seen.draw(&band, number, shell);
        }
        for (place, pixel) in pixels.chunks_exact_mut(3).enumerate() {
            let (x, y) = (place % width, place / width);
            let at = |index: usize| (y * SAMPLES + index / SAMPLES) * wide + x * SAMPLES + index % SAMPLES;
            let all: [[Sample; 3]; SAMPLES * SAMPLES] =
                std::array::from_fn(|index| [opaque[at(index)], skin[at(index)], ghost[at(index)]]);
            let colour = painter.pixel([x as f32, (first + y) as f32], &all);
            pixel.copy_from_slice(&colour.map(|part| (255.0 * part.clamp(0.0, 1.0) + 0.5) as u8));
        }
    }
}

/// What colours pixels.
struct Painter<'a> {
    camera: &'a Camera,
    colours: &'a Colours,
    shadow: Shadow,
    centre: Vector,
    ground: bool,
    sun: Vector,
}

impl Painter<'_> {
    /// The mean of the samples of a pixel.
    fn pixel(&self, [x, y]: [f32; 2], samples: &[[Sample; 3]; SAMPLES * SAMPLES]) -> Rgb {
        let (behind, nearness) = self.background(x, y);
        let mut sum = [0.0; 3];
        for (index, [solid, skin, ghost]) in samples.iter().enumerate() {
            let offset = |place: usize| (place as f32 + 0.5) / SAMPLES as f32;
            let drawn = [solid, skin, ghost].map(|sample| sample.nearness > nearness);
            let mut colour = behind;
            if drawn.contains(&true) {
                let ray = self.camera.ray(x + offset(index % SAMPLES), y + offset(index / SAMPLES));
                if drawn[0] {
                    colour = self.solid(solid, &ray);
                }
                for shell in [skin, ghost] {
                    if shell.nearness > nearness && shell.nearness > solid.nearness {
                        let (tint, alpha) = self.shell(shell, &ray);
                        colour = mix(colour, tint, alpha);
                    }
                }
            }
            sum = [0, 1, 2].map(|part| sum[part] + colour[part]);
        }
        sum.map(|part| part / (SAMPLES * SAMPLES) as f32)
    }

    /// Ground or sky in the middle of a pixel, and how near it is.
    fn background(&self, x: f32, y: f32) -> (Rgb, f32) {
        let Colours { sky, ground, line, .. } = *self.colours;
        let eye = self.camera.eye;
        let meets = |x: f32, y: f32| {
            let ray = self.camera.ray(x + 0.5, y + 0.5);
            (ray.z < -1e-6).then(|| (-eye.z / ray.z, eye + ray * (-eye.z / ray.z)))
        };
        let Some((depth, at)) = meets(x, y).filter(|_| self.ground) else { return (sky, 0.0) };
        let far = smoothstep(3.0, 14.0, (at - self.centre).xy().norm());
        if far >= 1.0 {
            return (sky, 1.0 / depth);
        }
        // How far the place moves from pixel to pixel: lines are as wide on the picture everywhere.
        let apart = |other: Option<(f32, Vector)>| other.map_or(Vector::repeat(1.0), |(_, other)| (other - at).abs());
        let footprint = apart(meets(x + 1.0, y)) + apart(meets(x, y + 1.0));
        let grid = |step: f32, width: f32| {
            let covered = [0, 1].map(|axis| {
                let place = at[axis] / step;
                let distance = (place - place.round()).abs() * step / footprint[axis].max(1e-5);
                1.0 - (distance / width).min(1.0)
            });
            covered[0].max(covered[1])
        };
        let marked = (0.7 * grid(1.0, 1.4) + 0.25 * grid(0.25, 1.0)).min(1.0);
        let light = SHADE + (1.0 - SHADE) * self.shadow.light(&at);
        (mix(mix(ground, line, marked).map(|part| part * light), sky, far), 1.0 / depth)
    }

    fn solid(&self, sample: &Sample, ray: &Vector) -> Rgb {
        let (normal, view) = facing(sample, ray);
        let base = sample.colour.map(|part| f32::from(part) / 255.0);
        match sample.paint {
            Paint::Muscle => {
                let rim = 0.82 + 0.18 * normal.dot(&view).max(0.0);
                self.lit(base, &normal, &view, 0.18).map(|part| part * rim)
            }
            Paint::Scenery => {
                let at = self.camera.eye + ray / sample.nearness;
                let light = SHADE + (1.0 - SHADE) * self.shadow.light(&(at + normal * 0.01));
                self.lit(base, &normal, &view, 0.12).map(|part| part * light)
            }
            _ => self.lit(base, &normal, &view, 0.12),
        }
    }

    /// Colour and opacity of what shines through: more at its edges.
    fn shell(&self, sample: &Sample, ray: &Vector) -> (Rgb, f32) {
        let (normal, view) = facing(sample, ray);
        let opacity = match sample.paint {
            Paint::Ghost => 0.5,
            Paint::MarkerBall => 0.8,
            _ => 0.55,
        };
        let slant = 1.0 - normal.dot(&view).max(0.0);
        // Close to the power of 2.2.
        let edge = slant * slant * (0.8 + 0.2 * slant);
        let base = sample.colour.map(|part| f32::from(part) / 255.0);
        (self.lit(base, &normal, &view, 0.04), opacity * (0.3 + 0.7 * edge))
    }

    fn lit(&self, base: Rgb, normal: &Vector, view: &Vector, gloss: f32) -> Rgb {
        let sky = 0.5 + 0.5 * normal.z;
        let sunny = normal.dot(&self.sun).max(0.0);
        let half = (self.sun + view).try_normalize(0.0).unwrap_or(self.sun);
        let square = |value: f32| value * value;
        let eighth = square(square(square(normal.dot(&half).max(0.0))));
        // The power of 40.
        let shine = square(square(eighth)) * eighth * gloss;
        let light = 0.38 + 0.26 * sky + 0.44 * sunny + 0.2 * normal.dot(view).max(0.0);
        base.map(|part| part * light + shine)
    }
}

/// The normal of a sample, on the side of the eye, and the direction to it.
fn facing(sample: &Sample, ray: &Vector) -> (Vector, Vector) {
    let view = -ray.normalize();
    let normal = sample.normal.try_normalize(0.0).unwrap_or(view);
    (if normal.dot(&view) < 0.0 { -normal } else { normal }, view)
}
