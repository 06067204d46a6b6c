//! Statements and expressions that a brush may have: those that compute, and nothing that reaches out.

use naga::{Block, Expression, Statement};

use super::{Parsed, Reporter};
use crate::compile::lint::{Lint, inner_blocks};

pub(in crate::custom) const LINT: Lint = Lint {
    name: "forbidden",
    summary: "a brush computes with its input: no barriers, atomics, derivatives, textures, `discard`",
    why: "each sample is computed on its own, as often and in whatever order suits the machine",
    fix: "use `at`, `parameters`, the functions of the library and WGSL's functions on numbers",
};

pub(super) fn check(parsed: &Parsed<'_>, reporter: &mut Reporter<'_>) {
    for (_, function) in parsed.functions() {
        check_block(parsed, &function.body, reporter);
        for (handle, expression) in function.expressions.iter() {
            if let Some(what) = forbidden_expression(parsed, expression) {
                reporter.at_span(&LINT, parsed, function.expressions.get_span(handle), what);
            }
        }
    }
}

fn check_block(parsed: &Parsed<'_>, block: &Block, reporter: &mut Reporter<'_>) {
    for (statement, span) in block.span_iter() {
        if let Some(what) = forbidden_statement(statement) {
            reporter.at_span(&LINT, parsed, *span, what);
        }
        for inner in inner_blocks(statement) {
            check_block(parsed, inner, reporter);
        }
    }
}

fn forbidden_statement(statement: &Statement) -> Option<&'static str> {
    match statement {
        Statement::Emit(_)
        | Statement::Block(_)
        | Statement::If { .. }
        | Statement::Switch { .. }
        | Statement::Loop { .. }
        | Statement::Break
        | Statement::Continue
        | Statement::Return { .. }
        | Statement::Store { .. }
        | Statement::Call { .. } => None,
        Statement::Kill => Some("`discard`; a brush that changes nothing returns `at.height_m`"),
        Statement::ControlBarrier(_)
        | Statement::MemoryBarrier(_)
        | Statement::WorkGroupUniformLoad { .. } => Some("a barrier"),
        Statement::Atomic { .. } | Statement::ImageAtomic { .. } => Some("an atomic"),
        Statement::ImageStore { .. } => Some("a texture"),
        _ => Some("a statement that is not for brushes"),
    }
}

fn forbidden_expression(parsed: &Parsed<'_>, expression: &Expression) -> Option<&'static str> {
    match expression {
        Expression::Literal(_)
        | Expression::Constant(_)
        | Expression::ZeroValue(_)
        | Expression::Compose { .. }
        | Expression::Access { .. }
        | Expression::AccessIndex { .. }
        | Expression::Splat { .. }
        | Expression::Swizzle { .. }
        | Expression::FunctionArgument(_)
        | Expression::LocalVariable(_)
        | Expression::Load { .. }
        | Expression::Unary { .. }
        | Expression::Binary { .. }
        | Expression::Select { .. }
        | Expression::Relational { .. }
        | Expression::Math { .. }
        | Expression::As { .. }
        | Expression::CallResult(_) => None,
        &Expression::GlobalVariable(handle) => {
            let variable = parsed.module.global_variables.try_get(handle).ok();
            let is_parameters =
                variable.is_some_and(|variable| variable.name.as_deref() == Some("parameters"));
            (!is_parameters).then_some("a variable outside the function")
        }
        Expression::Derivative { .. } => Some("a derivative; a sample knows nothing of its neighbours"),
        Expression::ImageSample { .. } | Expression::ImageLoad { .. } | Expression::ImageQuery { .. } => {
            Some("a texture")
        }
        Expression::AtomicResult { .. } => Some("an atomic"),
        Expression::Override(_) => Some("an override"),
        _ => Some("an expression that is not for brushes"),
    }
}

#[cfg(test)]
mod tests {
    use crate::custom::tests::{brush, compiled, errors_of, rules_of};

    #[test]
    fn accepts_what_computes() {
        let statements = "var a = vec3<f32>(at.place_m, 1.0); a.y = -a.x; var k = u32(at.sample.x);
            switch k & 3u { case 0u, 1u: { a *= 2.0; } default: { if any(a.xy > vec2<f32>(1.0)) { return 1.0; } } }
            let b = bitcast<f32>(k) + select(1.0, sin(a.x), a.y > 0.0) + exp(pow(abs(a.x), 2.0)) + log2(a.z);
            let m = mix(a.x, 2.0, b) + tanh(b) + f32(countOneBits(k)) + length(a) + fbm(at.place_m, 4u, 2.0, 0.5, k);";
        compiled(&brush(statements, "b + m + noise_at(at.sample, 40.0, at.seed) + parameters.unused"));
    }

    #[test]
    fn rejects_what_reaches_out() {
        for statement in [
            "workgroupBarrier();",
            "storageBarrier();",
            "let x = dpdx(at.weight);",
            "let x = fwidth(at.weight);",
            "if at.weight > 1.0 { for (var i = 0; i < 2; i++) { storageBarrier(); } }",
        ] {
            assert_eq!(rules_of(&brush(statement, "1.0")), [("forbidden", 2)], "{statement}");
        }
    }

    #[test]
    fn rejects_it_in_functions_that_nothing_calls() {
        let text = format!("\nfn f() {{ discard; }}\n{}", brush("", "1.0"));
        assert_eq!(rules_of(&text), [("forbidden", 2)]);
    }

    #[test]
    fn what_is_the_engines_is_out_of_reach() {
        for statement in [
            "let x = heights;",
            "textureStore(heights, vec2<u32>(0u, 0u), 0u, vec4<f32>(0.0));",
            "atomicAdd(&counters.num_clamped, 1u);",
            "let x = custom.spacing_m;",
            "let x = WEIGHT_MODE;",
            "let x = amount_of(instances[0], at.sample);",
            "let x = falloff_weight(1.0, Falloff());",
            "main(vec3<u32>(), vec3<u32>(), vec3<u32>());",
        ] {
            let errors = errors_of(&brush(statement, "1.0"));
            assert_eq!(
                (errors.len(), errors[0].line, errors[0].lint),
                (1, 2, None),
                "{statement}: {errors:?}"
            );
        }
    }

    #[test]
    fn recursion_is_an_error_of_wgsl() {
        let text = "fn f(x: f32) -> f32 { return g(x); }\nfn g(x: f32) -> f32 { return f(x); }\n";
        assert_eq!(errors_of(&format!("{text}{}", brush("", "f(1.0)"))).len(), 1);
        assert_eq!(errors_of(&brush("return brush(at);", "1.0")).len(), 1);
    }

    #[test]
    fn a_value_compared_with_itself_breaks_a_house_lint() {
        assert_eq!(
            rules_of(&brush("let x = at.weight; let is_nan = x != x;", "f32(is_nan)")),
            [("nan_test", 2)]
        );
    }
}
