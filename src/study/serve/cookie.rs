//! Cookies: the secret of a visit, and what pages show of it.

use super::Error;
use super::reply::hex;
use axum::http::HeaderMap;
use axum::http::header::COOKIE;
use sha2::{Digest as _, Sha256};

/// Longest secret that is looked up, bytes.
const LONGEST: usize = 128;
/// How long a browser keeps the secret of a participation, s: thirty days.
pub(super) const PARTICIPATION: u32 = 30 * 24 * 3600;

/// A cookie that scripts cannot read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cookie {
    name: &'static str,
    is_secure: bool,
    same_site: &'static str,
}

impl Cookie {
    /// The participant's. Only without TLS, on this machine, it lacks the prefix, and `Secure` unless it is for frames. In a frame
    /// of another site browsers keep only a cookie that belongs to both sites.
    pub(super) const fn of_participants(is_encrypted: bool, is_framed: bool) -> Self {
        let name = if is_encrypted { "__Host-gaitway" } else { "gaitway" };
        // browsers take this machine for safe without TLS
        let same_site = if is_framed { "None; Partitioned" } else { "Lax" };
        Self { name, is_secure: is_encrypted || is_framed, same_site }
    }

    /// The operator's.
    pub(super) const fn of_operators(is_encrypted: bool) -> Self {
        let name = if is_encrypted { "__Host-gaitway-admin" } else { "gaitway-admin" };
        Self { name, is_secure: is_encrypted, same_site: "Strict" }
    }

    /// The secret in a request.
    pub(super) fn find(self, headers: &HeaderMap) -> Option<String> {
        let lists = headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
        let mut pairs = lists.flat_map(|list| list.split(';')).filter_map(|pair| pair.trim().split_once('='));
        let (_, secret) = pairs.find(|(name, _)| *name == self.name)?;
        let is_usable =
            (1..=LONGEST).contains(&secret.len()) && secret.bytes().all(|b| b.is_ascii_alphanumeric());
        is_usable.then(|| secret.to_owned())
    }

    /// The header that stores a secret for some seconds; 0 forgets it.
    pub(super) fn set(self, secret: &str, seconds: u32) -> String {
        let Self { name, same_site, is_secure } = self;
        let secure = if is_secure { "; Secure" } else { "" };
        format!("{name}={secret}; Path=/; Max-Age={seconds}; HttpOnly; SameSite={same_site}{secure}")
    }
}

/// Random bits of the system.
pub(super) fn random() -> Result<[u8; 32], Error> {
    let mut bytes = [0; 32];
    getrandom::fill(&mut bytes).map_err(|error| Error::NoRandomness { reason: error.to_string() })?;
    Ok(bytes)
}

/// What a page shows of a secret. A page of an earlier visit is known by it, and a page of another host lacks it.
pub(super) fn mark(secret: &str) -> String {
    let digest = Sha256::new().chain_update(b"gaitway page\0").chain_update(secret.as_bytes()).finalize();
    hex(&digest[..8])
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    #[test]
    fn a_secret_is_kept_from_scripts_and_found_again() {
        let cookie = Cookie::of_participants(true, false);
        let set = cookie.set("abc", 60);
        assert_eq!(set, "__Host-gaitway=abc; Path=/; Max-Age=60; HttpOnly; SameSite=Lax; Secure");
        let open = Cookie::of_participants(false, false).set("abc", 60);
        assert!(!open.contains("Secure") && !open.contains("__Host-"), "{open}");
        let framed = Cookie::of_participants(true, true).set("abc", 60);
        assert!(framed.ends_with("; HttpOnly; SameSite=None; Partitioned; Secure"), "{framed}");
        let asked = |value: &str| HeaderMap::from_iter([(COOKIE, HeaderValue::from_str(value).unwrap())]);
        assert_eq!(cookie.find(&asked("a=b; __Host-gaitway=abc; c=d")).as_deref(), Some("abc"));
        for wrong in ["__Host-gaitway=", "gaitway=abc", "__Host-gaitway=a b\"", "x"] {
            assert_eq!(cookie.find(&asked(wrong)), None, "{wrong}");
        }
        assert_eq!(mark("abc").len(), 16);
        assert_ne!(mark("abc"), mark("xyz"));
    }
}
