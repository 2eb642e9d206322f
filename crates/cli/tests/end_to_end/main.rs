//! `sphcut` from the outside: what a user types, what comes back.

mod calibrate;
mod calibrate_friction;
mod cluster;
mod commands;
mod common;
mod diagnose;
mod documents;
mod greybox;
mod identify;
mod measuring;
mod recordings;
mod run;
mod same_bits;
mod series;
mod springback;
mod sweep;
mod trust;
