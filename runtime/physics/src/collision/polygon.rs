//! Convex polygons cut by planes.

use nalgebra::Vector3;

/// A convex polygon in space, and memory to cut it.
#[derive(Debug, Clone, Default)]
pub(super) struct Polygon {
    /// Corners in order.
    pub corners: Vec<Vector3<f64>>,
    cut: Vec<Vector3<f64>>,
}

impl Polygon {
    /// Keeps what lies on the inner side of a plane, normal · x <= offset. The order of corners is kept, their first one too
    /// as long as it stays inside (Sutherland and Hodgman 1974).
    pub fn clip(&mut self, normal: Vector3<f64>, offset: f64) {
        self.cut.clear();
        let count = self.corners.len();
        for (index, &from) in self.corners.iter().enumerate() {
            let to = self.corners[(index + 1) % count];
            let (height, next) = (normal.dot(&from) - offset, normal.dot(&to) - offset);
            if height <= 0.0 {
                self.cut.push(from);
            }
            if (height <= 0.0) != (next <= 0.0) {
                self.cut.push(from + (to - from) * (height / (height - next)));
            }
        }
        core::mem::swap(&mut self.corners, &mut self.cut);
    }
}

/// Four corners that span nearly the largest area, in order, of a polygon with `count` corners: the fourth, third and second move on in
/// turn as long as the area grows, for each first corner.
pub(super) fn widest_four(count: usize, corner: impl Fn(usize) -> Vector3<f64>) -> [usize; 4] {
    let next = |index: usize| (index + 1) % count;
    let area = |[a, b, c, d]: [usize; 4]| (corner(c) - corner(a)).cross(&(corner(d) - corner(b))).norm_squared();
    let mut best = [0, 1, 2, 3];
    let mut largest = area(best);
    let mut better = |candidate: [usize; 4]| {
        let found = area(candidate);
        let grows = found > largest;
        if grows {
            (best, largest) = (candidate, found);
        }
        grows
    };
    let (mut b, mut c, mut d) = (1, 2, 3);
    for a in 0..count {
        while better([a, b, c, next(d)]) {
            d = next(d);
            while better([a, b, next(c), d]) {
                c = next(c);
                while better([a, next(b), c, d]) {
                    b = next(b);
                }
            }
        }
        // The others stay ahead of the first.
        if b == a {
            b = next(b);
        }
        if c == b {
            c = next(c);
        }
        if d == c {
            d = next(d);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_cut_at_a_corner_has_five() {
        let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec();
        let mut polygon = Polygon { corners, ..Polygon::default() };
        polygon.clip(Vector3::new(1.0, 1.0, 0.0), 1.5);
        assert_eq!(polygon.corners.len(), 5);
        assert!((polygon.corners[0] - Vector3::new(0.5, 1.0, 0.0)).norm() < 1e-15);
        assert!((polygon.corners[4] - Vector3::new(1.0, 0.5, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn of_a_disc_four_corners_far_apart_are_kept() {
        let corner = |k: u32| {
            let (sin, cos) = libm::sincos(f64::from(k) * core::f64::consts::TAU / 16.0);
            Vector3::new(cos, sin, 0.0)
        };
        let four = widest_four(16, |k| corner(k as u32));
        let [a, b, c, d] = four.map(|index| corner(index as u32));
        assert!((c - a).cross(&(d - b)).norm() / 2.0 > 1.9, "{four:?}");
    }
}
