//! The common part of all kinds of models: parameters, definitions, functions and monitors.

use super::assembling::{Assembling, Program, elements};
use super::assembly::Value;
use super::duration::Duration;
use super::elements::{ELEMENTS, Elements};
use super::scope::{Meaning, Scope};
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{Common, Formulas};
use super::syntax::{Declared, Formula};
use super::tape::Tape;
use crate::core::hybrid::Scales;
use crate::core::problem::{Group, Measure, Names, UnknownName, distinct};
use crate::core::scalar::Scalar;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// The parts that models of every kind contain.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    pub source: Source,
    pub parameters: Vec<String>,
    /// The default values of the first parameters; the remaining parameters do not have default
    /// values.
    pub defaults: Vec<f64>,
    /// The states of the initial mode; for a zero problem, the unknowns.
    pub states: Vec<String>,
    /// The states grouped by name: an array of states is one group.
    pub groups: Vec<Group>,
    /// The names of the states whose initial values are stated, and the formulas of these initial
    /// values.
    pub initial: (Vec<String>, Tape),
    /// The names of parameters that no formula uses.
    pub unused: Vec<String>,
    /// The names of definitions, each with its line in the text.
    pub definitions: Vec<(String, String)>,
    /// The names of monitors, each with a formula for every mode.
    pub monitors: Vec<(String, Vec<Tape>)>,
    /// The measures that are recorded by default during a motion.
    pub measures: Vec<(String, Measure)>,
    /// The period of a periodic forcing; for a boundary-value problem, the length of the interval.
    pub duration: Duration,
    /// Whether formulas depend on time although no period is stated.
    pub aperiodic: bool,
    /// Typical sizes of the states, in the order of the states; empty if no sizes are stated.
    pub sizes: Vec<f64>,
    /// The typical sizes of all states and of time.
    pub scales: Scales,
    /// The names of columns and the labels of the axes that show these columns.
    pub labels: Vec<(String, String)>,
}

/// The functions that a problem given as text provides in addition to the traits of the core.
pub(super) trait Kind {
    fn basis(&self) -> &Basis;

    /// Returns the error of the first formula whose value is not finite at `(0, x, p)`, or `None`
    /// if all values are finite.
    fn undefined(&self, _x: &[f64], _p: &[f64]) -> Option<ModelError> {
        None
    }

    /// Returns the initial states of a motion; for a boundary-value problem, returns the values of
    /// the initial profiles at the position `tau`, in units of the interval's length.
    fn initial_along(&self, _tau: f64, p: &[f64]) -> Vec<(String, f64)> {
        self.basis().initial_at(0.0, p)
    }

    /// Returns the names of the guards whose functions are discontinuous.
    fn jumping_guards(&self) -> Vec<&str> {
        Vec::new()
    }

    /// Returns whether an equation of motion contains `if` or a discontinuous function.
    fn may_jump(&self) -> bool {
        false
    }
}

/// Evaluates a formula without names, such as `8/3` or `2*pi`.
///
/// # Errors
/// [`ModelError`] if the formula is invalid.
///
/// ```
/// use tangency::language::number;
/// assert_eq!(number("8/3")?, 8.0 / 3.0);
/// assert!(number("8/x").is_err());
/// # Ok::<(), tangency::language::ModelError>(())
/// ```
pub fn number(text: &str) -> Result<f64, ModelError> {
    let source = Source::new("", text);
    let phrase = source.phrase(0..text.len());
    constant(&Scope::new(source.clone()), &phrase).map_err(|error| match tail_of(text) {
        None => error,
        Some(tail) => {
            let expected = "an operator, as in `2*pi`, or the end of the number: a number is \
                            written without a unit (1.5 µm is 1.5e-6 in metres), and its decimal \
                            sign is a point";
            source.fault(&phrase, tail..text.len(), Fault::Syntax { expected: expected.into() })
        }
    })
}

/// Returns where a unit, or the decimal digits after a comma, begin in a text that begins with a
/// number; `None` for other texts.
fn tail_of(text: &str) -> Option<usize> {
    let ends = text.char_indices().map(|(at, _)| at).rev();
    let end = ends.into_iter().find(|end| text[..*end].parse::<f64>().is_ok())?;
    let tail = text[end..].trim_start();
    let is_unit = tail.starts_with(|letter: char| letter.is_alphabetic() || letter == '%');
    let is_comma = tail.starts_with(',');
    (is_unit || is_comma).then_some(text.len() - tail.len())
}

/// Evaluates a formula that must not depend on states, parameters or time.
pub(super) fn constant(scope: &Scope, phrase: &Phrase) -> Result<f64, ModelError> {
    let value = Assembling::new(scope).read(phrase)?;
    value.as_number().filter(|value| value.is_finite()).ok_or_else(|| {
        let (what, reason) = (
            format!("`{}`", phrase.text),
            "the value must be a finite number that does not depend \
                                            on states, parameters or time"
                .into(),
        );
        scope.source.fault_of(phrase, Fault::Misplaced { what, reason })
    })
}

impl Basis {
    /// Collects the parameters of a statement of equations, and the names of the parameters to
    /// which a scene gives values.
    pub fn of(source: &Source, common: Common, given: &[String]) -> Result<Self, ModelError> {
        let scope = Scope::new(source.clone());
        let (mut parameters, mut defaults) = (Vec::new(), Vec::new());
        for (name, value) in common.parameters {
            parameters.push(Declared::plain(source, name)?);
            defaults.push(constant(&scope, value)?);
        }
        for name in given {
            if !parameters.contains(name) {
                parameters.push(name.clone());
            }
        }
        let line = |name: &Phrase| source.line_of(name).unwrap_or_default();
        let definitions = common.definitions.iter();
        let definitions = definitions.map(|(name, _)| (name.text.clone(), line(name))).collect();
        let source = source.clone();
        Ok(Basis { source, parameters, defaults, definitions, ..Basis::default() })
    }

    /// Assembles the first parts of a statement without modes and events: the names, the initial
    /// states, and the rates of the states.
    pub fn of_rates(
        source: &Source,
        common: Common,
        (states, what): (&Formulas, &str),
        given: &[String],
    ) -> Result<(Self, Scope, Vec<Stated>), ModelError> {
        let mut basis = Basis::of(source, common, given)?;
        let states = states_of(&basis, common, states, what)?;
        let scope = basis.scope(common, &states)?;
        basis.begin(common, &scope)?;
        basis.states = names_of(&states);
        Ok((basis, scope, states))
    }

    /// Assembles the parts of a model that do not depend on the kind of its equations: the
    /// monitors, the sizes of states, and, for systems with events, the size of time. The formulas
    /// are assembled in the scopes of all modes.
    pub fn finish(
        &mut self,
        common: Common,
        scopes: &[&Scope],
        duration: Duration,
        events: bool,
    ) -> Result<(), ModelError> {
        self.monitors = monitors_of(scopes, common.monitors)?;
        let unused = |name: &&String| !scopes.iter().any(|scope| scope.uses(name));
        self.unused = self.parameters.iter().filter(unused).cloned().collect();
        self.aperiodic = duration.is_none() && scopes.iter().any(|scope| scope.uses("t"));
        self.duration = duration;
        let all = distinct(scopes.iter().flat_map(|scope| scope.states()));
        let all: Vec<String> = all.into_iter().map(String::from).collect();
        self.groups = Group::of_states(&self.states);
        self.measures = measures(&all, self.monitor_names());
        self.labels = labels_of(self, common, &all)?;
        let sizes = scales_of(scopes[0], common.scales, &all, events)?;
        let time = sizes.get("t").copied().filter(|_| events);
        let sized = |state: String| Some((state.clone(), *sizes.get(&state)?));
        self.set_scales(Scales { time, states: all.into_iter().filter_map(sized).collect() });
        Ok(())
    }

    /// Sets the typical sizes of states and of time.
    pub fn set_scales(&mut self, scales: Scales) {
        let sizes: HashMap<&str, f64> =
            scales.states.iter().map(|(state, size)| (&state[..], *size)).collect();
        let size = |state: &String| sizes.get(&state[..]).copied().unwrap_or(1.0);
        self.sizes = match sizes.is_empty() {
            true => Vec::new(),
            false => self.states.iter().map(size).collect(),
        };
        self.scales = scales;
    }

    pub fn monitor_names(&self) -> Vec<String> {
        self.monitors.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Returns the names of states, parameters and monitors of a problem without modes.
    pub fn names(&self) -> Names {
        let names = Names::new(self.groups.clone(), self.parameters.clone());
        names.with_monitors(self.monitor_names())
    }

    /// Returns the value of a monitor in a given mode.
    pub fn monitor<T: Scalar>(&self, monitor: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.monitors[monitor].1[mode].value(t, x, p)
    }

    /// Returns the scope in which formulas are assembled: the names of states, parameters,
    /// definitions and functions.
    pub fn scope(&self, common: Common, states: &[Stated]) -> Result<Scope, ModelError> {
        let mut scope = Scope::new(self.source.clone());
        for (k, name) in self.parameters.iter().enumerate() {
            let phrase = common
                .parameters
                .get(k)
                .map_or_else(|| name.as_str().into(), |(name, _)| name.clone());
            scope.declare(&phrase, name, Meaning::Parameter(k))?;
        }
        let names = states.iter().flat_map(|it| it.elements.names().map(|name| (&it.phrase, name)));
        for (k, (phrase, name)) in names.enumerate() {
            scope.declare(phrase, &name, Meaning::State(k))?;
        }
        scope.declare(&"t".into(), "t", Meaning::Time)?;
        for (name, arguments, formula) in common.functions {
            scope.function(name, arguments, formula)?;
        }
        for (name, formula) in common.definitions {
            let elements = elements(&scope, name)?;
            scope.define(name, &elements, formula)?;
        }
        Ok(scope)
    }

    /// Sets the formulas of the initial values of the states in a scope.
    pub fn begin(&mut self, common: Common, scope: &Scope) -> Result<(), ModelError> {
        let reason = "initial values may depend on parameters only";
        self.start(common, scope, reason, Value::is_parameter)
    }

    /// Sets the formulas of the initial profiles, which may depend on time, of the states in a
    /// scope.
    pub fn begin_along(&mut self, common: Common, scope: &Scope) -> Result<(), ModelError> {
        let reason = "initial profiles may depend on time and on parameters only";
        self.start(common, scope, reason, |input| input.is_parameter() || input == Value::Time)
    }

    fn start(
        &mut self,
        common: Common,
        scope: &Scope,
        reason: &str,
        allowed: impl Fn(Value) -> bool,
    ) -> Result<(), ModelError> {
        let (mut assembling, mut known) = (Assembling::new(scope), HashSet::new());
        let (mut states, mut values) = (Vec::new(), Vec::new());
        for (name, value) in common.initial {
            let (elements, formula) =
                (elements_of(scope, name, scope.states())?, Formula::read(&scope.source, value)?);
            for element in elements.names() {
                self.require_unknown(scope, name, &element)?;
                if !known.insert(element.clone()) {
                    return Err(scope.source.twice(name, element, "given a value"));
                }
                states.push(element);
            }
            let own = assembling.of_elements(&formula, &elements)?;
            if assembling.depends(&own, |input| !allowed(input)) {
                let (what, reason) = (format!("`{}`", formula.phrase.text), reason.into());
                let fault = Fault::Misplaced { what, reason };
                return Err(scope.source.fault_of(&formula.phrase, fault));
            }
            values.extend(own);
        }
        self.initial = (states, assembling.tape(&values));
        Ok(())
    }

    /// Returns an error if a name denotes neither a state nor an additional unknown number, which
    /// follows the parameters.
    fn require_unknown(
        &self,
        scope: &Scope,
        phrase: &Phrase,
        name: &str,
    ) -> Result<(), ModelError> {
        let fault = match scope.meaning(name) {
            Some(Meaning::State(_)) => return Ok(()),
            Some(Meaning::Parameter(k)) if k >= self.parameters.len() => return Ok(()),
            Some(other) => {
                let what = format!("`{name}` is {}", other.words());
                Fault::Misplaced {
                    what,
                    reason: "only states and further unknowns have initial values".into(),
                }
            }
            None => {
                let is_unknown = |name: &&str| match scope.meaning(name) {
                    Some(Meaning::State(_)) => true,
                    Some(Meaning::Parameter(k)) => k >= self.parameters.len(),
                    _ => false,
                };
                let unknowns = scope.names().filter(is_unknown);
                Fault::Unknown(UnknownName::new("state", name, unknowns))
            }
        };
        Err(scope.source.fault_of(phrase, fault))
    }

    /// Returns the initial values of the states at a given time, for given parameters.
    pub fn initial_at(&self, t: f64, p: &[f64]) -> Vec<(String, f64)> {
        let (states, tape) = &self.initial;
        let mut values = vec![0.0; states.len()];
        tape.evaluate(t, &[], p, &mut values);
        states.iter().cloned().zip(values).collect()
    }
}

/// A state or an array of states, with the formula of its rate of change.
pub(super) struct Stated {
    pub phrase: Phrase,
    pub elements: Elements,
    pub formula: Formula,
}

/// Returns the names of all states that the statement of a problem declares.
pub(super) fn names_of(states: &[Stated]) -> Vec<String> {
    states.iter().flat_map(|stated| stated.elements.names()).collect()
}

/// Returns the states of a statement with the formulas of their rates of change.
pub(super) fn states_of(
    basis: &Basis,
    common: Common,
    states: &Formulas,
    what: &str,
) -> Result<Vec<Stated>, ModelError> {
    if states.is_empty() {
        let needed = format!("state at least one {what}");
        let fault = Fault::Missing { what: "the equations are missing".into(), needed };
        return Err(basis.source.fault_of(&Phrase::default(), fault));
    }
    // Ends of arrays may be definitions that are constant.
    let ends = ends_of(basis, common);
    let (mut all, mut count) = (Vec::new(), 0);
    for (phrase, rate) in states {
        let formula = Formula::read(&basis.source, rate)?;
        let elements = elements(&ends, phrase)?;
        count += elements.count();
        if count > ELEMENTS {
            let fault = Fault::TooLarge { what: "states", limit: ELEMENTS };
            return Err(basis.source.fault_of(phrase, fault));
        }
        all.push(Stated { phrase: phrase.clone(), elements, formula });
    }
    Ok(all)
}

/// Returns a scope that contains the constant definitions, which may be used in the index ranges of
/// arrays.
fn ends_of(basis: &Basis, common: Common) -> Scope {
    let mut scope = Scope::new(basis.source.clone());
    for (k, name) in basis.parameters.iter().enumerate() {
        let _ = scope.declare(&name.as_str().into(), name, Meaning::Parameter(k));
    }
    for (name, formula) in common.definitions {
        // Errors in these names are reported once all names are known.
        if let Ok(elements) = elements(&scope, name) {
            let _ = scope.define(name, &elements, formula);
        }
    }
    scope
}

/// Returns the program that computes the rates of change of all states.
pub(super) fn program_of(scope: &Scope, rates: &[Stated]) -> Result<Program, ModelError> {
    let mut assembling = Assembling::new(scope);
    let values = values_of(&mut assembling, rates)?;
    Ok(assembling.program(values))
}

/// Returns the values of the rates of change of all states.
pub(super) fn values_of(
    assembling: &mut Assembling,
    rates: &[Stated],
) -> Result<Vec<Value>, ModelError> {
    assembling.define_all();
    let mut values = Vec::new();
    for Stated { elements, formula, .. } in rates {
        values.extend(assembling.of_elements(formula, elements)?);
    }
    Ok(values)
}

/// Returns the names of the monitors, each with a formula for every scope.
fn monitors_of(
    scopes: &[&Scope],
    monitors: &Formulas,
) -> Result<Vec<(String, Vec<Tape>)>, ModelError> {
    let mut all: Vec<(String, Vec<Tape>)> = Vec::new();
    for (name, formula) in monitors {
        let source = &scopes[0].source;
        let called = Declared::plain(source, name)?;
        let first = match all.iter().any(|(known, _)| *known == called) {
            true => Some("a monitor"),
            false => scopes.iter().find_map(|scope| scope.meaning(&called)).map(Meaning::words),
        };
        if let Some(first) = first {
            return Err(source.twice(name, called, first));
        }
        let tape = |scope: &&Scope| tape_of(scope, formula);
        all.push((called, scopes.iter().map(tape).collect::<Result<_, _>>()?));
    }
    Ok(all)
}

/// Returns the tape that computes a formula.
pub(super) fn tape_of(scope: &Scope, formula: &Phrase) -> Result<Tape, ModelError> {
    let mut assembling = Assembling::new(scope);
    let value = assembling.read(formula)?;
    Ok(assembling.tape(&[value]))
}

/// The maximum length of an array for which the extremes of each element are recorded.
const SINGLE: usize = 10;

/// Returns the indices of the states that are recorded individually, and the long arrays with the
/// names of their norms.
pub(super) fn recorded(states: &[String]) -> (Vec<usize>, Vec<(String, Range<usize>)>) {
    fn array(name: &str) -> &str {
        name.split_once('[').map_or(name, |(array, _)| array)
    }
    let (mut single, mut arrays, mut start) = (Vec::new(), Vec::new(), 0);
    for elements in states.chunk_by(|a, b| array(a) == array(b)) {
        let all = start..start + elements.len();
        start = all.end;
        match elements.len() > SINGLE {
            true => arrays.push((format!("norm_{}", array(&elements[0])), all)),
            false => single.extend(all),
        }
    }
    (single, arrays)
}

/// Returns the measures that are recorded by default: the same measures as for other problems,
/// except that for a long array only its norm is recorded.
fn measures(states: &[String], monitors: Vec<String>) -> Vec<(String, Measure)> {
    let (single, arrays) = recorded(states);
    let norms = arrays.into_iter().map(|(name, all)| (name, Measure::norm(states[all].to_vec())));
    let single = single.into_iter().map(|k| states[k].clone()).collect();
    norms.chain(Measure::by_default(single, monitors)).collect()
}

/// Returns the axis labels of columns. The label is stated in the model or, if no label is stated,
/// the name of the column; the unit follows in both cases. The column `period` has the unit of
/// time, and the columns of the extremes of a state have the label and the unit of the state.
fn labels_of(
    basis: &Basis,
    common: Common,
    states: &[String],
) -> Result<Vec<(String, String)>, ModelError> {
    let monitors = basis.monitor_names();
    let known = || states.iter().chain(&basis.parameters).chain(&monitors).map(String::as_str);
    let mut names: Vec<&Phrase> = Vec::new();
    for list in [common.labels, common.units] {
        for (k, (name, words)) in list.iter().enumerate() {
            if words.text.trim().is_empty() || words.text.contains(char::is_control) {
                let what = format!("the label or unit of `{}`", name.text);
                let reason = "a label or unit must not be empty and must not contain control \
                              characters"
                    .into();
                return Err(basis.source.fault_of(words, Fault::Misplaced { what, reason }));
            }
            let all: Vec<&str> = known().chain(["t"]).collect();
            crate::core::problem::position("state, parameter or monitor", &name.text, all)
                .map_err(|unknown| basis.source.fault_of(name, Fault::Unknown(unknown)))?;
            if list[..k].iter().any(|(other, _)| other.text == name.text) {
                let (what, reason) = (
                    format!("`{}`", name.text),
                    "the label or unit of this quantity is given twice".into(),
                );
                return Err(basis.source.fault_of(name, Fault::Misplaced { what, reason }));
            }
            if names.iter().all(|other| other.text != name.text) {
                names.push(name);
            }
        }
    }
    let stated = |list: &Formulas, name: &str| {
        list.iter().find(|(known, _)| known.text == name).map(|(_, text)| text.text.clone())
    };
    let mut labels = Vec::new();
    for Phrase { text: name, .. } in names {
        let (label, unit) = (stated(common.labels, name), stated(common.units, name));
        let unit = unit.map_or(String::new(), |unit| format!(" ({unit})"));
        // An existing column with this name has its own label.
        let is_real = |column: &str| column != name && known().any(|known| known == column);
        let mut add = |column: String, usual: String, before: &str| {
            if is_real(&column) {
                return;
            }
            let label = label.as_ref().map_or(usual, |label| format!("{before}{label}"));
            labels.push((column, format!("{label}{unit}")));
        };
        if name == "t" {
            add("time".into(), "time".into(), "");
            if !is_real("period") {
                labels.push(("period".into(), format!("period{unit}")));
            }
            continue;
        }
        add(name.clone(), name.clone(), "");
        if states.contains(name) || monitors.contains(name) {
            add(format!("max_{name}"), format!("max_{name}"), "largest ");
            add(format!("min_{name}"), format!("min_{name}"), "smallest ");
        }
    }
    Ok(labels)
}

/// Returns the elements that a name denotes in `initial` and `scales`: a state, elements of an
/// array selected by indices, or a whole array.
fn elements_of<'s>(
    scope: &Scope,
    phrase: &Phrase,
    states: impl IntoIterator<Item = &'s String>,
) -> Result<Elements, ModelError> {
    let named = elements(scope, phrase)?;
    let whole = named.of_array(states);
    Ok(whole.unwrap_or(named))
}

/// Returns the typical sizes of the states, and of time for systems with events; empty if all sizes
/// are 1. If several sizes are given for an element, the first size is used.
fn scales_of(
    scope: &Scope,
    scales: &Formulas,
    states: &[String],
    time: bool,
) -> Result<HashMap<String, f64>, ModelError> {
    let source = &scope.source;
    let known: HashSet<&str> =
        states.iter().map(String::as_str).chain(time.then_some("t")).collect();
    let mut all = HashMap::new();
    for (name, value) in scales {
        let own: Vec<String> = elements_of(scope, name, states)?.names().collect();
        if let Some(unknown) = own.iter().find(|state| !known.contains(state.as_str())) {
            let known = states.iter().map(String::as_str).chain(time.then_some("t"));
            let unknown = UnknownName::new("state", unknown, known);
            return Err(source.fault_of(name, Fault::Unknown(unknown)));
        }
        let size = constant(&Scope::new(source.clone()), value)?;
        if size <= 0.0 || scales.iter().filter(|(known, _)| known.text == name.text).count() > 1 {
            let (what, reason) = (
                format!("the scale of `{}`", name.text),
                "a scale must be a number above 0, and may be given only once".into(),
            );
            return Err(source.fault_of(value, Fault::Misplaced { what, reason }));
        }
        for state in own {
            all.entry(state).or_insert(size);
        }
    }
    Ok(all)
}
