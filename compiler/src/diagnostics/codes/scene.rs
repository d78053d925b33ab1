//! Codes of scenes: sizes, masses, what moves, what can be asked of the ground (E042).

codes! {
    SIZE = "E0420" {
        title: "a size that no thing has",
        explanation: "Lengths, radii and masses are above zero, ranges have a lower and an upper end, directions are no zero \
            vector. A thing without extent can neither be touched nor moved.",
        example: "scene { ground\n sphere cube { radius 0 m, mass 1 kg, free, at [1 m, 0, 1 m] } }",
        fix: "scene { ground\n sphere cube { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }",
    }
    MASS = "E0421" {
        title: "a thing that moves and weighs nothing",
        explanation: "What is free or has a joint needs a mass, of its own or of a part that it carries: `mass 2 kg`, or \
            `density 500 kg/m^3`. There is no silent default, which would make a door weigh whatever water weighs.",
        example: "scene { ground\n sphere cube { radius 0.1 m, free, at [1 m, 0, 1 m] } }",
        fix: "scene { ground\n sphere cube { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }",
    }
    MOTION = "E0422" {
        title: "a thing that moves where it must stand still, or the other way round",
        explanation: "Ground stands still, what is free is carried by nothing, a weld holds something that could move, a \
            force pushes something that can.",
        example: "scene { ground\n box board { size [1 m, 1 m, 2 cm], mass 5 kg, free, walkable, at [0, 0, 0.5 m] } }",
        fix: "scene { ground\n box board { size [1 m, 1 m, 2 cm], walkable, at [0, 0, 0.5 m] } }",
    }
    NO_GROUND = "E0423" {
        title: "a ground that is not there",
        explanation: "A task without `scene` stands on the level ground. A scene says itself what there is: `ground`, or \
            something `walkable`. Without either nothing can stand on, touch or measure the ground.",
        example: "scene { box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m] } }",
        fix: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m] } }",
    }
    QUERY = "E0424" {
        title: "a question that no sensor can answer",
        explanation: "Ground is measured under a landmark, under a landmark and a constant offset along its heading, or under a \
            constant place. Rays and radars look from a landmark with constant ranges. Anything else would have to be measured \
            after formulas are evaluated.",
        example: "reward { 1 high = ground_height(2 * (pelvis.position - head.position)) / 1 m }",
        fix: "reward { 1 high = ground_height(pelvis, [0.3 m, 0, 0]) / 1 m }",
    }
}
