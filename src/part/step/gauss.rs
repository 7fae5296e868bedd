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

/// Places with the weights of Kronrod's rule of 7 points, and of Gauss's rule of 3 of them, over [-1, 1].
const KRONROD: [(f64, f64, f64); 7] = [
    (-0.960_491_268_708_020_2, 0.104_656_226_026_467_27, 0.0),
    (-0.774_596_669_241_483_4, 0.268_488_089_868_333_44, 5.0 / 9.0),
    (-0.434_243_749_346_802_6, 0.401_397_414_775_962_2, 0.0),
    (0.0, 0.450_916_538_658_474_14, 8.0 / 9.0),
    (0.434_243_749_346_802_6, 0.401_397_414_775_962_2, 0.0),
    (0.774_596_669_241_483_4, 0.268_488_089_868_333_44, 5.0 / 9.0),
    (0.960_491_268_708_020_2, 0.104_656_226_026_467_27, 0.0),
];

/// Halvings of an interval.
const DEEPEST: usize = 6;

/// The integral over [from, to] by one use of the rule.
pub fn once(from: f64, to: f64, f: &mut impl FnMut(f64) -> f64) -> f64 {
    let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
    RULE.iter().map(|(place, weight)| weight * f(middle + half * place)).sum::<f64>() * half
}

/// The integral over [from, to] by Kronrod's rule of 7 points, halved until Gauss's rule of 3 of these points
/// differs by less than `tolerance`. The error is far smaller than this difference.
pub fn adaptive(from: f64, to: f64, tolerance: f64, f: &mut impl FnMut(f64) -> f64) -> f64 {
    halved([from, to], tolerance, 0, f)
}

fn halved([from, to]: [f64; 2], tolerance: f64, depth: usize, f: &mut impl FnMut(f64) -> f64) -> f64 {
    let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
    let [mut fine, mut coarse] = [0.0; 2];
    for (place, weight, weight_of_gauss) in KRONROD {
        let value = f(middle + half * place) * half;
        fine += weight * value;
        coarse += weight_of_gauss * value;
    }
    let is_settled = (fine - coarse).abs() <= tolerance || fine.is_nan() || tolerance.is_nan();
    if is_settled || depth == DEEPEST {
        return fine;
    }
    halved([from, middle], tolerance / 2.0, depth + 1, f)
        + halved([middle, to], tolerance / 2.0, depth + 1, f)
}
