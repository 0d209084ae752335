//! What was computed of a gait, kept, so that folds and repeats do not compute it again.

use crate::gait::Gait;
use std::collections::HashMap;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher as _};
use std::sync::{Arc, Mutex, PoisonError};

/// Identifies the motion of a gait: poses, rate and speed. Name, source and labels do not count.
pub(super) type Key = u128;

/// The key of a gait: 128 bits of `SipHash`, so that collisions of different motions are negligible.
pub(super) fn key(gait: &Gait) -> Key {
    let half = |salt: u8| {
        let mut hasher = DefaultHasher::new();
        salt.hash(&mut hasher);
        hasher.write(bytemuck::cast_slice(&gait.poses));
        [gait.frame_rate.to_bits(), gait.speed.to_bits()].hash(&mut hasher);
        hasher.finish()
    };
    (u128::from(half(0)) << 64) | u128::from(half(1))
}

/// Values by key, shared by a method and what it trains. Two threads may compute one value twice, which is the same
/// value.
pub(super) struct Memo<K, T>(Arc<Mutex<HashMap<K, T>>>);

impl<K: Hash + Eq + Copy, T: Clone> Memo<K, T> {
    /// The value of a key, computed if it is not known.
    pub(super) fn of(&self, key: K, compute: impl FnOnce() -> T) -> T {
        if let Some(known) = self.lock().get(&key) {
            return known.clone();
        }
        let value = compute();
        self.lock().insert(key, value.clone());
        value
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, HashMap<K, T>> {
        // a map is whole between two calls, whatever became of the thread that held it
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<K, T> Default for Memo<K, T> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

impl<K, T> Clone for Memo<K, T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<K, T> fmt::Debug for Memo<K, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Memo")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker::{Sex, WalkerStyle, walk};

    #[test]
    fn a_key_is_the_motion_and_nothing_else() {
        let gait = walk(&WalkerStyle::preset(Emotion::Sad, Sex::Male), "a").unwrap();
        let renamed = Gait { name: "b".into(), label: Some(Emotion::Angry), ..gait.clone() };
        assert_eq!(key(&gait), key(&renamed));
        let mut moved = gait.clone();
        moved.poses[3][2].x += 1e-4;
        let faster = Gait { speed: gait.speed + 1e-3, ..gait.clone() };
        assert_ne!(key(&gait), key(&moved));
        assert_ne!(key(&gait), key(&faster));
    }

    #[test]
    fn a_value_is_computed_once() {
        let memo = Memo::default();
        assert_eq!(memo.of(1, || 10), 10);
        assert_eq!(memo.clone().of(1, || 11), 10);
    }
}
