//! The syntax of XPPAUT's `global` lines, which are conditions with resets.

use super::super::source::{ModelError, Source};
use super::origin::{Named, Slice, Text};

/// A parsed `global` line: a condition and its resets.
pub(super) struct Global {
    pub falls: bool,
    pub condition: Text,
    pub resets: Vec<Named>,
}

impl Global {
    /// Parses the text `sign {condition} {name=formula;…}` that follows the keyword `global`.
    pub fn read(source: &Source, rest: Slice) -> Result<Global, ModelError> {
        let form = "a sign, a condition and resets, as in `global 1 {x-1} {x=0;y=y+1}`";
        let wrong = || rest.expected(source, form);
        let (sign, _, behind) = rest.split(&[' ', '\t', '{']).ok_or_else(wrong)?;
        let braced = rest.text[sign.text.len()..].starts_with('{')
            || behind.text.trim_start().starts_with('{');
        let falls = match sign.text.trim_start_matches('+').parse::<f64>() {
            Ok(1.0) => false,
            Ok(-1.0) => true,
            Ok(0.0) => {
                let reason = "a computed motion never meets a surface exactly";
                return Err(sign
                    .unsupported(source, "the sign 0 of `global`", reason)
                    .with_help("use 1 or -1"));
            }
            _ => return Err(wrong()),
        };
        let behind = rest.from(sign.text.len()).trim();
        let (condition, resets) = match braced {
            true => {
                let (condition, _, resets) = behind.from(1).split(&['}']).ok_or_else(wrong)?;
                let (before, _, resets) = resets.split(&['{']).ok_or_else(wrong)?;
                if !before.text.trim().is_empty() {
                    return Err(before.trim().expected(source, "`{` with resets"));
                }
                (condition, resets)
            }
            false => {
                let (condition, _, resets) = behind.split(&['{']).ok_or_else(wrong)?;
                (condition, resets)
            }
        };
        let (list, _, _) = resets.split(&['}']).ok_or_else(wrong)?;
        let resets = resets_of(source, list)?;
        Ok(Global { falls, condition: condition.trim().to_text(), resets })
    }
}

/// Parses the resets, which are assignments between the second pair of braces.
fn resets_of(source: &Source, list: Slice) -> Result<Vec<Named>, ModelError> {
    let (mut resets, mut rest) = (Vec::new(), list);
    while !rest.text.trim().is_empty() {
        let (first, others) = match rest.split(&[';']) {
            Some((first, _, others)) => (first.trim(), others),
            None => (rest.trim(), rest.from(rest.text.len())),
        };
        rest = others;
        if first.text.is_empty() {
            continue;
        }
        let wrong = || first.expected(source, "a reset, as in `x=0`");
        let (name, _, formula) = first.split(&['=']).ok_or_else(wrong)?;
        let (name, formula) = (name.trim().to_text(), formula.trim().to_text());
        resets.push(Named { name, formula });
    }
    Ok(resets)
}
