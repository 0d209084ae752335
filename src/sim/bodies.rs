//! Avatars and clips as the flat buffers that kernels and draw shaders read; `shaders/shared/body.wgsl` states the
//! layouts. [`fill`] gives a simulation everything that its frames need.

use super::avatar_set::AvatarSet;
use super::outfits::outfits;
use crate::avatar::foot::{Footprint, footprints, with_toes};
use crate::avatar::waist::{bones, with_waist};
use crate::avatar::wardrobe::Outfit;
use crate::avatar::{
    Avatar, Clip, ClipFrame, FaceVertex, FarVertex, LEVELS, Mesh, Paint, PaintCorner, Posture, RestJoint,
    Textured, TexturedMaterial, Vertex,
};
use crate::kernels::Store;
use crate::kernels::gaze_schedule::index::COUNTS;
use crate::kernels::layout::{Expression, FarPose, FrameUniforms, MeshRange, Physique};
use crate::kernels::shared::block::BLOCK;
use crate::kernels::shared::body::MATERIAL_BITS;
use crate::kernels::shared::body::index::{
    CLIP_ROWS, FACE_STRIDE, PALETTE_STRIDE, POSE_STRIDE, VERTEX_STRIDE,
};
use crate::kernels::shared::ranks::index::COLUMNS;
use crate::kernels::shared::scan::index::LANES;
use crate::reference::body::far_slot;
use crate::scenario::{Budget, EnvironmentMesh, Gaze, GazeMode};
use glam::Vec3;

/// Most agents that one frame shows with a pose; agents beyond are far bodies.
const MOST_VISIBLE: u64 = 100_000;
/// Most bytes of skinned vertices; agents beyond are drawn in the second level of detail.
const MOST_SKINNED: u64 = 48 << 20;
/// Storage buffers of this size can be bound by every Vulkan device.
pub const SMALLEST_STORAGE_RANGE: u64 = 128 << 20;
/// Nearer than the first two an agent is drawn in level 0 or 1 at high quality; farther than the third it is not drawn, m. Between
/// the second and the third lies the distance from which on far bodies are drawn: a person is then [`FAR_PIXELS`] high.
pub const LEVEL_DISTANCES: [f32; 3] = [8.0, 20.0, 2000.0];
/// People below this height are drawn as far bodies at high quality, pixels.
pub const FAR_PIXELS: f32 = 16.0;
/// Far bodies below this height are specks, pixels.
pub const SPECK_PIXELS: f32 = 7.0;
/// Most tiles of the depth of one eye's image for the occlusion test.
pub const MOST_TILES: usize = 1 << 18;
/// Most blocks of them: even an image of one column has no more.
const MOST_BLOCKS: usize = MOST_TILES / BLOCK as usize;
/// Radius about an agent's axis that limbs in motion stay within, m.
const REACH: f32 = 0.8;
/// Room above the standing height for the bounce of a walk, m.
const HEADROOM: f32 = 0.15;

/// All meshes of a set of avatars, one after another; bucket = avatar * `level_count` + level, and behind all of these a
/// far body of each avatar, then a speck of each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshBuffers {
    /// `mesh_vertices`: `[vertex][4]`. Position and material (bits); normal and four joints of eight bits (bits); weights;
    /// linear colour and alpha.
    pub vertices: Vec<[f32; 4]>,
    /// Indices of all meshes, each counted from its mesh's first vertex.
    pub indices: Vec<u32>,
    /// `face_moves`: `[face vertex][9]`, of all finest meshes.
    pub face_moves: Vec<[f32; 4]>,
    /// `mesh_table`: `[bucket]`, then `[avatar]` for the far bodies and for the specks.
    pub mesh_table: Vec<MeshRange>,
    /// `[bucket]`: what a body of scale 1 stays within, see [`crate::avatar::FarMesh::bounds`]; 0 of buckets with a pose.
    pub bounds: Vec<[[f32; 4]; 2]>,
    /// Levels of detail: those of the avatar with the most. An avatar with fewer repeats its coarsest.
    pub level_count: u32,
    /// Robots and vehicles.
    pub outsiders: Vec<OutsiderMesh>,
    /// What characters with textures are painted with; its vertices are numbered as `vertices`.
    #[doc(hidden)]
    pub paint: Option<Paint>,
    /// Buckets of their finest meshes, in order.
    #[doc(hidden)]
    pub painted: Vec<u32>,
    /// What outfits do to vertices, numbered as `vertices`: see [`crate::avatar::wardrobe::Tailoring::word`]. Those past its end
    /// are the same in all.
    #[doc(hidden)]
    pub tailoring: Vec<u32>,
    /// What agents wear; those past its end wear their avatar's own outfit.
    #[doc(hidden)]
    pub outfits: Vec<Outfit>,
}

/// A mesh and the agents that are drawn as it.
#[derive(Debug, Clone, PartialEq)]
pub struct OutsiderMesh {
    /// About the origin, standing on y = 0, front towards +z, m.
    pub mesh: EnvironmentMesh,
    /// Agents.
    pub agents: Vec<u32>,
}

impl MeshBuffers {
    /// Vertices of the largest mesh of level 0: `skinned` holds that many for every near agent.
    pub fn most_near_vertices(&self) -> u32 {
        self.mesh_table[..self.bucket_count() as usize]
            .iter()
            .step_by(self.level_count.max(1) as usize)
            .map(|mesh| mesh.vertex_count)
            .max()
            .unwrap_or(0)
    }

    /// Adds what the next mesh, which is a finest one, is painted with.
    fn add_paint(&mut self, own: &Paint, vertices: usize) {
        let length = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        self.painted.push(length(self.mesh_table.len()));
        let paint = self.paint.get_or_insert_default();
        let Textured { materials, colors, maps } = &mut paint.textured;
        let [first, first_color, first_map] = [materials.len(), colors.len(), maps.len()].map(length);
        let color = |number: u32| first_color + number;
        let map = |number: u32| first_map + number;
        let of_map = |(number, share): (u32, f32)| (map(number), share);
        materials.extend(own.textured.materials.iter().map(|material| TexturedMaterial {
            color: material.color.map(color),
            rough: material.rough.map(map),
            normal: material.normal.map(of_map),
            occlusion: material.occlusion.map(of_map),
            ..*material
        }));
        colors.extend(own.textured.colors.iter().cloned());
        maps.extend(own.textured.maps.iter().cloned());
        paint.corners.resize(self.vertices.len() / VERTEX_STRIDE, PaintCorner::default());
        let corners =
            own.corners.iter().map(|corner| PaintCorner { material: first + corner.material, ..*corner });
        paint.corners.extend(corners.take(vertices));
    }

    fn avatars(&self) -> u32 {
        u32::try_from(self.mesh_table.len()).unwrap_or(u32::MAX) / (self.level_count + 2)
    }

    /// Number of buckets of far bodies and specks.
    pub fn far_count(&self) -> u32 {
        2 * self.avatars()
    }

    /// Number of buckets of agents with a pose.
    pub fn bucket_count(&self) -> u32 {
        self.avatars() * self.level_count
    }

    /// Triangles of one agent in a bucket.
    pub fn triangles(&self, bucket: usize) -> u32 {
        self.mesh_table.get(bucket).map_or(0, |mesh| mesh.index_count / 3)
    }
}

/// Lays the meshes of all avatars out for the device.
///
/// An index that points past its mesh's vertices, and what is left of a triangle, is left out with its triangle, so that
/// no draw reads another mesh.
pub fn pack_avatars(avatars: &[Avatar]) -> MeshBuffers {
    pack(avatars, &[])
}

/// The posture of each clip of a cast.
fn postures_of(cast: &AvatarSet) -> Vec<Posture> {
    let of_avatar = cast.clips().len() / cast.avatars().len().max(1);
    let of_clip = |(number, clip)| {
        cast.avatars().get(number / of_avatar.max(1)).map_or_else(Posture::default, |a| Posture::of(a, clip))
    };
    cast.clips().iter().enumerate().map(of_clip).collect()
}

/// The same with the postures that far bodies may take.
fn pack(avatars: &[Avatar], postures: &[Posture]) -> MeshBuffers {
    let levels = avatars.iter().map(|avatar| avatar.levels.len()).max().unwrap_or(0).clamp(1, LEVELS);
    let mut out = MeshBuffers { level_count: u32::try_from(levels).unwrap_or(1), ..MeshBuffers::default() };
    for avatar in avatars {
        let mut coarsest = MeshRange::default();
        let prints = footprints(avatar);
        for level in 0..levels {
            if let Some(mesh) = avatar.levels.get(level) {
                let mut vertices = mesh_elements(mesh, &prints);
                if level == 0 {
                    number_face(&mut vertices, &avatar.face, &mut out.face_moves);
                    if let Some(paint) = &avatar.paint {
                        out.add_paint(paint, mesh.vertices.len());
                    }
                }
                let mut indices = mesh.indices.clone();
                if let Some(wardrobe) = &avatar.wardrobe
                    && let Some(clothes) = wardrobe.levels.get(level)
                {
                    out.add_clothes(clothes, wardrobe.collar, mesh.vertices.len());
                    let first = u32::try_from(mesh.vertices.len()).unwrap_or(u32::MAX);
                    vertices.extend(mesh_elements(&clothes.others, &prints));
                    indices.extend(clothes.others.indices.iter().map(|index| first + index));
                }
                coarsest = append(vertices, &indices, &mut out);
            }
            out.mesh_table.push(coarsest);
        }
    }
    out.bounds = vec![[[0.0; 4]; 2]; out.mesh_table.len()];
    let far_meshes = avatars.iter().map(Avatar::far_body).chain(avatars.iter().map(Avatar::speck));
    for far in far_meshes {
        out.bounds.push(far.bounds(postures));
        let vertices = far.vertices.iter().flat_map(far_elements).collect();
        let mesh = append(vertices, &far.indices, &mut out);
        out.mesh_table.push(mesh);
    }
    out
}

fn mesh_elements(mesh: &Mesh, prints: &[Footprint; 2]) -> Vec<[f32; 4]> {
    mesh.vertices
        .iter()
        .map(|vertex| with_waist(with_toes(*vertex, prints)))
        .flat_map(|v| vertex_elements(&v))
        .collect()
}

/// Adds what an expression moves, and gives its vertices their numbers there. Vertices that the mesh does not have are left out.
pub(crate) fn number_face(vertices: &mut [[f32; 4]], face: &[FaceVertex], moves: &mut Vec<[f32; 4]>) {
    for own in face {
        let Some([_, _, _, material]) = vertices.get_mut(own.vertex as usize * VERTEX_STRIDE) else {
            continue;
        };
        moves.extend(face_elements(own));
        let number = u32::try_from(moves.len() / FACE_STRIDE).unwrap_or(0);
        *material = f32::from_bits(material.to_bits() | number << MATERIAL_BITS);
    }
}

/// What an expression moves as it lies in `face_moves`.
fn face_elements(own: &FaceVertex) -> [[f32; 4]; FACE_STRIDE] {
    let own = *own;
    [
        own.inner_brow,
        own.outer_brow,
        own.corners_up,
        own.corners_down,
        own.opened,
        own.pressed,
        own.fist,
        own.fist_normal,
        own.blink,
    ]
    .map(|way| way.extend(0.0).to_array())
}

/// Adds a mesh; its line of the table.
fn append(vertices: Vec<[f32; 4]>, indices: &[u32], out: &mut MeshBuffers) -> MeshRange {
    let length = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let (first_index, first_vertex) = (length(out.indices.len()), length(out.vertices.len() / VERTEX_STRIDE));
    let count = length(vertices.len() / VERTEX_STRIDE);
    out.vertices.extend(vertices);
    let whole = indices.chunks_exact(3).filter(|triangle| triangle.iter().all(|index| *index < count));
    out.indices.extend(whole.flatten());
    MeshRange {
        first_index,
        index_count: length(out.indices.len()) - first_index,
        first_vertex,
        vertex_count: count,
    }
}

/// `rig`: `[avatar][100]`. Per joint the rest translation in its parent, then three rows of `joint_from_mesh`; then the
/// midpoint of the eyes in the head joint; where the toes bend, left and right, in the mesh, and how long they are; the left
/// eyeball's centre in the mesh, and whether there is one; last the joints' places in the mesh, then the directions of their
/// bones there. Metres.
pub fn pack_rig(avatars: &[Avatar]) -> Vec<[f32; 4]> {
    let joint = |joint: &RestJoint| {
        let row = |axis| joint.joint_from_mesh.row(axis).to_array();
        [joint.translation.extend(0.0).to_array(), row(0), row(1), row(2)]
    };
    let elements = |avatar: &Avatar| {
        let eyes = avatar.eyes_in_head.extend(0.0).to_array();
        let balls = footprints(avatar).map(Footprint::in_rig);
        let eyeball = avatar.eyeball.map_or([0.0; 4], |left| left.extend(1.0).to_array());
        let bones = bones(avatar).map(|bone| bone.map(|part| part.extend(0.0).to_array()));
        let of_joints = avatar.joints.iter().flat_map(joint);
        of_joints
            .chain([eyes])
            .chain(balls)
            .chain([eyeball])
            .chain(bones.into_iter().flatten())
            .collect::<Vec<_>>()
    };
    avatars.iter().flat_map(elements).collect()
}

/// A vertex as it lies in `mesh_vertices`.
fn vertex_elements(vertex: &Vertex) -> [[f32; 4]; VERTEX_STRIDE] {
    [
        vertex.position.extend(f32::from_bits(vertex.material as u32)).to_array(),
        vertex.normal.extend(f32::from_bits(u32::from_le_bytes(vertex.joints))).to_array(),
        vertex.weights,
        vertex.color.extend(vertex.alpha).to_array(),
    ]
}

/// A vertex of a far body as it lies there.
fn far_elements(vertex: &FarVertex) -> [[f32; 4]; VERTEX_STRIDE] {
    [
        vertex.position.extend(f32::from_bits(vertex.material as u32)).to_array(),
        vertex.normal.extend(f32::from_bits(vertex.limb as u32)).to_array(),
        vertex.hinge.extend(vertex.swing).to_array(),
        vertex.color.extend(vertex.hips).to_array(),
    ]
}

/// `clip_frames`: `[clip][64 frames and their mean][17]`. 16 local rotations, then the root's position and the clip's travel, m.
pub fn pack_clips(clips: &[Clip]) -> Vec<[f32; 4]> {
    let mut rows = Vec::with_capacity(clips.len() * CLIP_ROWS * POSE_STRIDE);
    for clip in clips {
        for frame in clip.frames.iter().chain([&ClipFrame::mean(&clip.frames)]) {
            rows.extend(frame.rotations.map(|rotation| rotation.to_array()));
            rows.push(frame.root.extend(clip.stride_travel).to_array());
        }
    }
    rows
}

/// Fills every buffer that frames of a crowd need, in capacities that fit buffers of `storage_range` bytes.
///
/// Returns the meshes for the renderer; the store's `frame` then holds everything that does not depend on the camera.
pub fn fill(store: &mut Store, cast: &AvatarSet, storage_range: u64) -> MeshBuffers {
    let postures = postures_of(cast);
    let mut meshes = pack(cast.avatars(), &postures);
    let agents = store.step.agent_count as usize;
    meshes.outsiders = outsiders(cast, agents);
    meshes.outfits = outfits(store, cast);
    let fits = |stride: u64, most: u64| storage_range.min(most) / stride.max(1);
    let visible = fits(PALETTE_STRIDE as u64 * 16, u64::MAX).min(MOST_VISIBLE).min(agents as u64) as usize;
    let near_vertices = meshes.most_near_vertices() as usize;
    let near =
        fits((near_vertices * size_of::<[u32; 4]>()) as u64, MOST_SKINNED).min(visible as u64) as usize;
    // who has no build has its avatar's
    store.physique.resize(agents, Physique::default());
    store.rig = pack_rig(cast.avatars());
    store.clip_frames = pack_clips(cast.clips());
    store.clip_postures = postures.into_iter().map(Posture::in_buffer).collect();
    store.far_poses = vec![FarPose::default(); agents];
    store.mesh_vertices.clone_from(&meshes.vertices);
    store.face_moves.clone_from(&meshes.face_moves);
    store.mesh_table = meshes.mesh_table.clone();
    store.agent_bucket = vec![0; agents];
    store.bucket_counts = vec![0; (agents.div_ceil(LANES) + 1) * COLUMNS];
    store.bucket_start = vec![0; meshes.mesh_table.len() + 2];
    store.visible = vec![u32::MAX; far_slot(visible) + agents];
    store.draw_args = vec![0; 2 * meshes.mesh_table.len() * 5];
    store.wanted = vec![0; 2 * MOST_BLOCKS];
    store.tile_depth = vec![0.0; 2 * MOST_TILES];
    store.hidden = vec![0; store.visible.len()];
    store.shown = vec![0; store.visible.len()];
    store.group_shown = vec![0; agents.div_ceil(LANES) + 1];
    store.bucket_shown = vec![0; meshes.mesh_table.len() + 1];
    store.shown_args = vec![0; meshes.mesh_table.len() * 5];
    store.attention_counts = vec![0; COUNTS];
    store.dispatch_args = vec![0; 3 + cast.avatars().len() * 3];
    store.local_rotations = vec![[0.0; 4]; visible * POSE_STRIDE];
    store.palettes = vec![[0.0; 4]; visible * PALETTE_STRIDE];
    store.expressions = vec![Expression::default(); visible];
    store.skinned = vec![[0; 4]; near * near_vertices];
    let [first, second, farthest] = LEVEL_DISTANCES;
    let mut standing_clips = [[0; 4]; 4];
    for (place, avatar) in standing_clips.as_flattened_mut().iter_mut().zip(0..cast.avatars().len() as u32) {
        *place = cast.standing_index(avatar);
    }
    store.frame = FrameUniforms {
        level_distance: [first, second, farthest, 0.0],
        standing_clips,
        agent_count: store.step.agent_count,
        eye_count: 1,
        level_count: meshes.level_count,
        bucket_count: meshes.bucket_count(),
        visible_capacity: visible as u32,
        near_capacity: near as u32,
        agent_height: cast.avatars().iter().map(Avatar::top).fold(0.0, f32::max) + HEADROOM,
        agent_radius: REACH,
        clip_count: cast.clips().len() as u32,
        ..FrameUniforms::default()
    };
    meshes
}

/// The same frame with the user's eyes (world, m) as the target of gazes, or with no target.
pub fn looking_at(frame: FrameUniforms, user_eyes: Option<Vec3>) -> FrameUniforms {
    match user_eyes {
        Some(eyes) => FrameUniforms { user_eyes: eyes.extend(0.0).to_array(), ..frame },
        None => FrameUniforms { gaze_limit: limit_of(Budget::Most(0)), ..frame },
    }
}

/// Robots and vehicles: outsiders are the last agents.
fn outsiders(cast: &AvatarSet, agents: usize) -> Vec<OutsiderMesh> {
    let bodies = cast.outsiders();
    let first = agents.saturating_sub(bodies.mesh_of.len());
    let drawn_as = |number: usize| {
        let of = (first..).zip(&bodies.mesh_of).filter(move |(_, mesh)| **mesh == Some(number));
        of.map(|(agent, _)| agent as u32).collect()
    };
    bodies
        .meshes
        .iter()
        .enumerate()
        .map(|(number, mesh)| OutsiderMesh { mesh: mesh.clone(), agents: drawn_as(number) })
        .collect()
}

/// Sets the formulas of the gaze, how many agents look at the user at a time, and for how long.
pub fn set_gaze(frame: &mut FrameUniforms, gaze: &Gaze) {
    frame.gaze_mode = u32::from(gaze.mode == GazeMode::Paper);
    frame.gaze_limit = limit_of(gaze.effective_budget());
    [frame.turn_least, frame.turn_most] = gaze.turn.map(|seconds| (seconds * 1e3) as u32);
}

/// The limit in the kernels' form for agents that may look at the user: 0 is all of them, otherwise one more than may.
const fn limit_of(budget: Budget) -> u32 {
    match budget {
        Budget::All => 0,
        Budget::Most(count) => count.saturating_add(1),
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "numbers are copied")]
mod tests {
    use super::*;
    use crate::avatar::Material;
    use crate::gait::JOINT_COUNT;
    use crate::kernels::shared::body::index::{RIG_EYES, RIG_STRIDE};
    use glam::{Mat4, Quat, Vec3};

    fn mesh(vertices: usize, indices: &[u32]) -> Mesh {
        let vertex = Vertex {
            position: Vec3::new(1.0, 2.0, 3.0),
            normal: Vec3::Y,
            color: Vec3::splat(0.5),
            alpha: 0.75,
            material: Material::Top,
            joints: [1, 2, 3, 4],
            weights: [0.4, 0.3, 0.2, 0.1],
        };
        Mesh { vertices: vec![vertex; vertices], indices: indices.to_vec() }
    }

    fn avatar(levels: Vec<Mesh>) -> Avatar {
        let joint = RestJoint {
            translation: Vec3::new(0.1, 0.2, 0.3),
            rotation: Quat::IDENTITY,
            joint_from_mesh: Mat4::from_translation(Vec3::new(7.0, 8.0, 9.0)),
        };
        Avatar {
            name: "test".to_owned(),
            joints: [joint; JOINT_COUNT],
            levels,
            eyes_in_head: Vec3::new(0.0, 0.1, 0.2),
            eyeball: None,
            face: Vec::new(),
            height: 1.7,
            paint: None,
            wardrobe: None,
        }
    }

    /// Lines of the table: first index, index count, first vertex, vertex count.
    fn ranges(packed: &MeshBuffers, buckets: std::ops::Range<usize>) -> Vec<[u32; 4]> {
        packed.mesh_table[buckets].iter().map(|range| bytemuck::cast(*range)).collect()
    }

    #[test]
    fn meshes_stand_one_after_another_and_indices_count_from_their_own_first_vertex() {
        let a = avatar(vec![mesh(4, &[0, 1, 2, 2, 1, 3]), mesh(3, &[0, 1, 2])]);
        let b = avatar(vec![mesh(5, &[4, 3, 2])]);
        let packed = pack_avatars(&[a, b]);
        assert_eq!(packed.level_count, 2);
        assert_eq!(ranges(&packed, 0..4), [[0, 6, 0, 4], [6, 3, 4, 3], [9, 3, 7, 5], [9, 3, 7, 5]]);
        assert_eq!(packed.indices, [0, 1, 2, 2, 1, 3, 0, 1, 2, 4, 3, 2]);
        assert_eq!(packed.vertices.len(), 48);
        // of meshes without height no far body can be made
        assert_eq!(ranges(&packed, 4..8), [[12, 0, 12, 0]; 4]);
        assert_eq!(packed.far_count(), 4);
        assert_eq!((packed.most_near_vertices(), packed.bucket_count(), packed.triangles(0)), (5, 4, 2));
        let v = &packed.vertices;
        assert_eq!(v[0][3].to_bits(), 3, "material");
        assert_eq!(v[1][3].to_bits(), 0x0403_0201, "joints");
        assert_eq!((v[0][2], v[2], v[3]), (3.0, [0.4, 0.3, 0.2, 0.1], [0.5, 0.5, 0.5, 0.75]));
    }

    #[test]
    fn triangles_that_point_outside_their_mesh_are_left_out() {
        let packed = pack_avatars(&[avatar(vec![mesh(3, &[0, 1, 3, 0, 1, 2, 1, 2])])]);
        assert_eq!(packed.indices, [0, 1, 2]);
        assert_eq!(pack_avatars(&[]).mesh_table.len(), 0);
    }

    #[test]
    fn the_rig_holds_translation_and_rows_per_joint_and_the_eyes_last() {
        let rig = pack_rig(&[avatar(vec![]), avatar(vec![])]);
        assert_eq!(rig.len(), 2 * RIG_STRIDE);
        assert_eq!(
            rig[4..8],
            [[0.1, 0.2, 0.3, 0.0], [1.0, 0.0, 0.0, 7.0], [0.0, 1.0, 0.0, 8.0], [0.0, 0.0, 1.0, 9.0]]
        );
        assert_eq!(rig[RIG_STRIDE + RIG_EYES], [0.0, 0.1, 0.2, 0.0]);
    }
}
