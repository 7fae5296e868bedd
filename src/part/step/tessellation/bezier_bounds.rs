//! Bounds of the derivatives of rational Bezier pieces.
//!
//! # Method
//! With the numerator A and the denominator w, both polynomials, `S_u = N / w^2` with `N = A_u w - A w_u`,
//! and `S_uu = (N_u w - 2 N w_u) / w^3`, in the same way `S_uv`. The numerators are polynomials, whose
//! control points bound them. What cancels in them cancels in the control points, too, as the bend of a
//! circle along the axis of its cylinder.

use nalgebra::{Vector3, Vector4};

/// Control points times their weights, followed by the weights: rows along v for each place along u. The net
/// of a polynomial in space has no weights.
pub type Net = Vec<Vec<Vector4<f64>>>;

pub fn transposed(net: &[Vec<Vector4<f64>>]) -> Net {
    (0..net[0].len()).map(|j| net.iter().map(|row| row[j]).collect()).collect()
}

/// The net of the derivative along u over a range of this length.
pub fn along_u(net: &[Vec<Vector4<f64>>], length: f64) -> Net {
    let factor = (net.len() - 1) as f64 / length;
    let row =
        |rows: &[Vec<Vector4<f64>>]| rows[0].iter().zip(&rows[1]).map(|(a, b)| (b - a) * factor).collect();
    net.windows(2).map(row).collect()
}

/// The numerator `d_xyz w - xyz d_w` of a derivative `d` of the net.
pub fn numerator(derivative: &Net, net: &Net) -> Net {
    product(derivative, net, |d, p| (d.xyz() * p.w - p.xyz() * d.w).push(0.0))
}

/// The net moved so that its middle is the origin.
fn centred(net: &Net) -> Net {
    let n = (net.len() * net[0].len()) as f64;
    let centre = net.iter().flatten().map(|p| p.xyz() / p.w).sum::<Vector3<f64>>() / n;
    net.iter().map(|row| row.iter().map(|p| (p.xyz() - centre * p.w).push(p.w)).collect()).collect()
}

fn least_weight(net: &Net) -> f64 {
    net.iter().flatten().map(|p| p.w).fold(f64::MAX, f64::min)
}

/// The weight of all control points, if they have one.
fn one_weight(net: &Net) -> Option<f64> {
    let first = net[0][0].w;
    net.iter().flatten().all(|p| p.w == first).then_some(first)
}

fn most(net: &Net) -> f64 {
    net.iter().flatten().map(|p| p.xyz().norm()).fold(0.0, f64::max)
}

/// Bounds of the first and second derivative along u over a range of this length.
pub fn derivatives(net: &Net, length: f64) -> [f64; 2] {
    if let Some(weight) = one_weight(net) {
        let first = along_u(net, length);
        return [most(&first), most(&along_u(&first, length))].map(|bound| bound / weight);
    }
    let net = centred(net);
    let (of_net, least) = (along_u(&net, length), least_weight(&net));
    let first = numerator(&of_net, &net);
    [
        most(&first) / least.powi(2),
        most(&second(&first, &along_u(&first, length), &of_net, &net)) / least.powi(3),
    ]
}

/// Bounds of the second derivatives along uu, uv and vv over ranges of these lengths.
pub fn seconds(net: &Net, lengths: [f64; 2]) -> [f64; 3] {
    let turned = transposed(net);
    let [uu, vv] = [derivatives(net, lengths[0])[1], derivatives(&turned, lengths[1])[1]];
    if let Some(weight) = one_weight(net) {
        let mixed = along_u(&transposed(&along_u(net, lengths[0])), lengths[1]);
        return [uu, most(&mixed) / weight, vv];
    }
    let net = centred(net);
    let turned = transposed(&net);
    let first = transposed(&numerator(&along_u(&net, lengths[0]), &net));
    let mixed = second(&first, &along_u(&first, lengths[1]), &along_u(&turned, lengths[1]), &turned);
    [uu, most(&mixed) / least_weight(&net).powi(3), vv]
}

/// `N_u w - 2 N w_u` of the numerator N, its derivative, and the derivative of the net.
fn second(first: &Net, slope: &Net, of_net: &Net, net: &Net) -> Net {
    let mut sum = product(slope, net, |n, p| n * p.w);
    let taken = product(first, of_net, |n, d| n * (2.0 * d.w));
    for (sum, taken) in sum.iter_mut().flatten().zip(taken.iter().flatten()) {
        *sum -= taken;
    }
    sum
}

/// The control points of a product of two polynomials.
fn product(a: &Net, b: &Net, of: impl Fn(&Vector4<f64>, &Vector4<f64>) -> Vector4<f64>) -> Net {
    if a.is_empty() || b.is_empty() {
        return Net::new();
    }
    let degrees = [[a.len() - 1, b.len() - 1], [a[0].len() - 1, b[0].len() - 1]];
    let shares = degrees.map(|[p, q]| {
        let [of_a, of_b, of_product] = [p, q, p + q].map(binomials);
        let row = |i: usize| -> Vec<f64> { (0..=q).map(|k| of_a[i] * of_b[k] / of_product[i + k]).collect() };
        (0..=p).map(row).collect::<Vec<Vec<f64>>>()
    });
    let mut sums =
        vec![vec![Vector4::zeros(); degrees[1][0] + degrees[1][1] + 1]; degrees[0][0] + degrees[0][1] + 1];
    for (i, row) in a.iter().enumerate() {
        for (k, other) in b.iter().enumerate() {
            for (j, p) in row.iter().enumerate() {
                for (l, q) in other.iter().enumerate() {
                    sums[i + k][j + l] += of(p, q) * (shares[0][i][k] * shares[1][j][l]);
                }
            }
        }
    }
    sums
}

/// The binomial coefficients of a degree.
fn binomials(n: usize) -> Vec<f64> {
    (0..=n)
        .scan(1.0, |next, k| {
            let here = *next;
            *next *= (n - k) as f64 / (k + 1) as f64;
            Some(here)
        })
        .collect()
}
