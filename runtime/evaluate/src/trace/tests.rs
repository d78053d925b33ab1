use super::*;

/// Two muscles, a root and a hinge, one foot, one term: three control steps.
pub(crate) fn trace() -> Trace {
    let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into() };
    let columns = |names: &[&str], unit: &str| names.iter().map(|name| column(name, unit)).collect::<Vec<_>>();
    let muscle = |name: &str, family: &str| Muscle { name: name.into(), family: family.into(), peak_force: 100.0 };
    let mut positions = columns(&["root.x", "root.y", "root.z"], "m");
    positions.extend(columns(&["root.qw", "root.qx", "root.qy", "root.qz"], ""));
    positions.push(column("knee", "rad"));
    let foot = ["f.force.x", "f.force.y", "f.force.z", "f.pressure.x", "f.pressure.y", "f.pressure.z", "f.torque"];
    let block = |quantity, columns| Block { quantity, columns };
    let layout = Layout {
        period: 0.01,
        mass: 70.0,
        gravity: 9.81,
        root_axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        families: vec!["Calves".into(), "Glutes".into()],
        muscles: vec![muscle("soleus_l", "Calves"), muscle("gmax_l", "Glutes")],
        feet: vec!["f".into()],
        blocks: vec![
            block(Quantity::Activations, columns(&["soleus_l", "gmax_l"], "")),
            block(Quantity::Positions, positions),
            block(Quantity::GroundReactions, columns(&foot, "N")),
            block(Quantity::Terms, columns(&["alive"], "")),
        ],
    };
    let mut trace = Trace::new(Arc::new(layout));
    trace.origin = Origin { task: "toy".into(), policy: "zero".into(), ended_by: "horizon".into(), ..Origin::default() };
    let half = core::f64::consts::FRAC_1_SQRT_2;
    for step in 0..4 {
        let at = f64::from(step);
        let values = [
            vec![0.25 * at, 1.0 / 3.0],
            // It stands a quarter turn to its left.
            vec![at, 2.0, 0.9, half, 0.0, 0.0, half, -0.5],
            vec![1.0, 2.0, 700.0, 0.1, 0.2, 0.0, 3.0],
            vec![5.0],
        ]
        .concat();
        let layout = Arc::clone(trace.layout());
        trace.push(&Row::new(&layout, &values, step == 0));
    }
    trace
}

#[test]
fn states_have_one_row_more_than_steps() {
    let trace = trace();
    assert_eq!((trace.rows(), trace.rows_of(Quantity::Activations), trace.rows_of(Quantity::Terms)), (4, 4, 3));
    assert_eq!(trace.column(Quantity::Activations, 0).unwrap(), [0.0, 0.25, 0.5, 0.75]);
    assert_eq!(trace.column(Quantity::Terms, 0).unwrap(), [5.0; 3]);
    assert_eq!(trace.column(Quantity::Actions, 0), None);
    assert_eq!(trace.block(Quantity::Feet).count(), 0);
}

#[test]
fn a_trace_is_replayed_as_it_was() {
    let trace = trace();
    let mut again = Trace::new(Arc::clone(trace.layout()));
    again.origin = trace.origin.clone();
    trace.replay(|row| again.push(row));
    assert_eq!(again, trace);
}

#[test]
fn an_archive_reads_back_and_has_the_same_bytes() {
    let trace = trace();
    let bytes = trace.archive().unwrap();
    assert_eq!(bytes, trace.archive().unwrap());
    assert_eq!(Trace::read(&bytes).unwrap(), trace);
    for cut in [0, 10, bytes.len() / 2, bytes.len() - 1] {
        assert!(Trace::read(&bytes[..cut]).is_err(), "{cut}");
    }
}

#[test]
fn a_trace_of_steps_that_follow_nothing_reads_back() {
    let mut trace = trace();
    let column = Column { name: "landmarks".into(), unit: "m".into() };
    let block = Block { quantity: Quantity::TrackingError, columns: vec![column] };
    Arc::make_mut(&mut trace.layout).blocks.insert(3, block);
    trace.blocks.insert(3, vec![0.5, f64::NAN, 0.25, f64::NAN]);
    let read = |trace: &Trace| Trace::read(&trace.archive().unwrap());
    let found = read(&trace).unwrap().column(Quantity::TrackingError, 0).unwrap();
    assert_eq!(found.iter().map(|error| error.is_nan()).collect::<Vec<_>>(), [false, true, false, true]);
    trace.blocks[3][0] = f64::INFINITY;
    assert!(read(&trace).unwrap_err().to_string().contains("is inf, which is not a finite number"));
}

#[test]
fn an_archive_of_something_else_is_refused() {
    let trace = trace();
    let error = |change: &dyn Fn(&mut Trace)| {
        let mut other = trace.clone();
        change(&mut other);
        Trace::read(&other.archive().unwrap()).unwrap_err().to_string()
    };
    let nan = error(&|trace| trace.blocks[0][0] = f64::NAN);
    assert_eq!(nan, "its array `activations` row 0, column 0 (from 0) is NaN, which is not a finite number");
    let layout = |change: &dyn Fn(&mut Layout)| error(&|trace| change(Arc::make_mut(&mut trace.layout)));
    let fewer = layout(&|layout| drop(layout.muscles.pop()));
    assert_eq!(fewer, "is not a trace: its layout has 2 columns of `activations`, expected 1");
    let feet = layout(&|layout| layout.feet.push("g".into()));
    assert_eq!(feet, "is not a trace: its layout has 7 columns of `ground_reactions`, expected 14");
    assert_eq!(layout(&|layout| layout.period = 0.0), "is not a trace: its layout has a control step of 0 s");
    let bytes = trace.archive().unwrap();
    let description = crate::npz::NpzReader::new(&bytes).unwrap().entry("trace.json", 1 << 20).unwrap();
    let description = String::from_utf8(description).unwrap().replace("\"rows\": 4", "\"rows\": 1000000000000");
    let mut endless = crate::npz::NpzWriter::new(std::io::Cursor::new(Vec::new()));
    endless.file("trace.json", description.as_bytes()).unwrap();
    let endless = Trace::read(&endless.finish().unwrap().into_inner()).unwrap_err().to_string();
    assert_eq!(endless, "it describes 1000000000000 rows, more than are read");
    let mut large = trace.clone();
    large.blocks.iter_mut().for_each(Vec::clear);
    large.rows = 0;
    assert_eq!(Trace::read(&large.archive().unwrap()).unwrap().rows(), 0);
}

#[test]
fn opensim_reads_angles_in_degrees_and_y_up() {
    let files = opensim(&trace());
    let file = |name: &str| files.iter().find(|file| file.name == name).unwrap().text.clone();
    insta::assert_snapshot!(file("coordinates.mot"), @r"
    toy_coordinates.mot
    version=1
    nRows=4
    nColumns=8
    inDegrees=yes
    endheader
    time	pelvis_tilt	pelvis_list	pelvis_rotation	pelvis_tx	pelvis_ty	pelvis_tz	knee
    0	0	0	90	0	0.9	-2	-28.64788975654116
    0.01	0	0	90	1	0.9	-2	-28.64788975654116
    0.02	0	0	90	2	0.9	-2	-28.64788975654116
    0.03	0	0	90	3	0.9	-2	-28.64788975654116
    ");
    insta::assert_snapshot!(file("activations.sto"), @r"
    toy_activations.sto
    version=1
    nRows=4
    nColumns=3
    inDegrees=no
    endheader
    time	soleus_l	gmax_l
    0	0	0.3333333333333333
    0.01	0.25	0.3333333333333333
    0.02	0.5	0.3333333333333333
    0.03	0.75	0.3333333333333333
    ");
    let ground = file("ground_reactions.mot");
    insta::assert_snapshot!(ground.lines().skip(5).take(3).collect::<Vec<_>>().join("\n"), @r"
    endheader
    time	ground_force_f_vx	ground_force_f_vy	ground_force_f_vz	ground_force_f_px	ground_force_f_py	ground_force_f_pz	ground_torque_f_x	ground_torque_f_y	ground_torque_f_z
    0	1	700	-2	0.1	0	-0.2	0	3	0
    ");
    assert_eq!(files.len(), 3);
}

#[test]
fn names_of_a_hostile_trace_stay_in_their_cells() {
    let mut trace = trace();
    trace.origin.task = "toy\nendheader".into();
    Arc::make_mut(&mut trace.layout).blocks[0].columns[0].name = "a\tb\u{1b}[2J".into();
    let text = &opensim(&trace)[0].text;
    assert!(text.starts_with("toy\\nendheader_activations.sto\nversion=1\n"), "{text}");
    assert!(text.contains("\ntime\ta\\tb\\u001b[2J\tgmax_l\n"), "{text}");
}

#[test]
fn angles_of_the_pelvis_are_those_of_its_own_sequence() {
    // OpenSim's ground from tilt, list and rotation, turned back into the world.
    let [tilt, list, rotation] = [0.2_f64, -0.3, 0.7];
    let about = |axis: nalgebra::Vector3<f64>, angle| nalgebra::Rotation3::new(axis * angle).into_inner();
    let (x, y, z) = (nalgebra::Vector3::x(), nalgebra::Vector3::y(), nalgebra::Vector3::z());
    let turn = about(z, tilt) * about(x, list) * about(y, rotation);
    let to_world = |axis: nalgebra::Vector3<f64>| nalgebra::Vector3::new(axis.x, -axis.z, axis.y);
    let [forward, up, right] = [0, 1, 2].map(|column| to_world(turn.column(column).into()));
    let found = opensim::pelvis_angles(nalgebra::Matrix3::from_columns(&[forward, -right, up]));
    for (found, expected) in found.into_iter().zip([tilt, list, rotation]) {
        assert!((found - expected.to_degrees()).abs() < 1e-9, "{found} is not {expected} rad");
    }
}

#[test]
fn quantities_are_named_and_unknown_ones_listed() {
    assert_eq!(quantities("terms, activations,terms"), Ok(vec![Quantity::Activations, Quantity::Terms]));
    assert_eq!(quantities("all").map(|all| all.len()), Ok(Quantity::ALL.len()));
    let message = quantities("activation").unwrap_err().to_string();
    assert!(
        message.starts_with("there is no quantity `activation` in a trace; choose of: excitations, activations"),
        "{message}"
    );
    for quantity in Quantity::ALL {
        assert_eq!(quantity.name().parse(), Ok(quantity));
        assert_eq!(serde_json::to_string(&quantity).unwrap(), format!("\"{quantity}\""));
    }
}
