//! Functions of one variable `ξ ∈ [−1, 1]` whose products span the displacements of a plate.
//!
//! A [`Basis`] is hierarchical: it begins with a few polynomials of degree at most 3, which satisfy
//! the conditions at the ends, and continues with *bubbles*. Bubbles are multiple integrals of
//! Legendre polynomials that vanish at both ends (together with their slopes, for `m = 2`):
//!
//! ```text
//! m = 1:  b_k' = √(k − ½) P_{k−1},    b_k = √(k − ½) (P_k − P_{k−2})/(2k − 1),                k ≥ 2
//! m = 2:  b_k" = √(k − 3/2) P_{k−2},  b_k' the bubble of m = 1 and degree k − 1,              k ≥ 4
//! ```
//!
//! The scaling gives `∫ b_j^(m) b_k^(m) dξ = δ_jk`, so that stiffness matrices are close to
//! diagonal at every order. Values are computed by the recurrence of Legendre polynomials, because
//! powers of `ξ` lose all digits by order 50. Appendix B of Zhao's dissertation writes the same
//! functions as sums of powers of `ξ`.

use super::edges::{InPlane, Support};
use super::tensor::{Rule, moments};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, Par, Side};

/// The direction of an in-plane displacement relative to the edges at the two ends of the interval;
/// it determines at which ends the displacement is prescribed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// The displacement is normal to the edges at the two ends of the interval.
    Normal,
    /// The displacement is tangential to the edges at the two ends of the interval.
    Tangential,
}

#[derive(Clone, Copy, Debug)]
enum Function {
    /// The cubic `c₀ + c₁ξ + c₂ξ² + c₃ξ³`, given by its coefficients.
    Cubic([f64; 4]),
    /// The bubble function of degree `k`.
    Bubble(usize),
}

/// A set of functions on `[−1, 1]`, with their values, slopes and curvatures.
#[derive(Clone, Debug)]
pub struct Basis {
    functions: Vec<Function>,
    /// The number `m` of times that a Legendre polynomial is integrated to give a bubble function.
    integrals: usize,
    /// The number of functions at the beginning of the basis that do not vanish at the ends of the
    /// interval.
    pub(super) boundary: usize,
    degree: usize,
    /// The linear combinations that replace the original functions of the basis, if any.
    mix: Option<Mix>,
}

/// A change of the basis from the functions `f_k` to the functions `F_m = Σ_k T_mk f_k`.
#[derive(Clone, Debug)]
struct Mix {
    /// The matrix `T`, with `T_mk` at position `m·n + k`.
    to: Vec<f64>,
    /// The matrix `T⁻ᵀ`, stored like the matrix `T`; it converts coefficients of the functions `f`
    /// into coefficients of the functions `F`.
    back: Vec<f64>,
}

/// The four cubics given by their values and slopes at −1 and 1: for each cubic, one of these four
/// numbers is 1 and the other three are 0.
const HERMITE: [[f64; 4]; 4] = [
    [0.5, -0.75, 0.0, 0.25],
    [0.25, -0.25, -0.25, 0.25],
    [0.5, 0.75, 0.0, -0.25],
    [-0.25, -0.25, 0.25, 0.25],
];

/// The largest number of functions in a basis. For larger numbers of functions, the mass matrix
/// loses all digits.
pub(super) const LARGEST_COUNT: usize = 60;

impl Basis {
    /// Creates the first `count` functions for a deflection with the supports `ends` at `ξ = −1`
    /// and `ξ = 1`; if `even` is true, only even functions are created, and the two supports must
    /// be equal.
    pub fn transverse(ends: [Support; 2], even: bool, count: usize) -> Basis {
        let cubics = if even {
            match ends[0] {
                Support::Clamped => vec![],
                Support::SimplySupported => vec![[1.0, 0.0, -1.0, 0.0]],
                Support::Free => vec![[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, -1.0, 0.0]],
            }
        } else {
            let mut cubics = Vec::new();
            for (end, support) in ends.into_iter().enumerate() {
                if support == Support::Free {
                    cubics.push(HERMITE[2 * end]);
                }
                if support != Support::Clamped {
                    cubics.push(HERMITE[2 * end + 1]);
                }
            }
            cubics
        };
        Basis::new(cubics, 2, 4, if even { 2 } else { 1 }, count)
    }

    /// Creates the first `count` functions for an in-plane displacement between two edges whose
    /// in-plane supports are `ends`. `parity` is `Some(true)` for even functions only,
    /// `Some(false)` for odd functions only, and `None` for all functions.
    pub(super) fn in_plane(
        ends: [InPlane; 2],
        direction: Direction,
        parity: Option<bool>,
        count: usize,
    ) -> Basis {
        let held = ends.map(|end| match direction {
            Direction::Normal => matches!(end, InPlane::Slide | InPlane::Immovable),
            Direction::Tangential => end == InPlane::Immovable,
        });
        let (rising, falling) = ([0.5, 0.5, 0.0, 0.0], [0.5, -0.5, 0.0, 0.0]);
        let (constant, linear) = ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]);
        let cubics = match (parity, held) {
            (Some(true), [false, _]) => vec![constant],
            (Some(false), [false, _]) => vec![linear],
            (Some(_), _) | (None, [true, true]) => vec![],
            (None, [false, true]) => vec![falling],
            (None, [true, false]) => vec![rising],
            // A straight edge needs only the functions of its normal displacement; a tangential
            // displacement needs the constant as one function, for straight edges across.
            (None, [false, false]) if direction == Direction::Normal => vec![falling, rising],
            (None, [false, false]) => vec![constant, linear],
        };
        let first = if parity == Some(false) { 3 } else { 2 };
        Basis::new(cubics, 1, first, if parity.is_some() { 2 } else { 1 }, count)
    }

    fn new(
        cubics: Vec<[f64; 4]>,
        integrals: usize,
        first: usize,
        stride: usize,
        count: usize,
    ) -> Basis {
        let boundary = cubics.len().min(count);
        let mut functions: Vec<Function> = cubics.into_iter().map(Function::Cubic).collect();
        functions.truncate(count);
        functions.extend((0..count - boundary).map(|i| Function::Bubble(first + stride * i)));
        let degree = functions.iter().map(Function::degree).max().unwrap_or(0);
        Basis { functions, integrals, boundary, degree, mix: None }
    }

    /// Replaces the functions by the modes of a beam with the same supports. The modes `F_i` span
    /// the same space as the functions, and the matrices `⟨F_i F_k⟩` and `⟨F_i" F_k"⟩` are both
    /// diagonal. In a basis of products of these functions, the stiffness matrix of a plate is
    /// nearly diagonal, so the eigenvalues of the scaled matrix characterise the plate. (In the
    /// basis of polynomials, the condition number of the matrix is 1e6 with ten functions, and
    /// inverse iteration yields noise.)
    ///
    /// The first function is the lowest beam mode; all functions are positive next to `ξ = 1`. The
    /// basis remains unchanged if values of its functions are not finite, because the eigenproblem
    /// then has no solution.
    #[must_use]
    pub(super) fn into_beam_modes(mut self, symmetric: bool) -> Basis {
        let n = self.len();
        let rule = Rule::exact(2 * self.degree, symmetric);
        let table = self.table(&rule.nodes);
        let mass = Mat::from_fn(n, n, {
            let mass = moments(&rule, &table.values, &table.values);
            move |i, k| mass[i * n + k]
        });
        let bending = moments(&rule, &table.curvatures, &table.curvatures);
        // A free beam has modes without bending, so the mass is added to make the matrix regular.
        let energy = Mat::from_fn(n, n, |i, k| bending[i * n + k] + mass[(i, k)]);
        let Ok(factor) = energy.llt(Side::Lower) else { return self };
        let lower = factor.L();
        let mut reduced = mass;
        solve_lower_triangular_in_place(lower, reduced.as_mut(), Par::Seq);
        solve_lower_triangular_in_place(lower, reduced.as_mut().transpose_mut(), Par::Seq);
        let Ok(eigen) = reduced.self_adjoint_eigen(Side::Lower) else { return self };
        let mut modes = eigen.U().to_owned();
        solve_upper_triangular_in_place(lower.transpose(), modes.as_mut(), Par::Seq);
        for mode in 0..n {
            let towards_end: f64 =
                (0..n).map(|k| modes[(k, mode)] * table.values[(k + 1) * rule.len() - 1]).sum();
            let sign = towards_end.signum();
            modes.col_mut(mode).iter_mut().for_each(|entry| *entry *= sign);
        }
        let back = &energy * &modes;
        // Eigenvalues ascend, and the largest mass for a given energy belongs to the lowest mode.
        let rows = |matrix: &Mat<f64>| {
            (0..n * n).map(|entry| matrix[(entry % n, n - 1 - entry / n)]).collect()
        };
        self.mix = Some(Mix { to: rows(&modes), back: rows(&back) });
        self
    }

    /// Returns the matrices that convert coefficients of the basis functions to coefficients of the
    /// polynomials, and back; `None` if the basis functions are the polynomials themselves.
    pub(super) fn conversions(&self) -> Option<[&[f64]; 2]> {
        self.mix.as_ref().map(|mix| [&mix.to[..], &mix.back[..]])
    }

    /// Returns the number of functions in the basis.
    pub fn len(&self) -> usize {
        self.functions.len()
    }

    /// Returns whether the basis contains no functions.
    pub fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// Returns the highest degree of the polynomials in the basis.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Returns whether the constant 1 (`power` 0) or `ξ` (`power` 1) is a linear combination of the
    /// functions.
    pub(super) fn contains(&self, power: usize) -> bool {
        let linear = |function: &Function| match function {
            Function::Cubic(c) if c[2] == 0.0 && c[3] == 0.0 => Some(*c),
            _ => None,
        };
        let cubics: Vec<[f64; 4]> = self.functions.iter().filter_map(linear).collect();
        cubics.len() == 2 || cubics.iter().any(|c| c[power] != 0.0 && c[1 - power] == 0.0)
    }

    /// Returns the values, slopes and curvatures of all functions at `ξ`, one function after
    /// another.
    pub fn at(&self, xi: f64) -> Vec<[f64; 3]> {
        let mut point = AtPoint::default();
        self.evaluate(xi, &mut point);
        point.values
    }

    /// Evaluates all functions of the basis and their derivatives at `xi` into a reusable
    /// workspace.
    pub(super) fn evaluate(&self, xi: f64, point: &mut AtPoint) {
        legendre(self.degree, xi, &mut point.legendre);
        let p = &point.legendre;
        let polynomials = self.functions.iter().map(|function| match *function {
            Function::Cubic([c0, c1, c2, c3]) => [
                c0 + xi * (c1 + xi * (c2 + xi * c3)),
                c1 + xi * (2.0 * c2 + xi * 3.0 * c3),
                2.0 * c2 + 6.0 * c3 * xi,
            ],
            Function::Bubble(k) if self.integrals == 1 => {
                [once(p, k), (k as f64 - 0.5).sqrt() * p[k - 1], f64::NAN]
            }
            Function::Bubble(k) => {
                [twice(p, k), once(p, k - 1), (k as f64 - 1.5).sqrt() * p[k - 2]]
            }
        });
        point.values.clear();
        let Some(mix) = &self.mix else { return point.values.extend(polynomials) };
        point.polynomials.clear();
        point.polynomials.extend(polynomials);
        let plain = &point.polynomials;
        let combine = |row: &[f64]| {
            [0, 1, 2].map(|order| row.iter().zip(plain).map(|(t, f)| t * f[order]).sum())
        };
        point.values.extend(mix.to.chunks_exact(plain.len()).map(combine));
    }

    /// Returns the values, slopes and curvatures of all functions at all `nodes`.
    pub fn table(&self, nodes: &[f64]) -> Table {
        let (points, functions) = (nodes.len(), self.len());
        let zeros = || vec![0.0; points * functions];
        let mut table =
            Table { points, functions, values: zeros(), slopes: zeros(), curvatures: zeros() };
        let mut memory = AtPoint::default();
        for (point, node) in nodes.iter().enumerate() {
            self.evaluate(*node, &mut memory);
            for (function, [value, slope, curvature]) in memory.values.iter().enumerate() {
                let entry = function * points + point;
                table.values[entry] = *value;
                table.slopes[entry] = *slope;
                table.curvatures[entry] = *curvature;
            }
        }
        table
    }
}

impl Function {
    fn degree(&self) -> usize {
        match self {
            Function::Cubic(c) => c.iter().rposition(|c| *c != 0.0).unwrap_or(0),
            Function::Bubble(k) => *k,
        }
    }
}

/// The functions of a [`Basis`] at one point, and the workspace of their evaluation.
#[derive(Clone, Debug, Default)]
pub(super) struct AtPoint {
    /// The value, slope and curvature of each function.
    pub values: Vec<[f64; 3]>,
    legendre: Vec<f64>,
    polynomials: Vec<[f64; 3]>,
}

/// Computes the Legendre polynomials `P_0 … P_degree` at `ξ`.
fn legendre(degree: usize, xi: f64, p: &mut Vec<f64>) {
    p.resize(degree.max(1) + 1, 1.0);
    p[1] = xi;
    for k in 2..=degree {
        let j = k as f64;
        p[k] = ((2.0 * j - 1.0) * xi * p[k - 1] - (j - 1.0) * p[k - 2]) / j;
    }
}

/// Returns the bubble function `√(k − ½) ∫P_{k−1}`.
fn once(p: &[f64], k: usize) -> f64 {
    let j = k as f64;
    (j - 0.5).sqrt() * (p[k] - p[k - 2]) / (2.0 * j - 1.0)
}

/// Returns the bubble function `√(k − 3/2) ∬P_{k−2}`.
fn twice(p: &[f64], k: usize) -> f64 {
    let n = k as f64 - 2.0;
    (n + 0.5).sqrt()
        * ((p[k] - p[k - 2]) / (2.0 * n + 3.0) - (p[k - 2] - p[k - 4]) / (2.0 * n - 1.0))
        / (2.0 * n + 1.0)
}

/// The functions of a [`Basis`] at the nodes of a quadrature rule, one function after another: the
/// entry of a function at a point has the position `function · points + point`.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The number of nodes of the table.
    pub points: usize,
    /// The number of functions in the table.
    pub functions: usize,
    /// The values.
    pub values: Vec<f64>,
    /// The slopes of the functions with respect to `ξ`.
    pub slopes: Vec<f64>,
    /// The curvatures of the functions with respect to `ξ` (NaN for in-plane bubble functions,
    /// whose curvatures are not needed).
    pub curvatures: Vec<f64>,
}
