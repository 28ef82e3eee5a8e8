//! Conversion of the fields that statements of all kinds have, that is, all fields except the
//! states.

use super::super::source::{Fault, ModelError, Phrase};
use super::super::statement::{Formulas as Pairs, Shared};
use super::depend::Formulas;
use super::formula;
use super::names::Names;
use super::origin::Named;
use super::parts::{Parts, Sort};
use super::phrase::{arguments_of, name_of, pair, written};
use super::tree::Known;

/// Returns the fields that statements of all kinds have, that is, all fields except the states.
pub(super) fn common(
    names: &Names,
    parts: &Parts,
    formulas: &Formulas,
    monitors: Pairs,
) -> Result<Shared, ModelError> {
    let number = |named: &Named| {
        let value = named.formula.all();
        // A parameter without a value is 0.
        let text = if value.text.is_empty() { "0" } else { value.text };
        (name_of(names, named.name.all()), value.phrase(names.source, text.into()))
    };
    let of_sort = |sort| parts.constants.iter().filter(move |(known, _)| *known == sort);
    let parameters = of_sort(Sort::Parameter).map(|(_, named)| number(named)).collect();
    let mut definitions: Pairs = of_sort(Sort::Number).map(|(_, named)| number(named)).collect();
    let order = formulas.order().map_err(|k| {
        let name = parts.constants[k].1.name.all();
        let through = "constants that depend on each other".to_string();
        name.fault(names.source, Fault::Circular { name: name.text.into(), through })
    })?;
    let derived = order.into_iter().filter_map(|k| {
        let (_, named) = &parts.constants[k];
        Some((named, formulas.constants[k].as_ref()?))
    });
    for (named, tree) in derived.chain(parts.fixed.iter().zip(&formulas.fixed)) {
        definitions.push(pair(names, named, tree, &[]));
    }
    let mut functions = Vec::new();
    for (function, tree) in parts.functions.iter().zip(&formulas.functions) {
        let arguments = arguments_of(names.source, function)?;
        let (name, formula) = pair(names, &function.named, tree, &arguments);
        let phrases = function.arguments.iter().zip(&arguments);
        let phrases = phrases.map(|(place, text)| place.all().phrase(names.source, text.clone()));
        functions.push((name, phrases.collect(), formula));
    }
    let initial = initial_of(names, parts)?;
    if names.needs_modulo.get() {
        functions.push(modulo(names));
    }
    Ok(Shared { parameters, definitions, functions, monitors, initial })
}

/// Returns the formula of XPPAUT's `mod`, for positive and negative divisors.
fn modulo(names: &Names) -> (Phrase, Vec<Phrase>, Phrase) {
    let (name, arguments) = (names.written(Known::Modulo), vec!["a".into(), "b".into()]);
    let negative = "if(a < 0 & mod(-a, -b) > 0)then(b - mod(-a, -b))else(mod(abs(a), -b))";
    let formula = format!("if(b > 0)then(mod(a, b))else({negative})");
    (name.into(), arguments, formula.into())
}

/// Returns the initial values of all states; the default value is 0.
fn initial_of(names: &Names, parts: &Parts) -> Result<Pairs, ModelError> {
    let mut initial: Pairs = parts
        .states
        .iter()
        .map(|named| (name_of(names, named.name.all()), Phrase::from("0")))
        .collect();
    for named in &parts.initial {
        let value = named.formula.all();
        let text = if value.text.is_empty() { "0" } else { value.text };
        initial[names.state(&named.name)?].1 = value.phrase(names.source, text.into());
    }
    for named in &parts.initial_formulas {
        let k = names.state(&named.name)?;
        let tree = formula::read(names, named.formula.all(), &[])?;
        initial[k].1 = written(names, named.formula.all(), &tree, &[]);
    }
    Ok(initial)
}
