//! Tests of the service through its HTTP interface, as callers use it.

mod arcs;
mod binary;
mod bounds;
mod compression;
mod connection;
mod cycles;
mod decoding;
mod determinism;
mod drops;
mod events;
mod examples;
mod five_axis;
mod golden;
mod languages;
mod models;
mod mtconnect;
mod negotiation;
mod operation;
mod points;
mod programs;
mod reading;
mod several;
mod shutdown;
mod smoothing;
pub mod support;
mod sweeps;
mod verifying;
