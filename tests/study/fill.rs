//! Fill: the lemmas, on schedules drawn at random.

use gaitway::study::plan::fill::Fill;

/// `SplitMix64`, so that schedules are the same on every machine.
struct Draws(u64);

impl Draws {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((u128::from(z ^ (z >> 31)) * end as u128) >> 64) as usize
    }
}

/// A study under way: what is leased, what has lapsed, and what lemma 2 counts.
struct Schedule {
    fill: Fill,
    at_least: u32,
    leases: Vec<(u64, usize)>,
    lapsed: Vec<(u64, usize)>,
    answers: Vec<usize>,
    /// d(i): lapses since the gap was last at most 1.
    lapses: Vec<u32>,
    /// w: late answers, returns and replacements since then.
    others: u32,
    people: u64,
}

impl Schedule {
    fn new(draws: &mut Draws) -> Self {
        let items = 1 + draws.below(12);
        let (each, at_least) = (1 + draws.below(items), draws.below(5) as u32);
        Self {
            fill: Fill::new(draws.below(1 << 30) as u64, items, each, at_least),
            at_least,
            leases: Vec::new(),
            lapsed: Vec::new(),
            answers: Vec::new(),
            lapses: vec![0; items],
            others: 0,
            people: 0,
        }
    }

    fn admit(&mut self) {
        let (open, before) = (self.fill.is_open(), self.fill.counts());
        let Some(items) = self.fill.admit(self.people) else {
            assert!(!open && before.iter().all(|&count| count >= self.at_least));
            return;
        };
        assert!(open && before.iter().any(|&count| count < self.at_least));
        let mut own = items.clone();
        own.sort_unstable();
        own.dedup();
        assert_eq!(own.len(), items.len(), "an item once for each participant");
        let left = (0..before.len()).filter(|item| !items.contains(item));
        let least_left = left.map(|item| before[item]).min().unwrap_or(u32::MAX);
        assert!(items.iter().all(|&item| before[item] <= least_left), "the least come first");
        self.leases.extend(items.into_iter().map(|item| (self.people, item)));
        self.people += 1;
    }

    fn step(&mut self, draws: &mut Draws, with_lapses: bool) {
        let kinds = if with_lapses { 9 } else { 5 };
        match draws.below(kinds) {
            0 | 1 => self.admit(),
            2..=4 if !self.leases.is_empty() => {
                let (_, item) = self.leases.swap_remove(draws.below(self.leases.len()));
                self.fill.answer(item);
                self.answers.push(item);
            }
            5 | 6 if !self.leases.is_empty() => {
                let lost = self.leases.swap_remove(draws.below(self.leases.len()));
                self.fill.lapse(lost.1);
                self.lapses[lost.1] += 1;
                self.lapsed.push(lost);
            }
            7 if !self.lapsed.is_empty() => {
                let (person, item) = self.lapsed.swap_remove(draws.below(self.lapsed.len()));
                self.others += 1;
                if draws.below(2) == 0 {
                    self.fill.answer_late(item);
                    self.answers.push(item);
                } else {
                    self.leases.push((person, self.fill.lease_again(person, item, &[item])));
                }
            }
            8 if !self.leases.is_empty() => {
                let at = draws.below(self.leases.len());
                let (person, item) = self.leases[at];
                self.others += 1;
                self.lapses[item] += 1;
                match self.fill.replace(person, item, &[item]) {
                    Some(other) => self.leases[at].1 = other,
                    None => drop(self.leases.swap_remove(at)),
                }
            }
            8 if !self.answers.is_empty() => {
                let item = self.answers.swap_remove(draws.below(self.answers.len()));
                self.fill.delete(item);
                self.lapses[item] += 1;
            }
            _ => {}
        }
        self.agrees(with_lapses);
    }

    /// The lemmas hold, and the books agree with what happened.
    fn agrees(&mut self, with_lapses: bool) {
        let counts = self.fill.counts();
        for (item, &count) in counts.iter().enumerate() {
            let answered = self.answers.iter().filter(|&&one| one == item).count();
            let leased = self.leases.iter().filter(|(_, one)| *one == item).count();
            assert_eq!(
                (self.fill.answered()[item], self.fill.leased()[item]),
                (answered as u32, leased as u32)
            );
            let most = counts.iter().max().unwrap();
            assert!(*most <= 1 + self.others + count + self.lapses[item], "lemma 2: {counts:?}");
        }
        if !with_lapses {
            assert!(self.fill.gap() <= 1, "lemma 1: {counts:?}");
        }
        if !self.fill.is_open() && self.leases.is_empty() {
            assert!(self.fill.answered().iter().all(|&answers| answers >= self.at_least), "lemma 3");
        }
        if self.fill.gap() <= 1 {
            self.lapses.fill(0);
            self.others = 0;
        }
    }

    /// Everyone answers and comes until admission is closed.
    fn finish(&mut self) {
        for _ in 0..1000 {
            if !self.fill.is_open() && self.leases.is_empty() {
                break;
            }
            self.admit();
            for (_, item) in std::mem::take(&mut self.leases) {
                self.fill.answer(item);
                self.answers.push(item);
            }
        }
        assert!(self.fill.answered().iter().all(|&answers| answers >= self.at_least), "at the end");
    }
}

fn schedules(from: u64, count: u64) {
    for seed in from..from + count {
        let mut draws = Draws(seed);
        let mut schedule = Schedule::new(&mut draws);
        for _ in 0..40 + draws.below(80) {
            schedule.step(&mut draws, seed % 4 != 0);
        }
        schedule.finish();
    }
}

#[test]
fn the_lemmas_hold_on_random_schedules() {
    schedules(0, 3000);
}

#[test]
#[ignore = "long: the schedules of the design, 10^5"]
fn the_lemmas_hold_on_a_hundred_thousand_random_schedules() {
    schedules(1_000_000, 100_000);
}

#[test]
fn without_drop_outs_342_people_give_342_walks_ten_answers_each() {
    let mut fill = Fill::new(1, 342, 10, 10);
    let mut people = 0;
    while let Some(items) = fill.admit(people) {
        items.into_iter().for_each(|item| fill.answer(item));
        people += 1;
    }
    assert_eq!((people, fill.gap()), (342, 0));
    assert!(fill.answered().iter().all(|&answers| answers == 10));
}

#[test]
fn a_lapse_opens_admission_again_and_the_lost_item_goes_to_the_next_participant() {
    let mut fill = Fill::new(3, 6, 2, 1);
    let first = fill.admit(0).unwrap();
    let others: Vec<usize> = (1..3).flat_map(|person| fill.admit(person).unwrap()).collect();
    assert!(!fill.is_open() && fill.admit(3).is_none());
    others.into_iter().for_each(|item| fill.answer(item));
    fill.lapse(first[0]);
    assert!(fill.is_open());
    assert!(fill.admit(4).unwrap().contains(&first[0]));
    // the late answer is kept
    fill.answer_late(first[0]);
    assert_eq!((fill.answered()[first[0]], fill.leased()[first[0]]), (1, 1));
}

#[test]
fn orders_differ_between_participants_and_ties_do_not_favour_an_item() {
    let mut firsts = [0_u32; 20];
    for person in 0..4000 {
        firsts[Fill::new(9, 20, 3, 1).admit(person).unwrap()[0]] += 1;
    }
    assert!(firsts.iter().all(|&times| times.abs_diff(200) < 60), "{firsts:?}");
}
