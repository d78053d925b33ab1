//! The words for operations in snapshots and hashes. They stay when a variant is renamed: a hash names what is computed, not
//! how the compiler spells it. See `docs/content-hash.md`.

use super::operation::{Binary, Chance, Memory, Reduction, Unary};

/// Gives every variant of a type its word.
macro_rules! words {
    ($kind:ident: $($variant:ident = $word:literal),* $(,)?) => {
        impl $kind {
            /// All of them.
            #[cfg(test)]
            #[allow(dead_code, reason = "a distribution is not an operation on numbers")]
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            pub(super) fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),*
                }
            }
        }
    };
}

words!(Chance:
    Uniform = "Uniform",
    Normal = "Normal",
);

words!(Unary:
    Negate = "Negate",
    Absolute = "Absolute",
    SquareRoot = "SquareRoot",
    Exponential = "Exponential",
    Logarithm = "Logarithm",
    HyperbolicTangent = "HyperbolicTangent",
    Sine = "Sine",
    Cosine = "Cosine",
    Tangent = "Tangent",
    ArcSine = "ArcSine",
    ArcCosine = "ArcCosine",
    Floor = "Floor",
    Sign = "Sign",
    Not = "Not",
    Wrap = "Wrap",
);

words!(Binary:
    Add = "Add",
    Subtract = "Subtract",
    Multiply = "Multiply",
    Divide = "Divide",
    Power = "Power",
    Minimum = "Minimum",
    Maximum = "Maximum",
    ArcTangent2 = "ArcTangent2",
    Hypotenuse = "Hypotenuse",
    Modulo = "Modulo",
    Less = "Less",
    LessEqual = "LessEqual",
    Equal = "Equal",
    And = "And",
    Or = "Or",
);

words!(Reduction:
    Sum = "Sum",
    Product = "Product",
    Minimum = "Minimum",
    Maximum = "Maximum",
    Norm = "Norm",
    ArgMinimum = "ArgMinimum",
    ArgMaximum = "ArgMaximum",
);

impl Memory {
    pub(super) fn words(self) -> String {
        match self {
            Self::Initial => "Initial".to_owned(),
            Self::Highest => "Highest".to_owned(),
            Self::Lowest => "Lowest".to_owned(),
            Self::Accumulate => "Accumulate".to_owned(),
            Self::Streak => "Streak".to_owned(),
            Self::StepsSince => "StepsSince".to_owned(),
            Self::Hysteresis => "Hysteresis".to_owned(),
            Self::Smooth => "Smooth".to_owned(),
            Self::SmoothAngle => "SmoothAngle".to_owned(),
            Self::Sampled => "Sampled".to_owned(),
            Self::Delay(steps) => format!("Delay({steps})"),
        }
    }
}
