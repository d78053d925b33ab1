//! Colours: those of the page (`page/palette.js`). The scale is linear in Oklab lightness, so it reads the same without colour vision.

use super::{Rgb, mix};
use std::sync::OnceLock;

/// What colours muscles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Colouring {
    /// Activation, 0 to 1.
    #[default]
    Activation,
    /// Excitation, what the policy asks for, 0 to 1.
    Excitation,
    /// Force over the peak isometric force.
    Force,
    /// Fibre length over the optimal one, 0.5 to 1.5.
    Fibre,
    /// What is left of the strength of the healthy, fresh muscle.
    Capacity,
}

impl Colouring {
    /// All, by the names that they have on a command line.
    pub const NAMED: [(&str, Self); 5] = [
        ("activation", Self::Activation),
        ("excitation", Self::Excitation),
        ("force", Self::Force),
        ("fibre", Self::Fibre),
        ("capacity", Self::Capacity),
    ];

    /// What the ends of the scale mean, and what it measures.
    pub(super) fn scale(self) -> [&'static str; 3] {
        match self {
            Self::Activation => ["0", "1", "activation"],
            Self::Excitation => ["0", "1", "excitation"],
            Self::Force => ["0", "1", "force / peak"],
            Self::Fibre => ["0.5", "1.5", "fibre / optimal length"],
            Self::Capacity => ["0", "1", "strength left"],
        }
    }
}

/// Light or dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// For print.
    #[default]
    Light,
    /// For screens.
    Dark,
}

impl Theme {
    /// Both, by the names that they have on a command line.
    pub const NAMED: [(&str, Self); 2] = [("light", Self::Light), ("dark", Self::Dark)];

    pub(super) fn colours(self) -> &'static Colours {
        match self {
            Self::Light => &LIGHT,
            Self::Dark => &DARK,
        }
    }
}

/// What a picture uses beside the scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Colours {
    pub sky: Rgb,
    pub ground: Rgb,
    pub line: Rgb,
    pub skin: Rgb,
    pub scenery: Rgb,
    pub bone: Rgb,
    pub ghost: Rgb,
    pub arrow: Rgb,
    pub marker: Rgb,
    pub tendon: Rgb,
    pub ink: Rgb,
}

pub(super) const LIGHT: Colours = Colours {
    sky: [0.925, 0.918, 0.9],
    ground: [0.87, 0.86, 0.835],
    line: [0.74, 0.73, 0.7],
    skin: [0.83, 0.68, 0.58],
    scenery: [0.55, 0.6, 0.65],
    bone: [0.93, 0.9, 0.82],
    ghost: [0.1, 0.42, 0.75],
    arrow: [0.0, 0.42, 0.33],
    marker: [0.75, 0.3, 0.05],
    tendon: [0.93, 0.9, 0.84],
    ink: [0.11, 0.12, 0.13],
};

pub(super) const DARK: Colours = Colours {
    sky: [0.1, 0.113, 0.128],
    ground: [0.155, 0.168, 0.185],
    line: [0.26, 0.275, 0.3],
    skin: [0.72, 0.6, 0.53],
    scenery: [0.42, 0.47, 0.53],
    bone: [0.85, 0.82, 0.75],
    ghost: [0.4, 0.7, 1.0],
    arrow: [0.25, 0.85, 0.65],
    marker: [1.0, 0.6, 0.25],
    tendon: [0.82, 0.8, 0.75],
    ink: [0.92, 0.92, 0.9],
};

/// What muscles pale to that are weak or tired.
pub(super) const WEAK: Rgb = [0.62, 0.64, 0.68];

/// The colour of a share, which is clipped to 0..1: from dusky rose over red and orange to light yellow, in equal steps to the eye.
pub(super) fn heat(share: f64) -> Rgb {
    static SCALE: OnceLock<Vec<Rgb>> = OnceLock::new();
    let scale = SCALE.get_or_init(|| {
        let shares = (0..256).map(|index| f64::from(index) / 255.0);
        shares.map(|share| oklch(0.44 + 0.47 * share, 0.095 + 0.07 * share, 2.0 + 98.0 * share)).collect()
    });
    // What is not a number is cast to 0.
    scale[(255.0 * share.clamp(0.0, 1.0)).round() as usize]
}

/// The colour of a muscle: of its share, and paler where it has lost strength.
pub(super) fn muscle(share: f64, lost: f64) -> Rgb {
    mix(heat(share), WEAK, (0.75 * lost.clamp(0.0, 1.0)) as f32)
}

/// sRGB of a colour in Oklch.
fn oklch(lightness: f64, chroma: f64, degrees: f64) -> Rgb {
    let hue = degrees.to_radians();
    let (a, b) = (chroma * libm::cos(hue), chroma * libm::sin(hue));
    let cube = |value: f64| value * value * value;
    let l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    let m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    let s = cube(lightness - 0.0894841775 * a - 1.291485548 * b);
    let gamma = |value: f64| {
        let value = value.clamp(0.0, 1.0);
        (if value <= 0.0031308 { 12.92 * value } else { 1.055 * libm::pow(value, 1.0 / 2.4) - 0.055 }) as f32
    };
    [
        gamma(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
        gamma(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        gamma(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
    ]
}
