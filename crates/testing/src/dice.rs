//! A stream of random choices for generating random test cases.

use papilio_sampling::{SampleStream, Sampler};

/// The random choices of one member of a family of cases; reproducible.
#[derive(Debug, Clone)]
pub struct Dice {
    numbers: SampleStream,
    drawn: u32,
}

impl Dice {
    /// Returns the choices of member `number` of family `family`.
    pub fn new(family: u64, number: u64) -> Self {
        Self { numbers: SampleStream::new(Sampler::Random, family, number), drawn: 0 }
    }

    /// Draws a uniform number in (0, 1).
    pub fn throw(&mut self) -> f64 {
        let drawn = self.drawn;
        self.drawn += 1;
        self.numbers.block(0, drawn / 4)[(drawn % 4) as usize]
    }

    /// Draws a uniform number between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.throw()
    }

    /// Draws a number with uniform logarithm between two positive numbers.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Returns true with probability 1/`count`.
    pub fn one_in(&mut self, count: u32) -> bool {
        self.throw() * f64::from(count) < 1.0
    }

    /// Draws an integer from 0 to `count - 1`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.throw() * count as f64) as usize
    }

    /// Draws 64 random bits.
    pub fn bits(&mut self) -> u64 {
        let half = |dice: &mut Self| (dice.throw() * 2.0_f64.powi(32)) as u64;
        (half(self) << 32) | half(self)
    }

    /// Draws one of these items.
    pub fn of<T: Copy, const N: usize>(&mut self, all: [T; N]) -> T {
        all[self.below(N)]
    }
}
