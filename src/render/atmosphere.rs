//! Sun, sky and haze.

use glam::{Quat, Vec3};

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
    /// Share of their light with which lamps burn behind windows, 0 to 1.
    pub lamps: f32,
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
        lamps: 0.0,
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
        lamps: 0.0,
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
        lamps: 0.0,
    };
}

/// The hour at which a place has its own light.
const NOON: f32 = 12.0;
/// Angle by which the sun goes on in an hour, radians.
const HOUR_ANGLE: f32 = std::f32::consts::TAU / 24.0;
/// Least sine of the sun's height: at the horizon the shadow map would have nothing to see.
const LOWEST: f32 = 0.05;
/// Share of its height at noon from which on the sun is white.
const WHITE: f32 = 0.6;
/// Share of its height at noon from which on lamps are lit, and that below which all are.
const DUSK: [f32; 2] = [0.3, 0.22];

impl Atmosphere {
    /// This light, which is that of noon, at another hour from 6 to 18: the sun goes round and sinks, and what is near the horizon
    /// turns red and dim; then lamps are lit. Hours beyond are those two.
    #[must_use]
    pub fn at_hour(self, hour: f32) -> Self {
        let angle = (hour.clamp(6.0, 18.0) - NOON) * HOUR_ANGLE;
        if angle == 0.0 {
            return self;
        }
        let noon = self.sun_direction.try_normalize().unwrap_or(Vec3::Y);
        let height = (noon.y * angle.cos()).max(LOWEST);
        let flat = Vec3::new(noon.x, 0.0, noon.z).try_normalize().unwrap_or(Vec3::X);
        let aside = Quat::from_rotation_y(-angle) * flat * (1.0 - height * height).sqrt();
        let share = (angle.cos() / WHITE).clamp(0.0, 1.0);
        let white = share * share * (3.0 - 2.0 * share);
        let [begins, all_burn] = DUSK;
        let toward = |color: Vec3, red: f32, green: f32, blue: f32| {
            color * Vec3::new(red, green, blue).lerp(Vec3::ONE, white)
        };
        Self {
            sun_direction: aside.with_y(height),
            sun: toward(self.sun, 0.75, 0.36, 0.16),
            zenith: toward(self.zenith, 0.8, 0.55, 0.55),
            horizon: toward(self.horizon, 1.2, 0.66, 0.42),
            ground_bounce: toward(self.ground_bounce, 0.7, 0.55, 0.5),
            sky_light: toward(self.sky_light, 0.9, 0.65, 0.65),
            lamps: self.lamps.max(((begins - angle.cos()) / (begins - all_burn)).clamp(0.0, 1.0)),
            ..self
        }
    }
}

impl Default for Atmosphere {
    fn default() -> Self {
        Self::DAY
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "noon is left as it is")]
mod tests {
    use super::*;

    #[test]
    fn noon_is_the_light_itself_and_the_sun_sinks_and_reddens_to_either_side() {
        assert_eq!(Atmosphere::DAY.at_hour(12.0), Atmosphere::DAY);
        let height = |hour: f32| Atmosphere::DAY.at_hour(hour).sun_direction.normalize().y;
        assert!(height(11.9) > height(15.0) && height(15.0) > height(17.5) && height(18.0) > 0.0);
        assert!((height(9.0) - height(15.0)).abs() < 1e-5);
        let evening = Atmosphere::DAY.at_hour(18.0);
        assert!(evening.sun.x / evening.sun.z > 2.0 * Atmosphere::DAY.sun.x / Atmosphere::DAY.sun.z);
        let [morning, noon] = [6.0, 12.0].map(|hour| Atmosphere::DAY.at_hour(hour).sun_direction);
        assert!(morning.with_y(0.0).dot(noon.with_y(0.0)).abs() < 1e-2, "a quarter turn");
        assert_eq!(Atmosphere::DAY.at_hour(25.0), evening);
        let lamps = |hour: f32| Atmosphere::DAY.at_hour(hour).lamps;
        assert_eq!([lamps(12.0), lamps(16.5), lamps(17.5), lamps(18.0)], [0.0, 0.0, 1.0, 1.0]);
        assert!(0.0 < lamps(17.0) && lamps(17.0) < 1.0 && (lamps(7.0) - lamps(17.0)).abs() < 1e-5);
    }
}
