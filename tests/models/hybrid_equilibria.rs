//! Promise: rest of hybrid and Filippov systems is followed through the boundaries of modes.

use super::library::{executed, scene};
use crate::common::{close, only};
use tangency::core::continuation::{Branch, End, Point, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::scene::{Scene, execute};

fn traced(problem: &str, runs: &str) -> Vec<Branch> {
    let text = format!(
        "Scene(title: \"rest\", settings: (eigenvalues: 3), problem: {problem}, runs: [{runs}])"
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document.branches
}

fn refusal(problem: &str) -> String {
    let run = r#"Run(name: "rest", along: [(name: "mu", low: -1, high: 1)])"#;
    let text = format!("Scene(title: \"rest\", problem: {problem}, runs: [{run}])");
    let outcome = match Scene::parse(&text) {
        Ok(scene) => execute(&scene, None, &mut ()),
        Err(error) => return one_line(&error),
    };
    one_line(&outcome.error.expect("a refusal"))
}

fn value(branch: &Branch, point: &SpecialPoint, name: &str) -> f64 {
    branch.column(name).and_then(|column| point.value(column)).expect("a column")
}

const PERSISTENCE: Option<&str> = Some("boundary equilibrium: persistence");
const NONSMOOTH_FOLD: Option<&str> = Some("boundary equilibrium: nonsmooth fold");

/// Above `y = 0` the field is `A (x, y) + (0, mu)` with `A = (−1 1; −2 −1)`, below it is `(d, 1)`.
fn linear(d: f64, settings: &str) -> String {
    format!(
        r#"FilippovEquations(
            surface: "y",
            above: [("x", "-x + y"), ("y", "-2*x - y + mu")],
            below: [("x", "d"), ("y", "1")],
            parameters: [("mu", 1), ("d", {d})],
            initial: [("x", 0.4), ("y", 0.3)],
            solution: equilibrium,
            {settings}
        )"#
    )
}

/// Equilibria above are at `x = y = mu/3`. With `A⁻¹ (d, 1) = ((−1 − ·d)/3, …)`, whose second part is
/// `k = (2 d − 1)/3`, both fields are opposite on `y = 0`, `f⁺ = −σ f⁻`, at `σ = mu/(3 k)`.
#[test]
fn planar_boundary_equilibria_persist_or_vanish() {
    for (d, name) in [(0.2, PERSISTENCE), (1.0, NONSMOOTH_FOLD)] {
        let branches = traced(
            &linear(d, ""),
            r#"
            Run(name: "above", along: [(name: "mu", low: -1, high: 1)]),
            Run(name: "sliding", start: From(run: "above", kind: G, switch: true), along: [(name: "mu", low: -1, high: 1)]),
            "#,
        );
        let [above, sliding] = &branches[..] else { panic!("two branches") };
        let boundary = only(above, Kind::G);
        assert_eq!(boundary.subkind.as_deref(), name);
        close(value(above, boundary, "mu"), 0.0, 1e-12);
        assert_eq!([&above.itinerary, &sliding.itinerary], ["above", "sliding"]);
        let k = (2.0 * d - 1.0) / 3.0;
        // Both sides of the surface: on the one the regular equilibrium, on k's the other one.
        for point in &above.points {
            assert!(value_at(above, point, "mu") > -1e-9);
        }
        for point in &sliding.points {
            let mu = value_at(sliding, point, "mu");
            let sigma = mu / (3.0 * k);
            assert!(sigma > -1e-9, "{mu}");
            // f⁺ = (−x, mu − 2 x) = −σ (d, 1).
            close(value_at(sliding, point, "x"), sigma * d, 1e-10);
            close(value_at(sliding, point, "y"), 0.0, 1e-12);
            // Along the surface x' = (f₁ − d f₂)/(1 − f₂), det A = 3.
            assert_eq!(point.unstable, Some(usize::from(k > 0.0)), "at {mu}");
        }
        let far = sliding
            .special
            .iter()
            .find(|point| point.kind == Kind::EP && value(sliding, point, "mu").abs() > 0.5);
        let far = far.expect("the end of the range");
        let sigma = value(sliding, far, "mu") / (3.0 * k);
        // From the pseudo-equilibrium back to the regular one.
        let back = traced(
            &linear(d, "mode: \"sliding\","),
            &format!(
                r#"
                Run(name: "sliding", set: [("mu", "{}")], along: [(name: "mu", low: -1, high: 1)]),
                Run(name: "above", start: From(run: "sliding", kind: G, switch: true), along: [(name: "mu", low: -1, high: 1)]),
                "#,
                k.signum() * 0.5
            ),
        );
        assert_eq!([&back[0].itinerary, &back[1].itinerary], ["sliding", "above"]);
        assert_eq!(only(&back[0], Kind::G).subkind.as_deref(), name);
        assert!(back[1].points.iter().all(|point| value_at(&back[1], point, "mu") > -1e-9));
        let [(rate, frequency)] = far.eigenvalues[..] else {
            panic!("one eigenvalue along the surface")
        };
        close(rate, 3.0 * k / (1.0 + sigma), 1e-10);
        assert_eq!(frequency, 0.0);
    }
}

fn value_at(branch: &Branch, point: &Point, name: &str) -> f64 {
    branch.column(name).and_then(|column| point.value(column)).expect("a column")
}

/// Persistence becomes a nonsmooth fold where the pseudo-equilibrium is singular, `k = 0`.
#[test]
fn boundary_equilibria_are_followed_in_two_parameters() {
    for (mode, mu) in [("above", 0.5), ("sliding", -0.5)] {
        let branches = traced(
            &linear(0.2, &format!("mode: \"{mode}\",")),
            &format!(
                r#"
            Run(name: "rest", set: [("mu", "{mu}")], along: [(name: "mu", low: -1, high: 1)]),
            Run(name: "boundary", start: From(run: "rest", kind: G), hold: G,
                along: [(name: "d", low: 0, high: 1), (name: "mu", low: -1, high: 1)]),
            "#
            ),
        );
        let curve = branches.last().expect("a curve");
        for point in &curve.points {
            close(value_at(curve, point, "mu"), 0.0, 1e-12);
        }
        close(value(curve, only(curve, Kind::GD), "d"), 0.5, 1e-10);
        assert_eq!(curve.special.iter().filter(|point| point.kind == Kind::EP).count(), 2);
    }
}

/// Treatment above a threshold: between the endemic equilibria without treatment and with it the
/// infected stay at the threshold, where `S = A/(b Ic + d)`, and deviate as `exp(−(b Ic + d) t)`.
#[test]
fn a_treatment_threshold_holds_the_infected() {
    let sir = r#"FilippovEquations(
        surface: "I - Ic",
        above: [("S", "A - b*S*I - d*S"), ("I", "b*S*I - (d + g + c)*I")],
        below: [("S", "A - b*S*I - d*S"), ("I", "b*S*I - (d + g)*I")],
        parameters: [("Ic", 0.75), ("A", 1), ("b", 1), ("d", 0.2), ("g", 0.5), ("c", 0.8)],
        initial: [("S", 1.05), ("I", 0.75)],
        solution: equilibrium,
    )"#;
    let branches = traced(
        sir,
        r#"
        Run(name: "rest", along: [(name: "Ic", low: 0, high: 3)]),
        Run(name: "treated", start: From(run: "rest", kind: G, nth: 0, switch: true), along: [(name: "Ic", low: 0, high: 3)]),
        Run(name: "untreated", start: From(run: "rest", kind: G, nth: 1, switch: true), along: [(name: "Ic", low: 0, high: 3)]),
        "#,
    );
    let rest = &branches[0];
    assert_eq!(rest.itinerary, "sliding");
    let endemic = |s: f64| (1.0 / s - 0.2) / 1.0;
    let mut ends: Vec<f64> = rest.of_kind(Kind::G).map(|point| value(rest, point, "Ic")).collect();
    ends.sort_by(f64::total_cmp);
    assert_eq!(ends.len(), 2);
    close(ends[0], endemic(1.5), 1e-10);
    close(ends[1], endemic(0.7), 1e-10);
    for point in rest.of_kind(Kind::G) {
        let level = value(rest, point, "Ic");
        assert_eq!(point.subkind.as_deref(), PERSISTENCE);
        close(value(rest, point, "S"), 1.0 / (level + 0.2), 1e-10);
        let [(rate, _)] = point.eigenvalues[..] else { panic!("one eigenvalue") };
        close(rate, -(level + 0.2), 1e-10);
    }
    let mut others = [&branches[1].itinerary, &branches[2].itinerary];
    others.sort();
    assert_eq!(others, ["above", "below"]);
    for branch in &branches[1..] {
        let s = if branch.itinerary == "above" { 1.5 } else { 0.7 };
        for point in &branch.points {
            close(value_at(branch, point, "S"), s, 1e-10);
            close(value_at(branch, point, "I"), endemic(s), 1e-10);
            assert_eq!(point.unstable, Some(0));
        }
    }
}

/// Harvested predators: pseudo-equilibria are at `y = T = (1 − x/K)(1 + x)`, with a fold at
/// `x = (K − 1)/2`.
#[test]
fn pseudo_equilibria_fold() {
    let harvest = r#"FilippovEquations(
        surface: "y - T",
        above: [("x", "x*(1 - x/K) - x*y/(1 + x)"), ("y", "y*(x/(1 + x) - d) - q*y")],
        below: [("x", "x*(1 - x/K) - x*y/(1 + x)"), ("y", "y*(x/(1 + x) - d)")],
        parameters: [("T", 1.7), ("K", 5), ("d", 0.4), ("q", 0.5)],
        initial: [("x", 1.2), ("y", 1.7)],
        solution: equilibrium,
    )"#;
    let branches = traced(
        harvest,
        r#"
        Run(name: "rest", along: [(name: "T", low: 0.1, high: 3)]),
        Run(name: "folds", start: From(run: "rest", kind: LP), hold: LP,
            along: [(name: "K", low: 4, high: 6), (name: "T", low: 0.1, high: 3)]),
        "#,
    );
    let [rest, folds] = &branches[..] else { panic!("two branches") };
    let fold = only(rest, Kind::LP);
    close(value(rest, fold, "T"), 1.8, 1e-10);
    close(value(rest, fold, "x"), 2.0, 1e-7);
    for point in &folds.points {
        let capacity = value_at(folds, point, "K");
        let x = (capacity - 1.0) / 2.0;
        close(value_at(folds, point, "T"), (1.0 - x / capacity) * (1.0 + x), 1e-10);
    }
}

/// On the surface `z = x²`, towards which motion goes with the speed 1, the sliding field is the
/// normal form of a Hopf point in `x` and `y`, `z' = (mu + i) z − z |z|²`: its Lyapunov coefficient is
/// −2 with an eigenvector of length 1.
#[test]
fn pseudo_equilibria_have_hopf_points_on_curved_surfaces() {
    let field = |speed: &str| {
        format!(r#"[("x", "u"), ("y", "x + mu*y - y*(x^2 + y^2)"), ("z", "2*x*u {speed}")]"#)
    };
    let problem = format!(
        r#"FilippovEquations(
            surface: "z - x^2",
            definitions: [("u", "mu*x - y - x*(x^2 + y^2)")],
            above: {},
            below: {},
            parameters: [("mu", -0.5)],
            initial: [("x", 0), ("y", 0), ("z", 0)],
            solution: equilibrium,
        )"#,
        field("- 1"),
        field("+ 1")
    );
    let branches =
        traced(&problem, r#"Run(name: "rest", along: [(name: "mu", low: -0.5, high: 0.5)])"#);
    let hopf = only(&branches[0], Kind::HB);
    assert_eq!(branches[0].itinerary, "sliding");
    close(value(&branches[0], hopf, "mu"), 0.0, 1e-10);
    let number =
        |name: &str| hopf.number(name).unwrap_or_else(|| panic!("{:?}", hopf.numbers)).value;
    close(number("l1"), -2.0, 1e-9);
    assert_eq!(hopf.eigenvalues.len(), 2);
}

/// A drill string in SI units: the roots of the cubic of slip, the fold of its equilibria, and the
/// torque that starts to turn what sticks.
#[test]
fn a_drill_string_rests_turns_and_oscillates() {
    let drill = r#"HybridEquations(
        modes: [
            (name: "slip", states: [("phi", "W - w"), ("W", "(u - k*phi - c*(W - w) - br*W)/Jr"), ("w", "(k*phi + c*(W - w) - fr)/Jb")]),
            (name: "stick", states: [("phi", "W"), ("W", "(u - k*phi - c*W - br*W)/Jr")]),
        ],
        definitions: [("fr", "Tc + (Ts - Tc)*exp(-w/ws) + bb*w")],
        guards: [
            (name: "stop", modes: ["slip"], function: "w", next: "stick"),
            (name: "go", modes: ["stick"], function: "Ts - k*phi - c*W", next: "slip", reset: [("w", 0)]),
        ],
        parameters: [("u", 6500), ("k", 473), ("c", 0.5), ("br", 425), ("Jr", 2122), ("Jb", 375), ("Tc", 4000), ("Ts", 6000),
            ("ws", 1), ("bb", 50)],
        initial: [("phi", 12), ("W", 5), ("w", 5)],
        solution: equilibrium,
    )"#;
    let branches = traced(
        drill,
        r#"
        Run(name: "turning", along: [(name: "u", low: 2000, high: 9000)]),
        Run(name: "sticking", start: From(run: "turning", kind: G, switch: true), along: [(name: "u", low: 2000, high: 9000)]),
        Run(name: "oscillating", start: From(run: "turning", kind: HB), along: [(name: "u", low: 2000, high: 9000)]),
        "#,
    );
    let [turning, sticking, oscillating] = &branches[..] else { panic!("three branches") };
    let torque = |w: f64| 425.0 * w + 4000.0 + 2000.0 * (-w).exp() + 50.0 * w;
    // λ³ + a λ² + b λ + c has a pair on the imaginary axis where ab = c.
    let routh = |w: f64| {
        let (k, c, jr, jb) = (473.0, 0.5, 2122.0, 375.0);
        let (top, bit) = ((c + 425.0) / jr, (c + 50.0 - 2000.0 * (-w).exp()) / jb);
        let a = top + bit;
        let b = top * bit - c * c / (jr * jb) + k / jr + k / jb;
        // Both inertias are coupled by the spring alone, but for the damping between them.
        let constant = k / jr * (bit - c / jb) + k / jb * (top - c / jr);
        a * b - constant
    };
    let (mut low, mut high) = (2.0, 6.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if routh(low) * routh(middle) <= 0.0 { high = middle } else { low = middle }
    }
    let hopf = only(turning, Kind::HB);
    close(value(turning, hopf, "w"), low, 1e-9);
    close(value(turning, hopf, "u"), torque(low), 1e-7);
    let fold = (2000.0_f64 / 475.0).ln();
    close(value(turning, only(turning, Kind::LP), "u"), torque(fold), 1e-7);
    let boundary = only(turning, Kind::G);
    close(value(turning, boundary, "u"), 6000.0, 1e-7);
    assert_eq!(boundary.subkind.as_deref(), NONSMOOTH_FOLD);
    assert_eq!(sticking.itinerary, "stick");
    for point in &sticking.points {
        let u = value_at(sticking, point, "u");
        assert!(u < 6000.0 + 1e-6);
        close(value_at(sticking, point, "phi"), u / 473.0, 1e-10);
    }
    // Cycles of slip grow from the Hopf point until the bit stops.
    assert_eq!(oscillating.itinerary, "slip");
    let stop = only(oscillating, Kind::G);
    close(value(oscillating, stop, "min_w"), 0.0, 1e-8);
}

/// A stop that gives way: the field is continuous, and rest goes on pressing it.
#[test]
fn rest_goes_on_against_a_spring() {
    let stop = r#"HybridEquations(
        modes: [
            (name: "free", states: [("x", "v"), ("v", "mu - x - v")]),
            (name: "pressed", states: [("x", "v"), ("v", "mu - x - v - 4*(x - 1)")]),
        ],
        guards: [
            (name: "press", modes: ["free"], function: "1 - x", next: "pressed"),
            (name: "leave", modes: ["pressed"], function: "x - 1", next: "free"),
        ],
        parameters: [("mu", 0)],
        initial: [("x", 0), ("v", 0)],
        solution: equilibrium,
    )"#;
    let along = "along: [(name: \"mu\", low: -1, high: 6)]";
    let branches = traced(
        stop,
        &format!(
            r#"Run(name: "free", {along}), Run(name: "pressed", start: From(run: "free", kind: G, switch: true), {along})"#
        ),
    );
    let [free, pressed] = &branches[..] else { panic!("two branches") };
    assert_eq!(only(free, Kind::G).subkind.as_deref(), PERSISTENCE);
    close(value(free, only(free, Kind::G), "mu"), 1.0, 1e-10);
    assert_eq!(pressed.itinerary, "pressed");
    for point in &pressed.points {
        close(value_at(pressed, point, "x"), (value_at(pressed, point, "mu") + 4.0) / 5.0, 1e-10);
    }
}

/// Where both fields leave the surface motion rests on no side of it for long.
#[test]
fn an_equilibrium_that_goes_nowhere_says_so() {
    let problem = r#"FilippovEquations(
        surface: "y",
        above: [("x", "-x"), ("y", "mu - y")],
        below: [("x", "-x"), ("y", "-1")],
        parameters: [("mu", 0.5)],
        initial: [("y", 0.5)],
        solution: equilibrium,
    )"#;
    let text = format!(
        "Scene(title: \"rest\", problem: {problem}, runs: [
            Run(name: \"rest\", along: [(name: \"mu\", low: -1, high: 1)]),
            Run(name: \"on\", start: From(run: \"rest\", kind: G, switch: true), along: [(name: \"mu\", low: -1, high: 1)])])"
    );
    let outcome = execute(&Scene::parse(&text).unwrap(), None, &mut ());
    let rest = &outcome.document.branches[0];
    assert_eq!(only(rest, Kind::G).subkind.as_deref(), Some("boundary equilibrium"));
    let said = format!("{:?}", outcome.error);
    assert!(
        said.contains("no other mode has an equilibrium at the boundary point that the equilibrium of mode `above`"),
        "{said}"
    );
}

#[test]
fn rest_that_cannot_be_is_refused() {
    let forced = r#"FilippovEquations(surface: "x", above: [("x", "-1 + mu*cos(t)")], below: [("x", "1")],
        period: "2*pi", parameters: [("mu", 0)], solution: equilibrium)"#;
    assert!(refusal(forced).contains("forced systems have no equilibria"), "{}", refusal(forced));
    let unknown = linear(0.2, "mode: \"slide\",");
    let said = refusal(&unknown);
    assert!(said.contains("slide") && said.contains("sliding"), "{said}");
}

/// The mode may be given, where the start lies in another one.
#[test]
fn the_mode_of_rest_may_be_given() {
    let branches = traced(
        &linear(0.2, "mode: \"sliding\","),
        r#"Run(name: "rest", start: Guess([("x", -0.1), ("y", 0.1)]), set: [("mu", "-0.5")], along: [(name: "mu", low: -1, high: 1)])"#,
    );
    assert_eq!(branches[0].itinerary, "sliding");
}

/// The parameters of the scene `harvested-prey` beside the harvest and the threshold: `a`, `b`, `d`.
const PREY: [f64; 3] = [0.3556, 0.33, 0.0444];

/// Prey and predators that rest where predators die at the rate `m`.
fn resting(m: f64) -> [f64; 2] {
    let [a, b, _] = PREY;
    let x = b * m / (a - m);
    [x, (1.0 - x) * (b + x) / a]
}

/// A step of Runge and Kutta's without harvest.
fn step([x, y]: [f64; 2], h: f64) -> [f64; 2] {
    let [a, b, d] = PREY;
    let field = |[x, y]: [f64; 2]| {
        let eaten = a * x / (b + x) * y;
        [x * (1.0 - x) - eaten, eaten - d * y]
    };
    let at = |k: [f64; 2], part: f64| [x + part * h * k[0], y + part * h * k[1]];
    let first = field([x, y]);
    let second = field(at(first, 0.5));
    let third = field(at(second, 0.5));
    let fourth = field(at(third, 1.0));
    let mean = |i: usize| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0;
    [x + h * mean(0), y + h * mean(1)]
}

/// Where the motion without harvest first rises through a zero of a function, after it was negative.
fn rising(mut from: [f64; 2], function: impl Fn([f64; 2]) -> f64) -> [f64; 2] {
    const H: f64 = 1e-3;
    let mut below = false;
    loop {
        let next = step(from, H);
        if below && function(next) >= 0.0 {
            let (mut low, mut high) = (0.0, H);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if function(step(from, middle)) < 0.0 { low = middle } else { high = middle }
            }
            return step(from, high);
        }
        below |= function(next) < -1e-6;
        from = next;
    }
}

/// SlideCont's example: all points by formulas, and those of cycles by motion in fixed steps.
#[test]
fn predators_are_harvested_above_a_threshold() {
    let document = executed(&scene("harvested-prey"));
    let [a, b, d] = PREY;
    let branch = |name: &str| document.branch(name).unwrap();
    let at = |name: &str, kind: Kind, column: &str| {
        value(branch(name), only(branch(name), kind), column)
    };
    let [tangency, free] = resting(d);
    let highest = (1.0 + b) * (1.0 + b) / (4.0 * a);
    close(at("on the threshold", Kind::LP, "alpha"), highest, 1e-10);
    let boundaries: Vec<(f64, Option<&str>)> = branch("on the threshold")
        .of_kind(Kind::G)
        .map(|point| (value(branch("on the threshold"), point, "alpha"), point.subkind.as_deref()))
        .collect();
    let [(second, persistence), (first, fold)] = boundaries[..] else { panic!("{boundaries:?}") };
    close(first, free, 1e-10);
    close(second, resting(d + 0.2067)[1], 1e-10);
    assert_eq!([fold, persistence], [NONSMOOTH_FOLD, PERSISTENCE]);
    // Harvested predators rest beside the fold of the pseudo-equilibria at the Hopf point.
    let hopf = a * (1.0 - b) / (1.0 + b) - d;
    let hopfs = branch("Hopf");
    assert!(hopfs.points.iter().all(|point| (value_at(hopfs, point, "E") - hopf).abs() < 1e-10));
    for curve in ["Hopf", "pseudo-equilibria fold"] {
        close(at(curve, Kind::G, "E"), hopf, 1e-8);
        close(at(curve, Kind::G, "alpha"), highest, 1e-8);
    }
    let curve = branch("harvested at the boundary");
    for point in &curve.points {
        let harvest = value_at(curve, point, "E");
        close(value_at(curve, point, "alpha"), resting(d + harvest)[1], 1e-10);
    }
    close(value(curve, only(curve, Kind::GD), "E"), hopf, 1e-8);
    for (name, expected) in [("free at the boundary", free), ("pseudo-equilibria fold", highest)] {
        let curve = branch(name);
        assert!(curve.points.len() > 5);
        for point in &curve.points {
            close(value_at(curve, point, "alpha"), expected, 1e-10);
        }
    }
    // The largest number of predators of the free cycle, which forgets where it began.
    let mut top = [tangency, 2.44];
    for _ in 0..3 {
        top = rising(top, |[x, _]| tangency - x);
    }
    close(at("slides", Kind::G, "alpha"), top[1], 1e-8);
    // From the end of sliding to the pseudo-saddle.
    let beside = |alpha: f64| {
        let landing = rising([tangency, alpha], |[_, y]| y - alpha)[0];
        let saddle = 0.5 * (1.0 - b) - (0.25 * (1.0 + b) * (1.0 + b) - a * alpha).sqrt();
        landing - saddle
    };
    let (mut low, mut high) = (1.2, 1.24);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if beside(low) * beside(middle) <= 0.0 { high = middle } else { low = middle }
    }
    let end = branch("slides").ends.iter().any(|end| matches!(end, End::Homoclinic { .. }));
    assert!(end, "{:?}", branch("slides").ends);
    let last = branch("slides").special.iter().map(|point| value(branch("slides"), point, "alpha"));
    close(last.fold(f64::INFINITY, f64::min), low, 1e-8);
    // Sliding that begins where harvested motion is tangent to the threshold buckles.
    let buckling = branch("buckling");
    for point in &buckling.points {
        let (harvest, alpha) = (value_at(buckling, point, "E"), value_at(buckling, point, "alpha"));
        let landing = rising([tangency, alpha], |[_, y]| y - alpha)[0];
        close(landing, resting(d + harvest)[0], 1e-7);
    }
}

/// Rest at zero velocity is no rest of a mode that ends there: nothing is said of its stability.
#[test]
fn rest_that_stays_at_a_boundary_has_no_stability() {
    let block = r#"HybridEquations(
        modes: [
            (name: "up", states: [("x", "v"), ("v", "-x - mu - 0.2*v")]),
            (name: "down", states: [("x", "v"), ("v", "-x + mu - 0.2*v")]),
        ],
        guards: [
            (name: "stop", modes: ["up"], function: "v", next: "down"),
            (name: "turn", modes: ["down"], function: "-v", next: "up"),
        ],
        parameters: [("mu", 1)],
        initial: [("x", -1), ("v", 0)],
        solution: equilibrium,
        mode: "up",
    )"#;
    let branches = traced(block, r#"Run(name: "rest", along: [(name: "mu", low: 0.5, high: 2)])"#);
    assert!(branches[0].points.len() > 2);
    assert!(branches[0].points.iter().all(|point| point.unstable.is_none()));
}

/// A simulated start says where it rests.
#[test]
fn a_simulation_that_rests_names_the_equilibrium() {
    let sir = r#"FilippovEquations(
        surface: "I - Ic",
        above: [("S", "1 - S*I - 0.2*S"), ("I", "S*I - 1.5*I")],
        below: [("S", "1 - S*I - 0.2*S"), ("I", "S*I - 0.7*I")],
        parameters: [("Ic", 0.8)],
        initial: [("S", 2), ("I", 0.1)],
    )"#;
    let run = r#"Run(name: "r", start: Simulated(transient: 100), along: [(name: "Ic", low: 0.5, high: 1)])"#;
    let text = format!("Scene(title: \"rest\", problem: {sir}, runs: [{run}])");
    let said = one_line(&execute(&Scene::parse(&text).unwrap(), None, &mut ()).error.unwrap());
    assert!(said.contains("in mode `sliding`, at S = 1.000000, I = 0.800000"), "{said}");
    assert!(said.contains("`solution: equilibrium`"), "{said}");
    // With that setting it is where the branch begins.
    let sir = sir.trim_end_matches(')').to_string() + "solution: equilibrium)";
    let rest = &traced(&sir, run)[0];
    assert_eq!(rest.itinerary, "sliding");
    assert!(rest.points.iter().all(|point| {
        let level = value_at(rest, point, "Ic");
        (value_at(rest, point, "S") - 1.0 / (level + 0.2)).abs() < 1e-10
    }));
    // Predators that oscillate do not rest.
    let mut prey = scene("harvested-prey");
    prey.runs.truncate(1);
    prey.runs[0].set.push(("solution".into(), "equilibrium".into()));
    let said = one_line(&execute(&prey, None, &mut ()).error.unwrap());
    assert!(said.contains("converges to a cycle"), "{said}");
}
