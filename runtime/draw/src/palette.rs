//! Colours. Activation runs from blue to red in steps that look equally large: the blend is linear in Oklab.

use nalgebra::{Matrix3, Vector3};

/// Silhouettes far from the viewer and near.
const SKIN: [[u8; 3]; 2] = [[214, 204, 190], [250, 247, 241]];
/// Anchors of the activation scale, from silent to fully active.
const ACTIVATION: [[u8; 3]; 5] = [[122, 158, 204], [126, 118, 198], [184, 92, 168], [218, 66, 98], [198, 14, 26]];

/// The colour of a silhouette, from far (0) to near (1), as `#rrggbb`.
pub(super) fn skin(near: f64) -> String {
    hexadecimal(oklab(SKIN[0]).lerp(&oklab(SKIN[1]), near.clamp(0.0, 1.0)))
}

/// The colour of a muscle at `activation`, which is clipped to 0..1, as `#rrggbb`.
pub(super) fn activation(activation: f64) -> String {
    let position = if activation.is_nan() { 0.0 } else { activation.clamp(0.0, 1.0) } * (ACTIVATION.len() - 1) as f64;
    let below = (position as usize).min(ACTIVATION.len() - 2);
    let (from, to) = (oklab(ACTIVATION[below]), oklab(ACTIVATION[below + 1]));
    hexadecimal(from.lerp(&to, position - below as f64))
}

fn hexadecimal(lab: Vector3<f64>) -> String {
    let [r, g, b] = srgb(lab);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Linear sRGB to cone responses, and their cube roots to lightness and two opponent axes (Ottosson 2020).
fn cones() -> Matrix3<f64> {
    Matrix3::new(
        0.4122214708,
        0.5363325363,
        0.0514459929,
        0.2119034982,
        0.6806995451,
        0.1073969566,
        0.0883024619,
        0.2817188376,
        0.6299787005,
    )
}

fn opponents() -> Matrix3<f64> {
    Matrix3::new(
        0.2104542553,
        0.7936177850,
        -0.0040720468,
        1.9779984951,
        -2.4285922050,
        0.4505937099,
        0.0259040371,
        0.7827717662,
        -0.8086757660,
    )
}

fn oklab(rgb: [u8; 3]) -> Vector3<f64> {
    let linear = |value: u8| {
        let value = f64::from(value) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
    };
    opponents() * (cones() * Vector3::from(rgb.map(linear))).map(libm::cbrt)
}

fn srgb(lab: Vector3<f64>) -> [u8; 3] {
    let inverse = |matrix: Matrix3<f64>| matrix.try_inverse().unwrap_or_default();
    let linear = inverse(cones()) * (inverse(opponents()) * lab).map(|value| value * value * value);
    let gamma = |value: f64| {
        let value = value.clamp(0.0, 1.0);
        let value = if value <= 0.0031308 { value * 12.92 } else { 1.055 * libm::pow(value, 1.0 / 2.4) - 0.055 };
        (value * 255.0).round() as u8
    };
    [gamma(linear.x), gamma(linear.y), gamma(linear.z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_hits_its_anchors_and_its_ends() {
        assert_eq!(activation(0.0), "#7a9ecc");
        assert_eq!(activation(0.5), "#b85ca8");
        assert_eq!(activation(7.0), "#c60e1a");
        assert_eq!(activation(f64::NAN), activation(0.0));
    }

    #[test]
    fn equal_steps_of_activation_are_about_equal_steps_to_the_eye() {
        let color = |index: u32| {
            let text = activation(f64::from(index) / 20.0);
            let byte = |at: usize| u8::from_str_radix(&text[at..at + 2], 16).unwrap();
            oklab([byte(1), byte(3), byte(5)])
        };
        let steps: Vec<f64> = (0..20).map(|index| (color(index + 1) - color(index)).norm()).collect();
        let mean = steps.iter().sum::<f64>() / 20.0;
        assert!(steps.iter().all(|step| (0.4..1.8).contains(&(step / mean))), "{steps:?}");
    }
}
