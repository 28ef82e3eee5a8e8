//! Changed documents: listed, drawn, and continued.

use super::Case;
use crate::bases::Bases;
use crate::dice::Dice;
use crate::mutate::mutated;
use crate::words::{TEXTS, number};

pub fn make(case: &mut Case, bases: &Bases, dice: &mut Dice) -> std::io::Result<()> {
    let (name, text) = dice.pick(&bases.documents);
    let file = format!("{name}-saved.ron");
    let bytes = match dice.chance(1, 6) {
        true => text.clone().into_bytes(),
        false => mutated(text, &bases.words, dice),
    };
    case.input(&file, bytes)?;
    match dice.below(4) {
        0 => case.arguments(&["table", &file]),
        1 | 2 => {
            case.arguments(&["plot", &file]);
            if dice.chance(1, 4) {
                let (other, text) = dice.pick(&bases.documents);
                let other = format!("{other}-other.ron");
                case.input(&other, text.clone().into_bytes())?;
                case.arguments(&[&other]);
            }
            for option in ["--x", "--y", "--points", "--out"] {
                if dice.chance(1, 6) {
                    let value = drawn(option, bases, dice);
                    case.option(option, &value);
                }
            }
        }
        _ => {
            case.arguments(&["trace", name, "--set", "max_points=6"]);
            let start = match dice.below(3) {
                0 => format!("{file}:{}", number(dice)),
                1 => format!("{file}:{}/1", dice.pick(&bases.words)),
                _ => format!("{file}:{}", 1 + dice.below(4)),
            };
            case.option("--start", &start);
            case.subjects.push(name.clone());
        }
    }
    Ok(())
}

/// What is drawn.
fn drawn(option: &str, bases: &Bases, dice: &mut Dice) -> String {
    match option {
        "--out" => dice.word(&["a.svg", "a.png", "a", "a/b.svg", "", "."]).to_string(),
        "--points" => match dice.below(3) {
            0 => format!("{}", dice.below(4)),
            1 => format!("{}/{}", dice.pick(&bases.words), dice.below(4)),
            _ => dice.word(TEXTS).to_string(),
        },
        _ => match dice.below(3) {
            0 => dice.word(TEXTS).to_string(),
            _ => dice.pick(&bases.words).clone(),
        },
    }
}
