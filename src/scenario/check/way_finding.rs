//! Way-finding.

use super::ranges::within;
use crate::scenario::error::Error;
use crate::scenario::file::WayFinding;

/// Checks how agents find the way.
pub(super) fn check(way_finding: &WayFinding) -> Result<(), Error> {
    way_finding.cell.map_or(Ok(()), |cell| within("way_finding.cell", cell))?;
    way_finding.clearance.map_or(Ok(()), |clearance| within("way_finding.clearance", clearance))?;
    within("way_finding.density_weight", way_finding.density_weight)?;
    within("way_finding.every", way_finding.every)
}
