//! The avatars of a crowd, and every gait retargeted onto each of them.

use super::Error;
use crate::avatar::{Avatar, Clip, retarget, standing};
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::kernels::shared::standing::index::STANCES;
use crate::scenario::ExternalBodies;
use rayon::prelude::*;

/// Clips in which an avatar stands: `[emotion][stance]`.
const STANDING: usize = Emotion::ALL.len() * STANCES;

/// Avatars and clips. Clips stand in the order `[avatar][gait]`, each avatar's standing clips after its gaits.
#[derive(Debug, Clone)]
pub struct AvatarSet {
    avatars: Vec<Avatar>,
    clips: Vec<Clip>,
    clips_per_avatar: usize,
    gaits: Vec<String>,
    outsiders: ExternalBodies,
}

impl AvatarSet {
    /// Retargets `gaits` onto every avatar, in parallel.
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
        let clips_per_avatar = gaits.len() + STANDING;
        let pairs: Vec<_> = avatars.iter().flat_map(|a| (0..clips_per_avatar).map(move |g| (a, g))).collect();
        let clips = pairs.into_par_iter().map(|(avatar, number)| match gaits.get(number) {
            Some(gait) => retarget(gait, avatar),
            None => {
                let number = number - gaits.len();
                Ok(standing(avatar, Emotion::ALL[number / STANCES], number % STANCES))
            }
        });
        let clips = clips.collect::<Result<Vec<_>, _>>()?;
        let outsiders = ExternalBodies::default();
        let names = gaits.iter().map(|gait| gait.name.clone()).collect();
        Ok(Self { avatars, clips, clips_per_avatar, gaits: names, outsiders })
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
        &self.avatars
    }

    /// How many gaits there are.
    pub const fn gait_count(&self) -> usize {
        self.gaits.len()
    }

    /// The name of a gait, by index.
    pub fn gait_name(&self, gait: u32) -> Option<&str> {
        self.gaits.get(gait as usize).map(String::as_str)
    }

    /// All clips.
    pub fn clips(&self) -> &[Clip] {
        &self.clips
    }

    /// Index of the clip of a gait on an avatar, both by index; out of range: the last standing clip, of the last avatar.
    pub fn clip_index(&self, avatar: u32, gait: u32) -> u32 {
        let avatar = (avatar as usize).min(self.avatars.len() - 1);
        let gait = (gait as usize).min(self.clips_per_avatar - 1);
        (avatar * self.clips_per_avatar + gait) as u32
    }

    /// Index of the first clip in which an avatar stands. Those of an emotion follow those of the emotion before.
    pub fn standing_index(&self, avatar: u32) -> u32 {
        self.clip_index(avatar, self.gaits.len() as u32)
    }

    /// A clip by index.
    pub fn clip(&self, index: u32) -> &Clip {
        &self.clips[(index as usize).min(self.clips.len() - 1)]
    }
}

/// Most avatars in one crowd: what `FrameUniforms::standing_clips` has room for with three levels each.
pub const MAX_AVATARS: usize = 5;
