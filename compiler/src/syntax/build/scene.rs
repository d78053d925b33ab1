//! Scenes, elements with fields, and how an episode begins.

use super::{Builder, is_mark, part, parts};
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{
    Act, Align, Assignment, Connection, Element, ElementName, Expr, Field, FieldValue, Group, Ident, InitStatement, Marker,
    Noise, Placement, PoseUse, Repeat, ScaledQuantity, Scaling, SceneStatement, Settle,
};
use crate::syntax::wording;

impl Builder<'_> {
    pub(super) fn scene_statements(&mut self, block: Option<Pair<'_>>) -> Vec<SceneStatement> {
        let mut statements = Vec::new();
        for pair in block.into_iter().flat_map(Pair::into_inner) {
            statements.push(match pair.as_rule() {
                Rule::element | Rule::scene_element => SceneStatement::Element(self.element(&pair)),
                Rule::connection => SceneStatement::Connection(self.connection(&pair)),
                Rule::group => SceneStatement::Group(self.group(&pair)),
                Rule::marker => SceneStatement::Marker(self.marker(&pair)),
                Rule::repeat => SceneStatement::Repeat(self.repeat(&pair)),
                Rule::remove => SceneStatement::Remove(self.remove(&pair)),
                Rule::allow => SceneStatement::Allow(self.allow(&pair)),
                Rule::junk => {
                    self.junk(&pair, Rule::one_scene_statement);
                    continue;
                }
                _ => continue,
            });
        }
        statements
    }

    pub(super) fn element(&mut self, pair: &Pair<'_>) -> Element {
        let span = self.span(pair);
        let docs = self.docs(span);
        let kind = self.identifier_in(pair);
        let name = self.element_name(pair);
        let on = part(pair, Rule::on).map(|on| self.expression(part(&on, Rule::postfixed)));
        let (fields, parts) = self.fields(pair);
        Element { docs, kind, name, on, fields, parts, span }
    }

    /// An element whose kind is one of the language's words, such as `landmark`.
    pub(super) fn element_of(&mut self, pair: &Pair<'_>, kind: Ident) -> Element {
        Element { kind, ..self.element(pair) }
    }

    fn element_name(&mut self, pair: &Pair<'_>) -> Option<ElementName> {
        if part(pair, Rule::path).is_some() {
            return Some(ElementName::Name(self.path_in(pair)));
        }
        if let Some(name) = part(pair, Rule::name) {
            return Some(ElementName::Name(self.name(Some(name))));
        }
        part(pair, Rule::text).map(|text| ElementName::Quoted(self.text(Some(text))))
    }

    /// Fields and inner elements of the `field_block` in `pair`.
    fn fields(&mut self, pair: &Pair<'_>) -> (Vec<Field>, Vec<Element>) {
        let (mut fields, mut elements) = (Vec::new(), Vec::new());
        for pair in part(pair, Rule::field_block).into_iter().flat_map(Pair::into_inner) {
            match pair.as_rule() {
                Rule::field => fields.push(self.field(&pair)),
                Rule::element => elements.push(self.element(&pair)),
                Rule::field_junk => self.junk(&pair, Rule::one_field),
                _ => {}
            }
        }
        (fields, elements)
    }

    /// `align PLACE to TARGET with JOINTS`
    pub(super) fn align(&mut self, pair: &Pair<'_>) -> Align {
        let former = part(pair, Rule::former_meets);
        let meets = former.as_ref().unwrap_or(pair);
        let (place, target) = (part(meets, Rule::postfixed), part(meets, Rule::expression));
        if former.is_some() {
            let words = |pair: &Option<Pair<'_>>| pair.as_ref().map_or("", |pair| pair.as_str().trim_end()).to_owned();
            self.report(wording::former_align(self.file, self.span(meets), &words(&place), &words(&target)));
        }
        let joints = part(pair, Rule::with_joints).map(|joints| self.expression_in(&joints));
        Align { place: self.expression(place), target: self.expression(target), joints, span: self.span(pair) }
    }

    fn field(&mut self, pair: &Pair<'_>) -> Field {
        let span = self.span(pair);
        if let Some(meets) = part(pair, Rule::meets) {
            let align = self.align(&meets);
            let name = self.field_word(&meets, Rule::kw_align);
            return Field { name, value: FieldValue::Align(align), span };
        }
        if let Some(ends) = part(pair, Rule::from_to) {
            let mut places = parts(&ends, Rule::expression);
            let from = self.expression(places.next());
            let to = self.expression(places.next());
            let name = self.field_word(&ends, Rule::kw_from);
            return Field { name, value: FieldValue::FromTo { from, to }, span };
        }
        let name = self.field_word(pair, Rule::word);
        let value = if let Some(on) = part(pair, Rule::on) {
            FieldValue::On(self.expression(part(&on, Rule::postfixed)))
        } else if part(pair, Rule::expression).is_some() {
            FieldValue::Value(self.ranged(pair))
        } else {
            FieldValue::Flag
        };
        Field { name, value, span }
    }

    fn field_word(&mut self, pair: &Pair<'_>, rule: Rule) -> Ident {
        part(pair, rule).map_or_else(|| self.keyword(pair), |word| self.keyword(&word))
    }

    fn connection(&mut self, pair: &Pair<'_>) -> Connection {
        let mut ends = parts(pair, Rule::postfixed);
        let kind = if part(pair, Rule::kw_weld).is_some() { Rule::kw_weld } else { Rule::kw_connect };
        let release = part(pair, Rule::release);
        Connection {
            kind: self.field_word(pair, kind),
            from: self.expression(ends.next()),
            to: self.expression(ends.next()),
            here: part(pair, Rule::here).is_some(),
            release: release.map(|release| self.expression(part(&release, Rule::chain))),
            span: self.span(pair),
        }
    }

    fn group(&mut self, pair: &Pair<'_>) -> Group {
        let span = self.span(pair);
        Group { docs: self.docs(span), name: self.identifier_in(pair), members: self.expression_in(pair), span }
    }

    fn marker(&mut self, pair: &Pair<'_>) -> Marker {
        Marker { name: self.name_in(pair), at: self.expression_in(pair), span: self.span(pair) }
    }

    fn repeat(&mut self, pair: &Pair<'_>) -> Repeat {
        let range = part(pair, Rule::range);
        Repeat {
            variable: self.identifier_in(pair),
            range: match range {
                Some(range) => self.ranged(&range),
                None => self.missing(),
            },
            statements: self.scene_statements(part(pair, Rule::scene_block)),
            span: self.span(pair),
        }
    }

    pub(super) fn init_statements(&mut self, block: Option<Pair<'_>>) -> Vec<InitStatement> {
        let mut statements = Vec::new();
        for pair in block.into_iter().flat_map(Pair::into_inner) {
            statements.push(match pair.as_rule() {
                Rule::pose | Rule::pose_block => InitStatement::Pose(self.pose_use(&pair)),
                Rule::noise => InitStatement::Noise(self.noise(&pair)),
                Rule::scaling => InitStatement::Scaling(self.scaling(&pair)),
                Rule::settle => InitStatement::Settle(self.settle(&pair)),
                Rule::placement => InitStatement::Object(self.placement(&pair)),
                Rule::remove => InitStatement::Remove(self.remove(&pair)),
                Rule::allow => InitStatement::Allow(self.allow(&pair)),
                Rule::junk => {
                    self.junk(&pair, Rule::one_init_statement);
                    continue;
                }
                _ => continue,
            });
        }
        statements
    }

    pub(super) fn placement(&mut self, pair: &Pair<'_>) -> Placement {
        let object = self.path_in(pair);
        let (fields, elements) = self.fields(pair);
        for element in elements {
            self.report(crate::syntax::wording::element_in_placement(self.file, element.kind.span, &object.text));
        }
        Placement { object, fields, span: self.span(pair) }
    }

    pub(super) fn disturb(&mut self, pair: &Pair<'_>) -> Element {
        let kind = self.field_word(pair, Rule::kw_disturb);
        self.element_of(pair, kind)
    }

    pub(super) fn act(&mut self, pair: &Pair<'_>) -> Act {
        let keyword = self.field_word(pair, Rule::kw_act).span;
        let (fields, elements) = self.fields(pair);
        for element in elements {
            self.report(crate::syntax::wording::element_in_action_space(self.file, element.kind.span, &element.kind.text));
        }
        Act { keyword, target: self.identifier_in(pair), fields, span: self.span(pair) }
    }

    pub(super) fn pose_use(&mut self, pair: &Pair<'_>) -> PoseUse {
        PoseUse { name: self.identifier_in(pair), adjustments: self.assignments(pair), span: self.span(pair) }
    }

    pub(super) fn assignments(&mut self, pair: &Pair<'_>) -> Vec<Assignment> {
        let mut assignments = Vec::new();
        for pair in part(pair, Rule::assignments).into_iter().flat_map(Pair::into_inner) {
            match pair.as_rule() {
                Rule::assignment => assignments.push(Assignment {
                    target: self.expression(part(&pair, Rule::postfixed)),
                    value: self.expression_in(&pair),
                    span: self.span(&pair),
                }),
                Rule::field_junk => self.junk(&pair, Rule::one_assignment),
                rule => debug_assert!(is_mark(rule)),
            }
        }
        assignments
    }

    fn noise(&mut self, pair: &Pair<'_>) -> Noise {
        let mut operands = parts(pair, Rule::postfixed);
        let target = self.expression(operands.next());
        let distribution = self.expression(operands.next());
        Noise { target, distribution, span: self.span(pair) }
    }

    fn scaling(&mut self, pair: &Pair<'_>) -> Scaling {
        let words = [
            (Rule::kw_mass, ScaledQuantity::Mass),
            (Rule::kw_damping, ScaledQuantity::Damping),
            (Rule::kw_stiffness, ScaledQuantity::Stiffness),
        ];
        let word = words.into_iter().find(|(rule, _)| part(pair, *rule).is_some());
        let quantity = word.map_or(ScaledQuantity::Strength, |(_, quantity)| quantity);
        let target = self.expression(part(pair, Rule::postfixed));
        Scaling { quantity, target, factor: self.expression_in(pair), span: self.span(pair) }
    }

    fn settle(&mut self, pair: &Pair<'_>) -> Settle {
        let mut values = parts(pair, Rule::expression);
        let duration = self.expression(values.next());
        let activation: Option<Expr> = values.next().map(|activation| self.expression(Some(activation)));
        Settle { duration, activation, at_rest: part(pair, Rule::at_rest).is_some(), span: self.span(pair) }
    }
}
