//! Models that are restated in other units: definitions express the original states and parameters
//! by the scaled ones.

use super::variant::{Other, Variant};
use std::fmt::Write;

/// A model with its runs.
pub struct Stated {
    pub name: &'static str,
    /// The kind of equations.
    pub kind: &'static str,
    /// States with their rates, next values, or what vanishes. `$t` is time; `x(0)` and `x(1)` are
    /// states at ends.
    pub states: &'static [(&'static str, &'static str)],
    /// Parameters with their values.
    pub parameters: &'static [(&'static str, f64)],
    /// Values of the states at the start.
    pub initial: &'static [f64],
    /// Further fields of the statement. `$time` is the unit of time.
    pub further: &'static str,
    /// The length of the range of parameters.
    pub range: f64,
    /// The settings of the scene.
    pub settings: &'static str,
    /// The runs, with `<name low high>` for the range of a parameter.
    pub runs: &'static str,
}

impl Stated {
    /// Whether the equations have a time.
    pub fn has_time(&self) -> bool {
        self.kind == "Equations"
    }

    /// Whether a run switches branches of solutions on a mesh.
    pub fn crosses_on_mesh(&self) -> bool {
        self.kind == "Boundary" && self.runs.contains("switch")
    }

    /// Whether a decoupled state can be added.
    pub fn takes_others(&self) -> bool {
        matches!(self.kind, "Equations" | "Map")
    }

    /// The scene in other units.
    pub fn text(&self, variant: &Variant) -> String {
        let list = |entries: &[String]| entries.join(", ");
        let Variant { parameter, time, .. } = variant;
        let mut order: Vec<usize> = (0..self.states.len()).collect();
        if variant.reversed {
            order.reverse();
        }
        let mut rates = Vec::new();
        for &k in &order {
            let (name, rate) = self.states[k];
            let rate = rate.replace("$t", &format!("(t/{time:e})"));
            let size = variant.state(k);
            let factor =
                if self.has_time() || self.kind == "Boundary" { size / time } else { size };
            rates.push(format!("(\"u_{name}\", \"{factor:e}*({rate})\")"));
        }
        let other = match self.kind {
            "Map" => "(\"other\", \"other/2\")".to_string(),
            _ => format!("(\"other\", \"-other/{time:e}\")"),
        };
        match variant.other {
            Some(Other::First) => rates.insert(0, other),
            Some(Other::Last) => rates.push(other),
            None => {}
        }
        let states = self.states.iter().enumerate();
        let definitions: Vec<String> = states
            .map(|(k, (name, _))| format!("(\"{name}\", \"u_{name}/{:e}\")", variant.state(k)))
            .chain(
                self.parameters.iter().map(|(p, _)| format!("(\"{p}\", \"q_{p}/{parameter:e}\")")),
            )
            .collect();
        let initial = self.initial.iter().zip(self.states).enumerate();
        let initial: Vec<String> = initial
            .map(|(k, (value, (name, _)))| {
                format!("(\"u_{name}\", {:e})", value * variant.state(k))
            })
            .collect();
        let values = self.parameters.iter();
        let values: Vec<String> =
            values.map(|(p, value)| format!("(\"q_{p}\", {:e})", value * parameter)).collect();
        let mut further = self.further.replace("$time", &format!("{time:e}"));
        for (k, (name, _)) in self.states.iter().enumerate() {
            for end in ["(0)", "(1)"] {
                let stated = format!("u_{name}{end}/{:e}", variant.state(k));
                further = further.replace(&format!("{name}{end}"), &stated);
            }
        }
        let unknowns = if self.kind == "Residual" { "unknowns" } else { "states" };
        let mut text = String::from("Scene(title: \"units\", problem: ");
        let _ = write!(text, "{}({unknowns}: [{}], ", self.kind, list(&rates));
        let _ = write!(text, "definitions: [{}], ", list(&definitions));
        let _ = write!(text, "initial: [{}], ", list(&initial));
        if !further.is_empty() {
            let _ = write!(text, "{further}, ");
        }
        if variant.stated && !variant.states.is_empty() {
            let scales = self.states.iter().enumerate();
            let scales: Vec<String> = scales
                .map(|(k, (name, _))| format!("(\"u_{name}\", \"{:e}\")", variant.state(k)))
                .collect();
            let _ = write!(text, "scales: [{}]", list(&scales));
        }
        text.push_str("), ");
        let _ = write!(text, "parameters: [{}], ", list(&values));
        let _ = write!(text, "settings: ({}), runs: [{}])", self.settings, self.runs(variant));
        text
    }

    /// The runs, with ranges in the units of the parameters.
    fn runs(&self, variant: &Variant) -> String {
        let mut out = String::new();
        for (k, part) in self.runs.split(['<', '>']).enumerate() {
            if k % 2 == 0 {
                out.push_str(part);
                continue;
            }
            let fields: Vec<&str> = part.split(' ').collect();
            let bound = |field: &str| field.parse::<f64>().expect("a bound") * variant.parameter;
            let (low, high) = (bound(fields[1]), bound(fields[2]));
            let _ = write!(out, "(name: \"q_{}\", low: {low:e}, high: {high:e})", fields[0]);
        }
        out
    }
}

/// A run of equilibria, one of the orbits from its Hopf point.
macro_rules! rest_and_cycles {
    ($range:literal) => {
        concat!(
            r#"(name: "rest", set: [("solution", "equilibrium")], along: ["#,
            $range,
            r#"]), (name: "cycles", start: From(run: "rest", kind: HB), along: ["#,
            $range,
            "])"
        )
    };
}

/// A run of equilibria.
macro_rules! rest {
    ($range:literal) => {
        concat!(r#"(name: "rest", set: [("solution", "equilibrium")], along: ["#, $range, "])")
    };
}

/// A run with default settings.
macro_rules! run {
    ($range:literal) => {
        concat!(r#"(name: "run", along: ["#, $range, "])")
    };
}

pub const MODELS: &[Stated] = &[
    Stated {
        name: "cusp",
        kind: "Equations",
        states: &[("x", "h + r*x - x^3")],
        parameters: &[("h", -1.0), ("r", 1.0)],
        initial: &[-1.3],
        further: "",
        range: 2.0,
        settings: "",
        runs: concat!(
            rest!("<h -1 1>"),
            r#", (name: "folds", hold: LP, set: [("solution", "equilibrium")], start: From(run: "rest", kind: LP),
                along: [<h -1 1>, <r -1 2>])"#
        ),
    },
    Stated {
        name: "pitchfork",
        kind: "Equations",
        states: &[("x", "r*x - x^3"), ("y", "x - y")],
        parameters: &[("r", -1.0)],
        initial: &[0.0, 0.0],
        further: "",
        range: 3.0,
        settings: "",
        runs: concat!(
            rest!("<r -1 2>"),
            r#", (name: "broken", set: [("solution", "equilibrium")],
                start: From(run: "rest", kind: BP, switch: true), along: [<r -1 2>])"#
        ),
    },
    Stated {
        name: "food chain",
        kind: "Equations",
        states: &[
            ("x", "x*(1 - x/K) - x*y/(x + 0.4)"),
            ("y", "y*(0.9*x/(x + 0.4) - 0.3 - z/(y + 0.5))"),
            ("z", "z*(0.4*y/(y + 0.5) - 0.3)"),
        ],
        parameters: &[("K", 0.1)],
        initial: &[0.1, 0.0, 0.0],
        further: "",
        range: 2.0,
        settings: "",
        runs: concat!(
            rest!("<K 0.05 2>"),
            r#", (name: "prey", set: [("solution", "equilibrium")],
                start: From(run: "rest", kind: BP, switch: true), along: [<K 0.05 2>])"#
        ),
    },
    Stated {
        name: "toggle switch",
        kind: "Equations",
        states: &[("x", "a/(1 + y^2) - x"), ("y", "a/(1 + x^2) - y")],
        parameters: &[("a", 1.0)],
        initial: &[0.7, 0.7],
        further: "",
        range: 4.0,
        settings: "",
        runs: concat!(
            rest!("<a 0.5 4>"),
            r#", (name: "switched", set: [("solution", "equilibrium")],
                start: From(run: "rest", kind: BP, switch: true), along: [<a 0.5 4>])"#
        ),
    },
    Stated {
        name: "Brusselator",
        kind: "Equations",
        states: &[("x", "1 - (b + 1)*x + x^2*y"), ("y", "b*x - x^2*y")],
        parameters: &[("b", 1.0)],
        initial: &[1.0, 1.0],
        further: "",
        range: 3.0,
        settings: "",
        runs: rest_and_cycles!("<b 1 3>"),
    },
    Stated {
        name: "Bautin",
        kind: "Equations",
        states: &[
            ("x", "mu*x - y + x*(x^2 + y^2) - x*(x^2 + y^2)^2"),
            ("y", "x + mu*y + y*(x^2 + y^2) - y*(x^2 + y^2)^2"),
        ],
        parameters: &[("mu", -0.5)],
        initial: &[0.0, 0.0],
        further: "",
        range: 1.0,
        settings: "",
        runs: rest_and_cycles!("<mu -0.5 0.5>"),
    },
    Stated {
        name: "Lorenz",
        kind: "Equations",
        states: &[("x", "10*(y - x)"), ("y", "x*(rho - z) - y"), ("z", "x*y - (8/3)*z")],
        parameters: &[("rho", 0.0)],
        initial: &[0.0, 0.0, 0.0],
        further: "",
        range: 30.0,
        settings: "max_step: 0.05",
        runs: concat!(
            rest!("<rho 0 30>"),
            r#", (name: "convection", set: [("solution", "equilibrium")],
                start: From(run: "rest", kind: BP, switch: true), along: [<rho 0 30>]),
                (name: "cycles", start: From(run: "convection", kind: HB), along: [<rho 20 30>])"#
        ),
    },
    Stated {
        name: "lure",
        kind: "Equations",
        states: &[("x", "y"), ("y", "z"), ("z", "x^2 - x - y - alpha*z")],
        parameters: &[("alpha", 1.2)],
        initial: &[0.0, 0.0, 0.0],
        further: "",
        range: 1.0,
        settings: "",
        runs: rest_and_cycles!("<alpha 0.7 1.5>"),
    },
    Stated {
        name: "Duffing",
        kind: "Equations",
        states: &[("x", "v"), ("v", "0.3*cos(omega*$t) - 0.1*v - x - x^3")],
        parameters: &[("omega", 0.6)],
        initial: &[0.5, 0.0],
        further: "period: \"$time*2*pi/omega\"",
        range: 2.0,
        settings: "",
        runs: r#"(name: "run", start: Simulated(transient: 100), along: [<omega 0.5 2.5>])"#,
    },
    Stated {
        name: "Henon",
        kind: "Map",
        states: &[("x", "1 - a*x^2 + y"), ("y", "0.3*x")],
        parameters: &[("a", 0.0)],
        initial: &[1.4, 0.4],
        further: "",
        range: 1.2,
        settings: "",
        runs: concat!(
            run!("<a -0.5 1.2>"),
            r#", (name: "doubled", start: From(run: "run", kind: PD, switch: true), along: [<a 0 1.2>])"#
        ),
    },
    Stated {
        name: "delayed logistic map",
        kind: "Map",
        states: &[("x", "a*x*(1 - y)"), ("y", "x")],
        parameters: &[("a", 1.5)],
        initial: &[0.33, 0.33],
        further: "",
        range: 1.5,
        settings: "",
        runs: run!("<a 0.5 2.5>"),
    },
    Stated {
        name: "elastica",
        kind: "Boundary",
        states: &[("u", "v"), ("v", "-lambda*sin(u)")],
        parameters: &[("lambda", 1.0)],
        initial: &[0.0, 0.0],
        further: r#"conditions: ["v(0)", "v(1)"]"#,
        range: 60.0,
        settings: "",
        runs: concat!(
            run!("<lambda 1 60>"),
            r#", (name: "bent", start: From(run: "run", kind: BP, switch: true), along: [<lambda 1 60>])"#
        ),
    },
    Stated {
        name: "Bratu",
        kind: "Residual",
        states: &[
            ("u1", "16*(u2 - 2*u1) + c*exp(u1)"),
            ("u2", "16*(u1 - 2*u2 + u3) + c*exp(u2)"),
            ("u3", "16*(u2 - 2*u3) + c*exp(u3)"),
        ],
        parameters: &[("c", 0.1)],
        initial: &[0.0, 0.0, 0.0],
        further: "dynamics: flow",
        range: 5.0,
        settings: "",
        runs: run!("<c 0.1 5>"),
    },
];
