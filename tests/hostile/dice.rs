//! Random choices, the same for the same seed.

use crate::random::Random;

/// Random choices.
pub struct Dice(Random);

impl Dice {
    /// The choices of a seed and a case: those of neighbouring cases have nothing in common.
    pub fn new(seed: u64, case: u64) -> Self {
        let [first, second] = [seed, case].map(|seed| Random::new(seed).number());
        Dice(Random::new(first ^ second))
    }

    /// A number of 64 random bits.
    pub fn number(&mut self) -> u64 {
        self.0.number()
    }

    /// A number below `count`; 0 if that is 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.below(count)
    }

    /// True `times` of `of` times.
    pub fn chance(&mut self, times: usize, of: usize) -> bool {
        self.below(of) < times
    }

    /// One of some, of which there is at least one.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    /// One of some texts.
    pub fn word<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }
}
