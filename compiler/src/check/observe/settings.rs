//! Settings of channels: what lies between a value and what a policy sees of it. `pelvis.height noise normal(0, 1 cm) delay 2 steps`

use crate::check::context::{Checked, Checker, Reported};
use crate::check::dimension::Dimension;
use crate::check::random::KnownRandom;
use crate::check::types::ElementType;
use crate::check::value::TypedValue;
use crate::diagnostics::{codes, nearest};
use crate::emit::{channels, draws, temporal};
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Chance};
use crate::resolve::scope::Place;
use crate::resolve::{Texts, written};
use crate::syntax::tree::{ChannelSetting, ExprKind};
use crate::task::Spread;

/// The settings, with the forms in which they are written.
const FORMS: [(&str, &str); 5] = [
    ("noise", "noise normal(0, 1 cm)"),
    ("delay", "delay 2 steps"),
    ("history", "history 3"),
    ("scale", "scale 0.3 rad"),
    ("clip", "clip -5 .. 5"),
];

/// Most values of the past in one channel.
const MOST_STEPS: f64 = 1000.0;

/// Settings, and where their names are looked up.
#[derive(Clone, Copy)]
pub(crate) struct Placed<'a> {
    pub place: Place,
    pub settings: &'a [ChannelSetting],
}

/// A channel on its way to the policy.
pub(super) struct Seen {
    pub node: NodeId,
    /// That of every number; none where they differ.
    dimension: Option<Dimension>,
    /// Whether the numbers are an orientation, of which none stands for itself.
    orientation: bool,
    /// Whether the numbers are in other units than the value.
    pub scaled: bool,
    /// The settings as they are written, separated by blanks.
    pub written: String,
    pub noise: Vec<AddedNoise>,
    /// How many control steps back the oldest of the numbers is.
    pub past: u32,
}

/// Noise of a channel, and what it is added to.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AddedNoise {
    pub signal: NodeId,
    /// Its standard deviation, or half of its range.
    pub size: f64,
}

impl Seen {
    pub fn new(node: NodeId, data: &TypedValue) -> Self {
        let orientation = data.kind.element() == Some(ElementType::Rotation);
        Self {
            node,
            dimension: data.kind.dimension(),
            orientation,
            scaled: false,
            written: String::new(),
            noise: Vec::new(),
            past: 0,
        }
    }
}

impl<'a> Checker<'a> {
    /// Applies settings to the channel `name`, those of the channel itself before those of the blocks around it.
    pub(super) fn apply_settings(&mut self, name: &str, chain: &[Placed<'a>], texts: &dyn Texts, seen: &mut Seen) -> Checked<()> {
        for Placed { place, settings } in chain {
            for setting in *settings {
                self.elsewhere(*place, |checker| checker.apply_setting(name, setting, texts, seen))?;
            }
        }
        Ok(())
    }

    fn apply_setting(&mut self, name: &str, setting: &'a ChannelSetting, texts: &dyn Texts, seen: &mut Seen) -> Checked<()> {
        let word = setting.word.text.as_str();
        if seen.orientation && matches!(word, "noise" | "scale" | "clip") {
            let message = format!("`{word}` applies to numbers, `{name}` is an orientation");
            let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, setting.span, message);
            return Err(self.report(diagnostic.help("observe its axes: `torso.up`, `torso.forward`")));
        }
        if !FORMS.iter().any(|(known, _)| *known == word) {
            return Err(self.no_such_setting(setting));
        }
        let source = format!("{word} {}", written(&setting.value, self.place.file, texts));
        match word {
            "noise" => self.add_noise(name, setting, &source, seen)?,
            "delay" => {
                let steps = self.past(setting)?;
                seen.node = self.delayed(seen.node, steps, setting)?;
                seen.past += steps;
            }
            "history" => self.add_history(setting, seen)?,
            "scale" => self.scale(name, setting, seen)?,
            _ => self.bound(name, setting, seen)?,
        }
        if !seen.written.is_empty() {
            seen.written.push(' ');
        }
        seen.written += &source;
        self.spend(self.graph.width(seen.node), setting.span)
    }

    fn no_such_setting(&mut self, setting: &ChannelSetting) -> Reported {
        let word = setting.word.text.as_str();
        let forms = FORMS.map(|(_, form)| format!("`{form}`")).join(", ");
        let mut diagnostic = self
            .diagnostic(codes::tasks::UNKNOWN_SETTING, setting.word.span, format!("channels have no setting `{word}`"))
            .help(format!("settings of channels are {forms}; another channel stands on a line of its own"));
        for near in nearest(word, FORMS.iter().map(|(known, _)| *known)) {
            diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), setting.word.span, near);
        }
        self.report(diagnostic)
    }

    /// Noise that is drawn anew at every step, for each number by itself.
    fn add_noise(&mut self, name: &str, setting: &'a ChannelSetting, source: &str, seen: &mut Seen) -> Checked<()> {
        let (spread, dimension) = self.distribution(&setting.value)?;
        if seen.dimension != Some(dimension) {
            return Err(self.other_dimension(name, setting, dimension, seen));
        }
        let (index, width) = (self.randoms.len(), self.graph.width(seen.node));
        let (chance, low, high) = match spread {
            Spread::None => return Ok(()),
            Spread::Normal(deviation) => (Chance::Normal, 0.0, deviation),
            Spread::Uniform(low, high) => (Chance::Uniform, low, high),
        };
        let size = if chance == Chance::Normal { high } else { 0.5 * (high - low) };
        seen.noise.push(AddedNoise { signal: seen.node, size });
        let graph = &mut self.graph;
        let raw = draws::noise(graph, index, chance, width);
        let [offset, size] = [low, high - low].map(|value| graph.constant(value));
        let candidate = draws::scaled(graph, offset, size, raw);
        let drawn = draws::held(graph, index, &[candidate]);
        let after = draws::redrawn(graph, index, drawn);
        seen.node = graph.binary(Binary::Add, seen.node, after);
        let always = graph.constant(1.0);
        let stream = format!("{name}.noise");
        let again = self.randoms.iter().filter(|known| known.name.starts_with(&stream)).count();
        self.randoms.push(KnownRandom {
            name: if again == 0 { stream } else { format!("{stream}.{}", again + 1) },
            data: TypedValue::new(drawn, ElementType::Number(dimension)),
            redraw: Some(always),
            written: Some([source.trim_start_matches("noise ").to_owned(), "every step".to_owned()]),
            parameter: None,
        });
        Ok(())
    }

    /// A number of control steps, one at least.
    fn past(&mut self, setting: &'a ChannelSetting) -> Checked<u32> {
        let steps = self.steps(&setting.value)?;
        if (1.0..=MOST_STEPS).contains(&steps) {
            return Ok(steps as u32);
        }
        let message = format!("`delay` takes from 1 to {MOST_STEPS} control steps");
        Err(self.error(codes::tasks::OUT_OF_RANGE, setting.value.span, message))
    }

    fn delayed(&mut self, node: NodeId, steps: u32, setting: &ChannelSetting) -> Checked<NodeId> {
        self.hold(steps as usize * self.graph.width(node), setting.span)?;
        Ok(temporal::delayed(&mut self.graph, node, steps))
    }

    /// The present value and those of the steps before, the latest first.
    fn add_history(&mut self, setting: &'a ChannelSetting, seen: &mut Seen) -> Checked<()> {
        let count = self.fixed_number(&setting.value, Dimension::NONE, "`history`")?;
        if count.fract() != 0.0 || !(2.0..=MOST_STEPS).contains(&count) {
            let diagnostic = self
                .diagnostic(codes::tasks::OUT_OF_RANGE, setting.value.span, "`history` counts values: now, a step ago, ...")
                .expected(format!("a whole number from 2 to {MOST_STEPS}"));
            return Err(self.report(diagnostic));
        }
        seen.past += count as u32 - 1;
        let mut values = vec![seen.node];
        for steps in 1..count as u32 {
            values.push(self.delayed(seen.node, steps, setting)?);
        }
        seen.node = self.graph.join(&values);
        Ok(())
    }

    /// The value in units of another.
    fn scale(&mut self, name: &str, setting: &'a ChannelSetting, seen: &mut Seen) -> Checked<()> {
        let data = self.data(&setting.value)?;
        let own = data.kind.dimension().filter(|_| data.kind.is_one_number());
        let plain = own == Some(Dimension::NONE);
        let Some(dimension) = own.filter(|_| plain || own == seen.dimension) else {
            let found = own.unwrap_or(Dimension::NONE);
            return Err(self.other_dimension(name, setting, found, seen));
        };
        let unit = self.fixed_number(&setting.value, dimension, "`scale`")?;
        if unit <= 0.0 {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, setting.value.span, "`scale` must be positive"));
        }
        seen.node = channels::scaled(&mut self.graph, seen.node, unit);
        if !plain {
            (seen.dimension, seen.scaled) = (Some(Dimension::NONE), true);
        }
        Ok(())
    }

    /// The value kept within bounds.
    fn bound(&mut self, name: &str, setting: &'a ChannelSetting, seen: &mut Seen) -> Checked<()> {
        let ExprKind::Range { low, high } = &setting.value.kind else {
            let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, setting.span, "`clip` takes a range");
            return Err(self.report(diagnostic.expected("`clip -5 .. 5`")));
        };
        let dimension = self.dimension_of(high)?;
        if seen.dimension != Some(dimension) {
            return Err(self.other_dimension(name, setting, dimension, seen));
        }
        let [bottom, top] = self.fixed_range(low, high, dimension, "`clip`")?;
        if bottom >= top {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, setting.value.span, "the lower end must be below the upper end"));
        }
        seen.node = channels::clipped(&mut self.graph, seen.node, [bottom, top]);
        Ok(())
    }

    fn other_dimension(&mut self, name: &str, setting: &ChannelSetting, found: Dimension, seen: &Seen) -> Reported {
        let word = setting.word.text.as_str();
        let message = format!("`{word}` and the channel `{name}` have different units");
        let expected = seen.dimension.map_or_else(|| "numbers of one unit".to_owned(), |dimension| dimension.described());
        let diagnostic = self
            .diagnostic(codes::types::DIMENSIONS_DIFFER, setting.value.span, message)
            .expected(expected)
            .found(found.described());
        let diagnostic = match seen.dimension {
            None => diagnostic.help("the channel holds numbers of different units: observe them as several channels"),
            Some(_) => diagnostic,
        };
        self.report(diagnostic)
    }
}
