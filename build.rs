//! Compiles `shaders/` and writes the Rust side of every kernel (see `src/kernels/mod.rs`).
#![allow(clippy::print_stdout, reason = "cargo reads a build script's standard output")]

#[path = "src/kernels/compile.rs"]
#[allow(
    dead_code,
    missing_docs,
    unreachable_pub,
    clippy::missing_errors_doc,
    reason = "checked in the crate"
)]
mod compile;
#[path = "build/constants.rs"]
mod constants;
#[path = "build/limits.rs"]
mod limits;
#[path = "src/kernels/link.rs"]
#[allow(dead_code, unreachable_pub, reason = "checked in the crate")]
mod link;
#[path = "build/operations.rs"]
mod operations;
#[path = "src/kernels/spirv.rs"]
#[allow(
    dead_code,
    missing_docs,
    unreachable_pub,
    clippy::missing_errors_doc,
    reason = "checked in the crate"
)]
mod spirv;
#[path = "build/structs.rs"]
mod structs;

use compile::constants::Constant;
use compile::{Binding, Entry, Shader, Source, Use};
use constants::Shared;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=shaders");
    println!("cargo::rerun-if-changed=src/reference");
    match generate() {
        Ok(()) => ExitCode::SUCCESS,
        Err(errors) => {
            for line in errors.lines() {
                println!("cargo::error={line}");
            }
            ExitCode::FAILURE
        }
    }
}

fn generate() -> Result<(), String> {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    let [spirv, libraries] = ["spirv", "operations"].map(|folder| out.join(folder));
    if spirv.exists() {
        // the code of a kernel that is no longer there must not be checked as if it were
        std::fs::remove_dir_all(&spirv).map_err(|e| format!("{}: {e}", spirv.display()))?;
    }
    for folder in [&spirv, &libraries] {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    compile::barriers::examples()?;
    let kernels = compile_folder(Path::new("shaders"), &spirv)?;
    let draws = compile_folder(Path::new("shaders/draw"), &spirv)?;
    let shared = constants::shared(kernels.iter().chain(&draws));
    constants::are_declared_once(&kernels, &shared)?;
    let mut text = String::from("// Written by build.rs from shaders/*.wgsl.\n");
    ids(&kernels, &mut text)?;
    store(&kernels, &mut text)?;
    for (source, shader) in &kernels {
        let own = constants::own(source, shader);
        kernel(source, shader, &own, &shared, &mut text)?;
    }
    constants::write_shared(&shared, &mut text);
    limits::write(&kernels, &draws, &mut text)?;
    operations::write(&kernels, [&spirv, &libraries], &mut text)?;
    text.push_str("/// The draw shaders.\n#[allow(unused_imports, reason = \"empty while there is no draw shader\")]\npub mod draw {\nuse super::*;\n");
    for (source, shader) in &draws {
        draw_shader(source, shader, &mut text)?;
        let (name, constants) = (&source.name, constants::own(source, shader));
        if !constants.is_empty() {
            let _ = write!(
                text,
                "/// Constants of `shaders/draw/{name}.wgsl`.\npub mod {name} {{\n{constants}}}\n"
            );
        }
    }
    text.push_str("}\n");
    write(&out.join("kernels.rs"), &text)?;
    write(&out.join("layout.rs"), &structs::text(kernels.iter().chain(&draws))?)?;
    write(&out.join("reference.rs"), &reference(&kernels)?)
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

/// Compiles every `.wgsl` of a folder, in name order.
fn compile_folder(folder: &Path, spirv: &Path) -> Result<Vec<(Source, Shader)>, String> {
    let listing = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<PathBuf> = listing.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "wgsl"));
    files.sort();
    let (mut shaders, mut errors) = (Vec::new(), Vec::new());
    for (number, file) in files.into_iter().enumerate() {
        let compiled = Source::read(&file, Path::new("shaders/shared"), number)
            .and_then(|source| compile::compile(&source).map(|shader| (source, shader)));
        match compiled {
            Ok((source, shader)) => {
                for entry in &shader.entries {
                    let one_eye = entry.one_eye.iter().map(|code| (code, ".one_eye"));
                    for (code, which) in [(&entry.spirv, "")].into_iter().chain(one_eye) {
                        write_spirv(spirv, &format!("{}{which}", entry.name), code)?;
                    }
                }
                shaders.push((source, shader));
            }
            Err(error) => errors.push(error.to_string()),
        }
    }
    if errors.is_empty() { Ok(shaders) } else { Err(errors.join("\n")) }
}

/// `grid_count` to `GridCount`.
fn camel(name: &str) -> String {
    let capital = |part: &str| part[..1].to_uppercase() + &part[1..];
    name.split('_').filter(|part| !part.is_empty()).map(capital).collect()
}

/// What must be true of a kernel file, and the names that Rust has for it.
fn check_kernel(source: &Source, shader: &Shader) -> Result<(), String> {
    let file = format!("shaders/{}.wgsl", source.name);
    let twin = format!("src/reference/{}.rs", source.name);
    if shader.entries.is_empty() {
        return Err(format!("{file}:1: a kernel file has an entry point for each of its phases, found none"));
    }
    if !Path::new(&twin).exists() {
        return Err(format!("{file}:1: kernel without a CPU twin: write {twin}"));
    }
    for entry in &shader.entries {
        let name = &entry.name;
        if *name != source.name && !name.starts_with(&format!("{}_", source.name)) {
            return Err(format!(
                "{file}:1: the entry point `{name}` must be named as its file, or `{}_` and the phase",
                source.name
            ));
        }
        if let Some(operation) = spirv::inexact(&entry.spirv) {
            return Err(format!(
                "{file}:1: {name}: Vulkan does not define {operation} to the bit: use + - * / sqrt and `exact.wgsl`"
            ));
        }
        if entry.immediate.as_ref().is_some_and(|(_, size)| *size != 4) {
            return Err(format!("{file}:1: {name}: the immediate of a kernel is one `u32`"));
        }
    }
    Ok(())
}

fn ids(kernels: &[(Source, Shader)], text: &mut String) -> Result<(), String> {
    let mut names = Vec::new();
    let mut phases = Vec::new();
    for (source, shader) in kernels {
        check_kernel(source, shader)?;
        names.push(source.name.as_str());
        phases.extend(shader.entries.iter().map(|entry| (source.name.as_str(), entry.name.as_str())));
    }
    let list = |f: &dyn Fn(&str) -> String| names.iter().map(|n| f(n)).collect::<String>();
    let _ = write!(
        text,
        "/// A kernel; one variant per file of `shaders/`.\n\
         #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]\n#[repr(u32)]\npub enum KernelId {{\n{}}}\n\
         impl KernelId {{\n/// All kernels by name.\npub const ALL: [Self; {}] = [{}];\n\
         /// The kernel.\npub const fn kernel(self) -> &'static Kernel {{ match self {{\n{}}} }}\n}}\n",
        list(&|n| format!("/// `shaders/{n}.wgsl`\n{},\n", camel(n))),
        names.len(),
        list(&|n| format!("Self::{},", camel(n))),
        list(&|n| format!("Self::{} => &{n}::KERNEL,\n", camel(n))),
    );
    let list = |f: &dyn Fn(&str, &str) -> String| phases.iter().map(|(k, n)| f(k, n)).collect::<String>();
    let _ = write!(
        text,
        "/// A phase of a kernel; one variant per entry point of `shaders/`.\n\
         #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]\npub enum Phase {{\n{}}}\n\
         impl Phase {{\n/// All phases, those of a kernel in the order of its file.\npub const ALL: [Self; {}] = [{}];\n\
         /// The entry point.\npub const fn entry(self) -> &'static Entry {{ match self {{\n{}}} }}\n}}\n",
        list(&|k, n| format!("/// `{n}` in `shaders/{k}.wgsl`\n{},\n", camel(n))),
        phases.len(),
        list(&|_, n| format!("Self::{},", camel(n))),
        list(&|k, n| format!("Self::{} => &{k}::{},\n", camel(n), n.to_uppercase())),
    );
    Ok(())
}

/// The bindings of all phases together: written if one of them writes.
fn union(shader: &Shader) -> Result<Vec<Binding>, String> {
    let mut all: BTreeMap<u32, Binding> = BTreeMap::new();
    for binding in shader.entries.iter().flat_map(|entry| &entry.bindings) {
        let known = all.entry(binding.binding).or_insert_with(|| binding.clone());
        if known.name != binding.name {
            return Err(format!("{}: `{}` has the number of `{}`", binding.place, binding.name, known.name));
        }
        if binding.access == Use::Write {
            known.access = Use::Write;
        }
    }
    Ok(all.into_values().collect())
}

/// The buffers: one per binding name over all kernels.
fn store(kernels: &[(Source, Shader)], text: &mut String) -> Result<(), String> {
    let mut buffers: BTreeMap<&str, &Binding> = BTreeMap::new();
    for binding in kernels.iter().flat_map(|(_, shader)| &shader.entries).flat_map(|entry| &entry.bindings) {
        let first = buffers.entry(&binding.name).or_insert(binding);
        if first.rust != binding.rust {
            return Err(format!(
                "{}: buffer `{}` holds {} here, but {} at {}",
                binding.place, binding.name, binding.rust, first.rust, first.place
            ));
        }
    }
    let is_uniform = |b: &Binding| b.access == Use::Uniform;
    let list = |f: &dyn Fn(&Binding) -> String| buffers.values().map(|b| f(b)).collect::<String>();
    let _ = write!(
        text,
        "/// A buffer; one variant per binding name.\n\
         #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]\npub enum BufferId {{\n{}}}\n\
         impl BufferId {{\n/// All buffers by name.\npub const ALL: [Self; {}] = [{}];\n\
         /// Name, as in the shaders.\npub const fn name(self) -> &'static str {{ match self {{\n{}}} }}\n\
         /// Bytes of one element.\npub const fn stride(self) -> usize {{ match self {{\n{}}} }}\n\
         /// Whether it is a uniform buffer.\npub const fn is_uniform(self) -> bool {{ match self {{\n{}}} }}\n\
         /// Bit `i`: whether word `i` of an element is an integer, or bits. Words from 64 on count as numbers.\n\
         pub const fn integer_words(self) -> u64 {{ match self {{\n{}}} }}\n}}\n",
        list(&|b| format!("/// `{}`\n{},\n", b.name, camel(&b.name))),
        buffers.len(),
        list(&|b| format!("Self::{},", camel(&b.name))),
        list(&|b| format!("Self::{} => \"{}\",\n", camel(&b.name), b.name)),
        list(&|b| format!("Self::{} => {},\n", camel(&b.name), b.stride)),
        list(&|b| format!("Self::{} => {},\n", camel(&b.name), is_uniform(b))),
        list(&|b| format!("Self::{} => {:#b},\n", camel(&b.name), mask(&b.integer_words))),
    );
    let (field, words, bytes, bytes_mut) = (
        list(&|b| {
            let ty = if is_uniform(b) { b.rust.clone() } else { format!("Vec<{}>", b.rust) };
            format!("/// Buffer `{}`, declared at `{}`.\npub {}: {ty},\n", b.name, b.place, b.name)
        }),
        list(&|b| {
            let value = format!("&mut self.{}", b.name);
            let value = if is_uniform(b) { format!("std::slice::from_mut({value})") } else { value };
            format!("wgsl_lanes::Words::write(bytemuck::must_cast_slice_mut({value})),\n")
        }),
        list(&|b| {
            let view = if is_uniform(b) { "bytemuck::bytes_of" } else { "bytemuck::cast_slice" };
            format!("BufferId::{} => {view}(&self.{}),\n", camel(&b.name), b.name)
        }),
        list(&|b| {
            let view = if is_uniform(b) { "bytemuck::bytes_of_mut" } else { "bytemuck::cast_slice_mut" };
            format!("BufferId::{} => {view}(&mut self.{}),\n", camel(&b.name), b.name)
        }),
    );
    let _ = write!(
        text,
        "/// Every buffer, on the CPU.\n#[derive(Debug, Clone, Default)]\npub struct Store {{\n{field}}}\n\
         impl Store {{\n/// The bytes of a buffer.\npub fn bytes(&self, buffer: BufferId) -> &[u8] {{ match buffer {{\n{bytes}}} }}\n\
         /// The words of all buffers, by [`BufferId`].\npub(crate) fn words(&mut self) -> [wgsl_lanes::Words<'_>; {count}] {{ [\n{words}] }}\n\
         /// The bytes of a buffer, to be overwritten.\npub fn bytes_mut(&mut self, buffer: BufferId) -> &mut [u8] {{ match buffer {{\n{bytes_mut}}} }}\n}}\n",
        count = buffers.len(),
    );
    Ok(())
}

/// Bit `i` is flag `i`, of the first 64.
fn mask(flags: &[bool]) -> u64 {
    flags.iter().take(64).enumerate().fold(0, |mask, (bit, is_set)| mask | u64::from(*is_set) << bit)
}

/// Writes a module into a folder, in the byte order of the machine that will run it.
pub(crate) fn write_spirv(folder: &Path, name: &str, words: &[u32]) -> Result<(), String> {
    let is_big = std::env::var("CARGO_CFG_TARGET_ENDIAN").is_ok_and(|order| order == "big");
    let bytes = |word: &u32| if is_big { word.to_be_bytes() } else { word.to_le_bytes() };
    let path = folder.join(format!("{name}.spv"));
    std::fs::write(&path, words.iter().flat_map(bytes).collect::<Vec<u8>>())
        .map_err(|e| format!("{}: {e}", path.display()))
}

/// A module in Rust: the file of the output folder that [`write_spirv`] wrote. As numbers all modules would be 400,000
/// expressions, which rustc and clippy take half a minute to look at.
pub(crate) fn words(file: &str, spirv: &[u32]) -> String {
    format!("spirv!(\"{file}\", {})", spirv.len())
}

fn bindings_text(bindings: &[Binding]) -> String {
    let one = |b: &Binding| {
        let (buffer, index, access) = (camel(&b.name), b.binding, b.access);
        format!("Binding {{ buffer: BufferId::{buffer}, index: {index}, access: Access::{access:?} }},")
    };
    bindings.iter().map(one).collect()
}

/// The immediate of an entry point; the constants of a shared file of its name are its flags.
fn immediate_text(entry: &Entry, shared: &Shared<'_>) -> String {
    let Some((name, _)) = &entry.immediate else { return "None".to_owned() };
    let mut flags: Vec<&Constant> =
        shared.get(name).into_iter().flat_map(BTreeMap::values).copied().collect();
    flags.sort_by_key(|constant| constant.line);
    let flags: String = flags
        .iter()
        .map(|c| format!("(\"{}\", shared::{name}::{}),", c.name.to_lowercase(), c.name))
        .collect();
    format!("Some(Immediate {{ name: \"{name}\", flags: &[{flags}] }})")
}

/// One phase of a kernel.
fn entry_text(kernel: &str, entry: &Entry, shared: &Shared<'_>) -> String {
    let name = &entry.name;
    let phase = name.strip_prefix(kernel).and_then(|rest| rest.strip_prefix('_'));
    let label = phase.map_or_else(|| kernel.to_owned(), |phase| format!("{kernel}.{phase}"));
    format!(
        "/// Entry point `{name}`.\npub static {upper}: Entry = Entry {{ phase: Phase::{id}, kernel: KernelId::{kernel}, \
         name: \"{name}\", label: \"{label}\", workgroup_size: {size:?}, bindings: &[{bindings}], \
         immediate: {immediate}, spirv: {words} }};\n",
        upper = name.to_uppercase(),
        id = camel(name),
        kernel = camel(kernel),
        size = entry.workgroup_size,
        bindings = bindings_text(&entry.bindings),
        immediate = immediate_text(entry, shared),
        words = words(&format!("spirv/{name}"), &entry.spirv),
    )
}

fn kernel(
    source: &Source,
    shader: &Shader,
    constants: &str,
    shared: &Shared<'_>,
    text: &mut String,
) -> Result<(), String> {
    let name = &source.name;
    let bindings = union(shader)?;
    let field = |b: &Binding| match b.access {
        Use::Uniform => format!("&'a {}", b.rust),
        Use::Write => format!("&'a mut [{}]", b.rust),
        _ => format!("&'a [{}]", b.rust),
    };
    let borrow = |b: &Binding| match b.access {
        Use::Write => format!("{0}: &mut store.{0},", b.name),
        _ => format!("{0}: &store.{0},", b.name),
    };
    let immediate = shader.entries.iter().find_map(|entry| Some(entry.immediate.as_ref()?.0.as_str()));
    let entries = |f: &dyn Fn(&Entry) -> String| shader.entries.iter().map(f).collect::<String>();
    let _ = write!(
        text,
        "/// Kernel `{name}`.\npub mod {name} {{\nuse super::*;\n\
         /// The kernel.\npub static KERNEL: Kernel = Kernel {{ id: KernelId::{id}, name: \"{name}\", phases: &[{phases}], bindings: &[{all}] }};\n{entries}\
         /// The bindings as slices, for the CPU twin.\n#[derive(Debug)]\npub struct Slices<'a> {{\n{fields}{immediate_field}}}\n\
         impl<'a> Slices<'a> {{\n/// Borrows what the kernel binds.\npub fn of(store: &'a mut Store, {argument}: u32) -> Self {{ Self {{ {borrows} {immediate_set} }} }}\n}}\n{constants}}}\n",
        id = camel(name),
        phases = entries(&|entry| format!("Phase::{},", camel(&entry.name))),
        all = bindings_text(&bindings),
        entries = entries(&|entry| entry_text(name, entry, shared)),
        fields = bindings
            .iter()
            .map(|b| format!("/// `{}`\npub {}: {},\n", b.place, b.name, field(b)))
            .collect::<String>(),
        immediate_field =
            immediate.map_or_else(String::new, |i| format!("/// The immediate.\npub {i}: u32,\n")),
        argument = immediate.unwrap_or("_"),
        borrows = bindings.iter().map(borrow).collect::<String>(),
        immediate_set = immediate.map_or_else(String::new, |i| format!("{i},")),
    );
    Ok(())
}

fn draw_shader(source: &Source, shader: &Shader, text: &mut String) -> Result<(), String> {
    let mut bindings: BTreeMap<(u32, u32), &Binding> = BTreeMap::new();
    for binding in shader.entries.iter().flat_map(|entry| &entry.bindings) {
        bindings.insert((binding.group, binding.binding), binding);
    }
    let kind = |b: &Binding| match b.access {
        Use::Uniform => Ok("Uniform"),
        Use::Read => Ok("Storage"),
        Use::Texture => Ok("Texture"),
        Use::Sampler => Ok("Sampler"),
        Use::Write => Err(format!("{}: a draw shader only reads `{}`", b.place, b.name)),
    };
    let mut list = String::new();
    for ((group, index), b) in &bindings {
        let _ = write!(
            list,
            "DrawBinding {{ name: \"{}\", group: {group}, index: {index}, kind: DrawBindingKind::{} }},",
            b.name,
            kind(b)?
        );
    }
    let entries: String = shader
        .entries
        .iter()
        .map(|e| {
            let name = &e.name;
            let one_eye = e.one_eye.as_ref().map(|code| words(&format!("spirv/{name}.one_eye"), code));
            let one_eye = one_eye.map_or_else(|| "None".to_owned(), |words| format!("Some({words})"));
            format!(
                "DrawEntry {{ name: \"{name}\", spirv: {}, one_eye: {one_eye} }},",
                words(&format!("spirv/{name}"), &e.spirv)
            )
        })
        .collect();
    let immediate = shader.entries.iter().filter_map(|e| e.immediate.as_ref()).map(|(_, size)| *size).max();
    let _ = write!(
        text,
        "/// `shaders/draw/{name}.wgsl`\npub static {upper}: DrawShader = DrawShader {{ name: \"{name}\", \
         entries: &[{entries}], bindings: &[{list}], immediate_size: {} }};\n",
        immediate.unwrap_or(0),
        name = source.name,
        upper = source.name.to_uppercase(),
    );
    Ok(())
}

/// Declares the twins and the call from a kernel to its twin.
fn reference(kernels: &[(Source, Shader)]) -> Result<String, String> {
    let root = std::env::var("CARGO_MANIFEST_DIR").map_err(|e| format!("CARGO_MANIFEST_DIR: {e}"))?;
    let mut text = String::from("// Written by build.rs: one module per kernel.\n");
    let mut arms = String::new();
    for (source, shader) in kernels {
        let name = &source.name;
        let _ = writeln!(text, "#[path = \"{root}/src/reference/{name}.rs\"]\npub mod {name};");
        for entry in &shader.entries {
            let _ = writeln!(
                arms,
                "Phase::{id} => {name}::{twin}(crate::kernels::{name}::Slices::of(store, immediate)),",
                id = camel(&entry.name),
                twin = entry.name,
            );
        }
    }
    let _ = write!(
        text,
        "/// Runs the CPU twin of a phase over all of its invocations.\n\
         pub fn run(phase: Phase, store: &mut Store, immediate: u32) {{ match phase {{\n{arms}}} }}\n"
    );
    Ok(text)
}
