//! Filippov systems as hybrid systems, with modes above, below and on the surface.

use super::normal::{project, sliding_velocity};
use super::{FilippovNames, FilippovSystem, Side};
use crate::core::failure::OutOfDomain;
use crate::core::hybrid::leg::Moment;
use crate::core::hybrid::scales::{guard_scale, time_scale};
use crate::core::hybrid::system::{Guard, HybridSystem, Mode, Scales};
use crate::core::hybrid::tangency::Tangency;
use crate::core::ode::NEGATIVE;
use crate::core::problem::{Forcing, Measure, forward};
use crate::core::scalar::Scalar;

/// The hybrid system that represents a [`FilippovSystem`].
///
/// The hybrid system has three modes, above, below and on the surface, all with the same states. The
/// event at the surface leads either across the surface or to sliding. Sliding ends when one of the
/// fields starts to point away from the surface; the event that ends sliding is named after the mode
/// on the side of that field.
#[derive(Clone, Copy, Debug)]
pub struct Filippov<S>(pub S);

/// The event at which motion reaches the surface from either side.
const SURFACE: usize = 0;
/// Rounding: a sliding field does not count as tangent to the surface if its normal velocity, in
/// units of the terms of this velocity, is above this value; a smaller normal velocity is a
/// rounding error of given constants.
const OFF: f64 = 1e-6;

impl<S> Filippov<S> {
    /// The mode above the surface.
    pub const ABOVE: usize = 0;
    /// The mode below the surface.
    pub const BELOW: usize = 1;
    /// The mode of sliding on the surface.
    pub const SLIDING: usize = 2;

    /// Returns the mode on a side of the surface.
    fn mode(side: Side) -> usize {
        match side {
            Side::Above => Self::ABOVE,
            Side::Below => Self::BELOW,
        }
    }

    /// Returns the side of the surface that has the given number, which is also the number of the
    /// mode on this side.
    fn side(number: usize) -> Side {
        if number == Self::ABOVE { Side::Above } else { Side::Below }
    }

    /// Returns the side to which motion leaves the surface at an event that ends sliding.
    fn exit(guard: usize) -> Side {
        Self::side(guard - 1)
    }
}

impl<S: FilippovSystem> HybridSystem for Filippov<S> {
    forward! { |self| self.0;
        fn parameters() -> Vec<String>;
        fn defaults() -> Vec<f64>;
        fn forcing() -> Forcing;
        fn period<T>(p: &[T]) -> T;
        fn scales(p: &[f64]) -> Scales;
        fn monitors() -> Vec<String>;
        fn measures() -> Vec<(String, Measure)>;
    }

    fn modes(&self) -> Vec<Mode> {
        let FilippovNames { above, below, sliding, .. } = self.0.names();
        let [above, below, sliding] =
            [above, below, sliding].map(|name| Mode::new(name, self.0.states()));
        vec![above, below, sliding.on_surface()]
    }

    fn guards(&self) -> Vec<Guard> {
        let FilippovNames { above, below, surface, .. } = self.0.names();
        let exit = |name| Guard::new(name, [Self::SLIDING]);
        vec![Guard::new(surface, [Self::ABOVE, Self::BELOW]), exit(above), exit(below)]
    }

    /// Returns the mode in which motion starts: the mode of the side on which the state lies. On the
    /// surface, motion slides if neither field leaves the surface. If one field leaves the surface,
    /// motion leaves to the side of that field; if both fields leave it, the given mode is kept.
    fn initial_mode(&self, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        let (height, scale) =
            (self.0.surface(t, x, p), guard_scale(self, (SURFACE, mode), (t, x), p));
        if height.abs() > NEGATIVE * scale {
            return if height > 0.0 { Self::ABOVE } else { Self::BELOW };
        }
        match [Side::Above, Side::Below].map(|side| self.0.holds(side, t, x, p) > 0.0) {
            [true, true] => Self::SLIDING,
            [false, true] => Self::ABOVE,
            [true, false] => Self::BELOW,
            [false, false] => mode,
        }
    }

    #[inline]
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        if mode == Self::SLIDING {
            self.0.sliding(t, x, p, f);
        } else {
            self.0.field(Self::side(mode), t, x, p, f);
        }
    }

    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        match guard {
            SURFACE if mode == Self::ABOVE => self.0.surface(t, x, p),
            SURFACE => -self.0.surface(t, x, p),
            exit => self.0.holds(Self::exit(exit), t, x, p),
        }
    }

    /// Computes the state after an event; at the start and end of sliding the state is projected
    /// onto the surface, which removes drift.
    fn reset<T: Scalar>(
        &self,
        _guard: usize,
        (mode, next): (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        after.copy_from_slice(x);
        if mode == Self::SLIDING {
            self.constrain(mode, t, after, p);
        } else {
            self.constrain(next, t, after, p);
        }
    }

    /// Projects the state onto the surface if the mode is sliding.
    fn constrain<T: Scalar>(&self, mode: usize, t: T, x: &mut [T], p: &[T]) {
        if mode == Self::SLIDING {
            let scales = self.0.scales(&p.iter().map(T::real).collect::<Vec<_>>());
            let sizes: Vec<f64> = self.0.states().iter().map(|state| scales.of(state)).collect();
            project(&self.0, (t, x, p), &sizes);
        }
    }

    fn may_follow(&self, guard: usize, mode: usize) -> Vec<usize> {
        match guard {
            SURFACE => vec![Self::mode(Self::side(mode).other()), Self::SLIDING],
            exit => vec![Self::mode(Self::exit(exit))],
        }
    }

    /// Computes the speed at which the field on the side opposite to the present mode leaves the
    /// surface.
    fn decision<T: Scalar>(
        &self,
        _position: usize,
        _guard: usize,
        mode: usize,
        t: T,
        x: &[T],
        p: &[T],
    ) -> T {
        -self.0.holds(Self::side(mode).other(), t, x, p)
    }

    /// Returns the name of a grazing or sliding bifurcation, after di Bernardo et al. (SIAM Review
    /// 50:629, 2008).
    fn kind_of_tangency(
        &self,
        tangency: Tangency,
        t: f64,
        x: &[f64],
        p: &[f64],
    ) -> Option<&'static str> {
        match tangency {
            Tangency::Touch { guard, mode } | Tangency::Slow { guard, mode, .. } => match guard {
                SURFACE => {
                    let slides = self.0.holds(Self::side(mode).other(), t, x, p) > 0.0;
                    slides.then_some("grazing-sliding")
                }
                _ => Some("adding-sliding"),
            },
            Tangency::Leg { before, mode, after } => match mode == Self::SLIDING {
                true if before == after => Some("grazing-sliding"),
                true => Some("crossing-sliding"),
                false if after != Self::SLIDING => None,
                false if before == Self::SLIDING => Some("adding-sliding"),
                false => Some("switching-sliding"),
            },
            Tangency::Decision { mode, .. } => {
                // Sliding that begins at the boundary of the sliding region continues along the
                // boundary, or leaves immediately.
                let exit = Self::mode(Self::side(mode).other()) + 1;
                let sliding = Moment { system: self, mode: Self::SLIDING, t, x, p };
                match sliding.rate(exit) > 0.0 {
                    true => Some("switching-sliding"),
                    false => Some("crossing-sliding"),
                }
            }
        }
    }

    fn monitor<T: Scalar>(&self, monitor: usize, _mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.0.monitor(monitor, t, x, p)
    }

    fn domain(&self, _mode: usize, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.0.domain(x, p)
    }

    /// Checks at the start and the end of a sliding motion that the sliding field is tangent to the
    /// surface.
    fn domain_at_ends(&self, mode: usize, t: f64, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        if mode != Self::SLIDING {
            return Ok(());
        }
        let [velocity, terms] = sliding_velocity(&self.0, (t, x, p));
        let scale = guard_scale(self, (SURFACE, Self::ABOVE), (t, x), p) / time_scale(self, p);
        if velocity.abs() > OFF * (terms + scale) {
            let quantity = "the normal velocity of the field of sliding motion on the surface";
            let remedy = "the normal velocity must vanish to keep sliding motion on the surface: \
                          correct `sliding`, or omit `sliding` to use the convex combination of \
                          the two fields";
            return Err(OutOfDomain::new(quantity, velocity, remedy));
        }
        Ok(())
    }
}
