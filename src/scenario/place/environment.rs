//! The mesh of the ground and of all props, and what of them is solid.

use super::material::SurfaceMaterial;
use super::mesh::{Builder, EnvironmentMesh, Finish, srgb};
use super::props::{self, Detail, Look};
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

impl Prop {
    /// A place (x, z) as it is in the prop's own frame, and the other way.
    fn inward(&self, place: Vec2) -> Vec2 {
        let (sine, cosine) = self.turn();
        let off = place - Vec2::from(self.position);
        Vec2::new(off.x * cosine - off.y * sine, off.x * sine + off.y * cosine)
    }

    fn outward(&self, place: Vec2) -> Vec2 {
        let (sine, cosine) = self.turn();
        Vec2::from(self.position)
            + Vec2::new(place.x * cosine + place.y * sine, place.y * cosine - place.x * sine)
    }

    fn turn(&self) -> (f32, f32) {
        let heading = self.heading_deg.to_radians();
        (libm::sinf(heading), libm::cosf(heading))
    }
}

impl Environment {
    /// The mesh of the whole environment, finest about `focus` (x, z).
    ///
    /// `bounds` is the walkable outline; the ground reaches well beyond it.
    pub(crate) fn mesh(&self, bounds: &[Vec2], focus: Vec2, finish: Finish) -> EnvironmentMesh {
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
            let mut detail = Some(affordable(used, finish));
            while let Some(tried) = detail {
                part.clear();
                props::draw(&mut part, &self.props[index], &self.look(index, tried, focus));
                if used + part.triangle_count() <= finish.most_triangles() {
                    break;
                }
                detail = tried.coarser();
            }
            if detail.is_none() {
                break;
            }
            let since = mesh.indices.len();
            mesh.append(&part);
            if let Some(look) =
                detail.and_then(|detail| self.look(index, detail, focus).seen_from_afar(&self.props[index]))
            {
                part.clear();
                props::draw(&mut part, &self.props[index], &look);
                mesh.stand_in(since, &part);
            }
        }
        mesh
    }

    fn look(&self, index: usize, detail: Detail, focus: Vec2) -> Look {
        let prop = &self.props[index];
        let is_house = prop.kind == PropKind::Building && detail == Detail::Fine;
        let hidden = if is_house { self.hidden_sides(index) } else { [false; 4] };
        let eye = prop.inward(focus);
        Look { id: u32::try_from(index).unwrap_or(0), detail, is_far: false, eye, hidden }
    }

    /// Which sides of a house, from that at +z on towards +x, stand against another house that is about as tall.
    fn hidden_sides(&self, index: usize) -> [bool; 4] {
        const GAP: f32 = 0.6;
        let house = &self.props[index];
        let [wide, tall, deep] = house.size;
        let is_covered = |place: Vec2| {
            self.props.iter().enumerate().any(|(other, prop)| {
                let half = Vec2::new(prop.size[0], prop.size[2]) * 0.5;
                other != index
                    && prop.kind == PropKind::Building
                    && prop.size[1] > 0.85 * tall
                    && prop.inward(place).abs().cmple(half).all()
            })
        };
        let outwards = [Vec2::Y, Vec2::X, Vec2::NEG_Y, Vec2::NEG_X];
        outwards.map(|out| {
            let reach = out * (Vec2::new(wide, deep) * 0.5 + GAP);
            let along = out.perp() * Vec2::new(wide, deep) * 0.45;
            [-1.0, 0.0, 1.0].iter().all(|side| is_covered(house.outward(reach + along * *side)))
        })
    }
}

/// How finely the next prop is drawn after so many triangles.
fn affordable(used: usize, finish: Finish) -> Detail {
    match (finish, used) {
        (Finish::Plain, ..30_000) | (Finish::Fine, 150_000..170_000) => Detail::Full,
        (Finish::Fine, ..150_000) => Detail::Fine,
        (Finish::Plain, 30_000..48_000) | (Finish::Fine, 170_000..185_000) => Detail::Some,
        _ => Detail::Box,
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

#[cfg(test)]
mod tests {
    use super::*;

    fn house(x: f32, z: f32, size: [f32; 3], heading_deg: f32) -> Prop {
        Prop::new(PropKind::Building, Vec2::new(x, z), size.into()).facing(heading_deg)
    }

    #[test]
    fn sides_that_stand_against_a_house_as_tall_are_hidden() {
        let size = [10.0, 20.0, 8.0];
        let beside = |other: Prop| {
            let props = vec![house(0.0, 0.0, size, 0.0), other];
            Environment { props, ..Environment::default() }.hidden_sides(0)
        };
        let none = [false; 4];
        assert_eq!(beside(house(0.0, 8.1, size, 0.0)), [true, false, false, false], "+z");
        assert_eq!(beside(house(10.1, 0.0, size, 0.0)), [false, true, false, false], "+x");
        assert_eq!(beside(house(0.0, -8.1, size, 180.0)), [false, false, true, false], "-z");
        assert_eq!(beside(house(-9.1, 0.0, size, 90.0)), [false, false, false, true], "-x");
        assert_eq!(beside(house(-9.1, 0.0, [6.0, 20.0, 8.0], 90.0)), none, "6 m do not cover 8 m");
        for (why, other) in [
            ("far", house(0.0, 10.0, size, 0.0)),
            ("aside", house(6.0, 8.1, size, 0.0)),
            ("low", house(0.0, 8.1, [10.0, 12.0, 8.0], 0.0)),
            ("no house", Prop { kind: PropKind::Store, ..house(0.0, 8.1, size, 0.0) }),
        ] {
            assert_eq!(beside(other), none, "{why}");
        }
        let mut turned = vec![house(3.0, 4.0, size, 90.0), house(11.1, 4.0, size, 90.0)];
        assert_eq!(
            Environment { props: turned.clone(), ..Environment::default() }.hidden_sides(0),
            [true, false, false, false]
        );
        turned.pop();
        assert_eq!(Environment { props: turned, ..Environment::default() }.hidden_sides(0), none);
    }

    #[test]
    fn a_place_in_a_prop_and_back_is_the_same() {
        let prop = house(3.0, -2.0, [1.0; 3], 30.0);
        let place = Vec2::new(1.5, 7.0);
        assert!(prop.outward(prop.inward(place)).distance(place) < 1.0e-5);
        // what is ahead of it is where it faces: 30 degrees from +z towards +x
        let ahead = prop.outward(Vec2::Y) - Vec2::new(3.0, -2.0);
        assert!(ahead.distance(Vec2::new(0.5, 0.75_f32.sqrt())) < 1.0e-5, "{ahead}");
    }
}
