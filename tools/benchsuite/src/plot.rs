//! Series as SVG: both axes logarithmic, so that a straight line is a power of what is below.

use std::fmt::Write as _;

use crate::report::Series;

const SIZE: [f64; 2] = [640.0, 400.0];
/// Left, top, right, bottom.
const MARGINS: [f64; 4] = [70.0, 40.0, 110.0, 50.0];
/// Told apart by people who see few colours, on light and on dark.
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
const INK: &str = "#767676";

/// Where the values of an axis lie.
struct Axis {
    from: f64,
    to: f64,
    at: [f64; 2],
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, at: [f64; 2]) -> Self {
        let values = values.filter(|value| *value > 0.0);
        let (from, to) =
            values.fold((f64::INFINITY, 0.0_f64), |(from, to), value| (from.min(value), to.max(value)));
        let (from, to) = if from < to { (from, to) } else { (0.5, 2.0) };
        Self { from: from.ln(), to: to.ln(), at }
    }

    /// Whole powers of ten on both ends.
    fn of_tens(values: impl Iterator<Item = f64>, at: [f64; 2]) -> Self {
        let Self { from, to, at } = Self::new(values, at);
        let tens = std::f64::consts::LN_10;
        Self { from: (from / tens).floor() * tens, to: (to / tens).ceil() * tens, at }
    }

    fn place(&self, value: f64) -> f64 {
        let [begin, end] = self.at;
        begin + (value.max(f64::MIN_POSITIVE).ln() - self.from) / (self.to - self.from) * (end - begin)
    }
}

/// A plot of series that belong together: of one title, one unit and one quantity below.
pub fn svg(title: &str, series: &[&Series]) -> String {
    let [width, height] = SIZE;
    let [left, top, right, bottom] = MARGINS;
    let points = || series.iter().flat_map(|series| series.points());
    let x_axis = Axis::new(points().map(|(x, _)| x), [left, width - right]);
    let spreads = points().flat_map(|(_, spread)| [spread.median, spread.lowest, spread.highest]);
    let y_axis = Axis::of_tens(spreads, [height - bottom, top]);
    let mut svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12" fill="{INK}">"#
    );
    let mut add = |element: String| _ = writeln!(svg, "{element}");
    add(String::new());
    add(format!(r#"<text x="{left}" y="20" font-size="15">{title}</text>"#));
    let below = series.first().map_or("", |series| series.x_name());
    add(format!(r#"<text x="{}" y="{}" text-anchor="end">{below}</text>"#, width - right, height - 10.0));
    let mut exponent = (y_axis.from / std::f64::consts::LN_10).round() as i32;
    while f64::from(exponent) * std::f64::consts::LN_10 <= y_axis.to + 1.0e-9 {
        let y = y_axis.place(10.0_f64.powi(exponent));
        add(format!(
            r#"<line x1="{left}" y1="{y:.1}" x2="{}" y2="{y:.1}" stroke="{INK}" stroke-opacity="0.3"/>"#,
            width - right
        ));
        add(format!(
            r#"<text x="{}" y="{:.1}" text-anchor="end">{}</text>"#,
            left - 8.0,
            y + 4.0,
            seconds(exponent)
        ));
        exponent += 1;
    }
    let mut ticks: Vec<_> = points().map(|(x, _)| x).collect();
    ticks.sort_by(f64::total_cmp);
    ticks.dedup();
    for tick in ticks {
        let (x, y) = (x_axis.place(tick), height - bottom);
        add(format!(
            r#"<text x="{x:.1}" y="{:.1}" text-anchor="middle">{}</text>"#,
            y + 18.0,
            thousands(tick)
        ));
    }
    for (series, colour) in series.iter().zip(COLOURS.iter().cycle()) {
        let at = |(x, y): (f64, f64)| format!("{:.1},{:.1}", x_axis.place(x), y_axis.place(y));
        let line: Vec<_> = series.points().map(|(x, spread)| at((x, spread.median))).collect();
        add(format!(
            r#"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="2"/>"#,
            line.join(" ")
        ));
        for (x, spread) in series.points() {
            let x = x_axis.place(x);
            let [low, middle, high] =
                [spread.lowest, spread.median, spread.highest].map(|value| y_axis.place(value));
            add(format!(
                r#"<line x1="{x:.1}" y1="{low:.1}" x2="{x:.1}" y2="{high:.1}" stroke="{colour}" stroke-opacity="0.6"/>"#
            ));
            add(format!(r#"<circle cx="{x:.1}" cy="{middle:.1}" r="3" fill="{colour}"/>"#));
        }
        if let Some((x, spread)) = series.points().last() {
            add(format!(
                r#"<text x="{:.1}" y="{:.1}" fill="{colour}">{}</text>"#,
                x_axis.place(x) + 8.0,
                y_axis.place(spread.median) + 4.0,
                series.name()
            ));
        }
    }
    svg + "</svg>\n"
}

/// A power of ten of seconds, in the unit that people say it in.
fn seconds(exponent: i32) -> String {
    let (unit, smaller) = match exponent {
        0.. => ("s", 0),
        -3..=-1 => ("ms", 3),
        -6..=-4 => ("µs", 6),
        _ => ("ns", 9),
    };
    let value = 10.0_f64.powi(exponent + smaller);
    if value < 1.0 { format!("{value} {unit}") } else { format!("{value:.0} {unit}") }
}

/// 4096 as 4096, 16384 as 16k: of powers of two.
fn thousands(value: f64) -> String {
    match value {
        1_048_576.0.. => format!("{:.0}M", value / 1_048_576.0),
        16_384.0.. => format!("{:.0}k", value / 1024.0),
        _ => format!("{value:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use crate::measure::Spread;
    use crate::report::Unit;

    use super::*;

    #[test]
    fn a_series_is_drawn_whole_and_within_its_axes() {
        let spread = |median: f64| Spread { median, lowest: 0.9 * median, highest: 1.2 * median };
        let points = vec![(8.0, spread(2.0e-6)), (64.0, spread(1.5e-5)), (4096.0, spread(0.03))];
        let series = Series::new("by radius", "raise", "radius", Unit::Seconds, points);
        let drawn = svg("by radius", &[&series]);
        assert_eq!(drawn.matches("<circle").count(), 3);
        for text in ["1 µs", "10 ms", "100 ms", ">4096<", ">raise<", ">by radius<"] {
            assert!(drawn.contains(text), "{text} is not in {drawn}");
        }
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{drawn}");
    }

    #[test]
    fn powers_of_ten_are_said_as_people_say_them() {
        let said: Vec<_> = [1, 0, -1, -3, -4, -7, -9].map(seconds).to_vec();
        assert_eq!(said, ["10 s", "1 s", "100 ms", "1 ms", "100 µs", "100 ns", "1 ns"]);
    }
}
