//! Hopf points of equilibria, and torus points of periodic orbits: defining systems and test
//! functions.

use super::at::At;
use super::defining_system::DefiningSystem;
use super::null::{NullSpace, NullVectors};
use super::stability::{Critical, without_critical};
use super::test_function::{
    Bracketed, Needs, Passage, PointValues, Reading, TestFunction, nearest_to_zero,
};
use crate::core::failure::Failure;
use crate::core::linalg::{Form, SpectrumRequest, dot};
use crate::core::problem::Dynamics;
use crate::core::system::{Functional, Kind, System};
use std::borrow::Cow;

impl Kind {
    /// `HB`: a Hopf point.
    pub const HB: Kind = Kind::new("HB", "Hopf point");
    /// `TR`: a torus (Neimark–Sacker) point of periodic orbits.
    pub const TR: Kind = Kind::new("TR", "torus point");
}

/// The defining system of Hopf points, where `F_z` has the eigenvalue `iω`; `ω > 0` is an auxiliary
/// unknown. For periodic orbits, the same equations define a torus point, where an orbit has the
/// multiplier `e^{iω}`.
///
/// The complex matrix `L(ω)` ([`Form::Oscillation`]; `F_z − iω M` for an equilibrium with the mass
/// matrix `M`) is bordered in the same way as `F_z` at a fold. The border's multiplier `g = −w* L v`
/// is complex, so the defining system consists of two equations, `Re g = Im g = 0`, with
/// `δg = −w* δF_z v − w* (∂L/∂ω) v δω`.
pub struct Hopf {
    /// Whether the solutions are periodic orbits.
    periodic: bool,
    /// The frequency or angle that selects one of several nearly critical pairs of eigenvalues or
    /// multipliers.
    near: Option<f64>,
    /// Separate null vectors of a second critical pair, needed because the shared null vectors are
    /// stored by form of the linearisation, without regard to frequency. `None` if this defining
    /// system uses the shared null vectors.
    own: Option<NullSpace>,
    /// The frequency or angle `ω` at the last evaluation.
    omega: f64,
    /// A buffer for a complex vector.
    vector: Vec<f64>,
    slope: Vec<f64>,
    form: Vec<f64>,
}

impl Hopf {
    /// Creates the defining system of Hopf points of equilibria.
    pub fn of_equilibria() -> Self {
        Self::new(false)
    }

    /// Creates the defining system of torus points of periodic orbits.
    pub fn neimark_sacker() -> Self {
        Self::new(true)
    }

    /// Creates the defining system of Hopf or torus points for the critical pair nearest to a given
    /// frequency or angle, even if other pairs are critical. If no pair is near, the given
    /// frequency is the initial value of the auxiliary unknown `ω`.
    pub(crate) fn near(frequency: f64, periodic: bool) -> Self {
        Hopf { near: Some(frequency), ..Self::new(periodic) }
    }

    fn new(periodic: bool) -> Self {
        let (vector, slope, form) = (Vec::new(), Vec::new(), Vec::new());
        Hopf { periodic, near: None, own: None, omega: 0.0, vector, slope, form }
    }

    /// Creates the defining system of a second critical pair on a curve of Hopf or torus points;
    /// the frequency or angle of the first pair is the first auxiliary unknown of that curve.
    pub(crate) fn second(periodic: bool) -> Self {
        Hopf { own: Some(NullSpace::default()), ..Self::new(periodic) }
    }
}

impl DefiningSystem for Hopf {
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
        match (self.periodic, &self.own) {
            (true, None) => &["torus_angle"],
            (true, Some(_)) => &["second_angle"],
            (false, None) => &["hopf_frequency"],
            (false, Some(_)) => &["second_frequency"],
        }
    }

    fn start(&mut self, mut at: At, y: &mut [f64]) -> Result<(), Failure> {
        at.system.assemble(at.x)?;
        let held = at.held.first().copied().filter(|_| self.own.is_some());
        y[0] = crossing_frequency(&mut at, self.near, held)?;
        self.resume(at, y)
    }

    /// Needs no eigenvalues or multipliers, which are not always determined.
    fn resume(&mut self, at: At, y: &[f64]) -> Result<(), Failure> {
        let n = at.system.names().dimension();
        self.vector.resize(2 * n, 0.0);
        self.slope.resize(2 * n, 0.0);
        self.form.resize(at.x.len(), 0.0);
        if let Some(own) = &mut self.own {
            own.units().clone_from(at.null.units());
        }
        let null = self.own.as_mut().unwrap_or(at.null);
        null.start(at.system, at.x, Form::Oscillation(y[0]), None)
    }

    fn values(
        &mut self,
        At { system, x, null, .. }: At,
        y: &[f64],
        values: &mut [f64],
    ) -> Result<(), Failure> {
        self.omega = y[0];
        let null = self.own.as_mut().unwrap_or(null);
        values.copy_from_slice(&null.of(system, x, Form::Oscillation(self.omega), None)?.g);
        Ok(())
    }

    fn gradients(
        &mut self,
        At { system, x, released, null, .. }: At,
        rows: &mut [f64],
        own: &mut [f64],
    ) -> Result<(), Failure> {
        let (n, length) = (system.names().dimension(), x.len());
        let null = self.own.as_mut().unwrap_or(null);
        let NullVectors { left, right, factors, .. } =
            null.of(system, x, Form::Oscillation(self.omega), None)?;
        let (left_real, left_imaginary) = left[0].split_at(n);
        let motions = motions(system, x, [&right[0], &right[1]], self.omega);
        rows.fill(0.0);
        // w* δF v = (wᵣ − i wᵢ)ᵀ δF (vᵣ + i vᵢ); the gradient of g is its negative.
        for (w, v, row, sign) in [
            (left_real, 0, 0, -1.0),
            (left_imaginary, 1, 0, -1.0),
            (left_real, 1, length, -1.0),
            (left_imaginary, 0, length, 1.0),
        ] {
            system.gradient(x, Functional::First(w, &motions[v]), released, &mut self.form)?;
            rows[row..row + length].iter_mut().zip(&self.form).for_each(|(r, f)| *r += sign * f);
        }
        self.vector[..n].copy_from_slice(&right[0][..n]);
        self.vector[n..].copy_from_slice(&right[1][..n]);
        factors.growth_derivative(&self.vector, &mut self.slope);
        // ∂L/∂ω = i ∂L/∂σ.
        let (slope_real, slope_imaginary) = self.slope.split_at(n);
        own[0] = dot(left_real, slope_imaginary) - dot(left_imaginary, slope_real);
        own[1] = -(dot(left_real, slope_real) + dot(left_imaginary, slope_imaginary));
        Ok(())
    }

    fn is_reflected(&self, y: &[f64]) -> bool {
        y[0] < 0.0
    }

    fn adapt(&mut self) {
        if let Some(own) = &mut self.own {
            own.adapt();
        }
    }
}

/// Returns the real and imaginary parts of a complex direction that changes like `e^{iωt}`; for a
/// flow with a mass matrix, each part is followed by its rates.
pub(super) fn motions<'a>(
    system: &dyn System,
    x: &[f64],
    [re, im]: [&'a [f64]; 2],
    omega: f64,
) -> [Cow<'a, [f64]>; 2] {
    if system.dynamics() != Dynamics::Implicit {
        return [re, im].map(Cow::Borrowed);
    }
    let n = system.names().dimension();
    let followed = |part: &[f64], other: &[f64], factor: f64| {
        let rates = other[..n].iter().map(|v| factor * v);
        part[..x.len()].iter().copied().chain(rates).collect()
    };
    [Cow::Owned(followed(re, im, -omega)), Cow::Owned(followed(im, re, omega))]
}

/// Heuristic: a critical pair is first sought among the unstable eigenvalues and this many others.
const LEADING: SpectrumRequest = SpectrumRequest::pairs(10);

/// All eigenvalues that the system can compute.
const ALL: SpectrumRequest = SpectrumRequest::pairs(usize::MAX);

/// Returns the imaginary part of the complex pair nearest to the imaginary axis, or the angle of
/// the pair of multipliers nearest to the unit circle. If a frequency `near` is given, returns the
/// frequency or angle of the pair nearest to `near`, or `near` itself if no pair is closer to
/// `near` than the eigenvalue 0 (for orbits, than the multipliers 1 and −1). The critical pair with
/// the frequency or angle `held` is excluded.
fn crossing_frequency(at: &mut At, near: Option<f64>, held: Option<f64>) -> Result<f64, Failure> {
    for request in [LEADING, ALL] {
        if let Some(found) = crossing_among(at, request, (near, held))? {
            return Ok(found);
        }
    }
    near.ok_or(Failure::NoComplexPair)
}

/// Returns the frequency or angle of [`crossing_frequency`] among the requested eigenvalues; `None` if no
/// complex pair is near enough.
fn crossing_among(
    at: &mut At,
    request: SpectrumRequest,
    (near, held): (Option<f64>, Option<f64>),
) -> Result<Option<f64>, Failure> {
    let mut spectrum = at.system.spectrum(at.x, request)?.unwrap_or_default();
    let dynamics = at.system.dynamics();
    if let Some(held) = held {
        let (re, im) = match dynamics {
            Dynamics::Periodic => (held.cos(), held.sin()),
            _ => (0.0, held),
        };
        let distance = |l: &(f64, f64)| (l.0 - re).hypot(l.1.abs() - im.abs());
        spectrum = without_critical(&spectrum, 2, distance);
    }
    let distance = |l: &(f64, f64)| match (near, dynamics) {
        (None, _) => Critical::Pair.distance(dynamics, l),
        (Some(angle), Dynamics::Periodic) => (l.0 - angle.cos()).hypot(l.1 - angle.sin()),
        (Some(omega), _) => l.0.hypot(l.1 - omega),
    };
    let real = if dynamics == Dynamics::Periodic { 1.0 } else { 0.0 };
    let reach = distance(&(real, 0.0)).min(distance(&(-real, 0.0)));
    let reach = near.map_or(f64::INFINITY, |_| reach);
    let near_enough = |l: &(f64, f64)| l.1 > 0.0 && distance(l) <= reach;
    let pairs = spectrum.into_iter().filter(near_enough);
    let nearest = pairs.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    Ok(nearest.map(|(real, imaginary)| match dynamics {
        Dynamics::Periodic => imaginary.atan2(real),
        _ => imaginary,
    }))
}

/// Heuristic: a frequency counts as nonzero if its ratio to the frequencies of nearby pairs exceeds
/// this threshold. A fold solves the equations of a Hopf point with `ω = 0`, and Newton's method
/// determines `ω = 0` only to the square root of its tolerance.
const REAL: f64 = 1e-6;

/// The test function of Hopf and torus points. For equilibria, it consists of two counts: the
/// number of unstable eigenvalues, and the parity of the number of pairs of eigenvalues with a
/// positive sum. For periodic orbits, the two counts are the number of unstable multipliers, and
/// the parity of the number of pairs of multipliers with a product larger than 1.
///
/// At a neutral saddle, where two real eigenvalues are `λ` and `−λ`, the number of unstable
/// eigenvalues does not change. At a fold, the parity of the number of pairs with a positive sum
/// does not change.
pub(super) struct UnstablePairs;

impl TestFunction for UnstablePairs {
    fn value(&self, _at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(None)
    }

    fn passes(&self, [before, after]: [&Reading; 2]) -> Option<Passage> {
        let (from, to) = (before.stability?, after.stability?);
        let change = from.unstable.abs_diff(to.unstable);
        // If the same step contains a fold, the change may be 1.
        if !(change >= 2 || change == 1 && from.odd_pairs != to.odd_pairs) {
            return None;
        }
        Some(if to.unstable > from.unstable { Passage::Rising } else { Passage::Falling })
    }

    fn needs(&self) -> Needs {
        Needs::Eigenvalues
    }

    fn guess(&self, _within: &Bracketed) -> f64 {
        0.5
    }

    /// Whether the frequency of a computed Hopf or torus point is nonzero; near a Bogdanov–Takens
    /// point, a solution with frequency zero is a fold.
    fn confirms(&self, frequency: f64, spectra: [&[(f64, f64)]; 2], of: Dynamics) -> bool {
        let periodic = of == Dynamics::Periodic;
        let size = |&(re, im): &(f64, f64)| if periodic { im / re.hypot(im) } else { im };
        let pairs = spectra.into_iter().flatten().filter(|l| l.1 > 0.0).map(size);
        let omega = if periodic { frequency.sin() } else { frequency };
        omega.abs() > REAL * pairs.reduce(f64::min).unwrap_or(0.0)
    }

    /// The real part of the pair of eigenvalues nearest to the imaginary axis; `None` for periodic
    /// orbits, whose unstable multipliers are counted instead.
    fn smooth(&self, _: &Reading, spectrum: &[(f64, f64)], of: Dynamics) -> Option<f64> {
        let pairs = spectrum.iter().filter(|l| l.1 > 0.0 && of != Dynamics::Periodic);
        nearest_to_zero(pairs.map(|l| l.0))
    }
}
