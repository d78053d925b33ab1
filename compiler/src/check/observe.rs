//! Observations: named channels, blocks of a library unfolded.

mod settings;

use super::allows;
use super::context::{Checked, Checker, Failures, ReadMode};
use super::types::{ElementType, Type};
use super::value::{TypedValue, Value};
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::emit::places;
use crate::graph::NodeId;
use crate::numbers::for_people;
use crate::resolve::scope::{Definition, Place};
use crate::resolve::{Texts, label_of, summary, written};
use crate::spoken::{self, SpokenUnit};
use crate::syntax::tree::{Channel, Entry, Expr, ExprKind, TaskStatement};
pub(crate) use settings::AddedNoise;
use settings::{Placed, Seen};

/// A channel that the graph computes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ObservedChannel {
    pub name: String,
    pub node: NodeId,
    /// What is observed, before orientations become quaternions.
    pub data: TypedValue,
    pub unit: String,
    /// The formula as written.
    pub source: String,
    /// The formula itself.
    pub formula: Expr,
    /// Documentation.
    pub docs: String,
    /// The block of a library that it comes from; empty if it is the task's own.
    pub block: String,
    /// What lies between the formula and the policy, as it is written.
    pub settings: String,
    /// Whether only a critic sees it.
    pub critic: bool,
    /// What of it is noise.
    pub noise: Vec<AddedNoise>,
    /// How many control steps back it reaches.
    pub past: u32,
    /// Where the channel, or the block that it comes from, is named in the task.
    pub file: FileId,
    pub span: Span,
}

/// A block of channels, where the task names it.
#[derive(Clone, Copy)]
pub(crate) struct Block<'a> {
    name: &'a str,
    file: FileId,
    span: Span,
}

impl<'a> Checker<'a> {
    /// All `observe` blocks, in order, then all `critic` blocks. States and randoms are read after their update there.
    pub(super) fn observations(&mut self, texts: &dyn Texts) -> Checked<Vec<ObservedChannel>> {
        let statements = self.statements;
        let mut channels = Vec::new();
        let mut failures = Failures::default();
        self.in_mode(ReadMode { after: true, ..self.mode }, |checker| {
            for critic in [false, true] {
                let first = channels.len();
                for placed in statements {
                    let block = match &placed.statement {
                        TaskStatement::Observe(block) if !critic => block,
                        TaskStatement::Critic(block) if critic => block,
                        _ => continue,
                    };
                    let found =
                        checker.in_file(placed.file, |checker| checker.channels(&block.entries, texts, None, &[], &mut channels));
                    failures.catch(found);
                }
                channels[first..].iter_mut().for_each(|channel| channel.critic = critic);
            }
        });
        failures.or(channels)
    }

    /// All `metrics` blocks, in order: logged, never rewarded.
    pub(super) fn metrics(&mut self, texts: &dyn Texts) -> Checked<Vec<ObservedChannel>> {
        let statements = self.statements;
        let mut metrics = Vec::new();
        let mut failures = Failures::default();
        for placed in statements {
            if let TaskStatement::Metrics(block) = &placed.statement {
                let found = self.in_file(placed.file, |checker| checker.channels(&block.entries, texts, None, &[], &mut metrics));
                failures.catch(found);
                let own = block
                    .entries
                    .iter()
                    .filter_map(|entry| if let Entry::Item(channel) = entry { channel.settings.first() } else { None });
                for setting in own {
                    let word = &setting.word.text;
                    let message = format!("`{word}` belongs to channels of the observation; a metric is what it is");
                    let diagnostic = Diagnostic::new(codes::tasks::UNKNOWN_SETTING, placed.file, setting.span, message);
                    failures.add(self.report(diagnostic));
                }
            }
        }
        failures.or(metrics)
    }

    /// Reports a policy that would be shown nothing at all.
    pub(super) fn observes_nothing(&mut self, (file, span): (FileId, Span)) {
        let diagnostic = Diagnostic::new(codes::tasks::MISSING, file, span, "the observation is empty");
        self.report(
            diagnostic.help("declare its channels: `observe { pelvis.height }`, or a block of channels such as `proprioception`"),
        );
    }

    /// Checks the channels of `observe`, or of a block of it, `around` which there are settings.
    pub(crate) fn channels(
        &mut self,
        entries: &'a [Entry<Channel>],
        texts: &dyn Texts,
        block: Option<Block<'a>>,
        around: &[Placed<'a>],
        found: &mut Vec<ObservedChannel>,
    ) -> Checked<()> {
        let mut failures = Failures::default();
        for entry in entries {
            if let (Entry::Allow(allow), Some(_)) = (entry, block) {
                self.allowances.extend(allows::of_library(allow, self.place.file, &mut self.diagnostics));
            }
            let Some(channel) = self.plain_entry(entry, "channel") else { continue };
            failures.catch(self.channel(channel, texts, block, around, found));
        }
        failures.or(())
    }

    fn channel(
        &mut self,
        channel: &'a Channel,
        texts: &dyn Texts,
        block: Option<Block<'a>>,
        around: &[Placed<'a>],
        found: &mut Vec<ObservedChannel>,
    ) -> Checked<()> {
        // Settings of the channel apply before those of the blocks in which it stands.
        let own = Placed { place: self.place, settings: &channel.settings };
        let chain: Vec<Placed<'a>> = [own].into_iter().chain(around.iter().copied()).collect();
        if let ExprKind::Name(name) = &channel.value.kind
            && let Some((declared, place)) = self.names.find(self.place, &name.text)
            && let Definition::Observation(observation) = declared.definition
        {
            self.names.called.borrow_mut().insert((declared.file, name.text.clone()));
            let block = block.unwrap_or(Block { name: &name.text, file: self.place.file, span: channel.span });
            return self.deeper(channel.span, |checker| {
                checker.elsewhere(place, |checker| checker.channels(&observation.channels, texts, Some(block), &chain, found))
            });
        }
        let name = label_of(channel, self.place.file, texts);
        let data = match self.value(&channel.value)? {
            Value::Typed(data) => data,
            other => return Err(self.not_numbers(&other, channel.value.span)),
        };
        let mut seen = Seen::new(self.observed(&data), &data);
        self.apply_settings(&name, &chain, texts, &mut seen)?;
        let node = seen.node;
        if let Some(known) = found.iter().find(|known| known.name == name) {
            let message = format!("the channel `{name}` is declared twice");
            let diagnostic = self.diagnostic(codes::tasks::LABEL_TWICE, channel.span, message);
            let help = match known.node == node && known.block.is_empty() {
                true => "both have the same values: remove one".to_owned(),
                false if known.node == node => format!("`{}` observes it already: remove this channel", known.block),
                false => "label one of them: `label = value`".to_owned(),
            };
            return Err(self.report(diagnostic.help(help)));
        }
        let lanes = self.graph.constant_lanes(node);
        if let Some(value) = lanes.iter().flatten().find(|value| !value.is_finite()) {
            let message = format!("`{name}` is {} in every state", for_people(*value));
            let diagnostic = self.diagnostic(codes::tasks::NOT_FINITE, channel.span, message);
            return Err(
                self.report(diagnostic.help("what is observed or measured has to be finite: look for a division by zero"))
            );
        }
        self.spend(self.graph.width(node), channel.span)?;
        let (file, span) = block.map_or((self.place.file, channel.span), |block| (block.file, block.span));
        let block = block.map_or_else(String::new, |block| block.name.to_owned());
        let source = written(&channel.value, self.place.file, texts);
        let unit = if seen.scaled { String::new() } else { unit_of(&data.kind) };
        let (formula, settings, noise, past) = (channel.value.clone(), seen.written, seen.noise, seen.past);
        let docs = summary(channel.docs.as_ref());
        let critic = false;
        found.push(ObservedChannel {
            name,
            node,
            data,
            unit,
            source,
            formula,
            docs,
            block,
            settings,
            critic,
            noise,
            past,
            file,
            span,
        });
        Ok(())
    }

    /// The node whose lanes are observed: orientations as quaternions, everything else as it is.
    fn observed(&mut self, data: &TypedValue) -> NodeId {
        if data.kind.element() != Some(ElementType::Rotation) {
            return data.node;
        }
        places::quaternions(&mut self.graph, data.node, data.kind.shape().count())
    }
}

/// The unit as printed: empty for plain numbers, several for mixed sets.
pub(crate) fn unit_of(ty: &Type) -> String {
    match ty {
        Type::One(ElementType::Steps) | Type::List(ElementType::Steps, _) => "steps".to_owned(),
        other => other.units().join(", "),
    }
}

/// The unit in which values of this type are printed where these formulas are read.
pub(crate) fn spoken_unit<'a>(ty: &Type, formulas: impl IntoIterator<Item = &'a Expr>) -> SpokenUnit {
    match ty.dimension() {
        Some(dimension) => spoken::written(dimension, formulas),
        None => SpokenUnit::si(unit_of(ty)),
    }
}

/// Where a formula of the task itself stands.
impl Place {
    pub(crate) fn of_task(file: FileId) -> Self {
        Self { file, in_task: true }
    }
}
