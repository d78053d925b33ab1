//! Probing tells what shows only with the model at hand, tells it where it stands, and is silent about the benchmark.

use msk_compiler::compile;
use msk_compiler::diagnostics::{Diagnostic, Stage, codes};
use msk_compiler::files::{LoadError, Loader};
use msk_compiler::task::CompiledTask;
use msk_evaluate::probe;
use msk_runtime::library::{BodyLibrary, FileLoader};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

struct One(String);

impl Loader for One {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if path == Path::new("example.msk") { Ok(self.0.clone()) } else { Err(LoadError::Missing(path.to_path_buf())) }
    }
}

/// What probing tells of a task of these statements, and the text of the main place of each.
fn findings(statements: &str) -> Vec<(Diagnostic, String)> {
    findings_by(statements, |tasks| probe::tasks(tasks, bodies()))
}

/// What playing at rest tells of a task of these statements.
fn played(statements: &str) -> Vec<Diagnostic> {
    findings_by(statements, |tasks| probe::episodes(tasks, bodies(), &|| {}))
        .into_iter()
        .map(|(diagnostic, _)| diagnostic)
        .collect()
}

fn findings_by(statements: &str, look: impl Fn(&[Arc<CompiledTask>]) -> Vec<Diagnostic>) -> Vec<(Diagnostic, String)> {
    let mut text = format!("task example {{\nbody human\n{statements}\n");
    for (word, line) in [
        ("reward", "reward { 1 tall = pelvis.height / 1 m }"),
        ("control", "control 100 Hz"),
        ("horizon", "horizon 1000 steps"),
        ("observe", "observe { pelvis.height }"),
        ("init", "init { pose neutral }"),
        ("success", "success survived"),
    ] {
        if !statements.lines().any(|line| line.starts_with(word)) {
            text = format!("{text}{line}\n");
        }
    }
    let text = format!("{text}}}\n");
    let compilation =
        compile(Path::new("example.msk"), &One(text), bodies()).unwrap_or_else(|report| panic!("{statements}:\n{report}"));
    let found = look(&compilation.tasks);
    let place = |diagnostic: &Diagnostic| diagnostic.span().of(compilation.sources.text(diagnostic.file())).to_owned();
    found.into_iter().map(|diagnostic| (diagnostic.clone(), place(&diagnostic))).collect()
}

fn codes_of(statements: &str) -> Vec<&'static str> {
    findings(statements).iter().map(|(diagnostic, _)| diagnostic.code.id).collect()
}

#[test]
fn a_world_that_is_drawn_rarely_is_probed_too() {
    // The post stands in the body in one of twenty episodes, and in none of the first three.
    let post =
        "random place = uniform(0.2 m .. 4 m)\nscene { ground; box post { size [20 cm, 20 cm, 1 m], at [place, 0, 0.5 m] } }";
    let found = findings(post);
    let starts_inside = |(diagnostic, _): &(Diagnostic, String)| diagnostic.code.id == codes::probing::STARTS_INSIDE.id;
    assert!(found.iter().any(starts_inside), "{found:?}");
    let free = post.replace("0.2 m ..", "1 m ..");
    assert!(!findings(&free).iter().any(starts_inside));
}

#[test]
fn examples_of_codes_cause_them_and_fixes_do_not() {
    for code in codes::probing::ALL.iter().filter(|code| code.lint.unwrap().stage == Stage::Probe) {
        assert!(codes_of(code.example).contains(&code.id), "{}: {:?}", code.id, findings(code.example));
        assert_eq!(codes_of(code.fix), [""; 0], "{}: {:?}", code.id, findings(code.fix));
    }
}

#[test]
fn a_penetration_is_reported_with_names_and_millimetres() {
    let findings = findings("init { pose neutral\n root { height 0.8 m } }");
    let (overlap, place) = findings.iter().find(|(diagnostic, _)| diagnostic.code.id == "W0530").unwrap();
    assert_eq!(place, "init");
    assert!(overlap.message.contains("`floor` penetrates `l_bofoot_col2` by 1"), "{}", overlap.message);
}

#[test]
fn ends_that_hold_at_the_first_step_are_reported_where_they_stand() {
    let statements = "init { pose neutral\n root { height on ground } }\n\
        terminate { low when pelvis.height < 1.2 m }\nsuccess com.height > 0.5 m";
    let findings = findings(statements);
    let places: Vec<(&str, &str)> = findings.iter().map(|(diagnostic, place)| (diagnostic.code.id, place.as_str())).collect();
    assert_eq!(places, [("W0512", "pelvis.height < 1.2 m"), ("W0512", "com.height > 0.5 m")]);
    assert!(findings[0].0.message.contains("3 of 3 episodes"), "{}", findings[0].0.message);
}

#[test]
fn examples_of_codes_that_take_an_episode_cause_them_and_fixes_and_reasons_do_not() {
    let codes_of = |statements: &str| played(statements).iter().map(|diagnostic| diagnostic.code.id).collect::<Vec<_>>();
    for code in codes::probing::ALL.iter().filter(|code| code.lint.unwrap().stage == Stage::Play) {
        assert_eq!(codes_of(code.example), [code.id], "{}: {:?}", code.id, played(code.example));
        assert_eq!(codes_of(code.fix), [""; 0], "{}: {:?}", code.id, played(code.fix));
        let allow = format!("allow {} \"on purpose\"\n", code.lint.unwrap().name);
        assert_eq!(codes_of(&(allow.clone() + code.example)), [""; 0]);
        // An episode that shows nothing to allow makes the `allow` needless.
        assert_eq!(codes_of(&(allow + code.fix)), ["W0513"]);
    }
}

#[test]
fn the_reward_of_rest_is_reported_with_its_largest_term() {
    let statements = "horizon 100 steps\nreward { 1 calm = exp(-50 * mean(muscles.activation))\n 2 low = clip(1 - pelvis.height / 1 m, 0, 1) }\n\
        terminate { fallen when pelvis.height < 0.6 m }";
    let findings = played(statements);
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert!(findings[0].message.contains("most of all by the term `calm`"), "{}", findings[0].message);
    assert!(findings[0].expected.as_ref().unwrap().contains("as `cmc` earns"), "{findings:?}");
}

#[test]
fn findings_can_be_allowed_with_a_reason() {
    for code in codes::probing::ALL.iter().filter(|code| code.lint.unwrap().stage == Stage::Probe) {
        let lint = code.lint.unwrap().name;
        let found = codes_of(&format!("allow {lint} \"on purpose\"\n{}", code.example));
        assert!(!found.contains(&code.id), "{lint}: {found:?}");
    }
    let holds = "terminate { low when pelvis.height < 1.2 m }";
    assert_eq!(codes_of(holds), ["W0512"]);
    assert_eq!(codes_of(&format!("allow holds_at_reset \"on purpose\"\n{holds}")), [""; 0]);
}

/// Defects and mistakes of the corpus that probing is documented to catch, with its findings: a block `probed` after that of
/// the text.
///
/// `MSK_UPDATE=1 cargo test` rewrites these blocks; read the difference before keeping it.
fn probed_blocks_of(folder: &str, pages: &[&str]) -> usize {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../compiler/tests/language").join(folder);
    let mut caught = 0;
    for page in pages {
        let path = folder.join(page).with_extension("md");
        let text = std::fs::read_to_string(&path).unwrap();
        let sections: Vec<String> = text
            .split("\n## ")
            .map(|section| if section.contains("Verdict: caught by probing") { answered(section) } else { section.to_owned() })
            .collect();
        caught += sections.iter().filter(|section| section.contains("\n```probed\n")).count();
        let fresh = sections.join("\n## ");
        if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
            std::fs::write(&path, &fresh).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), fresh, "{page}: MSK_UPDATE=1 rewrites the page");
    }
    caught
}

#[test]
fn defects_documented_as_caught_are() {
    let caught = probed_blocks_of("defects", &["hands", "standing", "steps", "walking"]);
    assert!(caught >= 19, "{caught}");
}

#[test]
fn mistakes_documented_as_caught_are() {
    let caught = probed_blocks_of("mistakes", &["endings", "rewards", "worlds_and_policies"]);
    assert!(caught >= 1, "{caught}");
}

/// A section of a page with the findings of probing in its first text.
fn answered(section: &str) -> String {
    let (before, rest) = section.split_once("\n```msk ").unwrap();
    let (kind, rest) = rest.split_once('\n').unwrap();
    let (body, after) = rest.split_once("\n```").unwrap();
    let statements = match kind {
        "success" => format!("success {body}"),
        kind if kind == "beginning" || kind == "task" || kind.starts_with("task-") => body.to_owned(),
        _ => format!("{kind} {{\n{body}\n}}"),
    };
    let answer: Vec<String> = findings(&statements)
        .iter()
        .map(|(diagnostic, place)| {
            format!("warning[{}]: {}\n at `{}`\n", diagnostic.code.named(), diagnostic.message, place.replace('\n', " "))
        })
        .collect();
    let caught = answer.iter().any(|answer| answer.starts_with("warning[W053"));
    assert!(caught, "probing says nothing of this:\n{section}");
    let after = match after.split_once("\n```probed\n") {
        Some((between, rest)) => format!("{between}{}", rest.split_once("```").unwrap().1),
        None => after.to_owned(),
    };
    // The diagnostics of the compiler come first.
    let (compiled, after) = match after.strip_prefix("\n```text\n").and_then(|rest| rest.split_once("\n```")) {
        Some((compiled, after)) => (format!("\n```text\n{compiled}\n```"), after),
        None => (String::new(), after.as_str()),
    };
    format!("{before}\n```msk {kind}\n{body}\n```{compiled}\n```probed\n{}```{after}", answer.join(""))
}

#[test]
fn the_suite_and_the_examples_begin_as_they_should() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files: Vec<PathBuf> = ["tasks.msk", "tasks/composed.msk", "tasks/loads.msk"].map(|file| root.join(file)).into();
    let examples = std::fs::read_dir(root.join("examples")).unwrap().map(|entry| entry.unwrap().path());
    files.extend(examples.filter(|path| path.extension().is_some_and(|extension| extension == "msk")));
    files.sort();
    for file in files {
        let compilation = compile(&file, &FileLoader, bodies()).unwrap_or_else(|report| panic!("{}:\n{report}", file.display()));
        let found = probe::tasks(&compilation.tasks, bodies());
        assert!(found.is_empty(), "{}: {found:#?}", file.display());
    }
}

#[test]
fn a_threshold_is_reported_with_the_numbers_that_were_met() {
    let findings = findings("success pelvis.height > 2 m");
    let [(remark, place)] = findings.as_slice() else { panic!("{findings:#?}") };
    assert_eq!((remark.code.id, place.as_str()), ("W0533", "pelvis.height > 2 m"));
    let [low, high]: [f64; 2] = numbers(&remark.message)[1..3].try_into().unwrap();
    // Lying on one side, and on the toes with straight legs, in a hop.
    assert!(0.05 < low && low < 0.3 && 1.0 < high && high < 1.4, "{}", remark.message);
    assert!(remark.message.ends_with("2 m on the right"), "{}", remark.message);
}

/// The numbers of a message.
fn numbers(message: &str) -> Vec<f64> {
    message.split(' ').filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn a_term_that_is_dead_at_reset_is_reported_in_any_pose() {
    let begins = |term: &str| format!("init {{ pose sitting\n root {{ height on ground }} }}\nreward {{ {term} }}");
    let upright = "1 upright = exp(-20 * (1 - torso.up.z))";
    let sideways = "1 upright = exp(-20 * (1 - torso.left.z))";
    assert_eq!(codes_of(&begins(upright)), [""; 0]);
    assert_eq!(codes_of(&begins(sideways)), ["W0511"]);
    let gate = format!("{sideways} when com.height > 0.8 m");
    assert_eq!(codes_of(&begins(&gate)), [""; 0]);
    assert_eq!(codes_of(&begins(&format!("allow dead_at_reset \"later\"\n{sideways}"))), [""; 0]);
}

#[test]
fn what_can_be_reached_is_searched_for() {
    // None of these is met by chance: a hand at the other ankle, both palms at one place of the seat, a bent body on the seat.
    for statements in [
        "terminate { a when distance(palm_l, ankle_r) < 10 cm }",
        "terminate { a when head.height < 0.2 m and pelvis.height > 0.4 m }",
        "scene { ground\n box seat { size [0.34 m, 0.34 m, 4 cm], at [-2 m, 1 m, 0.45 m] } }\n\
         terminate { a when touching(pelvis, seat) and torso.up.z > 0.9\n b when distance(palm_l, seat) < 30 cm }",
        "scene { ground\n sphere ball { radius 10 cm, mass 0.4 kg, free, at [3 m, 0, 10 cm] } }\n\
         terminate { a when ball.position.z > 1 m\n b when distance(palm_r, ball) < 15 cm\n c when ball.up.z < 0 }",
        "terminate { far when pelvis.position.x > 8 m\n left when pelvis.position.y > 3 m }",
    ] {
        assert_eq!(codes_of(statements), [""; 0], "{statements}: {:#?}", findings(statements));
    }
}

#[test]
fn what_poses_do_not_decide_is_not_reported() {
    for statements in [
        "terminate { fast when com.speed > 30 m/s }",
        "terminate { strong when sum(muscles.tension) > 1000 kN }",
        "terminate { late when held(pelvis.height > 0.8 m, 9 s) and com.speed > 9 m/s }",
        "success pelvis.position.x - initial(pelvis.position.x) > 100 m",
        "state low: int = 0 becomes low + 1 when com.height < 0.9 m\nobserve { low }\nsuccess low > 900",
        "random target = uniform(0.3 m .. 0.8 m, -0.6 m .. 0.6 m, 1.2 m .. 1.7 m)\nobserve { target }\n\
         terminate { near when norm(target - palm_r.position) < 1 cm }",
    ] {
        let found: Vec<_> = codes_of(statements).into_iter().filter(|code| code.starts_with("W053")).collect();
        assert_eq!(found, [""; 0], "{statements}: {:#?}", findings(statements));
    }
}

#[test]
fn a_threshold_in_a_let_is_reported_once_where_it_stands() {
    let findings =
        findings("let high = pelvis.height > 2 m\nreward { 1 a = torso.up.z when high\n 1 b = torso.up.z }\nsuccess high");
    let places: Vec<(&str, &str)> = findings.iter().map(|(diagnostic, place)| (diagnostic.code.id, place.as_str())).collect();
    assert_eq!(places, [("W0533", "pelvis.height > 2 m")]);
}

#[test]
fn a_lint_of_a_pose_is_allowed_on_its_term_alone() {
    let terms =
        |allow: &str| format!("reward {{ 1 tall = pelvis.height / 1 m\n{allow}\n 1 a = torso.up.z when pelvis.height > 2 m }}");
    assert_eq!(codes_of(&terms("")), ["W0533"]);
    assert_eq!(codes_of(&terms("allow unreached \"on purpose\"")), [""; 0]);
}

#[test]
fn a_symmetric_task_pays_mirrored_states_alike() {
    // Muscles, speeds, contacts and places, all of them on both sides.
    let fair = "symmetric\nreward {\n 1 effort = mean(muscles.activation^2)\n 1 speed = norm(com.velocity) / 1 m/s\n\
        1 wide = distance(sole_l, sole_r) / 1 m\n 1 sway = abs(torso.up.y)\n 1 force = sum(muscles.tension) / 1 kN\n\
        1 bent = sum(abs(knee_angle_{l,r}.q)) / 1 rad\n 1 planted = any(touching(sole_{l,r}, ground)) }";
    let found: Vec<_> = codes_of(fair).into_iter().filter(|code| *code == "W0537").collect();
    assert_eq!(found, [""; 0], "{:#?}", findings(fair));
    let unfair = "symmetric\nreward {\n 1 sway = clip(torso.up.y, 0, 1)\n 1 turn = max(0, torso.yaw / 1 rad) }\n\
        terminate { bowed when torso.up.y > 0.3 }";
    let findings = findings(unfair);
    let unlike: Vec<&str> =
        findings.iter().filter(|(diagnostic, _)| diagnostic.code.id == "W0537").map(|(_, place)| place.as_str()).collect();
    assert_eq!(unlike, ["clip(torso.up.y, 0, 1)", "max(0, torso.yaw / 1 rad)", "torso.up.y > 0.3"]);
}

#[test]
fn probing_tells_the_same_on_any_number_of_threads() {
    let text = "reward { 1 a = exp(-10 * mean(ankle_{l,r}.height) / 1 cm)\n 1 b = torso.up.z when pelvis.height > 1.3 m }";
    let messages = || findings(text).into_iter().map(|(diagnostic, _)| diagnostic.message).collect::<Vec<_>>();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(messages);
    assert_eq!(alone, messages());
}
