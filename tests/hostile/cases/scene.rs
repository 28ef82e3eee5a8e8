//! Changed scenes: traced, swept, written.

use super::Case;
use crate::bases::Bases;
use crate::dice::Dice;
use crate::mutate::mutated;

pub fn make(case: &mut Case, bases: &Bases, dice: &mut Dice) -> std::io::Result<()> {
    let base = dice.pick(&bases.scenes);
    let swept = base.text.contains("sweeps: [");
    let command = match dice.below(8) {
        0 => "show",
        1..5 if swept => "sweep",
        _ if base.slow => "show",
        _ => "trace",
    };
    let name = format!("{}.ron", base.name);
    case.input(&name, mutated(base.one_of_both(dice), &bases.words, dice))?;
    case.arguments(&[command, &name]);
    if command == "sweep" {
        case.arguments(&["--threads", "1"]);
    }
    Ok(())
}
