//! Values that all lanes have alike: constants, what callers pass so, counters of loops, what no invocation writes, and what
//! follows from these.
//!
//! The counter of a loop is a variable that begins with such a value right before the loop, grows by such a value at the end
//! of every turn, and is written nowhere else. Lanes leave a loop for good, so those in it have gone round as often, and the
//! counter of all of them is one number. Behind the loop each lane has its own: that of the turn in which it left.

use super::Axis;
use naga::{
    AddressSpace, Block, Expression, Handle, LocalVariable, Module, ScalarKind, Statement, StorageAccess,
    TypeInner,
};
use std::collections::{BTreeMap, BTreeSet};

type Path = Vec<*const Block>;

/// What a function has of such values.
#[derive(Debug, Default)]
pub(super) struct Same {
    /// Expressions.
    values: BTreeSet<Handle<Expression>>,
    /// Counters, and whether they are read outside of their loop.
    counters: BTreeMap<Handle<LocalVariable>, bool>,
}

/// A counter that may be one.
struct Candidate {
    /// The blocks of its loop.
    within: [*const Block; 2],
    /// What is stored in it.
    values: Vec<Handle<Expression>>,
    is_read_outside: bool,
}

/// A write to a variable, in the order of the text.
struct Write {
    local: Handle<LocalVariable>,
    path: Path,
    value: Option<Handle<Expression>>,
    at: usize,
}

/// A loop.
struct Loop {
    path: Path,
    blocks: [*const Block; 2],
    at: usize,
}

#[derive(Default)]
struct Found {
    writes: Vec<Write>,
    loops: Vec<Loop>,
    /// Blocks around the place where an expression is computed.
    computed: BTreeMap<Handle<Expression>, Path>,
    /// Statements so far.
    count: usize,
}

impl Same {
    /// Of a function whose arguments are the same in all lanes as `arguments` says. Those of an entry point are the number of the
    /// invocation, of which one component differs: `differs`.
    pub(super) fn of(
        module: &Module,
        function: &naga::Function,
        arguments: &[bool],
        differs: Option<Axis>,
    ) -> Self {
        let mut found = Found::default();
        walk(function, &function.body, &mut Vec::new(), &mut found);
        let mut candidates: BTreeMap<_, _> = function
            .local_variables
            .iter()
            .filter(|(_, local)| is_integer(&module.types[local.ty].inner))
            .filter_map(|(handle, _)| Some((handle, found.candidate(function, handle)?)))
            .collect();
        loop {
            let known =
                Known { module, function, arguments, differs, found: &found, candidates: &candidates };
            let wrong: Vec<_> = candidates
                .iter()
                .filter(|(_, one)| !one.values.iter().all(|value| known.is_same(*value)))
                .map(|(handle, _)| *handle)
                .collect();
            if wrong.is_empty() {
                let values = function
                    .expressions
                    .iter()
                    .map(|(handle, _)| handle)
                    .filter(|value| known.is_same(*value));
                let values = values.collect();
                let counters =
                    candidates.iter().map(|(handle, one)| (*handle, one.is_read_outside)).collect();
                return Self { values, counters };
            }
            candidates.retain(|handle, _| !wrong.contains(handle));
        }
    }

    /// Whether an expression has the same value in all lanes.
    pub(super) fn has(&self, value: Handle<Expression>) -> bool {
        self.values.contains(&value)
    }

    /// Whether a variable counts a loop.
    pub(super) fn counts(&self, local: Handle<LocalVariable>) -> bool {
        self.counters.contains_key(&local)
    }

    /// Whether a variable is needed lane by lane: it counts no loop, or is read behind it.
    pub(super) fn is_by_lane(&self, local: Handle<LocalVariable>) -> bool {
        self.counters.get(&local).copied().unwrap_or(true)
    }
}

fn is_integer(inner: &TypeInner) -> bool {
    matches!(inner, TypeInner::Scalar(scalar) if matches!(scalar.kind, ScalarKind::Uint | ScalarKind::Sint))
}

impl Found {
    /// The loop that a variable counts, by where it is written.
    fn candidate(&self, function: &naga::Function, local: Handle<LocalVariable>) -> Option<Candidate> {
        let writes: Vec<&Write> = self.writes.iter().filter(|write| write.local == local).collect();
        // the last write is the one at the end of a turn
        let (end, begin) = writes.split_last()?;
        let round = self.loops.iter().find(|round| end.path.last() == Some(&round.blocks[1]))?;
        let is_before = |write: &&&Write| write.path == round.path && write.at < round.at;
        if begin.len() > 1 || !begin.iter().all(|write| is_before(&write)) {
            return None;
        }
        // without a write it begins as it was declared, which is right for a loop that is come to once
        let is_once =
            !self.loops.iter().any(|outer| outer.blocks.iter().any(|block| round.path.contains(block)));
        if begin.is_empty() && !(is_once && function.local_variables[local].init.is_some()) {
            return None;
        }
        let values = writes.iter().map(|write| write.value).collect::<Option<Vec<_>>>()?;
        let is_load = |expression: Handle<Expression>| {
            let Expression::Load { pointer } = function.expressions[expression] else { return false };
            function.expressions[pointer] == Expression::LocalVariable(local)
        };
        let is_outside = |path: &Path| !round.blocks.iter().any(|block| path.contains(block));
        let is_read_outside =
            self.computed.iter().any(|(expression, path)| is_load(*expression) && is_outside(path));
        Some(Candidate { within: round.blocks, values, is_read_outside })
    }
}

fn walk(function: &naga::Function, block: &Block, path: &mut Path, found: &mut Found) {
    let local = |pointer: Handle<Expression>| match function.expressions[pointer] {
        Expression::LocalVariable(handle) => Some(handle),
        _ => None,
    };
    for statement in block.iter() {
        found.count += 1;
        let at = found.count;
        let mut inner = |block: &Block, found: &mut Found| {
            path.push(std::ptr::from_ref(block));
            walk(function, block, path, found);
            path.pop();
        };
        match statement {
            Statement::Emit(range) => {
                found.computed.extend(range.clone().map(|expression| (expression, path.clone())));
            }
            Statement::Store { pointer, value } => {
                if let Some(local) = local(*pointer) {
                    found.writes.push(Write { local, path: path.clone(), value: Some(*value), at });
                }
            }
            Statement::Call { arguments, .. } => {
                let given = arguments.iter().filter_map(|argument| local(*argument));
                let write = |local| Write { local, path: path.clone(), value: None, at };
                found.writes.extend(given.map(write));
            }
            Statement::Block(block) => walk(function, block, path, found), // in the same scope
            Statement::If { accept, reject, .. } => {
                inner(accept, found);
                inner(reject, found);
            }
            Statement::Loop { body, continuing, .. } => {
                let blocks = [body, continuing].map(std::ptr::from_ref);
                found.loops.push(Loop { path: path.clone(), blocks, at });
                let mut inner = |block: &Block, found: &mut Found| {
                    path.push(std::ptr::from_ref(block));
                    walk(function, block, path, found);
                    path.pop();
                };
                inner(body, found);
                inner(continuing, found);
            }
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| inner(&case.body, found)),
            _ => {}
        }
    }
}

/// What is known while counters are being found.
struct Known<'a> {
    module: &'a Module,
    function: &'a naga::Function,
    arguments: &'a [bool],
    differs: Option<Axis>,
    found: &'a Found,
    candidates: &'a BTreeMap<Handle<LocalVariable>, Candidate>,
}

impl Known<'_> {
    fn is_same(&self, value: Handle<Expression>) -> bool {
        match self.function.expressions[value] {
            Expression::Literal(_) | Expression::Constant(_) | Expression::ZeroValue(_) => true,
            Expression::FunctionArgument(at) => self.arguments.get(at as usize).copied().unwrap_or(false),
            Expression::Load { pointer } => self.is_same_load(value, pointer),
            Expression::AccessIndex { base, index } => {
                self.is_other_component(base, index) || self.is_same(base)
            }
            Expression::Access { base, index } => self.is_same(base) && self.is_same(index),
            Expression::Splat { value: part, .. } | Expression::Swizzle { vector: part, .. } => {
                self.is_same(part)
            }
            Expression::Compose { ref components, .. } => components.iter().all(|part| self.is_same(*part)),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => self.is_same(expr),
            Expression::Binary { left, right, .. } => self.is_same(left) && self.is_same(right),
            Expression::Select { condition, accept, reject } => {
                [condition, accept, reject].into_iter().all(|part| self.is_same(part))
            }
            Expression::Math { arg, arg1, arg2, arg3, .. } => {
                [Some(arg), arg1, arg2, arg3].into_iter().flatten().all(|part| self.is_same(part))
            }
            _ => false,
        }
    }

    fn is_same_load(&self, value: Handle<Expression>, pointer: Handle<Expression>) -> bool {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(local) => self.candidates.get(&local).is_some_and(|counter| {
                let path = self.found.computed.get(&value);
                path.is_some_and(|path| counter.within.iter().any(|block| path.contains(block)))
            }),
            _ => self.is_same_part(pointer),
        }
    }

    /// Whether a pointer is to a part of what no invocation writes, the same part for all lanes.
    fn is_same_part(&self, pointer: Handle<Expression>) -> bool {
        match self.function.expressions[pointer] {
            Expression::GlobalVariable(global) => match self.module.global_variables[global].space {
                AddressSpace::Immediate | AddressSpace::Uniform => true,
                AddressSpace::Storage { access } => !access.contains(StorageAccess::STORE),
                _ => false,
            },
            Expression::AccessIndex { base, .. } => self.is_same_part(base),
            Expression::Access { base, index } => self.is_same(index) && self.is_same_part(base),
            _ => false,
        }
    }

    /// Whether it is a component of the invocation's number along which the lanes do not lie.
    fn is_other_component(&self, base: Handle<Expression>, index: u32) -> bool {
        let is_number = matches!(self.function.expressions[base], Expression::FunctionArgument(_));
        is_number && self.differs.is_some_and(|axis| index != axis as u32)
    }
}
