//! Converts names and formulas of an XPPAUT file to the notation of statements.

use super::super::source::{Fault, ModelError, Phrase, Source};
use super::names::{Names, check};
use super::origin::{Named, Slice};
use super::parts::Function;
use super::tree::{Known, Tree};

/// Returns the names of a function's arguments.
pub(super) fn arguments_of(
    source: &Source,
    function: &Function,
) -> Result<Vec<String>, ModelError> {
    let mut arguments: Vec<String> = Vec::new();
    for argument in &function.arguments {
        let argument = argument.all();
        check(source, argument)?;
        if argument.text.contains('.') {
            return Err(argument.expected(source, "a name: letters, digits and `_`"));
        }
        if arguments.iter().any(|known| known.eq_ignore_ascii_case(argument.text)) {
            let fault = Fault::Twice { name: argument.text.into(), first: "an argument" };
            return Err(argument.fault(source, fault));
        }
        arguments.push(argument.text.into());
    }
    Ok(arguments)
}

/// Returns a name and its formula in the notation of statements.
pub(super) fn pair(
    names: &Names,
    named: &Named,
    tree: &Tree,
    arguments: &[String],
) -> (Phrase, Phrase) {
    let formula = written(names, named.formula.all(), tree, arguments);
    (name_of(names, named.name.all()), formula)
}

/// Returns a formula in the notation of statements.
pub(super) fn written(names: &Names, place: Slice, tree: &Tree, arguments: &[String]) -> Phrase {
    let text = tree.written(&|known| match known {
        Known::Argument(k) => arguments[k].clone(),
        known => names.written(known),
    });
    place.phrase(names.source, text)
}

/// Returns a name in the notation of statements.
pub(super) fn name_of(names: &Names, name: Slice) -> Phrase {
    let written = names.find(name.text).map_or(name.text.into(), |known| names.written(known));
    name.phrase(names.source, written)
}
