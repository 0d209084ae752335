//! A study's data as a dataset: the rules of Psych-DS, what is kept back, what is read again.

use super::analyse::{answer, identify, people, person};
use gaitway::perception::ratings as rule;
use gaitway::study::export::{Dataset, Note, Options, export};
use gaitway::study::file::{Front, OnWithdrawal};
use gaitway::study::plan::Ending;
use gaitway::study::protocol::State;
use gaitway::study::simulate::{Habits, Minds, Setup, run};
use gaitway::study::tables::{Fronts, Role, Tables, Value};
use gaitway::study::{Materials, Study};
use std::collections::{BTreeMap, BTreeSet};

/// Cells of a CSV, by line; quotes may hold commas and line ends.
fn table(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut is_quoted) = (Vec::new(), Vec::new(), String::new(), false);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if is_quoted && letters.next_if_eq(&'"').is_some() => cell.push('"'),
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => row.push(std::mem::take(&mut cell)),
            '\n' if !is_quoted => {
                row.push(std::mem::take(&mut cell));
                rows.push(std::mem::take(&mut row));
            }
            other => cell.push(other),
        }
    }
    assert!(cell.is_empty() && row.is_empty() && !is_quoted, "the last line ends");
    rows
}

/// What breaks a rule of Psych-DS 1.5.1.
fn faults(dataset: &Dataset) -> Vec<String> {
    let mut faults = Vec::new();
    let of = |path: &str| dataset.files.iter().find(|file| file.path == path);
    let Some(description) = of("dataset_description.json") else { return vec!["no description".to_owned()] };
    let Ok(json) = serde_json::from_str::<serde_json::Value>(&description.text) else {
        return vec!["no JSON".to_owned()];
    };
    if json["@context"] != "https://schema.org/" || json["@type"] != "Dataset" {
        faults.push("no schema.org dataset".to_owned());
    }
    for key in ["name", "description", "schemaVersion"] {
        if json[key].as_str().is_none_or(str::is_empty) {
            faults.push(format!("no {key}"));
        }
    }
    objects(&json, "dataset", &mut faults);
    let variables: BTreeSet<&str> = json["variableMeasured"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["name"].as_str().unwrap())
        .collect();
    let mut columns = BTreeSet::new();
    let data: Vec<_> = dataset.files.iter().filter(|file| file.path.starts_with("data/")).collect();
    if data.is_empty() {
        faults.push("no data".to_owned());
    }
    for file in data {
        let rows = table(&file.text);
        if !is_name(&file.path["data/".len()..]) {
            faults.push(format!("name {}", file.path));
        }
        if rows.len() < 2 || rows.iter().any(|row| row.len() != rows[0].len()) {
            faults.push(format!("rows of {}", file.path));
        }
        if rows[0].iter().collect::<BTreeSet<_>>().len() != rows[0].len() {
            faults.push(format!("columns of {}", file.path));
        }
        columns.extend(rows[0].clone());
    }
    let columns: BTreeSet<&str> = columns.iter().map(String::as_str).collect();
    faults.extend(columns.symmetric_difference(&variables).map(|column| format!("column {column}")));
    for (folder, name) in
        [("", "README.md"), ("", "CHANGES.md"), ("materials/", "study.toml"), ("analysis/", "models.R")]
    {
        if of(&format!("{folder}{name}")).is_none_or(|file| file.text.is_empty()) {
            faults.push(format!("no {name}"));
        }
    }
    faults
}

/// Objects in the values of schema.org's properties have a type.
fn objects(value: &serde_json::Value, at: &str, faults: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(fields) => {
            if !fields.contains_key("@type") {
                faults.push(format!("no @type in {at}"));
            }
            fields.iter().for_each(|(key, value)| objects(value, key, faults));
        }
        serde_json::Value::Array(values) => values.iter().for_each(|value| objects(value, at, faults)),
        _ => {}
    }
}

/// `([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv`
fn is_name(name: &str) -> bool {
    let Some(pairs) = name.strip_suffix("_data.csv") else { return false };
    pairs.split('_').all(|pair| {
        pair.split_once('-').is_some_and(|(key, value)| {
            let is_key = !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_lowercase());
            is_key && !value.is_empty() && value.bytes().all(|byte| byte.is_ascii_alphanumeric())
        })
    })
}

fn simulated(name: &str, count: usize) -> (Study, Tables) {
    let setup = Setup {
        participants: 60,
        at_once: 10,
        habits: Habits { careless: 0.2, ..Habits::default() },
        seed: 4,
    };
    let (_, found) = run(&super::plan(name, count), &Minds::default(), setup).unwrap();
    (Study::builtin(name).unwrap(), Tables::simulated(&found))
}

fn with_texts(study: &Study, tables: &Tables, options: Options) -> Dataset {
    let texts = Materials::default().with_text("../consent.en.md", "I agree.").texts;
    export(study, tables, &texts, options).unwrap()
}

/// People who said their gender (an index) and age.
fn said(about: &[(i64, i64)]) -> Tables {
    let rows = vec![[1, 2, 3]; about.len()];
    let mut tables = people(&rows, &["garden"], &["q1"]);
    for (number, &(gender, age)) in about.iter().enumerate() {
        for (question, value) in [("gender", gender), ("age", age)] {
            let mut one = answer(&format!("p{number}"), "about-you/1", Role::Ordinary, question, value);
            (one.page, one.trial) = ("about-you".to_owned(), None);
            tables.answers.push(one);
        }
    }
    tables
}

fn text<'d>(dataset: &'d Dataset, path: &str) -> &'d str {
    &dataset.files.iter().find(|file| file.path == path).unwrap().text
}

#[test]
fn the_rules_of_psych_ds_hold_for_both_studies() {
    for (name, count) in [("eva-gaits", 30), ("eva-agents", 0)] {
        let (study, tables) = simulated(name, count);
        for small_cells in [false, true] {
            let dataset = with_texts(&study, &tables, Options { small_cells, ..Options::default() });
            assert_eq!(faults(&dataset), Vec::<String>::new());
            assert!(dataset.notes.contains(&Note::Simulated));
            assert_eq!(text(&dataset, "materials/consent.en.md"), "I agree.");
            let description: serde_json::Value =
                serde_json::from_str(text(&dataset, "dataset_description.json")).unwrap();
            let of = |name: &str| {
                let all = description["variableMeasured"].as_array().unwrap();
                all.iter().find(|one| one["name"] == name).unwrap().clone()
            };
            assert_eq!(
                (of("ms")["unitText"].as_str(), of("front")["valueReference"][0]["name"].as_str()),
                (Some("ms"), Some("simulated"))
            );
            let value = of("value");
            let asked = value["valueReference"].as_array().unwrap();
            let item = if name == "eva-gaits" { "emotions.sad" } else { "presence.q1" };
            let one = asked.iter().find(|one| one["name"] == item).unwrap();
            assert_eq!((&one["minValue"], one["maxValue"].as_i64().unwrap() > 4), (&1.into(), true));
            assert!(
                one["description"].as_str().unwrap().len() > 10
                    && one["valueReference"].as_array().unwrap().len() >= 2
            );
        }
    }
    // the checks of this test find what is wrong
    let (study, tables) = simulated("eva-agents", 0);
    let good = with_texts(&study, &tables, Options::default());
    let broken = |change: &dyn Fn(&mut Dataset)| {
        let mut dataset = good.clone();
        change(&mut dataset);
        faults(&dataset)
    };
    let at = good.files.iter().position(|file| file.path.contains("task-scenes")).unwrap();
    assert_eq!(
        broken(&|set| set.files[at].path = "data/task-a-b_data.csv".to_owned()),
        ["name data/task-a-b_data.csv"]
    );
    assert!(
        !broken(&|set| set.files[at].text = set.files[at].text.replacen("scene,", "place,", 1)).is_empty()
    );
    assert!(!broken(&|set| set.files[at].text.push_str("a,b\n")).is_empty());
    assert!(
        !broken(&|set| set.files[0].text =
            set.files[0].text.replacen("\"@type\": \"PropertyValue\"", "\"x\": 1", 1))
        .is_empty()
    );
}

#[test]
fn every_answer_is_in_one_file_and_ratings_are_what_gait_ratings_reads() {
    let (study, tables) = simulated("eva-gaits", 30);
    let dataset = with_texts(&study, &tables, Options { small_cells: true, ..Options::default() });
    let data = dataset.files.iter().filter(|file| file.path.contains("_task-"));
    let rows: BTreeMap<&str, usize> = data.map(|file| (&*file.path, table(&file.text).len() - 1)).collect();
    assert_eq!(rows.values().sum::<usize>(), tables.answers.len(), "{rows:?}");
    let walks = tables.answers.iter().filter(|row| row.part == "walks").count();
    assert_eq!(rows["data/study-evagaits_task-walks_data.csv"], walks);
    let sheet = table(text(&dataset, "data/study-evagaits_task-walks_data.csv"));
    assert_eq!(
        sheet[0],
        [
            "participant",
            "front",
            "excluded",
            "page",
            "position",
            "role",
            "wanted",
            "gait",
            "question",
            "value",
            "ms"
        ]
    );
    let excluded: BTreeSet<&str> = sheet.iter().filter(|row| row[2] == "true").map(|row| &*row[0]).collect();
    let people = table(text(&dataset, "data/study-evagaits_description-participants_data.csv"));
    let named: BTreeSet<&str> = people.iter().filter(|row| row[4] == "true").map(|row| &*row[0]).collect();
    assert!(!excluded.is_empty() && excluded == named, "{excluded:?} {named:?}");
    let ratings = text(&dataset, "analysis/ratings.csv");
    let read = rule::parse(ratings, "", &rule::Options::default()).unwrap().responses;
    assert!(read.len() > 200 && read.iter().all(|one| !excluded.contains(one.participant.as_str())));
    assert!(text(&dataset, "analysis/models.R").contains("clmm(point ~ 1 + (1 | participant) + (1 | gait)"));
}

#[test]
fn gender_and_age_are_given_in_bands_or_not_at_all_where_fewer_than_five_people_share_them() {
    let mut study = Study::builtin("eva-agents").unwrap();
    let many: Vec<(i64, i64)> = (0..10).map(|number| (number % 2, 30)).collect();
    let about = "data/study-evaagents_task-aboutyou_data.csv";
    let participants = "data/study-evaagents_description-participants_data.csv";
    let dataset = with_texts(&study, &said(&many), Options::default());
    assert!(dataset.notes.is_empty(), "{:?}", dataset.notes);
    assert!(
        text(&dataset, participants).lines().nth(1).unwrap().ends_with(",woman,30"),
        "{}",
        text(&dataset, participants)
    );
    assert_eq!(faults(&dataset), Vec::<String>::new());
    assert!(text(&dataset, about).contains("gender"));
    // ages differ, and bands hide which one is whose
    let ages: Vec<(i64, i64)> = (0..12).map(|number| (number % 2, 25 + number % 10)).collect();
    let dataset = with_texts(&study, &said(&ages), Options::default());
    assert_eq!(dataset.notes, [Note::Banded { smallest: 1 }]);
    assert_eq!(faults(&dataset), Vec::<String>::new());
    let people = table(text(&dataset, participants));
    assert_eq!(people[0].last().unwrap(), "age_band");
    assert!(
        people[1..].iter().all(|row| row.last().unwrap() == "25-34")
            && !people[0].contains(&"age".to_owned())
    );
    let asked = table(text(&dataset, about));
    let question = asked[0].iter().position(|name| name == "question").unwrap();
    assert!(asked[1..].iter().all(|row| row[question] == "gender"), "no exact age is left anywhere");
    let dictionary = text(&dataset, "dataset_description.json");
    assert!(dictionary.contains("Age in a band") && dictionary.contains("\"25-34\""));
    // one more of another age: even in bands it would be found by it
    let mut one_more = many;
    one_more.push((1, 77));
    let dataset = with_texts(&study, &said(&one_more), Options::default());
    let withheld = |questions: &[&str]| Note::Withheld {
        questions: questions.iter().map(|&question| question.to_owned()).collect(),
        smallest: 1,
    };
    assert_eq!(dataset.notes, [withheld(&["age"])]);
    assert!(dataset.notes[0].to_string().contains("age left out: 1 of the participants"));
    assert!(text(&dataset, "README.md").contains("--small-cells"));
    assert_eq!(faults(&dataset), Vec::<String>::new());
    assert!(text(&dataset, participants).lines().nth(1).unwrap().ends_with(",woman"));
    let is_told =
        |file: &gaitway::study::export::File| file.path.starts_with("data/") && file.text.contains("77");
    assert!(!dataset.files.iter().any(is_told));
    // and one of another gender
    let mut two_more = one_more.clone();
    two_more.push((2, 30));
    let dataset = with_texts(&study, &said(&two_more), Options::default());
    assert_eq!(dataset.notes, [withheld(&["gender", "age"])]);
    assert!(!dataset.files.iter().any(is_told) && !dataset.files.iter().any(|file| file.path == about));
    let dataset = with_texts(&study, &said(&one_more), Options { small_cells: true, ..Options::default() });
    assert_eq!(dataset.notes, [Note::SmallCells { smallest: 1 }]);
    assert!(text(&dataset, participants).contains(",man,77\n"));
    // a participant that withdrew is in no table
    let mut tables = said(&one_more);
    tables.participants[10].state = State::Ended(Ending::Withdrawn);
    let dataset = with_texts(&study, &tables, Options::default());
    assert!(dataset.notes.is_empty() && !dataset.files.iter().any(|file| file.text.contains("p10,")));
    study.file.consent.on_withdrawal = OnWithdrawal::KeepAnonymous;
    let dataset = with_texts(&study, &tables, Options::default());
    assert!(text(&dataset, participants).contains("p10,web,withdrawn"));
}

#[test]
fn free_texts_cannot_be_computed_and_names_of_files_differ() {
    let study = Study::builtin("eva-agents").unwrap();
    let mut tables = people(&[[1, 2, 3], [2, 3, 4]], &["garden"], &["q1"]);
    identify(&mut tables, [[1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 2]]);
    for (number, words) in ["=1+1", "+1", "-1, \"x\"", "@a", "fine\nso far"].into_iter().enumerate() {
        let mut one = answer("p0", "comments/1", Role::Ordinary, "remarks", 0);
        (one.trial, one.value) = (None, Some(Value::Text(words.to_owned())));
        one.page = format!("comments-{number}");
        one.part = ["comments", "com-ments"][number % 2].to_owned();
        tables.answers.push(one);
    }
    let dataset = with_texts(&study, &tables, Options::default());
    assert_eq!(dataset.notes, [Note::FreeTexts { count: 5 }]);
    assert_eq!(faults(&dataset), Vec::<String>::new());
    let mut found = Vec::new();
    for file in ["comments", "commentsx2"] {
        let rows = table(text(&dataset, &format!("data/study-evaagents_task-{file}_data.csv")));
        let column = rows[0].iter().position(|name| name == "text").unwrap();
        found.extend(rows[1..].iter().map(|row| row[column].clone()));
    }
    assert_eq!(found, ["'=1+1", "'-1, \"x\"", "fine\nso far", "'+1", "'@a"]);
}

#[test]
fn people_and_simulated_participants_are_never_in_one_dataset() {
    let study = Study::builtin("eva-agents").unwrap();
    let mut tables = people(&[[1, 2, 3], [2, 3, 4]], &["garden"], &["q1"]);
    tables.participants.push(person("s7", Front::Simulated));
    let mut one = answer("s7", "scenes/1", Role::Ordinary, "presence.q1", 4);
    one.front = Front::Simulated;
    tables.answers.push(one);
    let own = |fronts| with_texts(&study, &tables, Options { fronts, ..Options::default() });
    let is_told = |dataset: &Dataset, name: &str| {
        let mut data = dataset.files.iter().filter(|file| file.path.starts_with("data/"));
        data.any(|file| file.text.contains(&format!("{name},")))
    };
    let dataset = own(None);
    assert_eq!(dataset.notes, [Note::LeftOut { front: Front::Simulated, count: 1 }]);
    assert!(is_told(&dataset, "p1") && !is_told(&dataset, "s7"));
    assert!(text(&dataset, "README.md").contains("1 participant of the front simulated"));
    let dataset = own(Some(Fronts::Simulated));
    assert_eq!(dataset.notes, [Note::Simulated, Note::LeftOut { front: Front::Web, count: 2 }]);
    assert!(!is_told(&dataset, "p1") && is_told(&dataset, "s7"));
    let options = Options { fronts: Some(Fronts::Headset), ..Options::default() };
    let wrong = export(&study, &tables, &BTreeMap::new(), options).unwrap_err().to_string();
    assert!(
        wrong.contains("no participant took part on the front \"headset\"; there are web, simulated"),
        "{wrong}"
    );
}
