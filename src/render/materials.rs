//! Materials with textures on the device, as `shaders/shared/textured.wgsl` looks them up.

use super::Error;
use super::commands::Submitter;
use super::pipelines::Resource;
use super::textures::{Coding, Textures};
use crate::avatar::{Textured, TexturedMaterial};
use crate::gpu::{Buffer, Device, call};
use crate::kernels::layout::TexturedMatter;
use ash::vk;
use std::sync::Arc;

/// What a material without a texture has for its layer.
const NO_LAYER: u32 = u32::MAX;

/// Materials and their textures.
pub(super) struct Materials {
    matters: Buffer,
    colors: Textures,
    maps: Textures,
    sampler: Sampler,
}

impl Materials {
    /// # Errors
    /// When there are more textures than the device takes, or memory is short.
    pub(super) fn new(submitter: &Submitter, textured: &Textured) -> Result<Self, Error> {
        let matters: Vec<TexturedMatter> = textured.materials.iter().map(matter).collect();
        Ok(Self {
            matters: submitter.upload("materials", bytemuck::cast_slice(&matters))?,
            colors: Textures::new(submitter, "textures of colours", &textured.colors, Coding::Srgb)?,
            maps: Textures::new(submitter, "textures of numbers", &textured.maps, Coding::Linear)?,
            sampler: Sampler::new(submitter.device())?,
        })
    }

    /// What the binding of that name is filled with; none where it is no material's.
    pub(super) fn find(&self, name: &str) -> Option<Resource> {
        match name {
            "matters" => Some(Resource::Buffer(self.matters.raw)),
            "color_layers" => Some(self.colors.resource()),
            "map_layers" => Some(self.maps.resource()),
            "layer_sampler" => Some(Resource::Sampler(self.sampler.raw)),
            _ => None,
        }
    }
}

fn matter(material: &TexturedMaterial) -> TexturedMatter {
    let layer = |layer: Option<u32>| layer.unwrap_or(NO_LAYER);
    TexturedMatter {
        glow: material.glow.extend(0.0).to_array(),
        cutoff: material.cutoff,
        roughness: material.roughness,
        metal: material.metal,
        slope: material.normal.map_or(0.0, |(_, scale)| scale),
        shade: material.occlusion.map_or(0.0, |(_, strength)| strength),
        color: layer(material.color),
        rough: layer(material.rough),
        normal: layer(material.normal.map(|(layer, _)| layer)),
        occlusion: layer(material.occlusion.map(|(layer, _)| layer)),
        is_blended: u32::from(material.is_blended),
        is_two_sided: u32::from(material.is_two_sided),
        ..TexturedMatter::default()
    }
}

/// How textures are looked up: between texels and levels, repeated beyond their edges.
struct Sampler {
    device: Arc<Device>,
    raw: vk::Sampler,
}

impl Sampler {
    fn new(device: &Arc<Device>) -> Result<Self, Error> {
        let create = vk::SamplerCreateInfo::default()
            .mag_filter(vk::Filter::LINEAR)
            .min_filter(vk::Filter::LINEAR)
            .mipmap_mode(vk::SamplerMipmapMode::LINEAR)
            .max_lod(vk::LOD_CLAMP_NONE);
        // SAFETY: the create-info is complete; `Drop` destroys the sampler.
        let raw = unsafe { device.raw.create_sampler(&create, None) }.map_err(call("vkCreateSampler"))?;
        Ok(Self { device: device.clone(), raw })
    }
}

impl Drop for Sampler {
    fn drop(&mut self) {
        // SAFETY: the renderer that owns the pass waits for its submissions.
        unsafe { self.device.raw.destroy_sampler(self.raw, None) };
    }
}
