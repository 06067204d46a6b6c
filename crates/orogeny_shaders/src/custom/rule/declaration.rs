//! Which declarations stand outside functions, and which names they may have.

use naga::keywords::wgsl::BUILTIN_IDENTIFIERS;

use super::Reporter;
use crate::compile::lint::Lint;
use crate::compile::text::Token;
use crate::custom::names::{Names, declared};

pub(in crate::custom) const LINT: Lint = Lint {
    name: "declaration",
    summary: "outside functions a brush declares `fn`, `const`, `struct` and `alias`, with names of its own, 256 at most",
    why: "a brush keeps nothing from one sample to the next, and its library has to mean what it says",
    fix: "use `var` within a function, `const` or a parameter instead of a variable outside, and another name",
};

/// naga's search for cycles goes as deep as declarations name one another.
const MAX_DECLARATIONS: usize = 256;

pub(in crate::custom) fn check(tokens: &[Token<'_>], names: &Names, reporter: &mut Reporter<'_>) {
    for (index, declared) in declared(tokens).enumerate() {
        let (keyword, name) = (declared.keyword, declared.name);
        if index == MAX_DECLARATIONS {
            reporter.at_offset(&LINT, keyword.offset, format!("more than {MAX_DECLARATIONS} declarations"));
            return;
        }
        if matches!(keyword.text, "override" | "var") {
            let message = format!("`{}` outside a function", keyword.text);
            reporter.at_offset(&LINT, keyword.offset, message);
        } else if names.is_in_library(name.text) {
            let message = format!("`{}` is in the library of brushes", name.text);
            reporter.at_offset(&LINT, name.offset, message);
        } else if BUILTIN_IDENTIFIERS.contains(&name.text) {
            reporter.at_offset(&LINT, name.offset, format!("`{}` is built in", name.text));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::compile::text::{self, Token};
    use crate::custom::names::declared;
    use crate::custom::tests::{brush, compiled, rules_of};

    #[test]
    fn accepts_functions_constants_structs_and_aliases() {
        let text = "const HALF = 0.5;\nalias Height = f32;\nstruct Pair { a: Height, b: Height }\n\
                    fn sum(pair: Pair) -> Height { return pair.a + pair.b; }\n";
        compiled(&format!(
            "{text}{}",
            brush("var noise = HALF; noise += at.weight;", "sum(Pair(noise, 1.0))")
        ));
    }

    #[test]
    fn rejects_variables_and_overrides() {
        for line in [
            "var<private> kept: f32;",
            "var<workgroup> shared_: array<f32, 64>;",
            "var<storage, read_write> stolen: array<f32>;",
            "var<uniform> a: f32;",
            "var image: texture_2d<f32>;",
            "var how: sampler;",
            "override A: f32 = 1.0;",
        ] {
            let text = format!("\n{line}\n{}", brush("", "1.0"));
            assert_eq!(rules_of(&text), [("declaration", 2)], "{line}");
        }
    }

    #[test]
    fn rejects_names_that_are_taken() {
        for line in [
            "fn noise(a: f32) -> f32 { return a; }",
            "const parameters = 1.0;",
            "struct BrushInput { a: f32 }",
            "struct Parameters { a: f32 }",
            "fn max(a: f32, b: f32) -> f32 { return a; }",
            "alias f32 = u32;",
            "struct vec3 { a: u32 }",
        ] {
            let text = format!("\n{line}\n{}", brush("", "1.0"));
            assert_eq!(rules_of(&text), [("declaration", 2)], "{line}");
        }
    }

    #[test]
    fn rejects_more_than_256() {
        let constants: String = (0..255).map(|k| format!("const A{k} = {k}.0;\n")).collect();
        compiled(&format!("{constants}{}", brush("", "A0 + A254")));
        assert_eq!(
            rules_of(&format!("{constants}const B = 1;\n{}", brush("", "1.0"))),
            [("declaration", 257)]
        );
    }

    /// A user's `max` would be the kernel's `max`, so what the kernel calls is in the list of what is built in.
    #[test]
    fn the_kernel_calls_nothing_that_a_user_could_declare() {
        let mut known: Vec<String> = Vec::new();
        let mut called: Vec<String> = Vec::new();
        for (_, source) in crate::CUSTOM_FILES {
            let masked = text::without_comments(source).unwrap();
            let tokens = text::tokens(&masked);
            known.extend(declared(&tokens).map(|declared| declared.name.text.to_owned()));
            let is_call = |pair: &&[Token<'_>]| {
                let is_word = pair[0].text.starts_with(|c: char| c.is_ascii_alphabetic());
                let is_beside = pair[0].offset + pair[0].text.len() == pair[1].offset;
                is_word && is_beside && matches!(pair[1].text, "(" | "<")
            };
            called.extend(tokens.windows(2).filter(is_call).map(|pair| pair[0].text.to_owned()));
        }
        let attributes = ["binding", "builtin", "group", "var", "workgroup_size"];
        assert!(called.len() > 100);
        for name in called {
            let is_known = known.contains(&name) || attributes.contains(&name.as_str());
            let is_built_in = naga::keywords::wgsl::BUILTIN_IDENTIFIERS.contains(&name.as_str());
            assert!(is_known || is_built_in, "{name}");
        }
    }
}
