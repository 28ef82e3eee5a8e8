//! Detection of quantities that hardly change over many steps.

/// Heuristic: a quantity stands still if it changes by less than this fraction of its value
/// in [`MANY`] consecutive points.
const LITTLE: f64 = 0.05;

const MANY: usize = 20;

/// The last values of a quantity that differ little from one of its earlier values.
#[derive(Clone, Copy, Default)]
pub(super) struct Standstill {
    /// The earlier value.
    from: f64,
    /// The number of values since then that differ little from the earlier value.
    count: usize,
}

impl Standstill {
    /// Records the value at the next point, and returns whether the quantity stands still.
    pub fn reached(&mut self, value: f64) -> bool {
        if (value - self.from).abs() < LITTLE * self.from.abs() {
            self.count += 1;
        } else {
            *self = Standstill { from: value, count: 0 };
        }
        self.count >= MANY
    }
}
