//! Polygons out of well-known text (OGC 06-103r4, section 7).

use crate::scenario::polygon::MAX_COORDINATE;
use glam::DVec2;

/// How deep collections may lie in one another.
const DEEPEST: u32 = 16;

/// The rings of every polygon, outer ring first, without the repeated last corner.
pub(crate) fn polygons(text: &str) -> Result<Vec<Vec<Vec<DVec2>>>, String> {
    let mut reader = Reader { text, at: 0 };
    let mut found = Vec::new();
    reader.geometry(&mut found, 0)?;
    reader.space();
    if reader.at < text.len() {
        return Err(reader.wrong("the end"));
    }
    Ok(found)
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn space(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn wrong(&self, wanted: &str) -> String {
        let found: String = self.rest().chars().take(20).collect();
        let found = if found.is_empty() { "the end".to_owned() } else { format!("{found:?}") };
        format!("at byte {}: expected {wanted}, found {found}", self.at)
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

    fn geometry(&mut self, found: &mut Vec<Vec<Vec<DVec2>>>, depth: u32) -> Result<(), String> {
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
    fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Result<T, String>) -> Result<Vec<T>, String> {
        if !self.takes('(') {
            return Err(self.wrong("'('"));
        }
        let mut items = vec![item(self)?];
        while self.takes(',') {
            items.push(item(self)?);
        }
        if self.takes(')') { Ok(items) } else { Err(self.wrong("',' or ')'")) }
    }

    fn ring(&mut self) -> Result<Vec<DVec2>, String> {
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

    fn corner(&mut self) -> Result<DVec2, String> {
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

    fn number(&mut self) -> Result<f64, String> {
        self.space();
        let length =
            self.rest().bytes().take_while(|b| b.is_ascii_alphanumeric() || b"+-.".contains(b)).count();
        match self.rest()[..length].parse::<f64>() {
            Ok(value) if value.abs() <= f64::from(MAX_COORDINATE) => {
                self.at += length;
                Ok(value)
            }
            _ => Err(self.wrong(&format!("a number within {} m of 0", MAX_COORDINATE))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert_eq!(polygons(text).map(|found| found.len()), Ok(count), "{text}");
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
            let error = polygons(text).unwrap_err();
            assert!(error.contains(place), "{text}: {error}");
        }
        let deep = "GEOMETRYCOLLECTION (".repeat(5000);
        assert!(polygons(&deep).is_err());
    }
}
