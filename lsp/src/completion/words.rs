//! The words with which statements begin, and what they are for.

/// Words with a sentence each.
pub type Table = &'static [(&'static str, &'static str)];

/// At the top of a file.
pub const FILE: Table = &[
    ("use", "use \"PATH\": import another file"),
    ("const", "const NAME = FORMULA: a compile-time constant"),
    ("fn", "fn NAME(a, b) = FORMULA: a pure function"),
    ("observation", "observation NAME { CHANNELS }: a named block of channels"),
    ("task", "task NAME { ... }"),
    ("sequence", "sequence NAME { ... }: tasks one after the other in one episode"),
    ("suite", "suite NAME { ... }: families of tasks and evaluation protocols"),
    ("body", "body NAME { ... }: names for the parts of a model"),
];

/// In a task.
pub const TASK: Table = &[
    ("family", "family NAME"),
    ("body", "body NAME: the body of the task"),
    ("control", "control 100 Hz: the control frequency"),
    ("horizon", "horizon 1000 steps: the maximal length of an episode"),
    ("symmetric", "exchanging left and right must not change the reward"),
    ("params", "params { NAME: TYPE = VALUE (LOW..HIGH) }: constants that a caller may set"),
    ("let", "let NAME = FORMULA"),
    ("state", "state NAME = INITIAL becomes VALUE when CONDITION"),
    ("clock", "clock NAME at FREQUENCY: an angle that advances at a constant rate"),
    ("random", "random NAME = DRAW where CONDITION redraw when CONDITION"),
    ("reference", "reference NAME = motion \"NAME\" start WHERE: a motion to follow"),
    ("scene", "scene { ... }: terrain and objects"),
    ("init", "init { ... }: the initial state"),
    ("observe", "observe { ... }: the observation"),
    ("critic", "critic { ... }: what only a critic sees, beside the observation"),
    ("reward", "reward { WEIGHT NAME = FORMULA }: the reward terms"),
    ("metrics", "metrics { ... }: logged, not part of the reward"),
    ("terminate", "terminate { REASON when CONDITION }: failures"),
    ("finish", "finish { REASON when CONDITION }: terminations that are not failures"),
    ("success", "success CONDITION: evaluated at the last step"),
    ("act", "act SPACE { ... }: what the entries of an action stand for"),
    ("disturb", "disturb PART { force, torque, at, for, every }"),
    ("phase", "phase TASK until CONDITION: of a sequence"),
    ("test", "test \"TITLE\" { ... }"),
    ("cheat", "cheat \"TITLE\" { ... }: an exploit, which must not succeed"),
    ("allow", "allow LINT \"REASON\""),
];

/// In a scene, beside the elements.
pub const SCENE: Table = &[
    ("weld", "weld A to B: constrains position and orientation"),
    ("connect", "connect A to B: constrains the position"),
    ("group", "group NAME = LIST: objects that act as one entity in contacts"),
    ("marker", "marker NAME at PLACE: drawn, without contacts"),
    ("repeat", "repeat NAME in LOW..HIGH { ... }"),
    ("remove", "remove NAME"),
];

/// In `init { }`.
pub const INIT: Table = &[
    ("pose", "pose NAME { JOINT = VALUE }"),
    ("root", "root { height on ground, at [x, y], heading 0 deg, velocity [x, y, z] }"),
    ("noise", "noise joints normal(0, DEVIATION)"),
    ("strength", "strength muscles FACTOR"),
    ("damping", "damping joints FACTOR"),
    ("stiffness", "stiffness JOINT FACTOR"),
    ("mass", "mass robot FACTOR"),
    ("settle", "settle DURATION with activation VALUE at rest"),
];

/// In `root { }` of `init`.
pub const ROOT: Table = &[
    ("height", "height on ground, or a length"),
    ("at", "at [x, y]"),
    ("heading", "rotation about the vertical"),
    ("pitch", "nose down"),
    ("roll", "right side down"),
    ("velocity", "velocity [x, y, z], world frame"),
    ("align", "align PLACE to PLACE: moves the body so that both coincide"),
];

/// Where an object starts.
pub const START: Table =
    &[("at", "where"), ("orientation", "orientation"), ("velocity", "how fast"), ("spin", "angular velocity")];

/// In a suite.
pub const SUITE: Table =
    &[("family", "family NAME { TASKS }"), ("protocol", "protocol NAME { episodes 50, seed 0 }: the first is the default")];

/// In a protocol.
pub const PROTOCOL: Table = &[
    ("episodes", "episodes of each task"),
    ("seed", "seed of the first episode"),
    ("sweep", "sweep { episodes 30, action [0, 0.1, 0.2] }: scales of perturbations"),
];

/// In the sweep of a protocol: the axes of `msk_program::sweep`.
pub const SWEEP: Table = &[
    ("episodes", "episodes of each task at each scale"),
    ("action", "standard deviation of the noise on every entry"),
    ("observation", "standard deviation of the noise on every normalised entry"),
    ("gain", "largest relative change of a muscle's force, drawn per episode"),
    ("push", "force against the root in body weights"),
    ("friction", "largest relative change of the ground's friction, drawn per episode"),
    ("mass", "largest relative change of a segment's mass, drawn per episode"),
    ("latency", "control steps by which actions are late"),
];

/// In a body file.
pub const BODY: Table = &[
    ("model", "model \"PATH\""),
    ("root", "root NAME { forward AXIS, up AXIS }"),
    ("excitation", "excitation linear, or sigmoid"),
    ("tendons", "tendons rigid, or elastic"),
    ("landmark", "landmark NAME { on BODY, at [x, y, z], forward AXIS, up AXIS, segment [GEOMS] }"),
    ("landmarks", "landmarks NAME = LIST"),
    ("joint", "joint NAME = NAME"),
    ("joints", "joints NAME = LIST"),
    ("muscles", "muscles NAME = LIST"),
    ("family", "family NAME \"Title\" = LIST"),
    ("pose", "pose NAME { JOINT = VALUE }"),
];

/// In a disturbance.
pub const DISTURB: Table = &[
    ("force", "force [x, y, z]"),
    ("torque", "torque [x, y, z]"),
    ("at", "from when"),
    ("for", "how long"),
    ("every", "how often"),
];

/// In a test.
pub const TEST: Table = &[
    ("pose", "pose NAME { JOINT = VALUE }"),
    ("at", "at TIME pose NAME"),
    ("repeat", "repeat NAME in LOW..HIGH { ... }: repeats statements"),
    ("play", "play motion \"FILE\" start PHASE for TIME: plays a motion"),
    ("given", "given RANDOM = VALUE: fixes a random value"),
    ("until", "until TIME: the end if the task does not end it earlier"),
    ("moment", "moment NAME { ... }: a separate episode, evaluated at its end"),
    ("run", "run POLICY for DURATION"),
    ("reset", "reset 50 times: the task's initial state"),
    ("expect", "expect CONDITION"),
];

/// Words within formulas.
pub const FORMULA: Table = &[
    ("if", "if CONDITION then VALUE else VALUE"),
    ("not", "not CONDITION"),
    ("true", ""),
    ("false", ""),
    ("ended", "ended by REASON"),
    ("muscle", "muscle \"NAME\": a muscle whose name needs quotes"),
    ("joint", "joint \"NAME\""),
    ("landmark", "landmark \"NAME\""),
];

/// Sets of every body.
pub const SETS: Table = &[
    ("com", "the centre of mass of the body"),
    ("joints", "all joints"),
    ("hinges", "rotational joints"),
    ("slides", "translational joints"),
    ("independent", "hinges that are not coupled to another joint"),
    ("muscles", "all muscles"),
    ("robot", "all shapes of the body"),
    ("ground", "the ground and everything walkable"),
];
