//! Snapshots: canonical text of what a task means. Layout, comments and local names of the source do not show in it.
//!
//! Every section stands by itself: what a term computes is numbered within the term, declared states are written where they
//! are read, and parts of body and scene go by their names. So a change of one term changes the section of that term only, and
//! a comparison of two can tell in words what has changed.

mod encoding;
pub mod names;
mod scene;
mod section;

pub use scene::by_spread;
pub use section::{Section, Snapshot, Unreadable};

use crate::body::BodyDescription;
use crate::debug::ConditionDebug;
use crate::digest::sha256;
use crate::formula::Notation;
use crate::graph::NodeId;
use crate::graph::text::{Labels, Writer};
use crate::numbers::exact;
use crate::scene::{Shape, Terrain};
use crate::task::{CompiledTask, Phase, RandomValue, Setting};
use names::Names;
use section::meant;

/// Most operations of one formula that a snapshot writes out; of larger ones it keeps their hash.
const LONGEST: usize = 1000;

/// Where the operations of formulas are written.
enum Ink<'a> {
    /// Each formula in its own section.
    Local,
    /// All formulas of a phase in one list, whose size is that of the graph: for the hash.
    Shared(Box<Writer<'a>>),
}

impl CompiledTask {
    /// What the task means, section by section: terms, weights, ranges, ends, channels, scene and initial state.
    pub fn snapshot(&self) -> Snapshot {
        let mut sections = self.frame_sections(&body_digest(&self.body));
        for phase in self.phases.iter() {
            let names = Names { task: self, phase };
            self.phase_sections(phase, &names, &mut Ink::Local, &mut sections);
        }
        Snapshot { sections }
    }

    /// SHA-256 of what the task and its body mean, where models lie on the disk left out, in an encoding of its own. `body` is the
    /// [`body_digest`] of its body, which many tasks have in common.
    pub fn content_hash(&self, body: &str) -> String {
        let mut text = format!("{}\n", encoding::VERSION);
        for section in self.frame_sections(body) {
            meant(&section, &mut text);
        }
        for phase in self.phases.iter() {
            let names = Names { task: self, phase };
            let writer = Writer::new(&phase.graph, &names, &phase.outputs.updates);
            let (mut ink, mut sections) = (Ink::Shared(Box::new(writer)), Vec::new());
            self.phase_sections(phase, &names, &mut ink, &mut sections);
            sections.iter().for_each(|section| meant(section, &mut text));
            if let Ink::Shared(writer) = ink {
                text += &writer.finish().join("\n");
            }
        }
        text += &scene::coordinates(self);
        sha256(text.as_bytes())
    }

    /// What does not belong to a phase.
    fn frame_sections(&self, body: &str) -> Vec<Section> {
        let mut head = Section::new("task", &self.name)
            .field("family", &self.family)
            .field("body", format!("{} {body}", self.body.name))
            .field("control", format!("{} Hz", self.control_frequency))
            .field("horizon", format!("{} steps", self.horizon))
            .field("symmetric", self.symmetric);
        if self.phases.len() > 1 {
            let phases: Vec<&str> = self.phases.iter().map(|phase| phase.name.as_str()).collect();
            head = head.field("phases", phases.join(", "));
        }
        let mut sections = vec![head];
        sections.extend(self.action_section());
        for parameter in &self.parameters {
            let section = Section::new("parameter", &parameter.name)
                .field("value", format!("{} {}", exact(parameter.value), parameter.unit).trim());
            let range = parameter.range.map(|[low, high]| format!("{}..{}", exact(low), exact(high)));
            let section = range.into_iter().fold(section, |section, range| section.field("range", range));
            sections.push(if parameter.per_episode { section.field("changes", "per episode") } else { section });
        }
        for followed in &self.motions {
            let start = followed.start.fixed().map_or("drawn".to_owned(), |start| start.to_string());
            let section = Section::new("reference", &followed.name).field("motion", followed.motion.digest());
            sections.push(section.field("start", start));
        }
        self.scene_sections(&mut sections);
        self.initial_state_sections(&mut sections);
        sections
    }

    /// What is drawn for the initial state; the samples of a height field together.
    fn drawn_sections<'a>(&'a self, phase: &'a Phase, names: &Names<'a>, ink: &mut Ink<'_>, sections: &mut Vec<Section>) {
        let one_field = |(a, _): &(Setting, usize), (b, _): &(Setting, usize)| match (a, b) {
            (Setting::ObjectShape(a, _), Setting::ObjectShape(b, _)) => a == b && self.varies_heights(*a),
            _ => false,
        };
        for alike in self.init.drawn.chunk_by(one_field) {
            let name = names::setting(self, alike[0].0);
            let name = if self.phases.len() > 1 { format!("{}.{name}", phase.name) } else { name };
            let nodes = alike.iter().filter_map(|(_, index)| phase.outputs.initial_values.get(*index));
            let mut section = Section::new("drawn", &name);
            match ink {
                Ink::Local => {
                    let mut graphs = nodes.map(|node| own_graph(phase, names, *node)).collect::<Vec<_>>();
                    section.graph = match graphs.len() {
                        0 => continue,
                        1 => graphs.remove(0),
                        samples => vec![format!("{samples} samples, sha256 {}", sha256(graphs.concat().join("\n").as_bytes()))],
                    };
                }
                Ink::Shared(writer) => {
                    let numbers: Vec<String> = nodes.map(|node| format!("%{}", writer.number(*node))).collect();
                    section = section.field("is", numbers.join(" "));
                }
            }
            sections.push(section);
        }
    }

    fn varies_heights(&self, row: usize) -> bool {
        let shape = self.init.variation.shapes.get(row).map(|known| &known.shape);
        matches!(shape, Some(Shape::Terrain(Terrain::Heights { .. })))
    }

    fn phase_sections<'a>(&'a self, phase: &'a Phase, names: &Names<'a>, ink: &mut Ink<'_>, sections: &mut Vec<Section>) {
        let (debug, outputs) = (&phase.debug, &phase.outputs);
        let several = self.phases.len() > 1;
        self.drawn_sections(phase, names, ink, sections);
        let mut write = |section: Section, formula: Option<&Notation>, node: NodeId, word: &str| {
            let mut section = section;
            section.formula = formula.map_or_else(String::new, |formula| formula.plain.clone());
            match ink {
                Ink::Local => section.graph = own_graph(phase, names, node),
                Ink::Shared(writer) => {
                    section.formula = String::new();
                    section = section.field(word, format!("%{}", writer.number(node)));
                }
            }
            sections.push(section);
        };
        let labelled = |name: &str| if several { format!("{}.{name}", phase.name) } else { name.to_owned() };
        for &(disturbance, setting, index) in &self.drawn_disturbances {
            let Some(&node) = outputs.initial_values.get(index) else { continue };
            let name = format!("disturbance {} {}", disturbance + 1, names::disturbance_setting(setting));
            write(Section::new("drawn", &labelled(&name)), None, node, "is");
        }
        for (&connection, &node) in self.releases.iter().zip(&outputs.releases) {
            write(Section::new("release", &labelled(&self.connection_name(connection))), None, node, "when");
        }
        for (&object, &node) in self.driven.iter().zip(&outputs.drives) {
            let name = self.scene.objects.get(object).map_or("?", |object| &object.name);
            write(Section::new("drive", &labelled(name)), None, node, "by");
        }
        for (name, &node) in self.markers.iter().zip(&outputs.markers) {
            write(Section::new("marker", &labelled(name)), None, node, "at");
        }
        for (&stream, draw) in phase.streams.iter().zip(&outputs.draws) {
            let RandomValue { name, parameter, .. } = &self.randoms[stream];
            if parameter.is_some() {
                continue;
            }
            write(Section::new("random", name), None, draw.value, "is");
            if let Some(redraw) = draw.redraw {
                write(Section::new("redraw", name), None, redraw, "when");
            }
        }
        for (place, (term, &node)) in self.terms[phase.terms.clone()].iter().zip(&outputs.terms).enumerate() {
            let mut section = Section::new("term", &term.name).field("weight", exact(term.weight));
            section = term.schedule.iter().fold(section, |section, schedule| section.field("schedule", schedule));
            match (term.fixed, term.weight_range) {
                (true, _) => section = section.field("range", "fixed"),
                (_, Some([low, high])) => section = section.field("range", format!("{}..{}", exact(low), exact(high))),
                _ => {}
            }
            write(section, debug.terms.get(place).map(|term| &term.formula), node, "pays");
        }
        for (place, (metric, &node)) in self.metrics[phase.metrics.clone()].iter().zip(&outputs.metrics).enumerate() {
            let section = Section::new("metric", &metric.name).field("size", metric.size);
            write(section, debug.metrics.get(place).map(|metric| &metric.formula), node, "is");
        }
        let ends = [
            ("terminate", &self.terminations[phase.terminations.clone()], &outputs.terminations, &debug.terminations, &[][..]),
            (
                "finish",
                &self.finishes[phase.finishes.clone()],
                &outputs.finishes,
                &debug.finishes,
                &self.bootstraps[phase.finishes.clone()],
            ),
        ];
        for (kind, reasons, nodes, conditions, bootstraps) in ends {
            for (place, (name, &node)) in reasons.iter().zip(nodes).enumerate() {
                let section = Section::new(kind, name);
                let section = if bootstraps.get(place) == Some(&true) { section.field("bootstrap", true) } else { section };
                write(section, conditions.get(place).map(|condition| &condition.formula), node, "when");
            }
        }
        let formula = |debug: &'a Option<ConditionDebug>| debug.as_ref().map(|debug| &debug.formula);
        let phase_name = if several { phase.name.as_str() } else { "" };
        if several {
            let horizon = phase.horizon;
            if let Some(node) = outputs.until {
                let section = Section::new("until", phase_name).field("horizon", horizon);
                write(section, formula(&debug.until), node, "when");
            }
            if let Some(node) = outputs.succeeded {
                write(Section::new("succeeded", phase_name).field("horizon", horizon), None, node, "when");
            }
        }
        if let Some(node) = outputs.success {
            write(Section::new("success", phase_name), formula(&debug.success), node, "when");
        }
        let groups = [("channel", &self.channels), ("critic", &self.critic)];
        let channels = groups.into_iter().flat_map(|(group, channels)| channels.iter().map(move |channel| (group, channel)));
        for ((group, channel), own) in channels.zip(&phase.channels) {
            let Some((own, &node)) = own.and_then(|own| Some((own, outputs.channels.get(own)?))) else { continue };
            let mut section = Section::new(group, &labelled(&channel.name)).field("size", channel.size);
            if !channel.unit.is_empty() {
                section = section.field("unit", &channel.unit);
            }
            write(section, debug.channels.get(own).map(|channel| &channel.formula), node, "is");
        }
    }
}

/// What one formula computes, numbered by itself.
fn own_graph(phase: &Phase, names: &dyn Labels, node: NodeId) -> Vec<String> {
    let graph = &phase.graph;
    if let Some(value) = graph.constant_value(node) {
        return vec![format!("constant {value:?}")];
    }
    let mut writer = Writer::new(graph, names, &phase.outputs.updates);
    writer.number(node);
    let lines = writer.finish();
    if lines.len() <= LONGEST {
        return lines;
    }
    let hash = sha256(lines.join("\n").as_bytes());
    vec![format!("{} operations, sha256 {hash}", lines.len())]
}

/// A short hash of a body: of everything in its file, but not of where the model lies.
pub fn body_digest(body: &BodyDescription) -> String {
    let mut hash = sha256(encoding::body(body).as_bytes());
    hash.truncate(16);
    hash
}
