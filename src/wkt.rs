//! Polygons as well-known text (OGC 06-103r4, section 7): the one reader and the one writer.
//!
//! They are our own although there is the crate `wkt` (0.14). That parser names no place in the text, ends without a word
//! about what follows the geometry, refuses further numbers without a `Z`, and overflows the stack of the process on
//! collections that lie deep in one another.

use glam::DVec2;
use std::fmt::{Display, Write as _};

/// Rings of a polygon, outer ring first, without the repeated last corner.
pub(crate) type Polygon = Vec<Vec<DVec2>>;

/// Text that is no area as well-known text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("at byte {at}: expected {expected}, found {found}")]
pub struct Error {
    /// Byte of the text, from 0.
    pub at: usize,
    /// What would be right there.
    pub expected: String,
    /// What begins there, quoted; `the end` at the end of the text.
    pub found: String,
}

/// How deep collections may lie in one another.
const DEEPEST: u32 = 16;

/// Every polygon of a POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION, with coordinates of at most `most`. Corners that repeat the
/// one before are left out.
///
/// # Errors
/// What is wrong with the text and where.
pub(crate) fn polygons(text: &str, most: f64) -> Result<Vec<Polygon>, Error> {
    let mut reader = Reader { text, at: 0, most };
    let mut found = Vec::new();
    reader.geometry(&mut found, 0)?;
    reader.space();
    if reader.at < text.len() {
        return Err(reader.wrong("the end"));
    }
    Ok(found)
}

/// POLYGON of one polygon, MULTIPOLYGON otherwise; each ring is closed by its first corner.
pub(crate) fn text<N: Display>(polygons: &[Vec<Vec<[N; 2]>>]) -> String {
    // Writing to a String cannot fail.
    let mut text = String::from(if polygons.len() == 1 { "POLYGON " } else { "MULTIPOLYGON (" });
    for (i, polygon) in polygons.iter().enumerate() {
        text.push_str(if i > 0 { ", (" } else { "(" });
        for (j, ring) in polygon.iter().enumerate() {
            text.push_str(if j > 0 { ", (" } else { "(" });
            for (k, [x, y]) in ring.iter().chain(ring.first()).enumerate() {
                let _ = write!(text, "{}{x} {y}", if k > 0 { ", " } else { "" });
            }
            text.push(')');
        }
        text.push(')');
    }
    if polygons.len() != 1 {
        text.push(')');
    }
    text
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    /// Greatest coordinate.
    most: f64,
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn space(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn wrong(&self, expected: &str) -> Error {
        let found: String = self.rest().chars().take(20).collect();
        let found = if found.is_empty() { "the end".to_owned() } else { format!("{found:?}") };
        Error { at: self.at, expected: expected.to_owned(), found }
    }

    /// Takes a sign if it comes next.
    fn takes(&mut self, sign: char) -> bool {
        self.space();
        let is_next = self.rest().starts_with(sign);
        self.at += usize::from(is_next);
        is_next
    }

    fn word(&mut self) -> String {
        self.space();
        let length = self.rest().bytes().take_while(u8::is_ascii_alphabetic).count();
        let word = self.rest()[..length].to_ascii_uppercase();
        self.at += length;
        word
    }

    fn geometry(&mut self, found: &mut Vec<Polygon>, depth: u32) -> Result<(), Error> {
        self.space();
        let start = self.at;
        let mut kind = self.word();
        // Z, M or ZM, written apart or as one word: further numbers are left out
        for suffix in ["ZM", "Z", "M"] {
            if let Some(bare) = kind
                .strip_suffix(suffix)
                .filter(|bare| bare.ends_with("POLYGON") || bare.ends_with("COLLECTION"))
            {
                kind = bare.to_owned();
            }
        }
        let after = self.at;
        match self.word().as_str() {
            "EMPTY" => return Ok(()),
            "Z" | "M" | "ZM" => {}
            _ => self.at = after,
        }
        match kind.as_str() {
            "POLYGON" => {
                let polygon = self.list(Self::ring)?;
                found.push(polygon);
            }
            "MULTIPOLYGON" => found.extend(self.list(|reader| reader.list(Self::ring))?),
            "GEOMETRYCOLLECTION" if depth < DEEPEST => {
                self.list(|reader| reader.geometry(found, depth + 1))?;
            }
            _ => {
                self.at = start;
                return Err(self.wrong("POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION"));
            }
        }
        Ok(())
    }

    /// One or more items in brackets.
    fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Result<T, Error>) -> Result<Vec<T>, Error> {
        if !self.takes('(') {
            return Err(self.wrong("'('"));
        }
        let mut items = vec![item(self)?];
        while self.takes(',') {
            items.push(item(self)?);
        }
        if self.takes(')') { Ok(items) } else { Err(self.wrong("',' or ')'")) }
    }

    fn ring(&mut self) -> Result<Vec<DVec2>, Error> {
        let start = self.at;
        let mut corners = self.list(Self::corner)?;
        corners.dedup();
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if corners.len() < 3 {
            self.at = start;
            return Err(self.wrong("a ring of three corners or more"));
        }
        Ok(corners)
    }

    fn corner(&mut self) -> Result<DVec2, Error> {
        let at = DVec2::new(self.number()?, self.number()?);
        while self
            .rest()
            .trim_start()
            .starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '+' || c == '.')
        {
            self.number()?;
        }
        Ok(at)
    }

    fn number(&mut self) -> Result<f64, Error> {
        self.space();
        let length =
            self.rest().bytes().take_while(|b| b.is_ascii_alphanumeric() || b"+-.".contains(b)).count();
        match self.rest()[..length].parse::<f64>() {
            Ok(value) if value.abs() <= self.most => {
                self.at += length;
                Ok(value)
            }
            _ => Err(self.wrong(&format!("a number within {} m of 0", self.most))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let square = |at: i32| vec![[at, 0], [at + 2, 0], [at + 2, 2], [at, 2]];
        let hole = vec![[1, 1], [1, 2], [2, 2]];
        assert_eq!(
            text(&[vec![square(0), hole]]),
            "POLYGON ((0 0, 2 0, 2 2, 0 2, 0 0), (1 1, 1 2, 2 2, 1 1))"
        );
        let two = [vec![square(0)], vec![square(5)]];
        let read = polygons(&text(&two), 9.0).unwrap();
        assert_eq!((read.len(), read[1][0][1]), (2, DVec2::new(7.0, 0.0)));
        assert_eq!(
            polygons("POLYGON ((0 0, 1 0, 1 -9.5))", 9.0).unwrap_err().expected,
            "a number within 9 m of 0"
        );
    }

    #[test]
    fn all_spellings_are_read_and_wrong_ones_are_refused_with_the_place() {
        for (text, count) in [
            ("POLYGON((0 0,1 0,1 1,0 0))", 1),
            (" polygon z ((0 0 5, 1 0 5, 1 1 5, 0 0 5)) ", 1),
            ("POLYGONZ ((0 0 5, 1 0 5, 1 1 5, 0 0 5))", 1),
            ("MULTIPOLYGON (((0 0,1e0 0,1 1)), ((2 0,3 0,3 -1.5E-1)))", 2),
            (
                "GEOMETRYCOLLECTION (POLYGON EMPTY, MULTIPOLYGON (((0 0,1 0,1 1))), GEOMETRYCOLLECTION EMPTY)",
                1,
            ),
        ] {
            assert_eq!(polygons(text, 5e4).map(|found| found.len()), Ok(count), "{text}");
        }
        for (text, place) in [
            ("", "byte 0"),
            ("POINT (0 0)", "byte 0"),
            ("POLYGON (0 0, 1 1)", "byte 9"),
            ("POLYGON ((0 0, 1 0, 1 x))", "byte 22"),
            ("POLYGON ((0 0, 1 0, 1 nan))", "byte 22"),
            ("POLYGON ((0 0, 1 0, 1 9e9))", "byte 22"),
            ("POLYGON ((0 0, 1 0, 0 0))", "byte 9"),
            ("POLYGON ((0 0, 1 0, 1 1)) x", "byte 26"),
            ("POLYGON ((0 0, 1 0, 1 1)", "byte 24"),
        ] {
            let error = polygons(text, 5e4).unwrap_err();
            assert!(error.to_string().starts_with(&format!("at {place}:")), "{text}: {error}");
        }
        let deep = "GEOMETRYCOLLECTION (".repeat(5000);
        assert!(polygons(&deep, 5e4).is_err());
    }
}
