//! The quantities that characterise a located special point: named numbers such as normal-form
//! coefficients, the type of the bifurcation that these numbers determine, and the sensitivities of
//! the point's location to other parameters.

use super::branch::{Number, Sensitivity, SpecialPoint};
use super::event::Event;
use super::extended::Extended;
use super::newton::Newton;
use super::persistence::{breaks_up, slope};
use crate::core::bifurcation::{At, Case, DefiningSystem, NormalForm, Quantity};
use crate::core::failure::Failure;
use crate::core::numerics::error_of_last;
use crate::core::system::Effort;

/// Heuristic: the number of samples of rounding errors from which the errors of named numbers are
/// estimated.
const SAMPLES: usize = 2;
/// Heuristic: the factor by which errors estimated from samples of rounding errors may be too small
/// by chance.
const CAUTION: f64 = 4.0;

/// Rounding: a sensitivity is zero up to rounding if it is smaller than this threshold, in units of
/// the rounding errors of its terms. A sensitivity is also zero up to rounding if a change of the
/// other parameter by its own size changes the released parameter by less than this threshold, in
/// units of the rounding error of the released parameter.
const NOISE: f64 = 16.0;

/// The named values (such as normal-form coefficients), the type and the sensitivities of a special
/// point.
#[derive(Clone, Debug, Default)]
pub(super) struct Meaning {
    pub numbers: Vec<Number>,
    /// Whether the library computes a normal form for special points of this kind.
    pub classified: bool,
    /// The type of the bifurcation, such as `supercritical`, determined by the normal-form
    /// coefficients.
    pub case: Option<Case>,
    pub sensitivities: Vec<Sensitivity>,
}

impl Meaning {
    /// Computes the named values, the type and the sensitivities at a solution of the defining
    /// system of an event; `equations` must contain this defining system. If solutions have no
    /// mesh, the errors of the named values are estimated from samples of rounding errors; if
    /// solutions have a mesh, from a refinement of the mesh. `scale` is the size of changes of the
    /// first released parameter.
    pub fn of(equations: &mut Extended, event: &Event, unknowns: &[f64], scale: f64) -> Self {
        let (values, case) = numbers(equations, event, unknowns);
        let mut errors: Vec<f64> =
            values.iter().map(|(_, value)| 4.0 * f64::EPSILON * value.abs()).collect();
        if !values.is_empty() && !equations.system().representation().is_on_mesh() {
            for (error, spread) in
                errors.iter_mut().zip(rounding(equations, event, (unknowns, scale), &values))
            {
                *error += CAUTION * spread;
            }
        }
        equations.load(unknowns);
        let named = values.into_iter().zip(errors);
        let named = named.map(|((name, value), error)| Number { name: name.into(), value, error });
        let classified = event.normal_form.is_some();
        Meaning { numbers: named.collect(), classified, case, sensitivities: Vec::new() }
    }

    /// Computes the sensitivities: the derivatives of the location of the special point with
    /// respect to other parameters.
    pub fn differentiate(&mut self, equations: &mut Extended, event: &Event, unknowns: &[f64]) {
        // A point at a level of the parameter keeps that value.
        if !matches!(event.test.level(), Some((Quantity::Parameter(_), _))) {
            let found = exactly(equations, |equations| sensitivities(equations, unknowns));
            self.sensitivities = found.unwrap_or_default();
            equations.load(unknowns);
        }
    }

    /// Computes the named values and the type of a special point that is located by bracketing. The
    /// error of a named value is its change from the special point to the point `beside`; the
    /// distance between these two points is the error of the location.
    pub fn beside(equations: &mut Extended, event: &Event, [at, beside]: [&[f64]; 2]) -> Self {
        if event.normal_form.is_none() {
            return Meaning::default();
        }
        let (values, case) = numbers(equations, event, at);
        let (others, _) = numbers(equations, event, beside);
        equations.load(at);
        let error = |name: &str, value: f64| {
            let other = others.iter().find(|(other, _)| *other == name);
            other.map_or(value.abs(), |(_, other)| (value - other).abs())
        };
        let number = |(name, value): (&str, f64)| {
            let error = error(name, value) + 4.0 * f64::EPSILON * value.abs();
            Number { name: name.into(), value, error }
        };
        let numbers = values.into_iter().map(number).collect();
        Meaning { numbers, classified: true, case, ..Meaning::default() }
    }

    /// Returns the named values that a special point currently contains.
    pub fn taken_from(special: &SpecialPoint) -> Self {
        Meaning { numbers: special.numbers.clone(), ..Meaning::default() }
    }

    /// Writes the named values, the type and the sensitivities into a special point.
    pub fn give_to(self, special: &mut SpecialPoint) {
        if self.classified {
            // A case is unknown if a determining coefficient is no larger than its error.
            let certain = |name: &&str| {
                let number = self.numbers.iter().find(|number| number.name == *name);
                number.is_some_and(|number| number.error < number.value.abs())
            };
            let case = self.case.filter(|case| case.decided_by.iter().all(certain));
            special.subkind = case.map(|case| case.word.to_owned());
        }
        (special.numbers, special.sensitivities) = (self.numbers, self.sensitivities);
    }

    /// Estimates the errors of the named values by comparison with their values on coarser
    /// discretisations, which are listed from the coarsest to the finest. A named value that is
    /// missing on one of the coarser discretisations is removed.
    pub fn after(mut self, coarser: &[Meaning]) -> Self {
        self.numbers.retain_mut(|number| {
            let of = |meaning: &Meaning| {
                meaning.numbers.iter().find(|other| other.name == number.name).map(|it| it.value)
            };
            let Some(mut series) = coarser.iter().map(of).collect::<Option<Vec<f64>>>() else {
                return false;
            };
            series.push(number.value);
            number.error += error_of_last(&series);
            true
        });
        self
    }
}

/// Returns the named auxiliary unknowns of the event, the coefficients of its normal form, and the
/// type that the coefficients determine.
fn numbers(
    equations: &mut Extended,
    event: &Event,
    unknowns: &[f64],
) -> (Vec<(&'static str, f64)>, Option<Case>) {
    equations.load(unknowns);
    let names = event.condition.as_ref().map_or(&[][..], |make| make().names());
    let recorded: Vec<f64> = equations.recorded().collect();
    let own = names.iter().copied().zip(recorded[recorded.len() - names.len()..].iter().copied());
    let mut values: Vec<(&'static str, f64)> = own.collect();
    let form = event.normal_form.and_then(|compute| compute(&mut equations.at()).ok());
    let NormalForm { coefficients, case } = form.unwrap_or_default();
    values.extend(coefficients.into_iter().filter(|(_, value)| value.is_finite()));
    (values, case)
}

/// Estimates the changes of the named values due to the rounding errors of the special point. The
/// rounding error of a parameter near zero is not smaller than the rounding error of the parameter's
/// changes, whose size is `scale`.
fn rounding(
    equations: &mut Extended,
    event: &Event,
    (unknowns, scale): (&[f64], f64),
    values: &[(&'static str, f64)],
) -> Vec<f64> {
    let parameter = equations.parameters_at();
    let mut spreads = vec![0.0_f64; values.len()];
    let Ok(samples) = Newton::default().rounding(equations, None, unknowns, SAMPLES) else {
        return values.iter().map(|(_, value)| value.abs()).collect();
    };
    for mut noise in samples {
        let least = f64::EPSILON * scale;
        noise[parameter] = noise[parameter].abs().max(least).copysign(noise[parameter]);
        let beside: Vec<f64> = unknowns.iter().zip(noise).map(|(x, d)| x + d).collect();
        let others = numbers(equations, event, &beside).0;
        for (spread, (name, value)) in spreads.iter_mut().zip(values) {
            // A number that is not found again has no accurate digit.
            let other = others.iter().find(|(other, _)| other == name);
            let change = other.map_or(value.abs(), |(_, other)| (value - other).abs());
            *spread = spread.max(change);
        }
    }
    spreads
}

/// Computes the derivatives of the released parameters at a special point with respect to every
/// other parameter, as far as these derivatives exist. The defining system `G(X, p) = 0` implies
/// `dX/dp = −G_X⁻¹ G_p`.
fn sensitivities(equations: &mut Extended, unknowns: &[f64]) -> Result<Vec<Sensitivity>, Failure> {
    let (n, first) = (equations.dimension(), equations.parameters_at());
    let mut room = vec![0.0; unknowns.len()];
    equations.residual(unknowns, None, &mut room)?;
    equations.factor(None)?;
    let adjoint = |position: usize| {
        let mut weights = vec![0.0; unknowns.len()];
        weights[position] = 1.0;
        equations.factors.solve_transposed(&mut weights);
        weights
    };
    let released: Vec<Vec<f64>> = (first..unknowns.len()).map(adjoint).collect();
    let gradients = gradients(equations)?;
    let names = equations.names().parameters.clone();
    let (mut all, varying) = (Vec::new(), equations.released.clone());
    let values = equations.at().x[n..].to_vec();
    for (p, name) in names.into_iter().enumerate().filter(|(p, _)| !varying.contains(p)) {
        if slope(equations, p, &mut room[..n]).is_err() {
            continue;
        }
        let breaks_up = breaks_up(equations, p, &room[..n]).unwrap_or(true);
        let of_conditions = gradients.iter().map(|gradient| gradient[n + p]);
        room[n..].iter_mut().zip(of_conditions).for_each(|(slope, own)| *slope = own);
        let along =
            |weights: &Vec<f64>| -> f64 { weights.iter().zip(&room).map(|(w, g)| -w * g).sum() };
        let slope = |(weights, of): (&Vec<f64>, &usize)| {
            let (slope, rounding) = (along(weights), NOISE * f64::EPSILON);
            let terms: f64 = weights.iter().zip(&room).map(|(w, g)| (w * g).abs()).sum();
            let change = (slope * values[p]).abs();
            let unseen = change > 0.0 && change <= rounding * values[*of].abs();
            if slope.abs() <= rounding * terms || unseen { 0.0 } else { slope }
        };
        let slopes: Vec<f64> = released.iter().zip(&varying).map(slope).collect();
        if !breaks_up && slopes.iter().all(|slope| slope.is_finite()) {
            all.push(Sensitivity { by: name, slopes });
        }
    }
    Ok(all)
}

/// Calls a function while exact gradients are enabled.
fn exactly<T>(equations: &mut Extended, compute: impl FnOnce(&mut Extended) -> T) -> T {
    let cancel = equations.cancel.clone();
    let set = |equations: &mut Extended, exact_gradients| {
        if let Some(system) = equations.system().discretised() {
            system.set_effort(Effort { error: 0.0, exact_gradients, cancel: &cancel });
        }
    };
    set(equations, true);
    let outcome = compute(equations);
    set(equations, false);
    outcome
}

/// Computes the gradients of all held defining systems with respect to `x`, including every
/// parameter.
fn gradients(equations: &mut Extended) -> Result<Vec<Vec<f64>>, Failure> {
    let Extended { system, x, conditions, auxiliary, null, .. } = equations;
    let all: Vec<usize> = (0..system.names().parameters.len()).collect();
    let mut at = At { system: &mut **system, x, released: &all, held: auxiliary, null };
    let mut gradients = Vec::new();
    for condition in conditions {
        let k = condition.unknowns();
        let (mut rows, mut own) = (vec![0.0; (k + 1) * at.x.len()], vec![0.0; (k + 1) * k]);
        if condition.gradients(at.again(), &mut rows, &mut own).is_err() {
            one_by_one(&mut **condition, at.again(), &mut rows);
        }
        gradients.extend(rows.chunks_exact(at.x.len()).map(<[f64]>::to_vec));
    }
    Ok(gradients)
}

/// Computes the derivatives of a defining system with respect to each parameter separately; a
/// derivative that does not exist is NaN.
fn one_by_one(condition: &mut dyn DefiningSystem, mut at: At, rows: &mut [f64]) {
    let (k, length, n) = (condition.unknowns(), at.x.len(), at.system.names().dimension());
    let (mut alone, mut own) = (vec![0.0; rows.len()], vec![0.0; (k + 1) * k]);
    for p in 0..length - n {
        let At { system, x, held, null, .. } = at.again();
        let by = At { system, x, released: &[p], held, null };
        let known = condition.gradients(by, &mut alone, &mut own).is_ok();
        let rows = rows.chunks_exact_mut(length).zip(alone.chunks_exact(length));
        rows.for_each(|(row, alone)| row[n + p] = if known { alone[n + p] } else { f64::NAN });
    }
}

/// Computes the largest variations of the released parameters at a special point, to first order,
/// when other parameters vary within their tolerances.
pub(super) fn spreads(
    sensitivities: &[Sensitivity],
    tolerances: &[(String, f64)],
    released: &[&str],
) -> Vec<Number> {
    let others = tolerances.iter().filter(|(name, _)| !released.contains(&&name[..]));
    let find = |name: &str| sensitivities.iter().find(|it| it.by == name);
    let known = others.map(|(name, tolerance)| Some((find(name)?, *tolerance)));
    // If one sensitivity is missing, no bound is known.
    let known: Option<Vec<(&Sensitivity, f64)>> = known.collect();
    let Some(known) = known.filter(|known| !known.is_empty()) else { return Vec::new() };
    let spread = |(k, name): (usize, &&str)| {
        let terms = known.iter().map(|(it, tolerance)| it.slopes[k].abs() * tolerance);
        let value: f64 = terms.sum();
        Number { name: format!("spread_{name}"), value, error: 4.0 * f64::EPSILON * value }
    };
    let all = released.iter().enumerate().map(spread);
    all.collect()
}
