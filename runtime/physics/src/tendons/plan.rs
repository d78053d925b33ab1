//! What tendon paths need, decided once per model.
//!
//! Segments and wraps that lie on one rigid group of bodies never change: they enter as a constant length. What remains is a
//! list of sites to place, straight segments between them, wraps between two of them, and for each of these the lines of
//! force it can exert. The number of lines is fixed: a wrap that is not touched lays the same straight line into both of
//! its slots, and the obstacle's body feels it twice with opposite signs.

use super::wrap::{WrapShape, WrappingSurface, bend};
use crate::{
    kinematics::{self, Kinematics},
    model::{GeomKind, Model, PathPoint},
    rotation::MINIMUM,
    spatial::norm,
    state::State,
};
use core::ops::Range;
use nalgebra::Vector3;

/// A site that moves relative to another one on its path.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    pub body: usize,
    pub local: Vector3<f64>,
}

/// A straight segment between two points.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub tendon: usize,
    /// One over the divisor of the pulley before it.
    pub weight: f64,
    pub ends: [usize; 2],
    pub lines: Range<usize>,
}

/// A site, an obstacle, a site.
#[derive(Debug, Clone)]
pub(crate) struct Wrap {
    pub tendon: usize,
    pub weight: f64,
    pub ends: [usize; 2],
    pub geom: usize,
    pub shape: WrapShape,
    pub radius: f64,
    pub side: Side,
    /// Lines from the first point to the obstacle, and from the obstacle to the second.
    pub lines: [Range<usize>; 2],
}

/// The side point of a wrap.
#[derive(Debug, Clone)]
pub(crate) enum Side {
    None,
    /// Fixed in the obstacle's frame, m.
    Fixed(Vector3<f64>),
    /// On another body.
    Moving(usize),
}

/// A joint whose coordinate enters the length of a fixed tendon.
#[derive(Debug, Clone)]
pub(crate) struct JointTerm {
    /// Its coordinate in the position vector.
    pub address: usize,
    pub dof: usize,
    pub coefficient: f64,
}

/// The bodies that a line of action pulls together.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub from: usize,
    pub to: usize,
    /// Root of the tree whose centre of mass the line's moment refers to.
    pub root: usize,
    pub weight: f64,
}

/// Fixed topology of all tendons.
#[derive(Debug, Clone, Default)]
pub(crate) struct Plan {
    pub points: Vec<Point>,
    pub segments: Vec<Segment>,
    pub wraps: Vec<Wrap>,
    pub lines: Vec<Line>,
    /// Lines of each tendon.
    pub tendon_lines: Vec<Range<usize>>,
    pub joint_terms: Vec<JointTerm>,
    /// Joint terms of each tendon; none for spatial ones.
    pub tendon_joints: Vec<Range<usize>>,
    /// Part of each tendon's length that never changes, m.
    pub constant_length: Vec<f64>,
}

impl Plan {
    pub fn new(model: &Model) -> Self {
        let mut reference = Kinematics::new(model);
        kinematics::update(model, &State::new(model), &mut reference);
        let mut planner = Planner { model, reference, point_of_site: vec![None; model.sites.body.len()], plan: Self::default() };
        for tendon in 0..model.tendons.path.len() {
            let first = planner.plan.lines.len();
            planner.plan.constant_length.push(0.0);
            planner.tendon(tendon);
            planner.plan.tendon_lines.push(first..planner.plan.lines.len());
            let first = planner.plan.tendon_joints.last().map_or(0, |terms: &Range<usize>| terms.end);
            planner.plan.tendon_joints.push(first..planner.plan.joint_terms.len());
        }
        planner.plan
    }
}

struct Planner<'a> {
    model: &'a Model,
    reference: Kinematics<f64>,
    point_of_site: Vec<Option<usize>>,
    plan: Plan,
}

impl Planner<'_> {
    fn tendon(&mut self, tendon: usize) {
        let mut weight = 1.0;
        let mut last_site = None;
        let mut obstacle = None;
        for point in &self.model.tendons.path_points[self.model.tendons.path[tendon].clone()] {
            match *point {
                PathPoint::Pulley(divisor) => {
                    weight = 1.0 / divisor;
                    last_site = None;
                }
                PathPoint::Wrap { geom, side } => obstacle = Some((geom, side)),
                PathPoint::Joint { joint, coefficient } => {
                    let joints = &self.model.joints;
                    let (address, dof) = (joints.position_address[joint], joints.dof_address[joint]);
                    self.plan.joint_terms.push(JointTerm { address, dof, coefficient });
                }
                PathPoint::Site(site) => {
                    match (last_site, obstacle.take()) {
                        (Some(start), Some(around)) => self.wrap(tendon, weight, [start, site], around),
                        (Some(start), None) => self.segment(tendon, weight, [start, site]),
                        (None, _) => {}
                    }
                    last_site = Some(site);
                }
            }
        }
    }

    fn segment(&mut self, tendon: usize, weight: f64, sites: [usize; 2]) {
        let [from, to] = sites.map(|site| self.model.sites.body[site]);
        if self.rigid(from, to) {
            let [start, end] = self.place(sites);
            self.plan.constant_length[tendon] += weight * norm(&(end - start));
            return;
        }
        let lines = self.lines(from, to, weight);
        let ends = sites.map(|site| self.point(site));
        self.plan.segments.push(Segment { tendon, weight, ends, lines });
    }

    fn wrap(&mut self, tendon: usize, weight: f64, sites: [usize; 2], (geom, side): (usize, Option<usize>)) {
        let [from, to] = sites.map(|site| self.model.sites.body[site]);
        let body = self.model.geoms.body[geom];
        let radius = self.model.geoms.size[geom].x;
        let shape = if self.model.geoms.kind[geom] == GeomKind::Sphere { WrapShape::Sphere } else { WrapShape::Cylinder };
        let side = match side {
            None => Side::None,
            Some(site) if self.rigid(self.model.sites.body[site], body) => {
                let offset = self.reference.site_position(self.model, site) - self.reference.geom_position[geom];
                Side::Fixed(self.reference.geom_rotation[geom].tr_mul(&offset))
            }
            Some(site) => Side::Moving(self.point(site)),
        };
        if self.rigid(from, body)
            && self.rigid(to, body)
            && let Some(length) = self.rigid_wrap(sites, geom, shape, &side)
        {
            self.plan.constant_length[tendon] += weight * length;
            return;
        }
        let lines = [self.lines(from, body, weight), self.lines(body, to, weight)];
        let ends = sites.map(|site| self.point(site));
        self.plan.wraps.push(Wrap { tendon, weight, ends, geom, shape, radius, side, lines });
    }

    /// Length of a wrap that moves as one rigid group with both of its sites, unless its side point does not.
    fn rigid_wrap(&self, sites: [usize; 2], geom: usize, shape: WrapShape, side: &Side) -> Option<f64> {
        let side = match side {
            Side::None => None,
            Side::Fixed(local) => Some(*local),
            Side::Moving(_) => return None,
        };
        let obstacle = WrappingSurface {
            shape,
            position: self.reference.geom_position[geom],
            rotation: self.reference.geom_rotation[geom],
            radius: self.model.geoms.size[geom].x,
            side,
        };
        let [start, end] = self.place(sites);
        Some(match bend(&start, &end, &obstacle) {
            Some(bend) => norm(&(bend.first - start)) + bend.arc + norm(&(end - bend.second)),
            None => norm(&(end - start)),
        })
    }

    /// Whether two bodies never move relative to each other.
    fn rigid(&self, a: usize, b: usize) -> bool {
        self.model.bodies.weld[a] == self.model.bodies.weld[b]
    }

    fn place(&self, sites: [usize; 2]) -> [Vector3<f64>; 2] {
        sites.map(|site| self.reference.site_position(self.model, site))
    }

    fn point(&mut self, site: usize) -> usize {
        if let Some(point) = self.point_of_site[site] {
            return point;
        }
        let point = self.plan.points.len();
        let sites = &self.model.sites;
        self.plan.points.push(Point { body: sites.body[site], local: sites.position[site] });
        self.point_of_site[site] = Some(point);
        point
    }

    /// Lines for a segment between two bodies: none if they move together, one within a tree or to the world, and one for
    /// each tree if it joins two, because each tree has its own point of reference.
    fn lines(&mut self, from: usize, to: usize, weight: f64) -> Range<usize> {
        let first = self.plan.lines.len();
        let root = |body: usize| self.model.bodies.root[body];
        let still = |body: usize| self.model.bodies.weld[body] == 0;
        let mut add = |from: usize, to: usize, root: usize| self.plan.lines.push(Line { from, to, root, weight });
        if self.model.bodies.weld[from] == self.model.bodies.weld[to] || weight.abs() < MINIMUM {
        } else if still(to) || (root(from) == root(to) && !still(from)) {
            add(from, if still(to) { 0 } else { to }, root(from));
        } else if still(from) {
            add(0, to, root(to));
        } else {
            add(from, 0, root(from));
            add(0, to, root(to));
        }
        first..self.plan.lines.len()
    }
}
