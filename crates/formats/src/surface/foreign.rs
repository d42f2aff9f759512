//! Formats that are recognised and not read, with what to export instead.

use super::SurfaceProblem;

/// First bytes, where they are, the format with its article, and what to export instead.
const FORMATS: [(&[u8], usize, &str, &str); 25] = [
    (
        b"\x89HDF\r\n\x1a\n",
        0,
        "an HDF5 file, such as .datx of Zygo",
        "export the map as SDF, X3P or Zygo XYZ",
    ),
    (b"\x88\x1b\x03\x6f", 0, "a MetroPro .dat file of Zygo", "export the map as SDF or Zygo XYZ"),
    (b"\x88\x1b\x03\x70", 0, "a MetroPro .dat file of Zygo", "export the map as SDF or Zygo XYZ"),
    (b"\x88\x1b\x03\x71", 0, "a MetroPro .dat file of Zygo", "export the map as SDF or Zygo XYZ"),
    (b"GWYP", 0, "a .gwy file of Gwyddion", "save the map as Gwyddion Simple Field (.gsf) or X3P"),
    (b"GWYO", 0, "a .gwy file of Gwyddion", "save the map as Gwyddion Simple Field (.gsf) or X3P"),
    (
        b"Gwyddion XYZ Field",
        0,
        "a .gxyzf file of Gwyddion",
        "save the map as Gwyddion Simple Field (.gsf) or X3P",
    ),
    (b"AliconaImaging", 0, "an .al3d file of Alicona", "export the map as SDF or X3P"),
    (b"VCA DATA", 0, "an .opdx file of Bruker Vision64", "export the map as SDF, .opd or ASCII"),
    (b"\\*File list", 0, "a Nanoscope file of Bruker", "open it in Gwyddion and save the map as .gsf or X3P"),
    (
        b"\\*Force file list",
        0,
        "a Nanoscope file of Bruker",
        "open it in Gwyddion and save the map as .gsf or X3P",
    ),
    (b"DSAA", 0, "a .grd grid of Surfer", "save it as points x, y, z"),
    (b"DSBB", 0, "a .grd grid of Surfer", "save it as points x, y, z"),
    (b"DSRB", 0, "a .grd grid of Surfer", "save it as points x, y, z"),
    (b"MATLAB 5.0 MAT-file", 0, "a .mat file of MATLAB", "save the map with writematrix, in um"),
    (b"CDF\x01", 0, "a netCDF file", "save the array as .npy, in um"),
    (b"CDF\x02", 0, "a netCDF file", "save the array as .npy, in um"),
    (
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        0,
        "an OLE document, such as an old Excel workbook",
        "save the heights as CSV",
    ),
    (b"%PDF", 0, "a PDF document", "export the map as SDF or X3P from the program of the instrument"),
    (
        b"\xff\xd8\xff",
        0,
        "a JPEG picture, whose 8 bits are too coarse for heights",
        "export the map as SDF or X3P, or as a grey PNG of 16 bits",
    ),
    (
        b"GIF8",
        0,
        "a GIF picture, whose 8 bits are too coarse for heights",
        "export the map as SDF or X3P, or as a grey PNG of 16 bits",
    ),
    (
        b"BM",
        0,
        "a BMP picture, whose 8 bits are too coarse for heights",
        "export the map as SDF or X3P, or as a grey PNG of 16 bits",
    ),
    (
        b"WEBP",
        8,
        "a WebP picture, whose 8 bits are too coarse for heights",
        "export the map as SDF or X3P, or as a grey PNG of 16 bits",
    ),
    (b"#?RADIANCE", 0, "a Radiance picture", "save the map as OpenEXR or .npy"),
    (b"II+\0", 0, "a BigTIFF picture", "save the map as a TIFF below 4 GB"),
];

/// The error for a file of these formats. Short words must not begin a text.
pub(super) fn recognised(bytes: &[u8]) -> Option<SurfaceProblem> {
    let is_of = |(magic, at, _, _): &&(&[u8], usize, &str, &str)| {
        let found = bytes.get(*at..).is_some_and(|rest| rest.starts_with(magic));
        found && (magic.len() > 2 || bytes.contains(&0))
    };
    let (_, _, format, export) = FORMATS.iter().find(is_of)?;
    Some(SurfaceProblem::Unsupported { format, export })
}
