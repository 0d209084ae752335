//! Who is signed in: passwords, sessions, the first password.

use super::super::Error;
use super::super::cookie::{mark, random};
use super::super::reply::hex;
use crate::study::store::Role;
use argon2::Argon2;
use argon2::password_hash::{PasswordHasher as _, PasswordVerifier as _};
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long a session lasts.
const LASTS: Duration = Duration::from_secs(12 * 3600);
/// Shortest and longest password, letters.
pub(super) const PASSWORD: std::ops::RangeInclusive<usize> = 12..=200;

/// An operator who is signed in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Session {
    pub(super) name: String,
    pub(super) role: Role,
    /// What forms send back.
    pub(super) mark: String,
    until: Instant,
}

/// All sessions, by the mark of their secret: the secrets themselves are not kept.
#[derive(Debug, Default)]
pub(super) struct Sessions(Mutex<HashMap<String, Session>>);

impl Sessions {
    fn all(&self) -> MutexGuard<'_, HashMap<String, Session>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a session; returns its secret.
    ///
    /// # Errors
    /// [`Error::NoRandomness`].
    pub(super) fn begin(&self, name: &str, role: Role) -> Result<String, Error> {
        let secret = hex(&random()?);
        let (now, mark) = (Instant::now(), mark(&secret));
        let mut all = self.all();
        all.retain(|_, session| session.until > now);
        let session = Session { name: name.to_owned(), role, mark: mark.clone(), until: now + LASTS };
        all.insert(mark, session);
        Ok(secret)
    }

    /// The session of a secret, unless it has ended.
    pub(super) fn find(&self, secret: &str) -> Option<Session> {
        self.all().get(&mark(secret)).filter(|session| session.until > Instant::now()).cloned()
    }

    /// Ends a session.
    pub(super) fn end(&self, secret: &str) {
        self.all().remove(&mark(secret));
    }

    /// Ends all sessions of an operator, whose password or role has changed.
    pub(super) fn end_all(&self, name: &str) {
        self.all().retain(|_, session| session.name != name);
    }
}

/// The hash of a password (argon2id, PHC format). It takes tens of milliseconds of a core by intention.
///
/// # Errors
/// [`Error::NoRandomness`] without a salt.
pub(super) fn hash(password: &str) -> Result<String, Error> {
    let salt = random()?;
    let hashed = Argon2::default().hash_password_with_salt(password.as_bytes(), &salt[..16]);
    hashed.map(|hash| hash.to_string()).map_err(|error| Error::NoRandomness { reason: error.to_string() })
}

/// Whether a password has a hash. Without a hash it takes as long, and is wrong.
pub(super) fn verify(password: &str, hash: Option<&str>) -> bool {
    match hash {
        Some(hash) => Argon2::default().verify_password(password.as_bytes(), hash).is_ok(),
        None => {
            let _ = Argon2::default().hash_password_with_salt(password.as_bytes(), &[0; 16]);
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_known_by_its_hash_and_a_session_by_its_secret() {
        let hashed = hash("a long password").unwrap();
        assert!(hashed.starts_with("$argon2id$"), "{hashed}");
        assert_ne!(hashed, hash("a long password").unwrap(), "the salt differs");
        assert!(verify("a long password", Some(&hashed)) && !verify("another one", Some(&hashed)));
        assert!(!verify("a long password", None) && !verify("x", Some("no hash")));
        let sessions = Sessions::default();
        let (one, two) =
            (sessions.begin("ann", Role::Run).unwrap(), sessions.begin("bob", Role::Own).unwrap());
        assert_eq!(sessions.find(&one).unwrap().role, Role::Run);
        assert!(sessions.find("x").is_none());
        sessions.end(&one);
        sessions.end_all("bob");
        assert!(sessions.find(&one).is_none() && sessions.find(&two).is_none());
    }
}
