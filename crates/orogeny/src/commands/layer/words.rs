//! What is said of a layer.

use orogeny_engine::LayerDescription;

use crate::output::count;

/// What there is to say of a layer beside what it is made of and how it joins what is below.
pub fn notes(layer: &LayerDescription, layers: &[LayerDescription]) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(group) = layers.iter().find(|group| Some(group.id) == layer.group) {
        notes.push(format!("in `{}`", group.name));
    }
    let terms = count(layer.mask_terms.len() as u64, "term");
    match (layer.has_painted_mask, layer.mask_terms.is_empty()) {
        (true, true) => notes.push("painted mask".to_owned()),
        (true, false) => notes.push(format!("painted mask and {terms}")),
        (false, false) => notes.push(format!("mask of {terms}")),
        (false, true) => {}
    }
    for (is_so, what) in [
        (!layer.transform.is_identity(), "moved"),
        (layer.locked, "locked"),
        (!layer.visible, "hidden"),
        (layer.is_stale, "stale: what is below has changed since it was worked out (`layer refresh`)"),
    ] {
        if is_so {
            notes.push(what.to_owned());
        }
    }
    notes
}
