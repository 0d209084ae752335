//! What can go wrong with the window.

/// There is no window, or not any more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no display to open a window on.
    #[error("no window can be opened: {0}")]
    NoDisplay(String),
    /// No Vulkan device can show frames in the window.
    #[error("no Vulkan device can show pictures in a window here; found: {0}")]
    NoPresenter(String),
    /// The window's pixels are of no kind that frames can be shown in.
    #[error("the window takes none of the colour formats of pictures (8 bits, sRGB); it takes {0}")]
    NoFormat(String),
    /// The panel could not be drawn.
    #[error("the panel cannot be drawn: {0}")]
    Panel(String),
}

impl Error {
    /// What the user can do about it.
    pub const fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NoDisplay(_) | Self::NoPresenter(_) | Self::NoFormat(_) => {
                Some("`gaitway render` draws the same pictures into files, without a window")
            }
            Self::Panel(_) => None,
        }
    }
}
