//! No attributes, directives and includes.

use super::Reporter;
use crate::compile::lint::Lint;
use crate::compile::text::Token;

pub(in crate::custom) const LINT: Lint = Lint {
    name: "attribute",
    summary: "a brush has no attributes, no directives and no includes",
    why: "bindings and entry points are the engine's, and a brush is one file that means the same everywhere",
    fix: "take what the brush needs from `at`, `parameters` and the library, and put all functions into this file",
};

const DIRECTIVES: &[&str] = &["diagnostic", "enable", "requires"];

pub(in crate::custom) fn check(masked: &str, tokens: &[Token<'_>], reporter: &mut Reporter<'_>) {
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate() {
        match token.text {
            "{" => depth += 1,
            "}" => depth = depth.saturating_sub(1),
            "@" => {
                let name = tokens.get(index + 1).map_or("", |next| next.text);
                reporter.at_offset(&LINT, token.offset, format!("an attribute, `@{name}`"));
            }
            directive if depth == 0 && DIRECTIVES.contains(&directive) && is_first(tokens, index) => {
                reporter.at_offset(&LINT, token.offset, format!("a directive, `{directive}`"));
            }
            "#" if starts_line(masked, token.offset) => {
                reporter.at_offset(&LINT, token.offset, "a line of a preprocessor; there is none");
            }
            _ => {}
        }
    }
}

/// Whether a declaration would start at a token.
fn is_first(tokens: &[Token<'_>], index: usize) -> bool {
    let before = index.checked_sub(1).and_then(|before| tokens.get(before));
    before.is_none_or(|before| matches!(before.text, ";" | "}"))
}

fn starts_line(masked: &str, offset: usize) -> bool {
    let before = masked.get(..offset).unwrap_or_default();
    before.rsplit('\n').next().unwrap_or_default().trim().is_empty()
}

#[cfg(test)]
mod tests {
    use crate::custom::tests::{brush, compiled, rules_of};

    #[test]
    fn accepts_a_file_without_them_and_comments_about_them() {
        compiled(&format!("// @compute #include\n{}", brush("let group = at.weight; /* @group */", "group")));
    }

    #[test]
    fn rejects_each_of_them_at_its_place() {
        for line in [
            "@group(1) @binding(13) var<storage, read_write> stolen: array<f32>;",
            "@compute @workgroup_size(64) fn main() {}",
            "@must_use fn f() -> f32 { return 1.0; }",
            "@id(3) override a: f32 = 1.0;",
            "struct S { @size(1073741824) a: f32 }",
            "enable f16;",
            "requires readonly_and_readwrite_storage_textures;",
            "diagnostic(off, derivative_uniformity);",
            "#include \"driver/local.wgsl\"",
            "  #include \"lib/hash.wgsl\"",
            "#define A 1",
        ] {
            let rules = rules_of(&format!("const A = 1;\n{line}\n{}", brush("", "1.0")));
            assert!(rules.contains(&("attribute", 2)), "{line}: {rules:?}");
        }
    }
}
