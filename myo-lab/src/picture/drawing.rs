//! Shapes on a page, from back to front.

use std::fmt::Write;

/// A point of the page (m): to the right and up from its centre.
pub type PagePoint = [f64; 2];

/// Red, green, blue, and how much of it covers what is behind, all from 0 to 1.
pub type Colour = [f64; 4];

/// What is drawn. Lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A line with round ends and corners.
    Line {
        /// Its corners.
        points: Vec<PagePoint>,
        /// How thick it is.
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// A filled polygon.
    Polygon {
        /// Its corners.
        points: Vec<PagePoint>,
        /// Its colour.
        colour: Colour,
    },
    /// A filled circle.
    Disc {
        /// Its centre.
        centre: PagePoint,
        /// Its radius.
        radius: f64,
        /// Its colour.
        colour: Colour,
    },
    /// A circle's outline.
    Ring {
        /// Its centre.
        centre: PagePoint,
        /// Its radius.
        radius: f64,
        /// How thick the line is.
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// A short text, centred.
    Label {
        /// Where.
        centre: PagePoint,
        /// Height of the letters.
        height: f64,
        /// What it says.
        text: String,
        /// Its colour.
        colour: Colour,
    },
}

/// A page of shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height that the page must show (m).
    pub size: [f64; 2],
    /// Its colour, opaque.
    pub paper: Colour,
    /// The shapes, from back to front.
    pub shapes: Vec<Shape>,
}

/// Pixels of an SVG per metre.
const SVG_SCALE: f64 = 580.0;

impl Drawing {
    /// The page as an SVG document.
    pub fn svg(&self) -> String {
        let [width, height] = self.size.map(|length| length * SVG_SCALE);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\">\n\
             <rect width=\"100%\" height=\"100%\" {}/>\n",
            paint("fill", self.paper)
        );
        for shape in &self.shapes {
            self.element(shape, &mut svg).expect("writing to a string");
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn element(&self, shape: &Shape, svg: &mut String) -> std::fmt::Result {
        let px = |length: f64| length * SVG_SCALE;
        match shape {
            Shape::Line { points, width, colour } => writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" {} \
                 stroke-width=\"{:.1}\"/>",
                self.list(points),
                paint("stroke", *colour),
                px(*width)
            ),
            Shape::Polygon { points, colour } => {
                writeln!(svg, "<polygon points=\"{}\" {}/>", self.list(points), paint("fill", *colour))
            }
            Shape::Disc { centre, radius, colour } => {
                let [x, y] = self.svg_point(*centre);
                writeln!(
                    svg,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" {}/>",
                    px(*radius),
                    paint("fill", *colour)
                )
            }
            Shape::Ring { centre, radius, width, colour } => {
                let [x, y] = self.svg_point(*centre);
                writeln!(
                    svg,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"none\" {} stroke-width=\"{:.1}\"/>",
                    px(*radius),
                    paint("stroke", *colour),
                    px(*width)
                )
            }
            Shape::Label { centre, height, text, colour } => {
                let [x, y] = self.svg_point(*centre);
                writeln!(
                    svg,
                    "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{:.0}\" text-anchor=\"middle\" \
                     dominant-baseline=\"central\" {}>{}</text>",
                    px(*height),
                    paint("fill", *colour),
                    escaped(text)
                )
            }
        }
    }

    fn list(&self, points: &[PagePoint]) -> String {
        let points = points.iter().map(|&point| self.svg_point(point));
        points.map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
    }

    fn svg_point(&self, [right, up]: PagePoint) -> [f64; 2] {
        [(0.5 * self.size[0] + right) * SVG_SCALE, (0.5 * self.size[1] - up) * SVG_SCALE]
    }
}

/// The attributes of a colour for `fill` or `stroke`.
fn paint(attribute: &str, [red, green, blue, alpha]: Colour) -> String {
    let byte = |x: f64| (255.0 * x.clamp(0.0, 1.0)).round() as u8;
    let colour = format!("{attribute}=\"#{:02x}{:02x}{:02x}\"", byte(red), byte(green), byte(blue));
    if alpha < 1.0 { format!("{colour} {attribute}-opacity=\"{alpha:.2}\"") } else { colour }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centre_of_the_page_is_the_origin_and_up_is_up() {
        let disc = Shape::Disc { centre: [0.5, 0.25], radius: 0.1, colour: [1.0, 0.0, 0.0, 0.5] };
        let label = Shape::Label { centre: [0.0, 0.0], height: 0.1, text: "a<b".into(), colour: [0.0, 0.0, 0.0, 1.0] };
        let drawing = Drawing { size: [2.0, 1.0], paper: [1.0; 4], shapes: vec![disc, label] };
        let svg = drawing.svg();
        assert!(svg.contains("viewBox=\"0 0 1160 580\""), "{svg}");
        assert!(
            svg.contains("<circle cx=\"870.0\" cy=\"145.0\" r=\"58.0\" fill=\"#ff0000\" fill-opacity=\"0.50\"/>"),
            "{svg}"
        );
        assert!(svg.contains(">a&lt;b</text>"), "{svg}");
    }
}
