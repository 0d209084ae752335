//! The meaning of a text's columns: by name, by a comment, by the format, by option, or to be inferred.

use super::{Error, clip, unusable};
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Column {
    /// Nothing that is used.
    Skip,
    /// Number of the person.
    Id,
    /// Number of the frame.
    Frame,
    /// Time, s.
    Time,
    /// Place to the right, in units of the file.
    X,
    /// Place up the page, in units of the file.
    Y,
    /// Height of the person or of the place; yields the unit.
    Z,
    /// Velocity to the right, in units of the file a second; yields the frame rate.
    Vx,
    /// Velocity up the page.
    Vy,
    /// Ours: place down the page.
    Down,
    /// Ours: heading about +y, rad.
    Heading,
    /// Ours: person, robot or vehicle.
    Kind,
    /// Vadere's: time at the end of the step.
    EndTime,
    /// Vadere's: place at the end of the step.
    EndX,
    /// Vadere's: the same up the page.
    EndY,
}

/// Names of columns in options.
const NAMES: [(&str, Column); 9] = [
    ("-", Column::Skip),
    ("id", Column::Id),
    ("frame", Column::Frame),
    ("time", Column::Time),
    ("x", Column::X),
    ("y", Column::Y),
    ("z", Column::Z),
    ("vx", Column::Vx),
    ("vy", Column::Vy),
];

/// Names of columns in the files of others, in lower case and without units.
const ALIASES: [(&str, Column); 48] = [
    ("id", Column::Id),
    ("personid", Column::Id),
    ("person_id", Column::Id),
    ("person", Column::Id),
    ("agent", Column::Id),
    ("agent_id", Column::Id),
    ("agentid", Column::Id),
    ("ped_id", Column::Id),
    ("pedid", Column::Id),        // Crowd:it
    ("pedestrianid", Column::Id), // Vadere
    ("pedestrian_id", Column::Id),
    ("track_id", Column::Id),
    ("trackid", Column::Id),
    ("no", Column::Id), // Viswalk
    ("frame", Column::Frame),
    ("frame_id", Column::Frame),
    ("frameid", Column::Frame),
    ("fr", Column::Frame),
    ("time", Column::Time),
    ("t", Column::Time),       // Pathfinder
    ("simtime", Column::Time), // Vadere
    ("simsec", Column::Time),  // Viswalk
    ("x", Column::X),
    ("pos_x", Column::X),
    ("posx", Column::X),
    ("startx", Column::X),
    ("coordcentx", Column::X),
    ("y", Column::Y),
    ("pos_y", Column::Y),
    ("posy", Column::Y),
    ("starty", Column::Y),
    ("coordcenty", Column::Y),
    ("z", Column::Z),
    ("pos_z", Column::Z),
    ("v_x", Column::Vx),
    ("vx", Column::Vx),
    ("vel_x", Column::Vx),
    ("velx", Column::Vx),
    ("v_y", Column::Vy),
    ("vy", Column::Vy),
    ("vel_y", Column::Vy),
    ("vely", Column::Vy),
    ("heading_rad", Column::Heading),
    ("kind", Column::Kind),
    ("endtime", Column::EndTime),
    ("endx", Column::EndX),
    ("endy", Column::EndY),
    ("z_m", Column::Down),
];

impl Column {
    const fn name(self) -> &'static str {
        match self {
            Self::Skip => "-",
            Self::Id => "id",
            Self::Frame => "frame",
            Self::Time => "time",
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Vx => "vx",
            Self::Vy => "vy",
            Self::Down => "z (down the page)",
            Self::Heading => "heading",
            Self::Kind => "kind",
            Self::EndTime => "end time",
            Self::EndX => "end x",
            Self::EndY => "end y",
        }
    }
}

/// The columns of a text, from the left: `id,frame,x,y`, `frame,id,x,-,y`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Columns(pub(super) Vec<Column>);

impl fmt::Display for Columns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let used = self.0.iter().rposition(|column| *column != Column::Skip).map_or(0, |last| last + 1);
        let names: Vec<&str> = self.0[..used].iter().map(|column| column.name()).collect();
        f.write_str(&names.join(", "))
    }
}

impl Serialize for Columns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(|column| column.name()))
    }
}

/// Text that is no [`Columns`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnsError {
    /// A name is no column's.
    #[error("{name:?} is no column; use id, frame, time, x, y, z, vx, vy, or - to skip one")]
    Unknown {
        /// The name, clipped.
        name: String,
    },
    /// A column stands there twice.
    #[error("{name} stands twice")]
    Twice {
        /// Its name, as it stands there.
        name: String,
    },
    /// A column that is needed is missing.
    #[error("{name} is missing; such as id,frame,x,y or frame,id,x,-,y")]
    Missing {
        /// Its name.
        name: &'static str,
    },
}

impl FromStr for Columns {
    type Err = ColumnsError;

    /// `id,frame,x,y` in any order, `-` for what is skipped, `time` (s) instead of `frame`; also `z`, `vx`, `vy`.
    fn from_str(text: &str) -> Result<Self, ColumnsError> {
        let mut columns = Vec::new();
        for name in text.split(',').map(str::trim) {
            let known = NAMES.iter().find(|(known, _)| *known == name.to_ascii_lowercase());
            let Some((_, column)) = known else {
                return Err(ColumnsError::Unknown { name: clip(name) });
            };
            if *column != Column::Skip && columns.contains(column) {
                return Err(ColumnsError::Twice { name: name.to_owned() });
            }
            columns.push(*column);
        }
        match Self(columns).lacking() {
            (columns, None) => Ok(columns),
            (_, Some(name)) => Err(ColumnsError::Missing { name }),
        }
    }
}

impl Columns {
    pub(super) fn find(&self, column: Column) -> Option<usize> {
        self.0.iter().position(|one| *one == column)
    }

    /// What is needed and not there.
    fn lacking(self) -> (Self, Option<&'static str>) {
        let has = |column| self.0.contains(&column);
        let missing = if !has(Column::Id) {
            Some("id")
        } else if !has(Column::Frame) && !has(Column::Time) {
            Some("frame (or time)")
        } else if !has(Column::X) {
            Some("x")
        } else if !has(Column::Y) && !has(Column::Down) {
            Some("y")
        } else {
            None
        };
        (self, missing)
    }

    /// The columns of names, metres per unit where a name says them, and what is needed and not among them.
    pub(super) fn of_names(head: &[&str]) -> (Self, Option<f64>, Option<&'static str>) {
        let named: Vec<(String, Option<f64>)> = head.iter().map(|cell| base_name(cell)).collect();
        let is_ours = ["x_m", "z_m"].iter().all(|name| head.iter().any(|cell| plain(cell) == *name));
        let mut columns = Self::default();
        let mut metres = None;
        for (cell, (base, unit)) in head.iter().zip(&named) {
            let whole = plain(cell);
            let known =
                |name: &str| ALIASES.iter().find(|(alias, _)| *alias == name).map(|(_, column)| *column);
            let mut column = known(&whole).or_else(|| known(base)).unwrap_or(Column::Skip);
            let ours_alone = matches!(column, Column::Down | Column::Heading | Column::Kind);
            if is_ours && matches!(column, Column::Y) {
                column = Column::Skip; // the height of the floor
            } else if ours_alone && !is_ours {
                column = if column == Column::Down { Column::Z } else { Column::Skip };
            }
            if column == Column::X {
                metres = metres.or(*unit);
            }
            if columns.0.contains(&column) {
                column = Column::Skip; // the first of a name counts
            }
            columns.0.push(column);
        }
        let (columns, missing) = columns.lacking();
        (columns, metres, missing)
    }

    /// The columns of a head, and metres per unit where a name says them.
    pub(super) fn of_head(path: &Path, line: usize, head: &[&str]) -> Result<(Self, Option<f64>), Error> {
        match Self::of_names(head) {
            (columns, metres, None) => Ok((columns, metres)),
            (.., Some(missing)) => {
                let known: Vec<String> = head.iter().take(12).map(|cell| plain(cell)).collect();
                let list = clip(&known.join(", "));
                let person = if missing == "id" { "the person (id)" } else { missing };
                let message = format!("line {line}: no column for {person} among {list:?}");
                let hint = "a person's id, a frame or a time, x and y are needed; --columns says where they stand, such as \
                            --columns id,frame,x,y or frame,id,x,-,y";
                Err(unusable(path, message, hint))
            }
        }
    }

    /// The columns that a comment names: `# id frame x/m y/m z/m`.
    pub(super) fn of_comment(comment: &str) -> Option<Self> {
        let words: Vec<&str> = comment.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty()).collect();
        if !(4..=16).contains(&words.len()) {
            return None;
        }
        Self::of_head(Path::new(""), 0, &words).ok().map(|(columns, _)| columns)
    }
}

/// A name of a column in lower case, without quotes.
fn plain(cell: &str) -> String {
    cell.trim().trim_matches('"').trim().to_ascii_lowercase()
}

/// A name without its unit, Viswalk's `$PEDESTRIAN:` and Vadere's `-PID1`; and metres per that unit.
fn base_name(cell: &str) -> (String, Option<f64>) {
    let name = plain(cell);
    let name = name.strip_prefix("$pedestrian:").unwrap_or(&name);
    let name = name.rsplit_once("-pid").map_or(name, |(name, _)| name);
    let Some((base, unit)) = name.split_once(['/', '(', '[']).or_else(|| name.rsplit_once('_')) else {
        return (name.to_owned(), None);
    };
    let unit = unit.trim_end_matches([')', ']']);
    match metres_of(unit) {
        Some(metres) => (base.trim().to_owned(), Some(metres)),
        None if matches!(unit, "s" | "sec" | "m/s" | "cm/s") => (base.trim().to_owned(), None),
        None => (name.to_owned(), None),
    }
}

/// Metres of a unit's sign.
pub(super) fn metres_of(unit: &str) -> Option<f64> {
    match unit.trim() {
        "m" => Some(1.0),
        "cm" => Some(0.01),
        "mm" => Some(0.001),
        "ft" => Some(0.3048),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_asked_for_by_name_and_wrong_ones_are_refused_with_the_way_out() {
        let read = |text: &str| text.parse::<Columns>();
        use Column::{Frame, Id, Skip, Vx, X, Y};
        assert_eq!(read("frame,id,x,y").unwrap().0, [Frame, Id, X, Y]);
        assert_eq!(read("ID, frame, x, -, y, vx").unwrap().0, [Id, Frame, X, Skip, Y, Vx]);
        assert_eq!(read("frame,id,x,-,y,-").unwrap().to_string(), "frame, id, x, -, y");
        assert!(read("id,x,y").unwrap_err().to_string().contains("frame (or time) is missing"));
        assert!(read("id,frame,x,x").unwrap_err().to_string().contains("twice"));
        assert!(read("id,frame,x,zz").unwrap_err().to_string().contains("no column; use id, frame"));
        assert!(read("").is_err() && read("id,frame,x").is_err() && read("time,id,x,y").is_ok());
    }

    #[test]
    fn heads_of_other_programs_are_understood() {
        let read =
            |head: &str| Columns::of_head(Path::new("f"), 1, &head.split_whitespace().collect::<Vec<_>>());
        let (vadere, _) = read(
            "pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1 endX-PID1 endY-PID1 targetId-PID2",
        )
        .unwrap();
        assert_eq!(vadere.to_string(), "id, time, end time, x, y, end x, end y");
        assert_eq!(read("t id name x y z speed").unwrap().0.to_string(), "time, id, -, x, y, z");
        let (viswalk, _) = read("$PEDESTRIAN:NO SIMSEC COORDCENTX COORDCENTY").unwrap();
        assert_eq!(viswalk.to_string(), "id, time, x, y");
        assert_eq!(read("id frame x/cm y/cm z/cm").unwrap().1, Some(0.01));
        assert_eq!(read("frame time_s id x_m z_m heading_rad").unwrap().0.find(Column::Down), Some(4));
        assert_eq!(Columns::of_comment(" frame id x/m y/m").unwrap().to_string(), "frame, id, x, y");
        assert_eq!(
            Columns::of_comment("z: can be 3d position or height of person (alternating or not)"),
            None
        );
    }
}
