//! Encodings of Parquet that a million agents need: each appends the bytes of a page's values. The library's own writer copies
//! every page four times, and finds the words of a dictionary by hashing.

/// Deltas of a block, and of the miniblocks that have a width of their own.
const BLOCK: usize = 128;
const MINIBLOCK: usize = 32;
/// Rows that share a byte of flags, and the least run of a repeated word.
const GROUP: usize = 8;

/// Bits, the lowest first.
#[derive(Debug)]
struct Bits<'a> {
    out: &'a mut Vec<u8>,
    waiting: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    fn new(out: &'a mut Vec<u8>) -> Self {
        Self { out, waiting: 0, count: 0 }
    }

    /// Appends the lower `width` bits of a number that has no others; 32 at most.
    fn push(&mut self, number: u32, width: u32) {
        self.waiting |= u64::from(number) << self.count;
        self.count += width;
        if self.count >= u32::BITS {
            let [a, b, c, d, ..] = self.waiting.to_le_bytes();
            self.out.extend_from_slice(&[a, b, c, d]);
            self.waiting >>= u32::BITS;
            self.count -= u32::BITS;
        }
    }

    /// Fills the last byte with zeros.
    fn finish(self) {
        let bytes = self.waiting.to_le_bytes();
        self.out.extend_from_slice(&bytes[..self.count.div_ceil(u8::BITS) as usize]);
    }
}

/// The lowest byte.
fn lowest(number: u64) -> u8 {
    number.to_le_bytes()[0]
}

fn varint(out: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        out.push(lowest(number) | 0x80);
        number >>= 7;
    }
    out.push(lowest(number));
}

fn zigzag(out: &mut Vec<u8>, number: i32) {
    varint(out, u64::from((number << 1 ^ number >> 31).cast_unsigned()));
}

/// Yes and no, a bit each (`PLAIN`).
pub(super) fn flags(out: &mut Vec<u8>, flags: &[bool]) {
    out.extend(flags.chunks(GROUP).map(byte_of));
}

fn byte_of(flags: &[bool]) -> u8 {
    (0..).zip(flags).fold(0, |byte, (bit, flag)| byte | u8::from(*flag) << bit)
}

/// Which rows of an optional column have a value (`RLE`), with the length before it.
pub(super) fn levels(out: &mut Vec<u8>, has_value: &[bool]) {
    let start = out.len();
    out.extend_from_slice(&[0; 4]);
    let first = has_value.first().copied().unwrap_or_default();
    // without an early end, so that the compiler makes vectors of it
    if has_value.iter().fold(true, |alike, one| alike & (*one == first)) {
        varint(out, (has_value.len() as u64) << 1);
        out.push(u8::from(first));
    } else {
        varint(out, (has_value.len().div_ceil(GROUP) as u64) << 1 | 1);
        flags(out, has_value);
    }
    let length = u32::try_from(out.len() - start - 4).unwrap_or(u32::MAX); // of a page: far less
    out[start..start + 4].copy_from_slice(&length.to_le_bytes());
}

/// Numbers with bytes of equal weight side by side (`BYTE_STREAM_SPLIT`).
pub(super) fn split(out: &mut Vec<u8>, values: &[f32]) {
    if values.is_empty() {
        return;
    }
    let start = out.len();
    out.resize(start + size_of_val(values), 0);
    for (stream, shift) in out[start..].chunks_exact_mut(values.len()).zip([0_u32, 8, 16, 24]) {
        for (byte, value) in stream.iter_mut().zip(values) {
            *byte = (value.to_bits() >> shift).to_le_bytes()[0];
        }
    }
}

/// Whole numbers as differences of successive ones (`DELTA_BINARY_PACKED`).
pub(super) fn delta(out: &mut Vec<u8>, values: &[i32]) {
    varint(out, BLOCK as u64);
    varint(out, (BLOCK / MINIBLOCK) as u64);
    varint(out, values.len() as u64);
    zigzag(out, values.first().copied().unwrap_or(0));
    let mut deltas = [0_i32; BLOCK];
    let mut last = deltas;
    let mut coded = out.len()..out.len();
    let mut start = 0;
    while start + 1 < values.len() {
        let block = &values[start..values.len().min(start + BLOCK + 1)];
        let count = block.len() - 1;
        for ((delta, from), to) in deltas.iter_mut().zip(block).zip(&block[1..]) {
            *delta = to.wrapping_sub(*from);
        }
        start += count;
        // most often a block is as the one before it: of so many frames, the same numbers for each agent
        if deltas == last && count == BLOCK && !coded.is_empty() {
            out.extend_from_within(coded.clone());
            continue;
        }
        last = deltas;
        coded.start = out.len();
        let least = deltas[..count].iter().copied().min().unwrap_or(0);
        zigzag(out, least);
        // what fills the last miniblock is zero, as packed
        deltas[count..].fill(least);
        let above = deltas.map(|delta| delta.wrapping_sub(least).cast_unsigned());
        let widths = out.len();
        out.extend_from_slice(&[0; BLOCK / MINIBLOCK]);
        let (miniblocks, _) = above.as_chunks::<MINIBLOCK>();
        for (number, miniblock) in miniblocks.iter().enumerate().take(count.div_ceil(MINIBLOCK)) {
            let width = u32::BITS - miniblock.iter().fold(0, |all, one| all | one).leading_zeros();
            out[widths + number] = lowest(width.into());
            match width {
                0 => {}
                1..=16 => pack(out, &miniblock.map(low_half), width),
                _ => {
                    let mut bits = Bits::new(out);
                    miniblock.iter().for_each(|one| bits.push(*one, width));
                    bits.finish();
                }
            }
        }
        coded.end = out.len();
    }
}

/// The lower 16 bits.
fn low_half(number: u32) -> u16 {
    let [low, high, ..] = number.to_le_bytes();
    u16::from_le_bytes([low, high])
}

/// Numbers of words in a dictionary of so many (`RLE_DICTIONARY`): words that repeat as runs, others packed.
pub(super) fn words(out: &mut Vec<u8>, words: &[u16], of: u16) {
    let width = (u16::BITS - of.saturating_sub(1).leading_zeros()).max(1);
    out.push(lowest(width.into()));
    let mut rest = words;
    while let Some(first) = rest.first() {
        let alike = rest.iter().take_while(|word| *word == first).count();
        if alike >= GROUP {
            varint(out, (alike as u64) << 1);
            out.extend_from_slice(&first.to_le_bytes()[..width.div_ceil(u8::BITS) as usize]);
            rest = &rest[alike..];
            continue;
        }
        let is_run = |group: &[u16; GROUP]| group.iter().fold(true, |all, word| all & (*word == group[0]));
        let (groups, _) = rest.as_chunks::<GROUP>();
        let packed = groups.iter().position(is_run).map_or(rest.len(), |groups| groups * GROUP);
        let (packed, after) = rest.split_at(packed);
        varint(out, (packed.len().div_ceil(GROUP) as u64) << 1 | 1);
        pack(out, packed, width);
        rest = after;
    }
}

/// Words of 16 bits at most, of which each takes `width` bits: eight are so many bytes. What is missing of eight is zero.
fn pack(out: &mut Vec<u8>, words: &[u16], width: u32) {
    const ROOM: usize = size_of::<u128>();
    let size = width as usize;
    let (groups, rest) = words.as_chunks::<GROUP>();
    let mut end = out.len();
    // room for whole numbers of 128 bits, of which the next group overwrites what it does not need
    out.resize(end + words.len().div_ceil(GROUP) * size + ROOM, 0);
    let mut put = |group: &[u16; GROUP]| {
        let [a, b, c, d, e, f, g, h] = group.map(u64::from);
        let pairs = [a | b << width, c | d << width, e | f << width, g | h << width];
        let [low, high] = [pairs[0] | pairs[1] << (2 * width), pairs[2] | pairs[3] << (2 * width)];
        let bits = u128::from(low) | u128::from(high) << (4 * width);
        if let Some(place) = out[end..].first_chunk_mut::<ROOM>() {
            *place = bits.to_le_bytes();
        }
        end += size;
    };
    groups.iter().for_each(&mut put);
    if !rest.is_empty() {
        let mut last = [0; GROUP];
        last[..rest.len()].copy_from_slice(rest);
        put(&last);
    }
    out.truncate(end);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_follow_one_another_from_the_lowest_on() {
        let mut out = Vec::new();
        let mut bits = Bits::new(&mut out);
        for (number, width) in [(0b1, 1), (0b10, 2), (0xffff_ffff, 32), (0b101, 3)] {
            bits.push(number, width);
        }
        bits.finish();
        assert_eq!(out, [0b1111_1101, 0xff, 0xff, 0xff, 0b10_1111]);
    }

    #[test]
    fn examples_of_the_format_have_its_bytes() {
        let coded = |encode: &dyn Fn(&mut Vec<u8>)| {
            let mut out = Vec::new();
            encode(&mut out);
            out
        };
        // 1 to 5: a first value and deltas of 1, which take no bits above the least
        assert_eq!(coded(&|out| delta(out, &[1, 2, 3, 4, 5])), [128, 1, 4, 5, 2, 2, 0, 0, 0, 0]);
        // the numbers 0 to 7 in three bits each: the example of the hybrid
        let eight = coded(&|out| words(out, &[0, 1, 2, 3, 4, 5, 6, 7], 8));
        assert_eq!(eight, [3, 0b11, 0b1000_1000, 0b1100_0110, 0b1111_1010]);
        assert_eq!(coded(&|out| words(out, &[300; 20], 1000)), [10, 40, 44, 1]);
        assert_eq!(coded(&|out| levels(out, &[true; 200])), [3, 0, 0, 0, 0x90, 3, 1]);
        assert_eq!(coded(&|out| levels(out, &[false, true, true])), [2, 0, 0, 0, 3, 0b110]);
        let [one, two] = [f32::from_bits(0x0403_0201), f32::from_bits(0x1413_1211)];
        assert_eq!(coded(&|out| split(out, &[one, two])), [1, 0x11, 2, 0x12, 3, 0x13, 4, 0x14]);
    }
}
