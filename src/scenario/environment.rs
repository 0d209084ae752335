//! What a scene looks like: a ground and props, and the mesh made of them.

use super::mesh::{Builder, EnvironmentMesh, srgb};
use super::polygon;
use super::props;
use super::schema::Point;
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Most triangles of an environment; what is farthest from the user is simplified, then left out.
pub const MAX_TRIANGLES: usize = 60_000;

/// Ground and props.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Environment {
    /// The ground everywhere under the scene; a generated layout brings its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<Ground>,
    /// Everything that lies or stands on the ground.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub props: Vec<Prop>,
}

/// What the ground is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "materials, which say so")]
pub enum Ground {
    #[default]
    Concrete,
    Asphalt,
    Gravel,
    Grass,
    Deck,
}

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
}

/// What a prop is. Size is `[width, height, depth]`; a heading of 0 faces +z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PropKind {
    /// A raised light slab with kerbs, flat.
    Pavement,
    /// Stripes across the width, flat.
    Zebra,
    /// A painted marking, flat.
    Line,
    /// Grass, flat.
    Lawn,
    /// A glowing strip in the floor, flat.
    Strip,
    /// A round pad with glowing rings, flat.
    LandingPad,
    /// A house with window bands and shop fronts.
    Building,
    /// A low shop with a glass front and a sign, facing +z.
    Store,
    /// A street lamp; the arm reaches towards +z.
    Lamp,
    /// A traffic light facing +z.
    TrafficLight,
    /// A tree; size is that of the crown and the whole height, the trunk is what is solid.
    Tree,
    /// A clipped hedge.
    Hedge,
    /// Lawn and flowers within a hedge.
    Bed,
    /// A bench facing +z.
    Bench,
    /// A round fountain.
    Fountain,
    /// A parked car facing +z.
    Car,
    /// A residential pod: a dome with a glowing band, door to +z.
    Pod,
    /// A column with a glowing ring.
    Column,
    /// A panelled wall with a glowing line.
    Wall,
    /// A plain box.
    Box,
}

impl PropKind {
    /// Whether it lies flat on the ground and can be walked over.
    pub const fn is_flat(self) -> bool {
        matches!(
            self,
            Self::Pavement | Self::Zebra | Self::Line | Self::Lawn | Self::Strip | Self::LandingPad
        )
    }
}

/// One thing that lies or stands on the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prop {
    /// What it is.
    pub kind: PropKind,
    /// Where its middle is (x, z), m.
    pub position: Point,
    /// Turn about +y, degrees; 0 faces +z, 90 faces +x.
    #[serde(default)]
    pub heading_deg: f32,
    /// Width (x), height (y), depth (z) before turning, m.
    pub size: [f32; 3],
    /// Whether it is an obstacle; left out: everything that is not flat. A prop whose middle lies outside the
    /// bounds is never one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<bool>,
}

impl Prop {
    /// A prop facing +z, solid by its kind.
    pub const fn new(kind: PropKind, position: Vec2, size: Vec3) -> Self {
        Self {
            kind,
            position: [position.x, position.y],
            heading_deg: 0.0,
            size: size.to_array(),
            solid: None,
        }
    }

    /// The same, turned.
    #[must_use]
    pub const fn facing(mut self, heading_deg: f32) -> Self {
        self.heading_deg = heading_deg;
        self
    }

    /// The same, for the eye only.
    #[must_use]
    pub const fn scenery(mut self) -> Self {
        self.solid = Some(false);
        self
    }

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
        let ground = self.ground.unwrap_or_default();
        let mut builder = Builder::new(&mut mesh, Vec3::ZERO, 0.0);
        builder.on(props::GROUND).sheet(Vec3::new(middle.x, 0.0, middle.y), size.x, size.y, ground.color());
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

/// Distance of the nearest part of a prop to the focus, roughly, m.
fn nearness(prop: &Prop, focus: Vec2) -> f32 {
    let reach = 0.5 * prop.size[0].max(prop.size[2]);
    (Vec2::from(prop.position).distance(focus) - reach).max(0.0)
}

impl EnvironmentMesh {
    fn clear(&mut self) {
        self.positions.clear();
        self.normals.clear();
        self.colors.clear();
        self.layers.clear();
        self.indices.clear();
    }

    fn append(&mut self, part: &Self) {
        let base = u32::try_from(self.positions.len()).unwrap_or(u32::MAX);
        self.positions.extend(&part.positions);
        self.normals.extend(&part.normals);
        self.colors.extend(&part.colors);
        self.layers.extend(&part.layers);
        self.indices.extend(part.indices.iter().map(|index| base.saturating_add(*index)));
    }
}
