//! Changes of stability that no event explains: several eigenvalues that pass at one point, as
//! symmetries make them do, or points of a kind that was not looked for.

use super::located::Located;
use super::stepper::{Place, Step, Stepper};
use super::test_values::turns;
use super::{Kind, SpecialPoint};
use crate::core::bifurcation::catalogue;
use crate::core::extended::Closing;
use crate::core::interpolation::lagrange;
use crate::core::motion::{Critical, Stability, neutral, without_critical};
use crate::core::zero::Dynamics;
use std::ops::RangeInclusive;

/// Steps in which the number of unstable eigenvalues changes without a reason are halved down to
/// this length, in scaled arclength.
pub(super) const LEAST_UNEXPLAINED: f64 = 1e-3;

impl Stepper<'_> {
    /// By how much the number of unstable eigenvalues changes in a step, unless the events found in
    /// it, or the special point that it starts from, explain that.
    pub fn unexplained(
        &self,
        from: &Place,
        step: &Step,
        found: &[Located],
        origin: &[Kind],
    ) -> Option<isize> {
        let branch_points = found.iter().filter(|it| it.special.kind == Kind::BP).count();
        let flips = self.branch_points().is_some_and(|i| turns(from.tests[i], step.place.tests[i]));
        let crossings = step.crossings.count;
        let odd = !crossings.is_multiple_of(2);
        // At a point of higher multiplicity Newton's iteration does not converge.
        let unsure = found.iter().any(|it| it.special.kind == Kind::BP && !it.special.converged);
        if crossings > branch_points.max(1) || crossings > 0 && (odd != flips || unsure) {
            return Some(crossings as isize);
        }
        let (before, after) = (from.point.unstable?, step.place.point.unstable?);
        let change = after as isize - before as isize;
        let passed = found.iter().map(|located| located.special.kind);
        let passed = passed.chain(origin.iter().copied());
        let mut reachable = vec![0_isize];
        for kind in passed {
            // A multiplier passes through infinity, or the solution is another one beyond.
            if matches!(kind, Kind::G | Kind::MX) {
                return None;
            }
            let changes = catalogue::row(kind).map_or(&[][..], |row| row.critical.changes());
            if changes.is_empty() {
                continue;
            }
            let sums = reachable.iter().flat_map(|sum| changes.iter().map(move |c| sum + c));
            reachable = sums.collect();
        }
        (!reachable.contains(&change)).then_some(change)
    }

    /// Whether a step that can be shortened ends on a special point itself, but for rounding, where
    /// signs say nothing.
    pub fn ends_on_special_point(&mut self, from: &Place, step: &Step) -> bool {
        let dynamics = self.equations.system().dynamics();
        let count = |place: &Place| place.spectrum.as_ref().map(|all| neutral(dynamics, all));
        let more = matches!((count(from), count(&step.place)), (Some(a), Some(b)) if b > a);
        step.length > LEAST_UNEXPLAINED && (step.crossings.singular || more)
    }
}

/// Where in a step, in units of it, eigenvalues are looked at: not at its ends and middle, where
/// symmetric problems may be singular.
const SAMPLES: [f64; 5] = [0.03, 0.22, 0.517, 0.76, 0.96];

/// Zeros in a step, in units of it, which may begin or end with one.
const ENDS: RangeInclusive<f64> = -1e-6..=1.0 + 1e-6;

/// Zeros of eigenvalues this near to each other, in units of the step, are one.
const TOGETHER: f64 = 1e-3;

impl Stepper<'_> {
    /// The point in a small step at which eigenvalues pass unexplained.
    pub fn unclassified(&mut self, from: &Place, step: &Step, change: isize) -> Option<Located> {
        self.passing(from, step, change).or_else(|| self.nameless(from, step))
    }

    /// The middle of a step in which something passes of which no more is known.
    fn nameless(&mut self, from: &Place, step: &Step) -> Option<Located> {
        let event = "eigenvalues pass, and no event explains it";
        let Located { along, unknowns, special, .. } =
            self.between((Kind::ND, event), from, &step.place, step.length);
        let error = special.error + self.mesh_share(&unknowns);
        self.equations.assemble(&unknowns).ok()?;
        let (point, _) = self.record(false).ok()?;
        let profiles = self.profiles();
        let parameter = self.equations.parameters_at();
        let bracket = [from, &step.place].map(|place| place.unknowns[parameter]);
        let special = self.special(Kind::ND, event, point, &[], (&unknowns, &from.tangent));
        let special = SpecialPoint { error, bracket, converged: false, profiles, ..special };
        Some(Located { event: None, along, unknowns, special })
    }

    /// The point at which several eigenvalues vanish together: where their mean vanishes on the
    /// polynomial through several points of the branch.
    ///
    /// The equations of the branch are singular there; beside it they are not.
    fn passing(&mut self, from: &Place, step: &Step, change: isize) -> Option<Located> {
        let places = self.samples(from, step)?;
        let abscissae: Vec<f64> = SAMPLES.iter().map(|s| s * step.length).collect();
        let (count, growth) = self.vanishing(&places, step.length, change.unsigned_abs())?;
        let mean: Vec<f64> =
            growth.iter().map(|all| all.iter().sum::<f64>() / count as f64).collect();
        let along = root(&abscissae, &mean, step.length)?;
        // Without the first sample, to know how well it is known.
        let rougher = root(&abscissae[1..], &mean[1..], step.length)?;
        let each = (0..count).filter_map(|k| {
            let values: Vec<f64> = growth.iter().map(|all| all[k]).collect();
            root(&abscissae, &values, step.length)
        });
        let spread = each.fold(0.0, |most: f64, zero| most.max((zero - along).abs()));
        let dynamics = self.equations.system().dynamics();
        let mut spectra = places.iter().filter_map(|place| place.spectrum.as_deref());
        let real = spectra.all(|spectrum| is_real(spectrum, count, dynamics));
        let multiple = count > 1 && real && spread <= TOGETHER * step.length;
        let unknowns: Vec<f64> = (0..from.unknowns.len())
            .map(|i| {
                let values: Vec<f64> = places.iter().map(|place| place.unknowns[i]).collect();
                interpolated(&abscissae, &values, along)
            })
            .collect();
        let parameter = self.equations.parameters_at();
        let slope = (step.place.unknowns[parameter] - from.unknowns[parameter]).abs() / step.length;
        let place = slope * (4.0 * (along - rougher).abs() + spread) + self.parameter_error();
        let share = match places[0].spectrum {
            Some(_) => self.mesh_share(&unknowns),
            None => slope * self.shift_on_finer(&places[0], count)?,
        };
        let error = place + share;
        let kind = if multiple { Kind::BP } else { Kind::ND };
        let (sides, multiplicity) = ([from, &step.place], if multiple { count } else { 1 });
        let special = self.record_unclassified(kind, &unknowns, sides, count)?;
        let bracket = sides.map(|place| place.unknowns[parameter]);
        let special = SpecialPoint { error, bracket, multiplicity, converged: multiple, ..special };
        Some(Located { event: None, along, unknowns, special })
    }

    /// Numbers that vanish with the eigenvalues that pass in a step, at places in it, in order, and
    /// how many: growth rates, or where no eigenvalues are known the distances to singular
    /// matrices, those that lie in the step.
    fn vanishing(
        &mut self,
        places: &[Place],
        length: f64,
        change: usize,
    ) -> Option<(usize, Vec<Vec<f64>>)> {
        let dynamics = self.equations.system().dynamics();
        if places[0].spectrum.is_some() {
            let rates = places.iter().map(|place| {
                nearest(place.spectrum.as_deref().unwrap_or_default(), change, dynamics)
            });
            return Some((change, rates.collect()));
        }
        let distances: Option<Vec<Vec<f64>>> =
            places.iter().map(|place| self.distances(place)).collect();
        let mut distances = distances?;
        let inside = |d: &&f64| ENDS.contains(&(SAMPLES[0] + *d / length));
        let count = distances[0].iter().filter(inside).count();
        for at in &mut distances {
            if at.len() < count {
                return None;
            }
            at.truncate(count);
            at.sort_by(f64::total_cmp);
        }
        (count > 0).then_some((count, distances))
    }

    /// Corrected points of the branch in a step.
    fn samples(&mut self, from: &Place, step: &Step) -> Option<Vec<Place>> {
        let row = self.covector(&from.tangent);
        let mut places = Vec::new();
        for share in SAMPLES {
            let ends = from.unknowns.iter().zip(&step.place.unknowns);
            let mut unknowns: Vec<f64> = ends.map(|(a, b)| a + share * (b - a)).collect();
            let length = share * step.length;
            let closing = Closing { row: &row, base: &from.unknowns, length };
            self.correct(&mut unknowns, closing).ok()?;
            let stability = self.wants_stability();
            places.push(self.arrive(unknowns, &row, f64::INFINITY, stability).ok()?);
        }
        Some(places)
    }

    fn record_unclassified(
        &mut self,
        kind: Kind,
        unknowns: &[f64],
        [from, to]: [&Place; 2],
        count: usize,
    ) -> Option<SpecialPoint> {
        self.equations.assemble(unknowns).ok()?;
        let (mut point, spectrum) = self.record(self.wants_stability()).ok()?;
        let dynamics = self.equations.system().dynamics();
        if let Some(spectrum) = &spectrum {
            let others = without_critical(spectrum, count, |l| rate(l, dynamics).abs());
            point.unstable = Some(Stability::of(dynamics, &others).unstable);
        }
        let spectrum = spectrum.unwrap_or_default();
        let event = match kind {
            Kind::BP => format!("branch point: {count} eigenvalues vanish"),
            _ => format!("{count} eigenvalues pass, and no event explains it"),
        };
        let tangent: Vec<f64> =
            from.tangent.iter().zip(&to.tangent).map(|(a, b)| 0.5 * (a + b)).collect();
        let profiles = self.profiles();
        let special = self.special(kind, &event, point, &spectrum, (unknowns, &tangent));
        Some(SpecialPoint { profiles, ..special })
    }
}

/// The rate of growth: the real part of an eigenvalue, the logarithm of a multiplier's modulus.
fn rate(&(re, im): &(f64, f64), dynamics: Dynamics) -> f64 {
    if dynamics == Dynamics::Periodic { re.hypot(im).ln() } else { re }
}

/// The `count` rates of growth nearest to zero, in order.
fn nearest(spectrum: &[(f64, f64)], count: usize, dynamics: Dynamics) -> Vec<f64> {
    let mut rates: Vec<f64> = spectrum.iter().map(|l| rate(l, dynamics)).collect();
    rates.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    rates.resize(count, 0.0);
    rates.sort_by(f64::total_cmp);
    rates
}

/// Whether the eigenvalues nearest to the stability boundary are real, and multipliers positive.
fn is_real(spectrum: &[(f64, f64)], count: usize, dynamics: Dynamics) -> bool {
    let distance = |l: &&(f64, f64)| Critical::One.distance(dynamics, l);
    let mut order: Vec<&(f64, f64)> = spectrum.iter().collect();
    order.sort_by(|a, b| rate(a, dynamics).abs().total_cmp(&rate(b, dynamics).abs()));
    let largest = order.iter().take(count).fold(0.0, |most: f64, l| most.max(distance(l)));
    order.iter().take(count).all(|l| l.1.abs() <= 1e-3 * largest.max(1e-6))
}

/// The polynomial through these values (Lagrange), at a place.
pub(super) fn interpolated(abscissae: &[f64], values: &[f64], at: f64) -> f64 {
    values.iter().enumerate().map(|(k, value)| lagrange(abscissae, k, at) * value).sum()
}

/// The zero, in a step of this length, of the polynomial through values of which the first and the
/// last one differ in sign, by the secant method.
fn root(abscissae: &[f64], values: &[f64], length: f64) -> Option<f64> {
    let line = |a: f64, fa: f64, b: f64, fb: f64| a - fa * (b - a) / (fb - fa);
    let last = values.len() - 1;
    let (mut a, mut fa) = (abscissae[0], values[0]);
    let mut b = line(a, fa, abscissae[last], values[last]);
    for _ in 0..30 {
        let fb = interpolated(abscissae, values, b);
        if fb == 0.0 || (b - a).abs() <= 1e-15 * length {
            break;
        }
        (a, fa, b) = (b, fb, line(a, fa, b, fb));
    }
    ENDS.contains(&(b / length)).then_some(b)
}
