//! The answers of one participation.

use super::{Answer, answer};
use crate::study::file::Front;
use crate::study::plan::Plan;
use crate::study::protocol::Session;

/// The last answers of a participation, in the order of pages.
pub fn of_session(plan: &Plan, participant: &str, front: Front, session: &Session) -> Vec<Answer> {
    let rows = crate::study::simulate::answers(plan, 0, session);
    let named = |row| Answer { participant: participant.to_owned(), front, ..answer(row) };
    rows.iter().map(named).collect()
}
