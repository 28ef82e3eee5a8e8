//! Promise: a kind of special point of one's own, with its test function and its defining system,
//! is one file, written from outside of the library.

use crate::common::{BogdanovTakens, close, first};
use tangency::core::bifurcation::{At, DefiningSystem, Needs, PointValues, TestFunction};
use tangency::core::continuation::{Branch, Continuation, Event};
use tangency::core::failure::{Failure, one_line};
use tangency::core::system::{Dense, Functional, Kind};
use tangency::output::Document;

/// `NS`: a neutral saddle, an equilibrium with the real eigenvalues `λ` and `−λ`.
const NS: Kind = Kind::new("NS", "neutral saddle");

/// The defining system: the trace of `F_z` vanishes. In the plane that is `λ₁ + λ₂ = 0`.
struct Trace;

/// The unit directions of the unknowns, each of the same length as `x`.
fn units(at: &At) -> Vec<Vec<f64>> {
    let unit = |i: usize| (0..at.x.len()).map(|k| if k == i { 1.0 } else { 0.0 }).collect();
    (0..at.system.names().dimension()).map(unit).collect()
}

impl DefiningSystem for Trace {
    fn kind(&self) -> Kind {
        NS
    }
    fn values(&mut self, at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        let units = units(&at);
        let mut column = vec![0.0; units.len()];
        values[0] = 0.0;
        for (i, unit) in units.iter().enumerate() {
            at.system.derivative(at.x, &[unit], &mut column)?;
            values[0] += column[i];
        }
        Ok(())
    }
    fn gradients(&mut self, at: At, rows: &mut [f64], _own: &mut [f64]) -> Result<(), Failure> {
        let mut row = vec![0.0; at.x.len()];
        rows.fill(0.0);
        for unit in &units(&at) {
            let of = Functional::First(&unit[..at.system.names().dimension()], unit);
            at.system.gradient(at.x, of, at.released, &mut row)?;
            rows.iter_mut().zip(&row).for_each(|(sum, entry)| *sum += entry);
        }
        Ok(())
    }
}

/// The test function: the sum of the eigenvalues where all of them are real.
struct SumOfEigenvalues;

impl TestFunction for SumOfEigenvalues {
    fn value(&self, _at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure> {
        let real = |spectrum: &&[(f64, f64)]| spectrum.iter().all(|l| l.1 == 0.0);
        let spectrum = known.spectrum.filter(real);
        Ok(spectrum.map(|spectrum| spectrum.iter().map(|l| l.0).sum()))
    }
    fn needs(&self) -> Needs {
        Needs::Eigenvalues
    }
}

fn traced() -> Branch {
    let mut system = Dense::new(BogdanovTakens);
    let curve = Continuation::new(&mut system).from(&[1.0, 0.0]).at("a", -1.0).at("b", -0.3);
    let event = Event::with_test("neutral saddle", NS, SumOfEigenvalues, || Trace);
    curve.along("a", -1.0..=1.0).event(event).trace().unwrap()
}

/// At `x = −b`, `a = −b²`. The Hopf point at `x = −√−a` has complex eigenvalues and is none.
#[test]
fn a_neutral_saddle_is_found_by_a_test_function_of_ones_own() {
    let branch = traced();
    assert_eq!(branch.of_kind(NS).count(), 1);
    let saddle = first(&branch, NS);
    assert!(saddle.converged);
    close(saddle.parameters[0], -0.09, 1e-13);
    close(saddle.state[0], 0.3, 1e-13);
    let refused = Document::new("own", vec![branch.clone()]).to_ron().unwrap_err();
    assert!(one_line(&refused).contains("must be a kind that the library knows"), "{refused}");
}

/// It is held along a curve as known kinds are: `a = −b²`.
#[test]
fn a_curve_of_neutral_saddles_is_followed() {
    let (branch, mut system) = (traced(), Dense::new(BogdanovTakens));
    let curve = Continuation::new(&mut system)
        .restart(&branch, first(&branch, NS).label)
        .hold_condition(|| Trace)
        .along("a", -1.0..=1.0)
        .along("b", -0.9..=-0.1)
        .trace()
        .unwrap();
    for point in &curve.points {
        close(point.parameters[0], -point.parameters[1].powi(2), 1e-9);
    }
    assert!(curve.points.len() > 5);
}
