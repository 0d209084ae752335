//! Which agent goes first where it is crowded, and how much room a body takes there; twin of `shaders/shared/precedence.wgsl`.
//!
//! Reciprocal avoidance shares every evasion in halves, so discs that press towards a door from both sides hold one another in
//! an arch. People do not: the person ahead goes, and the person behind waits. So where an agent cannot avoid all others, its
//! share of the avoidance is, instead of ρ (the `responsibility`),
//!
//! s = clamp(ρ + 10 c (a + 2 m p) / R, 0, 1),    c = |u + w| / 2,    a = d · (u + w) / |u + w|
//!
//! u and w are the directions in which both want to go, d leads to the other, and R is the sum of the radii. p is how much higher
//! the priority of the other is. `group_cohesion` raises it for members that their group has left behind, so a group passes a
//! door together. The two shares sum to 2 ρ: what one takes less the other takes more. Of two that meet exactly head on c is 0,
//! and they share as before. The agent that goes first yields at last, too: below 0.8 R.
//!
//! Beside one another people are shoulders, behind one another chests: the sum of the radii is taken as
//!
//! R max(0.9, 1 + e c (1 - 2 a² / d²)),    e = (0.46 - 0.28) / (0.46 + 0.28)
//!
//! by the ellipse of 0.46 m by 0.28 m that Weidmann (1993) and Fruin give a body, a tenth into the disc at most. The literature
//! knows right of way at doors and bodies that turn; this form is ours. The numbers 10, 0.9 and 0.8 are chosen so that doors
//! pass as many people as measured ones (`gaitway validate`).

use super::exact::{dot2, greater};
use super::orca::{Line, unit_or};
use crate::kernels::shared::precedence::{
    ALL_OF_IT, GAIN, NEAREST, PRECEDENCE_STEEPNESS, SAME_WAY, SHOULDERS,
};

/// What a pair is to one of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Precedence {
    /// The part of the avoidance that it takes, 0 to 1.
    pub share: f32,
    /// The sum of the radii, m.
    pub radius: f32,
    /// Whether it follows the other the same way.
    pub follows: bool,
}

/// Of two agents, `to` the other, m, with the directions `own` and `theirs` in which they want to go (unit; 0: it stands).
///
/// `radius` is the sum of the radii as discs, m; `equal` the share of both without precedence; `lead` how much further ahead the
/// other counts than it is, m. Where one stands, and where discs overlap, the shares are equal.
pub fn precedence(
    to: [f32; 2],
    own: [f32; 2],
    theirs: [f32; 2],
    radius: f32,
    equal: f32,
    lead: f32,
) -> Precedence {
    let both = [own[0] + theirs[0], own[1] + theirs[1]];
    let agreement = 0.5 * dot2(both, both).sqrt();
    let ahead = dot2(to, unit_or(both, [0.0, 0.0]));
    let distance2 = dot2(to, to);
    let is_standing = dot2(own, own) < 0.5 || dot2(theirs, theirs) < 0.5;
    if is_standing || distance2 < radius * radius {
        return Precedence { share: equal, radius, follows: false };
    }
    let share = (equal + PRECEDENCE_STEEPNESS * agreement * ((ahead + lead) / radius)).clamp(0.0, 1.0);
    let breadth = greater(1.0 + SHOULDERS * agreement * (1.0 - 2.0 * (ahead * ahead / distance2)), NEAREST);
    Precedence { share, radius: radius * breadth, follows: share > ALL_OF_IT && dot2(own, theirs) > SAME_WAY }
}

/// The line of an agent that follows, without its demand to walk backwards because the one ahead is near.
pub fn standing(line: Line) -> Line {
    let [x, y, along_x, along_y] = line;
    let need = x * -along_y + y * along_x;
    if need > 0.0 { [x - -along_y * need, y - along_x * need, along_x, along_y] } else { line }
}

/// Whether a velocity leads nowhere although `wanted` is wanted, m/s.
pub fn gets_nowhere(velocity: [f32; 2], wanted: [f32; 2]) -> bool {
    dot2(velocity, wanted) < GAIN * dot2(wanted, wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    const EAST: [f32; 2] = [1.0, 0.0];
    const WEST: [f32; 2] = [-1.0, 0.0];

    #[test]
    fn who_is_ahead_goes_and_who_is_behind_waits_and_both_take_all_together() {
        for (to, own, theirs) in [
            ([0.5, 0.1], EAST, EAST),
            ([0.03, 0.6], EAST, [0.8, 0.6]),
            ([0.4, -0.3], [0.6, -0.8], [0.6, 0.8]),
        ] {
            let own_part = precedence(to, own, theirs, 0.4, 0.5, 0.0);
            let their_part = precedence([-to[0], -to[1]], theirs, own, 0.4, 0.5, 0.0);
            assert!(own_part.share > 0.5, "the other is ahead");
            let [left_behind, let_by] = [(to, own, theirs, -0.9), ([-to[0], -to[1]], theirs, own, 0.9)]
                .map(|(to, own, theirs, lead)| precedence(to, own, theirs, 0.4, 0.5, lead).share);
            assert!(
                left_behind < 0.5 && (left_behind + let_by - 1.0).abs() < 1e-6,
                "{left_behind} and {let_by}"
            );
            assert!((own_part.share + their_part.share - 1.0).abs() < 1e-6);
            assert_eq!(own_part.radius, their_part.radius);
        }
        assert!(precedence([0.5, 0.1], EAST, EAST, 0.4, 0.5, 0.0).follows);
        assert!(!precedence([-0.5, 0.1], EAST, EAST, 0.4, 0.5, 0.0).follows, "who is ahead");
    }

    #[test]
    fn who_meets_stands_or_overlaps_shares_as_before_and_is_a_disc() {
        let plain = Precedence { share: 0.5, radius: 0.4, follows: false };
        assert_eq!(precedence([0.5, 0.1], EAST, WEST, 0.4, 0.5, 0.0), plain);
        assert_eq!(precedence([0.5, 0.1], EAST, [0.0; 2], 0.4, 0.5, 0.0), plain);
        assert_eq!(precedence([0.5, 0.1], [0.0; 2], EAST, 0.4, 0.5, 0.0), plain);
        assert_eq!(precedence([0.3, 0.1], EAST, EAST, 0.4, 0.5, 0.0), plain);
    }

    #[test]
    fn shoulders_are_as_broad_as_the_ellipse_and_chests_a_tenth_into_the_disc_at_most() {
        let beside = precedence([0.0, 1.0], EAST, EAST, 0.37, 0.5, 0.0).radius;
        let behind = precedence([1.0, 0.0], EAST, EAST, 0.37, 0.5, 0.0).radius;
        assert!((beside - 0.46).abs() < 1e-6 && (behind - 0.9 * 0.37).abs() < 1e-6, "{beside} {behind}");
    }

    #[test]
    fn who_follows_may_stand() {
        // the one ahead (east) is so near that its line asks for 0.3 m/s to the west
        assert_eq!(standing([-0.3, 0.7, 0.0, 1.0]), [0.0, 0.7, 0.0, 1.0]);
        assert_eq!(standing([0.3, 0.7, 0.0, 1.0]), [0.3, 0.7, 0.0, 1.0], "what it may do anyway");
        assert!(gets_nowhere([0.1, 1.0], EAST) && !gets_nowhere([0.6, 0.0], EAST));
    }
}
