//! The snapshot: canonical text of what a task means. Layout, comments and local names of the source do not show in it.

use crate::graph::text::{Writer, values};
use crate::task::CompiledTask;
use std::fmt::Write;

impl CompiledTask {
    /// Canonical, diffable text of the task's meaning: terms, weights, ranges, ends, channels, beginning and the graph.
    pub fn snapshot(&self) -> String {
        let mut writer = Writer::default();
        let graph = &self.meaning.graph;
        let outputs = &self.meaning.outputs;
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "task {} on {}", self.name, self.body.name);
        let _ = writeln!(text, "family {}", self.family);
        let _ = writeln!(text, "control {} Hz", self.control_frequency);
        let _ = writeln!(text, "horizon {} steps", self.horizon);
        let _ = writeln!(text, "symmetric {}", self.symmetric);
        self.write_init(&mut text);
        for (term, &node) in self.terms.iter().zip(&outputs.terms) {
            let bounds = match (term.fixed, term.weight_range) {
                (true, _) => " (fixed)".to_owned(),
                (_, Some([low, high])) => format!(" ({low}..{high})"),
                _ => String::new(),
            };
            let _ = writeln!(text, "term {} = {}{bounds} * %{}", term.name, term.weight, writer.number(graph, node));
        }
        for (name, &node) in self.terminations.iter().zip(&outputs.terminations) {
            let _ = writeln!(text, "terminate {name} when %{}", writer.number(graph, node));
        }
        if let Some(node) = outputs.success {
            let _ = writeln!(text, "success %{}", writer.number(graph, node));
        }
        for (channel, &node) in self.channels.iter().zip(&outputs.channels) {
            let unit = if channel.unit.is_empty() { String::new() } else { format!(" in {}", channel.unit) };
            let _ = writeln!(text, "observe {} ({}){unit} = %{}", channel.name, channel.size, writer.number(graph, node));
        }
        for (index, &node) in outputs.updates.iter().enumerate() {
            let _ = writeln!(text, "state {index} becomes %{}", writer.number(graph, node));
        }
        text + writer.lines()
    }

    fn write_init(&self, text: &mut String) {
        let root = &self.init.root;
        let height = root.height.map_or("on ground".to_owned(), |height| format!("{height} m"));
        let _ = writeln!(
            text,
            "init root height {height}, at {:?} m, heading {} rad, velocity {:?} m/s",
            root.position, root.heading, root.velocity
        );
        let _ = writeln!(text, "init noise joints {} rad, velocities {} rad/s", self.init.joint_noise, self.init.velocity_noise);
        let _ = writeln!(text, "init coordinates {}", values(self.init.coordinates.iter().copied()));
    }
}
