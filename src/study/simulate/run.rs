//! Many simulated participants at once, in simulated time.

use super::agents::{Confusion, LinearModel, PAPER_CONFUSION};
use super::habits::Habits;
use super::people::Person;
use super::ratings::RatingModel;
use super::store::Store;
use super::tables::{Participant, Run, answered, answers};
use crate::random::Random;
use crate::study::plan::{Ending, Plan};
use crate::study::protocol::{Event, Page, Refusal, State};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How often leases are looked at while nothing else happens, ms.
const TICK: i64 = 10_000;

/// What participants think.
#[derive(Debug, Clone, PartialEq)]
pub struct Minds {
    /// About gaits.
    pub ratings: RatingModel,
    /// About scenes.
    pub scenes: LinearModel,
    /// About single agents.
    pub confusion: Confusion,
}

/// Gaits that show nothing, scenes without an effect, the paper's confusion matrix.
impl Default for Minds {
    fn default() -> Self {
        let ratings = RatingModel::new(std::collections::BTreeMap::new());
        Self { ratings, scenes: LinearModel::default(), confusion: PAPER_CONFUSION }
    }
}

/// How many participants come, and what they do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Most that arrive.
    pub participants: u32,
    /// Most that take part at the same time.
    pub at_once: u32,
    /// What they do beside answering.
    pub habits: Habits,
    /// Seed of all of their draws.
    pub seed: u64,
}

/// Simulates a study until no participant comes any more: `participants` have arrived, or admission is closed and no lease is left that
/// could open it. Returns the store and what it holds as tables.
///
/// # Errors
/// [`Refusal`] if the protocol refuses an event of a simulated participant, which is a fault of this program.
pub fn run<'p>(plan: &'p Plan, minds: &Minds, setup: Setup) -> Result<(Store<'p>, Run), Refusal> {
    let mut world = World {
        plan,
        minds,
        setup,
        store: Store::new(plan),
        people: Vec::new(),
        due: BinaryHeap::new(),
        arrivals: Random::new(setup.seed),
        active: 0,
        now: 0,
    };
    world.go()?;
    let run = world.tables();
    Ok((world.store, run))
}

/// What happens next: time in ms, and index of the person.
type Due = Reverse<(i64, usize)>;

struct World<'p, 'm> {
    plan: &'p Plan,
    minds: &'m Minds,
    setup: Setup,
    store: Store<'p>,
    people: Vec<Person>,
    due: BinaryHeap<Due>,
    arrivals: Random,
    active: u32,
    now: i64,
}

impl World<'_, '_> {
    fn go(&mut self) -> Result<(), Refusal> {
        loop {
            self.store.lapse(self.now);
            self.invite()?;
            let leases = self.leases();
            match self.due.pop() {
                Some(Reverse((at, person))) if at <= self.now + TICK => {
                    self.now = self.now.max(at);
                    self.act(person)?;
                }
                Some(later) => {
                    self.due.push(later);
                    self.now += TICK;
                }
                None if leases => self.now += TICK,
                None => return Ok(()),
            }
        }
    }

    /// Whether a lease is left while no participant answers.
    fn leases(&self) -> bool {
        self.due.is_empty()
            && self.people.iter().any(|person| {
                self.store.session(key(person.number)).is_some_and(|s| s.lease_until(self.plan).is_some())
            })
    }

    /// Participants that have no place yet and may get one.
    fn waiting(&self) -> usize {
        let waits = |person: &&Person| {
            let session = self.store.session(key(person.number));
            !person.has_left
                && session.is_some_and(|s| matches!(s.state(), State::Arrived | State::Consented))
        };
        self.people.iter().filter(waits).count()
    }

    /// New participants come while there is room, admission is open, and more are needed than are on their way.
    fn invite(&mut self) -> Result<(), Refusal> {
        while self.active < self.setup.at_once
            && self.people.len() < self.setup.participants as usize
            && self.store.ledger().is_open(self.plan)
            && self.waiting() < self.store.ledger().needs(self.plan)
        {
            let number = self.people.len() as u64;
            let random = Random::new(self.arrivals.bits());
            self.people.push(Person::new(number, self.setup.habits.careless, random));
            let language = self.plan.languages.first().map_or("en", String::as_str);
            self.store.arrive(key(number), language, self.now)?;
            self.active += 1;
            let wait = i64::try_from(self.arrivals.below(60_000)).unwrap_or(0);
            self.due.push(Reverse((self.now + wait, self.people.len() - 1)));
        }
        Ok(())
    }

    /// A person sends what they answered, looks at the next page, and begins to answer it, or leaves.
    fn act(&mut self, index: usize) -> Result<(), Refusal> {
        let person = key(self.people[index].number);
        for (at, event) in std::mem::take(&mut self.people[index].pending) {
            self.store.submit(person, event, at)?;
        }
        let Some(page) = self.page(person)? else {
            self.leave();
            return Ok(());
        };
        let habits = self.setup.habits;
        let is_placed = self.store.session(person).is_some_and(|session| session.placed().is_some());
        let hazard = if is_placed { habits.leaving } else { habits.leaving_early };
        if is_new(&page) && self.people[index].random.unit() < hazard {
            return self.fall_silent(index, person);
        }
        let Some(session) = self.store.session(person) else { return Ok(()) };
        let reply = self.people[index].reply(self.plan, self.minds, session, &page);
        let mut at = self.now;
        let timed = reply.into_iter().map(|(time, event)| {
            at += time;
            (at, event)
        });
        self.people[index].pending = timed.collect();
        self.due.push(Reverse((at.max(self.now + 1), index)));
        Ok(())
    }

    /// The page of a person; none when nothing follows.
    fn page(&mut self, person: u64) -> Result<Option<Page>, Refusal> {
        let state = self.store.session(person).map(crate::study::protocol::Session::state);
        if state == Some(State::Lapsed) {
            let back = Event::Sign { page: String::new(), kind: "back".to_owned() };
            self.store.submit(person, back, self.now)?;
        }
        let Some(session) = self.store.session(person) else { return Ok(None) };
        let is_over = matches!(session.state(), State::Ended(_));
        Ok((!is_over).then(|| session.page(self.plan)))
    }

    fn leave(&mut self) {
        self.active = self.active.saturating_sub(1);
    }

    fn fall_silent(&mut self, index: usize, person: u64) -> Result<(), Refusal> {
        let habits = self.setup.habits;
        let random = &mut self.people[index].random;
        if random.unit() < habits.withdrawing {
            self.store.submit(person, Event::Withdrawn, self.now)?;
        } else if random.unit() < habits.returning {
            // a lease and a little later, and then no new leaving at this page
            let later = self.plan.lease_ms + i64::try_from(random.below(3_600_000)).unwrap_or(0);
            self.due.push(Reverse((self.now + later, index)));
            return Ok(());
        }
        self.people[index].has_left = true;
        self.leave();
        Ok(())
    }

    fn tables(&self) -> Run {
        let sessions = || self.people.iter().filter_map(|p| Some((p, self.store.session(key(p.number))?)));
        let participant = |(person, session): (&Person, &crate::study::protocol::Session)| Participant {
            number: person.number,
            state: session.state(),
            was_placed: session.placed().is_some(),
            is_careless: person.is_careless,
        };
        let participants: Vec<Participant> = sessions().map(participant).collect();
        let stays = |state| state != State::Ended(Ending::Withdrawn);
        Run {
            placed: participants.iter().filter(|one| one.was_placed).count(),
            turned_away: participants.iter().filter(|one| one.state == State::Ended(Ending::Full)).count(),
            answers: sessions()
                .filter(|(_, session)| stays(session.state()))
                .flat_map(|(person, session)| answers(self.plan, person.number, session))
                .collect(),
            answered: answered(self.plan, &self.store),
            counts: self.store.ledger().counts(),
            duration_ms: self.now,
            participants,
        }
    }
}

/// A page at which a person may leave: one is counted for each trial.
const fn is_new(page: &Page) -> bool {
    !matches!(page.content, crate::study::protocol::Content::Ask { .. })
}

/// The bits by which the plan draws for a simulated participant.
fn key(number: u64) -> u64 {
    Random::new(number).bits() >> 1
}
