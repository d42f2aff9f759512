//! Comparison of the output that a page shows with that of the program.

/// A word of the text that is expected, with the number of its line.
type Word<'a> = (usize, &'a str);

/// Stands for any number of words.
const OMITTED: &str = "...";

/// Compares an output with the text of a page: word by word, with numbers as [`same_word`] compares them.
/// `...` stands for any number of words.
pub(super) fn compare(shown: &str, printed: &str) -> Result<(), String> {
    let words: Vec<Word<'_>> = shown
        .lines()
        .enumerate()
        .flat_map(|(line, text)| text.split_whitespace().map(move |word| (line, word)))
        .collect();
    let printed: Vec<&str> = printed.split_whitespace().collect();
    let parts: Vec<&[Word<'_>]> = words.split(|(_, word)| *word == OMITTED).collect();
    let last = parts.len() - 1;
    let mut from = 0;
    for (index, part) in parts.iter().enumerate() {
        let end = printed.len().checked_sub(part.len());
        let starts = match (index, index == last) {
            (0, true) => (0, Some(0).filter(|_| part.len() == printed.len())),
            (0, false) => (0, end.map(|_| 0)),
            (_, true) => (end.unwrap_or(0).max(from), end),
            (_, false) => (from, end),
        };
        let found = starts.1.and_then(|last| {
            (starts.0..=last).find(|start| equal_words(part, &printed[*start..]) == part.len())
        });
        match found {
            Some(start) => from = start + part.len(),
            None => return Err(difference(shown, part, &printed[from..], index == 0)),
        }
    }
    Ok(())
}

/// Number of words at the beginning that are equal.
fn equal_words(expected: &[Word<'_>], printed: &[&str]) -> usize {
    expected.iter().zip(printed).take_while(|((_, shown), printed)| same_word(shown, printed)).count()
}

/// Describes where the longest beginning of `part` in the output ends.
fn difference(shown: &str, part: &[Word<'_>], printed: &[&str], at_start: bool) -> String {
    let starts = if at_start { 0..=0 } else { 0..=printed.len() };
    let best = starts
        .max_by_key(|start| (equal_words(part, &printed[*start..]), printed.len() - start))
        .unwrap_or(0);
    let equal = equal_words(part, &printed[best..]);
    let around = |words: &[&str]| words.iter().skip(equal).take(12).copied().collect::<Vec<_>>().join(" ");
    let found = around(&printed[best..]);
    match part.get(equal) {
        Some((line, word)) => {
            let text = shown.lines().nth(*line).unwrap_or_default().trim();
            format!(
                "line {} of the block, `{text}`: `{word}` is shown, the program prints `{found} ...`",
                line + 1
            )
        }
        None => format!("the program also prints `{found} ...`; omit it with a line `...`"),
    }
}

/// True if two words are equal. Numbers with decimals may differ by one unit of the last digit.
fn same_word(shown: &str, printed: &str) -> bool {
    let (mut shown, mut printed) = (pieces(shown), pieces(printed));
    loop {
        match (shown.next(), printed.next()) {
            (None, None) => return true,
            (Some(one), Some(other)) if one == other || are_close(one, other) => {}
            _ => return false,
        }
    }
}

/// Splits a word into numbers (digits and a decimal point) and what stands between them.
fn pieces(word: &str) -> impl Iterator<Item = &str> {
    let mut rest = word;
    std::iter::from_fn(move || {
        let is_number = |c: char| c.is_ascii_digit() || c == '.';
        let first = is_number(rest.chars().next()?);
        let end = rest.find(|c| is_number(c) != first).unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        rest = after;
        Some(piece)
    })
}

/// True if both are numbers with the same number of decimals that differ by one unit of the last digit at
/// most.
fn are_close(one: &str, other: &str) -> bool {
    let decimals = |text: &str| Some(text.split_once('.')?.1.len());
    let (Ok(a), Ok(b)) = (one.parse::<f64>(), other.parse::<f64>()) else { return false };
    match (decimals(one), decimals(other)) {
        (Some(digits), Some(others)) if digits > 0 && digits == others => {
            let unit = 0.1_f64.powi(i32::try_from(digits).unwrap_or(i32::MAX));
            (a - b).abs() < 1.5 * unit
        }
        _ => false,
    }
}

#[test]
fn equal_outputs_are_accepted() {
    let printed = "Title\n\nstate   Y\n white 0.5862 (3 %)\n black 0.0248\nend\n";
    for shown in [
        printed,
        "Title\nstate Y\nwhite 0.5862 (3 %)\n...\n",
        "Title\n...\nblack 0.0249\nend\n",
        "...\nwhite 0.5861\n...",
        "...",
        "Title ... end",
    ] {
        assert_eq!(compare(shown, printed), Ok(()), "{shown}");
    }
}

#[test]
fn different_outputs_are_reported_with_their_line() {
    let printed = "Title\n\nstate   Y\n white 0.5862 (3 %)\n black 0.0248\nend\n";
    for (shown, says) in [
        (
            "Title\nstate Y\nwhite 0.5864 (3 %)\n...",
            "line 3 of the block, `white 0.5864 (3 %)`: `0.5864` is shown",
        ),
        ("Title\nstate Y\nwhite 0.586 (3 %)\n...", "`0.586` is shown"),
        ("Title\nstate Y\nwhite 0.5862 (4 %)\n...", "`(4` is shown"),
        ("Title\n", "also prints `state Y"),
        ("Title\n...\nblack 0.0248\n", "also prints `end"),
        ("state\n...", "`state` is shown"),
        ("...\nblack 0.0248\nwhite\n...", "line 3"),
        ("...\nnothing", "`nothing` is shown"),
    ] {
        let error = compare(shown, printed).unwrap_err();
        assert!(error.contains(says), "{shown}: {error}");
    }
    assert!(!same_word("D65", "D64") && !same_word("-1.0", "1.0") && same_word("1.234(5)", "1.235(5)"));
}
