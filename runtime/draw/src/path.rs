//! SVG path data: short, rounded to a tenth of a millimetre, the same bytes on every machine.

use core::fmt::Write;
use nalgebra::Vector2;

/// Path data under construction.
#[derive(Debug, Clone, Default)]
pub(super) struct Path {
    data: String,
    /// The pen, in tenths of a millimetre: relative steps are taken between rounded points, so that rounding never adds up.
    pen: [i64; 2],
    bounds: Bounds,
}

/// The smallest upright rectangle around what was drawn, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub low: Vector2<f64>,
    pub high: Vector2<f64>,
}

impl Default for Bounds {
    fn default() -> Self {
        Self { low: Vector2::repeat(f64::INFINITY), high: Vector2::repeat(f64::NEG_INFINITY) }
    }
}

impl Bounds {
    pub fn include(&mut self, point: Vector2<f64>, margin: f64) {
        self.low = self.low.inf(&point.add_scalar(-margin));
        self.high = self.high.sup(&point.add_scalar(margin));
    }

    pub fn join(&mut self, other: &Self) {
        self.low = self.low.inf(&other.low);
        self.high = self.high.sup(&other.high);
    }
}

impl Path {
    pub fn data(&self) -> &str {
        &self.data
    }

    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn move_to(&mut self, point: Vector2<f64>) {
        self.pen = [tenths(point.x), tenths(point.y)];
        self.push('M', self.pen);
        self.bounds.include(point, 0.0);
    }

    fn line_to(&mut self, point: Vector2<f64>) {
        let step = self.step(point);
        if step != [0, 0] {
            self.push('l', step);
        }
        self.bounds.include(point, 0.0);
    }

    /// The rounded step from the pen to `point`, which becomes the pen.
    fn step(&mut self, point: Vector2<f64>) -> [i64; 2] {
        let target = [tenths(point.x), tenths(point.y)];
        let step = [target[0] - self.pen[0], target[1] - self.pen[1]];
        self.pen = target;
        step
    }

    fn push(&mut self, command: char, [x, y]: [i64; 2]) {
        self.data.push(command);
        self.data.push_str(&decimal(x));
        self.pair_with(y);
    }

    /// Appends a number behind another: a minus sign separates as well as a blank.
    fn pair_with(&mut self, value: i64) {
        if value >= 0 {
            self.data.push(' ');
        }
        self.data.push_str(&decimal(value));
    }

    /// An open line through points.
    pub fn polyline(&mut self, points: &[Vector2<f64>]) {
        let Some((&first, rest)) = points.split_first() else { return };
        self.move_to(first);
        for &point in rest {
            self.line_to(point);
        }
    }

    /// A closed figure through points.
    pub fn polygon(&mut self, points: &[Vector2<f64>]) {
        self.polyline(points);
        self.data.push('z');
    }

    /// Two discs joined by a shaft that narrows towards its middle. Of the two radii (mm) the first is that of the discs, the
    /// second that of the handles of the shaft's cubic Bézier edges.
    pub fn dumbbell(&mut self, a: Vector2<f64>, b: Vector2<f64>, [disc, handle]: [f64; 2]) {
        let along = b - a;
        if along.norm() < 3.0 * disc {
            return self.stadium(a, b, disc);
        }
        let side = Vector2::new(along.y, -along.x) / along.norm();
        let near = |end: Vector2<f64>, other: Vector2<f64>, side: Vector2<f64>| end.lerp(&other, 0.35) + side * handle;
        self.move_to(a + side * disc);
        self.curve([near(a, b, side), near(b, a, side), b + side * disc]);
        self.arc([disc, disc], 0.0, b - side * disc);
        self.curve([near(b, a, -side), near(a, b, -side), a - side * disc]);
        self.arc([disc, disc], 0.0, a + side * disc);
        self.data.push('z');
        self.bounds.include(a, disc);
        self.bounds.include(b, disc);
    }

    /// A cubic Bézier curve through two handles to its end.
    fn curve(&mut self, points: [Vector2<f64>; 3]) {
        let origin = self.pen;
        let [first, second, end] = points.map(|point| [tenths(point.x) - origin[0], tenths(point.y) - origin[1]]);
        self.push('c', first);
        for value in [second, end].concat() {
            self.pair_with(value);
        }
        self.pen = [origin[0] + end[0], origin[1] + end[1]];
    }

    /// An ellipse with its half axes (mm) turned by `turn` (rad), clockwise in the picture.
    pub fn ellipse(&mut self, centre: Vector2<f64>, [a, b]: [f64; 2], turn: f64) {
        let (sin, cos) = libm::sincos(turn);
        let arm = Vector2::new(cos, sin) * a;
        self.move_to(centre + arm);
        for end in [centre - arm, centre + arm] {
            self.arc([a, b], turn.to_degrees(), end);
        }
        self.data.push('z');
        let reach = Vector2::new((a * cos).hypot(b * sin), (a * sin).hypot(b * cos));
        self.bounds.include(centre - reach, 0.0);
        self.bounds.include(centre + reach, 0.0);
    }

    /// Everything within `radius` (mm) of the line from `a` to `b`, clockwise in the picture.
    pub fn stadium(&mut self, a: Vector2<f64>, b: Vector2<f64>, radius: f64) {
        let along = b - a;
        if along.norm() < 0.05 {
            return self.ellipse(a, [radius, radius], 0.0);
        }
        let side = Vector2::new(along.y, -along.x) * (radius / along.norm());
        self.move_to(a + side);
        self.line_to(b + side);
        self.arc([radius, radius], 0.0, b - side);
        self.line_to(a - side);
        self.arc([radius, radius], 0.0, a + side);
        self.data.push('z');
        self.bounds.include(a, radius);
        self.bounds.include(b, radius);
    }

    fn arc(&mut self, [a, b]: [f64; 2], turn: f64, end: Vector2<f64>) {
        let step = self.step(end);
        // Writing to a string cannot fail.
        let _ = write!(self.data, "a{} {} {} 0 1 ", decimal(tenths(a)), decimal(tenths(b)), decimal(tenths(turn)));
        self.data.push_str(&decimal(step[0]));
        self.pair_with(step[1]);
    }
}

/// The value in tenths, rounded; far-off and undefined values become a border that no picture reaches.
fn tenths(value: f64) -> i64 {
    const BORDER: f64 = 1e9;
    let value = if value.is_nan() { 0.0 } else { value.clamp(-BORDER, BORDER) };
    (value * 10.0).round() as i64
}

/// Tenths in decimal notation.
fn decimal(tenths: i64) -> String {
    let (sign, size) = (if tenths < 0 { "-" } else { "" }, tenths.unsigned_abs());
    match (size / 10, size % 10) {
        (whole, 0) => format!("{sign}{whole}"),
        (0, part) => format!("{sign}.{part}"),
        (whole, part) => format!("{sign}{whole}.{part}"),
    }
}

/// A number as it stands in attributes: at most one decimal.
pub(super) fn number(value: f64) -> String {
    decimal(tenths(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        assert_eq!([12.34, -0.04, -0.5, 3.0, 0.96].map(number), ["12.3", "0", "-.5", "3", "1"]);
    }

    #[test]
    fn rounding_never_adds_up_along_a_line() {
        let points: Vec<Vector2<f64>> = (0..1000).map(|i| Vector2::new(f64::from(i) * 0.26, 0.0)).collect();
        let mut path = Path::default();
        path.polyline(&points);
        let end: f64 = path.data().split('l').skip(1).map(|step| step.split(' ').next().unwrap().parse::<f64>().unwrap()).sum();
        assert!((end - 999.0 * 0.26).abs() < 0.06, "{end}");
    }

    #[test]
    fn an_ellipse_knows_its_bounds() {
        let mut path = Path::default();
        path.ellipse(Vector2::new(10.0, 20.0), [5.0, 1.0], core::f64::consts::FRAC_PI_2);
        assert!((path.bounds().low - Vector2::new(9.0, 15.0)).norm() < 1e-12);
        assert!((path.bounds().high - Vector2::new(11.0, 25.0)).norm() < 1e-12);
    }
}
