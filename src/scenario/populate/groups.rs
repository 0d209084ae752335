//! Groups of one to five, whose members have consecutive numbers.

use super::shares::{cumulate, weighted};
use crate::scenario::file::Scenario;
use crate::scenario::random::{Purpose, unit};
use glam::Vec2;
use std::ops::Range;

/// How many walk together, beginning with agent `first`: one that walks alone, or a group.
pub(super) fn members(scenario: &Scenario, first: u32) -> Range<u32> {
    let ends = cumulate(scenario.population.groups.sizes.iter().copied());
    let size =
        if ends.is_empty() { 0 } else { weighted(&ends, unit(scenario.seed, first, Purpose::Group, 0)) };
    let size = u32::try_from(size).unwrap_or(0) + 1;
    first..(first + size).min(scenario.population.agents)
}

/// The others of a group, as [`super::AgentStart::companions`] lists them.
pub(super) fn others(members: &Range<u32>, agent: u32) -> [u32; 4] {
    let mut others = members.clone().filter(|member| *member != agent);
    std::array::from_fn(|_| others.next().unwrap_or(u32::MAX))
}

/// Where the others could start, the best first: beside the first member, then a row behind.
pub(super) fn places(first: Vec2, direction: Vec2, apart: f32) -> impl Iterator<Item = Vec2> {
    const ACROSS: [f32; 5] = [1.0, -1.0, 2.0, -2.0, 0.0];
    let side = direction.perp();
    (0..4_u8).flat_map(move |row| {
        let back = direction * (f32::from(row) * apart);
        ACROSS.map(|across| first + side * (across * apart) - back)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_follow_one_another_and_all_know_all_others() {
        let mut scenario =
            Scenario::builtin("crossing").map_or_else(|e| panic!("{e}"), |s| s.with_agents(20_000));
        scenario.population.groups.sizes = vec![0.5, 0.3, 0.0, 0.1, 0.1];
        let (mut first, mut counts) = (0, [0_u32; 5]);
        while first < 20_000 {
            let group = members(&scenario, first);
            assert!(group.start == first && (1..=5).contains(&group.len()));
            counts[group.len() - 1] += 1;
            for member in group.clone() {
                let others = others(&group, member);
                let known = others.iter().filter(|other| group.contains(other) && **other != member);
                assert_eq!(known.count(), group.len() - 1);
            }
            first = group.end;
        }
        let all: u32 = counts.iter().sum();
        let share = |size: usize| f64::from(counts[size - 1]) / f64::from(all);
        assert!((share(1) - 0.5).abs() < 0.02 && (share(2) - 0.3).abs() < 0.02, "{counts:?}");
        assert!(counts[2] <= 1 && (share(5) - 0.1).abs() < 0.02, "{counts:?}"); // only the last may be cut short
        scenario.population.groups.sizes.clear();
        assert_eq!(members(&scenario, 7), 7..8);
    }
}
