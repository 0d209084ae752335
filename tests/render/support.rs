//! A device, scenes of boxes and a crowd as the kernels would have written it.

use crate::common::gpu;
use gaitway::avatar::{Avatar, Material, Mesh, RestJoint, Vertex};
use gaitway::gait::JOINT_COUNT;
use gaitway::gpu::{Buffer, Device, Memory};
use gaitway::kernels::layout::FarPose;
use gaitway::kernels::shared::body::index::SKIN_JOINTS;
use gaitway::reference::normal::packed_normal;
use gaitway::render::camera::View;
use gaitway::render::pack::{MeshBuffers, pack_avatars};
use gaitway::render::{Atmosphere, CrowdBuffers, Image, Surface};
use glam::{Mat4, Quat, Vec2, Vec3};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

pub(super) const W: u32 = 320;
pub(super) const H: u32 = 180;

/// The device that the tests share.
pub(super) fn device() -> Option<Arc<Device>> {
    static DEVICE: OnceLock<Option<Arc<Device>>> = OnceLock::new();
    DEVICE.get_or_init(gpu::device).clone()
}

/// Writes the picture where `GAITWAY_PICTURES` says, to be looked at.
pub(super) fn keep(name: &str, image: &Image) {
    if let Some(folder) = std::env::var_os("GAITWAY_PICTURES") {
        let path = PathBuf::from(folder).join(format!("{name}.png"));
        gaitway::export::image::write_png(&path, image).unwrap();
    }
}

/// Every surface shows its own colour: no sun, no haze, the same light from all sides.
pub(super) fn flat() -> Atmosphere {
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
pub(super) struct Boxes {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) colors: Vec<Vec3>,
    /// Layers of what lies flat, none unless all have one.
    pub(super) layers: Vec<u8>,
    pub(super) indices: Vec<u32>,
}

impl Boxes {
    pub(super) fn add(&mut self, low: Vec3, high: Vec3, color: Vec3) -> &mut Self {
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

    pub(super) fn surface(&self) -> Surface<'_> {
        Surface {
            positions: &self.positions,
            normals: &self.normals,
            colors: &self.colors,
            layers: &self.layers,
            materials: &[],
            indices: &self.indices,
        }
    }
}

pub(super) fn at(image: &Image, view: &View, point: Vec3) -> [u8; 3] {
    let p = view.pixel_from_world(0, point, W, H).unwrap();
    let [r, g, b, a] = image.pixel(p.x as u32, p.y as u32).unwrap();
    assert_eq!(a, 255);
    [r, g, b]
}

pub(super) fn near(found: [u8; 3], wanted: [u8; 3]) -> bool {
    found.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 3)
}

/// sRGB of a linear value below the tone curve's shoulder.
pub(super) fn srgb(linear: f32) -> u8 {
    let s = if linear <= 0.0031308 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (s * 255.0).round() as u8
}

/// A wide ground with a tower in the middle.
pub(super) fn tower() -> Boxes {
    let mut boxes = Boxes::default();
    boxes.add(Vec3::new(-20.0, -1.0, -20.0), Vec3::new(20.0, 0.0, 20.0), Vec3::splat(0.4));
    boxes.add(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 3.0, 0.5), Vec3::splat(0.6));
    boxes
}

/// A person of a few boxes, of one joint each; level 1 is a single box.
pub(super) fn box_person() -> Avatar {
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
                    alpha: 1.0,
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
        eyeball: None,
        face: Vec::new(),
        height: 1.7,
        paint: None,
        wardrobe: None,
    }
}

/// What the kernels would have written.
pub(super) struct HandMade {
    pub(super) meshes: MeshBuffers,
    buffers: Vec<Buffer>,
}

impl HandMade {
    /// Agents stand where `places` says; those with `true` are near (level 0), the others at level 1.
    pub(super) fn new(
        device: &Arc<Device>,
        places: &[(Vec2, bool)],
        colors: &[[u32; 4]],
        emotions: &[u32],
    ) -> Self {
        Self::of(device, &box_person(), places, colors, emotions)
    }

    /// The same with another body.
    pub(super) fn of(
        device: &Arc<Device>,
        body: &Avatar,
        places: &[(Vec2, bool)],
        colors: &[[u32; 4]],
        emotions: &[u32],
    ) -> Self {
        let meshes = pack_avatars(std::slice::from_ref(body));
        let mut visible: Vec<u32> = Vec::new();
        let mut starts = vec![0_u32];
        for near in [true, false] {
            visible.extend((0..places.len() as u32).filter(|i| places[*i as usize].1 == near));
            starts.push(visible.len() as u32);
        }
        let (mut palettes, mut skinned) = (Vec::<[f32; 4]>::new(), Vec::<[u32; 4]>::new());
        for agent in &visible {
            let (place, near) = places[*agent as usize];
            for _ in 0..SKIN_JOINTS {
                palettes.extend([[1.0, 0.0, 0.0, place.x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, place.y]]);
            }
            if near {
                let mesh = meshes.mesh_table[0];
                for vertex in meshes.vertices.chunks(4).take(mesh.vertex_count as usize) {
                    let (p, n) = (vertex[0], vertex[1]);
                    let [x, y, z] = [p[0] + place.x, p[1], p[2] + place.y].map(f32::to_bits);
                    skinned.push([x, y, z, packed_normal([n[0], n[1], n[2]])]);
                }
            }
        }
        // a free slot as the kernels leave it, and no far bodies
        let count = visible.len();
        visible.resize(count + 3, u32::MAX);
        let draws: Vec<[u32; 5]> = (0..4)
            .map(|b| {
                let mesh = meshes.mesh_table[b];
                let agents = if b < 2 { starts[b + 1] - starts[b] } else { 0 };
                [mesh.index_count, agents, mesh.first_index, mesh.first_vertex, 0]
            })
            .collect();
        let shadows: Vec<_> = [1, 1, 2, 3]
            .into_iter()
            .zip(&draws)
            .map(|(b, draw)| {
                [
                    meshes.mesh_table[b].index_count,
                    draw[1],
                    meshes.mesh_table[b].first_index,
                    meshes.mesh_table[b].first_vertex,
                    0,
                ]
            })
            .collect();
        let draws = [draws, shadows].concat();
        starts.extend([visible.len() as u32; 3]);
        let rgb565 = |hex: u32| (hex >> 8 & 0xf800) | (hex >> 5 & 0x7e0) | (hex >> 3 & 0x1f);
        let look: Vec<[u32; 4]> = (0..places.len())
            .map(|i| {
                let c = colors[i % colors.len()].map(rgb565);
                [emotions[i % emotions.len()] << 8, 1.0_f32.to_bits(), c[0] | c[1] << 16, c[2] | c[3] << 16]
            })
            .collect();
        let position: Vec<[f32; 2]> = places.iter().map(|p| p.0.to_array()).collect();
        let elevation = vec![0.0_f32; position.len()];
        let heading = vec![0.0_f32; position.len()];
        let far_poses = vec![FarPose::default(); position.len()];
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
            ("elevation", bytes(&elevation)),
            ("heading", bytes(&heading)),
            ("far_poses", bytes(&far_poses)),
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

    /// Turns an agent, and puts it on another floor; for what is drawn from these alone.
    pub(super) fn turn(&mut self, agent: usize, heading: f32, elevation: f32) {
        bytemuck::cast_slice_mut::<u8, f32>(self.buffers[10].bytes_mut())[agent] = heading;
        bytemuck::cast_slice_mut::<u8, f32>(self.buffers[9].bytes_mut())[agent] = elevation;
    }

    /// Moves an agent, likewise.
    pub(super) fn put(&mut self, agent: usize, place: [f32; 2]) {
        bytemuck::cast_slice_mut::<u8, f32>(self.buffers[8].bytes_mut())[2 * agent..2 * agent + 2]
            .copy_from_slice(&place);
    }

    pub(super) fn crowd(&self) -> CrowdBuffers<'_> {
        let b = &self.buffers;
        CrowdBuffers {
            engine: None,
            visible: &b[0],
            bucket_start: &b[1],
            draw_args: &b[2],
            mesh_vertices: &b[3],
            mesh_table: &b[4],
            palettes: &b[5],
            skinned: &b[6],
            appearance: &b[7],
            position: &b[8],
            elevation: &b[9],
            heading: &b[10],
            far_poses: &b[11],
        }
    }
}
