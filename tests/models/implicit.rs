//! Promise: the equations of a flow as text have left-hand sides: algebraic equations, and combinations
//! of rates.

use super::traced;
use crate::common::{close, first};
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::problem::{Dynamics, ZeroProblem};
use tangency::core::system::Kind;
use tangency::language::{Model, ModelError, Source};
use tangency::scene::{Scene, execute};

fn read(text: &str) -> Result<Model, ModelError> {
    Model::read(&Source::new("model.ron", text), &[])
}

fn zero(text: &str) -> impl ZeroProblem + use<> {
    match read(text) {
        Ok(Model::Zero(zero)) => (*zero).clone(),
        Ok(_) => panic!("{text}"),
        Err(error) => panic!("{error}"),
    }
}

/// The products of the mass matrix with the rates 1, 2, … at the unknowns 10, 20, …, and the residual.
fn sides(text: &str, p: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let problem = zero(text);
    let n = problem.names().dimension();
    let z: Vec<f64> = (1..=n).map(|k| 10.0 * k as f64).collect();
    let rates: Vec<f64> = (1..=n).map(|k| k as f64).collect();
    let [mut products, mut residual] = [vec![0.0; n], vec![0.0; n]];
    problem.mass_product(&z, p, &rates, &mut products);
    problem.residual(&z, p, &mut residual);
    (products, residual)
}

#[test]
fn left_hand_sides() {
    let text = "Residual(dynamics: flow, parameters: [(\"m\", 3)], unknowns: [
        (\"x\", \"2*x' - (m*y' + x*w')/5 = y\"), (\"y\", \"x + y\"), (\"w\", \"0 = x*w - 1\"),
        (\"v\", \"x + m = if(x <= 9, 1, v)\")])";
    let (products, residual) = sides(text, &[3.0]);
    assert_eq!(products, [2.0 - (3.0 * 2.0 + 10.0 * 3.0) / 5.0, 2.0, 0.0, 0.0]);
    assert_eq!(residual, [20.0, 30.0, 299.0, 40.0 - 13.0]);
    assert_eq!(zero(text).dynamics(), Dynamics::Implicit);
}

#[test]
fn arrays_have_left_hand_sides() {
    let text = "Residual(dynamics: flow, definitions: [(\"n\", 3), (\"u[0]\", 0), (\"u[4]\", 0)], unknowns: [
        (\"u[i=1..n]\", \"i*u[i]' + w[i]' = u[i-1] - 2*u[i] + u[i+1]\"),
        (\"w[i=1..n]\", \"0 = w[i] - u[i]^2\")])";
    let (products, residual) = sides(text, &[]);
    assert_eq!(products, [1.0 + 4.0, 4.0 + 5.0, 9.0 + 6.0, 0.0, 0.0, 0.0]);
    assert_eq!(residual, [0.0, 0.0, -40.0, 40.0 - 100.0, 50.0 - 400.0, 60.0 - 900.0]);
}

#[test]
fn a_rate_alone_is_a_plain_flow() {
    let text = "Residual(dynamics: flow, unknowns: [(\"x\", \"x' = y\"), (\"y\", \"-x\")])";
    assert_eq!(zero(text).dynamics(), Dynamics::Flow);
    assert_eq!(sides(text, &[]), (vec![1.0, 2.0], vec![20.0, -10.0]));
}

/// An error with its help, and the part of the text that the error quotes.
fn refused(equation: &str, dynamics: &str) -> (String, String) {
    let text = format!(
        "Residual(dynamics: {dynamics}, unknowns: [(\"x\", \"{equation}\"), (\"y\", \"x - y\")])"
    );
    let error = read(&text).expect_err("an error");
    let begin = error.place.column - 1;
    (one_line(&error), text[begin..begin + error.place.width].to_string())
}

#[test]
fn other_left_hand_sides_are_refused() {
    for equation in
        ["x'^2 = y", "x' - y = 1", "x'*y' = 1", "1/x' = y", "sin(x') = 0", "y + 2 - y' = 0"]
    {
        let (message, quoted) = refused(equation, "flow");
        assert!(message.contains("must all be linear in the rates"), "{message}");
        assert!(message.contains("write each equation as `0 = g(x, y)`"), "{message}");
        assert_eq!(quoted, equation.split(" =").next().unwrap());
    }
    let (message, quoted) = refused("x = y'", "flow");
    assert!(
        message.contains("the rate `y'`: rates occur only on the left-hand sides"),
        "{message}"
    );
    assert_eq!(quoted, "y'");
    let (message, _) = refused("z' = y", "flow");
    assert!(message.contains("unknown name `z'`"), "{message}");
    for dynamics in ["none", "potential", "second_order"] {
        let (message, quoted) = refused("x' = y", dynamics);
        assert!(message.contains("only the equations of a flow have left-hand sides"), "{message}");
        assert!(message.contains("set `dynamics: flow`"), "{message}");
        assert_eq!(quoted, "x'");
    }
}

fn hopf(branch: &Branch) -> &SpecialPoint {
    first(branch, Kind::HB)
}

/// The Brusselator with its reaction as an algebraic unknown, its equations added to each other, and
/// the rates multiplied by factors that depend on states and parameters.
#[test]
fn the_brusselator_with_an_algebraic_equation() {
    let a = 2.0_f64;
    let scene = |unknowns: &str| {
        format!(
            "Scene(title: \"t\", problem: Residual(dynamics: flow, unknowns: [{unknowns}],
                initial: [(\"x\", 2), (\"y\", 0.5), (\"w\", 2)], parameters: [(\"a\", 2), (\"b\", 1), (\"m\", 3)]),
                runs: [Run(name: \"rest\", along: [(name: \"b\", low: 1, high: 9)])])"
        )
    };
    let texts = [
        "(\"x\", \"x' = a + w - (b + 1)*x\"), (\"y\", \"y' = b*x - w\"), (\"w\", \"0 = x^2*y - w\")",
        "(\"x\", \"m*x' + m*y' = m*(a - x)\"), (\"y\", \"(1 + x^2)*y' = (1 + x^2)*(b*x - w)\"), (\"w\", \"x^2*y = w\")",
    ];
    for text in texts {
        let branches = traced(&scene(text));
        let point = hopf(&branches[0]);
        close(point.parameters[1], 1.0 + a * a, 1e-11);
        close(point.number("hopf_frequency").unwrap().value, a, 1e-10);
        let real = -(a * a + 2.0) / (2.0 * (2.0 * a * a + 1.0));
        close(point.number("c1_re").unwrap().value, real, 1e-10);
        close(point.number("l1").unwrap().value, real / a, 1e-10);
        close(point.number("growth_slope").unwrap().value, 0.5, 1e-10);
        assert_eq!(point.subkind.as_deref(), Some("supercritical"));
        assert_eq!(point.eigenvalues.len(), 2, "{:?}", point.eigenvalues);
    }
}

/// Computations that need the rates of states are refused.
#[test]
fn motions_are_refused() {
    let problem =
        "Residual(dynamics: flow, unknowns: [(\"x\", \"x' = y\"), (\"y\", \"0 = b - x - y\")],
        parameters: [(\"b\", 1)])";
    let runs = [
        "Run(name: \"r\", start: Simulated(transient: 1, duration: 1), along: [(name: \"b\", low: 0, high: 1)])",
    ];
    for run in runs {
        let text = format!("Scene(title: \"t\", problem: {problem}, runs: [{run}])");
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        let error = execute(&scene, None, &mut ()).error.expect("an error");
        let message = one_line(&error);
        assert!(message.contains("this problem is a flow with a mass matrix"), "{message}");
    }
}
