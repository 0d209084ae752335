//! Characters with textures: colours, holes, glass and maps at every pixel of the finest level.

use crate::common::{gpu, textured};
use crate::support::*;
use gaitway::avatar::{Avatar, Paint, PaintCorner, Sex, Textured, TexturedMaterial, Vertex, generated, glb};
use gaitway::gpu::Device;
use gaitway::render::camera::{Camera, View};
use gaitway::render::pack::pack_avatars;
use gaitway::render::{Atmosphere, Image, Quality, Renderer, Settings, Stereo};
use gaitway::scene::{Scene, Stage};
use glam::{Vec2, Vec3, Vec4};
use serde_json::json;
use std::sync::Arc;

/// Squares of the texture a metre, half of them of either colour.
const SQUARES: f32 = 8.0;
const COLORS: [[u8; 4]; 2] = [[200, 60, 50, 255], [40, 70, 190, 255]];
/// Agents' own colours: white, so that textures are as they are.
const WHITE: [[u32; 4]; 1] = [[0xff_ffff; 4]];
/// Height and distance of the trunk's front of `box_person`, m.
const TRUNK: Vec3 = Vec3::new(0.0, 1.1, 0.12);
/// What stands behind the person.
const WALL: [f32; 3] = [0.02, 0.5, 0.1];

const CLOTH: TexturedMaterial = TexturedMaterial {
    glow: Vec3::ZERO,
    roughness: 1.0,
    metal: 0.0,
    cutoff: 0.0,
    is_blended: false,
    is_two_sided: false,
    color: Some(0),
    rough: None,
    normal: None,
    occlusion: None,
};

/// Squares of both colours.
fn squares() -> Image {
    textured::squares(COLORS)
}

/// The colour of a place on the person's front.
fn square_at(at: Vec3) -> [u8; 3] {
    let [column, row] = [at.x, -at.y].map(|along| (SQUARES * along).floor() as i32);
    let [r, g, b, _] = COLORS[(column + row).rem_euclid(2) as usize];
    [r, g, b]
}

/// How far from the next edge of a square, m.
fn from_edge(at: Vec3) -> f32 {
    let to_edge = |along: f32| ((SQUARES * along).fract().abs() - 0.5).abs().mul_add(-1.0, 0.5) / SQUARES;
    to_edge(at.x).min(to_edge(at.y))
}

/// A person of boxes; what a vertex is made of is what `of` says.
fn person(textured: Textured, of: impl Fn(&Vertex) -> u32) -> Avatar {
    let body = box_person();
    let corner = |vertex: &Vertex| PaintCorner {
        color: Vec4::ONE,
        uv: 0.5 * SQUARES * Vec2::new(vertex.position.x, -vertex.position.y),
        material: of(vertex),
    };
    let corners = body.levels[0].vertices.iter().map(corner).collect();
    Avatar { paint: Some(Arc::new(Paint { corners, textured })), ..body }
}

fn in_squares(material: TexturedMaterial) -> Avatar {
    let textured = Textured { materials: vec![material], colors: vec![squares()], maps: Vec::new() };
    person(textured, |_| 0)
}

/// The trunk from so far in front of it, or behind where that is less than 0, m.
fn view(distance: f32) -> View {
    View::mono(&Camera::look_at(TRUNK + Vec3::Z * distance, TRUNK, Vec3::Y).with_fov(0.4), W, H)
}

fn renderer(device: &Arc<Device>, made: &HandMade, settings: Settings) -> Renderer {
    let mut wall = Boxes::default();
    wall.add(Vec3::new(-9.0, -9.0, -3.2), Vec3::new(9.0, 9.0, -3.0), Vec3::from(WALL));
    let mut renderer = Renderer::new(device, settings).unwrap();
    renderer.set_environment(&[wall.surface()]).unwrap();
    renderer.set_meshes(&made.meshes).unwrap();
    renderer
}

fn settings(quality: Quality) -> Settings {
    Settings { quality, shadow_size: 0, atmosphere: flat(), ..Settings::sized(W, H) }
}

fn drawn(device: &Arc<Device>, body: &Avatar, settings: Settings, view: &View) -> Image {
    let made = HandMade::of(device, body, &[(Vec2::ZERO, true)], &WHITE, &[3]);
    renderer(device, &made, settings).draw(view, Some(&made.crowd())).unwrap()
}

/// Mean of the pixels about the middle.
fn mean(image: &Image) -> [f32; 3] {
    let mut sum = Vec3::ZERO;
    for (x, y) in (0..16).flat_map(|x| (0..16).map(move |y| (W / 2 - 8 + x, H / 2 - 8 + y))) {
        let [r, g, b, _] = image.pixel(x, y).unwrap();
        sum += Vec3::new(f32::from(r), f32::from(g), f32::from(b));
    }
    (sum / 256.0).to_array()
}

fn brightness(image: &Image) -> f32 {
    mean(image).iter().sum()
}

fn is_wall(image: &Image) -> bool {
    let wall = WALL.map(srgb).map(f32::from);
    mean(image).iter().zip(wall).all(|(a, b)| (a - b).abs() < 3.0)
}

#[test]
fn textures_lie_where_they_should_and_are_sharp_at_a_metre() {
    let Some(device) = device() else { return };
    let body = in_squares(CLOTH);
    let view = view(1.0);
    let image = drawn(&device, &body, settings(Quality::Low), &view);
    keep("painted_squares", &image);
    let (mut right, mut wrong) = (0, 0);
    for (across, up) in (-30..=30).flat_map(|x| (-18..=18).map(move |y| (x, y))) {
        let place = TRUNK + 0.005 * Vec3::new(across as f32, up as f32, 0.0);
        if place.x.abs() < 0.24 && from_edge(place) > 0.004 {
            let found = at(&image, &view, place);
            let count = if near(found, square_at(place)) { &mut right } else { &mut wrong };
            *count += 1;
        }
    }
    assert!(right > 1_500 && wrong == 0, "{right} places are right, {wrong} are not");
    gpu::assert_silent();
}

#[test]
fn agents_colours_tint_textures_and_coarser_levels_have_the_colours_of_vertices() {
    let Some(device) = device() else { return };
    let grey = Textured {
        materials: vec![CLOTH],
        colors: vec![Image::filled(4, 4, [188, 188, 188, 255])],
        maps: Vec::new(),
    };
    let body = person(grey, |_| 0);
    // half of a dark red, and all of it
    for (is_near, share) in [(true, 0.5), (false, 1.0)] {
        let colors = [[0xff_ffff, 0xff_ffff, 0x84_0000, 0xff_ffff]];
        let made = HandMade::of(&device, &body, &[(Vec2::ZERO, is_near)], &colors, &[3]);
        let mut renderer = renderer(&device, &made, settings(Quality::Low));
        let image = renderer.draw(&view(1.0), Some(&made.crowd())).unwrap();
        let wanted = [srgb(0.23 * share), 0, 0].map(f32::from);
        let found = mean(&image);
        let is_right = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 6.0);
        assert!(is_right, "near: {is_near}: {found:?}, not {wanted:?}");
    }
    gpu::assert_silent();
}

#[test]
fn holes_show_what_is_behind_and_backs_are_seen_of_what_has_two_sides_only() {
    let Some(device) = device() else { return };
    // the front is a hole, all others are whole
    let of = |is_two_sided: bool| {
        let whole = TexturedMaterial { color: None, is_two_sided, ..CLOTH };
        let hole = TexturedMaterial { cutoff: 0.5, ..CLOTH };
        let empty = Image::filled(4, 4, [255, 255, 255, 0]);
        let textured = Textured { materials: vec![whole, hole], colors: vec![empty], maps: Vec::new() };
        person(textured, |vertex| u32::from(vertex.normal.z > 0.5))
    };
    for quality in [Quality::Low, Quality::Medium] {
        let [one, two] = [false, true].map(|is_two_sided| {
            let image = drawn(&device, &of(is_two_sided), settings(quality), &view(1.0));
            keep(&format!("painted_hole_{is_two_sided}_{quality:?}"), &image);
            is_wall(&image)
        });
        if quality == Quality::Low {
            assert!(one && !two, "the wall is seen through one side: {one}, through two: {two}");
        }
        // from behind, the back is a front
        assert!(!is_wall(&drawn(&device, &of(false), settings(quality), &view(-1.4))), "{quality:?}");
    }
    gpu::assert_silent();
}

#[test]
fn what_is_blended_covers_as_much_as_its_alpha_says_and_what_is_not_covers_all() {
    let Some(device) = device() else { return };
    let white = drawn(&device, &pale(255, true), settings(Quality::Low), &view(1.0));
    let is_glass = |image: &Image| {
        let [of_glass, of_wall, of_white] = [mean(image)[0], f32::from(srgb(WALL[0])), mean(&white)[0]];
        (of_glass - of_wall) / (of_white - of_wall)
    };
    // half of the samples: light adds up before it is coded
    let half = is_glass(&drawn(&device, &pale(128, true), settings(Quality::Low), &view(1.0)));
    assert!((0.6..0.8).contains(&half), "{half}");
    let opaque = is_glass(&drawn(&device, &pale(128, false), settings(Quality::Low), &view(1.0)));
    assert!((opaque - 1.0).abs() < 1e-3, "{opaque}");
    gpu::assert_silent();
}

/// A person in white of that alpha.
fn pale(alpha: u8, is_blended: bool) -> Avatar {
    let material = TexturedMaterial { is_blended, ..CLOTH };
    let image = Image::filled(4, 4, [255, 255, 255, alpha]);
    person(Textured { materials: vec![material], colors: vec![image], maps: Vec::new() }, |_| 0)
}

#[test]
fn maps_lean_normals_the_same_way_from_both_sides_and_at_medium_quality_only() {
    let Some(device) = device() else { return };
    let leaning = |red: u8| {
        let material = TexturedMaterial { color: None, normal: Some((0, 1.0)), ..CLOTH };
        let maps = vec![Image::filled(4, 4, [red, 128, 220, 255])];
        person(Textured { materials: vec![material], colors: Vec::new(), maps }, |_| 0)
    };
    // right of the person's front is left of its back; textures run with +x on both
    let [right, left] = [leaning(195), leaning(60)];
    for (name, distance, depth) in [("front", 1.0, 1.0), ("back", -1.4, -1.0)] {
        let sun_direction = Vec3::new(1.0, 0.4, depth);
        let atmosphere = Atmosphere { sun_direction, ..Atmosphere::DAY };
        let light = |body: &Avatar, quality| {
            let settings = Settings { atmosphere, ..settings(quality) };
            brightness(&drawn(&device, body, settings, &view(distance)))
        };
        let [to, from] = [&right, &left].map(|body| light(body, Quality::Medium));
        assert!(to > 1.2 * from, "{name}: {to} where the map leans to the sun, {from} where it leans away");
        assert!((light(&right, Quality::Low) - light(&left, Quality::Low)).abs() < 1e-3, "{name}");
    }
    gpu::assert_silent();
}

#[test]
fn one_pass_for_both_eyes_and_a_pass_for_each_give_the_same_pictures_of_them() {
    let Some(device) = device() else { return };
    let camera = Camera::look_at(TRUNK + Vec3::Z * 1.5, TRUNK, Vec3::Y);
    let view = View::stereo(&camera, 0.064, W, H);
    let body = in_squares(TexturedMaterial { is_two_sided: true, ..CLOTH });
    for quality in [Quality::Low, Quality::High] {
        let [one, two] = [Stereo::OnePass, Stereo::TwoPasses]
            .map(|stereo| drawn(&device, &body, Settings { eyes: 2, stereo, ..settings(quality) }, &view));
        assert!(one == two, "{quality:?}");
        assert!(one.pixels.iter().any(|byte| *byte != one.pixels[0]), "{quality:?}");
    }
    gpu::assert_silent();
}

#[test]
fn each_of_several_characters_has_its_own_materials_and_textures() {
    let plain = box_person();
    let mapped = TexturedMaterial { normal: Some((0, 0.5)), ..CLOTH };
    let one =
        person(Textured { materials: vec![mapped], colors: vec![squares()], maps: vec![squares()] }, |_| 0);
    let two = person(
        Textured { materials: vec![CLOTH, mapped], colors: vec![squares(); 2], maps: vec![squares()] },
        |vertex| u32::from(vertex.normal.z > 0.5),
    );
    let packed = pack_avatars(&[plain, one, two]);
    let levels = packed.level_count;
    assert_eq!(packed.painted, [levels, 2 * levels], "the finest level of the second and the third");
    let paint = packed.paint.as_ref().unwrap();
    let textured = &paint.textured;
    assert_eq!((textured.materials.len(), textured.colors.len(), textured.maps.len()), (3, 3, 2));
    let layers = |number: usize| (textured.materials[number].color, textured.materials[number].normal);
    assert_eq!(layers(0), (Some(0), Some((0, 0.5))));
    assert_eq!((layers(1), layers(2)), ((Some(1), None), (Some(1), Some((1, 0.5)))));
    for (bucket, first) in [(levels, 0), (2 * levels, 1)] {
        let mesh = packed.mesh_table[bucket as usize];
        let [from, count] = [mesh.first_vertex, mesh.vertex_count].map(|number| number as usize);
        let own = &paint.corners[from..from + count];
        assert_eq!(own.iter().map(|corner| corner.material).min(), Some(first));
        assert_eq!(own.iter().map(|corner| corner.material).max(), Some(2 * first));
        let position = packed.vertices[4 * from];
        assert!((own[0].uv.x - 0.5 * SQUARES * position[0]).abs() < 1e-6);
    }
}

#[test]
fn a_file_with_textures_walks_in_a_scene_and_is_sharp_at_a_metre_in_its_agents_colours() {
    let file = textured::textured(&glb(&generated(Sex::Male)), &[squares()], |json| {
        for material in json["materials"].as_array_mut().unwrap() {
            if material["name"] == "gaitway.top" {
                material["name"] = "shirt".into();
                material["pbrMetallicRoughness"]["baseColorFactor"] = json!([1.0, 1.0, 1.0, 1.0]);
                material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
            }
        }
    });
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("man.glb"), file).unwrap();
    let text = "name = \"shirt\"\nseed = 4\nbounds = [[-9, -9], [9, -9], [9, 9], [-9, 9]]\n[user]\navoided = false\n\
                [population]\nagents = 0\navatars = [\"man.glb\"]\n[[walkers]]\nposition = [0.0, 0.0]\n";
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    for quality in [Quality::Low, Quality::Medium] {
        let scene = Scene::load(path.to_str().unwrap()).unwrap().build().unwrap();
        let settings = Settings { quality, atmosphere: flat(), ..Settings::sized(600, 600) };
        let Some(mut stage) = gpu::on_device(Stage::new(scene, settings)) else { return };
        stage.step(30).unwrap();
        let chest = Vec3::new(0.0, 1.25, 0.0);
        let heading = stage.scene.crowd.agents[0].heading;
        let ahead = Vec3::new(heading.sin(), 0.0, heading.cos());
        let camera = Camera::look_at(chest + 1.1 * ahead, chest, Vec3::Y).with_fov(0.25);
        let image = stage.picture(&camera).unwrap();
        keep(&format!("painted_shirt_{quality:?}"), &image);
        // how many pixels have the one colour more than the other, and how many lie between
        let hue =
            |pixel: &[u8]| (f32::from(pixel[0]) - f32::from(pixel[2])) / f32::from(pixel[0].max(pixel[2]));
        let hues: Vec<f32> = image.pixels.chunks_exact(4).map(hue).collect();
        let share =
            |is: &dyn Fn(f32) -> bool| hues.iter().filter(|hue| is(**hue)).count() as f32 / hues.len() as f32;
        let [red, blue] = [share(&|hue| hue > 0.6), share(&|hue| hue < -0.6)];
        println!("{quality:?}: {red:.2} are red, {blue:.2} are blue");
        // along either axis one texel in 32 lies between two squares
        assert!(red > 0.3 && blue > 0.3 && red + blue > 0.93, "{quality:?}: {red} {blue}");
    }
    gpu::assert_silent();
}
