//! Inputs for the kernels: plausible ones and the hard ones, from a seed.
