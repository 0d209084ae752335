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
mod together;
mod types;

use crate::Isa;
use function::Variant;
use naga::valid::ModuleInfo;
use naga::{AddressSpace, GlobalVariable, Handle, Module, StorageAccess, Type, TypeInner};
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

/// What the private arrays of an invocation hold when it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrays {
    /// Zeros, or what they are declared with, as the language demands.
    Set,
    /// What another invocation has left there, or that. For shaders that write an element before they read it: to fill a large array
    /// takes as long as to use it.
    Unset,
}

/// Along which axis of a dispatch the lanes of a vector lie. What is read by the number along the other is read once for all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Lanes have different `global_invocation_id.x`.
    X,
    /// Lanes have different `global_invocation_id.y`.
    Y,
}

/// How a module is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options<'a> {
    /// What private arrays hold at first.
    pub arrays: Arrays,
    /// How lanes lie.
    pub axis: Axis,
    /// Buffers that are only read, of which each lane reads a part of its own again and again: their names, and how many elements
    /// such a part has. The parts of the lanes lie one behind the other. They are read once, and kept word by word.
    pub kept: &'a [(&'a str, u32)],
}

/// As the language demands, with lanes along x.
impl Default for Options<'_> {
    fn default() -> Self {
        Self { arrays: Arrays::Set, axis: Axis::X, kept: &[] }
    }
}

/// An entry point in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kernel {
    /// Its name. Its function is `run_` and this.
    pub name: String,
    /// The buffers, in the order in which the function takes them.
    pub bindings: Vec<Binding>,
}

/// The text of all entry points of a module.
#[derive(Debug, Clone)]
pub struct Written {
    /// Rust: the body of a module.
    pub text: String,
    /// The entry points in the order of the shader, or why one is not in the text.
    pub kernels: Vec<Result<Kernel, Unsupported>>,
}

/// Writes the entry points of a module for a set of instructions, and once each function that they call. The text is the body of a
/// module, which needs the crate `wgsl_lanes`; its functions
///
/// ```text
/// pub unsafe fn run_NAME(buffers: &[Words], immediate: u32, others: Range<u32>, invocations: Range<u32>)
/// ```
///
/// run the invocations whose `global_invocation_id` is within `invocations` along the axis on which lanes lie, and within `others` along
/// the other. The immediate is the module's `var<immediate>` of one word.
///
/// An entry point that lanes cannot run is not in the text: one with barriers, memory of a workgroup, textures, other invocation inputs.
pub fn kernels<'m>(module: &'m Module, info: &'m ModuleInfo, isa: Isa, options: Options<'m>) -> Written {
    let mut writer = Writer {
        module,
        info,
        isa,
        options,
        text: String::new(),
        structs: BTreeMap::new(),
        wanted: VecDeque::new(),
        known: BTreeSet::new(),
    };
    let kernels = (0..module.entry_points.len()).map(|entry| writer.attempt(entry)).collect();
    Written { text: writer.whole(), kernels }
}

/// Writes the functions of a module's entry points.
struct Writer<'m> {
    module: &'m Module,
    info: &'m ModuleInfo,
    isa: Isa,
    options: Options<'m>,
    text: String,
    /// Structs that functions use, by their text.
    structs: BTreeMap<Handle<Type>, String>,
    /// Functions that are called, and not yet written.
    wanted: VecDeque<Variant>,
    /// All that are called.
    known: BTreeSet<Variant>,
}

impl Writer<'_> {
    /// Writes an entry point, or nothing.
    fn attempt(&mut self, index: usize) -> Result<Kernel, Unsupported> {
        let (length, known) = (self.text.len(), self.known.clone());
        let done = self.entry(index);
        if done.is_err() {
            self.text.truncate(length);
            self.known = known;
            self.wanted.clear();
        }
        done
    }

    /// The variables that entry points use.
    fn used(&self) -> impl Iterator<Item = (Handle<GlobalVariable>, &GlobalVariable)> {
        let entries = 0..self.module.entry_points.len();
        self.module.global_variables.iter().filter(move |(handle, _)| {
            entries.clone().any(|entry| !self.info.get_entry_point(entry)[*handle].is_empty())
        })
    }

    /// What all entry points share, and what they do.
    fn whole(&self) -> String {
        let mut fields = String::new();
        for (handle, variable) in self.used() {
            let ty = match variable.space {
                AddressSpace::Uniform | AddressSpace::Storage { .. } => "Words<'a>",
                AddressSpace::Immediate => "u32",
                _ => continue,
            };
            let name = self.global(handle);
            let _ = writeln!(fields, "    {name}: {ty},");
            if let Some(words) = self.kept_words(handle) {
                let _ = writeln!(fields, "    kept_{name}: Kept<{words}>,");
            }
        }
        let structs: String = self.structs.values().map(String::as_str).collect();
        format!(
            "use wgsl_lanes::Words;\nuse wgsl_lanes::vector::{}::*;\n\n{structs}\
             /// The buffers, and the immediate.\nstruct Cx<'a> {{\n{fields}    buffers: std::marker::PhantomData<Words<'a>>,\n}}\n{}",
            self.isa.name(),
            self.text
        )
    }

    fn entry(&mut self, index: usize) -> Result<Kernel, Unsupported> {
        let entry = &self.module.entry_points[index];
        let info = self.info.get_entry_point(index);
        let unsupported = |what: String| Unsupported { what, function: entry.name.clone() };

        let (mut set, mut bindings) = (String::new(), Vec::new());
        for (handle, variable) in self.used() {
            let (name, is_used) = (self.global(handle), !info[handle].is_empty());
            match variable.space {
                AddressSpace::Uniform | AddressSpace::Storage { .. } if is_used => {
                    let _ = write!(set, "{name}: buffers[{}], ", bindings.len());
                    if self.kept_words(handle).is_some() {
                        let _ = write!(set, "kept_{name}: Kept::empty(), ");
                    }
                    let is_written = info[handle].contains(naga::valid::GlobalUse::WRITE);
                    bindings.push(Binding { name: variable.name.clone().unwrap_or_default(), is_written });
                }
                AddressSpace::Uniform | AddressSpace::Storage { .. } => {
                    let _ = write!(set, "{name}: Words::none(), ");
                    if self.kept_words(handle).is_some() {
                        let _ = write!(set, "kept_{name}: Kept::empty(), ");
                    }
                }
                AddressSpace::Immediate => _ = write!(set, "{name}: immediate, "),
                AddressSpace::Private => {}
                space if is_used => return Err(unsupported(format!("a variable of {space:?}"))),
                _ => {}
            }
        }
        let id = self.invocation(entry).map_err(unsupported)?;
        let attribute = self.attribute();
        // variables of an invocation: made for each, or kept from one to the next
        let (mut made, mut kept) = (String::new(), String::new());
        let (mut passed, mut taken, mut given) = (String::new(), String::new(), String::new());
        for handle in self.privates(info, &[]) {
            let variable = &self.module.global_variables[handle];
            let (name, ty) = (self.global(handle), self.rust(variable.ty).map_err(unsupported)?);
            let value = match variable.init {
                Some(init) => self.constant(init).map_err(unsupported)?,
                None => self.zero(variable.ty).map_err(unsupported)?,
            };
            let begin = format!("    let mut own_{name}: {ty} = {value};\n");
            let _ = write!(passed, "{name}, ");
            let is_array = matches!(self.module.types[variable.ty].inner, TypeInner::Array { .. });
            if is_array && self.options.arrays == Arrays::Unset {
                kept.push_str(&begin);
                let _ = write!(given, "&mut own_{name}, ");
                let _ = write!(taken, "{name}: &mut {ty}, ");
            } else {
                let _ = writeln!(made, "{begin}    let {name} = &mut own_{name};");
            }
        }
        let name = &entry.name;
        let _ = write!(
            self.text,
            "\n/// # Safety\n/// The machine has the instructions, and no two invocations that run at the same time use the same word\n\
             /// otherwise than by atomic operations, unless both only read it.\n\
             {attribute}pub unsafe fn run_{name}(buffers: &[Words<'_>], immediate: u32, others: std::ops::Range<u32>, invocations: std::ops::Range<u32>) {{\n    \
             let _ = (buffers, immediate);\n    let cx = &Cx {{ {set}buffers: std::marker::PhantomData }};\n{kept}    let mut at = invocations.start;\n    \
             while at < invocations.end {{\n        let mask = first_lanes(invocations.end - at);\n        \
             for other in others.clone() {{ one_{name}(cx, {given}mask, at, other); }}\n        \
             at = at.saturating_add(LANES as u32);\n    }}\n}}\n\n\
             /// As many invocations as there are lanes.\n{attribute}fn one_{name}(cx: &Cx<'_>, {taken}mask: M, first: u32, other: u32) {{\n{made}    \
             f_{name}(cx, {passed}mask{id});\n}}\n",
        );
        self.function(&Variant::entry(index))?;
        while let Some(variant) = self.wanted.pop_front() {
            self.function(&variant)?;
        }
        Ok(Kernel { name: name.clone(), bindings })
    }

    /// The argument that holds the number of the invocation, if the entry point takes it.
    fn invocation(&self, entry: &naga::EntryPoint) -> Result<&'static str, String> {
        use naga::{Binding, BuiltIn};
        match entry.function.arguments.as_slice() {
            [] => Ok(""),
            [one] if one.binding == Some(Binding::BuiltIn(BuiltIn::GlobalInvocationId)) => {
                Ok(match self.options.axis {
                    Axis::X => ", [V::count_from(first), V::c(other), V::c(0)]",
                    Axis::Y => ", [V::c(other), V::count_from(first), V::c(0)]",
                })
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

    /// Words of the part of a buffer that a lane keeps, if it does.
    fn kept_words(&self, handle: Handle<GlobalVariable>) -> Option<u32> {
        let variable = &self.module.global_variables[handle];
        let (_, elements) =
            self.options.kept.iter().find(|(name, _)| variable.name.as_deref() == Some(name))?;
        match self.module.types[variable.ty].inner {
            TypeInner::Array { stride, .. } if self.is_only_read(handle) => Some(elements * stride / 4),
            _ => None,
        }
    }

    /// Whether no invocation writes a buffer.
    fn is_only_read(&self, handle: Handle<GlobalVariable>) -> bool {
        let space = self.module.global_variables[handle].space;
        matches!(space, AddressSpace::Storage { access } if !access.contains(StorageAccess::STORE))
    }

    /// Name of a global variable in the text.
    fn global(&self, handle: Handle<GlobalVariable>) -> String {
        let name = self.module.global_variables[handle].name.as_deref().unwrap_or("unnamed");
        format!("g_{name}")
    }
}
