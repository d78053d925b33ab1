//! A motion as a picture: the body at equal times beside each other, and under it the curves of its joints.

use super::camera::{Camera, View};
use super::chart::{self, Chart};
use super::panel::Panel;
use super::path::number;
use super::{STYLE, escape, silhouette};
use core::fmt::Write;
use msk_physics::model::Model;
use msk_physics::{State, Workspace};
use msk_program::motion::{Motion, RootPart, Target};
use msk_program::quantity::dimension::Dimension;
use msk_runtime::body::Body;
use msk_runtime::body::sensors::Snapshot;

/// Width of the whole picture and height of the strip of bodies, as in charts.
const WIDTH: f64 = 1000.0;
const STRIP: f64 = 330.0;
/// Points of each curve.
const POINTS: usize = 101;
/// A joint that moves less stays out of the picture, rad or m.
const LEAST: f64 = 0.02;

/// Draws a motion on a body, which must have its joints, with `count` bodies over its length.
pub fn svg(model: &Model, body: &Body, motion: &Motion, count: usize) -> String {
    let lower = chart::svg(&curves(motion));
    let height = view_height(&lower);
    let mut out = String::new();
    let (w, h) = (number(WIDTH), number(STRIP + height));
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 {w} {h}" role="img">"#
    );
    let _ = writeln!(out, "<title>{}</title>\n<style>{STYLE}</style>", escape(&motion.name));
    let _ = writeln!(out, r##"<rect width="{w}" height="{h}" rx="16" fill="#fdfcfa"/>"##);
    strip(model, body, motion, count.max(2), &mut out);
    let _ = writeln!(
        out,
        r#"<svg x="0" y="{}" width="{w}" height="{}" viewBox="0 0 {w} {}">"#,
        number(STRIP),
        number(height),
        number(height)
    );
    // The chart without its own frame.
    let inner = lower.split_once('\n').map_or("", |(_, rest)| rest);
    out.push_str(inner);
    out.push_str("</svg>\n");
    out
}

/// The height in a picture's view box.
fn view_height(picture: &str) -> f64 {
    let numbers = picture.split("viewBox=\"").nth(1).and_then(|rest| rest.split('"').next());
    numbers.and_then(|numbers| numbers.split(' ').nth(3)).and_then(|height| height.parse().ok()).unwrap_or(0.0)
}

/// Bodies from the right side, each at its own time, in equal distances.
fn strip(model: &Model, body: &Body, motion: &Motion, count: usize, out: &mut String) {
    let (mut state, mut workspace) = (State::new(model), Workspace::new(model));
    let camera = Camera::new(View::Side);
    let mut drawn: Vec<(f64, Panel, f64)> = Vec::new();
    for index in 0..count {
        let share = index as f64 / (count - 1) as f64;
        body.follow(model, motion, motion.time_of(share), &mut state, &mut workspace);
        let mut panel = Panel::default();
        let snapshot = Snapshot { body, model, state: &state, workspace: &workspace };
        silhouette::add(&snapshot, &camera, &mut panel);
        let root = camera.project(workspace.kinematics.body_position[body.root.body]).x;
        drawn.push((share, panel, root));
    }
    let low = drawn.iter().map(|(_, panel, _)| panel.bounds().high.y).fold(0.0, f64::max);
    let high = drawn.iter().map(|(_, panel, _)| panel.bounds().low.y).fold(0.0, f64::min);
    let scale = (STRIP - 70.0) / (low - high).max(1.0);
    let apart = (WIDTH - 120.0) / (count - 1) as f64;
    let ground = STRIP - 45.0 - low * scale;
    for (index, (share, panel, root)) in drawn.iter_mut().enumerate() {
        let x = 60.0 + index as f64 * apart;
        let _ = writeln!(
            out,
            r#"<g transform="translate({} {}) scale({scale:.4}) translate({} 0)">"#,
            number(x),
            number(ground),
            number(-*root)
        );
        panel.write(&format!("body{index}-"), out);
        out.push_str("</g>\n");
        let label = format!("{:.0} %", 100.0 * *share);
        let (x, y) = (number(x), number(STRIP - 12.0));
        let _ = writeln!(out, r#"<text class="middle" style="font-size:19px" x="{x}" y="{y}">{label}</text>"#);
    }
    let _ =
        writeln!(out, r#"<path class="horizon" style="stroke-width:1.5" d="M20 {}H{}"/>"#, number(ground), number(WIDTH - 20.0));
}

/// Joints that move, left and right in one panel, and the root.
fn curves(motion: &Motion) -> Chart {
    let times: Vec<f64> = (0..POINTS).map(|index| index as f64 / (POINTS - 1) as f64 * motion.duration).collect();
    let mut panels: Vec<chart::Panel> = Vec::new();
    let mut seen: Vec<String> = Vec::new();
    for (index, column) in motion.columns.iter().enumerate() {
        let name = column.target.name().into_owned();
        let (stem, side) = match name.rsplit_once('_') {
            Some((stem, side @ ("l" | "r"))) if matches!(column.target, Target::Joint(_)) => (stem.to_owned(), side),
            _ => (name.clone(), ""),
        };
        if seen.contains(&stem) {
            continue;
        }
        let turns = column.dimension == Dimension::ANGLE;
        let (factor, unit) = if turns { (180.0 / core::f64::consts::PI, "deg") } else { (1.0, "m") };
        let values = |column: usize| times.iter().map(|time| factor * motion.value(column, *time)).collect::<Vec<f64>>();
        // Paths that go on are not informative as curves.
        let along = column.advances || column.target == Target::Root(RootPart::X) && motion.cycle;
        let [low, high] = motion.range(index);
        seen.push(stem.clone());
        if along || high - low < LEAST {
            continue;
        }
        let curves = if side.is_empty() {
            vec![(String::new(), values(index))]
        } else {
            let sides = [("right", "r"), ("left", "l")];
            let curve = |(word, side): (&str, &str)| Some((word.to_owned(), values(motion.joint(&format!("{stem}_{side}"))?)));
            sides.into_iter().filter_map(curve).collect()
        };
        panels.push(chart::Panel { label: format!("{} [{unit}]", stem.replace('_', " ")), curves });
    }
    let at = times.iter().map(|time| 100.0 * time / motion.duration).collect();
    let axis =
        if motion.cycle { format!("% of a cycle of {} s", motion.duration) } else { format!("% of {} s", motion.duration) };
    Chart { title: motion.name.clone(), axis, at, panels, bands: Vec::new() }
}
