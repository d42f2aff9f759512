//! Anchors of headings, by GitHub's rule: links of the pages work there and in the site.

use std::collections::HashMap;

/// Gives each heading of a page its anchor.
#[derive(Debug, Default)]
pub(crate) struct Anchors {
    used: HashMap<String, usize>,
}

impl Anchors {
    /// Returns the anchor of the next heading, whose text is without markup. An anchor that the page already
    /// has gets a number.
    pub(crate) fn next(&mut self, heading: &str) -> String {
        let plain = slug(heading);
        let count = self.used.entry(plain.clone()).or_default();
        *count += 1;
        if *count == 1 { plain } else { format!("{plain}-{}", *count - 1) }
    }
}

/// Lower case; letters, digits, `_` and `-` remain; blanks become `-`.
fn slug(heading: &str) -> String {
    let lower = heading.trim().to_lowercase();
    lower.chars().map(|c| if c == ' ' { '-' } else { c }).filter(|c| remains(*c)).collect()
}

fn remains(c: char) -> bool {
    c.is_alphabetic() || c.is_ascii_digit() || c == '_' || c == '-'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchor_of_a_heading_is_that_of_github() {
        // Checked against headings of rendered pages on GitHub.
        for (heading, expected) in [
            ("The diffuser's own reflection", "the-diffusers-own-reflection"),
            ("[display]: layers and pixel", "display-layers-and-pixel"),
            ("C++ & Rust -- both", "c--rust----both"),
            ("snake_case and kebab-case", "snake_case-and-kebab-case"),
            ("Größe θ in °", "größe-θ-in-"),
            ("10⁹ designs", "10-designs"),
        ] {
            assert_eq!(Anchors::default().next(heading), expected);
        }
    }

    #[test]
    fn repeated_headings_get_numbers() {
        let mut anchors = Anchors::default();
        let all = ["Limits", "Limits", "limits!"].map(|heading| anchors.next(heading));
        assert_eq!(all, ["limits", "limits-1", "limits-2"]);
    }
}
