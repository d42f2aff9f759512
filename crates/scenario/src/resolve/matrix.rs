//! `[display.matrix]`: pitch, sub-pixels and colour filter. Their rectangles are resolved in `windows`.

use papilio_diagnostics::Diagnostic;
use papilio_display::pixel::state_names;
use papilio_display::scene::{Display, Filter, FilterState, Length, Matrix, Pixel};
use papilio_spectra::Spectrum;

use super::Resolver;
use super::film::{DEFAULT_STATES, no_sub_pixel};
use super::windows::SubPixels;
use crate::describe::File;
use crate::describe::display::ShareSpectrum;
use crate::describe::matrix as describe;
use crate::describe::pixel as described_pixel;
use crate::mistake;
use crate::origin::Origin;
use crate::read::{Item, Named, Spanned};

/// Micrometres in an inch.
const UM_PER_INCH: f64 = 25_400.0;
/// Millimetres in a micrometre.
const MM_PER_UM: f64 = 1e-3;
/// Largest number of states.
const MOST_STATES: usize = 256;
/// Name of the only sub-pixel of a pixel without sub-pixels of its own.
const PIXEL: &str = "pixel";

impl Resolver<'_> {
    /// Resolves the matrix of a display with this pixel.
    pub(super) fn matrix(
        &mut self,
        (matrix, at): (&describe::Matrix, Origin),
        described: &described_pixel::Pixel,
        pixel: &Pixel,
    ) -> Option<Matrix> {
        let pitch_mm = self.pitch(matrix, at);
        let pixels = self.pixel_counts(matrix);
        let sub_pixels = self.sub_pixels_of(matrix, described, pixel);
        let windows = sub_pixels.as_ref().and_then(|sub_pixels| self.windows(matrix, sub_pixels));
        let names = sub_pixels.map(|sub_pixels| sub_pixels.names);
        let filter = match &matrix.filter.value {
            Some(filter) => names.and_then(|names| self.filter(matrix, filter, &names, pixel)).map(Some),
            None => self.refuse_states(matrix).map(|()| None),
        };
        Some(Matrix { pitch_mm: pitch_mm?, pixels: pixels?, sub_pixels: windows?, filter: filter? })
    }

    /// Resolves the period along x and y, mm.
    fn pitch(&mut self, matrix: &describe::Matrix, at: Origin) -> Option<[f64; 2]> {
        match (&matrix.pitch_um.value, matrix.ppi.value) {
            (Some(describe::Period::Square(pitch)), None) => Some([pitch.0 * MM_PER_UM; 2]),
            (Some(describe::Period::Oblong(both)), None) => match both.as_slice() {
                [x, y] => Some([x.0 * MM_PER_UM, y.0 * MM_PER_UM]),
                _ => {
                    self.err(&matrix.pitch_um, mistake::another_length("a number, or a list of two, [x, y]"));
                    None
                }
            },
            (None, Some(ppi)) => Some([UM_PER_INCH / ppi.0 * MM_PER_UM; 2]),
            (pitch, _) => {
                let given = if pitch.is_some() { 2 } else { 0 };
                let at = at.or_override([matrix.pitch_um.origin, matrix.ppi.origin]);
                self.errors.push(at, mistake::exactly_one("`pitch_um` and `ppi`", given));
                None
            }
        }
    }

    fn pixel_counts(&mut self, matrix: &describe::Matrix) -> Option<Option<[usize; 2]>> {
        match matrix.pixels.as_deref() {
            None => Some(None),
            Some([columns, rows]) => Some(Some([columns.0 as usize, rows.0 as usize])),
            Some(_) => {
                self.err(&matrix.pixels, mistake::another_length("a list of two, [columns, rows]"));
                None
            }
        }
    }

    /// Returns the names and areas of the sub-pixels: those of a film, or those of a filter, or a single one.
    fn sub_pixels_of(
        &mut self,
        matrix: &describe::Matrix,
        described: &described_pixel::Pixel,
        pixel: &Pixel,
    ) -> Option<SubPixels> {
        let filter = matrix.filter.as_ref();
        match (pixel, described, filter) {
            (Pixel::Film(film), described_pixel::Pixel::Film(described), _) => Some(SubPixels {
                names: film.sub_pixels.iter().map(|one| one.name.clone()).collect(),
                areas: Some(film.sub_pixels.iter().map(|one| one.area).collect()),
                fill_factor: film.fill_factor,
                table: "display.pixel.area",
                causes: vec![described.area.origin, described.fill_factor.origin],
            }),
            (.., Some(filter)) => {
                let names = filter.transmittance.names();
                self.limit(&filter.transmittance, "parts of the filter", names.len(), 64)?;
                if names.is_empty() {
                    let wrong = Diagnostic::new("this filter has no parts");
                    let expected = "a transmittance for each sub-pixel, such as { red = \"red.csv\", ... }";
                    self.err(&filter.transmittance, wrong.expected(expected));
                    return None;
                }
                Some(SubPixels {
                    names,
                    areas: None,
                    fill_factor: 1.0,
                    table: "display.matrix.filter.transmittance",
                    causes: vec![filter.transmittance.origin],
                })
            }
            (.., None) => Some(SubPixels {
                names: vec![PIXEL.to_owned()],
                areas: Some(vec![1.0]),
                fill_factor: 1.0,
                table: "display.pixel",
                causes: Vec::new(),
            }),
        }
    }

    /// Resolves a filter over sub-pixels of these names, with the states of the display.
    fn filter(
        &mut self,
        matrix: &describe::Matrix,
        filter: &describe::Filter,
        names: &[String],
        pixel: &Pixel,
    ) -> Option<Filter> {
        let transmittance = self.filter_spectra(&filter.transmittance, names);
        let states = self.filter_states(matrix, names, &state_names(pixel));
        Some(Filter {
            height_mm: filter.height_um.0 * MM_PER_UM,
            transmittance: transmittance?,
            states: states?,
        })
    }

    fn filter_spectra(
        &mut self,
        transmittance: &Spanned<Named<ShareSpectrum>>,
        names: &[String],
    ) -> Option<Vec<Spectrum>> {
        for item in transmittance.0.iter().filter(|item| !names.contains(&item.name)) {
            self.errors.push(item.name_origin, no_sub_pixel(&item.name, "area", names));
        }
        let spectra = names.iter().map(|name| match transmittance.get(name) {
            Some(spectrum) => self.share(spectrum, spectrum.origin),
            None => {
                self.err(
                    transmittance,
                    mistake::missing_key(name, "a number from 0 to 1, or a spectrum file"),
                );
                None
            }
        });
        spectra.collect::<Vec<_>>().into_iter().collect()
    }

    /// Resolves the states of a display with a filter: the default ones, and those of the scenario.
    fn filter_states(
        &mut self,
        matrix: &describe::Matrix,
        names: &[String],
        known: &[String],
    ) -> Option<Vec<FilterState>> {
        let mut states = default_states(names, known);
        let given = matrix.states.iter().flat_map(|states| &states.0);
        let given: Vec<_> = given.map(|item| self.filter_state(item, names, known)).collect();
        for state in given {
            let state = state?;
            match states.iter_mut().find(|other| other.name == state.name) {
                Some(other) => *other = state,
                None => states.push(state),
            }
        }
        self.limit(&matrix.states, "states", states.len(), MOST_STATES)?;
        if states.is_empty() {
            self.err(&matrix.filter, no_states_below(names, known));
            return None;
        }
        Some(states)
    }

    /// Resolves a state: the state of the pixel below every part of the filter.
    fn filter_state(
        &mut self,
        state: &Item<Named<String>>,
        names: &[String],
        known: &[String],
    ) -> Option<FilterState> {
        for item in state.value.0.iter().filter(|item| !names.contains(&item.name)) {
            self.errors.push(item.name_origin, no_sub_pixel(&item.name, "filter.transmittance", names));
        }
        let below = names.iter().map(|name| {
            let Some(wanted) = state.value.get(name) else {
                let wrong =
                    mistake::missing_key(name, "the state of the pixel below this part of the filter");
                self.err(&state.value, wrong);
                return None;
            };
            let found = known.iter().position(|known| *known == wanted.value);
            if found.is_none() {
                self.err(wanted, mistake::no_such_state(wanted, known));
            }
            found
        });
        let below: Vec<Option<usize>> = below.collect();
        let pixel_states = below.into_iter().collect::<Option<_>>()?;
        Some(FilterState { name: state.name.clone(), pixel_states })
    }

    /// Refuses states of a matrix without a filter.
    fn refuse_states(&mut self, matrix: &describe::Matrix) -> Option<()> {
        if matrix.states.is_none() {
            return Some(());
        }
        let wrong = Diagnostic::new("these states are for a display with a colour filter, but there is none");
        let hint =
            "add [display.matrix.filter], or describe the states of the sub-pixels in [display.pixel.states]";
        self.err(&matrix.states, wrong.hint(hint));
        None
    }

    /// Checks that a filter is inside the medium above the pixel.
    pub(super) fn check_filter_height(&mut self, file: &File, display: &Display) {
        let (Some(filter), Some(Length::Mm(thickness))) =
            (display.filter(), display.layers.last().map(|layer| &layer.thickness))
        else {
            return;
        };
        let Some(described) = file.display.matrix.iter().find_map(|matrix| matrix.filter.as_ref()) else {
            return;
        };
        if filter.height_mm > *thickness {
            let (height, glass) = (&described.height_um, &file.display.glass);
            let causes = [file.display.layers.origin, glass.origin];
            let thickness_at = glass.as_ref().map(|glass| glass.thickness_mm.origin);
            let wrong =
                Diagnostic::new(format!("the filter is {} um above the pixels", height.0)).expected(format!(
                    "a height within the medium above them, which is {} um thick",
                    mistake::tidy(*thickness / MM_PER_UM)
                ));
            self.errors.push(height.origin.or_override(causes).or_override(thickness_at), wrong);
        }
    }
}

/// A filter above pixels whose states do not make default ones.
fn no_states_below(names: &[String], known: &[String]) -> Diagnostic {
    let one = known.first().map_or("white", String::as_str);
    let below: Vec<String> = names.iter().map(|name| format!("{name} = \"{one}\"")).collect();
    Diagnostic::new("the states of the display with this filter are not described")
        .note(format!(
            "default states exist where the filter has red, green and blue and the pixel has the states white and black; this filter has {}, \
             and the pixel has the states {}",
            names.join(", "),
            known.join(", ")
        ))
        .hint(format!("describe them in [display.matrix.states]: {one} = {{ {} }}", below.join(", ")))
}

/// Returns the eight default states, if the filter has red, green and blue, and the pixel has white and
/// black.
fn default_states(names: &[String], known: &[String]) -> Vec<FilterState> {
    let is_one_of = |list: &[String], wanted: &str| list.iter().position(|name| name == wanted);
    let (Some(white), Some(black)) = (is_one_of(known, "white"), is_one_of(known, "black")) else {
        return Vec::new();
    };
    let primaries: Option<Vec<usize>> =
        ["red", "green", "blue"].into_iter().map(|name| is_one_of(names, name)).collect();
    let Some(primaries) = primaries else { return Vec::new() };
    let state = |(name, shares): (&str, [f64; 3])| {
        let mut pixel_states = vec![black; names.len()];
        for (primary, share) in primaries.iter().zip(shares) {
            pixel_states[*primary] = if share > 0.0 { white } else { black };
        }
        FilterState { name: name.to_owned(), pixel_states }
    };
    DEFAULT_STATES.map(state).to_vec()
}
