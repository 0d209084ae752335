//! How much slower somebody walks the more people there are ahead; twin of `shaders/shared/crowding.wgsl`.
//!
//! Reciprocal avoidance alone keeps the free speed until people touch, which nobody does. Here the velocity an agent wants
//! is shortened before avoidance by Weidmann's fundamental diagram (Weidmann, Transporttechnik der Fussgänger, 1993)
//!
//! v / v₀ = 1 - exp(-1.913 (1/ρ - 1/5.4))
//!
//! relative to its own free speed v₀, where ρ is the density that it sees ahead: that of its neighbours, with the weight
//!
//! w = (1 - d²/R²) max(0, cos θ)
//!
//! at distance d and angle θ from where it wants to go, over the integral of w, R²/2. R is the distance of the farthest
//! neighbour considered, if the list of neighbours is full, and at most `crowding_reach`: a nearest-neighbour density
//! estimate with a variable kernel (Terrell and Scott 1992), so that people come into it and leave it with weight 0.
//! The own person counts with 0.12: it would be 0 in a crowd that stands at random, where the others do not know of the
//! one who looks, and 1/π (the mean of max(0, cos θ)) in a regular one; people who keep their distance are between. With
//! that the speed in a ring of 0.5 to 3 people/m² is within 6 % of Weidmann's (`gaitway validate`). People beside and
//! behind do not count: who leaves a jam at its head walks on freely. The idea to slow down by what is free ahead is that of Best,
//! Narang, Curtis and Manocha (`DenseSense`, 2014), who do it with stride length; this form is ours.

use super::exact::{dot2, exp2};
use super::neighbours::{Nearest, Slots};
use super::orca::NEIGHBOURS;

/// The share of the own person in the density.
const OWN_SHARE: f32 = 0.12;
/// One over the density at which nobody moves any more, 5.4 people/m² (Weidmann 1993), m².
const JAM_AREA: f32 = 0.185_185_18;
/// How steeply speed falls, 1/m²: 1.913 log2(e).
const STEEPNESS: f32 = 2.759_875_5;
/// Nobody wants to walk slower than this share of the free speed, which Weidmann has at 3.6 people/m²: in a jam people shuffle
/// on, or it would never dissolve.
const LEAST_SHARE: f32 = 0.2;
/// The density is measured over no less than this, m².
const LEAST_REACH2: f32 = 0.04;

/// What is left of the velocity `wanted`, m/s, by somebody at `at` with the neighbours `nearest`, of at most `cap` looked for
/// within `range`, m.
pub fn crowded(
    slots: &Slots<'_>,
    wanted: [f32; 2],
    at: [f32; 2],
    range: f32,
    cap: u32,
    nearest: &Nearest,
) -> [f32; 2] {
    let (step, count) = (slots.step, nearest.count);
    let wanted2 = dot2(wanted, wanted);
    if step.crowding <= 0.0 || count == 0 || wanted2 < 1e-8 {
        return wanted;
    }
    let to = |k: usize| {
        let [x, y, ..] = slots.slot_motion[nearest.slots[k] as usize * 2];
        [x - at[0], y - at[1]]
    };
    let reach = range.min(step.crowding_reach);
    let mut reach2 = reach * reach;
    if count == (cap as usize).min(NEIGHBOURS) {
        // there may be more people behind the farthest one, so the density is that of the disc up to it
        let to = to(count - 1);
        reach2 = reach2.min(dot2(to, to));
    }
    reach2 = reach2.max(LEAST_REACH2);
    let mut people = OWN_SHARE;
    for k in 0..count {
        let to = to(k);
        let distance2 = dot2(to, to);
        let along = dot2(to, wanted);
        if along > 0.0 && distance2 > 1e-6 && distance2 < reach2 {
            people += (1.0 - distance2 / reach2) * (along / (distance2 * wanted2).sqrt());
        }
    }
    let density = people / (0.5 * reach2);
    let share = (1.0 - exp2(-STEEPNESS * (1.0 / density - JAM_AREA))).max(LEAST_SHARE);
    let left = 1.0 - step.crowding * (1.0 - share);
    [wanted[0] * left, wanted[1] * left]
}
