//! Light and surfaces by quality: low shows none of it, the others differ, and all are repeatable.

use crate::common::gpu;
use crate::support::*;
use gaitway::gpu::Device;
use gaitway::render::camera::{Camera, View};
use gaitway::render::{Image, Quality, Renderer, Settings, Stereo, Surface};
use gaitway::scenario::{EnvironmentMesh, Finish, SurfaceMaterial};
use gaitway::scene::{CameraChoice, Scene, Stage};
use glam::{Vec2, Vec3};
use std::sync::Arc;

const ALL: [Quality; 3] = [Quality::Low, Quality::Medium, Quality::High];
const COLORS: [u32; 4] = [0xc0_8060, 0x20_2020, 0xb0_2020, 0x20_20b0];

/// A tower on a ground, both of one material, and people before it.
fn draw(device: &Arc<Device>, settings: Settings, view: &View, material: SurfaceMaterial) -> Image {
    let boxes = tower();
    let materials = vec![material; boxes.positions.len()];
    let places: Vec<_> =
        (0..6).map(|i| (Vec2::new(i as f32 * 0.8 - 2.0, i as f32 * 0.3), i % 2 == 0)).collect();
    let made = HandMade::new(device, &places, &[COLORS], &[0]);
    let mut renderer = Renderer::new(device, settings).unwrap();
    renderer.set_environment(&[Surface { materials: &materials, ..boxes.surface() }]).unwrap();
    renderer.set_meshes(&made.meshes).unwrap();
    let image = renderer.draw(view, Some(&made.crowd())).unwrap();
    assert_eq!(image, renderer.draw(view, Some(&made.crowd())).unwrap(), "the same picture twice");
    image
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(0.0, 1.7, 4.0), Vec3::Y, Vec3::Y)
}

#[test]
fn each_quality_gives_another_picture_and_always_the_same() {
    let Some(device) = device() else { return };
    let view = View::mono(&camera(), W, H);
    let picture = |quality| {
        let settings = Settings { quality, ..Settings::sized(W, H) };
        let image = draw(&device, settings, &view, SurfaceMaterial::Brick);
        assert_eq!(image, draw(&device, settings, &view, SurfaceMaterial::Brick));
        keep(&format!("quality_{quality:?}"), &image);
        image
    };
    let [low, medium, high] = ALL.map(picture);
    assert!(low != medium && medium != high && low != high);
    gpu::assert_silent();
}

#[test]
fn materials_are_seen_at_medium_and_high_quality_only() {
    let Some(device) = device() else { return };
    let view = View::mono(&camera(), W, H);
    for quality in ALL {
        let settings = Settings { quality, ..Settings::sized(W, H) };
        let plain = draw(&device, settings, &view, SurfaceMaterial::Plain);
        for material in [SurfaceMaterial::Glass, SurfaceMaterial::Grass, SurfaceMaterial::Paving] {
            let other = draw(&device, settings, &view, material);
            assert_eq!(plain == other, quality == Quality::Low, "{quality:?} {material:?}");
        }
    }
    gpu::assert_silent();
}

#[test]
fn one_pass_for_both_eyes_and_a_pass_for_each_give_the_same_pictures_at_every_quality() {
    let Some(device) = device() else { return };
    let view = View::stereo(&camera(), 0.3, W, H);
    for quality in ALL {
        for samples in [1, 4] {
            let [one, two] = [Stereo::OnePass, Stereo::TwoPasses].map(|stereo| {
                let settings = Settings { eyes: 2, samples, stereo, quality, ..Settings::sized(W, H) };
                draw(&device, settings, &view, SurfaceMaterial::Paving)
            });
            let differ = one.pixels.chunks(4).zip(two.pixels.chunks(4)).filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "{quality:?}, {samples} samples");
        }
    }
    gpu::assert_silent();
}

/// How far two pictures differ, over all pixels and channels.
fn difference(a: &Image, b: &Image) -> u64 {
    a.pixels.iter().zip(&b.pixels).map(|(a, b)| u64::from(a.abs_diff(*b))).sum()
}

#[test]
fn shadows_near_the_eyes_are_finer_than_the_shadow_map_but_not_at_low_quality() {
    let Some(device) = device() else { return };
    // the tower's shadow and those of people, 2 to 6 m away
    let view =
        View::mono(&Camera::user_eyes(Vec3::new(0.5, 1.7, 5.0), std::f32::consts::PI, -0.3), W * 2, H * 2);
    let coarse = ALL.map(|quality| {
        let picture = |shadow_size| {
            let settings = Settings { quality, shadow_size, ..Settings::sized(W * 2, H * 2) };
            draw(&device, settings, &view, SurfaceMaterial::Plain)
        };
        let (coarse, fine) = (picture(256), picture(4096));
        keep(&format!("near_shadow_{quality:?}"), &coarse);
        difference(&coarse, &fine)
    });
    assert!(coarse[0] > 2 * coarse[1] && coarse[0] > 2 * coarse[2], "{coarse:?}");
    gpu::assert_silent();
}

#[test]
fn feet_darken_the_ground_before_them_but_not_at_low_quality() {
    let Some(device) = device() else { return };
    let mut ground = Boxes::default();
    ground.add(Vec3::new(-20.0, -1.0, -20.0), Vec3::new(20.0, 0.0, 20.0), Vec3::splat(0.4));
    let made = HandMade::new(&device, &[(Vec2::ZERO, true)], &[COLORS], &[0]);
    let view = View::mono(&Camera::look_at(Vec3::new(0.0, 1.5, 2.0), Vec3::ZERO, Vec3::Y), W, H);
    for quality in ALL {
        let settings = Settings { quality, shadow_size: 0, atmosphere: flat(), ..Settings::sized(W, H) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        renderer.set_environment(&[ground.surface()]).unwrap();
        renderer.set_meshes(&made.meshes).unwrap();
        let image = renderer.draw(&view, Some(&made.crowd())).unwrap();
        keep(&format!("feet_{quality:?}"), &image);
        let light = |x: f32, z: f32| at(&image, &view, Vec3::new(x, 0.0, z))[1];
        let is_darker = light(0.09, 0.16) + 20 < light(0.9, 0.16);
        assert_eq!(
            is_darker,
            quality > Quality::Low,
            "{quality:?}: {} {}",
            light(0.09, 0.16),
            light(0.9, 0.16)
        );
    }
    gpu::assert_silent();
}

#[test]
fn what_is_finer_than_two_pixels_is_not_drawn() {
    let Some(device) = device() else { return };
    let mut ground = Boxes::default();
    ground.add(Vec3::new(-900.0, -1.0, -900.0), Vec3::new(900.0, 0.0, 900.0), Vec3::splat(0.4));
    let materials = vec![SurfaceMaterial::Paving; ground.positions.len()];
    let settings = Settings { quality: Quality::High, atmosphere: flat(), ..Settings::sized(W, H) };
    let mut renderer = Renderer::new(&device, settings).unwrap();
    renderer.set_environment(&[Surface { materials: &materials, ..ground.surface() }]).unwrap();
    let mut tones = |height: f32| {
        let view = View::mono(&Camera::top(Vec2::ZERO, height), W, H);
        let image = renderer.draw(&view, None).unwrap();
        image.pixels.chunks(4).map(|p| p[0]).collect::<std::collections::BTreeSet<u8>>().len()
    };
    // slabs of 0.6 m: a pixel of 7 cm shows them, one of 2.8 m shows nothing
    assert!(tones(0.07 * H as f32) > 10);
    assert_eq!(tones(2.8 * H as f32), 1);
    gpu::assert_silent();
}

fn surface(mesh: &EnvironmentMesh) -> Surface<'_> {
    Surface {
        positions: &mesh.positions,
        normals: &mesh.normals,
        colors: &mesh.colors,
        layers: &mesh.layers,
        materials: &mesh.materials,
        indices: &mesh.indices,
    }
}

#[test]
fn scenery_is_as_fine_as_pictures_of_a_quality_have_room_for() {
    for quality in ALL {
        let scene = Scene::load("garden").unwrap().build().unwrap();
        let settings = Settings { quality, ..Settings::sized(W, H) };
        let Some(mut stage) = gpu::on_device(Stage::new(scene, settings)) else { return };
        let camera = stage.camera(CameraChoice::Eyes, 0.0).unwrap();
        let drawn = stage.picture(&camera).unwrap();
        keep(&format!("quality_scenery_{quality:?}"), &drawn);
        let [plain, fine] = [Finish::Plain, Finish::Fine].map(|finish| {
            let mesh = stage.scene.geometry.scenery_of(finish);
            stage.show().renderer().set_environment(&[surface(&mesh)]).unwrap();
            stage.picture(&camera).unwrap()
        });
        assert!(plain != fine, "{quality:?}");
        assert!(drawn == if quality == Quality::Low { plain } else { fine }, "{quality:?}");
    }
    gpu::assert_silent();
}

#[test]
fn houses_look_alike_with_the_triangles_that_they_have_from_afar() {
    let scene = Scene::load("crossing").unwrap().agents(100).build().unwrap();
    let settings = Settings { quality: Quality::Medium, ..Settings::sized(960, 540) };
    let Some(mut stage) = gpu::on_device(Stage::new(scene, settings)) else { return };
    let camera = stage.camera(CameraChoice::Orbit, 0.0).unwrap();
    let drawn = stage.picture(&camera).unwrap();
    let [plain, fine] = [Finish::Plain, Finish::Fine].map(|finish| {
        let mesh = stage.scene.geometry.scenery_of(finish);
        stage.show().renderer().set_environment(&[surface(&mesh)]).unwrap();
        stage.picture(&camera).unwrap()
    });
    keep("quality_houses_drawn", &drawn);
    keep("quality_houses_fine", &fine);
    let (off, blocks) = (other_pixels(&drawn, &fine), other_pixels(&drawn, &plain));
    println!("{off} of the pixels differ from the fine houses', {blocks} from the plain ones'");
    assert!(off > 0.0 && off < 0.05 && blocks > 5.0 * off, "{off} {blocks}");
    gpu::assert_silent();
}

/// The share of pixels that are clearly different in two pictures.
fn other_pixels(one: &Image, two: &Image) -> f64 {
    let pairs = one.pixels.chunks(4).zip(two.pixels.chunks(4));
    let differ = pairs.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 16));
    differ.count() as f64 / f64::from(one.width * one.height)
}
