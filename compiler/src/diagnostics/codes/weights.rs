//! Codes of weights files, which lie over compiled tasks (E046).

codes! {
    WEIGHTS_FILE = "E0460" {
        title: "a weights file cannot be parsed",
        explanation: "Weights files are TOML: a table for each task with a line `term = weight` for each weight that \
            differs from the source.",
        example: "[stand]\npose: 11.5",
        fix: "[stand]\npose = 11.5",
    }
    NO_WEIGHT = "E0461" {
        title: "not a weight",
        explanation: "A weight is one finite number in the table of its task.",
        example: "[stand]\npose = \"11.5\"",
        fix: "[stand]\npose = 11.5",
    }
    WEIGHTS_TASK = "E0462" {
        title: "weights of an unknown task",
        explanation: "A table of a weights file has the name of a task of the file that it overrides. A table with another \
            name would silently have no effect.",
        example: "[stnad]\npose = 11.5",
        fix: "[stand]\npose = 11.5",
    }
    WEIGHTS_TERM = "E0463" {
        title: "the weight of an unknown term",
        explanation: "A line of a weights file has the name of a reward term of the task.",
        example: "[stand]\npsoe = 11.5",
        fix: "[stand]\npose = 11.5",
    }
    WEIGHT_REFUSED = "E0464" {
        title: "a weight that the task does not allow",
        explanation: "The range of a weight in the source, `(5..30)`, bounds its value, and `(fixed)` forbids changes. \
            Without a range the sign must not change, and 0 stays 0: a reward cannot become a cost.",
        example: "[stand]\npose = -11.5",
        fix: "[stand]\npose = 11.5",
    }
}
