//! Two passes over the SPIR-V that naga writes. Both work on the stream of words:
//! five header words, then instructions of `(length << 16 | opcode), operands…`.

use std::collections::{HashMap, HashSet};

/// Words before the first instruction.
const HEADER: usize = 5;
const OP_TYPE_MATRIX: u32 = 24;
const OP_TYPE_ARRAY: u32 = 28;
const OP_TYPE_RUNTIME_ARRAY: u32 = 29;
const OP_TYPE_STRUCT: u32 = 30;
const OP_TYPE_POINTER: u32 = 32;
const OP_DECORATE: u32 = 71;
const OP_MEMBER_DECORATE: u32 = 72;
const DECORATION_NO_CONTRACTION: u32 = 42;
const DECORATION_ARRAY_STRIDE: u32 = 6;

/// Splits the module into `(opcode, all words of the instruction)`.
fn instructions(words: &[u32]) -> impl Iterator<Item = (u32, &[u32])> {
    let mut at = HEADER;
    std::iter::from_fn(move || {
        let first = *words.get(at)?;
        let length = ((first >> 16) as usize).max(1);
        let instruction = words.get(at..at + length)?;
        at += length;
        Some((first & 0xffff, instruction))
    })
}

/// Decorates the result of every float arithmetic instruction with `NoContraction`.
///
/// naga emits none, so a driver may fuse `a*b+c` or re-associate sums; the CPU does neither, and a crowd that
/// differs by one rounding is a different crowd after some hundred steps.
pub(crate) fn no_contraction(words: &[u32]) -> Vec<u32> {
    // FNegate FAdd FSub FMul FDiv FRem FMod, vector and matrix times scalar, vector, matrix; OuterProduct Dot
    const ARITHMETIC: [u32; 14] = [127, 129, 131, 133, 136, 140, 141, 142, 143, 144, 145, 146, 147, 148];
    let is_type = |opcode| (19..=59).contains(&opcode); // types and constants follow the annotations
    let mut out = words[..HEADER].to_vec();
    let mut annotated = false;
    for (opcode, instruction) in instructions(words) {
        if is_type(opcode) && !annotated {
            annotated = true;
            for (_, result) in instructions(words).filter(|(op, _)| ARITHMETIC.contains(op)) {
                out.extend([(3 << 16) | OP_DECORATE, result[2], DECORATION_NO_CONTRACTION]);
            }
        }
        out.extend_from_slice(instruction);
    }
    out
}

/// Removes layout decorations from types that no buffer reaches.
///
/// naga gives every array and struct strides and offsets; newer validation layers and some drivers refuse them
/// on workgroup and private variables (VUID-StandaloneSpirv-None-10684).
pub(crate) fn strip_private_layout(words: &[u32]) -> Vec<u32> {
    let mut children: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut reached = Vec::new();
    for (opcode, i) in instructions(words) {
        match opcode {
            OP_TYPE_MATRIX | OP_TYPE_ARRAY | OP_TYPE_RUNTIME_ARRAY => {
                children.insert(i[1], vec![i[2]]);
            }
            OP_TYPE_STRUCT => {
                children.insert(i[1], i[2..].to_vec());
            }
            // storage classes Uniform, PushConstant, StorageBuffer
            OP_TYPE_POINTER if matches!(i[2], 2 | 9 | 12) => reached.push(i[3]),
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
            OP_DECORATE => i[2] == DECORATION_ARRAY_STRIDE,
            OP_MEMBER_DECORATE => matches!(i[3], 35 | 7 | 5 | 4), // Offset MatrixStride ColMajor RowMajor
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
}
