//! Gauss–Legendre quadrature.

/// Computes the nodes in (−1, 1), in ascending order, and the weights of the `n`-point
/// Gauss–Legendre rule, which is exact for polynomials of degree `2n − 1`.
///
/// Newton's iteration on the three-term recurrence of `P_n` starts from the asymptotic nodes
/// `cos(π(i + 3/4)/(n + 1/2))`; nodes are accurate to an ulp, weights to a few ulps.
///
/// ```
/// let (x, w) = tangency::core::numerics::gauss_legendre(5);
/// let integral: f64 = x.iter().zip(&w).map(|(x, w)| w * x.powi(8)).sum();
/// assert!((integral - 2.0 / 9.0).abs() < 1e-15);
/// ```
pub fn gauss_legendre(n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut nodes = vec![0.0; n];
    let mut weights = vec![0.0; n];
    for i in 0..n.div_ceil(2) {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        if 2 * i + 1 == n {
            x = 0.0;
        }
        let mut slope = 0.0;
        for _ in 0..8 {
            let (value, derivative) = legendre_with_slope(n, x);
            slope = derivative;
            let step = value / derivative;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        (nodes[i], nodes[n - 1 - i]) = (-x, x);
        weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
        weights[n - 1 - i] = weights[i];
    }
    (nodes, weights)
}

fn legendre_with_slope(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    (current, n as f64 * (x * current - previous) / (x * x - 1.0))
}
