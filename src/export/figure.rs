//! One walking figure, as raters see it (S-03): it walks towards a camera in front of it, always the same one.
//!
//! Neither colours, surroundings nor names hint at the emotion. Stripes on the ground pass at the gait's speed. Drawing needs
//! no device. Clips and the pages of a study draw from the same constants.

use crate::gait::{Gait, Joint, Pose};
use crate::picture::Image;
use glam::{Vec2, Vec3};

/// Width and height, pixels.
pub const SIZE: (u32, u32) = (256, 384);
/// The camera stands here and looks along -z, m.
pub const CAMERA: Vec3 = Vec3::new(0.0, 1.1, 4.0);
/// Pixels of a metre at a metre's distance.
pub const FOCUS: f32 = 632.0;
/// Where the camera looks, pixels from the top left corner.
pub const CENTRE: Vec2 = Vec2::new(128.0, 176.0);
/// What is nearer to the camera than this is drawn as if it were here, m.
pub const NEAREST: f32 = 0.1;
/// Between two stripes on the ground, m.
pub const STRIPES: f32 = 0.6;
/// The first and the last stripe: this many times [`STRIPES`] in front of the figure.
pub const STRIPE_RANGE: [i16; 2] = [-12, 4];
/// Half of a stripe's length, m.
pub const STRIPE_HALF: f32 = 3.0;
/// Thickness of a stripe, m.
pub const STRIPE_THICK: f32 = 0.02;
/// Colour behind everything.
pub const PAPER: [u8; 4] = [240, 240, 238, 255];
/// Colour of stripes.
pub const GROUND: [u8; 4] = [206, 206, 202, 255];
/// Colours of the nearest and the farthest part of the body.
pub const BODY: [[f32; 3]; 2] = [[44.0, 48.0, 58.0], [122.0, 126.0, 136.0]];
/// Sum of the depths of a limb's ends between the middle of the body and its nearest part, m, twice.
pub const BODY_DEPTH: f32 = 0.8;
/// Thickness of limbs and of the head, m.
pub const THICK: [f32; 2] = [0.07, 0.2];

/// Pixels of a point, and of a metre at its distance.
fn project(point: Vec3) -> (Vec2, f32) {
    let away = CAMERA - point;
    let metre = FOCUS / away.z.max(NEAREST);
    (CENTRE + Vec2::new(-away.x, away.y) * metre, metre)
}

/// The gait `time` seconds after the left foot struck.
pub fn picture(gait: &Gait, time: f32) -> Image {
    let mut image = Image::filled(SIZE.0, SIZE.1, PAPER);
    for stripe in STRIPE_RANGE[0]..=STRIPE_RANGE[1] {
        // The walker walks towards the camera; on the spot, the ground goes away from it.
        let z = f32::from(stripe) * STRIPES - (gait.speed * time) % STRIPES;
        let (a, metre) = project(Vec3::new(-STRIPE_HALF, 0.0, z));
        let (b, _) = project(Vec3::new(STRIPE_HALF, 0.0, z));
        line(&mut image, [a, b], STRIPE_THICK * metre, GROUND);
    }
    let pose = pose_at(gait, time);
    let mut joints = Joint::ALL;
    // What is farther away first.
    let depth = |joint: Joint| pose[joint as usize].z + pose[Joint::PARENT[joint as usize]].z;
    joints.sort_by(|a, b| depth(*a).total_cmp(&depth(*b)));
    for joint in joints {
        let [from, to] = [Joint::PARENT[joint as usize], joint as usize].map(|index| project(pose[index]));
        let share = (0.5 - 0.5 * depth(joint) / BODY_DEPTH).clamp(0.0, 1.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two bytes")]
        let [r, g, b] = std::array::from_fn(|c| (BODY[0][c] + (BODY[1][c] - BODY[0][c]) * share) as u8);
        line(&mut image, [from.0, to.0], THICK[0] * to.1, [r, g, b, 255]);
        if joint == Joint::Head {
            line(&mut image, [to.0, to.0], THICK[1] * to.1, [r, g, b, 255]);
        }
    }
    image
}

/// The pose at a time, s, between the frames.
pub fn pose_at(gait: &Gait, time: f32) -> Pose {
    let place = time * gait.frame_rate;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred frames")]
    let frame = place as usize;
    let [now, next] = [frame, frame + 1].map(|frame| gait.poses[frame % gait.poses.len()]);
    std::array::from_fn(|joint| now[joint].lerp(next[joint], place.fract()))
}

/// A line with round ends, `width` pixels wide, smooth at its edge.
pub fn line(image: &mut Image, [a, b]: [Vec2; 2], width: f32, color: [u8; 4]) {
    let (low, high) = (a.min(b) - width, a.max(b) + width);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture")]
    let range = |from: f32, to: f32, end: u32| (from.max(0.0) as u32)..(to.max(0.0).ceil() as u32).min(end);
    for y in range(low.y, high.y, image.height) {
        for x in range(low.x, high.x, image.width) {
            #[allow(clippy::cast_precision_loss, reason = "a small picture")]
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let along = b - a;
            let t = ((at - a).dot(along) / along.length_squared().max(1e-9)).clamp(0.0, 1.0);
            let cover = (0.5 * width + 0.5 - at.distance(a + along * t)).clamp(0.0, 1.0);
            if let Some(under) = image.pixel(x, y).filter(|_| cover > 0.0) {
                let mix = |channel: usize| {
                    let (from, to) = (f32::from(under[channel]), f32::from(color[channel]));
                    #[allow(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "between two bytes"
                    )]
                    let mixed = (from + (to - from) * cover).round() as u8;
                    mixed
                };
                image.set(x, y, [mix(0), mix(1), mix(2), 255]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker::{Sex, person};

    #[test]
    fn a_walker_fills_the_picture_and_moves() {
        let gait = person(Emotion::Happy, Sex::Male, 1, 0).unwrap();
        let dark = |image: &Image| {
            let of = |y: u32| (0..SIZE.0).filter(|&x| image.pixel(x, y).is_some_and(|p| p[0] < 130)).count();
            (0..SIZE.1).map(of).collect::<Vec<_>>()
        };
        let [first, later] = [0.0, 0.25].map(|time| picture(&gait, time));
        let rows = dark(&first);
        let top = rows.iter().position(|&count| count > 3).unwrap();
        let bottom = rows.iter().rposition(|&count| count > 3).unwrap();
        assert!((20..120).contains(&top) && (330..384).contains(&bottom), "{top} to {bottom}");
        assert_ne!(first, later);
    }
}
