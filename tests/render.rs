//! Pictures: what is where, in which colour, and that the validation layer has nothing to say.
#![cfg(feature = "vulkan")]

use gaitway::avatar::{Avatar, Material, Mesh, RestJoint, Vertex};
use gaitway::gait::JOINT_COUNT;
use gaitway::gpu::{Buffer, Device, Memory, Validation, validation_messages};
use gaitway::render::camera::{Camera, View};
use gaitway::render::pack::{MeshBuffers, pack_avatars};
use gaitway::render::{Atmosphere, CrowdBuffers, Image, Markers, Renderer, Settings, Surface};
use glam::{Mat4, Quat, Vec2, Vec3};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

const W: u32 = 320;
const H: u32 = 180;

/// A device with the validation layer where it is installed; `None` (and a line) without Vulkan.
fn open() -> Option<Arc<Device>> {
    let device = Device::open(None, Validation::Sync).or_else(|_| Device::open(None, Validation::Off));
    match device {
        Ok(device) => {
            println!("{device:?} names {}", gaitway::gpu::validation_messages().len());
            Some(device)
        }
        Err(error) if std::env::var_os("GAITWAY_REQUIRE_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            println!("skipped: no Vulkan ({error})");
            None
        }
    }
}

fn device() -> Option<Arc<Device>> {
    static DEVICE: OnceLock<Option<Arc<Device>>> = OnceLock::new();
    DEVICE.get_or_init(open).clone()
}

fn assert_silent() {
    let messages = validation_messages();
    assert!(messages.is_empty(), "{messages:#?}");
}

/// Writes the picture where GAITWAY_PICTURES says, to be looked at.
fn keep(name: &str, image: &Image) {
    if let Some(folder) = std::env::var_os("GAITWAY_PICTURES") {
        let path = PathBuf::from(folder).join(format!("{name}.png"));
        gaitway::export::image::write_png(&path, image).unwrap();
    }
}

/// Every surface shows its own colour: no sun, no haze, the same light from all sides.
fn flat() -> Atmosphere {
    Atmosphere {
        sun: Vec3::ZERO,
        zenith: Vec3::ONE,
        horizon: Vec3::new(0.0, 0.0, 0.2),
        ground_bounce: Vec3::ONE,
        sky_light: Vec3::ONE,
        haze: 0.0,
        exposure: 1.0,
        ..Atmosphere::DAY
    }
}

#[derive(Default)]
struct Boxes {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    colors: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Boxes {
    fn add(&mut self, low: Vec3, high: Vec3, color: Vec3) -> &mut Self {
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for normal in [axis, -axis] {
                let side = Vec3::new(normal.y, normal.z, normal.x);
                let up = normal.cross(side);
                let first = self.positions.len() as u32;
                for (s, u) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    self.positions.push(middle + half * (normal + side * s + up * u));
                    self.normals.push(normal);
                    self.colors.push(color);
                }
                self.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
            }
        }
        self
    }

    fn surface(&self) -> Surface<'_> {
        Surface {
            positions: &self.positions,
            normals: &self.normals,
            colors: &self.colors,
            indices: &self.indices,
        }
    }
}

fn at(image: &Image, view: &View, point: Vec3) -> [u8; 3] {
    let p = view.pixel_from_world(0, point, W, H).unwrap();
    let [r, g, b, a] = image.pixel(p.x as u32, p.y as u32).unwrap();
    assert_eq!(a, 255);
    [r, g, b]
}

fn near(found: [u8; 3], wanted: [u8; 3]) -> bool {
    found.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 3)
}

/// sRGB of a linear value below the tone curve's shoulder.
fn srgb(linear: f32) -> u8 {
    let s = if linear <= 0.0031308 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (s * 255.0).round() as u8
}

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
    }
    assert_silent();
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
    assert_silent();
}

/// A wide ground with a tower in the middle.
fn tower() -> Boxes {
    let mut boxes = Boxes::default();
    boxes.add(Vec3::new(-20.0, -1.0, -20.0), Vec3::new(20.0, 0.0, 20.0), Vec3::splat(0.4));
    boxes.add(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 3.0, 0.5), Vec3::splat(0.6));
    boxes
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
    assert_silent();
}

/// A person of a few boxes, of one joint each; level 1 is a single box.
fn box_person() -> Avatar {
    let joint =
        RestJoint { translation: Vec3::ZERO, rotation: Quat::IDENTITY, joint_from_mesh: Mat4::IDENTITY };
    let part = |parts: &[(Vec3, Vec3, Material, u8)]| {
        let mut mesh = Mesh::default();
        for (low, high, material, joint) in parts {
            let mut boxes = Boxes::default();
            boxes.add(*low, *high, Vec3::ONE);
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(boxes.positions.iter().zip(&boxes.normals).map(|(position, normal)| {
                Vertex {
                    position: *position,
                    normal: *normal,
                    color: Vec3::ONE,
                    material: *material,
                    joints: [*joint; 4],
                    weights: [1.0, 0.0, 0.0, 0.0],
                }
            }));
            mesh.indices.extend(boxes.indices.iter().map(|i| first + i));
        }
        mesh
    };
    let v = Vec3::new;
    let fine = part(&[
        (v(-0.2, 0.0, -0.1), v(0.2, 0.8, 0.1), Material::Bottom, 0),
        (v(-0.25, 0.8, -0.12), v(0.25, 1.4, 0.12), Material::Top, 1),
        (v(-0.1, 1.45, -0.1), v(0.1, 1.7, 0.1), Material::Skin, 3),
    ]);
    let coarse = part(&[(v(-0.25, 0.0, -0.1), v(0.25, 1.7, 0.1), Material::Top, 0)]);
    Avatar {
        name: "boxes".to_owned(),
        joints: [joint; JOINT_COUNT],
        levels: vec![fine, coarse],
        eyes_in_head: Vec3::ZERO,
        height: 1.7,
    }
}

/// What the kernels would have written.
struct HandMade {
    meshes: MeshBuffers,
    buffers: Vec<Buffer>,
}

impl HandMade {
    /// Agents stand where `places` says; those with `true` are near (level 0), the others at level 1.
    fn new(device: &Arc<Device>, places: &[(Vec2, bool)], colors: &[[u32; 4]], emotions: &[u32]) -> Self {
        let meshes = pack_avatars(&[box_person()]);
        let mut visible: Vec<u32> = Vec::new();
        let mut starts = vec![0_u32];
        for near in [true, false] {
            visible.extend((0..places.len() as u32).filter(|i| places[*i as usize].1 == near));
            starts.push(visible.len() as u32);
        }
        let (mut palettes, mut skinned) = (Vec::<[f32; 4]>::new(), Vec::<[f32; 4]>::new());
        for agent in &visible {
            let (place, near) = places[*agent as usize];
            for _ in 0..JOINT_COUNT {
                palettes.extend([[1.0, 0.0, 0.0, place.x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, place.y]]);
            }
            if near {
                let mesh = meshes.mesh_table[0];
                for vertex in &meshes.vertices[..mesh[3] as usize] {
                    let [p, n, ..] = *vertex;
                    skinned.extend([[p[0] + place.x, p[1], p[2] + place.y, 1.0], [n[0], n[1], n[2], 0.0]]);
                }
            }
        }
        // a free slot as the kernels leave it
        let count = visible.len();
        visible.resize(count + 3, u32::MAX);
        let draws: Vec<[u32; 5]> = (0..2)
            .map(|b| {
                let mesh = meshes.mesh_table[b];
                [mesh[1], starts[b + 1] - starts[b], mesh[0], mesh[2], 0]
            })
            .collect();
        let rgb565 = |hex: u32| (hex >> 8 & 0xf800) | (hex >> 5 & 0x7e0) | (hex >> 3 & 0x1f);
        let look: Vec<[u32; 4]> = (0..places.len())
            .map(|i| {
                let c = colors[i % colors.len()].map(rgb565);
                [emotions[i % emotions.len()] << 8, 1.0_f32.to_bits(), c[0] | c[1] << 16, c[2] | c[3] << 16]
            })
            .collect();
        let position: Vec<[f32; 2]> = places.iter().map(|p| p.0.to_array()).collect();
        fn bytes<T: bytemuck::Pod>(x: &[T]) -> &[u8] {
            bytemuck::cast_slice(x)
        }
        let contents = [
            ("visible", bytes(&visible)),
            ("bucket_start", bytes(&starts)),
            ("draw_args", bytes(&draws)),
            ("mesh_vertices", bytes(&meshes.vertices)),
            ("mesh_table", bytes(&meshes.mesh_table)),
            ("palettes", bytes(&palettes)),
            ("skinned", bytes(&skinned)),
            ("look", bytes(&look)),
            ("position", bytes(&position)),
        ];
        let buffers = contents
            .map(|(name, bytes)| {
                let mut buffer = Buffer::new(device, name, bytes.len() as u64, Memory::Upload).unwrap();
                buffer.bytes_mut()[..bytes.len()].copy_from_slice(bytes);
                buffer
            })
            .into();
        Self { meshes, buffers }
    }

    fn crowd(&self) -> CrowdBuffers<'_> {
        let b = &self.buffers;
        CrowdBuffers {
            visible: &b[0],
            bucket_start: &b[1],
            draw_args: &b[2],
            mesh_vertices: &b[3],
            mesh_table: &b[4],
            palettes: &b[5],
            skinned: &b[6],
            look: &b[7],
            position: &b[8],
        }
    }
}

const COLORS: [u32; 4] = [0xc0_8060, 0x20_2020, 0xb0_2020, 0x20_20b0];

fn linear(hex: u32) -> Vec3 {
    let c = |shift: u32| {
        let s = ((hex >> shift) & 0xff) as f32 / 255.0;
        if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055_f32).powf(2.4) }
    };
    Vec3::new(c(16), c(8), c(0))
}

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
    assert!(!is_color(color(-0.5, 1.0), COLORS[2]), "nobody stands between them");
    assert_silent();
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
    let _ = linear(COLORS[0]);
    assert_silent();
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
    assert_silent();
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
    assert_silent();
}

#[test]
fn nothing_is_left_on_the_device_when_a_renderer_goes() {
    let Some(device) = open() else { return };
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
    assert_silent();
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
    assert!(error.contains("16 buckets"), "{error}");
    assert_silent();
}
