//! Codes of syntax: what the text must look like before it can mean anything (E01).

codes! {
    UNEXPECTED = "E0101" {
        title: "something else was expected here",
        explanation: "The text up to this place can be read; what follows cannot stand here.",
        example: "task stand { control = 100 Hz }",
        fix: "task stand { control 100 Hz }",
    }
}
