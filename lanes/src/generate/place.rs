//! Places: what a pointer of the shader points to, and how it is read and written.

use super::Writer;
use super::function::Function;
use super::types::{Kind, Shape};
use naga::{AddressSpace, ArraySize, Expression, GlobalVariable, Handle, LocalVariable, Type, TypeInner};
use std::fmt::Write as _;

/// Where a place begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Root {
    Global(Handle<GlobalVariable>),
    Local(Handle<LocalVariable>),
    /// A pointer that the function takes.
    Argument(u32),
}

/// A step from a place to a part of it.
#[derive(Debug, Clone)]
pub(super) enum Step {
    At(u32),
    /// By a vector of indices, one a lane.
    By(String),
    /// By a vector of one index in all lanes.
    Same(String),
}

/// What a pointer points to.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) root: Root,
    pub(super) steps: Vec<Step>,
}

/// Part of a buffer: where it begins, in words.
pub(super) struct Span {
    /// The same for all lanes.
    fixed: u32,
    /// Vectors to be added.
    by_lane: Vec<String>,
    /// Whether all of these have the same in all lanes.
    are_same: bool,
    pub(super) ty: Part,
}

/// A type that need not have a name: a component or a column of one that has.
pub(super) enum Part {
    Named(Handle<Type>),
    Inner(TypeInner),
}

impl Span {
    /// The index of a word of it.
    pub(super) fn index(&self, offset: u32) -> String {
        let fixed = self.fixed + offset;
        let sum = self.by_lane.iter().cloned().reduce(|sum, one| format!("{sum}.iadd({one})"));
        match (sum, fixed) {
            (None, _) => format!("V::c({fixed})"),
            (Some(sum), 0) => sum,
            (Some(sum), _) => format!("{sum}.iadd(V::c({fixed}))"),
        }
    }
}

impl<'m> Writer<'m> {
    /// The place that a pointer points to.
    pub(super) fn place(&mut self, f: &Function<'m>, pointer: Handle<Expression>) -> Result<Place, String> {
        let start = |root| Ok(Place { root, steps: Vec::new() });
        match f.body.expressions[pointer] {
            Expression::GlobalVariable(handle) => start(Root::Global(handle)),
            Expression::LocalVariable(handle) => start(Root::Local(handle)),
            Expression::FunctionArgument(at) => start(match f.variant.pointers.get(at as usize) {
                Some(&Some(global)) => Root::Global(global),
                _ => Root::Argument(at),
            }),
            Expression::AccessIndex { base, index } => {
                let mut place = self.place(f, base)?;
                place.steps.push(Step::At(index));
                Ok(place)
            }
            Expression::Access { base, index } => {
                let mut place = self.place(f, base)?;
                let text = self.value(f, index)?;
                place.steps.push(if f.same.has(index) { Step::Same(text) } else { Step::By(text) });
                Ok(place)
            }
            _ => Err("a pointer that is not a path from a variable".to_owned()),
        }
    }

    /// The type of where a place begins.
    pub(super) fn root_type(&self, f: &Function<'m>, root: Root) -> Result<Handle<Type>, String> {
        match root {
            Root::Global(handle) => Ok(self.module.global_variables[handle].ty),
            Root::Local(handle) => Ok(f.body.local_variables[handle].ty),
            Root::Argument(at) => match self.module.types[f.body.arguments[at as usize].ty].inner {
                TypeInner::Pointer { base, .. } => Ok(base),
                _ => Err("a pointer to a part of a vector".to_owned()),
            },
        }
    }

    /// The variable, where the place is in one that each lane has for itself.
    fn variable(&self, root: Root) -> Option<String> {
        match root {
            Root::Local(handle) => Some(format!("l{}", handle.index())),
            Root::Argument(at) => Some(format!("(*a{at})")),
            Root::Global(handle) => match self.module.global_variables[handle].space {
                AddressSpace::Private => Some(format!("(*{})", self.global(handle))),
                _ => None,
            },
        }
    }

    /// Reads what a pointer points to.
    pub(super) fn load(
        &mut self,
        f: &Function<'m>,
        pointer: Handle<Expression>,
        mask: &str,
    ) -> Result<String, String> {
        let place = self.place(f, pointer)?;
        if let Some(variable) = self.variable(place.root) {
            let ty = self.root_type(f, place.root)?;
            return self.read(variable, Part::Named(ty), &place.steps, mask);
        }
        let Root::Global(handle) = place.root else {
            unreachable!("only globals are no variables of a lane")
        };
        let variable = &self.module.global_variables[handle];
        let name = self.global(handle);
        match variable.space {
            AddressSpace::Immediate if place.steps.is_empty() => Ok(format!("V::c(cx.{name})")),
            AddressSpace::Uniform | AddressSpace::Storage { .. } => {
                let span = self.span(variable.ty, &place.steps)?;
                if let Part::Named(ty) = span.ty
                    && let TypeInner::Atomic(_) = self.module.types[ty].inner
                {
                    return Ok(format!("atomic_load(cx.{name}, {}, V::c(0), {mask})", span.index(0)));
                }
                self.fetch(handle, &name, &span)
            }
            space => Err(format!("reading a variable of {space:?}")),
        }
    }

    /// The buffer of an atomic variable, and its index there.
    pub(super) fn atomic_place(
        &mut self,
        f: &Function<'m>,
        pointer: Handle<Expression>,
    ) -> Result<(String, String), String> {
        let place = self.place(f, pointer)?;
        match place.root {
            Root::Global(handle) if self.variable(place.root).is_none() => {
                let span = self.span(self.module.global_variables[handle].ty, &place.steps)?;
                Ok((self.global(handle), span.index(0)))
            }
            _ => Err("an atomic variable outside of a buffer".to_owned()),
        }
    }

    /// Reads a part of a variable that each lane has for itself.
    fn read(&mut self, base: String, ty: Part, steps: &[Step], mask: &str) -> Result<String, String> {
        let mut text = base;
        let mut part = ty;
        for step in steps {
            let inner = self.inner(&part);
            match step {
                Step::At(at) => text = member(&inner, &text, *at),
                Step::By(index) => text = format!("{}(&{text}, {index}, {mask})", self.reader(&inner)?),
                Step::Same(index) => text = format!("{text}[place({index}.lane(), {text}.len())]"),
            }
            part = self.part(&inner, step)?;
        }
        Ok(text)
    }

    /// The function that reads an element by an index of each lane.
    fn reader(&self, inner: &TypeInner) -> Result<&'static str, String> {
        Ok(if self.columns(inner)?.is_some() { "row_at" } else { "at" })
    }

    /// Columns of the rows of an array; none where it has single words.
    fn columns(&self, inner: &TypeInner) -> Result<Option<usize>, String> {
        let element = match *inner {
            TypeInner::Vector { scalar, .. } => TypeInner::Scalar(scalar),
            TypeInner::Matrix { rows, scalar, .. } => TypeInner::Vector { size: rows, scalar },
            TypeInner::Array { base, .. } => self.module.types[base].inner.clone(),
            _ => return Err("an index into what is no array".to_owned()),
        };
        let Ok(shape) = Shape::of(&element) else {
            return Err("an index that differs by lane into an array of structs or arrays".to_owned());
        };
        if shape.kind == Kind::Bool {
            return Err("an index that differs by lane into an array of bool".to_owned());
        }
        Ok(shape.size)
    }

    /// A part of a value by an index of each lane.
    pub(super) fn index_value(
        &mut self,
        inner: &TypeInner,
        value: &str,
        index: &str,
        mask: &str,
    ) -> Result<String, String> {
        Ok(format!("{}(&{value}, {index}, {mask})", self.reader(inner)?))
    }

    /// Writes a value to where a pointer points. With `is_whole` lanes that are not active may get anything.
    pub(super) fn store(
        &mut self,
        f: &mut Function<'m>,
        pointer: Handle<Expression>,
        value: &str,
        mask: &str,
        is_whole: bool,
    ) -> Result<(), String> {
        let place = self.place(f, pointer)?;
        let ty = self.root_type(f, place.root)?;
        if let Some(variable) = self.variable(place.root) {
            return self.write(f, variable, ty, &place.steps, value, mask, is_whole);
        }
        let Root::Global(handle) = place.root else {
            unreachable!("only globals are no variables of a lane")
        };
        let name = self.global(handle);
        let span = self.span(ty, &place.steps)?;
        if let Part::Named(ty) = span.ty
            && let TypeInner::Atomic(_) = self.module.types[ty].inner
        {
            let _ = writeln!(f.text, "atomic_store(cx.{name}, {}, {value}, {mask});", span.index(0));
            return Ok(());
        }
        let mut words = Vec::new();
        self.words(&span.ty, value, 0, &mut words)?;
        let is_row = words.len() > 1 && (0..).zip(&words).all(|(at, (offset, _))| at == *offset);
        if is_row {
            let all: Vec<&str> = words.iter().map(|(_, word)| word.as_str()).collect();
            let _ = writeln!(f.text, "set_row(cx.{name}, {}, [{}], {mask});", span.index(0), all.join(", "));
            return Ok(());
        }
        for (offset, word) in &words {
            let _ = writeln!(f.text, "set_word(cx.{name}, {}, {word}, {mask});", span.index(*offset));
        }
        Ok(())
    }

    #[allow(clippy::too_many_arguments, reason = "a place, its type, and how it is written")]
    fn write(
        &mut self,
        f: &mut Function<'m>,
        base: String,
        ty: Handle<Type>,
        steps: &[Step],
        value: &str,
        mask: &str,
        is_whole: bool,
    ) -> Result<(), String> {
        let mut text = base;
        let mut part = Part::Named(ty);
        for (number, step) in steps.iter().enumerate() {
            let inner = self.inner(&part);
            match step {
                Step::At(at) => text = member(&inner, &text, *at),
                Step::Same(index) => text = format!("{text}[place({index}.lane(), {text}.len())]"),
                Step::By(index) => {
                    let columns = self.columns(&inner)?;
                    let _ = match (&steps[number + 1..], columns) {
                        ([], None) => writeln!(f.text, "put(&mut {text}, {index}, {value}, {mask});"),
                        ([], Some(_)) => writeln!(f.text, "row_put(&mut {text}, {index}, {value}, {mask});"),
                        ([Step::At(column)], Some(_)) => {
                            writeln!(f.text, "put_column(&mut {text}, {index}, {column}, {value}, {mask});")
                        }
                        _ => return Err("an index that differs by lane within another".to_owned()),
                    };
                    return Ok(());
                }
            }
            part = self.part(&inner, step)?;
        }
        if is_whole {
            let _ = writeln!(f.text, "{text} = {value};");
            return Ok(());
        }
        let picked = match part {
            Part::Named(ty) => self.pick(ty, mask, value, &text)?,
            Part::Inner(inner) => super::types::pick_words(&inner, mask, value, &text)?,
        };
        let _ = writeln!(f.text, "{text} = {picked};");
        Ok(())
    }

    /// A pointer to a variable of each lane, to be passed on.
    pub(super) fn borrow(&mut self, f: &Function<'m>, place: &Place) -> Result<String, String> {
        let ty = self.root_type(f, place.root)?;
        let Some(mut text) = self.variable(place.root) else {
            return Err("a pointer to a buffer as an argument".to_owned());
        };
        let mut part = Part::Named(ty);
        for step in &place.steps {
            let inner = self.inner(&part);
            let Step::At(at) = step else {
                return Err("a pointer by an index that differs by lane".to_owned());
            };
            text = member(&inner, &text, *at);
            part = self.part(&inner, step)?;
        }
        Ok(format!("&mut {text}"))
    }

    fn inner(&self, part: &Part) -> TypeInner {
        match part {
            Part::Named(ty) => self.module.types[*ty].inner.clone(),
            Part::Inner(inner) => inner.clone(),
        }
    }

    /// The type of a part.
    fn part(&self, inner: &TypeInner, step: &Step) -> Result<Part, String> {
        Ok(match (inner, step) {
            (TypeInner::Vector { scalar, .. }, _) => Part::Inner(TypeInner::Scalar(*scalar)),
            (TypeInner::Matrix { rows, scalar, .. }, _) => {
                Part::Inner(TypeInner::Vector { size: *rows, scalar: *scalar })
            }
            (TypeInner::Array { base, .. }, _) => Part::Named(*base),
            (TypeInner::Struct { members, .. }, Step::At(at)) => Part::Named(members[*at as usize].ty),
            _ => return Err("a path through what has no parts".to_owned()),
        })
    }

    /// Part of a buffer.
    pub(super) fn span(&mut self, ty: Handle<Type>, steps: &[Step]) -> Result<Span, String> {
        let mut span = Span { fixed: 0, by_lane: Vec::new(), are_same: true, ty: Part::Named(ty) };
        for step in steps {
            let inner = self.inner(&span.ty);
            let (stride, count) = match &inner {
                TypeInner::Vector { size, .. } => (1, Some(*size as u32)),
                TypeInner::Matrix { rows, columns, .. } => {
                    (if *rows as u32 == 3 { 4 } else { *rows as u32 }, Some(*columns as u32))
                }
                TypeInner::Array { stride, size, .. } => (
                    stride / 4,
                    match size {
                        ArraySize::Constant(count) => Some(count.get()),
                        _ => None,
                    },
                ),
                TypeInner::Struct { members, .. } => {
                    if let Step::At(at) = step {
                        span.fixed += members[*at as usize].offset / 4;
                    }
                    (0, None)
                }
                _ => (0, None),
            };
            match step {
                Step::At(at) => span.fixed += at * stride,
                Step::By(index) | Step::Same(index) => {
                    span.are_same &= matches!(step, Step::Same(_));
                    let index = match count {
                        Some(count) => format!("{index}.umin(V::c({}))", count - 1),
                        None => index.clone(),
                    };
                    span.by_lane.push(match stride {
                        1 => index,
                        _ if stride.is_power_of_two() => {
                            format!("{index}.ishl(V::c({}))", stride.trailing_zeros())
                        }
                        _ => format!("{index}.imul(V::c({stride}))"),
                    });
                }
            }
            span.ty = self.part(&inner, step)?;
        }
        Ok(span)
    }

    /// Reads a part of a buffer.
    fn fetch(&mut self, buffer: Handle<GlobalVariable>, name: &str, span: &Span) -> Result<String, String> {
        if span.by_lane.is_empty() {
            let word = |at: u32| format!("V::c(cx.{name}.word({}))", span.fixed + at);
            return self.assemble(&span.ty, 0, &word);
        }
        let size = self.size(&span.ty)?;
        if span.are_same {
            let value = self.assemble(&span.ty, 0, &|at| format!("row[{at}]"))?;
            return Ok(format!(
                "{{ let row: [V; {size}] = row_of(cx.{name}, {}.lane()); {value} }}",
                span.index(0)
            ));
        }
        if self.kept_words(buffer).is_some() && size > 1 {
            let value = self.assemble(&span.ty, 0, &|at| format!("row[{at}]"))?;
            let read =
                format!("cx.kept_{name}.rows::<{size}, {size}>(cx.{name}, {}, M::c(true))", span.index(0));
            return Ok(format!("{{ let row: [V; {size}] = {read}; {value} }}"));
        }
        if size == 1 {
            return Ok(format!("word(cx.{name}, {})", span.index(0)));
        }
        let value = self.assemble(&span.ty, 0, &|at| format!("row[{at}]"))?;
        Ok(format!("{{ let row: [V; {size}] = row(cx.{name}, {}); {value} }}", span.index(0)))
    }

    /// Words of a type in a buffer.
    pub(super) fn size(&self, part: &Part) -> Result<u32, String> {
        let inner = self.inner(part);
        Ok(match &inner {
            TypeInner::Struct { span, .. } => span / 4,
            TypeInner::Array { stride, size: ArraySize::Constant(count), .. } => stride / 4 * count.get(),
            TypeInner::Matrix { columns, rows, .. } => {
                *columns as u32 * if *rows as u32 == 3 { 4 } else { *rows as u32 }
            }
            _ => Shape::of(&inner)?.size.map_or(1, |size| size as u32),
        })
    }

    /// A value of a type of the words of a buffer.
    pub(super) fn assemble(
        &mut self,
        part: &Part,
        at: u32,
        word: &dyn Fn(u32) -> String,
    ) -> Result<String, String> {
        let inner = self.inner(part);
        let mut parts = Vec::new();
        match &inner {
            TypeInner::Struct { members, .. } => {
                for member in members {
                    parts.push(self.assemble(&Part::Named(member.ty), at + member.offset / 4, word)?);
                }
                let Part::Named(ty) = part else { return Err("a struct without a name".to_owned()) };
                return self.compose(*ty, &parts);
            }
            TypeInner::Array { base, stride, size: ArraySize::Constant(count) } => {
                for element in 0..count.get() {
                    parts.push(self.assemble(&Part::Named(*base), at + element * stride / 4, word)?);
                }
            }
            TypeInner::Matrix { columns, rows, .. } => {
                let stride = if *rows as u32 == 3 { 4 } else { *rows as u32 };
                for column in 0..*columns as u32 {
                    let all: Vec<String> =
                        (0..*rows as u32).map(|row| word(at + column * stride + row)).collect();
                    parts.push(format!("[{}]", all.join(", ")));
                }
            }
            _ => {
                let shape = Shape::of(&inner)?;
                let Some(size) = shape.size else { return Ok(word(at)) };
                parts.extend((0..size as u32).map(|component| word(at + component)));
            }
        }
        Ok(format!("[{}]", parts.join(", ")))
    }

    /// The words of a value with their offsets from its first.
    fn words(&self, part: &Part, value: &str, at: u32, words: &mut Vec<(u32, String)>) -> Result<(), String> {
        let inner = self.inner(part);
        match &inner {
            TypeInner::Struct { members, .. } => {
                for (number, member) in members.iter().enumerate() {
                    let value = format!("{value}.m{number}");
                    self.words(&Part::Named(member.ty), &value, at + member.offset / 4, words)?;
                }
            }
            TypeInner::Array { base, stride, size: ArraySize::Constant(count) } => {
                for element in 0..count.get() {
                    let value = format!("{value}[{element}]");
                    self.words(&Part::Named(*base), &value, at + element * stride / 4, words)?;
                }
            }
            TypeInner::Matrix { .. } => return Err("writing a matrix".to_owned()),
            _ => match Shape::of(&inner)?.size {
                None => words.push((at, value.to_owned())),
                Some(size) => {
                    words.extend((0..size as u32).map(|part| (at + part, format!("{value}[{part}]"))));
                }
            },
        }
        Ok(())
    }
}

/// A part of a value or a variable, by its number.
pub(super) fn member(inner: &TypeInner, text: &str, at: u32) -> String {
    match inner {
        TypeInner::Struct { .. } => format!("{text}.m{at}"),
        _ => format!("{text}[{at}]"),
    }
}
