//! Readers and writers of studies: the study file, and the tables of what people answered.

use crate::mutate::Form;
use crate::targets::{Target, text};
use gaitway::study::export::{Options, export};
use gaitway::study::file::Front;
use gaitway::study::plan::{Ending, Plan};
use gaitway::study::protocol::State;
use gaitway::study::simulate::{Habits, Minds, Setup, run};
use gaitway::study::tables::{Answer, Participant, Shown, Tables, Value, read, write};
use gaitway::study::{Materials, Study, check};
use std::collections::BTreeMap;
use std::sync::LazyLock;

pub(crate) static TARGETS: [Target; 4] = [
    Target { name: "study", form: Form::Text, seeds: study_seeds, read: |bytes| study(&text(bytes)) },
    Target { name: "tables", form: Form::Text, seeds: table_seeds, read: |bytes| tables(&text(bytes)) },
    Target { name: "answers-out", form: Form::Text, seeds: text_seeds, read: |bytes| written(&text(bytes)) },
    Target { name: "dataset", form: Form::Text, seeds: text_seeds, read: |bytes| dataset(&text(bytes)) },
];

/// Parts two tables, or two texts, in an input.
const BETWEEN: &str = "\n====\n";
/// What stands in seeds where a page has to escape it.
const MARKUP: &str = "<zyx>";
/// Letters with which a cell begins that a spreadsheet computes.
const FORMULA: [char; 4] = ['=', '+', '-', '@'];

/// A study of every kind of part and question.
const STUDY: &str = r#"
[study]
id = "all"
version = 1
title = { en = "All", de = "Alles" }
seed = 7
languages = ["en", "de"]
minutes = 6
contact = "Lab"
flow = ["consent", "you", "rules", "check", "walks", "scenes", "agents", "last"]
[consent]
text = "consent.md"
minimum_age = 18
on_withdrawal = "keep-anonymous"
[recruit]
platform = "prolific"
codes = { complete = "C1", screened-out = "C2", withdrawn = "C3" }
most_participants = 5
lease_minutes = 30
[crowd]
library = "library.glb"
avatars = ["female"]
[part.you]
kind = "form"
ask = ["gender", "age", "fms"]
[part.rules]
kind = "text"
text = "Look."
[part.check]
kind = "comprehension"
attempts = 2
questions = [{ text = "What?", options = ["a", "b"], right = 0 }]
[part.walks]
kind = "trials"
show = { gaits = "library.glb", view = "front", seconds = 0.5, plays = 1, replay = true }
design = { kind = "fill", each = 2, at_least = 2 }
repeat = 1
catch = 1
ask = "emotions"
[part.scenes]
kind = "trials"
show = { scenes = ["crossing", "garden"], conditions = ["baseline", "eva-g"], seconds = 2 }
design = { kind = "blocks", blocks = "scenes", within = "conditions" }
seeds = "per-block"
ask = "health"
after_block = ["fms"]
rest_after_blocks = 1
[part.agents]
kind = "trials"
show = { agents = { each_of = ["happy", "sad"], bodies = ["female"] }, condition = "eva-g", seconds = 8 }
design = { kind = "square" }
ask = "which"
[part.last]
kind = "form"
ask = "words"
[questions.health]
kind = "likert"
order = "per-trial"
points = { 1 = "no", 7 = "yes" }
items = [{ id = "well", text = { en = "well", de = "gut" } }]
[questions.emotions]
kind = "likert"
points = ["1", "2", "3", "4", "5"]
items = [{ id = "happy", text = "1" }, { id = "angry", text = "2" }, { id = "sad", text = "3" }, { id = "neutral", text = "4" }]
[questions.which]
kind = "choice"
text = "Which?"
options = ["happy", "sad"]
[questions.words]
kind = "text"
text = "Else?"
most = 400
[wording.fms]
sickness = "How sick?"
[exclude]
failed_catch = 1
median_ms_below = 1200
same_answer_share = 0.95
late_frames_share = 0.2
[data]
keep_links_days = 30
[analysis]
ratings = { part = "walks", theta = 3.5 }
[[analysis.test]]
kind = "friedman"
of = "scenes.health.*"
by = "condition"
within = "scene"
then = { kind = "wilcoxon", adjust = "holm", zeros = "pratt" }
"#;

static MATERIALS: LazyLock<Materials> = LazyLock::new(|| {
    let names = (1..=5).map(|number| format!("walk {number}")).collect();
    Materials::default().with_gaits("library.glb", names).with_text("consent.md", "# Consent")
});

fn study_seeds() -> Vec<Vec<u8>> {
    // the parts that stand alone, so that most faults leave a file that can be read
    let cut = |from: &str, to: &str| {
        let (head, rest) = STUDY.split_once(from).unwrap();
        format!("{head}{to}{}", rest.split_once(to).unwrap().1)
    };
    let walks = cut("[part.scenes]", "[part.last]");
    let end = walks.find("[[analysis.test]]").unwrap();
    let walks = walks[..end].replace(", \"scenes\", \"agents\"", "");
    vec![walks.into_bytes(), STUDY.into()]
}

/// Reads, checks and plans a study; two simulated participants go through it.
fn study(text: &str) -> Result<String, String> {
    let study = Study::parse(text, "x").map_err(|error| error.to_string())?;
    let report = check(&study, &MATERIALS);
    let said = report.to_string();
    if !report.is_valid() {
        return Err(said.lines().next().unwrap_or_default().to_owned());
    }
    let plan = Plan::of(&study.file, &MATERIALS).unwrap();
    let setup = Setup { participants: 2, at_once: 2, habits: Habits::default(), seed: 1 };
    let (_, run) = run(&plan, &Minds::default(), setup).unwrap();
    let counted: Vec<String> = report.notes.iter().map(|note| note.key.clone()).collect();
    Ok(format!("{} {} {}", counted.join(" "), run.answers.len().min(40), report.is_ready()))
}

fn table_seeds() -> Vec<Vec<u8>> {
    let people = "participant,front,state,placed,frames,late_frames\nk7,headset,finished,true,300,2\nk8,web,full,false,,\n";
    let answers = "participant,front,part,page,position,role,wanted,gait,scene,condition,emotion,body,question,value,ms\n\
                   k7,headset,scenes,scenes/1,1,ordinary,,,garden,eva-g,,,presence.q1,6,2100\n\
                   k7,headset,scenes,scenes/2,2,catch,3,,,,,,presence.q1,3,\n\
                   k8,web,last,last,,,,,,,,,words,\"'=a, \"\"b\"\"\nc\",\n";
    vec![format!("{people}{BETWEEN}{answers}").into_bytes()]
}

/// Reads two tables; what was read is written, and is the same when it is read again.
fn tables(text: &str) -> Result<String, String> {
    let (people, answers) = text.split_once(BETWEEN).ok_or("one table")?;
    let found = read(answers, people, "x").map_err(|error| error.to_string())?;
    let (answers, people) = write(&found);
    let again = read(&answers, &people, "x").unwrap_or_else(|error| panic!("{error}: {people}{answers}"));
    assert_eq!(again, found, "{people}{answers}");
    Ok(format!("{} {}", found.participants.len().min(5), found.answers.len().min(5)))
}

fn text_seeds() -> Vec<Vec<u8>> {
    let texts = [
        "=HYPERLINK(\"http://x\";\"a\")",
        "a, \"b\" and\r\n'c'",
        " +1 \t",
        "'-1",
        "@a\u{feff}",
        "-5",
        "12",
        "<zyx a=\"b\">&lt;",
        "\t=1+1",
        "naïve \u{1F600}; \u{2028}x",
        "1e5",
    ];
    [texts.join(BETWEEN), "=1".to_owned(), "one\rtwo".to_owned()].map(String::into_bytes).to_vec()
}

/// A participant for each text, who has written it.
fn answered(text: &str) -> Tables {
    let mut tables = Tables::default();
    for (index, text) in text.split(BETWEEN).enumerate() {
        let participant = format!("k{index}");
        tables.participants.push(Participant {
            participant: participant.clone(),
            front: Front::Web,
            state: State::Ended(Ending::Finished),
            placed: true,
            frames: None,
        });
        tables.answers.push(Answer {
            participant,
            front: Front::Web,
            part: "last".to_owned(),
            page: "last".to_owned(),
            trial: None,
            shown: Shown::default(),
            question: "words".to_owned(),
            value: Some(Value::Text(text.to_owned())),
            ms: Some(1),
        });
    }
    tables
}

/// Texts that people answered are read again as they were, but for blanks around them, and no spreadsheet computes them.
fn written(text: &str) -> Result<String, String> {
    let tables = answered(text);
    let (answers, people) = write(&tables);
    let again = read(&answers, &people, "x").unwrap_or_else(|error| panic!("{error}: {answers}"));
    let wanted = tables.answers.iter().map(|answer| match &answer.value {
        Some(Value::Text(text)) if !text.trim().is_empty() => Some(text.trim().to_owned()),
        _ => None,
    });
    let found = again.answers.iter().map(|answer| match &answer.value {
        Some(Value::Text(text)) => Some(text.clone()),
        None => None,
        Some(Value::Number(number)) => panic!("{number} was a text: {answers}"),
    });
    assert!(wanted.eq(found), "{tables:?}\n{answers}");
    let rows = cells(&answers);
    assert!(rows.len() == tables.answers.len() + 1 && rows.iter().all(|row| row.len() == 15), "{answers}");
    assert!(rows.iter().flatten().all(|cell| !cell.starts_with(FORMULA)), "a spreadsheet computes {answers}");
    Ok(rows.len().min(9).to_string())
}

/// The dataset of what people wrote: every table has its columns in all rows, no cell is computed, no page runs what they wrote.
fn dataset(text: &str) -> Result<String, String> {
    static STUDY_READ: LazyLock<Study> = LazyLock::new(|| Study::parse(STUDY, "x").unwrap());
    let made = export(&STUDY_READ, &answered(text), &BTreeMap::new(), Options::default());
    let made = made.map_err(|error| error.to_string())?;
    let of = |end: &'static str| made.files.iter().filter(move |file| file.path.ends_with(end));
    for file in of(".csv") {
        let rows = cells(&file.text);
        assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{}: {}", file.path, file.text);
        let is_computed = |cell: &&String| cell.starts_with(FORMULA) && cell.parse::<f64>().is_err();
        assert_eq!(rows.iter().flatten().find(is_computed), None, "{}", file.path);
    }
    for file in of(".json") {
        serde_json::from_str::<serde_json::Value>(&file.text).unwrap();
    }
    for file in of(".html").chain(of(".md")) {
        assert!(!file.text.contains(&MARKUP[..4]), "{} does not escape: {}", file.path, file.text);
    }
    Ok(made.files.len().to_string())
}

/// Cells of a CSV by RFC 4180, more strictly than readers are: a quote stands at the start of a cell or is doubled.
fn cells(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut is_quoted) = (Vec::new(), Vec::new(), String::new(), false);
    let mut letters = text.chars().peekable();
    let mut is_start = true;
    while let Some(letter) = letters.next() {
        match letter {
            '"' if is_quoted && letters.next_if_eq(&'"').is_some() => cell.push('"'),
            '"' if is_quoted => {
                is_quoted = false;
                assert!(matches!(letters.peek(), Some(',' | '\n')), "text behind a quoted cell: {text}");
            }
            '"' => {
                assert!(is_start, "a quote inside of a cell: {text}");
                is_quoted = true;
            }
            ',' | '\n' if !is_quoted => {
                row.push(std::mem::take(&mut cell));
                if letter == '\n' {
                    rows.push(std::mem::take(&mut row));
                }
                is_start = true;
                continue;
            }
            '\r' if !is_quoted => panic!("a line end inside of a cell: {text:?}"),
            other => cell.push(other),
        }
        is_start = false;
    }
    assert!(row.is_empty() && cell.is_empty() && !is_quoted, "the last line does not end: {text}");
    rows
}

/// Files that ask for much: reader, what they do, bytes.
pub(crate) fn hostile() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let with = |old: &str, new: &str| STUDY.replace(old, new).into_bytes();
    let nested = "[".repeat(400_000);
    vec![
        ("study", "nested brackets", format!("a = {nested}").into_bytes()),
        ("study", "many walks each", with("each = 2", "each = 4000000000")),
        ("study", "many answers", with("at_least = 2", "at_least = 4000000000")),
        ("study", "many repeats", with("repeat = 1", "repeat = 4000000000")),
        ("study", "many instructed trials", with("catch = 1", "catch = 4000000000")),
        ("study", "many attempts", with("attempts = 2", "attempts = 4000000000")),
        ("study", "many plays", with("plays = 1", "plays = 4000000000")),
        ("study", "a wide scale", with("7 = \"yes\"", "4000000000 = \"yes\"")),
        ("study", "long films", with("seconds = 2 ", "seconds = 1e300 ")),
        ("answers-out", "quotes", "\"".repeat(100_000).into_bytes()),
    ]
}
