//! The contents of an XPPAUT file, line by line, before names are resolved.

use super::super::source::{ModelError, Source};
use super::command::{REFUSED, arguments_of, no_formula, refuse_calls, values_of};
use super::global::Global;
use super::lines;
use super::option::{Found, number};
use super::origin::{Named, Slice, Text};
use std::ops::ControlFlow;

/// A function defined in the file: its name, its arguments and its formula.
pub(super) struct Function {
    pub named: Named,
    pub arguments: Vec<Text>,
}

/// The kind of a constant: a parameter, a number, or a formula of other constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sort {
    Parameter,
    Number,
    Derived,
}

/// All contents of an XPPAUT file, in the order of the lines of the file.
#[derive(Default)]
pub(super) struct Parts {
    /// The states, each with the formula of its rate or, for a map, of its next value.
    pub states: Vec<Named>,
    /// Whether the formulas of the states give the next values of the states instead of their
    /// rates, so that the file describes a map.
    pub is_map: bool,
    pub constants: Vec<(Sort, Named)>,
    pub fixed: Vec<Named>,
    pub functions: Vec<Function>,
    pub monitors: Vec<Named>,
    pub initial: Vec<Named>,
    /// The initial values of array elements, where these values are given as formulas.
    pub initial_formulas: Vec<Named>,
    pub globals: Vec<Global>,
    pub found: Found,
}

impl Parts {
    /// Parses all lines of an XPPAUT file.
    pub fn read(source: &Source) -> Result<Parts, ModelError> {
        let mut parts = Parts::default();
        lines::for_each(source, &mut |line, array| parts.line(source, line.all(), array))?;
        parts.is_map |= parts.found.discrete;
        Ok(parts)
    }

    fn line(
        &mut self,
        source: &Source,
        line: Slice,
        array: bool,
    ) -> Result<ControlFlow<()>, ModelError> {
        let go_on = Ok(ControlFlow::Continue(()));
        if line.text.starts_with('@') {
            self.found.read(source, line.from(1))?;
            return go_on;
        }
        let line = line.trim();
        if line.text.starts_with("#include") {
            return Err(line
                .part(0..8)
                .unsupported(source, "`#include`", "all equations of the model must be in one file")
                .with_help("copy the contents of the other file into this file"));
        }
        if line.text.is_empty() || line.text.starts_with(['#', '"']) {
            return go_on;
        }
        refuse_calls(source, line)?;
        let Some((head, letter, rest)) = line.split(&[' ', '\t', '=', '/', '\'', '(']) else {
            // The line is `done`.
            return match line.text.as_bytes()[0] {
                b'd' | b'D' => Ok(ControlFlow::Break(())),
                b'0'..=b'9' => {
                    let reason = "lines of the old form begin with numbers";
                    Err(line
                        .unsupported(source, "the old form of files", reason)
                        .with_help("convert the file with `xppaut -convert`"))
                }
                _ => Err(line.expected(source, "a statement, as in `x'=-x`")),
            };
        };
        let blank = letter == ' ' || letter == '\t';
        let (behind, formula) = (rest.trim(), |rest: Slice| rest.trim().to_text());
        match letter {
            _ if blank && !behind.text.starts_with('=') => {
                return self.command(source, head, behind);
            }
            '/' => self.rate(source, line)?,
            '\'' => {
                let Some(rate) = behind.text.strip_prefix('=') else {
                    return Err(rest.expected(source, "`=`, as in `x'=-x`"));
                };
                let rate = behind.from(behind.text.len() - rate.len());
                self.states.push(Named { name: head.to_text(), formula: formula(rate) });
            }
            '(' => self.bracket(source, line, head, array)?,
            _ => {
                let value = if blank { behind.from(1) } else { rest };
                self.assignment(source, head, value)?;
            }
        }
        go_on
    }

    /// Parses a line of the form `name = formula`, `!name = formula` or `0 = formula`.
    fn assignment(&mut self, source: &Source, name: Slice, value: Slice) -> Result<(), ModelError> {
        if name.text == "0" {
            let reason = "only differential equations and maps can be converted to models";
            return Err(name.unsupported(source, "an algebraic equation", reason).with_help(
                "write the equations as text: the unknowns of a `Residual` with `dynamics: flow` have \
                 equations such as `x' = f(x, y)` and `0 = g(x, y)`",
            ));
        }
        let formula = value.trim().to_text();
        if name.text.starts_with('!') {
            let name = name.from(1).trim().to_text();
            self.constants.push((Sort::Derived, Named { name, formula }));
        } else {
            self.fixed.push(Named { name: name.to_text(), formula });
        }
        Ok(())
    }

    /// Parses a line of the form `dx/dt = formula`.
    fn rate(&mut self, source: &Source, line: Slice) -> Result<(), ModelError> {
        let wrong = || line.expected(source, "a statement, as in `dx/dt=-x`");
        let (left, _, right) = line.split(&['=']).ok_or_else(wrong)?;
        let slash = left.text.find('/').ok_or_else(wrong)?;
        let below: String = left.text[slash + 1..].split_whitespace().collect();
        if !(left.text.starts_with(['d', 'D']) && below.eq_ignore_ascii_case("dt")) {
            return Err(wrong());
        }
        let name = left.part(1..slash).trim().to_text();
        self.states.push(Named { name, formula: right.trim().to_text() });
        Ok(())
    }

    /// Parses a line of the form `x(t+1) = formula`, `x(0) = number` or `f(a,b) = formula`.
    fn bracket(
        &mut self,
        source: &Source,
        line: Slice,
        head: Slice,
        array: bool,
    ) -> Result<(), ModelError> {
        let inside = line.from(head.text.len() + 1);
        let wrong =
            || line.expected(source, "a statement, as in `f(x)=x^2`, `x(t+1)=-x` or `x(0)=1`");
        let (within, _, behind) = inside.split(&[')']).ok_or_else(wrong)?;
        let (between, _, value) = behind.split(&['=']).ok_or_else(wrong)?;
        if !between.text.trim().is_empty() {
            return Err(wrong());
        }
        let (name, formula) = (head.to_text(), value.trim().to_text());
        let argument: String = within.text.split_whitespace().collect();
        match argument.to_ascii_lowercase().as_str() {
            "t+1" => {
                self.is_map = true;
                self.states.push(Named { name, formula });
            }
            // In XPPAUT only initial values of arrays are formulas.
            "0" if array => self.initial_formulas.push(Named { name, formula }),
            "0" => {
                if number(value.text).is_none() {
                    return Err(no_formula(source, value.trim()));
                }
                self.initial.push(Named { name, formula });
            }
            _ => {
                let named = Named { name, formula };
                self.functions.push(Function { named, arguments: arguments_of(within) });
            }
        }
        Ok(())
    }

    /// Parses a line that begins with a command; XPPAUT recognises a command by its first letters.
    fn command(
        &mut self,
        source: &Source,
        word: Slice,
        rest: Slice,
    ) -> Result<ControlFlow<()>, ModelError> {
        let upper = word.text.to_ascii_uppercase();
        let refused = REFUSED.iter().find(|(start, ..)| upper.starts_with(start));
        if let Some((_, construct, reason, help)) = refused {
            let error = word.unsupported(source, *construct, *reason);
            return Err(match help {
                Some(help) => error.with_help(*help),
                None => error,
            });
        }
        let begins = |start: &str| upper.starts_with(start);
        if begins("D") {
            return Ok(ControlFlow::Break(()));
        } else if begins("AU") {
            let wrong = || rest.expected(source, "a name with a formula, as in `aux e=x^2/2`");
            let (name, _, formula) = rest.split(&['=']).ok_or_else(wrong)?;
            let (name, formula) = (name.trim().to_text(), formula.trim().to_text());
            self.monitors.push(Named { name, formula });
        } else if begins("P") {
            self.constants(source, Sort::Parameter, rest)?;
        } else if begins("N") {
            self.constants(source, Sort::Number, rest)?;
        } else if begins("I") {
            self.initial.extend(values_of(source, rest)?);
        } else if begins("G") {
            self.globals.push(Global::read(source, rest)?);
        } else if rest.text.contains('=') && !begins("SE") && !begins("@") {
            return Err(word.expected(source, "a statement that XPPAUT knows"));
        } else {
            let line = word.line(source);
            self.found.ignored.push(format!("line {line}: `{}`", word.text));
        }
        Ok(ControlFlow::Continue(()))
    }

    fn constants(&mut self, source: &Source, sort: Sort, rest: Slice) -> Result<(), ModelError> {
        let values = values_of(source, rest)?;
        self.constants.extend(values.into_iter().map(|named| (sort, named)));
        Ok(())
    }
}
