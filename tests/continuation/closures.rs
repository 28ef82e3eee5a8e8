//! What a user attaches to a curve from outside: columns, events, and the curve point by point.

use crate::common::{Brusselator, close};
use tangency::core::bvp::Collocation;
use tangency::core::continuation::{
    Branch, Continuation, End, Event, Settings, TraceError, Traced,
};
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::Equilibria;
use tangency::core::system::{Dense, Kind};
use tangency::problems::classic::{Hyperbola, Lure, ParallelPlate};
use tangency::zero_problem;

/// Both sorts of monitors are columns after the problem's own, and end a branch at a bound: with a
/// gradient to rounding, without one to the accuracy of bracketing.
#[test]
fn attached_monitors_are_columns_and_bounds() {
    for smooth in [false, true] {
        let mut plate = Dense::new(ParallelPlate);
        let curve = Continuation::new(&mut plate).along("load", 0.0..=1.0).forward();
        let curve = match smooth {
            true => curve.smooth_monitor("gap", |u, _| -u[0] + 1.0),
            false => curve.monitor("gap", |at| 1.0 - at.state[0]),
        };
        let branch = curve.bound("gap", 0.8..=2.0).trace().unwrap();
        assert_eq!(branch.ends[1], End::MonitorBound { name: "gap".into(), value: 0.8 });
        let gap = branch.column("gap").unwrap();
        let deflection = branch.column("deflection");
        assert!(deflection.is_none_or(|column| column < gap));
        let end = branch.special.last().unwrap();
        // u (1 − u)² at u = 1/5.
        let accuracy = if smooth { 1e-14 } else { 1e-10 };
        close(end.parameters[0], 0.128, accuracy);
        assert!((end.parameters[0] - 0.128).abs() <= end.error && end.error < 1e-9);
        close(end.value(gap).unwrap(), 0.8, 1e-9);
        for point in &branch.points {
            assert!(point.value(gap).unwrap() > 0.8 - 1e-9);
        }
    }
}

/// What has no gradient cannot be held, and a name is given once.
#[test]
fn attached_monitors_are_refused_where_they_mean_nothing() {
    let mut hyperbola = Dense::new(Hyperbola);
    let curve = Continuation::new(&mut hyperbola).from(&[3.0]).at("epsilon", 9.0);
    let curve = curve.monitor("product", |at| at.state[0] * at.parameters[0]);
    let held = curve.hold_level("product", 20.0).along("mu", 0.0..=9.0).along("epsilon", 0.0..=9.0);
    assert_eq!(held.trace().unwrap_err(), TraceError::NoGradient("product".into()));
    let curve = Continuation::new(&mut hyperbola).from(&[3.0]).at("epsilon", 9.0);
    let twice = curve.monitor("size", |at| at.state[0]).monitor("size", |at| at.state[0]);
    let refused = twice.along("mu", 0.0..=9.0).trace().unwrap_err();
    assert_eq!(refused, TraceError::SameName { what: "monitors", name: "size".into() });
}

/// An event on dual numbers is finished by Newton's iteration, also on finer meshes of an orbit;
/// one without a gradient is the same point, as well as its mesh knows it.
#[test]
fn events_on_orbits_agree_with_and_without_a_gradient() {
    let mut orbits = periodic_orbits(Lure, 20, Collocation::new(4).unwrap()).unwrap();
    let mut field = Dense::new(Equilibria::new(Lure));
    let equilibria = Continuation::new(&mut field).at("alpha", 0.5).at("beta", 1.0);
    let equilibria = equilibria.along("alpha", 0.3..=1.5).trace().unwrap();
    let hopf = equilibria.of_kind(Kind::HB).next().unwrap().label;
    let mut traced = |event: Event| {
        let start = Continuation::new(&mut orbits).restart(&equilibria, hopf).event(event);
        let settings = Settings { max_points: 40, ..Settings::default() };
        start.settings(settings).along("alpha", 0.5..=1.5).trace().unwrap()
    };
    // The state x at the beginning of the period, less 1/10.
    let smooth = traced(Event::zero_of("x(0) = 0.1", |z, _| z[0] - 0.1));
    let plain = traced(Event::when("x(0) = 0.1", |at| at.state[0] - 0.1));
    let at =
        |branch: &Branch| branch.of_kind(Kind::UZ).map(|it| (it.parameters[0], it.error)).next();
    if let (Some((a, a_error)), Some((b, b_error))) = (at(&smooth), at(&plain)) {
        assert!((a - b).abs() <= a_error + b_error, "{a} ± {a_error}, {b} ± {b_error}");
        assert!(a_error < 1e-5 && b_error < 1e-4);
    } else {
        panic!("{:?} {:?}", smooth.special.len(), plain.special.len());
    }
}

/// Special points carry their own numbers: here the frequency of a Hopf point, on a branch and
/// along a curve.
#[test]
fn hopf_points_have_their_frequency() {
    let mut field = Dense::new(Equilibria::new(Brusselator));
    let a = 1.5;
    let curve = Continuation::new(&mut field).from(&[a, 1.0 / a]).at("a", a).at("b", 1.0);
    let branch = curve.along("b", 1.0..=5.0).trace().unwrap();
    let hopf = branch.of_kind(Kind::HB).next().unwrap();
    close(hopf.parameters[1], 1.0 + a * a, 1e-12);
    let names: Vec<&str> = hopf.numbers.iter().map(|number| &number.name[..]).collect();
    assert_eq!(names, ["hopf_frequency", "l1", "c1_re", "c1_im", "growth_slope"]);
    close(hopf.numbers[0].value, a, 1e-12);
    let csv = tangency::output::csv(std::slice::from_ref(&branch));
    assert!(
        csv.lines().next().unwrap().contains(",hopf_frequency,l1,c1_re,c1_im,growth_slope,error,"),
        "{csv}"
    );
    let curve = Continuation::new(&mut field).restart(&branch, hopf.label).hold(Kind::HB);
    let curve = curve.along("b", 1.0..=5.0).along("a", 0.5..=3.0).trace().unwrap();
    let frequency = curve.column("hopf_frequency").unwrap();
    for point in &curve.points {
        close(point.value(frequency).unwrap(), point.parameters[0], 1e-9);
    }
    // Where points are saved, the ends among them, so are their eigenvalues ±iω.
    for special in &curve.special {
        close(special.eigenvalues[0].0, 0.0, 1e-9);
        close(special.eigenvalues[0].1, special.parameters[0], 1e-9);
    }
}

zero_problem! {
    /// A cubic with two folds.
    struct Cubic [x; mu] {
        0 = mu + x - x.powi(3);
    }
}

fn curve(cubic: &mut Dense<Cubic>) -> Continuation<'_> {
    Continuation::new(cubic).from(&[0.1]).at("mu", -0.099).along("mu", -1.0..=1.0)
}

/// Point by point a curve is what it is at once; left early, it is the beginning of it.
#[test]
fn steps_make_the_branch_that_a_trace_makes() {
    let mut cubic = Dense::new(Cubic);
    let branch = curve(&mut cubic).trace().unwrap();
    assert_eq!(branch.of_kind(Kind::LP).count(), 2);
    let mut steps = curve(&mut cubic).steps().unwrap();
    let items: Vec<Traced> = steps.by_ref().collect();
    let points = items.iter().filter(|item| matches!(item, Traced::Point(_))).count();
    assert_eq!(points, branch.points.len());
    assert_eq!(items.len() - points, branch.special.len());
    assert_eq!(steps.finish(), branch);
    for taken in [0, 1, 5] {
        let mut steps = curve(&mut cubic).steps().unwrap();
        let first: Vec<Traced> = steps.by_ref().take(taken).collect();
        assert_eq!(first[..], items[..taken]);
        let part = steps.finish();
        assert_eq!(part.ends, [End::Interrupted, End::Interrupted]);
        assert!(part.points.len() <= taken.max(1));
    }
}
