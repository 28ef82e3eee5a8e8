//! Work-precision diagram of the curve interpolated between the points of a branch: its error
//! against the number of points.

use super::plan::{Answer, Method, Plan};
use crate::Drawn;
use tangency::core::continuation::{Branch, Continuation, Point, Settings};
use tangency::core::failure::one_line;
use tangency::core::system::Dense;
use tangency::zero_problem;

zero_problem! {
    /// The equilibrium of a plate attracted by an electrode: `load = u (1 − u)²`.
    struct Plate [u; load] {
        0 = load / (T::one() - u).powi(2) - u;
        monitor deflection = u;
    }
}

/// The number of deflections at which interpolated curves are compared.
const PLACES: usize = 400;

/// The largest deflection.
const END: f64 = 0.9;

/// The interpolation between neighbouring points of a branch.
#[derive(Clone, Copy)]
enum Joined {
    Straight,
    Cubic,
}

/// Traces the branch with a given tolerance for the error of the interpolated curve.
fn branch(curve_error: f64) -> Result<Branch, String> {
    let mut plate = Dense::new(Plate);
    let settings = Settings { curve_error, ..Settings::default() };
    let run = Continuation::new(&mut plate).along("load", 0.0..=1.0).bound("deflection", ..=END);
    run.settings(settings).trace().map_err(|cause| one_line(&cause))
}

/// Returns the interpolated load and deflection at a given fraction of the arclength between two
/// points of a branch.
fn between([from, to]: [&Point; 2], joined: Joined, share: f64) -> Option<[f64; 2]> {
    let [a, b] = [from.slopes.as_ref()?, to.slopes.as_ref()?];
    let length = b.position - a.position;
    let at = |column: usize| {
        let (x, y) = (from.value(column)?, to.value(column)?);
        let straight = x + share * (y - x);
        let Joined::Cubic = joined else { return Some(straight) };
        let [c, d] = [a.columns[column]?, b.columns[column]?].map(|slope| length * slope);
        let (s, r) = (share, 1.0 - share);
        Some(straight + s * r * ((r - s) * (x - y) + r * c - s * d))
    };
    Some([at(0)?, at(1)?])
}

/// Returns the load of the interpolated curve at a given deflection, by bisection.
fn load(branch: &Branch, joined: Joined, deflection: f64) -> Option<f64> {
    let reaches = |point: &Point| point.value(1).is_some_and(|u| u >= deflection);
    let end = branch.points.iter().position(reaches)?.max(1);
    let pair = [&branch.points[end - 1], &branch.points[end]];
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let before = between(pair, joined, middle)?[1] < deflection;
        (if before { &mut low } else { &mut high }).clone_from(&middle);
    }
    Some(between(pair, joined, low)?[0])
}

/// Returns the loads of the interpolated curve at equidistant deflections.
fn loads(branch: &Branch, joined: Joined) -> Option<Vec<f64>> {
    let places = (1..PLACES).map(|k| END * k as f64 / PLACES as f64);
    places.map(|deflection| load(branch, joined, deflection)).collect()
}

/// Plans the diagram of the error of the interpolated curve against the number of points.
pub(super) fn plans() -> Vec<Plan> {
    let exact = Method::new("load = u (1 − u)²", "", || {
        let places = (1..PLACES).map(|k| END * k as f64 / PLACES as f64);
        Ok(Answer { numbers: places.map(|u| u * (1.0 - u) * (1.0 - u)).collect(), work: 0.0 })
    });
    let method = |line: &str, joined: Joined, curve_error: f64| {
        Method::new(line, format!("{curve_error:.0e}"), move || {
            let branch = branch(curve_error)?;
            let numbers = loads(&branch, joined).ok_or("a point without slopes")?;
            Ok(Answer { numbers, work: branch.points.len() as f64 })
        })
    };
    let errors = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
    let plan = Plan::of("Curves through the points of a branch", exact).counting("points");
    let default = Settings::default().curve_error;
    let plan = plan
        .drawing(Drawn::ErrorAgainstWork)
        .with(errors.map(|it| method("cubics", Joined::Cubic, it)))
        .with(errors.map(|it| method("straight lines", Joined::Straight, it)));
    vec![plan.recommending("cubics", &format!("{default:.0e}"))]
}
