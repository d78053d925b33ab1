//! Radar charts: several things on axes around a centre, each from 0 to 100.

use super::chart::{STROKES, WORDS};
use super::escape;
use super::path::number;
use core::fmt::Write;

const SIZE: f64 = 1000.0;
const CENTRE: [f64; 2] = [500.0, 430.0];
const RADIUS: f64 = 300.0;

/// Draws `series`, each a name and a value from 0 to 100 for every axis, as SVG. What is not finite is drawn as 0.
pub fn svg(title: &str, axes: &[String], series: &[(String, Vec<f64>)]) -> String {
    let height = 800.0 + 34.0 * series.len() as f64;
    let place = |axis: usize, value: f64| {
        let angle = core::f64::consts::TAU * axis as f64 / axes.len().max(1) as f64;
        let (sine, cosine) = libm::sincos(angle);
        let radius = RADIUS * value / 100.0;
        [CENTRE[0] + radius * sine, CENTRE[1] - radius * cosine]
    };
    let outline = |values: &dyn Fn(usize) -> f64| {
        let corners: Vec<String> = (0..axes.len())
            .map(|axis| {
                let [x, y] = place(axis, values(axis));
                format!("{},{}", number(x), number(y))
            })
            .collect();
        corners.join(" ")
    };
    let (w, h) = (number(SIZE), number(height));
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" role="img">"#);
    let _ = writeln!(out, "<title>{}</title>\n<style>{WORDS}</style>", escape(title));
    let _ = writeln!(out, r##"<rect width="{w}" height="{h}" rx="16" fill="#fdfcfa"/>"##);
    let _ = writeln!(out, r#"<text class="title" x="30" y="42">{}</text>"#, escape(title));
    for ring in [25.0, 50.0, 75.0, 100.0] {
        let _ = writeln!(out, r##"<polygon points="{}" fill="none" stroke="#e3dfd7" stroke-width="2"/>"##, outline(&|_| ring));
    }
    for (index, name) in axes.iter().enumerate() {
        let [x, y] = place(index, 112.0);
        let _ = writeln!(out, r#"<text class="small middle" x="{}" y="{}">{}</text>"#, number(x), number(y + 7.0), escape(name));
    }
    for (index, (name, values)) in series.iter().enumerate() {
        let stroke = STROKES[index % STROKES.len()];
        let value = |axis: usize| values.get(axis).copied().filter(|value| value.is_finite()).unwrap_or(0.0);
        let points = outline(&value);
        let _ = writeln!(
            out,
            r#"<polygon points="{points}" fill="{stroke}" fill-opacity=".12" stroke="{stroke}" stroke-width="4"/>"#
        );
        let y = number(800.0 + 34.0 * index as f64);
        let _ = writeln!(out, r#"<text class="small" x="60" y="{y}" style="fill:{stroke}">{}</text>"#, escape(name));
    }
    out.push_str("</svg>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_series_has_its_outline() {
        let axes: Vec<String> = ["up", "right", "left"].map(String::from).to_vec();
        let picture = svg("a < b", &axes, &[("one".into(), vec![100.0, 50.0, f64::NAN]), ("two".into(), vec![])]);
        let document = roxmltree::Document::parse(&picture).unwrap();
        assert_eq!(document.descendants().filter(|node| node.has_tag_name("polygon")).count(), 6);
        assert!(!picture.contains("NaN"));
    }
}
