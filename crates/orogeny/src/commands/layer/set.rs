//! `layer set`: changes a layer.

use std::path::PathBuf;

use orogeny_engine::{
    Blend, Layer, LayerContent, LayerOperation, LayerReference, LayerTransform, Presets, Procedure, SetLayer,
};

use super::brush::{BrushArgument, brush};
use super::done;
use crate::session::Session;
use crate::values;

/// What `layer set` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The layer, by its name or `#ID`
    #[arg(value_parser = values::layer)]
    layer: LayerReference,
    #[command(flatten)]
    changes: Changes,
    /// Work an effect that is kept, as erosion is, out later, by `layer refresh`
    #[arg(long, requires = "made_by")]
    deferred: bool,
}

#[derive(Debug, clap::Args)]
#[group(required = true, multiple = true)]
struct Changes {
    /// What it is called from now on
    #[arg(long)]
    name: Option<String>,
    /// It counts
    #[arg(long, conflicts_with = "hide")]
    show: bool,
    /// It does not count
    #[arg(long)]
    hide: bool,
    /// It is protected: from being painted on, masked, moved, worked out anew, collapsed and removed
    #[arg(long, conflicts_with = "unlock")]
    lock: bool,
    /// It is not protected any more
    #[arg(long)]
    unlock: bool,
    /// How much it counts, 0 to 1
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    opacity: Option<f32>,
    /// How it joins what is below
    #[arg(long, value_parser = values::blend())]
    blend: Option<Blend>,
    /// By how much its heights are moved, in metres, from where they were painted
    #[arg(long = "move", value_name = "X,Z", value_parser = values::place, allow_hyphen_values = true)]
    move_m: Option<[f64; 2]>,
    /// By how many degrees they are turned, from x towards z
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    rotate: Option<f64>,
    /// How much larger they become, 0.01 to 100
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// About which place they are turned and enlarged, in metres
    #[arg(long, value_name = "X,Z", value_parser = values::place, allow_hyphen_values = true)]
    pivot: Option<[f64; 2]>,
    /// What they are multiplied by, -1000 to 1000
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    height_scale: Option<f64>,
    /// Of a procedural layer or an effect: the brush, a JSON object, a file that holds one, or the name of a preset
    #[arg(long, value_name = "BRUSH", value_parser = brush, group = "made_by")]
    brush: Option<BrushArgument>,
    /// Feeds everything random in the brush
    #[arg(long, value_name = "N", group = "made_by")]
    seed: Option<u32>,
}

/// Changes the layer.
///
/// # Errors
/// When it is not there, is locked, or cannot be changed so; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let changes = &arguments.changes;
    let terrain = session.open(&arguments.terrain)?;
    let layer = terrain.layer(Some(&arguments.layer))?;
    let operation = LayerOperation::SetLayer(SetLayer {
        layer: LayerReference::Id(layer.id),
        name: changes.name.clone(),
        visible: one_of(changes.show, changes.hide),
        locked: one_of(changes.lock, changes.unlock),
        opacity: changes.opacity,
        blend: changes.blend,
        transform: changes.transform(&layer.transform),
        content: changes.content(layer, &session.presets())?,
        deferred: arguments.deferred,
    });
    done::run_on(terrain, &arguments.terrain, operation, "set", session)
}

const fn one_of(yes: bool, no: bool) -> Option<bool> {
    match (yes, no) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        (false, false) => None,
    }
}

impl Changes {
    /// The transform with what is given of it; `None` where nothing is.
    fn transform(&self, before: &LayerTransform) -> Option<LayerTransform> {
        let after = LayerTransform {
            move_m: self.move_m.unwrap_or(before.move_m),
            rotation_deg: self.rotate.unwrap_or(before.rotation_deg),
            scale: self.scale.unwrap_or(before.scale),
            pivot_m: self.pivot.unwrap_or(before.pivot_m),
            height_scale: self.height_scale.unwrap_or(before.height_scale),
        };
        let is_given = self.move_m.is_some()
            || self.rotate.is_some()
            || self.scale.is_some()
            || self.pivot.is_some()
            || self.height_scale.is_some();
        is_given.then_some(after)
    }

    /// What the layer is made of with what is given of it; `None` where nothing is.
    fn content(&self, layer: &Layer, presets: &Presets) -> anyhow::Result<Option<LayerContent>> {
        if self.brush.is_none() && self.seed.is_none() {
            return Ok(None);
        }
        let before = layer.content.procedure();
        let seed = self.seed.or(before.map(|before| before.seed)).unwrap_or_default();
        let procedure = match (&self.brush, before) {
            (Some(brush), _) => brush.procedure(seed, presets)?,
            (None, Some(before)) => Procedure { seed, ..before.clone() },
            // The layer is made by no brush.
            (None, None) => return Ok(None),
        };
        Ok(Some(match layer.content {
            LayerContent::Procedural(_) => LayerContent::Procedural(procedure),
            // Of a layer of another kind it is refused.
            _ => LayerContent::Effect(procedure),
        }))
    }
}
