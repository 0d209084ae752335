//! What participants do beside answering.

/// What participants do beside answering; shares are 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Habits {
    /// Share that answers everything at random.
    pub careless: f64,
    /// Probability of leaving at each page, once there is a place. [`hazard`] finds it for a share of participants.
    pub leaving: f64,
    /// Probability of leaving at each page before that.
    pub leaving_early: f64,
    /// Share of the leaving that withdraw instead of falling silent.
    pub withdrawing: f64,
    /// Share of the silent that come back after their lease has lapsed.
    pub returning: f64,
}

/// Everybody answers with care and stays.
impl Default for Habits {
    fn default() -> Self {
        Self { careless: 0.0, leaving: 0.0, leaving_early: 0.0, withdrawing: 0.0, returning: 0.0 }
    }
}

/// The probability of leaving at each of `pages` pages with which `share` of the participants leave before the last:
/// 1 - (1 - h)^pages = share.
pub fn hazard(share: f64, pages: u32) -> f64 {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for _ in 0..60 {
        let middle = low.midpoint(high);
        let stay = (0..pages).fold(1.0, |stay, _| stay * (1.0 - middle));
        if 1.0 - stay < share { low = middle } else { high = middle }
    }
    low
}
