//! What is refused before a request is looked at: other origins, too many requests.

use super::reply::text;
use axum::http::HeaderMap;
use axum::http::header::{HOST, HeaderName, ORIGIN};
use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::Sha256;
use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

const FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
const FORWARDED_FOR: HeaderName = HeaderName::from_static("x-forwarded-for");
/// Counts that are kept before those that are full again are thrown away.
const MOST_COUNTS: usize = 100_000;
/// Bits of an address that count as one place: a household or a small site has all that share them.
const PREFIX_V4: u32 = 24;
const PREFIX_V6: u32 = 48;

/// From where forms and scripts may send.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Origin {
    /// From the public address, such as `https://study.example.org`.
    Public(String),
    /// From this machine: the host that the browser asked for, which must be the machine itself.
    Loopback,
}

impl Origin {
    /// Whether a request that changes something comes from a page of this host.
    pub(super) fn allows(&self, headers: &HeaderMap) -> bool {
        let site = text(headers, &FETCH_SITE);
        if !site.is_empty() && site != "same-origin" {
            return false;
        }
        let origin = text(headers, &ORIGIN);
        match self {
            Self::Public(own) => origin.eq_ignore_ascii_case(own),
            Self::Loopback => {
                let host = text(headers, &HOST);
                self.serves(headers) && origin.strip_prefix("http://").is_some_and(|o| o == host)
            }
        }
    }

    /// Whether a request asks for this host. On loopback another name would let pages of others read what is here.
    pub(super) fn serves(&self, headers: &HeaderMap) -> bool {
        match self {
            Self::Public(_) => true,
            Self::Loopback => is_loopback(text(headers, &HOST)),
        }
    }

    /// Whether browsers reach it by TLS, so that cookies may demand that.
    pub(super) const fn is_encrypted(&self) -> bool {
        matches!(self, Self::Public(_))
    }
}

/// Whether a host with or without port is this machine by a name that no name server gives.
fn is_loopback(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.split(':').next().unwrap_or_default(),
    };
    name == "localhost" || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

/// The address that a request comes from: the one that the proxy has added, where there is one.
pub(super) fn address(peer: IpAddr, headers: &HeaderMap, is_behind_proxy: bool) -> IpAddr {
    let last = headers.get_all(FORWARDED_FOR).iter().next_back().and_then(|value| value.to_str().ok());
    let added = last.and_then(|list| list.rsplit(',').next()).and_then(|entry| entry.trim().parse().ok());
    added.filter(|_| is_behind_proxy).unwrap_or(peer)
}

/// Counts requests in memory, by keyed hashes: neither addresses nor secrets are kept.
pub(super) struct Limits {
    key: [u8; 32],
    counts: Mutex<HashMap<u64, Bucket>>,
}

/// What is left of a minute's requests.
#[derive(Debug, Clone, Copy)]
struct Bucket {
    left: f64,
    most: f64,
    at: Instant,
}

impl std::fmt::Debug for Limits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Limits").finish_non_exhaustive()
    }
}

impl Limits {
    /// Limits with a key of random bits.
    pub(super) fn new(key: [u8; 32]) -> Self {
        Self { key, counts: Mutex::default() }
    }

    /// Whether one more request of a kind (a secret, an address) is within `a_minute`; 0 is without limit.
    pub(super) fn allow(&self, kind: &str, of: &[u8], a_minute: u32) -> bool {
        self.allow_at(kind, of, a_minute, Instant::now())
    }

    /// The same for an address, whose neighbours count with it.
    pub(super) fn allow_address(&self, kind: &str, address: IpAddr, a_minute: u32) -> bool {
        self.allow(kind, &prefix(address), a_minute)
    }

    fn allow_at(&self, kind: &str, of: &[u8], a_minute: u32, now: Instant) -> bool {
        if a_minute == 0 {
            return true;
        }
        let (id, most) = (self.hash(kind, of), f64::from(a_minute));
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        if counts.len() >= MOST_COUNTS {
            counts.retain(|_, bucket| bucket.refilled(now) < bucket.most);
        }
        let bucket = counts.entry(id).or_insert(Bucket { left: most, most, at: now });
        bucket.left = bucket.refilled(now);
        bucket.at = now;
        let is_allowed = bucket.left >= 1.0;
        if is_allowed {
            bucket.left -= 1.0;
        }
        is_allowed
    }

    fn hash(&self, kind: &str, of: &[u8]) -> u64 {
        let Ok(mut mac) = Hmac::<Sha256>::new_from_slice(&self.key) else { return 0 };
        mac.update(kind.as_bytes());
        mac.update(&[0]);
        mac.update(of);
        let bytes = mac.finalize().into_bytes();
        bytes.iter().take(8).fold(0, |id, &byte| (id << 8) | u64::from(byte))
    }
}

impl Bucket {
    fn refilled(&self, now: Instant) -> f64 {
        let passed = now.saturating_duration_since(self.at).min(Duration::from_secs(60)).as_secs_f64();
        (self.left + passed / 60.0 * self.most).min(self.most)
    }
}

/// The bytes that neighbouring addresses share.
fn prefix(address: IpAddr) -> Vec<u8> {
    match address {
        IpAddr::V4(address) => (address.to_bits() >> (32 - PREFIX_V4)).to_be_bytes().to_vec(),
        IpAddr::V6(address) => match address.to_ipv4_mapped() {
            Some(address) => prefix(address.into()),
            None => (Ipv6Addr::to_bits(address) >> (128 - PREFIX_V6)).to_be_bytes().to_vec(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn headers(pairs: &[(&'static str, &'static str)]) -> HeaderMap {
        pairs.iter().map(|&(n, v)| (HeaderName::from_static(n), HeaderValue::from_static(v))).collect()
    }

    #[test]
    fn only_the_own_origin_may_send() {
        let public = Origin::Public("https://lab.org".to_owned());
        assert!(public.allows(&headers(&[("origin", "https://lab.org"), ("sec-fetch-site", "same-origin")])));
        assert!(
            public.allows(&headers(&[("origin", "https://lab.org")])),
            "older browsers lack Sec-Fetch-Site"
        );
        for wrong in ["https://evil.org", "null", "", "http://lab.org", "https://lab.org.evil.org"] {
            assert!(!public.allows(&headers(&[("origin", wrong)])), "{wrong}");
        }
        for site in ["cross-site", "same-site", "none"] {
            let asked = headers(&[("origin", "https://lab.org"), ("sec-fetch-site", site)]);
            assert!(!public.allows(&asked), "{site}");
        }
        let local = |origin, host| Origin::Loopback.allows(&headers(&[("origin", origin), ("host", host)]));
        assert!(local("http://127.0.0.1:8000", "127.0.0.1:8000") && local("http://[::1]:1", "[::1]:1"));
        assert!(!local("http://localhost:8000", "localhost:8001") && !local("http://evil.org", "evil.org"));
        assert!(!local("http://127.0.0.1.evil.org", "127.0.0.1.evil.org"));
    }

    #[test]
    fn a_minute_holds_so_many_requests_and_they_come_back() {
        let limits = Limits::new([7; 32]);
        let now = Instant::now();
        let allowed = |at| (0..5).filter(|_| limits.allow_at("token", b"a", 3, at)).count();
        assert_eq!(allowed(now), 3);
        assert_eq!(allowed(now + Duration::from_secs(20)), 1, "a third of a minute, a third of three");
        assert_eq!(allowed(now + Duration::from_secs(600)), 3);
        assert!(limits.allow_at("token", b"b", 3, now) && limits.allow_at("address", b"a", 3, now));
        assert!((0..1000).all(|_| limits.allow_at("token", b"a", 0, now)), "0 is without limit");
    }

    #[test]
    fn neighbours_share_a_count_and_only_a_trusted_proxy_names_addresses() {
        let ip = |text: &str| text.parse::<IpAddr>().unwrap();
        assert_eq!(prefix(ip("192.0.2.1")), prefix(ip("192.0.2.200")));
        assert_eq!(prefix(ip("192.0.2.1")), prefix(ip("::ffff:192.0.2.9")));
        assert_ne!(prefix(ip("192.0.2.1")), prefix(ip("192.0.3.1")));
        assert_eq!(prefix(ip("2001:db8:1:2::1")), prefix(ip("2001:db8:1:3::9")));
        let forwarded = headers(&[("x-forwarded-for", "6.6.6.6, 9.9.9.9")]);
        assert_eq!(
            address(ip("10.0.0.1"), &forwarded, true),
            ip("9.9.9.9"),
            "what the client wrote is not last"
        );
        assert_eq!(address(ip("10.0.0.1"), &forwarded, false), ip("10.0.0.1"));
        assert_eq!(address(ip("10.0.0.1"), &HeaderMap::new(), true), ip("10.0.0.1"));
    }
}
