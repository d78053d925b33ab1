//! Horizontal bars: one number of several things for each name, in the colours of the charts.

use super::chart::{STROKES, WORDS};
use super::escape;
use super::path::number;
use core::fmt::Write;

/// Bars of several series.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bars {
    /// Line above the picture.
    pub title: String,
    /// Names of the series.
    pub series: Vec<String>,
    /// Names with a value for each series; what is not finite has no bar.
    pub rows: Vec<(String, Vec<f64>)>,
}

const WIDTH: f64 = 1000.0;
const LEFT: f64 = 290.0;
const RIGHT: f64 = 110.0;
const TOP: f64 = 70.0;
const BAR: f64 = 20.0;
const GAP: f64 = 16.0;

/// Draws bars as SVG.
pub fn svg(bars: &Bars) -> String {
    let count = bars.series.len().max(1) as f64;
    let legend = if bars.series.len() > 1 { 34.0 * count } else { 0.0 };
    let row = count * BAR + GAP;
    let height = TOP + legend + bars.rows.len() as f64 * row + 20.0;
    let values = || bars.rows.iter().flat_map(|(_, values)| values).copied().filter(|value| value.is_finite());
    let (low, high) = values().fold((0.0_f64, 0.0_f64), |(low, high), value| {
        (if value < low { value } else { low }, if value > high { value } else { high })
    });
    let scale = if high > low { (WIDTH - LEFT - RIGHT) / (high - low) } else { 0.0 };
    let zero = LEFT - low * scale;
    let (w, h) = (number(WIDTH), number(height));
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" role="img">"#);
    let _ = writeln!(out, "<title>{}</title>\n<style>{WORDS}</style>", escape(&bars.title));
    let _ = writeln!(out, r##"<rect width="{w}" height="{h}" rx="16" fill="#fdfcfa"/>"##);
    let mut text = |class: &str, x: f64, y: f64, words: &str| {
        let _ = writeln!(out, r#"<text class="{class}" x="{}" y="{}">{}</text>"#, number(x), number(y), escape(words));
    };
    text("title", 30.0, 42.0, &bars.title);
    for (place, (name, _)) in bars.rows.iter().enumerate() {
        let top = TOP + legend + place as f64 * row;
        text("small end", LEFT - 14.0, top + 0.5 * count * BAR + 6.0, name);
    }
    if bars.series.len() > 1 {
        for (index, name) in bars.series.iter().enumerate() {
            text("small", LEFT + 34.0, TOP + 34.0 * index as f64 + 16.0, name);
        }
    }
    for (index, _) in bars.series.iter().enumerate().filter(|_| bars.series.len() > 1) {
        let (y, fill) = (number(TOP + 34.0 * index as f64), STROKES[index % STROKES.len()]);
        let _ = writeln!(out, r#"<rect x="{}" y="{y}" width="20" height="20" fill="{fill}"/>"#, number(LEFT));
    }
    for (place, (_, values)) in bars.rows.iter().enumerate() {
        for (index, value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let top = TOP + legend + place as f64 * row + index as f64 * BAR;
            let [from, to] = if *value < 0.0 { [zero + value * scale, zero] } else { [zero, zero + value * scale] };
            let fill = STROKES[index % STROKES.len()];
            let (x, y, width) = (number(from), number(top), number(to - from));
            let _ = writeln!(out, r#"<rect x="{x}" y="{y}" width="{width}" height="18" fill="{fill}"/>"#);
            let words = msk_program::numbers::for_people(*value);
            let (x, y) = (number(to + 8.0), number(top + 16.0));
            let _ = writeln!(out, r#"<text class="small" x="{x}" y="{y}">{words}</text>"#);
        }
    }
    out.push_str("</svg>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_well_formed_and_leave_out_what_is_no_number() {
        let bars = Bars {
            title: "a < b".into(),
            series: vec!["one".into(), "two".into()],
            rows: vec![("x".into(), vec![1.0, -2.0]), ("y".into(), vec![f64::NAN, 0.5])],
        };
        let picture = svg(&bars);
        let document = roxmltree::Document::parse(&picture).unwrap();
        // The ground, two of the legend, three bars.
        assert_eq!(document.descendants().filter(|node| node.has_tag_name("rect")).count(), 6);
        assert!(picture.contains("a &lt; b") && !picture.contains("NaN") && !picture.contains("width=\"-"));
        assert!(roxmltree::Document::parse(&svg(&Bars::default())).is_ok());
    }
}
