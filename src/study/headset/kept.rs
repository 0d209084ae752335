//! A participation in the store on the disk.

use super::parties::{ConsentText, Participation};
use crate::study::file::Front;
use crate::study::protocol::{Event, Page};
use crate::study::store::{Act, Arrival, Arrived, Store, Trouble, Turn, Version, wait};
use crate::study::theatre::Showing;
use std::sync::Arc;

/// A participation in the store on the disk.
#[derive(Debug, Clone)]
pub struct Kept {
    store: Store,
    token: String,
    code: String,
    language: String,
    version: Arc<Version>,
}

impl Kept {
    /// A new participant in a headset, or the participant of a code, who goes on.
    ///
    /// # Errors
    /// [`Trouble::Unknown`] for a code that no participant has, [`Trouble::Elsewhere`] for that of one in a browser, [`Trouble::Closed`] while admission is closed, and the store's.
    pub fn begin(store: &Store, code: Option<&str>, language: &str) -> Result<Self, Trouble> {
        let Arrived { token, turn } = match code {
            Some(code) => wait(|then| store.resume(code, Front::Headset, then))?,
            None => {
                let (front, language) = (Front::Headset, language.to_owned());
                wait(|then| store.arrive(Arrival { front, language, platform: None }, then))?
            }
        };
        let version = store.version(turn.version).ok_or(Trouble::Unknown)?;
        Ok(Self { store: store.clone(), token, code: turn.code, language: turn.language, version })
    }

    /// The participant's code.
    pub fn code(&self) -> &str {
        &self.code
    }

    /// Language of the texts (BCP 47).
    pub fn language(&self) -> &str {
        &self.language
    }

    /// The version of the study.
    pub fn version(&self) -> &Version {
        &self.version
    }

    /// Where the participation is.
    ///
    /// # Errors
    /// When the store fails.
    pub fn turn(&self) -> Result<Turn, Trouble> {
        wait(|then| self.store.turn(&self.token, then))
    }

    /// Asks where the participation is, and does not wait; `then` runs on the store's thread.
    pub fn look(&self, then: impl FnOnce(Result<Turn, Trouble>) + Send + 'static) {
        self.store.turn(&self.token, then);
    }

    /// Does something with the participation on the operator's behalf.
    ///
    /// # Errors
    /// When the store fails or refuses it.
    pub fn operate(&self, operator: &str, act: Act) -> Result<Turn, Trouble> {
        wait(|then| self.store.operate(operator, &self.code, act, then))
    }

    fn showing(&self) -> Result<[Option<Showing>; 2], crate::Error> {
        wait(|then| self.store.showing(&self.token, then)).map_err(|trouble| of(&trouble))
    }
}

impl Participation for Kept {
    fn page(&mut self) -> Result<Page, crate::Error> {
        self.turn().map(|turn| turn.page).map_err(|trouble| of(&trouble))
    }

    fn submit(&mut self, event: Event) -> Result<Page, crate::Error> {
        let stored = wait(|then| self.store.submit(&self.token, event, then));
        stored.map(|turn| turn.page).map_err(|trouble| of(&trouble))
    }

    fn consent(&mut self, name: &str) -> Result<ConsentText, crate::Error> {
        let text = self.version.text(name).ok_or_else(|| crate::Error::Usage {
            message: format!("{name}: the frozen study has no such text"),
            hint: "restore the folder of data from its backup".to_owned(),
        })?;
        Ok(ConsentText { text: text.to_owned(), hash: self.version.text_hash(name) })
    }

    fn trial(&mut self) -> Result<Option<Showing>, crate::Error> {
        self.showing().map(|[now, _]| now)
    }

    fn next_trial(&mut self) -> Result<Option<Showing>, crate::Error> {
        self.showing().map(|[_, next]| next)
    }
}

/// A store that failed ends the session; what it has acknowledged is kept.
fn of(trouble: &Trouble) -> crate::Error {
    crate::Error::Usage {
        message: format!("the store: {trouble}"),
        hint: "all answers until then are stored: begin again with the participant's code".to_owned(),
    }
}
