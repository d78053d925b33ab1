//! Words of other languages and of simulators, and how the same is written here.

/// Modules whose functions stand by themselves here.
const MODULES: &[&str] = &["np", "numpy", "math", "torch", "jnp", "jax", "tf", "f32", "f64", "std"];

/// What is drawn has a name, by which tests, explanations and formulas know it.
const DRAW: &str = "declare the draw, `random NAME = uniform(low .. high)`, and write its name here";

/// A word that is called as a function elsewhere, and how the same is written.
const FUNCTIONS: &[(&str, &str)] = &[
    ("uniform", DRAW),
    ("normal", DRAW),
    ("choice", DRAW),
    ("pow", "a power is written `x^2`"),
    ("power", "a power is written `x^2`"),
    ("square", "a square is written `x^2`"),
    ("sq", "a square is written `x^2`"),
    ("sqr", "a square is written `x^2`"),
    ("cube", "a cube is written `x^3`"),
    ("fabs", "use `abs(x)`"),
    ("absolute", "use `abs(x)`"),
    ("magnitude", "the length of a vector is `norm(v)`"),
    ("length", "the length of a vector is `norm(v)`"),
    ("len", "the length of a vector is `norm(v)`; the number of elements of a list is known in the source"),
    ("average", "use `mean(list)`"),
    ("avg", "use `mean(list)`"),
    ("median", "use `mean(list)`, `min(list)` or `max(list)`"),
    ("clamp", "use `clip(x, low, high)`"),
    ("maximum", "use `max(x, y)`"),
    ("fmax", "use `max(x, y)`"),
    ("minimum", "use `min(x, y)`"),
    ("fmin", "use `min(x, y)`"),
    ("where", "use `if condition then a else b`"),
    ("ifelse", "use `if condition then a else b`"),
    ("cond", "use `if condition then a else b`"),
    ("arctan2", "use `atan2(y, x)`"),
    ("arccos", "use `acos(x)`"),
    ("arcsin", "use `asin(x)`"),
    ("ln", "the natural logarithm is `log(x)`"),
    ("log10", "use `log(x) / log(10)`"),
    ("deg2rad", "an angle has a unit: `40 deg`"),
    ("radians", "an angle has a unit: `40 deg`"),
    ("rad2deg", "an angle divided by `1 deg` is its number of degrees"),
    ("degrees", "an angle divided by `1 deg` is its number of degrees"),
    ("array", "a list or a vector is written `[a, b, c]`"),
    ("vec3", "a vector is written `[a, b, c]`"),
    ("vector", "a vector is written `[a, b, c]`"),
    ("range", "a range is written `0..5`, its upper end excluded"),
    ("sigmoid", "use `1 / (1 + exp(-x))`"),
    ("relu", "use `max(0, x)`"),
    ("gaussian", "use `exp(-(x / width)^2)`"),
    ("diff", "the rate of x is `rate(x)`, the difference of two values `a - b`"),
    ("derivative", "the rate of x is `rate(x)`"),
    ("velocity", "velocities are properties: `pelvis.velocity`; the rate of any number is `rate(x)`"),
    ("contact", "use `touching(a, b)`"),
    ("in_contact", "use `touching(a, b)`"),
    ("dist", "use `distance(a, b)`"),
    ("log1p", "use `log(1 + x)`"),
];

/// A word that simulators and training code read, and how the same is read here.
const NAMES: &[(&str, &str)] = &[
    ("qpos", "the angle of a joint is `knee_angle_r.q`, the height of the pelvis `pelvis.height`"),
    ("qvel", "the angular velocity of a joint is `knee_angle_r.qd`, the velocity of the pelvis `pelvis.velocity`"),
    ("qacc", "the acceleration of the centre of mass is `com.acceleration`"),
    ("q", "the angle of a joint is `knee_angle_r.q`, of all independent joints `independent.q`"),
    ("qd", "the angular velocity of a joint is `knee_angle_r.qd`, of all independent joints `independent.qd`"),
    ("xpos", "the place of a part of the body is `pelvis.position`"),
    ("xquat", "the orientation of a part of the body is `pelvis.orientation`"),
    ("ctrl", "the last action is `action`, the excitation of the muscles `muscles.excitation`"),
    ("act", "the last action is `action`, activations are `muscles.activation`"),
    ("actions", "the last action is `action`"),
    ("data", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("env", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("sim", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("physics", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("state", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("obs", "declare the observation in `observe { }`; formulas read the signals themselves"),
    ("self", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("clock", "declare a clock with its own name, `clock phase at 1.1 Hz`, and read it by that name"),
    ("reward", "formulas cannot read the reward; only tests can"),
];

/// Whether a word is a module of another language, whose functions need no prefix here.
pub fn is_module(word: &str) -> bool {
    MODULES.contains(&word)
}

/// How that is written here which another language calls by this function; `None` of a word that means nothing.
pub fn function_elsewhere(word: &str) -> Option<&'static str> {
    FUNCTIONS.iter().find(|(known, _)| *known == word).map(|(_, advice)| *advice)
}

/// How that is read here which simulators and training code read by this name.
pub fn name_elsewhere(word: &str) -> Option<&'static str> {
    if is_module(word) {
        return Some("functions are called without prefix: `exp(x)`");
    }
    NAMES.iter().find(|(known, _)| *known == word).map(|(_, advice)| *advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::functions;

    #[test]
    fn no_word_of_ours_is_foreign() {
        for (word, _) in FUNCTIONS {
            assert!(functions::find(word).is_none(), "{word} is a function");
        }
    }
}
