//! The tests, by where they come from.

mod corners;
mod diagrams;
mod doors;
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
    corners::RIMEA_15,
    corners::NIST_CORNER,
    lanes::NIST_COUNTER_FLOW,
    single::NIST_GROUPS,
    doors::NIST_CONGESTION,
    doors::NIST_MAXIMUM_FLOW,
    diagrams::JUELICH_CORRIDOR,
    doors::JUELICH_BOTTLENECK,
    lanes::LANES,
    street::UCY,
];
