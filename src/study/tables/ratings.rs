//! The sheet of ratings that `gait ratings` reads.

use super::Tables;
use crate::emotion::Emotion;
use crate::table::cell;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The sheet `participant,video,happy,angry,sad,neutral`: the ordinary trials of a part that asks `question` about each emotion.
/// A trial with fewer than four answers has no row.
pub fn ratings(tables: &Tables, part: &str, question: &str) -> String {
    // in the order of the table: a participant's trials stay together
    let mut order: Vec<(&str, &str)> = Vec::new();
    let mut gaits: BTreeMap<(&str, &str), &str> = BTreeMap::new();
    let mut scores: BTreeMap<(&str, &str), [Option<i64>; 4]> = BTreeMap::new();
    for row in tables.answers.iter().filter(|row| row.part == part && row.is_ordinary()) {
        let item = row.question.strip_prefix(question).and_then(|rest| rest.strip_prefix('.'));
        let emotion = item.and_then(|item| item.parse::<Emotion>().ok());
        let (Some(emotion), Some(gait)) = (emotion, row.shown.gait.as_deref()) else { continue };
        let key = (row.participant.as_str(), row.page.as_str());
        if gaits.insert(key, gait).is_none() {
            order.push(key);
        }
        scores.entry(key).or_default()[emotion.index()] = row.number();
    }
    let mut sheet = String::from("participant,video,happy,angry,sad,neutral\n");
    for key in order {
        let Some([Some(happy), Some(angry), Some(sad), Some(neutral)]) = scores.get(&key) else { continue };
        let (participant, video) = (cell(key.0), cell(gaits.get(&key).copied().unwrap_or_default()));
        // writing to a string cannot fail
        let _ = writeln!(sheet, "{participant},{video},{happy},{angry},{sad},{neutral}");
    }
    sheet
}
