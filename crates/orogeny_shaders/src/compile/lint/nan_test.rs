//! Comparisons of a value with itself.

use naga::{Arena, BinaryOperator, Block, Expression, Function, Handle, Module, Span, Statement};

use super::{Lint, inner_blocks};

pub(super) const LINT: Lint = Lint {
    name: "nan_test",
    summary: "a value is not compared with itself",
    why: "WGSL lets a driver assume that no NaN exists, so `x != x` may be false for one",
    fix: "test the bits: (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u",
};

/// Operands nested deeper than anyone writes them are taken for different.
const MAX_DEPTH: usize = 12;

pub(super) fn check(module: &Module, mut report: impl FnMut(Span, String)) {
    let functions = module.functions.iter().map(|(_, function)| function);
    for function in functions.chain(module.entry_points.iter().map(|entry_point| &entry_point.function)) {
        check_block(function, &function.body, &mut report);
    }
}

fn check_block(function: &Function, block: &Block, report: &mut impl FnMut(Span, String)) {
    // Expressions are evaluated by `Emit`; between successive ones nothing is written.
    let mut unwritten_since = None;
    for statement in block.iter() {
        let Statement::Emit(range) = statement else {
            unwritten_since = None;
            for inner in inner_blocks(statement) {
                check_block(function, inner, report);
            }
            continue;
        };
        for handle in range.clone() {
            let unwritten_since = *unwritten_since.get_or_insert(handle.index());
            let operands = Operands { expressions: &function.expressions, unwritten_since };
            if let Ok(&Expression::Binary { op, left, right }) = function.expressions.try_get(handle)
                && matches!(op, BinaryOperator::Equal | BinaryOperator::NotEqual)
                && operands.are_same(left, right, MAX_DEPTH)
            {
                report(function.expressions.get_span(handle), "a value compared with itself".to_owned());
            }
        }
    }
}

/// The expressions of the function that one comparison stands in.
struct Operands<'a> {
    expressions: &'a Arena<Expression>,
    /// No variable is written between the evaluation of this expression and the comparison.
    unwritten_since: usize,
}

impl Operands<'_> {
    /// Whether both expressions surely have the same bits.
    fn are_same(&self, left: Handle<Expression>, right: Handle<Expression>, depth: usize) -> bool {
        if left == right {
            return true;
        }
        let Some(depth) = depth.checked_sub(1) else {
            return false;
        };
        let (Ok(left_expression), Ok(right_expression)) =
            (self.expressions.try_get(left), self.expressions.try_get(right))
        else {
            return false;
        };
        match (left_expression, right_expression) {
            // Two reads of a variable: `let old = x;` was read where it stands, and `x` may have changed since.
            (&Expression::Load { pointer: a }, &Expression::Load { pointer: b }) => {
                left.index().min(right.index()) >= self.unwritten_since && self.are_same(a, b, depth)
            }
            (&Expression::Access { base: a, index: i }, &Expression::Access { base: b, index: j }) => {
                self.are_same(i, j, depth) && self.are_same(a, b, depth)
            }
            (
                &Expression::AccessIndex { base: a, index: i },
                &Expression::AccessIndex { base: b, index: j },
            ) => i == j && self.are_same(a, b, depth),
            (
                &Expression::Swizzle { size: m, vector: a, pattern: p },
                &Expression::Swizzle { size: n, vector: b, pattern: q },
            ) => m == n && p == q && self.are_same(a, b, depth),
            (&Expression::Unary { op: o, expr: a }, &Expression::Unary { op: p, expr: b }) => {
                o == p && self.are_same(a, b, depth)
            }
            (
                &Expression::Binary { op: o, left: a, right: c },
                &Expression::Binary { op: p, left: b, right: d },
            ) => o == p && self.are_same(a, b, depth) && self.are_same(c, d, depth),
            (Expression::Literal(a), Expression::Literal(b)) => a == b,
            (Expression::LocalVariable(a), Expression::LocalVariable(b)) => a == b,
            (Expression::GlobalVariable(a), Expression::GlobalVariable(b)) => a == b,
            (Expression::FunctionArgument(a), Expression::FunctionArgument(b)) => a == b,
            (Expression::Override(a), Expression::Override(b)) => a == b,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::compile::tests::{kernel, lints_of};

    fn lints(body: &str, result: &str) -> usize {
        let source = kernel(body, result);
        let found = lints_of(&[("brush/raise.wgsl", &source)]);
        assert!(
            found.iter().all(|&found| found == ("nan_test", "shaders/brush/raise.wgsl:4:18")),
            "{found:?}"
        );
        found.len()
    }

    #[test]
    fn accepts_bit_tests_and_different_values() {
        for condition in [
            "(bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u",
            "x != -x",
            "x == 0.0",
            "v.x == v.y",
            "a[0] == a[1]",
        ] {
            assert_eq!(lints(&format!("let is_nan = {condition};"), "f32(is_nan)"), 0, "{condition}");
        }
    }

    #[test]
    fn accepts_a_variable_compared_with_what_it_was() {
        assert_eq!(lints("let old = y; y += x; let same = old == y;", "f32(same)"), 0);
        assert_eq!(lints("let old = y; y = x; let same = old == y;", "f32(same)"), 0);
        assert_eq!(lints("let i = k; k += 1u; let same = a[i] == a[k];", "f32(same)"), 0);
    }

    #[test]
    fn rejects_a_value_compared_with_itself() {
        for condition in [
            "x != x",
            "x == x",
            "y != y",
            "v.x != v.x",
            "a[k] != (a[k])",
            "-y == -y",
            "x + y != x + y",
            "y + 1.0 == y + 1.0",
        ] {
            assert_eq!(lints(&format!("let is_nan = {condition};"), "f32(is_nan)"), 1, "{condition}");
        }
    }

    #[test]
    fn rejects_it_inside_control_flow() {
        for (before, after) in [
            ("{", "}"),
            ("if x > 0.0 {", "}"),
            ("while k > 2u {", "k -= 1u; }"),
            ("switch k { default: {", "} }"),
        ] {
            let source = kernel(&format!("{before} if y != y {{ y = 0.0; }} {after}"), "y");
            let found = lints_of(&[("brush/raise.wgsl", &source)]);
            assert_eq!(found.iter().map(|&(lint, _)| lint).collect::<Vec<_>>(), ["nan_test"], "{before}");
        }
    }
}
