//! Workgroup barriers that some invocations may not reach: naga lets them through, and a GPU hangs there.

use naga::{Block, Function, Module, Span, Statement};

/// The first statement of an entry point or of a function it calls where a barrier stands behind a condition, or behind
/// something that may have left the code around it; none if there is none.
pub(crate) fn fault(module: &Module) -> Option<Span> {
    let functions = module.functions.iter().map(|(_, function)| function);
    let all = functions.chain(module.entry_points.iter().map(|point| &point.function));
    all.filter_map(|function| block(module, &function.body, false)).next()
}

/// Goes through a block. `in_loop`: it is the body of a loop, whose first statement may be the loop's own condition.
fn block(module: &Module, body: &Block, in_loop: bool) -> Option<Span> {
    let mut may_have_left = false;
    let mut is_first = in_loop;
    for (statement, span) in body.span_iter() {
        if matches!(statement, Statement::Emit(_)) {
            continue;
        }
        let may_be_condition = std::mem::take(&mut is_first);
        let waits = waits(module, statement);
        if waits && may_have_left {
            return Some(*span);
        }
        match statement {
            Statement::If { .. } | Statement::Switch { .. } if waits => return Some(*span),
            Statement::If { .. } | Statement::Switch { .. } => {
                may_have_left |= leaves(statement, may_be_condition);
            }
            Statement::Block(inner) => {
                if let Some(found) = block(module, inner, may_be_condition) {
                    return Some(found);
                }
                may_have_left |= leaves(statement, may_be_condition);
            }
            Statement::Loop { body, continuing, .. } => {
                let found = block(module, body, true).or_else(|| block(module, continuing, false));
                if found.is_some() {
                    return found;
                }
                may_have_left |= returns(statement);
            }
            _ => {}
        }
    }
    None
}

/// Whether a statement waits at a barrier, by itself or in what it calls.
fn waits(module: &Module, statement: &Statement) -> bool {
    let in_function = |function: &Function| any(&function.body, &|inner| waits(module, inner));
    match statement {
        Statement::ControlBarrier(_) | Statement::WorkGroupUniformLoad { .. } => true,
        Statement::Call { function, .. } => in_function(&module.functions[*function]),
        _ => inside(statement, &|inner| waits(module, inner)),
    }
}

/// Whether a statement may leave the code around it: return, or break or continue a loop unless it is that loop's condition.
fn leaves(statement: &Statement, is_condition: bool) -> bool {
    match statement {
        Statement::Break | Statement::Continue => !is_condition,
        // what breaks an inner loop stays here
        Statement::Loop { .. } => returns(statement),
        _ => returns(statement) || inside(statement, &|inner| leaves(inner, is_condition)),
    }
}

fn returns(statement: &Statement) -> bool {
    matches!(statement, Statement::Return { .. }) || inside(statement, &returns)
}

fn any(block: &Block, wanted: &dyn Fn(&Statement) -> bool) -> bool {
    block.iter().any(wanted)
}

/// Whether one of the statements directly inside a statement is wanted.
fn inside(statement: &Statement, wanted: &dyn Fn(&Statement) -> bool) -> bool {
    match statement {
        Statement::Block(inner) => any(inner, wanted),
        Statement::If { accept, reject, .. } => any(accept, wanted) || any(reject, wanted),
        Statement::Switch { cases, .. } => cases.iter().any(|case| any(&case.body, wanted)),
        Statement::Loop { body, continuing, .. } => any(body, wanted) || any(continuing, wanted),
        _ => false,
    }
}

/// What [`fault`] must find, and what it must let through, as the body of an entry point. Compared when the crate is built.
#[allow(dead_code, reason = "build.rs compares them")]
pub(crate) const EXAMPLES: [(&str, bool); 9] = [
    ("workgroupBarrier();", false),
    ("wait();", false),
    ("for (var i = 0u; i < 4u; i++) { wait(); }", false),
    ("if lane > 3u { count = 1u; } wait(); if lane > 3u { return; }", false),
    ("if lane > 3u { workgroupBarrier(); }", true),
    ("if lane > 3u { wait(); }", true),
    ("if lane > 3u { return; } wait();", true),
    ("for (var i = 0u; i < 4u; i++) { if lane > 3u { break; } wait(); }", true),
    ("for (var i = 0u; i < 4u; i++) { if lane > 3u { return; } } wait();", true),
];

/// Whether [`fault`] tells the examples apart; else the one where it fails.
#[allow(dead_code, reason = "build.rs asks")]
pub(crate) fn examples() -> Result<(), String> {
    for (body, is_fault) in EXAMPLES {
        let text = format!(
            "var<workgroup> count: u32; fn wait() {{ workgroupBarrier(); }} @compute @workgroup_size(64) \
             fn main(@builtin(local_invocation_index) lane: u32) {{ {body} }}"
        );
        let module = naga::front::wgsl::parse_str(&text).map_err(|error| error.emit_to_string(&text))?;
        if fault(&module).is_some() != is_fault {
            return Err(format!("src/kernels/barriers.rs: wrong about `{body}`"));
        }
    }
    Ok(())
}
