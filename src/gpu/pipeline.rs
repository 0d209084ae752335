//! A phase of a kernel as a Vulkan pipeline, which engines on one device share, and with the buffers of one of them.

use super::{Buffer, Device, Error, call};
use crate::kernels::{Access, Entry, Kernel};
use ash::vk;
use std::ffi::CString;
use std::sync::Arc;

/// One phase of a kernel, compiled.
pub(super) struct Program {
    device: Arc<Device>,
    pub(super) raw: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    set_layout: vk::DescriptorSetLayout,
    pub(super) label: CString,
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
    /// Compiles an entry point.
    pub(super) fn new(device: &Arc<Device>, entry: &'static Entry, spirv: &[u32]) -> Result<Self, Error> {
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
        let word = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(4)];
        let word = if entry.immediate.is_some() { &word[..] } else { &[] };
        let name = CString::new(entry.name).unwrap_or_default();
        let label = CString::new(format!("gaitway.{}", entry.label)).unwrap_or_default();
        // null handles until all is made: what has been made when a call fails is destroyed with the others
        let mut made = Self {
            device: device.clone(),
            raw: vk::Pipeline::null(),
            layout: vk::PipelineLayout::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            label,
        };
        let raw = &device.raw;
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: all create-infos are complete, and the SPIR-V was validated when the crate was built.
        unsafe {
            made.set_layout = raw
                .create_descriptor_set_layout(&create, None)
                .map_err(call("vkCreateDescriptorSetLayout"))?;
            let set_layouts = [made.set_layout];
            let create =
                vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts).push_constant_ranges(word);
            made.layout =
                raw.create_pipeline_layout(&create, None).map_err(call("vkCreatePipelineLayout"))?;
            let module = raw
                .create_shader_module(&vk::ShaderModuleCreateInfo::default().code(spirv), None)
                .map_err(call("vkCreateShaderModule"))?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(&name);
            let create = [vk::ComputePipelineCreateInfo::default().layout(made.layout).stage(stage)];
            let pipelines = raw.create_compute_pipelines(device.cache.raw(), &create, None);
            raw.destroy_shader_module(module, None);
            made.raw = pipelines
                .map_err(|(_, result)| Error::Call { call: "vkCreateComputePipelines", result })?
                .first()
                .copied()
                .unwrap_or_default();
        }
        device.name(made.raw, entry.label);
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
                let buffer = buffers[b.buffer as usize].as_ref().map_or(vk::Buffer::null(), |x| x.raw);
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
            raw.destroy_pipeline(self.raw, None);
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
            raw: vk::Pipeline::null(),
            layout,
            set_layout,
            label: CString::default(),
        });
        drop(device); // the validation layer reports what is left
        for_tests::assert_silent();
    }
}
