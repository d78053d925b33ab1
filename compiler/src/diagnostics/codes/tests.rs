//! Codes of tests inside files (E044).

codes! {
    EXPECTS_NOTHING = "E0440" {
        title: "a test that expects nothing",
        explanation: "A test without `expect` cannot fail, so it shows nothing. A `cheat` always expects that the task does not \
            succeed and may say more.",
        example: "test \"a fall\" { pose neutral { root.pitch = 90 deg } }",
        fix: "test \"a fall\" { pose neutral { root.pitch = 90 deg }\n expect not success }",
    }
    TEST_ORDER = "E0441" {
        title: "a script that does not run forwards",
        explanation: "The times of `at` increase, `until` and `run` stand behind the last of them, and neither is said twice: a \
            motion has one order, and a test one end.",
        example: "test \"down\" { at 2 s pose squatting\n at 1 s pose neutral\n expect not success }",
        fix: "test \"down\" { at 1 s pose squatting\n at 2 s pose neutral\n expect not success }",
    }
    UNKNOWN_MOMENT = "E0442" {
        title: "a moment that the test does not have",
        explanation: "A moment is named by `at 1 s pose squatting as low`, or is an episode of its own: `moment low { ... }`.",
        example: "test \"low\" { expect pelvis.height at low < 0.5 m }",
        fix: "test \"low\" { moment low { pose squatting }\n expect pelvis.height at low < 1 m }",
    }
    TEST_PLACE = "E0443" {
        title: "a statement that does not belong there",
        explanation: "A test begins with `pose`, objects and `given`; what is behind `at` is motion. Moments hold no expectations and \
            no further moments. What moves in a script has the velocity of its motion, so that `velocity` and `spin` only go with \
            `run`.",
        example: "test \"a push\" { root { velocity [1 m/s, 0, 0] }\n expect not success }",
        fix: "test \"a push\" { at 1 s pose neutral { root.at = [1 m, 0 m] }\n expect not success }",
    }
    NOT_GIVEN = "E0444" {
        title: "something that cannot be given",
        explanation: "`given` decides what chance decides otherwise: it names a `random` of the task and a value of its type.",
        example: "random side = uniform(0.1 m .. 0.5 m)\nobserve { side }\ntest \"left\" { given side = 2 s\n expect not success }",
        fix: "random side = uniform(0.1 m .. 0.5 m)\nobserve { side }\ntest \"left\" { given side = 0.2 m\n expect not success }",
    }
    TEST_LONG = "E0445" {
        title: "a script that is longer than the task",
        explanation: "At its `horizon` an episode is over: what a script shows behind it would never be seen, and an expectation \
            would look at an earlier step than it says.",
        example: "test \"down at last\" { at 60 s pose squatting as low\n expect not success at low }",
        fix: "test \"down at last\" { at 2 s pose squatting as low\n expect not success at low }",
    }
}
