//! Codes of probing: what shows once the model is at hand, in poses or in an episode (W053). The runtime tells them.

codes! {
    STARTS_INSIDE = "W0530" lint starts_inside Probe {
        title: "shapes that begin inside each other",
        explanation: "Where the task begins, shapes overlap by more than a millimetre: the first steps would push them apart with a \
            jump. A root `height on ground` puts the lowest point of the body on the ground; an object is put beside, not into, \
            the body. The lint is allowed as `starts_inside`.",
        example: "init { pose neutral\n root { height 0.8 m } }",
        fix: "init { pose neutral\n root { height on ground } }",
    }
    STARTS_APART = "W0531" lint starts_apart Probe {
        title: "what is held together begins apart",
        explanation: "A coupling, connection or weld does not hold where the task begins: the first steps would pull its ends \
            together with a jerk. `here` holds both ends as they begin, and `root { align palm_l to bar.grip }` begins where they meet. \
            The lint is allowed as `starts_apart`.",
        example: "scene { ground\n capsule bar { along [0, 1, 0], length 1.2 m, radius 14 mm, mass 20 kg, free, at [0.5 m, 0, 0.3 m] }\n\
            weld palm_l to bar }",
        fix: "scene { ground\n capsule bar { along [0, 1, 0], length 1.2 m, radius 14 mm, mass 20 kg, free, at [0.5 m, 0, 0.3 m] }\n\
            weld palm_l to bar here }",
    }
    CANNOT_BEGIN = "W0532" lint cannot_begin Probe {
        title: "a task that cannot begin",
        explanation: "With the model at hand the task cannot take its first step: its scene cannot be built around the body, or the \
            physics, a term or a draw meets a fault. The lint is allowed as `cannot_begin`.",
        example: "random target = uniform(0.3 m .. 0.8 m, -0.6 m .. 0.6 m, 1.2 m .. 1.7 m) where distance(target, pelvis) > 10 m\n\
            observe { target }",
        fix: "random target = uniform(0.3 m .. 0.8 m, -0.6 m .. 0.6 m, 1.2 m .. 1.7 m) where distance(target, pelvis) > 0.4 m\n\
            observe { target }",
    }
    UNREACHED = "W0533" lint unreached Probe {
        title: "a condition that no pose decides otherwise",
        explanation: "With the model at hand many poses were looked at, on the ground, in a hop, lying, on and beside the things of the scene, \
            and more were searched for from the one that came nearest: the condition never holds, or never fails, in any of them. Speeds, \
            forces, activations, time, chance and what remembers may be anything, so only what the pose decides is told, with the \
            numbers that were met. The lint is allowed as `unreached`, for a task or on a term.",
        example: "success pelvis.height > 2 m",
        fix: "success pelvis.height > 1 m",
    }
    NEVER_PAID = "W0534" lint never_paid Probe {
        title: "a term that no pose pays",
        explanation: "In all poses that were looked at and searched for the term stays below a thousandth of its highest value, or of 1: a scale \
            is wrong, or a threshold lies where the body cannot be. The lint is allowed as `never_paid`.",
        example: "reward { 10 planted = exp(-10 * mean(ankle_{l,r}.height) / 1 cm) }",
        fix: "reward { 10 planted = exp(-10 * mean(sole_{l,r}.height) / 10 cm) }",
    }
    ALWAYS_PAID = "W0535" lint always_paid Probe {
        title: "a term that is paid whatever is done",
        explanation: "The task begins on the feet, and in all poses with a flat foot on the ground that were looked at and searched for the \
            term pays more than half of its highest value: what it pays for is hardly to be missed. An ankle, for example, is some 6 cm high \
            in a foot that stands. The lint is allowed as `always_paid`.",
        example: "reward { 6 flight = clip(ankle_l.height / 10 cm, 0, 1) }",
        fix: "reward { 6 flight = clip(sole_l.clearance / 10 cm, 0, 1) when not touching(sole_r, ground) }",
    }
    STARTS_ABOVE = "W0536" lint starts_above Probe {
        title: "a body that begins in the air",
        explanation: "The task puts the root higher than the body reaches: nothing is below it and nothing holds it, so an episode begins with \
            a fall. `height on ground` puts the lowest point on the ground. A root with a velocity is meant to fly. The lint is allowed as \
            `starts_above`.",
        example: "init { pose neutral\n root { height 1.1 m } }",
        fix: "init { pose neutral\n root { height on ground } }",
    }
    UNMIRRORED = "W0537" lint unmirrored Probe {
        title: "a symmetric task that pays its sides differently",
        explanation: "The task says that it is `symmetric`, but some states and their mirror images, in which left and right of body and scene \
            are exchanged, are not paid or ended alike. A vector's y that is paid as it is, or the first of several lowest numbers, \
            does that. What chance, time or a motion decides is left out, and so is a scene with two unlike sides. The lint is allowed as \
            `unmirrored`.",
        example: "symmetric\nreward { 1 still = clip(1 - torso.up.y, 0, 1) }",
        fix: "symmetric\nreward { 1 still = clip(1 - abs(torso.up.y), 0, 1) }",
    }
    REST_SUCCEEDS = "W0538" lint rest_succeeds Play {
        title: "a task in which doing nothing succeeds",
        explanation: "An episode was played in which every muscle stays at rest (policy `zero`, seed 0, at most 3000 control steps), and it \
            succeeded: the success asks for nothing that a policy has to learn. Often the failure is missing that a fall should be.",
        example: "horizon 200 steps\nsuccess survived",
        fix: "horizon 200 steps\nterminate { fallen when pelvis.height < 0.6 m }\nsuccess survived",
    }
    REST_PAYS = "W0539" lint rest_pays Play {
        title: "a task that pays doing nothing more than holding the pose",
        explanation: "In an episode in which every muscle stays at rest (policy `zero`) the task paid over 5 % more per step than to `cmc`, \
            which holds the pose of the beginning or follows the reference, over the same number of steps: giving up is what is learnt first. The \
            warning stands at the term that pays rest most.",
        example: "horizon 200 steps\nreward { 1 calm = exp(-50 * mean(muscles.activation)) }\n\
            terminate { fallen when pelvis.height < 0.6 m }",
        fix: "horizon 200 steps\nreward { 1 calm = exp(-50 * mean(muscles.activation))\n 5 alive = not terminated\n -200 failed = terminated }\n\
            terminate { fallen when pelvis.height < 0.6 m }",
    }
}
