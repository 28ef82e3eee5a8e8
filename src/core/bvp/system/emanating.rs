//! Cycles that emanate from equilibria at Hopf points, and special cycles (folds and torus points) whose
//! curves begin at points of codimension two.

use super::discretisation::DiscretisedProblem;
use super::equal_pairs;
use super::rest::{Mode, Rest};
use crate::core::failure::Failure;
use crate::core::system::{Kind, Site, Solution, Start};
use faer::c64;
use std::f64::consts::TAU;

/// Rounding: an inner product that enters a coefficient of a normal form counts as zero if it is
/// smaller than this fraction of the sum of the absolute values of its terms.
const DEGENERATE: f64 = 1e-9;

/// Heuristic: the largest relative difference between the vector field and its linearisation on the
/// first cycle of a curve: higher terms of the normal form are powers of this fraction.
const NONLINEAR: f64 = 0.1;

/// Heuristic: the largest number of halvings of the amplitude of the first cycle.
const HALVINGS: usize = 40;

/// The start of a branch of cycles.
pub(super) struct Emanating {
    pub start: Start,
    /// The reference motion of the phase condition, in the order of the unknowns `z`.
    pub motion: Vec<f64>,
}

/// The deviation `Re (v e^{2πiτ})` of small cycles from an equilibrium, where `v` is the eigenvector
/// of a critical pair.
struct Wave {
    /// The values of all unknowns at zero amplitude: all states are zero, and the period is the
    /// period of the critical pair.
    period: Vec<f64>,
    deviation: Vec<f64>,
    /// The time derivative of the deviation, up to a factor: the deviation a quarter of a period
    /// later.
    motion: Vec<f64>,
}

impl Wave {
    fn new(on: &DiscretisedProblem, pair: &Mode) -> Self {
        let zero = vec![0.0; on.layout.extras];
        let shifted = |shift: f64| {
            on.sampled(&zero, |_, tau, x| {
                let (sine, cosine) = (TAU * (tau + shift)).sin_cos();
                let parts = x.iter_mut().zip(&pair.vector);
                parts.for_each(|(x, v)| *x = v.re * cosine - v.im * sine);
            })
        };
        let mut deviation = shifted(0.0);
        // A branch begins in the direction in which its largest component grows.
        let largest = deviation.iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        if largest.is_some_and(|largest| *largest < 0.0) {
            deviation.iter_mut().for_each(|value| *value = -*value);
        }
        let period = vec![TAU / pair.value.im; on.layout.extras];
        Wave { period, deviation, motion: shifted(0.25) }
    }

    /// Returns the deviation as a direction in the space of all unknowns and parameters.
    fn direction(&self, parameters: usize) -> Vec<f64> {
        let mut direction = self.deviation.clone();
        direction.resize(self.deviation.len() + parameters, 0.0);
        direction
    }
}

/// Returns the orbit of zero amplitude at a Hopf point, `x* + ε Re(v e^{2πiτ})`, and the direction of its
/// branch in `ε`: `v` is the eigenvector of the vector field's Jacobian with the eigenvalue `iω`, and the
/// period is `2π/ω`. If several pairs of eigenvalues are equal, `solution.switch` selects one of the
/// eigenvectors in whose directions cycles emanate.
pub(super) fn at_hopf(on: &DiscretisedProblem, solution: &Solution) -> Result<Emanating, Failure> {
    let rest = Rest::new(on, solution)?;
    let pair = match solution.multiplicity {
        0 | 1 => rest.critical_pair(solution.frequency)?,
        count => {
            equal_pairs::direction(&rest, solution.frequency, count, solution.switch.unwrap_or(0))?
        }
    };
    let wave = Wave::new(on, &pair);
    let z = on.sampled(&wave.period, |_, _, x| x.copy_from_slice(rest.state));
    let direction = wave.direction(solution.parameters.len());
    let (site, one_sided) = (Site::Singular, true);
    let start = Start { site, one_sided, ..Start::point(z, Some(direction)) };
    Ok(Emanating { start, motion: wave.motion })
}

/// Returns a cycle near a generalised Hopf, a fold–Hopf or a double Hopf point, to first order in its
/// amplitude; this cycle is the guess at which a curve of folds or torus points of cycles begins. The
/// amplitude of the cycle is a fraction of the size of the equilibrium, or smaller if the vector field
/// is nonlinear at that distance. Newton's iteration corrects the cycle and the parameters, which differ
/// from the parameters of the point of codimension two by an amount proportional to the square of the
/// amplitude.
pub(super) fn beside(
    on: &DiscretisedProblem,
    solution: &Solution,
    part: f64,
) -> Result<Emanating, Failure> {
    let rest = Rest::new(on, solution)?;
    let units = rest.units();
    let normal = |mode: Mode| {
        let squares = mode.vector.iter().zip(&units).map(|(v, unit)| v.norm_sqr() / (unit * unit));
        let length = squares.sum::<f64>().sqrt();
        Mode { vector: mode.vector.iter().map(|v| v / length).collect(), ..mode }
    };
    let (pair, other) = match solution.kind {
        Kind::GH | Kind::ZH => (rest.critical_pair(solution.frequency)?, None),
        Kind::HH => {
            let (pair, other) = of_two_pairs(&rest, solution.switch.unwrap_or(0))?;
            (pair, Some(other))
        }
        kind => {
            return Err(Failure::Mismatch(format!(
                "no curve of bifurcations of cycles starts at a {}: the start must be a \
                 generalized Hopf (GH), fold–Hopf (ZH) or double Hopf point (HH)",
                kind.meaning()
            )));
        }
    };
    let pair = normal(pair);
    let amplitude = amplitude_of(&rest, &pair, part);
    let angle = match (solution.kind, other) {
        (Kind::ZH, _) => Some(angle_beside_fold(&rest, &pair, amplitude)?),
        // The angle, from 0 to π.
        (_, Some(other)) => Some((TAU * other / pair.value.im).cos().acos()),
        _ => None,
    };
    let wave = Wave::new(on, &pair);
    let mut z = on.sampled(&wave.period, |_, _, x| x.copy_from_slice(rest.state));
    z.iter_mut().zip(&wave.deviation).for_each(|(z, d)| *z += amplitude * d);
    let direction = wave.direction(solution.parameters.len());
    let (site, one_sided) = (Site::Beside, true);
    let start = Start { site, one_sided, angle, ..Start::point(z, Some(direction)) };
    Ok(Emanating { start, motion: wave.motion })
}

/// Returns the amplitude of the first cycle: a fraction of the size of the equilibrium, halved until the
/// vector field on the cycle is nearly linear.
fn amplitude_of(rest: &Rest, pair: &Mode, part: f64) -> f64 {
    let mut amplitude = part * rest.size();
    for _ in 0..HALVINGS {
        if rest.nonlinearity(&pair.vector, amplitude) <= NONLINEAR {
            break;
        }
        amplitude *= 0.5;
    }
    amplitude
}

/// Returns one of the two critical pairs of a double Hopf point, and the frequency of the other pair;
/// pair number 0 has the larger frequency.
fn of_two_pairs(rest: &Rest, which: usize) -> Result<(Mode, f64), Failure> {
    let mut pairs: [Mode; 2] = rest.critical_pairs(None)?;
    pairs.sort_by(|a, b| b.value.im.total_cmp(&a.value.im));
    let [first, second] = pairs;
    match which {
        0 => Ok((first, second.value.im)),
        1 => {
            let other = first.value.im;
            Ok((second, other))
        }
        _ => Err(Failure::no_branch(which, 2)),
    }
}

/// Returns the angle of the critical Floquet multipliers of the cycle that has the given amplitude near
/// a fold–Hopf point. With `v' = β₁ + G₀₁₁ |z|² + …`, `z' = (β₂ + iω + G₁₁₀ v + …) z`, deviations from
/// the cycle `v = 0`, `|z| = ρ` rotate with the frequency `ρ √(−2 G₀₁₁ Re G₁₁₀)`.
///
/// # Errors
/// [`Failure::Mismatch`] if the deviations from the cycle do not rotate.
fn angle_beside_fold(rest: &Rest, pair: &Mode, amplitude: f64) -> Result<f64, Failure> {
    let zero = rest.zero()?;
    let dot = |p: &[c64], f: &[c64]| -> c64 { p.iter().zip(f).map(|(p, f)| p * f).sum() };
    let conjugate: Vec<c64> = pair.vector.iter().map(c64::conj).collect();
    let g011 = dot(&rest.left(&zero)?, &rest.second(&pair.vector, &conjugate)).re;
    let g110 = dot(&rest.left(pair)?, &rest.second(&zero.vector, &pair.vector));
    let square = -2.0 * g011 * g110.re;
    if square <= DEGENERATE * (g011 * g110.norm_sqr().sqrt()).abs() {
        return Err(Failure::Mismatch(
            "no curve of torus points starts at this fold–Hopf point (ZH): the product s θ of its \
             normal-form coefficients is not negative"
                .into(),
        ));
    }
    let turns = 0.5 * amplitude * square.sqrt() * TAU / pair.value.im;
    Ok(turns.cos().acos())
}
