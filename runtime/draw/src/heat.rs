//! Heat maps: rows of numbers from 0 to 1 over time as colours.

use super::chart::WORDS;
use super::escape;
use super::palette;
use super::path::number;
use core::fmt::Write;

/// Columns at most: more are averaged.
const COLUMNS: usize = 200;
const WIDTH: f64 = 1000.0;
const LEFT: f64 = 290.0;
const RIGHT: f64 = 30.0;
const TOP: f64 = 70.0;
const ROW: f64 = 22.0;

/// Draws rows, each a name and values from 0 to 1 at equal distances, up to `end` on an axis of that name and unit, as SVG.
pub fn svg(title: &str, rows: &[(String, Vec<f64>)], axis: &str, end: f64) -> String {
    let height = TOP + rows.len() as f64 * ROW + 60.0;
    let (w, h) = (number(WIDTH), number(height));
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" role="img" shape-rendering="crispEdges">"#
    );
    let _ = writeln!(out, "<title>{}</title>\n<style>{WORDS}</style>", escape(title));
    let _ = writeln!(out, r##"<rect width="{w}" height="{h}" rx="16" fill="#fdfcfa"/>"##);
    let _ = writeln!(out, r#"<text class="title" x="30" y="42">{}</text>"#, escape(title));
    for (place, (name, values)) in rows.iter().enumerate() {
        let top = TOP + place as f64 * ROW;
        let y = number(top + 16.0);
        let _ = writeln!(out, r#"<text class="small end" x="{}" y="{y}">{}</text>"#, number(LEFT - 12.0), escape(name));
        let columns = values.len().min(COLUMNS);
        let width = (WIDTH - LEFT - RIGHT) / columns.max(1) as f64;
        for column in 0..columns {
            let part = &values[column * values.len() / columns..(column + 1) * values.len() / columns];
            let mean = part.iter().sum::<f64>() / part.len() as f64;
            let (x, y) = (number(LEFT + column as f64 * width), number(top));
            let fill = palette::activation(mean);
            let _ = writeln!(out, r#"<rect x="{x}" y="{y}" width="{}" height="21" fill="{fill}"/>"#, number(width));
        }
    }
    let y = number(height - 22.0);
    let words = format!("0 to {} {axis}", msk_program::numbers::for_people(end));
    let _ = writeln!(out, r#"<text class="small" x="{}" y="{y}">{}</text>"#, number(LEFT), escape(&words));
    out.push_str("</svg>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_a_cell_for_every_value_up_to_its_width() {
        let rows = vec![("few".to_owned(), vec![0.0, 0.5, 1.0]), ("many".to_owned(), vec![0.25; 1000]), ("none".into(), vec![])];
        let picture = svg("a & b", &rows, "s", 2.5);
        let document = roxmltree::Document::parse(&picture).unwrap();
        assert_eq!(document.descendants().filter(|node| node.has_tag_name("rect")).count(), 1 + 3 + 200);
        assert!(picture.contains("0 to 2.5 s"));
    }
}
