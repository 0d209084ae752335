//! What is computed between two statements. Two elements of a buffer that lie one behind the other are read together.

use super::Writer;
use super::function::Function;
use super::place::{Root, Step};
use naga::{AddressSpace, BinaryOperator, Expression, GlobalVariable, Handle, Literal, TypeInner};
use std::collections::BTreeMap;
use std::fmt::Write as _;

impl<'m> Writer<'m> {
    /// Writes expressions.
    pub(super) fn emit(
        &mut self,
        f: &mut Function<'m>,
        expressions: &[Handle<Expression>],
        mask: &str,
    ) -> Result<(), String> {
        let mut read = BTreeMap::new();
        for &expression in expressions {
            if let Some(behind) =
                expressions.iter().find(|other| f.is_behind(self.module, expression, **other))
            {
                read.insert(expression, *behind);
            }
        }
        let mut known: BTreeMap<_, String> = BTreeMap::new();
        for &expression in expressions {
            if self.is_pointer(f, expression) {
                continue;
            }
            if let Some(behind) = read.get(&expression)
                && !known.contains_key(&expression)
                && let Some([first, second]) = self.fetch_two(f, expression, mask)?
            {
                known.insert(expression, first);
                known.insert(*behind, second);
            }
            let value = match known.remove(&expression) {
                Some(text) => text,
                None => self.expression(f, expression, mask)?,
            };
            let _ = writeln!(f.text, "let e{} = {value};", expression.index());
        }
        Ok(())
    }

    /// Reads an element of a buffer and the one behind it, where these are at most four words without a gap. The text of each.
    fn fetch_two(
        &mut self,
        f: &mut Function<'m>,
        load: Handle<Expression>,
        mask: &str,
    ) -> Result<Option<[String; 2]>, String> {
        let Expression::Load { pointer } = f.body.expressions[load] else { return Ok(None) };
        let place = self.place(f, pointer)?;
        let (Root::Global(handle), [Step::By(_)]) = (place.root, place.steps.as_slice()) else {
            return Ok(None);
        };
        let ty = self.root_type(f, place.root)?;
        let stride = match self.module.types[ty].inner {
            TypeInner::Array { stride, .. } => stride / 4,
            _ => return Ok(None),
        };
        let span = self.span(ty, &place.steps)?;
        let size = self.size(&span.ty)?;
        if size != stride || size > 2 {
            return Ok(None);
        }
        let (buffer, both) = (self.global(handle), format!("both{}", load.index()));
        let _ = writeln!(
            f.text,
            "let {both} = two_rows::<{size}, {}>(cx.{buffer}, {}, {mask});",
            2 * size,
            span.index(0)
        );
        let [first, second] =
            [0, size].map(|at| self.assemble(&span.ty, at, &|word| format!("{both}[{word}]")));
        Ok(Some([first?, second?]))
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

    /// Whether the second expression reads the element behind the one that the first reads.
    fn is_behind(
        &self,
        module: &naga::Module,
        first: Handle<Expression>,
        second: Handle<Expression>,
    ) -> bool {
        let [Some((buffer, index)), Some((other, next))] =
            [first, second].map(|one| self.element_of_buffer(module, one))
        else {
            return false;
        };
        let Expression::Binary { op: BinaryOperator::Add, left, right } = self.body.expressions[next] else {
            return false;
        };
        first < second
            && buffer == other
            && left == index
            && self.body.expressions[right] == Expression::Literal(Literal::U32(1))
    }
}
