//! Codes of what tasks are made of and changed by: other tasks, parameters, chance, bodies, motions (E043).

codes! {
    OVERRIDES_NOTHING = "E0430" {
        title: "something is overridden or removed that is not there",
        explanation: "A weight alone overrides the weight of a term that the extended task has, and `remove` takes out what it \
            has. Neither may miss: the task would silently stay as it was.",
        example: "reward { 1 a = torso.up.z\n remove b }",
        fix: "reward { 1 a = torso.up.z }",
    }
    UNUSED_PARAMETER = "E0431" {
        title: "a parameter that nothing reads",
        explanation: "Whoever sets a parameter expects the task to change with it.",
        example: "params { pace = 1.3 m/s (0.5..2 m/s) }\nreward { 1 a = exp(-com.speed / 1.3 m/s) }",
        fix: "params { pace = 1.3 m/s (0.5..2 m/s) }\nreward { 1 a = exp(-com.speed / pace) }",
    }
    DRAW = "E0432" {
        title: "something that cannot be drawn",
        explanation: "A random is drawn from `uniform`, `normal` or `choice`, from values that are known before it, and is judged \
            as it is: its condition cannot look at several steps.",
        example: "random side = sometimes(0, 1)\nobserve { side }",
        fix: "random side = choice(0, 1)\nobserve { side }",
    }
    ONCE_PER_SECOND = "E0433" {
        title: "a single event is paid per second",
        explanation: "`reward per second` multiplies by the length of a control step. What holds at one step only would be paid a \
            hundredth of its weight.",
        example: "reward per second { 1 stood_up = once(com.height > 0.9 m) }",
        fix: "reward { 1 stood_up = once(com.height > 0.9 m) }",
    }
    SEQUENCE = "E0434" {
        title: "phases that do not fit together",
        explanation: "A sequence has at least two phases, each a task in sight on the same body, at the same control frequency, \
            each named once; the last one ends the sequence. Phases stand in sequences only.",
        example: "sequence rise { phase sit }",
        fix: "sequence rise { phase sit until t > 1 s; phase stand }",
    }
    BODY_EDIT = "E0435" {
        title: "a change of the body that changes nothing",
        explanation: "`body ... with` changes parameters of muscles and joints that exist, to values that differ from those they \
            have.",
        example: "body human with muscles.peak_force *= 1",
        fix: "body human with muscles.peak_force *= 0.8",
    }
    MOTION = "E0436" {
        title: "a motion that cannot be followed",
        explanation: "A reference motion is a file of comma-separated values; its path is relative to the file that names it. \
            It starts at a phase from 0 to 1, or anywhere with `start uniform`. What is read of it must have a column in its table.",
        example: "reference gait = motion \"missing.csv\" start 0\nobserve { gait.phase }",
        fix: "reference gait = motion \"motions/walk.csv\" start 0\nobserve { gait.phase }",
    }
    MOTION_COLUMN = "E0437" {
        title: "a column of a motion that means nothing",
        explanation: "The first column of a motion is `time [s]` or `phase`. The others are joints, named as the body names them, \
            or `root.x`, `root.y`, `root.height`, `root.heading`, `root.pitch`, `root.roll`, each with its unit in brackets: \
            `deg` or `rad` for what turns, `m` or `cm` for what slides.",
        example: "phase, hip_flexion_r, root.hight [m]",
        fix: "phase, hip_flexion_r [deg], root.height [m]",
    }
    MOTION_CYCLE = "E0438" {
        title: "a cycle that does not close",
        explanation: "The last row of a cycle is the first row of its next turn, so that both say the same. Only the place of the \
            root may go on from turn to turn, and the head says so with `# advances: root.x`.",
        example: "# cycle: yes\nphase, root.x [m]\n0, 0\n0.3, 0.4\n0.6, 0.8\n1, 1.4",
        fix: "# cycle: yes\n# advances: root.x\nphase, root.x [m]\n0, 0\n0.3, 0.4\n0.6, 0.8\n1, 1.4",
    }
    MOTION_TABLE = "E0439" {
        title: "a motion that is no table",
        explanation: "Above the headings stands what the motion is: `# name:`, `# source:`, `# cycle: yes` or `no`, and over phases \
            `# duration:`. Below stands a number for every heading, with times that increase from 0.",
        example: "phase, hip_flexion_r [deg]\n0, 30\n0, 31\n1, 32",
        fix: "phase, hip_flexion_r [deg]\n0, 30\n0.5, 31\n1, 32",
    }
}
