//! Tests of the engine. They are one program, since each would compile and link anew what all of them use.
#![allow(missing_docs, reason = "tests document themselves by their names")]

#[macro_use]
mod support;

mod fusion;
mod gpu;
mod plan;
mod regions;
