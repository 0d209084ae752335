//! The data of a store as tables.

use super::super::tables::{Frames, Participant, Tables, of_session};
use super::desk::Desk;

impl Desk {
    /// The data of a version, or of all: every participant, and the last answers, but of participants who have withdrawn.
    pub(super) fn tables(&self, version: Option<u32>) -> Tables {
        let mut tables = Tables::default();
        let chosen = |number: u32| version.is_none_or(|wanted| wanted == number);
        for one in self.books.people.values().filter(|one| chosen(one.version)) {
            let Some(version) = self.version(one.version) else { continue };
            let exposures = one.session.exposures().values();
            let frames = Frames {
                all: exposures.clone().map(|shown| u64::from(shown.frames)).sum(),
                late: exposures.map(|shown| u64::from(shown.late_frames.min(shown.frames))).sum(),
            };
            tables.participants.push(Participant {
                participant: one.code.clone(),
                front: one.front,
                state: one.session.state(),
                placed: one.session.placed().is_some(),
                frames: Some(frames).filter(|frames| frames.all > 0),
            });
            tables.answers.extend(of_session(&version.plan, &one.code, one.front, &one.session));
        }
        tables
    }
}
