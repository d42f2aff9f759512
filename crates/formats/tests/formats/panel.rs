//! Frames for the controllers of panels, read back by their published layouts: no code of the writers is used.

use papilio_display::result::Named;
use papilio_formats::DataFile;
use papilio_formats::panel::{
    CONTROLLERS, FrameNumbers, HeaderHead, Mounting, Packing, PanelFrame, bits_of, changed_rectangle,
    read_shown_states, row_bytes, write_frame_header, write_indexed_bmp, write_mask_png, write_states_png,
};

/// Numbers that look random, from 0 to `below - 1`.
fn numbers(count: usize, below: u8, seed: u32) -> Vec<u8> {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
    let next = |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((state >> 16) % u32::from(below)) as u8
    };
    (0..count).map(next).collect()
}

/// Codes of the published drivers, copied from their sources by hand.
#[test]
fn controllers_have_the_codes_of_their_drivers() {
    let published: [(&str, &[(&str, u8)]); 7] = [
        // epd4in2_V2.py, getbuffer: a bit that is set is white.
        ("black-white", &[("black", 0), ("white", 1)]),
        // inky_ssd1683.py, show: the first plane is 0 for black, the second 1 for red (or yellow).
        ("black-white-red", &[("black", 0b00), ("white", 0b01), ("red", 0b11), ("yellow", 0b11)]),
        // epd4in2_V2.py, getbuffer_4Gray: 0x00 black, 0x80 -> 0x40, 0xC0 -> 0x80, 0xff white; two highest bits.
        ("four-grey", &[("black", 0), ("dark_grey", 1), ("light_grey", 2), ("white", 3)]),
        // M5EPD_Driver.cpp: 16 greys, 0 black, 15 white; a third and two thirds of 15.
        ("it8951", &[("black", 0), ("dark_grey", 5), ("light_grey", 10), ("white", 15)]),
        // epd7in3g.py: 00 black, 01 white, 10 yellow, 11 red.
        ("four-colour", &[("black", 0), ("white", 1), ("yellow", 2), ("red", 3)]),
        // epd7in3e.py: 0000 black, 0001 white, 0010 yellow, 0011 red, 0101 blue, 0110 green.
        ("spectra-6", &[("black", 0), ("white", 1), ("yellow", 2), ("red", 3), ("blue", 5), ("green", 6)]),
        // EPD_5in65f.h: 000 black, 001 white, 010 green, 011 blue, 100 red, 101 yellow, 110 orange.
        (
            "acep-7",
            &[
                ("black", 0),
                ("white", 1),
                ("green", 2),
                ("blue", 3),
                ("red", 4),
                ("yellow", 5),
                ("orange", 6),
            ],
        ),
    ];
    assert_eq!(
        published.map(|(name, _)| name).to_vec(),
        CONTROLLERS.iter().map(|one| one.name).collect::<Vec<_>>()
    );
    for ((_, codes), controller) in published.iter().zip(CONTROLLERS) {
        assert_eq!(*codes, controller.codes, "{}", controller.name);
        let largest = codes.iter().map(|(_, code)| *code).max().unwrap();
        assert!(bits_of(largest) <= controller.packing.bits(), "{}", controller.name);
    }
}

/// The code of a pixel in packed bytes: how a driver shifts them out, the most significant bit first.
fn code_at(bytes: &[u8], columns: usize, bits: usize, x: usize, y: usize) -> u8 {
    let row = &bytes[y * (columns * bits).div_ceil(8)..];
    let bit = |at: usize| row[at / 8] >> (7 - at % 8) & 1;
    (0..bits).fold(0, |code, k| code << 1 | bit(x * bits + k))
}

/// Each packing, turn and mirror image of frames whose rows do and do not fill bytes gives the codes back where
/// the drawing functions of a published driver put them (GUI_Paint.c, Paint_SetPixel: rotation, then mirror).
#[test]
fn packed_frames_give_the_picture_back() {
    let size @ [columns, rows] = [13, 6];
    for (bits, below) in [(1, 2), (2, 4), (4, 7), (8, 200)] {
        let states = numbers(columns * rows, below, u32::from(bits));
        // Codes differ from the numbers of the states.
        let codes: Vec<u8> = (0..below).rev().collect();
        for quarter_turns in 0..4 {
            for is_mirrored in [false, true] {
                let mounting = Mounting { quarter_turns, is_mirrored };
                let frame = PanelFrame::new(size, &states, &codes, mounting);
                let [across, down] = if quarter_turns % 2 == 0 { [columns, rows] } else { [rows, columns] };
                assert_eq!(frame.size, [across, down]);
                let bytes = frame.packed(Packing::Bits(bits));
                assert_eq!(bytes.len(), down * (across * usize::from(bits)).div_ceil(8));
                let planes = frame.packed(Packing::Planes(bits));
                let plane = down * across.div_ceil(8);
                assert_eq!(planes.len(), usize::from(bits) * plane);
                for (at, state) in states.iter().enumerate() {
                    let (x, y) = (at % columns, at / columns);
                    let (x, y) = match quarter_turns {
                        0 => (x, y),
                        1 => (across - y - 1, x),
                        2 => (across - x - 1, down - y - 1),
                        _ => (y, down - x - 1),
                    };
                    let x = if is_mirrored { across - x - 1 } else { x };
                    let wanted = below - 1 - state;
                    assert_eq!(code_at(&bytes, across, usize::from(bits), x, y), wanted);
                    let by_plane =
                        (0..bits).map(|k| code_at(&planes[usize::from(k) * plane..], across, 1, x, y) << k);
                    assert_eq!(by_plane.sum::<u8>(), wanted);
                }
                // What remains of the last byte of a row is 0.
                let used = across * usize::from(bits);
                let rest = |row: &[u8]| row[used / 8..].iter().map(|byte| byte << (used % 8)).any(|b| b != 0);
                assert!(used % 8 == 0 || !bytes.chunks(row_bytes(across, bits)).any(rest));
            }
        }
    }
}

/// The byte of two and of four pixels as the published drivers compute it.
#[test]
fn bytes_are_those_of_the_drivers() {
    let frame = |codes: &[u8]| PanelFrame { size: [codes.len(), 1], codes: codes.to_vec() };
    // epd7in3e.py: (first << 4) + second.
    assert_eq!(frame(&[6, 5, 1, 0]).packed(Packing::Bits(4)), [(6 << 4) + 5, 1 << 4]);
    // epd7in3g.py: (p0 << 6) + (p1 << 4) + (p2 << 2) + p3.
    assert_eq!(frame(&[3, 1, 2, 0]).packed(Packing::Bits(2)), [(3 << 6) + (1 << 4) + (2 << 2)]);
    // epd4in2_V2.py: buf = 0xFF; a black pixel clears 0x80 >> (x % 8).
    let black_at = [1, 6];
    let byte = black_at.iter().fold(0xffu8, |byte, x| byte & !(0x80 >> x));
    let codes: Vec<u8> = (0..8).map(|x| u8::from(!black_at.contains(&x))).collect();
    assert_eq!(frame(&codes).packed(Packing::Bits(1)), [byte]);
    // inky_ssd1683.py: packbits(region != BLACK), packbits(region == RED), with black 0, white 1, red 3.
    let codes = [0, 1, 3, 3, 0, 1, 1, 0];
    let bits = |set: fn(&u8) -> bool| codes.iter().fold(0u8, |byte, code| byte << 1 | u8::from(set(code)));
    assert_eq!(frame(&codes).packed(Packing::Planes(2)), [bits(|code| *code != 0), bits(|code| *code == 3)]);
    // epd4in2_V2.py, display_4Gray: 0x24 has 1 for white and 0x40 (dark), 0x26 for white and 0x80 (light).
    let codes = [0, 1, 2, 3, 3, 2, 1, 0];
    let bits = |set: [u8; 2]| codes.iter().fold(0u8, |byte, code| byte << 1 | u8::from(set.contains(code)));
    assert_eq!(frame(&codes).packed(Packing::Planes(2)), [bits([3, 1]), bits([3, 2])]);
}

/// Numbers and colours of an indexed BMP, by the published layout (BITMAPFILEHEADER, BITMAPINFOHEADER).
fn read_bmp(bytes: &[u8]) -> ([usize; 2], usize, Vec<u8>, Vec<[u8; 3]>) {
    let long = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let short = |at: usize| usize::from(u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap()));
    assert_eq!((&bytes[..2], long(2), long(14), short(26), long(30)), (&b"BM"[..], bytes.len(), 40, 1, 0));
    let (columns, rows, depth) = (long(18), long(22), short(28));
    let stride = (columns * depth).div_ceil(32) * 4;
    let pixels = &bytes[long(10)..];
    assert_eq!((pixels.len(), long(34)), (stride * rows, stride * rows));
    let number = |at: usize| {
        let row = &pixels[(rows - 1 - at / columns) * stride..];
        code_at(row, columns, depth, at % columns, 0)
    };
    let colours = bytes[54..long(10)].chunks(4).map(|bgr| [bgr[2], bgr[1], bgr[0]]).collect();
    ([columns, rows], depth, (0..columns * rows).map(number).collect(), colours)
}

#[test]
fn bmp_has_the_codes_and_their_colours() {
    for (bits, below, depth) in [(1, 2, 1), (2, 4, 4), (3, 7, 4), (4, 16, 4), (8, 255, 8)] {
        for columns in [1, 7, 8, 33] {
            let codes = numbers(columns * 5, below, 7);
            let frame = PanelFrame { size: [columns, 5], codes: codes.clone() };
            let colour = |code: u8| [code, 255 - code, code / 2];
            let palette: Vec<(u8, [u8; 3])> = (0..below).map(|code| (code, colour(code))).collect();
            let mut bytes = Vec::new();
            write_indexed_bmp(&mut bytes, &frame, bits, &palette).unwrap();
            let (size, found, numbers, colours) = read_bmp(&bytes);
            assert_eq!((size, found, numbers), ([columns, 5], depth, codes));
            assert_eq!(colours.len(), 1 << depth);
            assert!((0..below).all(|code| colours[usize::from(code)] == colour(code)));
        }
    }
}

/// The header has the bytes in order, their number, and a comment that no title ends.
#[test]
fn c_header_has_the_bytes_of_the_frame() {
    let frame = PanelFrame { size: [37, 3], codes: numbers(37 * 3, 7, 3) };
    let bytes = frame.packed(Packing::Bits(4));
    let numbers = FrameNumbers {
        size: frame.size,
        bits: 4,
        planes: false,
        bytes_per_row: 19,
        controller: None,
        codes: Named(vec![("black".to_owned(), 0), ("white".to_owned(), 6)]),
        rotation_deg: 90,
        mirrored: true,
        changed: None,
    };
    let mut text = Vec::new();
    let head = HeaderHead { program: "papilio", title: "A panel \\", numbers: &numbers };
    write_frame_header(&mut text, head, &bytes).unwrap();
    let text = String::from_utf8(text).unwrap();
    let code: String = text.lines().filter(|line| !line.starts_with("//")).collect::<Vec<_>>().join("\n");
    let body = code.split_once("const unsigned char frame[57] = {").unwrap().1.split_once("};").unwrap().0;
    let found: Vec<u8> = body
        .split(',')
        .map(str::trim)
        .filter(|item| !item.is_empty())
        .map(|item| u8::from_str_radix(item.strip_prefix("0x").unwrap(), 16).unwrap())
        .collect();
    assert_eq!(found, bytes);
    for part in ["FRAME_WIDTH 37\n", "FRAME_HEIGHT 3\n", "FRAME_BITS 4\n", "FRAME_ROW_BYTES 19\n"] {
        assert!(code.contains(part), "{text}");
    }
    for part in ["black 0, white 6", "4 bits for each pixel", "rotated by 90 deg clockwise, then mirrored"] {
        assert!(text.contains(part), "{text}");
    }
    assert!(!text.lines().any(|line| line.ends_with('\\')), "{text}");
}

/// The rectangle is the smallest that has all pixels and consists of whole bytes of each row, from a multiple of 8 columns to another one or to the end
/// of the row's bytes; by trying all of them. With 1 bit and in planes both are multiples of 8.
#[test]
fn changed_rectangle_is_the_smallest_in_whole_bytes() {
    let (columns, rows) = (21, 4);
    for (packing, bits, end) in [
        (Packing::Bits(1), 1, 24),
        (Packing::Planes(2), 1, 24),
        (Packing::Bits(2), 2, 24),
        (Packing::Bits(4), 4, 22),
        (Packing::Bits(8), 8, 21),
    ] {
        assert_eq!(changed_rectangle(columns, packing, &vec![false; columns * rows]), None);
        for seed in 0..40 {
            let changed: Vec<bool> =
                numbers(columns * rows, 30, seed).iter().map(|value| *value == 0).collect();
            let places: Vec<[usize; 2]> =
                (0..changed.len()).filter(|at| changed[*at]).map(|at| [at % columns, at / columns]).collect();
            let has_all = |[x, y, width, height]: [usize; 4]| {
                places.iter().all(|[px, py]| (x..x + width).contains(px) && (y..y + height).contains(py))
            };
            let all = [0, 8, 16].into_iter().flat_map(|x| {
                [8, 16, end].into_iter().filter(move |end| *end > x).flat_map(move |end| {
                    (0..rows).flat_map(move |y| (1..=rows - y).map(move |height| [x, y, end - x, height]))
                })
            });
            let smallest = all.filter(|one| has_all(*one)).min_by_key(|[.., width, height]| width * height);
            let found = changed_rectangle(columns, packing, &changed);
            assert_eq!(found, smallest.filter(|_| !places.is_empty()), "{packing:?} {seed}");
            if let Some([x, _, width, _]) = found {
                assert_eq!((x * bits % 8, width * bits % 8), (0, 0), "{packing:?} {seed}");
            }
        }
    }
}

/// `states.png` is read as it was written, and in each depth in which other programs store it.
#[test]
fn shown_states_are_read_in_each_depth() {
    let file = |bytes: Vec<u8>| DataFile { name: "states.png".into(), bytes };
    let names: Vec<String> = ["black", "white", "grün"].map(str::to_owned).to_vec();
    let states = numbers(11 * 5, 3, 1);
    let palette = [[0; 3], [255; 3], [0, 128, 0]];
    let mut own = Vec::new();
    write_states_png(&mut own, 11, &states, &palette, &names).unwrap();
    let shown = read_shown_states(&file(own)).unwrap();
    assert_eq!((shown.size, &shown.states, shown.colours, shown.names), ([11, 5], &states, 3, Some(names)));
    for (depth, bits) in [(png::BitDepth::Two, 2), (png::BitDepth::Four, 4), (png::BitDepth::Eight, 8)] {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 11, 5);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(depth);
        encoder.set_palette(palette.concat());
        let packed = states.chunks(11).flat_map(|row| {
            let bit = |at: usize| row.get(at / bits).map_or(0, |code| code >> (bits - 1 - at % bits) & 1);
            (0..(11 * bits).div_ceil(8))
                .map(move |byte| (0..8).fold(0, |value, k| value << 1 | bit(8 * byte + k)))
                .collect::<Vec<u8>>()
        });
        let packed: Vec<u8> = packed.collect();
        encoder.write_header().unwrap().write_image_data(&packed).unwrap();
        let shown = read_shown_states(&file(bytes)).unwrap();
        assert_eq!((shown.states, shown.colours, shown.names), (states.clone(), 3, None), "{bits}");
    }
    let mut grey = Vec::new();
    write_mask_png(&mut grey, 11, &[true; 55]).unwrap();
    for (bytes, part) in [(grey, "not numbers of states"), (b"GIF89a".to_vec(), "not a PNG file")] {
        let wrong = read_shown_states(&file(bytes)).unwrap_err().to_string();
        assert!(wrong.contains(part) && wrong.contains("expected states.png"), "{wrong}");
    }
}

/// A mask is a PNG of 1 bit, white where it is true.
#[test]
fn mask_is_white_where_it_is_true() {
    let mask: Vec<bool> = numbers(11 * 5, 2, 5).iter().map(|value| *value == 1).collect();
    let mut bytes = Vec::new();
    write_mask_png(&mut bytes, 11, &mask).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    assert_eq!(reader.output_color_type(), (png::ColorType::Grayscale, png::BitDepth::One));
    let mut rows = vec![0; 2 * 5];
    reader.next_frame(&mut rows).unwrap();
    assert!(
        mask.iter().enumerate().all(|(at, set)| code_at(&rows, 11, 1, at % 11, at / 11) == u8::from(*set))
    );
}
