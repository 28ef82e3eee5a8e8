//! The derivatives of a zero problem `F = 0` at a point as multilinear forms, the null vectors of
//! its linearisations, and the solution of linear systems with these linearisations.

use crate::core::bifurcation::at::At;
use crate::core::bifurcation::hopf::motions;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, generic};
use crate::core::scalar::Space;
use crate::core::system::Deviation;
use faer::c64;
use std::borrow::Cow;

/// The inner product `⟨p, q⟩ = p* q` of complex vectors.
pub(super) fn inner(p: &[c64], q: &[c64]) -> c64 {
    p.iter().zip(q).map(|(p, q)| p.conj() * q).sum()
}

/// The component of a complex vector with the largest modulus.
pub(super) fn leading(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most: f64, c| if c.abs() > most.abs() { *c } else { most })
}

/// A critical direction of a linearisation, given by its right and its left null vector.
pub(super) struct Critical<V> {
    /// The right null vector `q`; a real `q` is stored as a direction of `x = (z, p)`.
    pub right: V,
    /// `p`.
    pub left: V,
    /// The number `N = p* L'(σ₀) q`; 0 if the critical eigenvalue is a double eigenvalue.
    pub growth: f64,
}

/// Rounding: if the product `p* L'(σ₀) q` of the null vectors is smaller than this fraction of the
/// product of their sizes, the critical eigenvalue is a double eigenvalue with one eigenvector, as in a
/// conservative system, and the product counts as zero.
const DOUBLE: f64 = 1e-10;

/// The multilinear forms of `F` at a point, and the solution of linear systems with the
/// linearisations of `F`.
pub(super) struct Forms<'f, 'a> {
    pub at: &'f mut At<'a>,
    /// The number of unknowns `z`.
    pub n: usize,
    room: Vec<f64>,
}

impl<'f, 'a> Forms<'f, 'a> {
    pub fn new(at: &'f mut At<'a>) -> Self {
        let n = at.system.names().dimension();
        Forms { at, n, room: vec![0.0; n] }
    }

    /// Computes the null vectors of a real form of the linearisation.
    pub fn real(&mut self, form: Form) -> Result<Critical<Vec<f64>>, Failure> {
        let At { system, x, null, .. } = &mut *self.at;
        // The borders may come from another special point, whose null vectors are orthogonal.
        if !null.of(&mut **system, x, form, None).is_ok_and(|it| it.is_well_bordered()) {
            null.start(&mut **system, x, form, None)?;
        }
        let null = null.of(&mut **system, x, form, None)?;
        let (right, left) = (null.right[0].clone(), null.left[0].clone());
        null.factors.growth_derivative(&right[..self.n], &mut self.room);
        let [growth, _, size] = null.along_left(&self.room);
        let growth = if growth.abs() > DOUBLE * size { growth } else { 0.0 };
        Ok(Critical { right, left, growth })
    }

    /// Computes the null vectors `q` and `p` of the linearisation with the critical exponent `iω`,
    /// with `p* L'(iω) q = −1`.
    pub fn complex(&mut self, omega: f64) -> Result<[Vec<c64>; 2], Failure> {
        let n = self.n;
        let At { system, x, null, .. } = &mut *self.at;
        let null = null.of(&mut **system, x, Form::Oscillation(omega), None)?;
        let parts = |a: &[f64], b: &[f64]| -> Vec<c64> {
            a[..n].iter().zip(b).map(|(re, im)| c64::new(*re, *im)).collect()
        };
        let q = parts(&null.right[0], &null.right[1]);
        let p = parts(&null.left[0], &null.left[0][n..]);
        let both = [&null.right[0][..n], &null.right[1][..n]].concat();
        let mut slope = vec![0.0; 2 * n];
        null.factors.growth_derivative(&both, &mut slope);
        let growth = inner(&p, &parts(&slope, &slope[n..]));
        Ok([q, p.iter().map(|c| -c / growth.conj()).collect()])
    }

    /// Computes the size of a critical direction with the exponent `iω`, from its real part and, if
    /// it is complex, its imaginary part. The returned change of the period refers to the real part
    /// of the direction.
    ///
    /// If the start time is free, as for autonomous orbits with events, it is shifted by `σ` such
    /// that deviations at equal times are multiplied by `e^{iω}` in a period: `(e^{iω} − 1) σ =
    /// δT`. For `ω = 0`, `σ` is chosen to minimise `⟨q, q⟩`.
    pub fn deviation(&mut self, parts: &[&[f64]], omega: f64) -> Result<Deviation, Failure> {
        let mut part = |k: usize| match parts.get(k) {
            Some(direction) => self.at.system.deviation(self.at.x, direction),
            None => Ok(Deviation::default()),
        };
        let [re, im] = [part(0)?, part(1)?];
        let shifts = if re.motion == 0.0 {
            [0.0, 0.0]
        } else if omega == 0.0 {
            [re, im].map(|part| part.along / re.motion)
        } else {
            let cotangent = (0.5 * omega).tan().recip();
            let [a, b] = [re.lengthening, im.lengthening];
            [0.5 * (b * cotangent - a), -0.5 * (a * cotangent + b)]
        };
        let square = re.square_after(shifts[0]) + im.square_after(shifts[1]);
        Ok(Deviation { square, ..re })
    }

    /// The period of the solution; 1 for equilibria and maps.
    pub fn period(&mut self) -> Result<f64, Failure> {
        let none = vec![0.0; self.at.x.len()];
        Ok(self.deviation(&[&none], 0.0)?.period)
    }

    /// Computes the coefficients of `F(z₀ + W)` for a polynomial `W`, with all parameters fixed.
    pub fn expand(
        &mut self,
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.at.system.expand(self.at.x, space, terms)
    }

    /// Returns the real and the imaginary part of a complex deviation that changes like `e^{iωt}`,
    /// as directions in which derivatives are taken: directions of `x`, followed by rates for a flow
    /// with a mass matrix.
    pub fn parts(&self, q: &[c64], omega: f64) -> [Vec<f64>; 2] {
        let [re, im] = [self.direction(q, |c| c.re), self.direction(q, |c| c.im)];
        motions(&*self.at.system, self.at.x, [&re, &im], omega).map(Cow::into_owned)
    }

    /// Returns the real or imaginary part of a complex vector as a direction of `x`.
    pub fn direction(&self, q: &[c64], part: impl Fn(&c64) -> f64) -> Vec<f64> {
        let mut direction: Vec<f64> = q.iter().map(part).collect();
        direction.resize(self.at.x.len(), 0.0);
        direction
    }

    /// Computes the mixed directional derivative of `F` along one or more real directions of `x`. If
    /// directions contain rates, `F − M z'` replaces `F`, and the rates of other directions are zero.
    pub fn of(&mut self, directions: &[&Vec<f64>]) -> Result<Vec<f64>, Failure> {
        let length = directions.iter().map(|d| d.len()).max().unwrap_or(0);
        let mut all: Vec<Vec<f64>> = directions.iter().map(|d| d.to_vec()).collect();
        all.iter_mut().for_each(|d| d.resize(length, 0.0));
        let directions: Vec<&[f64]> = all.iter().map(|d| &d[..]).collect();
        self.at.system.derivative(self.at.x, &directions, &mut self.room)?;
        Ok(self.room.clone())
    }

    /// Computes `F_xx[a, b]` for complex directions of `z`, each with the frequency at which it
    /// changes.
    pub fn bilinear(
        &mut self,
        (a, of_a): (&[c64], f64),
        (b, of_b): (&[c64], f64),
    ) -> Result<Vec<c64>, Failure> {
        let ([ar, ai], [br, bi]) = (self.parts(a, of_a), self.parts(b, of_b));
        let [rr, ii] = [self.of(&[&ar, &br])?, self.of(&[&ai, &bi])?];
        let [ri, ir] = [self.of(&[&ar, &bi])?, self.of(&[&ai, &br])?];
        Ok((0..rr.len()).map(|i| c64::new(rr[i] - ii[i], ri[i] + ir[i])).collect())
    }

    /// Computes `F_xx[a, d]` for a complex direction of `z` with its frequency and a real direction
    /// of `x`.
    pub fn along(&mut self, (a, omega): (&[c64], f64), d: &Vec<f64>) -> Result<Vec<c64>, Failure> {
        let [re, im] = self.parts(a, omega);
        let [re, im] = [self.of(&[&re, d])?, self.of(&[&im, d])?];
        Ok(re.iter().zip(im).map(|(re, im)| c64::new(*re, im)).collect())
    }

    /// Solves a linear system whose matrix is a singular linearisation, bordered by its null
    /// vectors.
    pub fn solve_within_border(&mut self, right: Vec<f64>) -> Result<Vec<f64>, Failure> {
        let At { system, x, null, .. } = &mut *self.at;
        let null = null.of(&mut **system, x, Form::Jacobian, None)?;
        let mut solution = right;
        solution.push(0.0);
        null.factors.solve(&mut solution);
        solution.truncate(self.n);
        solution.resize(self.at.x.len(), 0.0);
        Ok(solution)
    }

    /// Solves a linear system whose matrix is the transpose of a singular linearisation, bordered
    /// by its null vectors.
    pub fn solve_within_border_transposed(&mut self, right: Vec<f64>) -> Result<Vec<f64>, Failure> {
        let At { system, x, null, .. } = &mut *self.at;
        let null = null.of(&mut **system, x, Form::Jacobian, None)?;
        let mut solution = right;
        solution.push(0.0);
        null.factors.solve_transposed(&mut solution);
        solution.truncate(self.n);
        Ok(solution)
    }

    /// Computes `L' v` for the linearisation with the exponent 0.
    pub fn growth(&mut self, v: &[f64]) -> Result<Vec<f64>, Failure> {
        let At { system, x, null, .. } = &mut *self.at;
        let null = null.of(&mut **system, x, Form::Jacobian, None)?;
        null.factors.growth_derivative(&v[..self.n], &mut self.room);
        Ok(self.room.clone())
    }

    /// Computes the product of `L'` with a left vector, for the linearisation with the exponent 0.
    pub fn growth_transposed(&mut self, w: &[f64]) -> Result<Vec<f64>, Failure> {
        let At { system, x, null, .. } = &mut *self.at;
        let null = null.of(&mut **system, x, Form::Jacobian, None)?;
        null.factors.growth_derivative_transposed(&w[..self.n], &mut self.room);
        Ok(self.room.clone())
    }

    /// Solves a linear system with the matrix `F_z`; the solution is a direction of `x`.
    pub fn solve(&mut self, mut right: Vec<f64>) -> Result<Vec<f64>, Failure> {
        self.factors(Form::Jacobian)?.solve(&mut right);
        right.resize(self.at.x.len(), 0.0);
        Ok(right)
    }

    /// Solves a linear system whose matrix is the given form of the linearisation.
    pub fn solve_with(&mut self, form: Form, right: &[c64]) -> Result<Vec<c64>, Failure> {
        if let Form::Oscillation(omega) = form {
            return self.solve_complex(omega, right);
        }
        let mut factors = self.factors(form)?;
        let mut part = |part: fn(&c64) -> f64| -> Vec<f64> {
            let mut right: Vec<f64> = right.iter().map(part).collect();
            factors.solve(&mut right);
            right
        };
        let (re, im) = (part(|c| c.re), part(|c| c.im));
        Ok(re.iter().zip(im).map(|(re, im)| c64::new(*re, im)).collect())
    }

    /// Computes the factors of a real form of the linearisation.
    fn factors(&mut self, form: Form) -> Result<Factors, Failure> {
        let mut factors = Factors::default();
        self.at.system.assemble(self.at.x)?;
        self.at.system.factor(form, Border::NONE, &mut factors)?;
        Ok(factors)
    }

    /// Solves a linear system with the complex matrix `L(iω)`. With dense matrices, the complex
    /// linearisation of periodic orbits can be factored only with a border of width 1, so the
    /// solution of `L h = r` is combined from the solutions of two bordered systems:
    ///
    /// ```text
    ///     L h₁ + b g₁ = r,  c* h₁ = 0,      L h₂ + b g₂ = 0,  c* h₂ = 1,      h = h₁ − (g₁/g₂) h₂
    /// ```
    pub fn solve_complex(&mut self, omega: f64, right: &[c64]) -> Result<Vec<c64>, Failure> {
        let n = self.n;
        let (columns, rows) = (generic(2 * n, 1), generic(2 * n, 2));
        let border =
            Border { width: 1, columns: &columns, rows: &rows, corner: &[0.0], units: &[] };
        let mut factors = Factors::default();
        self.at.system.assemble(self.at.x)?;
        self.at.system.factor(Form::Oscillation(omega), border, &mut factors)?;
        let mut solved = |right: &[c64], last: f64| -> (Vec<c64>, c64) {
            let mut parts: Vec<f64> = right.iter().map(|r| r.re).chain([last]).collect();
            parts.extend(right.iter().map(|r| r.im).chain([0.0]));
            factors.solve(&mut parts);
            let (re, im) = parts.split_at(n + 1);
            let mut all: Vec<c64> = re.iter().zip(im).map(|(re, im)| c64::new(*re, *im)).collect();
            let g = all.pop().unwrap_or_default();
            (all, g)
        };
        let (h, g) = solved(right, 0.0);
        let (kernel, of_kernel) = solved(&vec![c64::new(0.0, 0.0); n], 1.0);
        let factor = g / of_kernel;
        if !(factor.re.is_finite() && factor.im.is_finite()) {
            return Err(Failure::Undetermined(
                "the normal form is undetermined: the linearisation is singular at a resonant \
                 frequency"
                    .into(),
            ));
        }
        Ok(h.iter().zip(kernel).map(|(h, k)| h - factor * k).collect())
    }

    /// The unit directions of the two released parameters.
    pub fn of_parameters(&self) -> Result<[Vec<f64>; 2], Failure> {
        let &[one, other] = self.at.released else {
            return Err(Failure::Unsupported("two parameters must be released".into()));
        };
        Ok([one, other].map(|p| {
            let mut direction = vec![0.0; self.at.x.len()];
            direction[self.n + p] = 1.0;
            direction
        }))
    }

    /// The unit direction of the first released parameter.
    pub fn of_parameter(&self) -> Option<Vec<f64>> {
        let mut direction = vec![0.0; self.at.x.len()];
        direction[self.n + *self.at.released.first()?] = 1.0;
        Some(direction)
    }

    /// Computes the direction of the branch, `(z_λ, 1)`, at a point where `F_z` is regular.
    pub fn along_branch(&mut self) -> Result<Option<Vec<f64>>, Failure> {
        let direction = self.of_parameter();
        direction.map(|direction| self.along_solutions(direction)).transpose()
    }

    /// Computes the derivative `(z_p, 1)` of the solution with respect to the parameter `p`, given
    /// as a unit direction of `x`, at a point where `F_z` is regular.
    pub fn along_solutions(&mut self, mut direction: Vec<f64>) -> Result<Vec<f64>, Failure> {
        let slope = self.of(&[&direction])?;
        let slope = self.solve(slope.into_iter().map(|f| -f).collect())?;
        direction[..self.n].copy_from_slice(&slope[..self.n]);
        Ok(direction)
    }

    /// Computes a direction `(s, 1)` with `F_z s = −F_λ` at a point where `F_z` is singular and
    /// `F_λ` lies in the range of `F_z`.
    pub fn along_crossing(&mut self) -> Result<Option<Vec<f64>>, Failure> {
        let direction = self.of_parameter();
        direction.map(|direction| self.along_singular(direction)).transpose()
    }

    /// Computes a direction `(s, 1)` with `F_z s = −F_p` at a point where `F_z` is singular; the
    /// parameter `p` is given as a unit direction of `x`.
    pub fn along_singular(&mut self, mut direction: Vec<f64>) -> Result<Vec<f64>, Failure> {
        let slope = self.of(&[&direction])?;
        let slope = self.solve_within_border(slope.into_iter().map(|f| -f).collect())?;
        direction[..self.n].copy_from_slice(&slope[..self.n]);
        Ok(direction)
    }
}
