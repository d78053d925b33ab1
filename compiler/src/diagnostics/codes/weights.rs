//! Codes of weights files, which lie over compiled tasks (E046).

codes! {
    WEIGHTS_FILE = "E0460" {
        title: "a weights file that cannot be read",
        explanation: "Weights files are TOML: a table for each task, in it a line `term = weight` for each weight that differs from \
            the source.",
        example: "[stand]\npose: 11.5",
        fix: "[stand]\npose = 11.5",
    }
    NO_WEIGHT = "E0461" {
        title: "something in a weights file that is no weight",
        explanation: "A weight is one finite number below the table of its task.",
        example: "[stand]\npose = \"11.5\"",
        fix: "[stand]\npose = 11.5",
    }
    WEIGHTS_TASK = "E0462" {
        title: "weights of a task that is not there",
        explanation: "A table of a weights file has the name of a task of the file that it is laid over. Another name would \
            silently change nothing.",
        example: "[stnad]\npose = 11.5",
        fix: "[stand]\npose = 11.5",
    }
    WEIGHTS_TERM = "E0463" {
        title: "the weight of a term that is not there",
        explanation: "A line of a weights file has the name of a reward term of the task.",
        example: "[stand]\npsoe = 11.5",
        fix: "[stand]\npose = 11.5",
    }
    WEIGHT_REFUSED = "E0464" {
        title: "a weight that the task does not allow",
        explanation: "The range behind a weight in the source, `(5..30)`, bounds what others may set it to, and `(fixed)` forbids \
            it. Where nothing is said the sign stays, and nothing stays nothing: what is paid does not become a price.",
        example: "[stand]\npose = -11.5",
        fix: "[stand]\npose = 11.5",
    }
}
