//! The walkable area given as text.

use crate::scenario::error::Error;
use crate::scenario::file::{Layout, Plane, Scenario};
use crate::scenario::place::Area;

/// The walkable area, where it is given as text.
pub(super) fn area(scenario: &Scenario) -> Result<Option<Area>, Error> {
    if !scenario.walkable_file.is_empty() {
        let hint = "read the scenario from a file, or give the area as walkable_wkt";
        let allowed = "the name of a file beside the scenario's";
        return Err(Error::value("walkable_file", format!("{:?}", scenario.walkable_file), allowed, hint));
    }
    if scenario.walkable_wkt.is_empty() {
        return match &scenario.walkable_node {
            None if scenario.walkable_plane != Plane::default() => {
                let hint = "it is the plane of walkable_wkt; bounds are (x, z) always";
                Err(Error::value(
                    "walkable_plane",
                    "\"xz\"",
                    "left out without walkable_wkt or walkable_file",
                    hint,
                ))
            }
            None => Ok(None),
            Some(name) => {
                let hint =
                    "it names a node of walkable_file, or of environment.glb where that is where people walk";
                Err(Error::value(
                    "walkable_node",
                    format!("{name:?}"),
                    "left out without walkable_file",
                    hint,
                ))
            }
        };
    }
    if scenario.layout != Layout::Custom || !scenario.bounds.is_empty() {
        let hint = "the walkable area is the bounds: leave out bounds and layout";
        return Err(Error::value("walkable_wkt", "..", "left out where bounds or a layout are given", hint));
    }
    match Area::from_wkt_in(scenario.walkable_plane, &scenario.walkable_wkt) {
        Ok(area) => Ok(Some(area)),
        Err(error) => {
            let allowed = "POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION of one area";
            Err(Error::value("walkable_wkt", error, allowed, "such as POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))"))
        }
    }
}
