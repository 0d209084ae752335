//! One hash for what must be recognised again: crowds, sessions, files of our own.

/// FNV-1a over little-endian words of 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    /// Adds whole words; what is left over does not count.
    pub fn add(&mut self, bytes: &[u8]) {
        for word in bytes.chunks_exact(4) {
            let word = u32::from_le_bytes([word[0], word[1], word[2], word[3]]);
            self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds bytes and how many there are, those beyond the last whole word padded with zeros.
    pub fn add_bytes(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.split_at(bytes.len() & !3);
        let mut last = [0; 4];
        last[..rest.len()].copy_from_slice(rest);
        self.add(&(bytes.len() as u64).to_le_bytes());
        self.add(words);
        self.add(&last);
    }

    /// Adds the bytes of a text.
    pub fn add_text(&mut self, text: &str) {
        self.add_bytes(text.as_bytes());
    }

    /// The hash of what was added.
    pub fn value(self) -> u64 {
        self.0
    }
}
