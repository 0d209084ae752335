//! What a store does with events: session and ledger together.

use super::event::{Entry, Event};
use super::page::Content;
use super::session::Session;
use super::verdict::{Refusal, Verdict};
use crate::study::plan::{Ledger, Plan};

/// Takes an event of a participant: applies it, and all that follows from it, to session and ledger. Returns what the store has
/// to write in one transaction, oldest first; nothing for a repeated event. If the transaction fails, session and ledger are
/// ahead of the store and have to be rebuilt with [`follow`].
///
/// # Errors
/// [`Refusal`] for a wrong event; nothing has changed then.
pub fn conduct(
    plan: &Plan,
    ledger: &mut Ledger,
    session: &mut Session,
    entry: Entry,
) -> Result<Vec<Entry>, Refusal> {
    let at = entry.at;
    let mut entries = Vec::new();
    match session.judge(plan, &entry.event) {
        Verdict::Refuse(refusal) => return Err(refusal),
        Verdict::Again => {}
        Verdict::Take => {
            follow(plan, ledger, session, &entry);
            entries.push(entry);
        }
    }
    while let Some(event) = due(plan, ledger, session) {
        let entry = Entry { at, event };
        session.take(plan, &entry);
        entries.push(entry);
    }
    Ok(entries)
}

/// The event that the store owes a session, with the ledger changed accordingly.
fn due(plan: &Plan, ledger: &mut Ledger, session: &Session) -> Option<Event> {
    let person = session.person();
    let current = session.trial().map(|(trial, was_shown)| (trial.part.clone(), trial.position, was_shown));
    match session.page(plan).content {
        Content::Place => Some(match ledger.place(plan, person) {
            Some(place) => Event::Placed { place: place.place, trials: place.trials },
            None => Event::Full,
        }),
        // a place may have become free since
        Content::Ended { ending: crate::study::plan::Ending::Full, .. } => {
            let place = ledger.place(plan, person)?;
            Some(Event::Placed { place: place.place, trials: place.trials })
        }
        Content::Lapsed => {
            let seen = current.as_ref().filter(|(.., was_shown)| *was_shown);
            let swaps = ledger.resume(person, seen.map(|(part, position, _)| (part.as_str(), *position)));
            Some(Event::Returned { swaps })
        }
        Content::Broken => {
            let (part, position, _) = current?;
            let left_out = crate::study::plan::Swap { part: part.clone(), position, item: None };
            Some(Event::Replaced(ledger.replace(person, &part, position).unwrap_or(left_out)))
        }
        _ => None,
    }
}

/// Notes that a participant was silent for longer than the lease. Returns what the store has to write; none if the lease has
/// not ended at `now` (UTC ms) or there is none.
pub fn lapse(plan: &Plan, ledger: &mut Ledger, session: &mut Session, now: i64) -> Option<Entry> {
    session.lease_until(plan).filter(|&until| until < now)?;
    let entry = Entry { at: now, event: Event::Lapsed };
    follow(plan, ledger, session, &entry);
    Some(entry)
}

/// Applies a stored event to session and ledger, and nothing that follows from it: when a store starts, it hands over all events of
/// each participant in turn. The order of participants does not matter.
pub fn follow(plan: &Plan, ledger: &mut Ledger, session: &mut Session, entry: &Entry) {
    if session.judge(plan, &entry.event) != Verdict::Take {
        return;
    }
    let person = session.person();
    let trial = session.trial().map(|(trial, _)| (trial.part.clone(), trial.position));
    session.take(plan, entry);
    match &entry.event {
        Event::Next { .. } => {
            if let Some((part, position)) = trial {
                ledger.answer(person, &part, position);
            }
        }
        Event::Placed { trials, .. } => ledger.restore(person, trials.clone()),
        Event::Lapsed => ledger.lapse(person),
        Event::Returned { swaps } => ledger.returned(person, swaps),
        Event::Replaced(swap) => ledger.replaced(person, swap),
        Event::Withdrawn => ledger.withdraw(person, plan.on_withdrawal),
        Event::Excluded { .. } => ledger.lapse(person),
        _ => {}
    }
}
