//! `layer mask`: changes where a layer counts.

use std::path::PathBuf;

use orogeny_engine::{LayerOperation, LayerReference, MaskFrom, SetMask};

use super::brush::{BrushArgument, brush};
use super::done;
use crate::session::Session;
use crate::values::{self, MaskTerms};

/// What `layer mask` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The layer, by its name or `#ID`
    #[arg(value_parser = values::layer)]
    layer: LayerReference,
    #[command(flatten)]
    changes: Changes,
}

#[derive(Debug, clap::Args)]
#[group(required = true, multiple = true)]
struct Changes {
    /// Paint it anew: it counts everywhere
    #[arg(long, group = "from")]
    all: bool,
    /// Paint it anew: it counts nowhere
    #[arg(long, group = "from")]
    nothing: bool,
    /// Paint it anew: it counts where something is selected
    #[arg(long, group = "from")]
    selection: bool,
    /// Keep what is painted; so does none of these three
    #[arg(long, group = "from")]
    keep: bool,
    /// Have it painted anew by a brush for masks, such as `flow_mask`, and kept, for `layer refresh`: a JSON object, a file that
    /// holds one, or the name of a preset
    #[arg(long, value_name = "BRUSH", value_parser = brush, group = "from")]
    brush: Option<BrushArgument>,
    /// Feeds everything random in that brush [default: 0]
    #[arg(long, value_name = "N", requires = "brush", conflicts_with_all = ["all", "nothing", "selection", "keep"])]
    seed: Option<u32>,
    /// Turn what is painted then into its opposite
    #[arg(long)]
    invert: bool,
    /// Multiply what is painted then, by 0 to 1: less fades the layer [default: 1]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    scale: Option<f32>,
    /// Where it counts besides, worked out from what lies below: a JSON array of terms, `[]` for none [default: as before]
    #[arg(long, value_name = "TERMS", value_parser = values::mask_terms)]
    terms: Option<MaskTerms>,
}

/// Changes the mask.
///
/// # Errors
/// When the layer is not there, or is locked; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let Changes { all, nothing, selection, keep: _, brush, seed, invert, scale, terms } = &arguments.changes;
    let from = match (all, nothing, selection) {
        (true, ..) => MaskFrom::All,
        (_, true, _) => MaskFrom::Nothing,
        (.., true) => MaskFrom::Selection,
        _ => MaskFrom::Keep,
    };
    let operation = LayerOperation::SetMask(SetMask {
        layer: arguments.layer.clone(),
        from,
        brush: brush
            .as_ref()
            .map(|brush| brush.procedure(seed.unwrap_or_default(), &session.presets()))
            .transpose()?,
        invert: *invert,
        scale: scale.unwrap_or(1.0),
        terms: terms.clone().map(|terms| terms.0),
    });
    done::run(&arguments.terrain, operation, "changed the mask of", session)
}
