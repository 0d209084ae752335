//! Limits of devices by class: what any pipeline needs is compared with each when the crate is built.

use crate::compile::{Binding, Shader, Source, Use};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What a pipeline binds and takes, and the most that a class of devices gives. Names in brackets are those of
/// `VkPhysicalDeviceLimits`.
const QUANTITIES: [&str; 9] = [
    "storage buffers of a stage",      // maxPerStageDescriptorStorageBuffers
    "uniform buffers of a stage",      // maxPerStageDescriptorUniformBuffers
    "sampled images of a stage",       // maxPerStageDescriptorSampledImages
    "resources of a stage",            // maxPerStageResources
    "bytes of a uniform buffer",       // maxUniformBufferRange
    "bytes of immediates",             // maxPushConstantsSize
    "invocations of a workgroup",      // maxComputeWorkGroupInvocations
    "workgroup's invocations along z", // maxComputeWorkGroupSize[2]
    "bytes of workgroup memory",       // maxComputeSharedMemorySize
];

/// Amounts in the order of [`QUANTITIES`].
type Amounts = [u32; QUANTITIES.len()];

/// Classes of devices. The first row is the specification's own minimum (table "Required Limits"); Android 15 and the
/// roadmap of 2022 are Khronos's profiles over it; on Apple's GPUs Metal has 31 buffers of a stage in all.
const CLASSES: [(&str, Amounts); 4] = [
    ("the Vulkan minimum", [4, 12, 16, 128, 16_384, 128, 128, 64, 16_384]),
    ("Android 15", [12, 13, 128, 128, 16_384, 128, 128, 64, 16_384]),
    ("the roadmap of 2022", [30, 15, 200, 200, 65_536, 128, 256, 64, 16_384]),
    ("MoltenVK on Apple's GPUs", [31, 31, 128, 128, 65_536, 4096, 1024, 1024, 32_768]),
];

/// What is given up knowingly: class, quantity, and the most that shaders may need all the same.
const GIVEN_UP: [(&str, &str, u32); 1] =
    // kernels bind twelve; every device with Vulkan 1.3 that is known gives as many
    [("the Vulkan minimum", "storage buffers of a stage", 12)];

/// Compares every shader with every class, and writes what the most demanding ones need as `NEEDS`.
pub(crate) fn write(
    kernels: &[(Source, Shader)],
    draws: &[(Source, Shader)],
    text: &mut String,
) -> Result<(), String> {
    let mut stages: Vec<(String, Amounts)> = Vec::new();
    for (source, shader) in kernels {
        let of = |entry: &crate::compile::Entry| {
            let amounts = amounts(&entry.bindings, entry.immediate.as_ref().map_or(0, |(_, size)| *size));
            let [x, y, z] = entry.workgroup_size;
            let compute = [x * y * z, z, entry.workgroup_bytes];
            (format!("shaders/{}.wgsl:1: {}", source.name, entry.name), with(amounts, compute))
        };
        stages.extend(shader.entries.iter().map(of));
    }
    for (source, shader) in draws {
        // the layout of a draw shader shows every binding to both stages
        let all: BTreeMap<(u32, u32), Binding> = shader
            .entries
            .iter()
            .flat_map(|e| &e.bindings)
            .map(|b| ((b.group, b.binding), b.clone()))
            .collect();
        let immediate =
            shader.entries.iter().filter_map(|e| e.immediate.as_ref()).map(|(_, size)| *size).max();
        let amounts = amounts(&all.into_values().collect::<Vec<_>>(), immediate.unwrap_or(0));
        stages.push((format!("shaders/draw/{0}.wgsl:1: {0}", source.name), with(amounts, [0; 3])));
    }
    fits(&stages)?;
    let needs: Vec<u32> = (0..QUANTITIES.len())
        .map(|i| stages.iter().map(|(_, amounts)| amounts[i]).max().unwrap_or(0))
        .collect();
    let [
        storage_buffers,
        uniform_buffers,
        sampled_images,
        resources,
        uniform_range,
        immediates,
        invocations,
        _,
        workgroup_memory,
    ] = needs[..]
    else {
        return Err("limits: nine quantities".to_owned());
    };
    let _ = write!(
        text,
        "/// What the most demanding shaders need of a device.\npub const NEEDS: Needs = Needs {{ \
         storage_buffers: {storage_buffers}, uniform_buffers: {uniform_buffers}, sampled_images: {sampled_images}, \
         resources: {resources}, uniform_range: {uniform_range}, immediates: {immediates}, \
         invocations: {invocations}, workgroup_memory: {workgroup_memory} }};\n"
    );
    Ok(())
}

/// The first six quantities.
fn amounts(bindings: &[Binding], immediates: u32) -> [u32; 6] {
    let count = |is: &dyn Fn(Use) -> bool| {
        u32::try_from(bindings.iter().filter(|b| is(b.access)).count()).unwrap_or(u32::MAX)
    };
    let uniforms = bindings.iter().filter(|b| b.access == Use::Uniform);
    [
        count(&|access| matches!(access, Use::Read | Use::Write)),
        count(&|access| access == Use::Uniform),
        count(&|access| access == Use::Texture),
        count(&|_| true),
        uniforms.map(|b| b.stride).max().unwrap_or(0),
        immediates,
    ]
}

fn with([a, b, c, d, e, f]: [u32; 6], [g, h, i]: [u32; 3]) -> Amounts {
    [a, b, c, d, e, f, g, h, i]
}

/// Every stage fits every class, but for what is given up; and nothing is given up for nothing.
fn fits(stages: &[(String, Amounts)]) -> Result<(), String> {
    let mut errors = Vec::new();
    for (class, limits) in CLASSES {
        for (i, quantity) in QUANTITIES.into_iter().enumerate() {
            let given_up = GIVEN_UP.iter().find(|(c, q, _)| *c == class && *q == quantity);
            let limit = given_up.map_or(limits[i], |(_, _, most)| *most);
            for (stage, amounts) in stages.iter().filter(|(_, amounts)| amounts[i] > limit) {
                errors.push(format!(
                    "{stage} needs {} {quantity}, and {class} has {limit}: devices of that class are left behind",
                    amounts[i]
                ));
            }
            if given_up.is_some() && stages.iter().all(|(_, amounts)| amounts[i] <= limits[i]) {
                errors.push(format!(
                    "build/limits.rs: nothing needs more {quantity} than {class} has: drop it from GIVEN_UP"
                ));
            }
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(errors.join("\n")) }
}
