//! The function that a file is for.

use naga::{Function, Handle, Scalar, Span, TypeInner};

use super::{Parsed, Reporter};
use crate::compile::lint::Lint;
use crate::custom::names::FUNCTION;

pub(in crate::custom) const LINT: Lint = Lint {
    name: "signature",
    summary: "a brush has one function `brush`, which takes a `BrushInput` and returns an `f32`",
    why: "it is called for each sample with the old height, and what it returns is the new one",
    fix: "write: fn brush(at: BrushInput) -> f32 { return at.height_m + at.weight; }",
};

/// The function, if it is there. A second one is an error of WGSL.
pub(super) fn check(parsed: &Parsed<'_>, reporter: &mut Reporter<'_>) -> Option<Handle<Function>> {
    let named = parsed.functions().find(|(_, function)| function.name.as_deref() == Some(FUNCTION));
    let Some((handle, function)) = named else {
        reporter.at_span(&LINT, parsed, Span::default(), "no function `brush` in this file");
        return None;
    };
    let ty = |handle| parsed.module.types.get_handle(handle).ok();
    let takes_input = match function.arguments.as_slice() {
        [argument] => ty(argument.ty).is_some_and(|ty| ty.name.as_deref() == Some("BrushInput")),
        _ => false,
    };
    let result = function.result.as_ref().and_then(|result| ty(result.ty));
    let returns_height = result.is_some_and(|ty| ty.inner == TypeInner::Scalar(Scalar::F32));
    if !takes_input || !returns_height {
        let span = parsed.module.functions.get_span(handle);
        reporter.at_span(&LINT, parsed, span, "`brush` does not take a `BrushInput` and return an `f32`");
    }
    Some(handle)
}

#[cfg(test)]
mod tests {
    use crate::custom::tests::{compiled, errors_of, rules_of};

    #[test]
    fn accepts_it_among_others_and_whatever_its_argument_is_called() {
        compiled(
            "fn a() -> f32 { return 1.0; }\nfn brush(b: BrushInput) -> f32 { return a(); }\nfn c() {}\n",
        );
        compiled(
            "alias Height = f32; alias Input = BrushInput; fn brush(b: Input) -> Height { return 1.0; }",
        );
    }

    #[test]
    fn rejects_none() {
        for text in
            ["", "// nothing\n", "fn brush_(at: BrushInput) -> f32 { return 1.0; }", "const brush = 1;"]
        {
            assert_eq!(rules_of(text), [("signature", 1)], "{text}");
        }
    }

    #[test]
    fn rejects_another_signature() {
        for head in [
            "fn brush() -> f32",
            "fn brush(at: f32) -> f32",
            "fn brush(at: BrushInput, more: f32) -> f32",
            "fn brush(at: BrushInput) -> u32",
            "fn brush(at: BrushInput) -> vec2<f32>",
        ] {
            let result = if head.ends_with("u32") { "1u" } else { "1.0" };
            let result = if head.contains("vec2") { "vec2<f32>(1.0)" } else { result };
            let text = format!("\n{head} {{ return {result}; }}\n");
            assert_eq!(rules_of(&text), [("signature", 2)], "{head}");
        }
        assert_eq!(rules_of("\nfn brush(at: BrushInput) {}\n"), [("signature", 2)]);
    }

    #[test]
    fn a_second_one_is_an_error_of_wgsl() {
        let line = "fn brush(at: BrushInput) -> f32 { return 1.0; }\n";
        let errors = errors_of(&line.repeat(2));
        assert_eq!((errors.len(), errors[0].lint), (1, None));
        assert!(errors[0].message.contains("brush"), "{}", errors[0].message);
    }
}
