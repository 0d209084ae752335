//! The library's error: one enum per layer, gathered here.

pub use crate::spelling::UnknownName;

/// Result of the library's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;

/// Any error of the library. Messages say what was wrong, where, the value and the allowed range;
/// [`Error::hint`] gives the way out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A motion file or gait could not be used.
    #[error(transparent)]
    Gait(#[from] crate::gait::Error),
    /// A statistic cannot be computed from these numbers.
    #[error(transparent)]
    Statistics(#[from] crate::statistics::Error),
    /// Ratings, features or a model of perception could not be used.
    #[error(transparent)]
    Perception(#[from] crate::perception::Error),
    /// A gait library could not be read, or lacks a wanted gait.
    #[error(transparent)]
    Library(#[from] crate::library::Error),
    /// A character could not be loaded or driven.
    #[error(transparent)]
    Avatar(#[from] crate::avatar::Error),
    /// A scenario is wrong.
    #[error(transparent)]
    Scenario(#[from] crate::scenario::Error),
    /// The parts of a scene do not fit together.
    #[error(transparent)]
    Scene(#[from] crate::scene::Error),
    /// A study file is wrong, or answers do not fit it.
    #[error(transparent)]
    Study(#[from] crate::study::Error),
    /// The answers of a study cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] crate::study::analyse::Error),
    /// A study cannot be served.
    #[cfg(feature = "study")]
    #[error(transparent)]
    Serve(#[from] crate::study::serve::Error),
    /// A sweep, a plan or the folder of its runs could not be used.
    #[cfg(feature = "cli")]
    #[error(transparent)]
    Sweep(#[from] crate::sweep::Error),
    /// The simulation refused its input or failed.
    #[error(transparent)]
    Sim(#[from] crate::sim::Error),
    /// Vulkan failed.
    #[cfg(feature = "vulkan")]
    #[error(transparent)]
    Gpu(#[from] crate::gpu::Error),
    /// Drawing failed.
    #[cfg(feature = "vulkan")]
    #[error(transparent)]
    Render(#[from] crate::render::Error),
    /// A recording of a crowd could not be read or replayed.
    #[error(transparent)]
    Replay(#[from] crate::replay::Error),
    /// The headset cannot be used.
    #[cfg(feature = "xr")]
    #[error(transparent)]
    Xr(#[from] crate::xr::Error),
    /// There can be no window.
    #[cfg(feature = "view")]
    #[error(transparent)]
    View(#[from] crate::view::Error),
    /// A result could not be written.
    #[error(transparent)]
    Export(#[from] crate::export::Error),
    /// A command could not do its work; message and way out.
    #[error("{message}")]
    Failed {
        /// What went wrong.
        message: String,
        /// What to do.
        hint: String,
    },
    /// A wish on the command line is not possible; message and way out.
    #[error("{message}")]
    Usage {
        /// What is not possible.
        message: String,
        /// What to do instead.
        hint: String,
    },
}

impl Error {
    /// What the user can do about it, where the message does not say so itself.
    pub fn hint(&self) -> Option<&str> {
        match self {
            #[cfg(feature = "vulkan")]
            Self::Gpu(error) | Self::Render(crate::render::Error::Gpu(error)) => error.hint(),
            Self::Sim(crate::sim::Error::NoVulkan) => {
                Some("use --backend cpu, or build with the feature `vulkan`")
            }
            Self::Avatar(error) => error.hint(),
            Self::Scene(error) => error.hint(),
            Self::Replay(error) => error.hint(),
            #[cfg(feature = "cli")]
            Self::Sweep(error) => error.hint(),
            #[cfg(feature = "xr")]
            Self::Xr(error) => error.hint(),
            #[cfg(feature = "view")]
            Self::View(error) => error.hint(),
            Self::Export(crate::export::Error::Picture(error)) => error.hint(),
            Self::Usage { hint, .. } | Self::Failed { hint, .. } => Some(hint),
            _ => None,
        }
    }
}
