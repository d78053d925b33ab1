//! Line charts: panels one above the other over a common axis, in the colours and letters of the other pictures.

use super::escape;
use super::path::{Path, number};
use core::fmt::Write;
use msk_text::numbers::for_people;
use nalgebra::Vector2;

/// A chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Line above the chart.
    pub title: String,
    /// Name and unit of the common axis.
    pub axis: String,
    /// Where on the common axis the values are, in increasing order.
    pub at: Vec<f64>,
    /// Panels, from top to bottom.
    pub panels: Vec<Panel>,
    /// Stretches of the common axis that are shaded, with a word each.
    pub bands: Vec<Band>,
}

/// Curves with one scale.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Name and unit of the scale.
    pub label: String,
    /// Curves, each with a value for every place of the axis and a name, which may be empty.
    pub curves: Vec<(String, Vec<f64>)>,
}

/// A shaded stretch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Band {
    /// What holds there.
    pub label: String,
    /// From where to where on the common axis.
    pub range: [f64; 2],
}

pub(super) const WIDTH: f64 = 1000.0;
pub(super) const LEFT: f64 = 130.0;
pub(super) const RIGHT: f64 = 40.0;
pub(super) const TOP: f64 = 80.0;
const HEIGHT: f64 = 230.0;
const GAP: f64 = 46.0;
pub(super) const BOTTOM: f64 = 90.0;
/// Strokes of the curves of a panel, one after the other.
pub(super) const STROKES: [&str; 12] = [
    "#b4232f", "#3f6fa8", "#8a8577", "#0f7b5f", "#c2541b", "#6b4f9e", "#1f8fa3", "#a3821f", "#7a1f5c", "#4f8a2c", "#2f3f8f",
    "#5c4a3a",
];

/// Letters of all charts.
pub(super) const WORDS: &str = "\
text{font:22px system-ui,-apple-system,'Segoe UI','Helvetica Neue',Arial,sans-serif;fill:#4b4a47}\
.title{font-size:27px;font-weight:600}.small{font-size:19px}.middle{text-anchor:middle}.end{text-anchor:end}";

pub(super) const STYLE: &str = "\
text{font:22px system-ui,-apple-system,'Segoe UI','Helvetica Neue',Arial,sans-serif;fill:#4b4a47}\
.title{font-size:27px;font-weight:600}.small{font-size:19px}.middle{text-anchor:middle}.end{text-anchor:end}\
.curve{fill:none;stroke-width:3.5;stroke-linejoin:round;stroke-linecap:round}.grid{stroke:#e3dfd7;stroke-width:1.5}\
.zero{stroke:#8d8878;stroke-width:1.5}.frame{fill:none;stroke:#b3a78f;stroke-width:2}.band{fill:#0f7b5f;fill-opacity:.1}";

/// Draws a chart as SVG. Values that are not finite leave gaps.
pub fn svg(chart: &Chart) -> String {
    let count = chart.panels.len() as f64;
    let height = TOP + count * HEIGHT + (count - 1.0).max(0.0) * GAP + BOTTOM;
    let (w, h) = (number(WIDTH), number(height));
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" role="img">"#);
    let _ = writeln!(out, "<title>{}</title>\n<style>{STYLE}</style>", escape(&chart.title));
    let _ = writeln!(out, r##"<rect width="{w}" height="{h}" rx="16" fill="#fdfcfa"/>"##);
    text(&mut out, "title", [LEFT, 42.0], &chart.title);
    let across = Scale::new(chart.at.iter().copied(), [LEFT, WIDTH - RIGHT], false);
    for (index, panel) in chart.panels.iter().enumerate() {
        let top = TOP + index as f64 * (HEIGHT + GAP);
        draw_panel(&mut out, chart, panel, &across, top);
    }
    let foot = height - BOTTOM;
    for (value, label) in across.ticks() {
        text(&mut out, "small middle", [across.place(value), foot + 28.0], &label);
    }
    text(&mut out, "middle", [0.5 * (LEFT + WIDTH - RIGHT), foot + 66.0], &chart.axis);
    out.push_str("</svg>\n");
    out
}

fn draw_panel(out: &mut String, chart: &Chart, panel: &Panel, across: &Scale, top: f64) {
    let values = panel.curves.iter().flat_map(|(_, values)| values).copied();
    let up = Scale::new(values, [top + HEIGHT, top], true);
    for band in &chart.bands {
        let [from, to] = band.range.map(|value| across.place(value));
        let (x, y, width, height) = (number(from), number(top), number(to - from), number(HEIGHT));
        let _ = writeln!(out, r#"<rect class="band" x="{x}" y="{y}" width="{width}" height="{height}"/>"#);
    }
    for (value, label) in up.ticks() {
        let y = up.place(value);
        let class = if value == 0.0 { "zero" } else { "grid" };
        let _ = writeln!(out, r#"<path class="{class}" d="M{} {}H{}"/>"#, number(LEFT), number(y), number(WIDTH - RIGHT));
        text(out, "small end", [LEFT - 10.0, y + 7.0], &label);
    }
    for (value, _) in across.ticks() {
        let x = number(across.place(value));
        let _ = writeln!(out, r#"<path class="grid" d="M{x} {}v{}"/>"#, number(top), number(HEIGHT));
    }
    for (index, (name, values)) in panel.curves.iter().enumerate() {
        let stroke = STROKES[index % STROKES.len()];
        for line in pieces(&chart.at, values) {
            let mut path = Path::default();
            path.polyline(&line.iter().map(|[x, y]| Vector2::new(across.place(*x), up.place(*y))).collect::<Vec<_>>());
            let _ = writeln!(out, r#"<path class="curve" stroke="{stroke}" d="{}"/>"#, path.data());
        }
        if !name.is_empty() {
            let (x, y) = (number(WIDTH - RIGHT - 12.0), number(top + 26.0 + 24.0 * index as f64));
            let _ = writeln!(out, r#"<text class="small end" x="{x}" y="{y}" style="fill:{stroke}">{}</text>"#, escape(name));
        }
    }
    // Words of bands stand over their curves.
    for band in &chart.bands {
        let middle = 0.5 * (across.place(band.range[0]) + across.place(band.range[1]));
        text(out, "small middle", [middle, top + HEIGHT - 12.0], &band.label);
    }
    let (x, y, width, height) = (number(LEFT), number(top), number(WIDTH - RIGHT - LEFT), number(HEIGHT));
    let _ = writeln!(out, r#"<rect class="frame" x="{x}" y="{y}" width="{width}" height="{height}"/>"#);
    text(out, "", [LEFT, top - 10.0], &panel.label);
}

/// The stretches of a curve without gaps.
fn pieces(at: &[f64], values: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let points: Vec<[f64; 2]> = at.iter().zip(values).map(|(x, y)| [*x, *y]).collect();
    points.split(|[_, y]| !y.is_finite()).filter(|piece| !piece.is_empty()).map(<[_]>::to_vec).collect()
}

pub(super) fn text(out: &mut String, class: &str, [x, y]: [f64; 2], words: &str) {
    let _ = writeln!(out, r#"<text class="{class}" x="{}" y="{}">{}</text>"#, number(x), number(y), escape(words));
}

/// Largest value of a scale.
const LARGEST: f64 = 1e300;

/// A linear scale with round ticks.
pub(super) struct Scale {
    values: [f64; 2],
    places: [f64; 2],
    step: f64,
}

impl Scale {
    /// Over all finite values; with `round` ends at ticks, else exactly at the smallest and largest value.
    pub(super) fn new(values: impl Iterator<Item = f64>, places: [f64; 2], round: bool) -> Self {
        // So that no difference, and no end that is rounded, is infinite.
        let finite = values.filter(|value| value.is_finite()).map(|value| value.clamp(-LARGEST, LARGEST));
        let [mut low, mut high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
        if low > high {
            [low, high] = [0.0, 1.0];
        }
        if high - low <= 1e-9 * high.abs().max(low.abs()).max(1e-9) {
            // A constant: show it in the middle.
            let room = 0.05 * high.abs().max(1e-6);
            [low, high] = [low - room, high + room];
        }
        let raw = (high - low) / 5.0;
        let power = libm::pow(10.0, libm::floor(libm::log10(raw)));
        let step = power * [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= raw).unwrap_or(10.0);
        let values = if round { [(low / step).floor() * step, (high / step).ceil() * step] } else { [low, high] };
        Self { values, places, step }
    }

    pub(super) fn place(&self, value: f64) -> f64 {
        let share = (value - self.values[0]) / (self.values[1] - self.values[0]);
        self.places[0] + share * (self.places[1] - self.places[0])
    }

    /// Round values within the scale, and how they are written.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let decimals = (-libm::floor(libm::log10(self.step) + 1e-9)).clamp(0.0, 9.0) as usize;
        let first = (self.values[0] / self.step - 1e-9).ceil() as i64;
        let last = (self.values[1] / self.step + 1e-9).floor() as i64;
        let small = self.values.iter().all(|value| value.abs() < 1e9) && self.step >= 1e-9;
        let label = |value: f64| if small { format!("{value:.decimals$}") } else { for_people(value) };
        (first..=last).map(|index| index as f64 * self.step).map(|value| (value, label(value))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(low: f64, high: f64) -> Scale {
        Scale::new([low, high].into_iter(), [0.0, 100.0], true)
    }

    #[test]
    fn ticks_are_round_and_cover_the_values() {
        let labels = |scale: &Scale| scale.ticks().into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(&scale(-3.2, 41.0)), ["-10", "0", "10", "20", "30", "40", "50"]);
        assert_eq!(labels(&scale(0.011, 0.034)), ["0.010", "0.015", "0.020", "0.025", "0.030", "0.035"]);
        assert_eq!(scale(0.0, 10.0).place(5.0), 50.0);
    }

    #[test]
    fn huge_and_tiny_values_have_short_labels() {
        for [low, high] in [[-1e308, 1e308], [0.0, 1e308], [1e-308, 2e-308], [-3e12, 5e12], [1e300, 1e300]] {
            let scale = scale(low, high);
            let ticks = scale.ticks();
            assert!((2..20).contains(&ticks.len()), "{low} to {high}: {ticks:?}");
            assert!(ticks.iter().all(|(value, label)| label.len() < 12 && scale.place(*value).is_finite()), "{ticks:?}");
        }
    }

    #[test]
    fn a_constant_and_an_empty_curve_have_a_scale() {
        for scale in [scale(2.5, 2.5), scale(0.0, 0.0), scale(f64::NAN, f64::NAN)] {
            assert!(scale.ticks().len() > 1 && scale.place(scale.values[0]).is_finite());
        }
    }

    #[test]
    fn a_chart_is_well_formed_and_names_its_axes() {
        let panel = Panel { label: "length [mm]".into(), curves: vec![("a < b".into(), vec![1.0, f64::NAN, 3.0, 4.0])] };
        let band = Band { label: "wraps".into(), range: [0.0, 1.0] };
        let at = vec![0.0, 1.0, 2.0, 3.0];
        let chart = Chart { title: "T".into(), axis: "knee [deg]".into(), at, panels: vec![panel], bands: vec![band] };
        let picture = svg(&chart);
        let document = roxmltree::Document::parse(&picture).unwrap();
        assert!(picture.contains("knee [deg]") && picture.contains("length [mm]") && picture.contains("a &lt; b"));
        // A value that is not finite splits its curve.
        assert_eq!(document.descendants().filter(|node| node.attribute("class") == Some("curve")).count(), 2);
        assert!(!picture.contains("NaN"));
    }
}
