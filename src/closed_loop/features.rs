//! The 29 features of gaits by the kernel `gait_features`, on the device of a simulation or by the CPU twin.

use crate::gait::Gait;
use crate::kernels::gait_features::index::ROW;
use crate::kernels::{Dispatch, KernelId, Phase, Store};
use crate::perception::features::{Batch, FEATURE_COUNT};
use crate::reference;
use crate::sim::{Error, Simulation};

#[cfg(feature = "vulkan")]
use crate::gpu::{Engine, plan::Op};
#[cfg(feature = "vulkan")]
use crate::kernels::BufferId;

/// Features of [`crate::perception::features::Variant::Corrected`], one row per gait, where the simulation runs.
///
/// # Errors
/// When the device fails, or a gait cannot be used: [`Error::Failure`] names the first by its index.
#[doc(hidden)]
pub fn features(gaits: &[&Gait], simulation: &Simulation) -> Result<Vec<[f64; FEATURE_COUNT]>, crate::Error> {
    let batch = Batch::new(gaits).ok_or_else(|| crate::Error::Usage {
        message: format!("{} gaits have more than 2^32 frames", gaits.len()),
        hint: "judge fewer at once".to_owned(),
    })?;
    if gaits.is_empty() {
        return Ok(Vec::new());
    }
    let mut store = Store {
        feature_rows: vec![[0.0; 4]; gaits.len() * ROW],
        failure: vec![u32::MAX; KernelId::ALL.len()],
        gait_frames: batch.frames,
        gait_table: batch.table,
        ..Store::default()
    };
    let count = u32::try_from(gaits.len()).unwrap_or(u32::MAX);
    let dispatch = Dispatch::of(Phase::GaitFeatures, count);
    run(&mut store, dispatch, simulation)?;
    let agent = store.failure[KernelId::GaitFeatures as usize];
    if agent != u32::MAX {
        return Err(Error::Failure { kernel: KernelId::GaitFeatures.kernel().name, agent }.into());
    }
    let row = |row: &[[f32; 4]]| std::array::from_fn(|i| f64::from(row.as_flattened()[i]));
    Ok(store.feature_rows.chunks_exact(ROW).map(row).collect())
}

#[cfg_attr(
    not(feature = "vulkan"),
    allow(clippy::unnecessary_wraps, unused_variables, reason = "as with Vulkan")
)]
fn run(store: &mut Store, dispatch: Dispatch, simulation: &Simulation) -> Result<(), crate::Error> {
    #[cfg(feature = "vulkan")]
    if let Some(of_crowd) = simulation.engine() {
        let mut engine = Engine::new(of_crowd.device(), store, &[dispatch.kernel()])?;
        engine.run(&[Op::Dispatch(dispatch)], |_, _| Vec::new(), false)?;
        engine.download(store, &[BufferId::FeatureRows, BufferId::Failure])?;
        return Ok(());
    }
    reference::run(dispatch.phase, store, dispatch.immediate);
    Ok(())
}
