//! The sheet of raw responses: CSV with a header, one row per participant and video.
//!
//! Columns by name, in any order: participant, video, happy, angry, sad, neutral, and optionally gender and age; common
//! other names are known ([`PARTICIPANT`], [`VIDEO`], ...), further columns do not matter. Separated by commas,
//! semicolons or tabs; cells may be quoted (RFC 4180) and then hold separators and line ends.

use super::Response;
use crate::emotion::Emotion;
use crate::file;
use crate::perception::Error;
use crate::spelling::nearest;
use crate::table::{Record, Records, Unclosed, is_unsaid, normalised};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Largest sheet that is read, bytes.
#[doc(hidden)]
pub const MOST_BYTES: u64 = 256 << 20;

/// Names of the column of participants.
const PARTICIPANT: &[&str] = &[
    "participant",
    "participant_id",
    "participantid",
    "pid",
    "rater",
    "rater_id",
    "worker",
    "worker_id",
    "workerid",
    "subject",
    "subject_id",
    "respondent",
    "respondent_id",
    "user",
    "user_id",
    "annotator",
];
/// Names of the column of videos.
const VIDEO: &[&str] = &[
    "video",
    "video_id",
    "videoid",
    "video_name",
    "gait",
    "gait_id",
    "gait_name",
    "clip",
    "clip_id",
    "stimulus",
    "stimulus_id",
    "item",
    "file",
    "filename",
];
/// Words that make a column that of an emotion, so that "This person looks happy." is one too.
const QUESTIONS: [&[&str]; 4] = [
    &["happy", "happiness", "joy", "joyful"],
    &["angry", "anger"],
    &["sad", "sadness"],
    &["neutral", "neutrality"],
];
const GENDER: &[&str] = &["gender", "sex", "participant_gender", "rater_gender"];
const AGE: &[&str] = &["age", "participant_age", "rater_age", "age_years"];
/// The five answers in words, from 1.
const ANSWERS: [&[&str]; 5] = [
    &["strongly disagree"],
    &["disagree", "somewhat disagree"],
    &["neither agree nor disagree", "neither", "neutral", "undecided"],
    &["agree", "somewhat agree"],
    &["strongly agree"],
];
/// Endings of videos and pictures, which the names of gaits do not have.
const ENDINGS: [&str; 9] = [".mp4", ".avi", ".webm", ".mov", ".mkv", ".y4m", ".ogv", ".gif", ".png"];
/// What the reader knows besides the sheet.
#[derive(Debug, Clone, Default)]
pub struct Options<'a> {
    /// Names of the gaits there are; any other video is a fault. None: every name is taken.
    pub videos: Option<&'a HashSet<String>>,
    /// Leave rows with faults out and list them, instead of refusing the sheet.
    pub skip_bad: bool,
}

/// A row that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Fault {
    /// Line of the sheet, from 1.
    pub line: usize,
    /// What is wrong, with the value found and what is allowed.
    pub message: String,
}

/// A sheet, read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Rows that can be used, in their order.
    pub responses: Vec<Response>,
    /// Rows that were left out, in their order; empty unless [`Options::skip_bad`].
    pub left_out: Vec<Fault>,
}

/// Reads the sheet at `path`.
///
/// # Errors
/// [`Error::Syntax`] with file and line if the file cannot be read, lacks a column, has a quote that is never closed or rows
/// that cannot be used (the first of them, and how many more there are); with [`Options::skip_bad`] rows count only if none
/// can be used.
pub fn read(path: &Path, options: &Options<'_>) -> Result<Sheet, Error> {
    let origin = path.display().to_string();
    let failed = |message: String| Error::Syntax { path: origin.clone(), line: 0, message };
    let bytes = file::read(path, MOST_BYTES).map_err(|error| failed(format!("cannot be read: {error}")))?;
    parse(&String::from_utf8_lossy(&bytes), &origin, options)
}

/// Reads a sheet from text; `origin` names it in errors.
///
/// # Errors
/// As [`read()`].
#[doc(hidden)]
pub fn parse(text: &str, origin: &str, options: &Options<'_>) -> Result<Sheet, Error> {
    let syntax = |line, message| Error::Syntax { path: origin.to_owned(), line, message };
    let unclosed = |quote: Unclosed| syntax(quote.line, quote.to_string());
    let mut records = Records::with_header(text);
    let Some(header) = records.next() else {
        return Err(syntax(
            0,
            "empty; the first line names the columns: participant,video,happy,angry,sad,neutral".into(),
        ));
    };
    let header = header.map_err(unclosed)?;
    let columns = Columns::of(&header.cells).map_err(|message| syntax(header.line, message))?;
    let mut reader = Reader { columns, width: header.cells.len(), options, seen: HashMap::new() };
    let mut sheet = Sheet::default();
    for record in records {
        match reader.response(&record.map_err(unclosed)?) {
            Ok(response) => sheet.responses.push(response),
            Err(fault) => sheet.left_out.push(fault),
        }
    }
    if let Some(first) = sheet.left_out.first().filter(|_| !options.skip_bad) {
        let more = match sheet.left_out.len() - 1 {
            0 => String::new(),
            more => format!(" ({more} more such rows)"),
        };
        let message = format!("{}; correct it, or leave bad rows out (--skip-bad){more}", first.message);
        return Err(syntax(first.line, message));
    }
    if sheet.responses.is_empty() {
        let why = sheet.left_out.first().map_or("there are no rows".into(), |fault| {
            format!("all {} rows are bad; line {}: {}", sheet.left_out.len(), fault.line, fault.message)
        });
        return Err(syntax(header.line, format!("no responses: {why}")));
    }
    Ok(sheet)
}

/// Turns rows into responses.
struct Reader<'a> {
    columns: Columns,
    width: usize,
    options: &'a Options<'a>,
    /// Line of each participant's answer to each video.
    seen: HashMap<(String, String), usize>,
}

impl Reader<'_> {
    fn response(&mut self, record: &Record<'_>) -> Result<Response, Fault> {
        let line = record.line;
        let fault = |message: String| Fault { line, message };
        let spare = record.cells.iter().skip(self.width).find(|cell| !cell.is_empty());
        if let Some(spare) = spare {
            let (found, width) = (record.cells.len(), self.width);
            return Err(fault(format!(
                "{found} cells, but the header names {width} columns ({spare:?} is spare)"
            )));
        }
        let cell = |column: usize, what: &str| match record.get(column) {
            None | Some("") => Err(fault(format!("the {what} is missing"))),
            Some(text) => Ok(text),
        };
        let participant = cell(self.columns.participant, "participant")?.to_owned();
        let video = self.video(cell(self.columns.video, "video")?).map_err(fault)?;
        let mut scores = [0; 4];
        for emotion in Emotion::ALL {
            let text = cell(self.columns.questions[emotion.index()], &format!("answer for {emotion}"))?;
            scores[emotion.index()] = score(text).ok_or_else(|| {
                fault(format!(
                    "the answer for {emotion} is {text:?}; it must be 1 (strongly disagree) to 5 (strongly agree)"
                ))
            })?;
        }
        let said = |column: Option<usize>| {
            let text = record.get(column?)?;
            (!is_unsaid(text)).then(|| text.to_owned())
        };
        let gender = said(self.columns.gender);
        let age = match said(self.columns.age) {
            None => None,
            Some(text) => match text.parse::<f64>() {
                Ok(age) if (1.0..=120.0).contains(&age) => Some(age),
                _ => return Err(fault(format!("the age is {text:?}; it must be 1 to 120 years, or empty"))),
            },
        };
        // Last, so that a row which is left out for another reason does not stand in the way of a good one.
        if let Some(first) = self.seen.insert((participant.clone(), video.clone()), line) {
            self.seen.insert((participant.clone(), video.clone()), first);
            return Err(fault(format!(
                "participant {participant:?} answered video {video:?} before, in line {first}; one answer each counts"
            )));
        }
        Ok(Response { participant, video, scores, gender, age, line })
    }

    /// The gait a video shows: its name without folder and the ending of a video.
    fn video(&self, text: &str) -> Result<String, String> {
        let Some(known) = self.options.videos else { return Ok(stem(text).to_owned()) };
        if let Some(name) = known.get(text).or_else(|| known.get(stem(text))) {
            return Ok(name.clone());
        }
        let mut names: Vec<&str> = known.iter().map(String::as_str).collect();
        names.sort_unstable();
        let example = match (nearest(stem(text), &names), names.first()) {
            (Some(near), _) => format!("; did you mean {near:?}?"),
            (None, Some(first)) => format!(", such as {first:?}"),
            (None, None) => String::new(),
        };
        Err(format!("unknown video {text:?}; the library has {} gaits{example}", known.len()))
    }
}

/// A name without folders and the ending of a video.
fn stem(text: &str) -> &str {
    let name = text.rsplit(['/', '\\']).next().unwrap_or(text);
    let cut = |ending: &&str| {
        let at = name.len().checked_sub(ending.len()).filter(|&at| at > 0 && name.is_char_boundary(at))?;
        name[at..].eq_ignore_ascii_case(ending).then(|| &name[..at])
    };
    ENDINGS.iter().find_map(cut).unwrap_or(name)
}

/// An answer: 1 to 5, or in words.
fn score(text: &str) -> Option<u8> {
    let words = text.to_lowercase();
    let words = words.trim_end_matches('.');
    if let Some(index) = ANSWERS.iter().position(|names| names.contains(&words)) {
        return u8::try_from(index + 1).ok();
    }
    let value: f64 = text.parse().ok()?;
    (1..=5).find(|&score| (value - f64::from(score)).abs() < 1e-9)
}

/// Which cell is what.
#[derive(Debug)]
struct Columns {
    participant: usize,
    video: usize,
    questions: [usize; 4],
    gender: Option<usize>,
    age: Option<usize>,
}

impl Columns {
    fn of(header: &[Cow<'_, str>]) -> Result<Self, String> {
        let plain: Vec<String> = header.iter().map(|cell| normalised(cell)).collect();
        let named = |names: &[&str]| plain.iter().position(|cell| names.contains(&cell.as_str()));
        let missing = |what: &str, names: &[&str]| {
            let found = header.join(", ");
            format!("no column for the {what}; call it one of {} (found: {found})", names.join(", "))
        };
        let mut questions = [0; 4];
        for emotion in Emotion::ALL {
            questions[emotion.index()] = question(header, &plain, QUESTIONS[emotion.index()])?
                .ok_or_else(|| missing(&format!("answers for {emotion}"), QUESTIONS[emotion.index()]))?;
        }
        Ok(Self {
            participant: named(PARTICIPANT).ok_or_else(|| missing("participant", PARTICIPANT))?,
            video: named(VIDEO).ok_or_else(|| missing("video", VIDEO))?,
            questions,
            gender: named(GENDER),
            age: named(AGE),
        })
    }
}

/// The column that is called one of `words`, or else the only one whose name has one of them.
fn question(header: &[Cow<'_, str>], plain: &[String], words: &[&str]) -> Result<Option<usize>, String> {
    if let Some(exact) = plain.iter().position(|cell| words.contains(&cell.as_str())) {
        return Ok(Some(exact));
    }
    let has = |cell: &String| cell.split('_').any(|word| words.contains(&word));
    let found: Vec<usize> = plain.iter().enumerate().filter(|(_, cell)| has(cell)).map(|(i, _)| i).collect();
    match found[..] {
        [] => Ok(None),
        [one] => Ok(Some(one)),
        [a, b, ..] => Err(format!(
            "columns {:?} and {:?} could both hold the answers for {}; call one of them {:?}",
            header[a], header[b], words[0], words[0]
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good(text: &str) -> Vec<Response> {
        parse(text, "study.csv", &Options::default()).unwrap().responses
    }

    fn bad(text: &str) -> String {
        parse(text, "study.csv", &Options::default()).unwrap_err().to_string()
    }

    #[test]
    fn headers_cells_and_answers_come_in_many_forms() {
        let text = "\u{feff}Worker ID;Looks happy?;Anger;Sadness;Neutral;Video;Sex;Age;comment\r\n\
                    w1;5;Strongly Disagree;2.0;\"neither agree nor disagree\";gaits/a.1.mp4;Female;34;\"says \"\"so\"\";\n\
                    twice\"\r\n\r\nw2;1;2;3;4;a.1;;n/a;\n";
        let found = good(text);
        assert_eq!((found[0].participant.as_str(), found[0].video.as_str()), ("w1", "a.1"));
        assert_eq!(found[0].scores, [5, 1, 2, 3]);
        assert_eq!((found[0].gender.as_deref(), found[0].age), (Some("Female"), Some(34.0)));
        assert_eq!((found[1].scores, found[1].line), ([1, 2, 3, 4], 5));
        assert_eq!((found[1].gender.as_deref(), found[1].age), (None, None));
    }

    #[test]
    fn wrong_rows_are_errors_with_file_line_value_and_range() {
        let head = "participant,video,happy,angry,sad,neutral\n";
        for (row, line, parts) in [
            ("p,v,1,2,6,1", 2, &["sad", "\"6\"", "1 (strongly disagree) to 5"][..]),
            ("p,v,1,2,2.5,1", 2, &["2.5"]),
            ("p,v,1,2,NaN,1", 2, &["NaN"]),
            ("p,v,1,2,,1", 2, &["sad", "missing"]),
            ("p,v,1,2,3", 2, &["neutral", "missing"]),
            (",v,1,2,3,4", 2, &["participant is missing"]),
            ("p,v,1,2,3,4,9", 2, &["7 cells", "6 columns"]),
            ("p,v,1,2,3,4\nq,v,1,1,1,1\np,v.mp4,1,1,1,1", 4, &["\"p\"", "\"v\"", "line 2"]),
        ] {
            let message = bad(&format!("{head}{row}\n"));
            assert!(message.starts_with(&format!("study.csv:{line}: ")), "{row}: {message}");
            assert!(parts.iter().all(|part| message.contains(part)), "{row}: {message}");
            assert!(message.contains("--skip-bad"), "{message}");
        }
        let skip = Options { skip_bad: true, ..Options::default() };
        let open = format!("{head}p,\"v\n1\",1,2,3,4\nq,\"v,1,2,3,4\nr,v,1,1,1,1\n");
        let message = parse(&open, "study.csv", &skip).unwrap_err().to_string();
        assert!(message.starts_with("study.csv:4: a quote is opened and never closed"), "{message}");
        assert!(bad("participant,happy,angry,sad,neutral\n").contains("no column for the video"));
        assert!(bad("").contains("participant,video"));
        assert!(bad("pid,gait,happy_a,happy_b,angry,sad,neutral\n").contains("happy_b"));
        assert!(bad("pid,gait,happy,angry,sad,neutral\n").contains("no rows"));
    }

    #[test]
    fn bad_rows_can_be_left_out_and_are_listed() {
        let known = HashSet::from(["v".to_owned()]);
        let options = Options { videos: Some(&known), skip_bad: true };
        let text = "participant,video,happy,angry,sad,neutral\np,v,1,9,1,1\np,v,1,2,3,4\nq,w,1,2,3,4\n";
        let sheet = parse(text, "s.csv", &options).unwrap();
        assert_eq!(
            sheet.responses.len(),
            1,
            "a bad row is no answer, so the good one after it is not the second"
        );
        assert_eq!(sheet.left_out.iter().map(|fault| fault.line).collect::<Vec<_>>(), [2, 4]);
        assert!(sheet.left_out[1].message.contains("unknown video \"w\""));
        assert!(parse("pid,gait,happy,angry,sad,neutral\np,v,0,1,1,1\n", "s.csv", &options).is_err());
    }

    #[test]
    fn any_text_is_read_or_refused() {
        let pieces = [
            "\"",
            ",",
            "\n",
            "\r\n",
            "participant",
            "video",
            "happy,angry,sad,neutral",
            "1",
            "é",
            "\t;",
            " ",
        ];
        let mut state = 12345_u32;
        for _ in 0..20_000 {
            let mut text = String::new();
            for _ in 0..12 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                text += pieces[(state >> 16) as usize % pieces.len()];
            }
            let _ = parse(&text, "s.csv", &Options { skip_bad: state.is_multiple_of(2), videos: None });
        }
    }
}
