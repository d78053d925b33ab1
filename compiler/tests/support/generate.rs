//! Programs that are right in most of their parts, grown from bytes: the same for properties and for fuzzing, where the fuzzer
//! chooses the bytes and so learns which choices lead where.
//!
//! Formulas are grown by what they are (a plain number, a length, a condition, ...), so that most of them have a meaning; now
//! and then one of another kind slips in, so that errors are met as well. Calls are grown from the table of functions: of every
//! function, with one value or a list for every parameter.

use msk_compiler::check::functions::signature::{Parameter, Shapes, Takes};
use msk_compiler::check::functions::{Checks, FUNCTIONS, Function, OPERATORS};
use msk_compiler::quantity::dimension::Dimension;

/// Bytes as choices; when they are used up, the first choice is always taken, so that every program ends.
pub struct Choices<'a> {
    bytes: &'a [u8],
    /// Whether what the task declares may be read: its own declarations would go in circles.
    names: bool,
    /// Whether it may be read how the episode ends.
    ends: bool,
}

impl<'a> Choices<'a> {
    /// Chooses by `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, names: false, ends: false }
    }

    /// A number below `count`.
    fn below(&mut self, count: usize) -> usize {
        let Some((first, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        usize::from(*first) % count.max(1)
    }

    fn pick<'t>(&mut self, from: &[&'t str]) -> &'t str {
        from[self.below(from.len())]
    }

    /// Once in `times`; never when there are no bytes left.
    fn rarely(&mut self, times: usize) -> bool {
        self.below(times) == times - 1
    }
}

/// What a formula is.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Plain,
    Length,
    Angle,
    Speed,
    Condition,
    Vector,
    List,
}

const KINDS: [Kind; 7] = [Kind::Plain, Kind::Length, Kind::Angle, Kind::Speed, Kind::Condition, Kind::Vector, Kind::List];

/// A whole task.
pub fn program(bytes: &[u8]) -> String {
    let choices = &mut Choices::new(bytes);
    let mut text = String::from("const reach = 0.4 m\nfn bell(x, width) = exp(-(x / width)^2)\nfn twice(x) = x + x\n\n");
    text += "task generated {\n    body human\n    control 100 Hz\n    horizon 50 steps\n";
    if choices.rarely(4) {
        text += "    params { pace: velocity = 1.3 m/s (0.5..2 m/s) }\n    let paced = com.speed / pace\n";
    }
    text += &scene(choices);
    text += "    init { pose neutral }\n";
    text += &format!("    let lean = {}\n", formula(choices, Kind::Plain, 3));
    text += &format!("    let low = {}\n", formula(choices, Kind::Condition, 3));
    choices.names = true;
    text += &format!("    state seen: int = 0 becomes seen + 1 when {}\n", formula(choices, Kind::Condition, 3));
    text += &format!("    state kept = 0 m becomes {} when low\n        becomes kept / 2\n", formula(choices, Kind::Length, 2));
    text += &format!("    clock phase at {} Hz\n", choices.pick(&["1", "0.5", "3"]));
    choices.ends = true;
    text += "    observe {\n        seen\n        kept\n        phase\n";
    for number in 0..1 + choices.below(4) {
        let value = if choices.rarely(2) {
            any_call(choices, 2)
        } else {
            let kind = KINDS[choices.below(KINDS.len())];
            formula(choices, kind, 4)
        };
        text += &format!("        channel_{number} = {value}\n");
    }
    text += "    }\n    reward {\n";
    for number in 0..1 + choices.below(4) {
        let weight = choices.pick(&["10", "-0.5", "3 (1..5)", "1 (fixed)", "0", "-1e-3"]);
        text += &format!("        {weight} term_{number} = {}\n", formula(choices, Kind::Plain, 5));
    }
    text += "    }\n";
    if choices.rarely(3) {
        text += &format!("    metrics {{ best = running_max({}) }}\n", formula(choices, Kind::Length, 3));
    }
    choices.ends = false;
    let grace = choices.pick(&["", "after 3 steps ", "after 0.02 s "]);
    text += &format!("    terminate {grace}{{ fallen when {} }}\n", formula(choices, Kind::Condition, 4));
    if choices.rarely(3) {
        text += &format!("    finish {{ done when {} }}\n", formula(choices, Kind::Condition, 3));
    }
    choices.ends = true;
    text += &format!("    success {}\n}}\n", formula(choices, Kind::Condition, 3));
    text
}

fn scene(choices: &mut Choices<'_>) -> String {
    match choices.below(4) {
        0 => String::new(),
        1 => "    scene {\n        ground\n        box seat { size [0.4 m, 0.5 m, 4 cm], at [-1 m, 0, 0.45 m] }\n    }\n".into(),
        2 => "    scene {\n        ground\n        sphere ball { radius 11 cm, mass 0.4 kg, free, at [3 m, 0, 1.2 m] }\n        \
              group things = [ball]\n    }\n"
            .into(),
        _ => {
            let count = choices.pick(&["1", "3", "0"]);
            format!(
                "    scene {{\n        ground\n        repeat i in 0..{count} {{ cylinder pole_{{i}} {{ radius 5 cm, length 2 m, at [1 m + i * 1 m, 1 m, 1 m] }} }}\n    }}\n"
            )
        }
    }
}

/// A formula of a kind, or now and then of another: in parentheses then, because `0 <= step == 7 < 1` would be a program that
/// cannot be read, not one with an error of types.
fn formula(choices: &mut Choices<'_>, kind: Kind, depth: usize) -> String {
    if choices.rarely(40) {
        let other = KINDS[choices.below(KINDS.len())];
        return format!("({})", formula_of(choices, other, depth));
    }
    formula_of(choices, kind, depth)
}

fn formula_of(choices: &mut Choices<'_>, kind: Kind, depth: usize) -> String {
    if depth == 0 {
        return leaf(choices, kind);
    }
    let mut deeper = |kind: Kind| formula(choices, kind, depth - 1);
    match kind {
        Kind::Plain => {
            let (a, b) = (deeper(Kind::Plain), deeper(Kind::Plain));
            match choices.below(22) {
                0 => leaf(choices, kind),
                1 => format!("({a} + {b})"),
                2 => format!("({a} - {b})"),
                3 => format!("{a} * {b}"),
                4 => format!("({a}) / ({b})"),
                5 => format!("exp(-abs({a}))"),
                6 => format!("tanh({a})"),
                7 => format!("({a})^2"),
                8 => format!("min({a}, {b})"),
                9 => format!("clip({a}, -1, 1)"),
                10 => format!("{} / 1 m", formula(choices, Kind::Length, depth - 1)),
                11 => format!("{} / 1 m/s", formula(choices, Kind::Speed, depth - 1)),
                12 => format!("cos({})", formula(choices, Kind::Angle, depth - 1)),
                13 => format!("(if {} then {a} else {b})", formula(choices, Kind::Condition, depth - 1)),
                14 => format!("({a} when {})", formula(choices, Kind::Condition, depth - 1)),
                15 => format!("mean({})", formula(choices, Kind::List, depth - 1)),
                16 => format!("{}({a})", choices.pick(&["prev", "highest", "lowest", "initial", "twice"])),
                17 => format!("smooth({a}, {} s)", choices.pick(&["0.1", "2", "0.01"])),
                18 => format!("bell({}, 0.3 m)", formula(choices, Kind::Length, depth - 1)),
                19 => format!("count({})", formula(choices, Kind::Condition, depth - 1)),
                20 if choices.names => format!("[{a}, {b}, 2][mod(seen, 3)]"),
                _ => format!("sum([({a}) * k for k in 0..{}])", choices.pick(&["2", "4", "0"])),
            }
        }
        Kind::Length => {
            let (a, b) = (deeper(Kind::Length), deeper(Kind::Length));
            match choices.below(10) {
                0 => leaf(choices, kind),
                1 => format!("({a} + {b})"),
                2 => format!("max({a}, {b})"),
                3 => format!("{a} * {}", formula(choices, Kind::Plain, depth - 1)),
                4 => format!("norm({})", formula(choices, Kind::Vector, depth - 1)),
                5 => format!("({}).z", formula(choices, Kind::Vector, depth - 1)),
                6 => format!("delay({a}, {} steps)", choices.pick(&["1", "7", "0"])),
                7 => format!("sample_hold({a}, {})", formula(choices, Kind::Condition, depth - 1)),
                8 => format!("integral({})", formula(choices, Kind::Speed, depth - 1)),
                _ => format!("abs({a} - {b})"),
            }
        }
        Kind::Angle => {
            let a = deeper(Kind::Angle);
            match choices.below(6) {
                0 => leaf(choices, kind),
                1 => format!("({a} - {})", leaf(choices, kind)),
                2 => format!("acos({})", formula(choices, Kind::Plain, depth - 1)),
                3 => format!("atan2({}, {})", formula(choices, Kind::Length, depth - 1), leaf(choices, Kind::Length)),
                4 => format!("angle_difference({a}, {})", leaf(choices, kind)),
                _ => format!("-({a})"),
            }
        }
        Kind::Speed => {
            let a = deeper(Kind::Speed);
            match choices.below(5) {
                0 => leaf(choices, kind),
                1 => format!("({a} + {})", leaf(choices, kind)),
                2 => format!("rate({})", formula(choices, Kind::Length, depth - 1)),
                3 => format!("{a} / 2"),
                _ => format!("hypot({a}, {})", leaf(choices, kind)),
            }
        }
        Kind::Condition => {
            let (a, b) = (deeper(Kind::Condition), deeper(Kind::Condition));
            match choices.below(13) {
                0 => leaf(choices, kind),
                1 => format!("({a} and {b})"),
                2 => format!("({a} or {b})"),
                3 => format!("(not {a})"),
                4 => format!("{} < {}", formula(choices, Kind::Length, depth - 1), leaf(choices, Kind::Length)),
                5 => format!("0 <= {} < 1", formula(choices, Kind::Plain, depth - 1)),
                6 => format!("held({a}, {})", choices.pick(&["3 steps", "0.05 s", "0 steps"])),
                7 => format!("{}({a})", choices.pick(&["once", "ever", "always", "rising", "falling"])),
                8 => format!("hysteresis({}, 0.2 m, 0.9 m)", formula(choices, Kind::Length, depth - 1)),
                9 => format!("any({})", "sole_{l,r}.height < 3 cm"),
                10 => format!("since({a}) > 0.1 s"),
                11 => format!("timer({a}) > 0.1 s"),
                _ => format!("between({}, 0..1 m)", formula(choices, Kind::Length, depth - 1)),
            }
        }
        Kind::Vector => {
            let a = deeper(Kind::Vector);
            match choices.below(6) {
                0 => leaf(choices, kind),
                1 => format!("({a} - {})", leaf(choices, kind)),
                2 => format!("({a}) * {}", formula(choices, Kind::Plain, depth - 1)),
                3 => format!("[{}, 0, {}]", leaf(choices, Kind::Length), leaf(choices, Kind::Length)),
                4 => format!("(({a}) in {})", choices.pick(&["pelvis", "heading(torso)", "world"])),
                _ => format!("cross({a}, torso.up)"),
            }
        }
        Kind::List => match choices.below(6) {
            0 => leaf(choices, kind),
            1 => format!("tanh({})", leaf(choices, kind)),
            2 => format!("[{}, {}]", formula(choices, Kind::Plain, depth - 1), formula(choices, Kind::Plain, depth - 1)),
            3 => format!("({} + {})", leaf(choices, kind), leaf(choices, kind)),
            4 => format!("prev({})", leaf(choices, kind)),
            _ => format!("({})^2", leaf(choices, kind)),
        },
    }
}

/// Calls that no signature describes: they take parts of the body, or what a sensor must know beforehand.
const OTHER_CALLS: [&str; 12] = [
    "touching(sole_l, ground)",
    "touching(sole_{l,r}, ground)",
    "contact_force(sole_l, ground)",
    "contact_force(feet, ground)",
    "contact_count(robot, ground)",
    "surface_distance(palm_l, head)",
    "slip(sole_r, ground)",
    "moment_arm(soleus_r, ankle_angle_r)",
    "ground_height(sole_{l,r})",
    "ground_normal(pelvis)",
    "scan(heading(pelvis), [[0.3 m, 0 m], [0.6 m, 0.1 m]])",
    "ray(torso, [1, 0, 0], 3 m)",
];

/// A call of any function of the language, with any shapes.
pub fn any_call(choices: &mut Choices<'_>, depth: usize) -> String {
    let functions: Vec<&Function> = FUNCTIONS.iter().chain(OPERATORS).collect();
    let function = functions[choices.below(functions.len())];
    let Checks::Signatures(signatures) = &function.checks else { return choices.pick(&OTHER_CALLS).to_owned() };
    let signature = &signatures[choices.below(signatures.len())];
    // Arguments that are alike are of one kind; lists of one call are equally long, but for now and then.
    let (kind, length) = (choices.below(QUANTITIES.len()), 1 + choices.below(4));
    let mut arguments = Vec::new();
    for parameter in signature.parameters {
        let length = if choices.rarely(20) { length + 1 } else { length };
        arguments.push(argument(choices, parameter, QUANTITIES[kind], length, depth));
    }
    format!("{}({})", function.name, arguments.join(", "))
}

/// What an argument may be where a parameter takes more than one dimension.
const QUANTITIES: [Kind; 4] = [Kind::Plain, Kind::Length, Kind::Angle, Kind::Speed];

fn argument(choices: &mut Choices<'_>, parameter: &Parameter, alike: Kind, length: usize, depth: usize) -> String {
    match parameter.takes {
        Takes::Duration => return choices.pick(&["3 steps", "0.05 s", "0 steps", "1 steps"]).to_owned(),
        Takes::TimeConstant => return choices.pick(&["0.1 s", "2 s"]).to_owned(),
        _ => {}
    }
    let list = match parameter.shapes {
        Shapes::List => !choices.rarely(20),
        Shapes::One => choices.rarely(20),
        Shapes::Each | Shapes::OneOrList => choices.rarely(2),
    };
    if !list {
        return element(choices, parameter.takes, alike, depth);
    }
    let elements: Vec<String> = (0..length).map(|_| element(choices, parameter.takes, alike, depth)).collect();
    format!("[{}]", elements.join(", "))
}

/// One element of what a parameter takes.
fn element(choices: &mut Choices<'_>, takes: Takes, alike: Kind, depth: usize) -> String {
    let kind = match takes {
        Takes::Quantity(Dimension::ANGLE) | Takes::Angle => Kind::Angle,
        Takes::Quantity(_) => Kind::Plain,
        Takes::Condition => Kind::Condition,
        Takes::Vector | Takes::Vector3 => Kind::Vector,
        Takes::Place => return choices.pick(&["com.position", "head.position", "palm_l", "[1 m, 0, 1 m]"]).to_owned(),
        Takes::Rotation => return choices.pick(&["torso.orientation", "pelvis.orientation"]).to_owned(),
        Takes::Anything if choices.rarely(3) => {
            return choices.pick(&["torso.orientation", "com.position", "3 steps", "low", "sole_l.height > 1 cm"]).to_owned();
        }
        Takes::Counted | Takes::Summed | Takes::Averaged if choices.rarely(4) => Kind::Condition,
        Takes::Summed | Takes::Averaged | Takes::Gradual | Takes::Anything if choices.rarely(4) => Kind::Vector,
        _ => alike,
    };
    formula(choices, kind, depth.min(1))
}

fn leaf(choices: &mut Choices<'_>, kind: Kind) -> String {
    let leaves: &[&str] = match kind {
        Kind::Plain => &[
            "1",
            "0.5",
            "torso.up.z",
            "lean",
            "seen",
            "soleus_r.activation",
            "3e2",
            "-2",
            "0",
            "step",
            "pi",
            "horizon",
            "30 %",
            "mean(muscles.activation)",
            "pelvis.forward.x",
        ],
        Kind::Length => &[
            "0.3 m",
            "com.height",
            "pelvis.height",
            "sole_l.clearance",
            "reach",
            "kept",
            "5 cm",
            "0",
            "distance(palm_l, head)",
            "pelvis.position.x",
            "seat.top",
            "ball.height",
            "pole_0.radius",
        ],
        Kind::Angle => &["knee_angle_r.q", "pelvis.pitch", "0.2 rad", "30 deg", "phase", "torso.yaw", "hip_flexion_l.q", "0"],
        Kind::Speed => &["com.speed", "0.5 m/s", "pelvis.velocity.z", "com.velocity.x", "0", "sole_r.speed"],
        Kind::Condition => &[
            "low",
            "com.height < 0.9 m",
            "true",
            "t > 0.1 s",
            "step == 7",
            "false",
            "terminated",
            "survived",
            "ended",
            "touching(sole_l, ground)",
            "ended by fallen",
            "knee_angle_r.q > 20 deg",
        ],
        Kind::Vector => {
            &["(head.position - pelvis.position)", "[1 m, 0, 2 m]", "com.velocity * 1 s", "(palm_l.position - com.position)"]
        }
        Kind::List => &[
            "sole_{l,r}.height / 1 m",
            "muscles.activation",
            "[1, 2, 3]",
            "independent.q / 1 rad",
            "action",
            "feet.speed / 1 m/s",
        ],
    };
    let own = ["low", "lean", "seen", "kept", "phase"];
    let ends = ["terminated", "survived", "ended", "ended by fallen"];
    let (names, free) = (choices.names, choices.ends);
    let allowed = |leaf: &&str| (names || !own.contains(leaf)) && (free || !ends.contains(leaf));
    let leaves: Vec<&str> = leaves.iter().copied().filter(allowed).collect();
    choices.pick(&leaves).to_owned()
}
