//! What can be done about a feature that the simulator does not have.

/// The first word in backquotes of a description, and what to do about it.
const BY_WORD: [(&str, &str); 25] = [
    ("composite", DEFORMABLE),
    ("flexcomp", DEFORMABLE),
    ("flex", DEFORMABLE),
    ("deformable", DEFORMABLE),
    ("skin", DEFORMABLE),
    ("plugin", PLUGIN),
    ("extension", PLUGIN),
    ("attach", COMPOSED),
    ("model", COMPOSED),
    ("scale", COMPOSED),
    ("massscale", COMPOSED),
    ("fluidshape", FLUID),
    ("fusestatic", "set it to false: static bodies then stay apart, which moves the same"),
    ("coordinate", "open and save the file with MuJoCo 2.2 or older, which rewrites it in local coordinates"),
    ("sdf", "replace the signed distance field by a mesh or by primitive shapes"),
    ("integrator", "choose `implicitfast`, which is as stable where bodies do not spin fast, or `RK4`"),
    ("dcmotor", MOTOR),
    ("pid", MOTOR),
    ("orientation", MOTOR),
    ("dyntype", MOTOR),
    ("gaintype", MOTOR),
    ("cranksite", "make the crank and the slider bodies of their own, joined by a `connect`"),
    ("delay", "remove it, or delay the control before it reaches the simulator"),
    ("adhesion", "remove it, or let an `adhesion` actuator hold the body"),
    ("surfacevel", "remove it, or move the surface by a slide joint of its own"),
];

const DEFORMABLE: &str = "only rigid bodies are simulated: replace it by bodies with joints, or remove it";
const PLUGIN: &str = "plugins are programs outside the model: replace it by built-in elements, or remove it";
const MOTOR: &str = "replace it by `position`, `velocity`, `motor` or `muscle`, or another `general` actuator";
const COMPOSED: &str = "load the file with MuJoCo and save it (`mj_saveLastXML`): the saved file has it resolved";
const FLUID: &str = "remove it: bodies then drag like boxes of their inertia wherever `option` has a `density` or `viscosity`";

/// Advice where no other is known.
const GENERAL: &str = "remove it if the motion does not depend on it, or express it by other elements";

/// What to do about an unsupported feature, from its description.
pub(super) fn advice(what: &str) -> &'static str {
    let word = what.split('`').nth(1).unwrap_or_default();
    BY_WORD.iter().find(|(known, _)| *known == word).map_or(GENERAL, |(_, advice)| advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_in_backquotes_decides() {
        assert_eq!(advice("element `flexcomp` in `body`"), DEFORMABLE);
        assert_eq!(advice("attribute `fluidshape` of `geom` with the value `ellipsoid`"), FLUID);
        assert_eq!(advice("attribute `unheard` of `fluidshape`"), GENERAL);
        assert_eq!(advice("something"), GENERAL);
    }
}
