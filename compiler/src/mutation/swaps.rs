//! What is easily taken for what.

/// Words behind which a minus is a sign.
pub(super) const OPENS: [&str; 9] = ["and", "or", "not", "if", "then", "else", "when", "in", "becomes"];

pub(super) const AXES: &[(&str, &str)] = &[
    ("x", "y"),
    ("y", "x"),
    ("z", "x"),
    ("forward", "left"),
    ("left", "forward"),
    ("up", "forward"),
    ("pitch", "roll"),
    ("roll", "pitch"),
    ("yaw", "pitch"),
];

pub(super) const DERIVATIVES: &[(&str, &str)] = &[
    ("q", "qd"),
    ("qd", "q"),
    ("position", "velocity"),
    ("velocity", "position"),
    ("acceleration", "velocity"),
    ("height", "speed"),
    ("speed", "height"),
    ("angular_velocity", "velocity"),
    ("activation", "excitation"),
    ("clearance", "height"),
];

pub(super) const UNITS: &[(&str, &str)] = &[
    ("m", "cm"),
    ("cm", "m"),
    ("mm", "cm"),
    ("rad", "deg"),
    ("deg", "rad"),
    ("s", "ms"),
    ("ms", "s"),
    ("steps", "s"),
    ("Hz", "kHz"),
    ("N", "kN"),
];

pub(super) const LOGIC: &[(&str, &str)] = &[("and", "or"), ("or", "and"), ("not", ""), ("true", "false"), ("false", "true")];

pub(super) const FUNCTIONS: &[(&str, &str)] = &[
    ("min", "max"),
    ("max", "min"),
    ("mean", "sum"),
    ("sum", "mean"),
    ("sin", "cos"),
    ("cos", "sin"),
    ("any", "all"),
    ("all", "any"),
    ("ever", "always"),
    ("always", "ever"),
    ("running_max", "running_min"),
    ("running_min", "running_max"),
    ("initial", "running_max"),
    ("rising", "falling"),
    ("falling", "rising"),
    ("once", "falling"),
    ("exp", "tanh"),
    ("abs", ""),
    ("norm", "max"),
    ("normalize", ""),
    ("count", "timer"),
];
