//! Codes of what tasks are made of and changed by: other tasks, parameters, chance, bodies, motions (E043).

codes! {
    OVERRIDES_NOTHING = "E0430" {
        title: "override or removal of an undefined element",
        explanation: "A weight alone overrides the weight of a term of the base task, and `remove` removes an element of \
            it. Both are errors if the element does not exist: the task would silently stay unchanged.",
        example: "reward { 1 a = torso.up.z\n remove b }",
        fix: "reward { 1 a = torso.up.z }",
    }
    UNUSED_PARAMETER = "E0431" {
        title: "unused parameter",
        explanation: "Setting a parameter must change the task.",
        example: "params { pace = 1.3 m/s (0.5..2 m/s) }\nreward { 1 a = exp(-com.speed / 1.3 m/s) }",
        fix: "params { pace = 1.3 m/s (0.5..2 m/s) }\nreward { 1 a = exp(-com.speed / pace) }",
    }
    DRAW = "E0432" {
        title: "invalid random value",
        explanation: "A random is drawn from `uniform`, `normal` or `choice`, with arguments that are known before it. Its \
            `where` condition is evaluated on a single draw and cannot use stateful operators.",
        example: "random side = sometimes(0, 1)\nobserve { side }",
        fix: "random side = choice(0, 1)\nobserve { side }",
    }
    ONCE_PER_SECOND = "E0433" {
        title: "a single event in a reward per second",
        explanation: "`reward per second` multiplies by the length of a control step. A condition that holds at one step \
            only would contribute a hundredth of its weight.",
        example: "reward per second { 1 stood_up = once(com.height > 0.9 m) }",
        fix: "reward { 1 stood_up = once(com.height > 0.9 m) }",
    }
    SEQUENCE = "E0434" {
        title: "invalid phases",
        explanation: "A sequence has at least two phases, each a task in scope on the same body, at the same control \
            frequency, each with a unique name; the last one ends the sequence. `phase` is allowed in sequences only.",
        example: "sequence rise { phase sit }",
        fix: "sequence rise { phase sit until t > 1 s; phase stand }",
    }
    BODY_EDIT = "E0435" {
        title: "a change of the body without effect",
        explanation: "`body ... with` changes parameters of existing muscles and joints to different values.",
        example: "body human with muscles.peak_force *= 1",
        fix: "body human with muscles.peak_force *= 0.8",
    }
    MOTION = "E0436" {
        title: "a motion cannot be used",
        explanation: "A reference motion is a CSV file; its path is relative to the file that names it. It starts at a \
            phase from 0 to 1, or at a random phase with `start uniform`. Every signal that is read must have a column in \
            its table.",
        example: "reference gait = motion \"missing.csv\" start 0\nobserve { gait.phase }",
        fix: "reference gait = motion \"motions/walk.csv\" start 0\nobserve { gait.phase }",
    }
    MOTION_COLUMN = "E0437" {
        title: "unknown column of a motion",
        explanation: "The first column of a motion is `time [s]` or `phase`. The others are joints, with their names in \
            the body, or `root.x`, `root.y`, `root.height`, `root.heading`, `root.pitch`, `root.roll`, each with its unit \
            in brackets: `deg` or `rad` for angles, `m` or `cm` for lengths.",
        example: "phase, hip_flexion_r, root.hight [m]",
        fix: "phase, hip_flexion_r [deg], root.height [m]",
    }
    MOTION_CYCLE = "E0438" {
        title: "a cyclic motion does not close",
        explanation: "The last row of a cyclic motion is the first row of the next cycle, so both must be equal. Only the \
            place of the root may advance from cycle to cycle, which the header declares with `# advances: root.x`.",
        example: "# cycle: yes\nphase, root.x [m]\n0, 0\n0.3, 0.4\n0.6, 0.8\n1, 1.4",
        fix: "# cycle: yes\n# advances: root.x\nphase, root.x [m]\n0, 0\n0.3, 0.4\n0.6, 0.8\n1, 1.4",
    }
    MOTION_TABLE = "E0439" {
        title: "invalid table of a motion",
        explanation: "The header consists of `# name:`, `# source:`, `# cycle: yes` or `no`, and for phases `# duration:`. \
            Below the column names, each row has one number per column, with times that increase from 0.",
        example: "phase, hip_flexion_r [deg]\n0, 30\n0, 31\n1, 32",
        fix: "phase, hip_flexion_r [deg]\n0, 30\n0.5, 31\n1, 32",
    }
}
