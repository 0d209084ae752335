//! Where barriers stand in a list of dispatches: derived from what each kernel reads and writes.

pub use crate::kernels::Op;
use crate::kernels::{Access, BufferId, Extent};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// One thing recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Everything written before is visible to everything after.
    Barrier,
    /// An operation and its place in the list.
    Op(usize, Op),
}

/// What has been touched since the last barrier.
#[derive(Debug, Default)]
pub struct Hazards {
    read: BTreeSet<BufferId>,
    written: BTreeSet<BufferId>,
}

impl Hazards {
    /// Notes the next operation; true if a barrier must stand before it.
    pub fn touch(&mut self, reads: &[BufferId], writes: &[BufferId]) -> bool {
        let after_write = reads.iter().chain(writes).any(|buffer| self.written.contains(buffer));
        let after_read = writes.iter().any(|buffer| self.read.contains(buffer));
        let barrier = after_write || after_read;
        if barrier {
            self.read.clear();
            self.written.clear();
        }
        self.read.extend(reads);
        self.written.extend(writes);
        barrier
    }
}

/// Buffers that an operation reads and writes.
fn touched(op: Op) -> (Vec<BufferId>, Vec<BufferId>) {
    match op {
        Op::Set(buffer) => (Vec::new(), vec![buffer]),
        Op::CountStep => (Vec::new(), Vec::new()), // the count is a word of `step`
        Op::Dispatch(dispatch) => {
            let entry = dispatch.phase.entry();
            let of = |write: bool| {
                let bindings = entry.bindings.iter().filter(move |b| (b.access == Access::Write) == write);
                bindings.map(|b| b.buffer.home()).collect::<Vec<_>>()
            };
            let mut reads = of(false);
            if let Extent::Indirect(buffer, _) = dispatch.extent {
                reads.push(buffer);
            }
            (reads, of(true))
        }
    }
}

/// Puts the barriers into a list of operations.
pub fn plan(ops: &[Op]) -> Vec<Command> {
    let mut hazards = Hazards::default();
    let mut commands = Vec::with_capacity(ops.len() * 2);
    for (index, op) in ops.iter().enumerate() {
        let (reads, writes) = touched(*op);
        if hazards.touch(&reads, &writes) {
            commands.push(Command::Barrier);
        }
        commands.push(Command::Op(index, *op));
    }
    commands
}

/// The plan as text, one command a line.
pub fn text(commands: &[Command]) -> String {
    let mut text = String::new();
    for command in commands {
        let _ = match command {
            Command::Barrier => writeln!(text, "barrier"),
            Command::Op(_, Op::Set(buffer)) => writeln!(text, "set {}", buffer.name()),
            Command::Op(_, Op::CountStep) => writeln!(text, "count step"),
            Command::Op(_, Op::Dispatch(dispatch)) => {
                let entry = dispatch.phase.entry();
                match &entry.immediate {
                    Some(immediate) => {
                        writeln!(text, "{} {}", entry.label, immediate.text(dispatch.immediate))
                    }
                    None => writeln!(text, "{}", entry.label),
                }
            }
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::Dispatch;
    use crate::kernels::Phase;

    #[test]
    fn a_barrier_stands_wherever_a_pass_meets_what_another_wrote() {
        let dispatch = |phase| Op::Dispatch(Dispatch::of(phase, 1));
        let ops = [
            Op::CountStep,
            dispatch(Phase::AdvanceJourney),
            dispatch(Phase::GridScan),
            dispatch(Phase::GridScatter),
        ];
        assert_eq!(
            text(&plan(&ops)),
            "count step\nadvance_journey\nbarrier\ngrid_scan\nbarrier\ngrid_scatter contents none\n"
        );
    }

    #[test]
    fn who_is_launched_by_counts_waits_for_them() {
        // `pose` binds nothing that the first operation writes: the counts alone make it wait
        let counts = BufferId::DispatchArgs;
        let pose = Phase::Pose;
        assert!(pose.entry().bindings.iter().all(|binding| binding.buffer != counts));
        let launched = |extent| text(&plan(&[Op::Set(counts), Op::Dispatch(Dispatch::new(pose, extent))]));
        assert_eq!(launched(Extent::Indirect(counts, 0)), "set dispatch_args\nbarrier\npose\n");
        assert_eq!(launched(Extent::Invocations(64)), "set dispatch_args\npose\n");
    }

    #[test]
    fn reads_after_reads_need_no_barrier_and_writes_after_reads_do() {
        let (a, b) = (BufferId::Position, BufferId::Velocity);
        let mut hazards = Hazards::default();
        assert!(!hazards.touch(&[a], &[]));
        assert!(!hazards.touch(&[a], &[b]));
        assert!(hazards.touch(&[], &[a]));
        assert!(hazards.touch(&[a], &[]));
    }
}
