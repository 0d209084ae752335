//! What robots and vehicles look like: a cart, a small car, or a model of the scene's.

use super::mesh::{Builder, EnvironmentMesh, srgb};
use super::props;
use crate::avatar::{self, Model, model};
use crate::scenario::error::Error;
use crate::scenario::file::{ExternalAgent, ExternalKind, Prop, PropKind, Scenario};
use glam::{Vec2, Vec3};
use std::path::Path;

/// Radius that the cart below is drawn for, m.
const CART: f32 = 0.4;
/// Width, height and length of a vehicle over its radius: its corners hardly leave the disc that people avoid.
const VEHICLE: Vec3 = Vec3::new(1.25, 1.4, 1.9);
/// Most vertices of all models of a scene.
const MOST_VERTICES: usize = 2_000_000;

impl ExternalAgent {
    /// Its radius in a scenario, m.
    pub fn radius(&self, scenario: &Scenario) -> f32 {
        self.radius.unwrap_or(match self.kind {
            ExternalKind::Robot => 0.4,
            ExternalKind::Vehicle => 1.0,
            ExternalKind::Person => scenario.navigation.radius,
        })
    }
}

/// What robots and vehicles look like, each mesh once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExternalBodies {
    /// Meshes about the origin, standing on y = 0, front towards +z, m.
    pub meshes: Vec<EnvironmentMesh>,
    /// Mesh of each of [`Scenario::outsiders`]; none of people, who have bodies like everyone.
    pub mesh_of: Vec<Option<usize>>,
}

/// The bodies of a scenario's external agents; models are looked for in `base`.
///
/// # Errors
/// [`Error::Value`] for a model that cannot be read, with the file and the reason.
pub fn external_bodies(scenario: &Scenario, base: Option<&Path>) -> Result<ExternalBodies, Error> {
    let mut bodies = ExternalBodies::default();
    let mut known: Vec<&ExternalAgent> = Vec::new();
    for (index, outsider) in scenario.outsiders.iter().enumerate() {
        if outsider.kind == ExternalKind::Person {
            bodies.mesh_of.push(None);
            continue;
        }
        if let Some(same) = known.iter().position(|other| look_alike(other, outsider, scenario)) {
            bodies.mesh_of.push(Some(same));
            continue;
        }
        let mesh = match &outsider.model {
            Some(file) => {
                let path = base.map_or_else(|| file.into(), |base| base.join(file));
                read(&path, outsider.size).map_err(|error| {
                    let allowed = "a glTF model (.glb, .gltf) beside the scenario";
                    Error::value(
                        format!("outsiders[{index}].model"),
                        format!("{file:?}"),
                        allowed,
                        why(&error),
                    )
                })?
            }
            None => built_in(outsider.kind, outsider.radius(scenario), known.len()),
        };
        bodies.mesh_of.push(Some(bodies.meshes.len()));
        bodies.meshes.push(mesh);
        known.push(outsider);
        let vertices: usize = bodies.meshes.iter().map(|mesh| mesh.positions.len()).sum();
        if vertices > MOST_VERTICES {
            let allowed = format!("models of at most {MOST_VERTICES} vertices together");
            let hint = "simplify them: `npx @gltf-transform/cli simplify IN.glb OUT.glb`";
            return Err(Error::value(format!("outsiders[{index}].model"), vertices, allowed, hint));
        }
    }
    Ok(bodies)
}

/// Whether two have the same mesh.
fn look_alike(one: &ExternalAgent, other: &ExternalAgent, scenario: &Scenario) -> bool {
    let radius = |outsider: &ExternalAgent| outsider.radius(scenario).to_bits();
    if one.model.is_some() || other.model.is_some() {
        return one.model == other.model && one.size == other.size;
    }
    one.kind == other.kind && radius(one) == radius(other)
}

/// An error of a model with its way out.
fn why(error: &avatar::Error) -> String {
    match error.hint() {
        Some(hint) => format!("{error}; {hint}"),
        None => error.to_string(),
    }
}

/// A model of the scene's, scaled to a size if one is given.
fn read(path: &Path, size: Option<[f32; 3]>) -> Result<EnvironmentMesh, avatar::Error> {
    let Model { mut positions, normals, colors, indices } = model(path)?;
    let mut scale = Vec3::ONE;
    if let Some(size) = size {
        let low = positions.iter().copied().fold(Vec3::MAX, Vec3::min);
        let high = positions.iter().copied().fold(Vec3::MIN, Vec3::max);
        let extent = high - low;
        let ground = (0.5 * (low + high)).with_y(low.y);
        scale = Vec3::from(size) / extent.max(Vec3::splat(1e-6));
        positions.iter_mut().for_each(|p| *p = (*p - ground) * scale);
    }
    let normals = normals.into_iter().map(|n| (n / scale).normalize_or(Vec3::Y)).collect();
    Ok(EnvironmentMesh { positions, normals, colors, indices, ..EnvironmentMesh::default() })
}

fn built_in(kind: ExternalKind, radius: f32, number: usize) -> EnvironmentMesh {
    let mut mesh = EnvironmentMesh::default();
    if kind == ExternalKind::Robot {
        cart(&mut Builder::new(&mut mesh, Vec3::ZERO, 0.0), radius / CART);
    } else {
        let car = Prop::new(PropKind::Car, Vec2::ZERO, VEHICLE * radius);
        props::draw(&mut mesh, &car, &props::Look::plain(u32::try_from(number).unwrap_or(0)));
        // its wheels have few sides: they touch the ground with the lowest
        let low = mesh.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
        mesh.positions.iter_mut().for_each(|p| p.y -= low);
    }
    mesh
}

/// A delivery robot on six wheels: a box with a lid, lights before and behind, a pennant that is seen over a crowd.
fn cart(b: &mut Builder<'_>, k: f32) {
    let v = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * k;
    let (dark, shell, lid) = (srgb(0x0022_2529), srgb(0x00e8_eaec), srgb(0x002f_6db5));
    for x in [-0.24, 0.24] {
        for z in [-0.21, 0.0, 0.21] {
            b.wheel(v(x, 0.09, z), 0.09 * k, 0.07 * k, 12, dark);
            b.wheel(v(x * 1.02, 0.09, z), 0.045 * k, 0.07 * k, 8, srgb(0x00b8_bcc0));
        }
    }
    b.block(v(0.0, 0.08, 0.0), v(0.40, 0.10, 0.58), dark);
    b.frustum_box(v(-0.25, 0.16, -0.31), v(0.25, 0.44, 0.31), 0.88, shell);
    b.block(v(0.0, 0.44, 0.0), v(0.40, 0.03, 0.50), lid);
    b.block(v(0.0, 0.27, 0.285), v(0.30, 0.05, 0.04), Vec3::new(0.25, 1.5, 1.8));
    for x in [-0.16, 0.16] {
        b.block(v(x, 0.25, -0.285), v(0.07, 0.05, 0.04), Vec3::new(1.5, 0.08, 0.06));
    }
    b.ball(v(0.0, 0.49, 0.17), v(0.05, 0.045, 0.05), 10, dark);
    b.block(v(-0.17, 0.46, -0.21), v(0.016, 0.62, 0.016), dark);
    b.block(v(-0.17, 0.94, -0.28), v(0.012, 0.12, 0.14), srgb(0x00f2_7a1a));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carts_and_cars_stand_on_the_ground_within_the_disc_that_people_avoid_and_face_ahead() {
        for (kind, radius) in
            [(ExternalKind::Robot, 0.4), (ExternalKind::Robot, 0.9), (ExternalKind::Vehicle, 1.3)]
        {
            let mesh = built_in(kind, radius, 0);
            let reach = mesh.positions.iter().map(|p| p.x.hypot(p.z)).fold(0.0, f32::max);
            assert!((0.8 * radius..1.25 * radius).contains(&reach), "{kind:?} {radius}: {reach}");
            let low = mesh.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
            assert!(low.abs() < 1e-3, "{kind:?}: {low}");
            // white or bluish light before, red behind
            let glow = |front: bool| {
                let lit = mesh.positions.iter().zip(&mesh.colors).filter(|(p, _)| (p.z > 0.0) == front);
                lit.filter(|(_, c)| c.max_element() > 0.85 && c.min_element() < 1.4)
                    .map(|(_, c)| c.z)
                    .fold(0.0, f32::max)
            };
            assert!(glow(true) > 1.0, "{kind:?}: no light in front");
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[t[k] as usize]);
                assert!((b - a).cross(c - a).dot(mesh.normals[t[0] as usize]) > 0.0, "{kind:?} inside out");
            }
        }
    }
}
