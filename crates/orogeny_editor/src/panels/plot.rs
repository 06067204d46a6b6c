//! Small plots: values from left to right, as a line or as columns.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, Ui, Vec2, pos2};

/// Room for what stands beside and below a plot.
const MARGIN: Vec2 = Vec2::new(58.0, 16.0);

/// How values are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    /// A line from each to the next.
    Line,
    /// A column for each, from 0 up.
    Columns,
}

/// What is plotted.
#[derive(Debug, Clone)]
pub(super) struct Plot<'a> {
    /// What it is called by those who read the window aloud.
    pub(super) name: &'a str,
    pub(super) values: &'a [f64],
    pub(super) style: Style,
    /// What stands at the left and at the right end.
    pub(super) ends: [String; 2],
    /// What stands beside the lowest and the highest value; `None`: nothing.
    pub(super) unit: Option<&'a str>,
}

impl Plot<'_> {
    /// Draws it as wide as there is room, and tells what lies under the pointer, which is 0 at its left end and 1 at its right end.
    pub(super) fn show(&self, ui: &mut Ui, height: f32, told: impl Fn(f64) -> String) {
        let size = egui::vec2(ui.available_width().max(80.0), height.max(40.0));
        let (room, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, self.name));
        let left = if self.unit.is_some() { MARGIN.x } else { 4.0 };
        let rect = Rect::from_min_max(room.min + egui::vec2(left, 4.0), room.max - egui::vec2(4.0, MARGIN.y));
        let visuals = ui.visuals();
        let (text, line) = (visuals.weak_text_color(), visuals.selection.bg_fill.gamma_multiply(1.3));
        let painter = ui.painter();
        painter.rect_filled(rect, 2.0, visuals.extreme_bg_color);
        let (low, high) = self.range();
        let at = |index: usize, value: f64| {
            let along = index as f32 / (self.values.len().max(2) - 1) as f32;
            let up = ((value - low) / (high - low)) as f32;
            pos2(rect.left() + along * rect.width(), rect.bottom() - up * rect.height())
        };
        match self.style {
            Style::Line => {
                let points: Vec<Pos2> =
                    self.values.iter().enumerate().map(|(index, value)| at(index, *value)).collect();
                painter.line(points, Stroke::new(1.5, line));
            }
            Style::Columns => {
                let width = rect.width() / self.values.len().max(1) as f32;
                for (index, value) in self.values.iter().enumerate() {
                    let x = rect.left() + index as f32 * width;
                    let top = at(index, *value).y;
                    let column = Rect::from_min_max(pos2(x, top), pos2(x + width, rect.bottom()));
                    painter.rect_filled(column, 0.0, line);
                }
            }
        }
        let font = FontId::proportional(11.0);
        if let Some(unit) = self.unit {
            for (value, align, y) in
                [(high, Align2::RIGHT_TOP, rect.top()), (low, Align2::RIGHT_BOTTOM, rect.bottom())]
            {
                let label = format!("{value:.1}{unit}");
                painter.text(pos2(rect.left() - 4.0, y), align, label, font.clone(), text);
            }
        }
        let [first, last] = &self.ends;
        let below = rect.bottom() + 2.0;
        painter.text(pos2(rect.left(), below), Align2::LEFT_TOP, first, font.clone(), text);
        painter.text(pos2(rect.right(), below), Align2::RIGHT_TOP, last, font.clone(), text);
        if let Some(pointer) = response.hover_pos().filter(|pointer| rect.contains(*pointer)) {
            painter.vline(pointer.x, rect.y_range(), Stroke::new(1.0, Color32::from_gray(150)));
            let share = (pointer.x - rect.left()) / rect.width();
            // Beside the line, on the side with more room.
            let (align, by) = if share > 0.5 { (Align2::RIGHT_TOP, -6.0) } else { (Align2::LEFT_TOP, 6.0) };
            let place = pos2(pointer.x + by, rect.top() + 3.0);
            painter.text(place, align, told(f64::from(share)), font, visuals.strong_text_color());
        }
    }

    /// The lowest and the highest value that there is room for; never the same.
    fn range(&self) -> (f64, f64) {
        let high = self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let low = match self.style {
            Style::Line => self.values.iter().copied().fold(f64::INFINITY, f64::min),
            Style::Columns => 0.0,
        };
        if high - low > 1.0e-6 { (low, high) } else { (low - 0.5, low + 0.5) }
    }
}
