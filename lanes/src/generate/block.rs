//! Statements. Each block has a mask: the lanes that run it.

use super::Writer;
use super::function::{Enclosing, Function, continues, count_returns, leaves};
use super::types::Kind;
use naga::{AtomicFunction, Block, Expression, Handle, Statement, SwitchCase, SwitchValue};
use std::fmt::Write as _;

impl<'m> Writer<'m> {
    /// Writes the statements of a block, which runs for the lanes of a mask. Afterwards the mask has those that reached its end.
    pub(super) fn block(&mut self, f: &mut Function<'m>, block: &'m Block, mask: &str) -> Result<(), String> {
        let mut open = 0;
        let mut expressions = Vec::new();
        for (at, statement) in block.iter().enumerate() {
            if let Statement::Emit(range) = statement {
                expressions.extend(range.clone());
                if matches!(block.get(at + 1), Some(Statement::Emit(_))) {
                    continue; // what is computed without a statement in between is written together
                }
            }
            let emitted = std::mem::take(&mut expressions);
            self.emit(f, &emitted, mask)?;
            let may_leave = self.statement(f, statement, mask)?;
            if may_leave && at + 1 < block.len() {
                let _ = writeln!(f.text, "{mask} = {mask}{}; if {mask}.any() {{", f.staying());
                open += 1;
            }
        }
        f.text.push_str(&"}\n".repeat(open));
        if open > 0 {
            let _ = writeln!(f.text, "{mask} = {mask}{};", f.staying());
        }
        Ok(())
    }

    /// A block within the present one, on a path of its own.
    fn inner_block(&mut self, f: &mut Function<'m>, block: &'m Block, mask: &str) -> Result<(), String> {
        f.path.push(std::ptr::from_ref(block));
        let done = self.block(f, block, mask);
        f.path.pop();
        done
    }

    /// Writes a statement. Whether lanes may leave the block in it.
    fn statement(
        &mut self,
        f: &mut Function<'m>,
        statement: &'m Statement,
        mask: &str,
    ) -> Result<bool, String> {
        match statement {
            Statement::Emit(_) => {} // by the block
            Statement::Block(block) => {
                self.block(f, block, mask)?; // in the same scope
                return Ok(leaves(block));
            }
            Statement::If { condition, accept, reject } => {
                self.choose(f, *condition, [accept, reject], mask)?;
                return Ok(leaves(accept) || leaves(reject));
            }
            Statement::Loop { body, continuing, break_if } => {
                return self.repeat(f, body, continuing, *break_if, mask);
            }
            Statement::Switch { selector, cases } => return self.switch(f, *selector, cases, mask),
            Statement::Break => match f.enclosing.last() {
                Some(Enclosing::Loop { number, .. } | Enclosing::Switch { number }) => {
                    let _ = writeln!(f.text, "in{number} = in{number}.andnot({mask});");
                }
                None => return Err("a break outside of a loop".to_owned()),
            },
            Statement::Continue => {
                let Some(number) = f.enclosing.iter().rev().find_map(|one| match one {
                    Enclosing::Loop { number, .. } => Some(number),
                    Enclosing::Switch { .. } => None,
                }) else {
                    return Err("a continue outside of a loop".to_owned());
                };
                let _ = writeln!(f.text, "turn{number} = turn{number}.andnot({mask});");
            }
            Statement::Return { value } => {
                if let Some(value) = value {
                    let text = self.value(f, *value)?;
                    let text = match &f.body.result {
                        Some(result) if f.returns_early => self.pick(result.ty, mask, &text, "result")?,
                        _ => text,
                    };
                    let _ = writeln!(f.text, "result = {text};");
                }
                if f.returns_early {
                    let _ = writeln!(f.text, "live = live.andnot({mask});");
                }
            }
            Statement::Store { pointer, value } => {
                let value = self.value(f, *value)?;
                let is_whole = match f.body.expressions[*pointer] {
                    Expression::LocalVariable(local) => {
                        if f.same.counts(local) {
                            let _ = writeln!(f.text, "n{} = {value}.lane();", local.index());
                        }
                        if !f.same.is_by_lane(local) {
                            return Ok(false);
                        }
                        f.scopes.get(&local).is_some_and(|scope| scope.begins_whole && scope.path == f.path)
                    }
                    _ => false,
                };
                self.store(f, *pointer, &value, mask, is_whole)?;
            }
            Statement::Atomic { pointer, fun, value, result } => {
                self.atomic(f, *pointer, *fun, *value, *result, mask)?;
            }
            Statement::Call { function, arguments, result } => {
                self.call(f, *function, arguments, *result, mask)?;
            }
            Statement::ControlBarrier(_)
            | Statement::MemoryBarrier(_)
            | Statement::WorkGroupUniformLoad { .. } => {
                return Err("a barrier".to_owned());
            }
            _ => return Err("a texture, a subgroup, a ray, or what draws,".to_owned()),
        }
        Ok(false)
    }

    /// An `if`: each side for its lanes. Where the condition is the same in all lanes, all go one way, by a branch of the processor.
    fn choose(
        &mut self,
        f: &mut Function<'m>,
        condition: Handle<Expression>,
        [accept, reject]: [&'m Block; 2],
        mask: &str,
    ) -> Result<(), String> {
        let number = f.name();
        let is_same = f.same.has(condition);
        if is_same {
            let text = self.truth(f, condition)?;
            let _ = writeln!(f.text, "let same{number} = {text};");
        }
        let value = self.value(f, condition)?;
        for (block, name, how, not) in [(accept, "yes", "and", ""), (reject, "no", "andnot", "!")] {
            if block.is_empty() {
                continue;
            }
            let own = format!("{name}{number}");
            let _ = if is_same {
                writeln!(f.text, "let mut {own} = {mask}; if {not}same{number} {{")
            } else {
                writeln!(f.text, "let mut {own} = {mask}.{how}({value}); if {own}.any() {{")
            };
            self.inner_block(f, block, &own)?;
            f.text.push_str("}\n");
        }
        Ok(())
    }

    /// A loop: `in` are the lanes that go round, `turn` those that are in this turn.
    fn repeat(
        &mut self,
        f: &mut Function<'m>,
        body: &'m Block,
        continuing: &'m Block,
        break_if: Option<Handle<Expression>>,
        mask: &str,
    ) -> Result<bool, String> {
        let number = f.name();
        let has_continue = continues(body);
        let returns = count_returns(body) > 0;
        let _ = writeln!(f.text, "let mut in{number} = {mask}; loop {{ if !in{number}.any() {{ break; }}");
        if has_continue {
            let _ = writeln!(f.text, "let mut turn{number} = in{number};");
        }
        let _ = writeln!(f.text, "let mut body{number} = in{number};");
        f.enclosing.push(Enclosing::Loop { number, continues: has_continue });
        self.inner_block(f, body, &format!("body{number}"))?;
        f.enclosing.pop();
        if returns {
            let _ = writeln!(f.text, "in{number} = in{number}.and(live);");
        }
        let _ = writeln!(f.text, "let mut next{number} = in{number};");
        self.inner_block(f, continuing, &format!("next{number}"))?;
        if let Some(condition) = break_if {
            let condition = self.value(f, condition)?;
            let _ = writeln!(f.text, "in{number} = in{number}.andnot({condition});");
        }
        f.text.push_str("}\n");
        Ok(returns)
    }

    /// A switch: `in` are the lanes that have not left it, `left` those that no case has taken, `fall` those that go on into the next.
    fn switch(
        &mut self,
        f: &mut Function<'m>,
        selector: Handle<Expression>,
        cases: &'m [SwitchCase],
        mask: &str,
    ) -> Result<bool, String> {
        let number = f.name();
        let selector = self.value(f, selector)?;
        let is = |value: &SwitchValue| match value {
            SwitchValue::I32(value) => Some(format!("{selector}.ieq(V::c({value}i32 as u32))")),
            SwitchValue::U32(value) => Some(format!("{selector}.ieq(V::c({value}))")),
            SwitchValue::Default => None,
        };
        let any =
            cases.iter().filter_map(|case| is(&case.value)).reduce(|all, one| format!("{all}.or({one})"));
        let other = any.map_or_else(|| "M::c(true)".to_owned(), |any| format!("{any}.negated()"));
        let _ = writeln!(f.text, "let mut in{number} = {mask}; let mut fall{number} = M::c(false);");
        f.enclosing.push(Enclosing::Switch { number });
        for (at, case) in cases.iter().enumerate() {
            let own = format!("case{number}_{at}");
            let chosen = is(&case.value).unwrap_or_else(|| other.clone());
            let _ = writeln!(
                f.text,
                "let mut {own} = {mask}.and({chosen}).or(fall{number}).and(in{number}); if {own}.any() {{"
            );
            self.inner_block(f, &case.body, &own)?;
            f.text.push_str("}\n");
            let falls = if case.fall_through { own } else { "M::c(false)".to_owned() };
            let _ = writeln!(f.text, "fall{number} = {falls};");
        }
        f.enclosing.pop();
        Ok(cases.iter().any(|case| case_leaves(&case.body)))
    }

    fn atomic(
        &mut self,
        f: &mut Function<'m>,
        pointer: Handle<Expression>,
        fun: AtomicFunction,
        value: Handle<Expression>,
        result: Option<Handle<Expression>>,
        mask: &str,
    ) -> Result<(), String> {
        let signed = self.shape(f, value)?.kind == Kind::Signed;
        let name = match fun {
            AtomicFunction::Add => "add",
            AtomicFunction::Subtract => "sub",
            AtomicFunction::And => "and",
            AtomicFunction::InclusiveOr => "or",
            AtomicFunction::ExclusiveOr => "xor",
            AtomicFunction::Min if signed => "imin",
            AtomicFunction::Min => "umin",
            AtomicFunction::Max if signed => "imax",
            AtomicFunction::Max => "umax",
            AtomicFunction::Exchange { compare: None } => "exchange",
            AtomicFunction::Exchange { compare: Some(_) } => return Err("atomicCompareExchange".to_owned()),
        };
        let value = self.value(f, value)?;
        let (buffer, index) = self.atomic_place(f, pointer)?;
        let bound = result.map_or_else(String::new, |result| format!("let e{} = ", result.index()));
        let _ = writeln!(f.text, "{bound}atomic_{name}(cx.{buffer}, {index}, {value}, {mask});");
        Ok(())
    }
}

/// Whether lanes may leave what is around a switch in one of its cases.
fn case_leaves(block: &Block) -> bool {
    let wrapped = |statement: &Statement| match statement {
        Statement::Break => false,
        Statement::Continue | Statement::Return { .. } => true,
        Statement::Block(block) => case_leaves(block),
        Statement::If { accept, reject, .. } => case_leaves(accept) || case_leaves(reject),
        Statement::Loop { body, continuing, .. } => count_returns(body) + count_returns(continuing) > 0,
        Statement::Switch { cases, .. } => cases.iter().any(|case| case_leaves(&case.body)),
        _ => false,
    };
    block.iter().any(wrapped)
}

impl Function<'_> {
    /// A number for names.
    fn name(&mut self) -> usize {
        self.names += 1;
        self.names
    }

    /// What to add to a mask so that lanes that have left are out.
    fn staying(&self) -> String {
        let mut text = String::new();
        if self.returns_early {
            text.push_str(".and(live)");
        }
        for enclosing in self.enclosing.iter().rev() {
            match enclosing {
                Enclosing::Switch { number } => {
                    let _ = write!(text, ".and(in{number})");
                }
                Enclosing::Loop { number, continues } => {
                    let _ = write!(text, ".and(in{number})");
                    if *continues {
                        let _ = write!(text, ".and(turn{number})");
                    }
                    break;
                }
            }
        }
        text
    }
}
