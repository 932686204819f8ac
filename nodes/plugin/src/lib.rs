//! The dynamic library: the C face of Isophote.
