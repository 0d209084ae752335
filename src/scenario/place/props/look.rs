//! How one prop is to look, and what its drawing counts with.

use crate::scenario::file::{Prop, PropKind};
use crate::scenario::place::mesh::srgb;
use crate::scenario::random::{Purpose, index, unit};
use glam::{Vec2, Vec3};

/// How finely a prop is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Detail {
    /// A box.
    Box,
    /// Without its small parts.
    Some,
    /// What low quality has at most.
    Full,
    /// With reveals, frames, letters and leaves.
    Fine,
}

impl Detail {
    /// The next coarser one.
    pub(crate) const fn coarser(self) -> Option<Self> {
        match self {
            Self::Fine => Some(Self::Full),
            Self::Full => Some(Self::Some),
            Self::Some => Some(Self::Box),
            Self::Box => None,
        }
    }
}

/// How one prop is to look.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    /// Its number, which picks colours and shapes.
    pub(crate) id: u32,
    pub(crate) detail: Detail,
    /// Whether it is drawn to be seen from afar: as it is, but without what is then no larger than a pixel or two.
    pub(crate) is_far: bool,
    /// Where it is looked at from, in its own frame (x, z), m: what is far from there is left out.
    pub(crate) eye: Vec2,
    /// Which sides of a building are covered: +z, +x, -z, -x.
    pub(crate) hidden: [bool; 4],
}

impl Look {
    /// As low quality shows the nearest.
    pub(crate) const fn plain(id: u32) -> Self {
        Self { id, detail: Detail::Full, is_far: false, eye: Vec2::ZERO, hidden: [false; 4] }
    }

    /// How a prop looks from afar, if that spares much: a fine house or car.
    pub(crate) fn seen_from_afar(self, prop: &Prop) -> Option<Self> {
        let is_rich = matches!(prop.kind, PropKind::Building | PropKind::Car);
        (is_rich && self.is_fine()).then_some(Self { is_far: true, ..self })
    }

    pub(super) fn is_fine(&self) -> bool {
        self.detail == Detail::Fine
    }

    pub(super) fn is_full(&self) -> bool {
        self.detail >= Detail::Full
    }

    /// A colour out of a list.
    pub(super) fn pick(&self, draw: u32, colors: &[u32]) -> Vec3 {
        srgb(colors[self.index(draw, colors.len())])
    }

    pub(super) fn index(&self, draw: u32, count: usize) -> usize {
        index(0, self.id, Purpose::Scenery, draw, count)
    }

    /// A number from 0 to 1.
    pub(super) fn unit(&self, draw: u32) -> f32 {
        unit(0, self.id, Purpose::Scenery, draw)
    }

    /// How far a place of the prop is from where it is looked at, on the ground, m.
    pub(super) fn far(&self, place: Vec3) -> f32 {
        self.eye.distance(Vec2::new(place.x, place.z))
    }

    /// The same prop from within a frame turned by quarters about +y.
    pub(super) fn seen_at(&self, quarters: u8) -> Self {
        let turned = (0..quarters).fold(self.eye, |eye, _| Vec2::new(-eye.y, eye.x));
        Self { eye: turned, ..*self }
    }
}

pub(super) const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Whole number of things of length `pitch` in `length`, at least 1, at most `most`.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small range")]
pub(super) fn count(length: f32, pitch: f32, most: u32) -> u32 {
    (length / pitch).round().clamp(1.0, 1000.0).min(f32::from(u16::try_from(most).unwrap_or(1000))) as u32
}
