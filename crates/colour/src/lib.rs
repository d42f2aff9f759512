//! From a radiance spectrum to what an observer sees: XYZ, u'v', L*a*b*, gamut.
