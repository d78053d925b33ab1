//! Muscles.

use super::names::Kind;
use super::{Compiler, section};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::{ModelError, Unsupported};

impl Compiler<'_> {
    /// Reads the `actuator` sections: muscles that pull tendons; everything else is refused.
    pub(super) fn read_actuators(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        for element in section(&document.root, "actuator") {
            let element = &self.defaults.resolve(element, None)?;
            let other = ["dyntype", "gaintype", "biastype"]
                .into_iter()
                .filter(|kind| element.text(kind).map(str::trim) != Some("muscle"));
            let refused = other.map(|kind| format!("an actuator whose `{kind}` is not muscle")).next();
            let missing = || "an actuator without `tendon`".to_owned();
            if let Some(what) = refused.or_else(|| element.text("tendon").is_none().then(missing)) {
                self.unsupported.push(Unsupported { place: element.place.clone(), what });
                continue;
            }
            self.add_muscle(element)?;
        }
        Ok(())
    }

    fn add_muscle(&mut self, element: &Element) -> Result<(), ModelError> {
        let tendon = self.names.required(Kind::Tendon, element, "tendon")?;
        let control_range = self.settings.limited(element, "ctrllimited", "ctrlrange")?;
        let length_range = element.numbers_over("lengthrange", [0.0; 2])?;
        if length_range[0] >= length_range[1] {
            return Err(element.invalid("a muscle needs a `lengthrange` of two lengths in ascending order"));
        }
        let [gear, ..] = element.numbers_over("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
        let dynamics: [f64; 10] = element.numbers_over("dynprm", raw_default())?;
        let gain: [f64; 10] = element.numbers_over("gainprm", raw_default())?;
        let bias: [f64; 10] = element.numbers_over("biasprm", [0.0; 10])?;
        if dynamics[..2].iter().any(|constant| *constant <= 0.0) || dynamics[2] < 0.0 {
            return Err(element.invalid("a muscle's time constants must be positive, its smoothing width not negative"));
        }
        check_curve(element, &gain)?;
        check_curve(element, &bias)?;
        let actuators = &mut self.model.actuators;
        let name = self.names.register(Kind::Actuator, element, actuators.name.len())?;
        actuators.name.push(name);
        actuators.tendon.push(tendon);
        actuators.gear.push(gear);
        actuators.control_range.push(control_range);
        actuators.length_range.push(length_range);
        actuators.time_constants.push(first(&dynamics));
        actuators.gain.push(first(&gain));
        actuators.bias.push(first(&bias));
        Ok(())
    }
}

/// Refuses parameters of a force curve that make no muscle.
fn check_curve(element: &Element, parameters: &[f64; 10]) -> Result<(), ModelError> {
    let [low, high, _, scale, shortest, longest, speed, passive, eccentric, _] = *parameters;
    if low >= high {
        return Err(element.invalid("a muscle's operating range must be two numbers in ascending order"));
    }
    if shortest >= 1.0 || longest <= 1.0 {
        return Err(element.invalid(format!("a muscle needs lmin < 1 < lmax, found {shortest} and {longest}")));
    }
    if [scale, speed, passive, eccentric].iter().any(|parameter| *parameter <= 0.0) {
        return Err(element.invalid("a muscle's scale, vmax, fpmax and fvmax must be positive"));
    }
    Ok(())
}

/// What `dynprm` and `gainprm` hold where a `general` actuator does not give them.
fn raw_default() -> [f64; 10] {
    let mut parameters = [0.0; 10];
    parameters[0] = 1.0;
    parameters
}

/// The first `N` of ten parameters.
fn first<const N: usize>(parameters: &[f64; 10]) -> [f64; N] {
    core::array::from_fn(|index| parameters[index])
}
