//! Anisotropic layers: Berreman's 4x4 method, for liquid crystals, retarders and polarisers.
//!
//! **Model.** A plane wave of vacuum wavelength `lambda` comes from a transparent medium (real n), meets flat
//! layers, each with a complex dielectric tensor of any orientation (uniaxial, biaxial, absorbing), and a
//! semi-infinite isotropic medium behind (n + ik). Layers are coherent (all reflections interfere) or
//! incoherent (thick slabs, whose fringes no instrument resolves).
//!
//! **Frame of the panel.** x and y lie in the panel, z points out of it, *to the viewer*. Azimuths are in
//! degrees, counter-clockwise as seen by the viewer, 0 along x. A tilt is in degrees out of the panel; a
//! positive one raises the end at the given azimuth towards the viewer. The azimuth of a wave is that of its
//! travel along the panel, so that of the viewer who sees the mirrored light. A positive twist turns the
//! director counter-clockwise (seen by the viewer) from the top of a cell down to its bottom: the helix of a
//! positive twist is left-handed, that of a negative one right-handed.
//!
//! **Polarisation.** p lies in the plane of incidence, s across it, and (p, s, direction of travel) is a
//! right-handed frame for both the incident and the reflected wave. Hence `r_p = -r_s` at normal incidence on
//! an isotropic stack, as in [`film`](crate::film). A Jones matrix has the rows of the light that leaves and the columns of
//! the light that arrives, p first: `r[0][1]` is p from s. Stokes parameters are
//! `I = |p|^2 + |s|^2`, `Q = |p|^2 - |s|^2`, `U = 2 Re(p s*)`, `V = 2 Im(p s*)`, with fields that vary as
//! exp(-i omega t). V > 0 is right circular: whoever receives the light sees the field turn clockwise. A right-handed
//! cholesteric reflects right circular light and leaves it right circular. Who receives the light has p to
//! the right, s upwards, and sees positive angles counter-clockwise.
//!
//! **Method.** The tangential fields `(Ex, Hy, Ey, -Hx)` obey `d psi/dz = i k0 D psi` with Berreman's matrix
//! D of the tensor and of `beta = n sin(theta)`. A layer becomes a *scattering matrix* (reflection and transmission
//! from both sides, between waves of unit power in an artificial isotropic medium), and layers are joined by
//! Redheffer's star product. Nothing in it grows with thickness. The scattering matrix of a homogeneous
//! layer is that of a slice so thin that the Taylor series of `exp(i k0 h D)` converges to rounding, doubled
//! until the layer is complete. No eigenvectors are used for it, so that neither equal modes (isotropic layers, light along an
//! optic axis, singular axes of absorbing crystals) nor grazing ones are special. An incoherent slab needs its waves down and
//! up apart: the invariant subspaces of D, from its matrix sign function, which equal modes do not disturb
//! either. Its two waves down stay coherent with each other (it is a retarder), and are not coherent with the waves up.
//!
//! **Validity.** Flat layers, local dielectric tensors without optical activity of their own, mu = 1. A
//! director that changes with depth is cut into slices, each with the director in its middle: the error
//! decreases with the square of their number.
//!
//! **Two implementations.** [`jones`] and [`mueller`] are the reference: one wave, all quantities. [`SpectralStack`] is fast: the
//! reflectance of many wavelengths and states for unpolarised light. The tests compare both.
//!
//! Source: D. W. Berreman, J. Opt. Soc. Am. 62, 502 (1972); R. Redheffer, J. Math. Phys. 41, 1 (1962);
//! L. Li, J. Opt. Soc. Am. A 13, 1024 (1996); N. J. Higham, "Functions of Matrices" (2008), chapter 5.

mod dielectric;
mod director;
mod generator;
mod helix;
mod incoherent;
mod lanes;
mod matrix;
mod modes;
mod slab;
mod spectral;
mod stack;

pub use dielectric::{Dielectric, axes, direction};
pub use director::{Director, slices};
pub use spectral::{Part, Slice, SpectralStack, SpectralWaves};
pub use stack::{AnisotropicLayer, Jones, Mueller, Response, Stack, Wave, jones, mueller};
