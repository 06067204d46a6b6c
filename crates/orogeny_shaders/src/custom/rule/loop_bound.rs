//! Loops that surely end, after a number of rounds that is known.

use super::loops::Loops;
use super::{Parsed, Reporter};
use crate::compile::lint::Lint;

pub(in crate::custom) const LINT: Lint = Lint {
    name: "loop_bound",
    summary: "a loop is a `for` whose counter starts at a constant, goes up to a constant in constant steps, and is \
              changed nowhere else",
    why: "a loop without an end stops the graphics driver, with everything that it was drawing",
    fix: "write `for (var i = 0; i < 8; i++) { ... }`, and leave it earlier with `if i >= n { break; }`",
};

/// Checks the loops of the user's functions; whether all have their bounds.
pub(super) fn check(parsed: &Parsed<'_>, reporter: &mut Reporter<'_>) -> bool {
    let mut are_bounded = true;
    for (_, function) in parsed.functions() {
        let loops = Loops::new(parsed.module, function);
        loops.visit(&function.body, false, &mut |span, rounds| {
            if let Err(message) = rounds {
                are_bounded = false;
                reporter.at_span(&LINT, parsed, span, message);
            }
        });
    }
    are_bounded
}

#[cfg(test)]
mod tests {
    use crate::custom::tests::{brush, compiled, errors_of};

    /// What is wrong with a loop on the second line.
    fn refusal(statement: &str) -> Option<String> {
        let errors = errors_of(&brush(statement, "1.0"));
        if let Some(error) = errors.first() {
            assert_eq!(
                (errors.len(), error.line, error.lint),
                (1, 2, Some("loop_bound")),
                "{statement}: {errors:?}"
            );
        }
        errors.into_iter().next().map(|error| error.message)
    }

    #[test]
    fn accepts_loops_with_constant_bounds() {
        for statement in [
            "for (var i = 0; i < 10; i++) { }",
            "for (var i = 0u; i <= 10u; i += 2u) { if at.weight > 1.0 { continue; } }",
            "for (var i: i32; 10 > i; i = i + 1) { break; }",
            "for (var i = 10; i > -10; i--) { }",
            "for (var i = 10u; i >= 4u; i -= 3u) { }",
            "for (var i = -5; i < 5; i = 2 + i) { return 1.0; }",
            "const N = 4; for (var i = N / 2; i < N * 2; i += N) { }",
            "let n = 4; for (var i = 0; i < n; i++) { }",
            "var i: i32; for (i = 3; i < 8; i++) { }",
            "for (var i = 0; i < 3; i++) { for (var j: u32; j < 3u; j++) { } }",
            "for (var i = 0; i < 3; i++) { for (var j = 1; j < 3; j++) { let p = &j; let q = *p + i; } }",
            "for (var i = 2147483640; i < 2147483647; i++) { }",
            "for (var i = 5; i < 0; i++) { }",
            "var i = 0; loop { if i < 5 { } else { break; } continuing { i++; } }",
        ] {
            assert_eq!(refusal(statement), None, "{statement}");
        }
    }

    #[test]
    fn accepts_a_bound_that_is_declared_outside() {
        compiled(&format!("const N = 8u;\n{}", brush("for (var i = 0u; i < N; i++) { }", "1.0")));
    }

    #[test]
    fn rejects_other_loops() {
        for (statement, expected) in [
            ("loop { break; }", "begin with its condition"),
            ("loop { continuing { break if true; } }", "break if"),
            ("var i = 0; while i < 5 { i++; }", "does not step"),
            ("for (;;) { break; }", "begin with its condition"),
            ("for (var i = 0; ; i++) { if i > 3 { break; } }", "begin with its condition"),
            ("for (var i = 0; i < 5; ) { i++; }", "does not step"),
            ("for (var i = 0; i != 5; i++) { }", "none of <"),
            ("for (var x = 0.0; x < 5.0; x += 1.0) { }", "bound that is no constant"),
            ("let b = at.weight > 1.0; for (var i = 0; b; i++) { }", "no comparison"),
        ] {
            let refusal = refusal(statement).unwrap_or_default();
            assert!(refusal.contains(expected), "{statement}: {refusal}");
        }
    }

    #[test]
    fn rejects_bounds_starts_and_steps_that_are_not_constant() {
        for (statement, expected) in [
            ("for (var i = 0; i < at.sample.x; i++) { }", "bound that is no constant"),
            ("var n = 5; for (var i = 0; i < n; i++) { n++; }", "bound that is no constant"),
            ("for (var i = at.sample.x; i < 5; i++) { }", "start at a constant"),
            ("for (var i = 0; i < 5; i += at.sample.x) { }", "stepped by a constant"),
            ("for (var i = 1; i < 5; i *= 2) { }", "stepped by a constant"),
            ("for (var i = 1; i < 5; i = 1) { }", "stepped by a constant"),
            ("for (var i = 1; i < 5; i = 9 - i) { }", "stepped by a constant"),
            ("var j = 0; for (var i = 0; i < 5; j++) { }", "does not step"),
        ] {
            let refusal = refusal(statement).unwrap_or_default();
            assert!(refusal.contains(expected), "{statement}: {refusal}");
        }
    }

    #[test]
    fn rejects_counters_that_something_else_writes() {
        for statement in [
            "for (var i = 0; i < 5; i++) { i = 0; }",
            "for (var i = 0; i < 5; i++) { if at.weight > 1.0 { i--; } }",
            "for (var i = 0; i < 5; i++) { let p = &i; *p = 0; }",
            "for (var i = 0; i < 5; i++) { for (i = 0; i < 3; i++) { } }",
            "var i = 0; for (; i < 3; i++) { } for (; i < 5; i++) { }",
        ] {
            let refusals = errors_of(&brush(statement, "1.0"));
            let is_bound = |error: &crate::Diagnostic| error.lint == Some("loop_bound") && error.line == 2;
            assert!(!refusals.is_empty() && refusals.iter().all(is_bound), "{statement}: {refusals:?}");
        }
        let text = format!(
            "fn back(i: ptr<function, i32>) {{ *i = 0; }}\n{}",
            brush("for (var i = 0; i < 5; i++) { back(&i); }", "1.0")
        );
        assert_eq!(crate::custom::tests::rules_of(&text), [("loop_bound", 3)]);
    }

    #[test]
    fn rejects_a_start_that_is_not_repeated() {
        let statement = "var i = 0; for (var k = 0; k < 3; k++) { for (; i < 5; i++) { } }";
        assert!(refusal(statement).unwrap_or_default().contains("start at a constant"));
    }

    #[test]
    fn rejects_conditions_and_steps_from_before_the_loop() {
        for statement in [
            "var i = 0; let on = i < 5; for (; on; i++) { }",
            "var i = 0; let next = i + 1; for (; i < 5; i = next) { }",
            "var i = 0; let old = i; for (; old < 5; i++) { }",
            "var i = 0; let old = i; for (; i < 5; i = old + 1) { }",
        ] {
            assert!(refusal(statement).is_some(), "{statement}");
        }
    }

    #[test]
    fn rejects_what_would_wrap_around() {
        for (statement, expected) in [
            ("for (var i = 0; i <= 2147483647; i++) { }", "largest"),
            ("for (var i = 5u; i >= 0u; i--) { }", "least"),
            ("for (var i = 10u; i >= 1u; i -= 3u) { }", "least"),
            ("for (var i = 0u; i < 4294967295u; i += 7u) { }", "largest"),
            ("for (var i = 0; i < 5; i--) { }", "towards"),
            ("for (var i = 0; i > -5; i++) { }", "towards"),
            ("for (var i = 0; i < 5; i += 0) { }", "towards"),
            ("for (var i = 10u; i > 0u; i += 4294967295u) { }", "towards"),
        ] {
            let refusal = refusal(statement).unwrap_or_default();
            assert!(refusal.contains(expected), "{statement}: {refusal}");
        }
    }
}
