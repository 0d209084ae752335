//! What lies under the library: buffers, kernels and their twins, the Vulkan engine, how a crowd is laid into buffers.
//!
//! **No promise is made about anything here.** Names and types follow the shaders and change with any version. The rest of
//! the library is stable: the changelog marks a change that breaks it with `breaking:`.
//!
//! Reasons to come here: to read or fill buffers ([`kernels::Store`]), to run one kernel by itself
//! ([`mod@reference`]), to put kernels of your own beside ours (`gpu`), to fill a crowd by hand ([`setup`]), to plan and analyse a study
//! ([`study`], [`statistics`]).
//!
//! ```
//! use gaitway::low_level::kernels::{Dispatch, Phase, Store};
//! use gaitway::low_level::reference;
//!
//! // one agent that walks along x for a step, by the twin of the kernel `integrate` alone
//! let mut store = gaitway::verify::cases::crossing::crossing(1, 1.0);
//! store.agent_slot[0] = 0;
//! store.new_velocity[0] = [1.3, 0.0];
//! let before = store.position[0];
//! let dispatch = Dispatch::of(Phase::Integrate, 1);
//! reference::run(dispatch.phase, &mut store, dispatch.immediate);
//! assert!(store.position[0][0] != before[0] && store.velocity[0] == [1.3, 0.0]);
//! ```

#[doc(inline)]
#[cfg(feature = "vulkan")]
pub use crate::gpu;
#[doc(inline)]
pub use crate::sim::{bodies, flow, obstacles, order, setup, snapshots};
#[doc(inline)]
pub use crate::verify::cases;
#[doc(inline)]
pub use crate::{file, ground, kernels, reference, stop};

// Studies with people are young, and their interface still moves.
#[doc(inline)]
pub use crate::{statistics, study};

/// Headsets as studies use them: one session for many worlds, panels and their answers. Young as well.
#[cfg(feature = "xr")]
pub mod xr {
    #[doc(inline)]
    pub use crate::xr::{
        Answered, Choice, FrameCount, MOST_CELLS, MOST_CHARACTERS, Means, Panel, PanelError, Stage, Walked,
        World,
    };
}

/// Parts of classifiers: matrices, margins, scaling.
pub mod perception {
    #[doc(inline)]
    pub use crate::perception::{linear, logistic, novelty, scaling, svm, trainer};
}

/// The arithmetic of places: polygons, random draws that enter a crowd, personality.
pub mod scenario {
    #[doc(inline)]
    pub use crate::scenario::{personality, polygon, random};
}

/// Readers of single formats of motion capture.
pub mod import {
    #[doc(inline)]
    #[cfg(feature = "import")]
    pub use crate::gait::import::npz;
    #[doc(inline)]
    pub use crate::gait::import::{asf_amc, bvh, c3d, csv, egait, trc};
}

/// What the tests of [`mod@crate::validate`] are made of.
pub mod validate {
    #[doc(inline)]
    pub use crate::validate::{diagram, measure, rooms, scene, tracks};
}
