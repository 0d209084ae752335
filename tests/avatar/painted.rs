//! Characters with textures: what the loader keeps of them, and what it leaves out with a word.

use crate::common::textured::{TILES, squares, textured};
use gaitway::avatar::{Avatar, Loaded, Paint, RigMap, Sex, generated, glb, load_bytes};
use gaitway::render::Image;
use glam::{Vec2, Vec3};
use serde_json::{Value, json};
use std::f32::consts::FRAC_PI_2;

const COLORS: [[u8; 4]; 2] = [[200, 60, 50, 255], [40, 70, 190, 255]];

fn loaded(images: &[Image], edit: impl Fn(&mut Value)) -> Loaded {
    let file = textured(&glb(&generated(Sex::Male)), images, edit);
    load_bytes("man", &file, None, &RigMap::default()).unwrap()
}

/// What all materials have.
fn each(json: &mut Value, edit: impl Fn(&mut Value)) {
    json["materials"].as_array_mut().unwrap().iter_mut().for_each(edit);
}

fn color(material: &mut Value) {
    material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
    material["name"] = "cloth".into();
}

fn paint(avatar: &Avatar) -> &Paint {
    avatar.paint.as_ref().unwrap()
}

fn says(loaded: &Loaded, words: &str) -> bool {
    loaded.report.iter().any(|line| line.contains(words))
}

#[test]
fn textures_are_kept_for_the_finest_level_and_looked_up_at_the_vertices_of_the_others() {
    let man = generated(Sex::Male);
    let plain = load_bytes("man", &glb(&man), None, &RigMap::default()).unwrap().avatar;
    assert!(plain.paint.is_none(), "who has no textures costs nothing");
    let loaded = loaded(&[squares(COLORS)], |json| each(json, color));
    assert!(says(&loaded, "1 of colours, 0 of normals"), "{:?}", loaded.report);
    let avatar = &loaded.avatar;
    let Paint { corners, textured } = paint(avatar);
    assert_eq!((textured.colors.len(), textured.maps.len()), (1, 0));
    assert_eq!(textured.colors[0], squares(COLORS));
    let finest = &avatar.levels[0];
    assert_eq!(corners.len(), finest.vertices.len());
    for (corner, vertex) in corners.iter().zip(&finest.vertices) {
        let wanted = TILES * Vec2::new(vertex.position.x, -vertex.position.y);
        assert!(corner.uv.distance(wanted) < 1e-3, "{corner:?} {vertex:?}");
        let material = &textured.materials[corner.material as usize];
        assert_eq!((material.color, material.is_blended), (Some(0), false));
    }
    // what a vertex has of its own, times a texel, is what the coarser levels are coloured with
    let linear = COLORS.map(|color| Vec3::from([color[0], color[1], color[2]].map(from_srgb)));
    let is_texel = |corner: (&gaitway::avatar::PaintCorner, &gaitway::avatar::Vertex)| {
        let own = corner.0.color.truncate();
        linear.iter().any(|texel| (own * *texel).distance(corner.1.color) < 1e-4)
    };
    assert!(corners.iter().zip(&finest.vertices).all(is_texel));
    assert_eq!(finest.indices.len(), plain.levels[0].indices.len());
}

fn from_srgb(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn cut_outs_keep_all_their_triangles_near_by_and_lose_holes_farther_away() {
    let mut with_holes = squares(COLORS);
    with_holes.fill(32, 0, 32, 32, [0; 4]);
    with_holes.fill(0, 32, 32, 32, [0; 4]);
    let masked = |image: Image| {
        loaded(&[image], |json| {
            each(json, |material| {
                color(material);
                (material["alphaMode"], material["alphaCutoff"]) = ("MASK".into(), 0.25.into());
                material["doubleSided"] = true.into();
            });
        })
    };
    let [whole, holes] = [squares(COLORS), with_holes].map(masked).map(|loaded| loaded.avatar);
    let material = &paint(&holes).textured.materials[0];
    assert_eq!((material.cutoff, material.is_two_sided, material.is_blended), (0.25, true, false));
    let triangles = |avatar: &Avatar, level: usize| avatar.levels[level].indices.len() / 3;
    assert_eq!(triangles(&whole, 0), triangles(&holes, 0));
    let area = |avatar: &Avatar| -> f32 {
        let mesh = &avatar.levels[1];
        let at = |corner: u32| mesh.vertices[corner as usize].position;
        let three = mesh.indices.chunks_exact(3).map(|t| [at(t[0]), at(t[1]), at(t[2])]);
        three.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    };
    assert!(area(&holes) < 0.8 * area(&whole), "{} of {}", area(&holes), area(&whole));
}

#[test]
fn maps_are_kept_by_their_kind_and_those_that_cannot_be_used_are_left_out_with_a_word() {
    let images = [squares(COLORS), Image::filled(4, 4, [128, 128, 255, 255]), Image::filled(2, 2, [9; 4])];
    let mapped = |edit: &dyn Fn(&mut Value)| {
        loaded(&images, |json| {
            each(json, |material| {
                color(material);
                material["normalTexture"] = json!({ "index": 1, "scale": 0.5 });
                material["occlusionTexture"] = json!({ "index": 2, "strength": 0.75 });
                material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({ "index": 2 });
            });
            edit(json);
        })
    };
    let all = mapped(&|_| {});
    let textured = &paint(&all.avatar).textured;
    let material = &textured.materials[0];
    assert_eq!((textured.colors.len(), textured.maps.len()), (1, 2), "one image is used twice");
    let [normal, others] = [Image::filled(4, 4, [128, 128, 255, 255]), Image::filled(2, 2, [9; 4])];
    let map = |number: u32| &textured.maps[number as usize];
    let is = |found: Option<(u32, f32)>, image: &Image, share: f32| {
        found.is_some_and(|(layer, own)| map(layer) == image && own.to_bits() == share.to_bits())
    };
    assert!(is(material.normal, &normal, 0.5) && is(material.occlusion, &others, 0.75));
    assert!(material.rough.is_some_and(|layer| map(layer) == &others));

    let second = mapped(&|json| each(json, |material| material["normalTexture"]["texCoord"] = 1.into()));
    assert!(says(&second, "1 of its textures use other coordinates"), "{:?}", second.report);
    assert!(paint(&second.avatar).textured.materials[0].normal.is_none());

    let broken = mapped(&|json| json["images"][1] = json!({ "uri": "gone.png" }));
    assert!(says(&broken, "image 1"), "{:?}", broken.report);
    let textured = &paint(&broken.avatar).textured;
    assert!(textured.materials[0].normal.is_none() && textured.materials[0].color == Some(0));

    // of what is left the first says which coordinates count
    let others = mapped(&|json| {
        json["images"][0] = json!({ "uri": "gone.png" });
        each(json, |material| {
            material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1.into();
        });
    });
    let Paint { corners, textured } = paint(&others.avatar);
    assert!(textured.materials[0].color.is_none() && textured.materials[0].normal.is_some());
    let vertices = &others.avatar.levels[0].vertices;
    assert!(
        corners.iter().zip(vertices).all(|(corner, v)| (corner.uv.x - TILES * v.position.x).abs() < 1e-3)
    );

    let none = loaded(&images[..1], |json| {
        each(json, color);
        json["images"][0] = json!({ "uri": "gone.png" });
    });
    assert!(none.avatar.paint.is_none() && says(&none, "image 0"), "{:?}", none.report);
}

#[test]
fn transforms_of_textures_move_coordinates_of_pixels_and_of_vertices() {
    // a quarter turn counter-clockwise, seen with v downwards, after the scale: (u, v) to (v, -u)
    let transform = json!({ "KHR_texture_transform": { "offset": [0.25, 0.5], "rotation": FRAC_PI_2, "scale": [2.0, 3.0] } });
    let images = [squares(COLORS), Image::filled(4, 4, [128, 128, 255, 255])];
    let moved = |of_normal: Value| {
        loaded(&images, |json| {
            json["extensionsUsed"] = json!(["KHR_texture_transform"]);
            json["extensionsRequired"] = json!(["KHR_texture_transform"]);
            each(json, |material| {
                color(material);
                material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = transform.clone();
                material["normalTexture"] = json!({ "index": 1, "extensions": of_normal });
            });
        })
    };
    let both = moved(transform.clone());
    assert!(both.report.iter().all(|line| !line.contains("left out")), "{:?}", both.report);
    let Paint { corners, textured } = paint(&both.avatar);
    assert!(textured.materials[0].normal.is_some());
    let vertices = &both.avatar.levels[0].vertices;
    assert_eq!(corners.len(), vertices.len());
    for (corner, vertex) in corners.iter().zip(vertices) {
        let [u, v] = [TILES * vertex.position.x, -TILES * vertex.position.y];
        let want = [0.25 + 3.0 * v, 0.5 - 2.0 * u];
        assert!(
            (corner.uv.x - want[0]).abs() < 2e-3 && (corner.uv.y - want[1]).abs() < 2e-3,
            "{:?}, not {want:?}",
            corner.uv
        );
    }
    // a map that lies elsewhere than the colours
    let colors_alone = moved(json!({}));
    assert!(says(&colors_alone, "1 of its textures"), "{:?}", colors_alone.report);
    assert!(paint(&colors_alone.avatar).textured.materials[0].normal.is_none());
    // and one of no numbers
    let broken = moved(json!({ "KHR_texture_transform": { "offset": "left" } }));
    assert!(says(&broken, "KHR_texture_transform: invalid type"), "{:?}", broken.report);
    assert!(paint(&broken.avatar).textured.materials[0].normal.is_none());
}

#[test]
fn colours_of_vertices_are_looked_up_where_a_transform_says() {
    let shades = |image: Image, transform: Value| -> Vec<Vec3> {
        let file = loaded(&[image], |json| {
            each(json, |material| {
                color(material);
                material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = transform.clone();
            });
        });
        file.avatar.levels[0].vertices.iter().map(|vertex| vertex.color).collect()
    };
    // all of the person lies on one square of the texture
    for (offset, square) in [(0.25, COLORS[0]), (0.75, COLORS[1])] {
        let transform = json!({ "KHR_texture_transform": { "offset": [offset, 0.0], "scale": [0.0, 0.0] } });
        let plain = shades(Image::filled(4, 4, square), json!({}));
        assert_eq!(shades(squares(COLORS), transform), plain);
    }
}
