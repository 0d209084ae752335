//! Whose answers an analysis or a dataset is of.

use super::{Participant, Tables, name};
use crate::study::error::Error;
use crate::study::file::Front;
use serde::Serialize;
use std::collections::BTreeMap;

/// Whose answers are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fronts {
    /// Of people in a browser.
    Web,
    /// Of people in a headset.
    Headset,
    /// Of all people, in a browser and in a headset together.
    People,
    /// Of simulated participants.
    Simulated,
}

impl Fronts {
    const fn have(self, front: Front) -> bool {
        match self {
            Self::Web => matches!(front, Front::Web),
            Self::Headset => matches!(front, Front::Headset),
            Self::People => !matches!(front, Front::Simulated),
            Self::Simulated => matches!(front, Front::Simulated),
        }
    }
}

/// Tables of the participants that were wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Their tables.
    pub tables: Tables,
    /// Numbers of the participants that are not in them, by front.
    pub left_out: BTreeMap<Front, usize>,
}

impl Tables {
    /// The participants that are wanted, with their answers. If nothing is asked for, people are wanted; without people,
    /// simulated participants. People and simulated participants are never in one choice.
    ///
    /// # Errors
    /// [`Error::SeveralFronts`] if nothing is asked for and people took part both in a browser and in a headset: what they saw
    /// differs, so which of them count has to be said. [`Error::NoFront`] if there is none of those asked for.
    pub fn choose(&self, wanted: Option<Fronts>) -> Result<Chosen, Error> {
        let count = |of: &dyn Fn(Front) -> bool| self.participants.iter().filter(|one| of(one.front)).count();
        let [web, headset] = [Front::Web, Front::Headset].map(|front| count(&|one| one == front));
        let wanted = match wanted {
            Some(wanted) => wanted,
            None if web > 0 && headset > 0 => return Err(Error::SeveralFronts { web, headset }),
            None if web + headset > 0 || self.participants.is_empty() => Fronts::People,
            None => Fronts::Simulated,
        };
        if !self.participants.is_empty() && count(&|front| wanted.have(front)) == 0 {
            let wanted = name(&wanted);
            return Err(Error::NoFront {
                wanted,
                found: self.fronts().into_keys().map(|front| name(&front)).collect(),
            });
        }
        let is_wanted = |one: &Participant| wanted.have(one.front);
        let left_out = self.only(|one| !is_wanted(one)).fronts();
        let tables = if left_out.is_empty() { self.clone() } else { self.only(is_wanted) };
        Ok(Chosen { tables, left_out })
    }

    /// Numbers of participants by front.
    pub fn fronts(&self) -> BTreeMap<Front, usize> {
        let mut fronts = BTreeMap::new();
        for one in &self.participants {
            *fronts.entry(one.front).or_insert(0) += 1;
        }
        fronts
    }
}
