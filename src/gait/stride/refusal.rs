//! Why a stride cannot be used, with the value found and the range that is used.

use super::support::{EQUAL, LEAST_LIFT, LEAST_STEP, MOST_UNSTEADY, Support, UNDERFOOT};
use super::{MAX_CRAB_DEG, OTHER_FOOT, SPEED, STRIDE_S};

/// Why the time between two strikes of one foot is no stride that can be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// The feet do not strike in turns.
    Turns {
        /// Strikes of the other foot between two of this one; 1 is needed.
        strikes: usize,
    },
    /// Too short or too long.
    Duration {
        /// Duration, s.
        seconds: f32,
    },
    /// The other foot strikes too early or too late.
    Halves {
        /// Share of the stride at which it strikes.
        share: f32,
    },
    /// The walker turns too far.
    Turn {
        /// Turn to the left, degrees.
        degrees: f32,
        /// The most that is used, degrees.
        most: f32,
    },
    /// The feet do not pass each other, as when boxing, dancing or standing.
    Steps(Support),
    /// The foot that goes forward is not lifted over the one that stands: walking backwards on a treadmill.
    Lift(Support),
    /// The ground does not pass under the feet as fast as the body goes: walking on the spot, sliding.
    Underfoot(Support),
    /// The ground passes under one foot much faster than under the other.
    Unequal(Support),
    /// The ground does not pass evenly under the standing feet.
    Unsteady(Support),
    /// Too slow or too fast.
    Speed {
        /// Speed, m/s.
        speed: f32,
    },
    /// The walker does not go where it faces.
    Crab {
        /// From where it goes to where it faces, degrees.
        degrees: f32,
    },
}

impl Refusal {
    /// Whether the feet do something else than walk.
    pub const fn is_no_walk(&self) -> bool {
        matches!(
            self,
            Self::Steps(_) | Self::Lift(_) | Self::Underfoot(_) | Self::Unequal(_) | Self::Unsteady(_)
        )
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Turns { strikes } => {
                write!(
                    f,
                    "the feet do not take turns: the other foot strikes {strikes} times between two strikes, not once"
                )
            }
            Self::Duration { seconds } => {
                write!(f, "{seconds:.2} s long; {} to {} are used", STRIDE_S.start(), STRIDE_S.end())
            }
            Self::Halves { share } => write!(
                f,
                "the feet do not take turns: the other foot strikes after {share:.2} of the stride; {} to {} are used",
                OTHER_FOOT.start(),
                OTHER_FOOT.end()
            ),
            Self::Turn { degrees, most } => write!(f, "turns by {degrees:.0} degrees; up to {most} are used"),
            Self::Steps(Support { step: [left, right], .. }) => write!(
                f,
                "not walking: the feet do not pass each other: where it strikes the left foot is {left:.2} m in front \
                 of the right, the right {right:.2} m in front of the left; {LEAST_STEP} m or more are needed"
            ),
            Self::Lift(Support { lift: [left, right], .. }) => write!(
                f,
                "not walking forwards: the foot that goes forward is not above the one that stands, but by {left:.3} m \
                 (left) and {right:.3} m (right); a mean of {LEAST_LIFT} m or more is needed"
            ),
            Self::Underfoot(Support { ground: [left, right], speed, .. }) => write!(
                f,
                "not walking: under the standing foot the ground goes back at {left:.2} m/s (left) and {right:.2} m/s \
                 (right), but the body goes at {speed:.2} m/s; a mean of {} to {} of it is needed",
                UNDERFOOT.start(),
                UNDERFOOT.end()
            ),
            Self::Unequal(Support { ground: [left, right], .. }) => write!(
                f,
                "not walking: the ground goes back at {left:.2} m/s under the left foot and at {right:.2} m/s under \
                 the right; a ratio of {} to {} is needed",
                EQUAL.start(),
                EQUAL.end()
            ),
            Self::Unsteady(support) => write!(
                f,
                "not walking: the speed of the ground under the standing feet deviates by {:.2} of its mean; up to \
                 {MOST_UNSTEADY} is used",
                support.unsteadiness()
            ),
            Self::Speed { speed } => {
                write!(f, "goes at {speed:.2} m/s; {} to {} are used", SPEED.start(), SPEED.end())
            }
            Self::Crab { degrees } => {
                let how = if degrees.abs() > 135.0 { "backwards" } else { "sideways" };
                write!(
                    f,
                    "walks {how}: {:.0} degrees off the way it faces; up to {MAX_CRAB_DEG} are used",
                    degrees.abs()
                )
            }
        }
    }
}
