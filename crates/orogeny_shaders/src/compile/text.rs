//! WGSL text without a grammar: comments, tokens and positions. Enough for include lines and for lints by name.

use std::ops::Range;

/// A word or a single other character of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token<'a> {
    /// An identifier, keyword or number, or one character of anything else.
    pub text: &'a str,
    /// Where it starts, in bytes.
    pub offset: usize,
}

/// The text with every byte of its comments replaced by a space, so that all offsets stay.
///
/// # Errors
///
/// The offset of a block comment that never ends.
pub(crate) fn without_comments(source: &str) -> Result<String, usize> {
    Ok(split_comments(source)?.0)
}

/// The text without its comments, and where its line comments are, each from its `//` to the end of the line.
///
/// # Errors
///
/// The offset of a block comment that never ends.
pub(crate) fn split_comments(source: &str) -> Result<(String, Vec<Range<usize>>), usize> {
    let mut line_comments = Vec::new();
    let mut out = String::with_capacity(source.len());
    let blank = |out: &mut String, c: char| match c {
        '\n' => out.push('\n'),
        c => out.extend(std::iter::repeat_n(' ', c.len_utf8())),
    };

    let mut chars = source.char_indices().peekable();
    let mut block_depth = 0_u32;
    let mut block_offset = 0;
    while let Some((offset, c)) = chars.next() {
        let next = chars.peek().map(|&(_, next)| next);
        match (block_depth, c, next) {
            (0, '/', Some('/')) => {
                blank(&mut out, c);
                while let Some((_, c)) = chars.next_if(|&(_, c)| c != '\n') {
                    blank(&mut out, c);
                }
                line_comments.push(offset..out.len());
            }
            (_, '/', Some('*')) => {
                if block_depth == 0 {
                    block_offset = offset;
                }
                block_depth += 1;
                chars.next();
                out.push_str("  ");
            }
            (1.., '*', Some('/')) => {
                block_depth -= 1;
                chars.next();
                out.push_str("  ");
            }
            (1.., ..) => blank(&mut out, c),
            (0, ..) => out.push(c),
        }
    }
    if block_depth > 0 { Err(block_offset) } else { Ok((out, line_comments)) }
}

/// The tokens of a text without comments, in order.
pub(crate) fn tokens(text: &str) -> Vec<Token<'_>> {
    let is_word = |c: char| c == '_' || c.is_alphanumeric();
    let mut tokens = Vec::new();
    let mut chars = text.char_indices().peekable();
    while let Some((offset, c)) = chars.next() {
        if c.is_whitespace() {
            continue;
        }
        let mut end = offset + c.len_utf8();
        if is_word(c) {
            while let Some((offset, c)) = chars.next_if(|&(_, c)| is_word(c)) {
                end = offset + c.len_utf8();
            }
        }
        tokens.push(Token { text: text.get(offset..end).unwrap_or_default(), offset });
    }
    tokens
}

/// The line and the column in characters, both from 1, of a byte offset.
pub(crate) fn position(text: &str, offset: usize) -> (u32, u32) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    let saturated = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    (saturated(line), saturated(column))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn words(text: &str) -> Vec<&str> {
        tokens(text).into_iter().map(|token| token.text).collect()
    }

    #[test]
    fn comments_become_spaces() {
        assert_eq!(without_comments("a // b\nc").unwrap(), "a     \nc");
        assert_eq!(without_comments("a /* b /* c */ \n */ d").unwrap(), "a              \n    d");
        assert_eq!(without_comments("a /*é*/ b").unwrap(), "a        b");
        assert_eq!(without_comments("a // /* b\nc").unwrap(), "a        \nc");
        assert_eq!(without_comments("a / b * c").unwrap(), "a / b * c");
    }

    #[test]
    fn line_comments_are_told_from_block_comments() {
        let source = "a // é\n/* // b\n// c */ d //\n";
        let (masked, comments) = split_comments(source).unwrap();
        assert_eq!(comments.iter().map(|range| &source[range.clone()]).collect::<Vec<_>>(), ["// é", "//"]);
        assert_eq!(masked.len(), source.len());
    }

    #[test]
    fn an_endless_comment_is_an_error_where_it_starts() {
        assert_eq!(without_comments("ab /* c"), Err(3));
        assert_eq!(without_comments("ab /* c /* d */"), Err(3));
    }

    #[test]
    fn words_are_whole() {
        assert_eq!(words("remix(a_1, 2.0)"), ["remix", "(", "a_1", ",", "2", ".", "0", ")"]);
        assert_eq!(words(" @compute\n"), ["@", "compute"]);
    }

    #[test]
    fn positions_count_characters() {
        assert_eq!(position("ab\ncd", 0), (1, 1));
        assert_eq!(position("ab\ncd", 4), (2, 2));
        assert_eq!(position("éa", 2), (1, 2));
        assert_eq!(position("ab", 99), (1, 3));
    }

    proptest! {
        #[test]
        fn offsets_and_lines_stay(text in r"([a-z/*\n é]|//|/\*|\*/){0,60}") {
            if let Ok(masked) = without_comments(&text) {
                prop_assert_eq!(masked.len(), text.len());
                prop_assert_eq!(masked.lines().count(), text.lines().count());
                for token in tokens(&masked) {
                    prop_assert_eq!(&text[token.offset..token.offset + token.text.len()], token.text);
                }
            }
        }
    }
}
