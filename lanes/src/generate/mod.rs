//! From a module of naga's to Rust with vectors of invocations.
//!
//! What a kernel computes for one invocation, the text computes for all lanes of a vector. Control flow becomes masks: both
//! sides of an `if` run, each with its lanes, and are skipped when there are none; a loop runs until no lane is left;
//! `return`, `break` and `continue` take lanes out. Variables hold a word of each lane. So the order of operations of
//! each invocation is that of the shader, and its result is the same to the bit.

mod block;
mod expression;
mod function;
mod place;
mod same;
mod types;

use crate::Isa;
use function::Variant;
use naga::valid::ModuleInfo;
use naga::{AddressSpace, GlobalVariable, Handle, Module, Type};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt::Write as _;

/// What has no counterpart in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsupported {
    /// What.
    pub what: String,
    /// The function in which it stands.
    pub function: String,
}

impl std::fmt::Display for Unsupported {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {} cannot be done by lanes", self.function, self.what)
    }
}

impl std::error::Error for Unsupported {}

/// A buffer of an entry point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Binding {
    /// Name of the variable.
    pub name: String,
    /// Whether it is written.
    pub is_written: bool,
}

/// The text of one entry point.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// The buffers, in the order in which [`Self::text`]'s `run` takes them.
    pub bindings: Vec<Binding>,
    /// Rust: the body of a module with a function `run`.
    pub text: String,
}

/// Writes an entry point for a set of instructions. The text is the body of a module, which needs the crate `wgsl_lanes`;
/// its function
///
/// ```text
/// pub unsafe fn run(buffers: &[Words], immediate: u32, row: u32, invocations: Range<u32>)
/// ```
///
/// runs the invocations of a row, `global_invocation_id.y`, whose `global_invocation_id.x` is in a range. The immediate is the module's `var<immediate>` of one word.
///
/// # Errors
/// What the entry point uses and lanes cannot do: barriers, memory of a workgroup, textures, other invocation inputs.
pub fn kernel(module: &Module, info: &ModuleInfo, entry: usize, isa: Isa) -> Result<Kernel, Unsupported> {
    let mut writer = Writer {
        module,
        info,
        isa,
        text: String::new(),
        structs: BTreeMap::new(),
        wanted: VecDeque::new(),
        known: BTreeSet::new(),
    };
    writer.entry(entry)
}

/// Writes the functions of one entry point.
struct Writer<'m> {
    module: &'m Module,
    info: &'m ModuleInfo,
    isa: Isa,
    text: String,
    /// Structs that functions use, by their text.
    structs: BTreeMap<Handle<Type>, String>,
    /// Functions that are called, and not yet written.
    wanted: VecDeque<Variant>,
    /// All that are called.
    known: BTreeSet<Variant>,
}

impl Writer<'_> {
    fn entry(&mut self, index: usize) -> Result<Kernel, Unsupported> {
        let entry = &self.module.entry_points[index];
        let info = self.info.get_entry_point(index);
        let is_used = |(handle, _): &(Handle<GlobalVariable>, &GlobalVariable)| !info[*handle].is_empty();
        let unsupported = |what: String| Unsupported { what, function: entry.name.clone() };

        let (mut fields, mut set, mut bindings) = (String::new(), String::new(), Vec::new());
        for (handle, variable) in self.module.global_variables.iter().filter(is_used) {
            let name = self.global(handle);
            match variable.space {
                AddressSpace::Uniform | AddressSpace::Storage { .. } => {
                    let place = bindings.len();
                    let _ = writeln!(fields, "    {name}: Words<'a>,");
                    let _ = write!(set, "{name}: buffers[{place}], ");
                    let is_written = info[handle].contains(naga::valid::GlobalUse::WRITE);
                    bindings.push(Binding { name: variable.name.clone().unwrap_or_default(), is_written });
                }
                AddressSpace::Immediate => {
                    let _ = writeln!(fields, "    {name}: u32,");
                    let _ = write!(set, "{name}: immediate, ");
                }
                AddressSpace::Private => {}
                space => return Err(unsupported(format!("a variable of {space:?}"))),
            }
        }
        let id = self.invocation(entry).map_err(unsupported)?;
        let attribute = self.attribute();
        let (mut privates, mut passed) = (String::new(), String::new());
        for handle in self.privates(info, &[]) {
            let variable = &self.module.global_variables[handle];
            let (name, ty) = (self.global(handle), self.rust(variable.ty).map_err(unsupported)?);
            let value = match variable.init {
                Some(init) => self.constant(init).map_err(unsupported)?,
                None => self.zero(variable.ty).map_err(unsupported)?,
            };
            let _ = writeln!(
                privates,
                "    let mut own_{name}: {ty} = {value};\n    let {name} = &mut own_{name};"
            );
            let _ = write!(passed, "{name}, ");
        }
        let _ = write!(
            self.text,
            "/// The buffers, and the immediate.\nstruct Cx<'a> {{\n{fields}    buffers: std::marker::PhantomData<Words<'a>>,\n}}\n\n\
             /// # Safety\n/// The machine has the instructions, and no two invocations that run at the same time use the same word\n\
             /// otherwise than by atomic operations, unless both only read it.\n\
             {attribute}pub unsafe fn run(buffers: &[Words<'_>], immediate: u32, row: u32, invocations: std::ops::Range<u32>) {{\n    \
             let _ = (buffers, immediate);\n    let cx = &Cx {{ {set}buffers: std::marker::PhantomData }};\n    let mut at = invocations.start;\n    \
             while at < invocations.end {{\n        let mask = first_lanes(invocations.end - at);\n        one(cx, mask, at, row);\n        \
             at = at.saturating_add(LANES as u32);\n    }}\n}}\n\n\
             /// As many invocations as there are lanes.\n{attribute}fn one(cx: &Cx<'_>, mask: M, first: u32, row: u32) {{\n{privates}    \
             f_{name}(cx, {passed}mask{id});\n}}\n",
            name = entry.name,
        );
        self.function(&Variant::entry(index))?;
        while let Some(variant) = self.wanted.pop_front() {
            self.function(&variant)?;
        }
        let head = "use wgsl_lanes::Words;\nuse wgsl_lanes::vector::";
        let structs: String = self.structs.values().map(String::as_str).collect();
        let text = format!("{head}{}::*;\n\n{structs}{}", self.isa.name(), self.text);
        Ok(Kernel { bindings, text })
    }

    /// The argument that holds the number of the invocation, if the entry point takes it.
    fn invocation(&self, entry: &naga::EntryPoint) -> Result<&'static str, String> {
        use naga::{Binding, BuiltIn};
        match entry.function.arguments.as_slice() {
            [] => Ok(""),
            [one] if one.binding == Some(Binding::BuiltIn(BuiltIn::GlobalInvocationId)) => {
                Ok(", [V::count_from(first), V::c(row), V::c(0)]")
            }
            _ => Err("another input than one global_invocation_id".to_owned()),
        }
    }

    /// What makes a function use the instructions.
    fn attribute(&self) -> &'static str {
        match self.isa {
            Isa::Portable | Isa::Neon => "",
            Isa::Avx2 => "#[target_feature(enable = \"avx2\")]\n",
            Isa::Avx512 => "#[target_feature(enable = \"avx512f,avx512bw,avx512dq,avx512vl\")]\n",
        }
    }

    /// Name of a global variable in the text.
    fn global(&self, handle: Handle<GlobalVariable>) -> String {
        let name = self.module.global_variables[handle].name.as_deref().unwrap_or("unnamed");
        format!("g_{name}")
    }
}
