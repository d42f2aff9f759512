//! Property tests: random cases are drawn, and a case that violates the property is printed.

use std::fmt::Debug;
use std::ops::RangeInclusive;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use crate::Dice;

/// Draws `cases` reproducible cases and checks a property of each. A case that violates it is printed.
///
/// ```
/// use papilio_testing::laws;
/// laws(300, |dice| dice.between(-9.0, 9.0), |x| assert!(x * x >= 0.0));
/// ```
///
/// # Panics
/// If the property panics.
#[allow(clippy::print_stderr, reason = "the output of a test that fails")]
pub fn laws<T: Debug>(cases: u64, draw: impl Fn(&mut Dice) -> T, property: impl Fn(&T)) {
    for number in 0..cases {
        let case = draw(&mut Dice::new(0, number));
        if let Err(failure) = catch_unwind(AssertUnwindSafe(|| property(&case))) {
            eprintln!("case {number} of {cases} violates the property: {case:#?}");
            resume_unwind(failure);
        }
    }
}

impl Dice {
    /// Draws a list whose length is uniform in the range.
    pub fn several<T>(
        &mut self,
        count: RangeInclusive<usize>,
        mut draw: impl FnMut(&mut Self) -> T,
    ) -> Vec<T> {
        let (fewest, most) = count.into_inner();
        let count = fewest + self.below(most - fewest + 1);
        (0..count).map(|_| draw(self)).collect()
    }

    /// Draws text of at most `longest` characters from the given set.
    pub fn text(&mut self, characters: &str, longest: usize) -> String {
        let characters: Vec<char> = characters.chars().collect();
        self.several(0..=longest, |dice| characters[dice.below(characters.len())]).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    #[test]
    fn every_case_is_drawn_and_a_violation_panics() {
        let seen = RefCell::new(Vec::new());
        laws(300, |dice| dice.throw(), |x| seen.borrow_mut().push(*x));
        let seen = seen.into_inner();
        assert_eq!(seen.len(), 300);
        assert!(seen.iter().any(|x| *x < 0.02) && seen.iter().any(|x| *x > 0.98));
        let broken = catch_unwind(|| laws(300, |dice| dice.throw(), |x| assert!(*x < 0.98)));
        assert!(broken.is_err());
    }

    #[test]
    fn texts_have_all_lengths_and_only_given_characters() {
        let mut lengths = [0; 4];
        for number in 0..400 {
            let text = Dice::new(1, number).text("ab\u{e9}", 3);
            assert!(text.chars().all(|c| "ab\u{e9}".contains(c)));
            lengths[text.chars().count()] += 1;
        }
        assert!(lengths.iter().all(|count| *count > 60), "{lengths:?}");
    }
}
