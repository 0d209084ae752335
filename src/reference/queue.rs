//! Moves the queues on.

use crate::kernels::queue::Slices;
use crate::kernels::shared::absent::NOBODY;

/// Twin of `shaders/queue.wgsl`.
pub fn queue(b: Slices<'_>) {
    for line in b.queues.chunks_exact_mut(8).take(b.step.queue_count as usize) {
        let [joins, mut first, next, is_served, served, places, service, _] = *line else { continue };
        if is_served == 1 {
            let mut served = served.wrapping_add(1);
            if served >= service {
                first = first.wrapping_add(1);
                line[1] = first;
                served = 0;
            }
            line[4] = served;
            line[3] = 0;
        }
        if joins != NOBODY {
            if next.wrapping_sub(first) < places {
                b.stage_progress[joins as usize] = next.wrapping_add(1);
                line[2] = next.wrapping_add(1);
            }
            line[0] = NOBODY;
        }
    }
}
