//! Where layers lie in the stack.

use orogeny_store::Layer;

/// The ids from the bottom, with `moved`, in their order, put right above another layer; below all for `None`.
pub(super) fn put_above(layers: &[Layer], moved: &[u32], above: Option<u32>) -> Vec<u32> {
    let is_moved = |id: &u32| moved.contains(id);
    let (block, rest): (Vec<u32>, Vec<u32>) = layers.iter().map(|layer| layer.id).partition(is_moved);
    let place = above.and_then(|above| rest.iter().position(|id| *id == above)).map_or(0, |place| place + 1);
    let (below, on_top) = rest.split_at(place.min(rest.len()));
    [below, &block, on_top].concat()
}

/// A layer and, of a group, all that is in it, from the bottom.
pub(super) fn with_members(layers: &[Layer], id: u32) -> Vec<u32> {
    let is_in = |layer: &&Layer| crate::composite::with_groups(layers, layer).any(|outer| outer.id == id);
    layers.iter().filter(is_in).map(|layer| layer.id).collect()
}

/// The layer right below another one, which does not count itself.
pub(super) fn below(layers: &[Layer], id: u32) -> Option<u32> {
    let place = layers.iter().position(|layer| layer.id == id)?;
    layers.get(place.checked_sub(1)?).map(|layer| layer.id)
}

/// A name for a copy that no layer has.
pub(super) fn copy_name(layers: &[Layer], name: &str) -> String {
    let is_free = |name: &String| layers.iter().all(|layer| layer.name != *name);
    let numbered = (2..).map(|number| format!("{name} copy {number}"));
    std::iter::once(format!("{name} copy")).chain(numbered).find(is_free).unwrap_or_default()
}
