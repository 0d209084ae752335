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

/// Clips in which an avatar stands: `[emotion][stance]`.
const STANDING: usize = Emotion::ALL.len() * STANCES;

/// Avatars and clips. Clips stand in the order `[avatar][gait]`, each avatar's standing clips after its gaits.
#[derive(Debug, Clone)]
pub struct AvatarSet {
    avatars: Vec<Avatar>,
    clips: Vec<Clip>,
    feet_down: Vec<[f32; 2]>,
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
        let outsiders = ExternalBodies::default();
        let names = gaits.iter().map(|gait| gait.name.clone()).collect();
        Ok(Self { avatars, clips, feet_down, clips_per_avatar, gaits: names, outsiders })
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

    /// Where the left foot comes down in a clip and where it is when the avatar stands with its feet side by side, to the left and
    /// ahead of the body, m, as [`Body`] has them; `scale` is that of the body over its avatar's.
    pub fn feet_of(&self, avatar: u32, clip: u32, scale: f32) -> [u32; 2] {
        let down = self.feet_down[(clip as usize).min(self.feet_down.len() - 1)];
        let stands = foot_stands(&self.avatars[(avatar as usize).min(self.avatars.len() - 1)]);
        [down, stands].map(|place| Body::foot_bits(place.map(|part| scale * part)))
    }
}

/// Most avatars in one crowd: what `FrameUniforms::standing_clips` has room for with three levels each.
pub const MAX_AVATARS: usize = 5;
