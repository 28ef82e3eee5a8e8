//! Promise: the cubics between the points of a branch follow the branch as closely as `curve_error`
//! says, with few points, and pictures of saved branches show them.

use tangency::core::continuation::{Branch, Continuation, Point, Settings};
use tangency::core::system::{Dense, Kind};
use tangency::output::{Document, diagram};
use tangency::zero_problem;

zero_problem! {
    /// A plate drawn towards an electrode: `load = u (1 − u)²`.
    struct Plate [u; load] {
        0 = load / (T::one() - u).powi(2) - u;
        monitor deflection = u;
    }
}

zero_problem! {
    /// The unit circle.
    struct Circle [x; p] {
        0 = x * x + p * p - T::one();
        monitor height = x;
    }
}

zero_problem! {
    /// A hyperbola that turns where the branches of `x² = p²` would cross: sharp for small `gap`.
    struct Hyperbola { gap: f64 } [x; p] {
        0 = x * x - p * p - gap * gap;
        monitor height = x;
    }
}

/// A point on the cubic between two points, in two columns.
fn between([from, to]: [&Point; 2], columns: [usize; 2], t: f64) -> [f64; 2] {
    let [a, b] = [from, to].map(|point| point.slopes.as_ref().expect("slopes"));
    let length = b.position - a.position;
    columns.map(|column| {
        let [x, y] = [from, to].map(|point| point.value(column).expect("a value"));
        let [c, d] = [a, b].map(|slopes| length * slopes.columns[column].expect("a slope"));
        let (u, v) = (1.0 - t, 3.0 * t * t - 2.0 * t * t * t);
        x + v * (y - x) + t * u * (u * c - t * d)
    })
}

/// The largest distance of the cubics of a branch from the curve `f = 0`, by its first-order
/// estimate `|f|/|∇f|` in columns measured by these scales.
fn error(branch: &Branch, scales: [f64; 2], f: impl Fn([f64; 2]) -> (f64, [f64; 2])) -> f64 {
    let mut most: f64 = 0.0;
    for pair in branch.points.windows(2) {
        for part in 1..10 {
            let at = between([&pair[0], &pair[1]], [0, 1], f64::from(part) / 10.0);
            let (value, gradient) = f(at);
            let size = (gradient[0] * scales[0]).hypot(gradient[1] * scales[1]);
            most = most.max((value / size).abs());
        }
    }
    most
}

fn with(curve_error: f64) -> Settings {
    Settings { curve_error, ..Settings::default() }
}

/// A step whose estimated error is more than the setting is refused, and a tenth of the setting
/// takes 10^¼ times as many points. The estimate is right within a factor of four.
#[test]
fn cubics_are_as_near_as_the_setting_says() {
    let mut counts = Vec::new();
    for tolerance in [1e-3, 1e-5, 1e-7] {
        let mut plate = Dense::new(Plate);
        let branch =
            Continuation::new(&mut plate).along("load", 0.0..=1.0).settings(with(tolerance));
        let branch = branch.bound("deflection", ..=0.9).trace().unwrap();
        let load =
            |[p, u]: [f64; 2]| (p - u * (1.0 - u) * (1.0 - u), [1.0, -(1.0 - u) * (1.0 - 3.0 * u)]);
        // The scales of the end: the range of the load, and the largest deflection.
        let plate = error(&branch, [1.0, 0.9], load);
        let mut circle = Dense::new(Circle);
        let branch =
            Continuation::new(&mut circle).from(&[1.0]).at("p", 0.0).settings(with(tolerance));
        let branch = branch.along("p", -2.0..=2.0).trace().unwrap();
        let circle = error(&branch, [4.0, 1.0], |[p, x]| (p * p + x * x - 1.0, [2.0 * p, 2.0 * x]));
        let most = 4.0 * tolerance;
        assert!(plate < most && circle < most, "{tolerance}: {plate:e} {circle:e}");
        counts.push(branch.points.len());
    }
    // Steps are bounded by angles at first; 100^¼ = 3.16.
    let growth = counts[2] as f64 / counts[1] as f64;
    assert!(counts[0] < 60 && (2.5..4.0).contains(&growth), "{counts:?}");
}

#[test]
fn a_sharp_turn_is_followed() {
    for gap in [0.1, 0.01, 1e-3] {
        let mut system = Dense::new(Hyperbola { gap });
        let branch = Continuation::new(&mut system).from(&[f64::hypot(1.0, gap)]).at("p", -1.0);
        let branch = branch.along("p", -1.0..=1.0).trace().unwrap();
        let f = |[p, x]: [f64; 2]| (x * x - p * p - gap * gap, [-2.0 * p, 2.0 * x]);
        let most = error(&branch, [2.0, 1.0], f);
        assert!(most < 1e-3 && branch.points.len() < 60, "{gap}: {most:e} {}", branch.points.len());
    }
}

/// A picture of a saved branch shows the branch between its points, and no vertex lies beyond the
/// fold.
#[test]
fn pictures_of_saved_branches_show_the_curve() {
    let mut plate = Dense::new(Plate);
    let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).bound("deflection", ..=0.9);
    let branch = branch.trace().unwrap();
    let count = branch.points.len();
    assert!(count < 20, "{count} points");
    let document = Document::new("", vec![branch]);
    let saved = Document::parse(&document.to_ron().unwrap()).unwrap();
    let figure = diagram(&[("", &saved)], None, &[]).unwrap();
    assert_eq!(figure, diagram(&[("", &document)], None, &[]).unwrap());
    let vertices: Vec<[f64; 2]> = figure.series.iter().flat_map(|it| it.points.clone()).collect();
    assert!(vertices.len() > 2 * count, "{} vertices", vertices.len());
    for [load, u] in vertices {
        // In units of the axes: the load reaches 4/27.
        let error = (load - u * (1.0 - u) * (1.0 - u)) * 27.0 / 4.0;
        assert!(error.abs() < 2e-3 && load < 4.0 / 27.0 + 1e-6, "{load} {u}: {error:e}");
    }
    let fold = saved.branches[0].of_kind(Kind::LP).next().unwrap();
    let slopes = fold.slopes.as_ref().unwrap();
    assert!(slopes.columns[0].unwrap().abs() < 1e-9, "the curve is vertical at the fold");
}
