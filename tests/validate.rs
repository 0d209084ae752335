//! The validation tests themselves: their measures on made-up data, and a quick part of what they run.

#![allow(clippy::unwrap_used, reason = "a test: a failure is a panic")]

use gaitway::sim::Backend;
use gaitway::validate::diagram::{ring, speed_round, weidmann};
use gaitway::validate::scene::{Stage, Variant};

#[test]
fn people_in_a_ring_slow_down_as_weidmann_says_and_not_at_all_without_crowding() {
    let stage = Stage::new(Backend::Cpu, None).unwrap();
    for density in [0.5, 1.5, 3.0] {
        let expected = weidmann(f64::from(density));
        for (crowding, share) in [(1.0, 1.0), (0.0, 1.34 / expected)] {
            let mut scene = ring(density, 3.0, 12.0).unwrap();
            scene.scenario.navigation.crowding = crowding;
            let run = scene.run(&stage, Variant::AsIs).unwrap();
            let found = speed_round(&run.tracks, 6.0) / expected;
            assert!((found / share - 1.0).abs() < 0.15, "{density}/m², crowding {crowding}: {found}");
            assert_eq!((run.outside, run.overlapping), (0, 0), "{density}/m², crowding {crowding}");
        }
    }
}
