//! The map from impact to impact of a forced system of one moving body, by simulation alone: nothing
//! here differentiates the system's equations.

use super::settings;
use nalgebra::{Complex, DMatrix, DVector, Matrix2, Vector2};
use std::ops::ControlFlow;
use tangency::core::hybrid::{Event, HybridFlow, HybridState, HybridSystem};

/// The map from impact to impact of `(t, u)`, the time of the impact and the speed just before, where the
/// time is counted without the period of the forcing.
pub struct ImpactMap<S> {
    pub system: S,
    /// The guard of the impacts, and the mode that it ends; its states are the place of the stop and
    /// the speed.
    pub impact: (usize, usize),
    pub stop: f64,
    pub p: Vec<f64>,
}

/// The degree of fitted polynomials, and the number of nodes in each direction. What a fit leaves
/// out of the third derivatives is of fourth order in the distance of the nodes.
const DEGREE: usize = 6;
const NODES: usize = 9;

impl<S: HybridSystem> ImpactMap<S> {
    pub fn period(&self) -> f64 {
        self.system.period(&self.p)
    }

    /// The image of a point after a few impacts.
    pub fn image(&self, from: [f64; 2], impacts: usize) -> Vector2<f64> {
        self.impacts(from, impacts)[impacts - 1]
    }

    /// The images of a point after one impact, two impacts, and so on.
    pub fn impacts(&self, [t, u]: [f64; 2], count: usize) -> Vec<Vector2<f64>> {
        let ((guard, mode), p) = (self.impact, &self.p);
        let before = [self.stop, u];
        let next = self.system.next_mode(guard, mode, t, &before, p);
        let mut x = vec![0.0; self.system.modes()[next].states.len()];
        self.system.reset(guard, (mode, next), t, &before, p, &mut x);
        let mut state = HybridState { mode: next, time: t, x };
        let mut flow = HybridFlow::new(&self.system, settings(1e-14)).unwrap();
        let (period, mut found) = (self.period(), Vec::with_capacity(count));
        let mut watch = |event: &Event<f64>| {
            if event.guard == guard {
                let periods = (found.len() + 1) as f64;
                found.push(Vector2::new(event.time - periods * period, event.before[1]));
            }
            if found.len() == count { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        flow.advance(&mut state, (count as f64 + 0.5) * period, p, &mut watch).unwrap();
        found
    }

    /// The fixed point of some iterates, from near it, by Newton's iteration with differences.
    pub fn fixed(&self, near: [f64; 2], impacts: usize) -> [f64; 2] {
        let step = 1e-6;
        let mut x = Vector2::from(near);
        for _ in 0..12 {
            let image = |x: Vector2<f64>| self.image([x[0], x[1]], impacts);
            let column = |k: usize| {
                let mut d = Vector2::zeros();
                d[k] = step;
                (image(x + d) - image(x - d)) / (2.0 * step)
            };
            let slope = Matrix2::from_columns(&[column(0), column(1)]) - Matrix2::identity();
            let change = slope.lu().solve(&(x - image(x))).unwrap();
            x += change;
            if change.norm() < 1e-12 {
                break;
            }
        }
        [x[0], x[1]]
    }

    /// The Taylor polynomials about a fixed point, fitted to images of a square of half the width
    /// `size`.
    pub fn fitted(&self, at: [f64; 2], size: f64) -> Fitted {
        let powers: Vec<[i32; 2]> = (0..=DEGREE as i32)
            .flat_map(|degree| (0..=degree).map(move |k| [degree - k, k]))
            .collect();
        let node = |k: usize| ((k as f64 + 0.5) / NODES as f64 * std::f64::consts::PI).cos();
        let nodes: Vec<[f64; 2]> =
            (0..NODES * NODES).map(|k| [node(k / NODES), node(k % NODES)]).collect();
        let rows = DMatrix::from_fn(nodes.len(), powers.len(), |k, m| {
            nodes[k][0].powi(powers[m][0]) * nodes[k][1].powi(powers[m][1])
        });
        let images: Vec<Vector2<f64>> =
            nodes.iter().map(|d| self.image([0, 1].map(|i| at[i] + size * d[i]), 1)).collect();
        let svd = rows.svd(true, true);
        let coefficients = [0, 1].map(|i| {
            let right = DVector::from_iterator(images.len(), images.iter().map(|y| y[i] - at[i]));
            let scaled = svd.solve(&right, 1e-14).unwrap();
            let unscaled = powers.iter().zip(scaled.iter());
            unscaled.map(|([a, b], c)| c / size.powi(a + b)).collect()
        });
        Fitted { powers, coefficients }
    }
}

/// A map near a fixed point as polynomials of the deviations.
pub struct Fitted {
    powers: Vec<[i32; 2]>,
    coefficients: [Vec<f64>; 2],
}

impl Fitted {
    /// The terms of a degree.
    fn terms(&self, degree: i32, d: Vector2<f64>) -> Vector2<f64> {
        let of = |i: usize| -> f64 {
            let all = self.powers.iter().zip(&self.coefficients[i]);
            let own = all.filter(|([a, b], _)| a + b == degree);
            own.map(|([a, b], c)| c * d[0].powi(*a) * d[1].powi(*b)).sum()
        };
        Vector2::new(of(0), of(1))
    }

    /// How far the point is from a fixed one.
    pub fn missed(&self) -> f64 {
        self.terms(0, Vector2::zeros()).norm()
    }

    pub fn slope(&self) -> Matrix2<f64> {
        let unit = |k: usize| Vector2::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
        Matrix2::from_columns(&[self.terms(1, unit(0)), self.terms(1, unit(1))])
    }

    /// `B(v, w)`, twice the polar form of the terms of second degree.
    fn second(&self, v: Pair, w: Pair) -> Pair {
        let of = |v: Vector2<f64>, w: Vector2<f64>| {
            self.terms(2, v + w) - self.terms(2, v) - self.terms(2, w)
        };
        let [(a, b), (c, d)] = [v, w].map(|v| (v.map(|c| c.re), v.map(|c| c.im)));
        complex(of(a, c) - of(b, d), of(a, d) + of(b, c))
    }

    /// `C(v, v, v̄)`.
    fn third(&self, v: Pair) -> Pair {
        let of = |k: f64, l: f64| self.terms(3, v.map(|c| k * c.re + l * c.im));
        let (a, b) = (of(1.0, 0.0), of(0.0, 1.0));
        // C(a, a, b) and C(a, b, b).
        let [sum, difference] = [of(1.0, 1.0), of(1.0, -1.0)];
        let aab = (sum - difference) - 2.0 * b;
        let abb = (sum + difference) - 2.0 * a;
        complex(6.0 * a + abb, aab + 6.0 * b)
    }

    /// The coefficient `D` in `z → λ (z + D z |z|²)` on the center manifold of a multiplier `λ` of
    /// modulus 1, for the deviation `z q` (and `z̄ q̄`) with `q = (1, q_u)`; and the left vector `p`
    /// with `p·q = 1`.
    ///
    /// ```text
    ///     λ D = p·(C(q, q, q̄) + B(q̄, (λ² − A)⁻¹ B(q, q)) + 2 B(q, (1 − A)⁻¹ B(q, q̄)))/2,
    /// ```
    ///
    /// and a third of it for a real `λ`.
    pub fn cubic(&self, multiplier: Complex<f64>) -> (Complex<f64>, Pair) {
        let a = self.slope().map(|x| Complex::new(x, 0.0));
        // The rows of A − λ are parallel, and so are its columns.
        let ratio = multiplier - a[(0, 0)];
        let q = Vector2::new(Complex::new(1.0, 0.0), ratio / a[(0, 1)]);
        let left = Vector2::new(Complex::new(1.0, 0.0), ratio / a[(1, 0)]);
        let left = left / left.dot(&q);
        let solve = |lambda: Complex<f64>, right: Pair| {
            (Matrix2::identity() * lambda - a).lu().solve(&right).unwrap()
        };
        let (conjugate, one) = (q.map(|c| c.conj()), Complex::new(1.0, 0.0));
        let h20 = solve(multiplier * multiplier, self.second(q, q));
        let h11 = solve(one, self.second(q, conjugate));
        let h20 = self.second(conjugate, h20);
        let h11 = self.second(q, h11) * Complex::new(2.0, 0.0);
        let sum = left.dot(&(self.third(q) + h20 + h11));
        // Of a real multiplier the three terms z q, z̄ q̄ coincide.
        let count = if multiplier.im == 0.0 { 6.0 } else { 2.0 };
        (sum / (multiplier * count), left)
    }
}

/// A complex vector of the plane.
type Pair = Vector2<Complex<f64>>;

fn complex(re: Vector2<f64>, im: Vector2<f64>) -> Pair {
    re.zip_map(&im, Complex::new)
}
