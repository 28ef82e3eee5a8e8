//! A linearisation within a border.

use super::layout::Layout;
use super::linearisation::Linearisation;
use crate::core::zero::Border;

/// Which linearisation is factored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// The Jacobian.
    Jacobian,
    /// The same with the extras zero in place of integral and phase conditions: what is left of a periodic
    /// orbit's linearisation when its boundary conditions are others.
    Twisted,
}

/// The assembled linearisation of a system, in a form, within a border.
#[derive(Clone, Copy)]
pub(super) struct Bordered<'a> {
    pub layout: &'a Layout,
    pub assembled: &'a Linearisation,
    pub form: Form,
    pub border: Border<'a>,
}
