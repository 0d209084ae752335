//! Pictures: what is where, in which colour, and that the validation layer has nothing to say.

use crate::common::gpu;
use crate::support::*;
use gaitway::export::image::{Tile, contact_sheet};
use gaitway::render::camera::{Camera, View};
use gaitway::render::pack::pack_avatars;
use gaitway::render::{
    Atmosphere, Hand, HandKind, Image, Markers, Renderer, Settings, Stereo, Teleport, User,
};
use glam::{Vec2, Vec3};

const RED: Vec3 = Vec3::new(0.5, 0.0, 0.0);
const GREEN: Vec3 = Vec3::new(0.0, 0.5, 0.0);
const BLUE: Vec3 = Vec3::new(0.0, 0.0, 0.5);

#[test]
fn boxes_appear_where_the_camera_matrix_says_in_their_own_colours() {
    let Some(device) = device() else { return };
    for samples in [1, 4] {
        let settings = Settings { samples, atmosphere: flat(), ..Settings::sized(W, H) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        let mut boxes = Boxes::default();
        boxes.add(Vec3::splat(-0.5), Vec3::splat(0.5), RED);
        boxes.add(Vec3::new(-0.5, 1.0, -0.5), Vec3::new(0.5, 2.0, 0.5), GREEN);
        boxes.add(Vec3::new(1.0, -0.5, -0.5), Vec3::new(2.0, 0.5, 0.5), BLUE);
        renderer.set_environment(&[boxes.surface()]).unwrap();
        let view = View::mono(&Camera::look_at(Vec3::new(0.3, 0.6, 6.0), Vec3::ZERO, Vec3::Y), W, H);
        let image = renderer.draw(&view, None).unwrap();
        keep(&format!("boxes{samples}"), &image);
        let half = srgb(0.5);
        assert!(near(at(&image, &view, Vec3::new(0.0, 0.0, 0.5)), [half, 0, 0]), "red in the middle");
        assert!(near(at(&image, &view, Vec3::new(0.0, 1.5, 0.5)), [0, half, 0]), "green above");
        assert!(near(at(&image, &view, Vec3::new(1.5, 0.0, 0.5)), [0, 0, half]), "blue to the right");
        let green = view.pixel_from_world(0, Vec3::new(0.0, 1.5, 0.5), W, H).unwrap();
        assert!(green.y < 90.0, "up is up");
        let sky = at(&image, &view, Vec3::new(-1.5, 0.2, 0.0));
        assert!(sky[2] > 40 && sky[0] == sky[1], "{sky:?}");
        // with several samples a slanted edge has tones between the two colours
        let tones: std::collections::BTreeSet<u8> = (0..W * H)
            .filter_map(|i| image.pixel(i % W, i / W))
            .filter(|p| p[0] > p[1].saturating_add(30))
            .map(|p| p[0])
            .collect();
        assert_eq!(tones.len() > 2, renderer.settings().samples > 1, "{tones:?}");
    }
    gpu::assert_silent();
}

#[test]
fn nearer_things_hide_farther_ones_whichever_is_drawn_first() {
    let Some(device) = device() else { return };
    let mut renderer =
        Renderer::new(&device, Settings { atmosphere: flat(), ..Settings::sized(W, H) }).unwrap();
    for near_first in [true, false] {
        let mut boxes = Boxes::default();
        let parts = [
            (Vec3::new(-0.2, -0.2, 2.0), Vec3::new(0.2, 0.2, 2.4), RED),
            (Vec3::new(-1.0, -1.0, -0.5), Vec3::new(1.0, 1.0, 0.5), GREEN),
        ];
        for (low, high, color) in if near_first { parts } else { [parts[1], parts[0]] } {
            boxes.add(low, high, color);
        }
        renderer.set_environment(&[boxes.surface()]).unwrap();
        let view = View::mono(&Camera::look_at(Vec3::new(0.0, 0.0, 6.0), Vec3::ZERO, Vec3::Y), W, H);
        let image = renderer.draw(&view, None).unwrap();
        assert!(near(at(&image, &view, Vec3::new(0.0, 0.0, 2.4)), [srgb(0.5), 0, 0]));
        assert!(near(at(&image, &view, Vec3::new(0.7, 0.0, 0.5)), [0, srgb(0.5), 0]));
    }
    gpu::assert_silent();
}

#[test]
fn the_side_away_from_the_sun_lies_in_shadow() {
    let Some(device) = device() else { return };
    let boxes = tower();
    let sun = Vec3::new(1.0, 1.0, 0.0);
    let camera = Camera::look_at(Vec3::new(0.0, 6.0, 9.0), Vec3::ZERO, Vec3::Y);
    let view = View::mono(&camera, W, H);
    let draw = |shadow_size| {
        let atmosphere = Atmosphere { sun_direction: sun, ..Atmosphere::DAY };
        let settings = Settings { shadow_size, atmosphere, ..Settings::sized(W, H) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        renderer.set_environment(&[boxes.surface()]).unwrap();
        renderer.draw(&view, None).unwrap()
    };
    let (lit, shaded) = (draw(0), draw(1024));
    keep("shadow", &shaded);
    // the tower is 3 m high and the sun at 45 degrees: its shadow ends 3.5 m away
    let light = |image, x: f32, z: f32| at(image, &view, Vec3::new(x, 0.0, z))[1];
    assert!(light(&shaded, -2.0, 0.0) + 40 < light(&lit, -2.0, 0.0), "in the shadow");
    assert!(light(&shaded, 2.0, 0.0).abs_diff(light(&lit, 2.0, 0.0)) <= 1, "towards the sun");
    assert!(light(&shaded, -4.5, 0.0).abs_diff(light(&lit, -4.5, 0.0)) <= 1, "beyond the shadow");
    assert!(light(&shaded, -2.0, 1.5).abs_diff(light(&lit, -2.0, 1.5)) <= 1, "beside the shadow");
    // no surface shades itself: away from the shadow both pictures are the same
    let differ = lit.pixels.chunks(4).zip(shaded.pixels.chunks(4)).filter(|(a, b)| a[1].abs_diff(b[1]) > 2);
    let differ = differ.count();
    assert!(differ < (W * H / 12) as usize, "{differ} pixels differ");
    gpu::assert_silent();
}

const COLORS: [u32; 4] = [0xc0_8060, 0x20_2020, 0xb0_2020, 0x20_20b0];

fn is_color(found: [u8; 3], hex: u32) -> bool {
    let [_, r, g, b] = hex.to_be_bytes();
    // five or six bits a channel
    found.iter().zip([r, g, b]).all(|(x, y)| x.abs_diff(y) <= 8)
}

#[test]
fn agents_wear_their_own_colours_at_every_level_of_detail() {
    let Some(device) = device() else { return };
    let mut renderer =
        Renderer::new(&device, Settings { atmosphere: flat(), ..Settings::sized(W, H) }).unwrap();
    let other = [0x40_3020, 0, 0x20_a040, 0x90_9020];
    let places = [(Vec2::new(-1.0, 0.0), true), (Vec2::new(1.0, 0.0), false), (Vec2::new(0.0, 0.0), true)];
    let made = HandMade::new(&device, &places, &[COLORS, other, other], &[0]);
    renderer.set_meshes(&made.meshes).unwrap();
    let view = View::mono(&Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::Y, Vec3::Y), W, H);
    let image = renderer.draw(&view, Some(&made.crowd())).unwrap();
    keep("agents", &image);
    let color = |x: f32, y: f32| at(&image, &view, Vec3::new(x, y, 0.1));
    assert!(is_color(color(-1.0, 0.4), COLORS[3]), "trousers {:?}", color(-1.0, 0.4));
    assert!(is_color(color(-1.0, 1.1), COLORS[2]), "shirt {:?}", color(-1.0, 1.1));
    assert!(is_color(color(-1.0, 1.6), COLORS[0]), "skin {:?}", color(-1.0, 1.6));
    // the second near agent stands behind the first in the list, with its own vertices and colours
    assert!(is_color(color(0.0, 1.1), other[2]) && is_color(color(0.0, 0.4), other[3]));
    // level 1 is one box in the colour of the shirt, skinned in the vertex shader
    for y in [0.1, 0.8, 1.6] {
        assert!(is_color(color(1.0, y), other[2]), "{y} {:?}", color(1.0, y));
    }
    assert!(!is_color(color(-0.5, 1.0), COLORS[2]), "no agent stands between them");
    gpu::assert_silent();
}

#[test]
fn agents_cast_shadows_and_stand_on_rings_of_their_emotion() {
    let Some(device) = device() else { return };
    let mut boxes = Boxes::default();
    boxes.add(Vec3::new(-20.0, -1.0, -20.0), Vec3::new(20.0, 0.0, 20.0), Vec3::splat(0.3));
    let atmosphere = Atmosphere { sun_direction: Vec3::new(1.0, 1.0, 0.0), ..Atmosphere::DAY };
    let mut renderer = Renderer::new(&device, Settings { atmosphere, ..Settings::sized(W, H) }).unwrap();
    renderer.set_environment(&[boxes.surface()]).unwrap();
    let places: Vec<_> = (0..4).map(|i| (Vec2::new(i as f32 * 2.0 - 3.0, 0.0), i % 2 == 0)).collect();
    let made = HandMade::new(&device, &places, &[COLORS], &[0, 1, 2, 3]);
    renderer.set_meshes(&made.meshes).unwrap();
    let view = View::mono(&Camera::look_at(Vec3::new(0.0, 5.0, 6.0), Vec3::Y * 0.3, Vec3::Y), W, H);
    let empty = renderer.draw(&view, None).unwrap();
    let plain = renderer.draw(&view, Some(&made.crowd())).unwrap();
    let markers = Markers::default();
    renderer.set_markers(Some(markers));
    let marked = renderer.draw(&view, Some(&made.crowd())).unwrap();
    keep("rings", &marked);
    for (i, (place, _)) in places.iter().enumerate() {
        let shadow = Vec3::new(place.x - 1.0, 0.0, place.y);
        let (lit, dark) = (at(&empty, &view, shadow), at(&plain, &view, shadow));
        assert!(dark[1] + 20 < lit[1], "agent {i} casts a shadow: {dark:?} {lit:?}");
        let ring = Vec3::new(place.x, 0.02, place.y + markers.radius);
        let (without, with) = (at(&plain, &view, ring), at(&marked, &view, ring));
        let want = markers.colors[i];
        let far = |c: [u8; 3]| {
            (0..3).map(|k| f32::from(c[k]) - f32::from(srgb(want[k]))).map(f32::abs).sum::<f32>()
        };
        assert!(far(with) < far(without) && far(with) < 90.0, "agent {i}: {without:?} {with:?} {want}");
    }
    gpu::assert_silent();
}

#[test]
fn two_eyes_in_one_go_see_what_each_would_see_alone() {
    let Some(device) = device() else { return };
    let boxes = tower();
    let camera = Camera::look_at(Vec3::new(0.0, 1.7, 4.0), Vec3::Y, Vec3::Y);
    let both = View::stereo(&camera, 0.3, W, H);
    let draw = |eyes, view: &View| {
        let mut renderer = Renderer::new(&device, Settings { eyes, ..Settings::sized(W, H) }).unwrap();
        renderer.set_environment(&[boxes.surface()]).unwrap();
        renderer.draw(view, None).unwrap()
    };
    let pair = draw(2, &both);
    keep("stereo", &pair);
    assert_eq!((pair.width, pair.height), (2 * W, H));
    for eye in 0..2_usize {
        // the shadow map is fitted to both eyes, so edges of shadows may differ a little
        let alone = View {
            clip_from_world: [both.clip_from_world[eye]; 2],
            eyes: [both.eyes[eye]; 2],
            eye_count: 1,
            parallel: false,
        };
        let alone = draw(1, &alone);
        let differ = (0..H)
            .flat_map(|y| (0..W).map(move |x| (x, y)))
            .filter(|(x, y)| {
                let (a, b) = (pair.pixel(x + eye as u32 * W, *y).unwrap(), alone.pixel(*x, *y).unwrap());
                a.iter().zip(b).any(|(a, b)| a.abs_diff(b) > 4)
            })
            .count();
        assert!(differ < 200, "eye {eye}: {differ} pixels differ");
    }
    gpu::assert_silent();
}

#[test]
fn one_pass_for_both_eyes_and_a_pass_for_each_give_the_same_pictures() {
    let Some(device) = device() else { return };
    let boxes = tower();
    let places: Vec<_> =
        (0..6).map(|i| (Vec2::new(i as f32 * 0.8 - 2.0, i as f32 * 0.3), i % 2 == 0)).collect();
    let made = HandMade::new(&device, &places, &[COLORS], &[0, 1, 2, 3]);
    let camera = Camera::look_at(Vec3::new(0.0, 1.7, 4.0), Vec3::Y, Vec3::Y);
    let view = View::stereo(&camera, 0.3, W, H);
    for samples in [1, 4] {
        let draw = |stereo| {
            let markers = Some(Markers::default());
            let settings = Settings { eyes: 2, samples, stereo, markers, ..Settings::sized(W, H) };
            let mut renderer = Renderer::new(&device, settings).unwrap();
            renderer.set_environment(&[boxes.surface()]).unwrap();
            renderer.set_meshes(&made.meshes).unwrap();
            let first = renderer.draw(&view, Some(&made.crowd())).unwrap();
            // in another size and back: the views of the layers are made again
            renderer.resize(W / 2, H / 2).unwrap();
            renderer.draw(&view, Some(&made.crowd())).unwrap();
            renderer.resize(W, H).unwrap();
            assert_eq!(first, renderer.draw(&view, Some(&made.crowd())).unwrap());
            (first, renderer.settings().stereo)
        };
        let (two, ways) = draw(Stereo::TwoPasses);
        assert_eq!(ways, Stereo::TwoPasses);
        keep(&format!("two_passes{samples}"), &two);
        let (one, ways) = draw(Stereo::Auto);
        assert_eq!(ways, Stereo::OnePass, "this device has multiview");
        let differ = one.pixels.chunks(4).zip(two.pixels.chunks(4)).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "{samples} samples");
        let half = |eye: u32| (0..W).map(move |x| x + eye * W);
        let differ =
            half(0).zip(half(1)).filter(|(l, r)| one.pixel(*l, H / 2) != one.pixel(*r, H / 2)).count();
        assert!(differ > 20, "the eyes see different pictures");
    }
    gpu::assert_silent();
}

#[test]
fn bodies_fade_near_the_eyes_and_both_eyes_miss_the_same_places() {
    let Some(device) = device() else { return };
    let eye = Vec3::new(0.0, 1.1, 0.0);
    let camera = Camera::look_at(eye, eye + Vec3::Z, Vec3::Y);
    let draw = |distance: f32, stereo| {
        // the front of the body's shirt is 0.12 m before its middle; the arms' boxes reach beyond the picture
        let made = HandMade::new(&device, &[(Vec2::new(0.0, distance + 0.12), true)], &[COLORS], &[0]);
        let settings = Settings { eyes: 2, samples: 1, stereo, atmosphere: flat(), ..Settings::sized(W, H) };
        let mut renderer = Renderer::new(&device, settings).unwrap();
        renderer.set_meshes(&made.meshes).unwrap();
        renderer.draw(&View::stereo(&camera, 0.06, W, H), Some(&made.crowd())).unwrap()
    };
    let is_shirt = |image: &Image, x: u32, y: u32| {
        let [r, g, b, _] = image.pixel(x, y).unwrap();
        is_color([r, g, b], COLORS[2])
    };
    // within the front of the shirt, which spans 0.5 m by 0.6 m
    let share = |image: &Image, eye: u32| {
        let places = (60..120).flat_map(|y| (120..200).map(move |x| (x + eye * W, y)));
        let (shown, all) =
            places.fold((0, 0), |(s, n), (x, y)| (s + u32::from(is_shirt(image, x, y)), n + 1));
        f64::from(shown) / f64::from(all)
    };
    for (distance, low, high) in [(0.7, 1.0, 1.0), (0.5, 0.6, 0.85), (0.4, 0.3, 0.65), (0.15, 0.0, 0.0)] {
        let image = draw(distance, Stereo::Auto);
        keep(&format!("near{}", (distance * 100.0) as u32), &image);
        for eye in 0..2 {
            let share = share(&image, eye);
            assert!((low..=high).contains(&share), "{distance} m, eye {eye}: {share}");
        }
        assert_eq!(image, draw(distance, Stereo::TwoPasses));
    }
    let image = draw(0.4, Stereo::Auto);
    let view = View::stereo(&camera, 0.06, W, H);
    let (mut same, mut all) = (0, 0);
    // the middles of the pattern's cells, of three pixels as seen from between the eyes
    let cell = 3.0 * 2.0 * (0.5 * Camera::VERTICAL_FOV).tan() / H as f32;
    for i in -15..15 {
        for j in -15..15 {
            let place = eye + Vec3::new((i as f32 + 0.5) * cell, (j as f32 + 0.5) * cell, 1.0) * 0.4;
            let seen = [0, 1].map(|eye| {
                let p = view.pixel_from_world(eye, place, W, H).unwrap();
                is_shirt(&image, p.x as u32 + eye as u32 * W, p.y as u32)
            });
            same += u32::from(seen[0] == seen[1]);
            all += 1;
        }
    }
    assert!(same * 10 > all * 9, "{same} of {all} places are the same in both eyes");
    gpu::assert_silent();
}

#[test]
fn hands_target_and_vignette_of_the_user_are_drawn_where_they_are() {
    let Some(device) = device() else { return };
    let mut renderer =
        Renderer::new(&device, Settings { eyes: 2, atmosphere: flat(), ..Settings::sized(W, H) }).unwrap();
    let mut boxes = Boxes::default();
    boxes.add(Vec3::new(-20.0, -1.0, -20.0), Vec3::new(20.0, 0.0, 20.0), Vec3::splat(0.3));
    renderer.set_environment(&[boxes.surface()]).unwrap();
    let camera = Camera::user_eyes(Vec3::new(0.0, 1.7, 0.0), 0.0, -0.5).with_fov(1.7);
    let view = View::stereo(&camera, 0.06, W, H);
    let bare = renderer.draw(&view, None).unwrap();
    let turn = camera.rotation;
    let places = [Vec3::new(0.25, 1.3, 0.45), Vec3::new(-0.25, 1.3, 0.45)];
    let hand = |i: usize, kind| Some(Hand { place: places[i], turn, kind });
    let to = Vec3::new(0.0, 0.0, 2.5);
    let teleport = Some(Teleport { from: places[1], to, is_allowed: true });
    let hands = [hand(0, HandKind::Hand), hand(1, HandKind::Controller)];
    renderer.set_user(User { hands, teleport, ..User::default() });
    let image = renderer.draw(&view, None).unwrap();
    keep("user", &image);
    let changed = |image: &Image, eye: usize, place: Vec3| {
        let p = view.pixel_from_world(eye, place, W, H).unwrap();
        let (x, y) = (p.x as u32 + eye as u32 * W, p.y as u32);
        image.pixel(x, y) != bare.pixel(x, y)
    };
    for eye in 0..2 {
        for place in [places[0], places[1], to] {
            assert!(changed(&image, eye, place), "eye {eye}: {place}");
        }
        assert!(!changed(&image, eye, Vec3::new(1.5, 0.0, 2.5)), "nothing beside it");
    }
    // blue where one may go, red where not
    let color = |image: &Image| at(image, &view, to + Vec3::new(0.9 * 0.35, 0.02, 0.0));
    let [r, _, b] = color(&image);
    assert!(b > r + 60, "{r} {b}");
    let forbidden = teleport.map(|aim| Teleport { is_allowed: false, ..aim });
    renderer.set_user(User { vignette: 1.0, ..User::default() });
    let image = renderer.draw(&view, None).unwrap();
    keep("vignette", &image);
    for eye in 0..2_u32 {
        assert_eq!(image.pixel(eye * W + 2, H / 2), Some([0, 0, 0, 255]), "dark at the edge");
        let middle = (eye * W + W / 2, H / 2);
        assert_eq!(image.pixel(middle.0, middle.1), bare.pixel(middle.0, middle.1), "clear in the middle");
    }
    renderer.set_user(User { hands, vignette: 1.0, fade: 1.0, ..User::default() });
    let image = renderer.draw(&view, None).unwrap();
    keep("faded", &image);
    let grey = image.pixel(3, 3).unwrap();
    assert!(grey[0] > 90 && grey[0] == grey[1] && grey[1] == grey[2], "{grey:?}");
    assert!(image.pixels.chunks_exact(4).all(|pixel| pixel == grey), "a full fade leaves nothing to be seen");
    renderer.set_user(User { fade: 0.5, ..User::default() });
    let half = renderer.draw(&view, None).unwrap();
    let middle = [&bare, &half].map(|image| i32::from(image.pixel(W / 2, H - 4).unwrap()[0]));
    let way = (middle[1] - middle[0]).abs();
    assert!(way > 3 && way < (i32::from(grey[0]) - middle[0]).abs(), "{middle:?}");
    renderer.set_user(User { teleport: forbidden, ..User::default() });
    let [r, _, b] = color(&renderer.draw(&view, None).unwrap());
    assert!(r > b + 60, "{r} {b}");
    renderer.set_user(User::default());
    assert_eq!(bare, renderer.draw(&view, None).unwrap());
    gpu::assert_silent();
}

#[test]
fn the_same_scene_gives_the_same_picture_and_sizes_can_change() {
    let Some(device) = device() else { return };
    let mut renderer = Renderer::new(&device, Settings::sized(64, 48)).unwrap();
    let boxes = tower();
    renderer.set_environment(&[boxes.surface()]).unwrap();
    let view = |w, h| View::mono(&Camera::orbit(Vec3::Y, 8.0, 0.4, 0.4), w, h);
    let first = renderer.draw(&view(64, 48), None).unwrap();
    assert_eq!(first, renderer.draw(&view(64, 48), None).unwrap());
    renderer.resize(33, 21).unwrap();
    let small = renderer.draw(&view(33, 21), None).unwrap();
    assert_eq!((small.width, small.height, small.pixels.len()), (33, 21, 33 * 21 * 4));
    assert!(renderer.resize(0, 5).unwrap_err().to_string().contains("0x5"));
    renderer.resize(64, 48).unwrap();
    assert_eq!(first, renderer.draw(&view(64, 48), None).unwrap());
    renderer.set_environment(&[]).unwrap();
    assert_ne!(first, renderer.draw(&view(64, 48), None).unwrap());
    gpu::assert_silent();
}

#[test]
fn pictures_go_onto_a_contact_sheet() {
    let Some(device) = device() else { return };
    let mut renderer = Renderer::new(&device, Settings::sized(W, H)).unwrap();
    renderer.set_environment(&[tower().surface()]).unwrap();
    let airs = [
        ("day", Atmosphere::DAY),
        ("overcast", Atmosphere::OVERCAST),
        ("evening\nsecond line, (x) = 3.5 m/s", Atmosphere::EVENING),
    ];
    let mut images = Vec::new();
    for (_, air) in airs {
        renderer.set_atmosphere(air);
        let view = View::mono(&Camera::user_eyes(Vec3::new(3.0, 1.7, -6.0), -0.3, 0.05), W, H);
        images.push(renderer.draw(&view, None).unwrap());
    }
    let tiles: Vec<_> =
        airs.iter().zip(&images).map(|((caption, _), image)| Tile { caption, image }).collect();
    let sheet = contact_sheet(&tiles, 2).unwrap();
    keep("sheet", &sheet);
    assert!(sheet.width > 2 * W && sheet.height > 2 * H);
    assert!(images[0] != images[1] && images[1] != images[2]);
    gpu::assert_silent();
}

#[test]
fn nothing_is_left_on_the_device_when_a_renderer_goes() {
    let Some(device) = gpu::device() else { return };
    let mut renderer =
        Renderer::new(&device, Settings { markers: Some(Markers::default()), ..Settings::sized(W, H) })
            .unwrap();
    renderer.set_environment(&[tower().surface()]).unwrap();
    let made = HandMade::new(&device, &[(Vec2::ZERO, true)], &[COLORS], &[1]);
    renderer.set_meshes(&made.meshes).unwrap();
    let view = View::mono(&Camera::top(Vec2::ZERO, 8.0), W, H);
    let image = renderer.draw(&view, Some(&made.crowd())).unwrap();
    keep("top", &image);
    drop(made);
    drop(renderer);
    drop(device);
    gpu::assert_silent();
}

#[test]
fn crowd_buffers_that_are_too_short_are_refused() {
    let Some(device) = device() else { return };
    let mut renderer = Renderer::new(&device, Settings::sized(W, H)).unwrap();
    let made = HandMade::new(&device, &[(Vec2::ZERO, true)], &[COLORS], &[1]);
    let meshes = pack_avatars(&vec![box_person(); 8]);
    renderer.set_meshes(&meshes).unwrap();
    let view = View::mono(&Camera::top(Vec2::ZERO, 8.0), W, H);
    let error = renderer.draw(&view, Some(&made.crowd())).unwrap_err().to_string();
    assert!(error.contains("32 buckets"), "{error}");
    gpu::assert_silent();
}
