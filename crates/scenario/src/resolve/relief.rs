//! A surface by its geometry as the antiglare face whose sparkle is computed.

use std::sync::OnceLock;

use papilio_display::spatial::{Cells, Extent, Relief, Tile};
use papilio_microgeometry::{HeightMap, Statistics, Surface};
use papilio_sampling::SampleStream;

const UM: f64 = 1e-3;

/// A surface with heights, which are made when they are needed.
#[derive(Debug)]
pub(super) struct SurfaceRelief {
    surface: Surface,
    extent: Extent,
    heights: OnceLock<Heights>,
}

/// One realisation, and its statistics.
#[derive(Debug)]
struct Heights {
    map: HeightMap,
    rms_mm: f64,
    slope_rms: f64,
    correlation_mm: f64,
}

impl SurfaceRelief {
    /// Returns `None` for a surface that is flat, or that is not described by heights.
    pub(super) fn new(surface: Surface, is_mirrored: bool) -> Option<Self> {
        let extent = match &surface {
            Surface::Flat | Surface::Mesh(_) | Surface::Volume(_) => return None,
            // Of a map with its mirror images, a quarter is known.
            Surface::Heights(map) if is_mirrored => {
                let [width, height] = map.period_um().map(|period| UM * period);
                Extent::Known { area_mm2: 0.25 * width * height }
            }
            surface if surface.is_random() => Extent::Drawn,
            Surface::Heights(_) | Surface::Caps(_) | Surface::Random(_) => Extent::Periodic,
        };
        Some(Self { surface, extent, heights: OnceLock::new() })
    }

    fn heights(&self) -> &Heights {
        self.heights.get_or_init(|| {
            let map = self.realisation(0, [0.0; 2]);
            let Statistics { rms_um, slope_rms: [x, y], correlation_um, .. } = Statistics::of(&map);
            let slope_rms = (0.5 * (x * x + y * y)).sqrt();
            let rms_mm = UM * rms_um;
            // If the heights do not lose their correlation within the map: the length of Gaussian heights
            // with these slopes.
            let correlation_mm =
                correlation_um.map_or(2.0_f64.sqrt() * rms_mm / slope_rms, |length| UM * length);
            Heights { map, rms_mm, slope_rms, correlation_mm }
        })
    }

    /// Heights of a replicate, of a random surface over `wanted_mm` or more. The check of the surface has
    /// excluded that they cannot be made.
    fn realisation(&self, replicate: u64, wanted_mm: [f64; 2]) -> HeightMap {
        let least_um = wanted_mm[0].max(wanted_mm[1]) / UM;
        self.surface.heights_over(replicate, least_um).unwrap_or_else(|_| HeightMap::flat())
    }
}

/// A piece of a map, which repeats: the whole map if it is not larger than wanted, or else a part at a random
/// place with its mirror images, of the wanted size together.
fn piece(map: &HeightMap, numbers: &SampleStream, wanted_mm: [f64; 2]) -> HeightMap {
    let (pitch_um, all) = (map.pitch_um(), [map.columns(), map.rows()]);
    let wanted = [0, 1].map(|axis| (wanted_mm[axis] / (UM * pitch_um[axis])).ceil() as usize);
    if wanted[0] >= all[0] && wanted[1] >= all[1] {
        return map.clone();
    }
    let count = [0, 1].map(|axis| wanted[axis].div_ceil(2).clamp(1, all[axis]));
    let first = [0, 1].map(|axis| numbers.part(axis as u64).uniform_int(all[axis] as u64) as usize);
    map.part(first, count).mirrored()
}

impl Relief for SurfaceRelief {
    fn tile(&self, numbers: &SampleStream, wanted_mm: [f64; 2]) -> Tile {
        let map = match self.surface.is_random() {
            true => self.realisation(numbers.uniform_int(u64::from(u32::MAX)), wanted_mm),
            false => piece(&self.heights().map, numbers, wanted_mm),
        };
        let count = [map.columns(), map.rows()];
        let period_mm = map.period_um().map(|period| UM * period);
        let heights_mm = map.heights_um().iter().map(|height| UM * height).collect();
        Tile { cells: Cells { count, period_mm }, heights_mm }
    }

    fn rms_mm(&self) -> f64 {
        self.heights().rms_mm
    }

    fn slope_rms(&self) -> f64 {
        self.heights().slope_rms
    }

    fn correlation_mm(&self) -> f64 {
        self.heights().correlation_mm
    }

    fn extent(&self) -> Extent {
        self.extent
    }
}
