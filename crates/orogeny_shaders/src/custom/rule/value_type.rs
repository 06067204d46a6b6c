//! What values may be, and how much of a thread's memory they take.

use naga::{ArraySize, Handle, Module, Span, Type, TypeInner};

use super::{Parsed, Reporter};
use crate::compile::lint::Lint;

pub(in crate::custom) const LINT: Lint = Lint {
    name: "value_type",
    summary: "values are numbers, vectors, matrices, and arrays and structs of them, of at most 1,024 bytes; variables \
              of all functions together take at most 8,192",
    why: "each of thousands of threads has its own, and the engine's textures and buffers are not a brush's",
    fix: "use smaller arrays, or compute the values where they are needed",
};

const MAX_BYTES: u32 = 1024;
const MAX_VARIABLES_BYTES: u64 = 8192;

pub(super) fn check(parsed: &Parsed<'_>, reporter: &mut Reporter<'_>) {
    let module = parsed.module;
    let refusal_of =
        |handle: Handle<Type>| module.types.get_handle(handle).ok().and_then(|ty| refusal(module, &ty.inner));
    let mut found: Vec<(Span, String)> = Vec::new();
    let mut variables_bytes = 0_u64;
    for (handle, function) in parsed.functions() {
        let span = module.functions.get_span(handle);
        let arguments = function.arguments.iter().map(|argument| argument.ty);
        let in_head = arguments.chain(function.result.iter().map(|result| result.ty));
        found.extend(in_head.filter_map(|ty| Some((span, refusal_of(ty)?))));
        for (variable, local) in function.local_variables.iter() {
            let span = function.local_variables.get_span(variable);
            found.extend(refusal_of(local.ty).map(|message| (span, message)));
            let ty = module.types.get_handle(local.ty).ok();
            variables_bytes =
                variables_bytes.saturating_add(ty.map_or(0, |ty| bytes(module, &ty.inner).into()));
            if variables_bytes > MAX_VARIABLES_BYTES && found.is_empty() {
                let message = format!("the variables up to here take more than {MAX_VARIABLES_BYTES} bytes");
                found.push((span, message));
            }
        }
        for (expression, _) in function.expressions.iter() {
            let inner = parsed.info[handle][expression].ty.inner_with(&module.types);
            let span = function.expressions.get_span(expression);
            found.extend(refusal(module, inner).map(|message| (span, message)));
        }
    }
    for (handle, constant) in module.constants.iter() {
        let span = module.constants.get_span(handle);
        found.extend(refusal_of(constant.ty).map(|message| (span, message)));
    }
    if found.is_empty() {
        // Named somewhere, and never used.
        let others = module.types.iter().filter_map(|(_, ty)| refusal(module, &ty.inner));
        found.extend(others.map(|message| (Span::default(), message)).take(1));
    }
    for (span, message) in found {
        reporter.at_span(&LINT, parsed, span, &message);
    }
}

/// Why a value may not be of a type, if so.
fn refusal(module: &Module, inner: &TypeInner) -> Option<String> {
    match inner {
        TypeInner::Scalar(_)
        | TypeInner::Vector { .. }
        | TypeInner::Matrix { .. }
        | TypeInner::Pointer { .. }
        | TypeInner::ValuePointer { .. } => None,
        TypeInner::Array { size: ArraySize::Constant(_), .. } | TypeInner::Struct { .. } => {
            let bytes = bytes(module, inner);
            (bytes > MAX_BYTES).then(|| format!("a value of {bytes} bytes, more than {MAX_BYTES}"))
        }
        TypeInner::Array { .. } => Some("an array without a constant length".to_owned()),
        TypeInner::Atomic(_) => Some("an atomic".to_owned()),
        _ => Some("a texture, a sampler or another resource".to_owned()),
    }
}

/// The size of a value of a type; naga refuses those above 1 GiB before.
pub(super) fn bytes(module: &Module, inner: &TypeInner) -> u32 {
    inner.try_size(module.to_ctx()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use crate::custom::tests::{brush, compiled, errors_of, rules_of};

    #[test]
    fn accepts_numbers_vectors_matrices_arrays_structs_and_pointers() {
        let text = "struct S { a: mat3x3<f32>, b: array<vec4<u32>, 8> }\n\
                    fn f(s: ptr<function, S>) -> bool { (*s).a[0].x = 2.0; return (*s).b[1].y == 3u; }\n";
        compiled(&format!("{text}{}", brush("var s = S(); let t = f(&s);", "select(1.0, s.a[0].x, t)")));
        compiled(&brush("var a: array<f32, 256>; a[3] = at.weight;", "a[at.sample.x & 255]"));
        compiled(&format!("const A = array<f32, 256>();\n{}", brush("", "A[1]")));
    }

    #[test]
    fn rejects_large_ones_where_they_are() {
        assert_eq!(rules_of(&brush("var a: array<f32, 257>;", "a[0]")), [("value_type", 2)]);
        assert_eq!(rules_of(&brush("let a = array<f32, 257>();", "a[0]")), [("value_type", 2)]);
        let rest = brush("", "1.0");
        for line in [
            "const A = array<f32, 257>();",
            "fn f(a: array<array<f32, 100>, 3>) {}",
            "fn f(a: array<f32, 250000000>) {}",
            "fn f() -> array<f32, 257> { return array<f32, 257>(); }",
        ] {
            let rules = rules_of(&format!("\n{line}\n{rest}"));
            assert!(
                !rules.is_empty() && rules.iter().all(|rule| *rule == ("value_type", 2)),
                "{line}: {rules:?}"
            );
        }
        assert_eq!(rules_of(&format!("\nstruct S {{ a: array<f32, 257> }}\n{rest}")), [("value_type", 1)]);
    }

    #[test]
    fn rejects_many_variables() {
        let many: String = (0..9).map(|k| format!("var a{k}: array<f32, 250>;\n")).collect();
        assert_eq!(rules_of(&brush(&many, "a8[0]")), [("value_type", 10)]);
    }

    #[test]
    fn rejects_resources() {
        let rest = brush("", "1.0");
        for argument in [
            "t: texture_2d<f32>",
            "s: sampler",
            "a: ptr<function, atomic<u32>>",
            "a: ptr<private, array<f32>>",
        ] {
            let text = format!("\nfn f({argument}) {{}}\n{rest}");
            assert!(!errors_of(&text).is_empty(), "{argument}");
        }
    }
}
