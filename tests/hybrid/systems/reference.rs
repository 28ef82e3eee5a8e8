//! Any of the systems with known answers, as one type: what is generic over systems is compiled
//! once for all.

use super::belt::Belt;
use super::bouncing_ball::BouncingBall;
use super::coulomb::Coulomb;
use super::dry_impact::DryImpact;
use super::piecewise::Piecewise;
use tangency::core::hybrid::filippov::Filippov;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::problems::classic::ImpactOscillator;

#[derive(Clone, Copy, Debug)]
pub enum Reference {
    Belt,
    BouncingBall,
    Coulomb,
    DryImpact,
    ImpactOscillator,
    Piecewise,
}

/// What the system says.
macro_rules! of {
    ($reference:expr, $system:ident => $answer:expr) => {
        of!($reference, $system => $answer,
            [Belt = Filippov(Belt), BouncingBall = BouncingBall, Coulomb = Coulomb, DryImpact = DryImpact,
             ImpactOscillator = ImpactOscillator, Piecewise = Piecewise])
    };
    ($reference:expr, $system:ident => $answer:expr, [$($name:ident = $value:expr),*]) => {
        match $reference {
            $(Reference::$name => {
                let $system = $value;
                $answer
            })*
        }
    };
}

impl HybridSystem for Reference {
    fn modes(&self) -> Vec<Mode> {
        of!(self, system => system.modes())
    }
    fn guards(&self) -> Vec<Guard> {
        of!(self, system => system.guards())
    }
    fn parameters(&self) -> Vec<String> {
        of!(self, system => system.parameters())
    }
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        of!(self, system => system.field(mode, t, x, p, f));
    }
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        of!(self, system => system.guard(guard, mode, t, x, p))
    }
    fn reset<T: Scalar>(
        &self,
        guard: usize,
        modes: (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        of!(self, system => system.reset(guard, modes, t, x, p, after));
    }
    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        of!(self, system => system.next_mode(guard, mode, t, x, p))
    }
    fn forcing(&self) -> Forcing {
        of!(self, system => system.forcing())
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        of!(self, system => system.period(p))
    }
}
