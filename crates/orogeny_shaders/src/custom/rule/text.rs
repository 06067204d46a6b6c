//! How long a text may be and how deep it may go, so that compiling it takes neither long nor much stack.

use super::Reporter;
use crate::compile::lint::Lint;
use crate::compile::text::Token;

pub(in crate::custom) const LINT: Lint = Lint {
    name: "text",
    summary: "a brush has at most 64 KiB, 500 characters a line, 64 a name, 64 brackets open, 1,000 words and signs \
              an expression and 200 `else`; outside comments it is ASCII",
    why: "a file may come from anywhere, and compiling it must end soon, on a stack of known size",
    fix: "split it up: lines, `let` for parts of an expression, functions for what is nested, `switch` for many cases",
};

const MAX_BYTES: usize = 64 << 10;
const MAX_LINE_CHARS: usize = 500;
const MAX_NAME_CHARS: usize = 64;
const MAX_OPEN_BRACKETS: usize = 64;
const MAX_EXPRESSION_TOKENS: usize = 1000;
/// A chain of `else if` is as deep as it is long.
const MAX_ELSE: usize = 200;

pub(in crate::custom) fn check_size(source: &str, reporter: &mut Reporter<'_>) {
    if source.len() > MAX_BYTES {
        reporter.unseen(&LINT, [1, 1], format!("{} bytes are more than {MAX_BYTES}", source.len()));
    }
}

pub(in crate::custom) fn check_characters(source: &str, reporter: &mut Reporter<'_>) {
    for (line_text, line) in source.split('\n').zip(1..) {
        if line_text.chars().count() > MAX_LINE_CHARS {
            reporter.unseen(&LINT, [line, 1], format!("a line of more than {MAX_LINE_CHARS} characters"));
        }
        if let Some((c, column)) = line_text.chars().zip(1..).find(|&(c, _)| is_unseen(c)) {
            let message = format!("the character U+{:04X}, which no one sees", u32::from(c));
            reporter.unseen(&LINT, [line, column], message);
        }
    }
}

/// Characters that a line of code is not what it looks like with: controls, line ends other than a line feed (which
/// end a comment for naga), and changes of direction.
fn is_unseen(c: char) -> bool {
    (c.is_control() && c != '\t')
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

pub(in crate::custom) fn check_tokens(masked: &str, tokens: &[Token<'_>], reporter: &mut Reporter<'_>) {
    if let Some(offset) = masked.find(|c: char| !c.is_ascii()) {
        reporter.at_offset(&LINT, offset, "a character outside ASCII, outside a comment");
    }
    if let Some(name) = tokens.iter().find(|token| token.text.len() > MAX_NAME_CHARS) {
        reporter.at_offset(&LINT, name.offset, format!("a name of more than {MAX_NAME_CHARS} characters"));
    }
    if let Some(token) = tokens.iter().filter(|token| token.text == "else").nth(MAX_ELSE) {
        reporter.at_offset(&LINT, token.offset, format!("more than {MAX_ELSE} `else`"));
    }
    check_depth(tokens, reporter);
}

/// What stands in an open bracket, up to the last token.
#[derive(Clone, Copy, Default)]
struct Open {
    /// Tokens of the item that is being written, with those of its deepest brackets: an expression can be as deep as
    /// it is long, as `a + b + c + ...` is.
    length: usize,
    /// The same of the longest item before it.
    longest: usize,
}

fn check_depth(tokens: &[Token<'_>], reporter: &mut Reporter<'_>) {
    let mut outer: Vec<Open> = Vec::new();
    let mut open = Open::default();
    for token in tokens {
        open.length += 1;
        match token.text {
            "(" | "[" | "{" => outer.push(std::mem::take(&mut open)),
            ")" | "]" => {
                let inner = open.length.max(open.longest);
                open = outer.pop().unwrap_or_default();
                open.length += inner;
            }
            "}" => {
                open = outer.pop().unwrap_or_default();
                open.length = 0;
            }
            ";" => open.length = 0,
            "," => open = Open { length: 0, longest: open.length.max(open.longest) },
            _ => {}
        }
        if outer.len() > MAX_OPEN_BRACKETS {
            let message = format!("more than {MAX_OPEN_BRACKETS} brackets are open");
            return reporter.at_offset(&LINT, token.offset, message);
        }
        let depth = open.length + outer.iter().map(|outer| outer.length).sum::<usize>();
        if depth > MAX_EXPRESSION_TOKENS {
            let message = format!("an expression of more than {MAX_EXPRESSION_TOKENS} words and signs");
            return reporter.at_offset(&LINT, token.offset, message);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::custom::tests::{brush, compiled, errors_of, rules_of};

    #[test]
    fn accepts_what_fits() {
        let text = brush("", "1.0");
        compiled(&format!("{}{text}", "// é\n".repeat(((64 << 10) - text.len()) / 6)));
        compiled(&format!("// {}\n{text}", "é".repeat(497)));
        compiled(&brush(&format!("let {} = 1.0;", "a".repeat(64)), "1.0"));
        // Two brackets are around it, the function's and the one after `return`.
        compiled(&brush("", &format!("({}at.weight{})", "(".repeat(61), ")".repeat(61))));
        compiled(&brush("", &lines(" + 1.0", 240)));
        let table = lines(" 1.25,", 250);
        compiled(&format!("const TABLE = array<f32, 250>({table});\n{}", brush("", "TABLE[1]")));
        compiled(&brush(&format!("var x = 0.0;\n{}", lines(" if x > 0.5 { x = 1.0; } else { }", 190)), "x"));
    }

    /// `part` so often, with line breaks.
    fn lines(part: &str, times: usize) -> String {
        let start = if part.starts_with(" +") { "1.0" } else { "" };
        let parts: String =
            (0..times).map(|k| format!("{part}{}", if k % 10 == 9 { "\n" } else { "" })).collect();
        format!("{start}{parts}")
    }

    #[test]
    fn rejects_what_is_too_long() {
        assert_eq!(rules_of(&" ".repeat((64 << 10) + 1)), [("text", 1)]);
        assert_eq!(rules_of(&format!("\n// {}\n", "é".repeat(498))), [("text", 2)]);
        assert_eq!(rules_of(&format!("\nconst {} = 1;", "a".repeat(65))), [("text", 2)]);
        assert_eq!(rules_of(&brush(&format!("let {} = 1.0;", "a".repeat(65)), "1.0")), [("text", 2)]);
    }

    #[test]
    fn a_line_that_is_too_long_is_not_shown() {
        let errors = errors_of(&"a".repeat(60_000));
        assert_eq!((errors.len(), errors[0].source_line.as_str()), (1, ""));
    }

    #[test]
    fn rejects_what_is_too_deep() {
        for (open, close) in [("(", ")"), ("[", "]"), ("{", "}")] {
            let text = format!("\n{}{}", open.repeat(65), close.repeat(65));
            assert_eq!(rules_of(&text), [("text", 2)], "{open}");
        }
        for part in ["+1", "-", "!", ".x", "[0]", "+f(1,1)", "<a", "&"] {
            let text = format!("fn f() -> f32 {{\nreturn 1{}; }}", lines(part, 1000));
            let errors = errors_of(&text);
            assert_eq!((errors.len(), errors[0].lint), (1, Some("text")), "{part}");
        }
        let text = brush(
            &format!("if at.weight > 1.0 {{ }}{}", " else if at.weight > 2.0 { }\n".repeat(201)),
            "1.0",
        );
        assert_eq!(rules_of(&text), [("text", 202)]);
    }

    #[test]
    fn rejects_characters_that_hide_something() {
        for hidden in
            ['\0', '\u{1b}', '\r', '\u{b}', '\u{85}', '\u{2028}', '\u{202e}', '\u{2066}', '\u{200b}']
        {
            let text = format!("\n// a {hidden} var<private> kept: f32;\n{}", brush("", "1.0"));
            let errors = errors_of(&text);
            let [error] = errors.as_slice() else { panic!("{hidden:?}: {errors:?}") };
            assert_eq!((error.line, error.column, error.lint), (2, 6, Some("text")), "{hidden:?}");
            assert!(!error.to_string().contains(hidden), "{hidden:?}");
        }
        let text = brush("let é = 1.0;", "1.0");
        assert_eq!(rules_of(&text), [("text", 2)]);
    }
}
