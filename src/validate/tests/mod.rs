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

/// What was tried where a test fails today, by its name.
pub(super) const TRIED: &[(&str, &str)] = &[
    (
        "nist-groups",
        "The group comes to the door together with the first of the ten, and they part it: between two of its members two or three \
         pass at 0.2 m/s. Members of a group no longer crowd one another, which makes the group a third faster. Still missing: a group that \
         waits before a door until all are there.",
    ),
    (
        "nist-counter-flow",
        "In some draws two people stand in one another's way for good. `patience` frees such pairs; it is off by default, since with it \
         100 against 100 take about twice as long.",
    ),
];
