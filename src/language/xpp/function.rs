//! The functions of XPPAUT.

use super::super::operation::{Function, function};

/// Functions without a counterpart: a description, and the reason.
pub(super) const REFUSED: [(&str, &str, &str); 15] = [
    ("DELAY", "a delay (`delay`)", "delay equations are not supported"),
    ("DEL_SHFT", "a delay (`del_shft`)", "delay equations are not supported"),
    ("INT", "an integral (`int`)", "integral equations have no counterpart"),
    ("RAN", "a random number (`ran`)", "random motion is not supported"),
    ("NORMAL", "a random number (`normal`)", "random motion is not supported"),
    ("POISSON", "a random number (`poisson`)", "random motion is not supported"),
    ("BESSELJ", "the function `besselj`", "the language does not have this function"),
    ("BESSELY", "the function `bessely`", "the language does not have this function"),
    ("BESSELI", "the function `besseli`", "the language does not have this function"),
    ("ERF", "the function `erf`", "the language does not have this function"),
    ("ERFC", "the function `erfc`", "the language does not have this function"),
    ("LGAMMA", "the function `lgamma`", "the language does not have this function"),
    ("HOM_BCS", "the function `hom_bcs`", "it states conditions of connecting orbits"),
    ("ISHIFT", "the function `ishift`", "it returns the position of a name in XPPAUT's memory"),
    ("SET", "the function `set`", "quantities cannot be set while others are computed"),
];

/// Returns the function with a name that both XPPAUT and the language have.
pub(super) fn built_in(name: &str) -> Option<&'static Function> {
    function(&name.to_ascii_lowercase()).filter(|function| function.of_xpp)
}
