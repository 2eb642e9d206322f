//! Notes of a store carry a digest of themselves: their last key, `digest`, is the SHA-256 of the text without it.

use serde_json::Value;
use sha2::{Digest, Sha256};

/// What stands before the digits, and after them.
const BEFORE: &str = ",\n  \"digest\": \"";
const AFTER: &str = "\"\n}\n";
const END: &str = "\n}\n";
const DIGITS: usize = 64;

/// Keys of notes from before there were digests: such notes are read, and notes whose key `digest` is damaged are not
/// taken for such.
const EARLIER_KEYS: &str = "address addresses allow_outside array cancelled collecting ended failing files folder layout \
     measured out particles patch reason results_version runs steps store sweep tasks there threads title version \
     wall_seconds what";

fn digest(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The text of a JSON object with its digest.
pub(super) fn sign(text: &str) -> String {
    match text.strip_suffix(END) {
        Some(start) => format!("{start}{BEFORE}{}{AFTER}", digest(text)),
        None => text.to_owned(),
    }
}

/// The object in `text`, whose digest is right where it has one.
pub(super) fn check(text: &str) -> Result<Value, String> {
    let value: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let signed = text.strip_suffix(AFTER).and_then(|rest| {
        let (start, digits) = rest.split_at_checked(rest.len().checked_sub(DIGITS)?)?;
        Some((start.strip_suffix(BEFORE)?, digits))
    });
    let right = match signed {
        Some((start, digits)) => digest(&format!("{start}{END}")) == digits,
        None => value.as_object().is_some_and(|object| {
            object.keys().all(|key| EARLIER_KEYS.split_whitespace().any(|known| known == key))
        }),
    };
    if right { Ok(value) } else { Err("its digest is wrong".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_flipped_bit_is_seen_and_earlier_notes_are_read() {
        let note = json!({ "layout": 1, "what": "results", "files": [{ "sha256": "00" }] });
        let earlier = format!("{note:#}\n");
        assert_eq!(check(&earlier).unwrap(), note);
        let signed = sign(&earlier);
        assert_eq!(check(&signed).unwrap()["what"], "results");
        let mut flips = 0;
        for place in 0..signed.len() {
            for bit in 0..8 {
                let mut bytes = signed.clone().into_bytes();
                bytes[place] ^= 1 << bit;
                let Ok(text) = String::from_utf8(bytes) else { continue };
                assert!(check(&text).is_err(), "{text}");
                flips += 1;
            }
        }
        assert!(flips > 1000);
    }
}
