//! Tests of the library. They are one program, since each would compile and link anew what all of them use.

mod cel_light;
mod control;
mod cpu;
mod graph;
mod importance;
mod line_sets;
mod line_wobble;
mod lines;
mod materials;
mod result;
mod shader_directives;
mod smoothing;
mod thing_rules;
mod toon_shading;
mod uniforms;
