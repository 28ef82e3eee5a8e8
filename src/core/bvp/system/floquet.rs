//! Floquet multipliers of periodic solutions, and linearisations of period doublings and torus
//! points.
//!
//! Return conditions `y − Y = 0` equate the states `Y` at the end of a period to the states `y` at
//! the start of the next period. If the return conditions are replaced by `μ y − Y = 0`,
//!
//! ```text
//!     F_z + (μ − 1) E,    E = Σ e_condition e_yᵀ,
//! ```
//!
//! the linearisation is singular exactly if `μ` is a Floquet multiplier. (For the return conditions
//! `x(0) = x(1)` on a single segment, the increments of the extra unknowns, here the period, are
//! zero, and there are no integral and phase conditions.) The chains of intervals are condensed in
//! real arithmetic; only the small dense matrix that remains is complex for `μ = e^{iω}`.

use super::assembly::{AssembledJacobian, Bordered, Form};
use super::factorisation::{Condensation, form_of, singular_by_growth};
use super::layout::UnknownLayout;
use super::leading_multipliers::LeadingMultipliers;
use super::liouville::{Orbit, accuracy_of_multipliers, by_liouville};
use crate::core::bvp::terms::Return;
use crate::core::failure::Failure;
use crate::core::linalg::{
    Border, Chain, Condensed, CondensedLu, Factorisation, Spectrum, dot, largest, multipliers,
    refill, undetermined,
};
use std::sync::Arc;

/// The Floquet multipliers of periodic solutions.
pub(super) struct Floquet {
    condensed: CondensedLu<Condensation>,
    pencil: [Vec<f64>; 2],
    /// The value of the assembly counter for the assembly from which the pencil was computed; 0 if
    /// no pencil is stored.
    pencil_of: usize,
    /// The matrix of the return conditions, stored row by row, and the right-hand side of a linear
    /// system.
    returned: Vec<f64>,
    right: Vec<f64>,
    /// The largest multipliers of orbits with sparse matrices.
    leading: LeadingMultipliers,
}

impl Floquet {
    /// Creates scratch space for the Floquet multipliers of solutions with a given layout.
    pub fn new(layout: &Arc<UnknownLayout>) -> Self {
        Floquet {
            condensed: CondensedLu::new(Condensation::new(layout)),
            pencil: Default::default(),
            pencil_of: 0,
            returned: Vec::new(),
            right: Vec::new(),
            leading: LeadingMultipliers::default(),
        }
    }

    /// Computes all Floquet multipliers, the eigenvalues `μ` of `P v + μ Q v = 0`, in descending
    /// order of their size.
    pub fn all(&mut self, of: &Orbit) -> Result<Spectrum, Failure> {
        if !of.equations.layout.closes() {
            return self.returning_multipliers(of);
        }
        let (p, q) = self.reduced_pencil(of)?;
        multipliers(p, q, of.equations.layout.states)
    }

    /// Returns the matrices `P` and `Q` of the first segment's equations, condensed to the states
    /// at its ends.
    pub fn reduced_pencil(&mut self, of: &Orbit) -> Result<(&[f64], &[f64]), Failure> {
        let (layout, assembled): (&UnknownLayout, _) = (&of.equations.layout, of.assembled);
        if assembled.at.is_empty() {
            return Err(Failure::Mismatch(
                "Floquet multipliers cannot be computed before the linearisation at a point is \
                 assembled"
                    .into(),
            ));
        }
        if assembled.structure.sparse().is_some() {
            return Err(Failure::Unsupported(format!(
                "only the largest of {} Floquet multipliers are computed for an orbit with sparse \
                 matrices: select dense matrices by `Collocation::with_matrices`, or by `matrices: \
                 dense` in a scene",
                layout.states
            )));
        }
        if self.pencil_of != assembled.count {
            let (form, border) = (Form::Jacobian, Border::NONE);
            let condensation = &mut self.condensed.condensed;
            condensation.condense(Bordered { layout, assembled, form, border })?;
            condensation.pencil(assembled, &mut self.pencil);
            self.pencil_of = assembled.count;
        }
        let [p, q] = &self.pencil;
        Ok((p, q))
    }

    /// Stores the matrices `P` and `Q` of the pencil `P + μ Q` to which the linearisation is
    /// condensed.
    pub fn keep(&mut self, condensation: &Condensation, assembled: &AssembledJacobian) {
        if condensation.pencil(assembled, &mut self.pencil) {
            self.pencil_of = assembled.count;
        }
    }

    /// Computes the Floquet multipliers that decide stability, which are all multipliers except the
    /// trivial multiplier of an autonomous orbit. The pencil is deflated by the known vector of the
    /// trivial multiplier, which is the vector field `f(x(0))`: near a fold or a branch point, the
    /// trivial multiplier could not be distinguished from another multiplier that passes 1. With sparse
    /// matrices, only the multipliers outside the unit circle and the `least` largest others are
    /// computed.
    pub fn deciding(&mut self, of: &mut Orbit, least: usize) -> Result<Spectrum, Failure> {
        if let (Some(sparse), false) = (of.assembled.structure.sparse(), of.assembled.at.is_empty())
        {
            return self.leading.deciding(of, sparse, least);
        }
        let found = self.nontrivial_multipliers(of);
        if !of.equations.layout.closes() || of.assembled.at.is_empty() {
            return found;
        }
        by_liouville(found, of)
    }

    fn nontrivial_multipliers(&mut self, of: &mut Orbit) -> Result<Spectrum, Failure> {
        let n = of.equations.layout.states;
        if !of.equations.layout.closes() {
            return self.returning_multipliers(of);
        }
        if !of.equations.layout.phase || of.assembled.at.is_empty() {
            return self.all(of);
        }
        let least = accuracy_of_multipliers(of);
        if let Some(found) = fast_multipliers(of, least)? {
            return Ok(found);
        }
        // At a Hopf point the motion at the start vanishes; the reference contains the motion of the
        // emanating orbits.
        let reference = of.phase.motion.clone();
        let mut motions = [of.motion_at(0), reference];
        let mut units = of.assembled.units.clone();
        units.resize(n.max(units.len()), 1.0);
        for motion in &mut motions {
            motion.iter_mut().zip(&units).for_each(|(m, unit)| *m /= unit);
        }
        let (p, q) = self.reduced_pencil(of)?;
        let (p, q) = in_units(p, q, &units[..n])?;
        for motion in &motions {
            if let Some((p, q)) = deflated(&p, &q, motion, least)? {
                return multipliers(&p, &q, n - 1);
            }
        }
        let mut found = multipliers(&p, &q, n)?;
        let distance = |mu: &(f64, f64)| (mu.0 - 1.0).hypot(mu.1);
        let nearer = |&a: &usize, &b: &usize| distance(&found[a]).total_cmp(&distance(&found[b]));
        if let Some(nearest) = (0..found.len()).min_by(nearer) {
            found.remove(nearest);
        }
        Ok(found)
    }

    /// Computes all Floquet multipliers for return conditions of any kind. With the square matrix
    /// `Q = E (F_z + (μ₀ − 1) E)⁻¹ Eᵀ` of the return conditions, the multipliers are the
    /// eigenvalues of `(I − μ₀ Q) v + μ Q v = 0`: infinite multipliers, as at a limit of admissible
    /// solutions, correspond to null vectors of `Q`, and the entries of `Q` remain bounded.
    fn returning_multipliers(&mut self, of: &Orbit) -> Result<Spectrum, Failure> {
        let k = of.equations.layout.returns.len();
        let mut best = f64::INFINITY;
        let mut singular = None;
        for mu in TRIAL_MULTIPLIERS {
            let size = match self.return_matrix(of, mu) {
                Ok(size) => size,
                Err(cause) => {
                    singular = Some(cause);
                    continue;
                }
            };
            if size < best {
                best = size;
                let identity = |i: usize| if i / k == i % k { 1.0 } else { 0.0 };
                let [p, q] = &mut self.pencil;
                self.pencil_of = 0;
                refill(p, self.returned.iter().enumerate().map(|(i, q)| identity(i) - mu * q));
                q.clone_from(&self.returned);
            }
            if best < MODERATE {
                break;
            }
        }
        if let Some(cause) = singular.filter(|_| best.is_infinite()) {
            return Err(singular_by_growth(of.assembled.growth(of.equations), cause));
        }
        // If motion continues through an event of zero speed as if there were no event, every μ
        // solves the equations.
        if best > SINGULAR {
            return Err(undetermined());
        }
        let [p, q] = &self.pencil;
        multipliers(p, q, k)
    }

    /// Computes the matrix `Q` for a trial multiplier `μ₀`, and its largest entry.
    fn return_matrix(&mut self, of: &Orbit, mu: f64) -> Result<f64, Failure> {
        let Self { condensed, returned, right, .. } = self;
        let (layout, assembled): (&UnknownLayout, _) = (&of.equations.layout, of.assembled);
        let matrix = Bordered { layout, assembled, form: form_of(layout), border: Border::NONE };
        condensed.factor(matrix, mu, &assembled.units)?;
        let (k, units) = (layout.returns.len(), &assembled.units);
        let unit = |r: &Return| units.get(layout.place(r).1).copied().unwrap_or(1.0);
        returned.clear();
        returned.resize(k * k, 0.0);
        for (column, r) in layout.returns.iter().enumerate() {
            right.clear();
            right.resize(layout.dimension, 0.0);
            right[layout.conditions() + r.condition] = unit(r);
            condensed.solve(right);
            for (row, r) in layout.returns.iter().enumerate() {
                returned[row * k + column] = right[layout.position(r.unknown)] / unit(r);
            }
        }
        Ok(returned.iter().fold(0.0, |size: f64, q| size.max(q.abs())))
    }
}

/// Computes the nontrivial Floquet multipliers of an autonomous orbit whose start is slow, by
/// starting the orbit at its fastest point instead. Near a saddle, the vector field (the vector of
/// the trivial multiplier) is inaccurate, and its errors would dominate small multipliers. Returns
/// `None` if the speed at the start of the orbit is large enough.
fn fast_multipliers(of: &Orbit, least: f64) -> Result<Option<Spectrum>, Failure> {
    let (layout, assembled) = (&of.equations.layout, of.assembled);
    let (s, m) = (&layout.segments[0], layout.degree);
    let at = |state: usize, node: usize| assembled.at[s.values + state * s.nodes + node];
    let size =
        |state: usize| (0..s.nodes).fold(f64::MIN_POSITIVE, |most, k| most.max(at(state, k).abs()));
    let sizes: Vec<f64> = (0..s.states).map(size).collect();
    let speed = |motion: &[f64]| {
        motion.iter().zip(&sizes).map(|(f, size)| (f / size).powi(2)).sum::<f64>().sqrt()
    };
    let speeds: Vec<f64> = (0..s.intervals).map(|j| speed(&of.motion_at(j * m))).collect();
    let by_speed = |a: &usize, b: &usize| speeds[*a].total_cmp(&speeds[*b]);
    let fastest = (0..s.intervals).max_by(by_speed).unwrap_or(0);
    if speeds[0] >= SLOW * speeds[fastest] {
        return Ok(None);
    }
    let (n, motion) = (s.states, of.motion_at(fastest * m));
    let length = m * n * (m + 1) * n;
    let mut blocks = assembled.blocks[0].clone();
    blocks.rotate_left(fastest * length);
    let mut chain = Chain::new(s.intervals, m, n);
    chain.factor(&blocks, &[], 0, &[], 0)?;
    let halves = |half: usize| -> Vec<f64> {
        chain.reduced().chunks_exact(2 * n).flat_map(|row| &row[half * n..][..n]).copied().collect()
    };
    let (p, q) = in_units(&halves(0), &halves(1), &sizes)?;
    let motion: Vec<f64> = motion.iter().zip(&sizes).map(|(f, size)| f / size).collect();
    let reduced = deflated(&p, &q, &motion, least)?;
    reduced.map(|(p, q)| multipliers(&p, &q, n - 1)).transpose()
}

/// Heuristic: if the speed at the start is smaller than this fraction of the largest speed on the
/// orbit, the vector field at the start counts as too inaccurate to be the vector of the trivial
/// multiplier.
const SLOW: f64 = 0.1;

/// Heuristic: the trial multipliers; the algorithm uses the first trial multiplier that is far
/// enough from all Floquet multipliers.
const TRIAL_MULTIPLIERS: [f64; 4] = [-0.4, 0.6, -2.3, 3.1];

/// Heuristic: a trial multiplier counts as far enough from all Floquet multipliers if no entry of
/// `Q` exceeds this bound.
const MODERATE: f64 = 1e3;

/// Rounding: if an entry of `Q` exceeds this bound for all trial multipliers, the equations count
/// as singular for every multiplier, and no multiplier is determined.
const SINGULAR: f64 = 1e12;

/// Discretisation: a vector counts as an eigenvector of the multiplier 1 if it satisfies the
/// equation of eigenvectors to this relative accuracy; mesh errors are smaller wherever multipliers
/// are determined.
const TRIVIAL: f64 = 1e-3;

/// The matrices `P` and `Q` of a pencil.
type Pencil = (Vec<f64>, Vec<f64>);

/// Returns the pencil `P + μ Q` with unknowns in the given units, and with each row scaled so that
/// its largest entry is 1.
fn in_units(p: &[f64], q: &[f64], units: &[f64]) -> Result<Pencil, Failure> {
    let times = |a: &[f64]| -> Vec<f64> {
        a.iter().zip(units.iter().cycle()).map(|(a, u)| a * u).collect()
    };
    let (mut p, mut q, n) = (times(p), times(q), units.len());
    for (p, q) in p.chunks_exact_mut(n).zip(q.chunks_exact_mut(n)) {
        let largest = p.iter().chain(&*q).fold(0.0, |most: f64, a| most.max(a.abs()));
        if largest == 0.0 {
            return Err(undetermined());
        }
        p.iter_mut().chain(q).for_each(|a| *a /= largest);
    }
    Ok((p, q))
}

/// Returns the pencil `P + μ Q` after deflation of its eigenvalue 1 with the eigenvector `v`: in
/// orthonormal bases that begin with `v` and with `Q v = −P v`, the pencil is block triangular.
/// Returns `None` if `v` is not an eigenvector of the eigenvalue 1.
///
/// # Errors
/// [`Failure::Undetermined`] if a row of the deflated pencil is smaller than `least_row`, relative
/// to all rows.
fn deflated(p: &[f64], q: &[f64], v: &[f64], least_row: f64) -> Result<Option<Pencil>, Failure> {
    let n = v.len();
    let times =
        |a: &[f64]| -> Vec<f64> { a.chunks_exact(n.max(1)).map(|row| dot(row, v)).collect() };
    let (pv, qv) = (times(p), times(q));
    let left: Vec<f64> = pv.iter().zip(&qv).map(|(p, q)| p + q).collect();
    let trivial = dot(&left, &left) <= TRIVIAL * TRIVIAL * dot(&qv, &qv);
    if !(trivial && dot(v, v) > 0.0 && dot(&qv, &qv) > 0.0) {
        return Ok(None);
    }
    let (from, to) = (reflector(v), reflector(&qv));
    let block = |a: &[f64]| -> Vec<f64> {
        let mut a = a.to_vec();
        a.chunks_exact_mut(n).for_each(|row| reflect(&from, row));
        let columns: Vec<Vec<f64>> = (1..n)
            .map(|j| {
                let mut column: Vec<f64> = (0..n).map(|i| a[i * n + j]).collect();
                reflect(&to, &mut column);
                column
            })
            .collect();
        (1..n).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
    };
    let (reduced_p, reduced_q) = (block(p), block(q));
    // Each row is compared with the rows from which it was computed: near a homoclinic orbit some
    // rows vanish up to rounding errors.
    let rest = n - 1;
    let least = (0..rest)
        .map(|i| {
            let row = |a: &[f64]| largest(&a[i * rest..(i + 1) * rest]);
            row(&reduced_p).max(row(&reduced_q))
        })
        .fold(f64::INFINITY, f64::min);
    if least <= least_row * largest(p).max(largest(q)) {
        return Err(undetermined());
    }
    Ok(Some((reduced_p, reduced_q)))
}

/// Returns the vector `w` of the Householder reflection `I − 2 w wᵀ/wᵀw` that maps `v` to the first
/// axis.
fn reflector(v: &[f64]) -> Vec<f64> {
    let size = dot(v, v).sqrt();
    let mut w: Vec<f64> = v.iter().map(|v| v / size).collect();
    w[0] += 1.0_f64.copysign(w[0]);
    w
}

fn reflect(w: &[f64], x: &mut [f64]) {
    let share = 2.0 * dot(w, x) / dot(w, w);
    x.iter_mut().zip(w).for_each(|(x, w)| *x -= share * w);
}
