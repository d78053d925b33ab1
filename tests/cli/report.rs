//! `msk report` and `msk compare`.

use super::project::Project;
use crate::support::repository;

/// Two evaluations of a task, the first with traces, and a sweep.
fn evaluated() -> Project {
    let project = Project::lean();
    let eval = |policy: &str, out: &str, more: &[&str]| {
        let command = ["eval", "tasks.msk", "--episodes", "2", "--policy", policy, "--out", out];
        project.msk(&[&command, more].concat()).succeeded();
    };
    eval("random", "random", &["--trace=activations,terms", "--trace-episodes", "1"]);
    eval("zero", "zero", &["--strip", "worst"]);
    eval("random", "sweep", &["--sweep", "latency"]);
    project
}

#[test]
fn a_report_has_every_part_and_no_link_outside() {
    let project = evaluated();
    let curve = "{\"step\":100,\"evaluation\":{\"episodes\":2,\"success\":0.5,\"return\":7.0,\"steps\":9.0}}\n\
                 {\"step\":200,\"evaluation\":{\"episodes\":2,\"success\":1.0,\"return\":6.0,\"steps\":9.0}}\n{\"ste";
    project.write("training/curve.jsonl", curve);
    let done = project.msk(&["report", "random", "zero", "sweep", "training", "--out", "report", "--title", "A < B"]).succeeded();
    assert_eq!(done.out.lines().count(), 7, "{}", done.out);
    let page = project.read("report/report.html");
    for part in [
        "A &#60; B",
        "Leaderboard",
        "Families",
        "Standard metrics: random (random)",
        "Recruitment",
        "Robustness: random (sweep)",
        "latency perturbation",
        "Learning",
        "Film strips: zero (zero)",
        "src=\"data:image/png;base64,",
        "Episode 0 of lean",
        "Mean activation by muscle family",
        "Reward terms",
    ] {
        assert!(page.contains(part), "no `{part}`");
    }
    // The name of a namespace is no link.
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("http"), "the page links to something outside");
    assert!(project.read("report/report.md").contains("| training |"));
    assert!(project.read("report/report.csv").contains("Learning,training,100,7,200"), "{}", project.read("report/report.csv"));
    assert!(project.read("report/report.tex").contains("\\toprule"));
    assert!(project.read("report/paper.tex").contains("& Stabilization (1) & "), "{}", project.read("report/paper.tex"));
    assert!(
        project.read("report/paper.csv").contains(",SR (%) \u{2191},Stabilization (1),"),
        "{}",
        project.read("report/paper.csv")
    );
    assert!(project.read("report/paper.md").contains("Coverage \u{2191}"), "{}", project.read("report/paper.md"));
}

/// A fall while running has one gait cycle.
#[test]
fn envelopes_of_people_stand_beside_those_of_an_episode() {
    let project = Project::empty();
    let suite = repository("tasks.msk");
    let play = ["eval", suite.to_str().unwrap(), "--task", "run", "--policy", "demonstration", "--episodes", "1"];
    project.msk(&[&play[..], &["--trace", "--out", "run"]].concat()).succeeded();
    project.write("human.csv", "percent,soleus_r,Tibialis\n0,0.1,0.2\n30,0.3,0.1\n60,0.9,0.3\n100,0.1,0.2\n");
    let emg = ["--emg", "human.csv", "--map", "soleus_r=soleus_r", "--map", "tibant_r=Tibialis"];
    project.msk(&[&["report", "run", "--out", "report"], &emg[..]].concat()).succeeded();
    let page = project.read("report/report.html");
    for part in [
        "Envelopes of electromyograms, episode 0 of run",
        "Mean r ",
        "soleus_r, r = ",
        "tibant_r (Tibialis), r = ",
        "deviation over cycles",
    ] {
        assert!(page.contains(part), "no `{part}`");
    }
    let report = project.read("report/report.md");
    let cells: Vec<&str> =
        report.lines().find(|line| line.starts_with("| soleus_r ")).unwrap().split('|').map(str::trim).collect();
    assert_eq!(cells[2..4], ["soleus_r", "1"], "{report}");
    // The paper's table of residuals has the correlations of few channels one by one.
    let line =
        project.read("report/paper.md").lines().find(|line| line.starts_with("| run ") && line.contains('/')).map(str::to_owned);
    assert!(line.is_some_and(|line| line.split('/').count() == 2), "{}", project.read("report/paper.md"));
    // A recording that is for another task is not compared.
    project.msk(&["report", "run", "--out", "stairs", "--emg", "stairs=human.csv"]).succeeded();
    assert!(!project.read("stairs/report.html").contains("Envelopes of electromyograms"));
    project.msk(&["report", "run", "--emg", "stairs="]).failed(2, &["expected FILE or TASK=FILE"]);
    // A column that does not exist is named, and the rest of the report is written.
    let done = project.msk(&["report", "run", "--out", "other", "--emg", "human.csv", "--map", "soleus_r=Soleus"]).succeeded();
    assert!(done.err.contains("episode 0 of run is not compared with electromyograms: "), "{}", done.err);
    assert!(done.err.contains("has no column `Soleus`") && project.path("other/report.html").exists(), "{}", done.err);
}

#[test]
fn sums_that_are_not_of_the_episodes_are_not_believed() {
    let project = Project::lean();
    for (policy, out) in [("zero", "zero"), ("random", "random")] {
        project.msk(&["eval", "tasks.msk", "--episodes", "2", "--policy", policy, "--out", out]).succeeded();
    }
    project.msk(&["report", "zero", "--out", "before"]).succeeded();
    let own = project.read("zero/summary.json");
    let page = project.read("before/report.md");
    // The summary of another run, and an edited one.
    for text in
        [project.read("random/summary.json"), own.replace("\"successes\": 0", "\"successes\": 2").replace("\"zero\"", "\"best\"")]
    {
        assert_ne!(text, own);
        project.write("zero/summary.json", &text);
        project.msk(&["report", "zero", "--out", "after"]).succeeded();
        assert_eq!(project.read("after/report.md"), page);
    }
}

#[test]
fn conditions_are_named() {
    let project = Project::lean();
    let eval = ["eval", "tasks.msk", "--episodes", "2", "--policy", "zero"];
    project.msk(&[&eval[..], &["--out", "healthy"]].concat()).succeeded();
    project.msk(&[&eval[..], &["--out", "weak", "--weakness", "0.3"]].concat()).succeeded();
    let done = project.msk(&["compare", "healthy", "weak"]).succeeded();
    assert!(done.out.contains("The muscles of `lean` differ: A is healthy, B is weakness 0.3"), "{}", done.out);
    project.msk(&["report", "healthy", "weak"]).succeeded();
    let report = project.read("report/report.md");
    for row in ["| lean |", "| lean (weakness 0.3) |"] {
        assert!(report.lines().any(|line| line.starts_with(row)), "no `{row}` in {report}");
    }
}

#[cfg(unix)]
#[test]
fn nothing_is_written_or_shown_through_a_link() {
    use std::os::unix::fs::symlink;
    let project = Project::lean();
    project
        .msk(&["eval", "tasks.msk", "--episodes", "1", "--policy", "zero", "--strip", "worst", "--trace=terms", "--out", "out"])
        .succeeded();
    project.write("victim", "secret");
    std::fs::create_dir(project.path("report")).unwrap();
    symlink(project.path("victim"), project.path("report/report.html")).unwrap();
    project.msk(&["report", "out"]).failed(1, &["cannot write `report/report.html`", "a symbolic link"]);
    assert_eq!(project.read("victim"), "secret");

    // The folder that is taken without `--out` may have come with the project; a named one may be anything.
    std::fs::remove_dir_all(project.path("report")).unwrap();
    std::fs::create_dir(project.path("elsewhere")).unwrap();
    for default in ["report", "export", "snapshots", "results"] {
        symlink(project.path("elsewhere"), project.path(default)).unwrap();
    }
    project.msk(&["report", "out"]).failed(1, &["`report` is a symbolic link", "hint: name another folder"]);
    project.msk(&["export", "lean", "--target", "python"]).failed(1, &["`export` is a symbolic link"]);
    project.msk(&["snapshot"]).failed(1, &["`snapshots` is a symbolic link"]);
    project.msk(&["eval", "--policy", "zero", "--episodes", "1"]).failed(1, &["`results` is a symbolic link"]);
    assert_eq!(std::fs::read_dir(project.path("elsewhere")).unwrap().count(), 0);
    project.msk(&["report", "out", "--out", "./report"]).succeeded();

    std::fs::remove_file(project.path("out/lean-worst.png")).unwrap();
    symlink(project.path("victim"), project.path("out/lean-worst.png")).unwrap();
    project.msk(&["report", "out", "--out", "other"]).failed(1, &["lean-worst.png", "a symbolic link"]);
    std::fs::remove_file(project.path("out/lean-worst.png")).unwrap();
    project.write("out/lean-worst.png", "no picture");
    project.msk(&["report", "out", "--out", "other"]).failed(1, &["is not a PNG picture"]);
    std::fs::remove_file(project.path("out/lean-worst.png")).unwrap();

    let trace = project.path("out/traces/lean-0000.npz");
    std::fs::rename(&trace, project.path("trace.npz")).unwrap();
    symlink(project.path("trace.npz"), &trace).unwrap();
    project.msk(&["report", "out", "--out", "other"]).failed(1, &["lean-0000.npz", "a symbolic link"]);
    std::fs::rename(project.path("out/traces"), project.path("traces")).unwrap();
    symlink(project.path("traces"), project.path("out/traces")).unwrap();
    project.msk(&["report", "out", "--out", "other"]).failed(1, &["`out/traces` is a symbolic link"]);
}

/// The sums of a sweep are of the episodes that its folders hold; these must be those that the folders are named after.
#[test]
fn a_sweep_of_exchanged_episodes_is_not_believed() {
    let project = evaluated();
    let report = || project.msk(&["report", "sweep", "--out", "report"]);
    report().succeeded();
    let scales = std::fs::read_dir(project.path("sweep")).unwrap().flatten().map(|entry| entry.path());
    let scale = scales.filter(|path| path.to_string_lossy().contains("latency-")).min().unwrap();
    std::fs::remove_dir_all(&scale).unwrap();
    std::fs::rename(project.path("zero"), &scale).unwrap();
    report().failed(1, &["the sweep contains results of another run in `sweep/latency-", "evaluate again"]);
    std::fs::remove_dir_all(&scale).unwrap();
    let copied = std::process::Command::new("cp").args(["-r"]).arg(project.path("sweep/unperturbed")).arg(&scale).status();
    assert!(copied.unwrap().success());
    report().failed(1, &["the sweep contains episodes that are perturbed in another way in `sweep/latency-"]);
}

/// A report of a folder that somebody else has made, with names that try to be more than names.
#[test]
fn hostile_names_stay_text_in_every_format() {
    let project = evaluated();
    let label = "=cmd|x\u{1b}[2J![a](http:\u{202e})\n<img>";
    std::fs::rename(project.path("zero"), project.path(label)).unwrap();
    let curve = "{\"step\":100,\"evaluation\":{\"episodes\":2,\"success\":0.5,\"return\":1e300,\"steps\":9.0}}\n";
    project.write(&format!("{label}2/curve.jsonl"), curve);
    let done = project.msk(&["report", label, &format!("{label}2"), "--out", "report", "--title", "a\u{1b}[2J\nb"]).succeeded();
    assert!(!done.out.contains('\u{1b}'), "{}", done.out);
    for file in ["report.html", "report.md", "report.csv", "report.tex", "paper.md", "paper.csv", "paper.tex"] {
        let text = project.read(format!("report/{file}"));
        let acts = |letter: char| (letter.is_control() && letter != '\n') || letter == '\u{202e}';
        assert!(!text.contains(acts), "{file}: {text}");
        assert!(!text.contains(&"0".repeat(200)), "{file} has rows of digits");
    }
    let csv = project.read("report/report.csv");
    assert!(csv.contains(",'=cmd|x\\u001b[2J") && !csv.contains(",=cmd"), "{csv}");
    let markdown = project.read("report/report.md");
    assert!(markdown.contains(r"=cmd\|x\\u001b[2J![a]\(http:\\u202e)\\n\<img>2"), "{markdown}");
    assert!(!project.read("report/report.html").contains("<img>"));
}

#[test]
fn what_has_no_results_is_named() {
    let project = Project::lean();
    project.write("empty/file", "");
    project.msk(&["report", "empty"]).failed(1, &["`empty` has no results", "hint: name a folder"]);
    project.write("bad/summary.json", "{");
    project.msk(&["report", "bad"]).failed(1, &["bad/summary.json", "was modified"]);
    project.msk(&["compare", "empty", "empty"]).failed(1, &["contains no results"]);
}

#[test]
fn evaluations_are_compared_in_pairs() {
    let project = evaluated();
    let done = project.msk(&["compare", "random", "zero"]).succeeded();
    for part in ["A: random, policy random", "B: zero, policy zero", "| lean |     2 |", "B - A [95 %]"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    let json: serde_json::Value =
        serde_json::from_str(&project.msk(&["compare", "random", "random", "--json"]).succeeded().out).unwrap();
    assert_eq!((&json[0]["return_difference"]["value"], &json[0]["pairs"]), (&0.0.into(), &2.into()));
}
