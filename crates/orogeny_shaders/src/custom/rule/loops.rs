//! How many rounds a loop takes, where that can be told.
//!
//! WGSL's `for` is gone in naga's module: it is a loop that begins with `if condition {} else { break; }` and steps its
//! counter in the `continuing` block. That form is looked for, whatever was written. What counts is where naga
//! evaluates an expression (its `Emit`), not where it stands: a `let` before a loop is the same in every round.

use std::collections::BTreeMap;

use naga::{
    Arena, BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, Module, Range,
    ScalarKind, Span, Statement, TypeInner,
};

use crate::compile::lint::inner_blocks;

/// The loops of a function.
pub(super) struct Loops<'a> {
    module: &'a Module,
    function: &'a Function,
    /// How often each variable is written in the text; too often if a pointer to it is given away.
    num_stores: BTreeMap<Handle<LocalVariable>, u32>,
}

impl<'a> Loops<'a> {
    pub(super) fn new(module: &'a Module, function: &'a Function) -> Self {
        let mut loops = Self { module, function, num_stores: BTreeMap::new() };
        loops.count_stores(&function.body);
        loops
    }

    fn count_stores(&mut self, block: &Block) {
        for statement in block.iter() {
            match statement {
                Statement::Store { pointer, .. } => self.add_stores(*pointer, 1),
                Statement::Call { arguments, .. } => {
                    arguments.iter().for_each(|argument| self.add_stores(*argument, 1000));
                }
                _ => {}
            }
            inner_blocks(statement).into_iter().for_each(|inner| self.count_stores(inner));
        }
    }

    fn add_stores(&mut self, pointer: Handle<Expression>, more: u32) {
        if let Some(variable) = self.variable(pointer) {
            let num_stores = self.num_stores.entry(variable).or_default();
            *num_stores = num_stores.saturating_add(more);
        }
    }

    /// Visits all loops of a block with the number of rounds that each takes at most, or why it is not known.
    pub(super) fn visit(
        &self,
        block: &Block,
        is_in_loop: bool,
        visit: &mut impl FnMut(Span, Result<u64, &'static str>),
    ) {
        for (index, (statement, span)) in block.span_iter().enumerate() {
            let is_loop = matches!(statement, Statement::Loop { .. });
            if is_loop {
                visit(*span, self.rounds(block, index, is_in_loop));
            }
            for inner in inner_blocks(statement) {
                self.visit(inner, is_in_loop || is_loop, visit);
            }
        }
    }

    /// How many rounds the loop at `index` of `block` takes at most.
    pub(super) fn rounds(&self, block: &Block, index: usize, is_in_loop: bool) -> Result<u64, &'static str> {
        let Some(Statement::Loop { body, continuing, break_if: None }) = block.get(index) else {
            return Err("a loop that is left by `break if`");
        };
        let (counter, op, bound) = self.condition(body)?;
        let step = self.step(continuing, counter)?;

        let before = block.get(..index).unwrap_or_default();
        let last = before.iter().rev().find(|statement| !matches!(statement, Statement::Emit(_)));
        let (start, num_stores) = match last {
            Some(&Statement::Store { pointer, value }) if self.variable(pointer) == Some(counter) => {
                (self.constant(value), 2)
            }
            // A `var` in no loop starts with its constant once.
            _ if !is_in_loop => {
                let variable = self.function.local_variables.try_get(counter).ok();
                (variable.and_then(|variable| variable.init.map_or(Some(0), |init| self.constant(init))), 1)
            }
            _ => (None, 2),
        };
        let start = start.ok_or("a counter that does not start at a constant, right before its loop")?;
        if self.num_stores.get(&counter) != Some(&num_stores) {
            return Err("a counter that is written elsewhere too");
        }
        let (least, most) = self.range(counter).ok_or("a counter that is no integer")?;

        let end = match op {
            BinaryOperator::Less | BinaryOperator::Greater => bound,
            BinaryOperator::LessEqual => bound + 1,
            _ => bound - 1,
        };
        let is_up = matches!(op, BinaryOperator::Less | BinaryOperator::LessEqual);
        if step == 0 || (step > 0) != is_up {
            return Err("a counter that does not go towards its bound");
        }
        // All are 32-bit numbers in 64 bits.
        let way = if is_up { end - start } else { start - end };
        let rounds = way.max(0).unsigned_abs().div_ceil(step.unsigned_abs());
        let last = i128::from(start) + i128::from(rounds) * i128::from(step);
        if last < i128::from(least) || last > i128::from(most) {
            return Err("a counter that passes the largest or the least number before its bound");
        }
        Ok(rounds)
    }

    /// The condition at the head of a loop: the counter, how it is compared, and with what.
    fn condition(&self, body: &Block) -> Result<(Handle<LocalVariable>, BinaryOperator, i64), &'static str> {
        let num_emits = body.iter().take_while(|statement| matches!(statement, Statement::Emit(_))).count();
        let (emits, rest) = body.split_at(num_emits);
        let condition = match rest.first() {
            Some(Statement::If { condition, accept, reject })
                if accept.is_empty() && matches!(reject.iter().as_slice(), [Statement::Break]) =>
            {
                *condition
            }
            _ => return Err("a loop that does not begin with its condition"),
        };
        let evaluated = Evaluated::of(emits);
        let expression = |handle| evaluated.get(&self.function.expressions, handle);
        let counter_of = |handle| match expression(handle) {
            Some(&Expression::Load { pointer }) => self.variable(pointer),
            _ => None,
        };
        let Some(&Expression::Binary { op, left, right }) = expression(condition) else {
            return Err("a condition that is no comparison of a counter");
        };
        let (counter, op, bound) = match (counter_of(left), counter_of(right)) {
            (Some(counter), _) => (counter, op, right),
            (None, Some(counter)) => (counter, mirrored(op), left),
            (None, None) => return Err("a condition that is no comparison of a counter"),
        };
        if !matches!(
            op,
            BinaryOperator::Less
                | BinaryOperator::LessEqual
                | BinaryOperator::Greater
                | BinaryOperator::GreaterEqual
        ) {
            return Err("a condition with none of <, <=, > and >=");
        }
        let bound = self.constant(bound).ok_or("a bound that is no constant")?;
        Ok((counter, op, bound))
    }

    /// What is added to the counter after each round.
    fn step(&self, continuing: &Block, counter: Handle<LocalVariable>) -> Result<i64, &'static str> {
        let Some((Statement::Store { pointer, value }, emits)) = continuing.split_last() else {
            return Err("a loop that does not step its counter");
        };
        let are_emits = emits.iter().all(|statement| matches!(statement, Statement::Emit(_)));
        if !are_emits || self.variable(*pointer) != Some(counter) {
            return Err("a loop that does not step its counter");
        }
        let evaluated = Evaluated::of(emits);
        let expression = |handle| evaluated.get(&self.function.expressions, handle);
        let is_counter = |handle| match expression(handle) {
            Some(&Expression::Load { pointer }) => self.variable(pointer) == Some(counter),
            _ => false,
        };
        let step = match expression(*value) {
            Some(&Expression::Binary { op: BinaryOperator::Add, left, right }) if is_counter(left) => {
                self.constant(right)
            }
            Some(&Expression::Binary { op: BinaryOperator::Add, left, right }) if is_counter(right) => {
                self.constant(left)
            }
            Some(&Expression::Binary { op: BinaryOperator::Subtract, left, right }) if is_counter(left) => {
                self.constant(right).map(|step| -step)
            }
            _ => None,
        };
        step.ok_or("a counter that is not stepped by a constant")
    }

    /// The variable that a pointer leads to as a whole.
    fn variable(&self, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        match self.function.expressions.try_get(pointer) {
            Ok(&Expression::LocalVariable(variable)) => Some(variable),
            _ => None,
        }
    }

    /// An integer that naga has worked out.
    fn constant(&self, handle: Handle<Expression>) -> Option<i64> {
        match self.function.expressions.try_get(handle) {
            Ok(&Expression::Constant(constant)) => {
                let init = self.module.constants.try_get(constant).ok()?.init;
                self.integer(self.module.global_expressions.try_get(init).ok()?)
            }
            Ok(expression) => self.integer(expression),
            Err(_) => None,
        }
    }

    fn integer(&self, expression: &Expression) -> Option<i64> {
        match *expression {
            Expression::Literal(Literal::I32(value)) => Some(value.into()),
            Expression::Literal(Literal::U32(value)) => Some(value.into()),
            Expression::ZeroValue(ty) => {
                let ty = self.module.types.get_handle(ty).ok()?;
                is_integer(&ty.inner).then_some(0)
            }
            _ => None,
        }
    }

    /// The least and the largest number that an integer variable holds.
    fn range(&self, variable: Handle<LocalVariable>) -> Option<(i64, i64)> {
        let ty = self.function.local_variables.try_get(variable).ok()?.ty;
        match self.module.types.get_handle(ty).ok()?.inner {
            TypeInner::Scalar(scalar) if scalar.width == 4 => match scalar.kind {
                ScalarKind::Sint => Some((i32::MIN.into(), i32::MAX.into())),
                ScalarKind::Uint => Some((0, u32::MAX.into())),
                _ => None,
            },
            _ => None,
        }
    }
}

fn is_integer(inner: &TypeInner) -> bool {
    matches!(inner, TypeInner::Scalar(scalar) if matches!(scalar.kind, ScalarKind::Sint | ScalarKind::Uint))
}

/// `a op b` as `b op a`.
fn mirrored(op: BinaryOperator) -> BinaryOperator {
    match op {
        BinaryOperator::Less => BinaryOperator::Greater,
        BinaryOperator::LessEqual => BinaryOperator::GreaterEqual,
        BinaryOperator::Greater => BinaryOperator::Less,
        BinaryOperator::GreaterEqual => BinaryOperator::LessEqual,
        other => other,
    }
}

/// The expressions that are evaluated at one place.
struct Evaluated(Vec<Range<Expression>>);

impl Evaluated {
    fn of(statements: &[Statement]) -> Self {
        let ranges = statements.iter().filter_map(|statement| match statement {
            Statement::Emit(range) => Some(range.clone()),
            _ => None,
        });
        Self(ranges.collect())
    }

    /// The expression, if it is one of them.
    fn get<'a>(
        &self,
        expressions: &'a Arena<Expression>,
        handle: Handle<Expression>,
    ) -> Option<&'a Expression> {
        let is_here = self.0.iter().any(|range| range.clone().any(|evaluated| evaluated == handle));
        is_here.then(|| expressions.try_get(handle).ok())?
    }
}
