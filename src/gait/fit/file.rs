//! Fitted gaits as files: JSON for people, and a compact binary form.
//!
//! ```text
//! JSON   { format: "gaitway-harmonic-gaits", version: 2, joints: [16 names], gaits: [ { name, cycle_time (s), speed (m/s),
//!          provenance (as in a library), acted?, ratings?, label?, unit (m), rows: [[48 integers] mean, cos 1, sin 1, cos 2, ...] } ] }
//! binary "GWHG", version u16, gaits u16; each: length of the name u8, name (UTF-8), label u8 (255: none), harmonics u8,
//!          cycle time f32, speed f32, unit f32, rows of 48 i16; all little-endian; joints in the order of Joint
//! ```

use super::{HarmonicGait, MOST_HARMONICS, Row};
use crate::emotion::Emotion;
use crate::file;
use crate::gait::{Error, JOINT_COUNT, Joint, Provenance};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// `format` of the JSON form.
pub const FORMAT: &str = "gaitway-harmonic-gaits";
/// First bytes of the binary form.
pub const MAGIC: [u8; 4] = *b"GWHG";
/// Version of the JSON form.
const JSON_VERSION: u16 = 2;
/// Version of the binary form.
const VERSION: u16 = 1;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 256 << 20;
/// A label of the binary form that is none.
const NO_LABEL: u8 = 255;

#[derive(Serialize, Deserialize)]
struct Document {
    format: String,
    version: u16,
    joints: Vec<String>,
    gaits: Vec<Entry>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    cycle_time: f32,
    speed: f32,
    #[serde(default)]
    provenance: Provenance,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    acted: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ratings: Option<[f32; 4]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    label: Option<Emotion>,
    unit: f32,
    rows: Vec<Vec<i16>>,
}

/// Whether a file's name is that of fitted gaits: `.json` or `.gwh`.
pub fn is_fitted(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json") || e.eq_ignore_ascii_case("gwh"))
}

/// Reads fitted gaits from a file of either form.
///
/// # Errors
/// [`Error::Read`], or [`Error::Syntax`] with file and line if it is not what its form demands.
pub fn load(path: &Path) -> Result<Vec<HarmonicGait>, Error> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let bytes = file::read(path, MOST_BYTES).map_err(failed)?;
    let origin = path.display().to_string();
    if bytes.starts_with(&MAGIC) { from_bytes(&bytes, &origin) } else { from_json(&bytes, &origin) }
}

/// The JSON form.
pub fn to_json(gaits: &[HarmonicGait]) -> String {
    let entry = |gait: &HarmonicGait| Entry {
        name: gait.name.clone(),
        cycle_time: gait.cycle_time,
        speed: gait.speed,
        provenance: gait.provenance.clone(),
        acted: gait.acted.clone(),
        ratings: gait.ratings,
        label: gait.label,
        unit: gait.unit,
        rows: gait.rows.iter().map(|row| row.as_flattened().to_vec()).collect(),
    };
    let document = Document {
        format: FORMAT.to_owned(),
        version: JSON_VERSION,
        joints: Joint::ALL.map(|joint| joint.name().to_owned()).to_vec(),
        gaits: gaits.iter().map(entry).collect(),
    };
    // A row a line: numbers of one harmonic belong together, one number a line would be thousands of lines.
    let text = serde_json::to_string(&document).unwrap_or_default();
    text.replace("],[", "],\n[").replace("},{", "},\n{") + "\n"
}

/// Reads the JSON form; `origin` names it in errors.
///
/// # Errors
/// [`Error::Syntax`] with the line of the fault.
pub fn from_json(bytes: &[u8], origin: &str) -> Result<Vec<HarmonicGait>, Error> {
    let syntax = |line, message: String| Error::Syntax { path: origin.to_owned(), line, message };
    let document: Document = serde_json::from_slice(bytes)
        .map_err(|error| syntax(error.line(), format!("not a file of fitted gaits ({FORMAT}): {error}")))?;
    if document.format != FORMAT || document.version != JSON_VERSION {
        let (format, version) = (document.format, document.version);
        return Err(syntax(
            0,
            format!("format {format:?} version {version}; {FORMAT:?} version {JSON_VERSION} is read"),
        ));
    }
    if !document.joints.iter().eq(Joint::ALL.map(|joint| joint.name().to_owned()).iter()) {
        return Err(syntax(0, "its joints are not the 16 of a gait in their order".to_owned()));
    }
    let read = |entry: Entry| {
        let row = |row: &Vec<i16>| -> Option<Row> {
            let (points, rest) = row.as_chunks::<3>();
            points.try_into().ok().filter(|_| rest.is_empty())
        };
        let rows: Option<Vec<Row>> = entry.rows.iter().map(row).collect();
        let numbers = JOINT_COUNT * 3;
        let rows = rows.ok_or_else(|| format!("gait {:?}: a row has not {numbers} numbers", entry.name))?;
        checked(HarmonicGait {
            name: entry.name,
            cycle_time: entry.cycle_time,
            speed: entry.speed,
            provenance: entry.provenance,
            acted: entry.acted,
            ratings: entry.ratings,
            label: entry.label,
            unit: entry.unit,
            rows,
        })
    };
    document.gaits.into_iter().map(|entry| read(entry).map_err(|message| syntax(0, message))).collect()
}

/// The gait, if its numbers are those of one.
fn checked(gait: HarmonicGait) -> Result<HarmonicGait, String> {
    let name = &gait.name;
    let ranges = [
        ("cycle time (s)", gait.cycle_time, 0.05, 60.0),
        ("speed (m/s)", gait.speed, 0.0, 20.0),
        ("unit (m)", gait.unit, 1e-7, 1e-2),
    ];
    for (what, value, low, high) in ranges {
        if !(low..=high).contains(&value) {
            return Err(format!("gait {name:?}: {what} is {value}; it must be {low} to {high}"));
        }
    }
    if gait.rows.len().is_multiple_of(2) || gait.harmonics() > MOST_HARMONICS {
        let rows = gait.rows.len();
        let most = 2 * MOST_HARMONICS + 1;
        return Err(format!("gait {name:?}: {rows} rows; they must be 1, 3, 5, ... up to {most}"));
    }
    Ok(gait)
}

/// The binary form: numbers, names and labels, without sources, subjects and ratings. Names are cut at 255 bytes; at most
/// 65,535 gaits are taken.
pub fn to_bytes(gaits: &[HarmonicGait]) -> Vec<u8> {
    let count = u16::try_from(gaits.len()).unwrap_or(u16::MAX);
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(count.to_le_bytes());
    for gait in gaits.iter().take(usize::from(count)) {
        let mut end = gait.name.len().min(255);
        while !gait.name.is_char_boundary(end) {
            end -= 1;
        }
        let byte = |value: usize| u8::try_from(value).unwrap_or(NO_LABEL);
        bytes.push(byte(end));
        bytes.extend(&gait.name.as_bytes()[..end]);
        bytes.push(gait.label.map_or(NO_LABEL, |label| byte(label.index())));
        bytes.push(byte(gait.harmonics()));
        bytes.extend([gait.cycle_time, gait.speed, gait.unit].iter().flat_map(|value| value.to_le_bytes()));
        let rows = gait.rows.iter().take(2 * gait.harmonics() + 1);
        bytes.extend(rows.flatten().flatten().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

/// Reads the binary form; `origin` names it in errors.
///
/// # Errors
/// [`Error::Syntax`] if it is cut off or damaged.
pub fn from_bytes(bytes: &[u8], origin: &str) -> Result<Vec<HarmonicGait>, Error> {
    let syntax = |message: String| Error::Syntax { path: origin.to_owned(), line: 0, message };
    let mut reader = Reader { bytes, at: 0 };
    let magic: [u8; 4] = reader.take().map_err(syntax)?;
    let version = u16::from_le_bytes(reader.take().map_err(syntax)?);
    if magic != MAGIC || version != VERSION {
        return Err(syntax(format!("not fitted gaits of version {VERSION} (it says {version})")));
    }
    let count = u16::from_le_bytes(reader.take().map_err(syntax)?);
    let gaits =
        (0..count).map(|_| reader.gait(origin)).collect::<Result<Vec<_>, String>>().map_err(syntax)?;
    if reader.at < bytes.len() {
        return Err(syntax(format!("{} bytes follow the last gait", bytes.len() - reader.at)));
    }
    Ok(gaits)
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn slice(&mut self, count: usize) -> Result<&[u8], String> {
        let found = self.at.checked_add(count).and_then(|end| self.bytes.get(self.at..end));
        let found = found.ok_or_else(|| {
            format!(
                "byte {}: {count} bytes should follow, but the file ends at {}",
                self.at,
                self.bytes.len()
            )
        })?;
        self.at += count;
        Ok(found)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let at = self.at;
        self.slice(N)?.try_into().map_err(|_length| format!("byte {at}: {N} bytes should follow"))
    }

    fn float(&mut self) -> Result<f32, String> {
        Ok(f32::from_le_bytes(self.take()?))
    }

    fn gait(&mut self, origin: &str) -> Result<HarmonicGait, String> {
        let [length] = self.take()?;
        let at = self.at;
        let name = std::str::from_utf8(self.slice(usize::from(length))?);
        let name = name.map_err(|_invalid| format!("byte {at}: the name is not UTF-8"))?.to_owned();
        let [label, harmonics] = self.take()?;
        let [cycle_time, speed, unit] = [self.float()?, self.float()?, self.float()?];
        let count = 2 * usize::from(harmonics) + 1;
        let numbers = self.slice(count * size_of::<Row>())?;
        let mut rows = vec![[[0_i16; 3]; JOINT_COUNT]; count];
        for (value, bytes) in rows.as_flattened_mut().as_flattened_mut().iter_mut().zip(numbers.as_chunks().0)
        {
            *value = i16::from_le_bytes(*bytes);
        }
        let label = match label {
            NO_LABEL => None,
            index => Some(*Emotion::ALL.get(usize::from(index)).ok_or_else(|| {
                format!("gait {name:?}: label {index}; it must be 0 to 3, or 255 for none")
            })?),
        };
        let file = Path::new(origin)
            .file_name()
            .map_or_else(String::new, |file| file.to_string_lossy().into_owned());
        let provenance = Provenance { file, take: name.clone(), ..Provenance::default() };
        let (acted, ratings) = (None, None);
        checked(HarmonicGait { name, cycle_time, speed, provenance, acted, ratings, label, unit, rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::fit::fit;
    use crate::gait::walker::{Sex, person};

    fn gaits() -> Vec<HarmonicGait> {
        let gait = person(Emotion::Sad, Sex::Male, 1, 0).unwrap();
        let mut rated = fit(&gait, 3).unwrap();
        rated.ratings = Some([1.0, 1.25, 4.3, 2.1]);
        rated.name = "\u{e9}t\u{e9}, \"quoted\"".to_owned();
        vec![rated, HarmonicGait { label: None, ..fit(&gait, 0).unwrap() }]
    }

    #[test]
    fn both_forms_give_the_gaits_back() {
        assert_eq!(from_json(to_json(&gaits()).as_bytes(), "f.json").unwrap(), gaits());
        let bytes = to_bytes(&gaits());
        let back = from_bytes(&bytes, "f.gwh").unwrap();
        for (back, gait) in back.iter().zip(gaits()) {
            assert_eq!((&back.rows, back.unit.to_bits()), (&gait.rows, gait.unit.to_bits()));
            assert_eq!((&back.name, back.label), (&gait.name, gait.label));
        }
        let names: usize = gaits().iter().map(|gait| gait.name.len()).sum();
        let numbers: usize = gaits().iter().map(HarmonicGait::bytes).sum();
        assert_eq!(bytes.len(), 8 + numbers + names + 2 * 3, "numbers, names and three bytes each");
    }

    #[test]
    fn damaged_files_are_refused_with_the_reason() {
        let bytes = to_bytes(&gaits());
        for end in 0..bytes.len() {
            assert!(from_bytes(&bytes[..end], "f.gwh").is_err(), "{end}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(from_bytes(&longer, "f.gwh").unwrap_err().to_string().contains("1 bytes follow"));
        let mut flipped = bytes;
        for at in 0..flipped.len() {
            flipped[at] ^= 0xff;
            let _ = from_bytes(&flipped, "f.gwh");
            flipped[at] ^= 0xff;
        }
        let json = to_json(&gaits());
        for (from, to, part) in [
            ("\"version\":2", "\"version\":1", "version 1"),
            ("\"cycle_time\":", "\"cycle_time\":-", "0.05 to 60"),
            ("\"root\"", "\"toor\"", "16 of a gait"),
            ("\"rows\":[[", "\"rows\":[[7,", "48 numbers"),
            ("\"rows\":[[", "\"rows\":[[99999,", "f.json:"),
        ] {
            let message = from_json(json.replacen(from, to, 1).as_bytes(), "f.json").unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
