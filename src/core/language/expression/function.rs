//! The names that an expression can use: the variable, constants and functions.

/// A function of one argument. Angles are in rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    /// The natural logarithm.
    Ln,
    Log10,
    Log2,
    Sqrt,
    Cbrt,
    Abs,
}

/// An operation on two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pairing {
    Add,
    Subtract,
    Multiply,
    Divide,
    /// The first operand to the power of the second, which contains x.
    Power,
    Min,
    Max,
    /// The square root of the sum of the squares.
    Hypot,
}

/// The meaning of a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meaning {
    Variable,
    Constant(f64),
    Function(Function),
    Pairing(Pairing),
}

/// Every legal name; `log` is the natural logarithm.
pub const NAMES: &[(&str, Meaning)] = &[
    ("x", Meaning::Variable),
    ("pi", Meaning::Constant(std::f64::consts::PI)),
    ("e", Meaning::Constant(std::f64::consts::E)),
    ("sin", Meaning::Function(Function::Sin)),
    ("cos", Meaning::Function(Function::Cos)),
    ("tan", Meaning::Function(Function::Tan)),
    ("asin", Meaning::Function(Function::Asin)),
    ("acos", Meaning::Function(Function::Acos)),
    ("atan", Meaning::Function(Function::Atan)),
    ("sinh", Meaning::Function(Function::Sinh)),
    ("cosh", Meaning::Function(Function::Cosh)),
    ("tanh", Meaning::Function(Function::Tanh)),
    ("exp", Meaning::Function(Function::Exp)),
    ("ln", Meaning::Function(Function::Ln)),
    ("log", Meaning::Function(Function::Ln)),
    ("log10", Meaning::Function(Function::Log10)),
    ("log2", Meaning::Function(Function::Log2)),
    ("sqrt", Meaning::Function(Function::Sqrt)),
    ("cbrt", Meaning::Function(Function::Cbrt)),
    ("abs", Meaning::Function(Function::Abs)),
    ("pow", Meaning::Pairing(Pairing::Power)),
    ("min", Meaning::Pairing(Pairing::Min)),
    ("max", Meaning::Pairing(Pairing::Max)),
    ("hypot", Meaning::Pairing(Pairing::Hypot)),
];
