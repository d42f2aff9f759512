//! Writer of a display's BSDF as a tensor file of the RGL material database (`.bsdf`), which the plugin
//! `measured` of Mitsuba and the material `measured` of pbrt-v4 load.
//!
//! The distribution of visible normals of the file is the density of the grid's nodes ([`HalfVectorGrid`]),
//! which a reader inverts to find the place of a half vector between the nodes. The values are f
//! cos(theta_o), without a Jacobian; below the horizon they are 0. `luminance` is what a renderer samples:
//! its density over the nodes is proportional to the mean of f cos(theta_o) over wavelengths. The mirror part
//! is not in the file, because it has no finite value per steradian.

use std::io::{self, Write};

use papilio_display::{HalfVectorGrid, HalfVectorTable, NodeDensity};
use papilio_goniometry::{Channel, Geometry, MeasuredPart, ScatterMode, WarpFields, WarpedGrid};

use super::display::BsdfSource;
use super::tristimulus::luminous_weights;

/// Magic bytes and version 1.0.
const HEAD: &[u8] = b"tensor_file\0\x01\x00";

/// Element types of the format.
const UINT8: u8 = 1;
const FLOAT32: u8 = 10;

/// Multiple of bytes at which arrays begin.
const ALIGNMENT: usize = 8;

/// Writes the BSDF of one state, number `state`, as an RGL tensor file.
///
/// # Errors
/// Those of `out`, and if the lengths of the table's arrays do not match its grid.
pub fn write_rgl(
    mut out: impl Write,
    source: &BsdfSource<'_>,
    table: &HalfVectorTable,
    state: usize,
) -> io::Result<()> {
    let (grid, found) =
        (&table.grid, table.states.get(state).ok_or_else(|| unsound("there is no such state"))?);
    let (thetas, size, bins) = (grid.theta_i_deg.len(), grid.size, table.wavelength_nm.len());
    let azimuths = grid.phi_i_deg.len().max(1);
    let lights = thetas * azimuths;
    let mut spectra = Vec::with_capacity(lights * bins * size * size);
    let mut luminance = Vec::with_capacity(lights * size * size);
    let mut densities = Vec::new();
    for nodes in Nodes::of_lights(table, state)? {
        (0..bins).for_each(|bin| spectra.extend(nodes.values(bin)));
        luminance.extend(nodes.luminance());
        densities.extend_from_slice(nodes.density.values());
    }
    let columns = densities.len() / (lights * size).max(1);
    let description = format!(
        "{}; state {}; papilio {}; scenario {}",
        source.title, found.name, source.papilio, source.hash
    );
    let phi_i: Vec<f32> = azimuths_of(grid).iter().map(|phi| *phi as f32).collect();
    let theta_i: Vec<f32> = grid.theta_i_deg.iter().map(|deg| deg.to_radians() as f32).collect();
    let wavelengths: Vec<f32> = table.wavelength_nm.iter().map(|nm| *nm as f32).collect();
    let ones = [1.0; 4];
    let fields = [
        Field {
            name: "description",
            shape: vec![description.len()],
            items: Items::Bytes(description.as_bytes()),
        },
        Field { name: "phi_i", shape: vec![azimuths], items: Items::Single(&phi_i) },
        Field { name: "theta_i", shape: vec![thetas], items: Items::Single(&theta_i) },
        Field { name: "wavelengths", shape: vec![bins], items: Items::Single(&wavelengths) },
        Field { name: "ndf", shape: vec![2, 2], items: Items::Single(&ones) },
        Field { name: "sigma", shape: vec![2, 2], items: Items::Single(&ones) },
        Field {
            name: "vndf",
            shape: vec![azimuths, thetas, size, columns],
            items: Items::Single(&densities),
        },
        Field {
            name: "luminance",
            shape: vec![azimuths, thetas, size, size],
            items: Items::Single(&luminance),
        },
        Field {
            name: "spectra",
            shape: vec![azimuths, thetas, bins, size, size],
            items: Items::Single(&spectra),
        },
        Field { name: "jacobian", shape: vec![1], items: Items::Bytes(&[0]) },
    ];
    write_tensors(&mut out, &fields)?;
    out.flush()
}

/// Azimuths of the light in the file, radians: one stands for all of an isotropic display.
fn azimuths_of(grid: &HalfVectorGrid) -> Vec<f64> {
    if grid.phi_i_deg.is_empty() {
        return vec![0.0];
    }
    grid.phi_i_deg.iter().map(|phi| phi.to_radians()).collect()
}

/// Returns the luminous values of the file of one state in D65, as its readers understand them.
pub(super) fn luminous_part(table: &HalfVectorTable, state: usize) -> io::Result<MeasuredPart> {
    let grid = &table.grid;
    let weights = luminous_weights(&table.wavelength_nm);
    let (mut values, mut densities, mut columns) = (Vec::new(), Vec::new(), 0);
    for nodes in Nodes::of_lights(table, state)? {
        let mut sums = vec![0.0; grid.size * grid.size];
        for (bin, weight) in weights.iter().enumerate() {
            sums.iter_mut().zip(nodes.values(bin)).for_each(|(sum, value)| *sum += weight * f64::from(value));
        }
        values.extend(sums);
        columns = nodes.density.columns();
        densities.extend(nodes.density.values().iter().map(|value| f64::from(*value)));
    }
    let fields = WarpFields {
        phi_i: azimuths_of(grid),
        theta_i: grid.theta_i_deg.iter().map(|theta| theta.to_radians()).collect(),
        ndf: (vec![1.0; 4], [2, 2]),
        sigma: (vec![1.0; 4], [2, 2]),
        vndf: (densities, [grid.size, columns]),
        shape: [grid.size; 2],
        jacobian: false,
    };
    let warped =
        WarpedGrid::new(fields).ok_or_else(|| unsound("the densities of the nodes are not sound"))?;
    Ok(MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels: vec![Channel::Y],
        geometry: Geometry::Warped(Box::new(warped)),
        values,
        tis: Vec::new(),
    })
}

/// The nodes of one direction of the light.
struct Nodes<'a> {
    theta_i_deg: f64,
    size: usize,
    /// u and v of each node.
    places: Vec<[f64; 2]>,
    density: NodeDensity,
    /// Number of the viewer of each node.
    numbers: Vec<Option<usize>>,
    /// Cosine of the viewer of each node; 0 below the horizon.
    cosines: Vec<f64>,
    /// BRDF, `[viewer][wavelength]`.
    brdf: &'a [f32],
    bins: usize,
}

impl<'a> Nodes<'a> {
    /// Returns the nodes of all directions of the light of a state, number `state`, in the order of the file: the inclination fastest.
    fn of_lights(table: &'a HalfVectorTable, state: usize) -> io::Result<Vec<Self>> {
        let (grid, bins) = (&table.grid, table.wavelength_nm.len());
        let found = table.states.get(state).ok_or_else(|| unsound("there is no such state"))?;
        let (thetas, azimuths) = (grid.theta_i_deg.len(), grid.phi_i_deg.len().max(1));
        let viewers: Vec<_> = (0..thetas * azimuths).map(|light| grid.viewers(light)).collect();
        let count: usize = viewers.iter().map(|(different, _)| different.len()).sum();
        if bins == 0 || grid.size < 2 || found.brdf.len() != count * bins {
            return Err(unsound("the BSDF does not match its directions"));
        }
        let mut rest = found.brdf.as_slice();
        let of_light = |(light, (different, numbers)): (usize, (Vec<_>, Vec<Option<usize>>))| {
            let (own, others) = rest.split_at(different.len() * bins);
            rest = others;
            Self::new(grid, light, numbers, (own, bins))
        };
        let mut nodes: Vec<Self> = viewers.into_iter().enumerate().map(of_light).collect();
        if azimuths > 1 {
            let mut by_inclination = nodes.into_iter().enumerate().collect::<Vec<_>>();
            by_inclination.sort_by_key(|(light, _)| (light % azimuths, light / azimuths));
            nodes = by_inclination.into_iter().map(|(_, nodes)| nodes).collect();
        }
        Ok(nodes)
    }

    fn new(
        grid: &HalfVectorGrid,
        light: usize,
        numbers: Vec<Option<usize>>,
        (brdf, bins): (&'a [f32], usize),
    ) -> Self {
        let (theta_i_deg, places) =
            (grid.theta_i_deg[light / grid.phi_i_deg.len().max(1)], grid.nodes(light));
        let cosine = |(at, number): (&[f64; 2], &Option<usize>)| {
            let viewer = number.and_then(|_| HalfVectorGrid::viewer(theta_i_deg, *at));
            viewer.map_or(0.0, |viewer| viewer.cos_theta_o)
        };
        let cosines = places.iter().zip(&numbers).map(cosine).collect();
        Self {
            theta_i_deg,
            size: grid.size,
            places,
            density: grid.density(light),
            numbers,
            cosines,
            brdf,
            bins,
        }
    }

    /// Values of a wavelength at all nodes: f cos(theta_o). Slightly negative values, which are
    /// discretisation errors, are written as 0.
    fn values(&self, bin: usize) -> impl Iterator<Item = f32> {
        let f = move |number: usize| f64::from(self.brdf[number * self.bins + bin].max(0.0));
        self.numbers
            .iter()
            .zip(&self.cosines)
            .map(move |(number, cosine)| number.map_or(0.0, |number| (f(number) * cosine) as f32))
    }

    /// Density of the viewers over the nodes, not normalised. Where nothing is scattered, it is that of a
    /// Lambertian display, because readers normalise it.
    fn luminance(&self) -> Vec<f32> {
        let density = |f: &dyn Fn(usize) -> f64| -> Vec<f32> {
            let nodes = self.numbers.iter().zip(&self.cosines).enumerate();
            nodes
                .map(|(node, (number, cosine))| {
                    let at = self.places[node];
                    let per_u = self.density.at(node / self.size, at[0]);
                    let jacobian =
                        HalfVectorGrid::jacobian(self.theta_i_deg, at) / per_u.max(f64::MIN_POSITIVE);
                    number.map_or(0.0, |number| (f(number) * cosine * jacobian) as f32)
                })
                .collect()
        };
        let mean = |number: usize| {
            let spectrum = &self.brdf[number * self.bins..][..self.bins];
            spectrum.iter().map(|f| f64::from(f.max(0.0))).sum::<f64>() / self.bins as f64
        };
        let found = density(&mean);
        if found.iter().any(|value| *value > 0.0) { found } else { density(&|_| 1.0) }
    }
}

/// An array of a tensor file.
struct Field<'a> {
    name: &'static str,
    shape: Vec<usize>,
    items: Items<'a>,
}

/// Elements of an array.
enum Items<'a> {
    Bytes(&'a [u8]),
    Single(&'a [f32]),
}

impl Items<'_> {
    fn bytes(&self) -> usize {
        match self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Single(numbers) => 4 * numbers.len(),
        }
    }

    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Bytes(bytes) => out.write_all(bytes),
            Self::Single(numbers) => {
                numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
            }
        }
    }
}

/// Writes the header and the arrays, each at a multiple of [`ALIGNMENT`].
fn write_tensors(out: &mut dyn Write, fields: &[Field<'_>]) -> io::Result<()> {
    let entry = |field: &Field<'_>| 2 + field.name.len() + 2 + 1 + 8 + 8 * field.shape.len();
    let mut end = HEAD.len() + 4 + fields.iter().map(entry).sum::<usize>();
    let mut header = HEAD.to_vec();
    header.extend((fields.len() as u32).to_le_bytes());
    let mut gaps = Vec::new();
    for field in fields {
        let offset = end.next_multiple_of(ALIGNMENT);
        gaps.push(offset - end);
        end = offset + field.items.bytes();
        header.extend((field.name.len() as u16).to_le_bytes());
        header.extend(field.name.as_bytes());
        header.extend((field.shape.len() as u16).to_le_bytes());
        header.push(if let Items::Bytes(_) = field.items { UINT8 } else { FLOAT32 });
        header.extend((offset as u64).to_le_bytes());
        field.shape.iter().for_each(|length| header.extend((*length as u64).to_le_bytes()));
    }
    out.write_all(&header)?;
    for (field, gap) in fields.iter().zip(gaps) {
        out.write_all(&[0; ALIGNMENT][..gap])?;
        field.items.write(out)?;
    }
    Ok(())
}

fn unsound(message: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message.to_owned())
}
