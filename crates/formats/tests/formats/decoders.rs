//! Every reader of files of others with damaged files of every format: an error with the name of the file,
//! and never a panic.

use papilio_formats::{
    DataFile, FormatError, RgbSpace, read_bsdf, read_face, read_heights, read_light_map, read_luminaire,
    read_mesh, read_palette, read_picture, read_result, write_rgb_png,
};
use papilio_testing::{Dice, sized};

type Reader = (&'static str, fn(&DataFile) -> Result<(), FormatError>);

const READERS: [Reader; 9] = [
    ("read_bsdf", |file| read_bsdf(file).map(drop)),
    ("read_face", |file| read_face(file).map(drop)),
    ("read_heights", |file| read_heights(file).map(drop)),
    ("read_luminaire", |file| read_luminaire(file).map(drop)),
    ("read_light_map", |file| read_light_map(file).map(drop)),
    ("read_mesh", |file| read_mesh(file).map(drop)),
    ("read_palette", |file| read_palette(file).map(drop)),
    ("read_picture", |file| read_picture(file, &RgbSpace::srgb()).map(drop)),
    ("read_result", |file| read_result(file).map(drop)),
];

/// Files with the least that each format needs, some of them wrong already.
fn files() -> Vec<Vec<u8>> {
    let mut png = Vec::new();
    write_rgb_png(&mut png, 2, &[[20, 128, 255]; 6], false).unwrap();
    // A palette of four bytes, which is no whole number of colours, as other programs have written one.
    let palette = [
        &b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x03\0\0\0\x28\xcb\x34\xbb\0\0\0\x04PLTE"[..],
        &[1, 2, 3, 4, 0, 0, 0, 0],
        b"\0\0\0\0IEND\xae\x42\x60\x82",
    ]
    .concat();
    let mut stl = vec![0; 80];
    stl.extend(1_u32.to_le_bytes());
    stl.extend([0; 50]);
    let klems = "<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure></DataDefinition>\
                 <WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock><ScatteringData>1,2</ScatteringData></WavelengthDataBlock>\
                 </WavelengthData></Layer></Optical></WindowElement>";
    let texts = [
        klems,
        "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 45 90\n0\n100 70 0\n",
        "# a\nSource Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 1\n0\n\
         ScatterAzimuth 2\n0 180\nScatterRadial 2\n0 90\n\nMonochrome\nDataBegin\nTIS 0.5\n1 0\n1 0\nDataEnd\n",
        "theta_i,phi_i,theta_o,phi_o,value\n0,0,0,0,0.3\n0,0,30,0,0.2\n",
        "NUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,550nm\n0,0,0,0,1\n",
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\nabcdabcdabcdabcdabcdabcdabcdabcd",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
        "state,L,a,b\nwhite,90,0,0\nblack,20,0,0\n",
        "{\"papilio\": \"0.1.0\", \"hash\": \"a\", \"wavelength_nm\": [400, 500], \"views\": []}",
        "tensor_file\0\x01\0\x01\0\0\0\x05\0specs\x01\0\x0a\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
    ];
    let heights = crate::heights::all_formats().into_iter().map(|(_, bytes)| bytes);
    let texts = texts.into_iter().map(|text| text.as_bytes().to_vec());
    [png, palette, stl].into_iter().chain(texts).chain(heights).collect()
}

#[test]
fn damaged_files_are_errors_of_every_reader() {
    let mut dice = Dice::new(0xdec0, 0);
    for bytes in files() {
        for _ in 0..sized(12, 2000) {
            let mut bytes = bytes.clone();
            if dice.below(3) == 0 {
                bytes.truncate(dice.below(bytes.len()));
            }
            for _ in 0..dice.below(4) {
                let at = dice.below(bytes.len().max(1));
                if let Some(byte) = bytes.get_mut(at) {
                    *byte =
                        [dice.bits() as u8, 0, 255, b'9', b'-', *byte ^ (1 << dice.below(8))][dice.below(6)];
                }
            }
            let file = DataFile { name: "damaged".to_owned(), bytes };
            for (reader, read) in READERS {
                if let Err(error) = read(&file) {
                    assert_eq!(error.place.name, "damaged", "{reader}");
                }
            }
        }
    }
}
