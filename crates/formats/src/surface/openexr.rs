//! Maps of heights in OpenEXR files: the channel `Z`, `Y`, or the only one.

use std::io::Cursor;

use exr::image::FlatSamples;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers};
use papilio_diagnostics::Diagnostic;

use super::{HeightFile, damaged, sized};

pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Channels that are heights.
const HEIGHTS: [&str; 2] = ["Z", "Y"];

/// Reads a map. Its numbers have no unit.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let refused = |error: exr::error::Error| damaged("OpenEXR", error.to_string());
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(refused)?;
    let [header] = &meta.headers[..] else {
        return Err(damaged("OpenEXR", "it has several layers (expected one)"));
    };
    let (columns, rows) = (header.layer_size.width(), header.layer_size.height());
    sized(columns, rows)?;
    // More channels would take memory that a map does not need.
    let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    if header.deep || names.len() > 4 {
        return Err(damaged("OpenEXR", format!("it has {} channels (expected one)", names.len())));
    }
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image =
        reader.first_valid_layer().all_attributes().from_buffered(Cursor::new(bytes)).map_err(refused)?;
    let mut channels = image.layer_data.channel_data.list;
    let found = HEIGHTS.iter().find_map(|name| names.iter().position(|known| known == name));
    let number = found.or((channels.len() == 1).then_some(0));
    let wrong = || {
        damaged(
            "OpenEXR",
            format!("its channels are {} (expected `Z`, `Y`, or a single one)", names.join(", ")),
        )
    };
    let number = number.filter(|number| *number < channels.len()).ok_or_else(wrong)?;
    let channel = channels.swap_remove(number);
    let numbers: Vec<f64> = match &channel.sample_data {
        FlatSamples::F16(values) => values.iter().map(|value| f64::from(value.to_f32())).collect(),
        FlatSamples::F32(values) => values.iter().map(|value| f64::from(*value)).collect(),
        FlatSamples::U32(values) => values.iter().map(|value| f64::from(*value)).collect(),
    };
    if numbers.len() != columns * rows {
        return Err(damaged("OpenEXR", "its channels have another size than its layer"));
    }
    let mut map = HeightFile::plain(columns, numbers).upside_down();
    if names.len() > 1 {
        map.warnings.push(format!("only the channel `{}` of this OpenEXR file is used", names[number]));
    }
    Ok(map)
}
