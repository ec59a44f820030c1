//! [`Chart`]: curves, bands and measured points over two axes, as SVG.

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// One axis: its label and what it shows.
pub(crate) struct Axis {
    pub(crate) label: String,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// Something to draw, in the order of the legend. What lies outside the axes is cut off.
pub(crate) enum Series {
    Curve {
        name: String,
        points: Vec<(f64, f64)>,
    },
    /// Between the lower and the upper values at each x.
    Band {
        name: String,
        bounds: Vec<(f64, f64, f64)>,
    },
    Points {
        name: String,
        points: Vec<(f64, f64)>,
    },
}

impl Series {
    fn count(&self, is_in: impl Fn(f64, f64) -> bool) -> usize {
        match self {
            Self::Curve { points, .. } | Self::Points { points, .. } => {
                points.iter().filter(|(x, y)| is_in(*x, *y)).count()
            }
            Self::Band { bounds, .. } => {
                bounds.iter().filter(|(x, low, high)| is_in(*x, *low) || is_in(*x, *high)).count()
            }
        }
    }
}

pub(crate) struct Chart {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
}

const SIZE: (u32, u32) = (720, 480);
const COLOURS: [RGBColor; 8] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 39, 40),
    RGBColor(44, 160, 44),
    RGBColor(148, 103, 189),
    RGBColor(255, 127, 14),
    RGBColor(140, 86, 75),
    RGBColor(23, 190, 207),
    RGBColor(90, 90, 90),
];

type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

impl Axis {
    pub(crate) fn new(label: &str, from: f64, to: f64) -> Self {
        Self { label: label.to_string(), from, to }
    }
}

impl Chart {
    pub(crate) fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self { title: title.to_string(), x, y, series: Vec::new() }
    }

    pub(crate) fn curve(mut self, name: &str, points: Vec<(f64, f64)>) -> Self {
        self.series.push(Series::Curve { name: name.to_string(), points });
        self
    }

    pub(crate) fn band(mut self, name: &str, bounds: Vec<(f64, f64, f64)>) -> Self {
        self.series.push(Series::Band { name: name.to_string(), bounds });
        self
    }

    pub(crate) fn points(mut self, name: &str, points: Vec<(f64, f64)>) -> Self {
        self.series.push(Series::Points { name: name.to_string(), points });
        self
    }

    pub(crate) fn to_svg(&self) -> Result<String> {
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        // The error borrows the drawing area.
        let drawn = self.draw(&area).map_err(|error| anyhow!("drawing {}: {error}", self.title));
        let presented = area.present().map_err(|error| anyhow!("drawing {}: {error}", self.title));
        drop(area);
        drawn.and(presented)?;
        Ok(svg)
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Box<dyn std::error::Error>> {
        let failed = |error: DrawingAreaErrorKind<std::io::Error>| error.to_string();
        area.fill(&WHITE).map_err(failed)?;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 18))
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(64)
            .build_cartesian_2d(self.x.from..self.x.to, self.y.from..self.y.to)
            .map_err(failed)?;
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14));
        mesh.max_light_lines(0).draw().map_err(failed)?;
        for (index, series) in self.series.iter().enumerate() {
            let colour = COLOURS[index % COLOURS.len()];
            self.add(&mut chart, series, colour).map_err(failed)?;
        }
        let mut legend = chart.configure_series_labels();
        legend.background_style(WHITE.mix(0.85)).border_style(BLACK.mix(0.4)).label_font(("sans-serif", 13));
        legend.position(self.emptiest_corner()).draw().map_err(failed)?;
        Ok(())
    }

    fn add(
        &self,
        chart: &mut Context<'_, '_>,
        series: &Series,
        colour: RGBColor,
    ) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
        let line = colour.stroke_width(2);
        match series {
            Series::Curve { name, points } => {
                for (index, part) in self.parts_inside(points).into_iter().enumerate() {
                    let drawn = chart.draw_series(LineSeries::new(part, line))?;
                    if index == 0 {
                        drawn.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], line));
                    }
                }
            }
            Series::Band { name, bounds } => {
                let clamped = |y: f64| y.clamp(self.y.from, self.y.to);
                let upper = bounds.iter().map(|(x, _, high)| (*x, clamped(*high)));
                let lower = bounds.iter().rev().map(|(x, low, _)| (*x, clamped(*low)));
                let outline: Vec<_> = upper.chain(lower).collect();
                let fill = colour.mix(0.18).filled();
                let drawn = chart.draw_series([Polygon::new(outline, fill)])?;
                drawn.label(name).legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 18, y + 5)], fill));
            }
            Series::Points { name, points } => {
                let inside = points.iter().copied().filter(|point| self.holds(*point));
                let drawn = chart.draw_series(inside.map(|point| Circle::new(point, 3, colour.filled())))?;
                drawn.label(name).legend(move |(x, y)| Circle::new((x + 9, y), 3, colour.filled()));
            }
        }
        Ok(())
    }

    /// Where the legend covers the fewest points.
    fn emptiest_corner(&self) -> SeriesLabelPosition {
        let corners = [
            (SeriesLabelPosition::UpperRight, true, true),
            (SeriesLabelPosition::UpperLeft, false, true),
            (SeriesLabelPosition::LowerRight, true, false),
            (SeriesLabelPosition::LowerLeft, false, false),
        ];
        let part = |value: f64, axis: &Axis| (value - axis.from) / (axis.to - axis.from);
        let covered = |is_right: bool, is_upper: bool| {
            let is_in = |x: f64, y: f64| {
                let (x, y) = (part(x, &self.x), part(y, &self.y));
                (if is_right { x > 0.6 } else { x < 0.4 }) && (if is_upper { y > 0.65 } else { y < 0.35 })
            };
            self.series.iter().map(|series| series.count(is_in)).sum::<usize>()
        };
        let least = corners.into_iter().min_by_key(|(_, is_right, is_upper)| covered(*is_right, *is_upper));
        least.map_or(SeriesLabelPosition::UpperRight, |(position, _, _)| position)
    }

    fn holds(&self, (x, y): (f64, f64)) -> bool {
        (self.x.from..=self.x.to).contains(&x) && (self.y.from..=self.y.to).contains(&y)
    }

    /// The stretches of a curve within the axes.
    fn parts_inside(&self, points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let parts = points.split(|point| !self.holds(*point));
        parts.filter(|part| part.len() > 1).map(<[_]>::to_vec).collect()
    }
}
