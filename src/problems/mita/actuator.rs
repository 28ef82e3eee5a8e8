//! Mita's impact microactuator with impacts and dry friction, modelled as a hybrid system.

use super::block::{Block, force};
use super::parameters::{NAMES, Parameters};
use crate::core::failure::OutOfDomain;
use crate::core::hybrid::{Guard, HybridSystem, Mode, Passage, Scales};
use crate::core::problem::{Forcing, Measure, VectorField};
use crate::core::scalar::{LaneWidth, Scalar};

/// Mita's impact microactuator: a block within a frame, whose impacts move the frame against dry
/// friction.
///
/// The symbols are the displacement `q₂` and velocity `u₂` of the block relative to the frame, the
/// velocity `u₁` of the frame, the mass `m₁` of the frame (the mass of the block is 1), the
/// normal force `N = (m₁ + 1) g`, and the force `R = V² sin²ωt/(1 − q₂)² − q₂ − c u₂` between block and frame (section 2.2
/// of Zhao's dissertation):
///
/// | mode | equations | conditions |
/// |---|---|---|
/// | `stick` | `q₂' = u₂, u₂' = R` | `−δ < q₂ < δ`, `|R| < μ_s N` |
/// | `forward`, `backward` | `u₁' = −(R ± μ_d N)/m₁, u₂' = R − u₁'` | `−δ < q₂ < δ`, `±u₁ > 0` |
/// | `contact` | frame and block at rest, at `q₂ = δ` | `R > 0` |
/// | `riding_forward`, `riding_backward` | `u₁' = ∓μ_d N/(m₁ + 1)`, at `q₂ = δ` | `±u₁ > 0`, `R ± μ_d N/(m₁ + 1) > 0` |
/// | `riding_back` | `u₁' = μ_d N/(m₁ + 1)`, at `q₂ = −δ` | `u₁ < 0`, `R − μ_d N/(m₁ + 1) < 0` |
///
/// An impact at `q₂ = ±δ` conserves momentum and multiplies the relative velocity by `−e`:
///
/// ```text
///     u₁ ← u₁ + (1 + e) u₂/(m₁ + 1),    u₂ ← −e u₂
/// ```
///
/// The impact sets the frame in motion. When the frame comes to rest, it sticks if `|R| ≤ μ_s N`;
/// otherwise it starts to move against `R`. After an accumulation of impacts, the block stays in
/// contact with the stopper if it is pressed against the stopper, either by the force or because
/// friction brakes the frame. (The force alone never presses the block against the back stopper.)
///
/// Every mode has the state `displacement`, and all modes without contact also have the state
/// `velocity`. Modes in which the frame slips also have the states `frame_velocity` and
/// `frame_displacement`; the displacement of the frame is measured from the start of the mode and
/// does not appear in the equations. The forcing has the period `π/ω` because the force is
/// proportional to the square of the voltage.
///
/// ```
/// use tangency::core::hybrid::HybridSystem;
/// use tangency::problems::mita::Actuator;
/// let p = Actuator::DEFAULTS;
/// // The block hits the front stopper with a velocity of 0.3; the frame is 5 times as heavy.
/// let (front, stick, forward) = (Actuator::FRONT, Actuator::STICK, Actuator::FORWARD);
/// assert_eq!(Actuator.next_mode(front, stick, 0.0, &[0.5, 0.3], &p), forward);
/// let mut after = [0.0; 4];
/// Actuator.reset(front, (stick, forward), 0.0, &[0.5, 0.3], &p, &mut after);
/// assert!((after[1] + 0.24_f64).abs() < 1e-15 && (after[2] - 0.09_f64).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Actuator;

impl Actuator {
    /// The default values of the actuator's parameters.
    pub const DEFAULTS: [f64; 9] = [0.24, 0.5, 0.5, 0.8, 0.04, 0.4, 0.27, 5.0, 9.81];
    /// The mode in which the frame is at rest and the block moves without contact with a stopper.
    pub const STICK: usize = 0;
    /// The mode in which the frame moves forward, without contact between block and stoppers.
    pub const FORWARD: usize = 1;
    /// The mode in which the frame moves backward, without contact between block and stoppers.
    pub const BACKWARD: usize = 2;
    /// The mode in which the frame is at rest and the block is in contact with the front stopper.
    pub const CONTACT: usize = 3;
    /// The mode in which the frame moves forward and the block is in contact with the front
    /// stopper.
    pub const RIDING_FORWARD: usize = 4;
    /// The mode in which the frame moves backward and the block is in contact with the front
    /// stopper.
    pub const RIDING_BACKWARD: usize = 5;
    /// The mode in which the frame moves backward and the block is in contact with the back
    /// stopper.
    pub const RIDING_BACK: usize = 6;
    /// The guard function that detects impacts on the front stopper.
    pub const FRONT: usize = 0;
    /// The guard function that detects impacts on the back stopper.
    pub const BACK: usize = 1;
    /// The guard function that detects the end of slip, where the frame comes to rest.
    pub const REST: usize = 2;
    /// The guard function that detects when the frame begins to slip forward without an impact.
    pub const SLIDE_FORWARD: usize = 3;
    /// The guard function that detects when the frame begins to slip backward without an impact.
    pub const SLIDE_BACKWARD: usize = 4;
    /// The guard function that detects when the contact between block and stopper ends.
    pub const LEAVE: usize = 5;

    fn moves_forward(mode: usize) -> bool {
        mode == Self::FORWARD || mode == Self::RIDING_FORWARD
    }

    /// Returns whether the frame moves in a mode.
    fn slips(mode: usize) -> bool {
        mode != Self::STICK && mode != Self::CONTACT
    }

    /// Returns whether the block is in contact with a stopper in a mode.
    fn touches(mode: usize) -> bool {
        mode >= Self::CONTACT
    }

    /// Returns the displacement and velocity of the block and the velocity of the frame, from the
    /// states of a mode.
    #[inline(always)]
    fn motion<T: Scalar>(mode: usize, x: &[T]) -> [T; 3] {
        match (Self::touches(mode), Self::slips(mode)) {
            (false, true) => [x[0], x[1], x[2]],
            (false, false) => [x[0], x[1], T::zero()],
            (true, true) => [x[0], T::zero(), x[1]],
            (true, false) => [x[0], T::zero(), T::zero()],
        }
    }

    /// Returns the part of the force `R` in excess of the force that accelerates the block with the
    /// frame: positive if the block is pressed against the front stopper, negative if it is pressed
    /// against the back stopper.
    #[inline(always)]
    fn excess<T: Scalar>(mode: usize, r: T, parameters: &Parameters<T>) -> T {
        if !Self::slips(mode) {
            return r;
        }
        r - parameters.on_the_frame(Self::moves_forward(mode)) / parameters.mass()
    }

    /// Returns the force `R` between block and frame in a mode.
    #[inline(always)]
    fn force<T: Scalar>(mode: usize, t: T, x: &[T], parameters: &Parameters<T>) -> T {
        let [q, u, _] = Self::motion(mode, x);
        force(t, q, u, parameters.block())
    }

    /// Returns the velocities of block and frame after an impact.
    fn impact<T: Scalar>([_, u, v]: [T; 3], parameters: &Parameters<T>) -> [T; 2] {
        let restitution = parameters.restitution();
        [-restitution * u, v + (restitution + 1.0) * u / parameters.mass()]
    }

    /// Returns the mode, without contact between block and stoppers, that follows an event, given
    /// the velocity of the frame.
    fn of_velocity(velocity: f64, r: f64, parameters: &Parameters<f64>) -> usize {
        if velocity > 0.0 {
            Self::FORWARD
        } else if velocity < 0.0 {
            Self::BACKWARD
        } else if r.abs() <= parameters.friction(parameters.static_friction()) {
            Self::STICK
        } else if r < 0.0 {
            Self::FORWARD
        } else {
            Self::BACKWARD
        }
    }
}

impl HybridSystem for Actuator {
    fn modes(&self) -> Vec<Mode> {
        let (block, frame) =
            (["displacement", "velocity"], ["frame_velocity", "frame_displacement"]);
        let names = [
            "stick",
            "forward",
            "backward",
            "contact",
            "riding_forward",
            "riding_backward",
            "riding_back",
        ];
        let mode = |(number, name): (usize, &str)| {
            let states = if Self::touches(number) { &block[..1] } else { &block[..] };
            let frame = if Self::slips(number) { &frame[..] } else { &[] };
            Mode::new(name, states.iter().chain(frame).copied())
        };
        names.into_iter().enumerate().map(mode).collect()
    }

    fn guards(&self) -> Vec<Guard> {
        let slipping = (Self::STICK..=Self::RIDING_BACK).filter(|mode| Self::slips(*mode));
        vec![
            Guard::new("front", Self::STICK..=Self::BACKWARD),
            Guard::new("back", Self::STICK..=Self::BACKWARD),
            Guard::new("rest", slipping),
            Guard::new("slide_forward", [Self::STICK]),
            Guard::new("slide_backward", [Self::STICK]),
            Guard::new("leave", Self::CONTACT..=Self::RIDING_BACK),
        ]
    }

    fn parameters(&self) -> Vec<String> {
        NAMES.map(String::from).into()
    }

    fn defaults(&self) -> Vec<f64> {
        Self::DEFAULTS.into()
    }

    /// Returns the scales of the dimensionless equations. The forcing may be much slower than the
    /// motion of the block, so the scale of time is not derived from the frequency of the forcing.
    fn scales(&self, _p: &[f64]) -> Scales {
        Scales::default().time(1.0)
    }

    #[inline(always)]
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let parameters = Parameters::of(p);
        if Self::touches(mode) {
            f[0] = T::zero();
            if Self::slips(mode) {
                f[1] = parameters.on_the_frame(Self::moves_forward(mode)) / parameters.mass();
                f[2] = x[1];
            }
            return;
        }
        let r = Self::force(mode, t, x, &parameters);
        f[0] = x[1];
        f[1] = r;
        if Self::slips(mode) {
            let acceleration =
                (parameters.on_the_frame(Self::moves_forward(mode)) - r) / parameters.frame_mass();
            f[1] = r - acceleration;
            f[2] = acceleration;
            f[3] = x[2];
        }
    }

    #[inline(always)]
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        let parameters = Parameters::of(p);
        match guard {
            Self::FRONT => parameters.clearance() - x[0],
            Self::BACK => parameters.clearance() + x[0],
            Self::REST => {
                let [_, _, velocity] = Self::motion(mode, x);
                if Self::moves_forward(mode) { velocity } else { -velocity }
            }
            Self::SLIDE_FORWARD | Self::SLIDE_BACKWARD => {
                let holding = parameters.friction(parameters.static_friction());
                let force = Self::force(mode, t, x, &parameters);
                if guard == Self::SLIDE_FORWARD { holding + force } else { holding - force }
            }
            _ => {
                let force = Self::force(mode, t, x, &parameters);
                let excess = Self::excess(mode, force, &parameters);
                if mode == Self::RIDING_BACK { -excess } else { excess }
            }
        }
    }

    fn reset<T: Scalar>(
        &self,
        guard: usize,
        (mode, next): (usize, usize),
        _t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        let parameters = Parameters::of(p);
        let [q, u, v] = Self::motion(mode, x);
        if Self::touches(next) {
            let front = next != Self::RIDING_BACK;
            after[0] = if front { parameters.clearance() } else { -parameters.clearance() };
            if Self::slips(next) {
                (after[1], after[2]) = (v, T::zero());
            }
            return;
        }
        let [u, v] = match guard {
            Self::FRONT | Self::BACK => Self::impact([q, u, v], &parameters),
            Self::LEAVE => [u, v],
            _ => [u, T::zero()],
        };
        (after[0], after[1]) = (q, u);
        if Self::slips(next) {
            (after[2], after[3]) = (v, T::zero());
        }
    }

    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        let parameters = Parameters::of(p);
        let motion @ [q, ..] = Self::motion(mode, x);
        let r = Self::force(mode, t, x, &parameters);
        match guard {
            Self::FRONT | Self::BACK => {
                let [u, v] = Self::impact(motion, &parameters);
                Self::of_velocity(v, force(t, q, u, parameters.block()), &parameters)
            }
            Self::REST if Self::touches(mode) && q > 0.0 && r > 0.0 => Self::CONTACT,
            Self::REST => Self::of_velocity(0.0, r, &parameters),
            Self::SLIDE_FORWARD => Self::FORWARD,
            Self::SLIDE_BACKWARD => Self::BACKWARD,
            _ if mode == Self::RIDING_BACK => Self::BACKWARD,
            _ => mode - Self::CONTACT,
        }
    }

    /// Returns the mode after an accumulation of impacts: a mode with contact, or the same mode as
    /// before if the block is not pressed against the stopper.
    fn mode_after_accumulation(
        &self,
        guard: usize,
        mode: usize,
        t: f64,
        _x: &[f64],
        p: &[f64],
    ) -> Option<usize> {
        let parameters = Parameters::of(p);
        let clearance = parameters.clearance();
        let force = |q: f64| force(t, q, 0.0, parameters.block());
        let excess = |q: f64| Self::excess(mode, force(q), &parameters);
        match guard {
            Self::FRONT if excess(clearance) > 0.0 => Some(mode + Self::CONTACT),
            Self::BACK if mode == Self::BACKWARD && excess(-clearance) < 0.0 => {
                Some(Self::RIDING_BACK)
            }
            Self::FRONT | Self::BACK => Some(mode),
            _ => None,
        }
    }

    fn in_lanes(&self) -> Option<LaneWidth> {
        Some(LaneWidth::widest())
    }

    fn forcing(&self) -> Forcing {
        VectorField::forcing(&Block)
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        VectorField::period(&Block, &Parameters::of(p).block().map(|p| *p))
    }

    /// Returns the measures of a period: `max_displacement`; `displacement_range`;
    /// `poincare_velocity`, the velocity of the block where it passes upward through the middle;
    /// `impact_velocity`, the largest impact velocity at the front stopper; `step`, the
    /// displacement of the frame in a period; and `average_velocity`, `ω` times the step.
    fn measures(&self) -> Vec<(String, Measure)> {
        let displacement = || "displacement".to_string();
        let rising = Measure::Rising { through: displacement(), value: "velocity".into() };
        [
            ("max_displacement", Measure::Maximum(displacement())),
            ("displacement_range", Measure::Range(displacement())),
            ("poincare_velocity", rising),
            ("impact_velocity", Measure::Ends(0)),
            ("step", Measure::Ends(1)),
            ("average_velocity", Measure::Ends(2)),
        ]
        .map(|(name, measure)| (name.to_string(), measure))
        .into()
    }

    fn cumulative_states(&self) -> Vec<String> {
        vec!["frame_displacement".into()]
    }

    fn measure<T: Scalar>(
        &self,
        position: usize,
        legs: &[Passage<T>],
        periods: usize,
        p: &[T],
    ) -> T {
        if position == 0 {
            let front = |leg: &&Passage<T>| leg.exit == Some(Self::FRONT);
            let speeds = legs.iter().filter(front).map(|leg| leg.end[1]);
            return speeds.fold(T::zero(), |most, u| if u.real() > most.real() { u } else { most });
        }
        let slips = legs.iter().filter(|leg| Self::slips(leg.mode));
        let way = |x: &[T]| x[x.len() - 1];
        let total = slips.fold(T::zero(), |sum, leg| sum + way(leg.end) - way(leg.start));
        let step = total / periods as f64;
        if position == 1 { step } else { step * *Parameters::of(p).block()[1] }
    }

    fn domain(&self, _mode: usize, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        let parameters = Parameters::of(p);
        let (clearance, frame_mass) = (parameters.clearance(), parameters.frame_mass());
        if !(clearance > 0.0 && clearance < 1.0) {
            let remedy = "the stoppers must be between the middle, at 0, and the electrode, at 1";
            return Err(OutOfDomain::new("clearance", clearance, remedy));
        }
        let ratios = [
            ("restitution", parameters.restitution()),
            ("damping", *parameters.block()[2]),
            ("static_friction", parameters.static_friction()),
            ("dynamic_friction", parameters.dynamic_friction()),
        ];
        if let Some((name, value)) = ratios.into_iter().find(|(_, value)| *value < 0.0) {
            return Err(OutOfDomain::new(
                name,
                value,
                "choose a positive value or 0 for this quantity",
            ));
        }
        if frame_mass <= 0.0 {
            return Err(OutOfDomain::new("frame_mass", frame_mass, "a mass must be positive"));
        }
        VectorField::domain(&Block, &x[..1], &parameters.block().map(|p| *p))
    }
}
