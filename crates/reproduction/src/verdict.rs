//! How many of the dissertation's printed numbers agree with Papilio's, and within what.
//!
//! Compared are the tables with a column `thesis` and, to the right of it, a column that begins with `here`:
//! each row in which both cells are numbers. Chromaticities and their distances are compared by their
//! difference, all other numbers by their ratio.

use crate::report::{Part, Report, Section, Table};

/// Limits of relative deviations, %.
const PERCENT: [f64; 3] = [2.0, 5.0, 10.0];

/// Limit of differences of chromaticities and of distances in u'v'.
const CHROMATICITY: f64 = 0.01;

/// Rows whose numbers are compared by their difference.
const DIFFERENCES: [&str; 3] = ["u\u{2032}", "v\u{2032}", "dR"];

/// Agreement of the numbers of a section, or of all.
#[derive(Debug, Clone, PartialEq, Default)]
struct Agreement {
    /// Relative deviations, %.
    percent: Vec<f64>,
    /// Differences of chromaticities.
    chromaticity: Vec<f64>,
}

impl Agreement {
    fn of_section(section: &Section) -> Self {
        let mut all = Self::default();
        for part in &section.parts {
            if let Part::Table(table) = part {
                all.add(table);
            }
        }
        all
    }

    fn add(&mut self, table: &Table) {
        let is_here = |name: &String| name.starts_with("here");
        let pairs = table.head.iter().enumerate().filter(|(_, name)| name.ends_with("thesis")).filter_map(
            |(k, _)| {
                let later = table.head.iter().enumerate().skip(k + 1);
                let here =
                    later.take_while(|(_, name)| !name.ends_with("thesis")).find(|(_, name)| is_here(name));
                here.map(|(here, _)| [k, here])
            },
        );
        let pairs: Vec<[usize; 2]> = pairs.collect();
        for row in &table.rows {
            let by_difference = row.first().is_some_and(|name| DIFFERENCES.contains(&name.as_str()));
            for pair in &pairs {
                let [Some(theirs), Some(ours)] = pair.map(|k| row.get(k).and_then(|cell| number(cell)))
                else {
                    continue;
                };
                if by_difference {
                    self.chromaticity.push((ours - theirs).abs());
                } else if theirs != 0.0 {
                    self.percent.push(100.0 * (ours / theirs - 1.0).abs());
                }
            }
        }
    }

    fn count(&self) -> usize {
        self.percent.len() + self.chromaticity.len()
    }

    /// Number of relative deviations up to a limit, %.
    fn within(&self, limit: f64) -> usize {
        self.percent.iter().filter(|percent| **percent <= limit).count()
    }

    fn near(&self) -> usize {
        self.chromaticity.iter().filter(|difference| **difference <= CHROMATICITY).count()
    }
}

/// Returns the number in a cell; `56.8/N` is a number, too.
fn number(cell: &str) -> Option<f64> {
    let plain = cell.strip_suffix("/N").unwrap_or(cell);
    plain.parse().ok().filter(|value: &f64| value.is_finite())
}

impl Report {
    /// Returns how many of the printed numbers agree, in one sentence.
    pub fn verdict(&self) -> String {
        let mut all = Agreement::default();
        for section in &self.sections {
            let Agreement { percent, chromaticity } = Agreement::of_section(section);
            all.percent.extend(percent);
            all.chromaticity.extend(chromaticity);
        }
        let [close, near, far] = PERCENT.map(|limit| all.within(limit));
        format!(
            "of {} numbers that the thesis prints, {close} agree within {} %, {near} within {} % and {far} within {} %; of {} \
             chromaticities (u\u{2032}, v\u{2032}, dR), {} agree within {CHROMATICITY}",
            all.percent.len(),
            PERCENT[0],
            PERCENT[1],
            PERCENT[2],
            all.chromaticity.len(),
            all.near()
        )
    }

    /// Returns the section with the agreement of each table and figure.
    pub(crate) fn summary(&self) -> Section {
        let head = [
            "",
            "numbers",
            "within 2 %",
            "within 5 %",
            "within 10 %",
            "largest deviation",
            "u\u{2032}, v\u{2032}, dR",
            "within 0.01",
        ];
        let mut table = Table::new(&head);
        for section in &self.sections {
            let one = Agreement::of_section(section);
            if one.count() == 0 {
                continue;
            }
            let worst = one.percent.iter().copied().fold(0.0, f64::max);
            let counted = |count: usize, of: usize| if of == 0 { String::new() } else { count.to_string() };
            let of = one.percent.len();
            let mut row = vec![section.title.clone(), counted(of, of)];
            row.extend(PERCENT.map(|limit| counted(one.within(limit), of)));
            row.push(if of == 0 { String::new() } else { format!("{worst:.1} %") });
            row.extend([
                counted(one.chromaticity.len(), one.chromaticity.len()),
                counted(one.near(), one.chromaticity.len()),
            ]);
            table.row(row);
        }
        let verdict = self.verdict();
        let mut letters = verdict.chars();
        let verdict: String =
            letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
        Section::new("agreement", "Agreement: how many printed numbers are reproduced, and within what")
            .say(format!("{verdict}."))
            .table(table)
            .say(
                "Compared are numbers in a column \u{201c}thesis\u{201d} with those in the next column \u{201c}here\u{201d}: in table 5.1, \
                 the bare panel with angles in glass. The display of the thesis is not public, so that large deviations are those of \
                 its substitute; each section gives the reasons. The integral in figures 5.3 and 5.4 is an error of the thesis.",
            )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_counts_rows_with_two_numbers() {
        let mut table = Table::new(&["", "thesis", "from X", "here: bare", "difference", "thesis", "here"]);
        table.row(["Y", "0.200", "9", "0.206", "+3 %", "21.3/N", "21.3333/N"]);
        table.row(["u\u{2032}", "0.200", "9", "0.205", "", "-", "1"]);
        table.row(["X", "0", "9", "1", "", "1", "2"]);
        let section = Section::new("s", "S").table(table);
        let found = Agreement::of_section(&section);
        assert_eq!((found.percent.len(), found.chromaticity.len()), (3, 1));
        assert_eq!([found.within(2.0), found.within(5.0), found.within(10.0), found.near()], [1, 2, 2, 1]);
        let report = Report { title: String::new(), about: Vec::new(), sections: vec![section] };
        assert!(
            report
                .verdict()
                .starts_with("of 3 numbers that the thesis prints, 1 agree within 2 %, 2 within 5 %")
        );
        assert_eq!(report.summary().parts.len(), 3);
    }
}
