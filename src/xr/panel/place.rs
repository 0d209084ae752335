//! Where a panel stands in the room, what rays meet of it, and how eyes see it.

use super::super::views::Pose;
use super::{HEIGHT, WIDTH};
use crate::picture::Image;
use glam::{Mat3, Mat4, Quat, Vec2, Vec3};

/// How far before the eyes the middle of the panel is, m.
pub(in super::super) const DISTANCE: f32 = 1.5;
/// How far below them, degrees.
const BELOW: f32 = 10.0;
/// A millimetre, m.
const PIXEL: f32 = 1e-3;

/// Width and height of the panel, m.
#[allow(clippy::cast_precision_loss, reason = "a thousand pixels")]
pub(in super::super) const SIZE: Vec2 = Vec2::new(WIDTH as f32 * PIXEL, HEIGHT as f32 * PIXEL);

/// Where a panel stands for a user whose head is there: before and below the eyes, upright but for a tilt towards them. Its
/// -z points away from the user, as that of a view does.
pub(in super::super) fn before(head: Pose) -> Pose {
    let ahead = head.rotation * Vec3::NEG_Z;
    // a user who looks straight down faces where the top of the head points
    let ahead = if ahead.y.abs() < 0.95 { ahead } else { head.rotation * (Vec3::Y * -ahead.y.signum()) };
    let turn = Quat::from_rotation_y((-ahead.x).atan2(-ahead.z));
    let rotation = turn * Quat::from_rotation_x(-BELOW.to_radians());
    Pose { rotation, position: head.position + rotation * (Vec3::NEG_Z * DISTANCE) }
}

/// The place on a panel, pixels, that a ray from a pose along its -z meets.
pub(in super::super) fn hit(panel: Pose, ray: Pose) -> Option<[f32; 2]> {
    let back = panel.rotation.inverse();
    let (from, along) = (back * (ray.position - panel.position), back * (ray.rotation * Vec3::NEG_Z));
    // the panel has one face
    let away = -from.z / along.z;
    let at = from + along * away;
    let is_met = from.z > 0.0 && along.z < -1e-4 && at.is_finite();
    is_met.then(|| [(at.x + 0.5 * SIZE.x) / PIXEL, (0.5 * SIZE.y - at.y) / PIXEL])
}

/// The place in the room of a place on the panel, pixels; a little before its face.
pub(in super::super) fn place(panel: Pose, [x, y]: [f32; 2]) -> Pose {
    let at = Vec3::new(x * PIXEL - 0.5 * SIZE.x, 0.5 * SIZE.y - y * PIXEL, 0.004);
    Pose { rotation: panel.rotation, position: panel.position + panel.rotation * at }
}

/// A rectangle of the room with a picture on it.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Quad {
    /// In the world.
    pub(in super::super) pose: Pose,
    /// Width and height, m.
    pub(in super::super) size: Vec2,
    /// Its part of the picture: left, top, width, height.
    pub(in super::super) part: [u32; 4],
}

/// A part of an image that shows what an eye sees.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct EyeImage {
    /// Left edge in the image, its width and height, pixels.
    pub(in super::super) left: u32,
    pub(in super::super) size: [u32; 2],
    /// Clip from world space.
    pub(in super::super) clip: Mat4,
}

/// Draws a rectangle over what an eye sees, as a compositor does: nothing lies before it.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pixels of images, cut to their bounds"
)]
pub(in super::super) fn paste(image: &mut Image, eye: &EyeImage, quad: &Quad, picture: &Image) {
    // columns: half a width to the right, half a height up, the middle
    let Pose { rotation, position } = quad.pose;
    let clip = |v: Vec3, w: f32| eye.clip * v.extend(w);
    let (right, up) = (rotation * Vec3::X * 0.5 * quad.size.x, rotation * Vec3::Y * 0.5 * quad.size.y);
    let columns = [clip(right, 0.0), clip(up, 0.0), clip(position, 1.0)];
    let clip_from_quad = Mat3::from_cols_array_2d(&columns.map(|c| [c.x, c.y, c.w]));
    let quad_from_clip = clip_from_quad.inverse();
    if !quad_from_clip.is_finite() {
        return;
    }
    let [width, height] = eye.size;
    let [part_left, part_top, part_width, part_height] = quad.part;
    let sample = |x: f32, y: f32| {
        let at = quad_from_clip * Vec3::new(2.0 * x / width as f32 - 1.0, 2.0 * y / height as f32 - 1.0, 1.0);
        let (u, v) = (at.x / at.z, at.y / at.z);
        // before the eye, and on the rectangle
        let is_there = at.z > 0.0 && u.abs() < 1.0 && v.abs() < 1.0;
        is_there.then(|| {
            let column = (0.5 * (u + 1.0) * part_width as f32) as u32;
            let row = (0.5 * (1.0 - v) * part_height as f32) as u32;
            picture.pixel(part_left + column.min(part_width - 1), part_top + row.min(part_height - 1))
        })?
    };
    const SAMPLES: [f32; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];
    let places = SAMPLES.map(|x| SAMPLES.map(|y| [x, y])).concat();
    for y in 0..height {
        for x in 0..width {
            let Some(under) = image.pixel(eye.left + x, y) else { continue };
            let mut sum = [0.0_f32; 3];
            let mut is_covered = false;
            for [dx, dy] in &places {
                let over = sample(x as f32 + dx, y as f32 + dy);
                is_covered |= over.is_some();
                let [.., alpha] = over.unwrap_or_default();
                let (over, share) = (over.unwrap_or_default(), f32::from(alpha) / 255.0);
                for (channel, sum) in sum.iter_mut().enumerate() {
                    *sum += f32::from(over[channel]) * share + f32::from(under[channel]) * (1.0 - share);
                }
            }
            if is_covered {
                let [r, g, b] = sum.map(|sum| (sum / places.len() as f32).round() as u8);
                image.set(eye.left + x, y, [r, g, b, 255]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Camera, View};

    fn head(turn: f32, pitch: f32, position: Vec3) -> Pose {
        Pose { rotation: Quat::from_rotation_y(turn) * Quat::from_rotation_x(pitch), position }
    }

    #[test]
    fn a_panel_stands_before_and_below_the_eyes_and_faces_them() {
        for (turn, pitch) in [(0.0, 0.0), (2.0, 0.4), (-1.0, -0.9), (3.0, -1.5), (0.5, 1.5)] {
            let eyes = head(turn, pitch, Vec3::new(1.0, 1.6, -2.0));
            let panel = before(eyes);
            let away = panel.position - eyes.position;
            assert!((away.length() - DISTANCE).abs() < 1e-5);
            assert!((away.y / DISTANCE + BELOW.to_radians().sin()).abs() < 1e-5);
            let flat = Vec3::new(-turn.sin(), 0.0, -turn.cos());
            assert!((Vec3::new(away.x, 0.0, away.z).normalize() - flat).length() < 1e-4, "{turn} {pitch}");
            // its normal points to the eyes, its sides are level
            assert!((panel.rotation * Vec3::Z + away / DISTANCE).length() < 1e-5);
            assert!((panel.rotation * Vec3::X).y.abs() < 1e-6);
        }
    }

    #[test]
    fn a_ray_meets_the_pixel_it_points_at_and_none_behind() {
        let eyes = head(0.7, 0.0, Vec3::new(0.3, 1.6, 0.0));
        let panel = before(eyes);
        let middle = [0.5 * WIDTH as f32, 0.5 * HEIGHT as f32];
        for pixel in [middle, [0.5, 0.5], [WIDTH as f32 - 3.0, 900.0]] {
            let to = place(panel, pixel).position - eyes.position;
            let ray = Pose { rotation: Quat::from_rotation_arc(Vec3::NEG_Z, to.normalize()), ..eyes };
            let found = hit(panel, ray).unwrap_or_default();
            assert!((Vec2::from(found) - Vec2::from(pixel)).length() < 3.0, "{found:?} {pixel:?}");
            let away = Pose { rotation: Quat::from_rotation_arc(Vec3::Z, to.normalize()), ..eyes };
            assert_eq!(hit(panel, away), None);
            let behind = Pose { position: eyes.position + 2.0 * to, ..ray };
            assert_eq!(hit(panel, behind), None);
        }
    }

    #[test]
    fn a_pasted_rectangle_is_where_the_eye_sees_it() {
        let camera = Camera::user_eyes(Vec3::new(0.0, 1.6, 0.0), 0.0, 0.0);
        let view = View::mono(&camera, 200, 200);
        // a user who faces +z; two metres away, half a metre wide
        let pose = Pose {
            rotation: Quat::from_rotation_y(std::f32::consts::PI),
            position: Vec3::new(0.5, 1.6, 2.0),
        };
        let mut picture = Image::filled(4, 2, [200, 0, 0, 255]);
        picture.fill(2, 0, 2, 2, [0, 0, 200, 255]);
        let quad = Quad { pose, size: Vec2::new(0.5, 0.5), part: [0, 0, 4, 2] };
        let mut image = Image::filled(400, 200, [9; 4]);
        let eye = EyeImage { left: 200, size: [200, 200], clip: view.clip_from_world[0] };
        paste(&mut image, &eye, &quad, &picture);
        // +x of the world is to the left for one who faces +z
        let at = |x: f32| {
            let clip = view.clip_from_world[0].project_point3(Vec3::new(x, 1.6, 2.0));
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
            let column = (0.5 * (clip.x + 1.0) * 200.0).round() as u32;
            image.pixel(200 + column, 100).unwrap_or_default()
        };
        assert_eq!((at(0.6), at(0.4)), ([200, 0, 0, 255], [0, 0, 200, 255]));
        assert_eq!((at(0.8), at(0.2), image.pixel(100, 100)), ([9; 4], [9; 4], Some([9; 4])));
        // behind the eye there is nothing
        let mut bare = Image::filled(400, 200, [9; 4]);
        let behind = Quad { pose: Pose { position: Vec3::new(0.5, 1.6, -2.0), ..pose }, ..quad };
        paste(&mut bare, &eye, &behind, &picture);
        assert_eq!(bare, Image::filled(400, 200, [9; 4]));
    }
}
