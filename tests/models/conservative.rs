//! Promise: families of cycles of conservative systems have their branch points and period doublings, the
//! right number of unstable multipliers, and no folds that errors of the constant parameter imitate.

use super::traced;
use crate::common::close;
use std::f64::consts::TAU;
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;

/// The families that emanate from a number of Hopf points of an equilibrium, up to a bound of the period.
fn families((model, count): (&str, usize), settings: &str, longest: f64) -> Vec<Branch> {
    let family = |nth: usize| {
        format!(
            r#"(name: "{nth}", start: From(run: "rest", kind: HB, nth: {nth}), set: [{settings}],
                along: [(name: "d", low: -1, high: 1)], bounds: [(name: "period", high: {longest})])"#
        )
    };
    let rest = r#"(name: "rest", along: [(name: "d", low: -1, high: 1)])"#;
    let runs: Vec<String> = std::iter::once(rest.into()).chain((0..count).map(family)).collect();
    let scene = format!(
        r#"Scene(title: "t", problem: {model}, settings: (max_step: 0.3), runs: [{}])"#,
        runs.join(", ")
    );
    traced(&scene).split_off(1)
}

fn is_family(branch: &Branch) -> bool {
    branch.warnings.iter().any(|warning| warning.contains("`d` is constant along this branch"))
}

/// The periods of the special points between the ends, with their kinds.
fn special(branch: &Branch) -> Vec<(Kind, f64)> {
    let inside = branch.special.iter().filter(|it| !matches!(it.kind, Kind::EP | Kind::MX));
    let period = branch.column("period").unwrap();
    let found = inside.map(|it| {
        assert!(it.converged, "{it:?}");
        (it.kind, it.value(period).unwrap())
    });
    found.collect()
}

/// Two coupled oscillators of Hénon and Heiles' type. On the family with `x = 0`, deviations of `x`
/// satisfy `x'' = −(1 + 2y) x`; SciPy (`DOP853`, relative tolerance 1e-12) gives the periods at which the trace of
/// their monodromy matrix is 2 and −2.
const SPRINGS: &str = r#"Equations(states: [("x", "px"), ("y", "py"), ("px", "-x - 2*x*y - d*px"),
    ("py", "-2.3*y - x^2 + y^2 - d*py")], parameters: [("d", 0)], solution: equilibrium)"#;

#[test]
fn a_family_has_its_branch_points_and_period_doublings() {
    let expected = [
        (Kind::BP, 4.625640471767703),
        (Kind::BP, 5.508778032306219),
        (Kind::PD, 5.820280661202309),
        (Kind::PD, 6.817805335267486),
        (Kind::BP, 7.125457030959037),
    ];
    for method in ["collocation(intervals: 20)", "shooting()"] {
        let branches = families((SPRINGS, 2), &format!(r#"("method", "{method}")"#), 8.0);
        let family = branches.iter().find(|it| special(it).len() > 1).unwrap();
        assert!(is_family(family), "{:?}", family.warnings);
        let found = special(family);
        assert_eq!(found.len(), expected.len(), "{method}: {found:?}");
        for ((kind, period), (expected, exact)) in found.iter().zip(expected) {
            assert_eq!(*kind, expected);
            close(*period, exact, 1e-9 * exact);
        }
        // Each special point exchanges a pair on the unit circle and a real pair.
        let period = family.column("period").unwrap();
        for point in &family.points[1..] {
            let period = point.value(period).unwrap();
            let passed = expected.iter().filter(|(_, place)| *place < period).count();
            assert_eq!(point.unstable, Some(passed % 2), "{method}, period {period}");
        }
    }
}

/// The planar Lyapunov orbits at the point L1 of the Earth and the Moon: halo orbits branch off where the
/// trace of the monodromy matrix of vertical deviations is 2 (SciPy, relative tolerance 1e-13). At the Hopf point of
/// vertical orbits, the planar states do not oscillate, and rounding errors must not be their scales.
#[test]
fn halo_orbits_branch_off() {
    let model = r#"Equations(states: [("x", "vx"), ("y", "vy"), ("z", "vz"),
            ("vx", "2*vy + x - (1-mu)*(x+mu)/r1^3 - mu*(x-1+mu)/r2^3 + d*vx"),
            ("vy", "-2*vx + y - (1-mu)*y/r1^3 - mu*y/r2^3 + d*vy"), ("vz", "-(1-mu)*z/r1^3 - mu*z/r2^3 + d*vz")],
        definitions: [("r1", "sqrt((x+mu)^2+y^2+z^2)"), ("r2", "sqrt((x-1+mu)^2+y^2+z^2)")],
        parameters: [("d", 0), ("mu", 0.01215)], initial: [("x", 0.8369)], solution: equilibrium,
        monitors: [("C", "x^2+y^2+2*(1-mu)/r1+2*mu/r2-vx^2-vy^2-vz^2")])"#;
    let branches = families((model, 2), "", 3.5);
    let [planar, vertical] = &branches[..2] else { panic!("{} branches", branches.len()) };
    let halo = planar.of_kind(Kind::BP).next().unwrap();
    close(halo.value(planar.column("period").unwrap()).unwrap(), 2.7429993222211566, 1e-9);
    close(halo.value(planar.column("C").unwrap()).unwrap(), 3.1743469557444484, 1e-9);
    assert_eq!(special(planar).len(), 1);
    for branch in [vertical, planar] {
        assert!(is_family(branch), "{:?}", branch.warnings);
        let end = branch.special.last().unwrap();
        close(end.value(branch.column("period").unwrap()).unwrap(), 3.5, 1e-6);
    }
    // Vertical orbits leave the plane.
    let height = vertical.special.last().unwrap().value(vertical.column("max_z").unwrap());
    assert!(height.unwrap() > 0.1, "{height:?}");
}

/// The pendulum: the period is `4 K(sin a/2)`, with the arithmetic–geometric mean.
#[test]
fn the_family_of_a_pendulum_has_exact_periods() {
    let model = r#"Equations(states: [("a", "w"), ("w", "-sin(a) - d*w")], parameters: [("d", 0)],
        solution: equilibrium)"#;
    let [family] = &families((model, 1), "", 12.0)[..] else { panic!() };
    assert!(is_family(family), "{:?}", family.warnings);
    assert_eq!(special(family), []);
    let [period, largest] = ["period", "max_a"].map(|name| family.column(name).unwrap());
    for point in &family.points[1..] {
        let (mut a, mut g) = (1.0, (0.5 * point.value(largest).unwrap()).cos());
        for _ in 0..8 {
            (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
        }
        close(point.value(period).unwrap(), TAU / a, 1e-6 * TAU / a);
        assert_eq!(point.unstable, Some(0));
    }
}

/// A monitor that is undefined at some solutions ends the branch, whose earlier points are kept: on the coarse
/// mesh of this Lotka–Volterra cycle a population becomes negative.
#[test]
fn an_undefined_monitor_ends_the_branch() {
    let model = r#"Equations(states: [("x", "x*(1-y) + d*x*(1-x)"), ("y", "y*(x-1)")], parameters: [("d", 0)],
        initial: [("x", 1), ("y", 1)], monitors: [("H", "log(0.2 - abs(x - 1))")], solution: equilibrium)"#;
    let [family] = &families((model, 1), "", 100.0)[..] else { panic!() };
    assert!(family.points.len() > 2);
    let message = family.ends[1].to_string();
    assert!(
        message.contains("the monitor `max_H`") || message.contains("the monitor `H`"),
        "{message}"
    );
}

/// In a dissipative system whose terms of third and fifth order vanish, the first cycles look like a family.
/// The fold of cycles is where the mean of `x'² (m + 0.3 x⁸ − 0.1 x¹²)` vanishes with its derivative (SciPy:
/// m = −0.0629730598).
#[test]
fn folds_beyond_a_degenerate_hopf_point_are_found() {
    let model = r#"Equations(states: [("x", "v"), ("v", "-x + (d + 0.3*x^8 - 0.1*x^12)*v")], parameters: [("d", -0.5)],
        solution: equilibrium)"#;
    for method in ["collocation(intervals: 20)", "shooting()"] {
        let branches = families((model, 1), &format!(r#"("method", "{method}")"#), 100.0);
        let folds: Vec<f64> = branches[0].of_kind(Kind::LP).map(|it| it.parameters[0]).collect();
        assert_eq!(folds.len(), 1, "{method}: {:?}", branches[0].warnings);
        close(folds[0], -0.0629730598, 1e-9);
    }
}

/// Van der Pol's oscillator without damping is linear: its cycles of all amplitudes are a vertical branch, from
/// which the cycles of amplitude 2 branch off.
#[test]
fn cycles_of_a_linear_oscillator_are_a_vertical_branch() {
    let model = r#"Equations(states: [("x", "v"), ("v", "-x + d*(1 - x^2)*v")], parameters: [("d", -0.5)], solution: equilibrium)"#;
    let rest = r#"(name: "rest", along: [(name: "d", low: -1, high: 1)])"#;
    let branches = traced(&format!(
        r#"Scene(title: "t", problem: {model}, settings: (max_step: 0.3), runs: [{rest},
            (name: "v", start: From(run: "rest", kind: HB), along: [(name: "d", low: -1, high: 1)],
                bounds: [(name: "max_x", high: 5)])])"#
    ));
    let cycles = &branches[1];
    let [crossing] = &cycles.of_kind(Kind::BP).collect::<Vec<_>>()[..] else {
        panic!("{:?}", cycles.special)
    };
    close(crossing.value(cycles.column("max_x").unwrap()).unwrap(), 2.0, 1e-9);
}

/// A Hopf point with a very small first Lyapunov coefficient is no beginning of such a family.
#[test]
fn a_weakly_nonlinear_hopf_point_begins_no_family() {
    let model = r#"Equations(states: [("x", "d*x - y - 1e-4*x*(x^2+y^2)"), ("y", "x + d*y - 1e-4*y*(x^2+y^2)")],
        parameters: [("d", -0.5)], solution: equilibrium)"#;
    let [cycles] = &families((model, 1), "", 100.0)[..] else { panic!() };
    assert!(!is_family(cycles) && cycles.special.last().unwrap().parameters[0] == 1.0);
    assert!(cycles.points[1..].iter().all(|point| point.unstable == Some(0)));
}
