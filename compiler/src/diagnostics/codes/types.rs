//! Codes of types, dimensions and frames (E03).

codes! {
    DIMENSIONS_DIFFER = "E0301" {
        title: "dimensions do not match",
        explanation: "Lengths, times, masses and angles cannot be mixed, and an angle is not dimensionless. The message \
            shows the expected and the actual dimension, and the missing factor.",
        example: "terminate { low when com.height < 0.8 }",
        fix: "terminate { low when com.height < 0.8 m }",
    }
    NOT_PLAIN = "E0302" {
        title: "a term that is not dimensionless",
        explanation: "Terms are added up, so each must be a single dimensionless number; otherwise its weight would hide a \
            unit. Divide by a characteristic size of the quantity.",
        example: "reward { 1 fast = com.speed }",
        fix: "reward { 1 fast = com.speed / 1 m/s }",
    }
    FRAMES_DIFFER = "E0303" {
        title: "vectors in different frames",
        explanation: "A vector has a frame in which its components are expressed. Components in different frames cannot be \
            compared or added; express one vector in the frame of the other with `in`.",
        example: "reward { 1 ahead = com.velocity.forward / 1 m/s }",
        fix: "reward { 1 ahead = (com.velocity in heading(pelvis)).forward / 1 m/s }",
    }
    WRONG_TYPE = "E0304" {
        title: "wrong kind of value",
        explanation: "For example a condition where a number is expected, or a part of the body where one of its signals \
            is expected. The message shows the expected and the actual kind.",
        example: "terminate { low when com.height }",
        fix: "terminate { low when com.height < 0.8 m }",
    }
    LENGTHS_DIFFER = "E0305" {
        title: "lists have different lengths",
        explanation: "Lists are combined element by element, so they must have equal length.",
        example: "reward { 1 a = sum([1, 2, 3, 4] * sole_{l,r}.speed) / 1 m/s }",
        fix: "reward { 1 a = sum([1, 2] * sole_{l,r}.speed) / 1 m/s }",
    }
    ARGUMENTS = "E0306" {
        title: "wrong arguments",
        explanation: "The number and the names of the arguments must match the function.",
        example: "reward { 1 a = exp(torso.up.z, 2) }",
        fix: "reward { 1 a = exp(torso.up.z) }",
    }
    MIXED = "E0307" {
        title: "a list of mixed dimensions is reduced to one number",
        explanation: "Hinges are angles and slides are lengths: a norm over both would depend on the choice of units. Such \
            a list may be observed, but not summed.",
        example: "reward { 1 still = exp(-norm(joints.qd)) }",
        fix: "reward { 1 still = exp(-norm(hinges.qd) / 1 rad/s) }",
    }
    POWER = "E0308" {
        title: "a power with unknown unit",
        explanation: "The unit of a power depends on its exponent, which must therefore be a constant simple fraction, \
            unless the base is dimensionless.",
        example: "reward { 1 a = com.height^(com.height / 1 m) }",
        fix: "reward { 1 a = (com.height / 1 m)^2 }",
    }
    NOT_CONSTANT = "E0309" {
        title: "not a compile-time constant",
        explanation: "Durations, indices, frequencies and the values of an initial state are compile-time constants.",
        example: "reward { 1 a = held(com.height > 1 m, t) }",
        fix: "reward { 1 a = held(com.height > 1 m, 0.5 s) }",
    }
    DURATION = "E0310" {
        title: "not a whole number of control steps",
        explanation: "Time advances in control steps; a duration is a whole number of them, written `25 steps` or in \
            seconds.",
        example: "reward { 1 a = held(com.height > 1 m, 0.015 s) }",
        fix: "reward { 1 a = held(com.height > 1 m, 0.02 s) }",
    }
    INDEX = "E0311" {
        title: "index out of range",
        explanation: "Elements are counted from 0.",
        example: "reward { 1 a = sole_{l,r}.speed[2] / 1 m/s }",
        fix: "reward { 1 a = sole_{l,r}.speed[1] / 1 m/s }",
    }
    ANNOTATION = "E0312" {
        title: "the value does not have the annotated type",
        explanation: "Types are inferred; an annotation is checked.",
        example: "let tall: time = pelvis.height\nreward { 1 a = tall / 1 s }",
        fix: "let tall: length = pelvis.height\nreward { 1 a = tall / 1 m }",
    }
    PLACES = "E0313" {
        title: "places cannot be added",
        explanation: "The sum of two places has no meaning. Place - place is a vector, place + vector a place, and the \
            mean of places a place.",
        example: "reward { 1 a = norm(head.position + pelvis.position) / 1 m }",
        fix: "reward { 1 a = norm(head.position - pelvis.position) / 1 m }",
    }
}
