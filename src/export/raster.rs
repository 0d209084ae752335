//! SVG into pixels, by resvg (feature `charts`).
//!
//! Figures and captions have one drawing, their SVG. Its text has one embedded font, whatever family the SVG names, so
//! pictures do not depend on the fonts of the machine. A character that the font lacks is an empty box.

use crate::picture::Image;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Source};
use std::sync::{Arc, LazyLock};

/// Nothing of the system: no fonts but Ubuntu Light, which has Latin, Greek and Cyrillic letters.
static OPTIONS: LazyLock<Options<'static>> = LazyLock::new(|| {
    let mut options = Options::default();
    options.fontdb_mut().load_font_source(Source::Binary(Arc::new(epaint_default_fonts::UBUNTU_LIGHT)));
    options.font_resolver.select_font = Box::new(|_, fonts| fonts.faces().next().map(|face| face.id));
    options
});

fn parsed(svg: &str) -> Result<Tree, String> {
    Tree::from_str(svg, &OPTIONS).map_err(|error| error.to_string())
}

/// The picture of an SVG with `scale` pixels for each of its units; the message says why there is none.
pub(super) fn pixels(svg: &str, scale: f32) -> Result<Image, String> {
    let tree = parsed(svg)?;
    let size = tree.size();
    let too_large = || format!("no room for {} x {} units, {scale} pixels each", size.width(), size.height());
    let map = size.to_int_size().scale_by(scale).and_then(|size| Pixmap::new(size.width(), size.height()));
    let mut map = map.ok_or_else(too_large)?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut map.as_mut());
    Ok(Image { width: map.width(), height: map.height(), pixels: map.take_demultiplied() })
}

/// How far to the right the marks of an SVG reach, units.
pub(super) fn reach(svg: &str) -> Result<f32, String> {
    Ok(parsed(svg)?.root().abs_bounding_box().right())
}

/// Left, top, right and bottom of every text of an SVG, units.
#[cfg(test)]
pub(super) fn texts(svg: &str) -> Vec<[f32; 4]> {
    fn of(group: &resvg::usvg::Group) -> Vec<[f32; 4]> {
        group
            .children()
            .iter()
            .flat_map(|node| match node {
                resvg::usvg::Node::Text(text) => {
                    let area = text.abs_bounding_box();
                    vec![[area.left(), area.top(), area.right(), area.bottom()]]
                }
                resvg::usvg::Node::Group(group) => of(group),
                _ => Vec::new(),
            })
            .collect()
    }
    of(parsed(svg).unwrap().root())
}
