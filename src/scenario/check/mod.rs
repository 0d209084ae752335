//! Allowed ranges of every value of a scenario, one file a section.

pub(crate) mod external;
mod feelings;
mod floors;
mod gaze;
mod inside;
mod journeys;
mod navigation;
mod people;
mod population;
mod props;
mod ranges;
mod routes;
mod user;
mod walkable;
mod walkers;
mod way_finding;

use crate::scenario::error::Error;
use crate::scenario::file::{Layout, Scenario};
use ranges::outline;

impl Scenario {
    /// Checks every value against its range, and every name against what it refers to.
    ///
    /// # Errors
    /// [`Error::Value`] for the first wrong value: key, value, allowed range, way out.
    pub fn validate(&self) -> Result<(), Error> {
        let word = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if self.name.is_empty() || self.name.len() > 64 || !self.name.chars().all(word) {
            let allowed = "1 to 64 letters, digits, '-' or '_'";
            return Err(Error::value(
                "name",
                format!("{:?}", self.name),
                allowed,
                "files are named after it",
            ));
        }
        if i64::try_from(self.seed).is_err() {
            return Err(Error::value("seed", self.seed, "0 to 2^63 - 1", "TOML knows no larger integer"));
        }
        population::check(&self.population)?;
        navigation::check(&self.navigation)?;
        self.user.as_ref().map_or(Ok(()), user::check)?;
        gaze::check(&self.gaze)?;
        feelings::check(self)?;
        external::check(self)?;
        way_finding::check(&self.way_finding)?;
        let area = walkable::area(self)?;
        if area.is_some() {
            // outline and holes are in the text
        } else if self.layout == Layout::Custom {
            outline("bounds", &self.bounds, "the corners of the walkable area, in order")?;
        } else if !self.bounds.is_empty() {
            let hint = "remove it, or set layout = \"custom\"";
            return Err(Error::value("bounds", "[..]", "left out with a generated layout", hint));
        }
        let goes_nowhere = self.routes.is_empty() && self.journeys.is_empty();
        if self.layout == Layout::Custom && goes_nowhere && self.population.agents > 0 {
            let hint = "add a [[routes]] or a [[journeys]] table";
            return Err(Error::value("routes", "[]", "one route or journey or more", hint));
        }
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            outline(
                &format!("obstacles[{index}].polygon"),
                &obstacle.polygon,
                "the corners of something solid",
            )?;
        }
        floors::check(&self.floors, &self.obstacles)?;
        floors::check_places(self)?;
        routes::check(&self.routes)?;
        routes::check_spawns(&self.spawns, &self.routes, self.layout)?;
        journeys::check(self)?;
        walkers::check(self)?;
        if let Some(area) = area {
            inside::check(self, &area)?;
        }
        self.environment.props.iter().enumerate().try_for_each(|(index, item)| props::check(index, item))?;
        match self.user {
            Some(user) if user.elevation.abs() > 0.0 => {
                let geometry = self.geometry();
                floors::check_user(&geometry.floors, geometry.user.unwrap_or_default(), user.elevation)
            }
            _ => Ok(()),
        }
    }
}
