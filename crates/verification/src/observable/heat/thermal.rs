//! The balance of heat.

use crate::observable::Observable;
use sphcut_sph::ChannelId;

/// Thermal energy against the heat supplied.
pub(crate) const HEAT_CLOSURE: Observable = Observable {
    name: "heat_closure",
    unit: "",
    meaning: "|thermal energy above the start - heat supplied| over the heat supplied, at the end",
    arguments: &[],
    evaluate: |evidence, _| {
        let sample = evidence.last_sample()?;
        let supplied = sample.get(ChannelId::HeatSupplied);
        Ok((sample.get(ChannelId::HeatContent) - supplied).abs() / supplied.abs())
    },
};

/// Thermal energy over the heat that plastic work, numerical terms and friction should have given.
pub(crate) const HEAT_BALANCE: Observable = Observable {
    name: "heat_balance",
    unit: "",
    meaning: "thermal energy and what passed through the contact into the tool over (Taylor-Quinney \
              share of the plastic work + workpiece's share of the friction work + heat of numerical terms), at the end",
    arguments: &[],
    evaluate: |evidence, _| {
        let sample = evidence.last_sample()?;
        let values = &evidence.setup.heat.values;
        let heat = values.get("taylor_quinney") * sample.get(ChannelId::PlasticWork)
            + values.get("friction_heat_share") * sample.get(ChannelId::FrictionWork)
            + sample.get(ChannelId::NumericalHeat);
        let found = sample.get(ChannelId::HeatContent) + sample.get(ChannelId::HeatIntoTool);
        Ok(found / heat)
    },
};

/// Thermal energy over friction work, for a body that does not yield.
pub(crate) const FRICTION_HEAT_RATIO: Observable = Observable {
    name: "friction_heat_ratio",
    unit: "",
    meaning: "thermal energy without that of numerical terms over friction work at the end",
    arguments: &[],
    evaluate: |evidence, _| {
        let sample = evidence.last_sample()?;
        let heat = sample.get(ChannelId::HeatContent) - sample.get(ChannelId::NumericalHeat);
        Ok(heat / sample.get(ChannelId::FrictionWork))
    },
};

/// Highest temperature at the end.
pub(crate) const LARGEST_TEMPERATURE: Observable = Observable {
    name: "largest_temperature",
    unit: "K",
    meaning: "highest temperature of all particles at the end",
    arguments: &[],
    evaluate: |evidence, _| Ok(evidence.last_sample()?.get(ChannelId::MaxTemperature)),
};
