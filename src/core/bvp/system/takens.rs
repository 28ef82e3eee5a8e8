//! The homoclinic orbit near a Bogdanov–Takens point to second order in the states, used as the guess
//! at which a curve of homoclinic orbits begins.
//!
//! With `A q₀ = 0`, `A q₁ = q₀`, `p₁ A = 0`, `p₀ A = p₁`, `p₀ q₀ = p₁ q₁ = 1` and `p₁ q₀ = p₀ q₁ = 0`,
//! the motion near the point is `z = z₀ + β₂ h + w₀ q₀ + w₁ q₁ + …`, `w₀' = w₁`, `w₁' = β₁ + β₂ w₁ + a
//! w₀² + b w₀ w₁`, and the parameters are `α = α₀ + β₂ k + …`, with
//!
//! ```text
//!     A h + F_α k = 0,    p₁ C(q₀) = 0,    p₀ C(q₀) + p₁ C(q₁) = 1,    C(q) = F_zz[q, h] + F_zα[q, k]
//!     w₀ = (ε²/a)(2 − 6 sech²(ε t)),    β₁ = −4 ε⁴/a,    β₂ = (10/7)(b/a) ε²
//! ```
//!
//! (W.-J. Beyn, in *Continuation and Bifurcations*, Kluwer 1990; B. Al-Hdaibat, W. Govaerts, Yu. A.
//! Kuznetsov and H. G. E. Meijer, *SIAM J. Appl. Dyn. Syst.* 15:952, 2016.)

use super::discretisation::DiscretisedProblem;
use super::rest::{Direction, Rest};
use crate::core::failure::Failure;
use crate::core::system::{Kind, Solution};
use nalgebra::{DMatrix, DVector};

/// Heuristic: the time that the orbit lasts before and after its midpoint, in units of `1/ε`: the
/// distance of its ends from the saddle is less than 1e-3 of the loop's size.
const HALF_TIME: f64 = 4.5;

/// Heuristic: the largest value of `ε b/a`; higher-order terms are powers of `ε b/a`.
const LARGEST: f64 = 0.1;

/// Rounding: a coefficient `a`, or a derivative, counts as a rounding error if it is smaller than
/// this fraction of its terms.
const DEGENERATE: f64 = 1e-9;

/// Rounding: Equations count as singular if their smallest singular value is below this fraction of
/// the largest singular value.
const DEPENDENT: f64 = 1e-9;

/// Computes a long cycle near the homoclinic orbit, for changed values of the two released
/// parameters. The amplitude of the cycle is `factor` times a fraction `part` of the size of the
/// equilibrium, or less if higher-order terms are large.
///
/// # Errors
/// [`Failure::Mismatch`] if the normal form is degenerate, or if the number of released parameters
/// is not two.
pub(super) fn beside(
    on: &DiscretisedProblem,
    point: &Solution,
    (released, [part, factor]): (&[usize], [f64; 2]),
) -> Result<Solution, Failure> {
    let &[one, other] = released else {
        return Err(refused("two parameters must be released"));
    };
    let rest = Rest::new(on, point)?;
    let takens = Takens::new(&rest, [one, other])?;
    let Takens { a, b, k, slope, curvature, .. } = takens;
    let nominal = (part * rest.size() * a.abs() / 6.0).sqrt().min(LARGEST * (a / b).abs());
    let epsilon = nominal * factor.sqrt();
    let beta = [-4.0 * epsilon.powi(4) / a, 10.0 / 7.0 * b / a * epsilon * epsilon];
    let first = beta[0] - 0.5 * beta[1] * beta[1] * curvature;
    let mut parameters = point.parameters.clone();
    for (i, p) in [one, other].into_iter().enumerate() {
        parameters[p] += beta[1] * k[i] + first * slope[i];
    }
    let period = 2.0 * HALF_TIME / epsilon;
    let units = rest.units();
    let state = on.sampled(&vec![period; on.layout.extras], |_, tau, x| {
        let time = (2.0 * tau - 1.0) * HALF_TIME;
        let square = time.cosh().powi(-2);
        let w = [2.0 - 6.0 * square, 12.0 * epsilon * square * time.tanh()];
        let w = w.map(|w| w * epsilon * epsilon / a);
        for (i, x) in x.iter_mut().enumerate() {
            *x = point.state[i] + units[i] * takens.deviation(i, w, beta);
        }
    });
    Ok(Solution {
        kind: Kind::EP,
        condition: None,
        method: on.method.to_string(),
        mesh: on.meshes.iter().flat_map(|mesh| mesh.points().iter().copied()).collect(),
        state,
        parameters,
        tangent: None,
        switch: None,
        ..point.clone()
    })
}

fn refused(reason: &str) -> Failure {
    Failure::Mismatch(format!(
        "no curve of homoclinic orbits starts at this Bogdanov–Takens point: \
                               {reason}"
    ))
}

fn singular() -> Failure {
    refused("the linearisation at the equilibrium has more than one null vector")
}

/// The right vectors `q₀, q₁` and left vectors `p₀, p₁` of a double zero eigenvalue.
struct Chain {
    q: [DVector<f64>; 2],
    p: [DVector<f64>; 2],
}

impl Chain {
    fn of(matrix: &DMatrix<f64>) -> Result<Self, Failure> {
        let decomposition = matrix.clone().svd(true, true);
        let (Some(u), Some(v)) = (&decomposition.u, &decomposition.v_t) else {
            return Err(singular());
        };
        let least = decomposition.singular_values.imin();
        let (right, left) = (v.row(least).transpose(), u.column(least).into_owned());
        let q1 = bordered(matrix, [&left, &right], &right)?;
        let p1 = &left / left.dot(&q1);
        let p0 = bordered(&matrix.transpose(), [&right, &left], &p1)?;
        let p0 = &p0 - &p1 * p0.dot(&q1);
        let p0 = &p0 / p0.dot(&right);
        Ok(Chain { q: [right, q1], p: [p0, p1] })
    }
}

/// Solves a linear system with a singular matrix that is bordered by one column and one row.
fn bordered(
    matrix: &DMatrix<f64>,
    [column, row]: [&DVector<f64>; 2],
    wanted: &DVector<f64>,
) -> Result<DVector<f64>, Failure> {
    let n = wanted.len();
    let mut all = matrix.clone().resize(n + 1, n + 1, 0.0);
    all.view_mut((0, n), (n, 1)).copy_from(column);
    all.view_mut((n, 0), (1, n)).copy_from(&row.transpose());
    let solved = all.lu().solve(&wanted.clone().push(0.0));
    solved.map(|it| it.rows(0, n).into_owned()).ok_or_else(singular)
}

/// An equilibrium with two released parameters; all states are in their units.
struct Unfolded<'r> {
    rest: &'r Rest<'r>,
    units: Vec<f64>,
    released: [usize; 2],
}

impl Unfolded<'_> {
    fn direction(&self, z: &DVector<f64>, k: [f64; 2]) -> Direction {
        Direction {
            states: z.iter().zip(&self.units).map(|(z, unit)| z * unit).collect(),
            parameters: self.released.into_iter().zip(k).collect(),
        }
    }

    fn image(&self, f: Vec<f64>) -> DVector<f64> {
        DVector::from_iterator(f.len(), f.iter().zip(&self.units).map(|(f, unit)| f / unit))
    }

    fn second(&self, a: &Direction, b: &Direction) -> DVector<f64> {
        self.image(self.rest.along(a, b))
    }
}

/// The normal form of the Bogdanov–Takens point, with its unfolding by two parameters.
struct Takens {
    q: [DVector<f64>; 2],
    a: f64,
    b: f64,
    h: DVector<f64>,
    k: [f64; 2],
    /// The change of the parameters that changes `β₁` by 1.
    slope: [f64; 2],
    /// The product of `p₁` with the second derivative of `F` along `(h, k)`.
    curvature: f64,
    second: Second,
}

/// The second-order terms of the center manifold, including the noncritical states that depend on the
/// critical states: `½ H₂₀ w₀² + H₁₁ w₀ w₁ + ½ H₀₂ w₁² + β₂ (G₀ w₀ + G₁ w₁) + β₁ e + ½ β₂² f`.
struct Second {
    h20: DVector<f64>,
    h11: DVector<f64>,
    h02: DVector<f64>,
    g: [DVector<f64>; 2],
    e: DVector<f64>,
    f: DVector<f64>,
}

impl Takens {
    fn new(rest: &Rest, released: [usize; 2]) -> Result<Takens, Failure> {
        let (n, matrix) = (rest.state.len(), rest.in_units());
        let Chain { q, p } = Chain::of(&matrix)?;
        let all = Unfolded { rest, units: rest.units(), released };
        let [d0, d1] = [&q[0], &q[1]].map(|q| all.direction(q, [0.0; 2]));
        let (of_q0, of_both) = (all.second(&d0, &d0), all.second(&d0, &d1));
        let a = 0.5 * p[1].dot(&of_q0);
        let b = p[0].dot(&of_q0) + p[1].dot(&of_both);
        if a.abs() <= DEGENERATE * p[1].norm() * of_q0.norm() {
            return Err(refused("its coefficient a vanishes"));
        }
        let slopes = released.map(|parameter| all.image(rest.by_parameter(parameter)));
        // The columns of the equations for (h, k).
        let mut equations = DMatrix::zeros(n + 2, n + 2);
        for j in 0..n + 2 {
            let unit = DVector::from_fn(n, |i, _| f64::from(u8::from(i == j)));
            let column = all.direction(&unit, [n, n + 1].map(|at| f64::from(u8::from(at == j))));
            let [on_q0, on_q1] = [all.second(&d0, &column), all.second(&d1, &column)];
            let image = match j.checked_sub(n) {
                None => matrix.column(j).into_owned(),
                Some(i) => slopes[i].clone(),
            };
            equations.view_mut((0, j), (n, 1)).copy_from(&image);
            equations[(n, j)] = p[1].dot(&on_q0);
            equations[(n + 1, j)] = p[0].dot(&on_q0) + p[1].dot(&on_q1);
        }
        let wanted = DVector::from_fn(n + 2, |i, _| f64::from(u8::from(i == n + 1)));
        let solved = well_posed(equations, &wanted).ok_or_else(dependent)?;
        let (h, k) = (solved.rows(0, n).into_owned(), [solved[n], solved[n + 1]]);
        let both = all.direction(&h, k);
        let curvature = p[1].dot(&all.second(&both, &both));
        let slope = steepest(&p[1], &slopes, released.map(|parameter| rest.parameter(parameter)))?;
        let solve = |wanted: DVector<f64>| bordered(&matrix, [&p[1], &q[0]], &wanted);
        let of_q1 = all.second(&d1, &d1);
        let h20 = solve(&q[1] * (2.0 * a) - &of_q0)?;
        let free = p[0].dot(&of_both) + 0.5 * p[1].dot(&of_q1) - p[0].dot(&h20);
        let h20 = h20 + &q[0] * free;
        let h11 = solve(&q[1] * b + &h20 - &of_both)?;
        let h02 = solve(&h11 * 2.0 - of_q1)?;
        let g0 = solve(-all.second(&d0, &both))?;
        let g1 = solve(&q[1] + &g0 - all.second(&d1, &both))?;
        // The change `β₁ − ½ β₂² curvature` moves the parameters along `slope`.
        let by_slope = &slopes[0] * slope[0] + &slopes[1] * slope[1];
        let e = solve(&q[1] - &by_slope)?;
        let f = solve(by_slope * curvature - all.second(&both, &both))?;
        let second = Second { h20, h11, h02, g: [g0, g1], e, f };
        Ok(Takens { q, a, b, h, k, slope, curvature, second })
    }

    /// Returns a component of the deviation from the equilibrium, in the unit of this component.
    fn deviation(&self, i: usize, [w0, w1]: [f64; 2], [beta1, beta2]: [f64; 2]) -> f64 {
        let Takens { q, h, second: Second { h20, h11, h02, g, e, f }, .. } = self;
        let first = beta2 * h[i] + w0 * q[0][i] + w1 * q[1][i];
        let squares = 0.5 * h20[i] * w0 * w0 + h11[i] * w0 * w1 + 0.5 * h02[i] * w1 * w1;
        let unfolded = beta2 * (g[0][i] * w0 + g[1][i] * w1);
        first + squares + unfolded + beta1 * e[i] + 0.5 * beta2 * beta2 * f[i]
    }
}

/// Solves a linear system; `None` if its matrix, with columns scaled to length 1, is singular up to
/// rounding errors.
fn well_posed(mut matrix: DMatrix<f64>, wanted: &DVector<f64>) -> Option<DVector<f64>> {
    let lengths: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
    for (mut column, length) in matrix.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let values = matrix.singular_values();
    let regular = values.min() > DEPENDENT * values.max();
    let solved = matrix.lu().solve(wanted).filter(|_| regular)?;
    Some(DVector::from_iterator(solved.len(), solved.iter().zip(lengths).map(|(x, l)| x / l)))
}

fn dependent() -> Failure {
    refused("the two released parameters do not unfold the Bogdanov–Takens point")
}

/// Returns the smallest change of parameters, with each parameter in units of its value, that
/// changes `β₁` by 1.
fn steepest(
    p1: &DVector<f64>,
    slopes: &[DVector<f64>; 2],
    values: [f64; 2],
) -> Result<[f64; 2], Failure> {
    let sizes = values.map(|value| if value == 0.0 { 1.0 } else { value.abs() });
    let of = |i: usize| p1.dot(&slopes[i]) * sizes[i];
    let square = of(0) * of(0) + of(1) * of(1);
    let most = (slopes[0].norm() * sizes[0]).max(slopes[1].norm() * sizes[1]);
    if square.sqrt() <= DEGENERATE * most * p1.norm() {
        return Err(dependent());
    }
    Ok([0, 1].map(|i| of(i) * sizes[i] / square))
}
