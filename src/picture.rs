//! A picture in memory.

/// A picture: eight bits a channel, red, green, blue, alpha, sRGB, rows from the top, no padding.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height * 4` bytes.
    pub pixels: Vec<u8>,
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Image")
            .field("width", &self.width)
            .field("height", &self.height)
            .finish_non_exhaustive()
    }
}

impl Image {
    /// A picture of one colour.
    pub fn filled(width: u32, height: u32, color: [u8; 4]) -> Self {
        let count = width as usize * height as usize;
        Self { width, height, pixels: color.repeat(count) }
    }

    /// The colour of a pixel, `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        self.offset(x, y).and_then(|at| self.pixels.get(at..at + 4)?.try_into().ok())
    }

    /// Sets a pixel; nothing happens outside.
    pub fn set(&mut self, x: u32, y: u32, color: [u8; 4]) {
        if let Some(pixel) = self.offset(x, y).and_then(|at| self.pixels.get_mut(at..at + 4)) {
            pixel.copy_from_slice(&color);
        }
    }

    /// Fills a rectangle; what lies outside is left out.
    pub fn fill(&mut self, left: u32, top: u32, width: u32, height: u32, color: [u8; 4]) {
        for y in top..top.saturating_add(height).min(self.height) {
            for x in left..left.saturating_add(width).min(self.width) {
                self.set(x, y, color);
            }
        }
    }

    /// Copies `other` into this picture with its top left corner at (`left`, `top`); what lies outside is left out.
    pub fn blit(&mut self, other: &Self, left: u32, top: u32) {
        if left >= self.width {
            return;
        }
        let bytes = other.width.min(self.width - left) as usize * 4;
        for y in 0..other.height.min(self.height.saturating_sub(top)) {
            let (Some(to), Some(from)) = (self.offset(left, top + y), other.offset(0, y)) else { return };
            if let (Some(to), Some(from)) =
                (self.pixels.get_mut(to..to + bytes), other.pixels.get(from..from + bytes))
            {
                to.copy_from_slice(from);
            }
        }
    }

    fn offset(&self, x: u32, y: u32) -> Option<usize> {
        (x < self.width && y < self.height).then(|| (y as usize * self.width as usize + x as usize) * 4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_rectangles_and_pictures_land_where_asked_and_stop_at_the_border() {
        let mut image = Image::filled(4, 3, [1; 4]);
        image.set(3, 2, [2; 4]);
        image.set(4, 0, [9; 4]);
        image.fill(0, 0, 2, 1, [3; 4]);
        image.fill(3, 0, u32::MAX, 1, [4; 4]);
        image.blit(&Image::filled(9, 9, [5; 4]), 2, 1);
        assert_eq!(image.pixel(1, 0), Some([3; 4]));
        assert_eq!(image.pixel(2, 0), Some([1; 4]));
        assert_eq!(image.pixel(3, 0), Some([4; 4]));
        assert_eq!(image.pixel(1, 1), Some([1; 4]));
        assert_eq!(image.pixel(2, 1), Some([5; 4]));
        assert_eq!(image.pixel(4, 0), None);
        assert_eq!(image.pixels.len(), 48);
    }
}
