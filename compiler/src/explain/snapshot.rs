//! The snapshot: canonical text of what a task means. Layout, comments and local names of the source do not show in it.

use crate::graph::text::{Writer, values};
use crate::task::{CompiledTask, Meaning, Phase, Spread};
use std::fmt::Write;

impl CompiledTask {
    /// Canonical, diffable text of the task's meaning: terms, weights, ranges, ends, channels, beginning and the graph.
    pub fn snapshot(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "task {} on {}", self.name, self.body.name);
        let _ = writeln!(text, "family {}", self.family);
        let _ = writeln!(text, "control {} Hz", self.control_frequency);
        let _ = writeln!(text, "horizon {} steps", self.horizon);
        let _ = writeln!(text, "symmetric {}", self.symmetric);
        for parameter in &self.parameters {
            let range = parameter.range.map_or(String::new(), |[low, high]| format!(" ({low}..{high})"));
            let _ = writeln!(text, "parameter {} = {}{range} {}", parameter.name, parameter.value, parameter.unit);
        }
        for followed in &self.motions {
            let start = followed.start.map_or("drawn".to_owned(), |start| start.to_string());
            let _ = writeln!(text, "reference {} = motion {}, start {start}", followed.name, followed.motion.digest());
        }
        self.write_scene(&mut text);
        self.write_init(&mut text);
        for phase in &self.phases {
            if self.phases.len() > 1 {
                let _ = writeln!(text, "phase {} of {} steps", phase.name, phase.horizon);
            }
            self.write_phase(phase, &mut text);
        }
        text
    }

    fn write_phase(&self, phase: &Phase, text: &mut String) {
        let mut writer = Writer::default();
        let Meaning { graph, outputs, .. } = &phase.meaning;
        for &(setting, index) in &self.init.drawn {
            let Some(&node) = outputs.beginning.get(index) else { continue };
            let _ = writeln!(text, "init {setting:?} is drawn = %{}", writer.number(graph, node));
        }
        for (connection, &node) in self.releases.iter().zip(&outputs.releases) {
            let _ = writeln!(text, "release {connection} when %{}", writer.number(graph, node));
        }
        for (name, &node) in self.markers.iter().zip(&outputs.markers) {
            let _ = writeln!(text, "marker {name} at %{}", writer.number(graph, node));
        }
        for (&stream, draw) in phase.streams.iter().zip(&outputs.draws) {
            let redraw = draw.redraw.map_or(String::new(), |node| format!(", again when %{}", writer.number(graph, node)));
            let name = &self.randoms[stream].name;
            let _ = writeln!(text, "random {name} = %{}{redraw}", writer.number(graph, draw.value));
        }
        for (term, &node) in self.terms[phase.terms.clone()].iter().zip(&outputs.terms) {
            let bounds = match (term.fixed, term.weight_range) {
                (true, _) => " (fixed)".to_owned(),
                (_, Some([low, high])) => format!(" ({low}..{high})"),
                _ => String::new(),
            };
            let _ = writeln!(text, "term {} = {}{bounds} * %{}", term.name, term.weight, writer.number(graph, node));
        }
        for (metric, &node) in self.metrics[phase.metrics.clone()].iter().zip(&outputs.metrics) {
            let _ = writeln!(text, "metric {} ({}) = %{}", metric.name, metric.size, writer.number(graph, node));
        }
        for (name, &node) in self.terminations[phase.terminations.clone()].iter().zip(&outputs.terminations) {
            let _ = writeln!(text, "terminate {name} when %{}", writer.number(graph, node));
        }
        for (name, &node) in self.finishes[phase.finishes.clone()].iter().zip(&outputs.finishes) {
            let _ = writeln!(text, "finish {name} when %{}", writer.number(graph, node));
        }
        for (word, node) in [("until", outputs.until), ("succeeded", outputs.succeeded), ("success", outputs.success)] {
            if let Some(node) = node {
                let _ = writeln!(text, "{word} %{}", writer.number(graph, node));
            }
        }
        for (channel, own) in self.channels.iter().zip(&phase.channels) {
            let Some(&node) = own.and_then(|own| outputs.channels.get(own)) else { continue };
            let unit = if channel.unit.is_empty() { String::new() } else { format!(" in {}", channel.unit) };
            let _ = writeln!(text, "observe {} ({}){unit} = %{}", channel.name, channel.size, writer.number(graph, node));
        }
        for (index, &node) in outputs.updates.iter().enumerate() {
            let _ = writeln!(text, "state {index} becomes %{}", writer.number(graph, node));
        }
        text.push_str(writer.lines());
    }

    fn write_scene(&self, text: &mut String) {
        // Plain data in the order of its declaration: writing it cannot fail.
        let written = |value: serde_json::Result<String>| value.unwrap_or_default();
        let scene = &self.scene;
        let _ = writeln!(text, "scene ground {}", written(serde_json::to_string(&scene.ground)));
        for object in &scene.objects {
            let _ = writeln!(text, "scene object {}", written(serde_json::to_string(object)));
        }
        for connection in &scene.connections {
            let _ = writeln!(text, "scene connection {}", written(serde_json::to_string(connection)));
        }
        for group in &scene.groups {
            let _ = writeln!(text, "scene group {}", written(serde_json::to_string(group)));
        }
        for (index, query) in self.frame.queries().iter().enumerate() {
            let _ = writeln!(text, "query {index} {}", written(serde_json::to_string(query)));
        }
        for disturbance in &self.disturbances {
            let _ = writeln!(text, "disturb {disturbance:?}");
        }
    }

    fn write_init(&self, text: &mut String) {
        let root = &self.init.root;
        let height = root.height.map_or("on ground".to_owned(), |height| format!("{height} m"));
        let _ = writeln!(
            text,
            "init root height {height}, at {:?} m, heading {} rad, pitch {} rad, roll {} rad, velocity {:?} m/s",
            root.position, root.heading, root.pitch, root.roll, root.velocity
        );
        if root.lift != 0.0 {
            let _ = writeln!(text, "init root lift {} m", root.lift);
        }
        for (what, spreads) in [("coordinates", &self.init.coordinate_noise), ("velocities", &self.init.velocity_noise)] {
            for (spread, joints) in by_spread(spreads) {
                let _ = writeln!(text, "init noise {what} {spread:?} on joints {joints:?}");
            }
        }
        if root.spin != [0.0; 3] {
            let _ = writeln!(text, "init root spin {:?} rad/s", root.spin);
        }
        if let Some(following) = &self.init.follows {
            let digest = following.motion.digest();
            let _ = writeln!(text, "init follows motion {digest} from drawn {}: {:?}", following.start, following.parts);
        }
        for meeting in &root.meets {
            let _ = writeln!(text, "init root meets {meeting:?}");
        }
        for start in &self.init.objects {
            let _ = writeln!(text, "init {start:?}");
        }
        if let Some(settle) = &self.init.settle {
            let _ = writeln!(text, "init {settle:?}");
        }
        let _ = writeln!(text, "init coordinates {}", values(self.init.coordinates.iter().copied()));
        if self.init.velocities.iter().any(|velocity| *velocity != 0.0) {
            let _ = writeln!(text, "init velocities {}", values(self.init.velocities.iter().copied()));
        }
    }
}

/// Joints that scatter alike, by the first of each.
fn by_spread(spreads: &[Spread]) -> Vec<(Spread, Vec<usize>)> {
    let mut sorted: Vec<(Spread, Vec<usize>)> = Vec::new();
    for (joint, &spread) in spreads.iter().enumerate().filter(|(_, spread)| **spread != Spread::None) {
        match sorted.iter_mut().find(|(known, _)| *known == spread) {
            Some((_, joints)) => joints.push(joint),
            None => sorted.push((spread, vec![joint])),
        }
    }
    sorted
}
