//! Writer of a display's BSDF as a tensor file of the RGL material database (`.bsdf`), which the plugin `measured` of Mitsuba and
//! the material `measured` of pbrt-v4 load.
//!
//! The distribution of visible normals is uniform, so that the grid of values is that of the half vectors ([`HalfVectorGrid`]). The
//! values are f cos(theta_o), without a Jacobian; below the horizon they are 0. `luminance` is what a renderer samples: its density
//! over the half vectors is proportional to the mean of f cos(theta_o) over wavelengths. The mirror part is not in the file, because it
//! has no finite value per steradian.

use std::io::{self, Write};

use papilio_display::{HalfVectorGrid, HalfVectorTable};

use super::display::BsdfSource;

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
    let grid = &table.grid;
    let (lights, size, bins) = (grid.theta_i_deg.len(), grid.size, table.wavelength_nm.len());
    let found = table.states.get(state).ok_or_else(|| unsound("there is no such state"))?;
    let viewers: Vec<Vec<Option<usize>>> = (0..lights).map(|light| grid.viewers(light).1).collect();
    let counts: Vec<usize> = (0..lights).map(|light| grid.viewers(light).0.len()).collect();
    if bins == 0 || size < 2 || found.brdf.len() != counts.iter().sum::<usize>() * bins {
        return Err(unsound("the BSDF does not match its directions"));
    }
    let mut spectra = Vec::with_capacity(lights * bins * size * size);
    let mut luminance = Vec::with_capacity(lights * size * size);
    let mut rest = found.brdf.as_slice();
    for ((theta_i, numbers), count) in grid.theta_i_deg.iter().zip(&viewers).zip(&counts) {
        let (of_light, others) = rest.split_at(count * bins);
        rest = others;
        let nodes = Nodes::new(grid, *theta_i, numbers, of_light, bins);
        (0..bins).for_each(|bin| spectra.extend(nodes.values(bin)));
        luminance.extend(nodes.luminance());
    }
    let description = format!(
        "{}; state {}; papilio {}; scenario {}",
        source.title, found.name, source.papilio, source.hash
    );
    let theta_i: Vec<f32> = grid.theta_i_deg.iter().map(|deg| deg.to_radians() as f32).collect();
    let wavelengths: Vec<f32> = table.wavelength_nm.iter().map(|nm| *nm as f32).collect();
    let (ones, uniform) = ([1.0; 4], vec![1.0; 4 * lights]);
    let fields = [
        Field {
            name: "description",
            shape: vec![description.len()],
            items: Items::Bytes(description.as_bytes()),
        },
        Field { name: "phi_i", shape: vec![1], items: Items::Single(&[0.0]) },
        Field { name: "theta_i", shape: vec![lights], items: Items::Single(&theta_i) },
        Field { name: "wavelengths", shape: vec![bins], items: Items::Single(&wavelengths) },
        Field { name: "ndf", shape: vec![2, 2], items: Items::Single(&ones) },
        Field { name: "sigma", shape: vec![2, 2], items: Items::Single(&ones) },
        Field { name: "vndf", shape: vec![1, lights, 2, 2], items: Items::Single(&uniform) },
        Field { name: "luminance", shape: vec![1, lights, size, size], items: Items::Single(&luminance) },
        Field { name: "spectra", shape: vec![1, lights, bins, size, size], items: Items::Single(&spectra) },
        Field { name: "jacobian", shape: vec![1], items: Items::Bytes(&[0]) },
    ];
    write_tensors(&mut out, &fields)?;
    out.flush()
}

/// The nodes of one direction of the light.
struct Nodes<'a> {
    grid: &'a HalfVectorGrid,
    theta_i_deg: f64,
    /// Number of the viewer of each node.
    numbers: &'a [Option<usize>],
    /// Cosine of the viewer of each node; 0 below the horizon.
    cosines: Vec<f64>,
    /// BRDF, `[viewer][wavelength]`.
    brdf: &'a [f32],
    bins: usize,
}

impl<'a> Nodes<'a> {
    fn new(
        grid: &'a HalfVectorGrid,
        theta_i_deg: f64,
        numbers: &'a [Option<usize>],
        brdf: &'a [f32],
        bins: usize,
    ) -> Self {
        let cosine = |(node, number): (usize, &Option<usize>)| {
            let at = grid.node(node % grid.size, node / grid.size);
            let viewer = number.and_then(|_| HalfVectorGrid::viewer(theta_i_deg, at));
            viewer.map_or(0.0, |viewer| viewer.cos_theta_o)
        };
        let cosines = numbers.iter().enumerate().map(cosine).collect();
        Self { grid, theta_i_deg, numbers, cosines, brdf, bins }
    }

    /// Values of a wavelength at all nodes: f cos(theta_o). Slightly negative values, which are discretisation errors, are
    /// written as 0.
    fn values(&self, bin: usize) -> impl Iterator<Item = f32> {
        let f = move |number: usize| f64::from(self.brdf[number * self.bins + bin].max(0.0));
        self.numbers
            .iter()
            .zip(&self.cosines)
            .map(move |(number, cosine)| number.map_or(0.0, |number| (f(number) * cosine) as f32))
    }

    /// Density of the viewers over the nodes, not normalised. Where nothing is scattered, it is that of a Lambertian display, because
    /// readers normalise it.
    fn luminance(&self) -> Vec<f32> {
        let density = |f: &dyn Fn(usize) -> f64| -> Vec<f32> {
            let nodes = self.numbers.iter().zip(&self.cosines).enumerate();
            nodes
                .map(|(node, (number, cosine))| {
                    let at = self.grid.node(node % self.grid.size, node / self.grid.size);
                    let jacobian = HalfVectorGrid::jacobian(self.theta_i_deg, at);
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

fn unsound(message: &'static str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}
