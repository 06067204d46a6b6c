//! Values that a user types: sizes, places, regions, ranges and choices.

use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use orogeny_engine::{
    Blend, ByteOrder, Cursor, Fit, Flip, HeightAt, LayerReference, MaskTerm, NodataPolicy, Place, SampleType,
};

/// Two whole numbers, as `4096x2048`.
///
/// # Errors
/// What is wrong and what it must look like, here and below.
pub fn size<T: FromStr>(text: &str) -> Result<[T; 2], String> {
    let sides = text.split_once(['x', 'X']).map(|(x, z)| (x.trim().parse(), z.trim().parse()));
    match sides {
        Some((Ok(width), Ok(depth))) => Ok([width, depth]),
        _ => Err("give two whole numbers of samples or pixels, as 4096x2048".to_owned()),
    }
}

/// A place in metres, as `X,Z`.
pub fn place(text: &str) -> Result<[f64; 2], String> {
    numbers(text, "X,Z")
}

/// A region in metres, as `X,Z,WIDTH,DEPTH`.
pub fn region(text: &str) -> Result<[f64; 4], String> {
    numbers(text, "X,Z,WIDTH,DEPTH")
}

/// A range of heights in metres, as `LO,HI`.
pub fn range(text: &str) -> Result<[f64; 2], String> {
    let [low, high] = numbers(text, "LO,HI")?;
    if low < high { Ok([low, high]) } else { Err("the first height must be below the second".to_owned()) }
}

/// A place to look from or at, in metres: `X,Y,Z`, with `+` before Y where it is above the ground.
pub fn view_place(text: &str) -> Result<Place, String> {
    let [x_m, y_m, z_m] = numbers(text, "X,Y,Z, with +Y above the ground")?;
    let is_above = text.split(',').nth(1).is_some_and(|y| y.trim().starts_with('+'));
    let height = if is_above { HeightAt::AboveGround(y_m) } else { HeightAt::Absolute(y_m) };
    Ok(Place { x_m, height, z_m })
}

/// A brush's ring: `X,Z,RADIUS,HARDNESS`.
pub fn cursor(text: &str) -> Result<Cursor, String> {
    let [x, z, radius, hardness] = numbers(text, "X,Z,RADIUS,HARDNESS")?;
    if radius > 0.0 && (0.0..=1.0).contains(&hardness) {
        Ok(Cursor { centre_m: [x, z], radius_m: radius as f32, hardness: hardness as f32 })
    } else {
        Err("the radius must be above 0, the hardness 0 to 1".to_owned())
    }
}

/// Where the sun stands, in degrees: `AZIMUTH,ALTITUDE`.
pub fn sun(text: &str) -> Result<[f64; 2], String> {
    numbers(text, "AZIMUTH,ALTITUDE")
        .map_err(|_| "give two numbers of degrees, as AZIMUTH,ALTITUDE".to_owned())
}

/// A layer: `#` and its id, or else its name.
pub fn layer(text: &str) -> Result<LayerReference, std::convert::Infallible> {
    let id = text.strip_prefix('#').and_then(|id| id.parse().ok());
    Ok(id.map_or_else(|| LayerReference::Name(text.to_owned()), LayerReference::Id))
}

/// How a layer joins what is below it, as recipes name it.
pub fn blend() -> impl TypedValueParser<Value = Blend> {
    PossibleValuesParser::new(Blend::ALL.map(Blend::name)).try_map(|name| {
        let blend = Blend::ALL.into_iter().find(|blend| blend.name() == name);
        blend.ok_or_else(|| format!("there is no blend `{name}`"))
    })
}

/// Terms of a mask, in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MaskTerms(pub Vec<MaskTerm>);

/// A JSON array of terms, as recipes hold it.
pub fn mask_terms(text: &str) -> Result<MaskTerms, String> {
    serde_json::from_str(text).map(MaskTerms).map_err(|err| format!("they are no JSON array of terms: {err}"))
}

fn numbers<const N: usize>(text: &str, form: &str) -> Result<[f64; N], String> {
    let values: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    values
        .ok()
        .and_then(|values| <[f64; N]>::try_from(values).ok())
        .filter(|values| values.iter().all(|value| value.is_finite()))
        .ok_or_else(|| format!("give {N} numbers of metres, as {form}"))
}

/// What becomes of samples without a height: `refuse`, `fill`, or a height in metres.
pub fn nodata(text: &str) -> Result<NodataPolicy, String> {
    match text {
        "refuse" => Ok(NodataPolicy::Refuse),
        "fill" => Ok(NodataPolicy::Fill),
        number => match number.parse::<f32>() {
            Ok(height_m) if height_m.is_finite() => Ok(NodataPolicy::Value(height_m)),
            _ => Err("give `refuse`, `fill` or a height in metres".to_owned()),
        },
    }
}

/// What the history may take in the file, in bytes; `None`: whatever it comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HistoryBudget(pub Option<u64>);

/// A size such as `500MiB`, or `none`.
pub fn history_budget(text: &str) -> Result<HistoryBudget, String> {
    const UNITS: [(&str, u32); 4] = [("KiB", 10), ("MiB", 20), ("GiB", 30), ("TiB", 40)];
    if text == "none" {
        return Ok(HistoryBudget(None));
    }
    let size = UNITS.into_iter().find_map(|(unit, shift)| {
        let number: u64 = text.strip_suffix(unit)?.trim().parse().ok()?;
        number.checked_mul(1 << shift).filter(|size| i64::try_from(*size).is_ok())
    });
    size.map(|size| HistoryBudget(Some(size)))
        .ok_or_else(|| "give a size as 500MiB (KiB, MiB, GiB or TiB), or `none`".to_owned())
}

/// How one sample is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sample {
    /// Whole numbers, 0 to 255
    U8,
    /// Whole numbers, 0 to 65535
    U16,
    /// Whole numbers, -32768 to 32767
    I16,
    /// Metres as they are
    F32,
}

impl From<Sample> for SampleType {
    fn from(sample: Sample) -> Self {
        match sample {
            Sample::U8 => Self::U8,
            Sample::U16 => Self::U16,
            Sample::I16 => Self::I16,
            Sample::F32 => Self::F32,
        }
    }
}

/// Which byte of a sample comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Order {
    /// The least significant, as on PCs
    Little,
    /// The most significant
    Big,
}

impl From<Order> for ByteOrder {
    fn from(order: Order) -> Self {
        match order {
            Order::Little => Self::Little,
            Order::Big => Self::Big,
        }
    }
}

/// How another number of samples comes about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fitting {
    /// Read between the samples; corners stay corners, and the spacing differs
    Resample,
    /// The middle, cut out; where there is too little the edge goes on
    Middle,
}

impl From<Fitting> for Fit {
    fn from(fitting: Fitting) -> Self {
        match fitting {
            Fitting::Resample => Self::Resample,
            Fitting::Middle => Self::Middle,
        }
    }
}

/// Which sides of a raster change places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Mirror {
    /// East and west
    EastWest,
    /// North and south
    NorthSouth,
    /// Both, as half a turn does
    Both,
}

impl From<Mirror> for Flip {
    fn from(mirror: Mirror) -> Self {
        match mirror {
            Mirror::EastWest => Self::EastWest,
            Mirror::NorthSouth => Self::NorthSouth,
            Mirror::Both => Self::Both,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn history_budgets_have_a_unit() {
        assert_eq!(history_budget("none"), Ok(HistoryBudget(None)));
        assert_eq!(history_budget("3GiB"), Ok(HistoryBudget(Some(3 << 30))));
        assert_eq!(history_budget("0 KiB"), Ok(HistoryBudget(Some(0))));
        for bad in ["", "5", "5MB", "-1MiB", "1.5GiB", "99999999TiB", "GiB"] {
            assert!(history_budget(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn layers_are_named_by_name_or_id() {
        assert_eq!(layer("#12"), Ok(LayerReference::Id(12)));
        for name in ["Base", "12", "#", "#twelve", "#-1", "#99999999999", ""] {
            assert_eq!(layer(name), Ok(LayerReference::Name(name.to_owned())));
        }
    }

    #[test]
    fn terms_are_an_array_and_a_bad_field_is_named() {
        assert_eq!(mask_terms("[]"), Ok(MaskTerms(Vec::new())));
        assert_eq!(mask_terms(r#"[{"gate": {"slope": {"min": 20}}, "blur": 5}]"#).unwrap().0.len(), 1);
        for (bad, word) in
            [("", "array"), (r#"{"mask": 1}"#, "array"), (r#"[{"mask": 1, "blurr": 5}]"#, "blurr")]
        {
            assert!(mask_terms(bad).unwrap_err().contains(word), "{bad}");
        }
    }

    #[test]
    fn sizes_are_two_whole_numbers() {
        assert_eq!(size::<u32>("4096x2048"), Ok([4096, 2048]));
        assert_eq!(size::<u64>("1099511627776X1"), Ok([1 << 40, 1]));
        for text in ["", "4096", "x", "4096x", "-1x5", "1.5x2", "1x2x3", "4294967296x1"] {
            assert!(size::<u32>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn places_regions_and_ranges_are_finite_numbers() {
        assert_eq!(place("-5, 1e3"), Ok([-5.0, 1000.0]));
        assert_eq!(region("0,0,10,20.5"), Ok([0.0, 0.0, 10.0, 20.5]));
        assert_eq!(range("-100,2500"), Ok([-100.0, 2500.0]));
        assert!(place("1").is_err() && place("1,2,3").is_err() && place("1,NaN").is_err());
        assert!(region("1,2,3").is_err() && region("0,0,inf,1").is_err());
        assert!(range("5,5").is_err() && range("6,5").is_err() && range("NaN,5").is_err());
    }

    #[test]
    fn nodata_is_a_word_or_a_height() {
        assert_eq!(nodata("fill"), Ok(NodataPolicy::Fill));
        assert_eq!(nodata("-12.5"), Ok(NodataPolicy::Value(-12.5)));
        assert!(nodata("NaN").is_err() && nodata("full").is_err());
    }
}
