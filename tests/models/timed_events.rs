//! Promise: events at given times come at these times, in simulations, sweeps and on branches, and
//! what they do is as exact as the rest.

use super::{scene, traced};
use crate::common::close;
use std::ops::ControlFlow;
use tangency::core::failure::one_line;
use tangency::core::hybrid::{Event, HybridFlow, HybridSettings, HybridState, time_left};
use tangency::core::sweep::Part;
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::scene::{Scene, execute, sweep};

/// The only error of a scene, when it is read or when it is traced.
fn refusal(text: &str) -> String {
    match Scene::parse(text) {
        Err(error) => one_line(&error),
        Ok(scene) => one_line(&execute(&scene, None, &mut ()).error.expect("an error")),
    }
}

/// Doses of 1 that decay at the rate `k` peak at `1/(1 − e^{−kτ})`, if they come at the interval `τ`.
fn doses(at: &str, period: &str) -> String {
    format!(
        "HybridEquations(
            modes: [(name: \"m\", states: [(\"S\", \"-k*S\")])],
            guards: [(name: \"dose\", modes: [\"m\"], at: \"{at}\", reset: [(\"S\", \"S + 1\")])],
            parameters: [(\"k\", 1), (\"tau\", 0.7)], initial: [(\"S\", 1)]{period})"
    )
}

#[test]
fn doses_at_given_times_peak_as_they_must() {
    // In which the model's period is stated, its part between doses, and the start of the itinerary.
    let cases =
        [("n", "1", 1.0, 1), ("n/2 + 0.2", "1", 0.5, 2), ("0.1 - 2*n*tau", "2*tau", 1.4, 0)];
    for ((at, period, interval, doses_in_period), method) in
        cases.into_iter().flat_map(|case| [(case, "shooting"), (case, "collocation")])
    {
        let model = doses(at, &format!(", period: \"{period}\""));
        let text = format!(
            "Scene(title: \"t\", problem: {model}, runs: [
                (name: \"r\", set: [(\"method\", \"{method}\")], start: Simulated(transient: 50),
                 along: [(name: \"k\", low: 0.5, high: 2)])])"
        );
        if doses_in_period == 0 {
            assert!(
                refusal(&text).contains("the time must grow by the period"),
                "{}",
                refusal(&text)
            );
            continue;
        }
        let branch = &traced(&text)[0];
        assert_eq!(branch.itinerary.matches("dose").count(), doses_in_period);
        let column = branch.column("max_S").unwrap();
        for point in &branch.points {
            let k = point.parameters[0];
            close(point.value(column).unwrap(), 1.0 / (1.0 - (-k * interval).exp()), 1e-10);
        }
        for end in &branch.special {
            close(end.eigenvalues[0].0, (-end.parameters[0]).exp(), 1e-8);
        }
    }
}

/// A seasonal epidemic under pulse vaccination: by the time, and by a state that counts it.
#[test]
fn pulse_vaccination_by_time_equals_the_model_with_a_clock() {
    let model = |clock: &str, season: &str, guard: &str, rest: &str| {
        format!(
            "Scene(title: \"t\", problem: HybridEquations(
                modes: [(name: \"go\",
                         states: [(\"S\", \"mu - bt*S*I - mu*S\"), (\"L\", \"bt*S - mu - g\"){clock}])],
                definitions: [(\"I\", \"exp(L)\"), (\"bt\", \"b0*(1 + b1*cos(2*pi*{season}))\")],
                guards: [(name: \"pulse\", modes: [\"go\"], {guard})],
                parameters: [(\"b0\", 80), (\"b1\", 0.02), (\"mu\", 0.02), (\"g\", 20), (\"p\", 0.01)],
                initial: [(\"S\", 0.25), (\"L\", -7)]{rest}),
             runs: [(name: \"r\", start: Simulated(transient: 500),
                     along: [(name: \"b1\", low: 0, high: 0.4)])])"
        )
    };
    let timed = model("", "t", "at: \"n\", reset: [(\"S\", \"(1-p)*S\")]", ", period: \"1\"");
    let counted = model(
        ", (\"s\", 1)",
        "s",
        "function: \"1 - s\", reset: [(\"s\", 0), (\"S\", \"(1-p)*S\")]",
        "",
    );
    let [timed, counted] = [timed, counted].map(|text| traced(&text).swap_remove(0));
    assert_eq!((timed.special.len(), counted.special.len()), (2, 2));
    for (timed_point, counted_point) in timed.special.iter().zip(&counted.special) {
        assert_eq!(timed_point.parameters[1], counted_point.parameters[1]);
        for column in ["max_S", "min_S", "max_L", "min_L", "period"] {
            let [a, b] = [(&timed, timed_point), (&counted, counted_point)]
                .map(|(branch, point)| point.value(branch.column(column).unwrap()).unwrap());
            close(a, b, 1e-10);
        }
        let largest = [timed_point, counted_point].map(|point| point.eigenvalues[0].0);
        close(largest[0], largest[1], 1e-8);
    }
}

/// `x` rises at the rate 1 to 1, and falls by `x' = −a − 2(x − 1)` until a clock ticks, which counts
/// while it falls only. It begins to fall with a tick at `a = 2/(1 − e^{−2})`, in the second period of
/// an orbit of two: before, motion is another one.
#[test]
fn an_event_that_comes_with_a_tick_which_did_not_count_is_a_border_collision() {
    let along = "along: [(name: \"a\", low: 1, high: 3)]";
    let text = format!(
        "Scene(title: \"t\", problem: HybridEquations(
            modes: [
                (name: \"on\", states: [(\"x\", \"1\")]),
                (name: \"off\", states: [(\"x\", \"-a - 2*(x - 1)\")]),
            ],
            guards: [
                (name: \"peak\", modes: [\"on\"], function: \"1 - x\", next: \"off\"),
                (name: \"clock\", modes: [\"off\"], at: \"n\", next: \"on\"),
            ],
            parameters: [(\"a\", 2.6)], period: \"1\", initial: [(\"x\", -0.2)]),
         runs: [
            (name: \"r\", start: Simulated(transient: 50), {along}),
            (name: \"s\", start: From(run: \"r\", kind: G, switch: true), {along}),
         ])"
    );
    let outcome = execute(&scene(&text), None, &mut ());
    let branch = &outcome.document.branches[0];
    let collision = branch.of_kind(Kind::G).next().expect("a border collision");
    assert_eq!(collision.subkind.as_deref(), Some("border collision"));
    close(collision.parameters[0], 2.0 / (1.0 - (-2.0_f64).exp()), 1e-10);
    let refused = one_line(&outcome.error.expect("no orbit is near on the other side"));
    assert!(refused.contains("their order determines the state of the motion"), "{refused}");
}

/// A sweep samples just when doses come: the dose belongs to the period that ends.
#[test]
fn a_sweep_takes_doses_at_the_ends_of_periods() {
    let model = doses("n", ", period: \"1\"");
    let scene = scene(&format!(
        "Scene(title: \"t\", problem: {model}, sweeps: [(name: \"s\", order: anew,
            over: [(name: \"k\", low: 0.5, high: 2, count: 4)], starts: [[(\"S\", 3)]],
            search: (transient: 60, recorded_periods: 10, lyapunov_periods: 0))])"
    ));
    let sweeps = sweep(&scene, "t", Part::WHOLE, None, &mut ()).unwrap();
    let table = &sweeps.sweeps[0];
    let column = |name: &str| table.run_columns.iter().position(|known| known == name).unwrap();
    assert_eq!(table.rows.len(), 4);
    for row in table.rows.values() {
        let k = row.values[column("k")];
        close(row.values[column("dose")], 1.0, 1e-12);
        close(row.values[column("end_0")], 1.0 / (1.0 - (-k).exp()), 1e-9);
        close(row.values[column("exponent")], -k, 1e-9);
    }
}

#[test]
fn times_that_do_not_repeat_with_the_period_are_refused() {
    let run = "runs: [(name: \"r\", start: Simulated(transient: 50), along: [(name: \"k\", low: 0.5, high: 2)])]";
    let of = |at: &str, rest: &str| {
        refusal(&format!("Scene(title: \"t\", problem: {}, {run})", doses(at, rest)))
    };
    let period = ", period: \"tau\"";
    assert!(of("n", "").contains("state the period"), "{}", of("n", ""));
    assert!(of("n*S", period).contains("not states or time"), "{}", of("n*S", period));
    assert!(of("n*t", period).contains("not states or time"), "{}", of("n*t", period));
    assert!(of("n^2*tau", period).contains("the time must grow by the period"));
    // Equal for the default, `tau = 0.7`, only.
    assert!(of("0.7*n", period).contains("the time must grow by the period"));
    let both = doses("n", ", period: \"1\"").replace("at:", "function: \"S\", at:");
    let both = refusal(&format!("Scene(title: \"t\", problem: {both}, {run})"));
    assert!(both.contains("a guard with a `function` cannot have event times `at`"), "{both}");
    let text = format!("Scene(title: \"t\", problem: {}, {run})", doses("n", ", period: \"1\""));
    let text = text.replace("start: Simulated(transient: 50)", "set: [(\"itinerary\", \"m\")]");
    assert!(
        refusal(&text).contains("`dose` occurs at given times in this mode"),
        "{}",
        refusal(&text)
    );
}

hybrid_system! {
    /// Two pulses at the same times, in the order in which they are stated, and one in between.
    struct Pulses [period; t] {
        period = period, phase = 1.0;
        mode m [x] {
            d/dt x = T::zero();
            event double.at(1): time_left(t, period * 0.0, period) => m { x: x * 2.0 };
            event add.at(1): time_left(t, period * 0.0, period) => m { x: x + 1.0 };
            event between.at(1): time_left(t, period * 0.5, period) => m { x: x - 0.5 };
        }
    }
}

#[test]
fn events_that_come_together_come_in_the_order_in_which_they_are_stated() {
    let mut flow = HybridFlow::new(&Pulses, HybridSettings::default()).unwrap();
    for pieces in [1, 2, 3, 7, 30] {
        let mut motion = HybridState { mode: 0, time: 0.0, x: vec![1.0] };
        let mut seen = Vec::new();
        for _ in 0..pieces {
            let mut see = |event: &Event<f64>| {
                seen.push((event.guard, event.time));
                ControlFlow::Continue(())
            };
            flow.advance(&mut motion, 0.9 / pieces as f64, &[0.3], &mut see).unwrap();
        }
        // At the start nothing comes; at the end both do.
        let guards: Vec<usize> = seen.iter().map(|(guard, _)| *guard).collect();
        assert_eq!(guards, [2, 0, 1, 2, 0, 1, 2, 0, 1], "{pieces} pieces: {seen:?}");
        for (k, (_, time)) in seen.iter().enumerate() {
            close(*time, [0.15, 0.3, 0.3][k % 3] + 0.3 * (k / 3) as f64, 1e-12);
        }
        // 1 → ½ → 2, → 1½ → 4, → 3½ → 8.
        close(motion.x[0], 8.0, 1e-12);
    }
}
