//! Whether a device's arithmetic is exact: found out at start-up, because it decides what agreement to expect.

use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine, Error};
use crate::kernels::{BufferId, Extent, KernelId, Pass, Store};
use std::sync::Arc;

/// Cases that the probe tries.
pub const CASES: u32 = 65_536;

/// What a device's arithmetic does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numerics {
    /// Every result of the probe has the bits of the correctly rounded one: CPU and device agree bit for bit.
    pub exact: bool,
    /// Largest error of a division in units in the last place.
    pub division_ulp: u32,
    /// Largest error of a square root in units in the last place.
    pub square_root_ulp: u32,
    /// Results that differ, of all.
    pub different: u32,
}

impl std::fmt::Display for Numerics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.exact {
            return f.write_str("exact");
        }
        let Self { division_ulp, square_root_ulp, different, .. } = self;
        let all = CASES * 16;
        write!(
            f,
            "{different} of {all} results differ (division {division_ulp} ULP, square root {square_root_ulp} ULP)"
        )
    }
}

/// Distance in units in the last place between floats of the same sign.
fn ulps(a: f32, b: f32) -> u32 {
    let order = |x: f32| {
        let bits = x.to_bits();
        if bits >> 31 == 1 { !bits } else { bits | 0x8000_0000 }
    };
    if a.is_nan() || b.is_nan() { u32::MAX } else { order(a).abs_diff(order(b)) }
}

/// Runs the probe on a device and compares with the CPU.
///
/// # Errors
/// When the device fails.
pub fn numerics(device: &Arc<Device>) -> Result<Numerics, Error> {
    let mut want = Store { numerics_in: crate::reference::probe_cases(CASES), ..Store::default() };
    want.numerics_out = vec![[0.0; 4]; want.numerics_in.len() * 4];
    let mut engine = Engine::new(device, &want, &[KernelId::Numerics])?;
    let pass = Pass { kernel: KernelId::Numerics, level: 0, extent: Extent::Invocations(CASES) };
    engine.run(&[Op::Pass(pass)], |_, _| Vec::new(), false)?;
    let mut got = want.clone();
    engine.download(&mut got, &[BufferId::NumericsOut])?;
    crate::reference::run(KernelId::Numerics, &mut want, 0);
    let mut found = Numerics { exact: true, division_ulp: 0, square_root_ulp: 0, different: 0 };
    for (index, (w, g)) in want.numerics_out.iter().zip(&got.numerics_out).enumerate() {
        for lane in 0..4 {
            found.different += u32::from(w[lane].to_bits() != g[lane].to_bits());
        }
        if index % 4 == 0 {
            found.division_ulp = found.division_ulp.max(ulps(w[0], g[0]));
            found.square_root_ulp = found.square_root_ulp.max(ulps(w[1], g[1]));
        }
    }
    found.exact = found.different == 0;
    Ok(found)
}
