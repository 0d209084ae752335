//! The parameters of a C3D file: groups of named arrays of bytes, integers, floats or characters.

/// How a file writes numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    /// Little-endian, IEEE floats.
    Intel,
    /// Little-endian, VAX floats.
    Dec,
    /// Big-endian, IEEE floats.
    Mips,
}

impl Number {
    /// The first two bytes as a word; 0 if they are not there.
    pub(super) fn word(self, bytes: &[u8]) -> u16 {
        match (self, bytes) {
            (Self::Mips, [a, b, ..]) => u16::from_be_bytes([*a, *b]),
            (_, [a, b, ..]) => u16::from_le_bytes([*a, *b]),
            _ => 0,
        }
    }

    /// The first two bytes as a signed integer.
    pub(super) fn integer(self, bytes: &[u8]) -> i16 {
        self.word(bytes).cast_signed()
    }

    /// The first four bytes as a float; 0 if they are not there.
    pub(super) fn float(self, bytes: &[u8]) -> f32 {
        let &[a, b, c, d, ..] = bytes else { return 0.0 };
        match self {
            Self::Intel => f32::from_le_bytes([a, b, c, d]),
            Self::Mips => f32::from_be_bytes([a, b, c, d]),
            // Words exchanged, and an exponent that counts from 128 below a leading 0.1 (binary): a factor of 4.
            Self::Dec => f32::from_le_bytes([c, d, a, b]) / 4.0,
        }
    }
}

/// One parameter.
#[derive(Debug)]
struct Parameter<'a> {
    group: i8,
    name: String,
    /// Bytes of an element: -1 characters, 1 bytes, 2 integers, 4 floats.
    kind: i8,
    extents: &'a [u8],
    data: &'a [u8],
}

/// All parameters of a file.
#[derive(Debug)]
pub(super) struct Parameters<'a> {
    number: Number,
    /// Number and name.
    groups: Vec<(i8, String)>,
    all: Vec<Parameter<'a>>,
}

/// Most parameters read.
const MAX_PARAMETERS: usize = 4096;

impl<'a> Parameters<'a> {
    /// Reads the parameters, in whatever order groups and parameters stand.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let &[block, key, ..] = bytes else { return Err("the file is empty".to_owned()) };
        if key != 0x50 {
            return Err(format!("no C3D file: its second byte is {key:#04x}, not 0x50"));
        }
        let start = usize::from(block).saturating_sub(1) * 512;
        let section = bytes.get(start..).filter(|section| section.len() >= 4 && start >= 512);
        let section = section
            .ok_or_else(|| format!("the parameters begin at block {block}, which is not in the file"))?;
        let number = match section[3] {
            84 => Number::Intel,
            85 => Number::Dec,
            86 => Number::Mips,
            other => {
                return Err(format!("processor type {other}; 84 (Intel), 85 (DEC) and 86 (MIPS) are known"));
            }
        };
        let mut found = Self { number, groups: Vec::new(), all: Vec::new() };
        let mut rest = &section[4..];
        while found.all.len() + found.groups.len() < MAX_PARAMETERS {
            let Some(next) = found.entry(rest) else { break };
            rest = next;
        }
        Ok(found)
    }

    /// Reads one entry; what follows it, or `None` at the end.
    fn entry(&mut self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let &[length, group, ref rest @ ..] = bytes else { return None };
        // A negative length says that the entry is locked.
        let length = usize::from(length.cast_signed().unsigned_abs());
        let group = group.cast_signed();
        if length == 0 || rest.len() < length + 2 {
            return None;
        }
        let (name, rest) = rest.split_at(length);
        let name = String::from_utf8_lossy(name).trim().to_ascii_uppercase();
        let jump = usize::from(self.number.word(rest));
        let body = &rest[2..];
        if group < 0 {
            self.groups.push((group.saturating_neg(), name));
        } else if let &[kind, dimensions, ref body @ ..] = body {
            let dimensions = usize::from(dimensions);
            if dimensions <= body.len() {
                let (extents, body) = body.split_at(dimensions);
                let kind = kind.cast_signed();
                let count =
                    extents.iter().try_fold(1_usize, |count, &extent| count.checked_mul(usize::from(extent)));
                let bytes = count.and_then(|count| count.checked_mul(usize::from(kind.unsigned_abs())));
                if let Some(data) = bytes.and_then(|bytes| body.get(..bytes)) {
                    self.all.push(Parameter { group, name, kind, extents, data });
                }
            }
        }
        // Counted from the jump itself; 0 is the last entry.
        if jump < 2 { None } else { rest.get(jump..) }
    }

    /// How the file writes numbers.
    pub(super) const fn number(&self) -> Number {
        self.number
    }

    fn get(&self, group: &str, name: &str) -> Option<&Parameter<'a>> {
        let (number, _) = self.groups.iter().find(|(_, other)| other == group)?;
        self.all.iter().find(|parameter| parameter.group == *number && parameter.name == name)
    }

    /// The first integer of a parameter, as a word without sign.
    pub(super) fn integer(&self, group: &str, name: &str) -> Option<u16> {
        let parameter = self.get(group, name)?;
        (parameter.kind == 2 && parameter.data.len() >= 2).then(|| self.number.word(parameter.data))
    }

    /// An integer of 32 bits in two words, the lower first.
    pub(super) fn long(&self, group: &str, name: &str) -> Option<usize> {
        let data = self.get(group, name).filter(|parameter| parameter.kind == 2)?.data;
        let [low, high] = [data.get(..2)?, data.get(2..4)?].map(|word| usize::from(self.number.word(word)));
        Some(low + 65536 * high)
    }

    /// The first float of a parameter; integers count.
    pub(super) fn float(&self, group: &str, name: &str) -> Option<f32> {
        let parameter = self.get(group, name)?;
        match parameter.kind {
            4 if parameter.data.len() >= 4 => Some(self.number.float(parameter.data)),
            2 if parameter.data.len() >= 2 => Some(f32::from(self.number.integer(parameter.data))),
            _ => None,
        }
    }

    /// The texts of a parameter of characters: its first extent is their length.
    pub(super) fn texts(&self, group: &str, name: &str) -> Vec<String> {
        let Some(parameter) = self.get(group, name).filter(|parameter| parameter.kind == -1) else {
            return Vec::new();
        };
        let length = parameter.extents.first().map_or(parameter.data.len(), |&extent| usize::from(extent));
        if length == 0 {
            return Vec::new();
        }
        parameter.data.chunks(length).map(|text| String::from_utf8_lossy(text).trim().to_owned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_three_processors_agree() {
        // 1.0 and -118.625 as the three write them; VAX F floating has a bias of 128 and a mantissa of 0.1fff.
        for (value, ieee, vax) in [
            (1.0_f32, 0x3f80_0000_u32, [0x80_u8, 0x40, 0, 0]),
            (-118.625, 0xc2ed_4000, [0xed, 0xc3, 0x00, 0x40]),
        ] {
            assert!((Number::Intel.float(&ieee.to_le_bytes()) - value).abs() < 1e-6);
            assert!((Number::Mips.float(&ieee.to_be_bytes()) - value).abs() < 1e-6);
            assert!((Number::Dec.float(&vax) - value).abs() < 1e-6, "{}", Number::Dec.float(&vax));
        }
        assert_eq!(Number::Mips.integer(&[0xff, 0xfe]), -2);
        assert_eq!(Number::Intel.integer(&[0xfe, 0xff]), -2);
    }
}
