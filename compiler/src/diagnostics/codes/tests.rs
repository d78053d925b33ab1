//! Codes of tests inside files (E044).

codes! {
    EXPECTS_NOTHING = "E0440" {
        title: "a test without expectation",
        explanation: "A test without `expect` cannot fail. A `cheat` always expects that the task does not succeed and may \
            have further expectations.",
        example: "test \"a fall\" { pose neutral { root.pitch = 90 deg } }",
        fix: "test \"a fall\" { pose neutral { root.pitch = 90 deg }\n expect not success }",
    }
    TEST_ORDER = "E0441" {
        title: "times of a script are not increasing",
        explanation: "The times of `at` increase, `until` and `run` come after the last of them, and each appears at most \
            once.",
        example: "test \"down\" { at 2 s pose squatting\n at 1 s pose neutral\n expect not success }",
        fix: "test \"down\" { at 1 s pose squatting\n at 2 s pose neutral\n expect not success }",
    }
    UNKNOWN_MOMENT = "E0442" {
        title: "undefined moment",
        explanation: "A moment is named by `at 1 s pose squatting as low`, or is a separate episode: `moment low { ... \
            }`.",
        example: "test \"low\" { expect pelvis.height at low < 0.5 m }",
        fix: "test \"low\" { moment low { pose squatting }\n expect pelvis.height at low < 1 m }",
    }
    TEST_PLACE = "E0443" {
        title: "not allowed in a test",
        explanation: "A test begins with `pose`, objects and `given`; `at` adds keyframes. Moments contain neither \
            expectations nor other moments. A cheat does not run the policy that is tested. Velocities of a script follow from its motion, so `velocity` and `spin` are \
            allowed only with `run`.",
        example: "test \"a push\" { root { velocity [1 m/s, 0, 0] }\n expect not success }",
        fix: "test \"a push\" { at 1 s pose neutral { root.at = [1 m, 0 m] }\n expect not success }",
    }
    NOT_GIVEN = "E0444" {
        title: "invalid `given`",
        explanation: "`given` fixes a random of the task: it names the `random` and a value of its type.",
        example: "random side = uniform(0.1 m .. 0.5 m)\nobserve { side }\ntest \"left\" { given side = 2 s\n expect not success }",
        fix: "random side = uniform(0.1 m .. 0.5 m)\nobserve { side }\ntest \"left\" { given side = 0.2 m\n expect not success }",
    }
    TEST_LONG = "E0445" {
        title: "a script is longer than the task",
        explanation: "An episode ends at its `horizon`: later keyframes would never be played, and an expectation would be \
            evaluated at an earlier step.",
        example: "test \"down at last\" { at 60 s pose squatting as low\n expect not success at low }",
        fix: "test \"down at last\" { at 2 s pose squatting as low\n expect not success at low }",
    }
}
