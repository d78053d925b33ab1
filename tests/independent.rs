//! The parts of the simulator that are written by hand because general libraries cannot exploit their structure, held to
//! those libraries: contacts with ellipsoids to parry's GJK and EPA, the constrained acceleration on the tree's own sparsity
//! to a dense Cholesky factorisation by faer.

use crate::support;

use faer::{Mat, Side, linalg::solvers::Solve};
use msk_physics::model::{GeomKind, Model};
use msk_physics::{self as physics, State, Workspace};
use parry3d_f64::{
    math::{Pose, Rotation, Vector},
    query::details::contact_support_map_support_map,
    shape::SupportMap,
};
use support::{SplitMix, repository};

/// An ellipsoid, or the segment of a capsule rounded by its radius, as a support map.
struct Convex {
    kind: GeomKind,
    size: Vector,
}

impl SupportMap for Convex {
    fn local_support_point(&self, direction: Vector) -> Vector {
        let direction = direction.normalize_or_zero();
        if self.kind == GeomKind::Ellipsoid {
            let scaled = direction * self.size;
            return self.size * scaled / scaled.length();
        }
        direction * self.size.x + Vector::Z * self.size.y * direction.z.signum()
    }
}

/// Two free bodies whose shapes may touch.
fn pair_of(first: &str, second: &str) -> Model {
    let text = format!(
        r#"<mujoco><worldbody>
             <body><freejoint/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/><geom name="a" {first}/></body>
             <body><freejoint/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/><geom name="b" {second}/></body>
           </worldbody><contact><pair geom1="a" geom2="b" margin="1"/></contact></mujoco>"#
    );
    Model::from_mjcf(&text).expect("a valid model")
}

/// Signed distance by parry, which stops within some 0.1 mm of it for smooth shapes.
fn parry_distance(model: &Model, state: &State<f64>) -> Option<f64> {
    let place = |index: usize| {
        let q = &state.position[7 * index..7 * index + 7];
        let rotation = Rotation::from_xyzw(q[4], q[5], q[6], q[3]).normalize();
        Pose::from_parts(Vector::new(q[0], q[1], q[2]), rotation)
    };
    let shape = |geom: usize| {
        let size = model.geoms.size[geom];
        Convex { kind: model.geoms.kind[geom], size: Vector::new(size.x, size.y, size.z) }
    };
    let between = place(0).inv_mul(&place(1));
    contact_support_map_support_map(&between, &shape(0), &shape(1), 1.0).map(|contact| contact.dist)
}

#[test]
fn contacts_with_ellipsoids_are_where_parry_finds_them() {
    let capsule = r#"type="capsule" size="0.05 0.2""#;
    let egg = r#"type="ellipsoid" size="0.11 0.13 0.2""#;
    let disc = r#"type="ellipsoid" size="0.15 0.05 0.12""#;
    let mut random = SplitMix(7);
    for (first, second) in [(capsule, egg), (egg, disc)] {
        let model = pair_of(first, second);
        let mut workspace = Workspace::<f64>::new(&model);
        let (mut apart, mut overlapping) = (0, 0);
        for case in 0..300 {
            let mut state = State::<f64>::new(&model);
            state.position.fill_with(|| random.between(-1.0, 1.0));
            for coordinate in [0, 1, 2, 7, 8, 9] {
                state.position[coordinate] *= 0.2;
            }
            physics::forward(&model, &state, &mut workspace).expect("a sound state");
            let contacts = &workspace.lanes[0].constraints.contacts;
            let Some(theirs) = parry_distance(&model, &state) else { continue };
            assert_eq!(contacts.len(), 1, "case {case}: {theirs} m apart by parry");
            let ours = contacts[0].distance;
            // GJK measures between points of the shapes and EPA to a polytope inside their difference: both come from above.
            let excess = theirs - ours;
            assert!((-1e-9..2e-4).contains(&excess), "case {case}: {ours} m, by parry {theirs} m");
            if ours < 0.0 { overlapping += 1 } else { apart += 1 }
        }
        assert!(apart > 30 && overlapping > 30, "{apart} apart, {overlapping} overlapping: too few to mean anything");
    }
}

/// The mass matrix as a dense one.
fn dense_mass(model: &Model, workspace: &Workspace<f64>) -> Mat<f64> {
    let mut mass = Mat::zeros(model.nv, model.nv);
    for (dof, row) in model.dofs.row.iter().enumerate() {
        for entry in row.clone() {
            let column = model.dofs.column[entry];
            mass[(dof, column)] = workspace.inertia.matrix[entry];
            mass[(column, dof)] = workspace.inertia.matrix[entry];
        }
    }
    mass
}

/// At the optimum the pulling rows are linear springs: (M + J'DJ) a = f + J'D a_ref + J' f_clipped.
#[test]
fn the_constrained_acceleration_solves_the_dense_system() {
    let model = Model::from_file(repository("bodies/models/human416.xml")).expect("the body");
    let mut workspace = Workspace::<f64>::new(&model);
    let mut random = SplitMix(11);
    let mut contacts = 0;
    for case in 0..12 {
        let mut state = support::draw(&model, &mut random);
        state.position[2] = 0.2 + 0.05 * f64::from(case);
        physics::forward(&model, &state, &mut workspace).expect("a sound state");
        let constraints = &workspace.lanes[0].constraints;
        let rows = &constraints.rows;
        contacts += constraints.contacts.len();

        let mut hessian = dense_mass(&model, &workspace);
        let mut right = Mat::from_fn(model.nv, 1, |dof, _| workspace.forces.smooth[dof]);
        for row in 0..rows.len() {
            let jacobian = constraints.jacobian_row(&model, row);
            let pulls = rows.force[row] > rows.lower[row] && rows.force[row] < rows.upper[row];
            let (weight, push) =
                if pulls { (rows.weight[row], rows.weight[row] * rows.reference[row]) } else { (0.0, rows.force[row]) };
            for (dof, &value) in jacobian.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                right[(dof, 0)] += value * push;
                for (other, &factor) in jacobian.iter().enumerate() {
                    hessian[(dof, other)] += weight * value * factor;
                }
            }
        }
        let solution = hessian.llt(Side::Lower).expect("positive definite").solve(&right);
        let scale = workspace.acceleration.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        for dof in 0..model.nv {
            let (ours, theirs) = (workspace.acceleration[dof], solution[(dof, 0)]);
            assert!((ours - theirs).abs() < 1e-9 * scale, "case {case}, dof {dof}: {ours}, dense {theirs}");
        }
    }
    assert!(contacts > 20, "{contacts} contacts: too few to mean anything");
}

/// A capsule whose axis just misses a cylinder's rim: the search for their distance once took a flat simplex for one that holds
/// the origin, and what it then took for the depth was 0.035 mm too much.
#[test]
fn cores_that_barely_miss_each_other_do_not_overlap() {
    let model = Model::from_mjcf(
        r#"<mujoco><worldbody>
            <geom type="cylinder" size="0.193438 0.164755" pos="0.011256535632642149 0.5938040072186648 -0.32945948065528785"
                quat="-0.14812658602845963 0.6478760144872469 0.40807333245528427 -0.6259323763015562"/>
            <body pos="-0.16727689011696217 0.2948748802255237 -0.23527326569919652"
                quat="-0.23742073041552547 0.7113365232319515 -0.09413248019069183 -0.6548059435118059">
                <freejoint/><geom type="capsule" size="0.178464 0.162777"/>
            </body>
        </worldbody></mujoco>"#,
    )
    .expect("two shapes");
    let mut workspace = Workspace::<f64>::new(&model);
    let mut random = SplitMix(3);
    // The largest gap over all directions, by a search over them; moving a shape changes it by no more than the way.
    let exact = -0.072_291_58;
    for case in 0..2000 {
        let mut state = State::<f64>::new(&model);
        let shift: [f64; 3] = std::array::from_fn(|_| random.between(-3e-6, 3e-6));
        state.position.iter_mut().zip(shift).for_each(|(place, shift)| *place += shift);
        physics::forward(&model, &state, &mut workspace).expect("a state of two shapes");
        let contacts = &workspace.lanes[0].constraints.contacts;
        let way = shift.iter().map(|part| part * part).sum::<f64>().sqrt();
        let deepest = contacts.iter().map(|contact| contact.distance).fold(0.0, f64::min);
        assert!((deepest - exact).abs() < way + 1e-7, "case {case}: {deepest} m, not {exact} m");
    }
}
