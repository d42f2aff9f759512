//! Interfaces, coherent thin films and scattering lobes, in direction cosines.
