//! Promise: phase responses are those of exact formulas, and of simulated motion after kicks, by both
//! methods and through events; where there is none, a reason is given.

use crate::common::{close, difference, dot, first};
use crate::orbits::cycles::collocation;
use std::f64::consts::TAU;
use tangency::core::bvp::{Collocation, Method, Shooting, phase_response};
use tangency::core::continuation::{Branch, Continuation, Settings, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::{Equilibria, Profile};
use tangency::core::system::{Dense, Kind, System};
use tangency::output::{Document, figures};
use tangency::scene::{BUILT_IN, LIBRARY, Purpose, Request, Scene, Simulated, execute};
use tangency::vector_field;

vector_field! {
    /// `r' = r(1 − r²)`, `φ' = 1 + b(1 − r²)` with `r` in units of `size`: the asymptotic phase is
    /// `φ − b log r`.
    struct Radial { size: f64 } [x, y; b] {
        let inwards = -(x * x + y * y) / (size * size) + 1.0;
        d/dt x = x * inwards - y * (b * inwards + 1.0);
        d/dt y = y * inwards + x * (b * inwards + 1.0);
    }
}

vector_field! {
    /// `r' = r(μ + 2r² − r⁴)`, `φ' = 1 + r²`: a fold of cycles at `μ = −1`, `r = 1`.
    struct Sheared [x, y; mu] {
        let square = x * x + y * y;
        let growth = mu + square * 2.0 - square * square;
        let turning = square + 1.0;
        d/dt x = x * growth - y * turning;
        d/dt y = y * growth + x * turning;
    }
}

#[test]
fn responses_are_exact_in_any_units() {
    let methods = |intervals: usize| -> [(Method, usize); 3] {
        let precise = Collocation::new(7).unwrap();
        [
            (Shooting::default().into(), 1),
            (Shooting::default().into(), 5),
            (precise.into(), intervals),
        ]
    };
    for (size, (method, intervals)) in
        [1.0, 1e3].into_iter().flat_map(|size| methods(30).map(|method| (size, method)))
    {
        let mut cycles = periodic_orbits(Radial { size }, intervals, method).unwrap();
        let z = cycles.sampled(&[TAU], |_, tau, x| {
            (x[1], x[0]) = (tau * TAU).sin_cos();
            x.iter_mut().for_each(|x| *x *= size);
        });
        let b = 0.7;
        let x = [&z[..], &[b]].concat();
        let (histories, response) = (cycles.profiles(&x), phase_response(&mut cycles, &x).unwrap());
        let names: Vec<&str> = response.iter().map(|profile| profile.name.as_str()).collect();
        assert_eq!(names, ["phase_response_x", "phase_response_y"]);
        for k in 0..histories[0].points.len() {
            let [[t, x], [_, y]] = [0, 1].map(|i| response[i].points[k]);
            assert_eq!(t, histories[0].points[k][0]);
            close(x * size, -t.sin() - b * t.cos(), 1e-8);
            close(y * size, t.cos() - b * t.sin(), 1e-8);
        }
        assert_eq!(response[0].points.len(), histories[0].points.len());
    }
}

fn sheared(method: impl Into<Method>, intervals: usize) -> Branch {
    let mut rest = Dense::new(Equilibria::new(Sheared));
    let rest = Continuation::new(&mut rest).at("mu", 0.5).along("mu", -2.0..=0.5).trace().unwrap();
    let hopf = first(&rest, Kind::HB);
    let mut cycles = periodic_orbits(Sheared, intervals, method).unwrap();
    Continuation::new(&mut cycles)
        .restart(&rest, hopf.label)
        .along("mu", -2.0..=0.5)
        .settings(Settings { phase_response: true, ..Settings::default() })
        .trace()
        .unwrap()
}

fn has_response(point: &SpecialPoint) -> bool {
    point.profiles.iter().any(|profile| profile.kicked().is_some())
}

#[test]
fn folds_of_cycles_have_no_response_and_say_so() {
    for branch in [sheared(Shooting::default(), 1), sheared(collocation(4), 20)] {
        let fold = first(&branch, Kind::LP);
        assert!(!has_response(fold));
        let reason = fold.without_phase_response.as_ref().expect("a reason");
        let warning =
            format!("the special point {} (LP) has no phase response: {reason}", fold.label);
        assert!(reason.contains("as at a fold of cycles"), "{reason}");
        assert!(branch.warnings.contains(&warning), "{:?}", branch.warnings);
        // μ = 0.5, r² = 1 + √1.5, where |Z|² is the square of −ω'/(g' ω) and of 1/(r ω).
        let end = branch.special.last().unwrap();
        assert!(end.without_phase_response.is_none() && end.parameters[0] == 0.5);
        let square = 1.0 + 1.5_f64.sqrt();
        let omega = 1.0 + square;
        let along = 2.0 * square.sqrt() / ((4.0 * square - 4.0 * square * square) * omega);
        let expected = along.hypot(1.0 / (square.sqrt() * omega));
        let responses: Vec<&Profile> =
            end.profiles.iter().filter(|profile| profile.kicked().is_some()).collect();
        assert!(responses[0].points.len() > 100);
        for (x, y) in responses[0].points.iter().zip(&responses[1].points) {
            close(x[1].hypot(y[1]), expected, 1e-6 * expected);
        }
    }
}

#[test]
fn folds_in_a_canard_explosion_have_no_response() {
    let mut scene = built_in("fitzhugh-nagumo");
    scene.set("phase_response", "true").unwrap();
    let outcome = execute(&scene, None, &mut ());
    let cycles = outcome.document.branch("firing").unwrap();
    for fold in cycles.of_kind(Kind::LP) {
        assert!(fold.without_phase_response.is_some() && !has_response(fold));
    }
    let rest = outcome.document.branch("rest").unwrap();
    assert!(rest.warnings.is_empty(), "{:?}", rest.warnings);
}

fn built_in(name: &str) -> Scene {
    let scene = BUILT_IN.iter().chain(LIBRARY).find(|scene| scene.name == name).expect("a scene");
    Scene::parse(scene.text).unwrap()
}

#[test]
fn the_setting_is_refused_where_there_is_no_phase() {
    for name in ["integrate-and-fire", "plate-clamped"] {
        let error =
            built_in(name).check_effects(["phase_response"], Purpose::Runs, None).unwrap_err();
        assert!(one_line(&error).starts_with("`phase_response` has no effect"), "{error}");
    }
    built_in("fitzhugh-nagumo").check_effects(["phase_response"], Purpose::Runs, None).unwrap();
    // In a scene it is as well for other runs, and a forced orbit says why it has none.
    let mut scene = built_in("integrate-and-fire");
    scene.settings.phase_response = true;
    scene.runs.truncate(1);
    let branch = execute(&scene, None, &mut ()).document.branches.remove(0);
    let said =
        |it: &SpecialPoint| it.without_phase_response.as_ref().map(|it| it.contains("forced"));
    assert!(branch.special.iter().all(|point| said(point) == Some(true)));
}

/// A scene of one run, in which motion settles on a cycle, with the response at its start.
fn cycles(problem: &str, (name, value): (&str, f64), transient: f64) -> Scene {
    let text = format!(
        "Scene(title: \"t\", problem: {problem}, settings: (phase_response: true, max_points: 1), runs: [(name: \"r\", start: \
         Simulated(transient: {transient}), along: [(name: \"{name}\", low: {value}, high: {})])])",
        value + 0.1
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"))
}

/// A cycle that is kicked.
struct Kicked {
    scene: Scene,
    /// The state that tells where the cycle is kicked: in the first mode, away from events.
    between: (&'static str, [f64; 2]),
}

impl Kicked {
    /// Where motion is after a time.
    fn after(&self, names: &[&str], state: &[f64], duration: f64) -> Vec<f64> {
        let state = names.iter().map(|name| name.to_string()).zip(state.iter().copied()).collect();
        let simulated = Simulated { state, transient: 0.0, duration, ..Simulated::default() };
        let scene = self.scene.clone().simulating(&Request::default(), simulated).unwrap();
        let outcome = execute(&scene, None, &mut ());
        assert!(outcome.error.is_none(), "{:?}", outcome.error);
        let profiles = &outcome.document.branches[0].special[0].profiles;
        let end = |name: &&str| {
            let history = profiles.iter().find(|it| it.name == *name && it.along == "time");
            history.unwrap().points.last().unwrap()[1]
        };
        names.iter().map(end).collect()
    }

    /// Compares the response with the shifts of motion after many periods, from central differences
    /// of order four; the largest error of any state, relative to its largest response.
    fn largest_error(&self) -> f64 {
        let branch = execute(&self.scene, None, &mut ()).document.branches.remove(0);
        // The branch begins on the lower bound of its parameter.
        let point = branch.special.iter().find(|it| it.after == 0).expect("the start");
        let period = point.value(branch.column("period").unwrap()).unwrap();
        let profile = |name: &str| {
            let known = point.profiles.iter().find(|it| it.name == name && it.along == "time");
            &known.unwrap_or_else(|| panic!("no {name}")).points
        };
        let names: Vec<&str> = point.profiles.iter().filter_map(Profile::kicked).collect();
        let responses: Vec<_> = names
            .iter()
            .map(|name| profile(&format!("{}{name}", Profile::PHASE_RESPONSE)))
            .collect();
        let (state, [low, high]) = self.between;
        let places: Vec<usize> = (0..profile(state).len())
            .filter(|&k| (low..=high).contains(&profile(state)[k][1]))
            .collect();
        // The others have died away by 1e-11.
        let slowest = point.eigenvalues.iter().map(|mu| mu.0.hypot(mu.1)).fold(0.0, f64::max);
        let periods = (1e-11_f64.ln() / slowest.ln()).ceil().max(2.0);
        let mut worst: f64 = 0.0;
        for k in (1..6).map(|part| places[part * places.len() / 6]) {
            let drawn: Vec<f64> = names.iter().map(|name| profile(name)[k][1]).collect();
            // Histories are drawn to 1e-8 only, and the isochrons of the walker bend within 1e-3.
            let state = self.after(&names, &drawn, periods * period);
            let h = 1e-3 * period;
            let motion =
                difference(&[periods * period], &[1.0], h, |t| self.after(&names, &state, t[0]));
            for (i, response) in responses.iter().enumerate() {
                let sizes =
                    |curve: &[[f64; 2]]| curve.iter().map(|at| at[1].abs()).fold(0.0, f64::max);
                let mut kick = vec![0.0; names.len()];
                kick[i] = 1.0;
                let h = 5e-5 * sizes(profile(names[i]));
                let end = |x: &[f64]| self.after(&names, x, periods * period);
                let moved = difference(&state, &kick, h, end);
                let shift = dot(&moved, &motion) / dot(&motion, &motion);
                let error = (response[k][1] - shift).abs() / sizes(response);
                worst = worst.max(error);
            }
        }
        println!("the largest error of the response: {worst:.1e}");
        worst
    }
}

#[test]
fn responses_of_smooth_cycles_are_those_of_kicked_motion() {
    for method in ["shooting(segments: 2)", "collocation(intervals: 60, degree: 5)"] {
        let problem = format!(
            "Equations(states: [(\"x\", \"y\"), (\"y\", \"mu*(1 - x^2)*y - x\")], parameters: [(\"mu\", 1)],
             initial: [(\"x\", 2)], solution: orbit, method: {method})"
        );
        let scene = cycles(&problem, ("mu", 1.0), 50.0);
        let error = Kicked { scene, between: ("x", [-3.0, 3.0]) }.largest_error();
        assert!(error < 1e-6, "{method}: {error:.1e}");
    }
}

/// A neuron with adaptation, which is reset when it fires.
fn neuron(method: &str) -> Scene {
    let problem = format!(
        "HybridEquations(
            modes: [(name: \"rest\", states: [(\"v\", \"I - v - w\"), (\"w\", \"-w/tau\")])],
            guards: [(name: \"spike\", modes: [\"rest\"], function: \"1 - v\", reset: [(\"v\", 0), (\"w\", \"w + d\")])],
            parameters: [(\"I\", 1.6), (\"tau\", 3), (\"d\", 0.1)], method: {method})"
    );
    cycles(&problem, ("I", 1.6), 50.0)
}

#[test]
fn responses_of_a_firing_neuron_are_those_of_kicked_motion() {
    for method in ["shooting()", "collocation(intervals: 20, degree: 4)"] {
        let error = Kicked { scene: neuron(method), between: ("v", [0.05, 0.95]) }.largest_error();
        assert!(error < 1e-6, "{method}: {error:.1e}");
    }
}

/// Two events a cycle, of which one changes nothing but the mode.
#[test]
fn responses_of_a_walker_are_those_of_kicked_motion() {
    let mut scene = built_in("simplest-walker");
    scene.runs.truncate(1);
    scene.runs[0].marks.clear();
    scene.runs[0].along[0].low = Some(0.009);
    (scene.settings.phase_response, scene.settings.max_points) = (true, 1);
    let error = Kicked { scene, between: ("theta", [0.02, 0.18]) }.largest_error();
    assert!(error < 1e-6, "{error:.1e}");
}

/// A field that jumps where it is crossed: nothing is reset, and the response jumps all the same.
#[test]
fn responses_of_a_relay_are_those_of_kicked_motion() {
    let problem = "FilippovEquations(
        surface: \"x\",
        above: [(\"x\", \"y - 3*x\"), (\"y\", \"z - 3*x\"), (\"z\", \"-x - k\")],
        below: [(\"x\", \"y - 3*x\"), (\"y\", \"z - 3*x\"), (\"z\", \"-x + k\")],
        parameters: [(\"k\", 1)], initial: [(\"x\", 0.1), (\"y\", 0.1)])";
    let scene = cycles(problem, ("k", 1.0), 100.0);
    let error = Kicked { scene, between: ("x", [0.03, 10.0]) }.largest_error();
    assert!(error < 1e-6, "{error:.1e}");
}

#[test]
fn pictures_have_a_panel_of_the_response() {
    let document: Document = execute(&neuron("shooting()"), None, &mut ()).document;
    let drawn = figures(&[("neuron", &document)], &[], None, &[]).unwrap();
    let over_time = drawn.iter().filter(|figure| figure.x_label == "time");
    let labels: Vec<&str> = over_time.map(|figure| figure.y_label.as_str()).collect();
    assert_eq!(labels, ["v", "phase response to v"]);
}
