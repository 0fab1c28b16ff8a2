//! Pixels of a drawing.

use myo::picture::{Colour, Drawing, Shape};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

/// Red, green and blue of every pixel, row by row. The page is centred and as large as fits. Labels are left out: they would
/// not be legible at the sizes that learning programs ask for.
pub fn pixels(drawing: &Drawing, width: usize, height: usize) -> Vec<u8> {
    let mut canvas = Canvas::new(drawing, width, height);
    for shape in &drawing.shapes {
        canvas.draw(shape);
    }
    canvas.pixels()
}

fn color([red, green, blue, alpha]: Colour) -> Color {
    let byte = |x: f64| (255.0 * x) as u8;
    Color::from_rgba8(
        (255.0 * red).round() as u8,
        (255.0 * green).round() as u8,
        (255.0 * blue).round() as u8,
        byte(alpha),
    )
}

/// A picture in the making.
struct Canvas {
    pixmap: Pixmap,
    /// Pixels per metre.
    scale: f64,
}

impl Canvas {
    fn new(drawing: &Drawing, width: usize, height: usize) -> Self {
        let mut pixmap = Pixmap::new(width as u32, height as u32).expect("sizes are checked by the caller");
        pixmap.fill(color(drawing.paper));
        let [page_width, page_height] = drawing.size;
        Self { pixmap, scale: (width as f64 / page_width).min(height as f64 / page_height) }
    }

    fn draw(&mut self, shape: &Shape) {
        match shape {
            Shape::Line { points, width, colour } => self.stroke(self.outline(points, false), *width, *colour),
            Shape::Polygon { points, colour } => self.fill(self.outline(points, true), *colour),
            Shape::Disc { centre, radius, colour } => self.fill(self.circle(*centre, *radius), *colour),
            Shape::Ring { centre, radius, width, colour } => {
                self.stroke(self.circle(*centre, *radius), *width, *colour);
            }
            Shape::Label { .. } => {}
        }
    }

    fn place(&self, [right, up]: [f64; 2]) -> (f32, f32) {
        let (width, height) = (f64::from(self.pixmap.width()), f64::from(self.pixmap.height()));
        ((0.5 * width + self.scale * right) as f32, (0.5 * height - self.scale * up) as f32)
    }

    fn outline(&self, points: &[[f64; 2]], closed: bool) -> Option<Path> {
        let mut path = PathBuilder::new();
        for (k, &point) in points.iter().enumerate() {
            let (x, y) = self.place(point);
            if k == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if closed {
            path.close();
        }
        path.finish()
    }

    fn circle(&self, centre: [f64; 2], radius_m: f64) -> Option<Path> {
        let (x, y) = self.place(centre);
        PathBuilder::from_circle(x, y, (radius_m * self.scale).max(0.5) as f32)
    }

    fn stroke(&mut self, path: Option<Path>, width_m: f64, colour: Colour) {
        let Some(path) = path else { return };
        let width = (width_m * self.scale).max(0.7) as f32;
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixmap.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }

    fn fill(&mut self, path: Option<Path>, colour: Colour) {
        let Some(path) = path else { return };
        self.pixmap.fill_path(&path, &paint(colour), FillRule::Winding, Transform::identity(), None);
    }

    /// The paper is opaque, so no pixel is transparent.
    fn pixels(&self) -> Vec<u8> {
        self.pixmap.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect()
    }
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(color(colour));
    paint
}
