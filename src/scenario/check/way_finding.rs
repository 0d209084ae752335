//! Way-finding.

use super::ranges::within;
use crate::scenario::error::Error;
use crate::scenario::file::WayFinding;

/// Checks how agents find the way.
pub(super) fn check(way_finding: &WayFinding) -> Result<(), Error> {
    if let Some(cell) = way_finding.cell {
        within("way_finding.cell", cell, 0.05, 5.0, "metres; leave it out for 0.25 or 0.5")?;
    }
    if let Some(clearance) = way_finding.clearance {
        within("way_finding.clearance", clearance, 0.0, 5.0, "metres; a body's radius is usual")?;
    }
    within(
        "way_finding.density_weight",
        way_finding.density_weight,
        0.0,
        100.0,
        "0.5 to 2 is usual; 0 is none",
    )?;
    within("way_finding.every", way_finding.every, 0.05, 3600.0, "seconds; 1 is usual")
}
