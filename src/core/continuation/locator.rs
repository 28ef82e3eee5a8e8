//! The interval of a curve in which events are located, and the computation of points in the
//! interval.

use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::extended::Closing;
use super::located::Located;
use super::newton::NewtonError;
use crate::core::failure::Failure;
use crate::core::system::Kind;

/// The interval of a curve in which events are located, together with the curve.
pub(super) struct Locator<'c, 'a> {
    pub curve: &'c mut Curve<'a>,
    pub interval: Interval<'c>,
    /// The covector of the tangent at the first point of the interval.
    pub row: Vec<f64>,
}

impl<'c, 'a> Locator<'c, 'a> {
    pub fn new(curve: &'c mut Curve<'a>, interval: Interval<'c>) -> Self {
        Locator { row: curve.corrector.norm.covector(&interval.from.tangent), curve, interval }
    }

    /// Returns the middle of the interval, as an unconverged special point.
    pub fn middle(&self, event: (Kind, &str)) -> Located {
        let corrector = &self.curve.corrector;
        let [start, end] = self.interval.ends(corrector.equations.parameters_at());
        let error = (end - start).abs() + corrector.parameter_error();
        let unknowns = self.interval.chord(0.5);
        Located::new(event, 0.5 * self.interval.length, unknowns, error).converged(false)
    }

    /// Corrects a guess to the point of the curve at the distance `along` from the first point, and
    /// returns it with the relative error of the last factored matrix.
    pub fn corrected(
        &mut self,
        mut guess: Vec<f64>,
        along: f64,
    ) -> Result<(Vec<f64>, f64), NewtonError> {
        let closing = Closing { row: &self.row, base: &self.interval.from.unknowns, length: along };
        let report = self.curve.corrector.correct(&mut guess, closing)?;
        Ok((guess, report.matrix_error))
    }

    /// Records a corrected point: its tangent, monitors, stability and test functions.
    pub fn arrive(
        &mut self,
        (unknowns, matrix_error): (Vec<f64>, f64),
        stability: bool,
    ) -> Result<CurvePoint, Failure> {
        self.curve.arrive(unknowns, &self.row, matrix_error, stability)
    }

    /// Returns the values of the test function of an event at the distance `reach` on both sides of
    /// a position; `None` if the curve cannot be corrected at these two points, or if the test
    /// function is undefined.
    pub fn values_beside(&mut self, index: usize, along: f64, reach: f64) -> Option<[f64; 2]> {
        let mut values = [0.0; 2];
        for (value, beside) in values.iter_mut().zip([along - reach, along + reach]) {
            let guess = self.interval.cubic(&self.row, beside);
            let corrected = self.corrected(guess, beside).ok()?;
            *value = self.arrive(corrected, false).ok()?.tests[index]?;
        }
        Some(values)
    }
}
