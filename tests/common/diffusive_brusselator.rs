//! A reaction with diffusion: equilibria with Hopf points, and cycles of many states.

use tangency::core::problem::{Group, Names, VectorField};
use tangency::core::scalar::Scalar;

/// The Brusselator in one dimension (Dₓ = 0.008, D_y = 0.004) with `2n` states, and its equilibrium at
/// the ends. If `valve` is positive, the second state also enters the last equation where the first
/// state exceeds `valve`.
pub struct DiffusiveBrusselator {
    pub n: usize,
    pub valve: f64,
}

impl DiffusiveBrusselator {
    pub fn new(n: usize) -> Self {
        DiffusiveBrusselator { n, valve: 0.0 }
    }
}

impl VectorField for DiffusiveBrusselator {
    fn names(&self) -> Names {
        let elements = |s: &'static str| (1..=self.n).map(move |i| format!("{s}[{i}]"));
        let all: Vec<String> = elements("u").chain(elements("v")).collect();
        Names::new(Group::of_states(&all), ["L", "A", "B"])
    }
    fn field<T: Scalar>(&self, _t: T, z: &[T], p: &[T], f: &mut [T]) {
        let n = self.n;
        let (u, v) = z.split_at(n);
        let ends = [p[1], p[2] / p[1]];
        let bent = |w: &[T], end: T, i: usize| {
            let at = |i: usize| if i == 0 || i > n { end } else { w[i - 1] };
            let second = at(i - 1) - at(i) * 2.0 + at(i + 1);
            second * ((n + 1) * (n + 1)) as f64 / (p[0] * p[0])
        };
        for i in 1..=n {
            let (u_i, v_i) = (u[i - 1], v[i - 1]);
            let reaction = u_i * u_i * v_i;
            f[i - 1] = bent(u, ends[0], i) * 0.008 + p[1] - (p[2] + 1.0) * u_i + reaction;
            f[n + i - 1] = bent(v, ends[1], i) * 0.004 + p[2] * u_i - reaction;
        }
        if self.valve > 0.0 && u[0].re() > self.valve {
            f[2 * n - 1] += (u[1] - 2.0) * 1e-3;
        }
    }
}
