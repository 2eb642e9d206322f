//! The sealed file of answers.
//!
//! The text is added bit by bit to a stream of SHA-256(key, salt, counter), and a SHA-256 of salt and text is printed beside
//! it. Without the key nothing can be read; with it nothing can be changed unseen. It protects from looking by accident and from
//! answers that change after the fact. It does not protect from somebody who uses the key.

use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};

/// 32 secret bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SealKey([u8; 32]);

impl SealKey {
    /// From the random numbers of the operating system that seed hash tables, and the clock.
    pub fn draw() -> Self {
        let mut state = Sha256::new();
        for round in 0..8_u64 {
            let mut hasher = RandomState::new().build_hasher();
            hasher.write_u64(round);
            state.update(hasher.finish().to_le_bytes());
        }
        if let Ok(time) = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH) {
            state.update(time.as_nanos().to_le_bytes());
        }
        Self(state.finalize().into())
    }

    /// 64 hexadecimal digits.
    pub fn to_text(&self) -> String {
        hex(&self.0)
    }

    /// From 64 hexadecimal digits.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let bytes = unhex(text.trim())?;
        bytes.try_into().map(Self).map_err(|_| "a key has 64 hexadecimal digits".to_owned())
    }

    /// What the cases are drawn with.
    pub fn seed(&self) -> u64 {
        let block = self.block(b"seed", 0);
        u64::from_le_bytes(block[..8].try_into().expect("8 of 32 bytes"))
    }

    fn block(&self, salt: &[u8], counter: u64) -> [u8; 32] {
        let mut state = Sha256::new();
        state.update(self.0);
        state.update(salt);
        state.update(counter.to_le_bytes());
        state.finalize().into()
    }

    fn mixed(&self, salt: &[u8], text: &[u8]) -> Vec<u8> {
        let chunks = text.chunks(32).zip(1_u64..);
        let mix = |(chunk, counter): (&[u8], u64)| {
            let stream = self.block(salt, counter);
            chunk.iter().zip(stream).map(|(byte, other)| byte ^ other).collect::<Vec<u8>>()
        };
        chunks.flat_map(mix).collect()
    }
}

/// SHA-256 in hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// The sealed file of `text`.
pub fn close(key: &SealKey, text: &str) -> String {
    // The same key and text give the same file: the salt is that of the text.
    let salt = key.block(text.as_bytes(), 0);
    let commitment = digest(&[&salt[..], text.as_bytes()].concat());
    let sealed = json!({
        "format": 1,
        "salt": hex(&salt),
        "commitment": commitment,
        "text": hex(&key.mixed(&salt, text.as_bytes())),
    });
    format!("{sealed:#}\n")
}

/// The text of a sealed file.
pub fn open(key: &SealKey, file: &str) -> Result<String, String> {
    let sealed: Value = serde_json::from_str(file).map_err(|error| error.to_string())?;
    let part =
        |name: &str| sealed[name].as_str().ok_or_else(|| format!("answers.sealed has no `{name}`"));
    let salt = unhex(part("salt")?)?;
    let text = key.mixed(&salt, &unhex(part("text")?)?);
    if digest(&[&salt[..], &text].concat()) != part("commitment")? {
        return Err(
            "answers.sealed and the key do not belong together, or it was changed".to_owned()
        );
    }
    String::from_utf8(text).map_err(|error| error.to_string())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn unhex(text: &str) -> Result<Vec<u8>, String> {
    let wrong = || "not a row of hexadecimal digits".to_owned();
    if !text.is_ascii() || text.len() % 2 == 1 {
        return Err(wrong());
    }
    let pairs = (0..text.len()).step_by(2).map(|start| &text[start..start + 2]);
    pairs.map(|pair| u8::from_str_radix(pair, 16).map_err(|_| wrong())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_sealed_opens_with_its_key_only() {
        let key = SealKey([7; 32]);
        let text = "wear, and nothing else but wear; ".repeat(9);
        let sealed = close(&key, &text);
        assert!(!sealed.contains("wear"));
        assert_eq!(open(&key, &sealed).unwrap(), text);
        assert!(open(&SealKey([8; 32]), &sealed).is_err());
        let place = sealed.find("\"text\": \"").unwrap() + 10;
        let digit = &sealed[place..=place];
        let other = if digit == "0" { "1" } else { "0" };
        let changed = format!("{}{other}{}", &sealed[..place], &sealed[place + 1..]);
        assert!(open(&key, &changed).is_err());
    }

    #[test]
    fn a_key_is_read_back_and_never_drawn_twice() {
        let key = SealKey::draw();
        assert_eq!(SealKey::from_text(&format!("{}\n", key.to_text())).unwrap(), key);
        assert_ne!(SealKey::draw(), key);
        assert!(SealKey::from_text("abc").is_err() && SealKey::from_text("zz").is_err());
    }

    #[test]
    fn the_digest_is_sha_256() {
        // FIPS 180-4, example "abc".
        assert!(digest(b"abc").starts_with("ba7816bf8f01cfea414140de5dae2223"));
    }
}
