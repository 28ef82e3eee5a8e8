//! A curve with the components that work on it, its points, and the intervals between them.

use super::arnoldi::{Crossings, count_crossings};
use super::branch::Point;
use super::corrector::Corrector;
use super::detector::Detector;
use super::hermite::{Knot, hermite};
use super::newton::ROUGHLY;
use super::recorder::{Recorded, Recorder};
use super::refiner::Refiner;
use crate::core::bifurcation::{Reading, Stability};
use crate::core::failure::Failure;
use crate::core::linalg::{Spectrum, dot};

/// A point of the curve with everything that the next step and the events need.
#[derive(Clone)]
pub(super) struct CurvePoint {
    pub unknowns: Vec<f64>,
    /// The tangent, of scaled length 1.
    pub tangent: Vec<f64>,
    /// Values of the events' test functions; `None` where one is unknown.
    pub tests: Vec<Option<f64>>,
    pub point: Point,
    /// All eigenvalues or multipliers, where they are known.
    pub spectrum: Option<Spectrum>,
    /// The counts of unstable ones, where they are known.
    pub stability: Option<Stability>,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// The arclength from here on in which no branch point lies, where eigenvalues are not known.
    pub quiet: f64,
}

/// Two successive points of a curve.
#[derive(Clone, Copy)]
pub(super) struct Interval<'p> {
    pub from: &'p CurvePoint,
    pub to: &'p CurvePoint,
    /// The distance of the hyperplanes across the tangent of the first point.
    pub length: f64,
}

impl Interval<'_> {
    /// The point this far behind the first one, on the cubic with the tangents of both ends; `row`
    /// is the covector of the first tangent.
    pub fn cubic(&self, row: &[f64], along: f64) -> Vec<f64> {
        let Interval { from, to, length } = *self;
        let speed = dot(row, &to.tangent);
        let knots = [
            Knot { u: 0.0, x: &from.unknowns, tangent: &from.tangent, speed: 1.0 },
            Knot { u: length, x: &to.unknowns, tangent: &to.tangent, speed },
        ];
        hermite(&knots, along)
    }

    /// The point of the chord at this share of the way.
    pub fn chord(&self, share: f64) -> Vec<f64> {
        let ends = self.from.unknowns.iter().zip(&self.to.unknowns);
        ends.map(|(a, b)| a + share * (b - a)).collect()
    }

    /// A component of the unknowns at both ends.
    pub fn ends(&self, component: usize) -> [f64; 2] {
        [self.from, self.to].map(|end| end.unknowns[component])
    }
}

/// A curve with the components that find and record its points.
pub(super) struct Curve<'a> {
    pub corrector: Corrector<'a>,
    pub detector: Detector,
    pub recorder: Recorder,
    pub refiner: Refiner,
}

impl Curve<'_> {
    /// The tangent at a corrected point, along `row`. The matrix factored last, with the same
    /// `row`, differs from the one there by `matrix_error`, relatively.
    pub fn tangent(
        &mut self,
        unknowns: &[f64],
        row: &[f64],
        matrix_error: f64,
        stability: bool,
    ) -> Result<Vec<f64>, Failure> {
        // Eigenvalues that are only counted need not be known well, but monitors and conditions
        // come with the matrix.
        let exact = self.detector.needs_matrix() || (stability && self.recorder.keeps_spectra());
        self.corrector.tangent(unknowns, row, if exact { f64::INFINITY } else { matrix_error })
    }

    /// The point with the tangent found last: monitors, stability (which costs a spectrum) if it is
    /// wanted, test functions.
    pub fn point(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        stability: bool,
    ) -> Result<CurvePoint, Failure> {
        let equations = &mut self.corrector.equations;
        let determinant = equations.factors.determinant_sign();
        // Monitors need not be known better than the point.
        equations.set_inexactness(ROUGHLY * self.corrector.tolerances.tolerance);
        let recorded = self.recorder.record(equations, stability);
        equations.set_inexactness(0.0);
        self.tested(unknowns, tangent, determinant, recorded?)
    }

    /// A recorded point with the values of its test functions.
    pub fn tested(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        determinant: f64,
        recorded: Recorded,
    ) -> Result<CurvePoint, Failure> {
        let equations = &mut self.corrector.equations;
        let tests = self.detector.values(equations, &tangent, determinant, &recorded)?;
        let Recorded { point, spectrum, stability } = recorded;
        let quiet = 0.0;
        Ok(CurvePoint { unknowns, tangent, tests, point, spectrum, stability, determinant, quiet })
    }

    /// What the test function of the event at this position compares at two points.
    pub fn reading(&self, event: usize, place: &CurvePoint) -> Reading {
        Reading {
            value: place.tests[event],
            slope: self.corrector.slope(&place.tangent),
            determinant: place.determinant,
            stability: place.stability,
        }
    }

    /// A corrected point with its tangent and everything that is recorded there.
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

    /// The branch points in a step to a point, if they are looked for and eigenvalues do not tell.
    /// The matrix factored last is the one of that point, with this row.
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
