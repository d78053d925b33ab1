//! Fields of elements: which there are, each once, and their values, all known while compiling.

use super::elements::{FIELDS, Kind};
use crate::check::context::{Checked, Checker, Failures, Reported};
use crate::check::dimension::Dimension;
use crate::check::lookup::renamed;
use crate::check::offered::{is_bare, offer_unit, unit_of};
use crate::check::types::{ElementType, Frame, Type};
use crate::check::value::{TypedValue, Value};
use crate::diagnostics::{Span, codes, nearest};
use crate::numbers::for_people;
use crate::syntax::tree::{Element, Expr, ExprKind, Field, FieldValue};

/// The fields of one element, each known to its kind and given once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fields<'a> {
    kind: &'static Kind,
    fields: &'a [Field],
    /// The word of the element.
    pub span: Span,
}

impl<'a> Fields<'a> {
    /// The field called `name`.
    pub(super) fn get(&self, name: &str) -> Option<&'a Field> {
        self.fields.iter().find(|field| field.name.text == name)
    }

    /// Its kind.
    pub(super) fn kind(&self) -> &'static str {
        self.kind.name
    }
}

impl<'a> Checker<'a> {
    /// Looks at the words of an element's fields.
    pub(super) fn fields(&mut self, element: &'a Element, kind: &'static Kind) -> Checked<Fields<'a>> {
        let mut failures = Failures::default();
        for (index, field) in element.fields.iter().enumerate() {
            let name = field.name.text.as_str();
            if !kind.fields().any(|known| known == name) {
                failures.add(self.unknown_field(field, kind));
            } else if element.fields[..index].iter().any(|earlier| earlier.name.text == name) {
                failures.add(self.error(codes::tasks::REPEATED, field.span, format!("`{name}` is declared twice")));
            }
        }
        let missing: Vec<&str> =
            kind.required.iter().copied().filter(|name| !element.fields.iter().any(|field| field.name.text == *name)).collect();
        if !missing.is_empty() && !failures.any() {
            let forms = FIELDS.iter().filter(|row| missing.contains(&row.name)).map(|row| format!("`{}`", row.form));
            let message = format!("this `{}` does not declare its {}", kind.name, missing.join(", "));
            let diagnostic = self
                .diagnostic(codes::tasks::MISSING, element.kind.span, message)
                .help(format!("write {}", forms.collect::<Vec<_>>().join(", ")));
            return Err(self.report(diagnostic));
        }
        failures.or(Fields { kind, fields: &element.fields, span: element.kind.span })
    }

    fn unknown_field(&mut self, field: &Field, kind: &Kind) -> Reported {
        let name = field.name.text.as_str();
        let known: Vec<&str> = kind.fields().collect();
        let message = format!("`{}` has no field `{name}`", kind.name);
        let mut diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, field.name.span, message);
        if let Some(present) = renamed(name).filter(|present| known.contains(present)) {
            diagnostic = diagnostic.suggest(format!("it is now called `{present}`"), field.name.span, present);
            return self.report(diagnostic);
        }
        let near = nearest(name, known.iter().copied());
        if near.is_empty() {
            diagnostic = diagnostic.help(format!("it has {}", known.join(", ")));
        }
        for known in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{known}`?"), field.name.span, known);
        }
        self.report(diagnostic)
    }

    /// The value behind a field's word.
    pub(crate) fn field_value(&mut self, field: &'a Field) -> Checked<&'a Expr> {
        if let FieldValue::Value(value) = &field.value {
            return Ok(value);
        }
        let name = field.name.text.as_str();
        let form = FIELDS.iter().find(|row| row.name == name).map_or_else(|| format!("{name} VALUE"), |row| row.form.to_owned());
        let diagnostic = self
            .diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, format!("invalid value of `{name}`"))
            .expected(format!("`{form}`"));
        Err(self.report(diagnostic))
    }

    /// A flag: there, or `true`, or `false`; `otherwise` where it is missing.
    pub(super) fn flag(&mut self, fields: &Fields<'a>, name: &str, otherwise: bool) -> Checked<bool> {
        fields.get(name).map_or(Ok(otherwise), |field| self.flag_value(field))
    }

    /// What a flag says that is there.
    pub(crate) fn flag_value(&mut self, field: &'a Field) -> Checked<bool> {
        match &field.value {
            FieldValue::Flag => Ok(true),
            FieldValue::Value(Expr { kind: ExprKind::Bool(truth), .. }) => Ok(*truth),
            _ => {
                let name = &field.name.text;
                let message = format!("`{name}` is a flag");
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, message)
                    .expected(format!("`{name}` or `{name} false`"));
                Err(self.report(diagnostic))
            }
        }
    }

    /// A number of this dimension that is known while compiling.
    pub(crate) fn fixed_number(&mut self, expr: &'a Expr, dimension: Dimension, wanted_by: &str) -> Checked<f64> {
        let data = self.data(expr)?;
        self.known_number(&data, expr, dimension, wanted_by)
    }

    /// A whole number that is not negative and known while compiling.
    pub(crate) fn fixed_count(&mut self, expr: &'a Expr, wanted_by: &str) -> Checked<u64> {
        let value = self.fixed_number(expr, Dimension::NONE, wanted_by)?;
        // Beyond 2^53 not every whole number is one that a float can be.
        if value >= 0.0 && value.fract() == 0.0 && value <= 9e15 {
            return Ok(value as u64);
        }
        let diagnostic = self
            .diagnostic(codes::types::NOT_CONSTANT, expr.span, format!("{wanted_by} takes a whole number"))
            .expected("a whole number from 0")
            .found(for_people(value));
        Err(self.report(diagnostic))
    }

    /// The number that `data`, the value of `expr`, is known to be.
    pub(in crate::check) fn known_number(
        &mut self,
        data: &TypedValue,
        expr: &Expr,
        dimension: Dimension,
        wanted_by: &str,
    ) -> Checked<f64> {
        let found = data.kind.dimension().filter(|_| data.kind.is_one_number());
        if found != Some(dimension) && !(data.is_zero() && data.kind.is_one_number()) {
            let diagnostic = self
                .diagnostic(codes::types::DIMENSIONS_DIFFER, expr.span, format!("{wanted_by} takes {}", dimension.described()))
                .expected(dimension.described())
                .found(data.kind.described(self.vocabulary));
            let plain = found.is_some_and(Dimension::is_none) && !dimension.is_none();
            return Err(self.report(if plain { offer_unit(diagnostic, dimension, expr) } else { diagnostic }));
        }
        match self.graph.constant_lanes(data.node).as_deref() {
            Some([value]) if value.is_finite() => Ok(*value),
            Some(_) => {
                let message = format!("{wanted_by} takes one finite number");
                Err(self.error(codes::types::WRONG_TYPE, expr.span, message))
            }
            None => Err(self.must_be_known(expr.span, wanted_by)),
        }
    }

    /// The ends of a range of this dimension that are known while compiling; a bare lower end has the unit of the upper.
    pub(crate) fn fixed_range(
        &mut self,
        low: &'a Expr,
        high: &'a Expr,
        dimension: Dimension,
        wanted_by: &str,
    ) -> Checked<[f64; 2]> {
        let top = self.fixed_number(high, dimension, wanted_by)?;
        let bottom = match unit_of(high).filter(|_| is_bare(low)) {
            Some(one) => self.fixed_number(low, Dimension::NONE, wanted_by)? * one,
            None => self.fixed_number(low, dimension, wanted_by)?,
        };
        Ok([bottom, top])
    }

    /// The number of a field, which must be above 0.
    pub(super) fn positive(&mut self, fields: &Fields<'a>, name: &str, dimension: Dimension) -> Checked<f64> {
        let field = self.required(fields, name)?;
        let expr = self.field_value(field)?;
        let value = self.fixed_number(expr, dimension, &format!("`{name}`"))?;
        self.must_be_positive(value, name, expr.span)?;
        Ok(value)
    }

    pub(super) fn must_be_positive(&mut self, value: f64, name: &str, span: Span) -> Checked<()> {
        if value > 0.0 {
            return Ok(());
        }
        let message = if value == 0.0 { format!("`{name}` is 0") } else { format!("`{name}` is negative") };
        let diagnostic = self
            .diagnostic(codes::scene::SIZE, span, message)
            .expected("more than 0")
            .help("an object without extent or mass has no contacts and no inertia");
        Err(self.report(diagnostic))
    }

    /// The number of a field that may be left out and must not be negative.
    pub(super) fn not_negative(&mut self, fields: &Fields<'a>, name: &str, dimension: Dimension) -> Checked<f64> {
        let Some(field) = fields.get(name) else { return Ok(0.0) };
        let expr = self.field_value(field)?;
        let value = self.fixed_number(expr, dimension, &format!("`{name}`"))?;
        if value < 0.0 {
            return Err(self.error(codes::scene::SIZE, expr.span, format!("`{name}` is negative")));
        }
        Ok(value)
    }

    pub(super) fn required(&mut self, fields: &Fields<'a>, name: &str) -> Checked<&'a Field> {
        match fields.get(name) {
            Some(field) => Ok(field),
            None => {
                let message = format!("this `{}` does not declare its {name}", fields.kind());
                Err(self.error(codes::tasks::MISSING, fields.span, message))
            }
        }
    }

    /// A bracket of numbers of this dimension that are known while compiling; a vector or place in world axes as well.
    pub(crate) fn fixed_bracket<const SIZE: usize>(
        &mut self,
        expr: &'a Expr,
        dimension: Dimension,
        wanted_by: &str,
    ) -> Checked<[f64; SIZE]> {
        let data = match self.value(expr)? {
            Value::Typed(data) => data,
            other => return Err(self.not_numbers(&other, expr.span)),
        };
        self.must_be_bracket(&data, SIZE, dimension, expr.span, wanted_by)?;
        self.known_bracket(&data, expr.span, wanted_by)
    }

    /// The components that a bracket of as many numbers is known to have.
    pub(in crate::check) fn known_bracket<const SIZE: usize>(
        &mut self,
        data: &TypedValue,
        span: Span,
        wanted_by: &str,
    ) -> Checked<[f64; SIZE]> {
        let Some(lanes) = self.graph.constant_lanes(data.node) else { return Err(self.must_be_known(span, wanted_by)) };
        match <[f64; SIZE]>::try_from(lanes) {
            Ok(values) if values.iter().all(|value| value.is_finite()) => Ok(values),
            _ => Err(self.error(codes::types::WRONG_TYPE, span, format!("{wanted_by} takes {SIZE} finite numbers"))),
        }
    }

    /// Whether these are `size` components of one dimension, in world axes where they have a frame.
    pub(crate) fn must_be_bracket(
        &mut self,
        data: &TypedValue,
        size: usize,
        dimension: Dimension,
        span: Span,
        wanted_by: &str,
    ) -> Checked<()> {
        let fits = match &data.kind {
            Type::One(ElementType::Vector { size: own, dimension: found, frame }) => {
                *own == size && (*found == dimension || data.is_zero()) && *frame == Frame::World
            }
            Type::One(ElementType::Place(Frame::World)) => size == 3 && dimension == Dimension::LENGTH,
            Type::One(_) => false,
            list => {
                list.length() == Some(size)
                    && (list.dimension() == Some(dimension) || data.is_zero())
                    && list.all(ElementType::is_number)
            }
        };
        if fits {
            return Ok(());
        }
        let unit = if dimension.is_none() { "without unit".to_owned() } else { format!("in {dimension}") };
        let code = match &data.kind {
            list if list.length() == Some(size) => codes::types::DIMENSIONS_DIFFER,
            _ => codes::types::WRONG_TYPE,
        };
        let found = data.kind.described(self.vocabulary);
        let diagnostic = self
            .diagnostic(code, span, format!("{wanted_by} takes a list of {size} numbers"))
            .expected(format!("{size} numbers {unit}"))
            .found(found);
        Err(self.report(diagnostic))
    }

    /// Reports a value that depends on the episode.
    pub(crate) fn must_be_known(&mut self, span: Span, wanted_by: &str) -> Reported {
        let diagnostic = self
            .diagnostic(codes::types::NOT_CONSTANT, span, format!("{wanted_by} must be a compile-time constant"))
            .help("allowed are numbers, constants, parameters that are not `per episode`, and sizes and places of fixed objects of the scene");
        self.report(diagnostic)
    }
}
