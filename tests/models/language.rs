//! The language of formulas: what they mean, in values and derivatives.

use crate::common::close;
use num_dual::{Dual64, DualNum, HyperDual64, HyperHyperDual64};
use std::fmt::Write;
use tangency::core::continuation::Continuation;
use tangency::core::hybrid::HybridSystem;
use tangency::core::problem::{Forcing, VectorField, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind};
use tangency::language::{Field, Model, Source, Statement, number};
use tangency::scene::{BUILT_IN, Scene, execute, explore};

/// A field of one state `x` and the parameters `a`, `b` with a formula as its rate.
fn field(formula: &str) -> std::sync::Arc<Field> {
    let text = format!(
        "Equations(states: [(\"x\", {formula:?})], parameters: [(\"a\", 2), (\"b\", -3)], period: \"1\",
            functions: [(\"f\", [\"u\", \"v\"], \"u - 2*v\")], definitions: [(\"d\", \"a + b\")])"
    );
    match Model::read(&Source::new("", text), &[]) {
        Ok(Model::Field(field)) => field,
        Ok(_) => panic!("a field"),
        Err(error) => panic!("{error}"),
    }
}

/// The value of a formula and its derivative in `x`, at `t = 0.4`.
fn slope(formula: &str, x: f64) -> (f64, f64) {
    let parameters = [2.0, -3.0].map(Dual64::from);
    let mut f = [Dual64::from(0.0)];
    field(formula).field(Dual64::from(0.4), &[Dual64::from(x).derivative()], &parameters, &mut f);
    (f[0].re, f[0].eps)
}

fn is(formula: &str, x: f64, (value, derivative): (f64, f64)) {
    let (found, rate) = slope(formula, x);
    assert!(
        (found - value).abs() <= 1e-14 * value.abs().max(1.0),
        "{formula}: {found}, not {value}"
    );
    let tolerance = 1e-13 * derivative.abs().max(1.0);
    assert!((rate - derivative).abs() <= tolerance, "d/dx {formula}: {rate}, not {derivative}");
}

/// Where `sinh` and `cosh` are infinite their quotient is not.
#[test]
fn friction_laws_are_smooth_far_from_rest() {
    for v in [-1e3, -2.0, 0.5, 1.5, 4e5] {
        is("tanh(x/0.001)", v, (v.signum(), 0.0));
    }
    for x in [-1.5_f64, -1.0, 0.9, 1.0, 3.0] {
        is("tanh(x)", x, (x.tanh(), x.cosh().powi(-2)));
    }
}

#[test]
fn operators_bind_as_on_paper() {
    let x = 1.5_f64;
    is("-x^2", x, (-x * x, -2.0 * x));
    is("2^-x", x, (2.0_f64.powf(-x), -(2.0_f64.ln()) * 2.0_f64.powf(-x)));
    is("x^2^3", x, (x.powi(8), 8.0 * x.powi(7)));
    is("2**3*x", x, (12.0, 8.0));
    is("x - 1 - 2", x, (x - 3.0, 1.0));
    is("x/2/4*8", x, (x, 1.0));
    is("1 - x*a/b", x, (1.0 + x * 2.0 / 3.0, 2.0 / 3.0));
    is("-(-x)", x, (x, 1.0));
    is("+x - -x", x, (2.0 * x, 2.0));
    is("x*-2", x, (-3.0, -2.0));
    is("1e3*x + .5 - 2.", x, (1498.5, 1000.0));
    is("1.5d-1*x", x, (0.225, 0.15));
    is("x < 2", x, (1.0, 0.0));
    is("x + 1 > 2 & x < 3 | 0", x, (1.0, 0.0));
    is("!(x == 1.5)", x, (0.0, 0.0));
    is("x != 1.5", x, (0.0, 0.0));
    is("if(x > 1, x^2, 1/(x - 1.5))", x, (2.25, 3.0));
    is("if(x > 1)then(x^2)else(0)", x, (2.25, 3.0));
    is("sum(i, 1, 4, i*x)", x, (15.0, 10.0));
    is("sum(1, 4)of(i'*x)", x, (15.0, 10.0));
    is("sum(i, 1, 3, sum(j, 1, i, x^j/i))", x, (4.875 / 3.0 * 0.0 + sums(x).0, sums(x).1));
    is("f(x, a)", x, (x - 4.0, 1.0));
    is("d*x + t", x, (-1.5 + 0.4, -1.0));
    is("(-2)^2*x", x, (6.0, 4.0));
    is("pi*x - e", x, (1.5 * std::f64::consts::PI - std::f64::consts::E, std::f64::consts::PI));
}

fn sums(x: f64) -> (f64, f64) {
    let terms =
        |i: i32| (1..=i).map(move |j| (x.powi(j) / i as f64, j as f64 * x.powi(j - 1) / i as f64));
    (1..=3).flat_map(terms).fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d))
}

/// A formula of numbers of any depth, at `t = 0.4`.
fn nested<T: Scalar>(formula: &str, x: T) -> T {
    let mut f = [T::zero()];
    field(formula).field(T::from(0.4), &[x], &[2.0, -3.0].map(T::from), &mut f);
    f[0]
}

/// Functions of nested numbers are compositions of their Taylor series: those of `num_dual` go by
/// the chain rule.
#[test]
fn functions_of_nested_numbers_have_all_mixed_derivatives() {
    type Number = HyperHyperDual64;
    type Function = fn(Number) -> Number;
    let functions: [(&str, Function); 27] = [
        ("sin(x)", |x| x.sin()),
        ("cos(x)", |x| x.cos()),
        ("sin(x)*cos(x)", |x| x.sin() * x.cos()),
        ("tan(x)", |x| x.tan()),
        ("asin(x)", |x| x.asin()),
        ("acos(x)", |x| x.acos()),
        ("atan(x)", |x| x.atan()),
        ("sinh(x)", |x| x.sinh()),
        ("cosh(x)", |x| x.cosh()),
        ("tanh(x)", |x| x.tanh()),
        ("tanh(5*x)", |x| (x * 5.0).tanh()),
        ("asinh(x)", |x| x.asinh()),
        ("acosh(1 + x)", |x| (x + 1.0).acosh()),
        ("atanh(x)", |x| x.atanh()),
        ("exp(x)", |x| x.exp()),
        ("exp2(x)", |x| x.exp2()),
        ("exp_m1(x)", |x| x.exp_m1()),
        ("ln(x)", |x| x.ln()),
        ("log2(x)", |x| x.log2()),
        ("log10(x)", |x| x.log10()),
        ("ln_1p(x)", |x| x.ln_1p()),
        ("sqrt(x) + cbrt(x)", |x| x.sqrt() + x.cbrt()),
        ("1/x + 2/(1 + x)", |x| x.recip() + (x + 1.0).recip() * 2.0),
        ("x^5 + x^(-3) + x^1.7", |x| x.powi(5) + x.powi(-3) + x.powf(1.7)),
        ("(1 + x)^x", |x| ((x + 1.0).ln() * x).exp()),
        ("atan2(x, x - 2) + atan2(x - 2, x)", |x| x.atan2(x - 2.0) + (x - 2.0).atan2(x)),
        ("hypot(x, 2*x - 1)", |x| (x.powi(2) + (x * 2.0 - 1.0).powi(2)).sqrt()),
    ];
    let x = Number::new(0.4, 1.0, 0.5, -0.7, 0.2, 0.1, -0.3, 0.6);
    let parts = |f: Number| {
        [f.re, f.eps1, f.eps2, f.eps3, f.eps1eps2, f.eps1eps3, f.eps2eps3, f.eps1eps2eps3]
    };
    for (formula, function) in functions {
        let (found, expected) = (parts(nested(formula, x)), parts(function(x)));
        for (found, expected) in found.into_iter().zip(expected) {
            let error = (found - expected).abs();
            assert!(error <= 1e-13 * expected.abs().max(1.0), "{formula}: {found}, {expected}");
        }
    }
}

/// `x^2.5` has two derivatives where it vanishes, and integer powers have all.
#[test]
fn powers_have_the_derivatives_that_exist_at_zero() {
    let x = HyperDual64::new(0.0, 1.0, 1.0, 0.0);
    for (formula, second) in [("x^2.5", 0.0), ("x^2", 2.0), ("x^3 + x^7", 0.0)] {
        let f = nested(formula, x);
        assert_eq!([f.re, f.eps1, f.eps2, f.eps1eps2], [0.0, 0.0, 0.0, second], "{formula}");
    }
}

#[test]
fn functions_are_those_of_f64() {
    let x = 0.3_f64;
    let one = [
        ("sin", x.sin(), x.cos()),
        ("cos", x.cos(), -x.sin()),
        ("tan", x.tan(), 1.0 + x.tan().powi(2)),
        ("asin", x.asin(), 1.0 / (1.0 - x * x).sqrt()),
        ("acos", x.acos(), -1.0 / (1.0 - x * x).sqrt()),
        ("atan", x.atan(), 1.0 / (1.0 + x * x)),
        ("sinh", x.sinh(), x.cosh()),
        ("cosh", x.cosh(), x.sinh()),
        ("tanh", x.tanh(), 1.0 - x.tanh().powi(2)),
        ("asinh", x.asinh(), 1.0 / (1.0 + x * x).sqrt()),
        ("atanh", x.atanh(), 1.0 / (1.0 - x * x)),
        ("exp", x.exp(), x.exp()),
        ("exp2", x.exp2(), x.exp2() * 2.0_f64.ln()),
        ("exp_m1", x.exp_m1(), x.exp()),
        ("ln", x.ln(), 1.0 / x),
        ("log", x.ln(), 1.0 / x),
        ("log2", x.log2(), 1.0 / x / 2.0_f64.ln()),
        ("log10", x.log10(), 1.0 / x / 10.0_f64.ln()),
        ("ln_1p", x.ln_1p(), 1.0 / (1.0 + x)),
        ("sqrt", x.sqrt(), 0.5 / x.sqrt()),
        ("cbrt", x.cbrt(), x.cbrt() / (3.0 * x)),
        ("recip", 1.0 / x, -1.0 / (x * x)),
        ("abs", x, 1.0),
        ("sign", 1.0, 0.0),
        ("heaviside", 1.0, 0.0),
        ("floor", 0.0, 0.0),
        ("ceil", 1.0, 0.0),
        ("round", 0.0, 0.0),
    ];
    for (name, value, derivative) in one {
        is(&format!("{name}(x)"), x, (value, derivative));
    }
    is("acosh(x)", 1.3, (1.3_f64.acosh(), 1.0 / (0.69_f64).sqrt()));
    is("abs(x) + sign(x) + heav(x) + floor(x)", -0.3, (0.3 - 1.0 - 1.0, -1.0));
    is("min(x, 2*x, 1) + max(x, 2*x)", x, (0.9, 3.0));
    is("mod(x, 0.2)", x, (0.1, 1.0));
    is("mod(-x, 1)", x, (0.7, -1.0));
    is("atan2(x, 2)", x, (x.atan2(2.0), 2.0 / (4.0 + x * x)));
    is("hypot(x, 2)", x, (x.hypot(2.0), x / x.hypot(2.0)));
    is(
        "pow(x, 3) + pow(3, x)",
        x,
        (x.powi(3) + 3.0_f64.powf(x), 3.0 * x * x + 3.0_f64.ln() * 3.0_f64.powf(x)),
    );
    is("(-x)^3 + x^b", x, (-x.powi(3) + x.powi(-3), -3.0 * x * x - 3.0 * x.powi(-4)));
    // The sine and the cosine of one angle are computed at once, in either order.
    is("cos(a*x)*sin(a*x)", x, ((0.6_f64).cos() * (0.6_f64).sin(), 2.0 * (1.2_f64).cos()));
}

#[test]
fn numbers_may_be_formulas() {
    assert_eq!(number("8/3").unwrap(), 8.0 / 3.0);
    close(number("2*pi").unwrap(), std::f64::consts::TAU, 0.0);
    assert!(number("1/0").is_err() && number("x").is_err() && number("").is_err());
    let scene = Scene::parse(
        "Scene(title: \"t\", problem: Residual(unknowns: [(\"u\", \"a - u\")]), parameters: [(\"a\", \"8/3\")],
            runs: [Run(name: \"r\", start: Guess([(\"u\", \"2*4/3\")]), along: [(name: \"a\", high: 3)])])",
    );
    let mut scene = scene.unwrap();
    assert_eq!(scene.value("a"), Some(8.0 / 3.0));
    scene.set("a", "sqrt(2)").unwrap();
    assert_eq!(scene.value("a"), Some(2.0_f64.sqrt()));
}

/// One tape is evaluated in every scalar alike.
#[test]
fn declared_names_come_before_constants() {
    let text = "Equations(states: [(\"pi\", \"-e*pi\")], parameters: [(\"e\", 3)])";
    let Model::Field(field) = Model::read(&Source::new("", text), &[]).unwrap() else { panic!() };
    let mut f = [0.0];
    field.field(0.0, &[2.0], &[3.0], &mut f);
    assert_eq!((f, field.forcing()), ([-6.0], Forcing::None));
}

#[test]
fn arrays_state_discretised_equations() {
    let bratu = "Residual(
        unknowns: [(\"u[i=1..n]\", \"(u[i-1] - 2*u[i] + u[i+1])*(n + 1)^2 + lambda*exp(u[i])\")],
        definitions: [(\"n\", 40), (\"u[0]\", 0), (\"u[n+1]\", 0)],
        monitors: [(\"norm\", \"sqrt(sum(i, 1, n, u[i]^2)/n)\")],
        parameters: [(\"lambda\", 0)],
    )";
    let Model::Zero(zero) = Model::read(&Source::new("", bratu), &[]).unwrap() else { panic!() };
    let mut system = Dense::shared(zero);
    let branch = Continuation::new(&mut system)
        .along("lambda", 0.0..=4.0)
        .bound("norm", 0.0..=3.0)
        .trace()
        .unwrap();
    let fold = branch.of_kind(Kind::LP).next().expect("a fold");
    // Differences of second order: 3.513830719 less 1.1e-3 at n = 40.
    close(fold.parameters[0], 3.513830719125, 2e-3);
    assert!(branch.column("norm").is_some());
}

/// Reading and evaluating take a time in proportion to the number of states.
#[test]
fn two_thousand_states() {
    let text = |n: usize| {
        format!(
            "Equations(states: [(\"u[i=1..n]\", \"d*(u[i-1] - 2*u[i] + u[i+1])*(n + 1)^2 + u[i]*(1 - u[i])\")],
                definitions: [(\"n\", {n}), (\"u[0]\", \"u[1]\"), (\"u[n+1]\", \"u[n]\")], parameters: [(\"d\", 1)])"
        )
    };
    let read = |n: usize| match Model::read(&Source::new("", text(n)), &[]).unwrap() {
        Model::Field(field) => field,
        _ => panic!("a field"),
    };
    let memory = |n: usize| allocation_counter::measure(|| drop(read(n))).bytes_max as f64;
    assert!(memory(2000) < 12.0 * memory(200), "{} and {}", memory(2000), memory(200));
    let field = read(2000);
    let x: Vec<f64> = (0..2000).map(|k| 0.2 + 1e-4 * k as f64).collect();
    let mut f = vec![0.0; 2000];
    let used = allocation_counter::measure(|| field.field(0.0, &x, &[1.0], &mut f));
    assert_eq!(used.count_total, 0);
    let inner =
        |k: usize| (x[k - 1] - 2.0 * x[k] + x[k + 1]) * 2001.0_f64.powi(2) + x[k] * (1.0 - x[k]);
    close(f[1000], inner(1000), 1e-6);
    close(f[0], (x[1] - x[0]) * 2001.0_f64.powi(2) + x[0] * (1.0 - x[0]), 1e-6);
    // Of many elements only the norm is recorded.
    assert_eq!(VectorField::measures(&*field).len(), 1);
}

#[test]
fn maps_and_their_cycles() {
    let scene = "Scene(
        title: \"Hénon\",
        problem: Map(states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"b*x\")]),
        parameters: [(\"a\", 0), (\"b\", 0.3)],
        runs: [
            Run(name: \"fixed\", along: [(name: \"a\", low: 0, high: 1.2)]),
            Run(name: \"two\", start: From(run: \"fixed\", kind: PD, switch: true), along: [(name: \"a\", low: 0, high: 1.2)]),
            Run(name: \"doublings\", hold: PD, start: From(run: \"fixed\", kind: PD),
                along: [(name: \"a\", low: 0, high: 3), (name: \"b\", low: -0.9, high: 0.9)]),
            Run(name: \"settled\", set: [(\"a\", \"0.9\")], start: Simulated(transient: 500), along: [(name: \"a\", low: 0, high: 0.95)]),
        ],
    )";
    let outcome = execute(&Scene::parse(scene).unwrap(), None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let branches = &outcome.document.branches;
    // Fixed points double at a = 3 (1 − b)²/4, cycles of two at a = (1 − b)² + (1 + b)²/4.
    let doubling =
        |k: usize| branches[k].of_kind(Kind::PD).next().expect("a doubling").parameters[0];
    close(doubling(0), 0.75 * 0.49, 1e-12);
    close(doubling(1), 0.49 + 1.69 / 4.0, 1e-12);
    for point in &branches[2].points {
        let [a, b] = [point.parameters[0], point.parameters[1]];
        close(a, 0.75 * (1.0 - b).powi(2), 1e-8);
    }
    // Where the cycles of two come back to the fixed points, their branch ends.
    let mut doublings: Vec<f64> =
        branches[3].of_kind(Kind::PD).map(|point| point.parameters[0]).collect();
    doublings.sort_by(f64::total_cmp);
    assert_eq!(doublings.len(), 2);
    close(doublings[0], doubling(0), 1e-12);
    close(doublings[1], doubling(1), 1e-12);
}

#[test]
fn what_is_found_is_followed() {
    let text = "Scene(
        title: \"Lorenz\",
        problem: Equations(
            states: [(\"x\", \"sigma*(y - x)\"), (\"y\", \"x*(rho - z) - y\"), (\"z\", \"x*y - beta*z\")],
            solution: equilibrium,
        ),
        parameters: [(\"sigma\", 10), (\"rho\", 0), (\"beta\", \"8/3\")],
        runs: [Run(name: \"rest\", along: [(name: \"rho\", low: 0, high: 30)])],
    )";
    let (scene, outcome) = explore(&Scene::parse(text).unwrap(), 2, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let names: Vec<&str> =
        outcome.document.branches.iter().map(|branch| branch.name.as_str()).collect();
    assert_eq!(names, ["rest", "rest-BP", "rest-BP-HB1", "rest-BP-HB2"]);
    let hopf = outcome.document.branches[1].of_kind(Kind::HB).next().expect("a Hopf point");
    // σ (σ + β + 3)/(σ − β − 1).
    close(hopf.parameters[1], 10.0 * (10.0 + 8.0 / 3.0 + 3.0) / (10.0 - 8.0 / 3.0 - 1.0), 1e-11);
    // The scene that it amounts to traces the same.
    let written = scene.to_ron();
    let again = Scene::parse(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(again, scene);
    // A scene's own runs are neither left out nor followed twice.
    let stated = text.replace(
        "high: 30)])],",
        "high: 30)]),
            Run(name: \"fixed\", start: From(run: \"rest\", kind: BP, switch: true), along: [(name: \"rho\", low: 0, high: 30)])],",
    );
    let (own, _) = explore(&Scene::parse(&stated).unwrap(), 2, &mut ());
    let names: Vec<&str> = own.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(names, ["rest", "fixed", "fixed-HB1", "fixed-HB2"]);
    let again = execute(&again, None, &mut ());
    assert_eq!(again.document.branches.len(), 4);
    assert_eq!(
        again.document.branches[3].special.len(),
        outcome.document.branches[3].special.len()
    );
}

#[test]
fn conditions_at_ends_and_integrals() {
    // u'' + λu = 0, u(0) = u(1) = 0, ∫u² = c: the first eigenvalue is π² for any c.
    let scene = "Scene(
        title: \"Taut string\",
        problem: Boundary(
            states: [(\"u\", \"v\"), (\"v\", \"-lambda*u\")],
            conditions: [\"u(0)\", \"u(1)\"], integrals: [\"u^2 - c\"], unknowns: [\"lambda\"], length: \"1\",
            monitors: [(\"energy\", \"v^2/2\")],
        ),
        parameters: [(\"c\", 1)],
        runs: [Run(name: \"r\", start: Guess([(\"u\", 1), (\"lambda\", 9)]), along: [(name: \"c\", low: 0.5, high: 2)])],
    )";
    let outcome = execute(&Scene::parse(scene).unwrap(), None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let branch = &outcome.document.branches[0];
    let (lambda, energy) =
        (branch.special[0].state.last().unwrap(), branch.column("energy").unwrap());
    close(*lambda, std::f64::consts::PI.powi(2), 1e-8);
    // ∫v²/2 = λ c/2.
    let end = branch.special.last().unwrap();
    close(end.value(energy).unwrap(), std::f64::consts::PI.powi(2) * end.parameters[0] / 2.0, 1e-7);
}

#[test]
fn residuals_say_nothing_of_motion_unless_they_state_it() {
    let zero = |dynamics: &str| {
        let text =
            format!("Residual(unknowns: [(\"u\", \"a - u\")], parameters: [(\"a\", 1)]{dynamics})");
        match Model::read(&Source::new("", text), &[]).unwrap() {
            Model::Zero(zero) => zero.dynamics(),
            _ => panic!("a residual"),
        }
    };
    use tangency::core::problem::Dynamics;
    assert_eq!(zero(""), Dynamics::None);
    assert_eq!(zero(", dynamics: flow"), Dynamics::Flow);
    assert_eq!(zero(", dynamics: potential"), Dynamics::Potential);
}

/// Registers are shared: a long formula needs few of them, and all are right.
#[test]
fn long_formulas_in_any_scalar() {
    let mut formula = String::from("x");
    for k in 1..400 {
        write!(formula, " + sin({k}*x)*cos({k}*x)/{k}").unwrap();
    }
    fn expected<T: Scalar>(x: T) -> T {
        (1..400).fold(x, |sum, k| sum + (x * k as f64).sin() * (x * k as f64).cos() / k as f64)
    }
    let (value, derivative) = slope(&formula, 0.3);
    let exact = expected(Dual64::from(0.3).derivative());
    close(value, exact.re, 1e-12);
    close(derivative, exact.eps, 1e-10);
}

#[test]
fn every_scene_can_be_written() {
    for built_in in BUILT_IN {
        let scene = Scene::parse(built_in.text).unwrap();
        let written = scene.to_ron();
        let again = Scene::parse(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
        assert!(again == scene, "{}:\n{written}", built_in.name);
    }
}

/// Resets name the elements of arrays as states do: one by one, or by range.
#[test]
fn resets_of_arrays() {
    use tangency::core::hybrid::HybridSystem;
    let text = "HybridEquations(
        modes: [(name: \"m\", states: [(\"u[i=1..n]\", \"-i\"), (\"v\", \"1\")])],
        guards: [(name: \"g\", function: \"u[1]\", reset: [(\"u[k=2..n]\", \"k*u[k-1] + v\"), (\"u[n-2]\", 7)])],
        definitions: [(\"n\", 3)],
    )";
    let Model::Hybrid(system) = Model::read(&Source::new("", text), &[]).unwrap() else { panic!() };
    let mut after = [0.0; 4];
    system.reset(0, (0, 0), 0.0, &[1.0, 2.0, 4.0, 0.5], &[], &mut after);
    assert_eq!(after, [7.0, 2.5, 6.5, 0.5]);
}

/// Two fields and a surface: what follows is known from them, and a statement is read back as it is
/// written.
#[test]
fn two_fields_and_a_surface() {
    let text = "FilippovEquations(
        above: [(\"x\", \"y - u\"), (\"y\", \"0\")], below: [(\"x\", \"y + u\"), (\"y\", \"0\")],
        surface: \"x - sin(t)\", names: [(\"sliding\", \"slide\")], parameters: [(\"u\", 2)], period: \"2*pi\",
    )";
    let source = Source::new("relay.ron", text);
    let Model::Filippov(relay) = Model::read(&source, &[]).unwrap() else { panic!() };
    let modes: Vec<String> = relay.modes().into_iter().map(|mode| mode.name).collect();
    assert_eq!(modes, ["above", "below", "slide"]);
    // The surface moves up with the velocity 1: sliding does, and is held between y = -1 and y = 3.
    let next = |y: f64| relay.next_mode(0, 0, 0.0, &[0.0, y], &[2.0]);
    assert_eq!([next(-1.1), next(-0.9), next(2.9)], [1, 2, 2]);
    assert_eq!([-0.9, 3.1].map(|y| relay.next_mode(0, 1, 0.0, &[0.0, y], &[2.0])), [2, 0]);
    let mut rates = [0.0_f64; 2];
    HybridSystem::field(&*relay, 2, 0.0, &[0.0, 0.5], &[2.0], &mut rates);
    assert!((rates[0] - 1.0).abs() < 1e-15 && rates[1] == 0.0, "{rates:?}");
    let stated = Statement::of(&source).unwrap();
    let written = Source::new("relay.ron", stated.ron());
    assert_eq!(Statement::of(&written).unwrap(), stated);
}
