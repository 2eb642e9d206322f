//! What a diagnosis asks of a model of the cut, and the models that answer: closed form, tabulated paired runs.

pub(crate) mod closed_form;
pub(crate) mod closed_form_cut;
pub(crate) mod nodes;
pub(crate) mod paired;
pub(crate) mod predictor;
pub(crate) mod scenario_keys;
