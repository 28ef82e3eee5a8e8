//! Promise: motion without forcing is swept by its returns to an event, and in text systems basins
//! are drawn over two states.

use crate::common::close;
use tangency::core::attractor::{AttractorSearch, ReturnMap, StroboscopicError, StroboscopicMap};
use tangency::core::continuation::Branch;
use tangency::core::failure::one_line;
use tangency::core::hybrid::{HybridSettings, HybridState, Member};
use tangency::core::sweep::Part;
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::language::Model;
use tangency::output::{SweepTable, figures};
use tangency::problems::classic::ImpactOscillator;
use tangency::scene::{Scene, execute, sweep as swept};

/// The simplest walker of the library, with slopes at which its steps repeat after one, two and
/// four.
const SLOPES: [(&str, f64, usize); 3] =
    [("walk", 0.009, 1), ("limp", 0.0165, 2), ("four steps", 0.0179, 4)];

fn walker() -> Scene {
    let mut scene = Scene::parse(include_str!("../../scenes/library/simplest-walker.ron")).unwrap();
    for (run, (name, slope, _)) in scene.runs.iter_mut().zip(SLOPES) {
        assert_eq!(run.name, name);
        run.marks = vec![("gamma".into(), slope)];
    }
    scene
}

/// The largest modulus of the multipliers at a mark.
fn largest(branch: &Branch) -> f64 {
    let mark = branch.of_kind(Kind::UZ).next().unwrap();
    assert_eq!(mark.unstable, Some(0));
    mark.eigenvalues.iter().map(|(re, im)| re.hypot(*im)).fold(0.0, f64::max)
}

/// In the least number of returns, with the exponent of the branch's multipliers.
#[test]
fn cycles_of_returns_have_their_exponents() {
    let scene = walker();
    let outcome = execute(&scene, None, &mut ());
    assert_eq!(outcome.error, None);
    let Some(Model::Hybrid(system)) = scene.problem.text() else { panic!("a hybrid system") };
    let mut map = ReturnMap::of(&**system, HybridSettings::default(), &[], "heel").unwrap();
    let search =
        AttractorSearch { transient: 300, lyapunov_periods: 0, ..AttractorSearch::default() };
    let mut state = HybridState { mode: 0, time: 0.0, x: vec![0.2, -0.2, 0.4, -0.0158] };
    let mut now = SLOPES[0].1;
    for (branch, (name, slope, returns)) in outcome.document.branches.iter().zip(SLOPES) {
        // Not at one go: the walker would fall.
        while now < slope {
            state = search.follow(&mut map, state, &[now]).unwrap().end;
            now += 2e-4;
        }
        now = slope;
        let found = search.follow(&mut map, state.clone(), &[slope]).unwrap();
        assert_eq!((found.periods, found.count("heel")), (Some(returns), returns as f64), "{name}");
        let exponent = found.exponent.unwrap();
        close(exponent.value, largest(branch).ln() / returns as f64, 1e-6);
    }
}

/// The numbers of a column, run by run.
fn numbers(table: &SweepTable, name: &str) -> Vec<f64> {
    let column = table.run_columns.iter().position(|known| known == name).unwrap();
    table.rows.values().map(|row| row.values[column]).collect()
}

/// The walker's steps along the slope: doublings at 0.0150884, 0.0176694 and 0.0181601.
#[test]
fn steps_double_along_a_sweep() {
    let text = include_str!("../../scenes/library/simplest-walker.ron");
    let sweeps = r#"    sweeps: [(
        name: "steps", at: "heel", over: [(name: "gamma", low: 0.0140, high: 0.0182, count: 22)], order: up,
        starts: [[("theta", 0.2), ("rate", -0.2), ("phi", 0.4), ("swing", -0.0158)]],
        search: (transient: 600, recorded_periods: 60, lyapunov_periods: 0), measures: ["max_theta"],
    )],
)"#;
    let (text, _) = text.rsplit_once(')').unwrap();
    let scene = Scene::parse(&(text.to_string() + sweeps)).unwrap();
    let found = swept(&scene, "steps", Part::WHOLE, None, &mut ()).unwrap();
    let table = &found.sweeps[0];
    let periods = numbers(table, "periods");
    for (slope, periods) in numbers(table, "gamma").iter().zip(&periods) {
        let expected = match slope {
            ..0.01508 => 1.0,
            0.0152..0.0176 => 2.0,
            0.0178..0.0181 => 4.0,
            _ => continue,
        };
        assert_eq!(*periods, expected, "γ = {slope}");
    }
    assert!(periods.contains(&1.0) && periods.contains(&2.0) && periods.contains(&4.0));
    assert!(figures(&[], std::slice::from_ref(&found), None, &[]).is_ok());
}

/// What has a forcing is sampled by it, what has none at an event, one that there is.
#[test]
fn samples_that_cannot_be_are_refused() {
    let settings = HybridSettings::default();
    let forced = ReturnMap::of(&ImpactOscillator, settings, &[], "impact").err();
    assert_eq!(forced, Some(StroboscopicError::Forced("impact".into())));
    let text = |guard: &str, sweep: &str| {
        format!(
            r#"Scene(
            title: "t",
            problem: HybridEquations(
                modes: [(name: "motion", states: [("x", "1 - x")])],
                guards: [(name: "flash", function: "{guard}", reset: [("x", 0)])],
            ),
            parameters: [("top", 0.5)],
            sweeps: [(name: "s", over: [(name: "top", low: 0.5, high: 2, count: 2)], {sweep} search: (transient: 5))],
        )"#
        )
    };
    let refused = |sweep: &str| one_line(&Scene::parse(&text("top - x", sweep)).unwrap_err());
    assert!(refused("").contains("`--at EVENT`; `at` in a scene"));
    assert!(refused(r#"at: "flask","#).contains("did you mean `flash`"));
    let scene = Scene::parse(&text("top - x", r#"at: "flash","#)).unwrap();
    let found = swept(&scene, "s", Part::WHOLE, None, &mut ()).unwrap();
    // Where the event does not come motion rests, which is an answer.
    let table = &found.sweeps[0];
    assert!(table.rows.values().all(|row| row.failure.is_none()));
    assert_eq!(numbers(table, "periods"), [1.0, 1.0]);
    assert_eq!(numbers(table, "flash"), [1.0, 0.0]);
}

/// Beside a clock that ticks, `x' = x − x³` goes to the side on which it begins.
#[test]
fn basins_of_a_text_system_are_over_two_states() {
    let text = r#"Scene(
        title: "Two sides",
        problem: HybridEquations(
            modes: [
                (name: "plus", states: [("x", "x - x^3"), ("y", "cos(t) - y")]),
                (name: "minus", states: [("x", "x - x^3"), ("y", "cos(t) - y")]),
            ],
            guards: [
                (name: "down", modes: ["plus"], function: "y", next: "minus"),
                (name: "up", modes: ["minus"], function: "-y", next: "plus"),
            ],
            period: "2*pi",
        ),
        plot: (x: "x", y: "y"),
        sweeps: [(
            name: "basins", over: [(name: "x", low: -1.5, high: 1.5, count: 6), (name: "y", low: 0.1, high: 0.9, count: 5)],
            search: (transient: 20, recorded_periods: 10, lyapunov_periods: 0),
        )],
    )"#;
    let scene = Scene::parse(text).unwrap();
    let found = swept(&scene, "basins", Part::WHOLE, None, &mut ()).unwrap();
    let table = &found.sweeps[0];
    let (starts, ends) = (numbers(table, "x"), numbers(table, "end_0"));
    assert_eq!(starts.len(), 30);
    for (start, end) in starts.iter().zip(ends) {
        close(end, start.signum(), 1e-9);
    }
    assert!(numbers(table, "periods").iter().all(|periods| *periods == 1.0));
    let drawn = figures(&[], std::slice::from_ref(&found), None, &[]).unwrap();
    assert!(!drawn.is_empty());
}

hybrid_system! {
    /// `v' = a + b v` from 0 to 1, where it falls back.
    struct Charging [a, b] {
        mode charging [v] {
            d/dt v = a + b * v;
            event flash: -v + 1.0 => charging { v: T::zero() };
        }
    }
}

/// An event that comes late is told from one that does not come, and waited for where that is
/// asked.
#[test]
fn events_that_come_late_are_waited_for() {
    let map = || ReturnMap::of(&Charging, HybridSettings::default(), &[], "flash").unwrap();
    let from = |p: [f64; 2]| Member {
        state: HybridState { mode: 0, time: 0.0, x: vec![0.0] },
        p: p.into(),
    };
    // It comes after a time of 20 000, and not where v settles on 1/2.
    let slow = || from([5e-5, 0.0]);
    let error = map().advance(&mut slow()).unwrap_err();
    assert!(matches!(error, StroboscopicError::Late { within: 10_000.0, .. }), "{error}");
    assert!(one_line(&error).contains("`ReturnMap::waiting`"), "{error}");
    let mut late = slow();
    map().waiting(30_000.0).advance(&mut late).unwrap();
    assert_eq!(late.state.x, [0.0]);
}

/// Where the event does not come motion rests: a stable cycle of one return, without the event.
#[test]
fn rest_is_an_attractor() {
    let mut map = ReturnMap::of(&Charging, HybridSettings::default(), &[], "flash").unwrap();
    let start = HybridState { mode: 0, time: 0.0, x: vec![0.0] };
    let search = AttractorSearch { transient: 20, ..AttractorSearch::default() };
    let found = search.follow(&mut map, start, &[0.5, -1.0]).unwrap();
    assert_eq!((found.periods, found.count("flash")), (Some(1), 0.0));
    assert!((found.end.x[0] - 0.5).abs() < 1e-11, "{:?}", found.end);
    // There is no return by which an exponent would count.
    assert_eq!(found.exponent, None);
}
