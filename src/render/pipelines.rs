//! Draw shaders as pipelines. Descriptor sets are filled by the names of the bindings.

use super::Error;
use super::settings::Quality;
use super::target::{DEPTH_FORMAT, Format};
use crate::gpu::{self, Device, FRAMES_IN_FLIGHT, call};
use crate::kernels::{DrawBindingKind, DrawShader};
use ash::vk;
use std::ffi::CString;
use std::sync::Arc;

/// Draw shaders see their bindings in both stages.
const STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::VERTEX.as_raw() | vk::ShaderStageFlags::FRAGMENT.as_raw(),
);

/// What a binding is filled with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Resource {
    Buffer(vk::Buffer),
    Texture(vk::ImageView, vk::ImageLayout),
    Sampler(vk::Sampler),
}

/// What the pipelines of all passes have in common.
pub(super) struct Setup<'a> {
    pub(super) device: &'a Arc<Device>,
    pub(super) format: Format,
    pub(super) view_mask: u32,
    /// Passes with a view of their own.
    pub(super) passes: u32,
    pub(super) quality: Quality,
}

impl Setup<'_> {
    pub(super) fn program(&self, shader: &'static DrawShader) -> Result<Program, Error> {
        Program::new(self.device, shader, self.passes)
    }

    /// The entry points of the two stages: those of low quality, or those of better light.
    pub(super) fn stages(&self, low: [&'static str; 2], fine: [&'static str; 2]) -> [&'static str; 2] {
        if self.quality == Quality::Low { low } else { fine }
    }

    /// Closed bodies: what faces away is not drawn.
    pub(super) fn solid(&self, vertex: &'static str, fragment: &'static str) -> PipelineSpec {
        PipelineSpec {
            vertex,
            fragment: Some(fragment),
            samples: self.format.samples,
            color_format: self.format.color,
            view_mask: self.view_mask,
            cull: vk::CullModeFlags::BACK,
            compare: vk::CompareOp::GREATER, // reversed depth: nearer is larger
            write_depth: true,
            has_depth: true,
            blend: false,
            covers: false,
        }
    }

    /// Solids of which both sides are drawn.
    pub(super) fn two_sided(&self, vertex: &'static str, fragment: &'static str) -> PipelineSpec {
        PipelineSpec { cull: vk::CullModeFlags::NONE, ..self.solid(vertex, fragment) }
    }

    /// Depth only, on the shadow map. Both sides cast shadows: no surface needs to be closed.
    pub(super) fn shadow(&self, vertex: &'static str) -> PipelineSpec {
        PipelineSpec {
            fragment: None,
            samples: vk::SampleCountFlags::TYPE_1,
            view_mask: 0,
            cull: vk::CullModeFlags::NONE,
            ..self.solid(vertex, "")
        }
    }

    /// The same of surfaces with holes, which the second stage finds.
    pub(super) fn shadow_with_holes(&self, vertex: &'static str, fragment: &'static str) -> PipelineSpec {
        PipelineSpec { fragment: Some(fragment), color_format: vk::Format::UNDEFINED, ..self.shadow(vertex) }
    }

    /// Colour that leaves the depth as it is.
    pub(super) fn flat(
        &self,
        vertex: &'static str,
        fragment: &'static str,
        compare: vk::CompareOp,
    ) -> PipelineSpec {
        PipelineSpec { write_depth: false, compare, ..self.two_sided(vertex, fragment) }
    }

    /// Like [`Setup::flat`], blended over earlier colour.
    pub(super) fn blended(
        &self,
        vertex: &'static str,
        fragment: &'static str,
        compare: vk::CompareOp,
    ) -> PipelineSpec {
        PipelineSpec { blend: true, ..self.flat(vertex, fragment, compare) }
    }
}

/// Which of a program's descriptor sets: that of a pass of a frame in flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SetIndex {
    /// The slot of the frame.
    pub(crate) slot: usize,
    /// Number of an eye pass, or of a shadow map after them.
    pub(crate) pass: usize,
}

/// A draw shader with its layout, and a descriptor set for every pass of every frame in flight.
pub(crate) struct Program {
    device: Arc<Device>,
    shader: &'static DrawShader,
    set_layout: vk::DescriptorSetLayout,
    pub(crate) layout: vk::PipelineLayout,
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
    pipelines: Vec<vk::Pipeline>,
}

/// How a pipeline draws.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PipelineSpec {
    pub(crate) vertex: &'static str,
    /// None draws depth only.
    pub(crate) fragment: Option<&'static str>,
    pub(crate) samples: vk::SampleCountFlags,
    /// Undefined: there is no colour.
    pub(crate) color_format: vk::Format,
    pub(crate) view_mask: u32,
    pub(crate) cull: vk::CullModeFlags,
    pub(crate) compare: vk::CompareOp,
    pub(crate) write_depth: bool,
    /// Whether there is a depth attachment.
    pub(crate) has_depth: bool,
    pub(crate) blend: bool,
    /// Whether alpha says how many of a pixel's samples are covered.
    pub(crate) covers: bool,
}

fn descriptor_type(kind: DrawBindingKind) -> vk::DescriptorType {
    match kind {
        DrawBindingKind::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        DrawBindingKind::Storage => vk::DescriptorType::STORAGE_BUFFER,
        DrawBindingKind::Texture => vk::DescriptorType::SAMPLED_IMAGE,
        DrawBindingKind::Sampler => vk::DescriptorType::SAMPLER,
    }
}

impl Program {
    pub(crate) fn new(device: &Arc<Device>, shader: &'static DrawShader, passes: u32) -> Result<Self, Error> {
        let count = passes.max(1) * u32::try_from(FRAMES_IN_FLIGHT).unwrap_or(1);
        let mut program = Self {
            device: device.clone(),
            shader,
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            pool: vk::DescriptorPool::null(),
            sets: Vec::new(),
            pipelines: Vec::new(),
        };
        let bindings: Vec<_> = shader
            .bindings
            .iter()
            .map(|b| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(b.index)
                    .descriptor_count(1)
                    .descriptor_type(descriptor_type(b.kind))
                    .stage_flags(STAGES)
            })
            .collect();
        let sizes: Vec<_> = shader
            .bindings
            .iter()
            .map(|b| vk::DescriptorPoolSize::default().ty(descriptor_type(b.kind)).descriptor_count(count))
            .collect();
        let immediates = [vk::PushConstantRange::default()
            .stage_flags(vk::ShaderStageFlags::VERTEX)
            .size(shader.immediate_size)];
        let immediates = if shader.immediate_size > 0 { &immediates[..] } else { &[] };
        let raw = &device.raw;
        // SAFETY: the create-infos are complete and live until the calls return; `Drop` destroys what was made.
        unsafe {
            let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            program.set_layout = raw
                .create_descriptor_set_layout(&create, None)
                .map_err(call("vkCreateDescriptorSetLayout"))?;
            let layouts = vec![program.set_layout; count as usize];
            let create = vk::PipelineLayoutCreateInfo::default()
                .set_layouts(&layouts[..1])
                .push_constant_ranges(immediates);
            program.layout =
                raw.create_pipeline_layout(&create, None).map_err(call("vkCreatePipelineLayout"))?;
            let create = vk::DescriptorPoolCreateInfo::default().max_sets(count).pool_sizes(&sizes);
            program.pool =
                raw.create_descriptor_pool(&create, None).map_err(call("vkCreateDescriptorPool"))?;
            let allocate =
                vk::DescriptorSetAllocateInfo::default().descriptor_pool(program.pool).set_layouts(&layouts);
            program.sets =
                raw.allocate_descriptor_sets(&allocate).map_err(call("vkAllocateDescriptorSets"))?;
        }
        for set in &program.sets {
            device.name(*set, shader.name);
        }
        Ok(program)
    }

    /// The descriptor set of a pass.
    pub(crate) fn set(&self, SetIndex { slot, pass }: SetIndex) -> vk::DescriptorSet {
        let passes = self.sets.len() / FRAMES_IN_FLIGHT;
        self.sets.get(slot * passes + pass).copied().unwrap_or_default()
    }

    /// Fills every binding of a pass with what `resource` gives for its name.
    ///
    /// The set must not be in use: the frame that had its slot was waited for.
    pub(crate) fn bind(
        &self,
        index: SetIndex,
        resource: impl Fn(&str) -> Option<Resource>,
    ) -> Result<(), Error> {
        for binding in self.shader.bindings {
            let Some(resource) = resource(binding.name) else {
                return Err(Error::NoBuffer { shader: self.shader.name, binding: binding.name });
            };
            let write = vk::WriteDescriptorSet::default()
                .dst_set(self.set(index))
                .dst_binding(binding.index)
                .descriptor_type(descriptor_type(binding.kind));
            let (buffer, image);
            let write = match resource {
                Resource::Buffer(raw) => {
                    buffer = [vk::DescriptorBufferInfo::default().buffer(raw).range(vk::WHOLE_SIZE)];
                    write.buffer_info(&buffer)
                }
                Resource::Texture(view, layout) => {
                    image = [vk::DescriptorImageInfo::default().image_view(view).image_layout(layout)];
                    write.image_info(&image)
                }
                Resource::Sampler(sampler) => {
                    image = [vk::DescriptorImageInfo::default().sampler(sampler)];
                    write.image_info(&image)
                }
            };
            // SAFETY: the set is not in use, and what is bound outlives the submission.
            unsafe { self.device.raw.update_descriptor_sets(&[write], &[]) };
        }
        Ok(())
    }

    fn module(&self, entry: &'static str, view_mask: u32) -> Result<vk::ShaderModule, Error> {
        let missing = Error::NoBuffer { shader: self.shader.name, binding: entry };
        let entry = self.shader.entry(entry).ok_or(missing)?;
        let code = entry.one_eye.filter(|_| view_mask == 0).unwrap_or(entry.spirv);
        #[cfg(feature = "hot-reload")]
        let compiled = self.reloaded(entry.name, view_mask)?;
        #[cfg(feature = "hot-reload")]
        let code = compiled.as_deref().unwrap_or(code);
        let create = vk::ShaderModuleCreateInfo::default().code(code);
        // SAFETY: the SPIR-V was validated when the crate was built.
        Ok(unsafe { self.device.raw.create_shader_module(&create, None) }
            .map_err(call("vkCreateShaderModule"))?)
    }

    /// The code of an entry point, compiled again if `GAITWAY_SHADERS` names a folder that has the shader.
    #[cfg(feature = "hot-reload")]
    fn reloaded(&self, name: &str, view_mask: u32) -> Result<Option<Vec<u32>>, Error> {
        use crate::kernels::compile::{Source, compile};
        let Some(folder) = gpu::arithmetic::shader_folder() else { return Ok(None) };
        let file = folder.join("draw").join(self.shader.name).with_extension("wgsl");
        if !file.is_file() {
            return Ok(None);
        }
        let source = Source::read(&file, &folder.join("shared"), 0).map_err(gpu::Error::from)?;
        let found = compile(&source).map_err(gpu::Error::from)?.entries;
        let found = found.into_iter().find(|entry| entry.name == name);
        Ok(found.map(|entry| entry.one_eye.filter(|_| view_mask == 0).unwrap_or(entry.spirv)))
    }

    /// Makes a pipeline, which lives as long as the program.
    pub(crate) fn pipeline(&mut self, spec: &PipelineSpec) -> Result<vk::Pipeline, Error> {
        let vertex = self.module(spec.vertex, spec.view_mask)?;
        let fragment = spec.fragment.map(|entry| self.module(entry, spec.view_mask)).transpose();
        let made = match fragment {
            Ok(fragment) => {
                let made = self.create(spec, vertex, fragment.unwrap_or_default());
                // SAFETY: pipelines do not need their modules once they are made.
                unsafe { self.device.raw.destroy_shader_module(fragment.unwrap_or_default(), None) };
                made
            }
            Err(error) => Err(error),
        };
        // SAFETY: as above.
        unsafe { self.device.raw.destroy_shader_module(vertex, None) };
        let pipeline = made?;
        self.pipelines.push(pipeline);
        self.device.name(pipeline, spec.vertex);
        Ok(pipeline)
    }

    fn create(
        &self,
        spec: &PipelineSpec,
        vertex: vk::ShaderModule,
        fragment: vk::ShaderModule,
    ) -> Result<vk::Pipeline, Error> {
        let names = [spec.vertex, spec.fragment.unwrap_or_default()]
            .map(|name| CString::new(name).unwrap_or_default());
        let stage = |flag, module, name| {
            vk::PipelineShaderStageCreateInfo::default().stage(flag).module(module).name(name)
        };
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, vertex, &names[0]),
            stage(vk::ShaderStageFlags::FRAGMENT, fragment, &names[1]),
        ];
        let stages = if spec.fragment.is_some() { &stages[..] } else { &stages[..1] };
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default(); // shaders pull from storage buffers
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(spec.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .line_width(1.0);
        let multisample = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(spec.samples)
            .alpha_to_coverage_enable(spec.covers && spec.samples != vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(spec.has_depth)
            .depth_write_enable(spec.write_depth)
            .depth_compare_op(spec.compare);
        let rgb = vk::ColorComponentFlags::R | vk::ColorComponentFlags::G | vk::ColorComponentFlags::B;
        let written = if spec.covers { rgb } else { vk::ColorComponentFlags::RGBA };
        let attachment = [vk::PipelineColorBlendAttachmentState::default()
            .blend_enable(spec.blend)
            .src_color_blend_factor(vk::BlendFactor::SRC_ALPHA)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .src_alpha_blend_factor(vk::BlendFactor::ZERO)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE)
            .color_write_mask(written)];
        let has_color = spec.fragment.is_some() && spec.color_format != vk::Format::UNDEFINED;
        let attachment = if has_color { &attachment[..] } else { &[] };
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(attachment);
        let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
        let formats = [spec.color_format];
        let formats = if has_color { &formats[..] } else { &[] };
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(formats)
            .depth_attachment_format(if spec.has_depth { DEPTH_FORMAT } else { vk::Format::UNDEFINED })
            .view_mask(spec.view_mask);
        let create = [vk::GraphicsPipelineCreateInfo::default()
            .stages(stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(self.layout)
            .push_next(&mut rendering)];
        // SAFETY: every state that the pipeline needs is given and lives until the call returns.
        let made =
            unsafe { self.device.raw.create_graphics_pipelines(self.device.cache.raw(), &create, None) };
        let made =
            made.map_err(|(_, result)| gpu::Error::Call { call: "vkCreateGraphicsPipelines", result })?;
        Ok(made.first().copied().unwrap_or_default())
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: the renderer waits for its submissions; null handles are ignored.
        unsafe {
            for pipeline in self.pipelines.drain(..) {
                raw.destroy_pipeline(pipeline, None);
            }
            raw.destroy_descriptor_pool(self.pool, None);
            raw.destroy_pipeline_layout(self.layout, None);
            raw.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}
