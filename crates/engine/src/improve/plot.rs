//! Bits lost over one input, before and after.

use serde::{Deserialize, Serialize};

use ::improve::{Losses, Points};

/// Places of a plot.
const PLACES: usize = 48;

/// The bits lost over the input on which they depend most, in parts of the samples that are alike in number.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// The input.
    pub input: String,
    /// For each part: the largest value of the input in it, and the mean of the bits lost before and after.
    #[serde(with = "crate::bits")]
    pub places: Vec<(f32, [f64; 2])>,
    /// The smallest value.
    #[serde(with = "crate::bits")]
    pub from: f32,
}

impl Plot {
    pub(super) fn new(points: &Points, names: &[&str], losses: [&Losses; 2]) -> Self {
        let all = (0..points.width()).map(|leaf| over(points, leaf, names[leaf], losses));
        // What differs most from part to part says most.
        all.max_by(|a, b| a.spread().total_cmp(&b.spread())).unwrap_or_default()
    }

    fn spread(&self) -> f64 {
        let before = || self.places.iter().map(|(_, lost)| lost[0]);
        let mean = before().sum::<f64>() / self.places.len().max(1) as f64;
        before().map(|lost| (lost - mean).powi(2)).sum()
    }
}

fn over(points: &Points, leaf: usize, name: &str, losses: [&Losses; 2]) -> Plot {
    let values = points.leaf(u32::try_from(leaf).unwrap_or(u32::MAX));
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let size = order.len().div_ceil(PLACES).max(1);
    let mean = |part: &[usize], of: &Losses| part.iter().map(|k| of.0[*k]).sum::<f64>() / part.len() as f64;
    let places = order.chunks(size).map(|part| (values[part[part.len() - 1]], losses.map(|of| mean(part, of))));
    Plot { input: name.to_owned(), places: places.collect(), from: order.first().map_or(0.0, |k| values[*k]) }
}
