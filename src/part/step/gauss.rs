//! Numerical integrals.

/// Places and weights of Gauss's rule of 6 points over [-1, 1], which is exact up to degree 11.
const RULE: [(f64, f64); 6] = [
    (-0.932_469_514_203_152, 0.171_324_492_379_170_36),
    (-0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (-0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_36),
];

/// Halvings of an interval.
const DEEPEST: usize = 8;

/// The integral over [from, to] by one use of the rule.
pub fn once(from: f64, to: f64, f: &mut impl FnMut(f64) -> f64) -> f64 {
    let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
    RULE.iter().map(|(place, weight)| weight * f(middle + half * place)).sum::<f64>() * half
}

/// The integral over [from, to], halved until halving changes it by less than `tolerance`.
pub fn adaptive(from: f64, to: f64, tolerance: f64, f: &mut impl FnMut(f64) -> f64) -> f64 {
    let whole = once(from, to, f);
    halved([from, to], whole, tolerance, 0, f)
}

fn halved(
    [from, to]: [f64; 2],
    whole: f64,
    tolerance: f64,
    depth: usize,
    f: &mut impl FnMut(f64) -> f64,
) -> f64 {
    let middle = (from + to) / 2.0;
    let halves = [once(from, middle, f), once(middle, to, f)];
    let sum = halves[0] + halves[1];
    if (sum - whole).abs() <= tolerance || depth == DEEPEST || sum.is_nan() {
        return sum;
    }
    halved([from, middle], halves[0], tolerance / 2.0, depth + 1, f)
        + halved([middle, to], halves[1], tolerance / 2.0, depth + 1, f)
}
