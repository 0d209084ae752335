//! Where a take goes and where its body faces: a line for the report, and a warning where the two disagree.

use crate::gait::Recording;
use crate::gait::stride::Course;

/// Body and travel may point this far apart before it is called walking sideways or backwards, degrees.
const CRAB_DEG: f32 = 35.0;
/// A take that turns further than this is called curved, degrees.
const CURVED_DEG: f32 = 20.0;
/// Shorter travel than this has no direction, m.
const LEAST_TRAVEL: f32 = 0.3;

/// The line for the report; `None` for takes too short to tell.
pub(super) fn line(take: &Recording) -> Option<String> {
    let course = Course::of(take)?;
    let faces = compass(course.facing_deg);
    if course.on_the_spot {
        return Some(format!("heading: on the spot (treadmill or travel taken out), faces {faces}"));
    }
    if course.travel < LEAST_TRAVEL {
        return Some(format!("heading: goes nowhere ({:.2} m), faces {faces}", course.travel));
    }
    if course.turn_deg.abs() > CURVED_DEG {
        let side = if course.turn_deg > 0.0 { "left" } else { "right" };
        return Some(format!("heading: curved, turns {:.0} degrees to the {side}", course.turn_deg.abs()));
    }
    let towards = compass(course.heading_deg);
    if course.crab_deg.abs() > CRAB_DEG {
        return Some(format!(
            "warning: walks towards {towards} but faces {faces}: sideways or backwards, or two axes are exchanged in \
             the file"
        ));
    }
    Some(format!("heading: straight towards {towards}, {:.2} m", course.travel))
}

/// An angle from +z towards +x as the nearest axis and the rest.
fn compass(degrees: f32) -> String {
    let quarter = (degrees / 90.0).round();
    let axis = match quarter.rem_euclid(4.0) {
        q if q < 0.5 => "+z",
        q if q < 1.5 => "+x",
        q if q < 2.5 => "-z",
        _ => "-x",
    };
    let rest = degrees - 90.0 * quarter;
    if rest.abs() < 5.0 { axis.to_owned() } else { format!("{axis} {rest:+.0} degrees") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_read_well() {
        assert_eq!(compass(0.0), "+z");
        assert_eq!(compass(92.0), "+x");
        assert_eq!(compass(-90.0), "-x");
        assert_eq!(compass(179.0), "-z");
        assert_eq!(compass(-170.0), "-z +10 degrees");
        assert_eq!(compass(45.0 + 90.0 + 20.0), "-z -25 degrees");
    }
}
