//! Formats that are recognised and not read, with what to export instead. Those of pictures are the ones of
//! [`picture_format`].

use papilio_diagnostics::Diagnostic;

use super::unsupported;

use crate::picture::a_file;
use crate::picture_format;

/// First bytes, the format with its article, and what to export instead.
const FORMATS: [(&[u8], &str, &str); 19] = [
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file, such as .datx of Zygo", "export the map as SDF, X3P or Zygo XYZ"),
    (b"\x88\x1b\x03\x6f", "a MetroPro .dat file of Zygo", "export the map as SDF or Zygo XYZ"),
    (b"\x88\x1b\x03\x70", "a MetroPro .dat file of Zygo", "export the map as SDF or Zygo XYZ"),
    (b"\x88\x1b\x03\x71", "a MetroPro .dat file of Zygo", "export the map as SDF or Zygo XYZ"),
    (b"GWYP", "a .gwy file of Gwyddion", "save the map as Gwyddion Simple Field (.gsf) or X3P"),
    (b"GWYO", "a .gwy file of Gwyddion", "save the map as Gwyddion Simple Field (.gsf) or X3P"),
    (
        b"Gwyddion XYZ Field",
        "a .gxyzf file of Gwyddion",
        "save the map as Gwyddion Simple Field (.gsf) or X3P",
    ),
    (b"AliconaImaging", "an .al3d file of Alicona", "export the map as SDF or X3P"),
    (b"VCA DATA", "an .opdx file of Bruker Vision64", "export the map as SDF, .opd or ASCII"),
    (b"\\*File list", "a Nanoscope file of Bruker", "open it in Gwyddion and save the map as .gsf or X3P"),
    (
        b"\\*Force file list",
        "a Nanoscope file of Bruker",
        "open it in Gwyddion and save the map as .gsf or X3P",
    ),
    (b"DSAA", "a .grd grid of Surfer", "save it as points x, y, z"),
    (b"DSBB", "a .grd grid of Surfer", "save it as points x, y, z"),
    (b"DSRB", "a .grd grid of Surfer", "save it as points x, y, z"),
    (b"MATLAB 5.0 MAT-file", "a .mat file of MATLAB", "save the map with writematrix, in um"),
    (b"CDF\x01", "a netCDF file", "save the array as .npy, in um"),
    (b"CDF\x02", "a netCDF file", "save the array as .npy, in um"),
    (
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        "an OLE document, such as an old Excel workbook",
        "save the heights as CSV",
    ),
    (b"#?RADIANCE", "a Radiance file", "save the map as OpenEXR or .npy"),
];

/// The error for a file of these formats, or a picture of a format that is not one of heights.
pub(super) fn recognised(bytes: &[u8]) -> Option<Diagnostic> {
    if let Some(format) = picture_format(bytes) {
        let export = match format {
            "TIFF" => "export the heights as a TIFF file below 4 GB: this one is a BigTIFF file",
            "PDF" => "export the heights as SDF or X3P from the program of the instrument",
            _ => {
                "export the heights as SDF or X3P from the program of the instrument, or as a grey PNG of 16 bits: 8 bits are too coarse"
            }
        };
        return Some(unsupported(&a_file(format), export));
    }
    let (_, format, export) = FORMATS.iter().find(|(magic, ..)| bytes.starts_with(magic))?;
    Some(unsupported(format, export))
}
