//! SPIR-V as a stream of words: five header words, then instructions of `(length << 16 | opcode), operands…`. Two passes
//! over what naga writes; `link` is a third.

use std::collections::{HashMap, HashSet};

/// Words before the first instruction.
pub const HEADER: usize = 5;
/// Which word of it is above all ids.
pub const BOUND: usize = 3;

/// Numbers of instructions.
#[allow(missing_docs, reason = "named as in the specification")]
pub mod op {
    pub const NAME: u32 = 5;
    pub const EXTENSION: u32 = 10;
    pub const EXT_INST_IMPORT: u32 = 11;
    pub const EXT_INST: u32 = 12;
    pub const MEMORY_MODEL: u32 = 14;
    pub const ENTRY_POINT: u32 = 15;
    pub const EXECUTION_MODE: u32 = 16;
    pub const CAPABILITY: u32 = 17;
    pub const TYPE_VOID: u32 = 19;
    pub const TYPE_FLOAT: u32 = 22;
    pub const TYPE_VECTOR: u32 = 23;
    pub const TYPE_MATRIX: u32 = 24;
    pub const TYPE_ARRAY: u32 = 28;
    pub const TYPE_RUNTIME_ARRAY: u32 = 29;
    pub const TYPE_STRUCT: u32 = 30;
    pub const TYPE_POINTER: u32 = 32;
    pub const TYPE_FUNCTION: u32 = 33;
    pub const CONSTANT_TRUE: u32 = 41;
    pub const CONSTANT: u32 = 43;
    pub const CONSTANT_NULL: u32 = 46;
    pub const FUNCTION: u32 = 54;
    pub const FUNCTION_CALL: u32 = 57;
    pub const VARIABLE: u32 = 59;
    pub const LOAD: u32 = 61;
    pub const ACCESS_CHAIN: u32 = 65;
    pub const DECORATE: u32 = 71;
    pub const MEMBER_DECORATE: u32 = 72;
    pub const COMPOSITE_CONSTRUCT: u32 = 80;
    pub const COMPOSITE_EXTRACT: u32 = 81;
    pub const COPY_OBJECT: u32 = 83;
    pub const F_ADD: u32 = 129;
    pub const F_SUB: u32 = 131;
    pub const F_MUL: u32 = 133;
    pub const F_DIV: u32 = 136;
    pub const VECTOR_TIMES_SCALAR: u32 = 142;
    /// Numbers of the extended instructions of GLSL.std.450.
    pub mod glsl {
        pub const SQRT: u32 = 31;
        pub const INVERSE_SQRT: u32 = 32;
        pub const F_MIN: u32 = 37;
        pub const F_MAX: u32 = 40;
        pub const F_CLAMP: u32 = 43;
    }
}
const DECORATION_NO_CONTRACTION: u32 = 42;
const DECORATION_ARRAY_STRIDE: u32 = 6;

/// Splits the module into `(opcode, all words of the instruction)`.
pub fn instructions(words: &[u32]) -> impl Iterator<Item = (u32, &[u32])> {
    let mut at = HEADER;
    std::iter::from_fn(move || {
        let first = *words.get(at)?;
        let length = ((first >> 16) as usize).max(1);
        let instruction = words.get(at..at + length)?;
        at += length;
        Some((first & 0xffff, instruction))
    })
}

/// Whether an instruction declares a type, a constant or a variable: they follow the annotations.
pub const fn is_declaration(opcode: u32) -> bool {
    matches!(opcode, 19..=59)
}

/// Whether an instruction gives a value: its second word is the type, its third the id.
pub const fn has_result(opcode: u32) -> bool {
    matches!(opcode, 1 | 12 | 41..=61 | 65..=68 | 77..=98 | 100..=205 | 227 | 229..=242 | 245)
        && !matches!(opcode, op::FUNCTION | 56)
}

/// The words of an instruction inside a function, of a type or of a constant that are ids; none for an instruction that is not
/// known.
pub fn ids(opcode: u32, instruction: &[u32]) -> Option<Vec<usize>> {
    let end = instruction.len();
    let ids: Vec<usize> = match opcode {
        // extended instruction: type, result, set, number, operands
        op::EXT_INST => [1, 2, 3].into_iter().chain(5..end).collect(),
        // types of no parts, blocks; constants with literals behind
        19..=22 | 248 | 249 => vec![1],
        41..=43 => vec![1, 2],
        op::TYPE_VECTOR => vec![1, 2],
        op::TYPE_POINTER => vec![1, 3],
        // function: type, result, control, type of the function; variable: type, result, class
        op::FUNCTION => vec![1, 2, 4],
        59 => [1, 2].into_iter().chain(4..end).collect(),
        // load and store with a literal behind; extract
        61 => vec![1, 2, 3],
        62 => vec![1, 2],
        op::COMPOSITE_EXTRACT => vec![1, 2, 3],
        // merges: blocks and a literal
        246 => vec![1, 2],
        247 => vec![1],
        250 => vec![1, 2, 3],
        op::TYPE_FUNCTION | 44 | 46 | 55..=57 | op::COMPOSITE_CONSTRUCT | 109..=205 | 245 | 252..=255 => {
            (1..end).collect()
        }
        _ => return None,
    };
    Some(ids)
}

/// The text that literal words hold.
pub fn text(words: &[u32]) -> String {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|byte| *byte != 0);
    String::from_utf8_lossy(&bytes.collect::<Vec<_>>()).into_owned()
}

/// The first operation on floats whose result Vulkan does not define to the bit, and that no library replaces, by its name.
pub fn inexact(words: &[u32]) -> Option<String> {
    // absolute values, floor, ceil, trunc and integers; the rest of what is replaced
    const EXTENDED: [u32; 19] = [3, 4, 5, 7, 8, 9, 31, 37, 38, 39, 40, 41, 42, 43, 44, 45, 73, 74, 75];
    instructions(words).find_map(|(opcode, i)| match opcode {
        140 | 141 | 143..=148 => {
            Some(format!("the SPIR-V instruction {opcode} (remainder, matrix or dot product)"))
        }
        op::EXT_INST if !EXTENDED.contains(&i[4]) => {
            Some(format!("the instruction {} of GLSL.std.450", i[4]))
        }
        _ => None,
    })
}

/// Decorates the result of every float arithmetic instruction with `NoContraction`.
///
/// naga emits none, so a driver may fuse `a*b+c` or re-associate sums; the CPU does neither, and a crowd that
/// differs by one rounding is a different crowd after some hundred steps.
pub fn no_contraction(words: &[u32]) -> Vec<u32> {
    // FNegate FAdd FSub FMul FDiv FRem FMod, vector and matrix times scalar, vector, matrix; OuterProduct Dot
    const ARITHMETIC: [u32; 14] = [127, 129, 131, 133, 136, 140, 141, 142, 143, 144, 145, 146, 147, 148];
    let mut out = words[..HEADER].to_vec();
    let mut annotated = false;
    for (opcode, instruction) in instructions(words) {
        if is_declaration(opcode) && !annotated {
            annotated = true;
            for (_, result) in instructions(words).filter(|(op, _)| ARITHMETIC.contains(op)) {
                out.extend([(3 << 16) | op::DECORATE, result[2], DECORATION_NO_CONTRACTION]);
            }
        }
        out.extend_from_slice(instruction);
    }
    out
}

/// A module whose immediate, one word, is this number for good: what the code does for other numbers a driver leaves out.
pub fn with_immediate(words: &[u32], number: u32) -> Vec<u32> {
    const PUSH_CONSTANT: u32 = 9;
    let (mut places, mut word) = (HashSet::new(), None);
    for (opcode, i) in instructions(words) {
        match opcode {
            op::VARIABLE if i[3] == PUSH_CONSTANT => {
                places.insert(i[2]);
            }
            op::ACCESS_CHAIN if places.contains(&i[3]) => {
                places.insert(i[2]);
            }
            op::LOAD if places.contains(&i[3]) => word = Some(i[1]),
            _ => {}
        }
    }
    let Some(word) = word else { return words.to_vec() };
    let mut out = words[..HEADER].to_vec();
    let constant = out[BOUND];
    out[BOUND] += 1;
    let mut is_declared = false;
    for (opcode, i) in instructions(words) {
        if opcode == op::FUNCTION && !is_declared {
            is_declared = true;
            out.extend([(4 << 16) | op::CONSTANT, word, constant, number]);
        }
        if opcode == op::LOAD && places.contains(&i[3]) {
            out.extend([(4 << 16) | op::COPY_OBJECT, i[1], i[2], constant]);
        } else {
            out.extend_from_slice(i);
        }
    }
    out
}

/// Leaves out the zeros that an array of one invocation begins with: kernels write an entry before they read it.
///
/// WGSL wants those zeros, so naga writes them. Such an array is memory on a GPU, and filling it takes as long as using it.
pub fn leave_arrays_unset(words: &[u32]) -> Vec<u32> {
    const PRIVATE: u32 = 6;
    let (mut arrays, mut pointers) = (HashSet::new(), HashSet::new());
    let mut out = words[..HEADER].to_vec();
    for (opcode, i) in instructions(words) {
        match opcode {
            op::TYPE_ARRAY => {
                arrays.insert(i[1]);
            }
            op::TYPE_POINTER if i[2] == PRIVATE && arrays.contains(&i[3]) => {
                pointers.insert(i[1]);
            }
            _ => {}
        }
        if opcode == op::VARIABLE && pointers.contains(&i[1]) && i.len() == 5 {
            out.push((4 << 16) | op::VARIABLE);
            out.extend_from_slice(&i[1..4]);
        } else {
            out.extend_from_slice(i);
        }
    }
    out
}

/// Removes layout decorations from types that no buffer reaches.
///
/// naga gives every array and struct strides and offsets; newer validation layers and some drivers refuse them
/// on workgroup and private variables (VUID-StandaloneSpirv-None-10684).
pub fn strip_private_layout(words: &[u32]) -> Vec<u32> {
    let mut children: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut reached = Vec::new();
    for (opcode, i) in instructions(words) {
        match opcode {
            op::TYPE_MATRIX | op::TYPE_ARRAY | op::TYPE_RUNTIME_ARRAY => {
                children.insert(i[1], vec![i[2]]);
            }
            op::TYPE_STRUCT => {
                children.insert(i[1], i[2..].to_vec());
            }
            // storage classes Uniform, PushConstant, StorageBuffer
            op::TYPE_POINTER if matches!(i[2], 2 | 9 | 12) => reached.push(i[3]),
            _ => {}
        }
    }
    let mut keep = HashSet::new();
    while let Some(ty) = reached.pop() {
        if keep.insert(ty) {
            reached.extend(children.get(&ty).into_iter().flatten());
        }
    }
    let mut out = words[..HEADER].to_vec();
    for (opcode, i) in instructions(words) {
        let is_layout = match opcode {
            op::DECORATE => i[2] == DECORATION_ARRAY_STRIDE,
            op::MEMBER_DECORATE => matches!(i[3], 35 | 7 | 5 | 4), // Offset MatrixStride ColMajor RowMajor
            _ => false,
        };
        if !is_layout || keep.contains(&i[1]) {
            out.extend_from_slice(i);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: [u32; 5] = [0x0723_0203, 0x0001_0300, 0, 99, 0];

    fn module(instructions: &[&[u32]]) -> Vec<u32> {
        let mut words = HEAD.to_vec();
        for i in instructions {
            words.push((u32::try_from(i.len()).unwrap() << 16) | i[0]);
            words.extend_from_slice(&i[1..]);
        }
        words
    }

    #[test]
    fn every_float_operation_is_decorated_before_the_first_type() {
        let words = module(&[&[22, 1, 32], &[129, 1, 7, 5, 6], &[124, 1, 8, 7]]);
        let want = module(&[&[71, 7, 42], &[22, 1, 32], &[129, 1, 7, 5, 6], &[124, 1, 8, 7]]);
        assert_eq!(no_contraction(&words), want);
    }

    #[test]
    fn strides_stay_on_buffers_and_leave_private_arrays() {
        let words =
            module(&[&[71, 3, 6, 4], &[71, 4, 6, 4], &[28, 3, 1, 2], &[28, 4, 1, 2], &[32, 5, 12, 3]]);
        let want = module(&[&[71, 3, 6, 4], &[28, 3, 1, 2], &[28, 4, 1, 2], &[32, 5, 12, 3]]);
        assert_eq!(strip_private_layout(&words), want);
    }

    #[test]
    fn an_immediate_becomes_the_number_that_it_is() {
        let before: [&[u32]; 3] = [&[21, 1, 32, 0], &[32, 2, 9, 1], &[59, 2, 3, 9]];
        let chain: &[u32] = &[65, 2, 12, 3, 4];
        let function: &[u32] = &[54, 6, 11, 0, 5];
        let other: &[u32] = &[61, 1, 14, 20]; // of another variable
        let words = module(&[&before[..], &[function, chain, &[61, 1, 13, 12], other]].concat());
        let wanted: [&[u32]; 5] = [&[43, 1, 99, 40], function, chain, &[83, 1, 13, 99], other];
        let mut wanted = module(&[&before[..], &wanted].concat());
        wanted[BOUND] = 100;
        assert_eq!(with_immediate(&words, 40), wanted);
        let without = module(&[&before[..], &[function, other]].concat());
        assert_eq!(with_immediate(&without, 40), without);
    }

    #[test]
    fn arrays_of_an_invocation_begin_with_nothing_and_other_variables_as_they_were() {
        let types: [&[u32]; 4] = [&[28, 3, 1, 2], &[32, 4, 6, 3], &[32, 5, 6, 1], &[32, 6, 4, 3]];
        let kept: [&[u32]; 2] = [&[59, 5, 9, 6, 8], &[59, 6, 10, 4, 8]]; // a number; an array of a workgroup
        let words = module(&[&types[..], &[&[59, 4, 7, 6, 8]], &kept[..]].concat());
        let wanted = module(&[&types[..], &[&[59, 4, 7, 6]], &kept[..]].concat());
        assert_eq!(leave_arrays_unset(&words), wanted);
        assert_eq!(leave_arrays_unset(&wanted), wanted);
    }

    #[test]
    fn operations_that_vulkan_does_not_define_to_the_bit_are_found() {
        assert_eq!(inexact(&module(&[&[129, 1, 7, 5, 6], &[12, 1, 8, 2, 31, 7]])), None);
        for bad in [&[148, 1, 7, 5, 6][..], &[12, 1, 8, 2, 69, 7], &[12, 1, 8, 2, 46, 7, 7, 7]] {
            assert!(inexact(&module(&[&[129, 1, 7, 5, 6], bad])).is_some(), "{bad:?}");
        }
    }
}
