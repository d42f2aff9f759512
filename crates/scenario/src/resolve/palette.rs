//! Pixels whose states have measured colours: spectra, or the smoothest spectra with given L\*, a\*, b\*.

use papilio_colour::{Lab, Observer, Standard};
use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{UniformKind, UniformPixel};
use papilio_formats::{PaletteTable, read_palette};
use papilio_optics::saunderson::DiffuseFace;
use papilio_spectra::{Grid, Spectrum, Tabulated, illuminant, illuminant_name};

use super::Resolver;
use super::through::impossible;
use crate::describe::File;
use crate::describe::display::MaterialSpec;
use crate::describe::numbers::Index;
use crate::describe::pixel::{PalettePixel, Pixel};
use crate::mistake::{self, tidy};
use crate::read::Spanned;

/// Wavelengths at which spectra of CIELAB colours are computed: those of the observer. Beyond them, the
/// values at the ends continue.
const RANGE_NM: [f64; 2] = [380.0, 780.0];
const STEP_NM: f64 = 5.0;

impl Resolver<'_> {
    /// Resolves a palette as Lambertian states.
    pub(super) fn palette(&mut self, pixel: &Spanned<PalettePixel>) -> Option<UniformPixel> {
        let table = self.data_with_notes(&pixel.file, pixel.file.origin, read_palette)?;
        let count = match &table {
            PaletteTable::Spectra(states) => states.len(),
            PaletteTable::Lab { colours, .. } => colours.len(),
        };
        self.limit(&pixel.file, "states", count, 256)?;
        // Spectra do not need the illuminant, but a wrong name is a mistake.
        let [first, last] = RANGE_NM;
        let grid = Grid::new(first, last, STEP_NM).ok()?;
        let name = self.light_of_palette(pixel, &table)?;
        let Ok(light) = illuminant(&name, &grid) else {
            self.err(&pixel.illuminant, mistake::unknown_light(&name));
            return None;
        };
        let face = self.face(&pixel.measured_through);
        let states = match table {
            PaletteTable::Spectra(states) => {
                let spectra = states.into_iter();
                spectra
                    .map(|(name, table)| {
                        let measured = self.measured_spectrum(pixel, &table)?;
                        let own = self.below(face, (name.as_str(), measured), pixel.file.origin)?;
                        Some((name, own))
                    })
                    .collect::<Option<_>>()?
            }
            PaletteTable::Lab { colours, observer, .. } => {
                let observer = Observer::of(observer.unwrap_or(Standard::Cie1931), &grid).ok()?;
                self.warnings.push(format!(
                    "{}: of L*, a*, b* only the colour in {} is known; its smoothest spectra are used, and colours in other light are estimates",
                    pixel.file.value, name
                ));
                colours
                    .into_iter()
                    .map(|(name, lab)| self.smoothest(pixel, (&grid, &light, &observer), face, (name, lab)))
                    .collect::<Option<_>>()?
            }
        };
        let spread_mm = self.spread_within(&pixel.spread_um)?;
        Some(UniformPixel { kind: UniformKind::Lambertian, states, spread_mm })
    }

    /// Returns the name of the illuminant of a palette: that of the file, which the key must not contradict, or that of the key.
    fn light_of_palette(&mut self, pixel: &Spanned<PalettePixel>, table: &PaletteTable) -> Option<String> {
        let key = &pixel.illuminant;
        let stated = match table {
            PaletteTable::Lab { illuminant, .. } => illuminant.as_ref(),
            PaletteTable::Spectra(_) => None,
        };
        if let (Some(name), Some(stated)) = (&key.value, stated)
            && illuminant_name(name) != Some(stated.as_str())
        {
            let wrong = Diagnostic::new(format!(
                "{} states that its colours are those in {stated}",
                pixel.file.value
            ))
            .expected(format!("illuminant = \"{stated}\", or none: the file's is used"));
            self.err(key, wrong);
            return None;
        }
        Some(key.value.as_ref().or(stated).map_or_else(|| "D50".to_owned(), String::clone))
    }

    /// Warns if a palette, which was measured through a surface, has a second one, or if inks below a face
    /// have no face in the display.
    pub(super) fn check_surface(&mut self, file: &File) {
        let through = match &file.display.pixel.value {
            Pixel::Palette(palette) => palette.measured_through.as_ref(),
            Pixel::Uniform(uniform) => uniform.measured_through.as_ref(),
            _ => None,
        };
        if let Some(through) = through {
            let glass = file.display.glass.as_ref().map(|glass| &glass.index.value);
            let is_bare = matches!(glass, Some(MaterialSpec::Number(Index(index))) if *index == 1.0);
            if is_bare && file.display.diffuser.is_none() {
                self.warnings.push(format!(
                    "display.pixel.measured_through: the reflectances below the face are used, but the display has no face; add [display.glass] \
                     with index = {} to see the panel that was measured",
                    tidy(through.index.0)
                ));
            }
            return;
        }
        let (Pixel::Palette(_), Some(glass)) = (&file.display.pixel.value, &file.display.glass.value) else {
            return;
        };
        let is_air = matches!(glass.index.value, MaterialSpec::Number(Index(index)) if index == 1.0);
        if !is_air {
            self.warnings.push(
                "display.glass lies above a palette, which was measured through the panel's own surface: its reflections are added to those \
                 of the measurement; remove [display.glass] unless it is another sheet of glass on the panel"
                    .to_owned(),
            );
        }
    }

    fn measured_spectrum(&mut self, pixel: &PalettePixel, table: &Tabulated) -> Option<Spectrum> {
        self.fractions(&pixel.file, pixel.file.origin, table)
    }

    fn smoothest(
        &mut self,
        pixel: &PalettePixel,
        (grid, light, observer): (&Grid, &Spectrum, &Observer),
        face: Option<DiffuseFace>,
        (name, lab): (String, Lab),
    ) -> Option<(String, Spectrum)> {
        let [first, last] = RANGE_NM;
        let white = observer.xyz(light);
        let white = white * (1.0 / white.y);
        let mut colour = lab.xyz(white);
        if let Some(face) = face {
            // Without the light that the face reflects itself: the smoothest spectrum is that of the light
            // from below.
            if !(face.least()..=face.most()).contains(&colour.y) {
                let wrong = impossible(
                    &format!("Y = {}", tidy((colour.y * 1e4).round() / 1e4)),
                    colour.y,
                    &name,
                    face,
                );
                self.errors.push(pixel.file.origin, wrong);
                return None;
            }
            colour = (colour - white * face.least()) * (1.0 / (1.0 - face.view()));
        }
        let spectrum = observer.smoothest(light, colour);
        let Some(spectrum) = spectrum else {
            let [l, a, b] = [lab.l, lab.a, lab.b].map(tidy);
            let wrong = Diagnostic::new(format!("no surface has the colour of state `{name}`, L* {l}, a* {a}, b* {b}"))
                .expected("colours that a reflectance between 0 and 1 can have in this illuminant")
                .hint("check the numbers, and the key `illuminant`: colours of cameras and screens are not measured colours");
            self.errors.push(pixel.file.origin, wrong);
            return None;
        };
        let spectrum = match face {
            Some(face) => spectrum.map(|below| face.own(face.least() + (1.0 - face.view()) * below)),
            None => spectrum,
        };
        let table = Tabulated::new(grid.wavelengths_nm(), spectrum.to_vec()).ok()?;
        let values = self.grid.wavelengths_nm().into_iter().map(|nm| table.at(nm.clamp(first, last)));
        Some((name, Spectrum::from_values(values.collect::<Result<_, _>>().ok()?)))
    }
}
