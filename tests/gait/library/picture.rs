//! Draws the generated walkers as stick figures into `walkers.png` in cargo's folder for test output, to be looked at.

use gaitway::Emotion;
use gaitway::gait::walker::{Sex, person};
use gaitway::gait::{Gait, JOINT_COUNT, Joint};
use glam::{Vec2, Vec3};

const CELL: usize = 150;
const SCALE: f32 = 95.0;
const STEPS: usize = 8;

struct Canvas {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Canvas {
    fn dot(&mut self, at: Vec2, radius: f32, color: [u8; 3]) {
        let reach = radius.ceil() as i32 + 1;
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (x, y) = (at.x as i32 + dx, at.y as i32 + dy);
                let inside = x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height;
                if inside && Vec2::new(x as f32, y as f32).distance(at) <= radius {
                    let i = 3 * (y as usize * self.width + x as usize);
                    self.rgb[i..i + 3].copy_from_slice(&color);
                }
            }
        }
    }

    fn line(&mut self, from: Vec2, to: Vec2, color: [u8; 3]) {
        let steps = (from.distance(to) * 2.0).ceil().max(1.0) as usize;
        for i in 0..=steps {
            self.dot(from.lerp(to, i as f32 / steps as f32), 1.4, color);
        }
    }
}

/// Left limbs are red, right ones blue, the trunk dark; the nose shows where the head points.
fn figure(canvas: &mut Canvas, gait: &Gait, frame: usize, foot: Vec2, project: impl Fn(Vec3) -> Vec2) {
    let pose = &gait.poses[frame];
    let on_canvas = |p: Vec3| foot + project(p) * Vec2::new(SCALE, -SCALE);
    for (joint, &parent) in Joint::PARENT.iter().enumerate().take(JOINT_COUNT).skip(1) {
        let color = match joint {
            4..=6 | 10..=12 => [200, 60, 50],
            7..=9 | 13..=15 => [50, 90, 200],
            _ => [40, 40, 40],
        };
        canvas.line(on_canvas(pose[parent]), on_canvas(pose[joint]), color);
    }
    let (neck, head) = (pose[Joint::Neck as usize], pose[Joint::Head as usize]);
    let up = (head - neck).normalize();
    let forward = (Vec3::Z - up * up.z).normalize();
    canvas.dot(on_canvas(head + up * 0.03), 0.105 * SCALE, [90, 90, 90]);
    canvas.line(on_canvas(head), on_canvas(head + forward * 0.15), [90, 90, 90]);
    for foot in [Joint::LeftFoot, Joint::RightFoot] {
        canvas.dot(on_canvas(pose[foot as usize]), 3.0, [20, 120, 40]);
    }
}

#[test]
fn the_walkers_can_be_looked_at() {
    let (width, height) = (CELL * (STEPS + 3), (CELL + 60) * 8);
    let mut canvas = Canvas { width, height, rgb: vec![255; width * height * 3] };
    let mut row = 0.0;
    for emotion in Emotion::ALL {
        for sex in Sex::ALL {
            let gait = person(emotion, sex, 1, 0).unwrap();
            let base = (row + 1.0) * (CELL + 60) as f32 - 20.0;
            canvas.line(Vec2::new(0.0, base + 6.0), Vec2::new(width as f32, base + 6.0), [210, 210, 210]);
            for step in 0..STEPS + 3 {
                let foot = Vec2::new((step as f32 + 0.5) * CELL as f32, base);
                if step < STEPS {
                    figure(&mut canvas, &gait, step * gait.poses.len() / STEPS, foot, |p| {
                        Vec2::new(p.z, p.y)
                    });
                } else {
                    // From the front: the walker's left is on the right of the picture.
                    figure(&mut canvas, &gait, (step - STEPS) * 12, foot, |p| Vec2::new(p.x, p.y));
                }
            }
            row += 1.0;
        }
    }
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("walkers.png");
    let file = std::fs::File::create(&path).unwrap();
    let mut encoder = png::Encoder::new(file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&canvas.rgb).unwrap();
    println!("drawn: {}", path.display());
    assert!(canvas.rgb.chunks(3).any(|pixel| pixel != [255, 255, 255]));
}
