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

use compile::{Binding, Constant, Entry, Layout, Shader, Source, Use};
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
    let spirv = out.join("spirv");
    if spirv.exists() {
        // the code of a kernel that is no longer there must not be checked as if it were
        std::fs::remove_dir_all(&spirv).map_err(|e| format!("{}: {e}", spirv.display()))?;
    }
    std::fs::create_dir_all(&spirv).map_err(|e| format!("{}: {e}", spirv.display()))?;
    let kernels = compile_folder(Path::new("shaders"), &spirv)?;
    let draws = compile_folder(Path::new("shaders/draw"), &spirv)?;
    let shared = shared_constants(kernels.iter().chain(&draws));
    twins_declare_none_again(&kernels, &shared)?;
    let mut text = String::from("// Written by build.rs from shaders/*.wgsl.\n");
    kernel_ids(&kernels, &mut text)?;
    store(&kernels, &mut text)?;
    for (source, shader) in &kernels {
        let own = own_constants(source, shader);
        kernel(source, &shader.entries[0], &own, &mut text);
    }
    text.push_str("/// The constants of `shaders/shared/`.\npub mod shared {\n");
    for (stem, constants) in &shared {
        let constants = constants_text(constants.values().copied());
        let _ = write!(
            text,
            "/// Constants of `shaders/shared/{stem}.wgsl`.\npub mod {stem} {{\n{constants}}}\n"
        );
    }
    text.push_str("}\n");
    text.push_str("/// The draw shaders.\n#[allow(unused_imports, reason = \"empty while there is no draw shader\")]\npub mod draw {\nuse super::*;\n");
    for (source, shader) in &draws {
        draw_shader(source, shader, &mut text)?;
        let (name, constants) = (&source.name, own_constants(source, shader));
        if !constants.is_empty() {
            let _ = write!(
                text,
                "/// Constants of `shaders/draw/{name}.wgsl`.\npub mod {name} {{\n{constants}}}\n"
            );
        }
    }
    text.push_str("}\n");
    layout_checks(kernels.iter().chain(&draws), &mut text)?;
    write(&out.join("kernels.rs"), &text)?;
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
                        let bytes: Vec<u8> = code.iter().flat_map(|word| word.to_le_bytes()).collect();
                        let path = spirv.join(format!("{}{which}.spv", entry.name));
                        std::fs::write(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))?;
                    }
                }
                shaders.push((source, shader));
            }
            Err(error) => errors.push(error),
        }
    }
    if errors.is_empty() { Ok(shaders) } else { Err(errors.join("\n")) }
}

/// `grid_count` to `GridCount`.
fn camel(name: &str) -> String {
    let capital = |part: &str| part[..1].to_uppercase() + &part[1..];
    name.split('_').filter(|part| !part.is_empty()).map(capital).collect()
}

fn kernel_ids(kernels: &[(Source, Shader)], text: &mut String) -> Result<(), String> {
    let mut names = Vec::new();
    for (source, shader) in kernels {
        let file = format!("shaders/{}.wgsl", source.name);
        let [entry] = shader.entries.as_slice() else {
            return Err(format!(
                "{file}:1: a kernel file has one entry point, found {}",
                shader.entries.len()
            ));
        };
        if entry.name != source.name {
            return Err(format!("{file}:1: the entry point `{}` must be named as its file", entry.name));
        }
        if entry.workgroup_size.iter().product::<u32>() > 256 {
            return Err(format!("{file}:1: workgroups over 256 invocations do not run everywhere"));
        }
        let storage = entry.bindings.iter().filter(|b| matches!(b.access, Use::Read | Use::Write)).count();
        if storage > 8 {
            return Err(format!("{file}:1: {storage} storage buffers, at most 8 run everywhere"));
        }
        let twin = format!("src/reference/{}.rs", source.name);
        if !Path::new(&twin).exists() {
            return Err(format!("{file}:1: kernel without a CPU twin: write {twin}"));
        }
        names.push(source.name.as_str());
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
    Ok(())
}

/// The buffers: one per binding name over all kernels.
fn store(kernels: &[(Source, Shader)], text: &mut String) -> Result<(), String> {
    let mut buffers: BTreeMap<&str, &Binding> = BTreeMap::new();
    for binding in kernels.iter().flat_map(|(_, shader)| &shader.entries[0].bindings) {
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
         /// Whether it is a uniform buffer.\npub const fn is_uniform(self) -> bool {{ match self {{\n{}}} }}\n}}\n",
        list(&|b| format!("/// `{}`\n{},\n", b.name, camel(&b.name))),
        buffers.len(),
        list(&|b| format!("Self::{},", camel(&b.name))),
        list(&|b| format!("Self::{} => \"{}\",\n", camel(&b.name), b.name)),
        list(&|b| format!("Self::{} => {},\n", camel(&b.name), b.stride)),
        list(&|b| format!("Self::{} => {},\n", camel(&b.name), is_uniform(b))),
    );
    let (field, bytes, bytes_mut) = (
        list(&|b| {
            let ty = if is_uniform(b) { b.rust.clone() } else { format!("Vec<{}>", b.rust) };
            format!("/// Buffer `{}`, declared at `{}`.\npub {}: {ty},\n", b.name, b.place, b.name)
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
         /// The bytes of a buffer, to be overwritten.\npub fn bytes_mut(&mut self, buffer: BufferId) -> &mut [u8] {{ match buffer {{\n{bytes_mut}}} }}\n}}\n",
    );
    Ok(())
}

fn words(spirv: &[u32]) -> String {
    spirv.iter().map(|word| format!("{word},")).collect()
}

/// Constants of shared texts, by file and name.
type Shared<'a> = BTreeMap<String, BTreeMap<&'a str, &'a Constant>>;

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn shared_constants<'a>(shaders: impl Iterator<Item = &'a (Source, Shader)>) -> Shared<'a> {
    let mut shared = Shared::new();
    for constant in shaders.flat_map(|(_, shader)| &shader.constants) {
        if constant.file.starts_with("shaders/shared") {
            shared.entry(stem(&constant.file)).or_default().insert(&constant.name, constant);
        }
    }
    shared
}

/// Constants that a shader's own file declares.
fn own_constants(source: &Source, shader: &Shader) -> String {
    let own = |c: &&Constant| !c.file.starts_with("shaders/shared") && stem(&c.file) == source.name;
    constants_text(shader.constants.iter().filter(own))
}

/// Constants in Rust; numbers without a sign also as lengths and indices.
fn constants_text<'a>(constants: impl Iterator<Item = &'a Constant>) -> String {
    let (mut text, mut lengths) = (String::new(), String::new());
    for c in constants {
        let (name, ty) = (&c.name, c.value.rust_type());
        let doc = format!("/// `{}:{}`: {}\n", c.file.display(), c.line, c.value.text());
        let _ = writeln!(text, "{doc}pub const {name}: {ty} = {};", c.value.rust());
        if ty == "u32" {
            let _ = writeln!(lengths, "{doc}pub const {name}: usize = super::{name} as usize;");
        }
    }
    if !lengths.is_empty() {
        let _ = write!(text, "/// The same, to count and to index with.\npub mod index {{\n{lengths}}}\n");
    }
    text
}

/// Refuses a constant in `src/reference` that has the name of one of its kernel's file or of a shared one.
fn twins_declare_none_again(kernels: &[(Source, Shader)], shared: &Shared<'_>) -> Result<(), String> {
    let folder = Path::new("src/reference");
    let listing = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<PathBuf> = listing.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.sort();
    let mut errors = Vec::new();
    for file in files {
        let own = kernels.iter().find(|(source, _)| source.name == stem(&file));
        let own = own.into_iter().flat_map(|(_, shader)| &shader.constants);
        let known: Vec<&Constant> = own.chain(shared.values().flat_map(BTreeMap::values).copied()).collect();
        let text = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        for (number, line) in text.lines().enumerate() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let declared = words.windows(2).find(|pair| matches!(pair[0], "const" | "static"));
            let name = declared.and_then(|pair| pair[1].strip_suffix(':'));
            if let Some(first) = known.iter().find(|constant| Some(constant.name.as_str()) == name) {
                errors.push(format!(
                    "{}:{}: `{}` stands at {}:{} already: import it from crate::kernels",
                    file.display(),
                    number + 1,
                    first.name,
                    first.file.display(),
                    first.line
                ));
            }
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(errors.join("\n")) }
}

fn kernel(source: &Source, entry: &Entry, constants: &str, text: &mut String) {
    let name = &source.name;
    let bindings: String = entry
        .bindings
        .iter()
        .map(|b| {
            format!(
                "Binding {{ buffer: BufferId::{}, index: {}, access: Access::{:?} }},",
                camel(&b.name),
                b.binding,
                b.access
            )
        })
        .collect();
    let field = |b: &Binding| match b.access {
        Use::Uniform => format!("&'a {}", b.rust),
        Use::Write => format!("&'a mut [{}]", b.rust),
        _ => format!("&'a [{}]", b.rust),
    };
    let borrow = |b: &Binding| match b.access {
        Use::Write => format!("{0}: &mut store.{0},", b.name),
        _ => format!("{0}: &store.{0},", b.name),
    };
    let level = entry.immediate.is_some();
    let _ = write!(
        text,
        "/// Kernel `{name}`.\npub mod {name} {{\nuse super::*;\n\
         /// The kernel.\npub static KERNEL: Kernel = Kernel {{ id: KernelId::{id}, name: \"{name}\", workgroup_size: {size:?}, \
         bindings: &[{bindings}], has_level: {level}, spirv: &[{words}] }};\n\
         /// The bindings as slices, for the CPU twin.\n#[derive(Debug)]\npub struct Slices<'a> {{\n{fields}{level_field}}}\n\
         impl<'a> Slices<'a> {{\n/// Borrows what the kernel binds.\npub fn of(store: &'a mut Store, {level_name}: u32) -> Self {{ Self {{ {borrows} {level_set} }} }}\n}}\n{constants}}}\n",
        id = camel(name),
        size = entry.workgroup_size,
        words = words(&entry.spirv),
        fields = entry
            .bindings
            .iter()
            .map(|b| format!("/// `{}`\npub {}: {},\n", b.place, b.name, field(b)))
            .collect::<String>(),
        level_field = if level { "/// Which pass of the kernel.\npub level: u32,\n" } else { "" },
        level_name = if level { "level" } else { "_level" },
        borrows = entry.bindings.iter().map(borrow).collect::<String>(),
        level_set = if level { "level," } else { "" },
    );
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
            let one_eye =
                e.one_eye.as_ref().map_or_else(|| "None".to_owned(), |w| format!("Some(&[{}])", words(w)));
            format!(
                "DrawEntry {{ name: \"{}\", spirv: &[{}], one_eye: {one_eye} }},",
                e.name,
                words(&e.spirv)
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

/// One assertion per field: a Rust struct that disagrees with its WGSL twin does not compile.
fn layout_checks<'a>(
    shaders: impl Iterator<Item = &'a (Source, Shader)>,
    text: &mut String,
) -> Result<(), String> {
    let mut layouts: BTreeMap<&str, &Layout> = BTreeMap::new();
    for layout in shaders.flat_map(|(_, shader)| &shader.layouts) {
        if let Some(first) = layouts.insert(&layout.name, layout)
            && (first.fields != layout.fields)
        {
            return Err(format!("{}: `{}` differs from {}", layout.place, layout.name, first.place));
        }
    }
    for layout in layouts.values() {
        let (name, place) = (&layout.name, &layout.place);
        for (field, offset, size) in &layout.fields {
            let _ = write!(
                text,
                "const _: () = assert!(core::mem::offset_of!(layout::{name}, {field}) == {offset}, \
                 \"{place}: offset of {name}.{field} is {offset} in WGSL, not in Rust\");\n\
                 const _: () = assert!(layout::field_size(|x: &layout::{name}| &x.{field}) == {size}, \
                 \"{place}: size of {name}.{field} is {size} in WGSL, not in Rust\");\n",
            );
        }
        let _ = writeln!(
            text,
            "const _: () = assert!(core::mem::size_of::<layout::{name}>() == {}, \"{place}: size of {name} differs\");",
            layout.size
        );
    }
    Ok(())
}

/// Declares the twins and the call from a kernel to its twin.
fn reference(kernels: &[(Source, Shader)]) -> Result<String, String> {
    let root = std::env::var("CARGO_MANIFEST_DIR").map_err(|e| format!("CARGO_MANIFEST_DIR: {e}"))?;
    let mut text = String::from("// Written by build.rs: one module per kernel.\n");
    let mut arms = String::new();
    for (source, _) in kernels {
        let (name, id) = (&source.name, camel(&source.name));
        let _ = writeln!(text, "#[path = \"{root}/src/reference/{name}.rs\"]\npub mod {name};");
        let _ = writeln!(
            arms,
            "KernelId::{id} => {name}::{name}(crate::kernels::{name}::Slices::of(store, level)),"
        );
    }
    let _ = write!(
        text,
        "/// Runs the CPU twin of a kernel over all of its invocations.\n\
         pub fn run(kernel: KernelId, store: &mut Store, level: u32) {{ match kernel {{\n{arms}}} }}\n"
    );
    Ok(text)
}
