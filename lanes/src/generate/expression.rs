//! Expressions.

use super::Writer;
use super::function::Function;
use super::place::{Root, member};
use super::types::{Kind, Shape, literal, pick_one};
use naga::{
    BinaryOperator, Expression, Handle, MathFunction, RelationalFunction, ScalarKind, TypeInner,
    UnaryOperator,
};

impl<'m> Writer<'m> {
    /// The name of a value, or its text where it has none.
    pub(super) fn value(
        &mut self,
        f: &Function<'m>,
        expression: Handle<Expression>,
    ) -> Result<String, String> {
        match &f.body.expressions[expression] {
            &Expression::Literal(value) => literal(value),
            &Expression::Constant(constant) => self.constant(self.module.constants[constant].init),
            &Expression::ZeroValue(ty) => self.zero(ty),
            &Expression::FunctionArgument(at) => Ok(format!("a{at}")),
            Expression::Compose { .. } | Expression::Splat { .. } if self.is_constant(f, expression) => {
                self.expression(f, expression, "mask")
            }
            Expression::Override(_) => Err("an override".to_owned()),
            _ => Ok(format!("e{}", expression.index())),
        }
    }

    /// Whether an expression is never emitted, since it is known when the shader is compiled.
    fn is_constant(&self, f: &Function<'_>, expression: Handle<Expression>) -> bool {
        match &f.body.expressions[expression] {
            Expression::Literal(_) | Expression::Constant(_) | Expression::ZeroValue(_) => true,
            Expression::Compose { components, .. } => {
                components.iter().all(|part| self.is_constant(f, *part))
            }
            Expression::Splat { value, .. } => self.is_constant(f, *value),
            _ => false,
        }
    }

    /// The text of an expression.
    pub(super) fn expression(
        &mut self,
        f: &Function<'m>,
        expression: Handle<Expression>,
        mask: &str,
    ) -> Result<String, String> {
        match &f.body.expressions[expression] {
            Expression::Compose { ty, components } => {
                let is_vector = matches!(self.module.types[*ty].inner, TypeInner::Vector { .. });
                let mut parts = Vec::new();
                for &component in components {
                    let value = self.value(f, component)?;
                    match self.inner_of(f, component) {
                        TypeInner::Vector { size, .. } if is_vector => {
                            parts.extend((0..*size as u32).map(|at| format!("{value}[{at}]")));
                        }
                        _ => parts.push(value),
                    }
                }
                self.compose(*ty, &parts)
            }
            &Expression::Splat { size, value } => Ok(format!("[{}; {}]", self.value(f, value)?, size as u32)),
            &Expression::Swizzle { size, vector, ref pattern } => {
                let vector = self.value(f, vector)?;
                let parts: Vec<String> =
                    pattern[..size as usize].iter().map(|at| format!("{vector}[{}]", *at as u32)).collect();
                Ok(format!("[{}]", parts.join(", ")))
            }
            &Expression::AccessIndex { base, index } => {
                let value = self.value(f, base)?;
                Ok(member(self.inner_of(f, base), &value, index))
            }
            &Expression::Access { base, index: at } => {
                let (value, index) = (self.value(f, base)?, self.value(f, at)?);
                if f.same.has(at) {
                    return Ok(format!("{value}[place({index}.lane(), {value}.len())]"));
                }
                let inner = self.inner_of(f, base).clone();
                self.index_value(&inner, &value, &index, mask)
            }
            &Expression::Load { pointer } => match f.body.expressions[pointer] {
                Expression::LocalVariable(local) if f.same.has(expression) => {
                    Ok(format!("V::c(n{})", local.index()))
                }
                _ => self.load(f, pointer, mask),
            },
            &Expression::Unary { op, expr } => {
                let (value, shape) = (self.value(f, expr)?, self.shape(f, expr)?);
                let method = match (op, shape.kind) {
                    (UnaryOperator::Negate, Kind::Float) => "fneg()",
                    (UnaryOperator::Negate, _) => "ineg()",
                    (_, Kind::Bool) => "negated()",
                    _ => "xor(V::c(u32::MAX))",
                };
                Ok(shape.each(&[(&value, shape)], |parts| format!("{}.{method}", parts[0])))
            }
            &Expression::Binary { op, left, right } => self.binary(f, op, left, right),
            &Expression::Select { condition, accept, reject } => {
                let condition_shape = self.shape(f, condition)?;
                let (condition, yes, no) =
                    (self.value(f, condition)?, self.value(f, accept)?, self.value(f, reject)?);
                let shape = self.shape(f, accept)?;
                let values = [(condition.as_str(), condition_shape), (&yes, shape), (&no, shape)];
                Ok(shape.each(&values, |parts| pick_one(shape.kind, &parts[0], &parts[1], &parts[2])))
            }
            &Expression::Relational { fun, argument } => {
                let (value, shape) = (self.value(f, argument)?, self.shape(f, argument)?);
                let how = match fun {
                    RelationalFunction::All => "and",
                    RelationalFunction::Any => "or",
                    _ => return Err(format!("{fun:?}")),
                };
                let size = shape.size.unwrap_or(1);
                Ok((1..size).fold(format!("{value}[0]"), |all, at| format!("{all}.{how}({value}[{at}])")))
            }
            &Expression::Math { fun, arg, arg1, arg2, .. } => self.math(f, fun, [Some(arg), arg1, arg2]),
            &Expression::As { expr, kind, convert } => self.convert(f, expr, kind, convert),
            &Expression::ArrayLength(pointer) => {
                let place = self.place(f, pointer)?;
                let Root::Global(handle) = place.root else {
                    return Err("the length of a variable".to_owned());
                };
                match self.module.types[self.module.global_variables[handle].ty].inner {
                    TypeInner::Array { stride, .. } if place.steps.is_empty() => {
                        Ok(format!("V::c(cx.{}.len() / {})", self.global(handle), stride / 4))
                    }
                    _ => Err("the length of an array within a struct".to_owned()),
                }
            }
            other => Err(format!("the expression {other:?}")),
        }
    }

    fn binary(
        &mut self,
        f: &Function<'m>,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Result<String, String> {
        use BinaryOperator as Op;
        let (a, b) = (self.value(f, left)?, self.value(f, right)?);
        let (left, right) = (self.shape(f, left)?, self.shape(f, right)?);
        let letter = left.kind.letter();
        let plain =
            |name: &str| if left.kind == Kind::Float { format!("f{name}") } else { format!("i{name}") };
        // the method, whether the operands change places, whether the result is negated
        let (method, is_swapped, is_negated) = match (op, left.kind) {
            (Op::Add, _) => (plain("add"), false, false),
            (Op::Subtract, _) => (plain("sub"), false, false),
            (Op::Multiply, _) => (plain("mul"), false, false),
            (Op::Divide, _) => (format!("{letter}div"), false, false),
            (Op::Modulo, _) => (format!("{letter}rem"), false, false),
            (Op::Equal, Kind::Bool) => ("xor".to_owned(), false, true),
            (Op::NotEqual, Kind::Bool) => ("xor".to_owned(), false, false),
            (Op::Equal, _) => (plain("eq"), false, false),
            (Op::NotEqual, _) => (plain("eq"), false, true),
            (Op::Less, _) => (format!("{letter}lt"), false, false),
            (Op::Greater, _) => (format!("{letter}lt"), true, false),
            (Op::LessEqual, Kind::Float) => ("fleq".to_owned(), false, false),
            (Op::GreaterEqual, Kind::Float) => ("fleq".to_owned(), true, false),
            (Op::LessEqual, _) => (format!("{letter}lt"), true, true),
            (Op::GreaterEqual, _) => (format!("{letter}lt"), false, true),
            (Op::And | Op::LogicalAnd, _) => ("and".to_owned(), false, false),
            (Op::InclusiveOr | Op::LogicalOr, _) => ("or".to_owned(), false, false),
            (Op::ExclusiveOr, _) => ("xor".to_owned(), false, false),
            (Op::ShiftLeft, _) => ("ishl".to_owned(), false, false),
            (Op::ShiftRight, _) => (format!("{letter}shr"), false, false),
        };
        let shape = Shape { kind: left.kind, size: left.size.or(right.size) };
        let end = if is_negated { ".negated()" } else { "" };
        let ((first, first_shape), (second, second_shape)) =
            if is_swapped { ((b, right), (a, left)) } else { ((a, left), (b, right)) };
        let values = [(first.as_str(), first_shape), (second.as_str(), second_shape)];
        Ok(shape.each(&values, |parts| format!("{}.{method}({}){end}", parts[0], parts[1])))
    }

    /// The truth of a condition that is the same in all lanes, as a `bool`: of numbers without a detour by vectors.
    pub(super) fn truth(
        &mut self,
        f: &Function<'m>,
        condition: Handle<Expression>,
    ) -> Result<String, String> {
        use BinaryOperator as Op;
        if let Expression::Unary { op: UnaryOperator::LogicalNot, expr } = f.body.expressions[condition] {
            return Ok(format!("!({})", self.truth(f, expr)?));
        }
        if let Expression::Binary { op, left, right } = f.body.expressions[condition]
            && let number = match self.shape(f, left)? {
                Shape { kind: Kind::Unsigned, size: None } => Some(""),
                Shape { kind: Kind::Signed, size: None } => Some(" as i32"),
                _ => None,
            }
            && let Some(cast) = number
            && let Some(operator) = match op {
                Op::Equal => Some("=="),
                Op::NotEqual => Some("!="),
                Op::Less => Some("<"),
                Op::LessEqual => Some("<="),
                Op::Greater => Some(">"),
                Op::GreaterEqual => Some(">="),
                _ => None,
            }
        {
            let (a, b) = (self.value(f, left)?, self.value(f, right)?);
            return Ok(format!("({a}.lane(){cast}) {operator} ({b}.lane(){cast})"));
        }
        Ok(format!("{}.any()", self.value(f, condition)?))
    }

    fn math(
        &mut self,
        f: &Function<'m>,
        fun: MathFunction,
        arguments: [Option<Handle<Expression>>; 3],
    ) -> Result<String, String> {
        use MathFunction as Math;
        let (mut texts, mut shapes) = (Vec::new(), Vec::new());
        for argument in arguments.into_iter().flatten() {
            texts.push(self.value(f, argument)?);
            shapes.push(self.shape(f, argument)?);
        }
        let kind = shapes[0].kind;
        let letter = kind.letter();
        let is_float = kind == Kind::Float;
        let values: Vec<(&str, Shape)> =
            texts.iter().map(String::as_str).zip(shapes.iter().copied()).collect();
        let shape = Shape { kind, size: shapes.iter().find_map(|shape| shape.size) };
        let each = |one: &dyn Fn(&[String]) -> String| Ok(shape.each(&values, one));
        match fun {
            Math::Abs if kind == Kind::Unsigned => Ok(texts[0].clone()),
            Math::Abs => each(&|p| format!("{}.{letter}abs()", p[0])),
            Math::Min => each(&|p| format!("{}.{letter}min({})", p[0], p[1])),
            Math::Max => each(&|p| format!("{}.{letter}max({})", p[0], p[1])),
            Math::Clamp => each(&|p| format!("{}.{letter}clamp({}, {})", p[0], p[1], p[2])),
            Math::Saturate => each(&|p| format!("{}.fclamp(V::f(0.0), V::f(1.0))", p[0])),
            Math::Floor => each(&|p| format!("{}.ffloor()", p[0])),
            Math::Ceil => each(&|p| format!("{}.fceil()", p[0])),
            Math::Trunc => each(&|p| format!("{}.ftrunc()", p[0])),
            Math::Round => each(&|p| format!("{}.fround()", p[0])),
            Math::Fract => each(&|p| format!("{0}.fsub({0}.ffloor())", p[0])),
            Math::Sqrt => each(&|p| format!("{}.fsqrt()", p[0])),
            Math::InverseSqrt => each(&|p| format!("V::f(1.0).fdiv({}.fsqrt())", p[0])),
            Math::Mix => {
                each(&|p| format!("{0}.fmul(V::f(1.0).fsub({2})).fadd({1}.fmul({2}))", p[0], p[1], p[2]))
            }
            Math::Step => each(&|p| format!("{}.fleq({}).to_f()", p[0], p[1])),
            Math::CountOneBits => each(&|p| format!("{}.popcount()", p[0])),
            Math::CountLeadingZeros => each(&|p| format!("{}.leading_zeros()", p[0])),
            Math::CountTrailingZeros => each(&|p| format!("{}.trailing_zeros()", p[0])),
            Math::Dot => {
                let (add, multiply) = if is_float { ("fadd", "fmul") } else { ("iadd", "imul") };
                let one = |at: usize| format!("{}[{at}].{multiply}({}[{at}])", texts[0], texts[1]);
                Ok((1..shape.size.unwrap_or(1)).fold(one(0), |sum, at| format!("{sum}.{add}({})", one(at))))
            }
            other => Err(format!("{other:?}, which no two machines compute alike,")),
        }
    }

    fn convert(
        &mut self,
        f: &Function<'m>,
        expression: Handle<Expression>,
        to: ScalarKind,
        width: Option<u8>,
    ) -> Result<String, String> {
        let (value, shape) = (self.value(f, expression)?, self.shape(f, expression)?);
        let method = match (width, shape.kind, to) {
            (None, _, _) => "",
            (Some(4), Kind::Float, ScalarKind::Uint) => ".f_to_u()",
            (Some(4), Kind::Float, ScalarKind::Sint) => ".f_to_i()",
            (Some(4), Kind::Unsigned, ScalarKind::Float) => ".u_to_f()",
            (Some(4), Kind::Signed, ScalarKind::Float) => ".i_to_f()",
            (Some(4), Kind::Bool, ScalarKind::Float) => ".to_f()",
            (Some(4), Kind::Bool, ScalarKind::Uint | ScalarKind::Sint) => ".to_u()",
            (Some(_), Kind::Bool, ScalarKind::Bool) => "",
            (Some(_), Kind::Float, ScalarKind::Bool) => ".feq(V::c(0)).negated()",
            (Some(_), _, ScalarKind::Bool) => ".ieq(V::c(0)).negated()",
            (Some(4), _, ScalarKind::Float | ScalarKind::Uint | ScalarKind::Sint) => "",
            (_, _, kind) => return Err(format!("a conversion to {kind:?} of another width")),
        };
        Ok(shape.each(&[(&value, shape)], |parts| format!("{}{method}", parts[0])))
    }
}
