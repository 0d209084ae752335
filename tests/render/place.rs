//! A place of the user's own: drawn with its textures and holes, in shadow and shading, walked on, and refused where it is wrong.

use crate::common::gpu;
use crate::common::street::{REACH, SQUARES, street};
use crate::support::{flat, keep};
use gaitway::render::camera::{Camera, View};
use gaitway::render::{Atmosphere, Image, Quality, Renderer, Settings, Stereo};
use gaitway::scene::{Scene, Stage};
use glam::{Vec2, Vec3};
use tempfile::TempDir;

const SIDE: u32 = 400;
/// A scenario whose place is the street.
const TEXT: &str = "name = \"street\"\nseed = 3\n[environment]\nglb = \"street.glb\"\n[user]\nposition = [-12, -12]\n\
                    [population]\nagents = 30\n[[routes]]\nname = \"street\"\nwaypoints = [[-15, 12], [15, 12]]\n";

/// A folder with the scenario and its model.
fn folder(text: &str, model: &[u8]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), text).unwrap();
    std::fs::write(folder.path().join("street.glb"), model).unwrap();
    folder
}

fn scene(folder: &TempDir) -> gaitway::Result<Scene> {
    Scene::load(folder.path().join("scene.toml").to_str().unwrap())?.build()
}

fn stage(settings: Settings) -> Option<Stage> {
    gpu::on_device(Stage::new(scene(&folder(TEXT, &street())).unwrap(), settings))
}

fn settings(quality: Quality, atmosphere: Atmosphere) -> Settings {
    Settings { quality, atmosphere, ..Settings::sized(SIDE, SIDE) }
}

/// The colour that the ground has at a place (x, z), m.
fn square_at(at: Vec2) -> [u8; 4] {
    let [column, row] = [at.x + REACH, at.y + REACH].map(|along| (2.0 * along).floor() as usize);
    SQUARES[(column + row) % 2]
}

fn is_near(a: [u8; 4], b: [u8; 4], within: u8) -> bool {
    a.iter().zip(b).take(3).all(|(a, b)| a.abs_diff(b) <= within)
}

fn brightness(image: &Image, x: u32, y: u32) -> u32 {
    image.pixel(x, y).unwrap()[..3].iter().map(|channel| u32::from(*channel)).sum()
}

#[test]
fn textures_are_drawn_where_they_lie_and_sharp_at_a_metre() {
    let Some(mut stage) = stage(settings(Quality::Low, flat())) else { return };
    // two metres along a side, 200 pixels a metre
    let middle = Vec2::new(-10.0, -10.0);
    let image = stage.picture(&Camera::top(middle, 2.0)).unwrap();
    keep("place_ground", &image);
    let (mut wrong, mut between) = (0, 0);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let at = middle + (Vec2::new(x as f32, y as f32) + 0.5) / SIDE as f32 * 2.0 - 1.0;
            let found = image.pixel(x, y).unwrap();
            if !is_near(found, square_at(at), 6) {
                let from_edge = [at.x, at.y].map(|along| ((2.0 * along).round() / 2.0 - along).abs());
                if from_edge[0].min(from_edge[1]) < 0.02 { between += 1 } else { wrong += 1 }
            }
        }
    }
    assert_eq!(wrong, 0, "pixels of another colour than their square");
    // a texel is 3 pixels: an edge takes as many
    assert!(between < 5 * 4 * 2 * SIDE, "{between} pixels between colours");
    gpu::assert_silent();
}

#[test]
fn far_textures_are_means_and_do_not_flicker() {
    let Some(mut stage) = stage(settings(Quality::Low, flat())) else { return };
    // a pixel is half a metre across, and more along: about a square of either colour
    let camera = Camera::look_at(Vec3::new(-12.0, 300.0, -600.0), Vec3::new(-12.0, 0.0, -12.0), Vec3::Y);
    let image = stage.picture(&camera.with_fov(0.3)).unwrap();
    keep("place_far", &image);
    let mean = |c: usize| {
        let linear = |byte: u8| ((f32::from(byte) / 255.0 + 0.055) / 1.055).powf(2.4);
        let mean = 0.5 * (linear(SQUARES[0][c]) + linear(SQUARES[1][c]));
        (255.0 * (1.055 * mean.powf(1.0 / 2.4) - 0.055)).round() as u8
    };
    let mean = [mean(0), mean(1), mean(2), 255];
    let middle = SIDE / 2;
    for (x, y) in (middle - 8..middle + 8).flat_map(|x| (middle - 4..middle + 4).map(move |y| (x, y))) {
        let found = image.pixel(x, y).unwrap();
        assert!(is_near(found, mean, 24), "{found:?} at {x}, {y}: the mean is {mean:?}");
    }
}

#[test]
fn maps_lean_normals_and_polish_metal_at_medium_quality_only() {
    // the front of the house, with the sun to the left, to the right, above and level
    let front = |quality, sun_direction, at: Vec3| {
        let air = Atmosphere { sun_direction, ..Atmosphere::DAY };
        let mut stage = stage(settings(quality, air))?;
        let camera = Camera::look_at(at + Vec3::new(0.0, 0.0, 6.0), at, Vec3::Y);
        let image = stage.picture(&camera.with_fov(0.1)).unwrap();
        Some(brightness(&image, SIDE / 2, SIDE / 2))
    };
    let house = Vec3::new(6.0, 3.5, 8.0);
    let of = |quality, sun| front(quality, sun, house);
    let (left, right) = (Vec3::new(-1.0, 0.5, 1.0), Vec3::new(1.0, 0.5, 1.0));
    let Some(from_left) = of(Quality::Medium, left) else { return };
    let from_right = of(Quality::Medium, right).unwrap();
    assert!(5 * from_left > 6 * from_right, "{from_left} and {from_right}: the map leans to the left");
    assert_eq!(of(Quality::Low, left), of(Quality::Low, right));
    // 30 degrees above the horizon and as much below what is level: only the map tells them apart
    let (high, low) = (Vec3::new(0.0, 1.0, 1.0), Vec3::new(0.0, 0.05, 1.0));
    let of_low = |sun| f64::from(of(Quality::Low, sun).unwrap());
    let of_fine = |sun| f64::from(of(Quality::Medium, sun).unwrap());
    let gain = (of_fine(high) / of_fine(low)) / (of_low(high) / of_low(low));
    assert!(gain > 1.05, "{gain}: the map leans up");
    // smooth metal mirrors the horizon, which is brighter than the plaster beside it
    let metal = |quality| front(quality, Vec3::new(0.0, 1.0, -1.0), Vec3::new(-8.0, 1.5, 11.0)).unwrap();
    let (fine, plain) = (metal(Quality::Medium), metal(Quality::Low));
    assert!(fine.abs_diff(plain) > 40, "{fine} and {plain}");
}

#[test]
fn holes_are_seen_through_from_both_sides_and_a_mirrored_board_from_its_front_only() {
    let Some(mut stage) = stage(settings(Quality::Low, flat())) else { return };
    for (name, from) in [("front", 6.0), ("back", -6.0)] {
        let camera = Camera::look_at(Vec3::new(-6.0, 2.0, from), Vec3::new(-6.0, 2.0, 0.0), Vec3::Y);
        let image = stage.picture(&camera.with_fov(0.6)).unwrap();
        keep(&format!("place_fence_{name}"), &image);
        let row: Vec<bool> =
            (0..SIDE).map(|x| is_near(image.pixel(x, SIDE / 2).unwrap(), [30, 160, 60, 255], 12)).collect();
        let solid = row.iter().filter(|is_solid| **is_solid).count();
        let changes = row.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!((SIDE as usize * 2 / 5..SIDE as usize * 3 / 5).contains(&solid), "{name}: {solid} of {SIDE}");
        assert!((6..=10).contains(&changes), "{name}: {changes} edges");
    }
    for (from, is_seen) in [(-4.0, true), (-12.0, false)] {
        let camera = Camera::look_at(Vec3::new(0.0, 1.5, from), Vec3::new(0.0, 1.5, -8.0), Vec3::Y);
        let image = stage.picture(&camera).unwrap();
        let middle = image.pixel(SIDE / 2, SIDE / 2).unwrap();
        assert_eq!(is_near(middle, [233; 4], 6), is_seen, "{middle:?} from {from}");
    }
}

#[test]
fn the_place_casts_shadows_of_its_walls_and_none_of_its_holes_and_people_cast_theirs_on_it() {
    // the sun stands to the side, so that shadows of house and fence lie to their left
    let sun_direction = Vec3::new(0.0, 1.0, -1.0);
    let air = Atmosphere { sun_direction, ..Atmosphere::DAY };
    let Some(mut stage) = stage(settings(Quality::Low, air)) else { return };
    let at = |image: &Image, middle: Vec2, extent: f32, place: Vec2| {
        let pixel = ((place - middle) / extent + 0.5) * SIDE as f32;
        brightness(image, pixel.x as u32, pixel.y as u32)
    };
    let middle = Vec2::new(6.0, 10.0);
    let image = stage.picture(&Camera::top(middle, 8.0)).unwrap();
    keep("place_shadow", &image);
    // squares of one colour, before and behind the end of the shadow of the house (5 m from its wall at z = 8)
    let place = |z: f32| at(&image, middle, 8.0, Vec2::new(6.25, z));
    assert!(square_at(Vec2::new(6.25, 9.25)) == square_at(Vec2::new(6.25, 13.25)));
    assert!(4 * place(9.25) < 3 * place(13.25), "{} and {}", place(9.25), place(13.25));
    // of the fence (4 m high at z = 0) every second half metre lets light through
    let middle = Vec2::new(-6.0, 2.0);
    let image = stage.picture(&Camera::top(middle, 4.0)).unwrap();
    keep("place_holes", &image);
    let along: Vec<u32> =
        (0..8).map(|i| at(&image, middle, 4.0, Vec2::new(-7.75 + 0.5 * i as f32, 2.25))).collect();
    // holes and squares have the same rhythm, so each is compared with its like where nothing casts a shadow
    let away = Vec2::new(-16.0, 2.0);
    let open = stage.picture(&Camera::top(away, 4.0)).unwrap();
    let shares: Vec<u32> = (0..8)
        .map(|i| 100 * along[i] / at(&open, away, 4.0, Vec2::new(-17.75 + 0.5 * i as f32, 2.25)))
        .collect();
    let count = |range: std::ops::Range<u32>| shares.iter().filter(|share| range.contains(share)).count();
    assert_eq!((count(0..80), count(96..105)), (4, 4), "{shares:?}");
    gpu::assert_silent();
}

#[test]
fn one_pass_for_both_eyes_and_a_pass_for_each_give_the_same_pictures_of_it() {
    let built = scene(&folder(TEXT, &street())).unwrap();
    let Some(device) = crate::support::device() else { return };
    let place = built.geometry.scenery().place;
    let camera = Camera::look_at(Vec3::new(-12.0, 1.7, -12.0), Vec3::new(0.0, 1.0, 0.0), Vec3::Y);
    let view = View::stereo(&camera, 0.064, SIDE, SIDE);
    for quality in [Quality::Low, Quality::Medium, Quality::High] {
        let [one, two] = [Stereo::OnePass, Stereo::TwoPasses].map(|stereo| {
            let settings = Settings { eyes: 2, stereo, ..settings(quality, Atmosphere::DAY) };
            let mut renderer = Renderer::new(&device, settings).unwrap();
            renderer.set_place(place.as_deref()).unwrap();
            let image = renderer.draw(&view, None).unwrap();
            renderer.set_place(None).unwrap();
            assert!(renderer.draw(&view, None).unwrap() != image, "without it nothing of it is left");
            image
        });
        keep(&format!("place_{quality:?}"), &one);
        assert!(one == two, "{quality:?}");
    }
    gpu::assert_silent();
}

#[test]
fn its_floor_is_where_people_walk_and_the_users_own_area_goes_first() {
    let made = scene(&folder(TEXT, &street())).unwrap();
    // less the house and the plate with what they enclose, the fence and the board, each a centimetre wider to every side
    let solid = 4.02 * 4.02 + 4.02 * 0.02 + 2.02 * 0.02 + 2.02 * 2.02;
    let free = f64::from(4.0 * REACH * REACH) - solid;
    assert!((made.geometry.walkable_area() - free).abs() < 1e-2, "{}", made.geometry.walkable_area());
    let mut simulation = made.start().unwrap();
    simulation.step(60).unwrap();
    assert!(simulation.people().unwrap().all(|person| person.position.abs().max_element() < REACH));
    // a way through the house is refused
    let through = TEXT.replace("[[-15, 12], [15, 12]]", "[[-15, 6], [15, 6]]");
    let refused = scene(&folder(&through, &street())).unwrap_err().to_string();
    assert!(refused.contains("no lane that is clear of obstacles"), "{refused}");
    let own =
        TEXT.replace("[environment]", "bounds = [[-18, -18], [18, -18], [18, 18], [-18, 18]]\n[environment]");
    let made = scene(&folder(&own, &street())).unwrap();
    assert!((made.geometry.walkable_area() - 36.0 * 36.0).abs() < 1e-2);
    // a node of it, and the ground of the scene's own under it
    let mut node =
        TEXT.replace("[environment]", "walkable_node = \"Ground\"\n[environment]\nground = \"grass\"");
    let made = scene(&folder(&node, &street())).unwrap();
    assert!(!made.geometry.scenery().indices.is_empty());
    node = node.replace("\"Ground\"", "\"Board\"");
    let refused = scene(&folder(&node, &street())).unwrap_err().to_string();
    assert!(refused.contains("environment.glb") && refused.contains("has no floor"), "{refused}");
}

#[test]
fn models_that_cannot_be_read_are_refused_with_the_reason() {
    let bounds =
        TEXT.replace("[environment]", "bounds = [[-9, -9], [9, -9], [9, 9], [-9, 9]]\n[environment]");
    let bounds = bounds
        .replace("position = [-12, -12]", "position = [-5, -5]")
        .replace("15", "8")
        .replace("12]", "6]");
    let refused = |model: &[u8]| scene(&folder(&bounds, model)).unwrap_err().to_string();
    let message = refused(b"not a model");
    assert!(message.contains("environment.glb") && message.contains("neither GLB nor glTF"), "{message}");
    let whole = street();
    let png = whole.windows(4).position(|four| four == b"\x89PNG").unwrap();
    let mut broken = whole.clone();
    broken[png + 40..png + 60].fill(0);
    let message = refused(&broken);
    assert!(message.contains("image 0") && message.contains("PNG"), "{message}");
    let text = bounds.replace("street.glb", "street2.glb");
    let message = scene(&folder(&text, &whole)).unwrap_err().to_string();
    assert!(message.contains("street2.glb"), "{message}");
}
