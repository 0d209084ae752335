//! Glass, robots and vehicles, and where shadows begin.

use crate::common::gpu;
use crate::support::*;
use gaitway::avatar::{Avatar, Material, Vertex};
use gaitway::ground::ABSENT;
use gaitway::render::camera::{Camera, View};
use gaitway::render::pack::OutsiderMesh;
use gaitway::render::{Atmosphere, Image, Renderer, Settings, Stereo};
use gaitway::scenario::EnvironmentMesh;
use glam::{Vec2, Vec3};

const SHIRT: [u32; 4] = [0xc0_8060, 0x20_2020, 0x20_20b0, 0x20_20b0];

/// A person of boxes with a red pane before the chest.
fn paned(alpha: f32) -> Avatar {
    let mut body = box_person();
    let mesh = &mut body.levels[0];
    let first = mesh.vertices.len() as u32;
    for (x, y) in [(-0.2, 0.9), (0.2, 0.9), (0.2, 1.3), (-0.2, 1.3)] {
        mesh.vertices.push(Vertex {
            position: Vec3::new(x, y, 0.2),
            normal: Vec3::Z,
            color: Vec3::new(0.4, 0.0, 0.0),
            alpha,
            material: Material::Fixed,
            joints: [1; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
        });
    }
    mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    body
}

/// Mean linear red and blue of 16 by 16 pixels about a point.
fn patch(image: &Image, view: &View, point: Vec3) -> [f32; 2] {
    let middle = view.pixel_from_world(0, point, W, H).unwrap();
    let mut sum = [0.0; 2];
    for i in 0..256_u32 {
        let (x, y) = (middle.x as u32 + i % 16 - 8, middle.y as u32 + i / 16 - 8);
        let pixel = image.pixel(x, y).unwrap();
        for (sum, channel) in sum.iter_mut().zip([pixel[0], pixel[2]]) {
            let s = f32::from(channel) / 255.0;
            *sum += if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) } / 256.0;
        }
    }
    sum
}

#[test]
fn glass_lets_through_what_its_alpha_says_with_one_sample_and_with_four() {
    let Some(device) = device() else { return };
    let view = View::mono(&Camera::look_at(Vec3::new(0.0, 1.1, 2.0), Vec3::Y * 1.1, Vec3::Y), W, H);
    for samples in [1, 4] {
        let settings = Settings { samples, atmosphere: flat(), ..Settings::sized(W, H) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        let mut seen = |alpha| {
            let made = HandMade::of(&device, &paned(alpha), &[(Vec2::ZERO, true)], &[SHIRT], &[0]);
            renderer.set_meshes(&made.meshes).unwrap();
            let image = renderer.draw(&view, Some(&made.crowd())).unwrap();
            keep(&format!("glass{samples}-{alpha}"), &image);
            patch(&image, &view, Vec3::new(0.0, 1.1, 0.2))
        };
        let (none, all) = (seen(0.0), seen(1.0));
        assert!(all[0] > none[0] + 0.2 && none[1] > all[1] + 0.2, "{none:?} {all:?}");
        for alpha in [0.1, 0.3, 0.5, 0.75] {
            let found = seen(alpha);
            for channel in 0..2 {
                let share = (found[channel] - none[channel]) / (all[channel] - none[channel]);
                assert!((share - alpha).abs() < 0.13, "{samples} samples: {alpha} is drawn as {share}");
            }
        }
    }
    gpu::assert_silent();
}

#[test]
fn both_ways_of_drawing_both_eyes_show_the_same_glass() {
    let Some(device) = device() else { return };
    let camera = Camera::look_at(Vec3::new(0.0, 1.1, 1.5), Vec3::Y * 1.1, Vec3::Y);
    let view = View::stereo(&camera, 0.063, W, H);
    let made = HandMade::of(&device, &paned(0.3), &[(Vec2::ZERO, true)], &[SHIRT], &[0]);
    let draw = |stereo| {
        let settings = Settings { eyes: 2, stereo, ..Settings::sized(W, H) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        renderer.set_meshes(&made.meshes).unwrap();
        renderer.draw(&view, Some(&made.crowd())).unwrap()
    };
    let (one, two) = (draw(Stereo::Auto), draw(Stereo::TwoPasses));
    assert_eq!(one.pixels, two.pixels);
    let red = |image: &Image, x: u32| {
        (0..W * H)
            .filter_map(|i| image.pixel(x + i % W, i / W))
            .filter(|p| p[0] > p[2] / 2 && p[2] > p[1])
            .count()
    };
    assert!(red(&one, 0) > 500 && red(&one, W) > 500, "seen by both eyes");
    gpu::assert_silent();
}

/// A block whose front is green and whose back is red.
fn block() -> EnvironmentMesh {
    let mut boxes = Boxes::default();
    boxes.add(Vec3::new(-0.4, 0.0, 0.0), Vec3::new(0.4, 0.6, 0.7), Vec3::new(0.0, 0.5, 0.0));
    boxes.add(Vec3::new(-0.4, 0.0, -0.7), Vec3::new(0.4, 0.6, 0.0), Vec3::new(0.5, 0.0, 0.0));
    let Boxes { positions, normals, colors, indices, .. } = boxes;
    EnvironmentMesh { positions, normals, colors, indices, ..EnvironmentMesh::default() }
}

#[test]
fn robots_are_drawn_where_their_agents_are_turned_as_they_are_on_their_floor_and_not_when_absent() {
    let Some(device) = device() else { return };
    let places = [(Vec2::new(-2.0, 0.0), true), (Vec2::new(0.5, 0.5), true), (Vec2::new(2.0, 0.0), true)];
    let mut made = HandMade::new(&device, &places, &[SHIRT], &[0]);
    made.meshes.outsiders = vec![OutsiderMesh { mesh: block(), agents: vec![1] }];
    made.turn(1, std::f32::consts::FRAC_PI_2, 0.0);
    let view = View::mono(&Camera::look_at(Vec3::new(0.0, 4.0, 5.0), Vec3::Y * 0.5, Vec3::Y), W, H);
    let (green, red) = ([0, srgb(0.5), 0], [srgb(0.5), 0, 0]);
    for stereo in [Stereo::Auto, Stereo::TwoPasses] {
        let settings = Settings { atmosphere: flat(), stereo, ..Settings::sized(W, H) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        renderer.set_meshes(&made.meshes).unwrap();
        let image = renderer.draw(&view, Some(&made.crowd())).unwrap();
        keep("robot", &image);
        // a heading of 90 degrees faces +x
        assert!(near(at(&image, &view, Vec3::new(0.85, 0.6, 0.5)), green), "its front");
        assert!(near(at(&image, &view, Vec3::new(0.15, 0.6, 0.5)), red), "its back");
    }
    let mut renderer =
        Renderer::new(&device, Settings { atmosphere: flat(), ..Settings::sized(W, H) }).unwrap();
    renderer.set_meshes(&made.meshes).unwrap();
    made.turn(1, std::f32::consts::PI, 1.0);
    let image = renderer.draw(&view, Some(&made.crowd())).unwrap();
    assert!(near(at(&image, &view, Vec3::new(0.5, 1.6, 0.85)), red), "turned about, on the floor above");
    assert!(near(at(&image, &view, Vec3::new(0.5, 1.6, 0.15)), green), "turned about, on the floor above");
    made.put(1, [ABSENT, ABSENT]);
    let gone = renderer.draw(&view, Some(&made.crowd())).unwrap();
    made.meshes.outsiders.clear();
    renderer.set_meshes(&made.meshes).unwrap();
    let without = renderer.draw(&view, Some(&made.crowd())).unwrap();
    keep("robot_gone", &gone);
    keep("robot_without", &without);
    assert!(gone == without, "no body there");
    gpu::assert_silent();
}

/// Darkness of the ground, 0 in the sun to 1 in the middle of the shadow, so far from what stands on it, m.
fn darkness(made: &HandMade, edge: f32, distances: &[f32]) -> Option<Vec<f32>> {
    let device = device()?;
    let atmosphere = Atmosphere { sun_direction: Vec3::new(1.0, 1.0, 0.0), haze: 0.0, ..Atmosphere::DAY };
    let view =
        View::mono(&Camera::look_at(Vec3::new(-1.5, 3.0, 3.0), Vec3::NEG_X * 0.6, Vec3::Y), W * 2, H * 2);
    let mut floor = Boxes::default();
    floor.add(Vec3::new(-9.0, -1.0, -9.0), Vec3::new(9.0, 0.0, 9.0), Vec3::splat(0.3));
    floor.layers = vec![1; floor.positions.len()];
    let draw = |shadow_size| {
        let settings = Settings { shadow_size, atmosphere, ..Settings::sized(W * 2, H * 2) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        renderer.set_environment(&[floor.surface()]).unwrap();
        renderer.set_meshes(&made.meshes).unwrap();
        renderer.draw(&view, Some(&made.crowd())).unwrap()
    };
    // texels as large as in a scene seen by the user
    let (lit, shaded) = (draw(0), draw(512));
    keep("feet", &shaded);
    let green = |image: &Image, x: f32| {
        let p = view.pixel_from_world(0, Vec3::new(x, 0.0, 0.0), W * 2, H * 2).unwrap();
        f32::from(image.pixel(p.x as u32, p.y as u32).unwrap()[1])
    };
    let whole = green(&lit, -0.6) - green(&shaded, -0.6);
    assert!(whole > 30.0, "there is a shadow: {whole}");
    let far = [1.5, 2.0, 2.5].map(|x| green(&lit, x) - green(&shaded, x));
    assert!(far.iter().all(|d| d.abs() < 1.0), "the ground does not shade itself: {far:?}");
    Some(distances.iter().map(|d| (green(&lit, edge - d) - green(&shaded, edge - d)) / whole).collect())
}

#[test]
fn shadows_begin_at_the_feet_of_people_and_at_the_wheels_of_robots() {
    let Some(device) = device() else { return };
    let places = [(Vec2::ZERO, true)];
    let mut person = HandMade::new(&device, &places, &[SHIRT], &[0]);
    // the box of level 1, which casts the shadow, is a little wider than the legs
    let found = darkness(&person, -0.25, &[0.03, 0.06, 0.1]).unwrap();
    println!("person {found:?}");
    assert!(found[0] > 0.5 && found[1] > 0.8 && found[2] > 0.9, "{found:?}");
    person.meshes.outsiders = vec![OutsiderMesh { mesh: block(), agents: vec![0] }];
    for draw in person.meshes.mesh_table.iter_mut() {
        draw.index_count = 0;
    }
    let found = darkness(&person, -0.4, &[0.03, 0.06, 0.1]).unwrap();
    println!("robot {found:?}");
    assert!(found[0] > 0.5 && found[1] > 0.8 && found[2] > 0.9, "{found:?}");
}
