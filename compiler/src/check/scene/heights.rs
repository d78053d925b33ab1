//! Height fields by formula: the formula is evaluated at every sample while compiling.

use super::drawn::SceneField;
use super::fields::Fields;
use super::shapes::Draw;
use super::varied::{MOST_SAMPLES, ShapeField};
use crate::check::context::{Checked, Checker, Local};
use crate::check::dimension::Dimension;
use crate::check::types::ElementType;
use crate::check::value::{TypedValue, Value};
use crate::diagnostics::codes;
use crate::scene::Terrain;
use crate::syntax::tree::walk::{Visitor, walk_expression};
use crate::syntax::tree::{Expr, ExprKind};

/// Samples of one height field.
const MOST: f64 = 10_000.0;

impl<'a> Checker<'a> {
    /// `heights waves { size [10 m, 2 m], samples [101, 11], height 0.1 m * sin(x * 90 deg/m) }`
    pub(super) fn heights(&mut self, fields: &Fields<'a>, drawn: &mut Vec<Draw<'a>>) -> Checked<Terrain> {
        let field = self.required(fields, "size")?;
        let expr = self.field_value(field)?;
        self.must_not_vary(expr, "size", "draw `height` instead, or `at`")?;
        let size: [f64; 2] = self.fixed_bracket(expr, Dimension::LENGTH, "`size` of `heights`")?;
        for extent in size {
            self.must_be_positive(extent, "size", expr.span)?;
        }
        let field = self.required(fields, "samples")?;
        let expr = self.field_value(field)?;
        self.must_not_vary(expr, "samples", "draw `height` instead")?;
        let [along, across]: [f64; 2] = self.fixed_bracket(expr, Dimension::NONE, "`samples`")?;
        let whole = |count: f64| count >= 2.0 && count.fract() == 0.0;
        if !whole(along) || !whole(across) || along * across > MOST {
            let message = format!("`samples` are two whole numbers, at least 2 each and at most {MOST} together");
            return Err(self.error(codes::scene::SIZE, expr.span, message));
        }
        let samples = [along as usize, across as usize];
        let heights = self.sampled_heights(fields, size, samples, drawn)?;
        Ok(Terrain::Heights { size, samples, heights })
    }

    /// The formula at every sample, x fastest; from the middle of what may be drawn.
    fn sampled_heights(
        &mut self,
        fields: &Fields<'a>,
        size: [f64; 2],
        samples: [usize; 2],
        drawn: &mut Vec<Draw<'a>>,
    ) -> Checked<Vec<f64>> {
        let field = self.required(fields, "height")?;
        let formula = self.field_value(field)?;
        let mut heights = Vec::with_capacity(samples[0] * samples[1]);
        let mut varies = false;
        // A wall of waves or steps has the same heights in all rows.
        let rows = if names(formula, "y") { samples[1] } else { 1 };
        for [x, y] in places(size, samples).take(samples[0] * rows) {
            let height = self.with_coordinates(x, y, |checker| checker.field_number(formula, Dimension::LENGTH, "`height`"))?;
            heights.push(height.value);
            varies |= height.drawn.is_some();
            if varies && samples[0] * samples[1] > MOST_SAMPLES {
                let message = format!("a height field that is drawn has at most {MOST_SAMPLES} samples");
                let diagnostic = self.diagnostic(codes::scene::SIZE, formula.span, message);
                return Err(self.report(diagnostic.help("fewer samples, or a formula without a random")));
            }
        }
        let heights = heights.repeat(samples[1] / rows);
        if varies {
            drawn.push((SceneField::Shape(ShapeField::Heights(size, samples)), formula));
        }
        Ok(heights)
    }

    pub(in crate::check) fn with_coordinates<T>(&mut self, x: f64, y: f64, check: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.locals.len();
        for (name, value) in [("x", x), ("y", y)] {
            let node = self.graph.constant(value);
            let value = Value::Typed(TypedValue::new(node, ElementType::Number(Dimension::LENGTH)));
            self.locals.push(Local { name: name.to_owned(), value, definition: None });
        }
        let result = check(self);
        self.locals.truncate(before);
        result
    }
}

/// Where the samples of a height field are, x fastest.
pub(in crate::check) fn places(size: [f64; 2], samples: [usize; 2]) -> impl Iterator<Item = [f64; 2]> {
    let step = |extent: f64, count: usize, index: usize| extent * index as f64 / (count - 1) as f64;
    let row = move |row: usize| step(size[1], samples[1], row) - 0.5 * size[1];
    (0..samples[1]).flat_map(move |y| (0..samples[0]).map(move |x| [step(size[0], samples[0], x), row(y)]))
}

/// Whether a word stands in a formula as a name, or in the braces of one.
fn names(formula: &Expr, word: &str) -> bool {
    struct Search<'w> {
        word: &'w str,
        found: bool,
    }
    impl<'a> Visitor<'a> for Search<'_> {
        fn expression(&mut self, expression: &'a Expr) {
            let (ExprKind::Name(name) | ExprKind::Field { name, .. }) = &expression.kind else {
                return walk_expression(self, expression);
            };
            let inside = |character: char| character.is_ascii_alphanumeric() || character == '_';
            self.found |= name.text.split(|character| !inside(character)).any(|part| part == self.word);
            walk_expression(self, expression);
        }
    }
    let mut search = Search { word, found: false };
    search.expression(formula);
    search.found
}
