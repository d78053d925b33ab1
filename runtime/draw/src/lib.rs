//! Pictures: a body in a scene at a state, as an SVG that a page can show and a person can read.
//!
//! 1. `camera`: orthographic views from the side and from in front;
//! 2. `silhouette`, `skeleton`, `muscles`: everything becomes flat outlines with a depth;
//! 3. `panel`: one view, painted from far to near;
//! 4. `forces`: arrows of contact forces on top, the centre of mass, and the legend.
//!
//! Apart from these, [`chart`] draws curves over a common axis, [`bars`], [`heat`], [`radar`] and [`stack`] other charts, and [`motion`] a
//! body through a motion.
//!
//! The same state gives the same bytes. Units in the file are millimetres.

#![allow(clippy::disallowed_methods, reason = "no result is computed from a picture")]

pub mod bars;
mod camera;
pub mod chart;
mod forces;
pub mod heat;
pub mod motion;
mod muscles;
mod outline;
mod palette;
mod panel;
mod path;
pub mod radar;
mod silhouette;
mod skeleton;
pub mod stack;

pub use camera::View;

use camera::Camera;
use core::fmt::Write;
use forces::Arrow;
use msk_physics::model::GeomKind;
use msk_runtime::body::sensors::Snapshot;
use msk_text::in_one_line;
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
    /// Whether muscles, bones and small things of the body are drawn; without them a picture is a tenth as large.
    pub anatomy: bool,
    /// Places that are shown and never touched: names and world positions, m.
    pub markers: Vec<(String, [f64; 3])>,
}

impl Default for Options {
    fn default() -> Self {
        Self { views: vec![View::Side, View::Front], caption: String::new(), anatomy: true, markers: Vec::new() }
    }
}

/// Room around and between views, mm.
const MARGIN: f64 = 90.0;
/// Height of the line of the caption, mm.
const TITLE: f64 = 40.0;
/// The legend needs this width, mm.
const NARROWEST: f64 = 1250.0;
/// Depth of the strip of ground that is shown, mm.
const GROUND: f64 = 26.0;
/// What lies deeper under the middle of the body is cut off, mm.
const DEEPEST: f64 = 2000.0;
/// Height of the strip under the ground for scale, captions and legend, mm.
const FOOTER: f64 = 190.0;

/// Height of a line of text under a view, mm.
const LINE: f64 = 32.0;

const STYLE: &str = "\
text{font:30px system-ui,-apple-system,'Segoe UI','Helvetica Neue',Arial,sans-serif;fill:#4b4a47}\
.edge{fill:#a89c8b;stroke:#a89c8b;stroke-width:5;stroke-linejoin:round}\
.scenery{fill:#cfd3d6;stroke:#8b9399;stroke-width:3}\
.before{fill-opacity:.3;stroke-opacity:.6}\
.bone{fill:#fffdf8;stroke:#b3a78f;stroke-width:2}\
.muscle{fill:none;stroke-linecap:round;stroke-linejoin:round;opacity:.9}\
.force{fill:#0f7b5f;stroke:#fff;stroke-width:3;stroke-linejoin:round;paint-order:stroke}\
.force-label{fill:#0b5f4a;font-weight:600}\
.halo{fill:none;stroke:#fff;stroke-width:9;stroke-linejoin:round;stroke-opacity:.85;font-weight:600}\
.marker{fill:none;stroke:#c2541b;stroke-width:5}.marked{fill:#9a3f10}\
.ground{fill:#e6e3dd}.horizon{stroke:#8d8878;stroke-width:3}.rule{stroke:#4b4a47;stroke-width:3;fill:none}\
.caption{font-size:34px;font-weight:600}.small{font-size:26px}.middle{text-anchor:middle}.end{text-anchor:end}";

/// Draws the body of `snapshot` with its scene.
pub fn svg(snapshot: &Snapshot<'_>, options: &Options) -> String {
    let mut sheet = Sheet::new(options.clone());
    sheet.add(snapshot, options.markers.clone(), &[]);
    sheet.svg()
}

/// Several states beside each other, on one ground and in one scale.
pub struct Sheet {
    options: Options,
    views: Vec<Drawing>,
    level: bool,
}

impl Sheet {
    /// Nothing yet; the markers of the options are not used.
    pub fn new(options: Options) -> Self {
        Self { options, views: Vec::new(), level: false }
    }

    /// Adds all views of a state, with lines of text under the first of them.
    pub fn add(&mut self, snapshot: &Snapshot<'_>, markers: Vec<(String, [f64; 3])>, lines: &[String]) {
        self.level |= has_level_ground(snapshot);
        let options = Options { markers, ..self.options.clone() };
        for (place, &view) in options.views.iter().enumerate() {
            let lines = if place == 0 { lines.to_vec() } else { Vec::new() };
            self.views.push(Drawing { lines, ..Drawing::new(snapshot, view, &options) });
        }
    }

    /// The picture.
    pub fn svg(mut self) -> String {
        let views = &mut self.views;
        let top = views.iter().map(|view| view.bounds.low.y).fold(0.0, f64::min) - MARGIN - TITLE;
        let extent = views.iter().map(|view| view.bounds.high.x - view.bounds.low.x + MARGIN).sum::<f64>() + MARGIN;
        let width = extent.max(NARROWEST);
        let depth = views.iter().map(|view| view.bounds.high.y).fold(GROUND, f64::max);
        let written = LINE * views.iter().map(|view| view.lines.len()).max().unwrap_or(0) as f64;
        let height = depth - top + written + FOOTER;

        let mut out = String::new();
        header(&mut out, &self.options, [width, height]);
        // From here on y = 0 is the ground.
        let _ = writeln!(out, r#"<g transform="translate(0 {})">"#, number(-top));
        if self.level {
            let _ = writeln!(out, r#"<path class="ground" d="M0 0h{}v{}H0z"/>"#, number(width), number(GROUND));
            let _ = writeln!(out, r#"<path class="horizon" d="M0 0h{}"/>"#, number(width));
        }
        let mut left = MARGIN + 0.5 * (width - extent);
        for (place, view) in views.iter_mut().enumerate() {
            // The definitions of the first picture of a view have its name alone.
            let number = place / self.options.views.len().max(1);
            let id = if number == 0 { view.view.name().to_owned() } else { format!("{}{number}-", view.view.name()) };
            view.write(&id, left, depth, &mut out);
            left += view.bounds.high.x - view.bounds.low.x + MARGIN;
        }
        legend(&mut out, width, depth + written, self.options.anatomy);
        out.push_str("</g>\n</svg>\n");
        out
    }
}

/// Whether the level z = 0 is to stand on: a plane of the scene, or what a body without a scene stands on.
fn has_level_ground(snapshot: &Snapshot<'_>) -> bool {
    let plane = |shape: &usize| snapshot.model.geoms.kind[*shape] == GeomKind::Plane;
    snapshot.body.objects.is_empty() || snapshot.body.ground.iter().any(plane)
}

/// One view with everything in it.
struct Drawing {
    view: View,
    panel: Panel,
    arrows: Vec<Arrow>,
    com: Vector2<f64>,
    markers: Vec<(String, Vector2<f64>)>,
    bounds: Bounds,
    /// Text under it.
    lines: Vec<String>,
}

impl Drawing {
    fn new(snapshot: &Snapshot<'_>, view: View, options: &Options) -> Self {
        let camera = Camera::new(view);
        let mut panel = Panel::default();
        silhouette::add_scenery(snapshot, &camera, &mut panel);
        silhouette::add(snapshot, &camera, &mut panel);
        if options.anatomy {
            skeleton::add(snapshot, &camera, &mut panel);
            muscles::add(snapshot, &camera, &mut panel);
        }
        let arrows = forces::arrows(snapshot, &camera);
        let com = camera.project(snapshot.body.centre_of_mass(snapshot.model, &snapshot.workspace.kinematics));
        let project = |(name, place): &(String, [f64; 3])| (name.clone(), camera.project((*place).into()));
        let markers: Vec<(String, Vector2<f64>)> = options.markers.iter().map(project).collect();
        let mut bounds = panel.bounds();
        bounds.include(com, 30.0);
        markers.iter().for_each(|(_, place)| bounds.include(*place, 40.0));
        for arrow in &arrows {
            bounds.join(&arrow.bounds());
        }
        let window = view.window();
        bounds.low.x = bounds.low.x.max(com.x - window[0]);
        bounds.high.x = bounds.high.x.min(com.x + window[1]);
        bounds.high.y = bounds.high.y.min(com.y + DEEPEST);
        Self { view, panel, arrows, com, markers, bounds, lines: Vec::new() }
    }

    /// Writes the view with its left edge at `left` and its name `depth` mm under the ground; `id` tells its definitions apart.
    fn write(&mut self, id: &str, left: f64, depth: f64, out: &mut String) {
        let name = self.view.name();
        let _ = writeln!(out, r#"<g transform="translate({} 0)">"#, number(left - self.bounds.low.x));
        // Scenes may reach far beyond what is shown.
        let Bounds { low, high } = self.bounds;
        let [x, y, width, height] = [low.x, low.y, high.x - low.x, high.y - low.y].map(number);
        let _ = writeln!(out, r#"<clipPath id="{id}"><rect x="{x}" y="{y}" width="{width}" height="{height}"/></clipPath>"#);
        let _ = writeln!(out, r##"<g clip-path="url(#{id})">"##);
        self.panel.write(id, out);
        out.push_str("</g>\n");
        centre_of_mass(self.com, out);
        self.arrows.iter().for_each(|arrow| arrow.write_shaft(out));
        self.arrows.iter().for_each(|arrow| arrow.write_label(out));
        self.markers.iter().for_each(|(name, place)| marker(name, *place, out));
        let middle = number(0.5 * (self.bounds.low.x + self.bounds.high.x));
        let _ = writeln!(out, r#"<text class="middle" x="{middle}" y="{}">{name}</text>"#, number(depth + 42.0));
        for (place, line) in self.lines.iter().enumerate() {
            let y = number(depth + 42.0 + LINE * (place + 1) as f64);
            let _ = writeln!(out, r#"<text class="small middle" x="{middle}" y="{y}">{}</text>"#, escape(line));
        }
        out.push_str("</g>\n");
    }
}

/// A ring with a cross, and its name.
fn marker(name: &str, at: Vector2<f64>, out: &mut String) {
    let [x, y] = [at.x, at.y].map(number);
    let _ = writeln!(out, r#"<path class="marker" d="M{x} {y}m-32 0h64m-32-32v64m-22-32a22 22 0 1 0 44 0a22 22 0 1 0-44 0"/>"#);
    let (x, y) = (number(at.x), number(at.y - 44.0));
    let _ = writeln!(out, r#"<text class="small middle marked" x="{x}" y="{y}">{}</text>"#, escape(name));
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
fn legend(out: &mut String, width: f64, depth: f64, anatomy: bool) {
    const BAR: f64 = 300.0;
    let y = depth + 110.0;
    let left = MARGIN;
    let _ = writeln!(out, r#"<path class="rule" d="M{} {}v16m0-8h500m0-8v16"/>"#, number(left), number(y - 8.0));
    let _ = writeln!(out, r#"<text class="small middle" x="{}" y="{}">0.5 m</text>"#, number(left + 250.0), number(y + 36.0));
    if !anatomy {
        return;
    }
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
    // XML has no control characters, not even as references.
    in_one_line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests;
