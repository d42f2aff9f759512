//! IES TM-27 (`.spdx`): XML with an element `SpectralData` for each wavelength.

use roxmltree::Node;

use super::{Kind, Sample, Source, SpectralFile};
use crate::error::FormatError;

const FORMAT: &str = "IES TM-27";

pub(super) fn read(name: &str, source: &str, root: Node<'_, '_>) -> Result<SpectralFile, FormatError> {
    let source = Source { name, text: source, format: FORMAT };
    let find = |tag: &str| root.descendants().find(|node| node.tag_name().name() == tag);
    let text = |tag: &str| find(tag).and_then(|node| node.text()).unwrap_or_default().trim().to_owned();
    let kind = match text("SpectralQuantity").to_ascii_lowercase().as_str() {
        "reflectance" | "r-factor" => Kind::Reflectance,
        "transmittance" | "t-factor" => Kind::Transmittance,
        "absorptance" => Kind::Absorptance,
        "" | "other" => Kind::Unstated,
        "flux" | "intensity" | "irradiance" | "radiance" | "exitance" | "relative" => Kind::Light,
        other => {
            let at = find("SpectralQuantity").map_or(0..0, |node| node.range());
            return Err(source.at(at, format!("`{other}` is not a SpectralQuantity of TM-27")));
        }
    };
    let mut sample = Sample { name: text("Description"), at: root.range(), ..Sample::default() };
    for node in root.descendants().filter(|node| node.tag_name().name() == "SpectralData") {
        let number = |text: Option<&str>| text?.trim().parse().ok().filter(|value: &f64| value.is_finite());
        match (number(node.attribute("wavelength")), number(node.text())) {
            (Some(nm), Some(value)) => sample.spectrum.push((nm, value, node.range())),
            _ => {
                let what = "SpectralData needs a number, and an attribute `wavelength` in nm".to_owned();
                return Err(source.at(node.range(), what));
            }
        }
    }
    let is_corrected = text("BandwidthCorrected") == "true";
    let bandwidth: Option<f64> = text("BandwidthFWHM").parse().ok();
    let mut file = SpectralFile::new(FORMAT, kind, Vec::new(), Vec::new());
    if let Some(width) = bandwidth.filter(|width| *width > 5.0 && !is_corrected) {
        file.notes.push(format!("the bandwidth of {width} nm is not corrected for"));
    }
    if !sample.spectrum.is_empty() {
        file.samples.push(sample);
    }
    file.divide_per_cent();
    Ok(file)
}
