//! Stacked areas over a common axis: parts of a sum one upon the other, those below zero downward, with a line for the sum.

use super::chart::{BOTTOM, LEFT, RIGHT, STROKES, STYLE, Scale, TOP, WIDTH, text};
use super::escape;
use super::path::{Path, number};
use core::fmt::Write;
use nalgebra::Vector2;

/// Height of the areas.
const HEIGHT: f64 = 420.0;

/// Parts of a sum over a common axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stack {
    /// Line above the picture.
    pub title: String,
    /// Name and unit of the common axis.
    pub axis: String,
    /// Name and unit of the sum.
    pub label: String,
    /// Where on the common axis the values are, in increasing order.
    pub at: Vec<f64>,
    /// Parts, from the axis outward, each with a name and a value for every place; what is not finite counts as 0.
    pub parts: Vec<(String, Vec<f64>)>,
}

/// Draws a stack as SVG.
pub fn svg(stack: &Stack) -> String {
    let height = TOP + HEIGHT + BOTTOM + 26.0 * stack.parts.len() as f64;
    let (w, h) = (number(WIDTH), number(height));
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" role="img">"#);
    let _ = writeln!(out, "<title>{}</title>\n<style>{STYLE}</style>", escape(&stack.title));
    let _ = writeln!(out, r##"<rect width="{w}" height="{h}" rx="16" fill="#fdfcfa"/>"##);
    text(&mut out, "title", [LEFT, 42.0], &stack.title);
    let (edges, sum) = edges(stack);
    let all = edges.iter().flat_map(|[inner, outer]| inner.iter().chain(outer)).chain(&sum).copied();
    let across = Scale::new(stack.at.iter().copied(), [LEFT, WIDTH - RIGHT], false);
    let up = Scale::new(all.chain([0.0]), [TOP + HEIGHT, TOP], true);
    for (value, label) in up.ticks() {
        let y = up.place(value);
        let _ = writeln!(out, r#"<path class="grid" d="M{} {}H{}"/>"#, number(LEFT), number(y), number(WIDTH - RIGHT));
        text(&mut out, "small end", [LEFT - 10.0, y + 7.0], &label);
    }
    for (value, label) in across.ticks() {
        text(&mut out, "small middle", [across.place(value), TOP + HEIGHT + 28.0], &label);
    }
    text(&mut out, "middle", [0.5 * (LEFT + WIDTH - RIGHT), TOP + HEIGHT + 62.0], &stack.axis);
    let line = |values: &[f64]| -> Vec<Vector2<f64>> {
        stack.at.iter().zip(values).map(|(x, y)| Vector2::new(across.place(*x), up.place(*y))).collect()
    };
    for (place, ([inner, outer], (name, _))) in edges.iter().zip(&stack.parts).enumerate() {
        let fill = STROKES[place % STROKES.len()];
        let mut path = Path::default();
        path.polyline(&line(outer).into_iter().chain(line(inner).into_iter().rev()).collect::<Vec<_>>());
        let _ = writeln!(out, r#"<path class="part" fill="{fill}" fill-opacity=".75" d="{}"/>"#, path.data());
        let y = number(TOP + HEIGHT + BOTTOM + 26.0 * place as f64);
        let _ = writeln!(out, r#"<text class="small" x="{}" y="{y}" style="fill:{fill}">{}</text>"#, number(LEFT), escape(name));
    }
    let mut path = Path::default();
    path.polyline(&line(&sum));
    let _ = writeln!(out, r##"<path class="curve" stroke="#2b2a28" d="{}"/>"##, path.data());
    text(&mut out, "", [LEFT, TOP - 10.0], &stack.label);
    out.push_str("</svg>\n");
    out
}

/// Inner and outer edge of every part, and the sum of all.
fn edges(stack: &Stack) -> (Vec<[Vec<f64>; 2]>, Vec<f64>) {
    let count = stack.at.len();
    let (mut above, mut below) = (vec![0.0; count], vec![0.0; count]);
    let edges = stack.parts.iter().map(|(_, values)| {
        let (mut inner, mut outer) = (vec![0.0; count], vec![0.0; count]);
        for (place, value) in values.iter().take(count).enumerate() {
            let value = if value.is_finite() { *value } else { 0.0 };
            let side = if value < 0.0 { &mut below[place] } else { &mut above[place] };
            inner[place] = *side;
            *side += value;
            outer[place] = *side;
        }
        [inner, outer]
    });
    let edges = edges.collect();
    (edges, above.iter().zip(&below).map(|(above, below)| above + below).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stack() -> Stack {
        let parts = vec![
            ("a < b".to_owned(), vec![1.0, 2.0, f64::NAN]),
            ("cost".to_owned(), vec![-1.0, -3.0, -1.0]),
            ("alive".to_owned(), vec![5.0, 5.0, 5.0]),
        ];
        Stack { title: "T".into(), axis: "time [s]".into(), label: "reward".into(), at: vec![0.0, 0.1, 0.2], parts }
    }

    #[test]
    fn parts_are_stacked_on_their_side_of_zero() {
        let (edges, sum) = edges(&stack());
        assert_eq!(edges[0], [vec![0.0; 3], vec![1.0, 2.0, 0.0]]);
        assert_eq!(edges[1], [vec![0.0; 3], vec![-1.0, -3.0, -1.0]]);
        assert_eq!(edges[2], [vec![1.0, 2.0, 0.0], vec![6.0, 7.0, 5.0]]);
        assert_eq!(sum, [5.0, 4.0, 4.0]);
    }

    #[test]
    fn a_stack_is_well_formed_and_names_its_parts() {
        let picture = svg(&stack());
        let document = roxmltree::Document::parse(&picture).unwrap();
        assert_eq!(document.descendants().filter(|node| node.attribute("class") == Some("part")).count(), 3);
        assert!(picture.contains("a &lt; b") && picture.contains("time [s]") && !picture.contains("NaN"));
        assert!(roxmltree::Document::parse(&svg(&Stack::default())).is_ok());
    }
}
