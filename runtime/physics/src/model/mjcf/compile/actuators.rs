//! Actuators: muscles, motors, servos and whatever else `general` can describe.

use super::names::Kind;
use super::{Compiler, section};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{Bias, Dynamics, Gain, JointKind, Transmission};

/// The attributes that name what an actuator acts on, of which it has exactly one.
const TARGETS: [&str; 5] = ["joint", "jointinparent", "tendon", "site", "body"];

impl Compiler<'_> {
    /// Reads the `actuator` sections.
    pub(super) fn read_actuators(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        for element in section(&document.root, "actuator") {
            let element = &self.defaults.resolve(element, None)?;
            self.add_actuator(element)?;
        }
        Ok(())
    }

    fn add_actuator(&mut self, element: &Element) -> Result<(), ModelError> {
        let transmission = self.transmission(element)?;
        let gear = element.numbers_over("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
        let dynamics = dynamics(element)?;
        let gain = gain(element)?;
        let bias = bias(element)?;
        let length_range = element.numbers_over("lengthrange", [0.0; 2])?;
        let [control_range, force_range, activation_range] = self.ranges(element, transmission, gear[0], dynamics, gain, bias)?;
        if dynamics == Dynamics::None && activation_range.is_some() {
            return Err(element.invalid("`actrange` limits an activation, but `dyntype` gives the actuator none"));
        }
        self.add_mechanics(element, transmission, gear[0])?;
        let dimension = i64::from(dynamics != Dynamics::None);
        if ![-1, dimension].contains(&element.integer_or("actdim", -1, -1, 1)?) {
            return Err(element.invalid(format!("`actdim` is {dimension} with this `dyntype`")));
        }
        let activation = (dynamics != Dynamics::None).then_some(self.model.na);
        self.model.na += usize::from(activation.is_some());
        let actuators = &mut self.model.actuators;
        let name = self.names.register(Kind::Actuator, element, actuators.name.len())?;
        actuators.name.push(name);
        actuators.transmission.push(transmission);
        actuators.gear.push(gear);
        actuators.dynamics.push(dynamics);
        actuators.gain.push(gain);
        actuators.bias.push(bias);
        actuators.activation.push(activation);
        actuators.actearly.push(element.flag("actearly")?.unwrap_or(false));
        actuators.control_range.push(control_range);
        actuators.force_range.push(force_range);
        actuators.activation_range.push(activation_range);
        actuators.length_range.push(length_range);
        Ok(())
    }

    fn transmission(&self, element: &Element) -> Result<Transmission, ModelError> {
        let given: Vec<&str> = TARGETS.into_iter().filter(|target| element.text(target).is_some()).collect();
        let [target] = given[..] else {
            let found = if given.is_empty() { "none".to_owned() } else { format!("`{}`", given.join("`, `")) };
            return Err(element.invalid(format!("an actuator acts on one of `{}`, found {found}", TARGETS.join("`, `"))));
        };
        if target != "site" && element.text("refsite").is_some() {
            return Err(element.invalid("`refsite` belongs to an actuator that acts on a `site`"));
        }
        Ok(match target {
            "joint" => Transmission::Joint(self.names.required(Kind::Joint, element, target)?),
            "jointinparent" => Transmission::JointInParent(self.names.required(Kind::Joint, element, target)?),
            "body" => Transmission::Body(self.names.required(Kind::Body, element, target)?),
            "tendon" => Transmission::Tendon(self.names.required(Kind::Tendon, element, target)?),
            _ => Transmission::Site {
                site: self.names.required(Kind::Site, element, target)?,
                reference: self.names.optional(Kind::Site, element, "refsite")?,
            },
        })
    }

    /// Ranges of control, force and activation; a servo may take the one of its set point from what it moves.
    fn ranges(
        &self,
        element: &Element,
        transmission: Transmission,
        ratio: f64,
        dynamics: Dynamics,
        gain: Gain,
        bias: Bias,
    ) -> Result<[Option<[f64; 2]>; 3], ModelError> {
        let limited = |flag, range| self.settings.limited(element, flag, range);
        let mut ranges =
            [limited("ctrllimited", "ctrlrange")?, limited("forcelimited", "forcerange")?, limited("actlimited", "actrange")?];
        let share = element.size_or("inheritrange", 0.0)?;
        let servo = matches!((gain, bias), (Gain::Fixed(pull), Bias::Affine([_, back, _])) if pull == -back);
        if share == 0.0 || !servo {
            return Ok(ranges);
        }
        let (slot, attribute) = if dynamics == Dynamics::Integrator { (2, "actrange") } else { (0, "ctrlrange") };
        if ranges[slot].is_some() {
            return Err(element.invalid(format!("`inheritrange` and `{attribute}` exclude each other")));
        }
        let target = match transmission {
            Transmission::Joint(joint) | Transmission::JointInParent(joint) => self.model.joints.range[joint],
            Transmission::Tendon(tendon) => self.model.tendons.range[tendon],
            Transmission::Site { .. } | Transmission::Body(_) => None,
        };
        let Some([low, high]) = target else {
            return Err(element.invalid("`inheritrange` needs a joint or tendon with a `range`"));
        };
        if ratio != 1.0 {
            return Err(element.invalid(format!("`inheritrange` needs a gear of 1, found {ratio}")));
        }
        let (middle, radius) = (0.5 * (high + low), 0.5 * (high - low) * share);
        ranges[slot] = Some([middle - radius, middle + radius]);
        Ok(ranges)
    }

    /// Adds the actuator's own damping and rotor inertia to the joint or tendon that it moves, scaled by its gear squared.
    fn add_mechanics(&mut self, element: &Element, transmission: Transmission, ratio: f64) -> Result<(), ModelError> {
        let damping = super::tree::linear(element, "damping")? * ratio * ratio;
        let armature = element.size_or("armature", 0.0)? * ratio * ratio;
        if damping == 0.0 && armature == 0.0 {
            return Ok(());
        }
        match transmission {
            Transmission::Joint(joint) | Transmission::JointInParent(joint)
                if matches!(self.model.joints.kind[joint], JointKind::Hinge | JointKind::Slide) =>
            {
                let dof = self.model.joints.dof_address[joint];
                self.model.dofs.damping[dof] += damping;
                self.model.dofs.armature[dof] += armature;
            }
            Transmission::Tendon(tendon) if armature == 0.0 => self.model.tendons.damping[tendon] += damping,
            _ => {
                let what = "`damping` or `armature` of an actuator that moves neither a hinge nor a slide".to_owned();
                self.unsupported.push(super::Unsupported { place: element.place.clone(), what });
            }
        }
        Ok(())
    }
}

fn dynamics(element: &Element) -> Result<Dynamics, ModelError> {
    let parameters: [f64; 10] = element.numbers_over("dynprm", raw_default())?;
    let kind = element.keyword("dyntype", &["none", "integrator", "filter", "filterexact", "muscle"])?;
    Ok(match kind.unwrap_or(0) {
        0 => Dynamics::None,
        1 => Dynamics::Integrator,
        2 => Dynamics::Filter(parameters[0]),
        3 => Dynamics::ExactFilter(parameters[0]),
        _ => {
            if parameters[..2].iter().any(|constant| *constant <= 0.0) || parameters[2] < 0.0 {
                return Err(element.invalid("a muscle's time constants must be positive, its smoothing width not negative"));
            }
            Dynamics::Muscle(first(&parameters))
        }
    })
}

fn gain(element: &Element) -> Result<Gain, ModelError> {
    let parameters: [f64; 10] = element.numbers_over("gainprm", raw_default())?;
    Ok(match element.keyword("gaintype", &["fixed", "affine", "muscle"])?.unwrap_or(0) {
        0 => Gain::Fixed(parameters[0]),
        1 => Gain::Affine(first(&parameters)),
        _ => {
            check_curve(element, &parameters)?;
            Gain::Muscle(first(&parameters))
        }
    })
}

fn bias(element: &Element) -> Result<Bias, ModelError> {
    let parameters: [f64; 10] = element.numbers_over("biasprm", [0.0; 10])?;
    Ok(match element.keyword("biastype", &["none", "affine", "muscle"])?.unwrap_or(0) {
        0 => Bias::None,
        1 => Bias::Affine(first(&parameters)),
        _ => {
            check_curve(element, &parameters)?;
            Bias::Muscle(first(&parameters))
        }
    })
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
