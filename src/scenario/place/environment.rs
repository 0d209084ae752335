//! The mesh of the ground and of all props, and what of them is solid.

use super::material::SurfaceMaterial;
use super::mesh::{Builder, EnvironmentMesh, MAX_TRIANGLES, srgb};
use super::props;
use crate::avatar::{self, PlaceModel};
use crate::scenario::error::Error;
use crate::scenario::file::{Environment, Ground, Prop, PropKind, Scenario};
use crate::scenario::polygon;
use glam::{Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

impl Ground {
    fn color(self) -> Vec3 {
        srgb(match self {
            Self::Concrete => 0xa8a59c,
            Self::Asphalt => 0x4a4c50,
            Self::Gravel => 0xcbb994,
            Self::Grass => 0x6f9a4b,
            Self::Deck => 0x39424f,
        })
    }

    fn material(self) -> SurfaceMaterial {
        match self {
            Self::Concrete => SurfaceMaterial::Concrete,
            Self::Asphalt => SurfaceMaterial::Asphalt,
            Self::Gravel => SurfaceMaterial::Gravel,
            Self::Grass => SurfaceMaterial::Grass,
            Self::Deck => SurfaceMaterial::Deck,
        }
    }
}

impl Prop {
    /// The polygon it stands on, counter-clockwise on (x, z); `None` when it can be walked over.
    pub fn footprint(&self) -> Option<Vec<Vec2>> {
        if !self.solid.unwrap_or(!self.kind.is_flat()) {
            return None;
        }
        let (center, [width, _, depth]) = (Vec2::from(self.position), self.size);
        // The radius is that of the circle *within* the polygon, so that nothing round sticks out.
        let round = |radius: f32, sides: u32| {
            let apothem = libm::cosf(std::f32::consts::PI / f32::from(u8::try_from(sides).unwrap_or(8)));
            polygon::regular(center, radius / apothem, sides, 0.0)
        };
        Some(match self.kind {
            PropKind::Tree => round(props::trunk_radius(width), 6),
            PropKind::Lamp | PropKind::TrafficLight => round(0.15, 6),
            PropKind::Fountain | PropKind::Pod => round(width * 0.5, 12),
            PropKind::Column => round(width * 0.5, 8),
            _ => polygon::rectangle(center, Vec2::new(width, depth), self.heading_deg.to_radians()),
        })
    }
}

impl Environment {
    /// The mesh of the whole environment, at most [`MAX_TRIANGLES`], finest about `focus` (x, z).
    ///
    /// `bounds` is the walkable outline; the ground reaches well beyond it.
    pub fn mesh(&self, bounds: &[Vec2], focus: Vec2) -> EnvironmentMesh {
        let mut mesh = EnvironmentMesh::default();
        let low = bounds.iter().copied().fold(focus, Vec2::min);
        let high = bounds.iter().copied().fold(focus, Vec2::max);
        let margin = Vec2::splat((high - low).max_element() * 0.5 + 80.0);
        let (middle, size) = ((low + high) * 0.5, high - low + margin * 2.0);
        if let Some(ground) = self.ground.or(self.glb.is_none().then(Ground::default)) {
            let mut builder = Builder::new(&mut mesh, Vec3::ZERO, 0.0);
            builder.on(props::GROUND).of(ground.material()).sheet(
                Vec3::new(middle.x, 0.0, middle.y),
                size.x,
                size.y,
                ground.color(),
            );
        }
        let mut order: Vec<(f32, usize)> =
            self.props.iter().enumerate().map(|(i, prop)| (nearness(prop, focus), i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut part = EnvironmentMesh::default();
        for (_, index) in order {
            let used = mesh.triangle_count();
            let detail = match used {
                ..30_000 => props::Detail::Full,
                30_000..48_000 => props::Detail::Some,
                _ => props::Detail::Box,
            };
            part.clear();
            props::draw(&mut part, &self.props[index], u32::try_from(index).unwrap_or(0), detail);
            if used + part.triangle_count() > MAX_TRIANGLES {
                break;
            }
            mesh.append(&part);
        }
        mesh
    }
}

/// The model of a scenario's place, if it has one; it is looked for in `base`.
///
/// # Errors
/// [`Error::Value`] for a model that cannot be read, with the file and the reason.
pub(crate) fn place_model(
    scenario: &Scenario,
    base: Option<&Path>,
) -> Result<Option<Arc<PlaceModel>>, Error> {
    let Some(file) = &scenario.environment.glb else { return Ok(None) };
    let path = base.map_or_else(|| file.into(), |base| base.join(file));
    let model = avatar::place(&path).map_err(|error| {
        let hint = error.hint().map_or_else(|| error.to_string(), |hint| format!("{error}; {hint}"));
        Error::value(
            "environment.glb",
            format!("{file:?}"),
            "a glTF model (.glb, .gltf) beside the scenario",
            hint,
        )
    })?;
    Ok(Some(Arc::new(model)))
}

/// Distance of the nearest part of a prop to the focus, roughly, m.
fn nearness(prop: &Prop, focus: Vec2) -> f32 {
    let reach = 0.5 * prop.size[0].max(prop.size[2]);
    (Vec2::from(prop.position).distance(focus) - reach).max(0.0)
}
