//! Small pictures, made byte by byte: PNG without compression, JPEG of uniform blocks, ICC profiles.

/// A PNG file in the making: signature, header and chunks.
#[derive(Clone)]
pub(super) struct Png {
    bytes: Vec<u8>,
    rows: usize,
}

fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & 0_u32.wrapping_sub(crc & 1)))
    };
    !bytes.iter().fold(!0, step)
}

/// Data as a zlib stream without compression.
pub(super) fn zlib(data: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0x78, 0x01];
    let count = data.chunks(65_535).count();
    for (k, block) in data.chunks(65_535).enumerate() {
        let length = block.len() as u16;
        bytes.push(u8::from(k + 1 == count));
        bytes.extend(length.to_le_bytes());
        bytes.extend((!length).to_le_bytes());
        bytes.extend(block);
    }
    let (a, b) = data.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65_521;
        (a, (b + a) % 65_521)
    });
    bytes.extend(((b << 16) | a).to_be_bytes());
    bytes
}

impl Png {
    pub(super) fn new([columns, rows]: [u32; 2], depth: u8, colour: u8) -> Self {
        let header = [&columns.to_be_bytes()[..], &rows.to_be_bytes(), &[depth, colour, 0, 0, 0]].concat();
        Self { bytes: b"\x89PNG\r\n\x1a\n".to_vec(), rows: rows as usize }.chunk(b"IHDR", &header)
    }

    pub(super) fn chunk(&self, name: &[u8; 4], data: &[u8]) -> Self {
        let mut bytes = self.bytes.clone();
        bytes.extend((data.len() as u32).to_be_bytes());
        let content = [name, data].concat();
        bytes.extend(&content);
        bytes.extend(checksum(&content).to_be_bytes());
        Self { bytes, rows: self.rows }
    }

    /// The file with these rows, each with its filter.
    pub(super) fn data(&self, filters: &[u8], data: &[u8]) -> Vec<u8> {
        self.data_and(filters, data, &[])
    }

    /// The same with chunks after the data.
    pub(super) fn data_and(&self, filters: &[u8], data: &[u8], after: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let width = data.len() / self.rows.min(filters.len());
        let rows = filters.iter().zip(data.chunks(width.max(1)));
        let rows: Vec<u8> = rows.flat_map(|(filter, row)| [&[*filter], row].concat()).collect();
        let png = self.chunk(b"IDAT", &zlib(&rows));
        let png = after.iter().fold(png, |png, (name, data)| png.chunk(name, data));
        png.chunk(b"IEND", &[]).bytes
    }
}

/// A PNG file with the checksums of its chunks made right; another file as it is.
pub(super) fn with_checksums(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut at = 8;
    while bytes.starts_with(b"\x89PNG") && at + 12 <= bytes.len() {
        let length = u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize;
        let Some(end) = at.checked_add(8 + length).filter(|end| end + 4 <= bytes.len()) else { break };
        let sum = checksum(&bytes[at + 4..end]).to_be_bytes();
        bytes[end..end + 4].copy_from_slice(&sum);
        at = end + 4;
    }
    bytes
}

/// A baseline JPEG file of blocks of one colour each, without subsampling.
#[derive(Clone)]
pub(super) struct Jpeg {
    pub(super) size: [u16; 2],
    pub(super) components: usize,
    pub(super) blocks: Vec<[u8; 4]>,
    /// Colour transform in Adobe's marker.
    pub(super) adobe: Option<u8>,
    pub(super) exif: Vec<u8>,
    pub(super) profile: Vec<u8>,
}

impl Jpeg {
    pub(super) fn new(components: usize, blocks: &[[u8; 4]]) -> Self {
        let (exif, profile) = (Vec::new(), Vec::new());
        Self { size: [8, 8], components, blocks: blocks.to_vec(), adobe: None, exif, profile }
    }

    pub(super) fn grey(blocks: &[u8]) -> Self {
        Self::new(1, &blocks.iter().map(|value| [*value, 0, 0, 0]).collect::<Vec<_>>())
    }

    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut bytes = vec![0xff, 0xd8];
        let mut segment = |marker: u8, data: &[u8]| {
            bytes.extend([0xff, marker]);
            bytes.extend((data.len() as u16 + 2).to_be_bytes());
            bytes.extend(data);
        };
        if !self.exif.is_empty() {
            segment(0xe1, &[b"Exif\0\0", &self.exif[..]].concat());
        }
        if !self.profile.is_empty() {
            segment(0xe2, &[b"ICC_PROFILE\0\x01\x01", &self.profile[..]].concat());
        }
        if let Some(transform) = self.adobe {
            segment(0xee, &[b"Adobe", &[0, 100, 0, 0, 0, 0, transform][..]].concat());
        }
        segment(0xdb, &[&[0][..], &[1; 64]].concat());
        let ids = 1..=self.components as u8;
        let [columns, rows] = self.size.map(u16::to_be_bytes);
        let frame: Vec<u8> = ids.clone().flat_map(|id| [id, 0x11, 0]).collect();
        segment(0xc0, &[&[8][..], &rows, &columns, &[self.components as u8], &frame].concat());
        // Twelve categories with codes of four bits; the end of a block with one bit.
        let dc: Vec<u8> = [0, 0, 0, 12].into_iter().chain([0; 12]).chain(0..12).collect();
        segment(0xc4, &[&[0x00][..], &dc].concat());
        segment(0xc4, &[&[0x10, 1][..], &[0; 15], &[0]].concat());
        let scan: Vec<u8> = ids.flat_map(|id| [id, 0]).collect();
        segment(0xda, &[&[self.components as u8][..], &scan, &[0, 63, 0]].concat());
        bytes.extend(self.scan());
        bytes.extend([0xff, 0xd9]);
        bytes
    }

    /// The coded blocks: the difference of each component from the block before it.
    fn scan(&self) -> Vec<u8> {
        let mut bits: Vec<bool> = Vec::new();
        let mut before = [0_i32; 4];
        for block in &self.blocks {
            for k in 0..self.components {
                let value = 8 * (i32::from(block[k]) - 128);
                let difference = value - before[k];
                before[k] = value;
                let category = 32 - difference.unsigned_abs().leading_zeros();
                let code = if difference < 0 { difference + (1 << category) - 1 } else { difference };
                bits.extend((0..4).rev().map(|bit| category >> bit & 1 == 1));
                bits.extend((0..category).rev().map(|bit| code >> bit & 1 == 1));
                bits.push(false);
            }
        }
        while !bits.len().is_multiple_of(8) {
            bits.push(true);
        }
        let byte = |bits: &[bool]| bits.iter().fold(0_u8, |byte, bit| byte << 1 | u8::from(*bit));
        bits.chunks(8)
            .map(byte)
            .flat_map(|byte| if byte == 0xff { vec![0xff, 0] } else { vec![byte] })
            .collect()
    }
}

/// EXIF data with an orientation.
pub(super) fn exif(orientation: u8) -> Vec<u8> {
    let mut bytes = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    bytes.extend([orientation, 0, 0, 0, 0, 0, 0]);
    bytes
}

/// A profile of these tags, for the numbers of a device, with colours as `XYZ ` or `Lab `.
fn profile_of(device: &[u8; 4], colours: &[u8; 4], tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes[16..20].copy_from_slice(device);
    bytes[20..24].copy_from_slice(colours);
    bytes[36..40].copy_from_slice(b"acsp");
    bytes.extend((tags.len() as u32).to_be_bytes());
    let mut at = 132 + 12 * tags.len();
    for (name, data) in tags {
        bytes.extend(*name);
        bytes.extend((at as u32).to_be_bytes());
        bytes.extend((data.len() as u32).to_be_bytes());
        at += data.len();
    }
    bytes.extend(tags.iter().flat_map(|(_, data)| data));
    bytes
}

fn fixed(values: &[f64]) -> impl Iterator<Item = u8> {
    values.iter().flat_map(|value| ((value * 65536.0).round() as i32).to_be_bytes())
}

/// A profile named `Test profile` with primaries moved by `by`, and one power or the parameters of sRGB as
/// transfer functions.
pub(super) fn profile(by: [f64; 3], transfer: &[f64]) -> Vec<u8> {
    // sRGB's primaries adapted to D50.
    let columns = [[0.43607, 0.22249, 0.01392], [0.38515, 0.71687, 0.09708], [0.14307, 0.06061, 0.71410]];
    let colour = |k: usize| {
        let moved: [f64; 3] = std::array::from_fn(|row| columns[k][row] + by[row]);
        b"XYZ \0\0\0\0".iter().copied().chain(fixed(&moved)).collect::<Vec<u8>>()
    };
    let kind = if transfer.len() == 1 { 0 } else { 3 };
    let curve: Vec<u8> =
        b"para\0\0\0\0".iter().copied().chain([0, kind, 0, 0]).chain(fixed(transfer)).collect();
    let name = b"desc\0\0\0\0\0\0\0\x0dTest profile\0".to_vec();
    let tags = [
        (b"desc", name),
        (b"rXYZ", colour(0)),
        (b"gXYZ", colour(1)),
        (b"bXYZ", colour(2)),
        (b"rTRC", curve.clone()),
        (b"gTRC", curve.clone()),
        (b"bTRC", curve.clone()),
        (b"kTRC", curve),
    ];
    profile_of(b"RGB ", b"XYZ ", &tags)
}

/// sRGB as a profile.
pub(super) fn srgb_profile() -> Vec<u8> {
    profile([0.0; 3], &[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045])
}

/// How a table is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Table {
    Lut8,
    Lut16,
    AToB,
    /// Without a grid.
    Matrix,
}

/// A profile that is a table: for each corner of the cube of numbers, linear light of `decoded`, its colour
/// from 0 to 1.
pub(super) fn table_profile(
    table: Table,
    [device, colours]: [&[u8; 4]; 2],
    decoded: impl Fn(f64) -> f64,
    colour: impl Fn(&[f64]) -> [f64; 3],
) -> Vec<u8> {
    let inputs: usize = if device == b"CMYK" { 4 } else { 3 };
    let corners = (0..1_usize << inputs).map(|corner| {
        (0..inputs).map(|axis| f64::from(u8::from(corner >> (inputs - 1 - axis) & 1 == 1))).collect()
    });
    let nodes: Vec<f64> = corners.flat_map(|corner: Vec<f64>| colour(&corner)).collect();
    let bytes = |values: &[f64]| -> Vec<u8> {
        match table {
            Table::Lut8 => values.iter().map(|value| (255.0 * value).round() as u8).collect(),
            _ => values.iter().flat_map(|value| ((65535.0 * value).round() as u16).to_be_bytes()).collect(),
        }
    };
    let curve =
        |steps: usize| bytes(&(0..steps).map(|k| decoded(k as f64 / (steps - 1) as f64)).collect::<Vec<_>>());
    let identity =
        |steps: usize| bytes(&(0..steps).map(|k| k as f64 / (steps - 1) as f64).collect::<Vec<_>>());
    let head = |kind: &[u8; 4]| [&kind[..], &[0; 4], &[inputs as u8, 3]].concat();
    let unused: Vec<u8> = fixed(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]).collect();
    let data = match table {
        Table::Lut8 => {
            let parts = [head(b"mft1"), vec![2, 0], unused, curve(256).repeat(inputs), bytes(&nodes)];
            [parts.concat(), identity(256).repeat(3)].concat()
        }
        Table::Lut16 => {
            let counts = [1024_u16, 2].map(u16::to_be_bytes).concat();
            let parts =
                [head(b"mft2"), vec![2, 0], unused, counts, curve(1024).repeat(inputs), bytes(&nodes)];
            [parts.concat(), identity(2).repeat(3)].concat()
        }
        Table::AToB | Table::Matrix => {
            let linear = b"curv\0\0\0\0\0\0\0\0".repeat(3);
            let mut sampled = [&b"curv\0\0\0\0"[..], &1025_u32.to_be_bytes(), &curve(1025)].concat();
            sampled.extend([0; 2]);
            let has_grid = table == Table::AToB;
            let m = if has_grid { linear.clone() } else { sampled.repeat(3) };
            // The matrix of the colours of single numbers.
            let of_one = |k: usize| colour(&[0, 1, 2].map(|axis| f64::from(u8::from(axis == k))));
            let columns = [0, 1, 2].map(|k| if has_grid { [0.0; 3] } else { of_one(k) });
            let elements = |row: usize, column: usize| {
                if has_grid { f64::from(u8::from(row == column)) } else { columns[column][row] }
            };
            let matrix: Vec<f64> = (0..9).map(|k| elements(k / 3, k % 3)).chain([0.0; 3]).collect();
            let grid = [&[2; 4][..inputs], &vec![0; 16 - inputs], &[2, 0, 0, 0], &bytes(&nodes)].concat();
            let mut parts = vec![linear, fixed(&matrix).collect(), m];
            if has_grid {
                parts.extend([grid, sampled.repeat(inputs)]);
            }
            let mut at = 32;
            let mut offsets = [0_u32; 5];
            for (offset, part) in offsets.iter_mut().zip(&parts) {
                *offset = at;
                at += part.len() as u32;
            }
            let offsets: Vec<u8> = offsets.into_iter().flat_map(u32::to_be_bytes).collect();
            [head(b"mAB "), vec![0; 2], offsets, parts.concat()].concat()
        }
    };
    profile_of(device, colours, &[(b"A2B0", data)])
}
