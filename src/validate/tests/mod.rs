//! The tests, by where they come from.

mod corners;
mod diagrams;
mod doors;
mod groups;
mod lanes;
mod single;
mod street;

use super::judge::Test;

/// All tests, in the order of the report.
pub const ALL: &[Test] = &[
    single::RIMEA_1,
    single::NIST_CORRIDOR,
    diagrams::RIMEA_4,
    corners::RIMEA_6,
    single::RIMEA_7,
    doors::RIMEA_8,
    doors::RIMEA_9,
    doors::RIMEA_12,
    doors::RIMEA_12B,
    corners::RIMEA_15,
    corners::NIST_CORNER,
    lanes::NIST_COUNTER_FLOW,
    groups::NIST_GROUPS,
    doors::NIST_CONGESTION,
    doors::NIST_MAXIMUM_FLOW,
    diagrams::JUELICH_CORRIDOR,
    doors::JUELICH_BOTTLENECK,
    lanes::LANES,
    groups::GROUPS,
    street::UCY,
];

/// What is known of our crowd beyond a test's rows, by the test's name.
pub(super) const KNOWN: &[(&str, &str)] = &[(
    "nist-counter-flow",
    "In one run of fifty (240 other runs than these) two people block each other for good at a corner of the passage. The \
            one inside wants out, and the wall beside it holds it. The one outside wants in, and the wall before it holds it. Both \
            slide along their walls. Their order changes with that every second, so they push each other back and forth. Tried \
            without success: a point of the way inside the mouth, and a tie that numbers decide. `patience` frees such pairs; it \
            is off by default, since with it 100 against 100 take about twice as long. Not tried: right of way by where the walls \
            let people go, not by where they want to.",
)];
