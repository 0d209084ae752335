//! Random bits, and hashes that do not lead back.

use super::super::Error;
use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::{Digest as _, Sha256};

/// A hash of 256 bits.
pub(super) type Hash = [u8; 32];

/// Digits of base 32 that cannot be taken for one another (Crockford): no I, L, O, U.
const DIGITS: &[u8; 32] = b"0123456789ABCDEFGHJKMNPQRSTVWXYZ";
/// Digits of a participant's code: 130 random bits.
const CODE_DIGITS: usize = 26;
/// Digits of a browser's secret: 260 random bits.
const TOKEN_DIGITS: usize = 52;

/// Random bytes of the system.
///
/// # Errors
/// [`Error::NoRandomness`] where the system has none.
pub(super) fn random<const N: usize>() -> Result<[u8; N], Error> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).map_err(|error| Error::NoRandomness { reason: error.to_string() })?;
    Ok(bytes)
}

/// A random number, 0 to 2^63 - 1.
pub(super) fn number() -> Result<u64, Error> {
    Ok(u64::from_le_bytes(random()?) >> 1)
}

/// A new code of a participant.
pub(super) fn code() -> Result<String, Error> {
    Ok(digits(&random::<CODE_DIGITS>()?))
}

/// A new secret of a browser.
pub(super) fn token() -> Result<String, Error> {
    Ok(digits(&random::<TOKEN_DIGITS>()?))
}

/// Five bits of each byte as a digit.
fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(DIGITS[usize::from(byte & 31)])).collect()
}

/// A code as participants type it: without spaces and hyphens, in upper case, with digits for letters that look like them.
pub(super) fn normal(code: &str) -> String {
    let digit = |letter: char| match letter.to_ascii_uppercase() {
        'O' => '0',
        'I' | 'L' => '1',
        other => other,
    };
    code.chars().filter(|letter| !letter.is_whitespace() && *letter != '-').map(digit).collect()
}

/// SHA-256.
pub(super) fn hash(bytes: &[u8]) -> Hash {
    Sha256::digest(bytes).into()
}

/// SHA-256 of several pieces, each with its length.
pub(super) fn hash_of<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> Hash {
    let mut hash = Sha256::new();
    for piece in pieces {
        hash.update((piece.len() as u64).to_le_bytes());
        hash.update(piece);
    }
    hash.finalize().into()
}

/// HMAC-SHA-256: without the key it cannot be found by trying all ids.
pub(super) fn keyed_hash(key: &Hash, text: &str) -> Hash {
    // a key of any length does
    Hmac::<Sha256>::new_from_slice(key)
        .map_or([0; 32], |mac| mac.chain_update(text).finalize().into_bytes().into())
}

/// Hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test")]

    use super::*;

    #[test]
    fn codes_are_read_as_people_write_them() {
        assert_eq!(normal(" k7qo-il0 z"), "K7Q0110Z");
        let code = code().unwrap();
        assert_eq!((code.len(), normal(&code.to_lowercase())), (26, code.clone()));
        assert_ne!(code, super::code().unwrap());
        assert_eq!(token().unwrap().len(), 52);
    }

    #[test]
    fn hashes_are_the_published_ones() {
        // FIPS 180-2, appendix B.1; RFC 4231, test case 2 has another key length
        assert_eq!(hex(&hash(b"abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_ne!(keyed_hash(&[0; 32], "P1"), keyed_hash(&[1; 32], "P1"));
        assert_ne!(hash_of([b"ab".as_slice(), b"c"]), hash_of([b"a".as_slice(), b"bc"]));
    }
}
