//! Settings of other programs for which this program has options or kinds of models instead.

/// The names of settings in AUTO, XPPAUT and MatCont, in lower case, with what replaces the settings
/// in this program.
const REPLACED: [(&str, &str); 13] = [
    ("rl0", "the option `--along NAME=LOW..HIGH`"),
    ("rl1", "the option `--along NAME=LOW..HIGH`"),
    ("parmin", "the option `--along NAME=LOW..HIGH`"),
    ("parmax", "the option `--along NAME=LOW..HIGH`"),
    ("icp", "the option `--along NAME=LOW..HIGH`"),
    ("stop", "the option `--bound NAME=LOW..HIGH`"),
    ("uzstop", "the option `--bound NAME=LOW..HIGH`"),
    ("uzr", "the option `--mark NAME=VALUE`"),
    ("isw", "the option `--switch KIND`"),
    ("mxbf", "the option `--depth NUMBER`"),
    ("irs", "the option `--start FILE:LABEL`"),
    ("total", "the option `--time TIME`"),
    ("ips", "the kind of the model, such as `Equations` or `Boundary`"),
];

/// Returns the remedy if a name is a setting of AUTO, XPPAUT or MatCont that an option or the kind
/// of the model replaces.
pub(super) fn remedy(name: &str) -> Option<String> {
    let lower = name.to_lowercase();
    let (_, own) = REPLACED.iter().find(|(other, _)| *other == lower)?;
    Some(format!("instead of `{name}` of other programs, use {own}"))
}
