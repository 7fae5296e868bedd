//! Random expressions as trees. A tree computes its value on its own, so that tests can compare this value.

use proptest::prelude::*;

/// An expression as a tree, to compare with the compiled expression.
#[derive(Debug, Clone)]
pub enum Tree {
    Variable,
    Number(f64),
    Negative(Box<Tree>),
    Call(&'static str, Box<Tree>),
    Pair(&'static str, Box<Tree>, Box<Tree>),
    Operator(char, Box<Tree>, Box<Tree>),
}

impl Tree {
    pub fn value(&self, x: f64) -> f64 {
        match self {
            Tree::Variable => x,
            Tree::Number(c) => *c,
            Tree::Negative(a) => -a.value(x),
            Tree::Call(name, a) => called(name, a.value(x)),
            Tree::Pair(name, a, b) => match *name {
                "min" => a.value(x).min(b.value(x)),
                "max" => a.value(x).max(b.value(x)),
                "hypot" => a.value(x).hypot(b.value(x)),
                _ => unreachable!("{name}"),
            },
            Tree::Operator(operator, a, b) => match operator {
                '+' => a.value(x) + b.value(x),
                '-' => a.value(x) - b.value(x),
                '*' => a.value(x) * b.value(x),
                '/' => a.value(x) / b.value(x),
                // A square is a product. The power function of the library may differ from it in the last
                // place.
                '^' if !b.holds_x() && b.value(x) == 2.0 => a.value(x) * a.value(x),
                '^' => a.value(x).powf(b.value(x)),
                _ => unreachable!("{operator}"),
            },
        }
    }

    fn holds_x(&self) -> bool {
        match self {
            Tree::Variable => true,
            Tree::Number(_) => false,
            Tree::Negative(a) | Tree::Call(_, a) => a.holds_x(),
            Tree::Pair(_, a, b) | Tree::Operator(_, a, b) => a.holds_x() || b.holds_x(),
        }
    }

    /// The text with as few parentheses as the grammar needs.
    pub fn text(&self) -> String {
        self.written(0)
    }

    /// The text as an operand that binds at least as tightly as `level`.
    fn written(&self, level: u8) -> String {
        let (text, own) = match self {
            Tree::Variable => ("x".to_owned(), 5),
            Tree::Number(c) => (format!("{c:?}"), 5),
            Tree::Negative(a) => (format!("-{}", a.written(3)), 3),
            Tree::Call(name, a) => (format!("{name}({})", a.written(0)), 5),
            Tree::Pair(name, a, b) => (format!("{name}({}, {})", a.written(0), b.written(0)), 5),
            Tree::Operator(operator, a, b) => {
                let (own, left, right) = match operator {
                    '+' | '-' => (1, 1, 2),
                    '*' | '/' => (2, 2, 3),
                    // A sign may start the exponent of a power, but not its base.
                    _ => (4, 5, 3),
                };
                (format!("{}{operator}{}", a.written(left), b.written(right)), own)
            }
        };
        if own < level { format!("({text})") } else { text }
    }
}

fn called(name: &str, a: f64) -> f64 {
    match name {
        "sin" => a.sin(),
        "cos" => a.cos(),
        "tan" => a.tan(),
        "asin" => a.asin(),
        "acos" => a.acos(),
        "atan" => a.atan(),
        "sinh" => a.sinh(),
        "cosh" => a.cosh(),
        "tanh" => a.tanh(),
        "exp" => a.exp(),
        "ln" | "log" => a.ln(),
        "log10" => a.log10(),
        "log2" => a.log2(),
        "sqrt" => a.sqrt(),
        "cbrt" => a.cbrt(),
        "abs" => a.abs(),
        _ => unreachable!("{name}"),
    }
}

const CALLS: &[&str] = &[
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "ln", "log", "log10", "log2",
    "sqrt", "cbrt", "abs",
];

/// Random trees of some twenty operations.
pub fn tree() -> impl Strategy<Value = Tree> {
    let number = prop_oneof![
        (0..5i32).prop_map(f64::from),
        prop::sample::select(vec![0.5, 0.25, 1.5, 2.5, 0.1]),
        0.0..3.0f64
    ];
    let leaf = prop_oneof![3 => Just(Tree::Variable), 2 => number.prop_map(Tree::Number)];
    leaf.prop_recursive(5, 24, 2, |inner| {
        let boxed = inner.prop_map(Box::new).boxed();
        let operator = prop::sample::select(vec!['+', '-', '*', '/', '^', '+', '*']);
        let pair = prop::sample::select(vec!["min", "max", "hypot"]);
        let call = prop::sample::select(CALLS);
        prop_oneof![
            1 => boxed.clone().prop_map(Tree::Negative),
            3 => (call, boxed.clone()).prop_map(|(name, a)| Tree::Call(name, a)),
            1 => (pair, boxed.clone(), boxed.clone()).prop_map(|(name, a, b)| Tree::Pair(name, a, b)),
            6 => (operator, boxed.clone(), boxed).prop_map(|(o, a, b)| Tree::Operator(o, a, b)),
        ]
    })
}
