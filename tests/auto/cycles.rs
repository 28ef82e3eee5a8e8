//! Families of cycles: `ab`, `abc`, `plp`, `pp2`, `chu`, `lor`, `frc`, `lcbp`, `vhb`.

use crate::equilibria::{crossing, rest, settings};
use crate::fields::{Ab, Abc, Chu, Frc, Lcbp, Lor, Plp, Pp2, Vhb};
use crate::report::{Report, Variant, show};
use crate::{Case, Outcome, case};
use std::f64::consts::TAU;
use tangency::core::attractor::CycleSearch;
use tangency::core::bvp::{BoundarySystem, Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
use tangency::core::orbit::{Smooth, from_cycle, periodic_orbits};
use tangency::core::problem::VectorField;
use tangency::core::system::Kind;

pub const CASES: &[Case] = &[
    case("ab cycles", true, ".555", ab),
    case("pp2 cycles", true, ".034", pp2),
    case("abc cycles", true, ".083", abc),
    case("plp cycles", true, ".087", plp),
    case("chu cycles", true, ".036", chu),
    case("lor", true, ".032", lor),
    case("frc", true, ".010", frc),
    case("lcbp", true, "", lcbp),
    case("vhb", true, ".039", vhb),
];

type Traced = Result<Branch, Box<dyn std::error::Error>>;

fn orbits<F: VectorField + 'static>(
    field: F,
    intervals: usize,
    v: Variant,
) -> Result<BoundarySystem, Box<dyn std::error::Error>> {
    Ok(match v.shooting {
        false => periodic_orbits(field, intervals, Collocation::new(4)?)?,
        true => periodic_orbits(field, intervals.div_ceil(5), Shooting::default())?,
    })
}

/// The cycles from the Hopf point number `index` of a branch, as far as a period.
fn cycles<F: VectorField + 'static>(
    field: F,
    (branch, index): (&Branch, usize),
    along: (&str, [f64; 2]),
    (intervals, longest): (usize, f64),
    v: Variant,
) -> Traced {
    let label = branch.of_kind(Kind::HB).nth(index).ok_or("there are fewer Hopf points")?.label;
    let mut system = orbits(field, intervals, v)?;
    let curve =
        Continuation::new(&mut system).named(format!("cycles {index}")).settings(settings(v));
    let curve = curve.restart(branch, label).along(along.0, along.1[0]..=along.1[1]);
    Ok(curve.bound("period", 0.0..=longest).trace().inspect(show)?)
}

/// The period where a branch reaches a value of its parameter.
fn period_at(branch: &Branch, value: f64) -> Vec<f64> {
    let period = branch.column("period").unwrap_or(usize::MAX);
    let there =
        |s: &&tangency::core::continuation::SpecialPoint| (s.parameters[0] - value).abs() < 1e-9;
    branch.special.iter().filter(there).filter_map(|s| s.value(period)).collect()
}

fn ab(v: Variant, report: &mut Report) -> Outcome {
    for (b, period) in [(15.0, 1.726366510852), (16.0, 1.231621670242)] {
        let branch = rest(Ab, &[0.0; 2], &[("B", b)], ("D", [0.0, 0.25]), v)?;
        let family = cycles(Ab, (&branch, 0), ("D", [0.05, 0.25]), (40, 100.0), v)?;
        let found = period_at(&family, 0.25);
        report.claim(format!("B = {b}: one end at D = 0.25: {found:?}"), found.len() == 1);
        found.iter().for_each(|found| report.value("period at D = 0.25", *found, period, 1e-9));
        report.none(&family, &[Kind::PD, Kind::BP, Kind::TR]);
    }
    // Towards homoclinic orbits.
    let branch = rest(Ab, &[0.0; 2], &[("B", 18.0)], ("D", [0.0, 0.25]), v)?;
    for (index, limit) in [(0, 0.110828639), (1, 0.110113578)] {
        let family = cycles(Ab, (&branch, index), ("D", [0.05, 0.25]), (60, 100.0), v)?;
        let last = if family.ends[0].to_string().contains("period") {
            family.special.first()
        } else {
            family.special.last()
        };
        let found = last.map_or(f64::NAN, |s| s.parameters[0]);
        report.value("the homoclinic orbit", found, limit, 1e-6);
        report.none(&family, &[Kind::PD, Kind::BP, Kind::TR]);
    }
    Ok(())
}

fn pp2(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Pp2, &[0.0; 2], &[], ("p", [0.0, 1.0]), v)?;
    let prey = crossing(Pp2, &branch, 0, ("p", [0.0, 1.0]), v)?;
    let both = crossing(Pp2, &prey, 0, ("p", [0.0, 1.0]), v)?;
    let family = cycles(Pp2, (&both, 0), ("p", [0.0, 1.0]), (60, 36.0), v)?;
    report.points(&family, Kind::EP, "p", &[0.671593847478832, 0.7079409016571], 1e-9);
    report.none(&family, &[Kind::PD, Kind::BP, Kind::TR, Kind::LP]);
    Ok(())
}

fn abc(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Abc, &[0.0; 3], &[], ("D", [0.0, 0.4]), v)?;
    let folds = [0.21369736921861, 0.21190327712342, 0.22496206553865];
    // The first and the last Hopf point, and the second and the third, are the two ends of two
    // families.
    let expected: [&[f64]; 4] = [&folds[..2], &folds[2..], &folds[2..], &folds[..2]];
    for (index, folds) in expected.iter().enumerate() {
        let family = cycles(Abc, (&branch, index), ("D", [0.1, 0.4]), (40, 100.0), v)?;
        report.points(&family, Kind::LP, "D", folds, 1e-9);
        let hopf = family.of_kind(Kind::HB).count();
        report.claim(
            format!("{}: ends at another Hopf point ({hopf}): {:?}", family.name, family.ends),
            hopf == 1,
        );
    }
    Ok(())
}

fn plp(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Plp, &[45.55974, 177.7987], &[], ("rho", [1.0, 7.0]), v)?;
    let family = cycles(Plp, (&branch, 0), ("rho", [1.0, 7.0]), (20, 100.0), v)?;
    let folds = [2.7596874554986, 5.0078397607629];
    report.points(&family, Kind::LP, "rho", &folds, 1e-9);
    report.points(&family, Kind::HB, "rho", &[4.6504578126027], 2e-11);
    // Two-parameter curve of folds, which ends on the Hopf curve, where its first Lyapunov
    // coefficient vanishes.
    let label = family.of_kind(Kind::LP).next().ok_or("no fold")?.label;
    let mut system = orbits(Plp, 20, v)?;
    let curve = Continuation::new(&mut system)
        .named("folds")
        .settings(settings(v))
        .restart(&family, label)
        .hold(Kind::LP);
    let curve = curve
        .along("rho", 1.0..=10.0)
        .along("S0", 100.0..=120.0)
        .mark("S0", 109.0)
        .mark("S0", 111.0)
        .trace()
        .inspect(show)?;
    let loci = [2.5826425379503, 5.243321463524118, 2.98629481022161, 4.722125236368755];
    report.points(&curve, Kind::UZ, "rho", &loci, 1e-9);
    report.none(&curve, &[Kind::CP]);
    // The isola at S0 = 111.
    let at = curve
        .of_kind(Kind::UZ)
        .find(|s| (s.parameters[1] - 111.0).abs() < 1e-6)
        .ok_or("no fold at S0 = 111")?;
    let mut system = orbits(Plp, 20, v)?;
    let isola = Continuation::new(&mut system)
        .named("isola")
        .settings(settings(v))
        .restart(&curve, at.label);
    let isola = isola.along("rho", 1.0..=10.0).trace().inspect(show)?;
    report.ends(&isola, ["closed", "closed"]);
    let [a, b] = [2.98629481022161, 4.722125236368755];
    report.claim(
        "folds of the isola",
        isola
            .of_kind(Kind::LP)
            .all(|s| (s.parameters[0] - a).abs() < 1e-8 || (s.parameters[0] - b).abs() < 1e-8),
    );
    report.claim("no fold of the isola twice", isola.of_kind(Kind::LP).count() <= 2);
    Ok(())
}

fn chu(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Chu, &[1.5, 0.0, -1.5], &[], ("alpha", [5.0, 15.0]), v)?;
    let family = cycles(Chu, (&branch, 0), ("alpha", [5.0, 15.0]), (40, 3.0), v)?;
    let first = family.of_kind(Kind::PD).next().map_or(f64::NAN, |s| s.parameters[0]);
    report.value("period doubling", first, 8.1959921211786, 1e-9);
    Ok(())
}

fn lor(v: Variant, report: &mut Report) -> Outcome {
    let p = [280.0, 8.0 / 3.0, 10.0];
    let start = HybridState { mode: 0, time: 0.0, x: vec![-5.0, 10.0, 260.0] };
    let mut flow = HybridFlow::new(&Smooth(Lor), HybridSettings::default())?;
    let cycle = CycleSearch::default().find(&mut flow, start, &p)?;
    let (mut system, z) = match v.shooting {
        false => from_cycle(Smooth(Lor), &cycle, &p, Collocation::new(4)?, 40)?,
        true => from_cycle(Smooth(Lor), &cycle, &p, Shooting::default(), 8)?,
    };
    let along = 200.0..=290.0;
    let mut curve = Continuation::new(&mut system).named("1").settings(settings(v)).from(&z);
    for (name, value) in ["rho", "b", "sigma"].iter().zip(p) {
        curve = curve.at(name, value);
    }
    let mut branch = curve.along("rho", along.clone()).trace().inspect(show)?;
    let doublings = [229.40670856144, 218.21012777782, 215.96593063243];
    for (k, value) in doublings.into_iter().enumerate() {
        let first = branch.of_kind(Kind::PD).find(|s| (s.parameters[0] - value).abs() < 1e-3);
        let Some(point) = first else {
            report.claim(format!("period doubling at {value}"), false);
            return Ok(());
        };
        report.value("period doubling", point.parameters[0], value, 1e-9);
        let label = point.label;
        let curve = Continuation::new(&mut system)
            .named(format!("{}", 2 << k))
            .settings(settings(v))
            .restart(&branch, label)
            .switch();
        branch = curve.along("rho", along.clone()).trace().inspect(show)?;
    }
    Ok(())
}

fn frc(v: Variant, report: &mut Report) -> Outcome {
    // Without a force the first two rest, at (½, 0).
    let mut system = orbits(Frc, 40, v)?;
    let z = system.sampled(&[TAU / 100.0], |_, tau, x| {
        let (sine, cosine) = (TAU * tau).sin_cos();
        x.copy_from_slice(&[0.5, 0.0, cosine, -sine]);
    });
    let branch = Continuation::new(&mut system)
        .settings(settings(v))
        .from(&z)
        .at("beta", 100.0)
        .along("r", 0.0..=0.2)
        .trace()
        .inspect(show)?;
    report.none(&branch, &[Kind::LP, Kind::BP, Kind::PD, Kind::TR]);
    let period = period_at(&branch, 0.2);
    report.claim("reaches r = 0.2", period.len() == 1);
    period.iter().for_each(|found| report.value("period", *found, TAU / 100.0, 1e-9));
    Ok(())
}

fn lcbp(v: Variant, report: &mut Report) -> Outcome {
    let mut system = orbits(Lcbp, 20, v)?;
    let z = system.sampled(&[1.0], |_, tau, x| {
        let (sine, cosine) = (TAU * tau).sin_cos();
        (x[0], x[1]) = (cosine, sine);
    });
    let branch = Continuation::new(&mut system)
        .settings(settings(v))
        .from(&z)
        .at("p1", 1.0)
        .at("p2", 2.0)
        .along("p1", 0.5..=3.0)
        .trace()
        .inspect(show)?;
    report.points(&branch, Kind::BP, "p1", &[2.0], 1e-9);
    report.none(&branch, &[Kind::LP, Kind::PD, Kind::TR]);
    let label = branch.of_kind(Kind::BP).next().ok_or("no branch point")?.label;
    let other = Continuation::new(&mut system)
        .settings(settings(v))
        .restart(&branch, label)
        .switch()
        .along("p1", 0.5..=3.0)
        .trace()
        .inspect(show)?;
    let radius = branch.column("max_x").ok_or("no column max_x")?;
    let constant =
        other.special.iter().all(|s| (s.value(radius).unwrap_or(f64::NAN) - 2.0).abs() < 1e-7);
    report.claim("the other family has the radius p2", constant);
    Ok(())
}

fn vhb(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Vhb, &[0.0; 2], &[], ("p", [-0.5, 0.5]), v)?;
    report.points(&branch, Kind::HB, "p", &[0.0], 1e-9);
    let family = cycles(Vhb, (&branch, 0), ("p", [-0.5, 0.5]), (40, 30.0), v)?;
    let vertical = family.points.iter().all(|point| point.parameters[0].abs() < 1e-7);
    report.claim("the family is vertical", vertical);
    report.none(&family, &[Kind::LP, Kind::PD, Kind::BP, Kind::ND]);
    report.ends(&family, ["period", ""]);
    Ok(())
}
