//! A page for browsers: one file with everything in it, formulas as MathML, readable offline, by day and by night.

use super::action::ActionReport;
use super::report::*;
use crate::extremes::maximum;
use crate::notation::escaped;
use crate::numbers::for_people;
use std::fmt::Write;

/// Tasks as one self-contained page under a title.
pub fn html(title: &str, tasks: &[TaskReport]) -> String {
    // Writing to a string cannot fail, here and below.
    let mut text = String::new();
    let title = escaped(title);
    let _ = writeln!(text, "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">");
    let _ = writeln!(text, "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">");
    let _ = writeln!(text, "<title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>", include_str!("page.css"));
    let _ = writeln!(text, "<header>\n<h1>{title}</h1>");
    if tasks.len() > 1 {
        let _ = writeln!(text, "<nav>");
        for task in tasks {
            let _ = writeln!(text, "<a href=\"#{0}\">{0}</a>", escaped(&task.name));
        }
        let _ = writeln!(text, "</nav>");
    }
    let _ = writeln!(text, "</header>\n<main>");
    tasks.iter().for_each(|task| section(task, &mut text));
    let _ = writeln!(text, "</main>\n<footer>Written by <code>msk explain --format html</code>.</footer>\n</body>\n</html>");
    text
}

fn math(formula: &FormulaReport) -> String {
    format!("<math>{}</math>", formula.mathml)
}

fn section(task: &TaskReport, text: &mut String) {
    let _ = writeln!(text, "<section class=\"task\" id=\"{0}\">\n<h2>{0}</h2>", escaped(&task.name));
    if !task.summary.is_empty() {
        let _ = writeln!(text, "<p class=\"summary\">{}</p>", escaped(&task.summary));
    }
    let mut facts: Vec<String> = [&task.family].into_iter().filter(|family| !family.is_empty()).cloned().collect();
    facts.push(format!("body {}", task.body));
    facts.push(format!("control {} Hz", for_people(task.control_frequency)));
    facts.push(format!("horizon {} steps ({} s)", task.horizon, for_people(task.duration)));
    facts.extend(task.symmetric.then(|| "symmetric".to_owned()));
    let _ = writeln!(text, "<p class=\"facts\">{}</p>", escaped(&facts.join(" \u{b7} ")));
    for phase in &task.phases {
        if task.phases.len() > 1 {
            let until = phase.until.as_ref().map_or_else(String::new, |until| format!(", until {}", math(until)));
            let _ = writeln!(text, "<h3>Phase {} of {} steps{until}</h3>", escaped(&phase.name), phase.horizon);
        }
        rewards(phase, text);
        ends(phase, text);
        metrics(phase, text);
    }
    if let Some(reward) = task.reward_at_reset {
        let _ = writeln!(text, "<p class=\"soft\">In the first snapshot the reward is {}.</p>", for_people(reward));
    }
    scene(task, text);
    initial_state(task, text);
    settings(task, text);
    observation(&task.observation, text);
    action(&task.action, text);
    let _ = writeln!(text, "<p class=\"soft\">hash <code>{}</code></p>\n</section>", task.hash);
}

/// Opens a table: titles, and whether a column holds numbers.
fn open(columns: &[(&str, bool)], text: &mut String) {
    let titles: String = columns
        .iter()
        .map(|(title, number)| if *number { format!("<th class=\"number\">{title}</th>") } else { format!("<th>{title}</th>") })
        .collect();
    let _ = writeln!(text, "<div class=\"scroll\"><table>\n<thead><tr>{titles}</tr></thead>\n<tbody>");
}

fn close(text: &mut String) {
    let _ = writeln!(text, "</tbody>\n</table></div>");
}

fn rewards(phase: &PhaseReport, text: &mut String) {
    let largest = phase.terms.iter().map(|term| term.weight.abs()).fold(0.0, maximum);
    let _ = writeln!(text, "<h3>Reward per control step</h3>");
    open(&[("Weight", true), ("", false), ("Term", false), ("Formula", false), ("Between", false), ("At reset", true)], text);
    for term in &phase.terms {
        let share = if largest > 0.0 { 100.0 * term.weight.abs() / largest } else { 0.0 };
        let class = if term.weight < 0.0 { " class=\"cost\"" } else { "" };
        let range = match (term.fixed, term.weight_range) {
            (true, _) => "<br><span class=\"soft\">fixed</span>".to_owned(),
            (_, Some([low, high])) => format!("<br><span class=\"soft\">{}..{}</span>", for_people(low), for_people(high)),
            _ => String::new(),
        };
        let docs =
            if term.docs.is_empty() { String::new() } else { format!("<div class=\"docs\">{}</div>", escaped(&term.docs)) };
        let rate = if term.per_second { " <span class=\"soft\">per second</span>" } else { "" };
        let bound = |bound: Option<f64>, none: &str| bound.map_or_else(|| none.to_owned(), for_people);
        let between = format!("{} .. {}", bound(term.bounds[0], "\u{2212}\u{221e}"), bound(term.bounds[1], "\u{221e}"));
        let at_reset = term.at_reset.map(for_people).unwrap_or_default();
        let _ = writeln!(
            text,
            "<tr><td class=\"number\">{}{range}</td><td class=\"bar\"><span{class} style=\"width:{share:.1}%\"></span></td>\
             <td>{}</td><td>{}{rate}{docs}</td><td class=\"soft\">{between}</td><td class=\"number\">{at_reset}</td></tr>",
            for_people(term.weight),
            escaped(&term.name),
            math(&term.formula)
        );
    }
    close(text);
    if phase.definitions.is_empty() {
        return;
    }
    let _ = writeln!(text, "<div class=\"where\"><span class=\"soft\">where</span>");
    for definition in &phase.definitions {
        let name = escaped(&definition.name.replace('_', " "));
        let arguments = if definition.parameters.is_empty() {
            String::new()
        } else {
            format!("({})", escaped(&definition.parameters.join(", ")))
        };
        let parts: String = definition
            .parts
            .iter()
            .map(|(word, formula)| format!(" {} {}", if word.is_empty() { "=" } else { word }, math(formula)))
            .collect();
        let docs = if definition.docs.is_empty() {
            String::new()
        } else {
            format!(" <span class=\"docs\">{}</span>", escaped(&definition.docs))
        };
        let _ = writeln!(text, "<div><i>{name}</i>{arguments}{parts}{docs}</div>");
    }
    let _ = writeln!(text, "</div>");
}

fn ends(phase: &PhaseReport, text: &mut String) {
    let _ = writeln!(text, "<h3>Terminations</h3>");
    open(&[("", false), ("Reason", false), ("Condition", false)], text);
    let mut row = |kind: &str, end: &EndReport| {
        let after = if end.after.is_empty() {
            String::new()
        } else {
            format!(" <span class=\"soft\">after {}</span>", escaped(&end.after))
        };
        let holds = if end.holds_at_reset == Some(true) { " <span class=\"holds\">holds at reset</span>" } else { "" };
        let docs = if end.docs.is_empty() { String::new() } else { format!("<div class=\"docs\">{}</div>", escaped(&end.docs)) };
        let name = escaped(&end.name);
        let _ = writeln!(
            text,
            "<tr><td class=\"soft\">{kind}</td><td>{name}</td><td>{}{after}{holds}{docs}</td></tr>",
            math(&end.condition)
        );
    };
    phase.terminations.iter().for_each(|end| row("failure", end));
    phase.finishes.iter().for_each(|end| row("finish", end));
    phase.success.iter().for_each(|end| row("success", end));
    close(text);
}

fn metrics(phase: &PhaseReport, text: &mut String) {
    if phase.metrics.is_empty() {
        return;
    }
    let _ = writeln!(text, "<h3>Logged, not part of the reward</h3>");
    open(&[("Metric", false), ("Unit", false), ("Formula", false)], text);
    for metric in &phase.metrics {
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td>{}</td><td>{}</td></tr>",
            escaped(&metric.name),
            escaped(&metric.unit),
            math(&metric.formula)
        );
    }
    close(text);
}

fn scene(task: &TaskReport, text: &mut String) {
    let scene = &task.scene;
    if scene.objects.is_empty() && scene.connections.is_empty() && task.disturbances.is_empty() {
        return;
    }
    let _ = writeln!(text, "<h3>Scene{}</h3>", if scene.ground { "" } else { ", without ground" });
    open(&[("Element", false), ("", false), ("Place [m]", false), ("Motion", false), ("Mass [kg]", true)], text);
    for object in &scene.objects {
        let on = if object.parent == "world" { String::new() } else { format!(" of {}", object.parent) };
        let marks = [(object.walkable, "walkable"), (!object.solid, "not solid")];
        let marks: Vec<&str> = marks.into_iter().filter(|(holds, _)| *holds).map(|(_, word)| word).collect();
        let kind = format!("{} {} {}", object.kind, object.size, marks.join(", "));
        let mass = if object.mass > 0.0 { for_people(object.mass) } else { String::new() };
        let place = format!("[{}]{on}", object.position.map(for_people).join(", "));
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"number\">{mass}</td></tr>",
            escaped(&object.name),
            escaped(kind.trim()),
            escaped(&place),
            escaped(&object.motion)
        );
    }
    close(text);
    let mut notes: Vec<String> = Vec::new();
    for held in &scene.connections {
        let release = if held.released { ", can be released" } else { "" };
        notes.push(format!("{} {} to {}{release}", held.kind, held.from, held.to));
    }
    notes.extend(scene.groups.iter().map(|(name, members)| format!("group {name}: {}", members.join(", "))));
    notes.extend(scene.markers.iter().map(|marker| format!("marked: {marker}")));
    for push in &task.disturbances {
        let force = push.force.map(for_people).join(", ");
        notes.push(format!(
            "a force of [{force}] N on {} at {} s for {} s{}",
            push.on,
            for_people(push.start),
            for_people(push.duration),
            push.varies()
        ));
    }
    list(&notes, text);
}

fn list(lines: &[String], text: &mut String) {
    if lines.is_empty() {
        return;
    }
    let items: String = lines.iter().map(|line| format!("<li>{}</li>", escaped(line))).collect();
    let _ = writeln!(text, "<ul>{items}</ul>");
}

fn initial_state(task: &TaskReport, text: &mut String) {
    let initial_state = &task.initial_state;
    let _ = writeln!(text, "<h3>Initial state</h3>");
    let mut lines = vec![initial_state.root.clone()];
    let joints = initial_state.independent_joints();
    let joints: Vec<String> = joints.iter().map(|(name, joint)| format!("{name} {}", joint.angle())).collect();
    lines.extend((!joints.is_empty()).then(|| format!("changes of the neutral pose: {}", joints.join(", "))));
    lines.extend(initial_state.noise.iter().map(|noise| format!("noise on {noise}")));
    lines.extend(initial_state.objects.iter().cloned());
    lines
        .extend((!initial_state.drawn.is_empty()).then(|| format!("drawn for each episode: {}", initial_state.drawn.join(", "))));
    lines.extend((!initial_state.settle.is_empty()).then(|| format!("settles for {}", initial_state.settle)));
    list(&lines, text);
}

fn settings(task: &TaskReport, text: &mut String) {
    if task.parameters.is_empty() && task.randoms.is_empty() && task.motions.is_empty() {
        return;
    }
    let _ = writeln!(text, "<h3>Parameters, motions and random values</h3>");
    let mut lines = Vec::new();
    for parameter in &task.parameters {
        let range =
            parameter.range.map_or_else(String::new, |[low, high]| format!(", {} .. {}", for_people(low), for_people(high)));
        lines.push(format!("{} = {} {}{range}", parameter.name, for_people(parameter.value), parameter.unit));
    }
    lines.extend(task.motions.iter().map(|motion| format!("{} follows {}", motion.name, motion.in_words())));
    for random in &task.randoms {
        let clause = |word: &str, clause: &str| if clause.is_empty() { String::new() } else { format!(" {word} {clause}") };
        let clauses = clause("where", &random.accept) + &clause("redraw when", &random.redraw);
        lines.push(format!("{} is drawn from {}{clauses}", random.name, random.source));
    }
    list(&lines, text);
}

fn action(action: &ActionReport, text: &mut String) {
    let _ = writeln!(text, "<h3>Action</h3>\n<p>{}</p>", escaped(&action.in_words()));
    list(&[action.entries.join(", ")], text);
}

fn observation(observation: &ObservationReport, text: &mut String) {
    let _ = writeln!(text, "<h3>Observation: {} values</h3>", observation.size);
    open(&[("Channel", false), ("Place", true), ("Size", true), ("Unit", false), ("From", false)], text);
    for channel in &observation.channels {
        let end = channel.offset + channel.size;
        let settings = if channel.settings.is_empty() { String::new() } else { format!(" {}", escaped(&channel.settings)) };
        let formula = if channel.formula.mathml.is_empty() { String::new() } else { math(&channel.formula) };
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td class=\"number\">{}..{end}</td><td class=\"number\">{}</td><td>{}</td><td>{formula}{} \
             <span class=\"soft\">{}</span></td></tr>",
            escaped(&channel.name),
            channel.offset,
            channel.size,
            escaped(&channel.unit),
            settings,
            escaped(&channel.block)
        );
    }
    close(text);
}
