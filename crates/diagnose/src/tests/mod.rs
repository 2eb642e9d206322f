//! Tests of the whole chain against a model with known answers.

pub(crate) mod twin;
