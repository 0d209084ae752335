//! What outfits show of a body, and in which colours.

use crate::common::gpu;
use crate::support::*;
use gaitway::avatar::wardrobe::{Clothes, Outfit, Tailoring, Wardrobe};
use gaitway::avatar::{Avatar, Material, Sex, generated};
use gaitway::gait::walker;
use gaitway::gpu::Device;
use gaitway::kernels::layout::Appearance;
use gaitway::kernels::shared::outfit::{
    BARE_LEGS, CAP, COAT, DRESS, JACKET, LOWER_SLEEVE, SKIRT, SNEAKERS, STRIPES, TORSO,
};
use gaitway::render::camera::{Camera, View};
use gaitway::render::{Image, Quality, Renderer, Settings};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Skin, hair, top, bottom.
const COLORS: [u32; 4] = [0xb0_b000, 0x20_2020, 0xb0_0000, 0x00_00b0];
/// Of jackets and of caps and stripes.
const GREEN: u32 = 0x00_b000;
const WHITE: u32 = 0xff_ffff;

fn dressed(parts: &[u32]) -> Outfit {
    let worn = parts.iter().fold(0, |worn, part| worn | 1 << part);
    Outfit { worn, colors: Appearance::color_bits(GREEN) | Appearance::color_bits(WHITE) << 16 }
}

/// A person of boxes: legs, a trunk that is `part`, a head, and a box on it that is a cap.
fn body(part: u32, growth: f32) -> Avatar {
    let mut body = box_person();
    let levels = body.levels.iter().map(|mesh| {
        let of = |vertex: &gaitway::avatar::Vertex| match vertex.joints[0] {
            1 => Tailoring { part, is_plain: true, growth },
            _ => Tailoring::default(),
        };
        let mut others = mesh.clone();
        others.vertices.retain(|vertex| vertex.joints[0] == 3);
        let vertices = others.vertices.len() as u32;
        let first = mesh.vertices.len() as u32 - vertices;
        others.indices.retain(|index| *index >= first && vertices > 0);
        others.indices.iter_mut().for_each(|index| *index -= first);
        others.vertices.iter_mut().for_each(|vertex| vertex.position.y += 0.3);
        let of_others = vec![Tailoring { part: CAP, is_plain: false, growth: 0.0 }; others.vertices.len()];
        Clothes { own: mesh.vertices.iter().map(of).collect(), others, of_others }
    });
    let levels = levels.collect();
    body.wardrobe = Some(Arc::new(Wardrobe { sex: walker::Sex::Male, collar: 1.4, levels }));
    body
}

/// One of these in an outfit; the ground is lit and has its shadow.
fn draw(device: &Arc<Device>, body: &Avatar, outfit: Option<Outfit>, quality: Quality) -> (Image, View) {
    let view = View::mono(&Camera::look_at(Vec3::new(0.0, 1.2, 3.0), Vec3::Y * 1.1, Vec3::Y), W, H);
    let mut ground = Boxes::default();
    ground.add(Vec3::new(-20.0, -1.0, -20.0), Vec3::new(20.0, 0.0, 20.0), Vec3::splat(0.4));
    let settings = Settings { quality, ..Settings::sized(W, H) };
    let mut renderer = Renderer::new(device, settings).unwrap();
    renderer.set_environment(&[ground.surface()]).unwrap();
    let mut made = HandMade::of(device, body, &[(Vec2::ZERO, true)], &[COLORS], &[0]);
    made.meshes.outfits.extend(outfit);
    renderer.set_meshes(&made.meshes).unwrap();
    (renderer.draw(&view, Some(&made.crowd())).unwrap(), view)
}

/// Which of red, green and blue is at a place of the front.
fn lit(image: &Image, view: &View, x: f32, y: f32) -> [bool; 3] {
    let color = at(image, view, Vec3::new(x, y, 0.12));
    let most = color.into_iter().max().unwrap();
    color.map(|channel| u32::from(channel) * 4 > u32::from(most) * 3)
}

const RED: [bool; 3] = [true, false, false];
const YELLOW: [bool; 3] = [true, true, false];

#[test]
fn what_is_not_worn_is_not_drawn_and_casts_no_shadow() {
    let Some(device) = device() else { return };
    for quality in [Quality::Low, Quality::Medium, Quality::High] {
        let body = body(TORSO, 0.0);
        let bare = Avatar { wardrobe: None, ..body.clone() };
        let (without, _) = draw(&device, &bare, None, quality);
        assert!(without == draw(&device, &body, None, quality).0, "{quality:?}: no outfit is given");
        assert!(
            without == draw(&device, &body, Some(Outfit::default()), quality).0,
            "{quality:?}: the own one"
        );
        assert!(without == draw(&device, &body, Some(dressed(&[TORSO])), quality).0, "{quality:?}: no cap");
        let (capped, view) = draw(&device, &body, Some(dressed(&[TORSO, CAP])), quality);
        assert_eq!(lit(&capped, &view, 0.0, 1.9), [true; 3], "{quality:?}: a white cap");
        let below = |image: &Image| at(image, &view, Vec3::new(0.0, 0.0, 0.6));
        let [sky, cap] = [&without, &capped].map(|image| at(image, &view, Vec3::new(0.0, 1.9, 0.12)));
        assert!(sky != cap, "{quality:?}: {sky:?} where no cap is");
        assert_eq!(below(&without), below(&capped), "{quality:?}: the ground before both is the same");
    }
    gpu::assert_silent();
}

#[test]
fn generated_bodies_without_an_outfit_look_as_they_do_without_a_wardrobe() {
    let Some(device) = device() else { return };
    for sex in Sex::ALL {
        let body = generated(sex);
        let mut body = body;
        body.levels.truncate(2);
        let bare = Avatar { wardrobe: None, ..body.clone() };
        for quality in [Quality::Low, Quality::High] {
            let [one, other] = [&body, &bare].map(|body| draw(&device, body, None, quality).0);
            keep(&format!("own_{}_{quality:?}", sex.name()), &one);
            keep(&format!("bare_{}_{quality:?}", sex.name()), &other);
            assert!(one == other, "{} at {quality:?}", sex.name());
        }
    }
    gpu::assert_silent();
}

#[test]
fn a_cover_is_cloth_where_it_is_worn_and_otherwise_skin() {
    let Some(device) = device() else { return };
    let [body, own] = [-0.05, 0.0].map(|growth| body(LOWER_SLEEVE, growth));
    for quality in [Quality::Low, Quality::Medium] {
        let of = |parts: &[u32], x: f32| {
            let (image, view) = draw(&device, &body, Some(dressed(parts)), quality);
            lit(&image, &view, x, 1.1)
        };
        assert_eq!(of(&[LOWER_SLEEVE], 0.0), RED, "{quality:?}: the colour of the top");
        assert_eq!(of(&[TORSO], 0.0), YELLOW, "{quality:?}: skin");
        assert_eq!(of(&[LOWER_SLEEVE, JACKET], 0.0), [false, true, false], "{quality:?}: the jacket's");
        // where nothing covers it an arm is thinner
        let is_as_wide = |parts: &[u32]| {
            let [thin, wide] = [&body, &own].map(|body| draw(&device, body, Some(dressed(parts)), quality).0);
            thin == wide
        };
        assert!(is_as_wide(&[LOWER_SLEEVE]) && !is_as_wide(&[TORSO]), "{quality:?}");
    }
    gpu::assert_silent();
}

#[test]
fn a_skirt_and_the_legs_in_it_have_the_colour_of_the_coat_over_them() {
    let Some(device) = device() else { return };
    for part in [SKIRT, BARE_LEGS] {
        let mut body = body(part, 0.0);
        let trunks = body.levels.iter_mut().flat_map(|mesh| &mut mesh.vertices);
        trunks.filter(|vertex| vertex.joints[0] == 1).for_each(|vertex| vertex.material = Material::Bottom);
        for quality in [Quality::Low, Quality::Medium] {
            let of = |parts: &[u32]| {
                let (image, view) = draw(&device, &body, Some(dressed(parts)), quality);
                lit(&image, &view, 0.0, 1.1)
            };
            assert_eq!(of(&[part]), [false, false, true], "{quality:?}: its own");
            assert_eq!(of(&[part, JACKET]), [false, false, true], "{quality:?}: a jacket ends above it");
            assert_eq!(of(&[part, DRESS]), RED, "{quality:?}: a dress has that of the top");
            assert_eq!(of(&[part, JACKET, COAT]), [false, true, false], "{quality:?}: the coat's");
            assert_eq!(of(&[part, DRESS, JACKET, COAT]), [false, true, false], "{quality:?}: over a dress");
        }
    }
    gpu::assert_silent();
}

#[test]
fn sneakers_have_the_colour_of_caps_and_other_shoes_their_own() {
    let Some(device) = device() else { return };
    for quality in [Quality::Low, Quality::Medium] {
        let of = |parts: &[u32]| {
            let (image, view) = draw(&device, &body(SNEAKERS, 0.0), Some(dressed(parts)), quality);
            lit(&image, &view, 0.0, 1.1)
        };
        assert_eq!(of(&[TORSO]), RED, "{quality:?}: as the mesh is painted");
        assert_eq!(of(&[TORSO, SNEAKERS]), [true; 3], "{quality:?}: white");
    }
    gpu::assert_silent();
}

#[test]
fn stripes_are_seen_at_medium_and_high_quality() {
    let Some(device) = device() else { return };
    for quality in [Quality::Low, Quality::Medium, Quality::High] {
        let (image, view) = draw(&device, &body(TORSO, 0.0), Some(dressed(&[TORSO, STRIPES])), quality);
        let heights = (0..60_u8).map(|k| 0.9 + 0.4 * f32::from(k) / 60.0);
        let white = heights.filter(|y| lit(&image, &view, 0.1, *y) == [true; 3]).count();
        let expected = if quality == Quality::Low { 0..1 } else { 12..36 };
        assert!(expected.contains(&white), "{quality:?}: {white} of 60 places are white");
        keep(&format!("stripes_{quality:?}"), &image);
    }
    gpu::assert_silent();
}
