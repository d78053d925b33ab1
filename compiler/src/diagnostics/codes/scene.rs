//! Codes of scenes: sizes, masses, what moves, what can be asked of the ground (E042).

codes! {
    SIZE = "E0420" {
        title: "invalid size",
        explanation: "Lengths, radii and masses must be positive, ranges need a lower and an upper end, directions must \
            not be zero vectors. An object without extent has no contacts and no inertia.",
        example: "scene { ground\n sphere cube { radius 0 m, mass 1 kg, free, at [1 m, 0, 1 m] } }",
        fix: "scene { ground\n sphere cube { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }",
    }
    MASS = "E0421" {
        title: "a moving object without mass",
        explanation: "An object that is free or has a joint needs a mass, of its own or of one of its parts: `mass 2 kg`, \
            or `density 500 kg/m^3`. There is no silent default such as the density of water.",
        example: "scene { ground\n sphere cube { radius 0.1 m, free, at [1 m, 0, 1 m] } }",
        fix: "scene { ground\n sphere cube { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }",
    }
    MOTION = "E0422" {
        title: "an object must be fixed, or must be movable",
        explanation: "Ground is fixed, a free object has no parent, a weld needs at least one side that can move, a force \
            needs an object that can move.",
        example: "scene { ground\n box board { size [1 m, 1 m, 2 cm], mass 5 kg, free, walkable, at [0, 0, 0.5 m] } }",
        fix: "scene { ground\n box board { size [1 m, 1 m, 2 cm], walkable, at [0, 0, 0.5 m] } }",
    }
    NO_GROUND = "E0423" {
        title: "the scene has no ground",
        explanation: "A task without `scene` has level ground. A scene declares its ground itself: `ground`, or a \
            `walkable` object. Without either no formula can refer to the ground.",
        example: "scene { box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m] } }",
        fix: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m] } }",
    }
    QUERY = "E0424" {
        title: "an argument that a sensor cannot use",
        explanation: "Ground is measured under a landmark, under a landmark and a constant offset along its heading, or \
            under a constant place. Rays and radars start at a landmark with constant ranges. Other arguments would \
            require a measurement after the formulas are evaluated.",
        example: "reward { 1 high = ground_height(2 * (pelvis.position - head.position)) / 1 m }",
        fix: "reward { 1 high = ground_height(pelvis, [0.3 m, 0, 0]) / 1 m }",
    }
}
