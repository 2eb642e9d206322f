//! What each command does.

pub(crate) mod calibrate;
pub(crate) mod calibrate_friction;
pub(crate) mod catalogue;
pub(crate) mod check;
pub(crate) mod diagnose;
pub(crate) mod export;
pub(crate) mod greybox;
pub(crate) mod identify;
pub(crate) mod materials;
pub(crate) mod predict;
pub(crate) mod recordings;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod schema;
pub(crate) mod springback;
pub(crate) mod store;
pub(crate) mod sweep;
pub(crate) mod validate;
pub(crate) mod verify;
pub(crate) mod wear;
