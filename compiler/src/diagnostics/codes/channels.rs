//! Codes of channels that no policy can have, or use (W0579 to W0581).

codes! {
    DROWNED = "W0579" lint drowned Compile {
        title: "noise as large as the signal",
        explanation: "The deviation of a channel's noise, or half its range, is at least half the range of the signal itself, \
            within the limits of the body: the policy sees little but noise. Often the unit is meant differently, degrees or \
            radians, or the noise stands behind a `scale`.",
        example: "observe { pelvis.height\n tilt = torso.up.z noise normal(0, 2) }",
        fix: "observe { pelvis.height\n tilt = torso.up.z noise normal(0, 0.02) }",
    }
    OUTDATED = "W0580" lint outdated Compile {
        title: "a channel from before the episode",
        explanation: "The delay and the history of a channel reach as far back as an episode is long. Values from before the \
            first step repeat the first value, so the policy sees no change of them in any episode.",
        example: "observe { pelvis.height\n tilt = torso.pitch delay 1000 steps }",
        fix: "observe { pelvis.height\n tilt = torso.pitch delay 10 steps }",
    }
    PRIVILEGED = "W0581" lint privileged Compile {
        title: "a policy that sees what no sensor measures",
        explanation: "A channel of the observation reads a draw that decides a mass, a friction, the strength of muscles, or \
            damping or stiffness of a joint. No sensor of a body measures these; a policy that is given them does not learn to find out. Observe what follows \
            from them, and leave the draw to `critic { ... }`.",
        example: "random load = uniform(1 kg .. 5 kg)\n\
            scene { ground\n box pack on torso { size [0.1 m, 0.3 m, 0.3 m], at [-0.2 m, 0, 0], mass load, solid false } }\n\
            observe { pelvis.height\n load }",
        fix: "random load = uniform(1 kg .. 5 kg)\n\
            scene { ground\n box pack on torso { size [0.1 m, 0.3 m, 0.3 m], at [-0.2 m, 0, 0], mass load, solid false } }\n\
            observe { pelvis.height }\ncritic { load }",
    }
}
