//! The functions of XPPAUT.

use super::super::operation::{Function, function};

/// XPPAUT functions that have no counterpart in this library: the name, a description, and the
/// reason for the rejection.
pub(super) const REFUSED: [(&str, &str, &str); 15] = [
    ("DELAY", "a delay (`delay`)", "the equations of a model cannot contain delays"),
    ("DEL_SHFT", "a delay (`del_shft`)", "the equations of a model cannot contain delays"),
    ("INT", "an integral (`int`)", "models cannot contain integral equations"),
    ("RAN", "a random number (`ran`)", "models are deterministic"),
    ("NORMAL", "a random number (`normal`)", "models are deterministic"),
    ("POISSON", "a random number (`poisson`)", "models are deterministic"),
    ("BESSELJ", "the function `besselj`", "the model language lacks this function"),
    ("BESSELY", "the function `bessely`", "the model language lacks this function"),
    ("BESSELI", "the function `besseli`", "the model language lacks this function"),
    ("ERF", "the function `erf`", "the model language lacks this function"),
    ("ERFC", "the function `erfc`", "the model language lacks this function"),
    ("LGAMMA", "the function `lgamma`", "the model language lacks this function"),
    ("HOM_BCS", "the function `hom_bcs`", "`hom_bcs` states conditions of connecting orbits"),
    (
        "ISHIFT",
        "the function `ishift`",
        "`ishift` returns the position of a name in XPPAUT's memory",
    ),
    (
        "SET",
        "the function `set`",
        "the evaluation of a formula cannot change the value of another quantity",
    ),
];

/// Returns the function with a given name if XPPAUT and this library's language both have this
/// function.
pub(super) fn built_in(name: &str) -> Option<&'static Function> {
    function(&name.to_ascii_lowercase()).filter(|function| function.of_xpp)
}
