//! The paper's four scenes (S-25): their files, and the layouts that grow with the number of agents.

mod blocks;
mod crossing;
mod garden;
mod parking;
mod scifi;

pub(crate) use blocks::{Generated, spaced};

use crate::scenario::file::Layout;

/// A built-in scene.
#[derive(Debug)]
pub(crate) struct Builtin {
    pub(crate) name: &'static str,
    /// Its scenario file.
    pub(crate) toml: &'static str,
    layout: Layout,
    /// Makes its layout for a number of agents.
    generate: fn(u32) -> Generated,
}

/// All built-in scenes.
pub(crate) static BUILTIN: [Builtin; 4] = [
    Builtin {
        name: "crossing",
        toml: include_str!("../../../assets/scenes/crossing.toml"),
        layout: Layout::Crossing,
        generate: crossing::generate,
    },
    Builtin {
        name: "garden",
        toml: include_str!("../../../assets/scenes/garden.toml"),
        layout: Layout::Garden,
        generate: garden::generate,
    },
    Builtin {
        name: "parking",
        toml: include_str!("../../../assets/scenes/parking.toml"),
        layout: Layout::Parking,
        generate: parking::generate,
    },
    Builtin {
        name: "scifi",
        toml: include_str!("../../../assets/scenes/scifi.toml"),
        layout: Layout::Scifi,
        generate: scifi::generate,
    },
];

/// What a layout makes for a number of agents; none for [`Layout::Custom`], whose geometry is in the file.
pub(crate) fn generate(layout: Layout, agents: u32) -> Option<Generated> {
    BUILTIN.iter().find(|scene| scene.layout == layout).map(|scene| (scene.generate)(agents))
}
