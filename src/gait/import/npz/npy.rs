//! One `NumPy` array (`.npy`): a header that says type, order and shape, then the elements.
//!
//! Read in place: nothing is copied, and the shape must fit the bytes that are there. Numbers of any width and byte
//! order, Booleans and text; no structures, and no pickled objects (they are programs).

/// What one element is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
    /// UTF-32.
    Text,
    /// One byte a character.
    Bytes,
}

/// An array in the bytes of a file.
#[derive(Debug)]
pub(super) struct Array<'a> {
    pub(super) shape: Vec<usize>,
    kind: Kind,
    /// Bytes of an element.
    size: usize,
    big_endian: bool,
    fortran: bool,
    data: &'a [u8],
}

/// Most dimensions of an array.
const MAX_DIMENSIONS: usize = 8;
/// Longest header, bytes.
const MAX_HEADER: usize = 1 << 16;

impl<'a> Array<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, String> {
        let rest =
            bytes.strip_prefix(b"\x93NUMPY").ok_or("no NumPy array: the first bytes are not \\x93NUMPY")?;
        let (length, rest) = match rest {
            [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
            [2 | 3, _, a, b, c, d, rest @ ..] => {
                (usize::try_from(u32::from_le_bytes([*a, *b, *c, *d])).unwrap_or(usize::MAX), rest)
            }
            [version, ..] => return Err(format!("NumPy format version {version}; 1 to 3 are read")),
            [] => return Err("the array is cut off in its header".to_owned()),
        };
        if length > MAX_HEADER || length > rest.len() {
            return Err(format!("the header claims {length} bytes; the array is cut off or broken"));
        }
        let (header, data) = rest.split_at(length);
        let header = String::from_utf8_lossy(header);
        let (kind, size, big_endian) = element(after(&header, "descr")?)?;
        let fortran = match after(&header, "fortran_order")? {
            text if text.starts_with("True") => true,
            text if text.starts_with("False") => false,
            text => return Err(format!("fortran_order is {:?}; True or False was expected", head(text))),
        };
        let shape = shape(after(&header, "shape")?)?;
        let bytes = shape.iter().try_fold(size, |product, &extent| product.checked_mul(extent));
        match bytes {
            Some(bytes) if bytes <= data.len() => {
                Ok(Self { shape, kind, size, big_endian, fortran, data: &data[..bytes] })
            }
            _ => Err(format!(
                "shape {shape:?} of {size} bytes each needs more than the {} bytes that are there; is it cut off?",
                data.len()
            )),
        }
    }

    /// Whether its elements are numbers.
    pub(super) fn is_numeric(&self) -> bool {
        matches!(self.kind, Kind::Float | Kind::Signed | Kind::Unsigned)
    }

    /// Number of elements.
    pub(super) fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// The bytes of an element in little-endian order, and how many there are.
    fn raw(&self, indices: &[usize]) -> Option<([u8; 8], usize)> {
        let mut at = 0_usize;
        let mut add = |(&index, &extent): (&usize, &usize)| {
            at = at.checked_mul(extent)?.checked_add(index)?;
            (index < extent).then_some(())
        };
        let pairs = indices.iter().zip(&self.shape);
        if self.fortran {
            pairs.rev().try_for_each(&mut add)?;
        } else {
            pairs.into_iter().try_for_each(&mut add)?;
        }
        let start = at.checked_mul(self.size)?;
        let bytes = self.data.get(start..start.checked_add(self.size)?)?;
        let mut raw = [0; 8];
        raw.get_mut(..self.size)?.copy_from_slice(bytes);
        if self.big_endian {
            raw.get_mut(..self.size)?.reverse();
        }
        Some((raw, self.size))
    }

    /// A number; `None` outside the shape or for what is no number.
    #[allow(clippy::cast_precision_loss, reason = "counts and rates; motion is in floats")]
    pub(super) fn number(&self, indices: &[usize]) -> Option<f64> {
        let (raw, size) = self.raw(indices)?;
        let [a, b, c, d, ..] = raw;
        match (self.kind, size) {
            (Kind::Float, 8) => Some(f64::from_le_bytes(raw)),
            (Kind::Float, 4) => Some(f64::from(f32::from_le_bytes([a, b, c, d]))),
            (Kind::Float, 2) => Some(half(u16::from_le_bytes([a, b]))),
            (Kind::Unsigned, _) => Some(u64::from_le_bytes(raw) as f64),
            (Kind::Signed, _) => {
                let unused = 64 - 8 * u32::try_from(size).ok()?;
                Some(((i64::from_le_bytes(raw) << unused) >> unused) as f64)
            }
            _ => None,
        }
    }

    /// The texts of an array of one dimension.
    pub(super) fn texts(&self) -> Option<Vec<String>> {
        let width = match self.kind {
            Kind::Text => 4,
            Kind::Bytes => 1,
            _ => return None,
        };
        if self.shape.len() != 1 || self.size == 0 {
            return None;
        }
        let character = |bytes: &[u8]| match *bytes {
            [a, b, c, d] => {
                let bytes = [a, b, c, d];
                char::from_u32(if self.big_endian {
                    u32::from_be_bytes(bytes)
                } else {
                    u32::from_le_bytes(bytes)
                })
            }
            [a] => Some(char::from(a)),
            _ => None,
        };
        let text = |bytes: &[u8]| bytes.chunks(width).filter_map(character).filter(|&c| c != '\0').collect();
        Some(self.data.chunks(self.size).map(text).collect())
    }
}

/// A number of 16 bits (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from((bits >> 10) & 31), f64::from(bits & 0x3ff));
    sign * match exponent {
        0 => fraction * 2.0_f64.powi(-24),
        31 if bits & 0x3ff == 0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction / 1024.0) * 2.0_f64.powi(exponent - 15),
    }
}

/// Beginning of a text for a message.
fn head(text: &str) -> String {
    text.chars().take(20).collect()
}

/// What follows `'key':` in the header.
fn after<'h>(header: &'h str, key: &str) -> Result<&'h str, String> {
    ['\'', '"']
        .into_iter()
        .find_map(|quote| header.split_once(&format!("{quote}{key}{quote}")))
        .and_then(|(_, rest)| rest.trim_start().strip_prefix(':'))
        .map(str::trim_start)
        .ok_or_else(|| format!("the header has no {key}"))
}

/// Kind, bytes and byte order of `'<f4'`.
fn element(text: &str) -> Result<(Kind, usize, bool), String> {
    let wrong = || {
        format!(
            "elements of type {}; numbers and text are read, no structures and no pickled objects (convert with \
             .astype('float32'))",
            head(text)
        )
    };
    let inner = text.strip_prefix(['\'', '"']).ok_or_else(wrong)?;
    let inner = inner.split(['\'', '"']).next().unwrap_or_default();
    let mut letters = inner.chars();
    let order = letters.next().ok_or_else(wrong)?;
    let (order, letter) = match order {
        '<' | '>' | '|' | '=' => (order, letters.next().ok_or_else(wrong)?),
        letter => ('<', letter),
    };
    let count: usize = letters.as_str().parse().map_err(|_not_a_number| wrong())?;
    let kind = match (letter, count) {
        ('f', 2 | 4 | 8) => Kind::Float,
        ('i', 1 | 2 | 4 | 8) => Kind::Signed,
        ('u', 1 | 2 | 4 | 8) | ('b', 1) => Kind::Unsigned,
        ('U', 0..=4096) => return Ok((Kind::Text, 4 * count, order == '>')),
        ('S', 0..=4096) => return Ok((Kind::Bytes, count, false)),
        _ => return Err(wrong()),
    };
    Ok((kind, count, order == '>'))
}

/// The numbers of `(3, 4)`.
fn shape(text: &str) -> Result<Vec<usize>, String> {
    let wrong = || format!("the shape is {:?}; such as (300, 16, 3) was expected", head(text));
    let inner = text.strip_prefix('(').and_then(|rest| rest.split_once(')')).ok_or_else(wrong)?.0;
    let extents = inner.split(',').map(str::trim).filter(|extent| !extent.is_empty());
    let shape: Vec<usize> = extents
        .take(MAX_DIMENSIONS + 1)
        .map(str::parse)
        .collect::<Result<_, _>>()
        .map_err(|_not_a_number| wrong())?;
    if shape.len() > MAX_DIMENSIONS {
        return Err(format!("more than {MAX_DIMENSIONS} dimensions"));
    }
    Ok(shape)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The bytes of an array, as `NumPy` writes them.
    pub(in super::super) fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn elements_of_any_type_and_order_are_found() {
        let numbers = [1.5_f32, -2.0, 3.0, 4.0, 5.0, 6.0];
        let little: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        let big: Vec<u8> = numbers.iter().flat_map(|n| f64::from(*n).to_be_bytes()).collect();
        let bytes = npy("<f4", "False", "(2, 3)", &little);
        let array = Array::new(&bytes).unwrap();
        assert_eq!((array.number(&[0, 1]), array.number(&[1, 0])), (Some(-2.0), Some(4.0)));
        assert_eq!(array.number(&[2, 0]), None);
        let bytes = npy(">f8", "True", "(2, 3)", &big);
        let array = Array::new(&bytes).unwrap();
        assert_eq!((array.number(&[0, 1]), array.number(&[1, 0])), (Some(3.0), Some(-2.0)));
        let halves: Vec<u8> = [0x3e00_u16, 0xc000, 0x0001].iter().flat_map(|n| n.to_le_bytes()).collect();
        let bytes = npy("<f2", "False", "(3,)", &halves);
        let array = Array::new(&bytes).unwrap();
        assert_eq!([0, 1, 2].map(|i| array.number(&[i])), [Some(1.5), Some(-2.0), Some(2.0_f64.powi(-24))]);
        let bytes = npy(">i2", "False", "(2,)", &[0xff, 0xfe, 0, 7]);
        let array = Array::new(&bytes).unwrap();
        assert_eq!([0, 1].map(|i| array.number(&[i])), [Some(-2.0), Some(7.0)]);
        let bytes = npy("<f8", "False", "()", &120.0_f64.to_le_bytes());
        assert_eq!(Array::new(&bytes).unwrap().number(&[]), Some(120.0));
        let bytes = npy("|S3", "False", "(2,)", b"abcd\0\0");
        assert_eq!(Array::new(&bytes).unwrap().texts().unwrap(), ["abc", "d"]);
        let bytes = npy("<U2", "False", "(1,)", &[b'h', 0, 0, 0, b'i', 0, 0, 0]);
        assert_eq!(Array::new(&bytes).unwrap().texts().unwrap(), ["hi"]);
    }

    #[test]
    fn a_shape_beyond_the_bytes_is_refused() {
        for (descr, shape, expected) in [
            ("<f4", "(1000000000, 16, 3)", "cut off"),
            ("<f4", "(18446744073709551615, 18446744073709551615)", "cut off"),
            ("<f4", "(2, 3", "such as (300, 16, 3)"),
            ("|O", "(1,)", "pickled"),
            ("<f16", "(1,)", "type"),
            ("<f4", "(1,1,1,1,1,1,1,1,1)", "dimensions"),
            ("<f4", "(-1,)", "shape"),
        ] {
            let bytes = npy(descr, "False", shape, &[0; 24]);
            let message = Array::new(&bytes).unwrap_err();
            assert!(message.contains(expected), "{message} should say {expected}");
        }
        assert!(Array::new(b"PK").unwrap_err().contains("NUMPY"));
        assert!(Array::new(b"\x93NUMPY\x01\x00\xff").is_err());
    }
}
