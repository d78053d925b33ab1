//! The action spaces and their settings: one table, from which they are checked, completed and described in the reference.

/// An action space.
pub struct Space {
    /// The word behind `act`.
    pub name: &'static str,
    /// What the entries of an action are.
    pub description: &'static str,
    /// Settings that it must have.
    pub required: &'static [&'static str],
    /// Settings that it may have, beside those of every space.
    pub optional: &'static [&'static str],
}

/// A setting of action spaces.
pub struct Setting {
    /// Its word.
    pub name: &'static str,
    /// How it is written.
    pub form: &'static str,
    /// Its text.
    pub description: &'static str,
}

/// Action spaces.
#[rustfmt::skip]
pub const SPACES: &[Space] = &[
    Space { name: "muscles", description: "the action of each muscle; the space of a task without `act`", required: &[], optional: &["of", "activations", "residual"] },
    Space { name: "synergies", description: "one action for each group of muscles, shared by its muscles", required: &["of"], optional: &["sides", "activations", "residual"] },
    Space { name: "torque", description: "torques on joints, without muscles: for debugging", required: &["joints", "range"], optional: &[] },
    Space { name: "cmc", description: "offsets of the targets that computed muscle control tracks: the motion of a `reference`, or the initial pose; or the pace of a gait", required: &[], optional: &["joints", "range", "com", "root", "reach", "pace", "speed", "along", "start"] },
];

/// Settings of every space.
pub const COMMON: &[&str] = &["scale", "filter", "latency"];

const fn setting(name: &'static str, form: &'static str, description: &'static str) -> Setting {
    Setting { name, form, description }
}

/// Settings.
#[rustfmt::skip]
pub const SETTINGS: &[Setting] = &[
    setting("of", "of [soleus_{l,r}, hamstrings]", "the muscles that are controlled, the others rest; for `synergies`, each element of the list is a group"),
    setting("sides", "sides", "each group is divided into its left and its right muscles"),
    setting("activations", "activations", "entries ask for the activations that muscles have at the end of the control step, in place of excitations"),
    setting("joints", "joints [legs, lumbar]", "independent hinges of the body"),
    setting("range", "range 0.5 rad, range 60 N*m, or range [60 N*m, 40 N*m]", "what an entry of 1 asks of a joint: an offset of its target, or a torque, one for all joints or one for each"),
    setting("com", "com 10 cm", "three entries that shift the target of the centre of mass forward, left and up in the root's heading"),
    setting("root", "root 20 deg", "three entries that turn the target of the root's orientation about its axes forward, left and up"),
    setting("reach", "reach 60 cm", "three entries for each hand: how far it reaches from where it is when the episode begins, forward, left and up in the root's heading"),
    setting("pace", "pace [1 m/s, 20 cm/s, 30 deg/s]", "the body walks, and steps wherever balance needs it: three entries say how fast it goes forward, beyond `speed`, and to the left, and turns to the left"),
    setting("speed", "speed 0.8 m/s", "how fast a gait goes forward, or backward where it is negative, where entries are 0, at first and without a policy"),
    setting("along", "along demonstration", "what has the targets, in place of a `reference` or the initial pose: the script of the first test that plays up to `expect success`; with `pace`, once one more entry, `demonstration`, is above 0.5"),
    setting("start", "start 1.5 s", "the time of the demonstration from which a body that has walked goes on with it"),
    setting("residual", "residual cmc", "the action is added to that of `cmc`, `demonstration` or a network, `residual \"agent.onnx\"`, muscle by muscle"),
    setting("scale", "scale 0.5", "factor of every entry, above 0 and at most 1"),
    setting("filter", "filter 50 ms", "time constant of a low-pass filter of first order"),
    setting("latency", "latency 2 steps", "control steps until an action takes effect"),
];

impl Space {
    /// Every setting that it knows.
    pub fn settings(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.required.iter().chain(self.optional).chain(COMMON).copied()
    }
}

/// The form of a setting.
pub(super) fn form(name: &str) -> &'static str {
    SETTINGS.iter().find(|setting| setting.name == name).map_or("", |setting| setting.form)
}

/// The tables as they stand in the reference.
pub fn markdown() -> String {
    let mut text = String::from("| space | entries of an action | settings |\n|---|---|---|\n");
    for space in SPACES {
        let required = space.required.iter().map(|name| format!("`{name}`"));
        let optional = space.optional.iter().map(|name| format!("[`{name}`]"));
        let settings: Vec<String> = required.chain(optional).collect();
        text += &format!("| `{}` | {} | {} |\n", space.name, space.description, settings.join(" "));
    }
    text += "\n| setting | form | meaning |\n|---|---|---|\n";
    for setting in SETTINGS {
        text += &format!("| `{}` | `{}` | {} |\n", setting.name, setting.form, setting.description);
    }
    text
}
