//! Boundary-value problems: `exp`, `ezp`, `int`, `bvp`, `lin`, `obv`.

use crate::boundary::{Bvp, Exp, Ezp, Int, Lin, Obv};
use crate::equilibria::settings;
use crate::report::{Report, Variant, show};
use crate::{Case, Outcome, case};
use std::f64::consts::PI;
use tangency::core::bvp::{BoundaryProblem, BoundarySystem, Collocation, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::system::Kind;

pub const CASES: &[Case] = &[
    case("exp", true, ".018", exp),
    case("ezp", true, "", ezp),
    case("int", true, ".010", int),
    case("bvp", true, ".079", bvp),
    case("lin", true, ".005", lin),
    case("obv", true, ".047", obv),
];

type Discretised = Result<BoundarySystem, Box<dyn std::error::Error>>;

/// A problem on some twenty intervals, or, by shooting, on a few.
fn discretised(problem: impl BoundaryProblem + 'static, v: Variant) -> Discretised {
    Ok(match v.shooting {
        false => BoundarySystem::new(problem, Collocation::new(4)?, vec![Mesh::uniform(20)])?,
        true => BoundarySystem::new(problem, Shooting::default(), vec![Mesh::uniform(4)])?,
    })
}

/// The values of a column at the points of a kind.
fn column(branch: &Branch, kind: Kind, name: &str) -> Vec<f64> {
    let column = branch.column(name).unwrap_or(usize::MAX);
    branch.of_kind(kind).filter_map(|s| s.value(column)).collect()
}

const BRATU: f64 = 3.513_830_719_125_161;

fn exp(v: Variant, report: &mut Report) -> Outcome {
    let mut system = discretised(Exp, v)?;
    let curve = Continuation::new(&mut system).settings(settings(v)).along("lambda", 0.0..=4.0);
    let marks = [0.5, 1.0, 2.0, 3.0];
    let curve = marks.iter().fold(curve, |curve, mark| curve.mark("lambda", *mark));
    let branch = curve.bound("slope", -1.0..=12.0).trace().inspect(show)?;
    report.points(&branch, Kind::LP, "lambda", &[BRATU], 1e-9);
    report.points(&branch, Kind::LP, "slope", &[4.0], 1e-7);
    report.points(&branch, Kind::LP, "max_u", &[1.186_842_168_634_389], 1e-7);
    report.none(&branch, &[Kind::BP]);
    let slopes = [
        0.2612773103,
        0.5493527287754,
        10.84689901939,
        1.248217517758,
        8.268763180545,
        2.319602258082,
        6.103381294149,
    ];
    report.points(&branch, Kind::UZ, "slope", &slopes, 1e-9);
    Ok(())
}

fn ezp(v: Variant, report: &mut Report) -> Outcome {
    let mut system = discretised(Ezp, v)?;
    let branch = Continuation::new(&mut system)
        .settings(settings(v))
        .along("lambda", 0.0..=4.0)
        .bound("real_slope", -1.0..=8.0)
        .trace()
        .inspect(show)?;
    // The fold of real solutions is where the complex ones begin.
    report.points(&branch, Kind::BP, "lambda", &[BRATU], 1e-9);
    let label = branch.of_kind(Kind::BP).next().ok_or("no branch point")?.label;
    let complex = Continuation::new(&mut system)
        .settings(settings(v))
        .restart(&branch, label)
        .switch()
        .along("lambda", 3.0..=7.0)
        .mark("lambda", 5.0)
        .mark("lambda", 6.0)
        .trace()
        .inspect(show)?;
    let found = column(&complex, Kind::UZ, "imaginary_slope");
    report.claim(format!("both conjugate solutions at λ = 5 and 6: {found:?}"), found.len() == 4);
    for slope in column(&complex, Kind::UZ, "imaginary_slope") {
        let expected = if slope.abs() < 3.2 { 2.916033667591 } else { 3.642839949206 };
        report.value("imaginary slope", slope.abs(), expected, 1e-9);
    }
    Ok(())
}

fn int(v: Variant, report: &mut Report) -> Outcome {
    let mut system = discretised(Int, v)?;
    let branch = Continuation::new(&mut system)
        .settings(settings(v))
        .along("p1", 0.0..=20.0)
        .mark("p1", 1.0)
        .mark("p1", 3.0)
        .bound("slope", -1.0..=20.0)
        .trace()
        .inspect(show)?;
    report.points(&branch, Kind::LP, "p1", &[11.92379020065], 1e-9);
    report.points(&branch, Kind::LP, "slope", &[9.145559583865], 1e-7);
    let slopes = column(&branch, Kind::UZ, "slope");
    for expected in [0.5003619752776, 1.510765361061] {
        let nearest = slopes
            .iter()
            .copied()
            .min_by(|a, b| (a - expected).abs().total_cmp(&(b - expected).abs()));
        report.value("slope at a mark", nearest.unwrap_or(f64::NAN), expected, 1e-9);
    }
    Ok(())
}

fn bvp(v: Variant, report: &mut Report) -> Outcome {
    let mut system = discretised(Bvp, v)?;
    let trivial = Continuation::new(&mut system)
        .settings(settings(v))
        .at("p", 0.5)
        .along("p", 0.5..=5.5)
        .trace()
        .inspect(show)?;
    report.points(&trivial, Kind::BP, "p", &[1.0, 2.0, 3.0, 4.0, 5.0], 1e-9);
    report.none(&trivial, &[Kind::LP]);
    let folds: [&[f64]; 5] = [&[], &[], &[2.963138883409], &[], &[4.97820997755]];
    // Where the mean is 3.
    let at_three: [&[f64]; 5] = [
        &[1.184202139348],
        &[2.121777755886, 2.121777755886],
        &[3.069920060602, 3.138432665113],
        &[4.062685350881, 4.062685350881],
        &[5.04249302281, 5.084626217752],
    ];
    for (k, label) in trivial.of_kind(Kind::BP).map(|s| s.label).enumerate() {
        let mut system = discretised(Bvp, v)?;
        let branch = Continuation::new(&mut system)
            .named(format!("{}", k + 1))
            .settings(settings(v))
            .restart(&trivial, label)
            .switch()
            .along("p", 0.0..=5.5)
            .bound("mean", -8.0..=3.0)
            .trace()
            .inspect(show)?;
        report.points(&branch, Kind::LP, "p", folds[k], 1e-9);
        let ends: Vec<f64> = [branch.special.first(), branch.special.last()]
            .into_iter()
            .flatten()
            .filter(|s| (s.monitors[0] - 3.0).abs() < 1e-9)
            .map(|s| s.parameters[0])
            .collect();
        let expected = at_three[k];
        report.claim(
            format!("branch {}: ends {:?} at mean 3, found {ends:?}", k + 1, expected),
            ends.len() == expected.len(),
        );
        for (found, expected) in sorted(&ends).iter().zip(expected) {
            report.value("p where the mean is 3", *found, *expected, 1e-9);
        }
    }
    Ok(())
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values
}

fn lin(v: Variant, report: &mut Report) -> Outcome {
    let mut system = discretised(Lin, v)?;
    let trivial = Continuation::new(&mut system)
        .settings(settings(v))
        .at("p", 0.5)
        .along("p", 0.5..=5.5)
        .trace()
        .inspect(show)?;
    report.points(&trivial, Kind::BP, "p", &[1.0, 2.0, 3.0, 4.0, 5.0], 1e-9);
    let label = trivial.of_kind(Kind::BP).next().ok_or("no branch point")?.label;
    let mode = Continuation::new(&mut system)
        .settings(settings(v))
        .restart(&trivial, label)
        .switch()
        .along("p", 0.5..=5.5)
        .bound("norm", -1.0..=1.0)
        .trace()
        .inspect(show)?;
    // A vertical branch: p stays 1, and no other point is special.
    report.points(&mode, Kind::EP, "p", &[1.0, 1.0], 1e-9);
    report.none(&mode, &[Kind::LP]);
    for slope in column(&mode, Kind::EP, "slope") {
        report.value("slope where ∫u² = 1", slope.abs(), 2.0_f64.sqrt() * PI, 1e-9);
    }
    Ok(())
}

fn obv(v: Variant, report: &mut Report) -> Outcome {
    let mut system = discretised(Obv, v)?;
    let z = system.sampled(&[0.001, 0.0, 0.0, 0.0, 0.0], |_, _, x| x.fill(0.0));
    let state = Continuation::new(&mut system)
        .settings(settings(v))
        .from(&z)
        .at("J", 1.0)
        .along("J", 0.2..=2.0)
        .bound("l1", 0.0..=4.0)
        .trace()
        .inspect(show)?;
    report.points(&state, Kind::BP, "J", &[0.9234459151787, 1.425255022779, 1.3262677802], 1e-9);
    let label = state.of_kind(Kind::BP).next().ok_or("no branch point")?.label;
    let adjoint = Continuation::new(&mut system)
        .settings(settings(v))
        .restart(&state, label)
        .switch()
        .along("J", 0.2..=2.0)
        .bound("a15", -1.5..=1.5)
        .mark("a15", 1.0)
        .trace()
        .inspect(show)?;
    report.none(&adjoint, &[Kind::LP]);
    let label = adjoint.of_kind(Kind::UZ).next().ok_or("no mark on the adjoint branch")?.label;
    let free = Continuation::new(&mut system)
        .settings(settings(v))
        .restart(&adjoint, label)
        .hold_level("a15", 1.0)
        .along("l2", -1.0..=3.0)
        .along("J", 0.2..=2.0)
        .trace()
        .inspect(show)?;
    report.claim("the extremum is followed in l2", free.points.len() > 3);
    Ok(())
}
