//! What a scene looks like: a ground and props.

use super::regions::Point;
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Ground and props.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Environment {
    /// The ground everywhere under the scene; left out: that of the layout, else concrete, or none under a model of the place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<Ground>,
    /// A model of the place (`.glb`, `.gltf`) beside the scenario's file, drawn with its materials and textures where it lies:
    /// metres, y up, the ground at y = 0; left out: there is none. Without `ground` there is no other ground. Without bounds and a
    /// walkable area of the file's own, its floor is where people walk.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glb: Option<String>,
    /// Everything that lies or stands on the ground.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub props: Vec<Prop>,
}

/// What the ground is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// What a prop is. Size is `[width, height, depth]`; a heading of 0 faces +z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PropKind {
    /// A light slab with kerbs, flat. Medium and high quality draw one that is 5 cm or higher as a step.
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
    /// A house with shops on its ground floor.
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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
}
