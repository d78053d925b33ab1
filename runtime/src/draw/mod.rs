//! Pictures: a body in a scene at a state, as an SVG that a page can show and a person can read.
//!
//! 1. `camera`: orthographic views from the side and from in front;
//! 2. `silhouette`, `skeleton`, `muscles`: everything becomes flat outlines with a depth;
//! 3. `panel`: one view, painted from far to near;
//! 4. `forces`: arrows of contact forces on top, the centre of mass, and the legend.
//!
//! Apart from these, [`chart`] draws curves over a common axis, and [`motion`] a body through a motion.
//!
//! The same state gives the same bytes. Units in the file are millimetres.

mod camera;
pub mod chart;
mod forces;
pub mod motion;
mod muscles;
mod outline;
mod palette;
mod panel;
mod path;
mod silhouette;
mod skeleton;

pub use camera::View;

use crate::body::sensors::Snapshot;
use camera::Camera;
use core::fmt::Write;
use forces::Arrow;
use nalgebra::Vector2;
use panel::Panel;
use path::{Bounds, number};

/// What to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Views, from left to right.
    pub views: Vec<View>,
    /// Line above the picture; none if empty.
    pub caption: String,
}

/// Room around and between views, mm.
const MARGIN: f64 = 90.0;
/// Height of the line of the caption, mm.
const TITLE: f64 = 40.0;
/// The legend needs this width, mm.
const NARROWEST: f64 = 1250.0;
/// Depth of the strip of ground that is shown, mm.
const GROUND: f64 = 26.0;
/// Height of the strip under the ground for scale, captions and legend, mm.
const FOOTER: f64 = 190.0;

const STYLE: &str = "\
text{font:30px system-ui,-apple-system,'Segoe UI','Helvetica Neue',Arial,sans-serif;fill:#4b4a47}\
.edge{fill:#a89c8b;stroke:#a89c8b;stroke-width:5;stroke-linejoin:round}\
.scenery{fill:#cfd3d6;stroke:#8b9399;stroke-width:3}\
.bone{fill:#fffdf8;stroke:#b3a78f;stroke-width:2}\
.muscle{fill:none;stroke-linecap:round;stroke-linejoin:round;opacity:.9}\
.force{fill:#0f7b5f;stroke:#fff;stroke-width:3;stroke-linejoin:round;paint-order:stroke}\
.force-label{fill:#0b5f4a;font-weight:600}\
.halo{fill:none;stroke:#fff;stroke-width:9;stroke-linejoin:round;stroke-opacity:.85;font-weight:600}\
.ground{fill:#e6e3dd}.horizon{stroke:#8d8878;stroke-width:3}.rule{stroke:#4b4a47;stroke-width:3;fill:none}\
.caption{font-size:34px;font-weight:600}.small{font-size:26px}.middle{text-anchor:middle}.end{text-anchor:end}";

/// Draws the body of `snapshot` with its scene.
pub fn svg(snapshot: &Snapshot<'_>, options: &Options) -> String {
    let mut views: Vec<Drawing> = options.views.iter().map(|&view| Drawing::new(snapshot, view)).collect();
    let top = views.iter().map(|view| view.bounds.low.y).fold(0.0, f64::min) - MARGIN - TITLE;
    let extent = views.iter().map(|view| view.bounds.high.x - view.bounds.low.x + MARGIN).sum::<f64>() + MARGIN;
    let width = extent.max(NARROWEST);
    let depth = views.iter().map(|view| view.bounds.high.y).fold(GROUND, f64::max);
    let height = depth - top + FOOTER;

    let mut out = String::new();
    header(&mut out, options, [width, height]);
    // From here on y = 0 is the ground.
    let _ = writeln!(out, r#"<g transform="translate(0 {})">"#, number(-top));
    let _ = writeln!(out, r#"<path class="ground" d="M0 0h{}v{}H0z"/>"#, number(width), number(GROUND));
    let _ = writeln!(out, r#"<path class="horizon" d="M0 0h{}"/>"#, number(width));
    let mut left = MARGIN + 0.5 * (width - extent);
    for view in &mut views {
        view.write(left, depth, &mut out);
        left += view.bounds.high.x - view.bounds.low.x + MARGIN;
    }
    legend(&mut out, width, depth);
    out.push_str("</g>\n</svg>\n");
    out
}

/// One view with everything in it.
struct Drawing {
    view: View,
    panel: Panel,
    arrows: Vec<Arrow>,
    com: Vector2<f64>,
    bounds: Bounds,
}

impl Drawing {
    fn new(snapshot: &Snapshot<'_>, view: View) -> Self {
        let camera = Camera::new(view);
        let mut panel = Panel::default();
        silhouette::add_scenery(snapshot, &camera, &mut panel);
        silhouette::add(snapshot, &camera, &mut panel);
        skeleton::add(snapshot, &camera, &mut panel);
        muscles::add(snapshot, &camera, &mut panel);
        let arrows = forces::arrows(snapshot, &camera);
        let com = camera.project(snapshot.body.centre_of_mass(snapshot.model, &snapshot.workspace.kinematics));
        let mut bounds = panel.bounds();
        bounds.include(com, 30.0);
        for arrow in &arrows {
            bounds.join(&arrow.bounds());
        }
        Self { view, panel, arrows, com, bounds }
    }

    /// Writes the view with its left edge at `left` and its name `depth` mm under the ground.
    fn write(&mut self, left: f64, depth: f64, out: &mut String) {
        let name = self.view.name();
        let _ = writeln!(out, r#"<g transform="translate({} 0)">"#, number(left - self.bounds.low.x));
        self.panel.write(name, out);
        centre_of_mass(self.com, out);
        self.arrows.iter().for_each(|arrow| arrow.write_shaft(out));
        self.arrows.iter().for_each(|arrow| arrow.write_label(out));
        let middle = number(0.5 * (self.bounds.low.x + self.bounds.high.x));
        let _ = writeln!(out, r#"<text class="middle" x="{middle}" y="{}">{name}</text>"#, number(depth + 42.0));
        out.push_str("</g>\n");
    }
}

/// The engineer's mark of a centre of mass: a quartered disc.
fn centre_of_mass(at: Vector2<f64>, out: &mut String) {
    let [x, y] = [at.x, at.y].map(number);
    let _ = writeln!(
        out,
        r##"<g transform="translate({x} {y})"><circle r="21" fill="#fff" stroke="#2b2a28" stroke-width="4"/><path fill="#2b2a28" d="M0 0V-21A21 21 0 0 1 21 0zM0 0V21A21 21 0 0 1-21 0z"/></g>"##
    );
}

fn header(out: &mut String, options: &Options, [width, height]: [f64; 2]) {
    let (w, h) = (number(width), number(height));
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 {w} {h}" role="img">"#
    );
    let _ = writeln!(out, "<title>{}</title>", escape(&options.caption));
    let _ = writeln!(out, "<style>{STYLE}</style>");
    let stops: String = (0..=8)
        .map(|index| {
            let share = f64::from(index) / 8.0;
            format!(r#"<stop offset="{}%" stop-color="{}"/>"#, number(share * 100.0), palette::activation(share))
        })
        .collect();
    let _ = writeln!(out, r#"<defs><linearGradient id="activation">{stops}</linearGradient></defs>"#);
    let _ = writeln!(out, r##"<rect width="{w}" height="{h}" rx="24" fill="#fdfcfa"/>"##);
    if !options.caption.is_empty() {
        let (x, y, caption) = (number(MARGIN), number(MARGIN - 12.0), escape(&options.caption));
        let _ = writeln!(out, r#"<text class="caption" x="{x}" y="{y}">{caption}</text>"#);
    }
}

/// Scale bar and activation scale in the strip under the ground.
fn legend(out: &mut String, width: f64, depth: f64) {
    const BAR: f64 = 300.0;
    let y = depth + 110.0;
    let left = MARGIN;
    let _ = writeln!(out, r#"<path class="rule" d="M{} {}v16m0-8h500m0-8v16"/>"#, number(left), number(y - 8.0));
    let _ = writeln!(out, r#"<text class="small middle" x="{}" y="{}">0.5 m</text>"#, number(left + 250.0), number(y + 36.0));
    let right = width - MARGIN - BAR;
    let _ = writeln!(
        out,
        r#"<rect x="{}" y="{}" width="{}" height="16" rx="8" fill="url(#activation)"/>"#,
        number(right),
        number(y - 8.0),
        number(BAR)
    );
    for (share, label) in [(0.0, "0"), (0.5, "muscle activation"), (1.0, "1")] {
        let x = number(right + share * BAR);
        let _ = writeln!(out, r#"<text class="small middle" x="{x}" y="{}">{label}</text>"#, number(y + 36.0));
    }
}

/// Text as it may stand in XML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests;
