//! Equilibria: `ab`, `pp2`, `ppp`, `abc`, `plp`, `enz`, `chu`, `cusp`.

use crate::fields::{Ab, Abc, Chu, Cusp, Enz, Plp, Pp2, Ppp};
use crate::report::{Report, Variant, show};
use crate::{Case, Outcome, case};
use tangency::core::continuation::{Branch, Continuation, Settings, TraceError};
use tangency::core::problem::{Equilibria, VectorField};
use tangency::core::system::{Dense, Kind};

pub const CASES: &[Case] = &[
    case("ab", false, ".555", ab),
    case("pp2", false, ".034", pp2),
    case("ppp", false, ".033", ppp),
    case("abc", false, ".083", abc),
    case("plp", false, ".087", plp),
    case("enz", false, "", enz),
    case("chu", false, ".036", chu),
    case("cusp", false, "", cusp),
];

/// The default settings with a variant's step.
pub fn settings(v: Variant) -> Settings {
    let settings = Settings::default();
    let points = (1000.0 / v.step.min(1.0)).round() as usize;
    Settings { max_step: settings.max_step * v.step, max_points: points, ..settings }
}

/// The equilibria of a field from a state, with parameters that differ from the demo's.
pub fn rest<F: VectorField + 'static>(
    field: F,
    from: &[f64],
    parameters: &[(&str, f64)],
    along: (&str, [f64; 2]),
    v: Variant,
) -> Result<Branch, TraceError> {
    let (names, defaults) = (field.names(), field.defaults());
    let mut system = Dense::new(Equilibria::new(field));
    let mut curve = Continuation::new(&mut system).named("rest").settings(settings(v)).from(from);
    for (name, value) in names.parameters.iter().zip(defaults) {
        curve = curve.at(name, value);
    }
    for (name, value) in parameters {
        curve = curve.at(name, *value);
    }
    curve.along(along.0, along.1[0]..=along.1[1]).trace().inspect(show)
}

/// The branch that crosses another one at its branch point number `index`.
pub fn crossing<F: VectorField + 'static>(
    field: F,
    branch: &Branch,
    index: usize,
    along: (&str, [f64; 2]),
    v: Variant,
) -> Result<Branch, Box<dyn std::error::Error>> {
    let point = branch.of_kind(Kind::BP).nth(index).ok_or("there are fewer branch points")?;
    let mut system = Dense::new(Equilibria::new(field));
    let curve =
        Continuation::new(&mut system).named(format!("crossing {index}")).settings(settings(v));
    let curve = curve.restart(branch, point.label).switch();
    Ok(curve.along(along.0, along.1[0]..=along.1[1]).trace().inspect(show)?)
}

fn ab(v: Variant, report: &mut Report) -> Outcome {
    type Row<'a> = (f64, &'a [f64], &'a [f64]);
    let rows: [Row; 5] = [
        (14.0, &[], &[0.165042045323561]),
        (15.0, &[], &[0.146882475604236]),
        (16.0, &[], &[0.1325384442692152]),
        (
            17.0,
            &[0.1219011608107829, 0.1170147504267039],
            &[0.1208657195093891, 0.2170805096962893],
        ),
        (
            18.0,
            &[0.1115650800742149, 0.09957413673572789],
            &[0.1111534841898642, 0.1838346079859874],
        ),
    ];
    for (b, folds, hopf) in rows {
        let branch = rest(Ab, &[0.0; 2], &[("B", b)], ("D", [0.0, 0.25]), v)?;
        // At B = 16 two folds have met.
        if b == 16.0 {
            let found =
                branch.of_kind(Kind::LP).all(|s| (s.parameters[0] - (-2.0f64).exp()).abs() < 1e-9);
            report.claim("B = 16: folds at e⁻² only", found);
        } else {
            report.points(&branch, Kind::LP, "D", folds, 1e-9);
        }
        report.points(&branch, Kind::HB, "D", hopf, 1e-9);
        report.none(&branch, &[Kind::BP]);
        report.ends(&branch, ["D reached its bound 0", "D reached its bound 0.25"]);
    }
    Ok(())
}

fn pp2(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Pp2, &[0.0; 2], &[], ("p", [0.0, 1.0]), v)?;
    report.points(&branch, Kind::BP, "p", &[0.6], 1e-9);
    report.none(&branch, &[Kind::LP, Kind::HB]);
    // The prey alone, and from it both.
    let prey = crossing(Pp2, &branch, 0, ("p", [0.0, 1.0]), v)?;
    report.points(&prey, Kind::BP, "p", &[0.821904345373991], 1e-9);
    report.points(&prey, Kind::LP, "p", &[0.832929322234157], 1e-9);
    report.none(&prey, &[Kind::HB]);
    let both = crossing(Pp2, &prey, 0, ("p", [0.0, 1.0]), v)?;
    report.points(&both, Kind::HB, "p", &[0.671593847478832], 1e-9);
    Ok(())
}

fn ppp(v: Variant, report: &mut Report) -> Outcome {
    let along = ("p", [0.0, 1.0]);
    let branch = rest(Ppp, &[1.0, 0.0, 0.0], &[], along, v)?;
    report.points(&branch, Kind::BP, "p", &[0.55], 1e-9);
    report.none(&branch, &[Kind::LP, Kind::HB]);
    // Without the third species.
    let two = crossing(Ppp, &branch, 0, along, v)?;
    report.points(&two, Kind::LP, "p", &[0.564595909971674], 1e-9);
    report.points(&two, Kind::BP, "p", &[0.368469531699284], 1e-9);
    let unbent = two.special.iter().all(|s| s.state[2].abs() < 1e-9);
    report.claim("the branch from p = 11/20 has w = 0", unbent);
    report.points(&two, Kind::HB, "p", &[0.179023447980222, 0.292357016267087], 1e-9);
    // With it.
    let three = crossing(Ppp, &two, 0, along, v)?;
    report.none(&three, &[Kind::HB, Kind::LP]);
    report.claim(
        "the branch with all three has w ≠ 0",
        three.special.iter().any(|s| s.state[2].abs() > 0.01),
    );
    Ok(())
}

fn abc(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Abc, &[0.0; 3], &[], ("D", [0.0, 0.4]), v)?;
    let hopf = [0.204184535700614, 0.229839037648467, 0.259957854244517, 0.346208521607389];
    report.points(&branch, Kind::HB, "D", &hopf, 1e-9);
    report.none(&branch, &[Kind::BP]);
    Ok(())
}

fn plp(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Plp, &[45.55974, 177.7987], &[], ("rho", [1.0, 7.0]), v)?;
    report.points(&branch, Kind::HB, "rho", &[3.49995382798691, 4.6504578126027], 1e-9);
    report.none(&branch, &[Kind::BP, Kind::LP]);
    for label in branch.of_kind(Kind::HB).map(|s| s.label).collect::<Vec<_>>() {
        let mut system = Dense::new(Equilibria::new(Plp));
        let curve = Continuation::new(&mut system)
            .settings(settings(v))
            .restart(&branch, label)
            .hold(Kind::HB);
        let curve = curve
            .along("rho", 1.0..=10.0)
            .along("S0", 100.0..=120.0)
            .mark("S0", 109.0)
            .trace()
            .inspect(show)?;
        report.points(&curve, Kind::UZ, "rho", &[5.10966576803712, 3.10386359736781], 1e-9);
    }
    Ok(())
}

fn enz(v: Variant, report: &mut Report) -> Outcome {
    let along = ("s0", [0.0, 80.0]);
    let branch = rest(Enz, &[0.0; 2], &[], along, v)?;
    let crossings = [34.2228865441902, 22.1816379261242];
    report.points(&branch, Kind::LP, "s0", &[34.3569249985262, 18.8870676579243], 1e-9);
    report.points(&branch, Kind::BP, "s0", &crossings, 1e-9);
    for index in 0..2 {
        let other = crossing(Enz, &branch, index, along, v)?;
        report.ends(&other, ["closed", "closed"]);
        report.claim(
            "the loop has two halves",
            other.special.iter().any(|s| (s.state[0] - s.state[1]).abs() > 1.0),
        );
        let found: Vec<f64> = other.of_kind(Kind::BP).map(|s| s.parameters[0]).collect();
        let expected = crossings[1 - index.min(1)];
        let near = found.iter().filter(|p| crossings.iter().any(|c| (*p - c).abs() < 1e-7)).count();
        report.claim(
            format!("the loop meets the other branch point, once: {found:?}, {expected}"),
            near == found.len() && found.len() <= 2,
        );
    }
    Ok(())
}

fn chu(v: Variant, report: &mut Report) -> Outcome {
    let branch = rest(Chu, &[1.5, 0.0, -1.5], &[], ("alpha", [5.0, 15.0]), v)?;
    report.points(&branch, Kind::HB, "alpha", &[6.80434005430908], 1e-9);
    report.none(&branch, &[Kind::BP, Kind::LP]);
    Ok(())
}

fn cusp(v: Variant, report: &mut Report) -> Outcome {
    let fold = 2.0 / (3.0 * 3.0_f64.sqrt());
    let branch = rest(Cusp, &[0.0], &[], ("mu", [-2.0, 2.0]), v)?;
    report.points(&branch, Kind::LP, "mu", &[-fold, fold], 1e-9);
    report.none(&branch, &[Kind::BP]);
    let label = branch.of_kind(Kind::LP).next().ok_or("no fold")?.label;
    let mut system = Dense::new(Equilibria::new(Cusp));
    let curve =
        Continuation::new(&mut system).settings(settings(v)).restart(&branch, label).hold(Kind::LP);
    let curve = curve.along("mu", -2.0..=2.0).along("lambda", -1.0..=2.0).trace().inspect(show)?;
    report.points(&curve, Kind::CP, "lambda", &[0.0], 1e-9);
    Ok(())
}
