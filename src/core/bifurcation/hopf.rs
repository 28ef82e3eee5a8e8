//! Hopf points of equilibria, and torus points of periodic orbits.

use crate::core::condition::{At, Condition, Failure};
use crate::core::kind::Kind;
use crate::core::linear::Factors;
use crate::core::vector::{dot, generic, normalise};
use crate::core::zero::{Border, Dynamics, Form};

impl Kind {
    /// `HB`: a Hopf point.
    pub const HB: Kind = Kind::new("HB", "Hopf point");
    /// `TR`: a torus (Neimark–Sacker) point of periodic orbits.
    pub const TR: Kind = Kind::new("TR", "torus point");
}

/// A Hopf point: `F_z` has the eigenvalue `iω`, `ω > 0` an unknown of the condition's own. On a
/// periodic orbit the same is a torus point: it has the multiplier `e^{iω}`.
///
/// The complex matrix `L(ω)` ([`Form::Oscillation`]; `F_z − iω` for an equilibrium) is bordered as at a
/// fold; the multiplier `g = −w* L v` is complex, so there are two equations, `Re g = Im g = 0`, with
/// `δg = −w* δF_z v − w* (∂L/∂ω) v δω`.
#[derive(Default)]
pub struct Hopf {
    /// Whether solutions are periodic orbits.
    periodic: bool,
    /// `b` and `c` as (real, imaginary) vectors one after the other.
    column: Vec<f64>,
    row: Vec<f64>,
    /// `(v, g)` and `(w, g)`: real parts of `n + 1` numbers, then imaginary parts.
    right: Vec<f64>,
    left: Vec<f64>,
    vector: Vec<f64>,
    slope: Vec<f64>,
    form: Vec<f64>,
    extended: [Vec<f64>; 2],
    factors: Factors,
}

impl Hopf {
    /// A Hopf point of equilibria.
    pub fn of_equilibria() -> Self {
        Hopf::default()
    }

    /// A torus point of periodic orbits.
    pub fn of_orbits() -> Self {
        Hopf { periodic: true, ..Hopf::default() }
    }

    fn solve(&mut self, at: &mut At, omega: f64) -> Result<(), Failure> {
        at.system.assemble(at.x)?;
        let n = at.system.names().dimension();
        let (columns, rows) = (&self.column, &self.row);
        let border = Border { width: 1, columns, rows, corner: &[0.0; 2] };
        at.system.factor(Form::Oscillation(omega), border, &mut self.factors)?;
        for vector in [&mut self.right, &mut self.left] {
            vector.fill(0.0);
            vector[n] = 1.0;
        }
        self.factors.solve(&mut self.right);
        self.factors.solve_transposed(&mut self.left);
        Ok(())
    }
}

impl Condition for Hopf {
    fn kind(&self) -> Kind {
        if self.periodic { Kind::TR } else { Kind::HB }
    }

    fn assembles(&self) -> bool {
        true
    }

    fn unknowns(&self) -> usize {
        1
    }

    fn names(&self) -> &'static [&'static str] {
        if self.periodic { &["torus_angle"] } else { &["hopf_frequency"] }
    }

    fn start(&mut self, mut at: At, y: &mut [f64]) -> Result<(), Failure> {
        let n = at.system.names().dimension();
        at.system.assemble(at.x)?;
        y[0] = crossing_frequency(&mut at)?;
        self.column = generic(2 * n, 1);
        self.row = generic(2 * n, 2);
        self.right.resize(2 * n + 2, 0.0);
        self.left.resize(2 * n + 2, 0.0);
        self.vector.resize(2 * n, 0.0);
        self.slope.resize(2 * n, 0.0);
        self.form.resize(at.x.len(), 0.0);
        self.extended = [vec![0.0; at.x.len()], vec![0.0; at.x.len()]];
        for _ in 0..3 {
            self.solve(&mut at, y[0])?;
            self.adapt();
        }
        Ok(())
    }

    fn values(&mut self, mut at: At, y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        let n = at.system.names().dimension();
        self.solve(&mut at, y[0])?;
        values.copy_from_slice(&[self.right[n], self.right[2 * n + 1]]);
        Ok(())
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure> {
        let (n, length) = (at.system.names().dimension(), at.x.len());
        let (real, imaginary) = (0..n, n + 1..2 * n + 1);
        self.extended[0][..n].copy_from_slice(&self.right[real.clone()]);
        self.extended[1][..n].copy_from_slice(&self.right[imaginary.clone()]);
        let (left_real, left_imaginary) = (&self.left[real], &self.left[imaginary]);
        rows.fill(0.0);
        // w* δF v = (wᵣ − i wᵢ)ᵀ δF (vᵣ + i vᵢ); the gradient of g is its negative.
        for (w, v, row, sign) in [
            (left_real, 0, 0, -1.0),
            (left_imaginary, 1, 0, -1.0),
            (left_real, 1, length, -1.0),
            (left_imaginary, 0, length, 1.0),
        ] {
            at.system.gradient(at.x, (w, &self.extended[v], 1), at.released, &mut self.form)?;
            rows[row..row + length].iter_mut().zip(&self.form).for_each(|(r, f)| *r += sign * f);
        }
        self.vector[..n].copy_from_slice(&self.extended[0][..n]);
        self.vector[n..].copy_from_slice(&self.extended[1][..n]);
        self.factors.frequency_derivative(&self.vector, &mut self.slope);
        let (slope_real, slope_imaginary) = self.slope.split_at(n);
        own[0] = -(dot(left_real, slope_real) + dot(left_imaginary, slope_imaginary));
        own[1] = -(dot(left_real, slope_imaginary) - dot(left_imaginary, slope_real));
        Ok(())
    }

    fn adapt(&mut self) {
        let n = self.column.len() / 2;
        for (border, null) in [(&mut self.column, &self.left), (&mut self.row, &self.right)] {
            border[..n].copy_from_slice(&null[..n]);
            border[n..].copy_from_slice(&null[n + 1..2 * n + 1]);
            normalise(border);
        }
    }
}

/// The imaginary part of the complex pair nearest to the imaginary axis, or the angle of the pair of
/// multipliers nearest to the unit circle.
fn crossing_frequency(at: &mut At) -> Result<f64, Failure> {
    let spectrum = at.system.spectrum(at.x)?.unwrap_or_default();
    let periodic = at.system.dynamics() == Dynamics::Periodic;
    let distance = |l: &(f64, f64)| match periodic {
        true => (l.0.hypot(l.1) - 1.0).abs(),
        false => l.0.abs(),
    };
    let pairs = spectrum.into_iter().filter(|(_, imaginary)| *imaginary > 0.0);
    match pairs.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
        Some((real, imaginary)) if periodic => Ok(imaginary.atan2(real)),
        Some((_, omega)) => Ok(omega),
        None => Err(Failure::NoComplexPair),
    }
}
