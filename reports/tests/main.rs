//! Work-precision diagrams, robustness maps, the gallery, and the project's text.

// The tests of interactive pages need more of the browser than the gallery.
#[allow(dead_code)]
#[path = "../../tests/pages/browser.rs"]
mod browser;
mod english;
mod gallery;
#[path = "../../tests/common/orders.rs"]
mod orders;
mod robustness;
mod work_precision;
