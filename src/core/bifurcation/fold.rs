//! Folds, and period doublings of periodic orbits: defining systems and test functions.

use super::at::At;
use super::defining_system::DefiningSystem;
use super::test_function::{
    Bracketed, Needs, Passage, PointValues, Reading, TestFunction, sign_change,
};
use crate::core::failure::Failure;
use crate::core::linalg::Form;
use crate::core::system::{Functional, Kind};

impl Kind {
    /// `LP`: a limit point, also called fold.
    pub const LP: Kind = Kind::new("LP", "fold");
    /// `PD`: a period doubling of periodic orbits.
    pub const PD: Kind = Kind::new("PD", "period doubling");
}

/// The defining system of folds, where `F_z` is singular. The equation is `g(z, p) = 0` with `∇g =
/// −∇ₓ(wᵀ F_z v)`. The left side of the fold equation is multiplied by the sign of the determinant
/// of the bordered matrix, because `g` is the ratio of `det F_z` to this determinant, which may
/// change sign far from any fold.
///
/// A period doubling has the same equation as a fold, except that `F_z` is replaced by the
/// linearisation with antiperiodic boundary conditions, `v(1) = −v(0)`; the two matrices differ by
/// a constant matrix.
#[derive(Default)]
pub struct Fold {
    form: Form,
    /// The sign of the determinant of the bordered matrix.
    sign: f64,
}

impl Fold {
    /// Creates the defining system of period doublings of periodic orbits.
    pub fn period_doubling() -> Self {
        Fold { form: Form::Antiperiodic, sign: 0.0 }
    }
}

impl DefiningSystem for Fold {
    fn kind(&self) -> Kind {
        if self.form == Form::Antiperiodic { Kind::PD } else { Kind::LP }
    }

    fn assembles(&self) -> bool {
        true
    }

    fn start(&mut self, At { system, x, null, .. }: At, _y: &mut [f64]) -> Result<(), Failure> {
        null.start(system, x, self.form, None)
    }

    fn values(
        &mut self,
        At { system, x, null, .. }: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), Failure> {
        let null = null.of(system, x, self.form, None)?;
        self.sign = null.factors.determinant_sign();
        values[0] = self.sign * null.g[0];
        Ok(())
    }

    fn gradients(
        &mut self,
        At { system, x, released, null, .. }: At,
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), Failure> {
        let null = null.of(system, x, self.form, None)?;
        system.gradient(x, Functional::First(&null.left[0], &null.right[0]), released, rows)?;
        rows.iter_mut().for_each(|entry| *entry *= -self.sign);
        Ok(())
    }
}

/// Rounding: a slope of the continued parameter with respect to scaled arclength counts as zero up
/// to rounding if it is smaller than this threshold.
pub(crate) const VERTICAL: f64 = 1e-7;

/// Heuristic: the scaled distance from a double root of a defining system at which Newton's
/// method stops. The root changes the continued parameter by the square of the distance; nearer to the
/// root, where the matrix is singular, rounding errors dominate the corrections.
pub(crate) const DOUBLE_ROOT: f64 = 2e-6;

/// The test function of folds: the component of the tangent along the continued parameter.
pub(super) struct ParameterSlope;

impl TestFunction for ParameterSlope {
    fn value(&self, _at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(Some(known.slope))
    }

    /// Detects a fold where a real multiplier passes 1; this test is used if the slope of the
    /// parameter is as small as the discretisation error of the mesh, as in a canard explosion.
    fn passes(&self, [before, after]: [&Reading; 2]) -> Option<Passage> {
        if let (Some(from), Some(to)) = (before.stability, after.stability)
            && self.counts([before, after])
        {
            let real = from.unstable + to.unstable - from.complex - to.complex;
            let passed = real % 2 == 1 && from.flipped == to.flipped;
            // At a branch point the determinant changes sign.
            let passed = passed && before.determinant * after.determinant > 0.0;
            let falls = to.unstable < from.unstable;
            let passage = if falls { Passage::Falling } else { Passage::Rising };
            return Some(passage).filter(|_| passed);
        }
        sign_change(before.value?, after.value?)
    }

    fn is_odd(&self) -> bool {
        true
    }

    fn counts(&self, ends: [&Reading; 2]) -> bool {
        let known = ends.iter().all(|end| end.stability.is_some());
        let flat = |end: &&&Reading| end.slope.abs() <= end.vertical;
        let noisy = ends.iter().filter(flat).any(|end| end.vertical > VERTICAL);
        known && (noisy || ends.iter().filter(flat).count() == ends.len())
    }

    fn is_doubtful(&self, ends: [&Reading; 2]) -> bool {
        ends.iter().all(|end| end.slope.abs() < VERTICAL)
    }

    fn guess(&self, within: &Bracketed) -> f64 {
        let Bracketed { values: [low, high], rise, length, .. } = *within;
        turn_of_cubic(low, high, rise / length)
    }
}

/// Returns the zero in 0..1 of a quadratic function with the value `low` at 0, the value `high` of
/// opposite sign at 1, and the given `mean`.
fn turn_of_cubic(low: f64, high: f64, mean: f64) -> f64 {
    // The slope low (1 − s) + high s + 6 c s (1 − s) has the given mean.
    let c = mean - 0.5 * (low + high);
    let (a, b) = (-6.0 * c, high - low + 6.0 * c);
    let root = (b * b - 4.0 * a * low).sqrt();
    // The root without cancellation is the one inside the interval.
    -2.0 * low / (b + root.copysign(high - low))
}

/// The test function of period doublings: the numbers of real multipliers outside the unit circle.
///
/// The number of unstable real multipliers changes by one where a multiplier passes 1, at a fold or
/// a branch point, and where a multiplier passes −1, at a period doubling. A multiplier that passes
/// through infinity, as at a grazing bifurcation, changes sign and stays unstable.
pub(super) struct FlippedCount;

impl TestFunction for FlippedCount {
    /// Returns the product `Π (1 + μ)/(1 + |μ|)` over all multipliers `μ`, which vanishes if one
    /// multiplier is −1.
    fn value(&self, _at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(known.spectrum.map(|spectrum| spectrum.iter().map(flip_factor).product()))
    }

    fn passes(&self, [before, after]: [&Reading; 2]) -> Option<Passage> {
        let (from, to) = (before.stability?, after.stability?);
        let real = from.unstable - from.complex + to.unstable - to.complex;
        let signs = [before.slope * after.slope, before.determinant * after.determinant];
        // The slope changes sign at a fold, the determinant at a branch point.
        let past_one = signs.iter().filter(|sign| **sign < 0.0).count();
        let known = signs.iter().all(|sign| *sign != 0.0)
            && [before, after].iter().all(|end| end.slope.abs() > VERTICAL.max(end.vertical));
        let odd = known && (real + past_one) % 2 == 1;
        // At a curve's mirror image the slope also changes sign, but no count changes.
        let [changes, flips] = [from.unstable != to.unstable, from.flipped != to.flipped];
        // A multiplier that passes −1 is negative on both sides.
        let negative = from.negative + to.negative > 0;
        if !(negative && (odd && (changes || flips) || changes && flips)) {
            return None;
        }
        Some(if to.unstable > from.unstable { Passage::Rising } else { Passage::Falling })
    }

    fn needs(&self) -> Needs {
        Needs::Eigenvalues
    }
}

/// Returns `(1 + μ)/(1 + |μ|)` of a real multiplier `μ`, and the modulus of this ratio for a
/// complex multiplier.
fn flip_factor(mu: &(f64, f64)) -> f64 {
    let size = mu.0.hypot(mu.1);
    match (mu.1 == 0.0, size.is_finite()) {
        (_, false) => mu.0.signum(),
        (true, _) => (1.0 + mu.0) / (1.0 + size),
        (false, _) => (1.0 + mu.0).hypot(mu.1) / (1.0 + size),
    }
}
