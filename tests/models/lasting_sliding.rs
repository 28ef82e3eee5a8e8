//! Promise: orbits that never leave the switching surface are closed on it, with the multipliers of
//! motion along it.

use super::branches;
use crate::common::close;
use std::f64::consts::{PI, TAU};
use tangency::core::sweep::Part;
use tangency::core::system::Kind;
use tangency::scene::{Scene, sweep};

/// A relay keeps `i = r sin ωt`, with `u' = 100 i − u`; times in microseconds are given in seconds
/// with the factor `1e6` of all rates.
fn tracking(rate: f64, rest: &str) -> Scene {
    let scales = if rate == 1.0 { "" } else { "scales: [(\"t\", \"1e-6\")]," };
    let text = format!(
        "Scene(title: \"t\", problem: FilippovEquations(
            surface: \"i - r*sin(w*t)\",
            above: [(\"u\", \"k*(i*100 - u)\"), (\"i\", \"k*(-u - 10*i - E)/10\")],
            below: [(\"u\", \"k*(i*100 - u)\"), (\"i\", \"k*(-u - 10*i + E)/10\")],
            parameters: [(\"k\", {rate}), (\"w\", {}), (\"r\", 0.02), (\"E\", 5)],
            period: \"2*pi/w\", {scales} initial: [(\"u\", 0.1), (\"i\", 0.01)]), {rest})",
        2.0 * rate
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"))
}

/// Sliding is held up to the amplitude at which the relay would need more than `E`:
/// `|10 i' + u + 10 i| = 10 √13 r`.
#[test]
fn tracking_by_a_relay_is_a_cycle_until_the_relay_saturates() {
    for (rate, method) in [1.0, 1e6].into_iter().flat_map(|k| [(k, "shooting"), (k, "collocation")])
    {
        let scene = tracking(
            rate,
            &format!(
                "runs: [(name: \"r\", set: [(\"method\", \"{method}\")], start: Simulated(transient: {}),
                         along: [(name: \"r\", low: 0.001, high: 0.3)])]",
                100.0 / rate
            ),
        );
        let branch = &branches(&scene)[0];
        let end = branch.of_kind(Kind::G).next().expect("a relay that saturates");
        assert_eq!(end.subkind.as_deref(), Some("adding-sliding"));
        close(end.parameters[2], 5.0 / (10.0 * 13.0_f64.sqrt()), 1e-11);
        // The relay shapes `i` immediately, and `u` forgets its past at the rate 1.
        assert_eq!(end.unstable, Some(0));
        let [along, across] = [end.eigenvalues[0], end.eigenvalues[1]];
        close(along.0, (-PI).exp(), 1e-9);
        assert!(across.0.hypot(across.1) < 1e-12, "{across:?}");
        let least = branch.of_kind(Kind::EP).next().expect("the bound");
        close(least.parameters[2], 0.001, 1e-15);
        let largest = branch.monitors.iter().position(|name| name == "max_u").unwrap();
        close(least.monitors[largest], 0.1 / 5.0_f64.sqrt(), 1e-10);
    }
}

#[test]
fn beyond_saturation_the_orbit_slides_for_parts_of_the_period() {
    let scene = tracking(
        1.0,
        "runs: [
            (name: \"r\", start: Simulated(transient: 100), along: [(name: \"r\", low: 0.01, high: 0.3)]),
            (name: \"beyond\", start: From(run: \"r\", kind: G, switch: true),
             along: [(name: \"r\", low: 0.01, high: 0.3)]),
        ]",
    );
    let beyond = &branches(&scene)[1];
    assert!(
        beyond.ends.iter().any(|end| end.to_string().contains("bound 0.3")),
        "{:?}",
        beyond.ends
    );
}

/// The exponent of a period is `−π`, whatever is begun with; off the surface there is none.
#[test]
fn a_sweep_names_the_period_and_the_exponent_along_the_surface() {
    let scene = tracking(
        1.0,
        "sweeps: [(name: \"s\", order: anew,
            over: [(name: \"r\", low: 0.005, high: 0.13, count: 4)], starts: [[(\"u\", 0.1), (\"i\", 0.01)]],
            search: (transient: 50, recorded_periods: 20, lyapunov_periods: 50))]",
    );
    let sweeps = sweep(&scene, "t", Part::WHOLE, None, &mut ()).unwrap();
    let table = &sweeps.sweeps[0];
    let column = |name: &str| table.run_columns.iter().position(|known| known == name).unwrap();
    for row in table.rows.values() {
        assert_eq!(row.values[column("periods")], 1.0);
        close(row.values[column("exponent")], -PI, 1e-8);
    }
}

/// A limit cycle `r = √m` in the surface `z = 0.3 x` of three states. The surface holds up to
/// `√(1.09 m) = 2`.
#[test]
fn a_limit_cycle_within_the_surface_has_a_period_of_its_own() {
    for method in ["shooting", "collocation"] {
        let scene = Scene::parse(&format!(
            "Scene(title: \"t\", problem: FilippovEquations(
                surface: \"z - 0.3*x\",
                definitions: [(\"c\", \"m - x^2 - y^2\")],
                above: [(\"x\", \"c*x - y\"), (\"y\", \"x + c*y\"), (\"z\", \"-2 + x\")],
                below: [(\"x\", \"c*x - y\"), (\"y\", \"x + c*y\"), (\"z\", \"2 + x\")],
                parameters: [(\"m\", 0.5)], initial: [(\"x\", 0.5), (\"y\", 0), (\"z\", 0.15)]),
             runs: [(name: \"r\", set: [(\"method\", \"{method}\")], start: Simulated(transient: 100),
                     along: [(name: \"m\", low: 0.1, high: 5)])])"
        ))
        .unwrap_or_else(|error| panic!("{error}"));
        let branch = &branches(&scene)[0];
        let end = branch.of_kind(Kind::G).next().expect("the end of sliding");
        let m = 4.0 / 1.09;
        close(end.parameters[0], m, 1e-10);
        close(branch.of_kind(Kind::EP).next().unwrap().parameters[0], 0.1, 1e-15);
        let period = branch.monitors.iter().position(|name| name == "period").unwrap();
        close(end.monitors[period], TAU, 1e-9);
        assert_eq!(end.unstable, Some(0));
        // Towards the cycle deviations shrink like exp(−2mt).
        let least = branch.of_kind(Kind::EP).next().unwrap();
        close(least.eigenvalues[0].0, (-0.2 * TAU).exp(), 1e-8);
    }
}

/// From a Hopf point of sliding cycles emanate within the surface `z = x²`: `r = √μ`, with the period
/// `2π`.
#[test]
fn cycles_are_born_at_a_hopf_point_of_sliding() {
    let along = "along: [(name: \"mu\", low: -1, high: 1)]";
    let scene = Scene::parse(&format!(
        "Scene(title: \"t\", problem: FilippovEquations(
            surface: \"z - x^2\",
            definitions: [(\"u\", \"mu*x - y - x*(x^2 + y^2)\")],
            above: [(\"x\", \"u\"), (\"y\", \"x + mu*y - y*(x^2 + y^2)\"), (\"z\", \"2*x*u - 1\")],
            below: [(\"x\", \"u\"), (\"y\", \"x + mu*y - y*(x^2 + y^2)\"), (\"z\", \"2*x*u + 1\")],
            parameters: [(\"mu\", -0.5)], initial: [(\"x\", 0), (\"y\", 0), (\"z\", 0)]),
         runs: [
            (name: \"rest\", set: [(\"solution\", \"equilibrium\")], {along}),
            (name: \"cycles\", start: From(run: \"rest\", kind: HB, switch: true), {along}),
         ])"
    ))
    .unwrap_or_else(|error| panic!("{error}"));
    let branches = branches(&scene);
    let born = branches[0].of_kind(Kind::HB).next().expect("a Hopf point");
    close(born.parameters[0], 0.0, 1e-10);
    let cycles = &branches[1];
    assert_eq!(cycles.itinerary, "sliding");
    let [largest, period] = ["max_x", "period"].map(|name| cycles.column(name).unwrap());
    let end = cycles.special.iter().find(|it| it.parameters[0] == 1.0).expect("the bound");
    close(end.value(largest).unwrap(), 1.0, 1e-9);
    close(end.value(period).unwrap(), TAU, 1e-9);
    close(end.eigenvalues[0].0, (-2.0 * TAU).exp(), 1e-8);
}
