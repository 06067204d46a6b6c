//! An operation on the layer stack in a line.

use orogeny_engine::{
    AddLayer, CollapseLayer, DuplicateLayer, LayerContent, LayerOperation, LayerReference, LayerTransform,
    MaskFrom, MoveLayer, RefreshLayer, RemoveLayer, SetLayer, SetMask,
};
use serde::Deserialize as _;
use serde_json::Value;

use crate::output::count;

/// An operation on layers, as the history records it, in a line; `None` for any other.
pub(super) fn summary(operation: &Value) -> Option<String> {
    let operation = LayerOperation::deserialize(operation).ok()?;
    let mut parts = Parts(vec![operation.name().to_owned()]);
    match &operation {
        LayerOperation::AddLayer(add) => parts.add(add),
        LayerOperation::SetLayer(set) => parts.set(set),
        LayerOperation::MoveLayer(MoveLayer { layer, above, group }) => {
            parts.beside_name(&id(layer));
            parts.push(
                above
                    .as_ref()
                    .map_or_else(|| "to the bottom".to_owned(), |above| format!("above {}", id(above))),
            );
            parts.push_if(group.as_ref(), |group| format!("in {}", id(group)));
        }
        LayerOperation::RemoveLayer(RemoveLayer { layer, members }) => {
            parts.beside_name(&id(layer));
            parts.push_where(*members, "with its layers");
        }
        LayerOperation::DuplicateLayer(DuplicateLayer { layer, name, id: made }) => {
            parts.beside_name(&id(layer));
            parts.push_if(*made, |made| format!("as {made}"));
            parts.push_if(name.as_ref(), |name| format!("named `{name}`"));
        }
        LayerOperation::CollapseLayer(CollapseLayer { layer, below }) => {
            parts.beside_name(&id(layer));
            parts.push_where(*below, "with all below");
        }
        LayerOperation::SetMask(set) => parts.set_mask(set),
        LayerOperation::RefreshLayer(RefreshLayer { layer }) => parts.beside_name(&id(layer)),
    }
    Some(parts.0.join(", "))
}

fn id(layer: &LayerReference) -> String {
    match layer {
        LayerReference::Id(id) => id.to_string(),
        LayerReference::Name(name) => format!("`{name}`"),
    }
}

fn terms(number: usize) -> String {
    count(number as u64, "mask term")
}

/// What is said, part by part.
struct Parts(Vec<String>);

impl Parts {
    fn push(&mut self, part: impl Into<String>) {
        self.0.push(part.into());
    }

    fn push_if<T>(&mut self, is_there: Option<T>, part: impl FnOnce(T) -> String) {
        self.0.extend(is_there.map(part));
    }

    /// A number, unless it is the usual one.
    fn push_unless<T: PartialEq>(&mut self, value: T, usual: T, part: impl FnOnce(T) -> String) {
        if value != usual {
            self.push(part(value));
        }
    }

    fn push_where(&mut self, is_so: bool, part: &str) {
        if is_so {
            self.push(part);
        }
    }

    /// Says which layer, right after the operation's name.
    fn beside_name(&mut self, what: &str) {
        if let Some(last) = self.0.last_mut() {
            last.push_str(&format!(" {what}"));
        }
    }

    fn add(&mut self, add: &AddLayer) {
        let AddLayer { name, content, height, above, group, blend, opacity, visible, locked, .. } = add;
        let made = add.id.map_or_else(String::new, |id| format!("{id} "));
        self.beside_name(&format!("{made}`{name}`"));
        self.content(content);
        self.push_unless(*height, 0.0, |height| format!("height {height} m"));
        self.push_if(above.as_ref(), |above| format!("above {}", id(above)));
        self.push_if(group.as_ref(), |group| format!("in {}", id(group)));
        self.push_if(blend.as_ref(), |blend| format!("blend {}", blend.name()));
        self.push_unless(*opacity, 1.0, |opacity| format!("opacity {opacity}"));
        self.push_where(!visible, "hidden");
        self.push_where(*locked, "locked");
        self.transform(&add.transform);
        self.push_unless(add.mask.len(), 0, terms);
        self.push_where(add.deferred, "not worked out yet");
    }

    fn set(&mut self, set: &SetLayer) {
        let SetLayer { layer, name, visible, locked, opacity, blend, transform, content, deferred } = set;
        self.beside_name(&id(layer));
        self.push_if(name.as_ref(), |name| format!("named `{name}`"));
        self.push_if(*visible, |visible| if visible { "shown" } else { "hidden" }.to_owned());
        self.push_if(*locked, |locked| if locked { "locked" } else { "unlocked" }.to_owned());
        self.push_if(opacity.as_ref(), |opacity| format!("opacity {opacity}"));
        self.push_if(blend.as_ref(), |blend| format!("blend {}", blend.name()));
        if let Some(transform) = transform {
            self.push_where(transform.is_identity(), "moved back");
            self.transform(transform);
        }
        if let Some(content) = content {
            self.content(content);
        }
        self.push_where(*deferred, "not worked out yet");
    }

    fn content(&mut self, content: &LayerContent) {
        let name = content.name();
        match content.procedure() {
            Some(procedure) => self.push(format!("{name} {}", procedure.brush.brush_type.name())),
            None => self.push_where(*content == LayerContent::Group, name),
        }
    }

    fn transform(&mut self, transform: &LayerTransform) {
        let LayerTransform { move_m: [x, z], rotation_deg, scale, height_scale, .. } = *transform;
        self.push_unless([x, z], [0.0; 2], |[x, z]| format!("moved by {x},{z} m"));
        self.push_unless(rotation_deg, 0.0, |angle| format!("turned by {angle} degrees"));
        self.push_unless(scale, 1.0, |scale| format!("scale {scale}"));
        self.push_unless(height_scale, 1.0, |scale| format!("height scale {scale}"));
    }

    fn set_mask(&mut self, set: &SetMask) {
        let SetMask { layer, from, brush, invert, scale, terms: given } = set;
        self.beside_name(&id(layer));
        match from {
            MaskFrom::Keep => {}
            MaskFrom::All => self.push("everywhere"),
            MaskFrom::Nothing => self.push("nowhere"),
            MaskFrom::Selection => self.push("from the selection"),
        }
        self.push_if(brush.as_ref(), |made| format!("painted by {}", made.brush.brush_type.name()));
        self.push_where(*invert, "inverted");
        self.push_unless(*scale, 1.0, |scale| format!("scale {scale}"));
        self.push_if(given.as_ref(), |given| terms(given.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_on_layers_are_told_in_a_line() {
        for (text, line) in [
            (r#"{"op": "add_layer", "name": "Sand", "id": 4}"#, "add_layer 4 `Sand`"),
            (
                r#"{"op": "add_layer", "name": "R", "id": 2, "content": {"type": "procedural", "brush": {"type": "noise"}},
                    "above": 1, "group": 3, "blend": "max", "opacity": 0.5, "visible": false, "mask": [{"mask": 1}]}"#,
                "add_layer 2 `R`, procedural noise, above 1, in 3, blend max, opacity 0.5, hidden, 1 mask term",
            ),
            (
                r#"{"op": "add_layer", "name": "E", "content": {"type": "effect", "brush": {"type": "erode_thermal"}}, "deferred": true}"#,
                "add_layer `E`, effect erode_thermal, not worked out yet",
            ),
            (
                r#"{"op": "set_layer", "layer": 3, "visible": true, "locked": false, "name": "N", "opacity": 0.25,
                    "transform": {"move": [10, -2.5], "rotate": 30, "height_scale": -1}}"#,
                "set_layer 3, named `N`, shown, unlocked, opacity 0.25, moved by 10,-2.5 m, turned by 30 degrees, height scale -1",
            ),
            (r#"{"op": "set_layer", "layer": 3, "transform": {"pivot": [5, 5]}}"#, "set_layer 3, moved back"),
            (r#"{"op": "move_layer", "layer": 3, "above": 1, "group": 2}"#, "move_layer 3, above 1, in 2"),
            (r#"{"op": "move_layer", "layer": 3}"#, "move_layer 3, to the bottom"),
            (r#"{"op": "remove_layer", "layer": 3, "members": true}"#, "remove_layer 3, with its layers"),
            (r#"{"op": "duplicate_layer", "layer": 3, "id": 5}"#, "duplicate_layer 3, as 5"),
            (r#"{"op": "collapse_layer", "layer": 3, "below": true}"#, "collapse_layer 3, with all below"),
            (
                r#"{"op": "set_mask", "layer": 3, "from": "selection", "invert": true, "scale": 0.5, "terms": []}"#,
                "set_mask 3, from the selection, inverted, scale 0.5, 0 mask terms",
            ),
            (r#"{"op": "refresh_layer", "layer": 9}"#, "refresh_layer 9"),
        ] {
            let operation = serde_json::from_str(text).unwrap();
            assert_eq!(summary(&operation).as_deref(), Some(line));
        }
        assert_eq!(summary(&serde_json::json!({"op": "fill"})), None);
    }
}
