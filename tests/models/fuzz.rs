//! Mutated scenes: no panic, no hang, no large allocation.

use crate::common::random::Random;
use cpu_time::ThreadTime;
use std::time::Duration;
use tangency::core::failure::one_line;
use tangency::scene::Scene;

const SCENES: [&str; 7] = [
    r#"Scene(title: "t", problem: Equations(states: [("x", "sigma*(y - x)"), ("y", "if(x > 0, x, -y)^2")], solution: equilibrium),
        parameters: [("sigma", "8/3")], runs: [Run(name: "r", along: [(name: "sigma", low: 0, high: 30)])])"#,
    r#"Scene(title: "t", problem: Residual(unknowns: [("u[i=1..n]", "sum(j, 1, n, u[j]) - a*u[i]")], definitions: [("n", 12)]),
        parameters: [("a", 1)], runs: [Run(name: "r", along: [(name: "a", low: 0)])])"#,
    r#"Scene(title: "t", problem: Residual(unknowns: [("u[i=1..m, j=1..m]", "u[i-1,j] + u[i+1,j] - 2*u[i,j] + a*u[i, j+1]")],
        definitions: [("m", 3), ("u[i=0..m+1, j=0..m+1]", 0)], initial: [("u[1, j=1..m]", "j")], scales: [("u", 2)]),
        parameters: [("a", 1)], runs: [Run(name: "r", along: [(name: "a", low: 0)])])"#,
    r#"Scene(title: "t", problem: Map(states: [("x", "1 - a*x^2 + y"), ("y", "f(x, b)")], functions: [("f", ["u", "v"], "u*v")]),
        parameters: [("a", 0), ("b", 0.3)], runs: [Run(name: "r", along: [(name: "a", low: 0, high: 1.2)])])"#,
    r#"Scene(title: "t", problem: Boundary(states: [("u", "v"), ("v", "-l*exp(u)")], conditions: ["u(0)", "u(1)"], length: "2"),
        parameters: [("l", 0)], runs: [Run(name: "r", along: [(name: "l", low: 0)])])"#,
    r#"Scene(title: "t", problem: HybridEquations(modes: [(name: "f", states: [("x", "v"), ("v", "a*cos(w*t) - x")])],
        guards: [(name: "i", modes: ["f"], function: "1 - x", next: [("f", "x"), "f"], reset: [("v", "-0.8*v")])], period: "2*pi/w"),
        parameters: [("a", 1), ("w", 2)], runs: [Run(name: "r", along: [(name: "a", low: 0, high: 3)])])"#,
    r#"Scene(title: "t", problem: FilippovEquations(above: [("x", "v"), ("v", "a*cos(w*t) - x - F")], below: [("x", "v"), ("v", "a*cos(w*t) - x + F")],
        surface: "v", names: [("sliding", "stick")], holds: [("above", "x + F")], period: "2*pi/w"),
        parameters: [("a", 1), ("w", 2), ("F", 0.1)], runs: [Run(name: "r", along: [(name: "a", low: 0, high: 3)])])"#,
];

/// What is put in, besides parts of the text.
const PARTS: [&str; 24] = [
    "(",
    ")",
    "[",
    "]",
    "\"",
    ",",
    "^",
    "-",
    "*",
    "1e999",
    "999999999",
    "..",
    "λ",
    "\\",
    "sum(i, 1, 99999999, i)",
    "t",
    "x[",
    "if(",
    "\u{0}",
    "((((((((((((",
    "u[i=1..1000000000]",
    "u[i=1..99999, j=1..99999]",
    "[0, j=1..9999]",
    "//",
];

fn mutated(text: &str, dice: &mut Random) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    for _ in 0..=dice.below(3) {
        let at = dice.below(letters.len());
        let end = (at + dice.below(12)).min(letters.len());
        match dice.below(4) {
            0 => drop(letters.drain(at..end)),
            1 => drop(letters.splice(at..at, PARTS[dice.below(PARTS.len())].chars())),
            2 => {
                let copy: Vec<char> = letters[at..end].to_vec();
                let to = dice.below(letters.len());
                letters.splice(to..to, copy);
            }
            _ => letters[at] = PARTS[dice.below(PARTS.len())].chars().next().unwrap_or(' '),
        }
    }
    letters.into_iter().collect()
}

#[test]
fn mutated_scenes_are_read_or_refused() {
    let mut dice = Random::new(1);
    let mut read = 0;
    for k in 0..10_000 {
        let text = mutated(SCENES[k % SCENES.len()], &mut dice);
        let begin = ThreadTime::now();
        let used = allocation_counter::measure(|| read += usize::from(Scene::parse(&text).is_ok()));
        assert!(begin.elapsed() < Duration::from_secs(2), "{text}");
        assert!(used.bytes_max < 100 << 20, "{} bytes for {text}", used.bytes_max);
    }
    // The mutations are neither harmless nor always fatal.
    assert!(read > 100 && read < 9000, "{read}");
}

#[test]
fn deep_and_large_formulas_are_refused() {
    let refused = |formula: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Residual(unknowns: [(\"u\", \"{formula}\")], definitions: [(\"d\", \"u\")]),
                parameters: [(\"a\", 1)], runs: [Run(name: \"r\", along: [(name: \"a\", low: 0)])])"
        );
        let begin = ThreadTime::now();
        let error = one_line(&Scene::parse(&text).unwrap_err());
        assert!(
            begin.elapsed() < Duration::from_secs(2),
            "{:?} for {:.40}",
            begin.elapsed(),
            formula
        );
        error
    };
    for formula in
        ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000), "f(".repeat(100_000)]
    {
        assert!(refused(&formula).contains("the limit is 150"), "{:.60}", refused(&formula));
    }
    let sum = refused("sum(i, 1, 999999999, sum(j, 1, 999999999, u*i*j))");
    assert!(sum.contains("the limit is 2000000") || sum.contains("the limit is 300000"), "{sum}");
}
