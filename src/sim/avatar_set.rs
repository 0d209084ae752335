//! The avatars of a crowd, and every gait retargeted onto each of them.

use super::Error;
use crate::avatar::foot::{foot_down, foot_stands};
use crate::avatar::{Avatar, Clip, retarget, standing};
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::kernels::layout::Body;
use crate::kernels::shared::standing::index::STANCES;
use crate::scenario::ExternalBodies;
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// Clips in which an avatar stands: `[emotion][stance]`.
const STANDING: usize = Emotion::ALL.len() * STANCES;

/// Sets that are kept for the next crowd.
const KEPT: usize = 4;

/// The sets that were put together last, the latest first. Runs of a sweep and episodes of a notebook have the same avatars and
/// gaits again and again, and retargeting takes longer than many a run.
static LAST: Mutex<Vec<Arc<Retargeted>>> = Mutex::new(Vec::new());

/// Avatars and clips. Clips stand in the order `[avatar][gait]`, each avatar's standing clips after its gaits.
#[derive(Debug, Clone)]
pub struct AvatarSet {
    retargeted: Arc<Retargeted>,
    outsiders: ExternalBodies,
}

/// What gaits and avatars give.
#[derive(Debug)]
struct Retargeted {
    gaits: Vec<Gait>,
    avatars: Vec<Avatar>,
    clips: Vec<Clip>,
    feet_down: Vec<[f32; 2]>,
}

impl AvatarSet {
    /// Retargets `gaits` onto every avatar, in parallel, unless that was done a short time ago.
    ///
    /// # Errors
    /// When there is no avatar or gait, too many avatars, or a gait cannot drive an avatar.
    pub fn new(gaits: &[Gait], avatars: Vec<Avatar>) -> Result<Self, crate::Error> {
        if avatars.is_empty() || avatars.len() > MAX_AVATARS {
            return Err(Error::Avatars { found: avatars.len(), most: MAX_AVATARS }.into());
        }
        if gaits.is_empty() {
            return Err(Error::NoGaits.into());
        }
        let retargeted = if let Some(kept) = kept(gaits, &avatars) {
            kept
        } else {
            let new = Arc::new(Retargeted::new(gaits, avatars)?);
            keep(&new);
            new
        };
        Ok(Self { retargeted, outsiders: ExternalBodies::default() })
    }

    /// The same with robots and vehicles.
    #[must_use]
    pub fn with_outsiders(mut self, outsiders: ExternalBodies) -> Self {
        self.outsiders = outsiders;
        self
    }

    /// What robots and vehicles look like.
    pub const fn outsiders(&self) -> &ExternalBodies {
        &self.outsiders
    }

    /// The avatars.
    pub fn avatars(&self) -> &[Avatar] {
        &self.retargeted.avatars
    }

    /// How many gaits there are.
    pub fn gait_count(&self) -> usize {
        self.retargeted.gaits.len()
    }

    /// The name of a gait, by index.
    pub fn gait_name(&self, gait: u32) -> Option<&str> {
        self.retargeted.gaits.get(gait as usize).map(|gait| gait.name.as_str())
    }

    /// All clips.
    pub fn clips(&self) -> &[Clip] {
        &self.retargeted.clips
    }

    /// Index of the clip of a gait on an avatar, both by index; out of range: the last standing clip, of the last avatar.
    pub fn clip_index(&self, avatar: u32, gait: u32) -> u32 {
        let clips = self.gait_count() + STANDING;
        let avatar = (avatar as usize).min(self.avatars().len() - 1);
        let gait = (gait as usize).min(clips - 1);
        (avatar * clips + gait) as u32
    }

    /// Index of the first clip in which an avatar stands. Those of an emotion follow those of the emotion before.
    pub fn standing_index(&self, avatar: u32) -> u32 {
        self.clip_index(avatar, self.gait_count() as u32)
    }

    /// A clip by index.
    pub fn clip(&self, index: u32) -> &Clip {
        &self.clips()[(index as usize).min(self.clips().len() - 1)]
    }

    /// Where the left foot comes down in a clip and where it is when the avatar stands with its feet side by side, to the left and
    /// ahead of the body, m, as [`Body`] has them; `scale` is that of the body over its avatar's.
    pub fn feet_of(&self, avatar: u32, clip: u32, scale: f32) -> [u32; 2] {
        let feet_down = &self.retargeted.feet_down;
        let down = feet_down[(clip as usize).min(feet_down.len() - 1)];
        let stands = foot_stands(&self.avatars()[(avatar as usize).min(self.avatars().len() - 1)]);
        [down, stands].map(|place| Body::foot_bits(place.map(|part| scale * part)))
    }
}

impl Retargeted {
    fn new(gaits: &[Gait], avatars: Vec<Avatar>) -> Result<Self, crate::Error> {
        let numbers = 0..gaits.len() + STANDING;
        let pairs: Vec<_> = avatars.iter().flat_map(|a| numbers.clone().map(move |g| (a, g))).collect();
        let clips = pairs.into_par_iter().map(|(avatar, number)| {
            let clip = match gaits.get(number) {
                Some(gait) => retarget(gait, avatar)?,
                None => {
                    let number = number - gaits.len();
                    standing(avatar, Emotion::ALL[number / STANCES], number % STANCES)
                }
            };
            let foot_down = foot_down(avatar, &clip);
            Ok((clip, foot_down))
        });
        let clips = clips.collect::<Result<Vec<_>, crate::Error>>()?;
        let (clips, feet_down) = clips.into_iter().unzip();
        Ok(Self { gaits: gaits.to_vec(), avatars, clips, feet_down })
    }
}

/// The set of these gaits and avatars, if it is kept. It never waits: after a fork the list may be held for good.
fn kept(gaits: &[Gait], avatars: &[Avatar]) -> Option<Arc<Retargeted>> {
    find(&LAST.try_lock().ok()?, gaits, avatars)
}

fn find(sets: &[Arc<Retargeted>], gaits: &[Gait], avatars: &[Avatar]) -> Option<Arc<Retargeted>> {
    sets.iter().find(|set| set.gaits == gaits && set.avatars == avatars).cloned()
}

/// Keeps a set, in place of the oldest.
fn keep(set: &Arc<Retargeted>) {
    if let Ok(mut sets) = LAST.try_lock() {
        insert(&mut sets, set);
    }
}

fn insert(sets: &mut Vec<Arc<Retargeted>>, set: &Arc<Retargeted>) {
    sets.truncate(KEPT - 1);
    sets.insert(0, set.clone());
}

/// Most avatars in one crowd: what `FrameUniforms::standing_clips` has room for with three levels each.
pub const MAX_AVATARS: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avatar::{Sex, generated};

    fn set(gait: &str, avatar: &str) -> Arc<Retargeted> {
        let gaits = vec![Gait { name: gait.to_owned(), ..Gait::default() }];
        let avatars = vec![Avatar { name: avatar.to_owned(), ..generated(Sex::ALL[0]) }];
        Arc::new(Retargeted { gaits, avatars, clips: Vec::new(), feet_down: Vec::new() })
    }

    #[test]
    fn a_set_is_found_by_its_gaits_and_its_avatars_until_four_newer_ones_are_kept() {
        let mut sets = Vec::new();
        let first = set("calm", "tall");
        insert(&mut sets, &first);
        let is_found = |sets: &[_], wanted: &Retargeted| {
            find(sets, &wanted.gaits, &wanted.avatars).is_some_and(|set| Arc::ptr_eq(&set, &first))
        };
        assert!(is_found(&sets, &set("calm", "tall")));
        assert!(!is_found(&sets, &set("angry", "tall")));
        assert!(!is_found(&sets, &set("calm", "short")));
        for number in 1..KEPT {
            insert(&mut sets, &set(&number.to_string(), "tall"));
            assert!(is_found(&sets, &first), "after {number} more");
        }
        insert(&mut sets, &set("last", "tall"));
        assert!(!is_found(&sets, &first) && sets.len() == KEPT);
    }
}
