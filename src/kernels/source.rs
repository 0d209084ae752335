//! The text of a shader, joined from its files.

use super::fault::Error;
use std::path::{Path, PathBuf};

/// Text of one shader with the shared texts it asks for behind it, and where each part came from.
///
/// A line `// uses: exact, orca` names files of `shaders/shared/`. They follow the shader's own text (WGSL
/// allows use before declaration), so the shader's line numbers stay true.
#[derive(Debug)]
pub struct Source {
    /// File stem, the kernel's name.
    pub name: String,
    text: String,
    /// First line (from 0) of each part and its file.
    parts: Vec<(usize, PathBuf)>,
}

impl Source {
    /// Reads `file` and the shared texts it uses, each once; `number` becomes the constant `KERNEL_ID`, under which
    /// a kernel reports failures.
    ///
    /// # Errors
    /// The file that cannot be read.
    pub fn read(file: &Path, shared: &Path, number: usize) -> Result<Self, Error> {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut source = Self { name, text: String::new(), parts: Vec::new() };
        let mut wanted = vec![file.to_path_buf()];
        let mut next = 0;
        while next < wanted.len() {
            let part = wanted[next].clone();
            next += 1;
            let text = std::fs::read_to_string(&part).map_err(|e| Error::at(part.display(), e))?;
            for used in text.lines().filter_map(|line| line.strip_prefix("// uses:")) {
                for stem in used.split(',').map(str::trim) {
                    let path = shared.join(format!("{stem}.wgsl"));
                    if !wanted.contains(&path) {
                        wanted.push(path);
                    }
                }
            }
            source.parts.push((source.text.lines().count(), part));
            source.text.push_str(&text);
            if !source.text.ends_with('\n') {
                source.text.push('\n');
            }
        }
        source.text.push_str(&format!("const KERNEL_ID: u32 = {number}u;\n"));
        Ok(source)
    }

    /// The joined text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Where a file's text begins in the joined text, bytes.
    pub fn start_of(&self, file: &Path) -> Option<usize> {
        let (line, _) = self.parts.iter().find(|(_, part)| part == file)?;
        Some(self.text.split_inclusive('\n').take(*line).map(str::len).sum())
    }

    /// All files the text came from.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.parts.iter().map(|(_, file)| file.as_path())
    }

    /// `file:line:column` of a byte range of the joined text.
    pub fn place(&self, span: naga::Span) -> String {
        let at = span.location(&self.text);
        match self.part(at.line_number as usize - 1) {
            Some((file, line)) => format!("{}:{line}:{}", file.display(), at.line_position),
            None => self.name.clone(),
        }
    }

    /// The comment on the line of a struct's field.
    pub fn comment_of(&self, name: &str, field: &str) -> Option<String> {
        let start = format!("struct {name} {{");
        let lines = self.text.lines().skip_while(|line| !line.starts_with(&start)).skip(1);
        let mut lines = lines.take_while(|line| !line.starts_with('}')).map(str::trim);
        let line = lines.find(|line| line.split_once(':').is_some_and(|(own, _)| own.trim() == field))?;
        Some(line.split_once("//")?.1.trim().to_owned())
    }

    /// The file of a line (from 0) of the joined text, and the number (from 1) that the line has there.
    pub fn part(&self, line: usize) -> Option<(&Path, usize)> {
        let (first, file) = self.parts.iter().rev().find(|(first, _)| *first <= line)?;
        Some((file, line - first + 1))
    }
}
