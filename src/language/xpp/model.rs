//! Conversion of the contents of an XPPAUT file to a statement, that is, to equations in the
//! notation of this library.

use super::super::Statement;
use super::super::source::{Fault, ModelError, Phrase, Source};
use super::super::statement::{Equations, Formulas as Pairs, HybridEquations, Map, Shared};
use super::common::common;
use super::depend::Formulas;
use super::event::{Event, Hybrid};
use super::names::{Names, check};
use super::origin::Named;
use super::parts::{Parts, Sort};
use super::phrase::{arguments_of, pair, written};
use super::tree::{Known, Tree};
use super::{Ode, formula};

/// Returns the model that an XPPAUT file contains.
pub(super) fn understood(source: &Source, parts: Parts) -> Result<Ode, ModelError> {
    check_sizes(source, &parts)?;
    let mut names = Names::of(source, &parts)?;
    if parts.states.is_empty() {
        let (what, needed) =
            ("the file has no equation".into(), "write an equation, as in `x'=-x`".into());
        return Err(source.fault_of(&Phrase::default(), Fault::Missing { what, needed }));
    }
    let formulas = formulas_of(&names, &parts)?;
    let read = |named: &Named| formula::read(&names, named.formula.all(), &[]);
    let rates: Vec<Tree> = parts.states.iter().map(read).collect::<Result<_, _>>()?;
    let monitors: Vec<Tree> = parts.monitors.iter().map(read).collect::<Result<_, _>>()?;
    // A map that depends on the number of the iterate has a state that counts iterates.
    let depends = |tree: &Tree| formulas.all_names(tree).contains(&Known::Time);
    if parts.is_map && rates.iter().chain(&monitors).any(depends) {
        names.clock = Some(names.free("iterate", false));
    }
    let mut ignored = parts.found.ignored.clone();
    let read = |global| Event::read(&names, &formulas, global, &mut ignored);
    let events: Vec<Event> = parts.globals.iter().map(read).collect::<Result<_, _>>()?;
    let mut renamed = names.renamed.clone();
    let monitors = monitors_of(&mut names, &parts, &monitors, &mut renamed)?;
    let mut common = common(&names, &parts, &formulas, monitors)?;
    let states = parts.states.iter().zip(&rates);
    let mut states: Pairs = states.map(|(named, tree)| pair(&names, named, tree, &[])).collect();
    if let Some(clock) = &names.clock {
        states.push((clock.as_str().into(), format!("{clock} + 1").into()));
        let start = parts.found.options.start.to_string();
        common.initial.push((clock.as_str().into(), start.into()));
    }
    let (statement, tried) = statement(&names, &formulas, &parts, events, states, common)?;
    let options = parts.found.options.clone();
    Ok(Ode { statement, options, ignored, renamed, tried, clock: names.clock })
}

/// The maximum number of functions in an XPPAUT file; the same maximum applies to the number of
/// `global` conditions.
const MOST: usize = 200;

/// Returns an error if a file contains more functions or conditions than can be substituted into
/// each other in a reasonable time.
fn check_sizes(source: &Source, parts: &Parts) -> Result<(), ModelError> {
    let function =
        parts.functions.get(MOST).map(|function| ("functions", function.named.name.all()));
    let global = parts.globals.get(MOST).map(|global| ("conditions", global.condition.all()));
    match function.or(global) {
        Some((what, place)) => Err(place.fault(source, Fault::TooLarge { what, limit: MOST })),
        None => Ok(()),
    }
}

/// Returns the statement (the equations in the notation of this library) of an XPPAUT file, and
/// descriptions of the `global` conditions that were decided by random trials.
fn statement(
    names: &Names,
    formulas: &Formulas,
    parts: &Parts,
    events: Vec<Event>,
    states: Pairs,
    common: Shared,
) -> Result<(Statement, Vec<String>), ModelError> {
    if parts.is_map {
        if let Some(global) = parts.globals.first() {
            let reason = "the events of maps cannot be converted to models";
            let place = global.condition.all();
            return Err(place
                .unsupported(names.source, "`global` of a map", reason)
                .with_help("write the map with `if`"));
        }
        return Ok((Statement::Map(Map { states, ..Map::from(common) }), Vec::new()));
    }
    if events.is_empty() {
        let equations = Equations { states, ..Equations::from(common) };
        return Ok((Statement::Equations(equations), Vec::new()));
    }
    let rest = HybridEquations::from(common);
    let hybrid = Hybrid { names, formulas, parts, events, rates: states, rest };
    let (statement, tried) = hybrid.statement()?;
    Ok((Statement::HybridEquations(statement), tried))
}

/// Returns the formulas of the constants, the fixed quantities and the functions of an XPPAUT file.
/// A formula that depends on itself or on quantities defined later is an error.
fn formulas_of(names: &Names, parts: &Parts) -> Result<Formulas, ModelError> {
    let mut formulas = Formulas::default();
    for function in &parts.functions {
        let arguments = arguments_of(names.source, function)?;
        formulas.functions.push(formula::read(names, function.named.formula.all(), &arguments)?);
    }
    for (sort, named) in &parts.constants {
        formulas.constants.push(match sort {
            Sort::Derived => Some(formula::read(names, named.formula.all(), &[])?),
            _ => None,
        });
    }
    for named in &parts.fixed {
        formulas.fixed.push(formula::read(names, named.formula.all(), &[])?);
    }
    if let Some(k) = formulas.circular() {
        let name = parts.functions[k].named.name.all();
        let fault = Fault::Circular { name: name.text.into(), through: "it calls itself".into() };
        return Err(name.fault(names.source, fault));
    }
    check_constants(names, parts, &formulas)?;
    check_order(names, parts, &formulas)?;
    Ok(formulas)
}

/// Returns an error if a constant depends on a quantity that varies, because XPPAUT computes
/// constants only once.
fn check_constants(names: &Names, parts: &Parts, formulas: &Formulas) -> Result<(), ModelError> {
    for ((_, named), tree) in parts.constants.iter().zip(&formulas.constants) {
        let Some(tree) = tree else { continue };
        let varies =
            |known: &Known| matches!(known, Known::State(_) | Known::Fixed(_) | Known::Time);
        if let Some(known) = formulas.all_names(tree).iter().find(|known| varies(known)) {
            let construct =
                format!("`!{}` that depends on `{}`", named.name.all().text, names.written(*known));
            let reason = "XPPAUT computes such a quantity once, at the start";
            let place = named.name.all();
            return Err(place
                .unsupported(names.source, construct, reason)
                .with_help("omit the `!` if the quantity should vary"));
        }
    }
    Ok(())
}

/// Returns an error if a quantity is used before it is computed, because XPPAUT would use its value
/// from the previous step.
fn check_order(names: &Names, parts: &Parts, formulas: &Formulas) -> Result<(), ModelError> {
    for (k, (named, tree)) in parts.fixed.iter().zip(&formulas.fixed).enumerate() {
        let later = |known: &Known| matches!(known, Known::Fixed(other) if *other >= k);
        if let Some(known) = formulas.by_functions(tree).iter().find(|known| later(known)) {
            let construct = format!(
                "`{}` in the formula of a quantity computed earlier",
                names.written(*known)
            );
            let reason = "XPPAUT would use the value from the previous step";
            let place = named.name.all();
            return Err(place
                .unsupported(names.source, construct, reason)
                .with_help("move the line of that quantity up"));
        }
    }
    Ok(())
}

/// Returns the monitors of the file, renamed if necessary: in XPPAUT, the name of a monitor may
/// coincide with another name.
fn monitors_of(
    names: &mut Names,
    parts: &Parts,
    trees: &[Tree],
    renamed: &mut Vec<(String, String)>,
) -> Result<Pairs, ModelError> {
    let mut monitors = Pairs::new();
    for (named, tree) in parts.monitors.iter().zip(trees) {
        let name = named.name.all();
        check(names.source, name)?;
        let taken = names.is_taken(name.text);
        let called =
            names.free(&if taken { format!("{}_aux", name.text) } else { name.text.into() }, false);
        if called != name.text {
            renamed.push((name.text.into(), called.clone()));
        }
        let name = name.phrase(names.source, called);
        monitors.push((name, written(names, named.formula.all(), tree, &[])));
    }
    Ok(monitors)
}
