//! Where a session stands, and what happens to it.

/// Where a session stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum State {
    /// Not begun.
    Idle,
    /// May begin.
    Ready,
    /// Frames are in step, nothing is seen.
    Synchronized,
    /// Seen, but another application has the input.
    Visible,
    /// Seen, with input.
    Focused,
    /// Shall end.
    Stopping,
    /// Is over, as requested.
    Exiting,
}

impl State {
    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Ready => "ready",
            Self::Synchronized => "synchronized",
            Self::Visible => "visible",
            Self::Focused => "focused",
            Self::Stopping => "stopping",
            Self::Exiting => "exiting",
        }
    }
}

/// What happened since the last look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// A new state.
    State(State),
    /// The user has recentred the view.
    Recentred,
    /// The display's refresh rate is another one now, Hz.
    Rate(f32),
}
