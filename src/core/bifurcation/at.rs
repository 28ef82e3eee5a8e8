//! Points at which defining systems and test functions are evaluated.

use super::null::NullSpace;
use crate::core::system::System;

/// A point at which a defining system or a test function is evaluated.
pub struct At<'a> {
    /// The system.
    pub system: &'a mut dyn System,
    /// The unknowns and all parameters, `x = (z, p)`.
    pub x: &'a [f64],
    /// Positions of the released parameters among all parameters. Only derivatives with respect to
    /// the released parameters are computed.
    pub released: &'a [usize],
    /// The auxiliary unknowns of the defining systems that hold along the curve, such as the
    /// frequency `ω` along a curve of Hopf points.
    pub held: &'a [f64],
    /// The null vectors at this point, which all defining systems and test functions share.
    pub null: &'a mut NullSpace,
}

impl At<'_> {
    /// Reborrows the point.
    pub(crate) fn again(&mut self) -> At<'_> {
        let At { system, x, released, held, null } = self;
        At { system: &mut **system, x, released, held, null }
    }
}

/// A parameter or a monitor that a defining system can hold at a given level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// The parameter with this index among all parameters.
    Parameter(usize),
    /// The monitor with this index among all monitors.
    Monitor(usize),
}
