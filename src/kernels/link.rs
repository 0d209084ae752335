//! A pass over SPIR-V that replaces operations by calls of functions, and declares how floats behave.
//!
//! The functions come from a *library*: a WGSL file of `shaders/operations/` with functions named `op_div`, `op_sqrt` and so
//! on ([`Operation::function`]). Vulkan leaves open how some operations round and which of two zeros they return; a library
//! leaves nothing open.

use super::spirv::{self, HEADER, instructions, op};
use std::collections::{HashMap, HashSet};
use std::fmt;

/// Why a library cannot be put into a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error {
    /// The library lacks the function of this name.
    Function(&'static str),
    /// The library has an instruction that this pass does not know.
    Instruction(u32),
    /// The module has no floats of 32 bits, or no extended instructions.
    Module,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Function(name) => write!(f, "the library has no function {name}"),
            Self::Instruction(opcode) => write!(f, "the library has the instruction {opcode}"),
            Self::Module => f.write_str("the module has no floats"),
        }
    }
}

impl std::error::Error for Error {}

/// An operation on floats that a library can replace.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operation {
    /// `a / b`
    Divide,
    /// `sqrt(x)`
    Root,
    /// `inverseSqrt(x)`
    InverseRoot,
    /// `min(a, b)`
    Least,
    /// `max(a, b)`
    Most,
    /// `clamp(x, low, high)`
    Clamp,
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a * b`, vectors times scalars too
    Multiply,
}

impl Operation {
    /// All operations.
    pub const ALL: [Self; 9] = [
        Self::Divide,
        Self::Root,
        Self::InverseRoot,
        Self::Least,
        Self::Most,
        Self::Clamp,
        Self::Add,
        Self::Subtract,
        Self::Multiply,
    ];

    /// The function of a library that stands in for it.
    pub const fn function(self) -> &'static str {
        match self {
            Self::Divide => "op_div",
            Self::Root => "op_sqrt",
            Self::InverseRoot => "op_rsqrt",
            Self::Least => "op_min",
            Self::Most => "op_max",
            Self::Clamp => "op_clamp",
            Self::Add => "op_add",
            Self::Subtract => "op_sub",
            Self::Multiply => "op_mul",
        }
    }

    /// The operation of an instruction and its first operand's place; `extended` is the id of GLSL.std.450.
    fn of(opcode: u32, instruction: &[u32], extended: Option<u32>) -> Option<(Self, usize)> {
        let operation = match opcode {
            op::F_ADD => Self::Add,
            op::F_SUB => Self::Subtract,
            op::F_MUL | op::VECTOR_TIMES_SCALAR => Self::Multiply,
            op::F_DIV => Self::Divide,
            op::EXT_INST if Some(instruction[3]) == extended => {
                let operation = match instruction[4] {
                    op::glsl::SQRT => Self::Root,
                    op::glsl::INVERSE_SQRT => Self::InverseRoot,
                    op::glsl::F_MIN => Self::Least,
                    op::glsl::F_MAX => Self::Most,
                    op::glsl::F_CLAMP => Self::Clamp,
                    _ => return None,
                };
                return Some((operation, 5));
            }
            _ => return None,
        };
        Some((operation, 3))
    }
}

/// How floats of 32 bits behave in a shader, where a device lets it be declared (`SPV_KHR_float_controls`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum FloatMode {
    /// Subnormal numbers are kept.
    DenormPreserve = 4459,
    /// Signs of zeros, infinities and NaN are kept.
    SignedZeroInfNanPreserve = 4461,
    /// Results are rounded to the nearest, ties to even.
    RoundingModeRte = 4462,
}

impl FloatMode {
    /// The capability that declares it.
    const fn capability(self) -> u32 {
        match self {
            Self::DenormPreserve => 4464,
            Self::SignedZeroInfNanPreserve => 4466,
            Self::RoundingModeRte => 4467,
        }
    }
}

/// Declares how floats behave in all entry points of a module.
pub fn declare(words: &[u32], modes: &[FloatMode]) -> Vec<u32> {
    if modes.is_empty() {
        return words.to_vec();
    }
    let mut out = words[..HEADER].to_vec();
    let points: Vec<u32> =
        instructions(words).filter(|(opcode, _)| *opcode == op::ENTRY_POINT).map(|(_, i)| i[2]).collect();
    let (mut capable, mut declared) = (false, false);
    for (opcode, instruction) in instructions(words) {
        if opcode != op::CAPABILITY && !capable {
            capable = true;
            modes.iter().for_each(|mode| push(&mut out, op::CAPABILITY, &[mode.capability()]));
            let name = b"SPV_KHR_float_controls\0\0";
            let name: Vec<u32> =
                name.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
            push(&mut out, op::EXTENSION, &name);
        }
        let is_before = matches!(
            opcode,
            op::CAPABILITY
                | op::EXTENSION
                | op::EXT_INST_IMPORT
                | op::MEMORY_MODEL
                | op::ENTRY_POINT
                | op::EXECUTION_MODE
        );
        if !is_before && !declared {
            declared = true;
            for (point, mode) in points.iter().flat_map(|point| modes.iter().map(move |mode| (point, mode))) {
                push(&mut out, op::EXECUTION_MODE, &[*point, *mode as u32, 32]);
            }
        }
        out.extend_from_slice(instruction);
    }
    out
}

fn push(out: &mut Vec<u32>, opcode: u32, operands: &[u32]) {
    #[allow(clippy::cast_possible_truncation, reason = "an instruction has fewer than 65,536 words")]
    out.push((operands.len() as u32 + 1) << 16 | opcode);
    out.extend_from_slice(operands);
}

/// A module with calls of the library's functions in place of the `wanted` operations. Vectors are taken apart. The library's
/// own operations stay.
///
/// # Errors
/// When the library lacks a function that is needed, or holds what this pass does not know.
pub fn link(words: &[u32], library: &[u32], wanted: &[Operation]) -> Result<Vec<u32>, Error> {
    let extended = import_of_glsl(words);
    let is_replaced = |opcode, instruction: &[u32]| {
        Operation::of(opcode, instruction, extended).filter(|(operation, _)| wanted.contains(operation))
    };
    let calls = |(opcode, i): (u32, &[u32])| is_replaced(opcode, i).map(|_| i[2]);
    let calls: HashSet<u32> = instructions(words).filter_map(calls).collect();
    if calls.is_empty() {
        return Ok(words.to_vec());
    }
    let mut linker = Linker::new(words, library)?;
    let mut out = words[..HEADER].to_vec();
    let (mut annotated, mut declared) = (false, false);
    for (opcode, instruction) in instructions(words) {
        if spirv::is_declaration(opcode) && !annotated {
            annotated = true;
            out.extend_from_slice(&linker.annotations);
        }
        if opcode == op::FUNCTION && !declared {
            declared = true;
            out.extend_from_slice(&linker.declarations);
        }
        if let Some((operation, first)) = is_replaced(opcode, instruction) {
            linker.call(operation, instruction, first, &mut out)?;
        } else if opcode != op::DECORATE || !calls.contains(&instruction[1]) {
            out.extend_from_slice(instruction);
        }
    }
    out.extend_from_slice(&linker.functions);
    out[3] = linker.bound;
    Ok(out)
}

/// The id under which a module has the extended instructions of GLSL.
fn import_of_glsl(words: &[u32]) -> Option<u32> {
    instructions(words).find(|(opcode, _)| *opcode == op::EXT_INST_IMPORT).map(|(_, i)| i[1])
}

/// A library on its way into a module.
struct Linker {
    /// The first id that is free.
    bound: u32,
    /// Functions of the library by their names, with the ids that they have in the module.
    named: HashMap<String, u32>,
    /// Type of each vector of floats, and its components.
    vectors: HashMap<u32, u32>,
    float: u32,
    /// Type of every value of the module that is a vector of floats.
    values: HashMap<u32, u32>,
    annotations: Vec<u32>,
    declarations: Vec<u32>,
    functions: Vec<u32>,
}

impl Linker {
    fn new(words: &[u32], library: &[u32]) -> Result<Self, Error> {
        let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
        let (mut vectors, mut values, mut float) = (HashMap::new(), HashMap::new(), None);
        for (opcode, i) in instructions(words) {
            if let Some(at) = declared_at(opcode) {
                known.entry(without(i, at)).or_insert(i[at]);
            }
            match opcode {
                op::TYPE_FLOAT if i[2] == 32 => float = Some(i[1]),
                op::TYPE_VECTOR if Some(i[2]) == float => _ = vectors.insert(i[1], i[3]),
                _ if spirv::has_result(opcode) && vectors.contains_key(&i[1]) => {
                    values.insert(i[2], i[1]);
                }
                _ => {}
            }
        }
        let glsl = import_of_glsl(words).ok_or(Error::Module)?;
        let float = float.ok_or(Error::Module)?;
        let [annotations, declarations, functions] = [const { Vec::new() }; 3];
        let (bound, named) = (words[3], HashMap::new());
        let mut new = Self { bound, named, vectors, float, values, annotations, declarations, functions };
        new.take(library, glsl, known)?;
        Ok(new)
    }

    /// A new id.
    const fn id(&mut self) -> u32 {
        self.bound += 1;
        self.bound - 1
    }

    /// Takes the library in, with ids of the module. What the module declares already is not declared again.
    fn take(&mut self, library: &[u32], glsl: u32, mut known: HashMap<Vec<u32>, u32>) -> Result<(), Error> {
        let mut ids: HashMap<u32, u32> = HashMap::new();
        let results: HashSet<u32> = instructions(library)
            .filter(|(opcode, _)| spirv::has_result(*opcode))
            .map(|(_, i)| i[2])
            .collect();
        let mut is_function = false;
        for (opcode, i) in instructions(library) {
            is_function |= opcode == op::FUNCTION;
            match opcode {
                op::EXT_INST_IMPORT => _ = ids.insert(i[1], glsl),
                op::NAME => _ = self.named.insert(spirv::text(&i[2..]), i[1]),
                op::DECORATE if results.contains(&i[1]) => {
                    let at = self.of(&mut ids, i[1]);
                    push(&mut self.annotations, opcode, &[&[at], &i[2..]].concat());
                }
                _ if is_function => {
                    let mut own = i.to_vec();
                    for at in spirv::ids(opcode, i).ok_or(Error::Instruction(opcode))? {
                        own[at] = self.of(&mut ids, own[at]);
                    }
                    self.functions.extend(own);
                }
                _ => {
                    let Some(at) = declared_at(opcode) else { continue };
                    let mut own = i.to_vec();
                    for operand in spirv::ids(opcode, i)
                        .ok_or(Error::Instruction(opcode))?
                        .into_iter()
                        .filter(|operand| *operand != at)
                    {
                        own[operand] = self.of(&mut ids, own[operand]);
                    }
                    if let Some(same) = known.get(&without(&own, at)) {
                        ids.insert(i[at], *same);
                    } else {
                        own[at] = self.of(&mut ids, i[at]);
                        known.insert(without(&own, at), own[at]);
                        self.declarations.extend(own);
                    }
                }
            }
        }
        for id in self.named.values_mut() {
            *id = ids.get(id).copied().unwrap_or_default();
        }
        Ok(())
    }

    /// The module's id for one of the library.
    fn of(&mut self, ids: &mut HashMap<u32, u32>, id: u32) -> u32 {
        *ids.entry(id).or_insert_with(|| self.id())
    }

    /// Writes the call that replaces an instruction, whose operands begin at `first`.
    fn call(
        &mut self,
        operation: Operation,
        instruction: &[u32],
        first: usize,
        out: &mut Vec<u32>,
    ) -> Result<(), Error> {
        let name = operation.function();
        let function = *self.named.get(name).ok_or(Error::Function(name))?;
        let (ty, result, operands) = (instruction[1], instruction[2], &instruction[first..]);
        let Some(&components) = self.vectors.get(&ty) else {
            push(out, op::FUNCTION_CALL, &[&[ty, result, function], operands].concat());
            return Ok(());
        };
        let mut parts = vec![ty, result];
        for component in 0..components {
            let mut call = vec![self.float, self.id(), function];
            for operand in operands {
                if self.values.contains_key(operand) {
                    let part = self.id();
                    push(out, op::COMPOSITE_EXTRACT, &[self.float, part, *operand, component]);
                    call.push(part);
                } else {
                    call.push(*operand); // the scalar that a vector is multiplied by
                }
            }
            parts.push(call[1]);
            push(out, op::FUNCTION_CALL, &call);
        }
        push(out, op::COMPOSITE_CONSTRUCT, &parts);
        Ok(())
    }
}

/// Where a type or constant has its id; none for what is neither.
const fn declared_at(opcode: u32) -> Option<usize> {
    match opcode {
        op::TYPE_VOID..=op::TYPE_FUNCTION => Some(1),
        op::CONSTANT_TRUE..=op::CONSTANT_NULL => Some(2),
        _ => None,
    }
}

/// An instruction without the id that it gives: equal for what need not be declared twice.
fn without(instruction: &[u32], at: usize) -> Vec<u32> {
    let mut key = instruction.to_vec();
    key.remove(at);
    key
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test")]
mod tests {
    use super::*;
    use crate::kernels::{Phase, operations};

    const CAREFUL: [Operation; 5] =
        [Operation::Divide, Operation::Root, Operation::Least, Operation::Most, Operation::Clamp];

    /// How often a module has each operation.
    fn count(words: &[u32]) -> HashMap<Operation, usize> {
        let extended = import_of_glsl(words);
        let mut found = HashMap::new();
        for (opcode, i) in instructions(words) {
            if let Some((operation, _)) = Operation::of(opcode, i, extended) {
                *found.entry(operation).or_default() += 1;
            }
        }
        found
    }

    #[test]
    fn only_operations_of_the_library_are_left_and_every_id_is_given_once() {
        let own = count(operations::CAREFUL);
        assert!(!own.contains_key(&Operation::Root) && own[&Operation::Divide] == 1);
        for phase in Phase::ALL {
            let entry = phase.entry();
            let linked = link(entry.spirv, operations::CAREFUL, &CAREFUL).unwrap();
            if !CAREFUL.iter().any(|operation| count(entry.spirv).contains_key(operation)) {
                assert_eq!(linked, entry.spirv, "{}: nothing to replace", entry.name);
                continue;
            }
            for operation in CAREFUL {
                assert_eq!(
                    count(&linked).get(&operation),
                    own.get(&operation),
                    "{}: {operation:?}",
                    entry.name
                );
            }
            let results =
                instructions(&linked).filter(|(opcode, _)| spirv::has_result(*opcode)).map(|(_, i)| i[2]);
            let labels = instructions(&linked).filter(|(opcode, _)| *opcode == 248).map(|(_, i)| i[1]);
            let mut given = HashSet::new();
            for id in results.chain(labels) {
                assert!(id < linked[3] && given.insert(id), "{}: the id {id} of {}", entry.name, linked[3]);
            }
        }
    }

    #[test]
    fn a_type_that_the_module_has_is_not_declared_again() {
        let entry = Phase::VelocityOrca.entry();
        let linked = link(entry.spirv, operations::CAREFUL, &CAREFUL).unwrap();
        let mut seen = HashSet::new();
        for (opcode, i) in instructions(&linked) {
            let is_type =
                matches!(opcode, op::TYPE_VOID..=op::TYPE_VECTOR | op::TYPE_POINTER | op::TYPE_FUNCTION);
            assert!(!is_type || seen.insert(without(i, 1)), "{i:?} twice");
        }
    }

    #[test]
    fn a_library_without_the_function_is_an_error_that_names_it() {
        let entry = Phase::VelocityOrca.entry();
        let error = link(entry.spirv, operations::PLAIN, &[Operation::Divide]).unwrap_err();
        assert_eq!(error, Error::Function("op_div"));
    }

    #[test]
    fn modes_are_declared_of_the_entry_point_and_nothing_without_modes() {
        let words = Phase::Integrate.entry().spirv;
        assert_eq!(declare(words, &[]), words);
        let declared = declare(words, &[FloatMode::RoundingModeRte]);
        let new: Vec<Vec<u32>> = instructions(&declared)
            .map(|(_, i)| i.to_vec())
            .filter(|i| !instructions(words).any(|(_, old)| old == i.as_slice()))
            .collect();
        let [capability, extension, mode] = &new[..] else { panic!("{new:?}") };
        assert_eq!(capability[1..], [4467]);
        assert_eq!(spirv::text(&extension[1..]), "SPV_KHR_float_controls");
        let point = instructions(words).find(|(opcode, _)| *opcode == op::ENTRY_POINT).unwrap().1[2];
        assert_eq!(mode[1..], [point, 4462, 32]);
    }
}
