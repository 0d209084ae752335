//! Numbers of the models of avoidance.

use super::ranges::{count, within};
use crate::scenario::error::Error;
use crate::scenario::file::Navigation;

pub(super) fn check(n: &Navigation) -> Result<(), Error> {
    count("navigation.neighbour_cap", n.neighbour_cap)?;
    [
        ("time_step", n.time_step),
        ("neighbour_distance", n.neighbour_distance),
        ("time_horizon", n.time_horizon),
        ("time_horizon_obstacles", n.time_horizon_obstacles),
        ("time_horizon_dense", n.time_horizon_dense),
        ("time_horizon_jam", n.time_horizon_jam),
        ("safety_margin", n.safety_margin),
        ("crowding", n.crowding),
        ("radius", n.radius),
        ("max_speed_factor", n.max_speed_factor),
        ("max_speed", n.max_speed),
        ("perturbation", n.perturbation),
        ("collision_weight", n.collision_weight),
        ("max_acceleration", n.max_acceleration),
        ("patience", n.patience),
    ]
    .into_iter()
    .try_for_each(|(name, value)| within(&format!("navigation.{name}"), value))
}
