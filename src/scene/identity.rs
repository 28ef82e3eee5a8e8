//! Identity of special points: decides whether special points of two branches are the same point.

use crate::core::continuation::{Branch, RootSearch, SpecialPoint};
use crate::core::system::{Kind, System};

/// Two grazings count as the same grazing if the relative difference of all corresponding numbers
/// is at most this value.
const SAME_GRAZING: f64 = 1e-7;

/// Returns whether two grazings on two branches are the same, by comparing the columns that both
/// branches have. Monitors that vanish on one of the branches are not compared: an approach speed
/// vanishes only on the branch whose orbits have the event. (At period doublings, the column `period` is
/// not compared, because the periods differ.)
pub(super) fn is_one_grazing(
    (branch, special): (&Branch, &SpecialPoint),
    (other, there): (&Branch, &SpecialPoint),
) -> bool {
    let value = |branch: &Branch, column: &str, special: &SpecialPoint| {
        branch.columns_showing(column).first().and_then(|k| special.value(*k))
    };
    let doubles = special.kind == Kind::PD && there.kind == Kind::PD;
    let error = ERRORS * (special.error + there.error);
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_GRAZING * a.abs().max(b.abs()) + error;
    let mut parameters = special.parameters.iter().zip(&there.parameters);
    if branch.parameters == other.parameters && !parameters.all(near) {
        return false;
    }
    branch.columns().filter(|column| !(doubles && *column == "period")).all(|column| {
        match (value(branch, column, special), value(other, column, there)) {
            (Some(a), Some(b)) if a.abs().min(b.abs()) > SAME_GRAZING => {
                (a - b).abs() <= SAME_GRAZING * a.abs().max(1.0)
            }
            _ => true,
        }
    })
}

/// Two special points can be the same point only if their continuation parameters differ by at most
/// this multiple of the sum of their errors, plus rounding errors.
const ERRORS: f64 = 10.0;
/// The rounding error of the values in a column, relative to the largest values on the branches.
const ROUNDING: f64 = 1e-12;

/// Two special points count as equal in a column if the difference of their values, relative to the
/// largest values on the branches, is at most this number; the continuation parameter is compared
/// differently.
const SAME: f64 = 1e-6;

/// Returns whether two special points, each on one of two branches, are the same point. The end of
/// a branch of orbits agrees with a Hopf point only to within the error of the point, because the
/// amplitude grows like a square root; the same applies to the end of a curve of folds of cycles at
/// a generalised Hopf point.
pub(super) fn is_one(
    (branch, point): (&Branch, &SpecialPoint),
    (other, there): (&Branch, &SpecialPoint),
) -> bool {
    // With two critical pairs, each curve has the frequency of its own pair.
    let own = match point.kind {
        Kind::PD => "period",
        Kind::HH => "hopf_frequency",
        _ => "",
    };
    let columns = branch.columns().filter(|column| *column != own);
    let both = columns.filter_map(|name| {
        let (here, elsewhere) = (branch.column(name)?, other.columns_showing(name));
        let (first, last) = (*elsewhere.first()?, *elsewhere.last()?);
        let spread = match point.kind {
            Kind::HB | Kind::GH => (there.value(first)? - there.value(last)?).abs(),
            _ => 0.0,
        };
        let difference = (point.value(here)? - there.value(first)?).abs() - spread;
        Some((name, difference, size(branch, here).max(size(other, first))))
    });
    let both: Vec<(&str, f64, f64)> = both.collect();
    // A column that is rounding noise along both branches, compared with other states, is ignored.
    // Parameters are kept, since their units are arbitrary.
    let of_states = both.iter().filter(|(name, ..)| !branch.parameters.iter().any(|p| p == name));
    let largest = of_states.fold(0.0, |most: f64, (_, _, size)| most.max(*size));
    both.iter().all(|(name, difference, size)| {
        let near = match branch.released.first().is_some_and(|released| released == name) {
            true => ERRORS * (point.error + there.error) + ROUNDING * size,
            false => SAME * size + ROUNDING * largest,
        };
        *difference <= near
    })
}

/// Returns the largest absolute value of a column along a branch.
pub(super) fn size(branch: &Branch, column: usize) -> f64 {
    let values = branch.points.iter().filter_map(|point| point.value(column));
    values.fold(0.0, |size: f64, value| size.max(value.abs()))
}

/// Returns whether a branch passes through a solution at the parameters `p`: the solution is one of
/// the branch's special points, or Newton's method converges to the solution from neighbouring
/// points of the branch.
pub(super) fn passes(branch: &Branch, system: &mut dyn System, p: &[f64], start: &[f64]) -> bool {
    let released = branch.released.first().and_then(|name| branch.column(name));
    let Some(column) = released.filter(|column| *column < p.len()) else { return false };
    let solutions: Vec<_> = branch.points.iter().filter_map(|it| it.solution.clone()).collect();
    let sizes: Vec<f64> = (0..start.len())
        .map(|k| solutions.iter().fold(start[k].abs(), |size, it| size.max(it.state[k].abs())))
        .map(|size| if size > 0.0 { size } else { 1.0 })
        .collect();
    let one = |z: &[f64]| {
        let mut all = z.iter().zip(start).zip(&sizes);
        all.all(|((a, b), size)| (a - b).abs() <= SAME * size)
    };
    let rounding = ROUNDING * size(branch, column);
    let here = |it: &&SpecialPoint| {
        (it.parameters[column] - p[column]).abs() <= ERRORS * it.error + rounding
    };
    if branch.special.iter().filter(here).any(|special| one(&special.state)) {
        return true;
    }
    solutions.windows(2).any(|pair| {
        let [from, to] = [&pair[0], &pair[1]].map(|it| it.parameters[column] - p[column]);
        if from * to > 0.0 {
            return false;
        }
        let part = if from == to { 0.0 } else { from / (from - to) };
        let between = pair[0].state.iter().zip(&pair[1].state);
        let z: Vec<f64> = between.map(|(a, b)| a + part * (b - a)).collect();
        let search = RootSearch::default();
        search.near(system, p, &z, &sizes).is_some_and(|z| one(&z))
    })
}
