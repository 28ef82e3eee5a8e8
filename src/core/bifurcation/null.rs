//! Null vectors by bordering: null vectors of `F_z` near a fold, and of `[F_z  F_p]` near a branch
//! point.

use crate::core::failure::Failure;
use crate::core::linalg::{
    Border, Factors, Form, clear_rounding, dot, generic, largest, normalise, orthogonalise,
};
use crate::core::system::System;
use std::mem::discriminant;

/// The null vectors of a system's Jacobian at one point, with one entry for each requested form of
/// the matrix, such as `F_z` with antiperiodic boundary conditions, or `[F_z  F_p]`. All defining
/// systems and test functions at a point share these null vectors, so each form costs one
/// factorisation per point.
#[derive(Default)]
pub struct NullSpace {
    entries: Vec<NullVectors>,
    /// The sizes of the components of `x`, used as units: null vectors are orthonormal in these
    /// units. An unknown size is 0; if the list is empty, all units are 1.
    units: Vec<f64>,
}

impl NullSpace {
    /// Returns the null vectors of `F_z` in the given form, or of `[F_z  F_p]` for the parameter
    /// `p` with the index `parameter`, near a point where the rank of the matrix falls by one. The
    /// first call at a point factors the bordered matrix; later calls with the same `x` return the
    /// stored null vectors.
    ///
    /// # Errors
    /// [`Failure`] if the matrix cannot be evaluated, or if the bordered matrix is singular.
    pub fn of(
        &mut self,
        system: &mut dyn System,
        x: &[f64],
        form: Form,
        parameter: Option<usize>,
    ) -> Result<&mut NullVectors, Failure> {
        let place = self.entry(form, parameter);
        let (entry, units) = (&mut self.entries[place], &self.units);
        let known = entry.at == x && entry.form == form;
        entry.form = form;
        if entry.borders.is_empty() {
            entry.start(system, x, (1, units))?;
        }
        if !known {
            entry.update(system, x)?;
        }
        Ok(entry)
    }

    /// Returns the sizes of the first `n` components of `x`; empty if the sizes are unknown.
    pub(crate) fn sizes(&self, n: usize) -> &[f64] {
        &self.units[..n.min(self.units.len())]
    }

    /// Returns the sizes of the components of `x`, which are the units in which null vectors are
    /// orthonormal; an unknown size is 0.
    pub(crate) fn units(&mut self) -> &mut Vec<f64> {
        &mut self.units
    }

    /// Chooses new borders for the matrix `F_z` or `[F_z  F_p]` in the given form, close to the
    /// null vectors of this matrix at a point.
    ///
    /// # Errors
    /// The same errors as for [`of`](NullSpace::of).
    pub fn start(
        &mut self,
        system: &mut dyn System,
        x: &[f64],
        form: Form,
        parameter: Option<usize>,
    ) -> Result<(), Failure> {
        let place = self.entry(form, parameter);
        let (entry, units) = (&mut self.entries[place], &self.units);
        entry.form = form;
        entry.start(system, x, (1, units))
    }

    /// Returns the stored null vectors of the matrix `F_z` or `[F_z  F_p]` in the given form, which
    /// may belong to another point.
    pub(super) fn known(&self, form: Form, parameter: Option<usize>) -> Option<&NullVectors> {
        let mut started = self.entries.iter().filter(|entry| !entry.borders.is_empty());
        started.find(|entry| entry.is_of(form, parameter))
    }

    /// Turns all borders towards the current null vectors, so that the bordered matrices stay well
    /// conditioned along a curve.
    pub(crate) fn adapt(&mut self) {
        let NullSpace { entries, units } = self;
        entries.iter_mut().for_each(|entry| entry.adapt(units));
    }

    /// Invalidates the stored null vectors after a change of the system.
    pub(crate) fn forget(&mut self) {
        self.entries.iter_mut().for_each(|entry| entry.at.clear());
    }

    /// Returns the index of the entry that stores the null vectors of the given form of the matrix;
    /// the entry is created if it does not exist.
    fn entry(&mut self, form: Form, parameter: Option<usize>) -> usize {
        let known = self.entries.iter().position(|entry| entry.is_of(form, parameter));
        known.unwrap_or_else(|| {
            self.entries.push(NullVectors::new(form, parameter));
            self.entries.len() - 1
        })
    }
}

/// The right and left null vectors of a matrix `J` near a point where its rank falls by `m`,
/// computed from a bordered matrix of size `N` that is regular near that point:
///
/// ```text
///     M = ⎡ J  B ⎤        M ⎡ ζᵢ ⎤ = eₙ₊ᵢ,       Mᵀ ⎡ wⱼ ⎤ = e_(N−m+j)
///         ⎣ C  0 ⎦          ⎣ hᵢ ⎦                  ⎣ ·  ⎦
/// ```
///
/// `J` is `F_z` (possibly with antiperiodic boundary conditions), with `m` right null vectors, or
/// `[F_z  F_p]` with a parameter `p`, with `m + 1` right null vectors. For `m = 1`, the last
/// components `gᵢ = −wᵀ J ζᵢ` of the vectors `hᵢ` vanish exactly where the rank of `J` falls. For a
/// complex form of the matrix ([`Form::Oscillation`]), each vector is stored as its real part
/// followed by its imaginary part.
#[derive(Default)]
pub struct NullVectors {
    /// The right null vectors as directions of `x`: all parameter components except the component
    /// of `p` are zero. A complex vector is stored as its real part followed by its imaginary part.
    pub right: Vec<Vec<f64>>,
    /// The left null vectors.
    pub left: Vec<Vec<f64>>,
    /// The multipliers `gᵢ`.
    pub g: Vec<f64>,
    /// The form of the linearisation whose null vectors are stored.
    form: Form,
    /// The factors of the bordered matrix `M`.
    pub factors: Factors,
    /// The columns of the border `B`.
    borders: Vec<Vec<f64>>,
    /// The index of the parameter `p` among all parameters.
    parameter: Option<usize>,
    /// The point `x` at which the null vectors were computed; empty before the first computation.
    at: Vec<f64>,
    /// The rows of the border `C`, with one column for each unknown and for `p`.
    rows: Vec<Vec<f64>>,
    /// The unit direction of the parameter `p`.
    direction: Vec<f64>,
    /// The sizes of the equations: the change of each equation's left side when all unknowns change
    /// by their sizes.
    terms: Vec<f64>,
    /// The sizes of the unknowns; empty if the sizes are unknown.
    sizes: Vec<f64>,
    /// The columns of the border of `F_z`, one after another.
    columns: Vec<f64>,
    border_rows: Vec<f64>,
    corner: Vec<f64>,
    work: Vec<f64>,
}

/// Orthonormalises vectors.
fn orthonormal(vectors: &mut [Vec<f64>]) {
    for k in 0..vectors.len() {
        let (before, rest) = vectors.split_at_mut(k);
        orthogonalise(&mut rest[0], before, dot);
        normalise(&mut rest[0]);
    }
}

/// Divides the components of a row by the sizes of the unknowns (for complex rows, in both the real
/// and the imaginary part), and the last component by the size of the parameter `p`.
fn divide(row: &mut [f64], units: &[f64], (n, parameter): (usize, Option<usize>)) {
    let unit = |k: usize| units.get(k).copied().filter(|unit| *unit > 0.0).unwrap_or(1.0);
    let end = row.len() - usize::from(parameter.is_some());
    for part in row[..end].chunks_mut(n.max(1)) {
        part.iter_mut().enumerate().for_each(|(k, r)| *r /= unit(k));
    }
    if let Some(p) = parameter {
        row[end] /= unit(n + p);
    }
}

/// Computes the sizes of the equations: the change of each equation's left side when all its
/// arguments change by their sizes, multiplied by factors that avoid cancellation; all sizes are 1
/// if the sizes of the arguments are unknown. The changes of the left sides are computed for finite
/// changes of the arguments because first derivatives may vanish, as at a pitchfork. The left sides
/// of collocation equations already have the units of the states.
fn equation_sizes(system: &mut dyn System, x: &[f64], units: &[f64]) -> Result<Vec<f64>, Failure> {
    let n = system.names().dimension();
    if units.is_empty() || system.representation().interpolated {
        return Ok(vec![1.0; n]);
    }
    let mut direction = generic(x.len(), 3);
    direction.iter_mut().zip(units).for_each(|(d, unit)| *d *= unit);
    let (mut terms, mut second) = (vec![0.0; n], vec![0.0; n]);
    system.derivative(x, &[&direction], &mut terms)?;
    system.derivative(x, &[&direction, &direction], &mut second)?;
    terms.iter_mut().zip(second).for_each(|(term, more)| *term = term.abs() + more.abs());
    let most = Some(largest(&terms)).filter(|most| *most > 0.0).unwrap_or(1.0);
    let size = |term: f64| if term == 0.0 { most } else { term };
    terms.iter_mut().for_each(|term| *term = size(*term));
    Ok(terms)
}

/// Rounding: the product of the left null vector with a vector of equations is zero up to rounding
/// if it is smaller than this fraction of its terms.
const ORTHOGONAL: f64 = 1e-7;
/// Discretisation: the fraction [`ORTHOGONAL`] for solutions on a mesh, whose symmetries the mesh
/// may break.
const ORTHOGONAL_ON_MESH: f64 = 1e-3;

/// Heuristic: borders count as nearly orthogonal to the null vectors if the product of their norms
/// exceeds their inner product by this factor.
const CANCELLED: f64 = 1e4;

impl NullVectors {
    /// Creates the storage for null vectors of the matrix `F_z` in a given form, or of `[F_z  F_p]`
    /// if a parameter is given.
    pub(super) fn new(form: Form, parameter: Option<usize>) -> Self {
        NullVectors { form, parameter, ..NullVectors::default() }
    }

    fn is_of(&self, form: Form, parameter: Option<usize>) -> bool {
        discriminant(&self.form) == discriminant(&form) && self.parameter == parameter
    }

    /// Chooses borders close to the null vectors of the matrix at a point where its rank falls by
    /// `m`; the sizes of the unknowns are given.
    pub(super) fn start(
        &mut self,
        system: &mut dyn System,
        x: &[f64],
        (m, units): (usize, &[f64]),
    ) -> Result<(), Failure> {
        let (n, length) = (system.names().dimension(), x.len());
        let of_p = usize::from(self.parameter.is_some());
        let (width, parts) = (m + of_p, self.parts());
        let former = (std::mem::take(&mut self.borders), std::mem::take(&mut self.rows));
        self.borders = (0..m).map(|k| generic(parts * n, 1 + 10 * k)).collect();
        self.rows = (0..width).map(|k| generic(parts * n + of_p, 2 + k)).collect();
        self.right = vec![vec![0.0; length]; parts * width];
        self.left = vec![vec![0.0; parts * n]; m];
        self.g = vec![0.0; parts * width];
        self.direction = vec![0.0; length];
        if let Some(p) = self.parameter {
            self.direction[n + p] = 1.0;
        }
        self.columns = vec![0.0; parts * n * width];
        self.border_rows = vec![0.0; parts * n * width];
        self.corner = vec![0.0; width * width];
        self.work = vec![0.0; parts * (n + width)];
        self.terms = equation_sizes(system, x, units)?;
        self.sizes = units[..n.min(units.len())].to_vec();
        for border in &mut self.borders {
            border.iter_mut().zip(self.terms.iter().cycle()).for_each(|(b, term)| *b *= term);
        }
        for row in &mut self.rows {
            divide(row, units, (n, self.parameter));
        }
        self.linearise(system, x)?;
        for _ in 0..3 {
            self.solve(system)?;
            self.adapt(units);
        }
        self.orient(&former);
        Ok(())
    }

    /// Gives the new borders of a real form of the matrix the same signs as the earlier borders, so
    /// that functions of the null vectors keep their signs along a curve.
    fn orient(&mut self, (borders, rows): &(Vec<Vec<f64>>, Vec<Vec<f64>>)) {
        if self.parts() > 1 {
            return;
        }
        for (new, old) in self.borders.iter_mut().zip(borders).chain(self.rows.iter_mut().zip(rows))
        {
            if new.len() == old.len() && dot(new, old) < 0.0 {
                new.iter_mut().for_each(|entry| *entry = -*entry);
            }
        }
    }

    /// In a null direction of `[F_z  F_p]`, sets to zero the components that consist only of
    /// rounding errors. Directions of solutions on a mesh are left unchanged, because special
    /// points on a mesh have a discretisation error.
    pub(super) fn clear_rounding(
        &mut self,
        system: &mut dyn System,
        x: &[f64],
        direction: &mut [f64],
    ) -> Result<(), Failure> {
        let n = system.names().dimension();
        let Some(p) = self.parameter.map(|p| n + p) else { return Ok(()) };
        if system.representation().is_on_mesh() {
            return Ok(());
        }
        let (length, mut at) = (self.work.len(), x.to_vec());
        let mut argument = vec![0.0; x.len()];
        let mut both = vec![0.0; 2 * length];
        for (part, of) in both.chunks_exact_mut(length).zip([x, &*direction]) {
            part[..n].copy_from_slice(&of[..n]);
            part[n] = of[p];
        }
        // Results computed from rounding errors are rounding errors, too.
        let residual = |v: &[f64], out: &mut [f64]| {
            let (point, along) = v.split_at(length);
            at[..n].copy_from_slice(&point[..n]);
            argument[..n].copy_from_slice(&along[..n]);
            (at[p], argument[p]) = (point[n], along[n]);
            out.fill(0.0);
            system.residual(&at, &mut out[..n])?;
            system.derivative(&at, &[&argument], &mut out[length..][..n])
        };
        let solve =
            |right: &mut [f64]| right.chunks_mut(length).for_each(|r| self.factors.solve(r));
        clear_rounding(&mut both, &[], residual, solve)?;
        direction[..n].copy_from_slice(&both[length..][..n]);
        direction[p] = both[length + n];
        Ok(())
    }

    /// Whether the borders are close to the null vectors: in the sums `C ζ = 1` and `wᵀ B = 1`, the
    /// vectors are not nearly orthogonal, in units of the sizes of the unknowns and equations.
    pub(super) fn is_well_bordered(&self) -> bool {
        let (of_p, n) = (self.rows.len() - self.borders.len(), self.terms.len());
        let mut rows = self.rows.iter().skip(of_p).zip(self.right.iter().skip(of_p));
        let mut borders = self.borders.iter().zip(&self.left);
        let unit = |k: usize| self.sizes.get(k).copied().filter(|unit| *unit > 0.0).unwrap_or(1.0);
        let is_well = |v: &[f64], null: &[f64], unit: &dyn Fn(usize) -> f64| {
            let parts = v.iter().zip(null).take(n).enumerate();
            let [v, null] = parts.fold([0.0_f64; 2], |[v, null], (k, (a, b))| {
                [v.hypot(a * unit(k)), null.hypot(b / unit(k))]
            });
            v * null <= CANCELLED
        };
        rows.all(|(row, right)| is_well(row, right, &unit))
            && borders.all(|(border, left)| is_well(border, left, &|k| self.terms[k].recip()))
    }

    /// The column by which the matrix is bordered.
    pub(crate) fn border(&self) -> &[f64] {
        &self.borders[0]
    }

    /// Whether the branch point breaks up if a parameter changes: whether the product `w F_p` of the
    /// left null vector and the derivative with respect to the parameter differs from zero by more
    /// than its error. The derivative is given in `slope`, and its change due to the errors of the
    /// unknowns in `change`. On a mesh, which may break a symmetry, a small part of the terms of the
    /// product counts as zero.
    pub(crate) fn breaks_up(&self, slope: &[f64], change: &[f64], on_mesh: bool) -> bool {
        let [along, terms, _] = self.along_left(slope);
        let [_, error, _] = self.along_left(change);
        let fraction = if on_mesh { ORTHOGONAL_ON_MESH } else { ORTHOGONAL };
        along.abs() > fraction * terms && along.abs() > error
    }

    /// Returns the product of the left null vector with a vector of equations, the sum of the moduli of
    /// its terms, and the product of the norms of both vectors in units of the sizes of the equations.
    pub(in crate::core::bifurcation) fn along_left(&self, right: &[f64]) -> [f64; 3] {
        let mut sums = [0.0; 4];
        for ((w, f), term) in self.left[0].iter().zip(right).zip(&self.terms) {
            let parts = [w * f, (w * f).abs(), (w * term).powi(2), (f / term).powi(2)];
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        }
        let [along, terms, left, right] = sums;
        [along, terms, (left * right).sqrt()]
    }

    /// The number of real numbers per component: 2 for a complex form, 1 for a real form.
    fn parts(&self) -> usize {
        if matches!(self.form, Form::Oscillation(_)) { 2 } else { 1 }
    }

    /// Computes the null vectors of the matrix at a point `x`.
    fn update(&mut self, system: &mut dyn System, x: &[f64]) -> Result<(), Failure> {
        self.at.clear();
        self.linearise(system, x)?;
        self.solve(system)?;
        self.at.extend(x);
        Ok(())
    }

    /// Evaluates `F_z` and, if a parameter `p` is included, `F_p`.
    fn linearise(&mut self, system: &mut dyn System, x: &[f64]) -> Result<(), Failure> {
        system.assemble(x)?;
        if self.parameter.is_some() {
            let n = system.names().dimension();
            system.derivative(x, &[&self.direction], &mut self.columns[..n])?;
        }
        Ok(())
    }

    /// Computes the null vectors of the matrix from the bordered matrix with the current borders.
    fn solve(&mut self, system: &mut dyn System) -> Result<(), Failure> {
        let (n, width, parts) = (system.names().dimension(), self.rows.len(), self.parts());
        let (of_p, length) = (width - self.borders.len(), parts * n);
        for (k, border) in self.borders.iter().enumerate() {
            self.columns[(of_p + k) * length..][..length].copy_from_slice(border);
        }
        for (k, row) in self.rows.iter().enumerate() {
            self.border_rows[k * length..][..length].copy_from_slice(&row[..length]);
            self.corner[k * width..][..of_p].copy_from_slice(&row[length..]);
        }
        let (columns, rows, corner) = (&self.columns, &self.border_rows, &self.corner);
        let units = &self.sizes[..];
        let border = Border { width, columns, rows, corner, units };
        system.factor(self.form, border, &mut self.factors)?;
        for i in 0..width {
            self.work.fill(0.0);
            self.work[n + i] = 1.0;
            self.factors.solve(&mut self.work);
            let solved = self.work.chunks_exact(n + width).zip(&mut self.right[i * parts..]);
            for ((part, right), g) in solved.zip(&mut self.g[i * parts..]) {
                right[..n].copy_from_slice(&part[..n]);
                if let Some(p) = self.parameter {
                    right[n + p] = part[n];
                }
                *g = part[n + width - 1];
            }
        }
        for (j, left) in self.left.iter_mut().enumerate() {
            self.work.fill(0.0);
            self.work[n + of_p + j] = 1.0;
            self.factors.solve_transposed(&mut self.work);
            let solved = self.work.chunks_exact(n + width).zip(left.chunks_exact_mut(n));
            solved.for_each(|(part, left)| left.copy_from_slice(&part[..n]));
        }
        Ok(())
    }

    /// Sets the borders to the current null vectors, orthonormalised in units of the sizes of the
    /// equations and unknowns.
    fn adapt(&mut self, units: &[f64]) {
        self.at.clear();
        let times_terms = |border: &mut Vec<f64>, terms: &[f64]| {
            border.iter_mut().zip(terms.iter().cycle()).for_each(|(b, term)| *b *= term);
        };
        for (border, left) in self.borders.iter_mut().zip(&self.left) {
            border.copy_from_slice(left);
            times_terms(border, &self.terms);
        }
        let (parts, n) = (self.parts(), self.work.len() / self.parts() - self.rows.len());
        for (row, right) in self.rows.iter_mut().zip(self.right.chunks_exact(parts)) {
            for (row, right) in row.chunks_exact_mut(n).zip(right) {
                row.copy_from_slice(&right[..n]);
            }
            if let Some(p) = self.parameter {
                row[parts * n] = right[0][n + p];
            }
            divide(row, units, (n, self.parameter));
        }
        orthonormal(&mut self.borders);
        // Without orthonormal rows the border might become singular.
        orthonormal(&mut self.rows);
        self.borders.iter_mut().for_each(|border| times_terms(border, &self.terms));
        self.rows.iter_mut().for_each(|row| divide(row, units, (n, self.parameter)));
    }
}
