//! What is computed between two statements. Elements of a buffer that lie one behind the other are read together.

use super::Writer;
use super::function::Function;
use super::place::{Root, Step};
use naga::{AddressSpace, BinaryOperator, Expression, GlobalVariable, Handle, Literal, TypeInner};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Elements that are read together at most.
const MOST: usize = 4;

impl<'m> Writer<'m> {
    /// Writes expressions.
    pub(super) fn emit(
        &mut self,
        f: &mut Function<'m>,
        expressions: &[Handle<Expression>],
        mask: &str,
    ) -> Result<(), String> {
        let mut known: BTreeMap<_, String> = BTreeMap::new();
        for &expression in expressions {
            if self.is_pointer(f, expression) {
                continue;
            }
            if !known.contains_key(&expression) {
                let run = f.run_of(self.module, expression, expressions);
                if run.len() > 1 {
                    known.extend(self.fetch_run(f, &run, mask)?);
                }
            }
            let value = match known.remove(&expression) {
                Some(text) => text,
                None => self.expression(f, expression, mask)?,
            };
            let _ = writeln!(f.text, "let e{} = {value};", expression.index());
        }
        Ok(())
    }

    /// Reads elements of a buffer that lie one behind the other, where these have no gaps. The text of each.
    fn fetch_run(
        &mut self,
        f: &mut Function<'m>,
        run: &[Handle<Expression>],
        mask: &str,
    ) -> Result<Vec<(Handle<Expression>, String)>, String> {
        let load = run[0];
        let Expression::Load { pointer } = f.body.expressions[load] else { return Ok(Vec::new()) };
        let place = self.place(f, pointer)?;
        let (Root::Global(handle), [Step::By(_)]) = (place.root, place.steps.as_slice()) else {
            return Ok(Vec::new());
        };
        let ty = self.root_type(f, place.root)?;
        let stride = match self.module.types[ty].inner {
            TypeInner::Array { stride, .. } => stride / 4,
            _ => return Ok(Vec::new()),
        };
        let span = self.span(ty, &place.steps)?;
        let size = self.size(&span.ty)?;
        if size != stride || size > 4 {
            return Ok(Vec::new());
        }
        let (buffer, all) = (self.global(handle), format!("all{}", load.index()));
        let count = size as usize * run.len();
        let index = span.index(0);
        let read = match self.kept_words(handle) {
            Some(_) => format!("cx.kept_{buffer}.rows"),
            None => "rows".to_owned(),
        };
        let _ = writeln!(f.text, "let {all} = {read}::<{size}, {count}>(cx.{buffer}, {index}, {mask});");
        let texts = (0..).zip(run).map(|(number, element)| {
            Ok((*element, self.assemble(&span.ty, number * size, &|word| format!("{all}[{word}]"))?))
        });
        texts.collect()
    }
}

impl Function<'_> {
    /// The buffer and the index of an element that an expression reads.
    fn element_of_buffer(
        &self,
        module: &naga::Module,
        expression: Handle<Expression>,
    ) -> Option<(Handle<GlobalVariable>, Handle<Expression>)> {
        let Expression::Load { pointer } = self.body.expressions[expression] else { return None };
        let Expression::Access { base, index } = self.body.expressions[pointer] else { return None };
        let Expression::GlobalVariable(buffer) = self.body.expressions[base] else { return None };
        matches!(module.global_variables[buffer].space, AddressSpace::Storage { .. })
            .then_some((buffer, index))
    }

    /// An expression that reads an element of a buffer, and those that read the elements behind it, in order.
    fn run_of(
        &self,
        module: &naga::Module,
        first: Handle<Expression>,
        among: &[Handle<Expression>],
    ) -> Vec<Handle<Expression>> {
        let mut run = vec![first];
        let behind = |distance| {
            among.iter().copied().find(|other| self.distance(module, first, *other) == Some(distance))
        };
        run.extend((1..MOST as u32).map_while(behind));
        run
    }

    /// How many elements behind the one that the first expression reads lies that which the second reads.
    fn distance(
        &self,
        module: &naga::Module,
        first: Handle<Expression>,
        second: Handle<Expression>,
    ) -> Option<u32> {
        let (buffer, index) = self.element_of_buffer(module, first)?;
        let (other, next) = self.element_of_buffer(module, second)?;
        let Expression::Binary { op: BinaryOperator::Add, left, right } = self.body.expressions[next] else {
            return None;
        };
        match self.body.expressions[right] {
            Expression::Literal(Literal::U32(distance)) => {
                (first < second && buffer == other && left == index).then_some(distance)
            }
            _ => None,
        }
    }
}
