//! What is correct, before it is changed: scenes, models, and the files that the program itself
//! makes of some.

use super::dice::Dice;
use super::mutate::words;
use super::runner::Program;
use std::path::Path;
use tangency::Catalogue;
use tangency::output::{Plot, Sweeps};
use tangency::scene::{BUILT_IN, SceneError, Start};

/// Scenes that take long even with few points: they are read and written, not traced.
const SLOW: &[&str] = &[
    "mita-chatter",
    "mita-grazing-curve",
    "mita-histories",
    "plate-aspect",
    "plate-buckling",
    "plate-frequency",
    "plate-modes",
    "plate-modes-clamped",
    "plate-pull-in-aspect",
    "plate-pull-in-edges",
    "plate-pull-in-gap",
];

macro_rules! texts {
    ($folder:literal $end:literal: $($name:literal)*) => {
        [$(($name, include_str!(concat!("../../", $folder, $name, $end)))),*]
    };
}

const LIBRARY: [(&str, &str); 20] = texts!("scenes/library/" ".ron":
    "bang-bang" "belt" "bouncing-ball" "brusselator" "buck-converter" "chua-sliding" "co-oxidation" "duffing" "fitzhugh-nagumo"
    "integrate-and-fire" "lorenz" "lure" "morris-lecar" "relay" "rocking-block" "simplest-walker" "soft-stop" "stick-slip"
    "swift-hohenberg" "two-walls");

const XPPAUT: [(&str, &str); 12] = texts!("tests/models/ode/" ".ode":
    "ball" "block" "chain" "choices" "clock" "discrete" "forced" "functions" "henon" "neurons" "quantities" "sums");

/// Files of equations, each with a parameter and a state.
pub const EQUATIONS: [(&str, &str, &str); 7] = [
    (
        "Equations(states: [(\"x\", \"sigma*(y - x)\"), (\"y\", \"x*(rho - z) - y\"), (\"z\", \"x*y - beta*z\")],
    parameters: [(\"sigma\", 10), (\"rho\", 0.5), (\"beta\", \"8/3\")])",
        "rho",
        "x",
    ),
    (
        "Equations(states: [(\"x\", \"v\"), (\"v\", \"f*cos(w*t) - 0.2*v - x - x^3\")], period: \"2*pi/w\",
    parameters: [(\"f\", 0.3), (\"w\", 1.2)], definitions: [(\"k\", 1)], monitors: [(\"energy\", \"v^2/2 + x^2/2\")])",
        "w",
        "v",
    ),
    (
        "Residual(unknowns: [(\"u[i=1..n]\", \"u[i-1] - 2*u[i] + u[i+1] + a*exp(u[i])/(n + 1)^2\")],
    definitions: [(\"n\", 8), (\"u[0]\", 0), (\"u[n+1]\", 0)], parameters: [(\"a\", 0)])",
        "a",
        "u[1]",
    ),
    (
        "Map(states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"f(x, b)\")], functions: [(\"f\", [\"u\", \"v\"], \"u*v\")],
    parameters: [(\"a\", 0.1), (\"b\", 0.3)], initial: [(\"x\", 0.7)])",
        "a",
        "x",
    ),
    (
        "Boundary(states: [(\"u\", \"v\"), (\"v\", \"-l*exp(u)\")], conditions: [\"u(0)\", \"u(1)\"], length: \"1\",
    parameters: [(\"l\", 0)])",
        "l",
        "u",
    ),
    (
        "HybridEquations(modes: [(name: \"f\", states: [(\"x\", \"v\"), (\"v\", \"a*cos(w*t) - x - 0.1*v\")])],
    guards: [(name: \"i\", modes: [\"f\"], function: \"1 - x\", next: [(\"f\", \"x\"), \"f\"], reset: [(\"v\", \"-0.8*v\")])],
    period: \"2*pi/w\", parameters: [(\"a\", 0.3), (\"w\", 2)])",
        "a",
        "v",
    ),
    (
        "FilippovEquations(above: [(\"x\", \"v\"), (\"v\", \"a*cos(w*t) - x - 0.5\")],
    below: [(\"x\", \"v\"), (\"v\", \"a*cos(w*t) - x + 0.5\")], surface: \"v\", names: [(\"sliding\", \"stick\")],
    holds: [(\"above\", \"x - a*cos(w*t) + 0.6\")], period: \"2*pi/w\", parameters: [(\"a\", 1), (\"w\", 1.5)])",
        "a",
        "v",
    ),
];

/// A sweep that takes a hundredth of a second: an oscillator with impacts.
pub const TINY: &str = "Scene(
    title: \"Tiny\",
    problem: HybridEquations(
        modes: [(name: \"f\", states: [(\"x\", \"v\"), (\"v\", \"a*cos(w*t) - x - 0.1*v\")])],
        guards: [(name: \"hit\", modes: [\"f\"], function: \"1 - x\", reset: [(\"v\", \"-0.8*v\")])],
        period: \"2*pi/w\",
    ),
    parameters: [(\"a\", 1), (\"w\", 2)],
    plot: (x: \"a\", y: \"x\", swept: [(\"a\", \"hit\"), (\"a\", \"hit.v\")]),
    sweeps: [
        (
            name: \"up\",
            over: [(name: \"a\", low: 0.5, high: 3, count: 4)],
            order: up,
            starts: [[(\"x\", 0.1)]],
            search: (transient: 4, recorded_periods: 4, lyapunov_periods: 4),
        ),
        (
            name: \"starts\",
            over: [(name: \"x\", low: -0.4, high: 0.4, count: 2), (name: \"v\", low: 0, high: 1, count: 2)],
            search: (transient: 4, recorded_periods: 4, lyapunov_periods: 0),
        ),
    ],
)
";

/// The scenes of which documents are made, with settings that make them small.
const TRACED: [(&str, &[&str]); 3] = [
    ("bratu", &["max_points=14", "intervals=6", "degree=2", "max_step=0.3"]),
    ("impact-oscillator", &["max_step=0.2"]),
    ("mita-nonimpacting", &["max_points=30", "max_step=0.3"]),
];

/// A scene whose text is shortened.
pub struct Base {
    pub name: String,
    pub text: String,
    /// The same with no runs but those that need no others, as the program writes it.
    pub simple: String,
    pub slow: bool,
    /// Its parameters, and the settings of its problem.
    pub names: Vec<String>,
}

impl Base {
    fn new(catalogue: &Catalogue, name: &str, text: &str) -> Result<Self, SceneError> {
        let text = shortened(text);
        let mut scene = catalogue.parse(&text)?;
        scene.runs.retain(|run| !matches!(run.start, Start::From { .. }));
        scene.runs.iter_mut().for_each(|run| run.shown = true);
        let (x, y) = (scene.plot.x.take(), scene.plot.y.take());
        scene.plot = Plot { x, y, ..Plot::default() };
        let parameters = scene.problem.parameters().into_iter().map(|(name, _)| name);
        let settings = scene.problem.settings().into_iter().map(|(name, _)| name.to_string());
        let names = parameters.chain(settings).collect();
        let slow = SLOW.contains(&name);
        // Runs may need others for what they expand.
        let simple = Some(scene.to_ron()).filter(|simple| catalogue.parse(simple).is_ok());
        Ok(Base { name: name.into(), simple: simple.unwrap_or(text.clone()), text, slow, names })
    }

    /// One of the two texts.
    pub fn one_of_both(&self, dice: &mut Dice) -> &str {
        if dice.chance(2, 3) { &self.simple } else { &self.text }
    }
}

/// Everything that is changed.
pub struct Bases {
    pub scenes: Vec<Base>,
    /// Files of XPPAUT's, with their names.
    pub xppaut: Vec<(&'static str, &'static str)>,
    /// Saved traces, by the names of their scenes.
    pub documents: Vec<(String, String)>,
    /// Saved sweeps of [`TINY`]: the whole, and two parts.
    pub archives: [Vec<u8>; 3],
    /// The same, read.
    pub sweeps: [Sweeps; 3],
    /// All words in scenes.
    pub words: Vec<String>,
}

impl Bases {
    /// Makes them in a folder; an error says what the program could not do.
    pub fn new(program: &Program, folder: &Path) -> Result<Self, String> {
        let built_in = BUILT_IN.iter().map(|scene| (scene.name, scene.text));
        let catalogue = Catalogue::built_in();
        let base = |(name, text)| Base::new(&catalogue, name, text);
        let scenes: Result<Vec<Base>, _> = built_in.chain(LIBRARY).map(base).collect();
        let scenes = scenes.map_err(|error| error.to_string())?;
        let mut known: Vec<String> = scenes.iter().flat_map(|scene| words(&scene.text)).collect();
        known.sort();
        known.dedup();
        let mut documents = Vec::new();
        for (name, settings) in TRACED {
            let mut arguments = vec!["trace", name];
            arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
            program.make(&arguments, folder)?;
            let text = std::fs::read_to_string(folder.join(format!("out/{name}.ron")));
            documents.push((name.to_string(), text.map_err(|error| format!("{name}: {error}"))?));
        }
        std::fs::write(folder.join("tiny.ron"), TINY).map_err(|error| error.to_string())?;
        let mut archives = [const { Vec::new() }; 3];
        let mut sweeps = Vec::new();
        for (bytes, part) in archives.iter_mut().zip(["", "1/2", "2/2"]) {
            let mut arguments = vec!["sweep", "tiny.ron"];
            let path = match part.split_once('/') {
                None => folder.join("out/tiny.npz"),
                Some((number, of)) => {
                    arguments.extend(["--part", part]);
                    folder.join(format!("out/tiny.part-{number}-of-{of}.npz"))
                }
            };
            program.make(&arguments, folder)?;
            *bytes = std::fs::read(&path).map_err(|error| error.to_string())?;
            sweeps.push(Sweeps::load(&path).map_err(|error| error.to_string())?);
        }
        let sweeps = sweeps.try_into().map_err(|_| "three sweeps")?;
        Ok(Bases { scenes, xppaut: XPPAUT.to_vec(), documents, archives, sweeps, words: known })
    }
}

/// A scene that takes a few hundredths of a second: few points, few and short runs of sweeps.
fn shortened(text: &str) -> String {
    const SHORT: [(&str, &str); 6] = [
        ("count: ", "3"),
        ("transient: ", "5"),
        ("recorded_periods: ", "4"),
        ("lyapunov_periods: ", "3"),
        ("strands: ", "1"),
        ("steps: ", "3"),
    ];
    let mut short = match text.contains("    settings: (") {
        true => text.replacen("    settings: (", "    settings: (max_points: 12, ", 1),
        false => text.replacen("    title:", "    settings: (max_points: 12),\n    title:", 1),
    };
    for (field, number) in SHORT {
        let parts: Vec<&str> = short.split(field).collect();
        let rest = |part: &&str| {
            format!("{number}{}", part.trim_start_matches(|c: char| c.is_ascii_digit()))
        };
        let tail: Vec<String> = parts[1..].iter().map(rest).collect();
        short = [vec![parts[0].to_string()], tail].concat().join(field);
    }
    short
}
