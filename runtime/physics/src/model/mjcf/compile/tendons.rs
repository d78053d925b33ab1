//! Spatial tendons and their paths, fixed tendons and their joints.

use super::names::Kind;
use super::settings::softness;
use super::tree::linear;
use super::{Compiler, section};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::{ModelError, Unsupported};
use crate::model::{GeomKind, PathPoint};
use std::collections::BTreeSet;

impl Compiler<'_> {
    /// Reads the `tendon` sections.
    pub(super) fn read_tendons(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        for element in section(&document.root, "tendon") {
            let element = &self.defaults.resolve(element, None)?;
            let path = if element.tag == "fixed" { self.combination(element)? } else { self.path(element)? };
            let armature = self.armature(element, &path)?;
            let tendons = &mut self.model.tendons;
            tendons.armature.push(armature);
            let name = self.names.register(Kind::Tendon, element, tendons.name.len())?;
            tendons.name.push(name);
            let start = tendons.path_points.len();
            tendons.path_points.extend(path);
            tendons.path.push(start..tendons.path_points.len());
            tendons.range.push(self.settings.limited(element, "limited", "range")?);
            tendons.margin.push(element.number_or("margin", 0.0)?);
            tendons.limit_softness.push(softness(element, "solreflimit", "solimplimit")?);
            tendons.friction_loss.push(element.size_or("frictionloss", 0.0)?);
            tendons.friction_softness.push(softness(element, "solreffriction", "solimpfriction")?);
            tendons.stiffness.push(linear(element, "stiffness")?);
            tendons.damping.push(linear(element, "damping")?);
            tendons.spring_length.push(spring_length(element)?);
        }
        Ok(())
    }

    /// The armature of a tendon. It couples all dofs that move the tendon: the mass matrix has room for that, and the force
    /// that it adds does not depend on velocities, where these are joints on one path to the root.
    fn armature(&mut self, element: &Element, path: &[PathPoint]) -> Result<f64, ModelError> {
        let armature = element.size_or("armature", 0.0)?;
        let body = |point: &PathPoint| match point {
            PathPoint::Joint { joint, .. } => Some(self.model.joints.body[*joint]),
            _ => None,
        };
        let bodies: Vec<Option<usize>> = path.iter().map(body).collect();
        let mut above: Vec<usize> = Vec::new();
        let mut next = bodies.iter().flatten().max().copied();
        while let Some(body) = next {
            above.push(body);
            next = (body > 0).then(|| self.model.bodies.parent[body]);
        }
        if armature > 0.0 && !bodies.iter().all(|body| body.is_some_and(|body| above.contains(&body))) {
            let what = "attribute `armature` of a tendon that is not a fixed one of joints on one path to the root".to_owned();
            self.unsupported.push(Unsupported { place: element.place.clone(), what });
        }
        Ok(armature)
    }

    /// The path of a spatial tendon.
    fn path(&self, element: &Element) -> Result<Vec<PathPoint>, ModelError> {
        let path = element.children.iter().map(|entry| self.path_point(entry)).collect::<Result<Vec<_>, _>>()?;
        check_path(element, &path)?;
        Ok(path)
    }

    /// The joints of a fixed tendon, each with its coefficient.
    fn combination(&self, element: &Element) -> Result<Vec<PathPoint>, ModelError> {
        let mut seen = BTreeSet::new();
        let mut entries = Vec::new();
        for entry in &element.children {
            entry.required("joint")?;
            let Some(joint) = self.scalar_joint(entry, "joint")? else { continue };
            let Some([coefficient]) = entry.numbers::<1>("coef")? else {
                return Err(entry.invalid("a joint of a fixed tendon needs the attribute `coef`"));
            };
            if !seen.insert(joint) {
                return Err(entry.invalid(format!("the joint `{}` is in this tendon twice", self.model.joints.name[joint])));
            }
            entries.push(PathPoint::Joint { joint, coefficient });
        }
        if entries.is_empty() {
            return Err(element.invalid("a fixed tendon needs at least one joint"));
        }
        Ok(entries)
    }

    fn path_point(&self, entry: &Element) -> Result<PathPoint, ModelError> {
        match entry.tag.as_str() {
            "site" => Ok(PathPoint::Site(self.names.required(Kind::Site, entry, "site")?)),
            "geom" => {
                let geom = self.names.required(Kind::Geom, entry, "geom")?;
                if !matches!(self.model.geoms.kind[geom], GeomKind::Sphere | GeomKind::Cylinder) {
                    return Err(entry.invalid("a tendon can only wrap around a sphere or a cylinder"));
                }
                let side = match entry.text("sidesite") {
                    Some("") => None,
                    _ => self.names.optional(Kind::Site, entry, "sidesite")?,
                };
                Ok(PathPoint::Wrap { geom, side })
            }
            _ => match entry.numbers::<1>("divisor")?.unwrap_or([1.0]) {
                [divisor] if divisor > 0.0 => Ok(PathPoint::Pulley(divisor)),
                _ => Err(entry.invalid("the `divisor` of a pulley must be positive")),
            },
        }
    }
}

/// Every branch of a path starts and ends with a site, has two of them, and every wrap lies between two sites.
fn check_path(element: &Element, path: &[PathPoint]) -> Result<(), ModelError> {
    let is_site = |point: &PathPoint| matches!(point, PathPoint::Site(_));
    let branches = path.split(|point| matches!(point, PathPoint::Pulley(_)));
    // A pulley at the very start opens the first branch and leaves nothing before it.
    let leading = usize::from(matches!(path.first(), Some(PathPoint::Pulley(_))));
    for branch in branches.skip(leading) {
        let (Some(first), Some(last)) = (branch.first(), branch.last()) else {
            return Err(element.invalid("a branch of the tendon's path is empty"));
        };
        if !is_site(first) || !is_site(last) || branch.len() < 2 {
            return Err(element.invalid("each branch of a tendon's path must start and end with a site of its own"));
        }
        if branch.windows(2).any(|pair| !is_site(&pair[0]) && !is_site(&pair[1])) {
            return Err(element.invalid("between two wraps of a tendon's path there must be a site"));
        }
    }
    Ok(())
}

/// Lengths between which the spring is slack: one number is both, and -1 stands for the length at the rest of the joints'
/// springs.
fn spring_length(element: &Element) -> Result<Option<[f64; 2]>, ModelError> {
    let Some(list) = element.list("springlength", 2)? else { return Ok(None) };
    let lengths = [list[0], list[list.len() - 1]];
    if lengths[0] == -1.0 && lengths[1] == -1.0 {
        return Ok(None);
    }
    if lengths[0] > lengths[1] {
        return Err(element.invalid("`springlength` expects one length, or two in ascending order"));
    }
    Ok(Some(lengths))
}
