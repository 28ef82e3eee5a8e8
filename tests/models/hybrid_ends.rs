//! Promise: at its ends a branch says what is true, and what goes on there is found.

use super::traced;
use crate::common::{close, only};
use std::f64::consts::{PI, TAU};
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::scene::{Scene, execute};

/// A boost converter with a clock of period `T` and a comparator of the current; both states are in
/// SI units.
pub(super) const BOOST: &str = r#"HybridEquations(
    modes: [
        (name: "on", states: [("i", "Vin/L"), ("v", "-v/(R*C)"), ("s", 1)]),
        (name: "off", states: [("i", "(Vin - v)/L"), ("v", "(i - v/R)/C"), ("s", 1)]),
    ],
    guards: [
        (name: "peak", modes: ["on"], function: "Iref - i", next: "off"),
        (name: "clock", modes: ["on", "off"], function: "T - s", next: "on", reset: [("s", 0)]),
    ],
    parameters: [("Iref", 0.7), ("Vin", 10), ("L", 1.5e-3), ("C", 10e-6), ("R", 40), ("T", 1e-4)],
    initial: [("i", 0.3), ("v", 12)],
    scales: [("t", "1e-4"), ("s", "1e-4")],
)"#;

/// The exponential of [`BOOST`]'s matrix, off for a time.
fn off(r: f64, time: f64) -> [[f64; 2]; 2] {
    let (l, c) = (1.5e-3, 10e-6);
    let a: f64 = 0.5 / (r * c);
    let w = (1.0 / (l * c) - a * a).sqrt();
    let (decay, cosine, sine) = ((-a * time).exp(), (w * time).cos(), (w * time).sin() / w);
    [
        [decay * (cosine + sine * a), -decay * sine / l],
        [decay * sine / c, decay * (cosine - sine * a)],
    ]
}

/// The reference current at which the doubled orbit of [`BOOST`], with a ramp of slope `mc`, is on for
/// a whole period, up to the clock, on for `d` until the ramp is reached again, and then off for
/// `T − d`. From the second peak `(I, v)` on, `i` lacks what it gains in `T + d`, and `v` falls to
/// what it was. Both conditions are linear in `(I, v)`.
fn colliding_current(r: f64, mc: f64) -> f64 {
    let (vin, l, c, t) = (10.0, 1.5e-3, 10e-6, 1e-4);
    let d = mc * t / (vin / l + mc);
    let e = off(r, t - d);
    let (rest, fall): ([f64; 2], f64) = ([vin / r, vin], (-(t + d) / (r * c)).exp());
    // e (x − x*) + x* = (I − (T + d) Vin/L, v / fall), x* = (Vin/R, Vin)
    let m = [[e[0][0] - 1.0, e[0][1]], [e[1][0], e[1][1] - 1.0 / fall]];
    let b = [
        e[0][0] * rest[0] + e[0][1] * rest[1] - rest[0] - vin * (t + d) / l,
        e[1][0] * rest[0] + e[1][1] * rest[1] - rest[1],
    ];
    (b[0] * m[1][1] - m[0][1] * b[1]) / (m[0][0] * m[1][1] - m[0][1] * m[1][0]) + mc * d
}

/// Where the clock and the comparator switch at the same time, the clock comes first on the other
/// side; the orbit goes on there with its events in the other order, and back.
#[test]
fn events_exchange_their_order_at_a_border_collision() {
    collides_as_the_closed_form_says(BOOST);
    // The clock ticks at the times nT of the forcing.
    let timed = BOOST
        .replace(", (\"s\", 1)", "")
        .replace(
            "function: \"T - s\", next: \"on\", reset: [(\"s\", 0)]",
            "at: \"n*T\", next: \"on\"",
        )
        .replace(", (\"s\", \"1e-4\")]", "], period: \"T\"");
    collides_as_the_closed_form_says(&timed);
}

fn collides_as_the_closed_form_says(converter: &str) {
    let along = "along: [(name: \"Iref\", low: 0.3, high: 2)]";
    let branches = traced(&format!(
        "Scene(title: \"t\", problem: {converter}, runs: [
            (name: \"once\", start: Simulated(transient: 0.03), {along}),
            (name: \"twice\", start: From(run: \"once\", kind: PD, switch: true), {along}),
            (name: \"beyond\", start: From(run: \"twice\", kind: G, switch: true), {along}),
            (name: \"back\", start: From(run: \"beyond\", kind: EP, switch: false), {along}),
            (name: \"curve\", hold: G, start: From(run: \"twice\", kind: G),
             along: [(name: \"Iref\", low: 0.3, high: 2.5), (name: \"R\", low: 20, high: 80)])])"
    ));
    let [once, twice, beyond, _, curve] = &branches[..] else { panic!("{}", branches.len()) };
    let legs = |branch: &Branch| {
        let mut legs: Vec<String> = branch.itinerary.split(' ').map(String::from).collect();
        legs.sort();
        legs.join(" ")
    };
    assert_eq!(legs(once), "off:clock on:peak");
    let collision = only(twice, Kind::G);
    assert!(collision.event.contains("border collision"), "{}", collision.event);
    close(collision.parameters[0], colliding_current(40.0, 0.0), 1e-10);
    assert_eq!(collision.unstable, Some(0));
    assert_eq!(legs(beyond), "2* off:clock on:clock on:peak");
    let first = beyond.special.iter().find(|it| it.event.contains("border collision")).unwrap();
    close(first.parameters[0], collision.parameters[0], 1e-10);
    assert_eq!(first.unstable, Some(1));
    // In two parameters.
    let [current, r] = ["Iref", "R"].map(|name| curve.column(name).unwrap());
    for point in &curve.points {
        let at = |column| point.value(column).unwrap();
        close(at(current), colliding_current(at(r), 0.0), 1e-9);
    }
    let resistances = || curve.points.iter().map(|point| point.value(r).unwrap());
    close(resistances().fold(40.0, f64::min), 20.0, 1e-12);
    close(resistances().fold(40.0, f64::max), 80.0, 1e-12);
    for column in ["max_v", "min_v", "min_i"] {
        let value = |branch: &Branch, at: &SpecialPoint| at.value(branch.column(column)?);
        let [there, here] = [(twice, collision), (beyond, first)].map(|(b, at)| value(b, at));
        close(here.unwrap(), there.unwrap(), 1e-9);
    }
}

/// The library's converter with a ramp: along the curve of doublings a period's map, by matrix
/// exponentials and the saltation matrix at the peak, closes and has the multiplier −1; the curve
/// of border collisions is known in closed form.
#[test]
fn a_ramp_moves_the_doubling_and_the_border_collision_of_a_converter() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/library/current-mode-boost.ron");
    let branches = traced(&std::fs::read_to_string(path).unwrap());
    let [.., doubling, collision] = &branches[..] else { panic!("{}", branches.len()) };
    let column = |branch: &Branch, name: &str| branch.column(name).unwrap();
    let [current, ramp] = ["Iref", "mc"].map(|name| column(collision, name));
    for point in &collision.points {
        let [current, ramp] = [current, ramp].map(|column| point.value(column).unwrap());
        close(current, colliding_current(40.0, ramp), 1e-9);
    }
    assert!(collision.points.iter().any(|point| point.value(ramp).unwrap() > 5000.0));
    let (e, l, c, r, t) = (10.0, 1.5e-3, 10e-6, 40.0, 1e-4);
    for point in &doubling.points {
        let value = |name: &str| point.value(column(doubling, name)).unwrap();
        let (peak, voltage, mc) = (value("max_i"), value("min_v"), value("mc"));
        let d = (peak - value("min_i")) * l / e;
        close(value("Iref"), peak + mc * d, 1e-9);
        let (phi, fall) = (off(r, t - d), (-d / (r * c)).exp());
        let rest = [e / r, e];
        let apart = [peak - rest[0], voltage - rest[1]];
        let after = |k: usize| phi[k][0] * apart[0] + phi[k][1] * apart[1] + rest[k];
        close(after(0), peak - e * d / l, 1e-9);
        close(after(1) * fall, voltage, 1e-8);
        // S = I + (f_off − f_on) nᵀ / (n f_on + mc), n = (1, 0), after the linear part of `on`.
        let jump = [-voltage / l, peak / c].map(|jump| jump / (e / l + mc));
        let salted = [[1.0 + jump[0], 0.0], [jump[1], fall]];
        let entry = |i: usize, j: usize| phi[i][0] * salted[0][j] + phi[i][1] * salted[1][j];
        let (trace, det) =
            (entry(0, 0) + entry(1, 1), entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0));
        close(1.0 + trace + det, 0.0, 1e-7);
    }
    assert!(
        doubling.points.iter().any(|point| point.value(column(doubling, "mc")).unwrap() > 5999.0)
    );
}

/// An oscillator that touches a spring without pressing it moves freely: the orbits that press it
/// end there with the multipliers `exp(−0.05 ∓ i √(1 − 0.05²)) · 2π/ω`, whatever the steps
/// were.
#[test]
fn stability_at_a_touch_is_that_of_the_free_orbit() {
    for max_step in [0.5, 0.2, 0.1, 0.05, 0.02] {
        let branches = traced(&format!(
            "Scene(title: \"t\", problem: HybridEquations(
                modes: [
                    (name: \"free\", states: [(\"x\", \"v\"), (\"v\", \"force\")]),
                    (name: \"pressed\", states: [(\"x\", \"v\"), (\"v\", \"force - 3*(x - 1)\")]),
                ],
                definitions: [(\"force\", \"A*cos(omega*t) - 0.1*v - x\")],
                guards: [
                    (name: \"touch\", modes: [\"free\"], function: \"1 - x\", next: \"pressed\"),
                    (name: \"leave\", modes: [\"pressed\"], function: \"x - 1\", next: \"free\"),
                ],
                parameters: [(\"A\", 0.3695), (\"omega\", 0.8)],
                period: \"2*pi/omega\"),
             settings: (max_step: {max_step}),
             runs: [(name: \"r\", start: Simulated(transient: 400), along: [(name: \"A\", low: 0, high: 1)])])"
        ));
        let touch = only(&branches[0], Kind::G);
        // |A / (1 − ω² + 0.1iω)| = 1
        close(touch.parameters[0], (0.36_f64.powi(2) + 0.08_f64.powi(2)).sqrt(), 1e-10);
        assert_eq!(touch.unstable, Some(0), "max_step {max_step}");
        for (re, im) in &touch.eigenvalues {
            close(re.hypot(*im), (-0.05 * TAU / 0.8).exp(), 1e-7);
        }
    }
}

/// A ball between two plates of a shaker, found on an orbit of two periods: at its ends the orbit of
/// one period goes on, with its own period; its doubling is one, and no branch point. SciPy gives
/// the multiplier −0.99999998 at `A = 4.5852929354`.
#[test]
fn doubled_hybrid_orbits_lead_to_the_orbit_of_half_the_period() {
    let along = "along: [(name: \"A\", low: 0, high: 20)]";
    let branches = traced(&format!(
        "Scene(title: \"t\", problem: HybridEquations(
            modes: [(name: \"fly\", states: [(\"x\", \"v\"), (\"v\", \"-0.3 + A*cos(2*t)\")])],
            guards: [
                (name: \"top\", modes: [\"fly\"], function: \"1 - x\", reset: [(\"v\", \"-0.6*v\")]),
                (name: \"bottom\", modes: [\"fly\"], function: \"1 + x\", reset: [(\"v\", \"-0.8*v\")]),
            ],
            parameters: [(\"A\", 5)], period: \"pi\", initial: [(\"v\", 1)]),
         runs: [
            (name: \"doubled\", start: Simulated(transient: 300), {along}),
            (name: \"once\", start: From(run: \"doubled\", kind: PD, switch: true), {along}),
            (name: \"touching\", start: From(run: \"once\", kind: G, switch: true), {along}),
         ])"
    ));
    let [doubled, once, touching] = &branches[..] else { panic!("{}", branches.len()) };
    let period = |branch: &Branch| branch.points[0].monitors[0];
    close(period(doubled), TAU, 1e-12);
    close(period(once), PI, 1e-12);
    close(period(touching), PI, 1e-12);
    assert_eq!(once.itinerary, "fly:bottom fly:top");
    let at = only(once, Kind::PD).parameters[0];
    assert!(doubled.of_kind(Kind::PD).any(|it| (it.parameters[0] - at).abs() < 1e-9), "{at}");
    close(only(touching, Kind::PD).parameters[0], 4.585_292_935_4, 1e-9);
    assert_eq!(touching.of_kind(Kind::BP).count(), 0);
}

/// Cycles of Rössler's flow, and of Hénon's map, found doubled.
#[test]
fn doubled_cycles_lead_to_the_cycle_of_half_the_period() {
    for method in ["collocation", "shooting"] {
        let along = format!(
            "set: [(\"solution\", \"orbit\"), (\"method\", \"{method}\")],
             along: [(name: \"c\", low: 2, high: 4)]"
        );
        let branches = traced(&format!(
            "Scene(title: \"t\", problem: Equations(
                states: [(\"x\", \"-y - z\"), (\"y\", \"x + 0.2*y\"), (\"z\", \"0.2 + z*(x - c)\")],
                parameters: [(\"c\", 3.5)], initial: [(\"x\", 1)]),
             runs: [
                (name: \"doubled\", start: Simulated(transient: 500), {along}),
                (name: \"once\", start: From(run: \"doubled\", kind: PD, switch: true), {along}),
             ])"
        ));
        let [doubled, once] = &branches[..] else { panic!("{}", branches.len()) };
        let at = doubled.of_kind(Kind::PD).find(|it| it.parameters[0] < 3.5).unwrap();
        close(at.parameters[0], 2.832_445_028, 1e-8);
        close(only(once, Kind::PD).parameters[0], 2.832_445_028, 1e-8);
        // The orbits of one period lose stability there, from 2 on to 4.
        let of = |c: f64| once.special.iter().find(|it| it.parameters[0] == c).unwrap();
        assert_eq!((of(2.0).unstable, of(4.0).unstable), (Some(0), Some(1)), "{method}");
        assert!(of(2.0).monitors[0] < 5.8 && at.monitors[0] > 11.5, "{method}");
    }
    let along = "along: [(name: \"a\", low: 0, high: 0.9)]";
    let branches = traced(&format!(
        "Scene(title: \"t\", problem: Map(
            states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"0.3*x\")],
            parameters: [(\"a\", 0.8)], initial: [(\"x\", 0.8), (\"y\", 0.2)]),
         runs: [
            (name: \"doubled\", start: Simulated(transient: 3000), {along}),
            (name: \"fixed\", start: From(run: \"doubled\", kind: PD, switch: true), {along}),
         ])"
    ));
    // The fixed point doubles at a = 3 (1 − b)²/4.
    close(only(&branches[0], Kind::PD).parameters[0], 0.75 * 0.7 * 0.7, 1e-10);
    let of = |a: f64| branches[1].special.iter().find(|it| it.parameters[0] == a).unwrap();
    assert_eq!((of(0.0).unstable, of(0.9).unstable), (Some(0), Some(1)));
    assert_eq!(of(0.0).state.len(), 2);
}

/// A guard that jumps away from zero misses its event: that is said. A state that counts time does
/// not: doses of 1 that decay at the rate `k` peak at `1/(1 − e^{−k})`.
#[test]
fn jumping_guards_are_named() {
    let model = |states: &str, guard: &str, period: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: HybridEquations(
                modes: [(name: \"m\", states: [(\"S\", \"-k*S\"){states}])],
                guards: [(name: \"pulse\", modes: [\"m\"], function: {guard})],
                parameters: [(\"k\", 1)]{period}, initial: [(\"S\", 1)]),
             runs: [(name: \"r\", start: Simulated(transient: 50), along: [(name: \"k\", low: 0.5, high: 2)])])"
        );
        Scene::parse(&text).unwrap()
    };
    let period = ", period: \"1\"";
    let jumps = model("", "\"1 - mod(t, 1)\", reset: [(\"S\", \"S + 1\")]", period);
    assert!(
        jumps.warnings()[0].contains("the guard `pulse` is discontinuous"),
        "{:?}",
        jumps.warnings()
    );
    let reset = "\"1 - s\", reset: [(\"S\", \"S + 1\"), (\"s\", 0)]";
    let counts = model(", (\"s\", 1)", reset, "");
    assert_eq!(counts.warnings(), Vec::<String>::new());
    let branch = &execute(&counts, None, &mut ()).document.branches[0];
    let column = branch.column("max_S").unwrap();
    for point in &branch.points {
        let k = point.parameters[0];
        close(point.value(column).unwrap(), 1.0 / (1.0 - (-k).exp()), 1e-9);
    }
}

/// Why a scene cannot be traced.
fn refusal(text: &str) -> String {
    let outcome = execute(&Scene::parse(text).unwrap(), None, &mut ());
    one_line(&outcome.error.expect("a refusal"))
}

/// A damped oscillator beside a wall rests in the end, however long it is followed.
#[test]
fn the_error_names_motion_that_comes_to_rest() {
    let reason = refusal(
        "Scene(title: \"t\", problem: HybridEquations(
            modes: [(name: \"free\", states: [(\"x\", \"v\"), (\"v\", \"-x - 0.5*v\")])],
            guards: [(name: \"hit\", modes: [\"free\"], function: \"c - x\", reset: [(\"v\", \"-0.5*v\")])],
            parameters: [(\"c\", 0.5)], initial: [(\"v\", 1)]),
         runs: [(name: \"r\", start: Simulated(transient: 100), along: [(name: \"c\", low: 0.1, high: 0.9)])])",
    );
    assert!(reason.contains("the motion comes to rest at t = "), "{reason}");
}

/// A relay on the position drives a mass to the origin through ever more switchings: an amplitude
/// `A` takes a time like `4 √A` for a turn, and loses a part like `√A` in each.
#[test]
fn events_that_become_ever_more_frequent_are_refused() {
    let reason = refusal(
        "Scene(title: \"t\", problem: FilippovEquations(surface: \"x\",
            above: [(\"x\", \"v\"), (\"v\", \"-1 - v + a*sin(t)\")],
            below: [(\"x\", \"v\"), (\"v\", \"1 - v + a*sin(t)\")],
            parameters: [(\"a\", 0.3)], period: \"2*pi\", initial: [(\"x\", 1)]),
         runs: [(name: \"r\", start: Simulated(transient: 1), along: [(name: \"a\", low: 0.1, high: 3)])])",
    );
    assert!(reason.contains("events become ever more frequent"), "{reason}");
}
