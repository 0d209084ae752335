//! Recordings of what participants did in a headset go with the answers of those participants.

use super::desk::Desk;
use super::files::RECORDINGS;
use crate::study::file::OnWithdrawal;
use crate::study::plan::Ending;
use crate::study::protocol::State;
use std::io::ErrorKind;

impl Desk {
    /// Deletes the recordings of participants whose answers were deleted when they withdrew.
    pub(super) fn forget_recordings(&self) -> std::io::Result<()> {
        let is_deleted = |version: u32| {
            self.version(version).is_some_and(|version| version.plan.on_withdrawal == OnWithdrawal::Delete)
        };
        let mut withdrawn =
            self.books.people.values().filter(|one| {
                one.session.state() == State::Ended(Ending::Withdrawn) && is_deleted(one.version)
            });
        withdrawn.try_for_each(|one| self.delete_recordings(&one.code))
    }

    /// Deletes the recordings of the participant of a code.
    pub(super) fn delete_recordings(&self, code: &str) -> std::io::Result<()> {
        match std::fs::remove_dir_all(self.folder.join(RECORDINGS).join(code)) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }
}
