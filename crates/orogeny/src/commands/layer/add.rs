//! `layer add`: makes a layer.

use std::path::PathBuf;

use orogeny_engine::{
    AddLayer, Blend, LayerContent, LayerOperation, LayerReference, LayerTransform, Procedure,
};

use super::brush::{BrushArgument, brush};
use super::done;
use crate::session::Session;
use crate::values::{self, MaskTerms};

/// What `layer add` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// What it is called; no other layer of the terrain is called so
    name: String,
    /// Make it of what a brush makes of flat ground: a JSON object, a file that holds one, or the name of a preset
    #[arg(long, value_name = "BRUSH", value_parser = brush, groups = ["content", "by_brush"])]
    procedural: Option<BrushArgument>,
    /// Make it of what a brush makes of what is below, wherever that is looked at: given as for `--procedural`
    #[arg(long, value_name = "BRUSH", value_parser = brush, groups = ["content", "by_brush"])]
    effect: Option<BrushArgument>,
    /// Make it a group, for other layers to be in
    #[arg(long, group = "content")]
    group: bool,
    /// Of heights: what they are before anything is painted, in metres [default: 0]
    #[arg(long, value_name = "METRES", conflicts_with = "content", allow_negative_numbers = true)]
    height: Option<f32>,
    /// The layer that it comes to lie on, by its name or `#ID` [default: the uppermost, with `--in` that of the group]
    #[arg(long, value_name = "LAYER", value_parser = values::layer)]
    above: Option<LayerReference>,
    /// The group that it is in
    #[arg(long = "in", value_name = "GROUP", value_parser = values::layer)]
    within: Option<LayerReference>,
    /// How it joins what is below [default: add; of an effect replace]
    #[arg(long, value_parser = values::blend())]
    blend: Option<Blend>,
    /// How much it counts, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, allow_negative_numbers = true)]
    opacity: f32,
    /// It does not count until it is shown
    #[arg(long)]
    hidden: bool,
    /// It is protected: from being painted on, masked, moved, worked out anew, collapsed and removed
    #[arg(long)]
    locked: bool,
    /// Where it counts, worked out from what lies below: a JSON array of terms
    #[arg(long, value_name = "TERMS", value_parser = values::mask_terms)]
    mask: Option<MaskTerms>,
    /// Feeds everything random in the brush [default: 0]
    #[arg(long, value_name = "N", requires = "by_brush", conflicts_with = "group")]
    seed: Option<u32>,
    /// Work an effect that is kept, as erosion is, out later, by `layer refresh`
    #[arg(long, requires = "effect", conflicts_with_all = ["procedural", "group"])]
    deferred: bool,
}

/// Makes the layer.
///
/// # Errors
/// When another one has the name, or no layer can be made so; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let procedure = |brush: &BrushArgument| -> anyhow::Result<Procedure> {
        brush.procedure(arguments.seed.unwrap_or_default(), &session.presets())
    };
    let content = match (&arguments.procedural, &arguments.effect) {
        (Some(brush), _) => LayerContent::Procedural(procedure(brush)?),
        (_, Some(brush)) => LayerContent::Effect(procedure(brush)?),
        _ if arguments.group => LayerContent::Group,
        _ => LayerContent::Heights,
    };
    let operation = LayerOperation::AddLayer(AddLayer {
        name: arguments.name.clone(),
        content,
        height: arguments.height.unwrap_or_default(),
        above: arguments.above.clone(),
        group: arguments.within.clone(),
        blend: arguments.blend,
        opacity: arguments.opacity,
        visible: !arguments.hidden,
        locked: arguments.locked,
        transform: LayerTransform::default(),
        mask: arguments.mask.clone().unwrap_or_default().0,
        deferred: arguments.deferred,
        id: None,
    });
    done::run(&arguments.terrain, operation, "added", session)
}
