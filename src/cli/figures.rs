//! Sheets of stick figures: gaits drawn without any device.

use crate::export;
use crate::export::figure::line;
use crate::export::image::{Tile, contact_sheet};
use crate::gait::{Gait, JOINT_COUNT, Joint, Pose};
use crate::picture::Image;
use glam::{Vec2, Vec3};

/// Pixels of a tile.
const TILE: (u32, u32) = (132, 196);
/// Figures a row from the side, at equal steps of phase; one from the front stands behind them.
const PHASES: usize = 8;
/// Pixels per metre.
const SCALE: f32 = 92.0;
const PAPER: [u8; 4] = [246, 244, 239, 255];
const GROUND: [u8; 4] = [205, 200, 190, 255];
const MIDDLE: [u8; 4] = [60, 60, 66, 255];
const LEFT: [u8; 4] = [196, 78, 40, 255];
const RIGHT: [u8; 4] = [36, 96, 158, 255];

/// One row per gait: phases from the left (it walks to the right), then the first phase from the front.
///
/// The left limbs are red, the right ones blue.
pub(super) fn sheet(gaits: &[Gait]) -> Result<Image, export::Error> {
    let mut pictures = Vec::new();
    for gait in gaits {
        for phase in 0..PHASES {
            let Some(pose) = gait.poses.get(phase * gait.poses.len() / PHASES) else { continue };
            // seen from the walker's right: +z to the right
            pictures.push((caption(gait, phase), figure(pose, |p| Vec2::new(p.z, p.y))));
        }
        if let Some(pose) = gait.poses.first() {
            pictures.push(("front".to_owned(), figure(pose, |p| Vec2::new(p.x, p.y))));
        }
    }
    let tiles: Vec<Tile<'_>> = pictures.iter().map(|(caption, image)| Tile { caption, image }).collect();
    Ok(contact_sheet(&tiles, u32::try_from(PHASES + 1).unwrap_or(1))?)
}

fn caption(gait: &Gait, phase: usize) -> String {
    if phase > 0 { format!("{phase}/{PHASES}") } else { gait.name.clone() }
}

/// One pose, projected by `flat` to metres right and up.
fn figure(pose: &Pose, flat: impl Fn(Vec3) -> Vec2) -> Image {
    let mut image = Image::filled(TILE.0, TILE.1, PAPER);
    #[allow(clippy::cast_precision_loss, reason = "a small tile")]
    let (middle, ground) = (TILE.0 as f32 * 0.5, TILE.1 as f32 - 12.0);
    let pixel = |p: Vec3| {
        let p = flat(p);
        Vec2::new(middle + p.x * SCALE, ground - p.y * SCALE)
    };
    line(&mut image, [Vec2::new(0.0, ground + 3.0), Vec2::new(middle * 2.0, ground + 3.0)], 1.5, GROUND);
    // what is farther away first: the right side is near when seen from the right
    let order = |joint: &Joint| if joint.name().starts_with("left") { 0 } else { 1 };
    let mut joints = Joint::ALL;
    joints.sort_by_key(order);
    for joint in joints {
        let (index, parent) = (joint as usize, Joint::PARENT[joint as usize]);
        debug_assert!(index < JOINT_COUNT, "a joint is an index of a pose");
        let color = match joint.name() {
            name if name.starts_with("left") => LEFT,
            name if name.starts_with("right") => RIGHT,
            _ => MIDDLE,
        };
        line(&mut image, [pixel(pose[parent]), pixel(pose[index])], 4.0, color);
        if joint == Joint::Head {
            let at = pixel(pose[index]);
            line(&mut image, [at, at], 17.0, MIDDLE);
        }
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker::{Sex, person};

    #[test]
    fn a_sheet_shows_both_sides_of_a_walker() {
        let gait = person(Emotion::Sad, Sex::Male, 1, 0).unwrap();
        let sheet = sheet(&[gait]).unwrap();
        assert!(sheet.width > 9 * TILE.0 && sheet.height >= TILE.1);
        for color in [LEFT, RIGHT, MIDDLE] {
            let count = sheet.pixels.chunks_exact(4).filter(|pixel| **pixel == color).count();
            assert!(count > 500, "{count} pixels of {color:?}");
        }
    }
}
