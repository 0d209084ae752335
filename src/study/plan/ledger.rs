//! The ledger of places: what was given to whom, and what came of it.
//!
//! The one writer of a store keeps it, and rebuilds it from the store when it starts: every method says what an event changes.

use super::account::{Account, Holder, open};
use super::compile::{Plan, TrialsStep};
use super::trials::{Swap, Trial, small};
use crate::study::file::OnWithdrawal;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// A place that was given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// How many were given before.
    pub place: u64,
    /// The trials of all counted parts, in order.
    pub trials: Vec<Trial>,
}

/// Counts of a part: answered and leased together, by stimulus or by row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Counts {
    /// Name of the part.
    pub part: String,
    /// Counts by stimulus (fill) or row (blocks, square); empty without a design.
    pub counts: Vec<u32>,
}

/// What was given to whom, and what came of it.
#[derive(Debug, Clone)]
pub struct Ledger {
    accounts: Vec<(String, Account)>,
    holders: BTreeMap<u64, Holder>,
    places: u64,
    /// Rows of the longest design that are given here; none: all.
    rows: Option<Range<u32>>,
}

impl Ledger {
    /// The ledger of a study without participants.
    pub fn new(plan: &Plan) -> Self {
        let account =
            |(_, name, step): (usize, &str, &TrialsStep)| (name.to_owned(), Account::of(plan, name, step));
        Self {
            accounts: plan.counted().map(account).collect(),
            holders: BTreeMap::new(),
            places: 0,
            rows: None,
        }
    }

    /// The same, giving rows of a range alone where several machines collect: of the parts that have the most rows.
    #[must_use]
    pub fn with_rows(self, rows: Option<Range<u32>>) -> Self {
        Self { rows, ..self }
    }

    /// Rows of the longest design; 0 without one.
    pub fn most_rows(&self) -> usize {
        self.accounts.iter().map(|(_, account)| account.rows()).max().unwrap_or(0)
    }

    /// Participants that are under way, or have answered all of their trials.
    pub fn participants(&self) -> usize {
        self.holders.values().filter(|holder| !holder.has_lapsed || holder.is_done()).count()
    }

    /// Places given so far, lapsed and withdrawn ones included.
    pub const fn places(&self) -> u64 {
        self.places
    }

    /// Whether a new participant gets a place: some stimulus lacks answers, and there are not too many participants.
    pub fn is_open(&self, plan: &Plan) -> bool {
        let mut fills = self.accounts.iter().filter_map(|(_, account)| match account {
            Account::Fill(fill) => Some(fill.is_open()),
            _ => None,
        });
        let first = fills.next();
        let lacks = first.is_none_or(|open| open || fills.any(|open| open));
        lacks && self.participants() < plan.most_participants as usize
    }

    /// How many more participants close admission if all of them stay: what an operator invites. For designs of rows it is what is
    /// left of `most_participants`.
    pub fn needs(&self, plan: &Plan) -> usize {
        let room = (plan.most_participants as usize).saturating_sub(self.participants());
        let fills = self.accounts.iter().filter_map(|(_, account)| match account {
            Account::Fill(fill) => Some(fill.needs()),
            _ => None,
        });
        fills.max().map_or(room, |needs| needs.min(room))
    }

    /// Counts of every counted part.
    pub fn counts(&self) -> Vec<Counts> {
        let counts = |account: &Account| match account {
            Account::Fill(fill) => fill.counts(),
            Account::Blocks(_, rows) | Account::Square(_, rows) => rows.counts(),
            Account::Same => Vec::new(),
        };
        self.accounts.iter().map(|(part, a)| Counts { part: part.clone(), counts: counts(a) }).collect()
    }

    /// Answers of a fill part, by stimulus; none for other parts.
    pub fn answered(&self, part: &str) -> Option<&[u32]> {
        self.accounts.iter().find_map(|(name, account)| match account {
            Account::Fill(fill) if name == part => Some(fill.answered()),
            _ => None,
        })
    }

    /// Gives a participant a place, the one that they have if they have one; none while admission is closed.
    pub fn place(&mut self, plan: &Plan, person: u64) -> Option<Place> {
        if let Some(holder) = self.holders.get(&person) {
            return Some(Place { place: holder.place, trials: holder.trials.clone() });
        }
        if !self.is_open(plan) {
            return None;
        }
        let mut trials = Vec::new();
        let most = self.most_rows();
        for (name, account) in &mut self.accounts {
            let rows = self.rows.as_ref().filter(|_| account.rows() == most);
            if let Some(step) = plan.trials_of(name) {
                trials.extend(account.admit(plan, (name, step), person, rows));
            }
        }
        let holder =
            Holder { place: self.places, trials: trials.clone(), done: BTreeSet::new(), has_lapsed: false };
        self.holders.insert(person, holder);
        self.places += 1;
        Some(Place { place: self.places - 1, trials })
    }

    /// A place as a store has it: for rebuilding.
    pub fn restore(&mut self, person: u64, trials: Vec<Trial>) {
        for (name, account) in &mut self.accounts {
            account.take(trials.iter().filter(|trial| trial.part == *name));
        }
        let place = self.places;
        self.holders.insert(person, Holder { place, trials, done: BTreeSet::new(), has_lapsed: false });
        self.places += 1;
    }

    /// The questions of a trial are answered, in time or after a lapse.
    pub fn answer(&mut self, person: u64, part: &str, position: u32) {
        let Some(holder) = self.holders.get_mut(&person) else { return };
        let Some(index) = holder.index(part, position) else { return };
        if !holder.done.insert(index) {
            return;
        }
        let (trial, late, ends) = (&holder.trials[index], holder.has_lapsed, holder.has_done(part));
        for (_, account) in self.accounts.iter_mut().filter(|(name, _)| name == part) {
            account.answer(trial, late, ends);
        }
    }

    /// The participant was silent for too long.
    pub fn lapse(&mut self, person: u64) {
        let Some(holder) = self.holders.get_mut(&person) else { return };
        if std::mem::replace(&mut holder.has_lapsed, true) {
            return;
        }
        for (name, account) in &mut self.accounts {
            account.lapse(holder, name);
        }
    }

    /// The participant is back after a lapse: places that are still free are kept, others are swapped for stimuli that lack
    /// answers. The trial `shown` (part and position), whose stimulus was seen, is kept in any case.
    pub fn resume(&mut self, person: u64, shown: Option<(&str, u32)>) -> Vec<Swap> {
        let Some(holder) = self.holders.get_mut(&person) else { return Vec::new() };
        if !std::mem::replace(&mut holder.has_lapsed, false) {
            return Vec::new();
        }
        let mut swaps = Vec::new();
        for (name, account) in &mut self.accounts {
            swaps.extend(account.resume(holder, name, person, shown));
        }
        swaps
    }

    /// The stimulus of a trial cannot be shown: another one takes its place, or, outside of fill, the trial is left out.
    pub fn replace(&mut self, person: u64, part: &str, position: u32) -> Option<Swap> {
        let holder = self.holders.get_mut(&person).filter(|holder| !holder.has_lapsed)?;
        let index = holder.index(part, position)?;
        let (_, account) = self.accounts.iter_mut().find(|(name, _)| name == part)?;
        let item = match (&mut *account, holder.trials[index].item) {
            (Account::Fill(fill), Some(item)) => {
                let own = holder.items(part);
                let other = fill.replace(person, item as usize, &own).map(small);
                holder.trials[index].item = other;
                other
            }
            _ => None,
        };
        if item.is_none() && holder.done.insert(index) && !matches!(account, Account::Fill(_)) {
            account.answer(&holder.trials[index], false, holder.has_done(part));
        }
        Some(Swap { part: part.to_owned(), position, item })
    }

    /// [`Ledger::resume`] as a store has it: for rebuilding.
    pub fn returned(&mut self, person: u64, swaps: &[Swap]) {
        let Some(holder) = self.holders.get_mut(&person) else { return };
        if !std::mem::replace(&mut holder.has_lapsed, false) {
            return;
        }
        swaps.iter().for_each(|swap| holder.swap(swap));
        for (name, account) in &mut self.accounts {
            let left: Vec<Trial> = open(holder, name).map(|(_, trial)| trial.clone()).collect();
            account.take(left.iter());
        }
    }

    /// [`Ledger::replace`] as a store has it: for rebuilding.
    pub fn replaced(&mut self, person: u64, swap: &Swap) {
        let Some(holder) = self.holders.get_mut(&person) else { return };
        let Some(index) = holder.index(&swap.part, swap.position) else { return };
        let before = holder.trials[index].clone();
        let Some((_, account)) = self.accounts.iter_mut().find(|(name, _)| *name == swap.part) else {
            return;
        };
        if let (Account::Fill(fill), Some(item)) = (&mut *account, before.item) {
            fill.lapse(item as usize);
            holder.trials[index].item = swap.item;
            swap.item.into_iter().for_each(|item| fill.lease(item as usize));
        }
        if swap.item.is_none() && holder.done.insert(index) && !matches!(account, Account::Fill(_)) {
            account.answer(&before, false, holder.has_done(&swap.part));
        }
    }

    /// The participant withdrew, or will not come back: leases lapse, and answers go if they are deleted.
    pub fn withdraw(&mut self, person: u64, answers: OnWithdrawal) {
        self.lapse(person);
        if answers == OnWithdrawal::KeepAnonymous {
            return;
        }
        let Some(holder) = self.holders.remove(&person) else { return };
        for (name, account) in &mut self.accounts {
            account.delete(&holder, name);
        }
    }
}
