//! Faults put into valid files.

use crate::containers;

/// A small generator (`SplitMix64`), our own.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % bound.max(1) as u64).unwrap()
    }
}

/// What a file is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Text,
    Binary,
    /// An archive of arrays: mutated whole, or one array in it, with the checksums put right.
    Npz,
    /// Two chunks: mutated whole, or one of them, with the lengths put right.
    Glb,
}

const NASTY: [&str; 34] = [
    "NaN",
    "inf",
    "-inf",
    "1e30",
    "-1e30",
    "1e38",
    "1e-45",
    "4000000000",
    "18446744073709551616",
    "-1",
    "0",
    "1",
    "65535",
    "999999",
    "0.0000001",
    "",
    "{",
    "}",
    "[",
    "]",
    "(",
    ")",
    "MOTION",
    "begin",
    "end",
    ":hierarchy",
    "root",
    "JOINT x {",
    ",,,",
    "\"",
    "=",
    "\u{0}",
    "\u{1F600}",
    "[[a]]",
];

/// An input of the pool with one to eight faults.
pub(crate) fn mutate(pool: &[Vec<u8>], form: Form, random: &mut Random) -> Vec<u8> {
    let input = &pool[random.below(pool.len())];
    let other = &pool[random.below(pool.len())];
    match form {
        Form::Npz if random.below(4) > 0 => {
            if let Some(bytes) = repacked(input, other, random) {
                return bytes;
            }
        }
        Form::Glb if random.below(4) > 0 => {
            if let Some(bytes) = rechunked(input, other, random) {
                return bytes;
            }
        }
        _ => {}
    }
    faults(input.clone(), other, form == Form::Text, random)
}

fn faults(mut bytes: Vec<u8>, other: &[u8], is_text: bool, random: &mut Random) -> Vec<u8> {
    let most = [1, 2, 8][random.below(3)];
    for _ in 0..=random.below(most) {
        fault(&mut bytes, other, is_text, random);
        // Doubling again and again would leave only the size to look at.
        bytes.truncate(1 << 18);
    }
    bytes
}

fn fault(bytes: &mut Vec<u8>, other: &[u8], is_text: bool, random: &mut Random) {
    if bytes.is_empty() {
        bytes.extend(other);
        return;
    }
    let at = random.below(bytes.len());
    let longest = [8, 80, 4000][random.below(3)];
    let span = 1 + random.below(longest);
    let end = (at + span).min(bytes.len());
    match random.below(if is_text { 14 } else { 10 }) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => {
            let part = bytes[at..end].to_vec();
            bytes.splice(at..at, part);
        }
        3 => bytes[at] ^= 1 << random.below(8),
        4 => bytes[at] = [0, 1, 2, 0x7f, 0x80, 0xff, b'\n', b' ', b'}', b','][random.below(10)],
        5 if !other.is_empty() => {
            // The rest of another file, or a piece of it.
            let from = random.below(other.len());
            let to = if random.below(2) == 0 { other.len() } else { (from + span).min(other.len()) };
            let part = other[from..to].to_vec();
            let until = if random.below(2) == 0 { bytes.len() } else { end };
            bytes.splice(at..until, part);
        }
        6..=9 if !is_text => {
            let width = [1, 2, 4, 8][random.below(4)];
            let at = at - at % width;
            let values: [[u8; 8]; 9] = [
                [0; 8],
                [0xff; 8],
                u64::from(f32::NAN.to_bits()).to_le_bytes(),
                u64::from(1e30_f32.to_bits()).to_le_bytes(),
                f64::NAN.to_le_bytes(),
                1_u64.to_le_bytes(),
                0x7fff_ffff_7fff_7fff_u64.to_le_bytes(),
                0x8000_0000_8000_8000_u64.to_le_bytes(),
                random.next().to_le_bytes(),
            ];
            let value = values[random.below(values.len())];
            for (byte, value) in bytes[at..].iter_mut().zip(&value[..width]) {
                *byte = *value;
            }
        }
        7..=10 => {
            // A whole word becomes a nasty one.
            let (from, to) = word(bytes, at);
            bytes.splice(from..to, NASTY[random.below(NASTY.len())].bytes());
        }
        11 => {
            let (from, to) = word(bytes, at);
            let mut twice = bytes[from..to].to_vec();
            twice.push(b' ');
            bytes.splice(from..from, twice);
        }
        12 => {
            let mut lines: Vec<&[u8]> = bytes.split(|&b| b == b'\n').collect();
            let (a, b) = (random.below(lines.len()), random.below(lines.len()));
            lines.swap(a, b);
            *bytes = lines.join(&b'\n');
        }
        _ => {
            // A line many times over.
            let from = bytes[..at].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
            let to = bytes[at..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |i| at + i + 1);
            let line = bytes[from..to].repeat(1 + random.below(200));
            bytes.splice(from..from, line);
        }
    }
}

/// The word around a place.
fn word(bytes: &[u8], at: usize) -> (usize, usize) {
    let inside = |b: &u8| !b.is_ascii_whitespace() && !b",=[]()\"'{}:".contains(b);
    let from = bytes[..at].iter().rposition(|b| !inside(b)).map_or(0, |i| i + 1);
    let to = bytes[at..].iter().position(|b| !inside(b)).map_or(bytes.len(), |i| at + i);
    (from.min(to), to)
}

/// An archive with faults in one of its arrays.
fn repacked(input: &[u8], other: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let mut arrays = unpacked(input)?;
    let others = unpacked(other)?;
    let at = random.below(arrays.len());
    let foreign = &others.get(random.below(others.len()))?.1;
    let there: Vec<String> = arrays.iter().map(|(name, _)| name.clone()).collect();
    let is_there = |name: &str| there.iter().any(|other| other == name);
    let (name, bytes) = arrays.get_mut(at)?;
    if random.below(8) == 0 {
        let new = ["poses", "trans", "fps", "names", "a"][random.below(5)];
        if !is_there(new) {
            new.clone_into(name);
        }
    } else {
        // Headers are short and worth more than the numbers behind them.
        let head = bytes.len().min(128);
        let rest = bytes.split_off(if random.below(2) == 0 { head } else { bytes.len() });
        let is_head = !rest.is_empty();
        *bytes = faults(std::mem::take(bytes), foreign, is_head, random);
        bytes.extend(rest);
    }
    let arrays: Vec<(&str, Vec<u8>)> =
        arrays.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
    Some(containers::npz(&arrays, random.below(2) == 0))
}

fn unpacked(bytes: &[u8]) -> Option<Vec<(String, Vec<u8>)>> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).ok()?;
    let mut arrays = Vec::new();
    for index in 0..archive.len().min(8) {
        let mut content = Vec::new();
        let file = archive.by_index(index).ok()?;
        let name = file.name().ok()?.trim_end_matches(".npy").to_owned();
        std::io::Read::read_to_end(&mut std::io::Read::take(file, 1 << 20), &mut content).ok()?;
        if !arrays.iter().any(|(other, _)| *other == name) {
            arrays.push((name, content));
        }
    }
    Some(arrays)
}

/// A GLB with faults in one of its chunks.
fn rechunked(input: &[u8], other: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let (mut json, mut data) = chunks(input)?;
    let (other_json, other_data) = chunks(other)?;
    if random.below(4) > 0 {
        json = faults(json, &other_json, true, random);
    } else {
        data = faults(data, &other_data, false, random);
    }
    json.resize(json.len().div_ceil(4) * 4, b' ');
    data.resize(data.len().div_ceil(4) * 4, 0);
    let length = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap().to_le_bytes();
    let total = u32::try_from(28 + json.len() + data.len()).unwrap().to_le_bytes();
    Some(
        [
            b"glTF\x02\0\0\0".as_slice(),
            &total,
            &length(&json),
            b"JSON",
            &json,
            &length(&data),
            b"BIN\0",
            &data,
        ]
        .concat(),
    )
}

fn chunks(bytes: &[u8]) -> Option<(Vec<u8>, Vec<u8>)> {
    let length = |at: usize| -> Option<usize> {
        let bytes: [u8; 4] = bytes.get(at..at + 4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(bytes)).ok()
    };
    let json = bytes.get(20..20 + length(12)?)?;
    let data = 20 + json.len() + 8;
    let data = bytes.get(data..data + length(data - 8)?)?;
    Some((json.to_vec(), data.to_vec()))
}
