//! A driver that hands out compiled pipelines: lavapipe and SwiftShader hand out the head of such data and nothing else.
//!
//! Only the keys of pipelines are kept, hashes of their code. Every device that ends writes a line into the file that
//! [`LOG`] names: how many pipelines were compiled, and how many were in the cache that they were made with.

use super::vulkan::{CacheCreate, Code, INCOMPLETE, ModuleCreate, Object, SUCCESS, Stage};
use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::CStr;
use std::hash::{Hash, Hasher};
use std::io::Write as _;
use std::slice;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The environment variable that names the file.
pub(crate) const LOG: &str = "GAITWAY_WRONG_DEVICE_LOG";
/// Bytes of the head of every driver's data.
const HEAD: usize = 32;
/// Bytes of a pipeline in the data.
const ENTRY: usize = 256;

#[derive(Default)]
pub(crate) struct Pipelines {
    modules: BTreeMap<Object, u64>,
    caches: BTreeMap<Object, BTreeSet<u64>>,
    compiled: u64,
    taken: u64,
}

static PIPELINES: Mutex<Pipelines> =
    Mutex::new(Pipelines { modules: BTreeMap::new(), caches: BTreeMap::new(), compiled: 0, taken: 0 });

pub(crate) fn pipelines() -> MutexGuard<'static, Pipelines> {
    PIPELINES.lock().unwrap_or_else(PoisonError::into_inner)
}

fn hash(value: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

impl Pipelines {
    pub(crate) unsafe fn add_module(&mut self, module: Object, create: &ModuleCreate) {
        let code = unsafe { slice::from_raw_parts(create.code, create.size) };
        self.modules.insert(module, hash(&code));
    }

    /// A new cache with what its data hold.
    pub(crate) unsafe fn add_cache(&mut self, cache: Object, create: &CacheCreate) {
        let data = match create.size {
            0 => &[],
            size => unsafe { slice::from_raw_parts(create.data, size) },
        };
        let entries = data.get(HEAD..).unwrap_or_default().chunks_exact(ENTRY);
        let keys = entries.map(|entry| u64::from_le_bytes(std::array::from_fn(|at| entry[at])));
        self.caches.insert(cache, keys.collect());
    }

    pub(crate) unsafe fn make<'a>(&mut self, cache: Object, stages: impl Iterator<Item = &'a Stage>) {
        let keys: Vec<(Option<&u64>, &CStr)> = stages
            .map(|stage| (self.modules.get(&stage.module), unsafe { CStr::from_ptr(stage.name) }))
            .collect();
        let key = hash(&keys);
        let is_new = self.caches.get_mut(&cache).is_none_or(|known| known.insert(key));
        *(if is_new { &mut self.compiled } else { &mut self.taken }) += 1;
    }

    pub(crate) fn merge(&mut self, into: Object, from: &[Object]) {
        let added: Vec<u64> =
            from.iter().filter_map(|cache| self.caches.get(cache)).flatten().copied().collect();
        self.caches.entry(into).or_default().extend(added);
    }

    /// The data of a cache behind the driver's own head.
    pub(crate) unsafe fn data(
        &self,
        cache: Object,
        head: [u8; HEAD],
        size: &mut usize,
        out: *mut u8,
    ) -> Code {
        let mut data = head.to_vec();
        for key in self.caches.get(&cache).into_iter().flatten() {
            data.extend(key.to_le_bytes().iter().cycle().take(ENTRY));
        }
        if out.is_null() {
            *size = data.len();
            return SUCCESS;
        }
        let whole = data.len() <= *size;
        *size = if whole { data.len() } else { 0 };
        unsafe { slice::from_raw_parts_mut(out, *size) }.copy_from_slice(&data[..*size]);
        if whole { SUCCESS } else { INCOMPLETE }
    }

    /// Writes the counts of a device that ends.
    pub(crate) fn end(&mut self) {
        let (compiled, taken) = (std::mem::take(&mut self.compiled), std::mem::take(&mut self.taken));
        let Some(path) = std::env::var_os(LOG) else { return };
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        let line = format!("{compiled} compiled, {taken} taken\n");
        // one write, so that the lines of programs do not mix
        let _ = file.and_then(|mut file| file.write_all(line.as_bytes()));
    }
}
