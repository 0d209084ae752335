//! Numbers of the models of avoidance.

use super::ranges::within;
use crate::scenario::error::Error;
use crate::scenario::file::{MAX_NEIGHBOURS, Navigation};

pub(super) fn check(n: &Navigation) -> Result<(), Error> {
    within("navigation.time_step", n.time_step, 0.001, 0.2, "1/30 s = 0.0333 is usual")?;
    within("navigation.neighbour_distance", n.neighbour_distance, 0.5, 50.0, "metres; 5 is usual")?;
    if !(1..=MAX_NEIGHBOURS).contains(&n.neighbour_cap) {
        let allowed = format!("1 to {MAX_NEIGHBOURS}");
        return Err(Error::value("navigation.neighbour_cap", n.neighbour_cap, allowed, "10 is usual"));
    }
    within("navigation.time_horizon", n.time_horizon, 0.1, 20.0, "seconds; 2 is usual")?;
    within(
        "navigation.time_horizon_obstacles",
        n.time_horizon_obstacles,
        0.1,
        20.0,
        "seconds; 0.5 to 1 is usual",
    )?;
    within("navigation.radius", n.radius, 0.05, 2.0, "metres; 0.2 is usual")?;
    within(
        "navigation.max_speed_factor",
        n.max_speed_factor,
        1.0,
        10.0,
        "times the preferred speed; 1.5 is usual",
    )?;
    within("navigation.max_speed", n.max_speed, 0.1, 10.0, "metres a second; 2.5 is usual")?;
    within("navigation.collision_weight", n.collision_weight, 0.0, 100.0, "metres; 1 is usual")?;
    within("navigation.patience", n.patience, 0.0, 600.0, "seconds; 1 is usual, 0 is never")?;
    within("navigation.max_acceleration", n.max_acceleration, 0.1, 100.0, "m/s2; 10 is usual")?;
    within("navigation.perturbation", n.perturbation, 0.0, 0.5, "m/s; 0.02 is usual")?;
    within(
        "navigation.time_horizon_dense",
        n.time_horizon_dense,
        0.0,
        60.0,
        "seconds; 1 is usual, 0 is none",
    )?;
    within(
        "navigation.time_horizon_jam",
        n.time_horizon_jam,
        0.0,
        60.0,
        "seconds; 0.15 is usual, 0 is none",
    )?;
    within("navigation.crowding", n.crowding, 0.0, 1.0, "0 is off, 1 is Weidmann's fundamental diagram")?;
    within("navigation.safety_margin", n.safety_margin, 0.0, 1.0, "metres; 0.01 is usual")
}
