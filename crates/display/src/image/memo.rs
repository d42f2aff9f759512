//! Functions of colours, of which a halftone has few.

/// Values of a function for the colours that it was asked for last: what is found in it has the same bits as what is computed again.
pub(super) struct Memo<V> {
    known: Vec<Option<([u32; 3], V)>>,
}

/// Logarithm of the number of values: six inks are seldom in each other's way.
const BITS: u32 = 8;

impl<V: Copy> Memo<V> {
    pub(super) fn new() -> Self {
        Self { known: vec![None; 1 << BITS] }
    }

    /// The value for a colour.
    #[inline]
    pub(super) fn of(&mut self, colour: [f32; 3], find: impl FnOnce([f32; 3]) -> V) -> V {
        let [x, y, z] = colour;
        let bits = [x.to_bits(), y.to_bits(), z.to_bits()];
        let mixed = bits[0] ^ bits[1].rotate_left(11) ^ bits[2].rotate_left(22);
        let place = &mut self.known[(mixed.wrapping_mul(0x9E37_79B9) >> (u32::BITS - BITS)) as usize];
        match place {
            Some((of, value)) if *of == bits => *value,
            _ => {
                let value = find(colour);
                *place = Some((bits, value));
                value
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of few colours and of many, whose places are the same, each has its own value, and few are computed once.
    #[test]
    fn values_are_those_of_their_colours() {
        for (colours, most) in [(6, 12), (4000, 8000)] {
            let (mut memo, mut computed) = (Memo::new(), 0);
            let colour = |k: usize| [k as f32 * 0.37, 1.0 / (1.0 + k as f32), -(k as f32)];
            for k in (0..colours).chain(0..colours) {
                let value = memo.of(colour(k), |colour| {
                    computed += 1;
                    colour.map(|one| 2.0 * one)
                });
                assert_eq!(value, colour(k).map(|one| 2.0 * one));
            }
            assert!((colours..=most).contains(&computed), "{computed}");
        }
    }
}
