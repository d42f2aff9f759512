//! Pairs of a measured state and its simulated counterpart.

use papilio_colour::{ColourError, Lab, Observer, Xyz, peak_nm};
use papilio_spectra::{Grid, SpectraError, Tabulated};

use super::deviation::z_of_measured;
use super::left_out::{LeftOut, NO_SUCH_STATE};
use super::{
    Agreement, Colour, Measured, NEAREST_DEG, Quantity, Simulated, SimulatedState, SimulatedView,
    SpectrumComparison, StandardDeviation, StateComparison,
};

/// Note on states that are found without the case of their letters.
const OTHER_CAPITALS: &str = "read as the states of the result whose names differ in capital letters only";

/// Angle between a measured direction and its view, degrees, beyond which it is noted.
const NOTED_DEG: f64 = 0.05;

/// Comparison of a state, with the number of its view.
pub(super) struct Pair {
    pub(super) view: usize,
    pub(super) comparison: StateComparison,
}

/// Finds the simulated counterpart of a measured state and compares the two, with notes if their names
/// differ in the case of letters, or their directions; fails with the reason if there is none.
pub(super) fn pair(simulated: &Simulated, measured: &Measured) -> Result<(Pair, Vec<LeftOut>), LeftOut> {
    let Measured { state, theta_deg, phi_deg, quantity, standard_deviation } = measured;
    let direction = theta_deg.map(|theta_deg| [theta_deg, *phi_deg]);
    let left_out = |why: String| LeftOut { state: state.clone(), direction, why };
    let (index, view) = view_at(simulated, direction).map_err(left_out)?;
    let found = named(view, state).ok_or_else(|| left_out(NO_SUCH_STATE.to_owned()))?;
    let SimulatedState { name, reflectance_factor, xyz, deviation } = found;
    let capitals = (name != state).then(|| left_out(OTHER_CAPITALS.to_owned()));
    let notes = capitals.into_iter().chain(beside(view, direction).map(left_out)).collect();
    let compared = match quantity {
        Quantity::Xyz(measured) => simulated.colours(*xyz, |_| *measured),
        Quantity::Lab(measured) => simulated.colours(*xyz, |white| measured.xyz(white)),
        Quantity::Spectrum(spectrum) => simulated.spectra(
            (reflectance_factor, &deviation.reflectance_factor),
            (spectrum, standard_deviation.as_ref()),
        ),
    };
    let (colours, spectrum) = compared.map_err(|reason| left_out(reason.to_string()))?;
    let [(simulated_xyz, simulated), (measured_xyz, measured)] = colours;
    let z = deviation.z(quantity, standard_deviation.as_ref(), [&simulated, &measured], spectrum.as_ref());
    // A coarse measurement has fewer numbers than the grid on which spectra are compared.
    let counted = match (quantity, &spectrum) {
        (Quantity::Spectrum(measured), Some(both)) => {
            z_of_measured(&z, &both.wavelength_nm, measured.wavelengths_nm())
        }
        _ => z.clone(),
    };
    let comparison = StateComparison {
        state: name.clone(),
        theta_deg: view.theta_deg,
        phi_deg: view.phi_deg,
        delta_E_2000: lab(&simulated).zip(lab(&measured)).map(|(a, b)| a.delta_e_2000(b)),
        distance_uv: simulated_xyz.uv_prime().zip(measured_xyz.uv_prime()).map(|(a, b)| a.distance(b)),
        difference_Y: simulated.Y - measured.Y,
        simulated,
        measured,
        spectrum,
        agreement: Agreement::of(counted.into_iter()),
        z,
    };
    Ok((Pair { view: index, comparison }, notes))
}

/// Note on a measured direction that is not that of the view.
pub(super) fn beside(view: &SimulatedView, direction: Option<[f64; 2]>) -> Option<String> {
    let (theta, phi) = (view.theta_deg, view.phi_deg);
    let azimuth = if phi == 0.0 { String::new() } else { format!(", azimuth {phi} deg") };
    direction.filter(|direction| between([theta, phi], *direction) > NOTED_DEG).map(|_| {
        format!("measured beside the view of {theta} deg{azimuth} with which it is compared (viewer.theta_deg sets the view)")
    })
}

/// Returns the view nearest to a measured direction, with its number; fails with the reason if there is none.
pub(super) fn view_at(
    simulated: &Simulated,
    direction: Option<[f64; 2]>,
) -> Result<(usize, &SimulatedView), String> {
    match (direction, &simulated.views[..]) {
        (Some(direction), views) => {
            let away = |view: &SimulatedView| between([view.theta_deg, view.phi_deg], direction);
            let nearest = views.iter().enumerate().min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
            nearest
                .filter(|(_, view)| away(view) <= NEAREST_DEG)
                .ok_or_else(|| format!("no view of the result is within {NEAREST_DEG} deg"))
        }
        (None, [only]) => Ok((0, only)),
        (None, several) => Err(format!(
            "the measurement states no angle, and the result has several views (a table can have a column `theta_deg`; for any other \
             file, compute the view of the meter alone: viewer.theta_deg = {})",
            several.first().map_or(0.0, |view| view.theta_deg)
        )),
    }
}

/// Returns the state of a view with this name, or else the only one whose name differs in the case of letters
/// alone.
pub(super) fn named<'a>(view: &'a SimulatedView, name: &str) -> Option<&'a SimulatedState> {
    let exact = view.states.iter().find(|known| known.name == name);
    exact.or_else(|| {
        let mut same_letters =
            view.states.iter().filter(|known| known.name.to_lowercase() == name.to_lowercase());
        same_letters.next().filter(|_| same_letters.next().is_none())
    })
}

type Colours = [(Xyz, Colour); 2];

impl Simulated {
    fn colours(
        &self,
        simulated: Xyz,
        measured: impl FnOnce(Xyz) -> Xyz,
    ) -> Result<(Colours, Option<SpectrumComparison>), Unequal> {
        let observer = Observer::of(self.observer, &self.grid)?;
        let white = observer.xyz(&self.radiance_of_white);
        let white = white * (1.0 / white.y);
        Ok(([simulated, measured(white)].map(|xyz| (xyz, colour(xyz, white, None))), None))
    }

    /// Compares both spectra, each with its standard deviations, over their common wavelength range.
    fn spectra(
        &self,
        (simulated, simulated_deviation): (&[f64], &[f64]),
        (measured, measured_deviation): (&Tabulated, Option<&StandardDeviation>),
    ) -> Result<(Colours, Option<SpectrumComparison>), Unequal> {
        let (from, to) = measured.range_nm();
        let inside = |i: &usize| (from..=to).contains(&self.grid.wavelength_nm(*i));
        let inside: Vec<usize> = (0..self.grid.len()).filter(inside).collect();
        let (Some(&first), Some(&last)) = (inside.first(), inside.last()) else {
            return Err(Unequal::NoCommonRange { from, to });
        };
        let common =
            Grid::new(self.grid.wavelength_nm(first), self.grid.wavelength_nm(last), self.grid.step_nm())
                .map_err(|_| Unequal::NoCommonRange { from, to })?;
        let (simulated, measured) = (&simulated[first..=last], measured.on(&common)?);
        let light = &self.radiance_of_white[first..=last];
        let observer = Observer::of(self.observer, &common)?;
        let white = observer.xyz(light);
        let seen = |factor: &[f64]| {
            let radiance: Vec<f64> = factor.iter().zip(light).map(|(rho, light)| rho * light).collect();
            let xyz = observer.xyz(&radiance) * (1.0 / white.y);
            (xyz, colour(xyz, white * (1.0 / white.y), peak_nm(&common, factor)))
        };
        let colours = [simulated, &*measured].map(seen);
        if colours[1].0.y < 0.0 {
            return Err(Unequal::Negative { y: colours[1].0.y });
        }
        let mut compared = differences(&common, simulated, &measured);
        if let Some(StandardDeviation::Spectrum(deviation)) = measured_deviation {
            compared.measured_deviation = deviation.on(&common)?.to_vec();
        }
        compared.simulated_deviation = simulated_deviation.get(first..=last).unwrap_or_default().to_vec();
        Ok((colours, Some(compared)))
    }
}

/// Reason why two spectra cannot be compared.
#[derive(Debug, thiserror::Error)]
enum Unequal {
    #[error("the measured wavelengths, {from} to {to} nm, do not overlap those of the result")]
    NoCommonRange { from: f64, to: f64 },
    #[error("the measured Y is negative, {y:.4}: check the dark signal of the measurement")]
    Negative { y: f64 },
    #[error(transparent)]
    Spectra(#[from] SpectraError),
    #[error(transparent)]
    Colour(#[from] ColourError),
}

fn differences(grid: &Grid, simulated: &[f64], measured: &[f64]) -> SpectrumComparison {
    let differences: Vec<f64> = simulated.iter().zip(measured).map(|(a, b)| a - b).collect();
    let count = differences.len() as f64;
    let largest = (0..differences.len())
        .fold(0, |best, i| if differences[i].abs() > differences[best].abs() { i } else { best });
    SpectrumComparison {
        wavelength_nm: grid.wavelengths_nm(),
        simulated: simulated.to_vec(),
        measured: measured.to_vec(),
        mean_difference: differences.iter().sum::<f64>() / count,
        rms_difference: (differences.iter().map(|d| d * d).sum::<f64>() / count).sqrt(),
        largest_difference: differences[largest],
        largest_at_nm: grid.wavelength_nm(largest),
        measured_deviation: Vec::new(),
        simulated_deviation: Vec::new(),
    }
}

fn colour(xyz: Xyz, white: Xyz, peak_nm: Option<f64>) -> Colour {
    let (uv, lab) = (xyz.uv_prime(), xyz.lab(white));
    Colour {
        X: xyz.x,
        Y: xyz.y,
        Z: xyz.z,
        u_prime: uv.map(|c| c.u),
        v_prime: uv.map(|c| c.v),
        L_star: lab.map(|c| c.l),
        a_star: lab.map(|c| c.a),
        b_star: lab.map(|c| c.b),
        contrast: None,
        peak_nm,
    }
}

fn lab(colour: &Colour) -> Option<Lab> {
    Some(Lab { l: colour.L_star?, a: colour.a_star?, b: colour.b_star? })
}

/// Returns the angle between two directions, degrees.
pub(super) fn between(one: [f64; 2], other: [f64; 2]) -> f64 {
    let vector = |[theta, phi]: [f64; 2]| {
        let ((sin, cos), (sin_phi, cos_phi)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
        [sin * cos_phi, sin * sin_phi, cos]
    };
    let ([ax, ay, az], [bx, by, bz]) = (vector(one), vector(other));
    let cross = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    let sine = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
    sine.atan2(ax * bx + ay * by + az * bz).to_degrees()
}
