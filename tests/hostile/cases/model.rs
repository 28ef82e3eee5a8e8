//! Changed files of equations, of this program and of XPPAUT's, and what is asked of correct ones.

use super::Case;
use crate::bases::{Bases, EQUATIONS};
use crate::dice::Dice;
use crate::mutate::{mutated, words};
use crate::words::{number, value};

pub fn make(case: &mut Case, bases: &Bases, dice: &mut Dice) -> std::io::Result<()> {
    let is_xppaut = dice.chance(1, 2);
    let (name, text, parameter, state) = if is_xppaut {
        let (name, text) = dice.pick(&bases.xppaut);
        let known = words(text);
        (format!("{name}.ode"), *text, dice.pick(&known).clone(), dice.pick(&known).clone())
    } else {
        let (text, parameter, state) = dice.pick(&EQUATIONS);
        ("equations.ron".into(), *text, parameter.to_string(), state.to_string())
    };
    let correct = dice.chance(1, 3);
    let bytes = match correct {
        true => text.as_bytes().to_vec(),
        false => mutated(text, &[words(text), bases.words.clone()].concat(), dice),
    };
    case.input(&name, bytes)?;
    if is_xppaut && dice.chance(1, 4) {
        case.arguments(&["import", &name]);
        if dice.chance(1, 2) {
            case.option("--out", "imported.ron");
        }
        return Ok(());
    }
    case.arguments(&[if dice.chance(1, 4) { "show" } else { "trace" }, &name]);
    case.option("--set", "max_points=10");
    let usual = !correct || dice.chance(1, 2);
    let range = if usual { "0..1".into() } else { range(dice) };
    case.option("--along", &format!("{parameter}={range}"));
    if !usual {
        flags(case, &parameter, &state, dice);
    }
    Ok(())
}

/// A range that may be wrong.
fn range(dice: &mut Dice) -> String {
    match dice.below(6) {
        0 => "0..1".into(),
        1 => "1..0".into(),
        2 => "..".into(),
        3 => value(dice).into(),
        _ => format!("{}..{}", number(dice), number(dice)),
    }
}

/// What else is asked for.
fn flags(case: &mut Case, parameter: &str, state: &str, dice: &mut Dice) {
    for _ in 0..=dice.below(2) {
        match dice.below(7) {
            0 => case.option("--start", &format!("{state}={}", value(dice))),
            1 => case.option("--hold", dice.word(&["LP", "HB", "PD", "G", "EP", "lp", "XX", ""])),
            2 => case.option("--bound", &format!("max_{state}={}", range(dice))),
            3 => {
                case.option("--switch", dice.word(&["all", "all", "none"]));
                if dice.chance(1, 2) {
                    case.option(
                        "--depth",
                        dice.word(&["0", "1", "2", "-1", "18446744073709551615"]),
                    );
                }
            }
            4 => case.option("--settle", dice.word(&["0", "3", "-1", "1e300", "nan", "x", "1/3"])),
            5 => case.option("--along", &format!("{parameter}={}", range(dice))),
            _ => case.option("--bound", &format!("{parameter}={}", range(dice))),
        }
    }
}
