//! Assembly of formulas into operations: resolves names, and inlines functions and sums.

use super::assembly::{Assembly, Origin, Undefined, Value};
use super::calls::Called;
use super::elements::{ELEMENTS, Elements, Indices};
use super::layout::Layout;
use super::operation::Operation;
use super::scope::{Definition, Function, Meaning, Scope};
use super::source::{Fault, ModelError, Phrase, Source};
use super::syntax::{Declared, Formula, Index, Node, Step, value_of};
use super::tape::Tape;
use std::fmt::Write;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// Limits on the number of values that are computed while formulas are assembled: the first limit
/// is for any model, and the second is the limit per state for a large model.
const WORK: [usize; 2] = [2_000_000, 150];
/// Limits on the number of operations on a tape (the list of operations that evaluates formulas):
/// the first limit is for any model, and the second is the limit per state for a large model.
const OPERATIONS: [usize; 2] = [300_000, 30];
/// Heuristic: after this number of invalid definitions of elements of an array, the remaining
/// elements get the same error.
const ERRORS: usize = 100;
/// Heuristic: the number of most recent phrases (parts of the text) with which a new phrase is
/// compared; a new phrase that equals one of them is not stored again.
const RECENT: usize = 8;
/// The maximum nesting depth of sums and functions.
const NESTED: usize = 300;
/// The maximum depth of nested function calls.
const CALLS: usize = 100;

/// The formulas of a scope while they are assembled into one tape (a list of operations).
pub(super) struct Assembling<'s> {
    scope: &'s Scope,
    assembly: Assembly,
    /// The values, or the errors, of the definitions that have been assembled so far, in order.
    defined: Vec<Result<Value, ModelError>>,
    /// Whether a definition is being assembled at present.
    defining: bool,
    /// Local names, such as the arguments of a function or the index of a sum, each with its value.
    locals: Vec<(Arc<str>, Value)>,
    frame: usize,
    calls: Vec<String>,
    depth: usize,
    work: usize,
    phrases: Vec<Phrase>,
    /// Whether formulas contain the states at the two ends of an interval, `x(0)` and `x(1)`.
    at_ends: bool,
}

impl<'s> Assembling<'s> {
    pub fn new(scope: &'s Scope) -> Self {
        Self::with(scope, false)
    }

    fn with(scope: &'s Scope, at_ends: bool) -> Self {
        Assembling {
            scope,
            assembly: Assembly::default(),
            defined: Vec::new(),
            defining: false,
            locals: Vec::new(),
            frame: 0,
            calls: Vec::new(),
            depth: 0,
            work: 0,
            phrases: Vec::new(),
            at_ends,
        }
    }

    /// Starts to assemble formulas that contain the states at both ends of an interval.
    pub fn at_ends(scope: &'s Scope) -> Self {
        Self::with(scope, true)
    }

    /// Returns the operations that have been assembled so far.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// Returns whether at least one of the given values depends on an input for which a predicate
    /// is true.
    pub fn depends(&self, values: &[Value], sort: impl Fn(Value) -> bool) -> bool {
        self.assembly.depends(values, sort)
    }

    /// Returns the value of a formula.
    pub fn formula(&mut self, formula: &Formula) -> Result<Value, ModelError> {
        let first = self.phrases.len().saturating_sub(RECENT);
        let known = self.phrases[first..].iter().position(|known| known.is(&formula.phrase));
        if known.is_none() {
            self.phrases.push(formula.phrase.clone());
        }
        let phrase = known.map_or(self.phrases.len() - 1, |known| first + known);
        self.nodes(&formula.nodes, phrase)
    }

    /// Returns the values of a formula for the given elements of an array.
    pub fn of_elements(
        &mut self,
        formula: &Formula,
        elements: &Elements,
    ) -> Result<Vec<Value>, ModelError> {
        let (count, mut values) = (elements.count(), Vec::with_capacity(elements.count()));
        for at in elements.values() {
            let before = self.assembly.len();
            values.push(self.indexed(formula, &at)?);
            // The second element is rarely next to a boundary, so that most elements have as many
            // operations as the second element.
            if values.len() == 2 {
                let all = (self.assembly.len() - before).saturating_mul(count - 2);
                self.assembly.reserve(all.min(most(OPERATIONS, self.scope.dimension)));
            }
        }
        Ok(values)
    }

    /// Returns the value of a formula for the given values of array indices.
    pub fn indexed(&mut self, formula: &Formula, at: &Indices) -> Result<Value, ModelError> {
        let depth = self.locals.len();
        self.locals.extend(at.iter().map(|(name, value)| (name.clone(), Value::number(*value))));
        let value = self.formula(formula);
        self.locals.truncate(depth);
        value
    }

    /// Parses and assembles a formula, and returns its value.
    pub fn read(&mut self, phrase: &Phrase) -> Result<Value, ModelError> {
        self.formula(&Formula::read(&self.scope.source, phrase)?)
    }

    /// Returns the error of the first definition or function that is invalid.
    pub fn check_named(&mut self) -> Result<(), ModelError> {
        self.errors_of_named().into_iter().flatten().next().map_or(Ok(()), Err)
    }

    /// Returns an entry for each definition and function: its error, or `None` if it is valid.
    /// Calls inside a function are resolved only where the function is called; this check covers
    /// only the names that occur in the function.
    pub fn errors_of_named(&mut self) -> Vec<Option<ModelError>> {
        self.define_all();
        let definitions = self.defined.iter().map(|value| value.clone().err());
        definitions.chain(self.scope.errors_of_functions()).collect()
    }

    /// Assembles all definitions.
    pub fn define_all(&mut self) {
        self.define(self.scope.definitions.len());
    }

    /// Assembles the first `count` definitions. If many elements of an array use an unknown name,
    /// the remaining elements get the same error.
    fn define(&mut self, count: usize) {
        let (depth, frame) = (std::mem::take(&mut self.depth), self.frame);
        let calls = std::mem::take(&mut self.calls);
        self.frame = self.locals.len();
        self.defining = true;
        let mut failed = 0;
        while self.defined.len() < count {
            let k = self.defined.len();
            let Definition { formula, element } = &self.scope.definitions[k];
            let last =
                k.checked_sub(1).filter(|last| self.scope.definitions[*last].formula == *formula);
            let known =
                last.map(|last| &self.defined[last]).filter(|it| it.is_err() && failed >= ERRORS);
            let value = match known {
                Some(error) => error.clone(),
                None => self.indexed(&self.scope.formulas[*formula], &element.at),
            };
            failed += usize::from(value.is_err());
            self.defined.push(value);
        }
        self.defining = false;
        (self.depth, self.frame, self.calls) = (depth, frame, calls);
    }

    /// Returns the tape (the list of operations) that computes the given values.
    pub fn tape(&self, results: &[Value]) -> Tape {
        Layout::of(&self.assembly, results).tape(results)
    }

    /// Returns the program that computes the given values.
    pub fn program(mut self, results: Vec<Value>) -> Program {
        let tape = self.tape(&results);
        self.assembly.complete();
        Program { tape, results, assembly: self.assembly, phrases: self.phrases }
    }

    fn nodes(&mut self, nodes: &[Node], phrase: usize) -> Result<Value, ModelError> {
        self.depth += 1;
        let value = self.steps(nodes, phrase);
        self.depth -= 1;
        value
    }

    fn steps(&mut self, nodes: &[Node], phrase: usize) -> Result<Value, ModelError> {
        let mut stack: Vec<Value> = Vec::new();
        for Node { step, place } in nodes {
            self.work += 1;
            let origin = &Origin { phrase, part: place.clone() };
            self.limit(origin)?;
            let begin = stack.len() - step.operands();
            let value = self.step(step, &stack[begin..], origin)?;
            stack.truncate(begin);
            stack.push(value);
        }
        Ok(stack.pop().unwrap_or(Value::number(0.0)))
    }

    /// Returns the value of one step of a formula in postfix order.
    fn step(
        &mut self,
        step: &Step,
        operands: &[Value],
        origin: &Origin,
    ) -> Result<Value, ModelError> {
        match step {
            Step::Number(digits) => Ok(Value::number(value_of(digits))),
            Step::Name(name) => self.name(name, origin),
            Step::Element(name, _) => self.name(&self.element(name, operands, origin)?, origin),
            Step::ElementAt(name, indices) => {
                let (indices, end) = operands.split_at(*indices);
                let element = self.element(name, indices, origin)?;
                self.call(&element, end, origin)
            }
            Step::Apply(operation) => Ok(self.assembly.apply(*operation, operands, origin)),
            Step::Call(function, _) => self.call(function, operands, origin),
            Step::Sum(index, body) => self.sum(index, [operands[0], operands[1]], body, origin),
        }
    }

    /// Returns the name of an element of an array.
    fn element(
        &self,
        array: &str,
        indices: &[Value],
        origin: &Origin,
    ) -> Result<String, ModelError> {
        let mut element = format!("{array}[");
        for (k, index) in indices.iter().enumerate() {
            let index = self.integer(*index, "the index", origin)?;
            // Writing into a string cannot fail.
            let _ = write!(element, "{}{index}", if k > 0 { "," } else { "" });
        }
        Ok(element + "]")
    }

    fn limit(&self, origin: &Origin) -> Result<(), ModelError> {
        let most = |limits| most(limits, self.scope.dimension);
        let limits = [
            (self.work, most(WORK), "steps to put a formula together"),
            (self.assembly.len(), most(OPERATIONS), "operations in a model"),
            (self.depth, NESTED, "nested sums and functions"),
        ];
        match limits.into_iter().find(|(count, limit, _)| count > limit) {
            Some((_, limit, what)) => Err(self.fault(origin, Fault::TooLarge { what, limit })),
            None => Ok(()),
        }
    }

    fn fault(&self, origin: &Origin, fault: Fault) -> ModelError {
        self.scope.source.fault(&self.phrases[origin.phrase], origin.part.clone(), fault)
    }

    fn integer(
        &self,
        value: Value,
        what: &'static str,
        origin: &Origin,
    ) -> Result<i64, ModelError> {
        integer_in(self.scope, value, what, &self.phrases[origin.phrase], origin.part.clone())
    }

    fn name(&mut self, name: &str, origin: &Origin) -> Result<Value, ModelError> {
        let local = self.locals[self.frame..].iter().rev().find(|(known, _)| **known == *name);
        if let Some((_, value)) = local {
            return Ok(*value);
        }
        if let Some(meaning) = self.scope.meaning(name) {
            if !matches!(meaning, Meaning::State(_)) && !self.scope.uses(name) {
                self.scope.used.borrow_mut().insert(name.to_string());
            }
            return match meaning {
                Meaning::State(_) if self.at_ends => Err(self.needs_end(name, origin)),
                Meaning::State(k) => Ok(Value::State(k as u32)),
                Meaning::Parameter(k) => Ok(Value::Parameter(k as u32)),
                Meaning::Time if self.at_ends => {
                    let reason = "boundary conditions hold at the two ends of the interval, 0 and \
                                  `length`, and cannot contain the time"
                        .into();
                    Err(self.fault(origin, Fault::Misplaced { what: "`t`".into(), reason }))
                }
                Meaning::Time => Ok(Value::Time),
                Meaning::Definition(k) => self.definition(name, k, origin),
            };
        }
        match name {
            "pi" => Ok(Value::number(std::f64::consts::PI)),
            "e" => Ok(Value::number(std::f64::consts::E)),
            _ => {
                let phrase = &self.phrases[origin.phrase];
                let state = name.split_once('\'').map(|(name, indices)| format!("{name}{indices}"));
                if state.is_some_and(|state| self.scope.is_state(&state)) {
                    return Err(self.misplaced_rate(name, origin));
                }
                Err(self.scope.unknown("name", name, phrase, origin.part.clone()))
            }
        }
    }

    /// Returns the error for a rate in a formula that is not a left-hand side of an equation.
    fn misplaced_rate(&self, name: &str, origin: &Origin) -> ModelError {
        let what = format!("the rate `{name}`");
        let reason = "rates occur only on the left-hand sides of equations".into();
        self.fault(origin, Fault::Misplaced { what, reason }).with_help(
            "only a `Residual` with `dynamics: flow` has equations with left-hand sides, such as \
             `2*x' + y' = f`; `=` separates the two sides",
        )
    }

    /// Returns the difference of two values that are computed from a formula.
    pub fn difference(&mut self, formula: &Formula, values: [Value; 2]) -> Value {
        let known = self.phrases.iter().position(|known| known.is(&formula.phrase));
        let part = 0..formula.phrase.text.len();
        let origin = Origin { phrase: known.unwrap_or(0), part };
        self.assembly.apply(Operation::Subtract, &values, &origin)
    }

    fn definition(&mut self, name: &str, k: usize, origin: &Origin) -> Result<Value, ModelError> {
        if !self.defining {
            self.define((k + 1).max(self.defined.len()));
        }
        // The definition may be under assembly, or follow later.
        self.defined.get(k).cloned().unwrap_or_else(|| {
            let by = &self.scope.definitions[self.defined.len()].element.name;
            let through =
                format!("`{by}` may use only the definitions before it, and `{name}` comes later");
            Err(self.fault(origin, Fault::Circular { name: name.into(), through }))
        })
    }

    fn call(
        &mut self,
        function: &str,
        arguments: &[Value],
        origin: &Origin,
    ) -> Result<Value, ModelError> {
        if let (true, Some(Meaning::State(k))) = (self.at_ends, self.scope.meaning(function)) {
            return self.at_end(function, k, arguments, origin);
        }
        let phrase = &self.phrases[origin.phrase];
        match self.scope.called(function, arguments.len(), phrase, &origin.part)? {
            Called::Own(own) => {
                if self.calls.iter().any(|name| name == function) || self.calls.len() >= CALLS {
                    let (name, through) = (function.into(), self.calls.join(", "));
                    return Err(self.fault(origin, Fault::Circular { name, through }));
                }
                self.inlined(function, own, arguments)
            }
            // The minimum and maximum of several values are reduced pair by pair.
            Called::BuiltIn(operation @ (Operation::Minimum | Operation::Maximum)) => {
                let mut others = arguments[1..].iter();
                let apply = |a, b: &Value| self.assembly.apply(operation, &[a, *b], origin);
                Ok(others.by_ref().fold(arguments[0], apply))
            }
            Called::BuiltIn(operation) => Ok(self.assembly.apply(operation, arguments, origin)),
            Called::State => {
                let phrase = &self.phrases[origin.phrase];
                Err(self.scope.unknown("function", function, phrase, origin.part.clone()))
            }
        }
    }

    /// Returns the value of a state at an end of the interval. In the numbering of states, the
    /// states at the end of the interval follow the states at the beginning.
    fn at_end(
        &self,
        name: &str,
        k: usize,
        arguments: &[Value],
        origin: &Origin,
    ) -> Result<Value, ModelError> {
        match arguments.iter().map(|value| value.as_number()).collect::<Vec<_>>()[..] {
            [Some(0.0)] => Ok(Value::State(k as u32)),
            [Some(1.0)] => Ok(Value::State((self.scope.dimension + k) as u32)),
            _ => Err(self.needs_end(name, origin)),
        }
    }

    /// Returns the error for a state that is named without an end of the interval.
    fn needs_end(&self, name: &str, origin: &Origin) -> ModelError {
        let expected = format!(
            "the value at one end: `{name}(0)` at the beginning or `{name}(1)` \
                                at the end"
        );
        self.fault(origin, Fault::Syntax { expected })
    }

    /// Returns the value of a function defined in the model.
    fn inlined(
        &mut self,
        name: &str,
        own: &Function,
        arguments: &[Value],
    ) -> Result<Value, ModelError> {
        let (frame, depth) = (self.frame, self.locals.len());
        self.frame = depth;
        self.locals.extend(own.arguments.iter().cloned().zip(arguments.iter().copied()));
        self.calls.push(name.to_string());
        let value = self.formula(&self.scope.formulas[own.formula]);
        self.calls.pop();
        self.locals.truncate(depth);
        self.frame = frame;
        value
    }

    fn sum(
        &mut self,
        index: &str,
        ends: [Value; 2],
        body: &[Node],
        origin: &Origin,
    ) -> Result<Value, ModelError> {
        let low = self.integer(ends[0], "the first index of a sum", origin)?;
        let high = self.integer(ends[1], "the last index of a sum", origin)?;
        let index: Arc<str> = index.into();
        if low > high {
            let seen = self.locals[self.frame..].iter().map(|(name, _)| name);
            let mut seen: Vec<Arc<str>> = seen.chain([&index]).cloned().collect();
            self.scope.check_nodes(body, &self.phrases[origin.phrase], &mut seen)?;
        }
        let mut total = None;
        for k in low..=high {
            self.work += 1;
            self.limit(origin)?;
            self.locals.push((index.clone(), Value::number(k as f64)));
            let term = self.nodes(body, origin.phrase);
            self.locals.pop();
            let term = term?;
            total = Some(match total {
                None => term,
                Some(total) => self.assembly.apply(Operation::Add, &[total, term], origin),
            });
        }
        Ok(total.unwrap_or(Value::number(0.0)))
    }
}

/// Returns the limit for a model with the given number of states, given the limit for any model and
/// the limit per state for a large model.
fn most([any, each]: [usize; 2], dimension: usize) -> usize {
    any.max(each * dimension)
}

/// Assembled formulas: their tape (a list of operations), and the position in the text of each
/// operation on the tape.
#[derive(Clone, Debug)]
pub(super) struct Program {
    tape: Tape,
    results: Vec<Value>,
    assembly: Assembly,
    phrases: Vec<Phrase>,
}

impl Deref for Program {
    type Target = Tape;

    fn deref(&self) -> &Tape {
        &self.tape
    }
}

impl Program {
    /// Returns the error of the first operation whose value is not finite at `(t, x, p)`, or `None`
    /// if all values are finite.
    pub fn undefined(
        &self,
        source: &Source,
        (t, x, p): (f64, &[f64], &[f64]),
    ) -> Option<ModelError> {
        let found = self.assembly.undefined(&self.results, t, x, p)?;
        let Undefined { operation, arguments, value, origin } = found;
        let what = match operation {
            Operation::Divide | Operation::Reciprocal => "a division by zero".to_string(),
            _ if value.is_nan() => "the result of an operation is not a number".into(),
            _ => "the result of an operation is not finite".into(),
        };
        let arguments: Vec<String> = arguments.iter().map(f64::to_string).collect();
        let values = match operation {
            Operation::Divide => arguments.join("/"),
            _ => format!("{} of {}", operation.name(), arguments.join(", ")),
        };
        let phrase = &self.phrases[origin.phrase];
        Some(source.fault(phrase, origin.part, Fault::Undefined { what, values }))
    }
}

/// Returns the elements that a name in a statement denotes: a scalar, or one or more elements of an
/// array.
pub(super) fn elements(scope: &Scope, phrase: &Phrase) -> Result<Elements, ModelError> {
    let Declared { name, indices } = Declared::read(&scope.source, phrase)?;
    if indices.is_empty() {
        return Ok(Elements::new(name, Vec::new()));
    }
    let mut whole = Assembling::new(scope);
    let mut integer = |formula: &Formula, what| {
        let value = whole.formula(formula)?;
        integer_in(scope, value, what, &formula.phrase, 0..formula.phrase.text.len())
    };
    let mut ranges: Vec<(Option<Arc<str>>, [i64; 2])> = Vec::new();
    for index in indices {
        ranges.push(match index {
            Index::One(formula) => (None, [integer(&formula, "the index")?; 2]),
            Index::Range(index, low, high) => {
                let low = integer(&low, "the first index")?;
                let high = integer(&high, "the last index")?;
                if low > high {
                    let what = format!("the range {low}..{high} of `{index}`");
                    let reason =
                        "the range is empty: the first index must not be above the last index"
                            .into();
                    return Err(scope.source.fault_of(phrase, Fault::Misplaced { what, reason }));
                }
                let known = |(known, _): &(Option<Arc<str>>, _)| known.as_deref() == Some(&*index);
                if ranges.iter().any(known) {
                    return Err(scope.source.twice(phrase, index, "an index"));
                }
                (Some(index.into()), [low, high])
            }
        });
    }
    let elements = Elements::new(name, ranges);
    if elements.count() > ELEMENTS {
        let fault = Fault::TooLarge { what: "elements of an array", limit: ELEMENTS };
        return Err(scope.source.fault_of(phrase, fault));
    }
    Ok(elements)
}

/// The largest index.
const LARGEST: f64 = 1e9;

/// Returns the integer value of an index; the index must be constant.
fn integer_in(
    scope: &Scope,
    value: Value,
    what: &'static str,
    phrase: &Phrase,
    part: Range<usize>,
) -> Result<i64, ModelError> {
    match value.as_number() {
        Some(number) if number.fract() == 0.0 && number.abs() <= LARGEST => Ok(number as i64),
        Some(number) if number.fract() == 0.0 => {
            let what = format!("{what}, {number}");
            let reason = format!("the index must be between -{LARGEST} and {LARGEST}");
            Err(scope.source.fault(phrase, part, Fault::Misplaced { what, reason }))
        }
        number => {
            let found = number.map_or(String::new(), |number| format!("; it is {number}"));
            Err(scope.source.fault(phrase, part, Fault::NotAnInteger { what, found }))
        }
    }
}
