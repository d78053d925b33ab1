//! Triangles of a scene, in the world.

use super::muscles::Tube;
use super::palette::Colours;
use super::scene::{Paint, Placed, Scene};
use super::{Rgb, Vector, mix, smoothstep};
use std::f64::consts::TAU;

/// Sides of a tube.
const SIDES: usize = 8;

/// Triangles with their corners.
#[derive(Debug, Default)]
pub(super) struct Surface {
    pub corners: Vec<Corner>,
    pub triangles: Vec<Triangle>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub place: Vector,
    pub normal: Vector,
    pub colour: Rgb,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub corners: [u32; 3],
    pub paint: Paint,
    /// Whether it is seen from outside only, where its corners turn counterclockwise.
    pub closed: bool,
}

/// What is solid, and the two shells that shine through: skin, then reference and markers.
pub(super) struct Layers {
    pub solid: Surface,
    pub shells: [Surface; 2],
    /// Of the triangles of `solid` these many, the first, cast a shadow: muscles lie within the skin.
    pub casting: usize,
}

impl Layers {
    pub fn of(scene: &Scene, colours: &Colours) -> Self {
        let mut solid = Surface::default();
        scene.solids.iter().for_each(|placed| solid.place(scene, placed, colours));
        let casting = solid.triangles.len();
        scene.tubes.iter().for_each(|tube| solid.tube(tube, colours.tendon));
        let shells = [0, 1].map(|shell: usize| {
            let mut surface = Surface::default();
            scene.shells[shell].iter().for_each(|placed| surface.place(scene, placed, colours));
            surface
        });
        // A body without a skin has muscles alone.
        let casting = if shells[0].triangles.is_empty() { solid.triangles.len() } else { casting };
        Self { solid, shells, casting }
    }
}

impl Surface {
    fn place(&mut self, scene: &Scene, placed: &Placed, colours: &Colours) {
        let Some(solid) = placed.form.solid(&scene.meshes) else { return };
        let first = self.corners.len() as u32;
        let colour = placed.paint.colour(colours);
        self.corners.extend(solid.corners.iter().map(|corner| {
            let mut local = corner.place.component_mul(&placed.size);
            local.z += corner.cap * placed.half;
            let normal = corner.normal.component_div(&placed.size.map(|part| part.max(1e-5)));
            let normal = (placed.turn * normal).try_normalize(0.0).unwrap_or_else(Vector::z);
            Corner { place: placed.place + placed.turn * local, normal, colour }
        }));
        let triangle = |corners: &[u32; 3]| Triangle {
            corners: corners.map(|corner| first + corner),
            paint: placed.paint,
            closed: solid.closed,
        };
        self.triangles.extend(solid.triangles.iter().map(triangle));
    }

    fn tube(&mut self, tube: &Tube, tendon: Rgb) {
        let rings = tube.rings();
        let first = self.corners.len() as u32;
        for (index, ring) in rings.iter().enumerate() {
            let [before, after] = [&rings[index.saturating_sub(1)], &rings[(index + 1).min(rings.len() - 1)]];
            let span = (after.place - before.place).norm().max(1e-6);
            let slope = ((after.radius - before.radius) / span).clamp(-1.0, 1.0);
            let side = ring.tangent.cross(&ring.normal);
            let colour = mix(tendon, tube.colour, smoothstep(0.1, 0.6, ring.belly));
            self.corners.extend(CIRCLE.with(|circle| {
                circle.map(|[s, c]| {
                    let outwards = ring.normal * c + side * s;
                    let normal = (outwards - ring.tangent * slope).try_normalize(0.0).unwrap_or(outwards);
                    Corner { place: ring.place + outwards * ring.radius, normal, colour }
                })
            }));
        }
        let sides = SIDES as u32;
        for ring in 1..rings.len() as u32 {
            for side in 0..sides {
                let (below, next) = (first + (ring - 1) * sides, (side + 1) % sides);
                let [a, b, c, d] = [below + side, below + next, below + sides + side, below + sides + next];
                let triangle = |corners| Triangle { corners, paint: Paint::Muscle, closed: true };
                self.triangles.extend([[a, b, c], [b, d, c]].map(triangle));
            }
        }
    }
}

thread_local! {
    /// Sine and cosine of the sides of a tube.
    static CIRCLE: [[f32; 2]; SIDES] = std::array::from_fn(|side| {
        let (s, c) = libm::sincos(TAU * side as f64 / SIDES as f64);
        [s as f32, c as f32]
    });
}
