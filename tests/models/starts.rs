//! Promise: branches begin where a model or a scene says.

use super::traced;
use crate::common::close;
use tangency::core::continuation::End;
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::scene::{Catalogue, Files, Problem, Range, Request, Scene, SceneError, execute};

/// The largest solution of `θ = √2 cosh(θ/4)`, by bisection: of both solutions of `u'' + eᵘ = 0`,
/// `u(0) = u(1) = 0`, the larger one has the maximum `2 ln cosh(θ/4)`.
fn upper_theta() -> f64 {
    let (mut low, mut high) = (6.0_f64, 20.0_f64);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let is_beyond = 2.0_f64.sqrt() * (middle / 4.0).cosh() > middle;
        (low, high) = if is_beyond { (low, middle) } else { (middle, high) };
    }
    low
}

/// From constants Newton's iteration finds the smaller solution.
#[test]
fn boundary_values_begin_at_profiles() {
    let largest = |initial: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Boundary(states: [(\"u\", \"v\"), (\"v\", \"-lambda*exp(u)\")],
                conditions: [\"u(0)\", \"u(1)\"], {initial}), parameters: [(\"lambda\", 1)],
                runs: [(name: \"r\", along: [(name: \"lambda\", low: 1, high: 2)])])"
        );
        let branch = &traced(&text)[0];
        let start = branch.special.iter().find(|special| special.parameters[0] == 1.0);
        start.and_then(|start| start.value(branch.column("max_u")?)).expect("a start")
    };
    let profile = "initial: [(\"u\", \"16*t*(1 - t)\"), (\"v\", \"16*(1 - 2*t)\")]";
    close(largest(profile), 2.0 * (upper_theta() / 4.0).cosh().ln(), 1e-6);
    close(largest("initial: []"), 0.140_539_214, 1e-6);
}

/// Of both roots of each equation the one begun at is followed.
#[test]
fn an_array_begins_at_one_value() {
    for (unknowns, middle) in [("u[i=1..3]", "u[2]"), ("u[i=1..3, j=0..1]", "u[2,0]")] {
        let element = unknowns.replace("=1..3", "").replace("=0..1", "");
        for (initial, expected) in [("-3", -2.0), ("lambda", 2.0)] {
            let text = format!(
                "Scene(title: \"t\", problem: Residual(unknowns: [(\"{unknowns}\", \"{element}^2 - lambda\")],
                    initial: [(\"u\", \"{initial}\")], monitors: [(\"middle\", \"{middle}\")]),
                    parameters: [(\"lambda\", 4)], runs: [(name: \"r\", along: [(name: \"lambda\", low: 1, high: 4)])])"
            );
            let branch = &traced(&text)[0];
            let start = branch.special.iter().find(|special| special.parameters[0] == 4.0);
            let value = start.and_then(|start| start.value(branch.column("middle")?));
            close(value.expect("a start"), expected, 1e-12);
        }
    }
}

/// A scene of Bratu's problem in a folder of its own, which begins at the table in `profile.csv`.
fn with_table(name: &str, problem: &str, table: &str) -> Result<Scene, SceneError> {
    let folder = std::env::temp_dir().join(format!("tangency-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("profile.csv"), table).unwrap();
    let text = format!(
        "Scene(title: \"t\", problem: {problem}, parameters: [(\"lambda\", 1)],
            runs: [(name: \"r\", start: Profile(file: \"profile.csv\"), along: [(name: \"lambda\", low: 1, high: 2)])])"
    );
    let scene = Catalogue::built_in().parse_in(Files::of(&folder), &text);
    std::fs::remove_dir_all(&folder).unwrap();
    scene
}

const BRATU: &str = "Boundary(states: [(\"u\", \"v\"), (\"v\", \"-lambda*exp(u)\")], conditions: [\"u(0)\", \"u(1)\"])";

/// Five rows, in seconds of another clock, lead to the larger solution. The scene then holds the
/// table, so that its archive needs no file.
#[test]
fn boundary_values_begin_at_tables() {
    let table = "# measured\nt, u, v\n3, 0, 16\n3.5, 3, 8\n4, 4, 0\n4.5, 3, -8\n5, 0, -16\n";
    let scene = with_table("table", BRATU, table).unwrap();
    let alone = Scene::parse(&scene.to_ron()).unwrap();
    assert_eq!(alone.runs, scene.runs);
    for scene in [scene, alone] {
        let outcome = execute(&scene, None, &mut ());
        assert!(outcome.error.is_none(), "{:?}", outcome.error);
        let branch = &outcome.document.branches[0];
        let start = branch.special.iter().find(|special| special.parameters[0] == 1.0).unwrap();
        let largest = start.value(branch.column("max_u").unwrap()).unwrap();
        close(largest, 2.0 * (upper_theta() / 4.0).cosh().ln(), 1e-6);
    }
}

#[test]
fn tables_that_are_no_profiles_are_refused() {
    let of = |table: &str| {
        let scene = with_table("refused", BRATU, table);
        let error = scene.map(|scene| execute(&scene, None, &mut ()).error.unwrap());
        one_line(&error.unwrap_or_else(|error| error))
    };
    let cases = [
        ("", "the file is empty"),
        ("0 0 1\n1 0 1", "the first line of the file must contain the names of the columns"),
        ("t u\n0 0\n1 one", "`one` in line 3 is not a number"),
        ("t u\n0 0\n1", "line 3 has 1 numbers, but the table has 2 columns"),
        ("t u\n0 0", "the profile has 2 columns and 1 rows"),
        ("t u\n0 0\n1 inf", "must contain a finite number for each column"),
        ("t u\n0 0\n0 1", "but times must increase"),
        ("t w\n0 0\n1 1", "unknown state `w`"),
    ];
    for (table, expected) in cases {
        assert!(of(table).contains(expected), "{table}: {}", of(table));
    }
    let map = "Map(states: [(\"u\", \"lambda*u/2\")])";
    let scene = with_table("map", map, "t u\n0 0\n1 1").unwrap();
    let error = one_line(&execute(&scene, None, &mut ()).error.unwrap());
    assert!(error.contains("only boundary-value problems have profiles"), "{error}");
    let archive = "Scene(title: \"t\", problem: Map(states: [(\"u\", \"a*u\")]), parameters: [(\"a\", 1)],
        runs: [(name: \"r\", start: Profile(file: \"/etc/passwd\"), along: [(name: \"a\", low: 1, high: 2)])])";
    let error = one_line(&Catalogue::built_in().parse_alone(archive).unwrap_err());
    assert!(error.contains("must not refer to other files"), "{error}");
}

/// Orbits, unless the run says that equilibria are followed.
#[test]
fn a_run_from_a_hopf_point_traces_orbits() {
    let text = |set: &str| {
        format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"1 - (b + 1)*x + x^2*y\"), (\"y\", \"b*x - x^2*y\")],
                initial: [(\"x\", 1), (\"y\", 1)], solution: equilibrium), parameters: [(\"b\", 1)],
                runs: [(name: \"rest\", along: [(name: \"b\", low: 1, high: 3)]),
                    (name: \"from\", {set} start: From(run: \"rest\", kind: HB), along: [(name: \"b\", low: 1, high: 3)])])"
        )
    };
    let has_period = |set: &str| traced(&text(set))[1].column("period").is_some();
    assert!(has_period(""));
    assert!(!has_period("set: [(\"solution\", \"equilibrium\")],"));
}

/// The complete elliptic integral `K(k)`, by the arithmetic–geometric mean.
fn elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..20 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::FRAC_PI_2 / a
}

/// Of a pendulum that turns over in a time of `2 k K(k)`, the largest velocity is `2/k`.
#[test]
fn rotations_are_boundary_values() {
    let k = 0.8;
    let time = 2.0 * k * elliptic(k);
    let text = format!(
        "Scene(title: \"t\", problem: Boundary(states: [(\"q\", \"v\"), (\"v\", \"-sin(q)\")],
            conditions: [\"q(0)\", \"q(1) - 2*pi\"], length: \"T\", initial: [(\"q\", \"2*pi*t/T\"), (\"v\", \"2*pi/T\")]),
            parameters: [(\"T\", {time})], runs: [(name: \"r\", along: [(name: \"T\", low: 2, high: 6)])])"
    );
    let branch = &traced(&text)[0];
    let start = branch.points.iter().find(|point| point.parameters[0] == time).unwrap();
    close(start.value(branch.column("max_v").unwrap()).unwrap(), 2.0 / k, 1e-9);
    assert_eq!(branch.special.len(), 2);
}

/// The scene that a model in a file amounts to.
fn of_model(name: &str, model: &str, asked: Request) -> Result<Scene, SceneError> {
    let path = std::env::temp_dir().join(format!("tangency-{}-{name}.ron", std::process::id()));
    std::fs::write(&path, model).unwrap();
    let problem = Problem::from_file(&path, &[]);
    std::fs::remove_file(&path).unwrap();
    Scene::of_model(problem?, "t", &asked)
}

fn along(name: &str, low: f64, high: f64) -> Vec<Range> {
    vec![Range { name: name.into(), low: Some(low), high: Some(high) }]
}

/// A model with a parameter outside of the range begins at the nearer end; told to begin outside, it
/// says that and no more.
#[test]
fn starts_outside_of_a_range() {
    let model =
        "Equations(states: [(\"x\", \"p - x\")], parameters: [(\"p\", 0)], initial: [(\"x\", 0)])";
    for ([low, high], begin) in [([1.0, 4.0], 1.0), ([-3.0, -2.0], -2.0), ([-1.0, 1.0], 0.0)] {
        let asked = Request { along: along("p", low, high), ..Request::default() };
        let scene = of_model("range", model, asked).unwrap();
        assert_eq!(scene.value("p"), Some(begin));
        let branch = execute(&scene, None, &mut ()).document.branches.remove(0);
        let ends: Vec<f64> = branch.special.iter().map(|point| point.parameters[0]).collect();
        assert!(ends.contains(&low) && ends.contains(&high), "{ends:?}");
    }
    let scene = |low: f64| {
        format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"p - x\")], solution: equilibrium),
                parameters: [(\"p\", 0)], runs: [(name: \"r\", along: [(name: \"p\", low: {low}, high: 4)])])"
        )
    };
    let error = execute(&Scene::parse(&scene(1.0)).unwrap(), None, &mut ()).error.unwrap();
    assert_eq!(
        one_line(&error),
        "run `r`: the start p = 0 is not in the range of p, 1 to 4; start the branch within the \
         range, or widen the range"
    );
}

/// Where an explicit method refuses a stiff field motion settles by the implicit one: here on a
/// circle with the period 2π, to which `z` is drawn a million times faster.
#[test]
fn stiff_fields_settle_by_the_implicit_method() {
    let model = "Equations(states: [(\"x\", \"a*x - y - x*(x^2 + y^2)\"), (\"y\", \"x + a*y - y*(x^2 + y^2)\"), (\"z\", \"1e6*(x - z)\")],
        parameters: [(\"a\", 1)], initial: [(\"x\", 0.5), (\"z\", 1)])";
    let asked = Request { along: along("a", 0.5, 1.5), settle: Some(20.0), ..Request::default() };
    let scene = of_model("stiff", model, asked).unwrap();
    let branch = execute(&scene, None, &mut ()).document.branches.remove(0);
    let start = branch.points.iter().find(|point| point.parameters[0] == 1.0).unwrap();
    close(start.monitors[0], std::f64::consts::TAU, 1e-9);
    assert_eq!(branch.points.iter().map(|point| point.parameters[0]).fold(0.0, f64::max), 1.5);
}

/// Chay's model of bursting: the start has 25 intervals, the branch begins with 26, and has others at
/// its ends.
#[test]
fn both_halves_begin_on_the_mesh_of_the_start() {
    let text = r#"Scene(title: "Chay", problem: Equations(
        states: [("V", "gI*m^3*h*(100 - V) + gKV*n^4*(-75 - V) + gKC*C/(1 + C)*(-75 - V) + 7*(-40 - V)"),
            ("n", "230*(an + bn)*(an/(an + bn) - n)"), ("C", "rho*(m^3*h*(100 - V) - kc*C)")],
        definitions: [("am", "0.1*(25 + V)/(1 - exp(-0.1*V - 2.5))"), ("bm", "4*exp(-(V + 50)/18)"),
            ("ah", "0.07*exp(-0.05*V - 2.5)"), ("bh", "1/(1 + exp(-0.1*V - 2))"),
            ("an", "0.01*(20 + V)/(1 - exp(-0.1*V - 2))"), ("bn", "0.125*exp(-(V + 30)/80)"),
            ("m", "am/(am + bm)"), ("h", "ah/(ah + bh)")],
        initial: [("V", -50), ("n", 0.1), ("C", 0.5)]),
        parameters: [("gKC", 10), ("gKV", 1700), ("gI", 1800), ("rho", 0.27), ("kc", 0.18181818)],
        runs: [(name: "spikes", start: Simulated(), along: [(name: "gKC", low: 8, high: 40)])])"#;
    let branch = &traced(text)[0];
    assert!(matches!(&branch.ends[0], End::ParameterBound { .. }), "{:?}", branch.ends);
    let long = matches!(&branch.ends[1], End::LongPeriod { .. } | End::Homoclinic { .. });
    assert!(long, "{:?}", branch.ends);
    let doubling = branch.of_kind(Kind::PD).next().expect("a period doubling");
    // The same on 40 and on 80 intervals.
    close(doubling.parameters[0], 10.484_995, 1e-6);
}

/// Of both solutions `a = ±2`, the one nearest to the initial value is found; at a = 0, Newton's method is
/// singular.
#[test]
fn further_unknowns_of_boundary_values_have_initial_values() {
    for (initial, expected) in [("3", 2.0), ("-6/2", -2.0)] {
        let text = format!(
            r#"Scene(title: "slope", problem: Boundary(states: [("u", "a")], unknowns: ["a"],
            conditions: ["u(0)", "a^2 - 4*m"], parameters: [("m", 1)], initial: [("a", {initial:?})]),
            runs: [(name: "r", along: [(name: "m", low: 1, high: 2)])])"#
        );
        let branch = &traced(&text)[0];
        // u = a t.
        let [largest, least] = ["max_u", "min_u"].map(|name| branch.column(name).unwrap());
        let [largest, least] = [largest, least].map(|k| branch.points[0].value(k).unwrap());
        close(largest + least, expected, 1e-9);
    }
}
