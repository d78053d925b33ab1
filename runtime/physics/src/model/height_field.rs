//! Height fields: ground given by heights over a rectangle.

use crate::scalar::Real;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Heights over a rectangle centred at the geom's origin, solid down to a base below it.
///
/// Between samples the surface consists of triangles: each cell is cut along the diagonal from its corner of smaller x and y to
/// that of larger x and y, as MuJoCo cuts it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeightField {
    /// Name.
    pub name: String,
    /// Samples along y.
    pub rows: usize,
    /// Samples along x.
    pub columns: usize,
    /// Half extents along x and y, m.
    pub radius: [f64; 2],
    /// Height that a sample of one stands for, m.
    pub elevation: f64,
    /// Depth of the solid below z = 0, m.
    pub base: f64,
    /// Samples from 0 to 1, row after row from small y, x fastest.
    pub samples: Vec<f64>,
}

impl HeightField {
    /// Place of a sample in the geom's frame, m.
    pub fn point(&self, row: usize, column: usize) -> Vector3<f64> {
        let along = |index: usize, count: usize, radius: f64| radius * (2.0 * index as f64 / (count - 1) as f64 - 1.0);
        let height = self.samples[row * self.columns + column] * self.elevation;
        Vector3::new(along(column, self.columns, self.radius[0]), along(row, self.rows, self.radius[1]), height)
    }

    /// Whether it has a surface, and its numbers are those of one.
    pub(crate) fn is_valid(&self) -> bool {
        let positive = |value: &f64| value.is_finite() && *value > 0.0;
        self.rows >= 2
            && self.columns >= 2
            && self.rows.checked_mul(self.columns) == Some(self.samples.len())
            && [self.radius[0], self.radius[1], self.elevation, self.base].iter().all(positive)
            && self.samples.iter().all(|sample| (0.0..=1.0).contains(sample))
    }

    /// The size of a geom with this shape, as MuJoCo gives it: half extents, the third over a field of half the elevation.
    pub fn size(&self) -> Vector3<f64> {
        Vector3::new(self.radius[0], self.radius[1], 0.25 * self.elevation + 0.5 * self.base)
    }

    /// Radius of a sphere about the origin that holds the shape, m.
    pub fn bounding_radius(&self) -> f64 {
        let [x, y] = self.radius;
        Vector3::new(x, y, self.elevation.at_least(self.base)).norm()
    }
}
