//! Questionnaires: numbers worked by hand.

use gaitway::study::Error;
use gaitway::study::instrument::{Instrument, names};
use std::collections::BTreeMap;

pub(super) fn instrument(name: &str) -> Instrument {
    Instrument::builtin(name).unwrap().unwrap()
}

/// All items answered alike but those named.
pub(super) fn answers(name: &str, all: i64, but: &[(&str, i64)]) -> BTreeMap<String, i64> {
    let mut answers: BTreeMap<String, i64> =
        instrument(name).items.iter().map(|item| (item.id.clone(), all)).collect();
    for &(item, value) in but {
        assert!(answers.insert(item.to_owned(), value).is_some(), "{item}");
    }
    answers
}

pub(super) fn scores(name: &str, answers: &BTreeMap<String, i64>, variants: &[&str]) -> Vec<f64> {
    let variants: Vec<String> = variants.iter().map(|&variant| variant.to_owned()).collect();
    let scores = instrument(name).score(answers, &variants).unwrap();
    // to two decimals: what papers print
    scores.into_iter().map(|(_, score)| (score * 100.0).round() / 100.0).collect()
}

#[test]
fn ssq_scores_are_the_published_sums_times_the_published_weights() {
    // seven items a score, and nausea in two of them: sums of 7, times 9.54, 7.58 and 13.92; total 21 x 3.74
    assert_eq!(scores("ssq", &answers("ssq", 1, &[]), &[]), [66.78, 53.06, 97.44, 78.54]);
    // the greatest there are: 21 each, 63 in all
    assert_eq!(scores("ssq", &answers("ssq", 3, &[]), &[]), [200.34, 159.18, 292.32, 235.62]);
    // nausea alone: in N and in D, so twice in the total
    let nausea = answers("ssq", 0, &[("nausea", 2)]);
    assert_eq!(scores("ssq", &nausea, &[]), [19.08, 0.0, 27.84, 14.96]);
    assert_eq!(scores("ssq", &nausea, &["d_without_nausea"]), [19.08, 0.0, 0.0, 7.48]);
    // general discomfort in N and O, blurred vision in O and D, burping in N alone
    let some = answers("ssq", 0, &[("general-discomfort", 1), ("blurred-vision", 2), ("burping", 3)]);
    assert_eq!(scores("ssq", &some, &[]), [38.16, 22.74, 27.84, 33.66]);
}

#[test]
fn each_ssq_symptom_counts_where_it_was_published_to_count() {
    let counts = |item: &str| {
        let found = scores("ssq", &answers("ssq", 0, &[(item, 1)]), &[]);
        ["n", "o", "d"]
            .into_iter()
            .zip(found)
            .filter(|(_, score)| *score > 0.0)
            .map(|(id, _)| id)
            .collect::<Vec<_>>()
    };
    let published: [(&str, &[&str]); 16] = [
        ("general-discomfort", &["n", "o"]),
        ("fatigue", &["o"]),
        ("headache", &["o"]),
        ("eyestrain", &["o"]),
        ("difficulty-focusing", &["o", "d"]),
        ("increased-salivation", &["n"]),
        ("sweating", &["n"]),
        ("nausea", &["n", "d"]),
        ("difficulty-concentrating", &["n", "o"]),
        ("fullness-of-head", &["d"]),
        ("blurred-vision", &["o", "d"]),
        ("dizzy-eyes-open", &["d"]),
        ("dizzy-eyes-closed", &["d"]),
        ("vertigo", &["d"]),
        ("stomach-awareness", &["n"]),
        ("burping", &["n"]),
    ];
    for (item, scores) in published {
        assert_eq!(counts(item), scores, "{item}");
    }
}

#[test]
fn the_other_questionnaires_are_scored_as_published() {
    // VRSQ: 4 items of 12 at most, 5 of 15, in percent, and their mean
    assert_eq!(scores("vrsq", &answers("vrsq", 3, &[]), &[]), [100.0, 100.0, 100.0]);
    let some = answers("vrsq", 0, &[("fatigue", 3), ("vertigo", 3)]);
    assert_eq!(scores("vrsq", &some, &[]), [25.0, 20.0, 22.5]);
    // CSQ-VR: 6 to 42
    assert_eq!(scores("csq-vr", &answers("csq-vr", 1, &[("nausea-a", 7)]), &[]), [8.0, 2.0, 2.0, 12.0]);
    // IPQ: means of 0 to 6; sp2, inv3 and real1 turned round
    assert_eq!(scores("ipq", &answers("ipq", 6, &[]), &[]), [6.0, 4.8, 4.5, 4.5]);
    let turned = answers("ipq", 6, &[("sp2", 0), ("inv3", 0), ("real1", 0)]);
    assert_eq!(scores("ipq", &turned, &[]), [6.0; 4]);
    // SUS: how many of six are 6 or 7
    assert_eq!(scores("sus", &answers("sus", 5, &[("1", 6), ("4", 7)]), &[]), [2.0, 5.5]);
    assert_eq!(scores("fms", &answers("fms", 13, &[]), &[]), [13.0]);
}

#[test]
fn what_cannot_be_scored_is_said() {
    let ssq = instrument("ssq");
    let mut lacking = answers("ssq", 0, &[]);
    lacking.remove("vertigo");
    let error = ssq.score(&lacking, &[]).unwrap_err();
    assert!(matches!(&error, Error::Unanswered { item, .. } if item == "vertigo"), "{error}");
    let error = ssq.score(&answers("ssq", 0, &[("vertigo", 4)]), &[]).unwrap_err();
    assert!(error.to_string().contains("ssq.vertigo = 4: must be 0 to 3"), "{error}");
    let error = ssq.score(&answers("ssq", 0, &[]), &["d_without_nausia".to_owned()]).unwrap_err();
    assert!(error.to_string().contains("did you mean \"d_without_nausea\"?"), "{error}");
    assert!(Instrument::builtin("none").unwrap().is_none());
}

#[test]
fn every_questionnaire_is_whole_and_wording_is_there_only_where_it_may_be() {
    for name in names() {
        let own = instrument(name);
        assert_eq!(own.id, name);
        let ids: Vec<&str> = own.items.iter().map(|item| item.id.as_str()).collect();
        let mut scores: Vec<&str> = Vec::new();
        for score in &own.scores {
            assert!(score.items.iter().all(|item| ids.contains(&item.as_str())), "{name}: {}", score.id);
            assert!(
                score.of.iter().all(|earlier| scores.contains(&earlier.as_str())),
                "{name}: {}",
                score.id
            );
            scores.push(&score.id);
        }
        let is_used = |id: &&str| own.scores.iter().any(|score| score.items.iter().any(|item| item == id));
        assert!(ids.iter().all(is_used), "{name}");
    }
    let lacking = |name| instrument(name).without_wording(None).len();
    assert_eq!(names().map(lacking), [0, 0, 0, 6, 14, 6]);
}
