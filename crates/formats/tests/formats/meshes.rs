//! Meshes: OBJ, STL in text and binary, right and damaged ones.

use papilio_formats::{DataFile, MeshFile, read_mesh};
use papilio_testing::Dice;

fn read(bytes: &[u8]) -> Result<MeshFile, String> {
    let file = DataFile { name: "mesh".to_owned(), bytes: bytes.to_vec() };
    read_mesh(&file).map_err(|error| error.to_string())
}

const SQUARE: [[[f64; 3]; 3]; 2] = [
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5]],
    [[0.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]],
];

const OBJ: &str = "# a square\nmtllib none.mtl\no face\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 5e-1\nvn 0 0 1\nv 0 1 0\nusemtl glass\ns off\nf 1/1/1 2//1 \
                   -2 -1\n";

fn text_stl() -> String {
    let vertex = |[x, y, z]: [f64; 3]| format!("      vertex {x} {y} {z:e}\n");
    let facet = |corners: [[f64; 3]; 3]| {
        format!(
            "  facet normal 0 0 1\r\n    outer loop\n{}    endloop\n  endfacet\n",
            corners.map(vertex).concat()
        )
    };
    format!("solid square\n{}endsolid square\n", SQUARE.map(facet).concat())
}

fn binary_stl() -> Vec<u8> {
    // Some programs begin their binary files as texts begin.
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(2_u32.to_le_bytes());
    for corners in SQUARE {
        let numbers = [[0.0, 0.0, 1.0]].into_iter().chain(corners).flatten();
        bytes.extend(numbers.flat_map(|value| (value as f32).to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

#[test]
fn meshes_of_all_formats_are_the_same() {
    for bytes in [OBJ.as_bytes().to_vec(), text_stl().into_bytes(), binary_stl()] {
        assert_eq!(read(&bytes).unwrap().triangles, SQUARE);
    }
}

#[test]
fn wrong_meshes_are_refused_with_their_places() {
    let stl = text_stl();
    let mut infinite = binary_stl();
    infinite[84 + 50 + 12 + 8..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let short = binary_stl()[..150].iter().map(|byte| if *byte == b' ' { 0xff } else { *byte }).collect();
    for (bytes, expected) in [
        (OBJ.replace("f 1/1/1", "f 9/1/1").into_bytes(), "mesh:11:1"),
        (OBJ.replace("f 1/1/1", "f 9/1/1").into_bytes(), "no vertex `9/1/1` among the 4"),
        (OBJ.replace("-2 -1", "-5").into_bytes(), "no vertex `-5`"),
        (OBJ.replace("f 1/1/1", "f 0").into_bytes(), "no vertex `0`"),
        (OBJ.replace(" 2//1 -2 -1", " 2").into_bytes(), "a face has 2 corners"),
        (OBJ.replace("v 1 1 5e-1", "v 1 1 nan").into_bytes(), "mesh:6:1"),
        (OBJ.replace("v 1 1 5e-1", "v 1 1").into_bytes(), "three coordinates"),
        (OBJ.replace("o face", "curv 1 2").into_bytes(), "mesh:3:1"),
        (b"v 0 0 0\n".to_vec(), "no triangles"),
        (Vec::new(), "no triangles"),
        (stl.replacen("vertex 1 1", "vertex 1 x", 1).into_bytes(), "`x` is not a finite number"),
        (stl.replacen("    endloop\n", "", 1).into_bytes(), "vertex or endloop"),
        (stl.replacen("      vertex 0 0 0e0\n", "", 1).into_bytes(), "three vertices"),
        (stl.as_bytes()[..stl.len() - 40].to_vec(), "ends within a loop"),
        (infinite, "the coordinate at byte 154 is inf"),
        (short, "a binary file of 2 triangles has 184 bytes, and this one has 150"),
    ] {
        let found = read(&bytes).unwrap_err();
        assert!(found.contains(expected), "{expected}\n{found}");
    }
}

/// Randomly damaged meshes are read, with finite numbers, or refused.
#[test]
fn damaged_meshes_do_no_harm() {
    let mut dice = Dice::new(0x357, 0);
    for whole in [OBJ.as_bytes().to_vec(), text_stl().into_bytes(), binary_stl()] {
        for _ in 0..2000 {
            let mut bytes = whole.clone();
            bytes.truncate(if dice.below(4) == 0 { dice.below(whole.len()) } else { whole.len() });
            for _ in 0..dice.below(5) {
                let at = dice.below(bytes.len().max(1));
                if let Some(byte) = bytes.get_mut(at) {
                    *byte =
                        if dice.below(2) == 0 { dice.bits() as u8 } else { b"0-9.e /\nvf"[dice.below(10)] };
                }
            }
            if let Ok(mesh) = read(&bytes) {
                assert!(mesh.triangles.iter().flatten().flatten().all(|number| number.is_finite()));
            }
        }
    }
}
