//! Codes of types, dimensions and frames (E03).

codes! {
    DIMENSIONS_DIFFER = "E0301" {
        title: "quantities of different dimension meet",
        explanation: "Lengths, times, masses and angles do not mix, and an angle is no plain number. The message lines up what \
            is wanted and what is there, and names the factor that is missing between them.",
        example: "terminate { low when com.height < 0.8 }",
        fix: "terminate { low when com.height < 0.8 m }",
    }
    NOT_PLAIN = "E0302" {
        title: "a term that is not a plain number",
        explanation: "Terms are added up, so each must be one number without unit; otherwise its weight would hide a unit. \
            Divide by the size at which the quantity shall matter.",
        example: "reward { 1 fast = com.speed }",
        fix: "reward { 1 fast = com.speed / 1 m/s }",
    }
    FRAMES_DIFFER = "E0303" {
        title: "vectors counted in different axes meet",
        explanation: "A vector knows the axes in which its components are counted. Components of different axes cannot be \
            compared or added; express one of them in the axes of the other with `in`.",
        example: "reward { 1 ahead = com.velocity.forward / 1 m/s }",
        fix: "reward { 1 ahead = (com.velocity in heading(pelvis)).forward / 1 m/s }",
    }
    WRONG_TYPE = "E0304" {
        title: "another kind of value is wanted here",
        explanation: "A condition where a number is wanted, a part of the body where one of its properties is wanted, or the \
            like. The message says what is wanted and what is there.",
        example: "terminate { low when com.height }",
        fix: "terminate { low when com.height < 0.8 m }",
    }
    LENGTHS_DIFFER = "E0305" {
        title: "lists of different length meet",
        explanation: "Lists are combined element by element, so they must be equally long.",
        example: "reward { 1 a = sum([1, 2, 3, 4] * sole_{l,r}.speed) / 1 m/s }",
        fix: "reward { 1 a = sum([1, 2] * sole_{l,r}.speed) / 1 m/s }",
    }
    ARGUMENTS = "E0306" {
        title: "arguments that the function does not take",
        explanation: "The number and the names of the arguments must be those of the function.",
        example: "reward { 1 a = exp(torso.up.z, 2) }",
        fix: "reward { 1 a = exp(torso.up.z) }",
    }
    MIXED = "E0307" {
        title: "a list that mixes dimensions is reduced to one number",
        explanation: "Hinges are angles and slides are lengths: a norm over both would depend on the choice of units. Such a \
            set may be observed, but not summed.",
        example: "reward { 1 still = exp(-norm(joints.qd)) }",
        fix: "reward { 1 still = exp(-norm(hinges.qd) / 1 rad/s) }",
    }
    POWER = "E0308" {
        title: "a power whose unit is not known",
        explanation: "The unit of a power follows from its exponent, which must therefore be a simple fraction known while \
            compiling, unless the base is a plain number.",
        example: "reward { 1 a = com.height^(com.height / 1 m) }",
        fix: "reward { 1 a = (com.height / 1 m)^2 }",
    }
    NOT_CONSTANT = "E0309" {
        title: "a value that must be known while compiling",
        explanation: "Durations, indices, frequencies and the values of a beginning are fixed when the task is compiled.",
        example: "reward { 1 a = held(com.height > 1 m, t) }",
        fix: "reward { 1 a = held(com.height > 1 m, 0.5 s) }",
    }
    DURATION = "E0310" {
        title: "not a whole number of control steps",
        explanation: "Time passes in control steps; a duration is a whole number of them, written `25 steps` or in seconds.",
        example: "reward { 1 a = held(com.height > 1 m, 0.015 s) }",
        fix: "reward { 1 a = held(com.height > 1 m, 0.02 s) }",
    }
    INDEX = "E0311" {
        title: "an index outside the list",
        explanation: "Elements are counted from 0.",
        example: "reward { 1 a = sole_{l,r}.speed[2] / 1 m/s }",
        fix: "reward { 1 a = sole_{l,r}.speed[1] / 1 m/s }",
    }
    ANNOTATION = "E0312" {
        title: "a value that is not of the type written beside its name",
        explanation: "Types are inferred; one that is written is checked.",
        example: "let tall: time = pelvis.height\nreward { 1 a = tall / 1 s }",
        fix: "let tall: length = pelvis.height\nreward { 1 a = tall / 1 m }",
    }
    PLACES = "E0313" {
        title: "places that are added",
        explanation: "The sum of two places means nothing. Place - place is a vector, place + vector a place, and the mean of \
            places a place.",
        example: "reward { 1 a = norm(head.position + pelvis.position) / 1 m }",
        fix: "reward { 1 a = norm(head.position - pelvis.position) / 1 m }",
    }
}
