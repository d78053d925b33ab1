//! One view: everything that is to be painted, far things first.

use super::palette;
use super::path::{Bounds, Path, number};
use core::fmt::Write;

/// Something to paint. Depths are distances from the viewer, m.
#[derive(Debug, Clone)]
pub(super) enum Item {
    /// A limb; `near` is how near it is to the viewer against the rest of the body, 0..1.
    Silhouette {
        depth: f64,
        path: Path,
        near: f64,
    },
    /// A thing of the scene; one before the body lets the body shine through.
    Scenery {
        depth: f64,
        path: Path,
        before: bool,
    },
    Bone {
        depth: f64,
        path: Path,
    },
    /// Lines on top of each other with their widths (mm), the longest and thinnest first.
    Muscle {
        depth: f64,
        spindle: [(Path, f64); 3],
        activation: f64,
    },
}

impl Item {
    fn depth(&self) -> f64 {
        match self {
            Self::Silhouette { depth, .. }
            | Self::Scenery { depth, .. }
            | Self::Bone { depth, .. }
            | Self::Muscle { depth, .. } => *depth,
        }
    }

    fn path(&self) -> &Path {
        match self {
            Self::Silhouette { path, .. } | Self::Scenery { path, .. } | Self::Bone { path, .. } => path,
            Self::Muscle { spindle: [(path, _), ..], .. } => path,
        }
    }
}

/// The items of one view.
#[derive(Debug, Clone, Default)]
pub(super) struct Panel {
    items: Vec<Item>,
    bounds: Bounds,
}

impl Panel {
    /// Adds an item; empty ones are left out.
    pub fn add(&mut self, item: Item) {
        if !item.path().data().is_empty() {
            self.bounds.join(item.path().bounds());
            self.items.push(item);
        }
    }

    /// The rectangle around all items, mm.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Writes the items, the farthest first; things at one depth stay in the order in which they came. `name` tells the
    /// definitions of several panels apart.
    pub fn write(&mut self, name: &str, out: &mut String) {
        self.items.sort_by(|a, b| b.depth().total_cmp(&a.depth()));
        for (index, item) in self.items.iter().enumerate() {
            let data = item.path().data();
            // Writing to a string cannot fail.
            let _ = match item {
                Item::Silhouette { near, .. } => {
                    // Stroked first and filled over it, a figure of several outlines shows only its outer edge.
                    let skin = palette::skin(*near);
                    writeln!(
                        out,
                        r##"<g class="edge"><path id="{name}{index}" d="{data}"/></g><use xlink:href="#{name}{index}" fill="{skin}"/>"##
                    )
                }
                Item::Scenery { before, .. } => {
                    let class = if *before { "scenery before" } else { "scenery" };
                    writeln!(out, r#"<path class="{class}" d="{data}"/>"#)
                }
                Item::Bone { .. } => writeln!(out, r#"<path class="bone" d="{data}"/>"#),
                Item::Muscle { spindle, activation, .. } => {
                    let _ = write!(out, r#"<g class="muscle" stroke="{}">"#, palette::activation(*activation));
                    for (path, width) in spindle {
                        let _ = write!(out, r#"<path stroke-width="{}" d="{}"/>"#, number(*width), path.data());
                    }
                    writeln!(out, "</g>")
                }
            };
        }
    }
}
