//! Curves: drawn, dragged by their points, typed in a table, or taken from a few shapes.

use egui::{CollapsingHeader, DragValue, Key, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use orogeny_engine::{Curve, MAX_CURVE_POINTS, Parameter};
use serde_json::{Value, json};

use crate::command::{capitalised, words};

/// How near to a point the pointer takes it, in points of the screen.
const REACH: f32 = 9.0;
/// Steps that a curve is drawn in.
const NUM_STEPS: u16 = 96;
/// The least distance of two points along x, as a share of all of it.
const MIN_GAP: f64 = 1.0e-3;
/// The height of the picture, in points of the screen.
const HEIGHT: f32 = 130.0;
/// Decimals of what is dragged.
const DECIMALS: f64 = 1000.0;

/// A shape to begin with: its points, with x and y from 0 to 1.
type Shape = (&'static str, &'static [[f64; 2]]);

const SHAPES: [Shape; 8] = [
    ("Line", &[[0.0, 0.0], [1.0, 1.0]]),
    ("Line down", &[[0.0, 1.0], [1.0, 0.0]]),
    ("Full", &[[0.0, 1.0], [1.0, 1.0]]),
    ("Late", &[[0.0, 0.0], [0.5, 0.15], [0.8, 0.5], [1.0, 1.0]]),
    ("Early", &[[0.0, 0.0], [0.2, 0.5], [0.5, 0.85], [1.0, 1.0]]),
    ("S", &[[0.0, 0.0], [0.25, 0.1], [0.5, 0.5], [0.75, 0.9], [1.0, 1.0]]),
    ("Hill", &[[0.0, 0.0], [0.25, 0.5], [0.5, 1.0], [0.75, 0.5], [1.0, 0.0]]),
    ("Steps", &[[0.0, 0.0], [0.3, 0.0], [0.36, 0.5], [0.64, 0.5], [0.7, 1.0], [1.0, 1.0]]),
];

/// Where a curve may lie, and what of it is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    x: (f64, f64),
    y: (f64, f64),
    /// What of y is seen.
    seen: (f64, f64),
    rect: Rect,
}

impl Frame {
    fn new((x, y): ((f64, f64), (f64, f64)), points: &[[f64; 2]], rect: Rect) -> Self {
        // Of a wide range, what is like the x at first, and whatever the points reach beyond.
        let ys = || points.iter().map(|[_, y]| *y);
        let low = ys().fold(x.0.max(y.0), f64::min);
        let high = ys().fold(x.1.min(y.1), f64::max);
        Self { x, y, seen: (low, high.max(low + 1.0e-6)), rect }
    }

    fn to_screen(self, [x, y]: [f64; 2]) -> Pos2 {
        let share = |value: f64, (low, high): (f64, f64)| ((value - low) / (high - low)) as f32;
        let (along, up) = (share(x, self.x), share(y, self.seen));
        pos2(self.rect.left() + along * self.rect.width(), self.rect.bottom() - up * self.rect.height())
    }

    fn place_at(self, at: Pos2) -> [f64; 2] {
        let along = f64::from((at.x - self.rect.left()) / self.rect.width());
        let up = f64::from((self.rect.bottom() - at.y) / self.rect.height());
        let between = |share: f64, (low, high): (f64, f64)| low + share * (high - low);
        let rounded = |value: f64| (value * DECIMALS).round() / DECIMALS;
        let [x, y] = [between(along, self.x), between(up, self.seen)].map(rounded);
        [x.clamp(self.x.0, self.x.1), y.clamp(self.y.0, self.y.1)]
    }
}

/// A curve's control points while they are changed: always in order, and within their ranges.
#[derive(Debug, Clone, PartialEq)]
struct Points {
    all: Vec<[f64; 2]>,
    x: (f64, f64),
    y: (f64, f64),
}

impl Points {
    /// Those that are given; a line where there are none, or none that are a curve.
    fn of(given: Option<&Value>, x: (f64, f64), y: (f64, f64)) -> Self {
        let given = given.and_then(|given| serde_json::from_value::<Vec<[f64; 2]>>(given.clone()).ok());
        let given = given.filter(|points| Curve::new("it", points.clone()).is_ok());
        let (low, high) = (x.0.max(y.0), x.1.min(y.1));
        Self { all: given.unwrap_or_else(|| vec![[x.0, low], [x.1, high]]), x, y }
    }

    fn gap(&self) -> f64 {
        MIN_GAP * (self.x.1 - self.x.0)
    }

    /// Puts a point elsewhere, between its neighbours.
    fn put(&mut self, index: usize, [x, y]: [f64; 2]) {
        let along = |index: Option<usize>| index.and_then(|index| self.all.get(index)).map(|[x, _]| *x);
        let low = along(index.checked_sub(1)).map_or(self.x.0, |x| x + self.gap());
        let high = along(index.checked_add(1)).map_or(self.x.1, |x| x - self.gap());
        let [low_y, high_y] = [self.y.0, self.y.1];
        if let Some(point) = self.all.get_mut(index)
            && low <= high
        {
            *point = [x.clamp(low, high), y.clamp(low_y, high_y)];
        }
    }

    /// Adds one where there is room; where it is now.
    fn add(&mut self, [x, y]: [f64; 2]) -> Option<usize> {
        let is_room = self.all.iter().all(|[other, _]| (other - x).abs() >= self.gap());
        if self.all.len() >= MAX_CURVE_POINTS || !is_room {
            return None;
        }
        let index = self.all.partition_point(|[other, _]| *other < x);
        self.all.insert(index, [x, y.clamp(self.y.0, self.y.1)]);
        Some(index)
    }

    /// Adds one in the middle of the widest gap, on the curve.
    fn add_anywhere(&mut self) -> Option<usize> {
        let gaps = self.all.windows(2).filter_map(|pair| match pair {
            [[from, _], [to, _]] => Some((to - from, (from + to) / 2.0)),
            _ => None,
        });
        let (_, x) = gaps.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
        let y = Curve::new("it", self.all.clone()).ok()?.value(x);
        self.add([x, (y * DECIMALS).round() / DECIMALS])
    }

    /// Takes one away; two stay.
    fn remove(&mut self, index: usize) {
        if self.all.len() > 2 && index < self.all.len() {
            self.all.remove(index);
        }
    }

    /// A shape in the place of all of them.
    fn shape(&mut self, shape: &[[f64; 2]]) {
        let (low, high) = (self.x.0.max(self.y.0), self.x.1.min(self.y.1));
        let along = |share: f64, low: f64, high: f64| low + share * (high - low);
        self.all = shape.iter().map(|[x, y]| [along(*x, self.x.0, self.x.1), along(*y, low, high)]).collect();
    }
}

/// What is done to a curve. A new value where it was changed; `Some(None)` for its default.
pub(super) fn show(
    ui: &mut Ui,
    parameter: &Parameter,
    (x, y): ((f64, f64), (f64, f64)),
    given: Option<&Value>,
) -> Option<Option<Value>> {
    let title = capitalised(&words(parameter.name));
    let title = if given.is_some() { format!("{title} *") } else { title };
    let mut is_reset = false;
    let mut points = Points::of(given, x, y);
    let before = points.clone();
    let header = CollapsingHeader::new(title).id_salt(parameter.name).show(ui, |ui| {
        drawing(ui, parameter.name, &mut points, given.is_some());
        ui.horizontal(|ui| {
            ui.menu_button("Shape", |ui| {
                for (name, shape) in SHAPES {
                    if ui.button(name).clicked() {
                        points.shape(shape);
                        ui.close();
                    }
                }
            });
            if ui.button("Add point").on_hover_text("In the widest gap; or double-click the curve").clicked()
            {
                points.add_anywhere();
            }
            let reset = ui.add_enabled(given.is_some(), egui::Button::new("Default"));
            is_reset = reset.on_hover_text("Without a curve").clicked();
        });
        table(ui, &mut points);
    });
    header.header_response.on_hover_text(capitalised(parameter.meaning));
    if is_reset {
        return Some(None);
    }
    (points != before).then(|| Some(json!(points.all)))
}

/// Draws it, and takes what the hand does to it.
fn drawing(ui: &mut Ui, name: &str, points: &mut Points, is_given: bool) {
    let size = vec2(ui.available_width().clamp(120.0, 400.0), HEIGHT);
    let (room, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let told = format!("Curve of {}: drag its points, double-click to add one", words(name));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &told));
    let frame = Frame::new((points.x, points.y), &points.all, room.shrink(8.0));
    // Which point is in the hand, or was last.
    let id = response.id.with("point");
    let mut chosen = ui.data(|data| data.get_temp::<usize>(id)).filter(|index| *index < points.all.len());
    let near = |at: Pos2| {
        let distances = points.all.iter().map(|point| frame.to_screen(*point).distance(at)).enumerate();
        distances
            .filter(|(_, far)| *far <= REACH)
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map(|(index, _)| index)
    };
    // A drag begins where the button went down.
    let pressed = ui.input(|input| input.pointer.press_origin());
    let hovered = response.hover_pos().and_then(near);
    if response.drag_started() || response.clicked() {
        response.request_focus();
        chosen = pressed.or(response.interact_pointer_pos()).and_then(near);
    }
    if response.secondary_clicked()
        && let Some(index) = response.interact_pointer_pos().and_then(near)
    {
        points.remove(index);
        chosen = None;
    } else if response.double_clicked()
        && let Some(at) = response.interact_pointer_pos()
        && near(at).is_none()
    {
        chosen = points.add(frame.place_at(at));
    } else if response.dragged()
        && let (Some(index), Some(at)) = (chosen, response.interact_pointer_pos())
    {
        points.put(index, frame.place_at(at));
    }
    if response.has_focus()
        && ui.input(|input| input.key_pressed(Key::Delete) || input.key_pressed(Key::Backspace))
        && let Some(index) = chosen.take()
    {
        points.remove(index);
    }
    ui.data_mut(|data| match chosen {
        Some(index) => _ = data.insert_temp(id, index),
        None => data.remove::<usize>(id),
    });
    paint(ui, frame, points, is_given, [chosen, hovered]);
    if let Some([x, y]) = hovered.and_then(|index| points.all.get(index)) {
        response.on_hover_text(format!("{x}, {y}"));
    }
}

fn paint(ui: &Ui, frame: Frame, points: &Points, is_given: bool, lit: [Option<usize>; 2]) {
    let visuals = ui.visuals();
    let painter = ui.painter();
    let rect = frame.rect;
    painter.rect_filled(rect.expand(8.0), 3.0, visuals.extreme_bg_color);
    let grid = Stroke::new(1.0, visuals.weak_text_color().gamma_multiply(0.3));
    for quarter in 0..=4_u8 {
        let share = f32::from(quarter) / 4.0;
        painter.vline(rect.left() + share * rect.width(), rect.y_range(), grid);
        painter.hline(rect.x_range(), rect.top() + share * rect.height(), grid);
    }
    let colour = if is_given { visuals.hyperlink_color } else { visuals.weak_text_color() };
    if let Ok(curve) = Curve::new("it", points.all.clone()) {
        let step = (frame.x.1 - frame.x.0) / f64::from(NUM_STEPS);
        let places = (0..=NUM_STEPS).map(|index| frame.x.0 + f64::from(index) * step);
        let line: Vec<_> = places.map(|x| frame.to_screen([x, curve.value(x)])).collect();
        painter.line(line, Stroke::new(1.5, colour));
    }
    for (index, point) in points.all.iter().enumerate() {
        let at = frame.to_screen(*point);
        let is_lit = lit.contains(&Some(index));
        let square = Rect::from_center_size(at, egui::Vec2::splat(if is_lit { 9.0 } else { 7.0 }));
        let fill = if is_lit { visuals.strong_text_color() } else { colour };
        painter.rect_filled(square, 1.0, fill);
        painter.rect_stroke(square, 1.0, Stroke::new(1.0, visuals.extreme_bg_color), StrokeKind::Outside);
    }
    let font = egui::FontId::proportional(10.0);
    let weak = visuals.weak_text_color();
    let number = |value: f64| format!("{}", (value * DECIMALS).round() / DECIMALS);
    let corner = |at: Pos2, align, value: f64| _ = painter.text(at, align, number(value), font.clone(), weak);
    corner(rect.left_top() + vec2(2.0, 0.0), egui::Align2::LEFT_TOP, frame.seen.1);
    corner(rect.left_bottom() + vec2(2.0, 0.0), egui::Align2::LEFT_BOTTOM, frame.seen.0);
    corner(rect.right_bottom() - vec2(2.0, 0.0), egui::Align2::RIGHT_BOTTOM, frame.x.1);
}

/// Every point in numbers.
fn table(ui: &mut Ui, points: &mut Points) {
    let mut removed = None;
    egui::Grid::new("points").num_columns(3).spacing([6.0, 2.0]).show(ui, |ui| {
        for (index, point) in points.all.clone().into_iter().enumerate() {
            let mut typed = point;
            for ((value, (low, high)), axis) in typed.iter_mut().zip([points.x, points.y]).zip(["x", "y"]) {
                let number =
                    DragValue::new(value).range(low..=high).speed((high - low) * 0.002).max_decimals(6);
                let told = format!("{axis} of point {}", index + 1);
                ui.add(number).widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &told));
            }
            if typed != point {
                points.put(index, typed);
            }
            let remove = ui.add_enabled(points.all.len() > 2, egui::Button::new("-").small());
            if remove.on_hover_text("Takes the point away; so does the right button, or Delete").clicked() {
                removed = Some(index);
            }
            ui.end_row();
        }
    });
    if let Some(index) = removed {
        points.remove(index);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line() -> Points {
        Points::of(None, (0.0, 1.0), (0.0, 1.0))
    }

    #[test]
    fn points_stay_in_order_and_within_their_ranges() {
        let mut points = line();
        assert_eq!(points.add([0.5, 0.9]), Some(1));
        points.put(1, [7.0, -3.0]);
        assert_eq!(points.all[1], [1.0 - MIN_GAP, 0.0]);
        points.put(0, [2.0, 0.5]);
        assert_eq!(points.all[0], [1.0 - 2.0 * MIN_GAP, 0.5]);
        assert!(points.add([points.all[0][0], 0.1]).is_none(), "there is one");
        Curve::new("it", points.all.clone()).unwrap();
        (0..5).for_each(|_| points.remove(0));
        assert_eq!(points.all.len(), 2);
        let mut points = line();
        (0..100).for_each(|_| _ = points.add_anywhere());
        assert_eq!(points.all.len(), MAX_CURVE_POINTS);
        Curve::new("it", points.all).unwrap();
    }

    #[test]
    fn every_shape_is_a_curve_of_every_range() {
        for (x, y) in [((0.0, 1.0), (0.0, 1.0)), ((-1.0, 1.0), (-4.0, 4.0))] {
            for (name, shape) in SHAPES {
                let mut points = Points::of(None, x, y);
                points.shape(shape);
                Curve::new(name, points.all.clone()).unwrap();
                assert!(points.all[0][0] == x.0 && points.all.last().unwrap()[0] == x.1, "{name}");
            }
        }
    }

    #[test]
    fn what_is_no_curve_is_begun_anew() {
        let given = json!([[0.5, 1], [0.2, 0]]);
        assert_eq!(Points::of(Some(&given), (-1.0, 1.0), (-4.0, 4.0)).all, [[-1.0, -1.0], [1.0, 1.0]]);
        let given = json!([[0, 1], [1, 0.25]]);
        assert_eq!(Points::of(Some(&given), (0.0, 1.0), (0.0, 1.0)).all, [[0.0, 1.0], [1.0, 0.25]]);
    }

    #[test]
    fn a_place_on_the_screen_is_the_place_of_the_curve() {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(200.0, 100.0));
        let frame = Frame::new(((-1.0, 1.0), (-4.0, 4.0)), &[[-1.0, -3.0], [1.0, 1.0]], rect);
        assert_eq!(frame.seen, (-3.0, 1.0));
        for point in [[-1.0, -3.0], [0.5, 0.0], [1.0, 1.0]] {
            let [x, y] = frame.place_at(frame.to_screen(point));
            assert!((x - point[0]).abs() < 1.0e-3 && (y - point[1]).abs() < 1.0e-3, "{point:?}");
        }
    }
}
