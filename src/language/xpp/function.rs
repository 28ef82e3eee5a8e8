//! XPPAUT's functions.

use super::super::operation::{Function, function};

/// Functions without a counterpart: what they are, and why they are refused.
pub(super) const REFUSED: [(&str, &str, &str); 15] = [
    ("DELAY", "a delay (`delay`)", "motion that depends on its past is not followed"),
    ("DEL_SHFT", "a delay (`del_shft`)", "motion that depends on its past is not followed"),
    ("INT", "an integral (`int`)", "integral equations have no counterpart"),
    ("RAN", "a random number (`ran`)", "motion that depends on chance is not followed"),
    ("NORMAL", "a random number (`normal`)", "motion that depends on chance is not followed"),
    ("POISSON", "a random number (`poisson`)", "motion that depends on chance is not followed"),
    ("BESSELJ", "the function `besselj`", "there is no such function here"),
    ("BESSELY", "the function `bessely`", "there is no such function here"),
    ("BESSELI", "the function `besseli`", "there is no such function here"),
    ("ERF", "the function `erf`", "there is no such function here"),
    ("ERFC", "the function `erfc`", "there is no such function here"),
    ("LGAMMA", "the function `lgamma`", "there is no such function here"),
    ("HOM_BCS", "the function `hom_bcs`", "it states conditions of connecting orbits"),
    ("ISHIFT", "the function `ishift`", "it gives the place of a name in XPPAUT's memory"),
    ("SET", "the function `set`", "quantities cannot be set while others are computed"),
];

/// The function of a name that XPPAUT and the language have.
pub(super) fn built_in(name: &str) -> Option<&'static Function> {
    function(&name.to_ascii_lowercase()).filter(|function| function.of_xpp)
}
