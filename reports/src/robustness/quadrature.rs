//! Robustness map of the integral of the load `1/(1 − w)²` near contact: one panel varies the
//! number of Gauss points, the other checks the error estimates of the plate model.

use super::grid::{Found, Panel, from_to, map};
use crate::RobustnessMap;
use tangency::core::continuation::{Branch, Continuation, End, Settings};
use tangency::core::failure::one_line;
use tangency::core::numerics::gauss_legendre;
use tangency::core::system::Kind;
use tangency::problems::plate::{Orders, Ritz, RitzSettings, Supports, Units};

/// Computes the integral `∬ dx dy/(1 − w)²` over a quarter of a clamped plate with the deflection
/// `w = W (16 x² (1 − x)² y² (1 − y)²)`, with a given number of Gauss points in each direction.
fn load(largest: f64, points: usize) -> f64 {
    let (nodes, weights) = gauss_legendre(points);
    let place = |(node, weight): (&f64, &f64)| {
        let x = 0.25 * (node + 1.0);
        [16.0 * (x * (1.0 - x)).powi(2), 0.25 * weight]
    };
    let line: Vec<[f64; 2]> = nodes.iter().zip(&weights).map(place).collect();
    let along = |[x, weight]: &[f64; 2]| {
        let across = line.iter().map(|[y, weight]| weight / (1.0 - largest * x * y).powi(2));
        weight * across.sum::<f64>()
    };
    line.iter().map(along).sum()
}

/// A number of Gauss points with which the integral is accurate at every place of the map.
const MANY: usize = 256;

/// Classifies the relative error of the integral for a number of Gauss points.
fn judged(error: f64) -> Found {
    match error {
        ..1e-9 => Found::right("nine digits"),
        1e-9..1e-6 => Found::right("six digits"),
        1e-6..1e-2 => Found::silent("fewer than six digits"),
        _ => Found::silent("fewer than two digits"),
    }
}

/// Traces a branch of the plate from rest up to a largest deflection, with marked points on the
/// way.
fn traced(orders: [usize; 2], refinement: f64, gaps: &[f64]) -> Traced {
    let supports: Supports =
        "CCCC".parse().map_err(|e: tangency::problems::plate::PlateError| one_line(&e))?;
    let mut settings = RitzSettings::new(supports);
    let [across, within] = orders;
    settings.orders = Some(Orders { transverse: [across; 2], in_plane: [within; 2] });
    let mut plate = Ritz::new(settings).map_err(|cause| one_line(&cause))?;
    let names = Units::Dimensionless.names().iter().zip(Units::Dimensionless.defaults());
    let start =
        names.fold(Continuation::new(&mut plate), |run, (name, value)| run.at(name, *value));
    let start = start
        .settings(Settings { refinement, ..Settings::default() })
        .along("load", 0.0..=f64::INFINITY)
        .bound("max_deflection", f64::NEG_INFINITY..=0.999);
    let marked = gaps.iter().fold(start, |run, gap| run.mark("max_deflection", 1.0 - gap));
    marked.trace().map_err(|cause| one_line(&cause))
}

/// Returns the load at a marked point of the branch, and the error of this load.
fn marked(branch: &Branch, gap: f64) -> Option<[f64; 2]> {
    let deflection = branch.column("max_deflection")?;
    let near = |value: f64| (value - 1.0 + gap).abs() < 1e-9;
    let mut marks = branch.of_kind(Kind::UZ);
    let point = marks.find(|point| point.value(deflection).is_some_and(near))?;
    Some([point.value(branch.column("load")?)?, point.error])
}

/// A branch, or the reason why its computation failed.
type Traced = Result<Branch, String>;

/// Compares a marked point of a branch with the same point of a more accurate branch; if the point
/// is missing, the reason why the branch ended is reported.
fn compared(branch: &Traced, finer: &Traced, gap: f64) -> Found {
    let (branch, finer) = match (branch, finer) {
        (Ok(branch), Ok(finer)) => (branch, finer),
        (Err(cause), _) | (_, Err(cause)) => return Found::reported("no branch", cause),
    };
    match (marked(branch, gap), marked(finer, gap)) {
        (Some([load, error]), Some([better, left])) => {
            let miss = (load - better).abs();
            match miss <= error + left {
                true if miss <= 1e-4 * better => Found::right("four digits"),
                true => Found::reported(
                    "fewer digits, by its own estimate",
                    format!("the error is estimated as {error:.1e}"),
                ),
                false => Found::silent("the error exceeds its estimate"),
            }
        }
        _ => match &branch.ends[1] {
            end @ End::StepTooSmall { .. } => {
                Found::reported("the branch ends before the electrode", end)
            }
            _ => Found::silent("no such point"),
        },
    }
}

/// Computes two panels.
pub(super) fn draw() -> RobustnessMap {
    let gaps = from_to(-3.0, -0.1, 30);
    let points: Vec<f64> = (1..=32).rev().map(|k| f64::from(2 * k)).collect();
    let exact: Vec<f64> = gaps.iter().map(|gap| load(1.0 - 10_f64.powf(*gap), MANY)).collect();
    let error = |gap: f64, points: f64| {
        let k = gaps.iter().position(|known| *known == gap).unwrap_or(0);
        (load(1.0 - 10_f64.powf(gap), points as usize) / exact[k] - 1.0).abs()
    };
    let x = "log₁₀ of the smallest remaining gap, 1 − w";
    let rule = |gap, points| judged(error(gap, points));
    let rules = Panel::new("Gauss points for a load", x, "points in each direction");
    let rules = rules.over(("Gauss points", true), [&gaps, &points], rule);
    let gaps = from_to(-1.9, -0.4, 6);
    let marks: Vec<f64> = gaps.iter().map(|gap| 10_f64.powf(*gap)).collect();
    let finer = traced([6, 8], 1e-5, &marks);
    let mut plates =
        Panel::new("Branches of a clamped plate", x, "transverse and in-plane functions");
    for [across, within] in [[2, 3], [3, 4]] {
        let coarse = traced([across, within], 1e-3, &marks);
        let name = format!("{across} and {within}");
        plates =
            plates.row((&name, false), &gaps, |gap| compared(&coarse, &finer, 10_f64.powf(gap)));
    }
    map("quadrature", vec![rules, plates])
}
