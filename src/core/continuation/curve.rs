//! A curve, together with the components that compute and record its points.

use super::arnoldi::{Crossings, count_crossings};
use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::detector::Detector;
use super::newton::ROUGHLY;
use super::paired_multipliers::{self, besides_second_one};
use super::recorder::{Recorded, Recorder};
use super::refiner::Refiner;
use crate::core::bifurcation::{ComputeNormalForm, Reading, nearest_to_critical};
use crate::core::failure::{Failure, finite};

/// Heuristic: the factor by which the error of eigenvalues may exceed the error of the matrix. The
/// error of the matrix is known only along the direction of the last correction.
const SPREAD: f64 = 1e3;

/// The remedy for a tangent that is not finite.
const NO_TANGENT: &str = "several branches may cross at the point: start beside the point";

/// A curve, together with the components that compute and record its points.
pub(super) struct Curve<'a> {
    pub corrector: Corrector<'a>,
    pub detector: Detector,
    pub recorder: Recorder,
    pub refiner: Refiner,
    /// On a [family of cycles](super::conservative), the settings and normal forms that are not used.
    pub unused: Option<Unused>,
}

/// The description of special points that does not apply to a [family of cycles](super::conservative).
pub(super) struct Unused {
    sensitivities: bool,
    normal_forms: Vec<Option<ComputeNormalForm>>,
}

impl Curve<'_> {
    /// Returns the tangent at a corrected point, in the direction in which its product with the
    /// covector `row` is positive. The last factored matrix, whose last row must also be `row`,
    /// differs from the matrix at the point by the relative error `matrix_error`.
    pub fn tangent(
        &mut self,
        unknowns: &[f64],
        row: &[f64],
        matrix_error: f64,
        stability: bool,
    ) -> Result<Vec<f64>, Failure> {
        // Eigenvalues that are only counted need not be accurate, but monitors and defining systems
        // are evaluated with the matrix.
        let spectra = stability && self.recorder.keeps_spectra();
        let factored_apart = self.corrector.equations.system().factors_for_eigenvalues();
        let exact = self.detector.needs_matrix() || (spectra && !factored_apart);
        let matrix_error = if exact { f64::INFINITY } else { matrix_error };
        let tangent = self.corrector.tangent(unknowns, row, matrix_error)?;
        // The computation of the spectrum needs the matrix at the point, and factors the matrix if necessary.
        if spectra && self.corrector.matrix_error > 0.0 {
            self.corrector.equations.assemble(unknowns)?;
            self.corrector.matrix_error = 0.0;
        }
        Ok(tangent)
    }

    /// Records the point at which the last tangent was computed: its monitors, its test functions
    /// and, if requested, its stability, which requires a spectrum.
    pub fn point(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        stability: bool,
    ) -> Result<CurvePoint, Failure> {
        let equations = &mut self.corrector.equations;
        let determinant = equations.factors.determinant_sign();
        // Monitors need not be more accurate than the point.
        equations.set_inexactness(ROUGHLY * self.corrector.tolerances.tolerance);
        let mut recorded = self.recorder.record(equations, stability);
        let error = SPREAD * self.corrector.matrix_error;
        let dynamics = equations.system().dynamics();
        let doubtful = |it: &Recorded| {
            it.others.as_deref().is_some_and(|all| nearest_to_critical(dynamics, all) <= error)
        };
        if error > 0.0 && recorded.as_ref().is_ok_and(doubtful) {
            equations.assemble(&unknowns)?;
            recorded = self.recorder.record(equations, stability);
        }
        equations.set_inexactness(0.0);
        self.tested(unknowns, tangent, determinant, recorded?)
    }

    /// Evaluates the test functions at a recorded point and stores their values in the point.
    pub fn tested(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        determinant: f64,
        recorded: Recorded,
    ) -> Result<CurvePoint, Failure> {
        let equations = &mut self.corrector.equations;
        let tests = self.detector.values(equations, &tangent, determinant, &recorded)?;
        let Recorded { point, others: spectrum, stability, .. } = recorded;
        Ok(CurvePoint {
            vertical: self.corrector.vertical(&unknowns),
            quiet: 0.0,
            unknowns,
            tangent,
            tests,
            point,
            spectrum,
            stability,
            determinant,
        })
    }

    /// Treats the curve from now on as a [family of cycles](super::conservative) at one value of the
    /// continued parameter, and updates points that were recorded before. No normal form and no
    /// sensitivity describes a special point of the family, since the parameter does not vary.
    pub fn becomes_family(&mut self, places: [&mut CurvePoint; 3]) {
        let sensitivities = std::mem::replace(&mut self.corrector.sensitivities, false);
        let events = self.detector.events.iter_mut();
        let normal_forms = events.map(|event| event.normal_form.take()).collect();
        self.unused = Some(Unused { sensitivities, normal_forms });
        self.recorder.family = true;
        for place in places {
            place.spectrum = place.spectrum.as_deref().map(besides_second_one);
            place.stability = place.spectrum.as_deref().map(paired_multipliers::stability);
            place.point.unstable = place.stability.map(|it| it.unstable);
        }
    }

    /// Treats the curve from now on as a branch along which the continued parameter varies. The stability
    /// of the last point without the second multiplier 1 cannot be compared with the next point.
    pub fn leaves_family(&mut self, last: &mut CurvePoint) {
        self.recorder.family = false;
        if let Some(Unused { sensitivities, normal_forms }) = self.unused.take() {
            self.corrector.sensitivities = sensitivities;
            let events = self.detector.events.iter_mut();
            events.zip(normal_forms).for_each(|(event, form)| event.normal_form = form);
        }
        (last.spectrum, last.stability, last.point.unstable) = (None, None, None);
    }

    /// Returns the value of the test function of an event and the stability at a point.
    pub fn reading(&self, event: usize, place: &CurvePoint) -> Reading {
        // The slope of a constant parameter is an error, and no multiplier passes 1 at its zeros.
        let slope = if self.recorder.family { 1.0 } else { self.corrector.slope(&place.tangent) };
        Reading {
            value: place.tests[event],
            slope,
            vertical: place.vertical,
            determinant: place.determinant,
            stability: place.stability,
        }
    }

    /// Records the start of the curve.
    pub fn arrive_first(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        from_branch_point: bool,
    ) -> Result<CurvePoint, Failure> {
        let Curve { corrector, detector, recorder, .. } = &mut *self;
        corrector.equations.load(&unknowns);
        detector.start(&mut corrector.equations)?;
        let stability = recorder.wants_stability();
        if from_branch_point {
            finite(&tangent, |k| format!("component {k} of the tangent"), NO_TANGENT)?;
            // The tangent of the matrix is not unique at a branch point.
            corrector.equations.assemble(&unknowns)?;
            // The multipliers may also be undetermined.
            let recorded = recorder.record(&mut corrector.equations, stability);
            let again = |_| recorder.record(&mut corrector.equations, false);
            let recorded = recorded.or_else(again)?;
            return self.tested(unknowns, tangent, 0.0, recorded);
        }
        let row = corrector.norm.covector(&tangent);
        self.arrive(unknowns, &row, f64::INFINITY, stability)
    }

    /// Records a corrected point: its tangent, monitors, stability and test functions.
    pub fn arrive(
        &mut self,
        unknowns: Vec<f64>,
        row: &[f64],
        matrix_error: f64,
        stability: bool,
    ) -> Result<CurvePoint, Failure> {
        let tangent = self.tangent(&unknowns, row, matrix_error, stability)?;
        self.point(unknowns, tangent, stability)
    }

    /// Counts the branch points in a step to a point, if the count is requested and not known from
    /// eigenvalues. The last factored matrix must be the matrix at that point with the last row
    /// `row`.
    pub fn crossings(
        &mut self,
        from: &CurvePoint,
        row: &[f64],
        length: f64,
        to: &mut CurvePoint,
    ) -> Crossings {
        let wanted = self.detector.branch_points().is_some() && self.recorder.solutions;
        if !wanted || to.spectrum.is_some() {
            return Crossings::default();
        }
        let crossings = count_crossings(&mut self.corrector, from, row, length);
        to.quiet = crossings.quiet;
        crossings
    }
}
