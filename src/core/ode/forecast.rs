//! Event forecasts for batched steps, from values and derivatives of a watched function at both
//! ends of a step.

use super::roots::{Sign, ZERO};
use crate::core::numerics::{Limits, bracketed_zero};
use crate::core::scalar::{DualLanes, Lanes, MOST_LANES, Register};
use num_traits::Signed;

/// Heuristic: the largest number of iterations for the root of a cubic, which serves only as an
/// initial guess.
const ROUNDS: usize = 8;
/// Heuristic: the iteration for the root of the cubic ends after a change of less than this
/// fraction of a step.
const NEAR: f64 = 1e-3;

/// Conclusions about a watched function from its values and derivatives at the ends of a step, with
/// one bit for each lane.
#[derive(Clone, Copy, Debug)]
pub struct EventForecast {
    /// The values and derivatives of the function at the start and at the end of the step.
    ends: [[[f64; MOST_LANES]; 2]; 2],
    /// Whether the function is positive at the start of the step.
    positive: u32,
    /// Whether the function is positive at both ends of the step and does not fall below the
    /// smaller of these two values within the step.
    clear: u32,
    /// Whether the function increases throughout the step and is positive at its end.
    rises: u32,
    /// Whether the function is positive at the start of the step, negative at its end, and has a
    /// single zero in between.
    falls: u32,
}

impl EventForecast {
    /// Computes the forecast for a function from its values and derivatives at both ends of the
    /// step.
    #[inline(always)]
    pub(super) fn of<R: Register>(start: DualLanes<R>, end: DualLanes<R>) -> Self {
        let [from, to] = [start.eps[0], end.eps[0]];
        let middle = (end.re - start.re) * 1.5 - (from + to) * 0.25;
        let slopes = [from, middle, to];
        let (first, second, third) = (from.abs(), middle.abs(), to.abs());
        let (least, most) = (first.least(second).least(third), first.most(second).most(third));
        let (zero, none) = (Lanes::splat(0.0), Lanes::splat(ZERO));
        let same =
            (from * to).exceeds(zero) & (middle * to).exceeds(zero) & (to * to).exceeds(zero);
        let monotone = same & (least * 5.0).exceeds(most);
        // The slope changes sign once, at a rate that varies by less than a factor of three.
        let rates = [slopes[1] - slopes[0], slopes[2] - slopes[1]];
        let (a, b) = (rates[0].abs(), rates[1].abs());
        let turns = zero.exceeds(slopes[0] * slopes[2])
            & (rates[0] * rates[1]).exceeds(zero)
            & (b * 3.0).exceeds(a)
            & (a * 3.0).exceeds(b);
        let (positive, lower) = (start.re.exceeds(none), start.re.least(end.re));
        EventForecast {
            ends: [start, end].map(|end| [end.re.each(), end.eps[0].each()]),
            positive,
            clear: lower.exceeds(none) & (monotone | lower.exceeds(most)),
            rises: monotone & to.exceeds(zero) & end.re.exceeds(none),
            falls: positive & (monotone | turns) & (zero - none).exceeds(end.re),
        }
    }

    /// Whether the function certainly has no downward zero crossing in the step of a lane, and is
    /// positive at the end of the step.
    pub(in crate::core) fn is_quiet(&self, lane: usize, sign: Sign) -> bool {
        let positive = match sign {
            Sign::Positive => true,
            Sign::Unknown => is_set(self.positive, lane),
            Sign::Zero { .. } | Sign::Fallen => false,
        };
        is_set(self.rises, lane) || positive && is_set(self.clear, lane)
    }

    /// Returns the approximate position of the function's single downward zero crossing in the step
    /// of a lane, from the cubic through the ends of the step; `None` if the forecast contains no
    /// such crossing.
    pub(super) fn fall(&self, lane: usize) -> Option<f64> {
        if !is_set(self.falls, lane) {
            return None;
        }
        let [[a, slope], [b, slope_b]] =
            [0, 1].map(|end| [0, 1].map(|part| self.ends[end][part][lane]));
        // The cubic is a + slope θ + square θ² + cube θ³.
        let (square, cube) =
            (3.0 * (b - a) - 2.0 * slope - slope_b, 2.0 * (a - b) + slope + slope_b);
        let limits = Limits { rounds: ROUNDS, moved: NEAR };
        Some(bracketed_zero([0.0, 1.0], 1.0, a / (a - b), limits, |theta| {
            let value = a + theta * (slope + theta * (square + theta * cube));
            [value, slope + theta * (2.0 * square + 3.0 * theta * cube)]
        }))
    }

    /// Returns the distance, in units of the step, from the end of a lane's step to the zero of the
    /// function.
    pub(super) fn correction(&self, lane: usize) -> f64 {
        let [value, slope] = &self.ends[1];
        -value[lane] / slope[lane]
    }
}

/// Whether the bit of a lane is set in a word of bits.
fn is_set(bits: u32, lane: usize) -> bool {
    bits >> lane & 1 == 1
}
