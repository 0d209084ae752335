//! Tables beside the motion files: the person, the style, and what raters saw.
//!
//! `labels`, `gaits` or `trials` with the ending `.csv`, `.tsv` or `.txt`, in the folder of a motion file or the one above,
//! in any case of letters. The header names a column `file`, `key`, `trial` or `name` (the take) and at least one of
//! `subject`, `sex`, `acted` (also `acted_emotion`, `style`) and `label` (also `emotion`, `perceived_label`,
//! `perceived_emotion`, `egait_perceived_label`). Acted is not perceived: it may be any word. A sex is female, male, f or
//! m, or empty; a label is happy, angry, sad or neutral, or empty. Case, separators and spaces are forgiven; an unknown word is an error with its line.
//!
//! A row means the take of that name, with or without the ending of its file. A name with folders (`anna/walk`) means
//! the file in these folders only. What the take carries already stays.

use super::text::{list, syntax};
use crate::emotion::Emotion;
use crate::gait::walker::Sex;
use crate::gait::{Error, LabelOrigin, Recording};
use crate::spelling::{UnknownName, nearest};
use crate::table::{Record, Records, Unclosed, is_unsaid, normalised};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Names of the tables; earlier ones come first where several name a take.
const NAMES: [&str; 3] = ["gaits", "labels", "trials"];
const ENDINGS: [&str; 3] = ["csv", "tsv", "txt"];
/// Largest table read, bytes.
const MAX_BYTES: u64 = 16 << 20;
/// Names that the columns may have.
const TAKE: &[&str] = &["key", "file", "trial", "name", "filename", "file_name", "take", "gait"];
const SUBJECT: &[&str] = &["subject", "participant", "person", "actor"];
const SEX: &[&str] = &["sex", "gender"];
const ACTED: &[&str] = &["acted", "acted_emotion", "style"];
const LABEL: &[&str] = &["label", "emotion", "perceived_label", "perceived_emotion", "egait_perceived_label"];

/// Whether a file of this name (lower case) is a table of labels and no motion.
pub(super) fn is_table(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(stem, ending)| NAMES.contains(&stem) && ENDINGS.contains(&ending))
}

/// The tables beside motion files, each read once.
#[derive(Debug, Default)]
pub struct Labels {
    tables: BTreeMap<PathBuf, Vec<Table>>,
}

#[derive(Debug)]
struct Table {
    path: PathBuf,
    /// Rows by the last part of their take's name in lower case.
    rows: HashMap<String, Vec<Row>>,
    count: usize,
    /// The first name in it, for messages.
    example: String,
    is_used: AtomicBool,
}

/// One row.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    /// The take, `/` between folders.
    name: String,
    line: usize,
    subject: Option<String>,
    sex: Option<Sex>,
    acted: Option<String>,
    label: Option<Emotion>,
}

impl Labels {
    /// Reads the tables beside these motion files: in the folder of each, and in the one above.
    ///
    /// # Errors
    /// [`Error::Read`] if a table cannot be read, [`Error::Syntax`] with its line if the header lacks a column, a label is
    /// no emotion, or two rows contradict each other.
    pub fn beside<P: AsRef<Path>>(files: &[P]) -> Result<Self, Error> {
        let named: BTreeSet<&Path> = files.iter().map(AsRef::as_ref).collect();
        let folders: BTreeSet<PathBuf> = named.iter().flat_map(|path| folders(path)).collect();
        let mut tables = BTreeMap::new();
        for folder in folders {
            let found: Result<Vec<Table>, Error> =
                table_files(&folder).into_iter().filter(|p| !named.contains(p.as_path())).map(read).collect();
            tables.insert(folder, found?);
        }
        Ok(Self { tables })
    }

    /// Fills subject, acted style and label of the takes of the motion file `path`.
    pub(super) fn apply(&self, path: &Path, takes: &mut [Recording]) {
        for table in folders(path).iter().filter_map(|folder| self.tables.get(folder)).flatten() {
            for take in takes.iter_mut() {
                let Some(row) = table.row(path, &take.name) else { continue };
                table.is_used.store(true, Ordering::Relaxed);
                let of = &mut take.provenance;
                of.subject = of.subject.take().or_else(|| row.subject.clone());
                of.sex = of.sex.or(row.sex);
                take.acted = take.acted.take().or_else(|| row.acted.clone());
                if let (None, Some(label)) = (take.label, row.label) {
                    (take.label, of.label_origin) = (Some(label), Some(LabelOrigin::Rated));
                }
                let name = table.path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
                take.report.push(format!("subject, style and label: {name}:{}", row.line));
            }
        }
    }

    /// A line for each table that named none of the takes that were read.
    pub fn unused(&self) -> Vec<String> {
        let tables = self.tables.values().flatten().filter(|table| !table.is_used.load(Ordering::Relaxed));
        tables
            .map(|table| {
                format!(
                    "{}: none of its {} rows names a take that was read (the first is for {:?}); a row names the file of a \
                     take, or the key that the take has in its file",
                    table.path.display(),
                    table.count,
                    table.example
                )
            })
            .collect()
    }
}

/// Where the tables of a motion file lie: beside it, and in the folder above.
fn folders(path: &Path) -> Vec<PathBuf> {
    let beside =
        path.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let above = path.parent().and_then(Path::parent);
    let above = above.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    beside.into_iter().chain(above.filter(|above| Some(*above) != beside)).map(Path::to_owned).collect()
}

/// The tables in a folder, in the order of [`NAMES`]; a folder that cannot be listed has none.
fn table_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut found: Vec<(String, PathBuf)> = entries
        .filter_map(Result::ok)
        .map(|entry| (entry.file_name().to_string_lossy().to_ascii_lowercase(), entry.path()))
        .filter(|(name, path)| is_table(name) && path.is_file())
        .collect();
    found.sort();
    found.into_iter().map(|(_, path)| path).collect()
}

fn read(path: PathBuf) -> Result<Table, Error> {
    let bytes = std::fs::metadata(&path).map_err(|source| Error::Read { path: path.clone(), source })?.len();
    let shown = path.display().to_string();
    if bytes > MAX_BYTES {
        let message = format!(
            "{bytes} bytes; a table of labels has up to {MAX_BYTES}. Call the file otherwise if it is something else"
        );
        return Err(syntax(&shown, 0, message));
    }
    parse(&super::read(&path)?, path)
}

/// Which cell is what.
struct Columns {
    take: usize,
    subject: Option<usize>,
    sex: Option<usize>,
    acted: Option<usize>,
    label: Option<usize>,
}

impl Columns {
    fn of(header: &[Cow<'_, str>]) -> Result<Self, String> {
        let plain: Vec<String> = header.iter().map(|cell| normalised(cell)).collect();
        let column =
            |names: &[&str]| names.iter().find_map(|name| plain.iter().position(|cell| cell == name));
        let found = list(header);
        let way_out = format!("(found: {found}). Call the file otherwise if it is no table of labels");
        let Some(take) = column(TAKE) else {
            return Err(format!("no column names the takes; call it one of {} {way_out}", TAKE.join(", ")));
        };
        let [subject, sex, acted, label] = [SUBJECT, SEX, ACTED, LABEL].map(column);
        if subject.or(sex).or(acted).or(label).is_none() {
            return Err(format!("none of the columns label, subject, sex and acted {way_out}"));
        }
        Ok(Self { take, subject, sex, acted, label })
    }
}

fn parse(text: &str, path: PathBuf) -> Result<Table, Error> {
    let shown = path.display().to_string();
    let mut records = Records::with_header(text);
    let failed = |unclosed: Unclosed| syntax(&shown, unclosed.line, unclosed.to_string());
    let Some(header) = records.next() else {
        return Err(syntax(
            &shown,
            0,
            "the table is empty; its first line names the columns, such as file,label",
        ));
    };
    let header = header.map_err(failed)?;
    let columns = Columns::of(&header.cells).map_err(|message| syntax(&shown, header.line, message))?;
    let (mut rows, mut count, mut example): (HashMap<String, Vec<Row>>, _, _) = (HashMap::new(), 0, None);
    for record in records {
        let record = record.map_err(failed)?;
        let line = record.line;
        let row = row(&record, &columns).map_err(|message| syntax(&shown, line, message))?;
        count += 1;
        example.get_or_insert_with(|| row.name.clone());
        let same = rows.entry(key(&row.name)).or_default();
        let before = same.iter().find(|other| other.name == row.name);
        if let Some(before) = before {
            if (Row { line, ..before.clone() }) != row {
                let message = format!("{:?} stands in line {} with something else", row.name, before.line);
                return Err(syntax(&shown, line, message));
            }
        } else {
            same.push(row);
        }
    }
    Ok(Table { path, rows, count, example: example.unwrap_or_default(), is_used: AtomicBool::new(false) })
}

fn row(record: &Record<'_>, columns: &Columns) -> Result<Row, String> {
    let cell = |column: Option<usize>| record.get(column?).filter(|cell| !is_unsaid(cell));
    let name = record.get(columns.take).unwrap_or_default();
    if name.is_empty() {
        return Err("the row names no take".to_owned());
    }
    Ok(Row {
        name: name.replace('\\', "/"),
        line: record.line,
        subject: cell(columns.subject).map(str::to_owned),
        sex: cell(columns.sex).map(sex).transpose()?,
        acted: cell(columns.acted).map(str::to_owned),
        label: cell(columns.label).map(label).transpose()?,
    })
}

/// The sex that a word or its first letter names.
fn sex(word: &str) -> Result<Sex, String> {
    let named = |sex: &Sex| {
        let name = sex.name();
        word.eq_ignore_ascii_case(name) || word.eq_ignore_ascii_case(&name[..1])
    };
    Sex::ALL
        .into_iter()
        .find(named)
        .ok_or_else(|| format!("the sex is {word:?}; it must be female, male, f, m, or empty"))
}

/// The emotion of a label.
fn label(word: &str) -> Result<Emotion, String> {
    word.parse().map_err(|_unknown: UnknownName| {
        let names = Emotion::ALL.map(Emotion::name);
        let meant = nearest(word, &names).map_or(String::new(), |near| format!("; did you mean {near:?}?"));
        format!("the label is {word:?}; it must be {}, or empty{meant}", names.join(", "))
    })
}

/// The part of a name behind its folders.
fn last(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// What a take's name and the name of its file have in common: no folders, no ending of motion files, lower case.
fn key(name: &str) -> String {
    let name = last(name).to_lowercase();
    match name.rsplit_once('.') {
        Some((stem, ending)) if super::EXTENSIONS.contains(&ending) => stem.to_owned(),
        _ => name,
    }
}

impl Table {
    /// The row for a take of a motion file. Of several, the one with most folders that lead to the file, then the one that
    /// is written as the file or the take is.
    fn row(&self, path: &Path, take: &str) -> Option<&Row> {
        let file = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let folder =
            path.parent().map(|folder| folder.to_string_lossy().replace('\\', "/")).unwrap_or_default();
        let leads = |row: &&Row| match row.name.rsplit_once('/') {
            Some((folders, _)) => {
                row.name == take || folder == folders || folder.ends_with(&format!("/{folders}"))
            }
            None => true,
        };
        self.rows.get(&key(take))?.iter().filter(leads).max_by_key(|row| {
            let name = last(&row.name);
            (row.name.matches('/').count(), name == file, name == take, std::cmp::Reverse(row.line))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn takes(names: &[&str]) -> Vec<Recording> {
        names.iter().map(|name| Recording::new(*name, 30.0, vec![])).collect()
    }

    fn bad(text: &str) -> String {
        parse(text, "labels.csv".into()).unwrap_err().to_string()
    }

    fn labels(folder: &str, text: &str) -> Labels {
        let table = parse(text, Path::new(folder).join("labels.csv")).unwrap();
        Labels { tables: [(folder.into(), vec![table])].into() }
    }

    #[test]
    fn a_table_names_subject_style_and_label() {
        let all =
            labels("a", "file,subject,style,perceived_label\na_01.bvh,7,proud,happy\nc.bvh,8,sad,sad\n");
        let mut takes = takes(&["a_01", "b"]);
        all.apply(Path::new("a/a_01.bvh"), &mut takes);
        assert_eq!(takes[0].provenance.subject.as_deref(), Some("7"));
        assert_eq!(takes[0].acted.as_deref(), Some("proud"));
        assert_eq!(takes[0].label, Some(Emotion::Happy));
        assert_eq!((takes[1].label, takes[1].provenance.subject.as_deref()), (None, None));
    }

    #[test]
    fn a_sex_is_a_word_or_its_first_letter() {
        let all = labels("a", "file,Gender\nb,F\nc,male\n");
        let mut takes = takes(&["b", "c"]);
        all.apply(Path::new("a/b.bvh"), &mut takes);
        assert_eq!([takes[0].provenance.sex, takes[1].provenance.sex], [Some(Sex::Female), Some(Sex::Male)]);
        assert!(bad("file,sex\na,x\n").contains("the sex is \"x\"; it must be female, male, f, m, or empty"));
    }

    #[test]
    fn case_separators_marks_and_spaces_are_forgiven() {
        for text in [
            "File,Label\nWalk1.BVH,Happy\n",
            "\u{feff}FILE;LABEL\r\nwalk1.bvh;HAPPY\r\n",
            " file \t Label \n walk1 \t happy \n",
            "\"file\", \"Perceived Label\"\n\"takes\\walk1.bvh\", \"happy\"\n",
            "name;subject;Emotion\n\nwalk1;anna;happy;\n",
        ] {
            let mut takes = takes(&["walk1"]);
            let all = labels("x/takes", text);
            all.apply(Path::new("x/takes/walk1.bvh"), &mut takes);
            assert_eq!(takes[0].label, Some(Emotion::Happy), "{text:?}");
            assert!(all.unused().is_empty());
        }
    }

    #[test]
    fn what_cannot_be_meant_is_an_error_with_its_line_and_the_way_out() {
        let hapy = bad("file,label\nx,sad\nwalk1.bvh,hapy\n");
        assert_eq!(
            hapy,
            "labels.csv:3: the label is \"hapy\"; it must be happy, angry, sad, neutral, or empty; did you mean \"happy\"?"
        );
        for (text, parts) in [
            ("Datei;Gefühl\na;happy\n", &["labels.csv:1:", "no column names the takes", "Datei, Gefühl"][..]),
            ("file,feeling\na,happy\n", &["labels.csv:1:", "columns label", "file, feeling"]),
            ("file,label\na,happy\na,sad\n", &["labels.csv:3:", "\"a\"", "line 2"]),
            ("file,label\n,happy\n", &["labels.csv:2:", "names no take"]),
            ("file,label\n\"a,happy\n", &["labels.csv:2:", "never closed"]),
            ("", &["labels.csv:0:", "empty"]),
        ] {
            let found = bad(text);
            assert!(parts.iter().all(|part| found.contains(part)), "{text:?}: {found}");
        }
        // nothing known is no unknown word
        assert!(parse("file,label\na,\nb,n/a\nc,-\n", "labels.csv".into()).is_ok());
    }

    #[test]
    fn names_with_folders_mean_the_file_in_these_folders() {
        let all =
            labels("x", "file,label\nwalk,sad\nanna/walk.bvh,happy\nben\\walk.bvh,angry\nwalk.c3d,neutral\n");
        for (path, label) in [
            ("x/anna/walk.bvh", Emotion::Happy),
            ("x/ben/walk.bvh", Emotion::Angry),
            ("x/joanna/walk.bvh", Emotion::Sad),
            ("x/joanna/walk.c3d", Emotion::Neutral),
        ] {
            let mut takes = takes(&["walk"]);
            all.apply(Path::new(path), &mut takes);
            assert_eq!(takes[0].label, Some(label), "{path}");
        }
    }

    #[test]
    fn a_table_that_names_no_take_says_so() {
        let all = labels("x", "file,label\nw1.bvh,sad\nw2.bvh,sad\n");
        all.apply(Path::new("x/other.bvh"), &mut takes(&["other"]));
        let told = all.unused();
        assert_eq!(told.len(), 1);
        assert!(told[0].contains("x/labels.csv") && told[0].contains("2 rows") && told[0].contains("w1.bvh"));
    }
}
