//! Direct draws show what indirect ones show, as people come and go from one frame to the next.

use super::far::crossing_as;
use crate::common::gpu;
use gaitway::render::camera::{Camera, View};
use gaitway::render::{Draws, Image, Markers, Occlusion, Settings, Stereo};
use glam::Vec3;

const W: u32 = 200;
const H: u32 = 120;

/// Pictures of a crowd while it walks and its user turns and rises; none without a device.
fn pictures(settings: Settings) -> Option<Vec<Image>> {
    let (mut simulation, mut show, user) = crossing_as(1_200, settings)?;
    let settled = *show.renderer().settings();
    assert_eq!(settled.draws, settings.draws);
    let leaves_out = settings.draws == Draws::Indirect;
    assert_eq!(settled.occlusion, if leaves_out { Occlusion::On } else { Occlusion::Off });
    let picture = |number: u8| {
        let turned = f32::from(number);
        let eyes = user + Vec3::new(turned, 0.4 * turned * turned, 0.0);
        let camera = Camera::user_eyes(eyes, 1.1 * turned, -0.1 * turned).with_fov(1.2);
        let view = match settings.eyes {
            2 => View::stereo(&camera, 0.063, W, H),
            _ => View::mono(&camera, W, H),
        };
        simulation.step(5).unwrap();
        show.draw(&mut simulation, &view, user).unwrap()
    };
    Some((0..4).map(picture).collect())
}

#[test]
fn direct_draws_show_the_same_people_while_crowd_and_eyes_move() {
    let ways = [(4, 1, Stereo::Auto), (1, 1, Stereo::Auto), (4, 2, Stereo::Auto), (4, 2, Stereo::TwoPasses)];
    for (samples, eyes, stereo) in ways {
        let drawn = |draws| {
            let occlusion = Occlusion::On;
            let markers = Some(Markers::default());
            let settings =
                Settings { samples, eyes, stereo, occlusion, draws, markers, ..Settings::sized(W, H) };
            pictures(settings)
        };
        let (Some(direct), Some(indirect)) = (drawn(Draws::Direct), drawn(Draws::Indirect)) else { return };
        for (number, (direct, indirect)) in direct.iter().zip(&indirect).enumerate() {
            assert!(direct == indirect, "{samples} samples, {eyes} eyes, {stereo:?}, picture {number}");
        }
    }
    gpu::assert_silent();
}
