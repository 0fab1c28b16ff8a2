//! Plots of what a protocol found, as SVG and PNG.

use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use thiserror::Error;

/// Width and height of a plot (pixels).
const SIZE: (u32, u32) = (900, 600);
/// Letters: PNG has none of its own, and SVG is laid out with the same.
const LETTERS: &[u8] = include_bytes!("../../fonts/DejaVuSans-subset.ttf");
const FAMILY: &str = "sans-serif";
const TITLE_HEIGHT: u32 = 22;
const LETTER_HEIGHT: u32 = 16;
/// Room at the ends of an axis, as a share of what it shows.
const MARGIN: f64 = 0.06;
const INK: RGBColor = RGBColor(0x2b, 0x2b, 0x2b);
const GRID: RGBColor = RGBColor(0xe3, 0xe0, 0xd8);
const PAPER: RGBColor = RGBColor(0xfb, 0xfa, 0xf7);
/// Told apart by those, too, who see few colours (Okabe and Ito 2008).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
];

/// A plot of one quantity over another.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// What the axes are, with units: to the right, and up.
    pub axes: [String; 2],
    /// What is in it.
    pub series: Vec<PlotSeries>,
}

/// Points, or a line, of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotSeries {
    /// What they are; not told where it is empty.
    pub name: String,
    /// Single points.
    pub points: Vec<PlotPoint>,
    /// Corners of a line.
    pub line: Vec<[f64; 2]>,
}

/// A point with what is uncertain about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotPoint {
    /// Where it is.
    pub at: [f64; 2],
    /// From where to where it may be, upwards.
    pub interval: Option<[f64; 2]>,
}

/// Why a plot cannot be made.
#[derive(Debug, Error)]
#[error("cannot draw the plot \"{title}\": {reason}")]
pub struct PlotError {
    title: String,
    reason: String,
}

impl Plot {
    /// As an SVG document.
    ///
    /// # Errors
    /// A number that is not finite, or nothing to show.
    pub fn svg(&self) -> Result<String, PlotError> {
        let mut text = String::new();
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        self.draw(&area)?;
        drop(area);
        Ok(text)
    }

    /// As a PNG file.
    ///
    /// # Errors
    /// As for [`svg`](Self::svg).
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        let mut pixels = vec![0; 3 * (SIZE.0 * SIZE.1) as usize];
        let area = BitMapBackend::with_buffer(&mut pixels, SIZE).into_drawing_area();
        self.draw(&area)?;
        drop(area);
        let mut file = vec![];
        let mut encoder = png::Encoder::new(&mut file, SIZE.0, SIZE.1);
        encoder.set_color(png::ColorType::Rgb);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
        written.map_err(|error| self.error(&error))?;
        Ok(file)
    }

    /// The upper corner of what is shown where less is drawn.
    fn free_corner(&self, across: &std::ops::Range<f64>, up: &std::ops::Range<f64>) -> SeriesLabelPosition {
        let middle = |range: &std::ops::Range<f64>| 0.5 * (range.start + range.end);
        let points = |series: &PlotSeries| series.points.iter().map(|point| point.at).collect::<Vec<_>>();
        let drawn = self.series.iter().flat_map(|series| points(series).into_iter().chain(series.line.clone()));
        let upper = drawn.filter(|at| at[1] > middle(up));
        let (left, right): (Vec<_>, Vec<_>) = upper.partition(|at| at[0] < middle(across));
        if left.len() > right.len() { SeriesLabelPosition::UpperRight } else { SeriesLabelPosition::UpperLeft }
    }

    fn error(&self, reason: &dyn std::fmt::Display) -> PlotError {
        PlotError { title: self.title.clone(), reason: reason.to_string() }
    }

    /// Every place along an axis that must be shown.
    fn places(&self, axis: usize) -> impl Iterator<Item = f64> {
        self.series.iter().flat_map(move |series| {
            let intervals = series.points.iter().filter_map(move |point| point.interval.filter(|_| axis == 1));
            let points = series.points.iter().map(|point| point.at);
            points.chain(series.line.iter().copied()).map(move |at| at[axis]).chain(intervals.flatten())
        })
    }

    fn range(&self, axis: usize) -> Result<std::ops::Range<f64>, PlotError> {
        if let Some(odd) = self.places(axis).find(|place| !place.is_finite()) {
            return Err(self.error(&format!("{} is {odd}", self.axes[axis])));
        }
        let (low, high) = (self.places(axis).reduce(f64::min), self.places(axis).reduce(f64::max));
        let (Some(low), Some(high)) = (low, high) else { return Err(self.error(&"there is nothing to show")) };
        let room = MARGIN * (high - low).max(1e-9 * high.abs()).max(1e-12);
        // Times and lengths begin at nothing.
        let low = if axis == 1 && low >= 0.0 { 0.0 } else { low - room };
        Ok(low..high + room)
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), PlotError> {
        static REGISTERED: Once = Once::new();
        // It is refused only where it is no font.
        REGISTERED.call_once(|| drop(register_font(FAMILY, FontStyle::Normal, LETTERS)));
        let (across, up) = (self.range(0)?, self.range(1)?);
        self.paint(area, across, up).map_err(|error| self.error(&error))
    }

    fn paint<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        across: std::ops::Range<f64>,
        up: std::ops::Range<f64>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.fill(&PAPER)?;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FAMILY, TITLE_HEIGHT).into_font().color(&INK))
            .margin(14)
            .x_label_area_size(48)
            .y_label_area_size(64)
            .build_cartesian_2d(across.clone(), up.clone())?;
        chart
            .configure_mesh()
            .x_desc(&self.axes[0])
            .y_desc(&self.axes[1])
            .axis_style(INK)
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .label_style((FAMILY, LETTER_HEIGHT).into_font().color(&INK))
            .draw()?;
        for (series, colour) in self.series.iter().zip(COLOURS.iter().cycle()) {
            let line = series.line.iter().map(|&[x, y]| (x, y));
            let drawn = chart.draw_series(LineSeries::new(line, colour.stroke_width(2)))?;
            if !series.name.is_empty() {
                let mark = move |(x, y)| Rectangle::new([(x, y - 4), (x + 14, y + 4)], colour.filled());
                drawn.label(&series.name).legend(mark);
            }
            let bars = series.points.iter().filter_map(|point| point.interval.map(|[low, high]| (point.at, low, high)));
            let bar = |([x, _], low, high): ([f64; 2], f64, f64)| {
                PathElement::new(vec![(x, low), (x, high)], colour.stroke_width(2))
            };
            chart.draw_series(bars.map(bar))?;
            let discs = series.points.iter().map(|point| Circle::new((point.at[0], point.at[1]), 5, colour.filled()));
            chart.draw_series(discs)?;
        }
        if self.series.iter().any(|series| !series.name.is_empty()) {
            chart
                .configure_series_labels()
                .position(self.free_corner(&across, &up))
                .background_style(PAPER.mix(0.8))
                .label_font((FAMILY, LETTER_HEIGHT).into_font().color(&INK))
                .draw()?;
        }
        area.present()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let point = |x: f64| PlotPoint { at: [x, 0.1 + 0.15 * x], interval: Some([0.15 * x, 0.2 + 0.15 * x]) };
        let points = PlotSeries { name: "means".into(), points: [1.5, 3.0, 4.5].map(point).to_vec(), line: vec![] };
        let line = PlotSeries { name: String::new(), points: vec![], line: vec![[1.0, 0.25], [5.0, 0.85]] };
        let axes = ["index of difficulty, bit", "movement time, s"].map(String::from);
        Plot { title: "Fitts' law <F1>".into(), axes, series: vec![points, line] }
    }

    #[test]
    fn a_plot_has_its_points_lines_and_words() {
        let svg = plot().svg().unwrap();
        assert_eq!(svg.matches("<circle").count(), 3, "{svg}");
        assert!(
            svg.contains("index of difficulty, bit") && svg.contains("movement time, s") && svg.contains("means"),
            "{svg}"
        );
        assert!(svg.contains("&lt;F1&gt;") && !svg.contains("<F1>"), "{svg}");
    }

    #[test]
    fn names_of_series_stand_where_little_is_drawn() {
        let name_at = |falls: bool| {
            let mut plot = plot();
            for series in plot.series.iter_mut().filter(|_| falls) {
                series.points.iter_mut().for_each(|point| (point.at[1], point.interval) = (1.0 - point.at[1], None));
                series.line.iter_mut().for_each(|at| at[1] = 1.0 - at[1]);
            }
            let svg = plot.svg().unwrap();
            let before = &svg[..svg.find("means").unwrap()];
            let x = before.rsplit("<text x=\"").next().unwrap().split('"').next().unwrap();
            x.parse::<u32>().unwrap()
        };
        assert!(name_at(false) < SIZE.0 / 2 && name_at(true) > SIZE.0 / 2, "{} {}", name_at(false), name_at(true));
    }

    #[test]
    fn pixels_are_a_png_in_which_something_is_drawn() {
        let file = plot().png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((frame.width, frame.height), SIZE);
        let of = |colour: RGBColor| pixels.chunks(3).filter(|pixel| *pixel == [colour.0, colour.1, colour.2]).count();
        // Three discs, a line across, and letters, on paper.
        assert!(of(COLOURS[0]) > 150 && of(COLOURS[1]) > 500 && of(INK) > 500 && of(PAPER) > 300_000);
    }

    #[test]
    fn what_is_no_number_is_not_drawn() {
        let mut odd = plot();
        odd.series[0].points[1].at[1] = f64::NAN;
        let error = odd.svg().unwrap_err().to_string();
        assert_eq!(error, "cannot draw the plot \"Fitts' law <F1>\": movement time, s is NaN");
        odd.series.clear();
        assert!(odd.png().unwrap_err().to_string().contains("there is nothing to show"));
    }
}
