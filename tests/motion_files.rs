//! The reference motions of this repository: each fits the body, keeps its feet on the ground, and is what its name promises.

use msk_compiler::diagnostics::FileId;
use msk_compiler::motion::{Motion, RootPart, problems, read};
use msk_runtime::bodies;
use msk_runtime::inspect::{MotionLimits, MotionReport, inspect_motion};
use msk_runtime::library::{BodyLibrary, BoundBody, FileLoader};
use std::path::Path;
use std::sync::OnceLock;

const NAMES: [&str; 5] = ["walk", "run", "stairs", "squat", "sit"];

fn body() -> &'static BoundBody {
    static BODY: OnceLock<BoundBody> = OnceLock::new();
    BODY.get_or_init(|| {
        let path = bodies::builtin("human").unwrap().path;
        let library = BodyLibrary::default();
        let compilation = msk_compiler::compile(&path, &FileLoader, &library).unwrap_or_else(|report| panic!("{report}"));
        library.bind(&compilation.bodies[0]).unwrap()
    })
}

fn motion(name: &str) -> Motion {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("motions/{name}.csv"));
    let motion = read(FileId::default(), &std::fs::read_to_string(path).unwrap()).unwrap();
    let BoundBody { model, body, .. } = body();
    assert_eq!(problems(&motion, FileId::default(), &body.vocabulary(model)), []);
    motion
}

fn report(motion: &Motion) -> MotionReport {
    inspect_motion(&body().model, &body().body, motion)
}

/// Highest and lowest angle of a joint, deg.
fn extremes(report: &MotionReport, joint: &str) -> [f64; 2] {
    report.columns.iter().find(|column| column.name == joint).unwrap().values.map(f64::to_degrees)
}

#[test]
fn every_motion_is_within_the_limits() {
    for name in NAMES {
        let motion = motion(name);
        assert_eq!(motion.name, name);
        assert!(motion.source.contains("fitted to our body"), "{name}");
        let report = report(&motion);
        assert_eq!(report.faults(&MotionLimits::default()), [""; 0], "{name}");
        assert_eq!(report.feet.len(), 2, "{name}");
    }
}

#[test]
fn sides_are_those_of_the_movement() {
    for (name, later) in [("walk", true), ("run", true), ("stairs", true), ("squat", false), ("sit", false)] {
        let (difference, found) = report(&motion(name)).sides.unwrap();
        assert!(difference < 1e-9 && found == later, "{name}: {difference} {found}");
    }
}

#[test]
fn walking_and_running_go_as_published() {
    let walk = report(&motion("walk"));
    let [stride, speed] = walk.stride.unwrap();
    assert!((1.25..1.5).contains(&stride) && (1.1..1.4).contains(&speed), "{stride} m, {speed} m/s");
    // Two feet stand for three fifths of the cycle each; knees bend by some sixty degrees in swing.
    assert!(walk.feet.iter().all(|foot| (0.52..0.66).contains(&foot.stance)), "{:?}", walk.feet);
    let [_, knee] = extremes(&walk, "knee_angle_r");
    let [back, front] = extremes(&walk, "hip_flexion_r");
    assert!((55.0..70.0).contains(&knee) && (-20.0..-8.0).contains(&back) && (22.0..36.0).contains(&front));
    let run = report(&motion("run"));
    assert!(run.stride.unwrap()[1] > 2.5, "{:?}", run.stride);
    // A run has flights: neither foot stands for half of the time.
    assert!(run.feet.iter().all(|foot| foot.stance < 0.42), "{:?}", run.feet);
    assert!(extremes(&run, "knee_angle_l")[1] > 80.0);
}

#[test]
fn stairs_climb_two_steps_a_turn_and_a_squat_comes_back() {
    let stairs = motion("stairs");
    let advance = |part| stairs.advance(stairs.root(part).unwrap());
    // The steps of the task: 15 cm by 50 cm.
    assert!((advance(RootPart::Height) - 0.30).abs() < 1e-3 && (advance(RootPart::X) - 1.0).abs() < 5e-3);
    for (name, least) in [("squat", 0.35), ("sit", 0.3)] {
        let motion = motion(name);
        let [low, high] = motion.range(motion.root(RootPart::Height).unwrap());
        assert!(high - low > least, "{name}: {low} .. {high}");
    }
}

#[test]
fn a_gait_that_slides_or_sinks_is_reported() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("motions/walk.csv")).unwrap();
    let shortened = text.replace("# duration: 1.1 s", "# duration: 1.1 s\n# a remark");
    assert_eq!(read(FileId::default(), &shortened).unwrap().digest(), motion("walk").digest());
    // A pelvis that goes on too slowly drags its feet; one that is too low pushes them into the ground.
    let change = |column: &str, change: fn(f64) -> f64| {
        let heading = text.lines().find(|line| line.starts_with("phase")).unwrap();
        let index = heading.split(", ").position(|cell| cell.starts_with(column)).unwrap();
        let row = |line: &str| {
            let mut cells: Vec<String> = line.split(", ").map(str::to_owned).collect();
            cells[index] = change(cells[index].parse::<f64>().unwrap()).to_string();
            cells.join(", ") + "\n"
        };
        let lines =
            text.lines().map(|line| if line.starts_with(|c: char| c.is_ascii_digit()) { row(line) } else { format!("{line}\n") });
        report(&read(FileId::default(), &lines.collect::<String>()).unwrap()).faults(&MotionLimits::default())
    };
    let slow = change("root.x", |x| 0.9 * x);
    assert!(slow.iter().any(|fault| fault.contains("slides by")), "{slow:?}");
    let low = change("root.height", |z| z - 0.02);
    assert!(low.iter().any(|fault| fault.contains("penetrates the ground")), "{low:?}");
}
