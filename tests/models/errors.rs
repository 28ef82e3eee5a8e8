//! What is wrong with equations: each mistake has its text and its place.

use tangency::Diagnostic;
use tangency::core::failure::one_line;
use tangency::language::{Fault, Model, ModelError, Source};
use tangency::scene::{Scene, execute};

fn refused(text: &str) -> ModelError {
    match Model::read(&Source::new("model.ron", text), &[]) {
        Ok(_) => panic!("{text}"),
        Err(error) => error,
    }
}

/// The error of a text, which must be at the place that `»…«` marks in it.
fn at(marked: &str) -> ModelError {
    let start = marked.find('»').expect("a mark");
    let text = marked.replace(['»', '«'], "");
    let error = refused(&text);
    let before = &marked[..start];
    let line = 1 + before.matches('\n').count();
    let column = 1 + before.rsplit('\n').next().unwrap_or("").chars().count();
    assert_eq!((error.place.line, error.place.column), (Some(line), column), "{error}");
    let end = marked.find('«').expect("an end");
    let width = marked[start + '»'.len_utf8()..end].chars().count();
    assert_eq!(error.place.width, width.max(1), "{error}");
    error
}

fn says(marked: &str, words: &str) {
    let error = at(marked);
    let help = error.help.iter().map(|help| format!("; {help}")).collect::<String>();
    let said = format!("{}{help}", error.fault);
    assert!(said.contains(words), "{said}\n\nlacks: {words}");
}

#[test]
fn formulas() {
    let of = |formula: &str| {
        format!(
            "Equations(\n  states: [(\"x\", \"{formula}\")],\n  parameters: [(\"alpha\", 1)],\n  period: \"1\")"
        )
    };
    says(&of("1 + »alhpa« - x"), "unknown name `alhpa`; did you mean `alpha`?");
    says(&of("»snh(x)«"), "unknown function `snh`; did you mean `sinh`?");
    says(&of("»sin(x, 2)«"), "`sin` takes one argument, not 2");
    says(&of("1 + »«"), "expected a number, a name or `(`");
    says(&of("(x + 1»«"), "expected an operator or `)`");
    says(&of("x »x«"), "expected an operator, as in `2*x`, or the end of the formula");
    says(&of("2»x«"), "expected an operator, as in `2*x`");
    says(&of("»x'« + 1"), "the rate `x'`: rates occur only on the left-hand sides of equations");
    says(&of("»z'« + 1"), "unknown name `z'`");
    says(&of("x' »=« 1"), "expected an operator, as in `2*x`, or the end of the formula");
    says(&of("x + »§« 2"), "expected a number, a name or `(`");
    says(&of("if(x, 1»)«"), "expected an operator, `,` or `)`");
    says(
        &of("»sum(i, 1, x, i)«"),
        "the last index of a sum must be an integer that does not depend on states",
    );
    says(&of("»u[1]«"), "unknown name `u[1]`");
    says(
        &of("2*»x[1.5]«"),
        "the index must be an integer that does not depend on states, parameters or time; it is 1.5",
    );
}

#[test]
fn names() {
    says(
        "Equations(states: [(\"x\", \"1\"), (\"»x«\", \"2\")])",
        "`x` is given a second time, although `x` is already a state",
    );
    says(
        "Equations(states: [(\"x\", \"a\")], parameters: [(\"a\", 1)], definitions: [(\"»a«\", \"2\")])",
        "`a` is already a parameter",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], functions: [(\"»x«\", [\"u\"], \"u\")])",
        "`x` is already a state",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], functions: [(\"»sin«\", [\"u\"], \"u\")])",
        "`sin` is already a function of the language",
    );
    says(
        "Equations(states: [(\"»t«\", \"1\")])",
        "this name is a reserved word of the model language",
    );
    says(
        "Equations(states: [(\"»2x«\", \"1\")])".replace("»2x«", "»2«x").as_str(),
        "expected a name",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], monitors: [(\"»x«\", \"2\")])",
        "`x` is already a state",
    );
    says(
        "Equations(states: [(\"x\", \"d\")], definitions: [(\"d\", \"»c« + 1\"), (\"c\", \"2\")])",
        "`c` is defined in terms of itself: `d` may use only the definitions before it",
    );
    says(
        "Equations(states: [(\"x\", \"f(x)\")], functions: [(\"f\", [\"u\"], \"»f(u - 1)«\")])",
        "`f` is defined in terms of itself: f",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], initial: [(\"»a«\", 2)], parameters: [(\"a\", 1)])",
        "only states and further unknowns have initial values",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], period: \"»2*x«\")",
        "the period: the formula may contain parameters, but not states or time",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], parameters: [(\"a\", \"»1/0«\")])",
        "the value must be a finite number that does not depend on states, parameters or time",
    );
    says("Equations(states: [(\"x\", \"1\")], scales: [(\"»y«\", 2)])", "unknown state `y`");
}

#[test]
fn statements() {
    let error = refused("Equations(states: [(\"x\", \"1\")], stats: [])");
    assert!(one_line(&error).contains("stats"), "{error}");
    assert_eq!(error.place.line, Some(1));
    let error = refused("Equation(states: [(\"x\", \"1\")])");
    assert!(
        error.help.as_deref().is_some_and(|help| help.starts_with("did you mean `Equations`?")),
        "{error}"
    );
    let error = refused("Equations()");
    assert!(matches!(error.fault, Fault::Missing { .. }), "{error}");
    assert_eq!(error.to_string(), "model.ron: the equations are missing");
    assert!(
        refused("Map(states: [(\"x\", \"x + t\")])")
            .to_string()
            .contains("maps that depend on the number of the iteration")
    );
    says(
        "Boundary(states: [(\"u\", \"v\"), (\"v\", \"-u\")], conditions: [\"»u(0)«\"])",
        "give 2 `conditions` and `integrals` in total: one for each state (2), and one for each entry of `unknowns` (0)",
    );
    says("Boundary(states: [(\"u\", \"1\")], conditions: [\"»t«\"])", "cannot contain the time");
    says(
        "Boundary(states: [(\"u\", \"1\")], definitions: [(\"d\", \"»u« + 1\")], conditions: [\"d\"])",
        "expected the value at one end: `u(0)` at the beginning or `u(1)` at the end",
    );
    says(
        "Boundary(states: [(\"u\", \"1\")], conditions: [\"»u(2)«\"])",
        "expected the value at one end: `u(0)` at the beginning or `u(1)` at the end",
    );
    says(
        "Boundary(states: [(\"u\", \"1\")], conditions: [\"»u« - 1\"])",
        "expected the value at one end: `u(0)` at the beginning or `u(1)` at the end",
    );
}

#[test]
fn sizes_of_arrays() {
    says(
        "Equations(states: [(\"»x[i=1..200001]«\", \"-x[i]\")])",
        "elements of an array: the limit is 200000",
    );
    says(
        "Equations(states: [(\"x[i=1..200000]\", \"-x[i]\"), (\"»y«\", \"1\")])",
        "states: the limit is 200000",
    );
    says(
        "Residual(unknowns: [(\"»u[i=1..1000, j=-999999999..999999999]«\", \"u[i,j]\")])",
        "elements of an array: the limit is 200000",
    );
    says("Residual(unknowns: [(\"»u[i=1..3, i=1..2]«\", \"u[i,i]\")])", "`i` is already an index");
    says(
        "Residual(unknowns: [(\"u[i=1..3, j=1..2]\", \"1 + »u[i, j-7]«\")])",
        "unknown name `u[1,-6]`",
    );
    says("Residual(unknowns: [(\"u[i=1..3, j=1..2]\", \"2*»u[i]«\")])", "unknown name `u[1]`");
    says("Residual(unknowns: [(\"u[i=1..3, »]«\", \"1\")])", "expected a number, a name or `(`");
    says(
        "Residual(unknowns: [(\"u[i=1..2]\", \"u[i]\")], definitions: [(\"»u[i=1..2]«\", 0)])",
        "`u[1]` is already a state",
    );
    says(
        "Residual(unknowns: [(\"»u[i=1..n]«\", \"u[i]\")], parameters: [(\"n\", 10)])",
        "the last index must be an integer that does not depend on states, parameters or time",
    );
    says(
        "Residual(unknowns: [(\"»u[i=3..1]«\", \"u[i]\")])",
        "the range 3..1 of `i`: the range is empty: the first index must not be above the last index",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], definitions: [(\"n\", 0), (\"»d[i=1..n]«\", \"i\")])",
        "the range 1..0 of `i`",
    );
}

#[test]
fn modes_and_guards() {
    let of = |guard: &str| {
        format!(
            "HybridEquations(\n  modes: [\n    (name: \"up\", states: [(\"x\", \"v\"), (\"v\", \"-1\")]),
    (name: \"down\", states: [(\"x\", \"w\"), (\"w\", \"1\")]),\n  ],\n  guards: [\n    {guard},\n  ],\n)"
        )
    };
    says(
        &of("(name: \"»hit«\", function: \"x\")"),
        "the guard `hit` does not name the modes that it ends; name the modes that the guard ends",
    );
    says(
        &of("(name: \"hit\", modes: [\"»upp«\"], function: \"x\")"),
        "unknown mode `upp`; did you mean `up`?",
    );
    says(
        &of("(name: \"hit\", modes: [\"up\"], function: \"x\", next: \"»dwn«\")"),
        "unknown mode `dwn`; did you mean `down`?",
    );
    says(
        &of("(name: \"»hit«\", modes: [\"up\"], function: \"x\", next: \"down\")"),
        "the reset of `hit` leaves `w` undefined, a state of mode `down` but not of `up` before the event",
    );
    says(
        &of("(name: \"hit\", modes: [\"up\"], function: \"»w«\", next: \"up\")"),
        "unknown name `w`",
    );
    says(
        &of(
            "(name: \"hit\", modes: [\"up\"], function: \"x\", next: \"up\", reset: [(\"»z«\", \"1\")])",
        ),
        "unknown state `z`",
    );
    let begin = |initial: &str| {
        of("(name: \"hit\", modes: [\"up\"], function: \"x\")")
            .replace("guards", &format!("initial: [({initial}, 1)], guards"))
    };
    says(
        &begin("\"»w«\""),
        "the initial value of `w` belongs to mode `down`: the motion begins in the first mode, \
         `up`, which does not have this state",
    );
    says(&begin("\"»vv«\""), "unknown state `vv`; did you mean `v`?");
    says(
        "HybridEquations(modes: [(name: \"a\", states: [(\"x\", \"1\")]), (name: \"»a«\", states: [(\"x\", \"1\")])])",
        "`a` is already a mode",
    );
}

#[test]
fn scenes_show_the_line() {
    let text = "Scene(\n    title: \"t\",\n    problem: Equations(states: [(\"x\", \"rho - x^2\")], solution: equilibrium),\n    parameters: [(\"rh\", 1)],
    runs: [Run(name: \"r\", along: [(name: \"rh\", low: 0)])],\n)";
    let error = Scene::parse(text).unwrap_err();
    let help = error.help().expect("a help").to_string();
    assert!(help.starts_with("did you mean `rh`?"), "{help}");
    let error = error.to_string();
    assert!(error.starts_with("line 3, column 40: unknown name `rho`"), "{error}");
    assert!(error.ends_with("\n  |                                        ^^^"), "{error}");
    assert!(
        error.contains(
            "3 |     problem: Equations(states: [(\"x\", \"rho - x^2\")], solution: equilibrium),"
        ),
        "{error}"
    );
    let wrong = text.replace("solution", "solutoin").replace("rho", "rh");
    let error = one_line(&Scene::parse(&wrong).unwrap_err());
    assert!(
        error.contains("unknown field `solutoin` of `Equations`")
            && error.contains("; did you mean `solution`?"),
        "{error}"
    );
    let unused = text.replace("rho", "2").replace("(\"rh\", 1)", "(\"rh\", 1), (\"q\", 2)");
    let scene = Scene::parse(&unused).unwrap();
    assert_eq!(scene.warnings().len(), 2);
    assert!(scene.warnings()[1].contains("`q`"));
}

#[test]
fn a_start_where_a_formula_is_not_finite() {
    let scene = |formula: &str, start: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"{formula}\")], solution: equilibrium),
    parameters: [(\"a\", 1)], runs: [Run(name: \"r\"{start}, along: [(name: \"a\", low: 0.5, high: 2)])])"
        );
        execute(&Scene::parse(&text).unwrap(), None, &mut ())
    };
    let error = one_line(&scene("a - 1/x", "").error.expect("a division by zero"));
    assert!(error.contains("column 58: a division by zero at the start: 1/0"), "{error}");
    assert!(scene("a - 1/x", ", start: Guess([(\"x\", 1)])").error.is_none());
    let error = one_line(&scene("a - ln(x - 1)", "").error.expect("a logarithm"));
    assert!(
        error.contains("the result of an operation is not a number at the start: ln of -1"),
        "{error}"
    );
    // Time without a period: motion can be simulated, but not continued.
    let text = "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a*t - x\")]), parameters: [(\"a\", 1)],
        runs: [Run(name: \"r\", along: [(name: \"a\", low: 0.5, high: 2)])])";
    let error = Scene::parse(text).unwrap_err();
    let error = one_line(&error);
    assert!(error.contains("state the period of the forcing"), "{error}");
}

/// What a stranger may state twice, or in a way that means something else elsewhere.
#[test]
fn nothing_is_silently_left_out() {
    says(
        "Equations(states: [(\"x\", \"1\")], initial: [(\"x\", 1), (\"»x«\", 2)])",
        "`x` is already given a value",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], initial: [(\"x\", \"»2*t«\")])",
        "initial values may depend on parameters only",
    );
    says("Equations(states: [(\"x\", \"0 < x < »1«\")])", "`&` between two comparisons");
    says(
        "Equations(states: [(\"x\", \"1\")], scales: [(\"x\", \"»-1«\")])",
        "a scale must be a number above 0",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], functions: [(\"»sum«\", [\"u\"], \"u\")])",
        "this name is a reserved word of the model language",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], functions: [(\"f\", [\"u\", \"»u«\"], \"u\")])",
        "`u` is already an argument",
    );
    says(
        "Equations(states: [(\"x\", \"1\")], functions: [(\"»f«\", [], \"1\")])",
        "or write a definition instead of the function",
    );
    let of = |guard: &str| {
        format!(
            "HybridEquations(modes: [(name: \"f\", states: [(\"x\", \"v\"), (\"v\", \"-1\")])], \
             guards: [(name: \"g\", function: \"x\", {guard})])"
        )
    };
    says(&of("reset: [(\"v\", \"-v\"), (\"»v«\", \"2*v\")]"), "`v` is already reset");
    says(&of("modes: [\"f\", \"»f«\"]"), "`f` is already a mode of this guard");
    says(&of("reset: [(\"»x[i=1..2]«\", 0)]"), "unknown state `x[1]`");
    says(
        &of("next: [\"»f«\", (\"f\", \"x\")]"),
        "the modes after a mode without a function are never reached",
    );
    // Values of arrays at ends.
    let text = "Boundary(states: [(\"u[i=1..2]\", \"-u[i]\")], conditions: [\"u[1](0) - 1\", \"u[2](1)\"])";
    assert!(Model::read(&Source::new("", text), &[]).is_ok());
    // Sums in functions in each other end in an error, not in an overflow of the stack.
    let nested =
        |k: usize| format!("{}f{}(u){}", "sum(i, 1, 1, ".repeat(100), k + 1, ")".repeat(100));
    let functions: Vec<String> =
        (0..60).map(|k| format!("(\"f{k}\", [\"u\"], \"{}\")", nested(k))).collect();
    let text = format!(
        "Equations(states: [(\"x\", \"f0(x)\")], functions: [{}, (\"f60\", [\"u\"], \"u\")])",
        functions.join(", ")
    );
    assert!(refused(&text).to_string().contains("nested sums and functions"));
}

/// Periods and lengths must be positive where parameters begin: in the scene, in its runs and its
/// sweeps.
#[test]
fn periods_and_lengths_are_positive() {
    says(
        "Equations(states: [(\"x\", \"1\")], period: \"»0«\")",
        "the period `0` is 0, but must be a finite number above 0",
    );
    says(
        "Boundary(states: [(\"u\", \"1\")], conditions: [\"u(0)\"], length: \"»-1«\")",
        "the length `-1` is -1",
    );
    says(
        "Boundary(states: [(\"u\", \"1\")], conditions: [\"u(0)\"], length: \"»u«\")",
        "the length: the formula may contain parameters, but not states or time",
    );
    let scene = |parameters: &str, run: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"cos(pi*w*t) - x + a\")], period: \"2/w\"),
    parameters: [(\"a\", 1), {parameters}], runs: [Run(name: \"r\"{run}, along: [(name: \"a\", low: 0, high: 2)])])"
        );
        Scene::parse(&text).map_err(|error| error.to_string())
    };
    assert!(scene("(\"w\", 2)", "").is_ok());
    let error = scene("(\"w\", -2)", "").unwrap_err();
    assert!(error.contains("the period `2/w` is -1 at w = -2"), "{error}");
    assert!(error.starts_with("line 1, column "), "{error}");
    let error = scene("(\"w\", 2)", ", set: [(\"w\", \"0\")]").unwrap_err();
    assert!(error.contains("the period `2/w` is inf at w = 0"), "{error}");
}

/// A name that nothing has is an error wherever it stands: in a function that nothing calls, in a
/// sum without terms.
#[test]
fn unknown_names_that_nothing_uses() {
    let of = |functions: &str| {
        format!(
            "Equations(states: [(\"x\", \"1\")], definitions: [(\"u[0]\", 1)], functions: [{functions}])"
        )
    };
    says(&of("(\"f\", [\"u\"], \"u + »typo«\")"), "unknown name `typo`");
    says(&of("(\"f\", [\"u\"], \"»snh(u)«\")"), "unknown function `snh`; did you mean `sinh`?");
    says(&of("(\"f\", [\"u\"], \"»g(u, 1)«\"), (\"g\", [\"v\"], \"v\")"), "`g` takes one argument");
    says(&of("(\"f\", [\"u\"], \"»w[u]«\")"), "unknown name `w`");
    says(&of("(\"f\", [\"n\"], \"sum(i, 1, n, i*»q«)\")"), "unknown name `q`");
    says("Equations(states: [(\"x\", \"sum(i, 1, 0, i*»q«)\")])", "unknown name `q`");
    says(
        "Equations(states: [(\"x\", \"1\")], definitions: [(\"d\", \"2*»typo«\")])",
        "unknown name `typo`",
    );
    let right = of("(\"f\", [\"n\", \"k\"], \"sum(i, 1, n, i*pi*x + u[k] + t + max(n, k, e))\")");
    assert!(Model::read(&Source::new("", right), &[]).is_ok());
    let modes = |formula: &str| {
        format!(
            "HybridEquations(modes: [(name: \"a\", states: [(\"x\", \"1\")]), (name: \"b\", states: [(\"y\", \"1\")])],
    functions: [(\"f\", [\"u\"], \"{formula}\")])"
        )
    };
    says(&modes("y + »typo«"), "unknown name `typo`");
    assert!(Model::read(&Source::new("", modes("u + y")), &[]).is_ok());
}

/// A definition that is a number looks like a parameter, but cannot be set or varied.
#[test]
fn definitions_are_no_parameters() {
    let text = "Scene(title: \"t\",
    problem: Equations(
        states: [(\"x\", \"a - n*x\")],
        definitions: [(\"n\", 3)],
        solution: equilibrium,
    ),
    parameters: [(\"a\", 1)],
    runs: [Run(name: \"r\", along: [(name: \"a\", low: 0, high: 2)])],
)";
    let mut scene = Scene::parse(text).unwrap();
    let error = one_line(&scene.set("n", "4").unwrap_err());
    assert!(
        error.starts_with(
            "`n` is a definition (line 4), but only parameters can be set and varied; change the definition, or move \
             `n` to `parameters`"
        ),
        "{error}"
    );
    let error = one_line(&Scene::parse(&text.replace("name: \"a\"", "name: \"n\"")).unwrap_err());
    assert!(error.starts_with("`n` is a definition (line 4)"), "{error}");
}

/// Comments stand wherever RON has them, whatever they hold.
#[test]
fn comments_within_equations() {
    let text = "// states: [
Scene(title: \"t\",
    problem: Equations /* , ( */ ( // a, \"quote\" and a bracket (
        /* states: /* in each other */ [ */ states /* named */: /* states */ [
            (\"x\", /* , */ \"a - x // 2\"), // solution: orbit,
        ] /* behind, */ , /* solution: */ solution: /* solution */ equilibrium // the last, one
        , // done
        definitions: [(\"d\", 1)] /* none */
    ),
    parameters: [(\"a\", 1)],
    runs: [Run(name: \"r\", along: [(name: \"a\", low: 0, high: 2)])],
)";
    let error = Scene::parse(text).unwrap_err();
    let error = one_line(&error);
    assert!(error.starts_with("line 5, column 35: expected a number, a name or `(`"), "{error}");
    let scene = Scene::parse(&text.replace(" // 2\"", "\"")).unwrap();
    let settings = scene.problem.settings();
    assert!(
        settings.contains(&("solution".to_string(), "equilibrium".to_string())),
        "{settings:?}"
    );
    let written = scene.to_ron();
    assert_eq!(Scene::parse(&written).unwrap_or_else(|error| panic!("{error}\n{written}")), scene);
}

/// Files may begin with a byte-order mark, and RON with attributes.
#[test]
fn marks_and_attributes_at_the_beginning() {
    let equations = "Equations(states: [(\"x\", \"a - x\")], parameters: [(\"a\", 1)])";
    let header =
        "\u{feff}// first\n#![enable(implicit_some)] /* and */\n#![enable(unwrap_newtypes)]\n";
    let read = |text: String| Model::read(&Source::new("m.ron", text), &[]);
    assert!(read(format!("\u{feff}{equations}")).is_ok());
    assert!(read(format!("{header}{equations}")).is_ok());
    let error = read(format!("{header}{}", equations.replace("a - x", "a - y"))).unwrap_err();
    assert_eq!((error.place.line, error.place.column), (Some(4), 31), "{error}");
    let error = read(format!("// first\n#![enable(nothing)]\n{equations}")).unwrap_err();
    assert_eq!(error.place.line, Some(2), "{error}");
    let scene = format!(
        "Scene(title: \"t\", problem: {equations}, runs: [Run(name: \"r\", along: [(name: \"a\", low: 0, high: 2)])])"
    );
    assert!(Scene::parse(&format!("{header}{scene}")).is_ok());
    let error = Scene::parse(&format!("\u{feff}{}", scene.replace("a - x", "a - y"))).unwrap_err();
    assert!(one_line(&error).starts_with("line 1, column 58: unknown name `y`"), "{error}");
    let source = Source::new("m.ode", "\u{feff}x'=-x\n");
    assert!(tangency::language::xpp::read(&source).is_ok());
}

/// Two fields and a surface.
#[test]
fn sliding() {
    let of = |rest: &str| {
        format!("FilippovEquations(\n  above: [(\"x\", \"y\"), (\"y\", \"-1\")],\n  {rest})")
    };
    let below = "below: [(\"x\", \"y\"), (\"y\", \"1\")]";
    let text = refused(&of(below)).to_string();
    assert!(text.contains("the equations have no surface"), "{text}");
    says(
        &of("below: [(\"»y«\", \"y\"), (\"x\", \"1\")], surface: \"x\""),
        "state 1 is y: in the field above the surface, the state at the same position is x, but all \
         fields must have the same states in the same order",
    );
    says(
        &of("below: [(\"»x«\", \"y\")], surface: \"x\""),
        "state 2 is none: in the field above the surface, the state at the same position is y",
    );
    let with = |rest: &str| of(&format!("{below}, surface: \"x\", {rest}"));
    says(&with("holds: [(\"»abvoe«\", \"1\")]"), "unknown side `abvoe`");
    says(&with("names: [(\"»slide«\", \"stick\")]"), "unknown mode or event `slide`");
    says(&with("names: [(\"sliding\", \"»above«\")]"), "`above` is already a mode or an event");
    says(&with("sliding: [(\"x\", \"»u«\"), (\"y\", \"0\")]"), "unknown name `u`");
    // What motion needs where it begins: the rates of its mode, on the surface all that decides
    // there.
    let undefined = |rest: &str, x: f64| {
        let text = "FilippovEquations(above: [(\"x\", \"sqrt(x)\"), (\"y\", \"-1\")], below: [(\"x\", \"sqrt(-x)\"), (\"y\", \"1\")]";
        let model = Model::read(&Source::new("", format!("{text}, {rest})")), &[]).unwrap();
        model.undefined_at(&[x, 0.0], &[]).map(|error| error.to_string())
    };
    let slides = |surface: &str, hold: &str| {
        let sliding = "sliding: [(\"x\", \"0\"), (\"y\", \"1/y\")]";
        format!(
            "surface: \"{surface}\", {sliding}, holds: [(\"above\", \"{hold}\"), (\"below\", \"1\")]"
        )
    };
    let plain = slides("x", "ln(y - 1)");
    assert_eq!([1.0, -1.0].map(|x| undefined(&plain, x)), [None, None]);
    let on = undefined(&plain, 0.0).unwrap();
    assert!(
        on.contains("the result of an operation is not a number at the start: ln of -1"),
        "{on}"
    );
    for (rest, x) in [(slides("x", "1"), 0.0), (slides("x + 1/y", "1"), 1.0)] {
        let error = undefined(&rest, x).unwrap();
        assert!(error.contains("a division by zero at the start: 1/0"), "{error}");
    }
}
