//! A small CPU rasteriser: z-buffer, Lambert, orthographic. For looking at avatars, not for measuring.

use gaitway::avatar::{Avatar, ClipFrame, Material, Mesh};
use glam::{Mat4, Vec3};
use std::path::Path;

/// Skinned positions and normals of a level in the pose of `frame`.
pub fn skin(avatar: &Avatar, mesh: &Mesh, frame: &ClipFrame) -> Vec<(Vec3, Vec3)> {
    let model = avatar.model_from_joint(&frame.rotations, frame.root);
    let palette: Vec<Mat4> = model.iter().zip(&avatar.joints).map(|(m, j)| *m * j.joint_from_mesh).collect();
    let blend = |v: &gaitway::avatar::Vertex| {
        let mut position = Vec3::ZERO;
        let mut normal = Vec3::ZERO;
        for (joint, weight) in v.driven_joints().into_iter().zip(v.weights) {
            let matrix = palette[usize::from(joint)];
            position += matrix.transform_point3(v.position) * weight;
            normal += matrix.transform_vector3(v.normal) * weight;
        }
        (position, normal.normalize_or_zero())
    };
    mesh.vertices.iter().map(blend).collect()
}

/// The avatar standing in its rest pose.
pub fn rest(avatar: &Avatar) -> ClipFrame {
    ClipFrame { rotations: avatar.joints.map(|j| j.rotation), root: avatar.joints[0].translation }
}

/// A picture of several views side by side.
pub struct Sheet {
    width: usize,
    height: usize,
    scale: f32,
    color: Vec<[u8; 3]>,
    depth: Vec<f32>,
    next: f32,
}

impl Sheet {
    /// `metres` wide and `tall`, at `scale` pixels per metre.
    pub fn new(metres: f32, tall: f32, scale: f32) -> Self {
        let (width, height) = ((metres * scale) as usize, (tall * scale) as usize);
        Self {
            width,
            height,
            scale,
            color: vec![[205, 214, 224]; width * height],
            depth: vec![f32::MAX; width * height],
            next: 0.0,
        }
    }

    /// Draws the posed level `turn` radians about the vertical (0 = seen from the front) into the next column
    /// of `room` metres; `base` is the height of the picture's lower edge.
    pub fn draw(
        &mut self,
        avatar: &Avatar,
        level: usize,
        frame: &ClipFrame,
        turn: f32,
        room: f32,
        base: f32,
    ) {
        let mesh = &avatar.levels[level];
        let vertices = skin(avatar, mesh, frame);
        let view = glam::Quat::from_rotation_y(turn);
        let middle = self.next + room * 0.5;
        self.next += room;
        let light = Vec3::new(0.45, 0.75, 0.6).normalize();
        for t in mesh.indices.chunks_exact(3) {
            let ids = [t[0] as usize, t[1] as usize, t[2] as usize];
            // Seen from +z: x to the right of the picture is the walker's left.
            let p = ids.map(|i| {
                let q = view * vertices[i].0;
                Vec3::new((middle + q.x) * self.scale, self.height as f32 - (q.y - base) * self.scale, -q.z)
            });
            let shade = ids.map(|i| {
                let v = &mesh.vertices[i];
                let tint = match v.material {
                    Material::Fixed => Vec3::ONE,
                    Material::Skin => Vec3::new(0.72, 0.43, 0.29),
                    Material::Hair => Vec3::new(0.07, 0.035, 0.02),
                    Material::Top => Vec3::new(0.05, 0.2, 0.35),
                    Material::Bottom => Vec3::new(0.1, 0.09, 0.12),
                };
                let lambert = 0.4 + 0.6 * (view * vertices[i].1).dot(light).max(0.0);
                (v.color * tint * lambert, v)
            });
            self.triangle(p, shade.map(|s| s.0));
        }
    }

    fn triangle(&mut self, p: [Vec3; 3], shade: [Vec3; 3]) {
        let cross = |a: Vec3, b: Vec3, c: Vec3| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        let area = cross(p[0], p[1], p[2]);
        // Culls what winds clockwise as seen (the picture's y runs down).
        if area >= 0.0 {
            return;
        }
        let low = p[0].min(p[1]).min(p[2]);
        let high = p[0].max(p[1]).max(p[2]);
        let clamp = |v: f32, top: usize| (v.max(0.0) as usize).min(top);
        for y in clamp(low.y, self.height)..clamp(high.y + 1.0, self.height) {
            for x in clamp(low.x, self.width)..clamp(high.x + 1.0, self.width) {
                let q = Vec3::new(x as f32 + 0.5, y as f32 + 0.5, 0.0);
                let w = [cross(p[1], p[2], q), cross(p[2], p[0], q), cross(p[0], p[1], q)].map(|v| v / area);
                if w.iter().any(|&v| v < 0.0) {
                    continue;
                }
                let depth: f32 = (0..3).map(|i| w[i] * p[i].z).sum();
                let at = y * self.width + x;
                if depth < self.depth[at] {
                    self.depth[at] = depth;
                    let color: Vec3 = (0..3).map(|i| shade[i] * w[i]).sum();
                    self.color[at] =
                        color.to_array().map(|v| (v.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8);
                }
            }
        }
    }

    /// Writes the picture as PNG.
    pub fn save(&self, path: &Path) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
        let mut encoder =
            png::Encoder::new(file, u32::try_from(self.width).unwrap(), u32::try_from(self.height).unwrap());
        encoder.set_color(png::ColorType::Rgb);
        let data: Vec<u8> = self.color.iter().flatten().copied().collect();
        encoder.write_header().unwrap().write_image_data(&data).unwrap();
    }
}
