//! Words of other languages and of simulators, and how the same is written here.

/// Modules whose functions stand by themselves here.
const MODULES: &[&str] = &["np", "numpy", "math", "torch", "jnp", "jax", "tf", "f32", "f64", "std"];

/// A word that is called as a function elsewhere, and how the same is written.
const FUNCTIONS: &[(&str, &str)] = &[
    ("pow", "a power is written `x^2`"),
    ("power", "a power is written `x^2`"),
    ("square", "a square is written `x^2`"),
    ("sq", "a square is written `x^2`"),
    ("sqr", "a square is written `x^2`"),
    ("cube", "a cube is written `x^3`"),
    ("fabs", "it is `abs(x)`"),
    ("absolute", "it is `abs(x)`"),
    ("magnitude", "the length of a vector is `norm(v)`"),
    ("length", "the length of a vector is `norm(v)`"),
    ("len", "the length of a vector is `norm(v)`; how many elements a list has is known where it is written"),
    ("average", "it is `mean(list)`"),
    ("avg", "it is `mean(list)`"),
    ("median", "there is `mean(list)`, `min(list)` and `max(list)`"),
    ("clamp", "it is `clip(x, low, high)`"),
    ("maximum", "it is `max(x, y)`"),
    ("fmax", "it is `max(x, y)`"),
    ("minimum", "it is `min(x, y)`"),
    ("fmin", "it is `min(x, y)`"),
    ("where", "it is `if condition then a else b`"),
    ("ifelse", "it is `if condition then a else b`"),
    ("cond", "it is `if condition then a else b`"),
    ("arctan2", "it is `atan2(y, x)`"),
    ("arccos", "it is `acos(x)`"),
    ("arcsin", "it is `asin(x)`"),
    ("ln", "the natural logarithm is `log(x)`"),
    ("log10", "it is `log(x) / log(10)`"),
    ("deg2rad", "an angle carries its unit: `40 deg`"),
    ("radians", "an angle carries its unit: `40 deg`"),
    ("rad2deg", "divided by `1 deg` an angle is a plain number of degrees"),
    ("degrees", "divided by `1 deg` an angle is a plain number of degrees"),
    ("array", "a list or a vector is written `[a, b, c]`"),
    ("vec3", "a vector is written `[a, b, c]`"),
    ("vector", "a vector is written `[a, b, c]`"),
    ("range", "a range is written `0..5`, its upper end excluded"),
    ("sigmoid", "it is `1 / (1 + exp(-x))`"),
    ("relu", "it is `max(0, x)`"),
    ("gaussian", "it is `exp(-(x / width)^2)`"),
    ("diff", "how fast x changes is `rate(x)`, the difference of two values `a - b`"),
    ("derivative", "how fast x changes is `rate(x)`"),
    ("velocity", "it is a property: `pelvis.velocity`; how fast any number changes is `rate(x)`"),
    ("contact", "it is `touching(a, b)`"),
    ("in_contact", "it is `touching(a, b)`"),
    ("dist", "it is `distance(a, b)`"),
    ("log1p", "it is `log(1 + x)`"),
];

/// A word that simulators and training code read, and how the same is read here.
const NAMES: &[(&str, &str)] = &[
    ("qpos", "the angle of a joint is `knee_angle_r.q`, the height of the pelvis `pelvis.height`"),
    ("qvel", "the angular velocity of a joint is `knee_angle_r.qd`, the velocity of the pelvis `pelvis.velocity`"),
    ("qacc", "the acceleration of the centre of mass is `com.acceleration`"),
    ("q", "the angle of a joint is `knee_angle_r.q`, of all that move by themselves `independent.q`"),
    ("qd", "the angular velocity of a joint is `knee_angle_r.qd`, of all that move by themselves `independent.qd`"),
    ("xpos", "the place of a part of the body is `pelvis.position`"),
    ("xquat", "which way a part of the body is turned is `pelvis.orientation`"),
    ("ctrl", "the last action is `action`, what muscles are told `muscles.excitation`"),
    ("act", "the last action is `action`, activations are `muscles.activation`"),
    ("actions", "the last action is `action`"),
    ("data", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("env", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("sim", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("physics", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("state", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("obs", "what the policy sees is said in `observe { }`; formulas read the signals themselves"),
    ("self", "signals are read by name: `pelvis.height`, `knee_angle_r.q`, `com.velocity`"),
    ("clock", "a clock is declared with a name of its own, `clock phase at 1.1 Hz`, and read by that name"),
    ("reward", "a formula cannot read the reward; only tests do"),
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
        return Some("functions stand by themselves: `exp(x)`");
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
