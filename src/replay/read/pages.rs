//! What the pages of a Parquet column claim to hold, looked at before the library reserves memory for it: it takes a page's
//! word for its size.

/// Deepest nesting of a page's header; it has two levels.
const DEEPEST: u8 = 8;

/// What a column may claim.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    /// Bytes of a page.
    pub(super) most: u64,
    /// Values, with those that are missing.
    pub(super) rows: u64,
    /// Bytes of a value, where none may be missing.
    pub(super) width: Option<u64>,
}

/// Number of the encoding whose decoder looks for all values that a page claims: byte-stream-split.
const SPLIT: i64 = 9;

/// Refuses a column whose pages claim more than it may, or than they have room for. `chunk` are its bytes, header after
/// header.
pub(super) fn check(mut chunk: &[u8], bounds: Bounds) -> Result<(), String> {
    let Bounds { most, rows, width } = bounds;
    let mut left = rows;
    while !chunk.is_empty() {
        let mut input = Compact { bytes: chunk, at: 0 };
        let header = Header::read(&mut input).ok_or("the header of a page is broken")?;
        let Header { unfolded, stored, entries, values, encoding } = header;
        let room = u64::try_from(unfolded).ok().ok_or_else(|| format!("a page of {unfolded} bytes"))?;
        if room > most {
            return Err(format!("a page of {room} bytes; up to {most} are read"));
        }
        // the shortest entry that is read has four bytes
        if entries < 0 || entries.unsigned_abs() > room / 4 {
            return Err(format!("a dictionary of {entries} entries in {room} bytes"));
        }
        let count = u64::try_from(values).ok().filter(|values| *values <= left);
        let is_room = |count: u64| encoding != SPLIT || width.is_none_or(|width| count <= room / width);
        let Some(count) = count.filter(|count| is_room(*count)) else {
            return Err(format!("a page of {values} values in {room} bytes, of {rows} rows"));
        };
        left -= count;
        let end = usize::try_from(stored).ok().and_then(|stored| input.at.checked_add(stored));
        chunk = end.and_then(|end| chunk.get(end..)).ok_or("a page is longer than its column")?;
    }
    Ok(())
}

/// What a page's header claims.
#[derive(Debug, Default)]
struct Header {
    unfolded: i64,
    stored: i64,
    /// Of a dictionary.
    entries: i64,
    /// Of data.
    values: i64,
    encoding: i64,
}

impl Header {
    fn read(input: &mut Compact<'_>) -> Option<Self> {
        let mut header = Self::default();
        input.fields(|input, field, kind| {
            match (field, kind) {
                (2, INT) => header.unfolded = input.zigzag()?,
                (3, INT) => header.stored = input.zigzag()?,
                // pages of data of both versions, and of dictionaries
                (5 | 7 | 8, STRUCT) => input.fields(|input, inner, kind| {
                    match (field, inner, kind) {
                        (7, 1, INT) => header.entries = input.zigzag()?,
                        (_, 1, INT) => header.values = input.zigzag()?,
                        (5, 2, INT) | (8, 4, INT) => header.encoding = input.zigzag()?,
                        _ => input.skip(kind, DEEPEST)?,
                    }
                    Some(())
                })?,
                _ => input.skip(kind, DEEPEST)?,
            }
            Some(())
        })?;
        Some(header)
    }
}

/// Thrift's compact protocol.
struct Compact<'a> {
    bytes: &'a [u8],
    at: usize,
}

const INT: u8 = 5;
const STRUCT: u8 = 12;

impl Compact<'_> {
    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    fn zigzag(&mut self) -> Option<i64> {
        let value = self.varint()?;
        #[allow(clippy::cast_possible_wrap, reason = "that is how signs are coded")]
        let (half, sign) = ((value >> 1) as i64, (value & 1) as i64);
        Some(half ^ -sign)
    }

    fn pass(&mut self, count: u64) -> Option<()> {
        let end = self.at.checked_add(usize::try_from(count).ok()?)?;
        (end <= self.bytes.len()).then(|| self.at = end)
    }

    /// Calls `take` with the number and the kind of every field of a struct; it must read over the value.
    fn fields(&mut self, mut take: impl FnMut(&mut Self, i64, u8) -> Option<()>) -> Option<()> {
        let mut field = 0;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            field = if head >> 4 == 0 { self.zigzag()? } else { field + i64::from(head >> 4) };
            take(self, field, head & 15)?;
        }
    }

    /// Reads over a value.
    fn skip(&mut self, kind: u8, depth: u8) -> Option<()> {
        let deeper = depth.checked_sub(1)?;
        match kind {
            1 | 2 => Some(()), // true and false are their own kinds
            3 => self.pass(1),
            4..=6 => self.varint().map(drop),
            7 => self.pass(8),
            8 => self.varint().and_then(|length| self.pass(length)),
            9 | 10 => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
                let of = head & 15;
                for _ in 0..count {
                    // in lists, a truth is a byte
                    self.skip(if matches!(of, 1 | 2) { 3 } else { of }, deeper)?;
                }
                Some(())
            }
            STRUCT => self.fields(|input, _, kind| input.skip(kind, deeper)),
            _ => None, // no header has maps
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page of these sizes and bytes, with fields of one struct.
    fn page(unfolded: u8, stored: u8, inner: &[u8]) -> Vec<u8> {
        let head = [0x15, 0, 0x15, 2 * unfolded, 0x15, 2 * stored];
        [&head[..], inner, &[0], &vec![0xaa; stored.into()]].concat()
    }

    /// A dictionary, with a flag behind its encoding.
    fn dictionary(entries: u8) -> [u8; 7] {
        [0x4c, 0x15, 2 * entries, 0x15, 0, 0x11, 0]
    }

    /// Data of version 1.
    fn data(values: u8, encoding: u8) -> [u8; 6] {
        [0x2c, 0x15, 2 * values, 0x15, 2 * encoding, 0]
    }

    #[test]
    fn pages_that_claim_too_much_are_refused_before_they_are_read() {
        let bounds = Bounds { most: 60, rows: 20, width: Some(4) };
        let two = [page(40, 3, &dictionary(10)), page(60, 5, &data(15, 9))].concat();
        assert_eq!(check(&two, bounds), Ok(()));
        let wrong = |bytes: &[u8], bounds: Bounds| check(bytes, bounds).unwrap_err();
        assert!(wrong(&two, Bounds { most: 59, ..bounds }).contains("a page of 60 bytes"));
        assert!(wrong(&two, Bounds { rows: 14, ..bounds }).contains("15 values"));
        assert!(
            wrong(&[page(60, 0, &data(12, 0)), page(60, 0, &data(9, 0))].concat(), bounds)
                .contains("9 values")
        );
        assert!(wrong(&page(60, 5, &data(16, 9)), bounds).contains("16 values in 60 bytes"));
        assert_eq!(check(&page(60, 5, &data(16, 9)), Bounds { width: None, ..bounds }), Ok(()));
        assert!(wrong(&page(40, 3, &dictionary(11)), bounds).contains("11 entries in 40 bytes"));
        for cut in 1..two.len() - 1 {
            let whole = cut == page(40, 3, &dictionary(10)).len();
            assert_eq!(check(&two[..cut], bounds).is_ok(), whole, "{cut}");
        }
        let negative = [0x15, 0, 0x15, 1, 0x15, 0, 0];
        assert!(wrong(&negative, bounds).contains("-1 bytes"));
    }
}
