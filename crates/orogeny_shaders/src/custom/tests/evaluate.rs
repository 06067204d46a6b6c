//! Runs functions of a naga module on the CPU, for tests: numbers, vectors, structs, variables, loops and calls.
//!
//! It rounds as Rust does. What it has no need of panics.

use std::collections::HashMap;

use naga::{
    BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, LocalVariable,
    MathFunction, Module, ScalarKind, Statement, TypeInner, UnaryOperator,
};

/// A value: a scalar is a vector of one.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    F32(Vec<f32>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    Bool(Vec<bool>),
    Struct(Vec<Value>),
    Pointer(Root, Vec<usize>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Root {
    Local(Handle<LocalVariable>),
    Global(Handle<GlobalVariable>),
}

/// A module with values for its uniforms and overrides, by their names.
pub(super) struct Machine<'a> {
    pub module: &'a Module,
    pub named: HashMap<&'static str, Value>,
}

/// What a block does to what comes after it.
enum Flow {
    On,
    Break,
    Continue,
    Return(Option<Value>),
}

struct Frame<'a> {
    machine: &'a Machine<'a>,
    function: &'a Function,
    arguments: Vec<Value>,
    locals: HashMap<Handle<LocalVariable>, Value>,
    known: HashMap<Handle<Expression>, Value>,
}

impl Machine<'_> {
    /// The result of the function of a name.
    pub(super) fn call(&self, name: &str, arguments: Vec<Value>) -> Value {
        let mut functions = self.module.functions.iter();
        let (handle, _) = functions.find(|(_, function)| function.name.as_deref() == Some(name)).unwrap();
        self.call_handle(handle, arguments).unwrap()
    }

    fn call_handle(&self, handle: Handle<Function>, arguments: Vec<Value>) -> Option<Value> {
        let function = &self.module.functions[handle];
        let mut frame =
            Frame { machine: self, function, arguments, locals: HashMap::new(), known: HashMap::new() };
        for (local, variable) in function.local_variables.iter() {
            let value = variable
                .init
                .map_or_else(|| self.zero(&self.module.types[variable.ty].inner), |init| frame.get(init));
            frame.locals.insert(local, value);
        }
        match frame.block(&function.body) {
            Flow::Return(value) => value,
            _ => None,
        }
    }

    fn zero(&self, inner: &TypeInner) -> Value {
        let (scalar, len) = match *inner {
            TypeInner::Scalar(scalar) => (scalar, 1),
            TypeInner::Vector { size, scalar } => (scalar, size as usize),
            TypeInner::Struct { ref members, .. } => {
                let zeros = members.iter().map(|member| self.zero(&self.module.types[member.ty].inner));
                return Value::Struct(zeros.collect());
            }
            _ => panic!("{inner:?}"),
        };
        match scalar.kind {
            ScalarKind::Float => Value::F32(vec![0.0; len]),
            ScalarKind::Sint => Value::I32(vec![0; len]),
            ScalarKind::Uint => Value::U32(vec![0; len]),
            _ => Value::Bool(vec![false; len]),
        }
    }

    fn constant(&self, expression: &Expression) -> Value {
        match expression {
            Expression::Literal(Literal::F32(value)) => Value::F32(vec![*value]),
            Expression::Literal(Literal::I32(value)) => Value::I32(vec![*value]),
            Expression::Literal(Literal::U32(value)) => Value::U32(vec![*value]),
            Expression::Literal(Literal::Bool(value)) => Value::Bool(vec![*value]),
            Expression::ZeroValue(ty) => self.zero(&self.module.types[*ty].inner),
            Expression::Constant(constant) => {
                self.constant(&self.module.global_expressions[self.module.constants[*constant].init])
            }
            Expression::Override(item) => {
                self.named[self.module.overrides[*item].name.as_deref().unwrap()].clone()
            }
            other => panic!("{other:?}"),
        }
    }
}

impl Frame<'_> {
    fn block(&mut self, block: &Block) -> Flow {
        for statement in block.iter() {
            let flow = match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        let value = self.evaluate(handle);
                        self.known.insert(handle, value);
                    }
                    Flow::On
                }
                Statement::Block(block) => self.block(block),
                Statement::If { condition, accept, reject } => {
                    let is_so = self.get(*condition) == Value::Bool(vec![true]);
                    self.block(if is_so { accept } else { reject })
                }
                Statement::Loop { body, continuing, .. } => loop {
                    match self.block(body) {
                        Flow::Break => break Flow::On,
                        Flow::Return(value) => break Flow::Return(value),
                        Flow::On | Flow::Continue => _ = self.block(continuing),
                    }
                },
                Statement::Break => Flow::Break,
                Statement::Continue => Flow::Continue,
                Statement::Return { value } => Flow::Return(value.map(|value| self.get(value))),
                Statement::Store { pointer, value } => {
                    let (Value::Pointer(Root::Local(local), path), value) =
                        (self.get(*pointer), self.get(*value))
                    else {
                        panic!("{statement:?}")
                    };
                    let target = self.locals.get_mut(&local).unwrap();
                    match path.as_slice() {
                        [] => *target = value,
                        [index] => set(target, *index, value),
                        _ => panic!("{path:?}"),
                    }
                    Flow::On
                }
                Statement::Call { function, arguments, result } => {
                    let arguments = arguments.iter().map(|argument| self.get(*argument)).collect();
                    let value = self.machine.call_handle(*function, arguments);
                    self.known.extend(result.zip(value));
                    Flow::On
                }
                other => panic!("{other:?}"),
            };
            if !matches!(flow, Flow::On) {
                return flow;
            }
        }
        Flow::On
    }

    /// What was evaluated, or what needs no evaluation.
    fn get(&self, handle: Handle<Expression>) -> Value {
        self.known.get(&handle).cloned().unwrap_or_else(|| self.evaluate(handle))
    }

    fn evaluate(&self, handle: Handle<Expression>) -> Value {
        match &self.function.expressions[handle] {
            Expression::FunctionArgument(index) => self.arguments[*index as usize].clone(),
            Expression::LocalVariable(local) => Value::Pointer(Root::Local(*local), Vec::new()),
            Expression::GlobalVariable(global) => Value::Pointer(Root::Global(*global), Vec::new()),
            Expression::Load { pointer } => self.load(self.get(*pointer)),
            Expression::AccessIndex { base, index } => match self.get(*base) {
                Value::Pointer(root, path) => Value::Pointer(root, [path, vec![*index as usize]].concat()),
                value => element(&value, *index as usize),
            },
            Expression::Compose { ty, components } => {
                let parts: Vec<Value> = components.iter().map(|component| self.get(*component)).collect();
                match self.machine.module.types[*ty].inner {
                    TypeInner::Struct { .. } => Value::Struct(parts),
                    _ => joined(parts),
                }
            }
            Expression::Splat { size, value } => joined(vec![self.get(*value); *size as usize]),
            Expression::Swizzle { size, vector, pattern } => {
                let vector = self.get(*vector);
                joined(
                    pattern[..*size as usize].iter().map(|from| element(&vector, *from as usize)).collect(),
                )
            }
            Expression::Unary { op, expr } => match (op, self.get(*expr)) {
                (UnaryOperator::Negate, Value::F32(a)) => Value::F32(a.iter().map(|a| -a).collect()),
                (UnaryOperator::Negate, Value::I32(a)) => {
                    Value::I32(a.iter().map(|a| a.wrapping_neg()).collect())
                }
                (UnaryOperator::LogicalNot, Value::Bool(a)) => Value::Bool(a.iter().map(|a| !a).collect()),
                other => panic!("{other:?}"),
            },
            Expression::Binary { op, left, right } => binary(*op, self.get(*left), self.get(*right)),
            Expression::Select { condition, accept, reject } => {
                let Value::Bool(condition) = self.get(*condition) else { panic!("{condition:?}") };
                let (accept, reject) = (self.get(*accept), self.get(*reject));
                if let [condition] = condition[..] {
                    return if condition { accept } else { reject };
                }
                let chosen = |(k, is_so): (usize, &bool)| element(if *is_so { &accept } else { &reject }, k);
                joined(condition.iter().enumerate().map(chosen).collect())
            }
            Expression::Math { fun, arg, arg1, arg2, .. } => {
                let arguments: Vec<Value> = [Some(*arg), *arg1, *arg2]
                    .into_iter()
                    .flatten()
                    .map(|argument| self.get(argument))
                    .collect();
                math(*fun, &arguments)
            }
            Expression::As { expr, kind, convert } => cast(self.get(*expr), *kind, convert.is_some()),
            other => self.machine.constant(other),
        }
    }

    fn load(&self, pointer: Value) -> Value {
        let Value::Pointer(root, path) = pointer else { panic!("{pointer:?}") };
        let whole = match root {
            Root::Local(local) => &self.locals[&local],
            Root::Global(global) => {
                &self.machine.named[self.machine.module.global_variables[global].name.as_deref().unwrap()]
            }
        };
        path.into_iter().fold(whole.clone(), |value, index| element(&value, index))
    }
}

fn element(value: &Value, index: usize) -> Value {
    match value {
        Value::F32(all) => Value::F32(vec![all[index]]),
        Value::I32(all) => Value::I32(vec![all[index]]),
        Value::U32(all) => Value::U32(vec![all[index]]),
        Value::Bool(all) => Value::Bool(vec![all[index]]),
        Value::Struct(all) => all[index].clone(),
        Value::Pointer(..) => panic!("{value:?}"),
    }
}

fn set(target: &mut Value, index: usize, value: Value) {
    match (target, value) {
        (Value::F32(all), Value::F32(value)) => all[index] = value[0],
        (Value::I32(all), Value::I32(value)) => all[index] = value[0],
        (Value::U32(all), Value::U32(value)) => all[index] = value[0],
        other => panic!("{other:?}"),
    }
}

fn joined(parts: Vec<Value>) -> Value {
    let joined = parts.into_iter().reduce(|whole, part| match (whole, part) {
        (Value::F32(a), Value::F32(b)) => Value::F32([a, b].concat()),
        (Value::I32(a), Value::I32(b)) => Value::I32([a, b].concat()),
        (Value::U32(a), Value::U32(b)) => Value::U32([a, b].concat()),
        (Value::Bool(a), Value::Bool(b)) => Value::Bool([a, b].concat()),
        other => panic!("{other:?}"),
    });
    joined.unwrap()
}

/// Applies `op` component by component; a scalar goes with each.
fn zip<T: Copy, R>(a: &[T], b: &[T], op: impl Fn(T, T) -> R) -> Vec<R> {
    let at = |all: &[T], k: usize| if all.len() == 1 { all[0] } else { all[k] };
    (0..a.len().max(b.len())).map(|k| op(at(a, k), at(b, k))).collect()
}

fn binary(op: BinaryOperator, left: Value, right: Value) -> Value {
    use BinaryOperator as Op;
    let compared = |ordering: Option<std::cmp::Ordering>| match op {
        Op::Equal => ordering.is_some_and(|ordering| ordering.is_eq()),
        Op::NotEqual => !ordering.is_some_and(|ordering| ordering.is_eq()),
        Op::Less => ordering.is_some_and(|ordering| ordering.is_lt()),
        Op::LessEqual => ordering.is_some_and(|ordering| ordering.is_le()),
        Op::Greater => ordering.is_some_and(|ordering| ordering.is_gt()),
        _ => ordering.is_some_and(|ordering| ordering.is_ge()),
    };
    let is_comparison =
        matches!(op, Op::Equal | Op::NotEqual | Op::Less | Op::LessEqual | Op::Greater | Op::GreaterEqual);
    match (left, right) {
        (Value::F32(a), Value::F32(b)) if is_comparison => {
            Value::Bool(zip(&a, &b, |a, b| compared(a.partial_cmp(&b))))
        }
        (Value::I32(a), Value::I32(b)) if is_comparison => {
            Value::Bool(zip(&a, &b, |a, b| compared(Some(a.cmp(&b)))))
        }
        (Value::U32(a), Value::U32(b)) if is_comparison => {
            Value::Bool(zip(&a, &b, |a, b| compared(Some(a.cmp(&b)))))
        }
        (Value::F32(a), Value::F32(b)) => Value::F32(zip(&a, &b, |a, b| match op {
            Op::Add => a + b,
            Op::Subtract => a - b,
            Op::Multiply => a * b,
            Op::Divide => a / b,
            _ => panic!("{op:?}"),
        })),
        (Value::U32(a), Value::U32(b)) => Value::U32(zip(&a, &b, |a, b| match op {
            Op::Add => a.wrapping_add(b),
            Op::Multiply => a.wrapping_mul(b),
            Op::And => a & b,
            Op::ExclusiveOr => a ^ b,
            Op::InclusiveOr => a | b,
            Op::ShiftRight => a >> b,
            Op::ShiftLeft => a << b,
            _ => panic!("{op:?}"),
        })),
        (Value::I32(a), Value::I32(b)) => Value::I32(zip(&a, &b, |a, b| match op {
            Op::Add => a.wrapping_add(b),
            Op::Subtract => a.wrapping_sub(b),
            Op::Multiply => a.wrapping_mul(b),
            Op::Divide => a.wrapping_div(b),
            Op::Modulo => a.wrapping_rem(b),
            _ => panic!("{op:?}"),
        })),
        (Value::I32(a), Value::U32(b)) => {
            assert_eq!(op, Op::ShiftRight);
            Value::I32(a.iter().map(|a| a >> b[0]).collect())
        }
        (Value::Bool(a), Value::Bool(b)) => Value::Bool(zip(&a, &b, |a, b| match op {
            Op::And | Op::LogicalAnd => a && b,
            Op::InclusiveOr | Op::LogicalOr => a || b,
            _ => panic!("{op:?}"),
        })),
        other => panic!("{op:?} {other:?}"),
    }
}

fn math(function: MathFunction, arguments: &[Value]) -> Value {
    match (function, arguments) {
        (MathFunction::Floor, [Value::F32(a)]) => Value::F32(a.iter().map(|a| a.floor()).collect()),
        (MathFunction::Clamp, [Value::F32(a), Value::F32(low), Value::F32(high)]) => {
            Value::F32(zip(&zip(a, low, f32::max), high, f32::min))
        }
        (MathFunction::Sqrt, [Value::F32(a)]) => Value::F32(a.iter().map(|a| a.sqrt()).collect()),
        other => panic!("{other:?}"),
    }
}

fn cast(value: Value, kind: ScalarKind, converts: bool) -> Value {
    match (value, kind, converts) {
        (Value::F32(a), ScalarKind::Float, true) => Value::F32(a),
        (Value::F32(a), ScalarKind::Sint, true) => Value::I32(a.iter().map(|a| *a as i32).collect()),
        (Value::F32(a), ScalarKind::Uint, false) => Value::U32(a.iter().map(|a| a.to_bits()).collect()),
        (Value::I32(a), ScalarKind::Uint, true) => Value::U32(a.iter().map(|a| *a as u32).collect()),
        (Value::I32(a), ScalarKind::Float, true) => Value::F32(a.iter().map(|a| *a as f32).collect()),
        (Value::U32(a), ScalarKind::Float, true) => Value::F32(a.iter().map(|a| *a as f32).collect()),
        (Value::U32(a), ScalarKind::Float, false) => {
            Value::F32(a.iter().map(|a| f32::from_bits(*a)).collect())
        }
        other => panic!("{other:?}"),
    }
}
