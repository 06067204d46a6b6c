//! How much work a brush is, counted before it runs.
//!
//! An operation is one on numbers: adding two `vec3` is three. Both branches of an `if` count, and all cases of a
//! `switch`, for threads that go side by side take both; a driver that writes every call out in its caller makes no
//! more of it than this count either.

use naga::valid::FunctionInfo;
use naga::{
    BinaryOperator, Block, Expression, Function, Handle, MathFunction, Module, Range, Statement, TypeInner,
};

use super::loops::Loops;
use super::{Parsed, Reporter, value_type};
use crate::compile::lint::{Lint, inner_blocks};
use crate::custom::MAX_OPERATIONS;

pub(in crate::custom) const LINT: Lint = Lint {
    name: "cost",
    summary: "a function takes at most 65,536 operations, with its loops and all that it calls",
    why: "a stroke calls the brush a million times and more, and a driver stops what takes too long",
    fix: "use fewer rounds, fewer octaves, or work out once what does not change in a loop",
};

/// The number of operations of the brush; functions that nothing calls are measured too, for a driver compiles them.
pub(super) fn check(
    parsed: &Parsed<'_>,
    brush: Option<Handle<Function>>,
    reporter: &mut Reporter<'_>,
) -> u64 {
    // Callees stand before their callers.
    let mut costs: Vec<u64> = Vec::new();
    for (handle, function) in parsed.module.functions.iter() {
        let info = &parsed.info[handle];
        let loops = Loops::new(parsed.module, function);
        let work = Work { module: parsed.module, function, info, loops, costs: &costs };
        costs.push(work.of_function());
    }
    let cost_of = |handle: Handle<Function>| costs.get(handle.index()).copied().unwrap_or(u64::MAX);
    // The first one says all: its callers are too much because of it.
    if let Some((handle, function)) = parsed.functions().find(|(handle, _)| cost_of(*handle) > MAX_OPERATIONS)
    {
        let (name, cost) = (function.name.as_deref().unwrap_or_default(), cost_of(handle));
        let message = format!("`{name}` takes {cost} operations, more than {MAX_OPERATIONS}");
        reporter.at_span(&LINT, parsed, parsed.module.functions.get_span(handle), &message);
    }
    brush.map_or(0, cost_of)
}

/// A function that is being measured.
struct Work<'a> {
    module: &'a Module,
    function: &'a Function,
    info: &'a FunctionInfo,
    loops: Loops<'a>,
    /// Of the functions before it.
    costs: &'a [u64],
}

impl Work<'_> {
    fn of_function(&self) -> u64 {
        let zeroed = self.function.local_variables.iter().filter_map(|(_, variable)| {
            let ty = self.module.types.get_handle(variable.ty).ok()?;
            Some(self.numbers(&ty.inner))
        });
        zeroed.fold(1, u64::saturating_add).saturating_add(self.of_block(&self.function.body, false))
    }

    fn of_block(&self, block: &Block, is_in_loop: bool) -> u64 {
        let costs = block.iter().enumerate().map(|(index, statement)| match statement {
            Statement::Loop { .. } => {
                let inner = self.of_inner(statement, true).saturating_add(1);
                let rounds = self.loops.rounds(block, index, is_in_loop).unwrap_or(u64::MAX);
                // The condition is evaluated once more.
                rounds.saturating_add(1).saturating_mul(inner)
            }
            _ => self.of_statement(statement).saturating_add(self.of_inner(statement, is_in_loop)),
        });
        costs.fold(0, u64::saturating_add)
    }

    fn of_inner(&self, statement: &Statement, is_in_loop: bool) -> u64 {
        let inner = inner_blocks(statement).into_iter();
        inner.map(|block| self.of_block(block, is_in_loop)).fold(0, u64::saturating_add)
    }

    fn of_statement(&self, statement: &Statement) -> u64 {
        match statement {
            Statement::Emit(range) => self.of_expressions(range),
            Statement::Store { value, .. } => self.numbers_of(*value),
            Statement::Switch { cases, .. } => cases.len() as u64,
            Statement::Call { function, arguments, .. } => {
                let called = self.costs.get(function.index()).copied().unwrap_or(u64::MAX);
                arguments.iter().map(|argument| self.numbers_of(*argument)).fold(called, u64::saturating_add)
            }
            _ => 1,
        }
    }

    fn of_expressions(&self, range: &Range<Expression>) -> u64 {
        let costs = range.clone().map(|handle| {
            let Ok(expression) = self.function.expressions.try_get(handle) else {
                return 0;
            };
            match expression {
                // An array that is no variable is copied into one to be indexed.
                Expression::Access { base, .. } => self.numbers_of(*base),
                Expression::Binary { op, left, right } => {
                    self.numbers_of(handle).saturating_mul(self.of_operator(*op, [*left, *right]))
                }
                Expression::Math { fun, arg, .. } => {
                    let numbers = self.numbers_of(handle).max(self.numbers_of(*arg));
                    numbers.saturating_mul(of_math(*fun))
                }
                _ => self.numbers_of(handle),
            }
        });
        costs.fold(0, u64::saturating_add)
    }

    /// How many operations a number of the result takes.
    fn of_operator(&self, op: BinaryOperator, operands: [Handle<Expression>; 2]) -> u64 {
        let is_matrix = |handle| matches!(self.inner(handle), TypeInner::Matrix { .. });
        match op {
            BinaryOperator::Divide | BinaryOperator::Modulo => 4,
            // Rows by columns.
            BinaryOperator::Multiply if operands.into_iter().any(is_matrix) => 8,
            _ => 1,
        }
    }

    fn inner(&self, handle: Handle<Expression>) -> &TypeInner {
        self.info[handle].ty.inner_with(&self.module.types)
    }

    fn numbers_of(&self, handle: Handle<Expression>) -> u64 {
        self.numbers(self.inner(handle))
    }

    /// How many numbers a value has; a pointer counts as one.
    fn numbers(&self, inner: &TypeInner) -> u64 {
        match inner {
            TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => 1,
            _ => u64::from(value_type::bytes(self.module, inner)).div_ceil(4).max(1),
        }
    }
}

/// How many operations a function takes for a number.
fn of_math(function: MathFunction) -> u64 {
    match function {
        MathFunction::Abs
        | MathFunction::Min
        | MathFunction::Max
        | MathFunction::Clamp
        | MathFunction::Saturate
        | MathFunction::Radians
        | MathFunction::Degrees
        | MathFunction::Ceil
        | MathFunction::Floor
        | MathFunction::Round
        | MathFunction::Fract
        | MathFunction::Trunc
        | MathFunction::Dot
        | MathFunction::Sign
        | MathFunction::Fma
        | MathFunction::Mix
        | MathFunction::Step => 2,
        _ => 16,
    }
}

#[cfg(test)]
mod tests {
    use crate::custom::tests::{brush, compiled, errors_of, rules_of};

    fn cost(statements: &str, result: &str) -> u64 {
        compiled(&brush(statements, result)).num_operations
    }

    #[test]
    fn counts_numbers_rounds_branches_and_calls() {
        let nothing = cost("", "1.0");
        let sum = cost("let x = at.weight + at.height_m;", "x") - nothing;
        let rounds =
            |n: u32| cost(&format!("var x = 0.0; for (var i = 0; i < {n}; i++) {{ x += 1.0; }}"), "x");
        assert!((1..8).contains(&sum), "{sum}");
        assert_eq!(rounds(30) - rounds(20), rounds(20) - rounds(10));
        assert!(rounds(20) - rounds(10) >= 20);
        let branch = "x = sin(x) + cos(x);";
        let one = cost(&format!("var x = at.weight; if x > 1.0 {{ {branch} }}"), "x");
        let two = cost(&format!("var x = at.weight; if x > 1.0 {{ {branch} }} else {{ {branch} }}"), "x");
        assert!(two - one >= 32, "{one} {two}");
        let wide = cost("let v = vec4<f32>(at.weight) * 2.0;", "v.x");
        let narrow = cost("let v = vec2<f32>(at.weight) * 2.0;", "v.x");
        assert!(wide > narrow);
    }

    /// The users' guide has these numbers.
    #[test]
    fn the_librarys_functions_leave_room() {
        let nothing = cost("", "1.0");
        for (call, at_most) in [
            ("noise(at.place_m, 1u)", 620),
            ("noise_at(at.sample, 20.0, 1u)", 720),
            ("fbm(at.place_m, 4u, 2.0, 0.5, 1u)", 15_500),
            ("fbm_at(at.sample, 20.0, 4u, 0.5, 1u)", 16_384),
            ("natural_log(at.weight)", 60),
        ] {
            let cost = cost("", call) - nothing;
            assert!(cost <= at_most && cost * 2 > at_most, "{call}: {cost}");
        }
    }

    #[test]
    fn rejects_too_many_rounds_with_the_number() {
        let text = brush("for (var i = 0; i < 2000000000; i++) { }", "1.0");
        let errors = errors_of(&text);
        assert_eq!((errors.len(), errors[0].line, errors[0].lint), (1, 1, Some("cost")));
        assert!(errors[0].message.contains("more than 65536"), "{}", errors[0].message);
        let nested = "for (var i = 0; i < 200; i++) { for (var j = 0; j < 200; j++) { } }";
        assert_eq!(rules_of(&brush(nested, "1.0")), [("cost", 1)]);
    }

    #[test]
    fn rejects_what_calls_grow_to_and_says_so_once() {
        let mut text = "fn g0(x: f32) -> f32 { return x * 2.0; }\n".to_owned();
        for k in 1..60 {
            text += &format!("fn g{k}(x: f32) -> f32 {{ return g{0}(x) + g{0}(x); }}\n", k - 1);
        }
        let rules = rules_of(&format!("{text}{}", brush("", "g59(1.0)")));
        assert!(matches!(rules.as_slice(), [("cost", 8..16)]), "{rules:?}");
    }

    #[test]
    fn rejects_a_function_that_nothing_calls_too() {
        let text = format!("\nfn f() {{ for (var i = 0; i < 99999; i++) {{ }} }}\n{}", brush("", "1.0"));
        assert_eq!(rules_of(&text), [("cost", 2)]);
    }

    #[test]
    fn rejects_arrays_that_are_copied_often() {
        let copies = "var a: array<f32, 256>; for (var i = 0; i < 300; i++) { a = array<f32, 256>(); }";
        assert_eq!(rules_of(&brush(copies, "a[0]")), [("cost", 1)]);
    }
}
