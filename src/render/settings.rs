//! How frames are drawn.

use super::{Atmosphere, Draws};
use crate::scenario::Finish;
use glam::Vec3;
use std::str::FromStr;

/// Rings on the ground under the agents in the colour of their emotion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Markers {
    /// Radius of the ring, m.
    pub radius: f32,
    /// Width of its line, m.
    pub width: f32,
    /// Linear colour per emotion, in the order of [`crate::Emotion::ALL`].
    pub colors: [Vec3; 4],
    /// 0 invisible to 1 solid.
    pub opacity: f32,
}

impl Default for Markers {
    /// Happy yellow, angry vermilion, sad blue, neutral white: distinct with every common colour vision.
    fn default() -> Self {
        let colors = [
            Vec3::new(0.87, 0.61, 0.02),
            Vec3::new(0.66, 0.11, 0.01),
            Vec3::new(0.02, 0.17, 0.45),
            Vec3::new(0.7, 0.7, 0.7),
        ];
        Self { radius: 0.38, width: 0.09, colors, opacity: 0.9 }
    }
}

/// How both eyes are drawn; the images are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stereo {
    /// In one pass where the device has multiview.
    #[default]
    Auto,
    /// In one pass (multiview): every draw is submitted once, for both layers. Two passes where the device lacks it.
    OnePass,
    /// One eye after the other, each in a pass of its own. The bodies and the shadow map are still made once for both.
    TwoPasses,
}

/// Whether agents that are hidden behind others or behind buildings are left out. The images are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Occlusion {
    /// On, but off on a tiler ([`crate::gpu::DeviceInfo::is_tiler`]): depth is read while an image is half drawn, and a tiler has
    /// to write out all of its tiles for that.
    #[default]
    Auto,
    /// Left out, unless the device cannot read depth or draws directly ([`Draws::Direct`]).
    On,
    /// Drawn.
    Off,
}

impl Occlusion {
    /// What is done on a tiler, or another device, that draws in this way: never `Auto`. With direct draws the host would have to
    /// wait in the middle of an image for how many agents are left.
    pub(super) fn settled(self, is_tiler: bool, draws: Draws) -> Self {
        match self {
            Self::Off => Self::Off,
            _ if draws == Draws::Direct => Self::Off,
            Self::Auto if is_tiler => Self::Off,
            Self::Auto | Self::On => Self::On,
        }
    }
}

/// How much is spent on light and surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Quality {
    /// Matt surfaces of one colour each: the least time.
    #[default]
    Low,
    /// Ground and walls have a texture, glass mirrors the sky, people are soft and darken the ground they stand on.
    Medium,
    /// The same with relief, and softer shadows.
    High,
}

impl Quality {
    /// How far away bodies become coarser, as a share of where they do at high quality.
    pub(super) const fn reach(self) -> Reach {
        match self {
            Self::Low | Self::Medium => Reach { first: 0.75, second: 0.6, posed: 0.75 },
            Self::High => Reach { first: 1.0, second: 1.0, posed: 1.0 },
        }
    }

    /// The scenery that its pictures have room for.
    #[doc(hidden)]
    pub const fn finish(self) -> Finish {
        match self {
            Self::Low => Finish::Plain,
            Self::Medium | Self::High => Finish::Fine,
        }
    }
}

/// Shares of the distances at which the first two levels of bodies end, and at which bodies with a pose do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    pub(super) first: f32,
    pub(super) second: f32,
    pub(super) posed: f32,
}

/// Text that is no [`Quality`].
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("use low, medium or high")]
pub struct UnknownQuality;

impl FromStr for Quality {
    type Err = UnknownQuality;

    fn from_str(text: &str) -> Result<Self, UnknownQuality> {
        match text {
            "low" => Ok(Self::Low),
            "medium" => Ok(Self::Medium),
            "high" => Ok(Self::High),
            _ => Err(UnknownQuality),
        }
    }
}

/// How frames are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Pixels a row, per eye.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples a pixel, 1 or 4 (or what the device has, if fewer).
    pub samples: u32,
    /// 1, or 2 for both eyes in one go.
    pub eyes: u32,
    /// How both are drawn.
    pub stereo: Stereo,
    /// Whether hidden agents are left out.
    pub occlusion: Occlusion,
    /// Where the arguments of the crowd's draws come from.
    pub draws: Draws,
    /// Texels a side of the shadow map, and of the finer one that medium and high quality have near the eyes; 0 draws no shadows.
    pub shadow_size: u32,
    /// How much is spent on light and surfaces.
    pub quality: Quality,
    /// Sun, sky and haze.
    pub atmosphere: Atmosphere,
    /// Rings under the agents, if wanted.
    pub markers: Option<Markers>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 4,
            eyes: 1,
            stereo: Stereo::Auto,
            occlusion: Occlusion::Auto,
            draws: Draws::Auto,
            shadow_size: 2048,
            quality: Quality::Low,
            atmosphere: Atmosphere::DAY,
            markers: None,
        }
    }
}

impl Settings {
    /// The defaults in another size.
    pub fn sized(width: u32, height: u32) -> Self {
        Self { width, height, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn qualities_are_read_and_wrong_ones_refused_with_the_way_out() {
        assert_eq!(
            ["low", "medium", "high"].map(str::parse),
            [Ok(Quality::Low), Ok(Quality::Medium), Ok(Quality::High)]
        );
        assert_eq!("best".parse::<Quality>().unwrap_err().to_string(), "use low, medium or high");
        assert!(Settings::default().quality == Quality::Low && Quality::Low < Quality::High);
    }

    #[test]
    fn hidden_people_are_drawn_on_a_tiler_unless_they_are_asked_to_be_left_out() {
        use Occlusion::{Auto, Off, On};
        let settled = |is_tiler, draws| [Auto, On, Off].map(|wanted| wanted.settled(is_tiler, draws));
        assert_eq!(settled(false, Draws::Indirect), [On, On, Off]);
        assert_eq!(settled(true, Draws::Indirect), [Off, On, Off]);
        for is_tiler in [false, true] {
            assert_eq!(settled(is_tiler, Draws::Direct), [Off; 3]);
        }
    }
}
