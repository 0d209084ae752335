//! What the compiler knows about a text: which comparisons are of floats.

use naga::proc::TypeResolution;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{BinaryOperator, Expression, Function, ScalarKind, Span, TypeInner};
use std::ops::Range;

/// Where the operators of comparisons of floats stand, bytes.
pub(crate) fn floats(text: &str) -> Result<Vec<Range<usize>>, String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.message().to_owned())?;
    let capabilities = Capabilities::IMMEDIATES | Capabilities::MULTIVIEW;
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|error| error.to_string())?;
    let mut found = Vec::new();
    let mut look = |function: &Function, info: &naga::valid::FunctionInfo| {
        for (handle, expression) in function.expressions.iter() {
            let Expression::Binary { op, left, right } = expression else { continue };
            let inner = match &info[*left].ty {
                TypeResolution::Handle(ty) => &module.types[*ty].inner,
                TypeResolution::Value(inner) => inner,
            };
            let scalar = match inner {
                TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } => *scalar,
                _ => continue,
            };
            if is_order(*op) && scalar.kind == ScalarKind::Float {
                let span = |handle| function.expressions.get_span(handle);
                found.extend(between(span(handle), span(*left), span(*right)));
            }
        }
    };
    for (handle, function) in module.functions.iter() {
        look(function, &info[handle]);
    }
    for (index, point) in module.entry_points.iter().enumerate() {
        look(&point.function, info.get_entry_point(index));
    }
    Ok(found)
}

fn is_order(op: BinaryOperator) -> bool {
    use BinaryOperator::{Greater, GreaterEqual, Less, LessEqual};
    matches!(op, Less | LessEqual | Greater | GreaterEqual)
}

/// What of an expression is neither of its sides. A name's span is where it was defined: then the whole counts.
fn between(whole: Span, left: Span, right: Span) -> Option<Range<usize>> {
    let [whole, left, right] = [whole, left, right].map(Span::to_range);
    let whole = whole?;
    let begin = left.map(|left| left.end).filter(|end| whole.contains(end)).unwrap_or(whole.start);
    let end = right.map(|right| right.start).filter(|start| whole.contains(start)).unwrap_or(whole.end);
    (begin < end).then_some(begin..end)
}
