//! Compiled pipelines, kept for devices that are opened later: within this process in memory, for later programs in a file.
//!
//! A driver takes up to seconds to compile all pipelines. A device that is lost is opened again in the same process, and every
//! command opens one. Nothing here fails: what cannot be read or written is compiled again.

use super::instance::DriverId;
use crate::file;
use crate::hash::Hash;
use ash::vk;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The environment variable that names the folder of the files, or says `off`.
pub const CACHE_VARIABLE: &str = "GAITWAY_PIPELINE_CACHE";
/// Its value for no file.
const OFF: &str = "off";

/// What our files begin with: who wrote them, and in which form.
const MAGIC: [u8; 8] = *b"gwpipes\x01";
/// Bytes before the driver's data: magic, length and hash of the data.
const HEAD: usize = 24;
/// Longest data of a file, bytes. Every version of the shaders adds to it, so a longer one begins again.
const MOST: usize = 64 << 20;
/// Bytes at the beginning of a driver's data, which say whose they are (`VkPipelineCacheHeaderVersionOne`).
const DRIVERS_HEAD: usize = 16 + vk::UUID_SIZE;

/// What the devices of this process have compiled, by driver.
static KEPT: Mutex<Vec<(DriverId, Arc<[u8]>)>> = Mutex::new(Vec::new());

/// The pipelines that a device has compiled or was given.
pub(crate) struct PipelineCache {
    raw: vk::PipelineCache,
    driver: DriverId,
    /// Hash of the data that it began with.
    begun: u64,
    /// Where other programs find them.
    file: Option<PathBuf>,
}

impl PipelineCache {
    /// Begins with what devices of this driver have compiled before, in this process or as its file says.
    pub(super) fn open(device: &ash::Device, driver: DriverId) -> Self {
        Self::open_at(device, driver, folder().map(|folder| folder.join(driver.file_name())))
    }

    fn open_at(device: &ash::Device, driver: DriverId, file: Option<PathBuf>) -> Self {
        let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let in_process = kept.iter().find(|(of, _)| *of == driver).map(|(_, data)| data.clone());
        drop(kept);
        let data = in_process.or_else(|| read(file.as_deref()?, &driver)).unwrap_or_default();
        let raw = make(device, &data).or_else(|| make(device, &[])).unwrap_or_default();
        Self { raw, driver, begun: hash_of(&data), file }
    }

    /// Keeps nothing: for code that is wrong on purpose, or will be other code in the next run.
    pub(super) fn none(driver: DriverId) -> Self {
        Self { raw: vk::PipelineCache::null(), driver, begun: 0, file: None }
    }

    /// What pipelines are made with.
    pub(crate) const fn raw(&self) -> vk::PipelineCache {
        self.raw
    }

    /// Keeps what was compiled, and destroys the cache.
    ///
    /// # Safety
    /// The device is the one that it was opened for, and makes no pipeline from now on.
    pub(super) unsafe fn close(&mut self, device: &ash::Device) {
        self.keep(device);
        // SAFETY: no pipeline is being made; null is ignored.
        unsafe { device.destroy_pipeline_cache(self.raw, None) };
        self.raw = vk::PipelineCache::null();
    }

    fn keep(&self, device: &ash::Device) -> Option<()> {
        let data = self.data(device)?;
        if hash_of(&data) == self.begun {
            return None;
        }
        // held while writing, so that the devices of a process write one after another
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let place = kept.iter().position(|(of, _)| *of == self.driver);
        let in_process = place.map(|place| kept[place].1.clone());
        let in_file = self.file.as_deref().and_then(|file| read(file, &self.driver));
        // what others have added since it was opened
        for added in [&in_process, &in_file].into_iter().flatten().filter(|data| hash_of(data) != self.begun)
        {
            self.merge(device, added);
        }
        let data: Arc<[u8]> = self.data(device)?.into();
        match place {
            Some(place) => kept[place].1 = data.clone(),
            None => kept.push((self.driver, data.clone())),
        }
        write(self.file.as_deref()?, &data, in_file.as_deref());
        Some(())
    }

    /// The driver's data, if it has compiled anything.
    fn data(&self, device: &ash::Device) -> Option<Vec<u8>> {
        if self.raw == vk::PipelineCache::null() {
            return None;
        }
        // SAFETY: the cache is of this device.
        let data = unsafe { device.get_pipeline_cache_data(self.raw) }.ok()?;
        (data.len() > DRIVERS_HEAD).then_some(data)
    }

    fn merge(&self, device: &ash::Device, data: &[u8]) {
        let Some(other) = make(device, data) else { return };
        // SAFETY: both caches are of this device, and no pipeline is being made. A merge that fails adds nothing.
        unsafe {
            let _ = device.merge_pipeline_caches(self.raw, &[other]);
            device.destroy_pipeline_cache(other, None);
        }
    }
}

fn make(device: &ash::Device, data: &[u8]) -> Option<vk::PipelineCache> {
    let create = vk::PipelineCacheCreateInfo::default().initial_data(data);
    // SAFETY: the data is empty, or what the same driver gave: its hash is right, and its head names the driver.
    unsafe { device.create_pipeline_cache(&create, None) }.ok()
}

fn hash_of(data: &[u8]) -> u64 {
    let mut hash = Hash::default();
    hash.add_bytes(data);
    hash.value()
}

/// The data of a file; none where there is none, where it is damaged or of another driver.
fn read(path: &Path, driver: &DriverId) -> Option<Arc<[u8]>> {
    let bytes = file::read(path, (HEAD + MOST) as u64).ok()?;
    let (head, data) = bytes.split_at_checked(HEAD)?;
    (head == head_of(data) && driver.made(data)).then(|| data.into())
}

fn head_of(data: &[u8]) -> [u8; HEAD] {
    let mut head = [0; HEAD];
    head[..8].copy_from_slice(&MAGIC);
    head[8..16].copy_from_slice(&(data.len() as u64).to_le_bytes());
    head[16..].copy_from_slice(&hash_of(data).to_le_bytes());
    head
}

/// Writes a file whole or not at all, unless it holds the data already.
fn write(path: &Path, data: &[u8], present: Option<&[u8]>) {
    if present == Some(data) {
        return;
    }
    if data.len() > MOST {
        let _ = std::fs::remove_file(path); // the next program begins again
        return;
    }
    let written = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    // A folder that cannot be written to is no error: the next program compiles again.
    let _ = written.and_then(|()| file::write(path, &[&head_of(data), data].concat()));
}

/// The folder of the files: what [`CACHE_VARIABLE`] names, or `gaitway` in the user's cache folder.
fn folder() -> Option<PathBuf> {
    match std::env::var_os(CACHE_VARIABLE).filter(|value| !value.is_empty()) {
        Some(off) if off == OFF => None,
        Some(own) => Some(own.into()),
        None => file::users_cache().map(|cache| cache.join("gaitway")),
    }
}

impl DriverId {
    fn file_name(&self) -> String {
        let uuid: String = self.cache_uuid.iter().map(|byte| format!("{byte:02x}")).collect();
        format!("{:04x}-{:04x}-{:08x}-{uuid}.pipelines", self.vendor, self.device, self.version)
    }

    /// Whether the head of a driver's data names this one.
    fn made(&self, data: &[u8]) -> bool {
        let length = u32::try_from(DRIVERS_HEAD).unwrap_or(0);
        let version = vk::PipelineCacheHeaderVersion::ONE.as_raw().cast_unsigned();
        let words = [length, version, self.vendor, self.device].map(u32::to_le_bytes);
        data.get(..DRIVERS_HEAD) == Some(&[words.as_flattened(), &self.cache_uuid].concat()[..])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::gpu::for_tests;

    const DRIVER: DriverId = DriverId { vendor: 0x10de, device: 0x2330, version: 7, cache_uuid: [0xab; 16] };

    /// Data as a driver gives them.
    fn data(driver: &DriverId, pipelines: &[u8]) -> Vec<u8> {
        let words = [32, 1, driver.vendor, driver.device].map(u32::to_le_bytes);
        [words.as_flattened(), &driver.cache_uuid, pipelines].concat()
    }

    #[test]
    fn a_file_is_read_whole_and_of_this_driver_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("in").join(DRIVER.file_name());
        let data = data(&DRIVER, b"some pipelines");
        write(&path, &data, None);
        assert_eq!(read(&path, &DRIVER).as_deref(), Some(&data[..]));
        let whole = std::fs::read(&path).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(read(&path, &DRIVER).is_none(), "{length} bytes");
        }
        for bit in 0..whole.len() * 8 {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&path, damaged).unwrap();
            assert!(read(&path, &DRIVER).is_none(), "bit {bit}");
        }
        std::fs::write(&path, [&whole[..], b"0"].concat()).unwrap();
        assert!(read(&path, &DRIVER).is_none(), "a byte more");
        std::fs::write(&path, &whole).unwrap();
        assert!(read(&path, &DRIVER).is_some());
        for other in [
            DriverId { vendor: 0x1002, ..DRIVER },
            DriverId { device: 1, ..DRIVER },
            DriverId { cache_uuid: [0; 16], ..DRIVER },
        ] {
            assert!(read(&path, &other).is_none(), "{other:?}");
            assert_ne!(other.file_name(), DRIVER.file_name());
        }
        assert_ne!(DriverId { version: 8, ..DRIVER }.file_name(), DRIVER.file_name());
    }

    #[test]
    fn a_file_is_written_where_it_differs_and_begins_again_where_it_is_too_long() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write(&path, b"1", Some(b"1"));
        assert!(!path.exists());
        write(&path, b"1", Some(b"2"));
        assert!(path.exists());
        write(&path, &vec![0; MOST + 1], None);
        assert!(!path.exists());
        let below_a_file = folder.path().join("file/below/file");
        std::fs::write(&path, b"").unwrap();
        write(&below_a_file, b"1", None);
        assert!(!below_a_file.exists());
    }

    #[test]
    fn a_cache_is_closed_with_nothing_in_it_and_where_there_is_none() {
        let Some(device) = for_tests::device() else { return };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write(&path, &data(&device.driver, &[]), None);
        let mut cache = PipelineCache::open_at(&device.raw, device.driver, Some(path));
        // SAFETY: no pipeline is made with it.
        unsafe { cache.close(&device.raw) };
        let mut none = PipelineCache::none(device.driver);
        assert_eq!(none.raw(), vk::PipelineCache::null());
        // SAFETY: as above.
        unsafe { none.close(&device.raw) };
        drop(device);
        for_tests::assert_silent();
    }
}
