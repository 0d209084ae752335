//! Functions: one text for each combination of variables that a function's pointers point to.

use super::same::Same;
use super::types::{Kind, Shape};
use super::{Unsupported, Writer};
use naga::valid::FunctionInfo;
use naga::{AddressSpace, Block, Expression, GlobalVariable, Handle, LocalVariable, Statement, TypeInner};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Which function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Which {
    Entry(usize),
    Function(Handle<naga::Function>),
}

/// A function, for what its arguments point to. A pointer to a global variable of an invocation is not passed: the function may use
/// the variable by its name as well, and in Rust there is one way to what is written.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Variant {
    which: Which,
    /// Of each argument the global that it points to.
    pub(super) pointers: Vec<Option<Handle<GlobalVariable>>>,
    /// Of each argument whether all lanes have the same.
    same: Vec<bool>,
}

impl Variant {
    pub(super) const fn entry(index: usize) -> Self {
        Self { which: Which::Entry(index), pointers: Vec::new(), same: Vec::new() }
    }
}

/// What encloses a statement and can be left.
#[derive(Debug, Clone, Copy)]
pub(super) enum Enclosing {
    /// A loop, and whether it has a `continue`.
    Loop {
        number: usize,
        continues: bool,
    },
    Switch {
        number: usize,
    },
}

/// A function that is being written.
pub(super) struct Function<'m> {
    pub(super) variant: Variant,
    pub(super) body: &'m naga::Function,
    pub(super) info: &'m FunctionInfo,
    /// Where each local variable is used.
    pub(super) scopes: BTreeMap<Handle<LocalVariable>, Scope>,
    /// What all lanes have alike.
    pub(super) same: Same,
    /// Whether some lanes may return before others.
    pub(super) returns_early: bool,
    /// What encloses the present statement, the innermost last.
    pub(super) enclosing: Vec<Enclosing>,
    /// The blocks that do.
    pub(super) path: Path,
    /// Names so far.
    pub(super) names: usize,
    pub(super) text: String,
}

/// The blocks around a statement, the innermost last, by where they lie in memory.
pub(super) type Path = Vec<*const Block>;

/// The innermost block in which all uses of a variable lie.
pub(super) struct Scope {
    pub(super) path: Path,
    /// Whether its first use there overwrites all of it: then no lane needs what another path has left in it.
    pub(super) begins_whole: bool,
}

impl<'m> Writer<'m> {
    /// Name of a variant in the text, and its function.
    fn named(&self, variant: &Variant) -> (String, &'m naga::Function, &'m FunctionInfo) {
        match variant.which {
            Which::Entry(index) => {
                let entry = &self.module.entry_points[index];
                (format!("f_{}", entry.name), &entry.function, self.info.get_entry_point(index))
            }
            Which::Function(handle) => {
                let function = &self.module.functions[handle];
                let mut name = format!("f_{}", function.name.as_deref().unwrap_or("unnamed"));
                for global in variant.pointers.iter().flatten() {
                    let _ = write!(name, "_{}", self.global(*global));
                }
                for (at, _) in variant.same.iter().enumerate().filter(|(_, same)| **same) {
                    let _ = write!(name, "_same{at}");
                }
                (name, function, &self.info[handle])
            }
        }
    }

    /// The variables of an invocation that a function uses, or is given pointers to.
    pub(super) fn privates(
        &self,
        info: &FunctionInfo,
        pointers: &[Option<Handle<GlobalVariable>>],
    ) -> Vec<Handle<GlobalVariable>> {
        let is_private = |space| space == AddressSpace::Private;
        let used = self
            .module
            .global_variables
            .iter()
            .filter(|(handle, v)| is_private(v.space) && !info[*handle].is_empty());
        let mut all: BTreeSet<_> = used.map(|(handle, _)| handle).collect();
        all.extend(pointers.iter().flatten().copied());
        all.into_iter().collect()
    }

    /// Writes a function.
    pub(super) fn function(&mut self, variant: &Variant) -> Result<(), Unsupported> {
        let (name, body, info) = self.named(variant);
        let said = body.name.clone().unwrap_or_else(|| name.clone());
        self.function_text(variant, &name, body, info).map_err(|what| Unsupported { what, function: said })
    }

    fn function_text(
        &mut self,
        variant: &Variant,
        name: &str,
        body: &'m naga::Function,
        info: &'m FunctionInfo,
    ) -> Result<(), String> {
        let returns = count_returns(&body.body);
        let ends = matches!(body.body.last(), Some(Statement::Return { .. }));
        let differs = matches!(variant.which, Which::Entry(_)).then_some(self.options.axis);
        let mut f = Function {
            variant: variant.clone(),
            body,
            info,
            scopes: scopes(body),
            same: Same::of(self.module, body, &variant.same, differs),
            returns_early: returns > usize::from(ends),
            enclosing: Vec::new(),
            path: Vec::new(),
            names: 0,
            text: String::new(),
        };
        let mut arguments = String::new();
        for global in self.privates(info, &variant.pointers) {
            let ty = self.rust(self.module.global_variables[global].ty)?;
            let _ = write!(arguments, ", {}: &mut {ty}", self.global(global));
        }
        arguments.push_str(", mask: M");
        for (at, argument) in body.arguments.iter().enumerate() {
            if variant.pointers.get(at).is_some_and(Option::is_some) {
                continue;
            }
            let ty = match self.module.types[argument.ty].inner {
                TypeInner::Pointer { base, space: AddressSpace::Function } => {
                    format!("&mut {}", self.rust(base)?)
                }
                _ => self.rust(argument.ty)?,
            };
            let _ = write!(arguments, ", a{at}: {ty}");
        }
        let (mut result, mut start, mut end) = (String::new(), String::new(), "");
        if let Some(returned) = &body.result {
            let ty = self.rust(returned.ty)?;
            result = format!(" -> {ty}");
            start = format!("let mut result: {ty} = {};\n", self.zero(returned.ty)?);
            end = "result\n";
        }
        if f.returns_early {
            start.push_str("let mut live = mask;\n");
        }
        for (handle, local) in body.local_variables.iter() {
            let ty = self.rust(local.ty)?;
            let value = match local.init {
                Some(init) => self.value(&f, init)?,
                None => self.zero(local.ty)?,
            };
            let _ = writeln!(start, "let mut l{}: {ty} = {value};", handle.index());
            if f.same.counts(handle) {
                let _ = writeln!(start, "let mut n{}: u32 = {value}.lane();", handle.index());
            }
        }
        self.block(&mut f, &body.body, "mask")?;
        let hint = if size(&body.body) < INLINED { "#[inline]\n" } else { "" };
        let _ = write!(
            self.text,
            "\n{hint}{}fn {name}(cx: &Cx<'_>{arguments}){result} {{\nlet mut mask = mask;\n{start}{}{end}}}\n",
            self.attribute(),
            f.text
        );
        Ok(())
    }

    /// Calls a function.
    pub(super) fn call(
        &mut self,
        f: &mut Function<'m>,
        callee: Handle<naga::Function>,
        arguments: &[Handle<Expression>],
        result: Option<Handle<Expression>>,
        mask: &str,
    ) -> Result<(), String> {
        let (mut pointers, mut values) = (Vec::new(), String::new());
        let is_number = |argument| {
            self.shape(f, argument).is_ok_and(|shape| shape.size.is_none() && shape.kind != Kind::Float)
        };
        let same = arguments.iter().map(|argument| f.same.has(*argument) && is_number(*argument)).collect();
        for &argument in arguments {
            if !self.is_pointer(f, argument) {
                pointers.push(None);
                let _ = write!(values, ", {}", self.value(f, argument)?);
                continue;
            }
            let place = self.place(f, argument)?;
            match place.root {
                super::place::Root::Global(global)
                    if self.module.global_variables[global].space == AddressSpace::Private =>
                {
                    if !place.steps.is_empty() {
                        return Err("a pointer to a part of a global variable".to_owned());
                    }
                    pointers.push(Some(global));
                }
                _ => {
                    pointers.push(None);
                    let _ = write!(values, ", {}", self.borrow(f, &place)?);
                }
            }
        }
        let variant = Variant { which: Which::Function(callee), pointers, same };
        let (name, _, info) = self.named(&variant);
        let privates: String = self
            .privates(info, &variant.pointers)
            .into_iter()
            .map(|handle| format!("{}, ", self.global(handle)))
            .collect();
        let bound = result.map_or_else(String::new, |result| format!("let e{} = ", result.index()));
        let _ = writeln!(f.text, "{bound}{name}(cx, {privates}{mask}{values});");
        if self.known.insert(variant.clone()) {
            self.wanted.push_back(variant);
        }
        Ok(())
    }

    /// Numbers or vectors of a kind.
    pub(super) fn shape(&self, f: &Function<'_>, expression: Handle<Expression>) -> Result<Shape, String> {
        Shape::of(self.inner_of(f, expression))
    }

    /// The type of an expression.
    pub(super) fn inner_of<'f>(
        &'f self,
        f: &'f Function<'_>,
        expression: Handle<Expression>,
    ) -> &'f TypeInner {
        f.info[expression].ty.inner_with(&self.module.types)
    }

    /// Whether an expression points to something.
    pub(super) fn is_pointer(&self, f: &Function<'_>, expression: Handle<Expression>) -> bool {
        matches!(self.inner_of(f, expression), TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. })
    }
}

/// Functions of fewer statements are to be inlined.
const INLINED: usize = 60;

/// The blocks directly within a statement.
fn within(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        _ => Vec::new(),
    }
}

/// Statements and expressions of a block.
fn size(block: &Block) -> usize {
    let one = |statement: &Statement| match statement {
        Statement::Emit(range) => range.clone().count(),
        _ => 1 + within(statement).into_iter().map(size).sum::<usize>(),
    };
    block.iter().map(one).sum()
}

/// How often a block returns.
pub(super) fn count_returns(block: &Block) -> usize {
    let one = |statement: &Statement| match statement {
        Statement::Return { .. } => 1,
        _ => within(statement).into_iter().map(count_returns).sum(),
    };
    block.iter().map(one).sum()
}

/// Whether a loop's body has a `continue` of its own.
pub(super) fn continues(block: &Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Continue => true,
        Statement::Loop { .. } => false,
        _ => within(statement).into_iter().any(continues),
    })
}

/// Whether lanes may leave a block by other ways than its end. In a loop and a switch `break` does not, and in a loop `continue`.
pub(super) fn leaves(block: &Block) -> bool {
    fn of(block: &Block, breaks: bool, continues: bool) -> bool {
        block.iter().any(|statement| match statement {
            Statement::Return { .. } | Statement::Kill => true,
            Statement::Break => breaks,
            Statement::Continue => continues,
            Statement::Loop { body, continuing, .. } => {
                of(body, false, false) || of(continuing, false, false)
            }
            Statement::Switch { cases, .. } => cases.iter().any(|case| of(&case.body, false, continues)),
            _ => within(statement).into_iter().any(|block| of(block, breaks, continues)),
        })
    }
    of(block, true, true)
}

/// A use of a local variable, in the order of the text.
struct LocalUse {
    local: Handle<LocalVariable>,
    path: Path,
    overwrites: bool,
}

/// Where each local variable is used.
fn scopes(function: &naga::Function) -> BTreeMap<Handle<LocalVariable>, Scope> {
    let mut uses = Vec::new();
    collect(function, &function.body, &mut Vec::new(), &mut uses);
    let mut scopes: BTreeMap<Handle<LocalVariable>, Scope> = BTreeMap::new();
    for one in &uses {
        let scope =
            scopes.entry(one.local).or_insert_with(|| Scope { path: one.path.clone(), begins_whole: false });
        let common = scope.path.iter().zip(&one.path).take_while(|(a, b)| a == b).count();
        scope.path.truncate(common);
    }
    for (local, scope) in &mut scopes {
        let first = uses.iter().find(|one| one.local == *local);
        scope.begins_whole =
            scope.path.is_empty() || first.is_some_and(|one| one.overwrites && one.path == scope.path);
    }
    scopes
}

fn collect(function: &naga::Function, block: &Block, path: &mut Path, uses: &mut Vec<LocalUse>) {
    let local = |mut pointer: Handle<Expression>| loop {
        match function.expressions[pointer] {
            Expression::LocalVariable(handle) => return Some(handle),
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => pointer = base,
            _ => return None,
        }
    };
    let is_whole =
        |pointer: Handle<Expression>| matches!(function.expressions[pointer], Expression::LocalVariable(_));
    for statement in block.iter() {
        let mut used = |pointer, overwrites| {
            if let Some(local) = local(pointer) {
                uses.push(LocalUse { local, path: path.clone(), overwrites });
            }
        };
        match statement {
            Statement::Emit(range) => {
                for expression in range.clone() {
                    if let Expression::Load { pointer } = function.expressions[expression] {
                        used(pointer, false);
                    }
                }
            }
            Statement::Store { pointer, .. } => used(*pointer, is_whole(*pointer)),
            Statement::Call { arguments, .. } => arguments.iter().for_each(|argument| used(*argument, false)),
            Statement::Block(block) => collect(function, block, path, uses), // in the same scope
            _ => {
                for block in within(statement) {
                    path.push(std::ptr::from_ref(block));
                    collect(function, block, path, uses);
                    path.pop();
                }
            }
        }
    }
}
