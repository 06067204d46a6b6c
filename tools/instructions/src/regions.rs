//! Kernels of whole regions: water on its way, and selections.

use std::hint::black_box;

use anyhow::Result;
use orogeny_field::{DropletKernel, Droplets, FillPits, FlowRouting, Plane, SampleRect};
use orogeny_reference::field::{droplets, fill_pits, flow};
use orogeny_reference::select::{feather, grow};

use crate::{Kernel, Work, rough_values};

pub const KERNELS: &[Kernel] = &[
    Kernel { name: "field/droplets", prepare: droplets_of_a_round },
    Kernel { name: "field/fill_pits", prepare: filled_pits },
    Kernel { name: "field/flow", prepare: flow_of_a_region },
    Kernel { name: "select/grow", prepare: || selected(|plane| black_box(grow::grown(plane, 12.0)).rect()) },
    Kernel {
        name: "select/feather",
        prepare: || selected(|plane| black_box(feather::feathered(plane, 8.0)).rect()),
    },
];

const SIDE: usize = 128;

fn ground() -> Result<Plane> {
    let rect = SampleRect::new(0, 0, SIDE as i32, SIDE as i32);
    Ok(Plane::from_samples(rect, 1, rough_values(SIDE * SIDE))?)
}

fn droplets_of_a_round() -> Result<Work> {
    let kernel = DropletKernel::new("erode", &Droplets::default(), 4.0)?;
    let ground = ground()?;
    Ok(Box::new(move || {
        let mut heights = ground.clone();
        droplets::run(&mut heights, &kernel, 256, 0);
        black_box(&mut heights);
    }))
}

fn filled_pits() -> Result<Work> {
    let ground = ground()?;
    Ok(Box::new(move || {
        let mut heights = ground.clone();
        fill_pits::fill_pits(&mut heights, &FillPits::default());
        black_box(&mut heights);
    }))
}

fn flow_of_a_region() -> Result<Work> {
    let mut ground = ground()?;
    fill_pits::fill_pits(&mut ground, &FillPits::default());
    Ok(Box::new(move || {
        black_box(flow::flow(&ground, FlowRouting::Steepest));
    }))
}

fn selected(work: fn(&Plane) -> SampleRect) -> Result<Work> {
    let mut plane = ground()?;
    for value in plane.samples_mut() {
        *value = f32::from(u8::from(*value > 345.0));
    }
    Ok(Box::new(move || {
        black_box(work(&plane));
    }))
}
