//! Promise: nullclines and simulations at a point of a branch have the parameters of the point.

use tangency::core::cancel::CancelToken;
use tangency::core::numerics::zero_set;
use tangency::scene::{Place, Scene, execute};

fn axis(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = (high - low) / (count - 1) as f64;
    (0..count).map(|k| low + k as f64 * step).collect()
}

/// The zero set of xy has the two axes, which cross, and the lines have no branches.
#[test]
fn lines_that_cross_lie_on_both_axes() {
    let [x, y] = [axis(-1.0, 1.0, 20), axis(-2.0, 1.0, 24)];
    let lines = zero_set([&x, &y], |[x, y]| x * y);
    assert!(lines.iter().flatten().all(|[x, y]| (x * y).abs() < 1e-12));
    let length = |line: &Vec<[f64; 2]>| {
        let parts =
            line.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        parts.sum::<f64>()
    };
    // The two axes are 2 and 3 long; the corners of the crossing cut off less than a cell.
    let total: f64 = lines.iter().map(length).sum();
    assert!((total - 5.0).abs() < 0.3, "{total}");
}

#[test]
fn poles_jumps_and_undefined_values_leave_gaps() {
    let x = axis(-1.0, 1.0, 30);
    assert!(zero_set([&x, &x], |[x, _]| 1.0 / x).is_empty());
    assert!(zero_set([&x, &x], |[x, _]| 1.0f64.copysign(x - 0.1)).is_empty());
    assert!(zero_set([&x, &x], |_| f64::NAN).is_empty());
    // √x − 1/2 is defined for x ≥ 0 only.
    let lines = zero_set([&x, &x], |[x, _]| x.sqrt() - 0.5);
    assert!(lines.len() == 1 && lines[0].iter().all(|at| (at[0] - 0.25).abs() < 1e-12));
}

#[test]
fn a_zero_at_grid_nodes_is_one_line() {
    let x = axis(-1.0, 1.0, 21);
    let lines = zero_set([&x, &x], |[x, _]| x);
    assert!(lines.len() == 1 && lines[0].iter().all(|at| at[0].abs() < 1e-12));
    assert!((lines[0][0][1] - lines[0][20][1]).abs() > 1.99);
}

/// The Brusselator has the equilibrium (a, b/a), and a Hopf point at b = 1 + a² with ω = a.
#[test]
fn the_phase_space_has_the_values_and_the_time_scale_of_the_point() {
    let scene = Scene::parse(
        "Scene(
            title: \"Brusselator\",
            problem: Equations(states: [(\"x\", \"a - (b + 1)*x + x^2*y\"), (\"y\", \"b*x - x^2*y\")], initial: [(\"x\", 1.5), (\"y\", 0.7)], solution: equilibrium),
            parameters: [(\"a\", 2), (\"b\", 1)],
            runs: [
                (name: \"rest\", set: [(\"a\", \"1.5\")], along: [(name: \"b\", low: 1, high: 5)]),
                (name: \"cycles\", set: [(\"a\", \"1.5\")], start: From(run: \"rest\", kind: HB), along: [(name: \"b\", low: 1, high: 4)]),
            ],
        )",
    )
    .unwrap();
    let document = execute(&scene, None, &mut ()).document;
    let resolution = scene.resolve(None).unwrap();
    let [rest, cycles] = &document.branches[..] else { panic!("two branches") };
    let hopf = rest.special.iter().find(|it| it.kind.letters() == "HB").unwrap();
    let space = resolution.phase_space(rest, Place::Special(hopf.label)).unwrap();
    let value = |name: &str| {
        let all = space.parameters.iter().chain(&space.states);
        all.clone().find(|(known, _)| known == name).unwrap().1
    };
    assert!(
        ["a", "b", "x", "y"]
            .iter()
            .zip([1.5, 3.25, 1.5, 3.25 / 1.5])
            .all(|(name, exact)| { (value(name) - exact).abs() < 1e-8 })
    );
    // Eight periods of 2π/ω, to two digits.
    assert!(space.is_equilibrium && space.duration == 34.0, "{}", space.duration);
    let [x, y] = space.nullclines([0, 1], [[0.1, 3.0], [0.0, 5.0]]);
    let (a, b) = (1.5, value("b"));
    assert!(x.iter().flatten().all(|[x, y]| (a - (b + 1.0) * x + x * x * y).abs() < 1e-9));
    assert!(y.iter().flatten().all(|[x, y]| (b - x * y).abs() < 1e-9));
    // At a regular point of the branch, too, but not of orbits, whose states are not saved there.
    let regular = resolution.phase_space(rest, Place::Regular(1)).unwrap();
    assert!((regular.states[0].1 - 1.5).abs() < 1e-9);
    assert!(resolution.phase_space(cycles, Place::Regular(1)).is_none());
    let end = cycles.special.iter().rev().find(|it| it.kind.letters() == "EP").unwrap();
    let space = resolution.phase_space(cycles, Place::Special(end.label)).unwrap();
    let period = end.value(cycles.column("period").unwrap()).unwrap();
    assert!((space.duration / (5.0 * period) - 1.0).abs() < 0.05 && !space.is_equilibrium);
    // A simulation from the orbit stays on it.
    let token = CancelToken::default();
    let simulated =
        space.simulation(scene.clone(), (space.states.clone(), period), &token).unwrap();
    let history = &execute(&simulated, None, &mut ()).document.branches[0];
    let column =
        |branch: &tangency::core::continuation::Branch, name: &str| branch.column(name).unwrap();
    let [simulated, traced] = [
        history.points[0].value(column(history, "max_x")).unwrap(),
        end.value(column(cycles, "max_x")).unwrap(),
    ];
    assert!((simulated / traced - 1.0).abs() < 1e-3, "{simulated} {traced}");
}
