//! What surfaces of the scenery are made of.

use crate::kernels::shared::detail;

/// What a surface is made of. Pictures of medium and high quality show it, by the patterns of `shaders/shared/detail.wgsl`.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
#[allow(clippy::cast_possible_truncation, reason = "eighteen materials")]
pub enum SurfaceMaterial {
    /// One colour, a little uneven.
    #[default]
    Plain = detail::PLAIN as u8,
    /// A road's surface, with grain.
    Asphalt = detail::ASPHALT as u8,
    /// Slabs of 3 m.
    Concrete = detail::CONCRETE as u8,
    /// Small stones.
    Gravel = detail::GRAVEL as u8,
    /// A lawn.
    Grass = detail::GRASS as u8,
    /// Plates of metal.
    Deck = detail::DECK as u8,
    /// A pavement's slabs of 0.6 m.
    Paving = detail::PAVING as u8,
    /// A road's markings.
    Paint = detail::PAINT as u8,
    /// Rendered walls.
    Plaster = detail::PLASTER as u8,
    /// Walls of plates.
    Panel = detail::PANEL as u8,
    /// Courses of bricks.
    Brick = detail::BRICK as u8,
    /// Panes that mirror the sky.
    Glass = detail::GLASS as u8,
    /// Leaves.
    Foliage = detail::FOLIAGE as u8,
    /// Wood.
    Wood = detail::WOOD as u8,
    /// Water that mirrors the sky.
    Water = detail::WATER as u8,
    /// A car's coat.
    Lacquer = detail::LACQUER as u8,
    /// A single pane, which mirrors the sky.
    Pane = detail::PANE as u8,
    /// The same with a lamp behind it, which burns while the sun is low.
    LitPane = detail::LIT_PANE as u8,
}
