//! Codes of syntax: what the text must look like before it can mean anything (E01).

codes! {
    UNEXPECTED = "E0101" {
        title: "expected something else here",
        explanation: "The statement is valid up to this position. The parser skips the rest of the statement and continues \
            with the rest of the file.",
        example: "task t { reward { 10 pose exp(-com.speed) } }",
        fix: "task t { reward { 10 pose = exp(-com.speed) } }",
    }
    UNCLOSED_BRACKET = "E0102" {
        title: "a bracket is never closed",
        explanation: "Round and square brackets must be closed within their block; a block ends where the indentation \
            decreases.",
        example: "task t { success held(com.height > 1 m, 25 steps }",
        fix: "task t { success held(com.height > 1 m, 25 steps) }",
    }
    UNOPENED_BRACKET = "E0103" {
        title: "a closing bracket without an opening bracket",
        explanation: "There is no matching opening bracket of this kind.",
        example: "task t { success com.height > 1 m) }",
        fix: "task t { success com.height > 1 m }",
    }
    UNCLOSED_TEXT = "E0104" {
        title: "a string is never closed",
        explanation: "A string ends on its own line.",
        example: "use \"lib/posture.msk",
        fix: "use \"lib/posture.msk\"",
    }
    FOREIGN_SIGN = "E0105" {
        title: "this character is spelled differently here",
        explanation: "Typographic characters and operators of other languages have one spelling in .msk files: `-` instead \
            of a dash, `and` instead of `&&`, `//` instead of `#`.",
        example: "task t { success com.height ≥ 1 m }",
        fix: "task t { success com.height >= 1 m }",
    }
    BEGINS_WITH_OPERATOR = "E0106" {
        title: "a line cannot begin with an operator",
        explanation: "A statement ends at the end of its line, so that a negative weight on the next line is never parsed \
            as a subtraction. A statement continues if a bracket is open or if the line ends in an operator.",
        example: "task t { let effort = mean(muscles.activation)\n        + 1 }",
        fix: "task t { let effort = mean(muscles.activation) +\n        1 }",
    }
    GLUED_NUMBER = "E0107" {
        title: "missing space between a number and a word",
        explanation: "A space separates a number from its unit. A factor in front of a name is written with `*`.",
        example: "task t { success com.height > 0.9m }",
        fix: "task t { success com.height > 0.9 m }",
    }
    BARE_UNIT = "E0108" {
        title: "a unit without a number",
        explanation: "A unit expression belongs to the number before it and contains no spaces: `10 s/m`, `30 m^-2`. Units \
            are reserved words and cannot be names.",
        example: "task t { let sharpness = 30 / m^2 }",
        fix: "task t { let sharpness = 30 m^-2 }",
    }
    UNKNOWN_UNIT = "E0109" {
        title: "unknown unit",
        explanation: "A word after a number must be a known unit; `msk vocabulary` and the reference list all units.",
        example: "task t { success com.height > 0.9 metres }",
        fix: "task t { success com.height > 0.9 m }",
    }
    NAME_SPELLING = "E0110" {
        title: "names are lower case",
        explanation: "A name consists of lower-case letters, digits and underscores, and does not end in an underscore. \
            Any other name of a model element is quoted: `muscle \"DELT2_r\"`.",
        example: "task Stand { control 100 Hz }",
        fix: "task stand { control 100 Hz }",
    }
    MIXED_FRAME = "E0111" {
        title: "arithmetic beside `in` needs brackets",
        explanation: "`in` expresses a vector in another frame. `a + b in pelvis` is ambiguous: it could convert the sum \
            or only `b`.",
        example: "task t { let v = com.velocity + wind in pelvis }",
        fix: "task t { let v = (com.velocity + wind) in pelvis }",
    }
    NOT_A_FRAME = "E0112" {
        title: "not a valid frame",
        explanation: "The right side of `in` is a name or `heading(NAME)`. To read a component of the result, put the \
            whole expression in brackets.",
        example: "task t { let forward = com.velocity in pelvis.forward }",
        fix: "task t { let forward = (com.velocity in pelvis).forward }",
    }
    MIXED_COMPARISON = "E0113" {
        title: "chained comparisons must have one direction",
        explanation: "`0 < x < 1` and `1 >= x > 0` mean that x lies between; `a < b > c` and `a == b == c` are easily \
            misread and must be written with `and`.",
        example: "task t { success 0 m < com.height > 1 m }",
        fix: "task t { success 0 m < com.height and com.height > 1 m }",
    }
    CHAINED_POWER = "E0114" {
        title: "nested powers need brackets",
        explanation: "`a^b^c` is ambiguous: `a^(b^c)` or `(a^b)^c`.",
        example: "task t { let x = 2^3^2 }",
        fix: "task t { let x = 2^(3^2) }",
    }
    UNKNOWN_STATEMENT = "E0115" {
        title: "no statement begins with this word here",
        explanation: "Every statement begins with a keyword; the block determines which keywords are allowed.",
        example: "task t { rewrad { 1 alive = 1 } }",
        fix: "task t { reward { 1 alive = 1 } }",
    }
    RESERVED_WORD = "E0116" {
        title: "this word is reserved",
        explanation: "Units and the keywords of formulas (`and or not if then else in for when where becomes redraw until \
            by true false let const fn task`) cannot be names.",
        example: "task t { let m = 3 kg }",
        fix: "task t { let mass = 3 kg }",
    }
    SPACED_CALL = "E0117" {
        title: "space between a function and its bracket",
        explanation: "No space separates a name from the bracket of its call or index. So `speed = 1 m/s (0.5..2 m/s)` is \
            a value with a range, and a missing comma before a list is not parsed as an index.",
        example: "task t { let x = norm (com.velocity) }",
        fix: "task t { let x = norm(com.velocity) }",
    }
    SINGLE_EQUALS = "E0118" {
        title: "`=` assigns, `==` compares",
        explanation: "A formula compares with `==` (whole numbers and conditions only; quantities are compared with `<` \
            and `>`).",
        example: "task t { success step = 10 }",
        fix: "task t { success step == 10 }",
    }
    BARE_WHEN = "E0119" {
        title: "`when` needs brackets here",
        explanation: "After `if ... then ... else ...`, inside `becomes`, and after another `when`, the scope of the \
            condition would be ambiguous.",
        example: "task t { let x = if a then 1 else 2 when b }",
        fix: "task t { let x = (if a then 1 else 2) when b }",
    }
    MISPLACED_NOT = "E0120" {
        title: "`not` must be at the start of a condition",
        explanation: "`not` begins a condition or follows `and` or `or`. Elsewhere the negated condition needs brackets.",
        example: "task t { let x = 1 + not fallen }",
        fix: "task t { let x = 1 + (not fallen) }",
    }
    TOO_DEEP = "E0121" {
        title: "brackets are nested too deep",
        explanation: "At most 64 brackets may be open at once.",
        example: "a formula with 65 brackets open",
        fix: "give the inner part a name with `let`",
    }
    TOO_MANY_OPERATORS = "E0122" {
        title: "too many operators in one statement",
        explanation: "A statement may hold at most 512 operators, calls and fields.",
        example: "a sum of 600 terms",
        fix: "`sum(...)` of a list, or several `let`s",
    }
    FILE_TOO_BIG = "E0123" {
        title: "the file is too big",
        explanation: "A file may have at most 256 kB; large data belongs in separate files.",
        example: "a file of 300 kB",
        fix: "several files, brought together with `use`",
    }
    MISSING_SEPARATOR = "E0124" {
        title: "two statements on one line",
        explanation: "A statement ends at the end of its line. Several statements on one line are separated by `;`, the \
            fields of a block by commas.",
        example: "task t { control 100 Hz horizon 1000 steps }",
        fix: "task t { control 100 Hz; horizon 1000 steps }",
    }
    NUMBER_TOO_BIG = "E0125" {
        title: "the number is too big",
        explanation: "Numbers are 64-bit floating point, at most about 1.8e308.",
        example: "task t { let x = 1e999 }",
        fix: "task t { let x = 1e9 }",
    }
    BRACE_PATTERN = "E0126" {
        title: "this brace pattern matches nothing",
        explanation: "Braces directly after an underscore contain words `{l,r}`, a range `{0..9}` whose upper end is \
            excluded, a star `{*}`, or one loop variable `{i}`.",
        example: "task t { observe { pole_{9..3}.height } }",
        fix: "task t { observe { pole_{3..9}.height } }",
    }
    UNREADABLE = "E0127" {
        title: "the text cannot be parsed",
        explanation: "Parsing it would need too much memory for nested constructs.",
        example: "machine-made text nested beyond all use",
        fix: "give inner parts names with `let`",
    }
    UNIT_EXPONENT = "E0128" {
        title: "the exponent of a unit is too big",
        explanation: "Exponents of units are whole numbers or fractions with parts up to 9: `m^-2`, `m^(1/2)`.",
        example: "task t { let x = 1 m^20 }",
        fix: "task t { let x = 1 m^2 }",
    }
    MISPLACED = "E0129" {
        title: "not allowed in this block",
        explanation: "The statement is valid in the language, but not in this block.",
        example: "suite bench { protocol { episodes 50 }; protocol { seed 1 } }",
        fix: "suite bench { protocol a { episodes 50 }; protocol b { seed 1 } }",
    }
    MISSING_BLOCK = "E0130" {
        title: "missing block in braces",
        explanation: "The statement needs a block `{ ... }`.",
        example: "task t { reward }",
        fix: "task t { reward { 5 alive = not terminated } }",
    }
    MORE_ERRORS = "E0131" {
        title: "there are more errors",
        explanation: "At most 500 errors are shown per file; the last one counts the others.",
        example: "a file that is not an .msk file at all",
        fix: "correct what is shown and look again",
    }
}
