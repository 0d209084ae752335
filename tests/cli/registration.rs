//! `gaitway study register`: what the file says, blanks for what it does not, and nothing once a participant has had a place.

use super::{bad, good, json};
use gaitway::study::file::Front;
use gaitway::study::protocol::{Content, Event, State};
use gaitway::study::store::{Arrival, Opening, Store, wait};
use gaitway::study::{Materials, Study};
use std::collections::BTreeMap;
use std::path::Path;

const STUDY: &str = r#"
[study]
id = "looks"
version = 3
title = "How do they look?"
seed = 7
languages = ["en"]
minutes = 5
contact = "A lab"
flow = ["consent", "walks"]

[consent]
text = "consent.md"
minimum_age = 21

[part.walks]
kind = "trials"
show = { gaits = "practice", seconds = 4.0 }
ask = "mood"

[questions.mood]
kind = "choice"
text = "How does the person feel?"
options = ["well", "not well"]
"#;

fn write(folder: &Path, study: &str) {
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(folder.join("study.toml"), study).unwrap();
    std::fs::write(folder.join("consent.md"), "Do you agree?").unwrap();
}

fn store(mine: &Path, data: &Path) -> Store {
    let materials = Materials::default().with_text("consent.md", "Do you agree?");
    let study = Study::load(mine).unwrap();
    Store::open(data, &Opening { study, materials, libraries: BTreeMap::new(), rows: None }).unwrap()
}

/// The text under a heading.
fn under<'p>(page: &'p str, field: &str) -> &'p str {
    let (_, rest) = page.split_once(&format!("\n### {field}\n")).unwrap_or_else(|| panic!("{field}: {page}"));
    rest.split("\n#").next().unwrap().trim()
}

#[test]
fn a_registration_says_what_the_file_says_and_has_blanks_for_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine");
    write(&mine, STUDY);
    let page = good(&["study", "register", mine.to_str().unwrap()]);
    // every field of the template, in its order
    let fields: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("### ")).collect();
    let template = [
        "Title",
        "Authors",
        "Description",
        "Hypotheses",
        "Study type",
        "Blinding",
        "Is there any additional blinding in this study?",
        "Study design",
        "Randomization",
        "Existing data",
        "Explanation of existing data",
        "Data collection procedures",
        "Sample size",
        "Sample size rationale",
        "Stopping rule",
        "Manipulated variables",
        "Measured variables",
        "Indices",
        "Statistical models",
        "Transformations",
        "Inference criteria",
        "Data exclusion",
        "Missing data",
        "Exploratory analysis",
        "Other",
    ];
    assert_eq!(fields, template);
    assert_eq!(under(&page, "Title"), "How do they look?");
    for blank in [
        "Authors",
        "Hypotheses",
        "Study type",
        "Existing data",
        "Sample size rationale",
        "Statistical models",
    ] {
        assert!(under(&page, blank).starts_with("TO FILL IN: "), "{blank}: {page}");
    }
    assert!(under(&page, "Study design").contains("`walks`: 3 gaits of `practice`; 4 s each, played once"));
    assert!(
        under(&page, "Measured variables").contains("“How does the person feel?”; one of well, not well")
    );
    assert!(under(&page, "Data collection procedures").contains("at least 21 years old"));
    assert!(under(&page, "Data exclusion").contains("no rule"));
    assert!(under(&page, "Other").contains(&format!("gaitway {}", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn hypotheses_power_and_rules_come_from_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine");
    let at = mine.to_str().unwrap();
    good(&["study", "new", "eva-agents", "--out", at]);
    let file = mine.join("study.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let said = "[registration]\nauthors = [\"A. B.\"]\nhypotheses = [\"Q1 is higher under eva-g than under baseline.\"]\n\
                smallest_w = 0.16\n\n[exclude]\nmedian_ms_below = 900\n\n[data]";
    std::fs::write(&file, text.replacen("[data]", said, 1)).unwrap();
    let found = json(&["study", "register", at, "--json"]);
    let page = found["page"].as_str().unwrap();
    assert_eq!(under(page, "Hypotheses"), "- Q1 is higher under eva-g than under baseline.");
    assert_eq!(under(page, "Authors"), "- A. B.");
    // as `study power --w 0.16` prints them under "finite"
    let power = json(&["study", "power", "--w", "0.16", "--json"]);
    for people in [24, 48] {
        let rows = power["rows"].as_array().unwrap();
        let row = rows.iter().find(|row| row["people"] == people).unwrap();
        let line = format!(
            "{people} participants, 3 levels: power {:.1} % at alpha = 0.05",
            100.0 * row["finite"].as_f64().unwrap()
        );
        assert!(under(page, "Sample size rationale").contains(&line), "{line}: {page}");
    }
    assert_eq!(
        under(page, "Manipulated variables").lines().next().unwrap(),
        "- `scenes`, condition: baseline, eva-o, eva-g"
    );
    assert!(under(page, "Data exclusion").starts_with("- median time of an answer below 900 ms"));
    assert!(under(page, "Statistical models").contains("adjusted within a test by Bonferroni"));
    assert!(under(page, "Indices").contains("total = sum of n, o, d, times 3.74"));
    // what the lab has not written yet is named, too
    assert!(under(page, "Other").contains("`study.contact`, `consent.text`"), "{page}");
    assert_eq!(found["blanks"], page.matches("TO FILL IN").count());
    std::fs::write(&file, text.replacen("[data]", "[registration]\nsmallest_w = 1.5\n\n[data]", 1)).unwrap();
    let (code, message) = bad(&["study", "register", at]);
    assert!(
        code == 1 && message.contains("registration.smallest_w = 1.5: must be above 0 and below 1"),
        "{message}"
    );
}

#[test]
fn a_registration_comes_before_the_first_place_and_is_of_the_files_that_participants_see() {
    let folder = tempfile::tempdir().unwrap();
    let (mine, data) = (folder.path().join("mine"), folder.path().join("run"));
    write(&mine, STUDY);
    let store = store(&mine, &data);
    let register = ["study", "register", mine.to_str().unwrap(), "--data", data.to_str().unwrap()];
    let found = json(&[&register[..], &["--json"]].concat());
    assert_eq!(found["hash"], store.current().hash);
    let page = found["page"].as_str().unwrap();
    assert!(page.contains(&store.current().hash));
    assert!(under(page, "Existing data").starts_with("Registration prior to creation of data."));

    // a participant who only looks has no place
    let arrival = || Arrival { front: Front::Web, language: "en".to_owned(), platform: None };
    let arrived = wait(|then| store.arrive(arrival(), then)).unwrap();
    good(&register);
    // one who agrees has
    let agreed = Event::Consented { text: "hash".to_owned() };
    let turn = wait(|then| store.submit(&arrived.token, agreed, then)).unwrap();
    assert!(matches!(turn.page.content, Content::Show { .. }) && turn.state == State::Placed);
    let (code, message) = bad(&register);
    assert!(code == 1 && message.contains("1 participant has had a place already"), "{message}");
    // and has had one after all is deleted
    wait(|then| store.submit(&arrived.token, Event::Withdrawn, then)).unwrap();
    assert!(bad(&register).1.contains("had a place already"));

    // other files than those of the data
    let fresh = folder.path().join("fresh");
    drop(self::store(&mine, &fresh));
    std::fs::write(mine.join("consent.md"), "Do you agree, too?").unwrap();
    let (code, message) =
        bad(&["study", "register", mine.to_str().unwrap(), "--data", fresh.to_str().unwrap()]);
    assert!(code == 1 && message.contains("holds version 3 with the hash"), "{message}");
}
