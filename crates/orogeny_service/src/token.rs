//! The word that lets clients in.

use crate::{Error, Result};

/// The fewest characters of a token.
const MIN_LENGTH: usize = 16;

/// A token, known by its hash alone: it can be compared, and neither printed nor logged.
#[derive(Clone)]
pub struct Token(blake3::Hash);

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token")
    }
}

impl Token {
    /// Takes a token of at least 16 letters, digits, `-`, `_` and `.`; space around it, as files end in, does not count.
    ///
    /// # Errors
    /// [`Error::Token`].
    pub fn new(text: &str) -> Result<Self> {
        let text = text.trim();
        if text.len() < MIN_LENGTH {
            let detail = format!("it has {} characters, it must have at least {MIN_LENGTH}", text.len());
            return Err(Error::Token { detail });
        }
        // A browser sends it as a WebSocket's subprotocol, which can hold no more than these.
        let is_sendable = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
        if let Some(other) = text.chars().find(|c| !is_sendable(*c)) {
            let detail =
                format!("it has the character {other:?}; letters, digits, `-`, `_` and `.` can be sent");
            return Err(Error::Token { detail });
        }
        Ok(Self(blake3::hash(text.as_bytes())))
    }

    /// Whether it is this one. Takes as long for one as for another.
    pub(crate) fn is(&self, text: &str) -> bool {
        // Hashes of this crate compare in constant time.
        self.0 == blake3::hash(text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_whole_token_is_it_and_nothing_prints_it() {
        let token = Token::new("0123456789abcdef\n").unwrap();
        assert!(token.is("0123456789abcdef"));
        for other in ["", "0123456789abcde", "0123456789abcdef0", "0123456789ABCDEF"] {
            assert!(!token.is(other), "{other}");
        }
        assert_eq!(format!("{token:?}"), "Token");
    }

    #[test]
    fn what_is_guessed_or_cannot_be_sent_is_refused() {
        for (text, why) in
            [("secret", "6 characters"), ("0123456789 abcdef", "' '"), ("0123456789äbcdef", "'ä'")]
        {
            let refused = Token::new(text).unwrap_err().to_string();
            assert!(refused.contains(why), "{refused}");
            assert!(!refused.contains(text), "{refused}");
        }
    }
}
