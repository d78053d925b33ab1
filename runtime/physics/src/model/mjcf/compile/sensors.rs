//! Sensors.

use super::names::Kind;
use super::{Compiler, section};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{Framed, GapQuantity, GeomKind, JointKind, LimitQuantity, Limited, Measure, Surface};

impl Compiler<'_> {
    /// Reads the `sensor` sections.
    pub(super) fn read_sensors(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        for element in section(&document.root, "sensor") {
            let measure = self.measure(element)?;
            let cutoff = element.size_or("cutoff", 0.0)?;
            if cutoff > 0.0 && measure.is_direction() {
                return Err(element.invalid("a direction or orientation has no `cutoff`"));
            }
            let sensors = &mut self.model.sensors;
            let name = self.names.register(Kind::Sensor, element, sensors.name.len())?;
            sensors.name.push(name);
            sensors.measure.push(measure);
            sensors.cutoff.push(cutoff);
        }
        Ok(())
    }

    fn measure(&self, element: &Element) -> Result<Measure, ModelError> {
        let of = |kind, attribute| self.names.required(kind, element, attribute);
        let site = || of(Kind::Site, "site");
        let body = || of(Kind::Body, "body");
        let object = || self.framed(element, ["objtype", "objname"]);
        let reference = || match element.text("reftype").or(element.text("refname")) {
            None => Ok(None),
            Some(_) => self.framed(element, ["reftype", "refname"]).map(Some),
        };
        let axis = |axis| Ok::<_, ModelError>(Measure::FrameAxis(object()?, reference()?, axis));
        let scalar = || self.joint_of(element, &[JointKind::Hinge, JointKind::Slide]);
        let ball = || self.joint_of(element, &[JointKind::Ball]);
        let limit = |quantity| Ok::<_, ModelError>(Measure::Limit(self.limited(element)?, quantity));
        let gap = |quantity| {
            let surfaces = [self.surface(element, ["geom1", "body1"])?, self.surface(element, ["geom2", "body2"])?];
            Ok::<_, ModelError>(Measure::Gap(surfaces, quantity))
        };
        Ok(match element.tag.as_str() {
            "touch" => {
                let site = site()?;
                let (shape, size) = self.zones[site];
                if shape == GeomKind::Mesh {
                    return Err(element.invalid("a touch needs a site with the shape of a primitive, found a mesh"));
                }
                Measure::Touch { site, shape, size }
            }
            "accelerometer" => Measure::Accelerometer(site()?),
            "velocimeter" => Measure::Velocimeter(site()?),
            "gyro" => Measure::Gyro(site()?),
            "force" => Measure::Force(site()?),
            "torque" => Measure::Torque(site()?),
            "jointpos" => Measure::JointPosition(scalar()?),
            "jointvel" => Measure::JointVelocity(scalar()?),
            "jointactuatorfrc" => Measure::JointActuatorForce(scalar()?),
            "ballquat" => Measure::BallOrientation(ball()?),
            "ballangvel" => Measure::BallVelocity(ball()?),
            "tendonpos" => Measure::TendonPosition(of(Kind::Tendon, "tendon")?),
            "tendonvel" => Measure::TendonVelocity(of(Kind::Tendon, "tendon")?),
            "actuatorpos" => Measure::ActuatorPosition(of(Kind::Actuator, "actuator")?),
            "actuatorvel" => Measure::ActuatorVelocity(of(Kind::Actuator, "actuator")?),
            "actuatorfrc" => Measure::ActuatorForce(of(Kind::Actuator, "actuator")?),
            "tendonactuatorfrc" => Measure::TendonActuatorForce(of(Kind::Tendon, "tendon")?),
            "jointlimitpos" | "tendonlimitpos" => limit(LimitQuantity::Distance)?,
            "jointlimitvel" | "tendonlimitvel" => limit(LimitQuantity::Velocity)?,
            "jointlimitfrc" | "tendonlimitfrc" => limit(LimitQuantity::Force)?,
            "rangefinder" => Measure::Range(site()?),
            "distance" => gap(GapQuantity::Distance)?,
            "normal" => gap(GapQuantity::Normal)?,
            "fromto" => gap(GapQuantity::Segment)?,
            "framepos" => Measure::FramePosition(object()?, reference()?),
            "framequat" => Measure::FrameOrientation(object()?, reference()?),
            "framexaxis" => axis(0)?,
            "frameyaxis" => axis(1)?,
            "framezaxis" => axis(2)?,
            "framelinvel" => Measure::FrameVelocity(object()?, reference()?),
            "frameangvel" => Measure::FrameAngularVelocity(object()?, reference()?),
            "framelinacc" => Measure::FrameAcceleration(object()?),
            "frameangacc" => Measure::FrameAngularAcceleration(object()?),
            "subtreecom" => Measure::SubtreeCenter(body()?),
            "subtreelinvel" => Measure::SubtreeVelocity(body()?),
            "subtreeangmom" => Measure::SubtreeAngularMomentum(body()?),
            _ => Measure::Clock,
        })
    }

    /// The joint or tendon whose limit a sensor measures.
    fn limited(&self, element: &Element) -> Result<Limited, ModelError> {
        let model = &self.model;
        let (limited, range) = match element.text("joint") {
            Some(_) => {
                let joint = self.names.required(Kind::Joint, element, "joint")?;
                (Limited::Joint(joint), model.joints.range[joint])
            }
            None => {
                let tendon = self.names.required(Kind::Tendon, element, "tendon")?;
                (Limited::Tendon(tendon), model.tendons.range[tendon])
            }
        };
        let missing = || element.invalid(format!("`{}` measures a limit, and there is none: give it a `range`", element.tag));
        range.map(|_| limited).ok_or_else(missing)
    }

    /// The geom or body on one side of a distance.
    fn surface(&self, element: &Element, [geom, body]: [&str; 2]) -> Result<Surface, ModelError> {
        match (element.text(geom), element.text(body)) {
            (Some(_), Some(_)) => Err(element.invalid(format!("expected `{geom}` or `{body}`, found both"))),
            (None, Some(_)) => Ok(Surface::Body(self.names.required(Kind::Body, element, body)?)),
            _ => Ok(Surface::Geom(self.names.required(Kind::Geom, element, geom)?)),
        }
    }

    fn framed(&self, element: &Element, [kind, name]: [&str; 2]) -> Result<Framed, ModelError> {
        element.required(kind)?;
        Ok(match element.keyword(kind, &["body", "xbody", "geom", "site"])? {
            Some(0) => Framed::InertialBody(self.names.required(Kind::Body, element, name)?),
            Some(1) => Framed::Body(self.names.required(Kind::Body, element, name)?),
            Some(2) => Framed::Geom(self.names.required(Kind::Geom, element, name)?),
            _ => Framed::Site(self.names.required(Kind::Site, element, name)?),
        })
    }

    fn joint_of(&self, element: &Element, kinds: &[JointKind]) -> Result<usize, ModelError> {
        let joint = self.names.required(Kind::Joint, element, "joint")?;
        let kind = self.model.joints.kind[joint];
        if !kinds.contains(&kind) {
            let tag = &element.tag;
            return Err(element.invalid(format!("`{tag}` measures joints of the kinds {kinds:?}, found {kind:?}")));
        }
        Ok(joint)
    }
}
