//! Whether and how a chip forms.

use crate::observable::Observable;
use sphcut_sph::ChannelId;

/// Highest equivalent plastic strain at the end.
pub(crate) const LARGEST_PLASTIC_STRAIN: Observable = Observable {
    name: "largest_plastic_strain",
    unit: "",
    meaning: "highest equivalent plastic strain of all particles at the end",
    arguments: &[],
    evaluate: |evidence, _| Ok(evidence.last_sample()?.get(ChannelId::MaxPlasticStrain)),
};

/// Height of the highest particle above the uncut surface in terms of h.
pub(crate) const CHIP_RISE: Observable = Observable {
    name: "chip_rise",
    unit: "",
    meaning: "height of the highest particle above the uncut surface, in uncut chip thicknesses",
    arguments: &[],
    evaluate: |evidence, _| {
        let thickness = evidence.setup.uncut_chip_thickness.ok_or("there is no cut")?;
        let feed = evidence.setup.frame.feed;
        let top = |positions: &[[f64; 3]]| {
            positions
                .iter()
                .map(|position| -(0..3).map(|axis| position[axis] * feed[axis]).sum::<f64>())
                .fold(f64::NEG_INFINITY, f64::max)
        };
        Ok((top(&evidence.last()?.position) - top(&evidence.first()?.position)) / thickness)
    },
};

/// h_ch as in `summary.json`.
pub(crate) const CHIP_THICKNESS: Observable = Observable {
    name: "chip_thickness",
    unit: "m",
    meaning: "chip thickness as `sphcut run` reports it: median local thickness, mean over the \
              snapshots of the window of the means",
    arguments: &[],
    evaluate: |evidence, _| match &evidence.result()?.geometry.chip {
        Ok(chip) => Ok(chip.thickness),
        Err(reason) => Err(reason.to_string()),
    },
};
