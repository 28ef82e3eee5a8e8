//! Vector fields as hybrid systems with one mode and no guards.

use crate::core::failure::OutOfDomain;
use crate::core::hybrid::{Guard, HybridSystem, Mode, Scales};
use crate::core::problem::{Forcing, Measure, VectorField, forward};
use crate::core::scalar::Scalar;

/// The hybrid system with one mode and no guards that represents a vector field.
///
/// ```
/// use tangency::core::hybrid::HybridSystem;
/// use tangency::core::orbit::Smooth;
/// use tangency::problems::classic::Lure;
/// assert_eq!(Smooth(Lure).modes()[0].states, ["x", "y", "z"]);
/// assert!(Smooth(Lure).guards().is_empty());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Smooth<F>(pub F);

impl<F: VectorField> HybridSystem for Smooth<F> {
    forward! { |self| self.0;
        fn forcing() -> Forcing;
        fn period<T>(p: &[T]) -> T;
        fn measures() -> Vec<(String, Measure)>;
    }

    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flow", self.0.names().elements())]
    }

    fn guards(&self) -> Vec<Guard> {
        Vec::new()
    }

    fn parameters(&self) -> Vec<String> {
        self.0.names().parameters
    }

    fn field<T: Scalar>(&self, _mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.0.field(t, x, p, f);
    }

    fn guard<T: Scalar>(&self, _guard: usize, _mode: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::one()
    }

    fn next_mode(&self, _guard: usize, mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        mode
    }

    fn monitors(&self) -> Vec<String> {
        self.0.names().monitors
    }

    fn monitor<T: Scalar>(&self, monitor: usize, _mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.0.monitor(monitor, t, x, p)
    }

    fn scales(&self, p: &[f64]) -> Scales {
        let sizes = self.0.scales(p);
        if sizes.is_empty() {
            return Scales::default();
        }
        let states = self.0.names().elements().zip(sizes).collect();
        Scales { time: None, states }
    }

    fn domain(&self, _mode: usize, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.0.domain(x, p)
    }
}
