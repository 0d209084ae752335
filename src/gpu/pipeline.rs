//! A phase of a kernel as a Vulkan pipeline, which engines on one device share, and with the buffers of one of them.

use super::{Buffer, Device, Error, call};
use crate::kernels::spirv::with_immediate;
use crate::kernels::{Access, Entry, Kernel};
use ash::vk;
use std::ffi::CString;
use std::sync::{Arc, Mutex, PoisonError};

/// One phase of a kernel, compiled.
///
/// A phase whose immediate is flags is compiled for every word that it is launched with: what the flags rule out is not in it.
pub(super) struct Program {
    device: Arc<Device>,
    entry: &'static Entry,
    code: Vec<u32>, // of a phase whose immediate is flags
    name: CString,
    made: Mutex<Vec<Made>>,
    pub(super) layout: vk::PipelineLayout,
    set_layout: vk::DescriptorSetLayout,
    pub(super) label: CString,
}

/// A pipeline, and the word that it is for.
struct Made {
    word: u32,
    raw: vk::Pipeline,
}

/// The same with the buffers of an engine, ready to be launched.
pub(super) struct Pipeline {
    pub(super) program: Arc<Program>,
    pub(super) set: vk::DescriptorSet,
}

const fn kind(access: Access) -> vk::DescriptorType {
    match access {
        Access::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        Access::Read | Access::Write => vk::DescriptorType::STORAGE_BUFFER,
    }
}

impl Program {
    /// Compiles an entry point, for an immediate of this word if it is flags.
    pub(super) fn new(
        device: &Arc<Device>,
        entry: &'static Entry,
        code: Vec<u32>,
        word: u32,
    ) -> Result<Self, Error> {
        let bindings: Vec<_> = entry
            .bindings
            .iter()
            .map(|b| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(b.index)
                    .descriptor_count(1)
                    .descriptor_type(kind(b.access))
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let immediate = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(4)];
        let immediate = if entry.immediate.is_some() { &immediate[..] } else { &[] };
        let name = CString::new(entry.name).unwrap_or_default();
        let label = CString::new(format!("gaitway.{}", entry.label)).unwrap_or_default();
        // null handles until all is made: what has been made when a call fails is destroyed with the others
        let mut made = Self {
            device: device.clone(),
            entry,
            code,
            name,
            made: Mutex::default(),
            layout: vk::PipelineLayout::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            label,
        };
        let raw = &device.raw;
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: all create-infos are complete.
        unsafe {
            made.set_layout = raw
                .create_descriptor_set_layout(&create, None)
                .map_err(call("vkCreateDescriptorSetLayout"))?;
            let set_layouts = [made.set_layout];
            let create = vk::PipelineLayoutCreateInfo::default()
                .set_layouts(&set_layouts)
                .push_constant_ranges(immediate);
            made.layout =
                raw.create_pipeline_layout(&create, None).map_err(call("vkCreatePipelineLayout"))?;
        }
        made.raw(word)?;
        if !made.has_flags() {
            made.code = Vec::new(); // it is compiled once
        }
        Ok(made)
    }

    /// Whether its immediate is flags.
    fn has_flags(&self) -> bool {
        self.entry.immediate.as_ref().is_some_and(|immediate| !immediate.flags.is_empty())
    }

    /// The pipeline for an immediate of this word, which is compiled now if there is none yet.
    pub(super) fn raw(&self, word: u32) -> Result<vk::Pipeline, Error> {
        let word = if self.has_flags() { word } else { 0 };
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(made) = made.iter().find(|made| made.word == word) {
            return Ok(made.raw);
        }
        let special = self.has_flags().then(|| with_immediate(&self.code, word));
        let raw = self.compiled(special.as_ref().unwrap_or(&self.code))?;
        made.push(Made { word, raw });
        Ok(raw)
    }

    fn compiled(&self, code: &[u32]) -> Result<vk::Pipeline, Error> {
        let raw = &self.device.raw;
        // SAFETY: all create-infos are complete, and the SPIR-V was validated when the crate was built.
        let made = unsafe {
            let module = raw
                .create_shader_module(&vk::ShaderModuleCreateInfo::default().code(code), None)
                .map_err(call("vkCreateShaderModule"))?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(&self.name);
            let create = [vk::ComputePipelineCreateInfo::default().layout(self.layout).stage(stage)];
            let pipelines = raw.create_compute_pipelines(self.device.cache.raw(), &create, None);
            raw.destroy_shader_module(module, None);
            pipelines
                .map_err(|(_, result)| Error::Call { call: "vkCreateComputePipelines", result })?
                .first()
                .copied()
                .unwrap_or_default()
        };
        self.device.name(made, self.entry.label);
        Ok(made)
    }
}

impl Pipeline {
    /// Makes the descriptor set of a program, with the buffers that its entry point binds by name.
    pub(super) fn new(
        device: &Device,
        entry: &'static Entry,
        program: Arc<Program>,
        descriptors: vk::DescriptorPool,
        buffers: &[Option<Buffer>],
    ) -> Result<Self, Error> {
        let set_layouts = [program.set_layout];
        let allocate =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(descriptors).set_layouts(&set_layouts);
        // SAFETY: the create-info is complete; pool and layout are alive, and the set goes with its pool.
        let sets = unsafe { device.raw.allocate_descriptor_sets(&allocate) };
        let set = sets.map_err(call("vkAllocateDescriptorSets"))?.first().copied().unwrap_or_default();
        let made = Self { program, set };
        made.bind(device, entry, buffers);
        Ok(made)
    }

    /// Writes the buffers that the entry point binds into its descriptor set; nothing that uses it may be under way.
    pub(super) fn bind(&self, device: &Device, entry: &'static Entry, buffers: &[Option<Buffer>]) {
        let infos: Vec<_> = entry
            .bindings
            .iter()
            .map(|b| {
                let buffer = buffers[b.buffer.home() as usize].as_ref().map_or(vk::Buffer::null(), |x| x.raw);
                [vk::DescriptorBufferInfo::default().buffer(buffer).range(vk::WHOLE_SIZE)]
            })
            .collect();
        let writes: Vec<_> = entry
            .bindings
            .iter()
            .zip(&infos)
            .map(|(b, info)| {
                vk::WriteDescriptorSet::default()
                    .dst_set(self.set)
                    .dst_binding(b.index)
                    .descriptor_type(kind(b.access))
                    .buffer_info(info)
            })
            .collect();
        // SAFETY: set and buffers are alive, the set was made for these bindings, and every submission is waited for.
        unsafe { device.raw.update_descriptor_sets(&writes, &[]) };
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: every submission was waited for; null handles are ignored.
        unsafe {
            for made in self.made.get_mut().unwrap_or_else(PoisonError::into_inner) {
                raw.destroy_pipeline(made.raw, None);
            }
            raw.destroy_pipeline_layout(self.layout, None);
            raw.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

/// SPIR-V.
pub(super) type Code = std::borrow::Cow<'static, [u32]>;

/// The code of a kernel's phases, as it was when the program was built.
#[cfg(not(feature = "hot-reload"))]
#[allow(clippy::unnecessary_wraps, reason = "reloading can fail")]
pub(super) fn code(kernel: &'static Kernel) -> Result<Vec<Code>, Error> {
    Ok(kernel.phases.iter().map(|phase| phase.entry().spirv.into()).collect())
}

/// The code of a kernel's phases: compiled again from the folder that `GAITWAY_SHADERS` names, if it names one.
#[cfg(feature = "hot-reload")]
pub(super) fn code(kernel: &'static Kernel) -> Result<Vec<Code>, Error> {
    use crate::kernels::compile::{Source, compile, fault};
    let entries = kernel.phases.iter().map(|phase| phase.entry());
    let Some(folder) = super::arithmetic::shader_folder() else {
        return Ok(entries.map(|entry| entry.spirv.into()).collect());
    };
    let file = folder.join(kernel.name).with_extension("wgsl");
    let source = Source::read(&file, &folder.join("shared"), kernel.id as usize)?;
    let mut found = compile(&source)?.entries;
    let code = entries.map(|entry| {
        let wanted = entry.bindings.iter().map(|b| (b.buffer.name(), b.index));
        let found = found.iter_mut().find(|found| found.name == entry.name)?;
        let is_same = found.bindings.iter().map(|b| (b.name.as_str(), b.binding)).eq(wanted);
        is_same.then(|| std::mem::take(&mut found.spirv).into())
    });
    code.collect::<Option<_>>().ok_or_else(|| {
        let message = "other phases or bindings than when the program was built: build it again";
        fault::Error::at(file.display(), message).into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::for_tests;
    use crate::kernels::Phase;

    #[test]
    fn what_was_made_before_a_call_failed_is_destroyed() {
        let Some(device) = for_tests::device() else { return };
        // SAFETY: the create-infos are complete.
        let (set_layout, layout) = unsafe {
            let create = vk::DescriptorSetLayoutCreateInfo::default();
            let set_layout = device.raw.create_descriptor_set_layout(&create, None).unwrap();
            let create = vk::PipelineLayoutCreateInfo::default();
            (set_layout, device.raw.create_pipeline_layout(&create, None).unwrap())
        };
        drop(Program {
            device: device.clone(),
            entry: Phase::Integrate.entry(),
            code: Vec::new(),
            name: CString::default(),
            made: Mutex::default(),
            layout,
            set_layout,
            label: CString::default(),
        });
        drop(device); // the validation layer reports what is left
        for_tests::assert_silent();
    }
}
