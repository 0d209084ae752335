//! Sun, sky and haze.

use glam::Vec3;

/// Light and air of a scene. Colours are linear; 1 is what the exposure maps to a bright surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atmosphere {
    /// Direction towards the sun, world frame; need not be unit.
    pub sun_direction: Vec3,
    /// Light of the sun on a surface that faces it.
    pub sun: Vec3,
    /// Colour of the sky overhead.
    pub zenith: Vec3,
    /// Colour of the sky at the horizon, and of the haze.
    pub horizon: Vec3,
    /// Light that the ground throws back onto surfaces that face down.
    pub ground_bounce: Vec3,
    /// Light of the sky on surfaces that face up.
    pub sky_light: Vec3,
    /// Share of light lost per metre of air, 1/m; 0.004 blurs a street's end.
    pub haze: f32,
    /// Brightness of the image, 1 as is.
    pub exposure: f32,
}

impl Atmosphere {
    /// A clear late morning.
    pub const DAY: Self = Self {
        sun_direction: Vec3::new(0.55, 0.8, 0.4),
        sun: Vec3::new(1.15, 1.05, 0.88),
        zenith: Vec3::new(0.13, 0.3, 0.62),
        horizon: Vec3::new(0.58, 0.7, 0.82),
        ground_bounce: Vec3::new(0.16, 0.15, 0.135),
        sky_light: Vec3::new(0.23, 0.28, 0.35),
        haze: 0.002,
        exposure: 0.95,
    };

    /// Under clouds: soft, hardly a shadow.
    pub const OVERCAST: Self = Self {
        sun_direction: Vec3::new(0.3, 0.9, 0.3),
        sun: Vec3::new(0.3, 0.3, 0.3),
        zenith: Vec3::new(0.5, 0.53, 0.57),
        horizon: Vec3::new(0.66, 0.68, 0.7),
        ground_bounce: Vec3::new(0.22, 0.21, 0.2),
        sky_light: Vec3::new(0.52, 0.54, 0.57),
        haze: 0.006,
        exposure: 0.95,
    };

    /// A low, warm sun.
    pub const EVENING: Self = Self {
        sun_direction: Vec3::new(0.8, 0.33, -0.5),
        sun: Vec3::new(1.15, 0.66, 0.36),
        zenith: Vec3::new(0.12, 0.17, 0.36),
        horizon: Vec3::new(0.78, 0.5, 0.36),
        ground_bounce: Vec3::new(0.14, 0.11, 0.1),
        sky_light: Vec3::new(0.24, 0.22, 0.3),
        haze: 0.005,
        exposure: 1.0,
    };
}

impl Default for Atmosphere {
    fn default() -> Self {
        Self::DAY
    }
}
