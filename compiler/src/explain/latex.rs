//! Tables for papers, in the layout of the benchmark's: per family one of rewards and one of settings, then one of what
//! succeeds. The document compiles with `pdflatex`; a table can be cut out between its comments.

use super::report::*;
use crate::notation::latex_words;
use crate::numbers::for_people;
use std::fmt::Write;

const PREAMBLE: &str = r"\documentclass[10pt]{article}
\usepackage[utf8]{inputenc}
\usepackage[T1]{fontenc}
\usepackage[a4paper, landscape, margin=15mm]{geometry}
\usepackage{amsmath, amssymb, array, booktabs, longtable}
\renewcommand{\arraystretch}{1.15}
\setlength{\emergencystretch}{3em}
\setlength{\LTcapwidth}{\textwidth}
\begin{document}
";

/// Tasks as tables, families in the order in which they first come.
pub fn latex(tasks: &[TaskReport]) -> String {
    // Writing to a string cannot fail, here and below.
    let mut text = PREAMBLE.to_owned();
    let mut families: Vec<&str> = Vec::new();
    for task in tasks {
        if !families.contains(&task.family.as_str()) {
            families.push(&task.family);
        }
    }
    let of = |family: &str| tasks.iter().filter(move |task| task.family == family).enumerate().collect::<Vec<_>>();
    let part = |index: usize, family: &str| match (families.len(), family) {
        (1, "") => String::new(),
        (1, family) => format!(" ({})", title(family)),
        (_, family) => format!(" (Part {}: {})", index + 1, title(if family.is_empty() { "others" } else { family })),
    };
    for (index, family) in families.iter().enumerate() {
        rewards(&of(family), &part(index, family), family, &mut text);
    }
    for (index, family) in families.iter().enumerate() {
        settings(&of(family), &part(index, family), family, &mut text);
    }
    successes(tasks, &mut text);
    text + "\\end{document}\n"
}

/// `stabilization` to `Stabilization`, `single_leg_stand` to `Single leg stand`.
fn title(name: &str) -> String {
    let words = name.replace('_', " ");
    let mut letters = words.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    latex_words(&format!("{first}{}", letters.as_str()))
}

/// Opens a table: its caption, label, columns and their titles.
fn open(caption: &str, label: &str, columns: &[(&str, &str)], text: &mut String) {
    let _ = writeln!(text, "\n% --- {label}");
    let widths: String = columns.iter().map(|(_, width)| format!(" >{{\\raggedright\\arraybackslash}}p{{{width}}}")).collect();
    let titles: Vec<String> = columns.iter().map(|(title, _)| format!("\\textbf{{{title}}}")).collect();
    let titles = titles.join(" & ");
    let _ = writeln!(text, "\\begin{{longtable}}{{@{{}}{widths} @{{}}}}");
    let _ = writeln!(text, "\\caption{{{caption}}}\\label{{tab:{label}}} \\\\");
    let _ = writeln!(text, "\\toprule\n{titles} \\\\ \\midrule\n\\endfirsthead");
    let _ = writeln!(text, "\\toprule\n{titles} \\\\ \\midrule\n\\endhead\n\\bottomrule\n\\endfoot");
}

fn close(label: &str, text: &mut String) {
    let _ = writeln!(text, "\\end{{longtable}}\n% --- end of {label}");
}

fn math(formula: &FormulaReport) -> String {
    format!("${}$", formula.latex)
}

/// A number with a true minus, and powers of ten as such.
fn weight(value: f64) -> String {
    let text = for_people(value);
    match text.split_once('e') {
        Some((mantissa, power)) => format!("${mantissa} \\cdot 10^{{{power}}}$"),
        None => format!("${text}$"),
    }
}

/// The weight of a term, or the two between which it changes.
fn weights(term: &TermReport) -> String {
    match &term.schedule {
        None => weight(term.weight),
        Some(schedule) => {
            let shares = latex_words(&schedule.shares());
            format!("{} $\\to$ {} {shares}", weight(schedule.from), weight(term.weight))
        }
    }
}

fn rewards(tasks: &[(usize, &TaskReport)], part: &str, family: &str, text: &mut String) {
    let label = format!("rewards_{}", if family.is_empty() { "tasks" } else { family });
    let columns = [("Task", "28mm"), ("Term", "34mm"), ("Formula", "165mm"), ("Weight", "20mm")];
    open(
        &format!("Reward functions{part}. The reward of a control step is the sum of weight times term."),
        &label,
        &columns,
        text,
    );
    for (number, task) in tasks {
        let mut heading = format!("\\textbf{{{}. {}}}", number + 1, title(&task.name));
        for phase in &task.phases {
            if task.phases.len() > 1 {
                let _ =
                    writeln!(text, "{heading} & \\multicolumn{{3}}{{l}}{{\\emph{{phase {}}}}} \\\\", latex_words(&phase.name));
                heading.clear();
            }
            for term in &phase.terms {
                let name = term.name.rsplit('.').next().unwrap_or(&term.name);
                let rate = if term.per_second { " per second" } else { "" };
                let _ = writeln!(text, "{heading} & {}{rate} & {} & {} \\\\", title(name), math(&term.formula), weights(term));
                heading.clear();
            }
            where_rows(phase, text);
        }
        let _ = writeln!(text, "\\addlinespace");
    }
    close(&label, text);
}

/// What the formulas of a phase name, in one small row.
fn where_rows(phase: &PhaseReport, text: &mut String) {
    for definition in &phase.definitions {
        let arguments = if definition.parameters.is_empty() {
            String::new()
        } else {
            let names: Vec<String> =
                definition.parameters.iter().map(|name| format!("\\mathit{{{}}}", latex_words(name))).collect();
            format!("({})", names.join(", "))
        };
        let parts: Vec<String> = definition
            .parts
            .iter()
            .map(|(word, formula)| match word.as_str() {
                "" => format!("$= {}$", formula.latex),
                word => format!("{word} ${}$", formula.latex),
            })
            .collect();
        let name = format!("$\\mathit{{{}}}{arguments}$", latex_words(&definition.name).replace("\\_", "\\ "));
        let _ = writeln!(text, " & \\footnotesize\\emph{{where}} & \\footnotesize {name} {} & \\\\", parts.join(" "));
    }
}

fn settings(tasks: &[(usize, &TaskReport)], part: &str, family: &str, text: &mut String) {
    let label = format!("settings_{}", if family.is_empty() { "tasks" } else { family });
    let columns = [("Task", "28mm"), ("Observations", "72mm"), ("Initialisation", "72mm"), ("Termination criteria", "75mm")];
    open(&format!("Task settings, observations and termination criteria{part}."), &label, &columns, text);
    for (number, task) in tasks {
        let ends: Vec<String> = task
            .phases
            .iter()
            .flat_map(|phase| phase.terminations.iter().chain(&phase.finishes))
            .map(|end| {
                let after = if end.after.is_empty() { String::new() } else { format!(" (after {})", latex_words(&end.after)) };
                let bootstrap = if end.bootstrap { " (bootstraps)" } else { "" };
                format!("{}: {}{after}{bootstrap}", title(&end.name), math(&end.condition))
            })
            .collect();
        let _ = writeln!(
            text,
            "\\textbf{{{}. {}}} & {} & {} & {} \\\\ \\addlinespace",
            number + 1,
            title(&task.name),
            observations(&task.observation),
            initial_state(&task.initial_state),
            if ends.is_empty() { "none".to_owned() } else { ends.join("; \\newline ") }
        );
    }
    close(&label, text);
}

/// Blocks by their names, the task's own channels as formulas.
fn observations(observation: &ObservationReport) -> String {
    let mut parts: Vec<String> = Vec::new();
    for channel in &observation.channels {
        let part = match (channel.block.as_str(), channel.formula.latex.as_str()) {
            ("", "") => format!("{} ({})", title(&channel.name), channel.size),
            ("", latex) => format!("${latex}$"),
            (block, _) => title(block),
        };
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
    format!("{} \\newline ({} values)", parts.join("; "), observation.size)
}

fn initial_state(initial_state: &InitialStateReport) -> String {
    let mut parts = vec![latex_words(&initial_state.root)];
    let joints = initial_state.independent_joints();
    let joints: Vec<String> =
        joints.iter().map(|(name, joint)| format!("{} {}", latex_words(name), latex_words(&joint.angle()))).collect();
    parts.extend((!joints.is_empty()).then(|| joints.join(", ")));
    parts.extend(initial_state.noise.iter().map(|noise| format!("noise on {}", latex_words(noise))));
    parts.extend(initial_state.objects.iter().chain(&initial_state.scaled).map(|words| latex_words(words)));
    parts.extend((!initial_state.drawn.is_empty()).then(|| format!("drawn: {}", latex_words(&initial_state.drawn.join(", ")))));
    parts.extend((!initial_state.settle.is_empty()).then(|| format!("settles for {}", latex_words(&initial_state.settle))));
    parts.join("; \\newline ")
}

fn successes(tasks: &[TaskReport], text: &mut String) {
    let columns = [("Task", "40mm"), ("Success criterion, at the last step", "165mm"), ("Horizon", "40mm")];
    open("Success criteria.", "success", &columns, text);
    for task in tasks {
        let success = task.phases.iter().rev().find_map(|phase| phase.success.as_ref());
        let criterion = success.map_or_else(String::new, |success| math(&success.condition));
        let _ =
            writeln!(text, "{} & {criterion} & {} steps ({} s) \\\\", title(&task.name), task.horizon, for_people(task.duration));
    }
    close("success", text);
}
