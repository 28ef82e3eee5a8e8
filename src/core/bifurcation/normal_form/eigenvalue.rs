//! Critical eigenvalues and multipliers, with their left and right eigenvectors.

use super::forms::{Forms, inner, leading};
use super::polynomials::{Variable, ZERO};
use crate::core::bifurcation::null::{NullSpace, NullVectors};
use crate::core::failure::Failure;
use crate::core::linalg::Form;
use faer::c64;

/// A critical exponent `σ = iω`: `σ` is an eigenvalue of an equilibrium, or `e^σ` is a multiplier
/// of an orbit. If `σ` is not real, its conjugate is also critical.
pub(super) struct Eigenvalue {
    form: Form,
    /// The right eigenvector `q` of `L`, normalised so that the integral of `⟨q, q⟩` over the
    /// period is 1; for a double eigenvalue, the Jordan chain `L q₀ = 0`, `L q₁ = −L' q₀`. A real
    /// `q` that changes the period is instead scaled such that `dτ/dt = 1 − ξ`.
    pub right: Vec<Vec<c64>>,
    /// The left eigenvector `p`: `p* L = 0`, and `p* L' q = −1` for the last vector `q` of the
    /// Jordan chain.
    pub left: Vec<c64>,
    /// Whether the scale of `q` is determined by the change of the period that `q` causes, instead
    /// of by `⟨q, q⟩`.
    pub by_period: bool,
    null: NullSpace,
}

impl Eigenvalue {
    /// Computes the eigenvectors of a simple critical eigenvalue.
    pub fn simple(forms: &mut Forms, form: Form) -> Result<Self, Failure> {
        let mut it = Self::new(forms, form)?;
        it.scale_left(forms)?;
        Ok(it)
    }

    /// Computes the null vectors of a critical eigenvalue; the left null vector is not scaled. The
    /// null vectors of each eigenvalue are computed separately, since several pairs may be
    /// critical.
    fn new(forms: &mut Forms, form: Form) -> Result<Self, Failure> {
        let mut null = NullSpace::default();
        null.units().clone_from(forms.at.null.units());
        null.start(&mut *forms.at.system, forms.at.x, form, None)?;
        let mut it =
            Eigenvalue { form, right: Vec::new(), left: Vec::new(), by_period: false, null };
        let n = forms.n;
        let known = it.known(forms)?;
        let (q, p) = match form {
            Form::Oscillation(_) => {
                let right = [&known.right[0][..n], &known.right[1][..n]].concat();
                (joined(&right), joined(&known.left[0]))
            }
            _ => (real(&known.right[0][..n]), real(&known.left[0])),
        };
        let size = it.size(forms, &q)?;
        it.right = vec![q.iter().map(|c| c / size).collect()];
        it.left = p;
        Ok(it)
    }

    /// Computes the Jordan chain and the left vector of a real double eigenvalue with one
    /// eigenvector.
    pub fn double(forms: &mut Forms, form: Form) -> Result<Self, Failure> {
        // p* L' q₀ = 0.
        let mut it = Self::new(forms, form)?;
        let growth = it.growth(forms, &it.right[0].clone())?;
        let right: Vec<c64> = growth.iter().map(|c| -c).collect();
        let next = it.solve_within_border(forms, &right)?;
        it.right.push(next);
        it.scale_left(forms)?;
        Ok(it)
    }

    /// `ω`.
    pub fn omega(&self) -> f64 {
        match self.form {
            Form::Jacobian => 0.0,
            Form::Antiperiodic => std::f64::consts::PI,
            Form::Oscillation(omega) => omega,
        }
    }

    /// The variables that represent the critical deviations: their number and whether they are
    /// complex.
    pub fn variables(&self) -> Vec<Variable> {
        match self.form {
            Form::Oscillation(_) => vec![Variable::Complex, Variable::Conjugate],
            _ => vec![Variable::Real; self.right.len()],
        }
    }

    /// Returns the null vectors of the linearisation in the form of this eigenvalue, and the
    /// factors of the bordered matrix.
    fn known(&mut self, forms: &mut Forms) -> Result<&mut NullVectors, Failure> {
        self.null.of(&mut *forms.at.system, forms.at.x, self.form, None)
    }

    /// The number by which a critical eigenvector is divided to normalise it.
    fn size(&mut self, forms: &mut Forms, q: &[c64]) -> Result<f64, Failure> {
        let [re, im] = [forms.direction(q, |c| c.re), forms.direction(q, |c| c.im)];
        let deviation = forms.deviation(&[&re, &im], self.omega())?;
        if self.form == Form::Jacobian
            && let Some(lengthening) = deviation.changes_period()
        {
            self.by_period = true;
            return Ok(lengthening / deviation.period);
        }
        let of_flow = forms.at.system.dynamics().is_flow() && self.form == Form::Jacobian;
        let sign = if of_flow { leading(&re[..forms.n]).signum() } else { 1.0 };
        Ok(sign * deviation.square.sqrt())
    }

    /// Scales the left eigenvector such that `p* L' q = −1` for the last right vector `q`.
    fn scale_left(&mut self, forms: &mut Forms) -> Result<(), Failure> {
        let last = self.last().to_vec();
        let growth = self.growth(forms, &last)?;
        let factor = -inner(&self.left, &growth).conj();
        self.left.iter_mut().for_each(|c| *c /= factor);
        Ok(())
    }

    /// The last right vector of the Jordan chain; for a simple eigenvalue, the right eigenvector.
    pub fn last(&self) -> &[c64] {
        self.right.last().map_or(&[], Vec::as_slice)
    }

    /// `L' v`.
    pub fn growth(&mut self, forms: &mut Forms, v: &[c64]) -> Result<Vec<c64>, Failure> {
        let complex = matches!(self.form, Form::Oscillation(_));
        let factors = &self.known(forms)?.factors;
        let parts = separated(v);
        let mut out = vec![0.0; parts.len()];
        if complex {
            factors.growth_derivative(&parts, &mut out);
        } else {
            for (part, out) in parts.chunks(v.len()).zip(out.chunks_mut(v.len())) {
                factors.growth_derivative(part, out);
            }
        }
        Ok(joined(&out))
    }

    /// Solves a linear system with the singular matrix `L`, bordered by its null vectors.
    pub fn solve_within_border(
        &mut self,
        forms: &mut Forms,
        right: &[c64],
    ) -> Result<Vec<c64>, Failure> {
        let complex = matches!(self.form, Form::Oscillation(_));
        let factors = &mut self.known(forms)?.factors;
        let mut parts = separated(&[right, &[ZERO]].concat());
        if complex {
            factors.solve(&mut parts);
        } else {
            parts.chunks_mut(right.len() + 1).for_each(|part| factors.solve(part));
        }
        let mut solution = joined(&parts);
        solution.pop();
        Ok(solution)
    }
}

fn real(v: &[f64]) -> Vec<c64> {
    v.iter().map(|c| c64::new(*c, 0.0)).collect()
}

/// Creates a complex vector from its real parts followed by its imaginary parts.
fn joined(parts: &[f64]) -> Vec<c64> {
    let (re, im) = parts.split_at(parts.len() / 2);
    re.iter().zip(im).map(|(re, im)| c64::new(*re, *im)).collect()
}

/// Returns the real parts of a complex vector, followed by its imaginary parts.
fn separated(v: &[c64]) -> Vec<f64> {
    v.iter().map(|c| c.re).chain(v.iter().map(|c| c.im)).collect()
}
