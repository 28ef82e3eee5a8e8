//! Settings of correct scenes.

use super::Case;
use crate::bases::Bases;
use crate::dice::Dice;
use crate::words::value;

/// Settings of all scenes, and of sweeps.
const SETTINGS: &[&str] = &[
    "accuracy",
    "count",
    "curve_error",
    "detect",
    "eigenvalues",
    "event_tolerance",
    "flow_tolerance",
    "initial_step",
    "lyapunov_periods",
    "max_iterations",
    "target_mesh_error",
    "max_mesh_error",
    "max_period",
    "max_period_growth",
    "max_points",
    "max_step",
    "min_step",
    "recorded_periods",
    "refinement",
    "save_every",
    "refine",
    "stability",
    "tolerance",
    "transient",
];

pub fn make(case: &mut Case, bases: &Bases, dice: &mut Dice) -> std::io::Result<()> {
    let quick: Vec<_> = bases.scenes.iter().filter(|scene| !scene.slow).collect();
    let base = dice.pick(&quick);
    let swept = base.text.contains("sweeps: [");
    let command = match dice.below(8) {
        0 => "show",
        _ if swept => "sweep",
        _ => "trace",
    };
    let name = format!("{}.ron", base.name);
    case.input(&name, base.one_of_both(dice).into())?;
    case.arguments(&[command, &name]);
    for _ in 0..=dice.below(3) / 2 {
        let setting = match dice.below(8) {
            0 => dice.pick(&bases.words).as_str(),
            1..5 => dice.pick(&base.names),
            _ => dice.word(SETTINGS),
        };
        let value = value(dice);
        case.option("--set", &format!("{setting}={value}"));
    }
    Ok(())
}
