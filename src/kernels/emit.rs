//! naga's module as SPIR-V.

use super::spirv;
use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{BuiltIn, Expression, FunctionArgument, Literal, Module, ShaderStage};

/// The SPIR-V of a module of functions alone: a library of operations (see `link`).
#[allow(dead_code, reason = "build.rs compiles the libraries")]
pub(crate) fn library(text: &str) -> Result<Vec<u32>, String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    words(&module, &info.map_err(|error| error.emit_to_string(text))?, None)
}

/// The SPIR-V of an entry point: of several phases in a file each has only what it needs.
pub(super) fn entry(module: &Module, info: &ModuleInfo, index: usize) -> Result<Vec<u32>, String> {
    if module.entry_points.len() == 1 || module.entry_points[index].stage != ShaderStage::Compute {
        return emit(module, info, index);
    }
    let mut module = module.clone();
    module.entry_points = vec![module.entry_points.swap_remove(index)];
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    let info = Validator::new(ValidationFlags::all(), Capabilities::IMMEDIATES).validate(&module);
    emit(&module, &info.map_err(|error| error.to_string())?, 0)
}

/// The SPIR-V of an entry point that reads `view_index`, with 0 in its place; none for one that does not.
///
/// A shader that reads the number of the eye needs a device with multiview, even when it draws one eye only.
pub(super) fn one_eye(module: &Module, index: usize) -> Result<Option<Vec<u32>>, String> {
    let is_eye = |a: &FunctionArgument| a.binding == Some(naga::Binding::BuiltIn(BuiltIn::ViewIndex));
    let arguments = &module.entry_points[index].function.arguments;
    let Some(eye) = arguments.iter().position(is_eye) else { return Ok(None) };
    let mut module = module.clone();
    let function = &mut module.entry_points[index].function;
    function.arguments.remove(eye);
    let eye = u32::try_from(eye).map_err(|error| error.to_string())?;
    for (_, expression) in function.expressions.iter_mut() {
        match expression {
            Expression::FunctionArgument(number) if *number == eye => {
                *expression = Expression::Literal(Literal::U32(0));
            }
            Expression::FunctionArgument(number) if *number > eye => *number -= 1,
            _ => {}
        }
    }
    // the other entry points may still have it
    module.entry_points = vec![module.entry_points.swap_remove(index)];
    let info = Validator::new(ValidationFlags::all(), Capabilities::IMMEDIATES).validate(&module);
    let info = info.map_err(|error| format!("without view_index: {error}"))?;
    emit(&module, &info, 0).map(Some)
}

/// The SPIR-V of one entry point, with the choices this project has measured.
fn emit(module: &Module, info: &ModuleInfo, index: usize) -> Result<Vec<u32>, String> {
    let point = &module.entry_points[index];
    let pipeline = spv::PipelineOptions { shader_stage: point.stage, entry_point: point.name.clone() };
    words(module, info, Some(&pipeline))
}

fn words(
    module: &Module,
    info: &ModuleInfo,
    pipeline: Option<&spv::PipelineOptions>,
) -> Result<Vec<u32>, String> {
    let restrict = BoundsCheckPolicy::Restrict; // costs nothing measurable, and no index can leave its buffer
    let options = spv::Options {
        lang_version: (1, 3),
        flags: spv::WriterFlags::DEBUG, // names for captures; without ADJUST_COORDINATE_SPACE, which flips y
        fake_missing_bindings: false,
        binding_map: module
            .global_variables
            .iter()
            .filter_map(|(_, variable)| variable.binding)
            .map(|b| {
                (b, spv::BindingInfo { descriptor_set: b.group, binding: b.binding, ..Default::default() })
            })
            .collect(),
        bounds_check_policies: BoundsCheckPolicies {
            index: restrict,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: restrict,
            binding_array: restrict,
        },
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None, // kernels write first
        force_loop_bounding: false, // every loop has an integer bound of its own; a counter costs time
        ..Default::default()
    };
    let words = spv::write_vec(module, info, &options, pipeline).map_err(|error| error.to_string())?;
    Ok(spirv::leave_arrays_unset(&spirv::strip_private_layout(&spirv::no_contraction(&words))))
}
