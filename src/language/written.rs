//! Statements written as RON.

use super::Statement;
use super::source::Phrase;
use super::statement::{
    Boundary, Equations, FilippovEquations, Guard, HybridEquations, Map, Mode, Next, Residual,
    Static,
};
use std::fmt::Write;

/// The longest line of a list that is written in one.
const WIDTH: usize = 100;

impl Statement {
    /// It as RON, which reads as an equal statement.
    ///
    /// ```
    /// use tangency::language::{Model, Source, Statement, xpp};
    /// let read = xpp::read(&Source::new("decay.ode", "x'=-(k)*X\npar k=2\ninit x=1\n"))?;
    /// let ron = read.statement.ron();
    /// assert_eq!(ron, "\
    /// Equations(
    ///     states: [(\"x\", \"-k*x\")],
    ///     parameters: [(\"k\", 2)],
    ///     initial: [(\"x\", 1)],
    /// )
    /// ");
    /// let source = Source::new("decay.ron", ron);
    /// assert_eq!(Statement::read(&source, "Equations", &source.text[9..])?, read.statement);
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn ron(&self) -> String {
        let mut out = Writer::default();
        match self {
            Statement::Equations(stated) => equations(&mut out, stated),
            Statement::Residual(stated) => residual(&mut out, stated),
            Statement::Map(stated) => map(&mut out, stated),
            Statement::Boundary(stated) => boundary(&mut out, stated),
            Statement::HybridEquations(stated) => hybrid(&mut out, stated),
            Statement::FilippovEquations(stated) => filippov(&mut out, stated),
        }
        out.text
    }
}

/// Declares how a kind of statement is written: its own fields between those that all have.
macro_rules! common {
    ($out:ident, $stated:ident) => {
        $out.pairs("parameters", &$stated.parameters);
        $out.pairs("definitions", &$stated.definitions);
        let functions = $stated.functions.iter().map(|(name, arguments, formula)| {
            let arguments: Vec<String> = arguments.iter().map(quoted).collect();
            format!("({}, [{}], {})", quoted(name), arguments.join(", "), value(formula))
        });
        $out.list("functions", functions.collect());
        $out.pairs("monitors", &$stated.monitors);
        $out.pairs("initial", &$stated.initial);
    };
}

fn equations(out: &mut Writer, stated: &Equations) {
    out.open("Equations(");
    out.pairs("states", &stated.states);
    out.optional("period", stated.period.as_ref());
    common!(out, stated);
    out.pairs("scales", &stated.scales);
    out.close(")");
}

fn residual(out: &mut Writer, stated: &Residual) {
    out.open("Residual(");
    out.pairs("unknowns", &stated.unknowns);
    let dynamics = match stated.dynamics {
        Static::None => None,
        Static::Flow => Some("flow"),
        Static::Potential => Some("potential"),
        Static::SecondOrder => Some("second_order"),
    };
    if let Some(dynamics) = dynamics {
        out.line(&format!("dynamics: {dynamics},"));
    }
    common!(out, stated);
    out.pairs("scales", &stated.scales);
    out.close(")");
}

fn map(out: &mut Writer, stated: &Map) {
    out.open("Map(");
    out.pairs("states", &stated.states);
    common!(out, stated);
    out.pairs("scales", &stated.scales);
    out.close(")");
}

fn boundary(out: &mut Writer, stated: &Boundary) {
    out.open("Boundary(");
    out.pairs("states", &stated.states);
    out.list("conditions", stated.conditions.iter().map(value).collect());
    out.list("integrals", stated.integrals.iter().map(value).collect());
    out.list("unknowns", stated.unknowns.iter().map(quoted).collect());
    out.optional("length", stated.length.as_ref());
    common!(out, stated);
    out.pairs("scales", &stated.scales);
    out.close(")");
}

fn hybrid(out: &mut Writer, stated: &HybridEquations) {
    out.open("HybridEquations(");
    out.pairs("states", &stated.states);
    modes(out, "modes: [", &stated.modes);
    if !stated.product.is_empty() {
        out.open("product: [");
        stated.product.iter().for_each(|part| modes(out, "[", part));
        out.close("],");
    }
    out.open("guards: [");
    for each in &stated.guards {
        guard(out, each);
    }
    out.close("],");
    out.optional("period", stated.period.as_ref());
    common!(out, stated);
    out.pairs("scales", &stated.scales);
    out.close(")");
}

fn modes(out: &mut Writer, begin: &str, modes: &[Mode]) {
    out.open(begin);
    for Mode { name, states, definitions } in modes {
        out.open("(");
        out.line(&format!("name: {},", quoted(name)));
        out.pairs("states", states);
        out.pairs("definitions", definitions);
        out.close("),");
    }
    out.close("],");
}

fn filippov(out: &mut Writer, stated: &FilippovEquations) {
    out.open("FilippovEquations(");
    out.pairs("above", &stated.above);
    out.pairs("below", &stated.below);
    out.optional("surface", stated.surface.as_ref());
    out.pairs("sliding", &stated.sliding);
    out.pairs("holds", &stated.holds);
    out.pairs("names", &stated.names);
    out.optional("period", stated.period.as_ref());
    common!(out, stated);
    out.pairs("scales", &stated.scales);
    out.close(")");
}

fn guard(out: &mut Writer, stated: &Guard) {
    let Guard { name, modes, function, at, next, reset, accumulates_to, changes_in } = stated;
    out.open("(");
    out.line(&format!("name: {},", quoted(name)));
    out.list("modes", modes.iter().map(quoted).collect());
    out.optional("function", function.as_ref());
    out.optional("at", at.as_ref());
    following(out, "next", next);
    out.pairs("reset", reset);
    following(out, "accumulates_to", accumulates_to);
    out.optional("changes_in", changes_in.as_ref());
    out.close("),");
}

/// The modes that may follow.
fn following(out: &mut Writer, name: &str, Next(choices): &Next) {
    match &choices[..] {
        [(mode, None)] => out.line(&format!("{name}: {},", quoted(mode))),
        choices => {
            let choice = |(mode, function): &(Phrase, Option<Phrase>)| match function {
                Some(function) => format!("({}, {})", quoted(mode), value(function)),
                None => quoted(mode),
            };
            out.list(name, choices.iter().map(choice).collect());
        }
    }
}

/// A text in quotes.
fn quoted(phrase: &Phrase) -> String {
    let mut text = String::from("\"");
    for letter in phrase.text.chars() {
        match letter {
            '"' | '\\' => {
                text.push('\\');
                text.push(letter);
            }
            '\n' => text.push_str("\\n"),
            '\r' => text.push_str("\\r"),
            '\t' => text.push_str("\\t"),
            letter if letter.is_control() => {
                let _ = write!(text, "\\u{{{:x}}}", letter as u32);
            }
            letter => text.push(letter),
        }
    }
    text.push('"');
    text
}

/// A formula: a whole number stands for itself.
fn value(phrase: &Phrase) -> String {
    let same = |number: i32| number.to_string() == phrase.text;
    match phrase.text.parse().is_ok_and(same) {
        true => phrase.text.clone(),
        false => quoted(phrase),
    }
}

/// A text that grows line by line.
#[derive(Default)]
struct Writer {
    text: String,
    depth: usize,
}

impl Writer {
    fn line(&mut self, line: &str) {
        self.text.push_str(&"    ".repeat(self.depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn open(&mut self, line: &str) {
        self.line(line);
        self.depth += 1;
    }

    fn close(&mut self, line: &str) {
        self.depth -= 1;
        self.line(line);
    }

    /// A list, in one line if it is short; nothing if it has no items.
    fn list(&mut self, name: &str, items: Vec<String>) {
        if items.is_empty() {
            return;
        }
        let line = format!("{name}: [{}],", items.join(", "));
        if line.len() + 4 * self.depth <= WIDTH {
            return self.line(&line);
        }
        self.open(&format!("{name}: ["));
        for item in items {
            self.line(&format!("{item},"));
        }
        self.close("],");
    }

    fn pairs(&mut self, name: &str, pairs: &[(Phrase, Phrase)]) {
        self.list(name, written(pairs));
    }

    fn optional(&mut self, name: &str, phrase: Option<&Phrase>) {
        if let Some(phrase) = phrase {
            self.line(&format!("{name}: {},", value(phrase)));
        }
    }
}

/// Names with formulas.
fn written(pairs: &[(Phrase, Phrase)]) -> Vec<String> {
    let pair =
        |(name, formula): &(Phrase, Phrase)| format!("({}, {})", quoted(name), value(formula));
    pairs.iter().map(pair).collect()
}
